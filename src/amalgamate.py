#!/usr/bin/env python3
"""Makes the shipped headers of the top folder from src/.

src/rbd.h and the like hold the manual, the contents and the rooms in reading order, as lines #include "FOLDER/NAME.h".
A room is a file

    #ifndef RBDI_FOLDER_NAME_H
    #define RBDI_FOLDER_NAME_H
    #include "FOLDER/OTHER.h"        the rooms that it stands on

    text

    #endif

or, without a guard, text alone, which is put wherever it is named, also within a room. In the shipped header the text
stands in place of the #include, that of a room under a line that names the file. Of the letters whose macros are set
aside it has only those that it uses. A room keeps its guard if a header that stands alone has it too.

The lines #define rbd_x RBDI_SYMBOL(rbd_x), which put the scalar into the symbols, follow from the declarations of src/api:
--write makes them first.

usage: amalgamate.py --write | --check        writes the shipped headers, or fails if they differ
"""
import re
import sys
from pathlib import Path

SRC = Path(__file__).resolve().parent
HEADERS = (SRC / "headers.txt").read_text().split()  # those that are shipped, the only list of them
ALONE = ["rbd_qp.h"]  # without rbd.h, though a file may have both, in any order
INCLUDE = re.compile(r'#include "(\w+/\w+\.h)"')
LETTER = re.compile(r'#(?:pragma (?:push|pop)_macro\("(\w)"\)|undef (\w))')
SYMBOL = re.compile(r"#define rbd_\w+ (RBDI_SYMBOL|RBDI_OF_SCALAR)\(rbd_\w+\)")
DECLARED = re.compile(r"^RBDI_(?:BATCH_)?API\b[^;({]*?\b(rbd_\w+)\(", re.M)
NO_SCALAR = ["rbd_status_string", "rbd_finding_text"]  # one function for all scalars
MADE = "   Made by src/amalgamate.py from src/{} and the files that it includes: edit those."


def marker(path):
    return f"/* ==== src/{path} ==== */"


def guard(room):
    return "RBDI_" + re.sub(r"\W", "_", room).upper()


def read_lines(name, src=SRC):
    """The lines of a file of src/, each with its place: the file's name and the line's number."""
    text = (src / name).read_text(encoding="utf-8").rstrip("\n")
    return [(line, (name, number)) for number, line in enumerate(text.split("\n"), 1)]


def is_text(name, src=SRC):
    """Whether a file has no guard: it is text for those that name it."""
    return not read_lines(name, src)[0][0].startswith("#ifndef RBDI_")


def trim(lines):
    """Without empty lines at both ends."""
    while lines and not lines[0][0]:
        lines = lines[1:]
    while lines and not lines[-1][0]:
        lines = lines[:-1]
    return lines


def read_room(room, src=SRC):
    """The rooms that a room includes, and its lines with their places."""
    placed = read_lines(room, src)
    if is_text(room, src):
        return [], trim(placed)
    lines = [line for line, _ in placed]
    if lines[:2] != [f"#ifndef {guard(room)}", f"#define {guard(room)}"] or lines[-1] != "#endif":
        raise SystemExit(f"src/{room}: its guard must be {guard(room)}, in the first two lines and the last")
    placed, includes, out = placed[2:-1], [], []
    while placed and INCLUDE.fullmatch(placed[0][0]):
        includes.append(INCLUDE.fullmatch(placed.pop(0)[0])[1])
    for line, place in placed:
        other = INCLUDE.fullmatch(line)
        if other and not is_text(other[1], src):
            raise SystemExit(f"src/{room}: its #include lines must stand together, behind the guard")
        out += read_room(other[1], src)[1] if other else [(line, place)]
    return includes, trim(out)


def named_in(header, src=SRC):
    """The rooms that a header names."""
    return INCLUDE.findall((src / header).read_text(encoding="utf-8"))


def shared(src=SRC):
    """The rooms with a guard that a header which stands alone has, and another one too."""
    out = set()
    for alone in (header for header in ALONE if (src / header).exists()):
        others = {room for header in HEADERS if header != alone and (src / header).exists() for room in named_in(header, src)}
        out |= {room for room in named_in(alone, src) if room in others and not is_text(room, src)}
    return out


