#!/usr/bin/env python3
"""Mutation test: small faults are put into a header's implementation, one at a time, and the tests must see each.

What no test sees is either a test that is missing or a change that alters no result; those stand in
equivalent.txt with a reason. The mutants are those with the smallest hashes of seed, function and text: the same
ones however the file is ordered. Results are kept in the folder, so that a run that was stopped goes on."""
import argparse
import concurrent.futures
import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from source import Exceptions, HEADERS, ROOT, Source, amalgamate, squeeze

HERE = Path(__file__).resolve().parent
TESTS = ROOT / "tests"
FIELDS = ["function", "text", "mutated"]
ABORT = ["-Wl,--wrap=_ck_assert_failed"]  # the first failure ends the program: see stop.c
COUNT = {"rbd.h": 300, "rbd_derivatives.h": 100, "rbd_constraints.h": 100, "rbd_contact.h": 100, "rbd_ik.h": 60, "rbd_estimate.h": 60, "rbd_actuator.h": 60, "rbd_batch.h": 50, "rbd_spatial.h": 50,
         "rbd_qp.h": 50, "rbd_tasks.h": 60}  # that compile

# ---- mutants ----

# Binary operators stand between spaces; what else looks like one does not.
BINARY = {
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["/"],
    "<": ["<=", ">"], "<=": ["<"], ">": [">=", "<"], ">=": [">"], "==": ["!="], "!=": ["=="],
    "&&": ["||"], "||": ["&&"], "&": ["|"], "|": ["&"], "^": ["|"], ">>": ["<<"], "<<": [">>"],
    "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="], "|=": ["&="],
}
BINARY_AT = re.compile("(?<= )(" + "|".join(map(re.escape, sorted(BINARY, key=len, reverse=True))) + ")(?= )")
MEMBERS = [("x", "y", "z"), ("xx", "yy", "zz"), ("xy", "xz", "yz"), ("yx", "zx", "zy"), ("w", "v"), ("n", "f"),
           ("iq", "iv"), ("nq", "nv"), ("ca", "sa"), ("cb", "sb"), ("cg", "sg"), ("rho", "kappa"), ("c", "s"),
           ("I", "M"), ("lower", "upper"), ("B", "C"), ("half_sine", "half_cosine"),
           ("first", "end"), ("row", "column"), ("source_q", "source_v"), ("nv", "nmimic"), ("nb", "nv"),
           ("link", "iv"), ("size", "cursor"), ("mass", "moment")]


@dataclass(frozen=True)
class Mutant:
    function: str
    text: str     # the line, or lines, without indentation
    mutated: str
    line: int
    start: int    # in the line
    stop: int
    new: str
    rank: str = ""

    @property
    def key(self):
        return (self.function, self.text, self.mutated)


def operators(code):
    for match in BINARY_AT.finditer(code):
        for new in BINARY[match.group()]:
            yield match.start(), match.end(), new


def unaries(code):
    for match in re.finditer(r"(?<=[(,= \[])[-!~](?=[\w(*])", code):
        yield match.start(), match.end(), ""
    for match in re.finditer(r"\+\+|--", code):
        yield match.start(), match.end(), "--" if match.group() == "++" else "++"


def members(code):
    for match in re.finditer(r"(?<=[\w\])])(\.|->)(\w+)\b(?!\()", code):
        for group in MEMBERS:
            if match.group(2) in group:
                new = group[(group.index(match.group(2)) + 1) % len(group)]
                yield match.start(2), match.end(2), new


def indices(code):
    """The index before or after; of an array that is declared one element less."""
    declared = re.match(r"\s*(?:const |static )*(?:rbdi?_\w+|int|double|unsigned char) \*?\w+(\[[^\]]*\])*[,; ]", code)
    for match in re.finditer(r"(?<=[\w\]])\[([^\[\]]+)\]", code):
        inner = match.group(1)
        if inner.isdigit():
            yield match.start(1), match.end(1), str(int(inner) - 1 if int(inner) > 0 else 1)
        else:
            yield match.start(1), match.end(1), inner + (" - 1" if declared and " = " not in code else " + 1")


def constants(code):
    number = r"(?<![\w.\]\[])(\d+\.\d*(?:e-?\d+)?f?|\d+e-?\d+f?|0x[0-9a-f]+|\d+)(u?)(?![\w.\]])"
    for match in re.finditer(number, code):
        text = match.group(1)
        if re.fullmatch(r"\d+|0x[0-9a-f]+", text):
            value = int(text, 0)
            yield match.start(1), match.end(1), str(value + 1)
            if value > 0:
                yield match.start(1), match.end(1), str(value - 1)
        else:
            yield match.start(1), match.end(1), f"2 * {text}"


