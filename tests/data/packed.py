# SPDX-License-Identifier: MIT
"""The reference results as they are kept: a file NAME.bin for each model.

A file is compressed by zlib. It holds a line of JSON, then numbers.
The line is the model as reference.h lays it out: an object for each structure, its members by their names. Instead
of an array of doubles the line has how many they are; they follow in this order as the numbers.
Each different number is kept once, as the 8 bytes of a double, in the order in which they appear first:
first the lowest byte of all, then the next, since alike bytes compress where they are neighbours.
Then comes a code of 4 bytes for each number: NEW is the next of the different ones, ZERO is 0, and any other is one
that was there before: see _steps."""
import array
import json
import re
import struct
import sys
import zlib
from pathlib import Path

HERE = Path(__file__).resolve().parent
NEW, ZERO, BEFORE = 0, 1, 2
SUFFIX = ".bin"


class Member:
    """A member of a structure of reference.h, such as `const double *M; /* nv x nv: mass matrix */`."""

    def __init__(self, kind, pointer, name, count, comment):
        self.kind, self.pointer, self.name = kind, bool(pointer), name
        self.count = int(count or 0)  # of an array within the structure
        self.shape = re.match("[^:;]*", comment)[0].split(" x ")  # of what a pointer leads to
        self.optional = "NULL" in comment


def structures():
    """The structures of reference.h: lists of members."""
    text = (HERE / "reference.h").read_text(encoding="utf-8")
    found = {}
    for name, body in re.findall(r"typedef struct (\w+) \{\n(.*?)\n\} \1;", text, re.S):
        found[name] = []
        for kind, declared, comment in re.findall(r"^    (?:const )?(\w+) (.*?);(?: +/\* (.*?) \*/)?$", body, re.M):
            for star, member, count in re.findall(r"(\*?)(\w+)(?:\[(\d+)\])?", declared):
                found[name].append(Member(kind, star, member, count, comment))
    return found


STRUCTURES = structures()


def root(name):
    """The structure that a file of this name holds."""
    return "ref_control" if name.startswith("control_") else "ref_model"


def replaced(kind, record, replace):
    """The record, a structure of this kind as a dict, with what `replace` gives in place of each array of doubles."""
    out = {}
    members = {member.name: member for member in STRUCTURES.get(kind, [])}  # rbd_body has none: it stays as it is
    for key, value in record.items():
        member = members.get(key)
        if member is None or value is None or not (member.pointer or member.count):
            out[key] = value
        elif member.kind == "double":
            out[key] = replace(value)
        elif isinstance(value, dict):
            out[key] = replaced(member.kind, value, replace)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            out[key] = [replaced(member.kind, row, replace) for row in value]
        else:
            out[key] = value
    return out


def _split(data, size):
    """The first bytes of all words of this size, then the second ones, ..."""
    return b"".join(data[k::size] for k in range(size))


def _joined(data, size):
    out, count = bytearray(len(data)), len(data) // size
    for k in range(size):
        out[k::size] = data[k * count:(k + 1) * count]
    return bytes(out)


def _words(letter, data):
    """An array of little-endian words."""
    words = array.array(letter, data)
    if sys.byteorder == "big":
        words.byteswap()
    return words


def _bits(numbers):
    return struct.unpack(f"<{len(numbers)}Q", struct.pack(f"<{len(numbers)}d", *numbers))


def _codes(bits):
    """The different numbers, and a code for each number. One that was there before is coded by the step to its place
    from that after the number repeated last: 0, -1, 1, -2, ... as BEFORE, BEFORE + 1, ... Copied rows have steps of 0."""
    different, codes, next_place = {}, [], 0
    for number in bits:
        if number == 0:
            codes.append(ZERO)
        elif number not in different:
            different[number] = len(different)
            codes.append(NEW)
        else:
            step = different[number] - next_place
            codes.append(BEFORE + (2 * step if step >= 0 else -2 * step - 1))
            next_place = different[number] + 1
    return list(different), codes


def _numbers(different, codes):
    """The inverse of _codes, of doubles."""
    numbers, fresh, next_place = [], iter(different), 0
    for code in codes:
        if code == NEW:
            numbers.append(next(fresh))
        elif code == ZERO:
            numbers.append(0.0)
        else:
            code -= BEFORE
            place = next_place + (-(code + 1) // 2 if code % 2 else code // 2)
            numbers.append(different[place])
            next_place = place + 1
    return numbers


def pack(kind, record):
    """The bytes of a file."""
    numbers = []

    def take(values):
        numbers.extend(values)
        return len(values)

    line = json.dumps(replaced(kind, record, take), separators=(",", ":"))
    different, codes = _codes(_bits(numbers))
    counts = f"{len(different)} {len(codes)}\n"
    words = struct.pack(f"<{len(different)}Q", *different), struct.pack(f"<{len(codes)}I", *codes)
    return zlib.compress(counts.encode() + line.encode() + b"\n" + _split(words[0], 8) + _split(words[1], 4), 9)


def unpack(path):
    """The record of a file."""
    counts, line, data = zlib.decompress(path.read_bytes()).split(b"\n", 2)
    different, codes = map(int, counts.split())
    if len(data) != 8 * different + 4 * codes:
        raise ValueError(f"{path}: {len(data)} bytes of numbers instead of {8 * different + 4 * codes}")
    numbers = iter(_numbers(_words("d", _joined(data[:8 * different], 8)),
                            _words("I", _joined(data[8 * different:], 4))))
    record = replaced(root(path.stem), json.loads(line), lambda count: [next(numbers) for _ in range(count)])
    if next(numbers, None) is not None:
        raise ValueError(f"{path}: more numbers than the model has")
    return record
