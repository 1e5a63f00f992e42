#!/usr/bin/env python3
"""The rooms of src/: what each defines and uses, and whether the house is in order.

    rooms.py                 checks: a room includes what it uses and no more; no circle, no arrow up between storeys; a
                             storey uses of another one only what an Interface names; joint types and comments name
                             what is there; no function stands in two rooms (twice.py)
    rooms.py --mend          writes the #include lines of all rooms anew, from what they use
    rooms.py --interfaces    writes the Interface of each room anew: a decision, so read the difference
    rooms.py --draw          writes docs/rooms.svg

A storey is a folder of src/. What the rooms of other storeys may use of a room stands in a comment of its own, which
begins with "/* Interface:" and names each function, macro, type and constant; of the open storeys they may use all."""
import re
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "src"))
import amalgamate  # noqa: E402
import twice  # noqa: E402

STOREYS = ["api", "base", "qp", "algebra", "spatial", "model", "dynamics", "motion", "derivatives", "constraints", "contact", "ik", "estimate", "actuator", "tasks", "batch"]
OPEN = ["api", "base", "algebra"]
# Files outside of src/ that have something for each joint type.
OUTSIDE = ["tools/print.c", "tests/textbook.c", "tests/fuzz/robots.c", "tests/fuzz/world.c"]
OPAQUE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)
NAME = r"(?:rbdi?|RBDI?)_\w+"
INTERFACE = re.compile(r"/\* Interface:(.*?)\*/", re.S)


def statements(text):
    """The statements outside of braces, each up to its semicolon or brace; of an enum with what is in it."""
    text = re.sub(r'extern\s+" *"\s*\{', "", re.sub(r"^#(?:.*\\\n)*.*$", "", text, flags=re.M))
    depth, start, out = 0, 0, []
    for match in re.finditer(r"[{};]", text):
        at, mark = match.start(), match.group()
        if mark == "{":
            if depth == 0:
                out.append(text[start:at + 1])
                start = at
            depth += 1
        elif mark == "}":
            depth = max(depth - 1, 0)
            if depth == 0:
                if re.search(r"\benum\b[^;()]*\{$", out[-1] if out else ""):
                    out[-1] += text[start + 1:at + 1]
                start = at
        elif depth == 0:
            out.append(text[start:at + 1])
            start = at + 1
    return out


def named(lines, room):
    """The text of a room. Of a file that it includes more than once, each time with the names that macros give it:
    #define rbdi_x rbdi_y before, #undef rbdi_x after."""
    out, names = [], {}
    for line, (file, _) in lines:
        define, end = re.fullmatch(rf"#define ({NAME}) ({NAME})", line), re.fullmatch(rf"#undef ({NAME})", line)
        if file != room:
            line = re.sub(rf"\b{NAME}\b", lambda name: names.get(name[0], name[0]), line)
        elif define:
            names[define[1]] = define[2]
        elif end:
            names.pop(end[1], None)
        out.append(line)
    return "\n".join(out)


def definitions(text):
    """The macros, and the functions, types and constants that a text without comments defines or declares."""
    macros = set(re.findall(rf"^#define ({NAME})", text, re.M))
    found = set()
    for statement in statements(text):
        for pattern in (rf"\b(?:struct|union|enum)\s+({NAME})\s*\{{", rf"^\}}[^;]*?\b({NAME})\s*;",
                        rf"\btypedef\b[^;{{(]*\b({NAME})\s*(?:__attribute__.*|\[.*)?;",
                        rf"\btypedef\b[^;{{]*\(\s*\*?\s*({NAME})\s*\)?\s*\("):
            found |= set(re.findall(pattern, statement, re.S))
        enum = re.search(r"\benum\b[^;(){]*\{(.*)\}", statement, re.S)
        if enum:
            found |= set(re.findall(rf"(?:^|,)\s*({NAME})", re.sub(r"\([^()]*\)", "", enum[1])))
        function = re.search(rf"\b({NAME})\s*\(", statement)
        if function and "typedef" not in statement and "=" not in statement and statement.strip("};\n "):
            found.add(function[1])
    return macros, found


class Room:
    def __init__(self, name):
        self.name, self.storey = name, name.split("/")[0]
        self.includes, lines = amalgamate.read_room(name)
        text = named(lines, name)
        self.interface = set(re.findall(NAME, " ".join(INTERFACE.findall(text))))
        clean = OPAQUE.sub(lambda m: '" "' if m.group()[0] == '"' else " ", text)
        self.names = set(re.findall(rf"\b{NAME}\b", clean))
        self.macros, self.found = definitions(clean)
        self.structs = set(re.findall(rf"^struct ({NAME}) \{{", clean, re.M))  # typedef elsewhere