def terms(code):
    """An operator + or - with the term behind it dropped; of a product the last factor."""
    for match in re.finditer(r" ([-+*]|&&|\|\|) ", code):
        ends = {"*": " [-+*/<>=?:|&]", "-": " [-+<>=?:|&]", "+": " [-+<>=?:|&]",
                "&&": r" (&&|\|\|)|\?|:", "||": r" \|\||\?|:"}[match.group(1)]
        depth, k = 0, match.end()
        while k < len(code):
            if depth == 0 and (code[k] in ",;" or re.match(ends, code[k:])):
                break
            depth += (code[k] in "([") - (code[k] in ")]")
            if depth < 0:
                break
            k += 1
        if depth <= 0 and k < len(code):
            yield match.start(), k, ""


def statements(code):
    """Assignments and calls dropped, conditions turned, jumps."""
    match = re.match(r"(\s*(?:if \(.*\) |else |for \(.*\) )?)"
                     r"(\*?[\w.>\[\]()*-]+ [-+*/|]?= [^;]*|\w+\([^;]*\)|\+\+\w[^;]*);", code)
    if match and not re.match(r"\s*(return|const|static|int|rbd\w* |for|if|else)\b", match.group(2)):
        yield match.start(2), match.end(2), ""
    for match in re.finditer(r"\bif \(", code):
        depth, k = 1, match.end()
        while k < len(code) and depth:
            depth += (code[k] == "(") - (code[k] == ")")
            k += 1
        if depth == 0:
            yield match.end(), k - 1, "!(" + code[match.end():k - 1] + ")"
    for match in re.finditer(r"\b(continue|break);", code):
        yield match.start(1), match.end(1), "break" if match.group(1) == "continue" else "continue"
    for match in re.finditer(r"\breturn ([^;]+);", code):
        value = match.group(1)
        new = {"RBD_OK": "RBD_ERR_NULL", "-1": "0", "0": "1", "1": "0", "NULL": None}.get(
            value, "RBD_OK" if value.startswith("RBD_ERR") else None)
        if new is not None:
            yield match.start(1), match.end(1), new
    for match in re.finditer(r"\*(model|work|batch|report|dof)(?= = )", code):
        yield match.start(), code.index(";", match.start()), "(void)0"


def arguments(code):
    """The first two arguments of a call swapped, and the last two."""
    for match in re.finditer(r"\b(?!if\b|for\b|while\b|switch\b|sizeof\b)\w+\((?=[^)])", code):
        depth, k, cuts = 1, match.end(), [match.end() - 1]
        while k < len(code) and depth:
            depth += (code[k] in "([") - (code[k] in ")]")
            if depth == 1 and code[k] == "," or depth == 0:
                cuts.append(k)
            k += 1
        if depth or len(cuts) < 3:
            continue
        parts = [code[a + 1:b].strip() for a, b in zip(cuts, cuts[1:])]
        for i in {0, len(parts) - 2}:
            if parts[i] != parts[i + 1]:
                swapped = parts[:i] + [parts[i + 1], parts[i]] + parts[i + 2:]
                yield match.end(), cuts[-1], ", ".join(swapped)


def bounds(code):
    """A loop one short and one too far."""
    match = re.search(r"\bfor \([^;]*;[^;]*?\b\w+ (?:<|<=|>|>=) ([^;]+?);", code)
    if match:
        yield match.end(1), match.end(1), " - 1"
        yield match.end(1), match.end(1), " + 1"


KINDS = [operators, unaries, members, indices, constants, terms, statements, arguments, bounds]


def is_of_its_own(source, line):
    """Whether a line is in a room that no other header has: rooms that rbd_qp.h shares with rbd.h are tried there."""
    return source.name not in amalgamate.ALONE or source.places[line][0] not in amalgamate.shared()


