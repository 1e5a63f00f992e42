"""What the headers declare, with the comments that stand there: the reference is made from this.

A header's public part is read as a row of comments, directives and declarations. Declarations that follow each other
without an empty line share the comment before the first. SPDX-License-Identifier: MIT"""
import pathlib
import re
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HEADERS = (ROOT / "src/headers.txt").read_text().split() + ["rbd_urdf.h", "rbd_mjcf.h"]
ENDS = {"rbd_urdf.h": "\n   Implementation\n", "rbd_mjcf.h": "\n   Implementation\n", "rbd_spatial.h": None}  # of the public part; the others:
STOP = "   Stop here if you only use it."
SECTION = re.compile(r"/\* -+ (.*?) \[([\w ]+)\] -+\s*(.*?)\*/", re.S)
TOKEN = re.compile(r"/\*.*?\*/|^[ \t]*#(?:[^\n\\/]|\\.|\\\n|/(?!\*))*|\n[ \t]*(?=\n)|[^\s]", re.S | re.M)


@dataclass
class Item:
    """A declaration: kind is function, type or macro."""
    name: str
    kind: str
    text: str                 # as it stands there
    line: int
    comment: str = ""
    follows: bool = False     # it stands directly behind the item before, without a comment of its own
    guards: list = field(default_factory=list)
    members: list = field(default_factory=list)  # of an enum or struct: (declaration, comment)


@dataclass
class Section:
    title: str
    tag: str
    comment: str
    items: list = field(default_factory=list)
    note: str = ""            # behind it, on all calls below


@dataclass
class Header:
    name: str
    top: str                  # its first comment
    sections: list


def plain(comment):
    """A comment's text without its marks, and without the indentation of all lines."""
    lines = [line.rstrip() for line in comment.split("\n")]
    return "\n".join([lines[0].strip()] + [re.sub(r"^ {0,3}", "", line) for line in lines[1:]]).strip()


def end_of(text, start):
    """Where the declaration that begins here ends: behind its ; or, of a function that is defined here, its }."""
    depth, k, defined = 0, start, False
    while k < len(text):
        if text.startswith("/*", k):
            k = text.index("*/", k) + 2
            continue
        c = text[k]
        depth += (c in "({") - (c in ")}")
        if depth == 1 and c == "{":
            before = text[start:k]
            defined = before.startswith(("static", "RBDI_INLINE", "RBDI_PART")) and ")" in before
        k += 1
        if depth == 0 and (c == ";" or (c == "}" and defined)):
            return k
    raise ValueError(f"a declaration without end: {text[start:start + 60]!r}")


def members(text):
    """Members of an enum or struct, each with the comment behind it."""
    body = text[text.index("{") + 1:text.rindex("}")]
    body = re.sub(r"RBDI_FRAMES\([^)]*\)", "", body)
    found, k = [], 0
    separator = "," if re.match(r"(typedef )?enum", text) else ";"
    while True:
        end = k
        while end < len(body) and body[end] != separator:
            end = body.index("*/", end) + 2 if body.startswith("/*", end) else end + 1
        declaration = body[k:end]
        rest = re.match(r"[,;]?[ \t]*/\*(.*?)\*/", body[end:], re.S)
        comment = plain(rest[1]) if rest else ""
        inside = re.search(r"/\*(.*?)\*/", declaration, re.S)  # behind the last, which has no comma
        if inside and not comment:
            comment = plain(inside[1])
        declaration = " ".join(re.sub(r"/\*.*?\*/", "", declaration, flags=re.S).split())
        if declaration:
            found.append((declaration, comment))
        if end >= len(body):
            return found
        k = end + (rest.end() if rest else 1)


def item_of(text, line):
    """The declaration as an item; None if it is nothing that a user names."""
    head = text.split("{")[0]
    bare = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    if re.match(r"typedef\b|enum\b|struct\b", text):
        name = re.search(r"(\w+)(?: __attribute__.*)?;$", bare, re.S)
        if text.startswith(("enum", "struct")) or not name:
            return None
        kind = "type"
    else:
        name = re.search(r"\b(rbd_\w+)\s*\(", head)
        kind = "function"
    if not name or not name[1].startswith("rbd_"):
        return None
    item = Item(name[1], kind, text, line)
    if kind == "type" and "{" in text:
        item.members = members(text)
    return item


def public_part(whole, header):
    """The text that declares, up to its last comment; what is no declaration of C is blank, so that lines keep their numbers."""
    end = ENDS.get(header, STOP)
    public = whole[:whole.index(end)] if end else whole
    public = public[:public.rindex("*/") + 2]
    for pattern in (r'^#if[^\n]*__cplusplus[^\n]*\n(?:extern "C" \{|\})\n#endif', r"^RBDI_EXTERN_C_(BEGIN|END)$",
                    r"\bRBDI_EXTENSION(?= typedef)"):
        public = re.sub(pattern, lambda m: re.sub(r"[^\n]", " ", m[0]), public, flags=re.M)
    return public


