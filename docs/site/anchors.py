"""Whether each public name has a place in the built reference that shows its prototype: anchors.py FOLDER.
SPDX-License-Identifier: MIT"""
import html
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests"))
import interface  # noqa: E402


def places(folder):
    """Name and the text of its entry's head."""
    found = {}
    for page in (folder / "reference").glob("*.html"):
        for anchor, head in re.findall(r'<dt[^>]* id="c\.([\w.]+)">(.*?)</dt>', page.read_text(), re.S):
            found.setdefault(anchor.split(".")[-1], html.unescape(re.sub(r"<[^>]*>", "", head)))
    return found


def main():
    found = places(pathlib.Path(sys.argv[1]))
    functions = set().union(*(re.findall(r"\b(rbd_\w+)\(", interface.code_of((ROOT / h).read_text())) for h in interface.HEADERS))
    declared = set().union(*map(interface.public, interface.HEADERS))
    missing = sorted(declared - set(found))
    functions = {n for n in declared & functions & set(found) if not re.match("struct|enum|type", found[n].strip())}
    bare = sorted(n for n in functions if n + "(" not in found[n].replace(" ", ""))
    print("\n".join([f"{n} has no anchor" for n in missing] + [f"the place of {n} shows no prototype" for n in bare]))
    print(f"{len(declared)} names, {len(missing) + len(bare)} problems")
    return bool(missing or bare) or len(declared) < 300


sys.exit(main())
