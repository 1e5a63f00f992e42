#!/usr/bin/env python3
"""The programs of tests that ./run quick builds and runs, one a line, each with the suites that it runs:

    suites.py SUITE...   these suites; all: every one
    suites.py            those of the rooms and tests that changed since the last commit; if none did, every one
    suites.py --map      a table: each room and its suites

The suites of a room follow from names. A room src/STOREY/NAME.h has the first of these that exists:

1. the suite STOREY_NAME, or NAME if that names no other storey and no other room;
2. the suites of its storey, STOREY and STOREY_...;
3. the suites that call its public functions, at most three, of those that call them most;
4. the suites of STOREYS below;
5. all.

src/api/symbols.h alone has none: ./run rooms --mend adds a line there for each new call, whose room and test say which
suites to run."""
import difflib
import functools
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TESTS = "tests/tests"
# Suites with a program of their own, in double.
PROGRAMS = {"batch": "tests/batch_double__2_lanes", "sincos": "tests/sincos_double", "spatial": "tests/spatial_double",
            "qp": "tests/qp_double"}
# Suites for rooms that no name says one of.
STOREYS = {"model": ["build", "joints", "work"], "dynamics": ["rnea", "crba", "aba", "cholesky", "singular"],
           "motion": ["kinematics", "points"]}
FAMILIES = ["derivatives", "constraints", "contact", "ik", "actuator", "batch", "spatial", "qp"]  # storeys with suites of their own


def all_suites():
    return re.findall(r"\bx\((\w+)\)", (ROOT / "tests/suites.h").read_text()) + list(PROGRAMS)


def rooms():
    """The names of all rooms, STOREY/NAME.h."""
    return sorted(str(path.relative_to(ROOT / "src")) for path in (ROOT / "src").glob("*/*.h"))


@functools.lru_cache(None)
def text_of(suite):
    return (ROOT / f"tests/test_{suite}.c").read_text()


def calling(room, suites):
    """The suites that call the public functions of a room most."""
    functions = re.findall(r"^RBDI_(?:BATCH_)?API[^;{(]*?\b(rbd_\w+)\(", (ROOT / "src" / room).read_text(), re.M)
    counts = {}
    for suite in suites if functions else []:
        counts[suite] = len(re.findall(rf"\b(?:{'|'.join(functions)})\(", text_of(suite)))
    most = sorted((s for s in counts if counts[s]), key=lambda s: -counts[s])[:3]
    return [s for s in suites if s in most]


def suites_of(room, suites):
    """The suites of a room, as the text above says."""
    if room == "api/symbols.h":
        return []
    storey, name = re.fullmatch(r"(\w+)/(\w+)\.h", room).groups()
    others = [other for other in rooms() if other.endswith(f"/{name}.h") and not other.startswith(("api/", storey + "/"))]
    if f"{storey}_{name}" in suites:
        return [f"{storey}_{name}"]
    if name in suites and (storey == "api" or name not in FAMILIES) and not (others and storey in FAMILIES):
        return [name]
    family = [s for s in suites if s == storey or s.startswith(storey + "_")]
    return family or calling(room, suites) or STOREYS.get(storey) or suites


def changed_files():
    """Files that differ from the last commit, and new ones."""
    found = []
    for command in (["diff", "--name-only", "--diff-filter=d", "HEAD"], ["ls-files", "--others", "--exclude-standard"]):
        result = subprocess.run(["git", *command], cwd=ROOT, capture_output=True, text=True)
        if result.returncode:
            sys.exit("run: git does not say what changed: name suites")
        found += result.stdout.splitlines()
    return found


def suites_of_changes(files, suites):
    """The suites of changed files; all, if what they share changed."""
    found = set()
    for file in files:
        room, test = re.fullmatch(r"src/(\w+/\w+\.h)", file), re.fullmatch(r"tests/test_(\w+)\.c", file)
        if room:
            found.update(suites_of(room[1], suites))
        elif test and test[1] in suites:
            found.add(test[1])
        elif re.fullmatch(r"tests/(tests\.c|suites\.h|(support|textbook|reference|control)\.[ch])", file):
            found.update(suites)
    return [s for s in suites if s in found]


def check_names(names, suites):
    """Ends with a hint if there is no such suite."""
    for name in names:
        if name not in suites:
            near = difflib.get_close_matches(name, suites, 1, 0.5)
            hint = f"; did you mean '{near[0]}'?" if near else "."
            sys.exit(f"run: no suite is called '{name}'{hint} They are: {' '.join(suites)}")


def main(arguments):
    suites = all_suites()
    if arguments == ["--map"]:
        for room in rooms():
            of = suites_of(room, suites)
            print(f"src/{room:<32}{'all' if of == suites else ' '.join(of) or 'none'}")
        return
    wanted = suites if arguments == ["all"] else arguments
    check_names(wanted, suites)
    wanted = wanted or suites_of_changes(changed_files(), suites)
    if not wanted:
        print("run: nothing in src/ or tests/ has changed since the last commit: every suite, without its slow tests. They are: "
              + " ".join(suites), file=sys.stderr)
        wanted = suites
    inside = [s for s in suites if s in wanted and s not in PROGRAMS]
    if inside:
        print(TESTS, *inside)
    for name in PROGRAMS:
        if name in wanted:
            print(PROGRAMS[name])


if __name__ == "__main__":
    main(sys.argv[1:])
