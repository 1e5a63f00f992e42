"""What coverage.py and mutants.py know of a header's text: where code is, whose it is; and the lists of exceptions."""
import difflib
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "src"))
import amalgamate  # noqa: E402
HEADERS = amalgamate.HEADERS

# Comments, strings and characters; what else begins with a quote does not occur in C.
OPAQUE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)


def blank(text):
    """The same text with comments and literals as spaces; strings keep their quotes."""
    def spaces(match):
        found = re.sub(r"[^\n]", " ", match.group())
        return '"' + found[1:-1] + '"' if match.group()[0] == '"' else found
    return OPAQUE.sub(spaces, text)


class Source:
    """A header by lines, counted from 1. function[n]: the function or macro that line n belongs to, or ''.
    code[n]: line n without comments and literals; '' if it is preprocessor, a signature or outside. The
    implementation begins at line first; rbd_spatial.h is one."""

    def __init__(self, path):
        self.name = path.name
        self.text = path.read_text(encoding="utf-8")
        self.lines = [""] + self.text.split("\n")
        clean = [""] + blank(self.text).split("\n")
        self.first = next((i for i, line in enumerate(clean)
                           if re.match("#if defined RBD_(BATCH_)?IMPLEMENTATION", line)), 1)
        self.function = [""] * len(clean)
        self.code = [""] * len(clean)
        self.clean = clean
        self.places = amalgamate.places(self.name)
        i = self.first
        while i < len(clean):
            i = self._macro(i) if clean[i].startswith("#") else self._definition(i)

    def place(self, line):
        """The file of src/ that a line is from, and its line there."""
        return "src/{}:{}".format(*self.places[line])

    def _macro(self, i):
        """Of a macro the lines after the first are code: the name and its parameters stand in the first."""
        name = re.match(r"#define (\w+)\(", self.clean[i])
        while True:
            if name:
                self.function[i] = name.group(1)
            if not self.clean[i].endswith("\\"):
                return i + 1
            i += 1
            self.code[i] = self.clean[i].rstrip("\\") if name else ""

    def _definition(self, i):
        """A definition begins in the first column; a function has a body, which ends in the first column."""
        if not re.match(r"(RBD|static)", self.clean[i]) or "(" not in self.clean[i]:
            return i + 1
        start, head = i, self.clean[i]
        while not re.search(r"[;{=]", head):
            i += 1
            head += " " + self.clean[i]
        name = re.search(r"(\w+)\s*\(", head)
        if "{" not in head or not name or ";" in head.split("{")[0]:
            return i + 1
        one_line = head.rstrip().endswith("}")
        if one_line:
            at = self.clean[i].index("{") + 1
            self.code[i] = " " * at + self.clean[i][at:self.clean[i].rindex("}")]
        while not one_line:
            i += 1
            if self.clean[i].startswith("}"):
                break
            self.code[i] = "" if self.clean[i].lstrip().startswith("#") else self.clean[i]
        for k in range(start, i + 1):
            self.function[k] = name.group(1)
        return i + 1

    def span(self, l1, c1, l2, c2):
        """The text of a region, spaces made one."""
        if l1 == l2:
            text = self.lines[l1][c1 - 1:c2 - 1]
        else:
            text = "\n".join([self.lines[l1][c1 - 1:], *self.lines[l1 + 1:l2], self.lines[l2][:c2 - 1]])
        return squeeze(text)


def squeeze(text):
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    return " ".join(text.replace("\\\n", " ").split())


class Exceptions:
    """A committed list: paragraphs of a key of several lines, 'name: text', and the reason, indented. The
    keys are texts, not line numbers, so that code may move."""

    def __init__(self, path, fields):
        self.path, self.fields = path, fields
        self.head, self.entries = [], []
        self.used = set()
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        for paragraph in re.split(r"\n\s*\n", text.strip()):
            rows = paragraph.split("\n")
            if not rows[0].startswith(fields[0] + ": "):
                self.head.append(paragraph)
                continue
            key = []
            for field in fields:
                row = rows.pop(0) if rows else ""
                if not row.startswith(field + ": "):
                    raise SystemExit(f"{path.name}: '{field}: ' expected: {row}")
                key.append(row[len(field) + 2:].strip())
            reason = " ".join(row.strip() for row in rows)
            if not reason:
                raise SystemExit(f"{path.name}: no reason: {key}")
            self.entries.append([tuple(key), reason])

    def find(self, key):
        """The reason, or None."""
        for entry, reason in self.entries:
            if entry == key:
                self.used.add(key)
                return reason
        return None

    def stale(self):
        return [key for key, _ in self.entries if key not in self.used]

    def refresh(self, present):
        """Gives each stale entry the key, of those present and not listed, that resembles it most."""
        free = [key for key in present if all(key != entry for entry, _ in self.entries)]
        for entry in self.entries:
            if entry[0] in present:
                continue
            old = "\n".join(entry[0])
            scored = sorted(((difflib.SequenceMatcher(None, old, "\n".join(key)).ratio(), key) for key in free),
                            reverse=True)
            if scored and scored[0][0] > 0.75:
                print(f"refreshed: {' | '.join(entry[0])}\n       as: {' | '.join(scored[0][1])}")
                entry[0] = scored[0][1]
                free.remove(entry[0])
            else:
                print(f"gone: {' | '.join(entry[0])}")
        self.save()

    def save(self):
        out = list(self.head)
        for key, reason in self.entries:
            rows = [f"{field}: {text}" for field, text in zip(self.fields, key)]
            line = "   "
            for word in reason.split():
                if len(line) + 1 + len(word) > 110:
                    rows.append(line)
                    line = "   "
                line += " " + word
            out.append("\n".join([*rows, line]))
        self.path.write_text("\n\n".join(out) + "\n", encoding="utf-8")