def enumerate_mutants(source, seed):
    """All of them, in the order of their hashes. Two that read the same count once."""
    found = {}
    for n, code in enumerate(source.code):
        if not code.strip() or re.match(r"\s*(typedef|case \w+:\s*$)", code) or not is_of_its_own(source, n):
            continue
        line = source.lines[n]
        for kind in KINDS:
            for start, stop, new in kind(code):
                if "  " in code[start:stop].strip() and '"' in line[start:stop]:
                    new = new if not new else None  # a literal was blanked: only dropping keeps it whole
                if new is None:
                    continue
                mutated = line[:start] + new + line[stop:]
                key = (source.function[n], squeeze(line), squeeze(mutated))
                if key[1] == key[2] or key in found:
                    continue
                rank = hashlib.sha256("\0".join([str(seed), *key]).encode()).hexdigest()
                found[key] = Mutant(*key, n, start, stop, new, rank)
    return sorted(found.values(), key=lambda m: m.rank)


def mutate(source, m):
    lines = list(source.lines[1:])
    line = lines[m.line - 1]
    lines[m.line - 1] = line[:m.start] + m.new + line[m.stop:]
    return "\n".join(lines)


# ---- the programs that must see them ----

# A type that does not fit is no fault that a test must see: the compiler does.
WARN_NOT = ["-Wno-psabi", "-Wno-attributes", "-Werror=incompatible-pointer-types", "-Werror=int-conversion",
            "-Werror=implicit-function-declaration"]
APART = "-Dalways_inline=unused"  # compiles in a fraction of the time
SANITIZE = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O1", APART)
BATCHED = "rbd.h|rbd_derivatives.h|rbd_constraints.h|rbd_batch.h"
# tcc 0.9.27 returns the struct of rbd_contact_last, a real and two ints, in other registers than GCC reads.
NOT_BY_TCC = ("contact_step", "contact_energy", "contact_derivatives")
BATCHES = "batch|gather|scatter|transpose|exchange|task|lanes|_output|note_singular"


@dataclass(frozen=True)
class Stage:
    """A test program: what of it has the implementation, and is compiled for each mutant, and what has not."""
    name: str
    units: tuple        # (source, flags) compiled with the mutant
    rest: tuple = ()    # (source, flags) compiled once
    libraries: tuple = ()
    compiler: str = "gcc"
    link: tuple = ()
    environment: tuple = ()
    run: tuple = ()     # what runs the program
    arguments: tuple = ()
    parts: tuple = ("",) # Check's suites that are run one by one, the quickest first
    functions: str = "" # which functions' mutants it can see and the stages before it cannot; all
    headers: str = "rbd.h|rbd_derivatives.h|rbd_constraints.h|rbd_contact.h|rbd_ik.h|rbd_estimate.h|rbd_actuator.h|rbd_tasks.h" # and which headers'


def suite_sources():
    names = re.search(r"test_sources = files\((.*?)\)", (TESTS / "meson.build").read_text(), re.S).group(1)
    return [*re.findall(r"'([^']+)'", names), "textbook.c"]


def suites_of(header):
    """The suites that can see a mutant of the header: of rbd.h all, of another those that include it."""
    names = re.findall(r"\bx\((\w+)\)", (TESTS / "suites.h").read_text())
    include = f'#include "{header}"'
    return tuple(name for name in names
                 if header == "rbd.h" or include in (TESTS / f"test_{name}.c").read_text())


