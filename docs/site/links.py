"""Whether the links of built pages lead to pages, files and places that are there: links.py FOLDER.
SPDX-License-Identifier: MIT"""
import pathlib
import re
import sys
import urllib.parse

FOLDER = pathlib.Path(sys.argv[1]).resolve()
texts = {path: path.read_text() for path in FOLDER.rglob("*.html")}
anchors = {path: set(re.findall(r'\b(?:id|name)="([^"]+)"', text)) for path, text in texts.items()}
problems, count = [], 0
for page, text in texts.items():
    for target in re.findall(r'\b(?:href|src)="([^"]+)"', text):
        if re.match(r"[a-z]+:|//", target):
            if target.startswith(("http:", "https:", "//")) and 'src="' + target in text:
                problems.append(f"{page}: loads {target} from outside")
            continue
        path, _, anchor = target.partition("#")
        goal = (page.parent / urllib.parse.unquote(path.split("?")[0])).resolve() if path else page
        if goal.is_dir():
            goal /= "index.html"
        if goal.parts[len(FOLDER.parts):][:1] == ("playground",):
            continue
        count += 1
        if not goal.exists():
            problems.append(f"{page.relative_to(FOLDER)}: there is no {target}")
        elif anchor and goal in anchors and urllib.parse.unquote(anchor) not in anchors[goal]:
            problems.append(f"{page.relative_to(FOLDER)}: there is no place {target}")
print("\n".join(sorted(set(problems))))
print(f"{len(texts)} pages, {count} links, {len(set(problems))} problems")
sys.exit(bool(problems) or count < 1000)