class House:
    """The rooms in reading order. owner: the first room that defines a name. uses: {room: {other: names}}."""

    def __init__(self):
        self.rooms, self.owner, renamed, structs = {}, {}, {}, {}
        for header in amalgamate.HEADERS:
            for name, _ in amalgamate.read_header(header):
                if name and not amalgamate.is_text(name) and name not in self.rooms:
                    self.rooms[name] = Room(name)
        for room in self.rooms.values():
            for name in sorted(room.macros):
                # a public function's name carries the scalar: #define rbd_x RBDI_SYMBOL(rbd_x)
                (renamed if name.startswith("rbd_") else self.owner).setdefault(name, room.name)
            structs.update((name, room.name) for name in room.structs)
            for name in sorted(room.found):
                self.owner.setdefault(name, room.name)
        order = list(self.rooms)
        self.uses = {}
        for room in self.rooms.values():
            uses = {}
            for name in room.names:
                owners = {self.owner.get(name)} if name not in room.macros else set()
                if name in room.found and order.index(renamed.get(name, order[-1])) < order.index(room.name):
                    owners.add(renamed[name])
                if room.storey != "api" and name in structs and order.index(structs[name]) < order.index(room.name):
                    owners.add(structs[name])
                for owner in owners - {None, room.name}:
                    uses.setdefault(owner, set()).add(name)
            self.uses[room.name] = {other: uses[other] for other in self.rooms if other in uses}

    def across(self):
        """{room: {internal name: a room of another storey that uses it}}, but of the open storeys."""
        used = {}
        for name, others in self.uses.items():
            for other, names in others.items():
                if self.rooms[other].storey not in (self.rooms[name].storey, *OPEN):
                    for internal in sorted(names):
                        if internal.startswith(("rbdi_", "RBDI_")):
                            used.setdefault(other, {}).setdefault(internal, name)
        return used

    def wanted(self):
        """What each room should include: what it uses, but what comes with another of these."""
        below, out = {}, {}
        for name in self.rooms:
            used = [other for other in self.uses[name] if other in below]  # in reading order
            below[name] = set(used).union(*(below[other] for other in used))
            out[name] = [other for other in used if not any(other in below[third] for third in used)]
        return out


def check(house):
    """The sentences of what is wrong."""
    order = list(house.rooms)
    files = {str(path.relative_to(amalgamate.SRC)) for path in amalgamate.SRC.glob("*/*.h")}
    for name in sorted(files - set(order)):
        if not amalgamate.is_text(name):
            yield f"src/{name} is in no header"
    wanted = house.wanted()
    for name, room in house.rooms.items():
        if room.storey not in STOREYS:
            yield f"src/{name}: {room.storey} is no storey"
            continue
        for other in room.includes:
            if other not in order or order.index(other) > order.index(name):
                yield f"src/{name} includes {other}, which does not stand before it"
        for other, names in house.uses[name].items():
            some = ", ".join(sorted(names)[:3])
            if order.index(other) > order.index(name):
                yield f"src/{name} uses {other} ({some}), which stands behind it"
            if STOREYS.index(house.rooms[other].storey) > STOREYS.index(room.storey):
                yield f"src/{name} uses {other} ({some}), which is in a higher storey"
        if room.includes != wanted[name]:
            yield f"src/{name} should include {' '.join(wanted[name]) or 'nothing'}, in this order (rooms.py --mend)"
    used = house.across()
    for name, room in house.rooms.items():
        for internal, user in sorted(used.get(name, {}).items()):
            if internal not in room.interface:
                yield f"src/{user} uses {internal}, which the interface of src/{name} does not name"
        for internal in sorted(room.interface - set(used.get(name, {}))):
            yield f"src/{name}: its interface names {internal}, which no other storey uses"


def joint_types(house):
    """What is wrong with the list of the places where joint types differ, and with what has a row for each."""
    place = "model/joint_types.h"
    text = (amalgamate.SRC / place).read_text(encoding="utf-8")
    types = (amalgamate.SRC / "api/types.h").read_text(encoding="utf-8")
    types = set(re.findall(r"^    (RBD_[A-Z_]+),? ", re.search(r"enum rbd_joint_type \{(.*?)\}", types, re.S)[1], re.M))
    for name, room in house.rooms.items():
        if room.storey != "api" and name != place and (room.names & types) - {"RBD_JOINT_TYPES"} and name not in text:
            yield f"src/{name} asks for a joint type: the list at the top of src/{place} must name it"
    for file in OUTSIDE:
        for missing in sorted(types - {"RBD_JOINT_TYPES"} - set(re.findall(r"RBD_[A-Z_]+", (ROOT / file).read_text(encoding="utf-8")))):
            yield f"{file} does not name {missing}"