def stages(header):
    """Fast to slow: a mutant meets each until one sees it. By tcc the library compiles in a fiftieth of the time,
    without batches and the header's own sine; what passes there meets the stages of few functions first."""
    suites, parts = suite_sources(), suites_of(header)
    fast = tuple((name, ("-O1",)) for name in suites)
    ref = (("reference.c", ("-O1",)), ("control.c", ("-O1",)))
    def scalar(name, *flags):
        return Stage("scalar " + name, (("scalars.c", ("-O0", APART, *flags)),), ref)

    def batch(scalar_name, lanes):
        flags = (f"-DRBD_REAL={scalar_name}", f"-DBATCH_LANES={lanes}")
        return Stage(f"batch {scalar_name} {lanes}", (("batch.c", ("-O0", APART, *flags)), ("rbd.c", ("-O0", APART, flags[0]))),
                     (("test_batch.c", ("-O1", *flags)), *ref), functions=BATCHES, headers=BATCHED)

    def sincos(name, *flags):
        return Stage("sincos " + name, (("test_sincos.c", ("-O1", "-DHAVE_QUADMATH", *flags)),), (), ("-lquadmath",),
                     functions="sincos|bits")

    def tables(name, *flags):
        return Stage("tables " + name, (("tables.c", ("-O0", APART, "-ffp-contract=off", *flags)),))

    def bounds():
        return Stage("bounds", (("test_bounds.c", ("-O0", APART)),),
                     (("fuzz/robots.c", ("-O1", "-DRBD_REAL=double")), ("fuzz/world.c", ("-O1", "-DRBD_REAL=double"))),
                     ("-lquadmath",), functions="check_pivot|check_free|pivot_status|far_pivots|add_links|factor")

    def axes(scalar_name):
        flag = f"-DRBD_REAL={scalar_name}"
        return Stage("axes " + scalar_name, (("rbd.c", ("-O0", APART, flag)),),
                     (("test_axes.c", ("-O1", flag)), ("textbook.c", ("-O1", flag))), functions="build_|parallel|snap|zxz")

    def spatial(name, *flags, link=()):
        return Stage("spatial " + name, (("test_spatial.c", ("-O0", *flags)),), (("reference.c", ("-O1",)),),
                     ("-lquadmath",), link=link, headers="rbd_spatial")

    def sanitized_batch(scalar_name, lanes):
        flags = (f"-DRBD_REAL={scalar_name}", f"-DBATCH_LANES={lanes}")
        return Stage(f"batch {scalar_name} {lanes} sanitized", (("batch.c", (*SANITIZE, *flags)),),
                     (("rbd.c", ("-O1", flags[0])), ("test_batch.c", ("-O1", *flags)), *ref), link=SANITIZE[:2],
                     environment=(("ASAN_OPTIONS", "detect_leaks=0"),), functions=BATCHES, headers=BATCHED)

    def qp(scalar_name, *flags, link=()):
        return Stage("qp " + scalar_name, (("test_qp.c", ("-O1", *flags)),), link=link, headers="rbd_qp")

    out = [qp("double"), qp("float", "-DRBD_REAL=float"), qp("scalars", "-U__SSE2__"), qp("sanitized", *SANITIZE, link=SANITIZE[:2]),
           Stage("ik double", (("ik_scalars.c", ("-O1", APART)),), headers="rbd_ik"),
           Stage("estimate double", (("estimate_scalars.c", ("-O1", APART)),), headers="rbd_estimate"),
           Stage("tasks double", (("tasks_scalars.c", ("-O1", APART)),), headers="rbd_tasks"),
           Stage("actuator double", (("actuator_scalars.c", ("-O1", APART)),), headers="rbd_actuator"),
           spatial("double"), spatial("4 lanes", "-DRBD_LANES=4"), spatial("float", "-DRBD_REAL=float"),
           Stage("spatial frames", (("spatial_frames.c", ("-O0",)),), headers="rbd_spatial"),
           spatial("sanitized", *SANITIZE, link=SANITIZE[:2])]
    if shutil.which("tcc") and platform.machine() == "x86_64":
        out += [Stage("suites, tcc", (("rbd.c", ()),), fast, compiler="tcc",
                      parts=tuple(part for part in parts if part not in NOT_BY_TCC))]
    out += [batch("double", 4), batch("double", 2), batch("double", 8), batch("float", 4), batch("float", 16),
            sincos("double"), sincos("float", "-DRBD_REAL=float"), sincos("scalars", "-U__SSE2__"),
            sincos("float scalars", "-U__SSE2__", "-DRBD_REAL=float"),
            bounds(), axes("double"), axes("float"),
            Stage("suites", (("rbd.c", ("-O0", "-D__OPTIMIZE__=1", APART)),), fast, parts=parts),
            Stage("suites, AVX2", (("rbd.c", ("-O1", APART, "-mavx2", "-mfma")),), fast, parts=parts,
                  functions="stride|batches_of"),
            tables("double"), tables("float", "-DSCALAR_FLOAT"),
            scalar("float", "-DSCALAR_FLOAT"), scalar("4 lanes", "-DRBD_LANES=4"),
            Stage("scalar quad", (("scalars.c", ("-O0", APART, "-DSCALAR_QUAD")),), ref, ("-lquadmath",),
                  functions="sincos|joints"),  # which take their sines one by one there
            sanitized_batch("double", 4), sanitized_batch("float", 16),
            Stage("arrays", (("arrays.c", SANITIZE),), link=SANITIZE[:2], arguments=("400",),
                  headers="rbd.h|rbd_derivatives"),
            Stage("suites sanitized", (("rbd.c", SANITIZE),), fast, link=SANITIZE[:2], parts=parts,
                  environment=(("ASAN_OPTIONS", "detect_leaks=0"),))]
    cpu = Path("/proc/cpuinfo")
    if not (cpu.exists() and " avx2 " in cpu.read_text()):
        out = [stage for stage in out if stage.name != "suites, AVX2"]
    if shutil.which("valgrind"):
        out += [Stage("work under valgrind", (("rbd.c", ("-O1",)),), fast, environment=(("CK_RUN_CASE", "work"),),
                      run=("valgrind", "--quiet", "--error-exitcode=1"),
                      functions="rbd_work|take|aligned|joints|clear|crba|sincos|kinematics")]
    return out


