#!/usr/bin/env python3
"""How the rooms of src/ read. Fails, with file and line, where

    a room has more than 450 lines or a function more than 60
    a line holds two statements
    a comma joins two assignments, outside of a declaration
    the head of a for has more than three commas

usage: readable.py [FILE ...]     all rooms, or these"""
import re
import sys
from pathlib import Path

from source import ROOT, blank

LONGEST_ROOM = 450
LONGEST_FUNCTION = 60
MOST_COMMAS = 3

ASSIGNS = re.compile(r"(?<![=!<>])(?:[-+*/%&|^]|<<|>>)?=(?!=)")
TYPE = r"(?:const|static|volatile|unsigned|signed|struct|union|enum|int|char|long|short|double|float|void|size_t|u?int\d+_t|rbdi?_\w+)"
DECLARATION = re.compile(rf"\s*(?:RBDI?_\w+\s+)*{TYPE}\b[\w\s*]*[\s*]\w+\s*(?:\[|=|,|;|$)")

def without_heads(line):
    """The line without the heads of for, if, while and switch: what is left are statements. And the heads of for."""
    loops = []
    while True:
        head = re.search(r"\b(for|if|while|switch)\s*\(", line)
        if not head:
            return line, loops
        depth, end = 0, head.end() - 1
        while end < len(line):
            depth += (line[end] == "(") - (line[end] == ")")
            end += 1
            if depth == 0:
                break
        if head[1] == "for":
            loops.append(line[head.end():end - 1])
        line = line[:head.start()] + line[end:]


def top_level(text):
    """The text without what stands in brackets of any kind."""
    out, depth = [], 0
    for mark in text:
        depth -= mark in ")]}"
        if depth <= 0:
            out.append(mark)
        depth += mark in "([{"
    return "".join(out)


def functions(lines):
    """(name, first line, number of lines) of each function: its head begins in the first column, and so does its last brace."""
    start = None
    for i, line in enumerate(lines):
        if re.match(r"(RBD|static|rbd|int|void|double|const|enum|struct)\w*\b.*\(", line) and not line.rstrip().endswith(";"):
            start = i
        elif line.startswith("}") and start is not None:
            name = re.search(r"(\w+)\(", lines[start])
            yield name[1] if name else "?", start, i + 1 - start
            start = None


def findings(path):
    """The findings of one room: (line, sentence)."""
    text = path.read_text(encoding="utf-8")
    lines = blank(text).split("\n")
    if len(lines) - 1 > LONGEST_ROOM:
        yield len(lines) - 1, f"the room has {len(lines) - 1} lines; at most {LONGEST_ROOM}"
    for name, start, length in functions(lines):
        if length > LONGEST_FUNCTION:
            yield start + 1, f"{name} has {length} lines; at most {LONGEST_FUNCTION}"

    statement = ""  # up to its semicolon or brace
    constants = False  # in an enum
    for i, line in enumerate(lines):
        line = line.rstrip("\\ ")
        constants = "}" not in line and (constants or re.search(r"\benum\b[\w\s]*\{", line) is not None)
        if constants or line.lstrip().startswith("#"):
            statement = ""
            continue
        before = statement
        bare, loops = without_heads(line)
        for loop in loops:
            if top_level(loop).count(",") > MOST_COMMAS:
                yield i + 1, f"a for of more than {MOST_COMMAS} commas"
        flat = top_level(bare)
        if flat.count(";") > 1:
            yield i + 1, "two statements on a line"
        for part in flat.split(";"):
            statement = before + " " + part
            before = ""
            words = re.sub(r"^[\s{}]*(?:else|do)?\b", "", statement)
            pieces = words.split(",")
            if len([p for p in pieces if ASSIGNS.search(p)]) > 1 and not DECLARATION.match(words) and "return" not in words:
                yield i + 1, "a comma joins two assignments"
                statement = ""
        if re.search(r"[;{}]\s*$", line):
            statement = ""


def main(arguments):
    paths = [Path(a).resolve() for a in arguments] or sorted((ROOT / "src").rglob("*.h"))
    count = 0
    for path in paths:
        for line, sentence in findings(path):
            print(f"{path.relative_to(ROOT)}:{line}: {sentence}")
            count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
