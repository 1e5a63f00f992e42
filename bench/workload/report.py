#!/usr/bin/env python3
"""Builds, measures, counts, draws and writes the workload report: ./run report --help

SPDX-License-Identifier: MIT
"""
import argparse
import csv
import datetime
import functools
import hashlib
import itertools
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CODEGEN = os.path.join(ROOT, "build", "tools", "rbd-codegen")  # ./run builds it
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import callgrind  # noqa: E402
import page  # noqa: E402
import sizes  # noqa: E402
from data import ALGORITHMS, Data, read  # noqa: E402

CALLGRIND = ["valgrind", "--command-line-only=yes", "--tool=callgrind", "--cache-sim=yes", "--branch-sim=yes",
             "--dump-instr=yes", "--compress-pos=no", "--compress-strings=no", "--collect-atstart=no",
             "--combine-dumps=yes"]


def die(text):
    progress("")
    print("report: " + text, file=sys.stderr)
    sys.exit(1)


def progress(text):
    """A line that the next one replaces, if stderr is a terminal."""
    if sys.stderr.isatty():
        print("\r\033[K" + text, end="", file=sys.stderr, flush=True)


# ---- options ----

def options():
    p = argparse.ArgumentParser(prog="./run report", description="Measures rbd and the libraries beside it, counts "
                                "their events, and writes report.html, report.md and the figures.")
    p.add_argument("--counters", choices=["auto", "perf", "valgrind", "none"], default="auto",
                   help="where counts come from (default auto: all that this machine offers)")
    p.add_argument("--compilers", default="", metavar='"A B"',
                   help="compilers to build rbd with; the figures show the first (default: gcc and the newest clang)")
    p.add_argument("--cxx", metavar="COMPILER",
                   help="compiler of the other libraries' sources (default: the newest clang++, else that of rbd's make)")
    p.add_argument("--robcogen", default="", metavar="FOLDER", help="what RobCoGen generated: bench/peers/README.md")
    p.add_argument("--samples", type=int, help="random states of a timed experiment (default 2000)")
    p.add_argument("--experiments", type=int, help="how often they are timed (default 50)")
    p.add_argument("--quick", action="store_true", help="1000 states, 10 experiments, 64 states under valgrind")
    p.add_argument("--output", default=os.path.join(ROOT, "build", "report"), metavar="FOLDER",
                   help="where all is written (default build/report); an interrupted report goes on from there")
    p.add_argument("--again", action="store_true", help="forget what the folder has, but the builds")
    o = p.parse_args()
    for name in ("samples", "experiments"):
        if getattr(o, name) is not None and getattr(o, name) < 1:
            p.error("--%s: must be at least 1" % name)
    o.samples = o.samples or (1000 if o.quick else 2000)
    o.experiments = o.experiments or (10 if o.quick else 50)
    o.compilers = o.compilers.split() or default_compilers()
    for c in o.compilers:
        if not shutil.which(c):
            p.error("--compilers: '%s' is not installed" % c)
    if o.counters == "valgrind" and not shutil.which("valgrind"):
        p.error("--counters valgrind: valgrind is not installed")
    return o


def default_compilers():
    found = ["gcc"] if shutil.which("gcc") else []
    found += [c for c in ("clang-19", "clang-16", "clang") if shutil.which(c)][:1]
    return found or die("neither gcc nor clang found")


# ---- the folder, and what it has from before ----

def sources():
    """The files that results depend on."""
    found = [os.path.join(ROOT, folder, name) for folder in ("", "models")
             for name in os.listdir(os.path.join(ROOT, folder)) if name.endswith(".h")]
    for folder, folders, names in itertools.chain(*(os.walk(os.path.join(ROOT, f)) for f in ("bench", "tools"))):
        folders[:] = [f for f in folders if f not in ("firmware", "results", "tests", "__pycache__")]
        found += [os.path.join(folder, name) for name in names
                  if name.endswith((".c", ".h", ".cpp", ".hpp", ".jl", ".build")) or name == "callgrind.py"]
    return sorted(found)