class Reader:
    """Reads a public part into sections, token by token."""

    def __init__(self, public):
        self.public, self.sections = public, [Section("", "", "")]
        self.guards = []       # the #if around
        self.comment = None    # that waits for its declaration
        self.last = None       # the item before
        self.blank = True      # an empty line came since

    def read(self, k):
        while token := TOKEN.search(self.public, k):
            text, k = token[0].strip(), token.end()
            start = token.start() + len(token[0]) - len(token[0].lstrip())
            if not text:
                self.empty_line()
            elif text.startswith("/*"):
                self.take_comment(text, self.public[self.public.rfind("\n", 0, start) + 1:start].strip() == "")
            elif text.startswith("#"):
                self.directive(text, self.line(start))
            else:
                k = self.declaration(start)

    def line(self, place):
        return self.public.count("\n", 0, place) + 1

    def empty_line(self):
        if self.comment and "all calls below" in self.comment:
            self.sections[-1].note = self.comment
        self.blank, self.comment = True, None

    def take_comment(self, text, own_line):
        section = SECTION.match(text)
        if section:
            self.sections.append(Section(section[1], section[2], plain(section[3])))
            self.last = None
        elif text.startswith("/* ===="):
            return
        elif own_line:
            self.comment = plain(text[2:-2])
        elif self.last and not self.last.comment:  # behind a declaration
            self.last.comment = plain(text[2:-2])

    def directive(self, text, line):
        word = re.match(r"#\s*(\w+)\s*(.*)", text, re.S)
        if word[1] in ("if", "ifdef", "ifndef"):
            self.guards.append(f"{word[1]} {word[2]}".strip())
        elif word[1] == "endif" and self.guards:
            self.guards.pop()
        macro = re.match(r"(RBD_[A-Z]\w*)(\([\w, ]*\))?", word[2])
        self.last = None
        if word[1] == "define" and macro and not macro[1].endswith("_H"):
            self.last = Item(macro[1], "macro", macro[1] + (macro[2] or ""), line, self.comment or "")
            if macro[1] not in [i.name for s in self.sections for i in s.items]:
                self.sections[-1].items.append(self.last)
            self.comment = None

    def declaration(self, start):
        end = end_of(self.public, start)
        found = item_of(self.public[start:end], self.line(start))
        if found:
            found.comment = self.comment or ""
            found.guards = [g for g in self.guards if g.startswith("ifndef RBD_NO_") or "RBD_DERIVATIVES_H" in g]
            found.follows = self.comment is None and self.last is not None and not self.blank
            self.sections[-1].items.append(found)
        self.last, self.comment, self.blank = found, None, False
        return end


def sizes(whole, public):
    """Macros of memory, which stand behind the public part."""
    for found in re.finditer(r"^(?:/\*((?:[^*]|\*(?!/))*)\*/\n)?#define (RBD_[A-Z]\w*_SIZE\w*)(\([\w, ]+\))", whole[len(public):], re.M):
        line = whole.count("\n", 0, len(public) + found.start(2)) + 1
        yield Item(found[2], "macro", found[2] + found[3], line, plain(found[1] or ""), follows=found[1] is None)


def parse(header, root=ROOT):
    whole = (root / header).read_text()
    public = public_part(whole, header)
    top = re.match(r"/\*(.*?)\*/", public, re.S)
    reader = Reader(public)
    reader.read(top.end())
    sections = reader.sections
    for item in sizes(whole, public):
        tags = ("build",) if item.name.startswith("RBD_MODEL") else ("work", "memory", "set")
        next((s for s in sections if s.tag in tags), sections[-1]).items.append(item)
    return Header(header, plain(top[1]), [s for s in sections if s.items or s.tag])


def groups(section):
    """The items that share a comment stand together."""
    found = []
    for item in section.items:
        if item.follows and found and found[-1][0].kind in (item.kind, "type"):
            found[-1].append(item)
        else:
            found.append([item])
    return found


def named_in_top(header):
    """Macros that the top comment describes: lines 'RBD_NAME   text', and what is indented below."""
    found, names = {}, []
    for line in header.top.split("\n"):
        entry = re.match(r" +(RBD_[A-Z]\w*(?:\([a-z]\))?(?: [a-zA-Z(RBD_]\S*)?) {2,}(\S.*)$", line)
        entry = entry or re.match(r" +(RBD_REPRODUCIBLE) (.*)$", line)
        if entry:
            names = re.findall(r"RBD_\w+", entry[1])
            for name in names:
                found[name] = [entry[2]]
        elif names and re.match(r" {6,}\S", line):
            for name in names:
                found[name].append(line.strip())
        else:
            names = []
    return {name: " ".join(lines) for name, lines in found.items()}


def names_of(header):
    """All public names of a header that have a place in the reference."""
    found = set(named_in_top(header))
    for section in header.sections:
        for item in section.items:
            found.add(item.name)
            if item.kind == "type" and item.text.startswith("typedef enum"):
                found |= {declaration.split()[0] for declaration, _ in item.members}
    found |= set(re.findall(r"#define (RBD_\w+)", header.top))
    return found
