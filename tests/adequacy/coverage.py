#!/usr/bin/env python3
"""Branch coverage of the headers' implementation by the tests, counted at source level: a macro or a function that is
inlined in many places counts once, and so does what several builds have in common (double, float, lanes, batches,
quad, a C++ class). Prints what no test reaches and unreachable.txt does not excuse; fails if there is any."""
import argparse
import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from source import Exceptions, HEADERS, ROOT, Source, amalgamate

HERE = Path(__file__).resolve().parent
TESTS = ROOT / "tests"
FIELDS = ["function", "text", "never"]
SKIPPED = 77  # meson's sign
COVER = ["-fprofile-instr-generate", "-fcoverage-mapping"]
CODE_REGION, SKIPPED_REGION = 0, 2


def suite_sources():
    names = re.search(r"test_sources = files\((.*?)\)", (TESTS / "meson.build").read_text(), re.S).group(1)
    return [*re.findall(r"'([^']+)'", names), "textbook.c"]


# The code of an optimised build, compiled fast: no optimisation and no forced inlining.
QUICK = ["-O0", "-D__OPTIMIZE__=1", "-Dalways_inline=unused"]
RUN_LONG = ["-O1", "-Dalways_inline=unused"]  # the same where running takes more than compiling
AVX2 = ["-mavx2", "-mfma"]
DATA = ["reference.c", "control.c"]


def programs():
    """(name, sources with the headers' implementation, other sources, flags, libraries). Every build here reaches
    something that those before it do not. A build named after a suite runs that suite alone."""
    out = [("suites", ["rbd.c"], suite_sources(), RUN_LONG, [])]
    if " avx2 " in Path("/proc/cpuinfo").read_text():  # batches of four
        out.append(("constraints", ["rbd.c"], suite_sources(), [*QUICK, *AVX2], []))
    out.append(("scalar lanes", ["scalars.c"], ["reference.c", "control.c"], [*QUICK, "-DRBD_LANES=4"], []))
    for name, flags in {"double": [], "scalars": ["-U__SSE2__"]}.items():
        out.append(("sincos " + name, ["test_sincos.c"], [], [*QUICK, *flags], ["-lquadmath"]))
    for real, lanes in ("double", 8), ("float", 16):
        flags = [*QUICK, f"-DRBD_REAL={real}", f"-DBATCH_LANES={lanes}"]
        out.append((f"batch {real} {lanes}", ["batch.c", "rbd.c"], ["test_batch.c", "reference.c"], flags, []))
    out.append(("spatial", ["test_spatial.c"], ["reference.c"], QUICK, ["-lquadmath"]))
    for robot in "iiwa", "hyq":
        out.append((f"features {robot}", [f"features_{robot}.c", "features.c"], [], QUICK, []))
    out.append(("spatial frames", ["spatial_frames.c"], [], QUICK, []))
    for name, flags in {"double": [], "float": ["-DRBD_REAL=float"], "scalars": ["-U__SSE2__"],
                        "small": ["-U__OPTIMIZE__"], "small scalars": ["-U__SSE2__", "-U__OPTIMIZE__"]}.items():
        out.append((f"qp {name}", ["test_qp.c"], [], [*RUN_LONG, *flags], []))
    for part in "tasks", "actuator", "estimate", "ik":
        for real in "double", "float":
            out.append((f"{part} {real}", [f"{part}_scalars.c"], [], [*RUN_LONG, f"-DRBD_REAL={real}"], []))
    return out


def plain(source, flags):
    """The flags of a source without the implementation: those that it would be the same without are left out. The
    textbook is what takes the time."""
    level = "-O3" if source == "textbook.c" else "-O1"
    known = [*QUICK, *RUN_LONG, *AVX2]
    return level, "-DPART_OF_TREES=5", *(flag for flag in flags if flag not in known and source not in DATA)


def tools(compiler):
    suffix = compiler.replace("clang", "")
    return [compiler, "llvm-profdata" + suffix, "llvm-cov" + suffix]


