#!/usr/bin/env python3
"""What follows from the public declarations: interface.py [--list | --write]

docs/interface.md names what the headers declare, and nothing else. tests/plain_calls.h lists the calls that tests can make by
their declaration alone (calls.py). Each function of the headers that RBD_REPRODUCIBLE is for is one of these, or called in
reproducible.c or all_calls.h, where the bits of its results are compared.

--write makes tests/plain_calls.h, and a row of docs/interface.md for each function, type and macro that has none: behind the
row of the declaration before it, with the first sentence of its comment. Read these rows.

Public is each rbd_... and RBD_... of a header's code before "Stop here", and each macro RBD_... that it defines or
asks for after it. --list prints them. SPDX-License-Identifier: MIT"""
import pathlib
import re
import sys

import calls
import extract

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE, PLAIN_CALLS = ROOT / "docs/interface.md", ROOT / "tests/plain_calls.h"
HEADERS = (ROOT / "src/headers.txt").read_text().split() + ["rbd_urdf.h", "rbd_mjcf.h"]
NAME = re.compile(r"\b(?:rbd|RBD)_\w*[A-Za-z0-9]\b")
TEXTS = ["rbd_status_string", "rbd_finding_text", "rbd_constraint_finding_text",
         "rbd_contact_finding_text", "rbd_estimate_text", "rbd_ik_text", "rbd_actuators_finding_text", "rbd_qp_text",
         "rbd_tasks_text"]  # words, not numbers
MACRO = re.compile(r"^ *# *(?:define|ifdef|ifndef|if|elif)\b.*$", re.M)


def code_of(text):
    """Without comments, literals and messages."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)
    text = re.sub(r"\\\n", " ", text)
    text = re.sub(r"^ *# *(?:error|include)\b.*$", "", text, flags=re.M)
    return re.sub(r'"(?:\\.|[^"\\\n])*"', '""', text)


def public(header):
    """Names that the header shows to its users."""
    text = (ROOT / header).read_text()
    public_part, _, rest = text.partition("   Stop here if you only use it.")
    if header in ("rbd_urdf.h", "rbd_mjcf.h"):
        public_part, _, rest = text.partition("\n   Implementation\n")
    if header == "rbd_spatial.h":
        public_part, rest = text, ""
    names = set(NAME.findall(code_of(public_part + "*/")))
    for line in MACRO.findall(code_of("/*" + rest)):
        names |= {n for n in NAME.findall(line) if n.startswith("RBD_")}
    guard = header.replace(".", "_").upper()
    return {n for n in names if n != guard and not re.fullmatch(r"RBD\w*_H", n)}


def uncompared():
    """Functions of which no bits are compared."""
    called = "".join((ROOT / "tests" / name).read_text() for name in ("all_calls.h", "reproducible.c", "plain_calls.h"))
    for header in HEADERS:
        if header in ("rbd_batch.h", "rbd_urdf.h", "rbd_mjcf.h"):  # reproducible_batch.c compares batches; files are never on a robot
            continue
        public_part = (ROOT / header).read_text().partition("   Stop here if you only use it.")[0]
        for name in sorted(set(re.findall(r"\b(rbd_\w+)\(", code_of(public_part + "*/"))) - set(TEXTS)):
            if not re.search(rf"\b{name}(\(|, [01], \()", called):
                yield f"tests/all_calls.h does not call {name} of {header}"


def documented(text):
    """Names in the first cell of each row of the tables."""
    found = []
    for row in re.findall(r"^\| (`[^|]*) \|", text, re.M):
        found += re.findall(r"`(\w+)", row)
    return found


def first_sentence(comment):
    sentence = re.split(r"\.(?= |$)|; |: ", " ".join(comment.split()))[0]
    return sentence[:1].lower() + sentence[1:] if sentence else "-"


def with_rows(page):
    """The page with a row for each declaration that has none."""
    lines = page.split("\n")
    for header in HEADERS:
        before = None
        for item in [item for section in extract.parse(header).sections for item in section.items]:
            at = next((i for i, line in enumerate(lines) if re.match(rf"\| [^|]*`{item.name}`", line)), None)
            if at is None and before is not None:
                at = before + 1
                lines.insert(at, f"| `{item.name}` | {first_sentence(item.comment)} |")
            before = at
    return "\n".join(lines)


def write():
    """Writes what follows from the declarations; prints the files that changed."""
    for path, text in ((PAGE, with_rows(PAGE.read_text())), (PLAIN_CALLS, calls.text())):
        if path.read_text() != text:
            path.write_text(text)
            print(f"{path.relative_to(ROOT)} is new: read the difference")


def main():
    declared = set().union(*map(public, HEADERS))
    if "--list" in sys.argv[1:]:
        print("\n".join(sorted(declared)))
        return 0
    if "--write" in sys.argv[1:]:
        write()
    rows = documented(PAGE.read_text())
    problems = [f"docs/interface.md lacks {n}" for n in sorted(declared - set(rows))]
    problems += [f"docs/interface.md has {n}, which no header declares" for n in sorted(set(rows) - declared)]
    problems += [f"docs/interface.md has {n} twice" for n in sorted(set(rows)) if rows.count(n) > 1]
    problems += uncompared()
    if PLAIN_CALLS.read_text() != calls.text():
        problems.append("tests/plain_calls.h is not what the headers declare: python3 tests/interface.py --write")
    print("\n".join(problems))
    print(f"{len(declared)} public names, {len(problems)} problems")
    return bool(problems) or len(declared) < 200


if __name__ == "__main__":
    sys.exit(main())
