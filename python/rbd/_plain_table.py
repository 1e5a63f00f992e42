# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""C tables as rbd-model writes them, read without a compiler."""
from __future__ import annotations

import ctypes
import re

from ._headers import JointType, structure

_TOKEN = re.compile(r"""\s+ | /\*.*?\*/ | //[^\n]*
                        | (?P<text>"(?:[^"\\\n]|\\(?:["\\?]|[0-7]{3}))*")
                        | (?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.]))
                        | (?P<name>[A-Za-z_]\w*)
                        | (?P<mark>[{},;])""", re.S | re.X)


_COMMENT = re.compile(r'"(?:[^"\\\n]|\\.)*"|/\*.*?\*/|//[^\n]*', re.S)
_CONDITION = re.compile(r"^[ \t]*#[ \t]*(ifndef|ifdef|if|elif|else|endif)\b[ \t]*(\w*)[^\n]*"
                        r"(?:(?=\n\s*#[ \t]*define[ \t]+(\w+))|)", re.M)


class _NotPlain(Exception):
    """What only a compiler understands."""


def _tokens(text, at):
    """(kind, text) of what stands from `at`, to the semicolon."""
    while True:
        token = _TOKEN.match(text, at)
        if not token or token.group() == ";":
            return
        at = token.end()
        if token.lastgroup:
            yield token.lastgroup, token.group()


def _character(escape):
    """The byte of an escape."""
    return bytes([int(escape[1], 8)]) if len(escape[1]) == 3 else escape[1]


def _value(kind, text):
    if kind == "text":
        return re.sub(rb"\\([0-7]{3}|.)", _character, text[1:-1].encode())
    if kind == "number":
        if re.fullmatch(r"[-+]?0\d+", text):  # octal
            raise _NotPlain
        return float(text) if re.search(r"[.eE]", text) else int(text)
    if text == "NULL":
        return None
    if kind == "name" and text.startswith("RBD_") and text[4:] in JointType.__members__:
        return JointType[text[4:]]
    raise _NotPlain


def _initialiser(text, at):
    """The lists of values between braces."""
    open_lists, whole = [[]], None
    comma = True  # a value may follow: one stands behind a brace or a comma
    for kind, token in _tokens(text, at):
        if whole is not None or (token != "}" and token != "," and not comma) or (token == "," and comma):
            raise _NotPlain
        if token == "{":
            open_lists.append([])
        elif token == "}":
            closed = open_lists.pop()
            if not open_lists:
                raise _NotPlain
            open_lists[-1].append(closed)
            whole = closed if len(open_lists) == 1 else None
        elif token != ",":
            open_lists[-1].append(_value(kind, token))
        comma = token in "{,"
    if whole is None:
        raise _NotPlain
    return whole


def _set(row, member, kind, value):
    if issubclass(kind, ctypes.Array):
        if not isinstance(value, list) or not 1 <= len(value) <= kind._length_:
            raise _NotPlain
        value = kind(*value)
    elif isinstance(value, list) or kind is ctypes.c_int and isinstance(value, int) and not -2**31 <= value < 2**31:
        raise _NotPlain
    setattr(row, member, value)


def _may_be_skipped(before):
    """Whether what stands behind this text is within an #if that is no guard."""
    guards = []
    for word, name, defined in _CONDITION.findall(before):
        if word.startswith("if"):
            guards.append(word == "ifndef" and name == defined)
        elif guards and word == "endif":
            guards.pop()
        elif guards:
            guards[-1] = False
    return not all(guards)


def _has_length(text, length, rows):
    """Whether an array of this length in C, a number, a name or nothing, has so many rows."""
    defined = re.search(rf"^\s*#\s*define\s+{length}\s+(\d+)\s*$", text, re.M) if length and not length.isdigit() else None
    return not length or (defined[1] if defined else length) == str(rows)


def _plain_rows(text, array):
    """Rows of this array of rbd_body in the text of a C header, or None if it is not as plain as rbd-model
    writes it: then a compiler reads it."""
    text = _COMMENT.sub(lambda found: found.group() if found.group()[0] == '"' else " ", text)
    found = list(re.finditer(rf"\brbd_body\s+{array}\s*\[\s*(\w*)\s*\]\s*=\s*(?={{)", text))
    begin = found[0] if len(found) == 1 else None
    if not begin or _may_be_skipped(text[:begin.start()]) or re.search(r"^\s*#\s*(?:if|elif|else|include)\b", text[begin.end():].partition(";")[0], re.M):
        return None
    try:
        rows = []
        for values in _initialiser(text, begin.end()):
            row = structure("rbd_body")()
            if not isinstance(values, list) or len(values) > len(row._fields_):
                raise _NotPlain
            for (member, kind), value in zip(row._fields_, values):
                _set(row, member, kind, value)
            rows.append(row)
        return rows if _has_length(text, begin[1], len(rows)) else None
    except (_NotPlain, TypeError, ValueError, SyntaxError):
        return None