def fingerprint(o, machine):
    """Of the sources and options that results depend on, and of the machine as machine_of has it."""
    h = hashlib.sha256(json.dumps([o.samples, o.experiments, o.quick, o.counters, o.cxx, o.robcogen, machine]).encode())
    for path in sources():
        with open(path, "rb") as f:
            h.update(os.path.relpath(path, ROOT).encode() + f.read())
    return h.hexdigest()


def content(path):
    """Of the file, or None if there is none."""
    if not os.path.exists(path):
        return None
    with open(path) as f:
        return f.read()


def prepare(o, machines):
    """Drops results of other sources or options, or of another machine; machines: {compiler: its machine}."""
    for compiler, machine in machines.items():
        stamp, now = os.path.join(o.output, "fingerprint-" + compiler), fingerprint(o, machine)
        if o.again or content(stamp) != now:
            for name in os.listdir(o.output):
                if name.endswith("-%s.csv" % compiler) or name == "operations.csv":
                    os.remove(os.path.join(o.output, name))
        page.write_whole(stamp, now)


# ---- steps: each leaves one file, written beside its place first ----

class Steps:
    def __init__(self, o):
        self.o, self.list = o, []

    def add(self, name, title, work):
        """work(path) writes the file; skipped if it is there."""
        self.list.append((os.path.join(self.o.output, name), title, work))

    def run(self):
        for i, (path, title, work) in enumerate(self.list):
            if os.path.exists(path):
                continue
            progress("report: %d of %d: %s " % (i + 1, len(self.list), title))
            work(path + ".tmp")
            os.replace(path + ".tmp", path)
        progress("")


def call(command, stdout=None, env=None):
    """Runs a command; if it fails, shows what it printed. Returns what it printed to stderr."""
    done = subprocess.run(command, stdout=stdout or subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env=dict(os.environ, **(env or {})))
    if done.returncode != 0:
        progress("")
        sys.stderr.write((done.stdout or "") + done.stderr)
        die("failed: " + " ".join(command))
    return done.stderr


def call_to(path, command):
    with open(path, "w") as f:
        return call(command, stdout=f)


def folder_of(o, compiler, march):
    return os.path.join(o.output, "build-%s-%s" % (compiler, march))


def cpp_of(o, compiler):
    """The C++ compiler that is asked for; else clang's, which does best by Pinocchio; else that of the same make."""
    for name in [o.cxx] if o.cxx else ["clang++-19", "clang++-16", "clang++"]:
        if shutil.which(name):
            return name
    name = compiler.replace("gcc", "g++").replace("clang", "clang++")
    return (name != compiler and shutil.which(name)) or shutil.which("g++") or "c++"


BUILT = {}  # (compiler, march, name): the value of bench_fixed_base that it was built with in this run


def program(o, compiler, march, name, fixed_base=False):
    """The path of a program of bench/, which is built if it was not in this run; fixed_base: with generated code of
    HyQ and Atlas on fixed bases."""
    key, folder = (compiler, march, name), folder_of(o, compiler, march)
    if BUILT.get(key) != fixed_base:
        progress("report: building %s with %s, -march=%s " % (name, compiler, march))
        if not os.path.exists(os.path.join(folder, "build.ninja")):
            configure(o, folder, compiler, march)
        call(["meson", "configure", folder, "-Dbench_fixed_base=%s" % str(fixed_base).lower()])
        call(["ninja", "-C", folder, "bench/" + name])
        BUILT[key] = fixed_base
    return os.path.join(folder, "bench", name)


def configure(o, folder, compiler, march):
    shutil.rmtree(folder, ignore_errors=True)
    if platform.machine() not in ("x86_64", "amd64"):
        march = "native"
    cpp = cpp_of(o, compiler)
    more = []
    if march != "native" and "clang" in cpp:
        more = ["-Dcpp_args=-fno-integrated-as " + shlex.quote("-B" + assembler_for_valgrind(folder + "-as"))]
    call(["meson", "setup", folder, ROOT, "--buildtype=release", "-Dtests=disabled", "-Dbench=enabled",
          "-Durdf=disabled", "-Dbench_march=" + march, "-Drobcogen=" + o.robcogen, "-Dcodegen=" + CODEGEN] + more,
         env={"CC": compiler, "CXX": cpp})