class Build:
    def __init__(self, folder, compiler):
        self.folder, self.compiler = folder, compiler
        self.check = subprocess.run(["pkg-config", "--cflags", "--libs", "check"], capture_output=True, text=True,
                                    check=True).stdout.split()
        # libquadmath is GCC's
        found = subprocess.run(["gcc", "-print-file-name=libquadmath.so"], capture_output=True, text=True).stdout
        self.paths = ["-L" + str(Path(found.strip()).parent)] if "/" in found else []

    def command(self, command):
        result = subprocess.run(command, capture_output=True, text=True)
        if result.returncode:
            sys.exit(f"{' '.join(command)}\n{result.stdout[-2000:]}{result.stderr[-4000:]}")
        return result.stdout

    def compile(self, source, flags, out):
        cpp = source.endswith(".cpp")
        self.command([self.compiler.replace("clang", "clang++") if cpp else self.compiler,
                      "-std=c++17" if cpp else "-std=c99", "-w", *flags, f"-I{ROOT}", f"-I{self.folder}", "-c",
                      str(TESTS / source), "-o", str(out)])
        return str(out)

    def compile_plain(self, pool):
        """The sources without the implementation, each once for the programs that have it with the same flags."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self.command([str(TESTS / "data/unpack.py"), str(self.folder)])
        wanted = sorted({(s, plain(s, flags)) for _, _, others, flags, _ in programs() for s in others})
        out = pool.map(lambda k: self.compile(*wanted[k], self.folder / f"{k}_{wanted[k][0]}.o"), range(len(wanted)))
        self.plain = dict(zip(wanted, out))

    def measure(self, program):
        """Builds and runs one program; what llvm-cov says of the headers in it."""
        name, covered, others, flags, libraries = program
        place = self.folder / name.replace(" ", "_")
        place.mkdir(parents=True, exist_ok=True)
        objects = [self.compile(s, [*flags, *COVER], place / (s + ".o")) for s in covered]
        objects += [self.plain[s, plain(s, flags)] for s in others]
        binary = place / "program"
        compiler = self.compiler.replace("clang", "clang++") if name == "class" else self.compiler
        self.command([compiler, *COVER, *objects, "-o", str(binary), *self.check, *self.paths, *libraries, "-lm"])
        raw = place / "raw.profraw"
        suite = {"CK_RUN_SUITE": name} if f"test_{name}.c" in others else {}
        result = subprocess.run([str(binary)], cwd=ROOT, capture_output=True, text=True,
                                env=dict(os.environ, CK_FORK="no", LLVM_PROFILE_FILE=str(raw), **suite))
        if result.returncode:
            sys.exit(f"{name}: fails\n{result.stdout[-2000:]}")
        _, profdata, cov = tools(self.compiler)
        data = place / "data.profdata"
        self.command([profdata, "merge", "-sparse", str(raw), "-o", str(data)])
        return json.loads(self.command([cov, "export", str(binary), f"-instr-profile={data}",
                                        "-format=text"]))


class Counts:
    """How often each region ran and each condition was true and false, by its place in a header."""

    def __init__(self, header):
        self.header = header
        self.regions, self.branches, self.compiled = {}, {}, set()

    def add(self, export):
        for function in export["data"][0]["functions"]:
            here = [Path(name) == self.header for name in function["filenames"]]
            if not any(here):
                continue
            present, skipped = set(), set()
            for l1, c1, l2, c2, count, file, _, kind in function["regions"]:
                if here[file]:
                    end = l2 + 1 if c2 > 1 else l2  # what is skipped may end where a line begins
                    (skipped if kind == SKIPPED_REGION else present).update(range(l1, end))
                if here[file] and kind == CODE_REGION:
                    place = (l1, c1, l2, c2)
                    self.regions[place] = self.regions.get(place, 0) + count
            if function["count"]:  # of one that is never called clang says less
                self.compiled |= present - skipped
            for l1, c1, l2, c2, true, false, file, _, kind in function["branches"]:
                if here[file]:
                    place = (l1, c1, l2, c2)
                    old = self.branches.get(place, (0, 0))
                    self.branches[place] = (old[0] + true, old[1] + false)


def not_compiled(source, counts):
    """The lines of code that no build has, a run of them as one. Of a macro any line stands for all."""
    macros = {source.function[n] for n in counts.compiled if source.clean[n].endswith("\\")}
    before = 0
    for n, code in enumerate(source.code):
        if not re.search(r"\w", code) or n in counts.compiled or source.function[n] in macros:
            continue
        if source.function[n] != source.function[before]:
            yield (n, 1), (source.function[n], " ".join(source.lines[n].split()), "compiled")
        before = n


def gaps(source, counts):
    """(place, key) of all that never happened. A condition that is known to the compiler has no branch in that
    build: neither count rises. One whose region never ran is told by the region."""
    for place, count in sorted(counts.regions.items()):
        if not count and place[0] > source.first and source.function[place[0]]: # no constant
            text = source.span(*place)
            yield place, (source.function[place[0]], text if len(text) <= 90 else text[:90].rstrip(), "run")
    for place, (true, false) in sorted(counts.branches.items()):
        if place[0] <= source.first or bool(true) == bool(false):
            continue
        yield place, (source.function[place[0]], source.span(*place), "false" if true else "true")


def main():
    parser = argparse.ArgumentParser(prog="run coverage", description=__doc__.split(":")[0])
    parser.add_argument("folder", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--compiler", default="clang-19", help="clang-19; its llvm-cov has the same suffix")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--all", action="store_true", help="print what is excused too, with its reason")
    parser.add_argument("--if-possible", action="store_true", help="skipped, by name, without the compiler")
    parser.add_argument("--refresh", action="store_true",
                        help="find the entries of unreachable.txt again whose text in the headers changed")
    options = parser.parse_args()
    missing = [tool for tool in tools(options.compiler) if not shutil.which(tool)]
    if missing:
        print("not installed: " + " ".join(missing))
        return SKIPPED if options.if_possible else 1
    headers = [(Source(ROOT / name), Counts(ROOT / name)) for name in HEADERS]
    build = Build(options.folder, options.compiler)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        build.compile_plain(pool)
        for export in pool.map(build.measure, programs()):
            for _, counts in headers:
                counts.add(export)
    missed = [[gap for gap in (*gaps(*header), *not_compiled(*header)) if of_its_own(header[0], gap)] for header in headers]
    excuses = Exceptions(HERE / "unreachable.txt", FIELDS)
    if options.refresh:
        excuses.refresh([key for part in missed for _, key in part])
        return 0
    bad = sum(report(*header, part, excuses, options.all) for header, part in zip(headers, missed))
    for key in excuses.stale():
        print("unreachable.txt has what is reached, or is not there (--refresh finds it again): " + " | ".join(key))
    return 1 if bad or excuses.stale() else 0


def of_its_own(source, gap):
    """Whether a gap is in a room that no other header has: of rbd_qp.h those that it shares with rbd.h are not."""
    room = source.places[gap[0][0]][0]
    return source.name not in amalgamate.ALONE or room not in amalgamate.shared()


def report(source, counts, missed, excuses, every):
    """Prints what was missed of a header without an excuse, and how much that is."""
    bad = 0
    for place, key in missed:
        reason = excuses.find(key)
        bad += reason is None
        if reason is None or every:
            print(f"{source.place(place[0])}:{place[1]}\n" + "\n".join(f"  {f}: {t}" for f, t in zip(FIELDS, key)))
            if reason:
                print("   ", reason)
    whole = sum(1 for p in counts.regions if p[0] > source.first)
    branches = 2 * sum(1 for p, c in counts.branches.items() if p[0] > source.first and any(c))
    print(f"{source.name}: {whole} regions and {branches} branches; {len(missed)} not reached, "
          f"{len(missed) - bad} of these excused")
    return bad


if __name__ == "__main__":
    sys.exit(main())
