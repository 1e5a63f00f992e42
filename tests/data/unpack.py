#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the reference results as C.

usage: unpack.py FOLDER             FOLDER/reference_models.h and FOLDER/control_models.h, with all models
       unpack.py HEADER MODEL...    one header with these models, all of one kind

A program includes rbd.h and reference.h before. REFERENCE_MODELS, or CONTROL_MODELS, are pointers to the models, for
an initialiser. Python 3.8 without packages."""
import sys
from pathlib import Path

from packed import HERE, STRUCTURES, SUFFIX, root, unpack

WIDTH = 110


def number(x):
    """The shortest text that reads back as this double; -0 would be the whole number 0."""
    text = repr(x)
    return text[:-2] if text.endswith(".0") and text != "-0.0" else text


def value(x):
    if isinstance(x, str):
        return f'"{x}"'
    return "{" + ", ".join(map(value, x)) + "}" if isinstance(x, list) else number(x)


def lines(words):
    """The words in lines of the usual width."""
    out, line = [], ""
    for word in words:
        if line and len(line) + len(word) + 6 > WIDTH:
            out.append(line.rstrip())
            line = ""
        line += word + ", "
    return "    " + "\n    ".join([*out, line[:-2]])


def body(b, k):
    """The initialiser of one rbd_body."""
    groups = [f'{value(b["name"])}, {value(b["joint"])}, {b["parent"]}, {b["type"]}, /* body {k} */',
              f'{value(b["axis"])}, {value(b["axis2"])}, {number(b["pitch"])},',
              f'{value(b["position"])},',
              f'{value(b["rotation"])},',
              f'{number(b["mass"])}, {value(b["com"])},',
              f'{value(b["inertia"])},',
              f'{{{number(b["armature"])}}}, {{0}}, {{0}},',
              "0, 0, 0, 0,",  # limits: no result depends on them
              "NULL, 0, 0}"]
    return "{" + "\n     ".join(groups)


class Text:
    """The C of one model. An array that is there already is not written again."""

    def __init__(self, name):
        self.name, self.parts, self.known = name, [], {}

    def array(self, kind, name, values, expected):
        if len(values) != expected:
            raise ValueError(f"{name}: {len(values)} values instead of {expected}")
        key = (kind, *map(number, values))
        if key not in self.known:
            self.known[key] = name
            self.parts.append(f"static const {kind} {name}[{expected}] = {{\n{lines(key[1:])}}};\n")
        return self.known[key]

    def rows(self, kind, name, rows):
        self.parts.append(f"static const {kind} {name}[{len(rows)}] = {{\n    " + ",\n    ".join(rows) + "};\n")
        return name

    def pointed(self, member, name, x, sizes):
        """What a pointer leads to; its name."""
        if x is None:
            if not member.optional:
                raise ValueError(f"{name}: no {member.name}")
            return "NULL"
        if member.kind == "rbd_body":
            return self.rows("rbd_body", name, [body(b, k) for k, b in enumerate(x)])
        if isinstance(x, dict):
            self.parts.append(f"static const {member.kind} {name} = {self.record(member.kind, name, x, sizes)};\n")
            return "&" + name
        if member.kind in STRUCTURES:
            return self.rows(member.kind, name,
                             [self.record(member.kind, f"{name}{k}", row, sizes) for k, row in enumerate(x)])
        expected = 1
        for factor in member.shape:
            expected *= int(sizes.get(factor, factor))
        return self.array(member.kind, name, x, expected)

    def record(self, kind, name, record, sizes):
        """The initialiser of a structure; what it points to goes before it."""
        members = STRUCTURES[kind]
        unknown = set(record) - {member.name for member in members}
        if unknown:
            raise ValueError(f"{name}: not in reference.h: {', '.join(sorted(unknown))}")
        sizes = {**sizes, **record.get("model", {}), **record}
        words = []
        for member in members:
            x = record.get(member.name)
            if member.pointer and not isinstance(x, str):
                words.append(self.pointed(member, f"{name}_{member.name}", x, sizes))
            else:
                words.append(value(x))
        return "{" + lines(words).strip() + "}"


def c_model(name):
    """The definition of ref_NAME."""
    text, kind = Text(name), root(name)
    record = text.record(kind, f"ref_{name}", unpack(HERE / (name + SUFFIX)), {})
    text.parts.append(f"static const {kind} ref_{name} = {record};\n")
    return "".join(text.parts)


def header(names):
    kinds = {root(name): name for name in names}
    if len(kinds) != 1:
        raise ValueError("models of two kinds do not go into one header")
    macro = "REFERENCE_MODELS" if "ref_model" in kinds else "CONTROL_MODELS"
    pointers = ", ".join(f"&ref_{name}" for name in names)
    return ("/* Reference results, written by unpack.py. Include rbd.h and reference.h before. */\n\n"
            + "\n".join(map(c_model, names)) + f"\n#define {macro} {pointers}\n")


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    output, names = Path(sys.argv[1]), sys.argv[2:]
    if names:
        output.write_text(header(names), encoding="utf-8")
        return
    names = sorted(path.stem for path in HERE.glob("*" + SUFFIX))
    for prefix, kind in ("reference", "ref_model"), ("control", "ref_control"):
        text = header([name for name in names if root(name) == kind])
        (output / f"{prefix}_models.h").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
