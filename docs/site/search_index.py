"""Writes _static/search_index.js of a built site, which static/search.js reads: search_index.py FOLDER.
SPDX-License-Identifier: MIT"""
import html.parser
import json
import pathlib
import sys

VOID = {"br", "hr", "img", "input", "link", "meta", "wbr", "col", "source"}


class Sections(html.parser.HTMLParser):
    """Sections and declarations of a page's article: [anchor, title, text, kind]."""

    def __init__(self):
        super().__init__()
        self.found, self.depth, self.title, self.skip, self.section = [], 0, None, 0, ""
        self.joined, self.last = set(), ""  # declarations that share the text of the next one

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "article":
            self.depth = 1
        if not self.depth or tag in VOID:
            return
        self.depth += 1
        self.last = self.last if tag == "dt" else ""
        anchor = attributes.get("id", "")
        if tag == "section":
            self.section = anchor
        elif tag in ("h1", "h2", "h3"):
            self.found.append([self.section if tag != "h1" else "", "", "", int(tag == "h1")])
            self.title = self.depth
        elif tag == "dt" and anchor.startswith(("c.", "rbd.")):
            if self.last == "dt":
                self.joined.add(len(self.found) - 1)
            self.found.append([anchor, anchor.split(".")[-1] if anchor.startswith("c.") else anchor[4:], "", 2])
        kind = attributes.get("class", "")
        if self.skip or "headerlink" in kind or kind.split()[:1] == ["math"] or tag in ("script", "style", "annotation"):
            self.skip += 1

    def handle_endtag(self, tag):
        if not self.depth or tag in VOID:
            return
        self.last = tag
        if self.title == self.depth:
            self.title = None
        self.depth = 0 if tag == "article" else self.depth - 1
        self.skip = max(0, self.skip - 1)

    def handle_data(self, data):
        if not self.depth or self.skip or not self.found:
            return
        self.found[-1][1 if self.title else 2] += data


def entries(folder):
    for path in sorted(folder.glob("*/*.html")) + [folder / "index.html"]:
        page = path.relative_to(folder).as_posix()
        if page.split("/")[0] not in ("guides", "reference", "index.html"):
            continue
        parser = Sections()
        parser.feed(path.read_text())
        for k in sorted(parser.joined, reverse=True):
            parser.found[k][2] += " " + parser.found[k + 1][2]
        for anchor, title, text, kind in parser.found:
            yield [page, anchor, " ".join(title.split()), " ".join(text.split()), kind]


def main():
    folder = pathlib.Path(sys.argv[1])
    found = list(entries(folder))
    (folder / "_static/search_index.js").write_text("const SEARCH_INDEX = " + json.dumps(found, ensure_ascii=False, separators=(",", ":")) + ";\n")
    print(len(found), "places to find")
    return len(found) < 500


if __name__ == "__main__":
    sys.exit(main())