def unknown_names(sources):
    """What the stages and MEMBERS name and no header has any more: parts of the names of functions; members."""
    functions = {name for source in sources for name in source.function if name}
    members_there = {name for source in sources for code in source.code for name in re.findall(r"(?:\.|->)(\w+)\b(?!\()", code)}
    parts = {part for header in HEADERS for stage in stages(header) for part in stage.functions.split("|")}
    return [*sorted(part for part in parts if not any(re.search(part, name) for name in functions)),
            *sorted(name for group in MEMBERS for name in group if name not in members_there)]


class Bench:
    """Compiles and runs; what is not mutated is compiled once."""

    def __init__(self, folder, source):
        self.folder = folder
        self.header = source.name
        self.stages = [stage for stage in stages(source.name) if re.search(stage.headers, source.name)]
        # what an object without the implementation depends on
        subprocess.run([str(TESTS / "data/unpack.py"), str(folder)], check=True)
        self.seen = digest_of(*sources_of_tests()) + "".join(
            "".join(header.lines[:header.first]) for header in (Source(ROOT / name) for name in HEADERS[:5]))
        self.check = subprocess.run(["pkg-config", "--cflags", "--libs", "check"], capture_output=True, text=True,
                                    check=True).stdout.split()
        self.lock = threading.Lock()
        self.base = {}   # stage and unit: digest of the object of the unchanged header
        self.limit = {}  # stage and part: seconds
        self.preparing = {stage.name: threading.Lock() for stage in self.stages}

    def compile(self, compiler, name, flags, include, out):
        command = [compiler, "-std=c99", *flags, *WARN_NOT, f"-I{include}", f"-I{ROOT}", f"-I{TESTS}",
                   f"-I{self.folder}", "-c",
                   str(TESTS / name if not name.startswith("/") else name), "-o", str(out)]
        return subprocess.run(command, capture_output=True, text=True)

    def compiles(self, include):
        """Whether GCC takes it: a fifth of a second."""
        unit = {"rbd_spatial.h": "spatial_frames.c", "rbd_batch.h": "batch.c", "rbd_qp.h": "test_qp.c"}.get(self.header, "rbd.c")
        return self.compile("gcc", unit, (APART, "-DBATCH_LANES=2", "-fsyntax-only"), include, "-").returncode == 0

    def once(self, compiler, name, flags):
        """An object that no mutant is in; kept from run to run."""
        tag = hashlib.sha256(repr((compiler, name, flags, self.seen)).encode()).hexdigest()[:16]
        out = self.folder / f"{Path(name).stem}-{tag}.o"
        with self.lock:
            if not out.exists():
                part = out.with_suffix(".part")
                result = self.compile(compiler, name, flags, ROOT, part)
                if result.returncode:
                    sys.exit(f"{name}: {result.stderr}")
                part.rename(out)
        return out

    def attempt(self, stage, include, place, original=False):
        """'no compile', 'same' (the objects are those of the unchanged header), 'passes' or 'fails'."""
        units = []
        same = True
        for k, (name, flags) in enumerate(stage.units):
            out = place / f"unit{k}.o"
            result = self.compile(stage.compiler, name, flags, include, out)
            if result.returncode:  # by tcc: not judged
                return "no compile" if stage.compiler == "gcc" else "same"
            digest = hashlib.sha256(out.read_bytes()).hexdigest()
            if original:
                self.base[stage.name, k] = digest
            same &= digest == self.base[stage.name, k]
            units.append(out)
        if same and not original:
            return "same"
        program = place / "program"
        rest = [self.once("gcc", name, flags) for name, flags in stage.rest]
        stop = self.once("gcc", str(HERE / "stop.c"), ("-O1",))
        result = subprocess.run(["gcc", *stage.link, *ABORT, *map(str, [*units, *rest, stop]), "-o",
                                 str(program), *self.check, *stage.libraries, "-lm"], capture_output=True, text=True)
        if result.returncode:
            if original:
                sys.exit(f"{stage.name}: {result.stderr}")
            return "no compile"
        for part in sorted(stage.parts, key=lambda part: self.limit.get((stage.name, part), 0)):
            began = time.monotonic()
            environment = dict(os.environ, CK_FORK="no", **dict(stage.environment))
            if part:
                environment["CK_RUN_SUITE"] = part
            limit = ["prlimit", f"--cpu={self.limit.get((stage.name, part), 1200)}"]  # holds on a busy machine too
            result = subprocess.run([*limit, *stage.run, str(program), *stage.arguments], cwd=ROOT, env=environment,
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            if result.returncode:
                return "fails"
            if original:
                self.limit[stage.name, part] = int(3 + 4 * (time.monotonic() - began))
        return "passes"

    def lay(self, include, text):
        """The headers in a folder, one with this text; and what tests/arrays.c makes of rbd.h."""
        shutil.rmtree(include, ignore_errors=True)
        include.mkdir(parents=True)
        for name in [path.name for path in ROOT.glob("rbd*.h") if path.name != self.header]:
            (include / name).symlink_to(ROOT / name)
        (include / self.header).write_text(text, encoding="utf-8")
        rbd = (include / "rbd.h").read_text(encoding="utf-8")
        (include / "rbd_arrays.h").write_text(rbd.replace("RBDI_PART void *rbdi_take(", "RBDI_PART void *rbdi_unused("))

    def prepare(self, stage, place):
        """The unchanged header must pass; its time and objects are the measure."""
        with self.preparing[stage.name]:
            if (stage.name, stage.parts[-1]) in self.limit:
                return
            include = place / "original"
            self.lay(include, (ROOT / self.header).read_text(encoding="utf-8"))
            if self.attempt(stage, include, place, original=True) != "passes":
                print(f"{stage.name}: fails without a mutant", file=sys.stderr, flush=True)
                os._exit(1)

    def judge(self, mutant_text, function, place):
        """The name of the stage that sees the mutant; 'no compile'; 'same' if no build differs;
        'survives'."""
        include = place / "include"
        self.lay(include, mutant_text)
        if not self.compiles(include):
            return "no compile"
        differs = False
        for stage in self.stages:
            if not re.search(stage.functions, function):
                continue
            if stage.name == "suites" and differs and self.header != "rbd_contact.h":
                continue  # tcc's code of it passed nearly all of them; GCC's meets all sanitized
            self.prepare(stage, place)
            verdict = self.attempt(stage, include, place)
            if verdict == "no compile":
                return verdict
            if verdict == "fails":
                return stage.name
            differs |= verdict == "passes"
        return "survives" if differs else "same"


# ---- the run ----

def sources_of_tests():
    """What the tests are compiled from: C and the reference results."""
    return sorted([*TESTS.rglob("*.[ch]*"), *TESTS.glob("data/*.bin"), *TESTS.glob("data/*.py")])


def digest_of(*paths):
    total = hashlib.sha256()
    for path in paths:
        total.update(path.read_bytes())
    return total.hexdigest()


class Results:
    """Verdicts, one a line. They hold for one text of the header; a survivor's for one state of the tests too."""

    def __init__(self, path, header, fresh):
        self.path = path
        self.header = digest_of(header)
        self.tests = digest_of(*sources_of_tests(), Path(__file__))
        self.verdicts = {}
        if fresh and path.exists():
            path.unlink()
        for line in path.read_text().splitlines() if path.exists() else []:
            row = json.loads(line)
            if row["header"] == self.header and (row["verdict"] != "survives" or row["tests"] == self.tests):
                self.verdicts[tuple(row["key"])] = row["verdict"]

    def add(self, key, verdict):
        self.verdicts[key] = verdict
        with self.path.open("a") as file:
            file.write(json.dumps({"key": key, "verdict": verdict, "header": self.header, "tests": self.tests}) + "\n")


def report(source, counted):
    """The score; whether none survives but those that are listed."""
    excused = [m for m, verdict in counted if verdict == "equivalent"]
    alive = [m for m, verdict in counted if verdict in ("survives", "same")]
    killed = len(counted) - len(excused) - len(alive)
    by_stage = {}
    for _, verdict in counted:
        by_stage[verdict] = by_stage.get(verdict, 0) + 1
    for m in alive:
        print(f"SURVIVES {source.place(m.line)}\n  function: {m.function}\n  text: {m.text}\n  mutated: {m.mutated}")
    for name, number in sorted(by_stage.items(), key=lambda row: -row[1]):
        print(f"{number:5}  {name}")
    whole = len(counted) - len(excused)
    print(f"{source.name}: {len(counted)} mutants, {len(excused)} equivalent, {killed} of {whole} killed: "
          f"{100 * killed / max(whole, 1):.1f} %")
    return not alive


def main():
    parser = argparse.ArgumentParser(prog="run mutants", description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--header", choices=HEADERS, help="which to put them into (one after another)")
    parser.add_argument("--count", type=int, help="mutants that compile (" +
                        ", ".join(f"{name} {count}" for name, count in COUNT.items()) + ")")
    parser.add_argument("--seed", type=int, default=1, help="another choice of mutants (1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="side by side (one a core)")
    parser.add_argument("--only", metavar="REGEX", help="all mutants of which 'function: text -> mutated' matches")
    parser.add_argument("--fresh", action="store_true", help="forget what earlier runs found")
    parser.add_argument("--list", action="store_true", help="print the mutants, run nothing")
    parser.add_argument("--check", action="store_true", help="only that equivalent.txt speaks of what is there")
    parser.add_argument("--refresh", action="store_true",
                        help="find the entries of equivalent.txt again whose text in the headers changed")
    options = parser.parse_args()
    sources = {name: Source(ROOT / name) for name in HEADERS}
    equivalents = Exceptions(HERE / "equivalent.txt", FIELDS)
    every = {name: enumerate_mutants(source, options.seed) for name, source in sources.items()}
    present = {m.key for mutants in every.values() for m in mutants}
    if options.refresh:
        equivalents.refresh(list(present))
        return 0
    missing = [key for key, _ in equivalents.entries if key not in present]
    unknown = unknown_names(sources.values())
    for name in unknown:
        print(f"mutants.py names '{name}', which no header has")
    for key in missing:
        print("equivalent.txt has what no header has (--refresh finds it again): " + " | ".join(key))
    if options.check:
        return 1 if missing or unknown else 0
    options.folder.mkdir(parents=True, exist_ok=True)
    well = not missing
    for name in [options.header] if options.header else HEADERS:
        count, mutants = options.count or COUNT[name], every[name]
        if options.only:
            mutants = [m for m in mutants if re.search(options.only, f"{m.function}: {m.text} -> {m.mutated}")]
            count = len(mutants)
        if options.list:
            for m in mutants[:count]:
                print(f"{m.line}: {m.function}\n  - {m.text}\n  + {m.mutated}")
            print(f"{name}: {len(mutants)} in all")
            continue
        results = Results(options.folder / f"{name}.jsonl", ROOT / name, options.fresh)
        counted = run(sources[name], mutants, count, options, results, equivalents)
        well &= report(sources[name], counted)
    return 0 if well else 1


def run(source, mutants, count, options, results, equivalents):
    """Judges mutants in their order until enough of them compile, those that are listed as equivalent only where
    they are asked for. [(mutant, verdict)]"""
    bench = Bench(options.folder, source)
    places = [options.folder / f"worker{k}" for k in range(options.jobs)]
    free = list(places)
    for place in places:
        place.mkdir(exist_ok=True)
    started = time.monotonic()

    def one(m):
        listed = equivalents.find(m.key)
        if listed and not options.only:
            return m, "equivalent"
        if m.key in results.verdicts:
            return m, results.verdicts[m.key]
        with bench.lock:
            place = free.pop()
        verdict = bench.judge(mutate(source, m), m.function, place)
        with bench.lock:
            free.append(place)
            results.add(m.key, verdict)
        print(f"{time.monotonic() - started:6.0f} s  {source.place(m.line)} {m.function}: {verdict}", file=sys.stderr,
              flush=True)
        if listed and verdict not in ("survives", "same"):
            print("equivalent.txt has what is seen: " + " | ".join(m.key))
        return m, verdict

    counted, at = [], 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        while len(counted) < count and at < len(mutants):
            part = mutants[at:at + count - len(counted)]
            at += len(part)
            counted += [(m, verdict) for m, verdict in pool.map(one, part) if verdict != "no compile"]
    return counted


if __name__ == "__main__":
    sys.exit(main())
