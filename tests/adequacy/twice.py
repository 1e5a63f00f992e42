#!/usr/bin/env python3
"""Functions that stand in two rooms of src/: their parameters and bodies are the same but for the names of locals and
const. rooms.py refuses them with the names of both.

The headers that include rbd.h have its rooms: what two storeys need stands in a room below both, as base/memory.h.
rbd_qp.h stands alone. A room of base/ that it names, as rbd.h does, keeps its guard in both shipped headers
(amalgamate.shared), so that a file which includes both has it once.

usage: twice.py [FILE ...]     all rooms, or these"""
import re
import sys
from pathlib import Path

from source import OPAQUE, ROOT

LEAST_WORDS = 6  # of a body: shorter ones name a field or pass arguments on
HEAD = re.compile(r"^(?:RBDI?_\w+|static)\b[^\n;{}=]*(?:\n[^\n;{}=]+)*\{", re.M)
WORDS = set("if else for while do return switch case break continue default static int double float unsigned char void "
            "sizeof struct size_t ptrdiff_t enum NULL".split())


def without_comment(match):
    """A string as it is, a comment as its line ends."""
    return re.sub(r"[^\n]", " ", match[0]) if match[0].startswith("/") else match[0]


def functions(text):
    """(name, line, parameters, body) of each function of a text without comments."""
    for head in HEAD.finditer(text):
        name = re.search(r"\b(rbdi?_\w+)\s*(\(.*)\{", head[0], re.S)
        if not name:
            continue
        depth, end = 1, head.end()
        while depth and end < len(text):
            depth += (text[end] == "{") - (text[end] == "}")
            end += 1
        yield name[1], text.count("\n", 0, head.start()) + 1, name[2], text[head.end():end - 1]


def shape(parameters, body):
    """The same for functions that differ in names of locals alone; None of a short body."""
    tokens = [t for t in re.findall(r'"(?:\\.|[^"\\])*"|\w+|->|[^\w\s]', parameters + body) if t != "const"]
    if len(re.findall(r"\w+", body)) < LEAST_WORDS:
        return None
    names, out = {}, []
    for i, token in enumerate(tokens):
        is_field = i > 0 and tokens[i - 1] in (".", "->")
        is_called = i + 1 < len(tokens) and tokens[i + 1] == "("
        is_local = re.match(r"[a-zA-Z]", token) and not token.lower().startswith("rbd") and token not in WORDS
        out.append(f"local{names.setdefault(token, len(names))}" if is_local and not is_field and not is_called else token)
    return " ".join(out)


def findings(paths):
    """The sentences of what stands twice."""
    first = {}
    for path in paths:
        text = OPAQUE.sub(without_comment, path.read_text(encoding="utf-8"))
        for name, line, parameters, body in functions(text):
            place = f"{path.relative_to(ROOT) if path.is_relative_to(ROOT) else path.name}:{line}"
            found = shape(parameters, body)
            if found is None:
                continue
            other, its_path, its_place = first.setdefault(found, (name, path, place))
            if its_path != path:
                yield f"{place}: {name} is {other} of {its_place}: one room that both include should have it"


def rooms():
    return sorted((ROOT / "src").glob("*/*.h"))


def main(names):
    wrong = list(findings([Path(a).resolve() for a in names] or rooms()))
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