def read_header(header, src=SRC):
    """A header of src/ in pieces: (None, its own lines) or (room, the room's lines), in order, with their places."""
    pieces, own, guarded = [], [], shared(src)
    for line, place in read_lines(header, src):
        room = INCLUDE.fullmatch(line)
        if not room:
            own.append((line, place))
            continue
        if trim(own):
            pieces.append((None, trim(own)))
        own = []
        text = read_room(room[1], src)[1]
        if room[1] in guarded:
            begin, end = (room[1], 1), text[-1][1]
            text = [(f"#ifndef {guard(room[1])}", begin), (f"#define {guard(room[1])}", begin), *text, ("#endif", end)]
        pieces.append((room[1], text))
    return pieces + [(None, trim(own))] if trim(own) else pieces


def symbols(header, src=SRC):
    """{room: its text with the symbols that it should have}, of the rooms of a header that have symbols: those of what it
    declares, and of what the rooms behind it do up to the next one with symbols."""
    texts, names, last = {}, {}, None
    for room, _ in read_header(header, src):
        if not room or not room.startswith("api/"):
            continue
        text = (src / room).read_text(encoding="utf-8")
        if any(SYMBOL.fullmatch(line) for line in text.split("\n")):
            last, texts[room], names[room] = room, text, []
        declared = DECLARED.findall(re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL))
        declared = [name for name in declared if name not in NO_SCALAR]
        if last:
            names[last] += [name for name in declared if name not in names[last]]
        elif declared and header not in ALONE:
            sys.exit(f"src/{room}: {declared[0]} has no symbol of its scalar: begin the room with the line\n"
                     f"#define {declared[0]} RBDI_SYMBOL({declared[0]})")
    return {room: with_symbols(text, names[room]) for room, text in texts.items()}


def with_symbols(text, names):
    """The text of a room whose symbols are of these names."""
    lines = text.split("\n")
    at = [i for i, line in enumerate(lines) if SYMBOL.fullmatch(line)]
    macro = SYMBOL.fullmatch(lines[at[0]])[1]
    lines[at[0]:at[-1] + 1] = [f"#define {name} {macro}({name})" for name in names]
    return "\n".join(lines)


def letters_of(pieces):
    """The single letters that the code of these pieces uses as names."""
    code = "\n".join(line for _, text in pieces for line, _ in text if not LETTER.fullmatch(line))
    return set(re.findall(r"\b[A-Z]\b", re.sub(r"/\*.*?\*/", "", code, flags=re.DOTALL)))


def lines_of(header, src=SRC):
    """The lines of a shipped header, each with the file of src/ and the line there that it is from, or None."""
    pieces = read_header(header, src)
    letters = letters_of(pieces)
    for number, (room, text) in enumerate(pieces):
        if number == 0:
            yield text[0]
            yield MADE.format(header), None
            yield from text[1:]
            continue
        yield "", None
        yield marker(room or header), None
        for line, place in text:
            letter = LETTER.fullmatch(line)
            if not letter or (letter[1] or letter[2]) in letters:
                yield line, place


def shipped(header, src=SRC):
    """The text of a shipped header."""
    lines = [line for line, _ in lines_of(header, src)]
    if any(line.startswith("<<<<<<< ") for line in lines):
        raise SystemExit(f"src/{header} or a file that it includes has a conflict of git's")
    return "\n".join(lines) + "\n"


def places(header, src=SRC):
    """places(header)[n]: the file of src/ and the line there that line n of the shipped header is from."""
    out = [(header, 1)]
    for _, place in lines_of(header, src):
        out.append(place or out[-1])
    return out


def main(arguments):
    if arguments not in (["--write"], ["--check"]):
        raise SystemExit(__doc__)
    status = 0
    for room, text in [pair for header in HEADERS for pair in symbols(header).items()]:
        if (SRC / room).read_text(encoding="utf-8") == text:
            continue
        if arguments == ["--write"]:
            (SRC / room).write_text(text, encoding="utf-8")
            continue
        print(f"src/{room} has not the symbols of what src/api declares: python3 src/amalgamate.py --write")
        status = 1
    for header in HEADERS:
        path, text = SRC.parent / header, shipped(header)
        if path.exists() and path.read_text(encoding="utf-8") == text:
            continue
        if arguments == ["--write"]:
            path.write_text(text, encoding="utf-8")
            continue
        print(f"{header} is not what src/ makes: python3 src/amalgamate.py --write")
        status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