def assembler_for_valgrind(folder):
    """A folder with an assembler that avoids an encoding which valgrind 3.19 does not know: see counters/instructions.sh."""
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "as")
    with open(path, "w") as f:
        f.write("#!/bin/sh\nfor source; do :; done\n"
                "sed -i 's/^\\tvmovq\\t\\(%xmm[0-9]*, %xmm\\)/\\t{load} vmovq\\t\\1/' \"$source\"\n"
                "exec as \"$@\"\n")
    os.chmod(path, 0o755)
    return folder


def bench(o, compiler, march, fixed_base=False):
    return program(o, compiler, march, "rbd-bench", fixed_base)


ROUNDS = 2


def times(o, compiler, march, path, *more):
    """Each library in a process of its own, in turns: a round for a part of the experiments. Accuracy is of the first."""
    rounds = []
    states = julia_states(o, compiler) if march == "native" and julia_package() else []
    for i in range(min(ROUNDS, o.experiments)):
        share = max(o.experiments * (i + 1) // ROUNDS - o.experiments * i // ROUNDS, 1)
        rounds.append([])
        for library in libraries(o, compiler):
            part = "%s.%s" % (path, library)
            progress_of([bench(o, compiler, march), "--library", library, "--samples", str(o.samples), "--experiments",
                         str(share), "--format", "csv", "--output", part, *more,
                         *([] if i == 0 and march == "native" else ["--no-quad"])])
            rounds[-1] += read(part)
            os.remove(part)
        if states:
            call_to(path + ".julia", JULIA + [os.path.join(ROOT, "models"), str(share), *states])
            rounds[-1] += read(path + ".julia")
            os.remove(path + ".julia")
    for name in states:
        os.remove(name)
    write_rows(path, least_of(rounds))


def has_avx512():
    try:
        with open("/proc/cpuinfo") as f:
            return " avx512f " in f.read()
    except OSError:
        return False


# Julia's code is faster without AVX-512: bench/peers/README.md.
JULIA = ["julia", "--startup-file=no", "-O3", "--check-bounds=no", *(["-Chaswell"] if has_avx512() else []),
         os.path.join(ROOT, "bench", "peers", "rigid_body_dynamics.jl")]


@functools.lru_cache()
def julia_package():
    """The version of RigidBodyDynamics.jl and Julia, empty where they are not."""
    done = shutil.which("julia") and subprocess.run(JULIA + ["--version"], capture_output=True, text=True)
    return done.stdout.strip() if done and done.returncode == 0 else ""


def julia_states(o, compiler):
    """Files of the states and what rbd computes of them, one for each algorithm of RigidBodyDynamics.jl."""
    names = []
    for algorithm, _ in ALGORITHMS:
        names.append(os.path.join(o.output, "states-" + algorithm))
        call([bench(o, compiler, "native"), "--library", "rbd", "--variant", "run-time", "--algorithm", algorithm,
              "--samples", str(o.samples), "--states", "--output", names[-1]])
    return names


def least_of(rounds):
    """Of each row the round with the least minimum, and the first round's error against quad precision."""
    return [dict(min(same, key=lambda row: float(row["min_ns"])), quad_error=same[0]["quad_error"])
            for same in zip(*rounds)]


def write_rows(path, rows):
    with open(path, "w", newline="") as f:
        writer = csv.DictWriter(f, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def progress_of(command):
    """Runs rbd-bench, whose own progress line may be seen."""
    if sys.stderr.isatty():
        if subprocess.run(command).returncode != 0:
            die("failed: " + " ".join(command))
    else:
        call(command)


def grid_times(o, compiler, path):
    """Single calls of rbd in float, bases fixed, with gravity: for any robot, and of generated code."""
    rows = []
    for variant in ("run-time", "generated"):
        progress_of([bench(o, compiler, "native", True), "--library", "rbd", "--variant", variant, "--scalar", "float", "--fixed-base",
                     "--gravity", "--samples", str(o.samples), "--experiments", str(o.experiments), "--format", "csv",
                     "--output", path])
        rows += read(path)
    write_rows(path, rows)


def code_rows(o, compiler, path):
    build = os.path.join(folder_of(o, compiler, "native"), "bench")
    bench(o, compiler, "native")
    with open(path, "w", newline="") as f:
        csv.writer(f, lineterminator="\n").writerows([sizes.HEADER, *sizes.rows(build, CODEGEN, compiler)])


def valgrind_counts(o, compiler, path):
    raw = os.path.join(o.output, "callgrind-%s" % compiler)
    call(CALLGRIND + ["--callgrind-out-file=" + raw, bench(o, compiler, "haswell"), "--count", "callgrind",
                      "--samples", "64" if o.quick else "512"])
    with open(path, "w") as f:
        for row in [callgrind.HEADER] + list(callgrind.rows(raw)):
            f.write(",".join(row) + "\n")
    os.remove(raw)


def short_run(o, compiler, *more):
    """rbd-bench on little, in all libraries."""
    return subprocess.run([bench(o, compiler, "native"), "--robot", "iiwa", "--algorithm", "id", "--samples", "1000",
                           "--experiments", "1", *more], capture_output=True, text=True)


def rows_of(done):
    return list(csv.DictReader(done.stdout.splitlines()))


LIBRARIES = {}  # compiler: names of those that its build has, as on the command line


def libraries(o, compiler):
    if compiler not in LIBRARIES:
        rows = rows_of(short_run(o, compiler, "--format", "csv"))
        LIBRARIES[compiler] = list(dict.fromkeys(row["library"].lower() for row in rows))
    return LIBRARIES[compiler]


def machine_of(o, compiler):
    """What rbd-bench finds here: libraries, compiler, counters, and what it says of hardware counters, which is
    empty if they count; and the processor."""
    timed = short_run(o, compiler, "--format", "csv")
    counted = short_run(o, compiler, "--count", "perf", "--library", "rbd", "--variant", "run-time")
    if timed.returncode or counted.returncode:
        die((timed.stderr or counted.stderr).strip())
    libraries = {"%s %s" % (r["library"], r["version"]) for r in rows_of(timed)}
    return {"cpu": cpu(), "libraries": sorted(libraries | ({julia_package()} - {""})),
            "compiler": sorted({r["compiler"] for r in rows_of(timed)}),
            "counters": sorted({r["counter"] for r in rows_of(counted)}),
            "message": counted.stderr.strip().replace("rbd-bench: ", "")}


def measure(o):
    steps = Steps(o)
    use_valgrind = o.counters in ("auto", "valgrind") and shutil.which("valgrind")
    for c in o.compilers:
        steps.add("times-%s.csv" % c, "timing, " + c, lambda p, c=c: times(o, c, "native", p, "--scalar", "all"))
        steps.add("scaling-%s.csv" % c, "scaling, " + c, lambda p, c=c: call_to(
            p, [program(o, c, "native", "rbd-scaling")]))
        if o.counters in ("auto", "perf"):
            steps.add("counts-perf-%s.csv" % c, "hardware counters, " + c, lambda p, c=c: call(
                [bench(o, c, "native"), "--count", "perf", "--samples", str(o.samples), "--output", p]))
        if use_valgrind:
            steps.add("times-haswell-%s.csv" % c, "timing for valgrind's rates, " + c,
                      lambda p, c=c: times(o, c, "haswell", p))
            steps.add("counts-valgrind-%s.csv" % c, "counting under valgrind, " + c,
                      lambda p, c=c: valgrind_counts(o, c, p))
    first = o.compilers[0]
    steps.add("grid-%s.csv" % first, "the method of GRiDBenchmarks, " + first, lambda p: grid_times(o, first, p))
    steps.add("code-%s.csv" % first, "compiling code for one robot, " + first, lambda p: code_rows(o, first, p))
    if o.counters != "none":
        steps.add("operations.csv", "counting operations", lambda p: call_to(
            p, [program(o, o.compilers[0], "native", "rbd-operations")]))
    steps.run()


# ---- facts ----

def first_line(command):
    try:
        return subprocess.run(command, capture_output=True, text=True).stdout.strip().splitlines()[0]
    except (OSError, IndexError):
        return "not found"


def cpu():
    try:
        with open("/proc/cpuinfo") as f:
            names = [line.split(":", 1)[1].strip() for line in f if line.startswith("model name")]
        return "%s, %d processors" % (names[0], len(names))
    except (OSError, IndexError):
        return platform.processor() or "unknown"


def facts(o, data):
    versions, builds = {}, {}
    for row in data.times[data.main]:
        versions[row["library"]] = row["version"]
        if row["library"] != "rbd":
            kind = "'s generated code" if row["variant"].startswith("generated") else ""
            builds.setdefault(row["compiler"], {})[row["library"] + kind] = None
    now = datetime.datetime.now(datetime.timezone.utc)
    lanes = sorted({r["variant"] for r in data.times[data.main] if r["variant"].startswith("lanes")})
    return [
        ("machine", cpu()), ("system", "%s %s" % (platform.system(), platform.release())),
        ("libraries", ", ".join("%s %s" % item for item in versions.items())),
        ("compilers", "; ".join(first_line([c, "--version"]) for c in o.compilers)),
        ("flags", "-O3 -march=native -ffp-contract=fast; generated code -O3 -march=native; under valgrind -march=haswell, which has no AVX-512"),
        ("flags of others", "; ".join("%s: %s" % (", ".join(names), build) for build, names in builds.items()) or "–"),
        ("lanes", ", ".join(lanes) + " (double and float); under valgrind those of AVX2" if lanes else "–"),
        ("tools", "%s; %s" % (first_line(["valgrind", "--version"]), first_line(["gnuplot", "--version"]))),
        ("states", "%d per robot, different at each call, %d experiments, each library in a process of its own, in turns; "
         "gravity off" % (o.samples, o.experiments)),
        ("command", "./run report " + " ".join(sys.argv[1:])), ("date", now.strftime("%Y-%m-%d %H:%M UTC")),
    ]


def hardware_note(data, message):
    """message: of machine_of, about this moment; the data tell what was counted."""
    if not data.has("perf", "instructions"):
        return ("Hardware, by perf_event_open: %s. It would tell what really happens on this machine, cycles and "
                "stalls too; nothing here comes from it but the kernel's task clock."
                % (message.replace("hardware counters: ", "") or "nothing was counted"))
    share = min(float(r["share"]) for r in data.counts[data.main] if r["source"] == "perf")
    missing = [words for words, counter in (
        ("loads", "loads"), ("stores", "stores"), ("stalls", "stall_cycles"),
        ("stalls for memory", "memory_stall_cycles"), ("floating-point operations", "fp_scalar"))
        if not data.has("perf", counter)]
    return ("Hardware, by perf_event_open: every group of events was counted for %.0f %% of its time or more (below "
            "100 %% the counts are scaled up). It tells what really happened on this machine, and drifts by a few per "
            "cent.%s" % (100 * share, " Not counted, for want of the events' names (libpfm4 and a processor that it "
                         "knows): %s; what needs them is by valgrind, if that was there." % ", ".join(missing)
                         if missing else ""))


def notes(o, data, message):
    found = []
    if o.counters in ("auto", "perf"):
        found.append(hardware_note(data, message))
    if data.has("valgrind", "instructions"):
        found.append("Deterministic, by valgrind: instructions, loads and stores as executed by the -march=haswell "
                     "build, mispredictions and misses of a simulated predictor and cache; branches and "
                     "floating-point operations by weighting the disassembly with how often each instruction ran. "
                     "It repeats to the digit, and knows nothing of cycles or stalls.")
    if data.operations:
        found.append("Operations, by running the same header with a C++ scalar that counts: what the algorithm "
                     "needs, whatever the compiler makes of it.")
    return found or ["No counts: --counters none."]


def main():
    o = options()
    os.makedirs(o.output, exist_ok=True)
    machines = {c: machine_of(o, c) for c in o.compilers}
    prepare(o, machines)
    measure(o)
    progress("report: drawing ")
    data = Data(o.output, o.compilers)
    if not shutil.which("gnuplot"):
        die("gnuplot is not installed (Debian: gnuplot-nox); the tables are in " + o.output)
    page.write(data, o.output, facts(o, data), notes(o, data, machines[data.main]["message"]))
    progress("")
    print(os.path.join(o.output, "report.html"))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        progress("")
        print("report: interrupted; the same command goes on from here", file=sys.stderr)
        sys.exit(130)