def names_in_comments(house):
    """Comments that speak of a function which is not there: after a renaming."""
    texts = {name: (amalgamate.SRC / name).read_text(encoding="utf-8") for name in house.rooms}
    there = set()
    for text in texts.values():
        there.update(re.findall(r"\brbdi_\w+", re.sub(r"/\*.*?\*/", "", text, flags=re.S)))
    for name, text in texts.items():
        for comment in re.findall(r"/\*.*?\*/", text, re.S):
            for gone in sorted(set(re.findall(r"\brbdi_\w+", comment)) - there):
                yield f"a comment of src/{name} speaks of {gone}, which is not there"


def mend(house):
    for name, includes in house.wanted().items():
        path = amalgamate.SRC / name
        lines = path.read_text(encoding="utf-8").split("\n")
        old = 2 + len(house.rooms[name].includes)
        path.write_text("\n".join([*lines[:2], *(f'#include "{other}"' for other in includes), *lines[old:]]),
                        encoding="utf-8")


def picture(house):
    """The storeys, the lowest below, as SVG. In a storey rooms stand in reading order, so that each uses those to its
    left. A line leads to a room of a lower storey that is included; of api, which all include, there are none."""
    wide, high, gap, left, row = 112, 26, 14, 110, 7
    place, bands, y = {}, [], 10
    for storey in reversed(STOREYS):
        rooms = [room for room in house.rooms.values() if room.storey == storey]
        lines = -(-len(rooms) // row)
        for k, room in enumerate(rooms):
            shift = (row - min(row, len(rooms) - k // row * row)) * (wide + gap) / 2
            place[room.name] = (left + shift + k % row * (wide + gap), y + 12 + k // row * (high + 12))
        height = lines * (high + 12) + 12
        bands.append((storey, y, height))
        y += height + 26
    width = left + row * (wide + gap)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {y}" font-family="sans-serif" font-size="13">',
           "<!-- Made by tests/adequacy/rooms.py from the includes of src/. -->",
           f'<rect width="{width}" height="{y}" fill="#ffffff"/>']
    for storey, top, height in bands:
        out.append(f'<rect x="4" y="{top}" width="{width - 8}" height="{height}" rx="6" fill="#eef2f7"/>')
        out.append(f'<text x="14" y="{top + height / 2 + 4:.0f}" font-weight="bold">{storey}</text>')
    for room in house.rooms.values():
        for other in room.includes:
            if other.split("/")[0] not in (room.storey, "api"):
                (x1, y1), (x2, y2) = place[room.name], place[other]
                x1, y1, x2 = x1 + wide / 2, y1 + high, x2 + wide / 2
                bend = max(20, (y2 - y1) / 2)
                out.append(f'<path d="M{x1:.0f} {y1} C{x1:.0f} {y1 + bend:.0f} {x2:.0f} {y2 - bend:.0f} {x2:.0f} {y2}" '
                           'fill="none" stroke="#3465a4" stroke-opacity="0.45"/>')
    for name, (x, top) in place.items():
        label = name.split("/")[1][:-2].replace("_", " ")
        out.append(f'<rect x="{x:.0f}" y="{top}" width="{wide}" height="{high}" rx="4" fill="#ffffff" stroke="#8899aa"/>')
        small = ' font-size="10"' if len(label) > 15 else ""
        out.append(f'<text x="{x + wide / 2:.0f}" y="{top + 17}" text-anchor="middle"{small}>{label}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


def interfaces(house):
    used = house.across()
    for name in house.rooms:
        path = amalgamate.SRC / name
        text = re.sub(INTERFACE.pattern + "\n+", "", path.read_text(encoding="utf-8"), flags=re.S)
        if name in used:
            comment = textwrap.fill("/* Interface: " + ", ".join(sorted(used[name], key=lambda n: (n.isupper(), n))) + " */", 110,
                                    subsequent_indent="   ", break_on_hyphens=False)
            head = text.index("\n\n") + 1
            text = text[:head] + "\n" + comment + "\n" + text[head:]
        path.write_text(re.sub(r"\n{3,}", "\n\n", text), encoding="utf-8")


def main(arguments):
    house = House()
    if arguments == ["--interfaces"]:
        interfaces(house)
        return 0
    if arguments == ["--mend"]:
        mend(house)
        return 0
    drawn = ROOT / "docs" / "rooms.svg"
    if arguments == ["--draw"]:
        drawn.write_text(picture(house), encoding="utf-8")
        return 0
    if arguments:
        raise SystemExit(__doc__)
    wrong = [*check(house), *joint_types(house), *names_in_comments(house), *twice.findings(twice.rooms())]
    if not drawn.exists() or drawn.read_text(encoding="utf-8") != picture(house):
        wrong.append("docs/rooms.svg is another house: python3 tests/adequacy/rooms.py --draw")
    print("\n".join(wrong) if wrong else f"{len(house.rooms)} rooms in {len(STOREYS)} storeys")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
