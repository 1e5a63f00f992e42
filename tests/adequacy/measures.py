#!/usr/bin/env python3
"""How tests, benchmarks and examples keep the largest of what they measure. Fails, with file and line, where NaN gets lost:

    x = fmax(x, y), std::fmax, std::max        they pass over NaN
    if (y > x) x = y;  x = y > x ? y : x;      so do these, where x is no integer
    if (!(y <= x)) x = y;                      it takes NaN, and after it the next number

larger(x, y) of larger.h, of tests/ or of examples/, stays infinite. A bound is the other way around: fmax keeps a finite one, and larger would
make it infinite, which everything keeps. What is called a bound or a tolerance must not come of larger.

usage: measures.py [FILE ...]     all of tests/, bench/ and examples/, or these"""
import re
import sys
from pathlib import Path

from source import ROOT, blank

KINDS = ["*.c", "*.h", "*.cpp", "*.hpp", "*.cu", "*.cuh"]
NAME = r"[*\w][\w.\->]*(?:\[[^][]*\])*(?:[.\w\->]*)"
BOUND = re.compile(r"bound|tolerance", re.I)
MAXIMUM = re.compile(rf"({NAME}) = (?:(?!fmin)[^;=])*?\b(?:std::)?(fmax[fl]?|max)(?:<[^>]*>)?\(")
LARGER_BOUND = re.compile(rf"({NAME}) = larger\(")
NOT_LESS = re.compile(rf"if \(!\(([^;]*) <=? ({NAME})\)\) ({NAME}) = ")
GREATER = re.compile(rf"if \(([^;]*) >=? ({NAME})\) ({NAME}) = ([^;]*);")
INTEGER = r"\b(?:int|long(?!\s+double)|unsigned|size_t|u?int\d+_t)\b"
CHOICE = re.compile(rf"({NAME}) = ([^;=]*) [<>]=? ([^;=]*) \? ([^;:]*) : ([^;]*);")


def arguments(text):
    """The arguments of a call, of what stands behind its bracket."""
    out, depth, word = [], 0, ""
    for mark in text:
        depth += mark in "([{"
        depth -= mark in ")]}"
        if depth < 0:
            break
        if mark == "," and depth == 0:
            out.append(word.strip())
            word = ""
        else:
            word += mark
    return [*out, word.strip()]


def is_integer(name, text):
    """Whether the file declares the last word of a name as an integer."""
    word = re.search(r"(\w+)\W*$", re.sub(r"\[[^][]*\]", "", name))[1]
    return re.search(rf"{INTEGER}(?:(?:[^;(){{}}]|\{{[^{{}}]*\}})*,)?[\s*]*\b{word}\b", text) is not None


def findings(path):
    """The findings of a file: (line, sentence)."""
    text = blank(path.read_text(encoding="utf-8"))
    ends = [0, *(match.end() for match in re.finditer(";", text)), len(text)]

    def at(match):
        return text.count("\n", 0, match.start()) + 1

    def matches(pattern, word):
        """Those in statements with the word, in a tenth of the time: no match goes beyond a semicolon."""
        for begin, end in zip(ends, ends[1:]):
            if text.find(word, begin, end) >= 0:
                yield from pattern.finditer(text, begin, end)

    for match in matches(MAXIMUM, "max"):
        name = match[1].lstrip("*")
        given = [re.sub(r"^\((?:double|float)\)\*?", "", a).lstrip("*") for a in arguments(text[match.end():])]
        if (name in given or given[0] in ("0", "0.0")) and not BOUND.search(name) and not is_integer(name, text):
            yield at(match), f"{match[2]} passes over NaN: {name} = larger({name}, ...) of larger.h does not"
    for match in matches(LARGER_BOUND, "larger("):
        if BOUND.search(match[1]):
            yield at(match), f"larger makes {match[1]} infinite of NaN, and everything keeps it: fmax does not"
    for match in matches(NOT_LESS, "if (!("):
        if match[2] == match[3]:
            yield at(match), f"the next number takes the place of NaN: {match[2]} = larger({match[2]}, ...) of larger.h"
    for match in matches(GREATER, "if ("):
        if match[2] == match[3] and match[1] == match[4] and not is_integer(match[2], text):
            yield at(match), f"NaN is not greater: {match[2]} = larger({match[2]}, ...) of larger.h"
    for match in matches(CHOICE, "?"):
        if match[1] in (match[2], match[3]) and {match[2], match[3]} == {match[4], match[5]} and not is_integer(match[1], text):
            yield at(match), f"NaN may not be chosen: {match[1]} = larger({match[1]}, ...) of larger.h"


def main(names):
    paths = [Path(a).resolve() for a in names] or sorted(
        path for folder in ("tests", "bench", "examples") for kind in KINDS for path in (ROOT / folder).rglob(kind))
    count = 0
    for path in paths:
        for line, sentence in findings(path):
            print(f"{path.relative_to(ROOT)}:{line}: {sentence}")
            count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
