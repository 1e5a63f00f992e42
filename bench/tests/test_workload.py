#!/usr/bin/env python3
"""Tests of the workload report: counts of known loops, parsing, schemas, resuming, sentences.

usage: test_workload.py DIRECTORY [CLASS...]    with rbd-bench, rbd-operations and tests/test_counters in it
Exit status: 77 if anything was skipped, for a program that is missing, and nothing failed.
SPDX-License-Identifier: MIT
"""
import array
import csv
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "workload"))
import callgrind  # noqa: E402
import figures  # noqa: E402
import page  # noqa: E402
import readme  # noqa: E402
import report  # noqa: E402
import sizes  # noqa: E402
from data import Data  # noqa: E402

PROGRAMS = sys.argv.pop(1) if len(sys.argv) > 1 else "."


def run(name, *arguments):
    return subprocess.run([os.path.join(PROGRAMS, name)] + list(arguments), capture_output=True, text=True)


class Classification(unittest.TestCase):
    def test_instructions_are_counted_by_width(self):
        for instruction, expected in {
            "mulsd  %xmm1,%xmm0": ("fp_scalar", 1),
            "vaddss 0x10(%rax),%xmm1,%xmm0": ("fp_scalar", 1),
            "vfmadd231sd %xmm2,%xmm1,%xmm0": ("fp_scalar", 2),
            "addpd  %xmm1,%xmm0": ("fp_128", 2),
            "mulps  %xmm1,%xmm0": ("fp_128", 4),
            "vsubpd %ymm2,%ymm1,%ymm0": ("fp_256", 4),
            "vfnmadd213ps %ymm2,%ymm1,%ymm0": ("fp_256", 16),
            "vfmadd132pd %zmm2,%zmm1,%zmm0": ("fp_512", 16),
            "sqrtsd %xmm0,%xmm0": ("fp_scalar", 1),
            "jne    401136 <main+0x10>": ("branches", 1),
            "bnd jmp *%rax": ("branches", 1),
            "repz ret": ("branches", 1),
            "call   *%rdx": ("branches", 1),
            "mov    %rax,%rbx": None,
            "vmovapd %ymm0,(%rax)": None,
            "vxorpd %xmm0,%xmm0,%xmm0": None,
            "imul   %rax,%rbx": None,
            "add    $0x8,%rax": None,
            "subss_like_word": None,
        }.items():
            self.assertEqual(callgrind.classify(instruction), expected, instruction)


SAMPLE = """# callgrind format
positions: instr line
desc: Trigger: Client Request: rbd,0.1.0,lanes 4,double,iiwa,id,10
events: Ir Dr Dw I1mr D1mr D1mw ILmr DLmr DLmw Bc Bcm Bi Bim
summary: 1000 300 200 1 4 6 0 0 0 90 7 10 3

ob=/a/program
fn=loop
0x10 0 40 40
0x14 0 30
cob=/a/library
cfn=sine
calls=30 0x90 0
0x18 0 500 100 50
0x18 0 20

ob=/a/library
fn=sine
0x90 0 25
totals: 1000 300 200 1 4 6 0 0 0 90 7 10 3
desc: Trigger: Program termination
events: Ir Dr Dw
summary: 5 5 5
ob=/a/program
0x10 0 999
totals: 5 5 5
"""


class Parsing(unittest.TestCase):
    def setUp(self):
        self.parts = list(callgrind.parse(SAMPLE.splitlines()))

    def test_only_requested_dumps_are_taken(self):
        self.assertEqual([p[0] for p in self.parts], ["rbd,0.1.0,lanes 4,double,iiwa,id,10"])

    def test_what_a_call_cost_is_not_counted_at_the_call(self):
        self.assertEqual(self.parts[0][2], {"/a/program": {0x10: 40, 0x14: 30, 0x18: 20}, "/a/library": {0x90: 25}})

    def test_counters_weigh_the_disassembly(self):
        kinds = {"/a/program": {0x10: ("fp_scalar", 1), 0x14: ("branches", 1)}, "/a/library": {0x90: ("fp_256", 8)}}
        found = callgrind.counters(self.parts[0][1], self.parts[0][2], kinds.get)
        self.assertEqual((found["fp_scalar"], found["branches"], found["fp_256"]), (40, 30, 200))
        self.assertEqual((found["instructions"], found["loads"], found["stores"]), (1000, 300, 200))
        self.assertEqual((found["branch_misses"], found["l1d_accesses"], found["l1d_misses"]), (10, 500, 10))


@unittest.skipUnless(shutil.which("valgrind") and shutil.which("objdump"), "needs valgrind and objdump")
class KnownLoop(unittest.TestCase):
    def test_callgrind_counts_each_multiplication(self):
        with tempfile.TemporaryDirectory() as folder:
            raw = os.path.join(folder, "out")
            done = subprocess.run(report.CALLGRIND + ["--callgrind-out-file=" + raw,
                                                      os.path.join(PROGRAMS, "tests/test_counters"), "--callgrind"],
                                  capture_output=True, text=True)
            if done.returncode == 77:
                self.skipTest("no loops for this machine, or no valgrind headers")
            self.assertEqual(done.returncode, 0, done.stderr)
            counts = {(r[3], r[7]): float(r[8]) for r in callgrind.rows(raw)}
        self.assertEqual((counts["scalars", "fp_scalar"], counts["scalars", "fp_128"]), (1, 0))
        self.assertEqual((counts["pairs", "fp_scalar"], counts["pairs", "fp_128"]), (0, 2))
        self.assertAlmostEqual(counts["scalars", "branches"], 1, places=3)
        self.assertGreaterEqual(counts["scalars", "instructions"], 2)


class Operations(unittest.TestCase):
    def test_the_counting_scalar_counts_each_multiplication(self):
        if not os.path.exists(os.path.join(PROGRAMS, "rbd-operations")):
            self.skipTest("no C++ compiler")
        done = run("rbd-operations", "--known-loop")
        self.assertEqual((done.returncode, done.stdout), (0, "1000 1000\n"))

    def test_each_joint_needs_one_sine_and_one_cosine(self):
        if not os.path.exists(os.path.join(PROGRAMS, "rbd-operations")):
            self.skipTest("no C++ compiler")
        rows = list(csv.DictReader(io.StringIO(run("rbd-operations").stdout)))
        self.assertEqual(list(rows[0]), callgrind.HEADER)
        joints = {"iiwa": 7, "hyq": 12, "atlas": 30}
        found = {(r["robot"], r["algorithm"], r["counter"]): float(r["per_state"]) for r in rows}
        for robot, n in joints.items():
            for algorithm in ("id", "mm", "fd"):
                self.assertIn(found[robot, algorithm, "op_sin"] - n, (0, 1), (robot, algorithm))
                self.assertEqual(found[robot, algorithm, "op_sin"], found[robot, algorithm, "op_cos"])
        self.assertLess(found["iiwa", "id", "op_mul"], found["iiwa", "fd", "op_mul"])


class Schemas(unittest.TestCase):
    COLUMNS = ("library,version,compiler,scalar,robot,algorithm,samples,experiments,mean_ns,stddev_ns,min_ns,"
               "max_error,quad_error,variant,disturbed").split(",")
    SHORT = ["--samples", "4", "--experiments", "2", "--robot", "iiwa", "--algorithm", "id"]

    def test_csv(self):
        rows = list(csv.DictReader(io.StringIO(run("rbd-bench", "--format", "csv", *self.SHORT).stdout)))
        self.assertEqual(list(rows[0]), self.COLUMNS)
        variants = [r["variant"] for r in rows if r["library"] == "rbd" and not r["variant"].startswith("generated")]
        self.assertEqual(variants[0], "run-time")
        self.assertRegex(variants[1], r"^lanes (2|4|8)$")
        for row in rows:
            self.assertGreater(float(row["min_ns"]), 0)
            self.assertLess(float(row["max_error"]), 1e-5 if row["library"] == "RobCoGen" else 1e-10)

    def test_algorithms_have_other_names(self):
        for name, other in (("rnea", "id"), ("crba", "mm"), ("aba", "fd")):
            done = run("rbd-bench", "--format", "csv", "--samples", "4", "--experiments", "1", "--robot", "iiwa",
                       "--algorithm", name)
            self.assertEqual({r["algorithm"] for r in csv.DictReader(io.StringIO(done.stdout))}, {other})

    def test_without_quad(self):
        rows = list(csv.DictReader(io.StringIO(run("rbd-bench", "--no-quad", "--format", "csv", *self.SHORT).stdout)))
        self.assertEqual({r["quad_error"] for r in rows}, {""})

    def test_json(self):
        whole = json.loads(run("rbd-bench", "--format", "json", *self.SHORT).stdout)
        self.assertEqual(sorted(whole), ["machine", "rows"])
        self.assertEqual(list(whole["rows"][0]), self.COLUMNS)
        self.assertEqual(list(whole["machine"]), ["cpu", "compiler", "flags", "date", "seed", "gravity"])

    def test_counts(self):
        done = run("rbd-bench", "--count", "perf", "--library", "rbd", *self.SHORT)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.splitlines()[0].split(","), callgrind.HEADER)
        self.assertLessEqual(len(done.stderr.splitlines()), 1)

    def test_callgrind_counts_want_callgrind(self):
        done = run("rbd-bench", "--count", "callgrind", *self.SHORT)
        self.assertEqual(done.returncode, 1)
        self.assertIn("callgrind", done.stderr)


def states_of(algorithm, path, samples=3):
    """The file of `rbd-bench --states` for each robot: {robot: (its words, its joints, q, v, a, tau, results)}."""
    done = run("rbd-bench", "--states", "--library", "rbd", "--variant", "run-time", "--algorithm", algorithm,
               "--samples", str(samples), "--output", path)
    assert done.returncode == 0, done.stderr
    found = {}
    with open(path, "rb") as f:
        for line in f:
            robot, *words = line.decode().split()
            joints = [joint.split() for joint in f.readline().decode().strip("\t\n").split("\t")]
            n, nq, nv, results = map(int, words[1:])
            arrays = []
            for width in (nq, nv, nv, nv, results):
                numbers = array.array("d", f.read(8 * n * width))
                arrays.append([numbers[k * width:(k + 1) * width] for k in range(n)])
            found[robot] = (words, joints, *arrays)
    return found


def times(M, x):
    n = len(x)
    return [sum(M[i * n + j] * x[j] for j in range(n)) for i in range(n)]


class States(unittest.TestCase):
    """The states of the bench, and what rbd computes of them, for a program in another language."""

    def test_the_results_are_those_of_the_states(self):
        with tempfile.TemporaryDirectory() as folder:
            ID, MM, FD = (states_of(name, os.path.join(folder, name)) for name in ("id", "mm", "fd"))
        self.assertEqual({r: len(b[1]) for r, b in ID.items()}, {"iiwa": 7, "hyq": 13, "atlas": 31})
        for robot, (words, joints, q, v, a, tau, torque) in ID.items():
            self.assertEqual(words[:2], ["id", "3"])
            self.assertEqual([MM[robot][i] for i in range(1, 6)], [joints, q, v, a, tau])
            self.assertNotEqual(q[0], q[1])
            for k in range(3):  # M (a - fd(tau)) = id(a) - tau
                found = times(MM[robot][6][k], [x - y for x, y in zip(a[k], FD[robot][6][k])])
                bound = 1e-9 * max(map(abs, times(MM[robot][6][k], list(map(abs, FD[robot][6][k])))))
                for x, y, z in zip(found, torque[k], tau[k]):
                    self.assertAlmostEqual(x, y - z, delta=bound)


@unittest.skipUnless(report.julia_package(), "needs julia with RigidBodyDynamics.jl")
class Julia(unittest.TestCase):
    def run_julia(self, spoil):
        with tempfile.TemporaryDirectory() as folder:
            names = [os.path.join(folder, name) for name in ("id", "mm", "fd")]
            for name in names:
                states_of(os.path.basename(name), name)
            if spoil:
                with open(names[2], "r+b") as f:
                    f.seek(-8, os.SEEK_END)
                    f.write(array.array("d", [1e6]).tobytes())
            return subprocess.run(report.JULIA + [os.path.join(report.ROOT, "models"), "2", *names],
                                  capture_output=True, text=True)

    def test_it_agrees_with_rbd(self):
        done = self.run_julia(False)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = list(csv.DictReader(io.StringIO(done.stdout)))
        self.assertEqual(list(rows[0]), Schemas.COLUMNS)
        self.assertEqual(sorted((r["robot"], r["algorithm"]) for r in rows), sorted(
            (robot, algorithm) for robot in ("iiwa", "hyq", "atlas") for algorithm in ("id", "mm", "fd")))
        for row in rows:
            self.assertLess(float(row["max_error"]), 1e-10)
            self.assertGreater(float(row["min_ns"]), 0)

    def test_a_wrong_result_is_not_timed(self):
        done = self.run_julia(True)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("atlas, fd: relative error", done.stderr)


class Resuming(unittest.TestCase):
    def test_what_is_there_is_not_measured_again(self):
        with tempfile.TemporaryDirectory() as folder:
            done = []

            def work(name):
                def write(path):
                    done.append(name)
                    if name == "b" and done.count("b") == 1:
                        raise KeyboardInterrupt
                    open(path, "w").close()
                return write

            options = type("options", (), {"output": folder})
            for _ in range(2):
                steps = report.Steps(options)
                for name in "abc":
                    steps.add(name, name, work(name))
                try:
                    steps.run()
                except KeyboardInterrupt:
                    self.assertEqual(sorted(os.listdir(folder)), ["a"])
            self.assertEqual(done, ["a", "b", "b", "c"])

    def test_each_program_is_built_as_this_run_wants_it(self):
        calls, call, built = [], report.call, report.BUILT
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(os.path.join(folder, "build-gcc-native"))
            open(os.path.join(folder, "build-gcc-native", "build.ninja"), "w").close()  # of an earlier run
            report.call, report.BUILT = lambda command: calls.append(command[-1]), {}
            try:
                for fixed_base in (False, False, True, True, False):
                    report.bench(type("options", (), {"output": folder}), "gcc", "native", fixed_base)
            finally:
                report.call, report.BUILT = call, built
        self.assertEqual(calls, ["-Dbench_fixed_base=false", "bench/rbd-bench", "-Dbench_fixed_base=true",
                                 "bench/rbd-bench", "-Dbench_fixed_base=false", "bench/rbd-bench"])


class Staleness(unittest.TestCase):
    MACHINE = {"libraries": ["rbd 1"], "counters": ["task_clock_ns"], "message": "not permitted"}

    def kept(self, folder, machines, again=False):
        """What is left of a report in the folder."""
        options = type("options", (), {"output": folder, "samples": 1, "experiments": 1, "quick": False,
                                       "counters": "auto", "again": again, "cxx": None, "robcogen": ""})
        report.prepare(options, machines)
        return sorted(n for n in os.listdir(folder) if n.endswith(".csv"))

    def test_results_of_another_machine_are_dropped(self):
        everything = ["counts-perf-gcc.csv", "operations.csv", "times-clang-19.csv", "times-gcc.csv"]
        permitted = dict(self.MACHINE, message="", counters=["instructions", "task_clock_ns"])
        with_peer = dict(self.MACHINE, libraries=["MuJoCo 1", "rbd 1"])
        with_names = dict(self.MACHINE, counters=["loads", "task_clock_ns"])
        for other in (permitted, with_peer, with_names):
            with tempfile.TemporaryDirectory() as folder:
                self.kept(folder, {"gcc": self.MACHINE, "clang-19": self.MACHINE})
                for name in everything:
                    open(os.path.join(folder, name), "w").close()
                self.assertEqual(self.kept(folder, {"gcc": self.MACHINE, "clang-19": self.MACHINE}), everything)
                self.assertEqual(self.kept(folder, {"gcc": self.MACHINE}), everything)
                self.assertEqual(self.kept(folder, {"gcc": other}), ["times-clang-19.csv"])
                self.assertEqual(self.kept(folder, {"clang-19": self.MACHINE}, again=True), [])

    def test_the_least_round_of_a_row_counts(self):
        rows = lambda quad, *times: [{"algorithm": str(i), "min_ns": t, "quad_error": quad} for i, t in enumerate(times)]
        self.assertEqual(report.least_of([rows("1e-15", "9.5", "10"), rows("", "11", "8")]), rows("1e-15", "9.5", "8"))

    def test_the_machine_is_what_the_bench_says(self):
        program, report.bench = report.bench, lambda *_: os.path.join(PROGRAMS, "rbd-bench")
        try:
            machine = report.machine_of(None, "gcc")
        finally:
            report.bench = program
        self.assertIn("rbd " + run("rbd-bench", "--version").stdout.split()[1], machine["libraries"])
        self.assertEqual("instructions" in machine["counters"], machine["message"] == "")


def counts_of(names, library="rbd", time=1, source="valgrind"):
    """Rows of made-up counts: 10 instructions, 5 accesses and one of all else per unit of time."""
    for robot, size in (("iiwa", 1), ("hyq", 2), ("atlas", 4)):
        for algorithm in ("id", "mm", "fd"):
            for name in names:
                n = {"instructions": 10, "l1d_accesses": 5}.get(name, 1) * time * size
                yield [source, library, "1", "run-time", "double", robot, algorithm, name, n, 1]


VALGRIND = ["instructions", "loads", "stores", "branches", "branch_misses", "l1d_accesses", "l1d_misses", "fp_scalar",
            "fp_128", "fp_256", "fp_512"]
GENERIC = ["task_clock_ns", "cycles", "instructions", "branches", "branch_misses", "l1d_accesses", "l1d_misses"]


class Sources(unittest.TestCase):
    """Each figure takes the first source that counted what it needs."""

    def figures(self, perf, valgrind):
        times = [Schemas.COLUMNS] + [["rbd", "1", "gcc", "double", robot, algorithm, 1, 1, 9, 0, 9, 0, "", "run-time", 0]
                                     for robot in ("iiwa", "hyq", "atlas") for algorithm in ("id", "mm", "fd")]
        tables = {"times-gcc": times, "times-haswell-gcc": times,
                  "counts-perf-gcc": [callgrind.HEADER] + list(counts_of(perf, source="perf")),
                  "counts-valgrind-gcc": [callgrind.HEADER] + list(counts_of(valgrind))}
        with tempfile.TemporaryDirectory() as folder:
            for name, rows in tables.items():
                with open(os.path.join(folder, name + ".csv"), "w", newline="") as f:
                    csv.writer(f).writerows(rows)
            self.data = Data(folder, ["gcc"])
        found = {f.name.split("_")[0]: f for f in page.figures_of(self.data)}
        for figure in found.values():
            self.assertNotRegex(figure.text, "None|unknown|%s")
            self.assertTrue(figure.text)
        return found

    def hardware(self, found):
        return sorted(n for n, f in found.items() if n != "fig2" and "valgrind" not in f.caption
                      and "callgrind" not in f.caption)

    def test_all_counters(self):
        found = self.figures(GENERIC + VALGRIND + ["stall_cycles", "memory_stall_cycles"], VALGRIND)
        self.assertEqual(self.hardware(found), ["fig3", "fig4", "fig5", "fig6", "fig7"])
        self.assertNotIn("Not counted", report.hardware_note(self.data, ""))

    def test_counters_without_names(self):
        found = self.figures(GENERIC, VALGRIND)
        self.assertEqual(sorted(found), ["fig2", "fig3", "fig4", "fig5", "fig6", "fig7"])
        self.assertEqual(self.hardware(found), ["fig3", "fig7"])
        self.assertIn("Not counted", report.hardware_note(self.data, ""))

    def test_counters_without_names_or_valgrind(self):
        self.assertEqual(sorted(self.figures(GENERIC, [])), ["fig2", "fig3", "fig7"])

    def test_no_hardware(self):
        found = self.figures(["task_clock_ns"], VALGRIND)
        self.assertEqual((len(found), self.hardware(found)), (6, []))
        # permitted since, but what was counted was counted before
        self.assertIn("nothing was counted", report.hardware_note(self.data, ""))
        self.assertIn("not permitted", report.hardware_note(self.data, "hardware counters: not permitted"))

    def test_no_counts(self):
        self.assertEqual(sorted(self.figures([], [])), ["fig2"])


class Readme(unittest.TestCase):
    """The documents have the tables of their report; those of made-up times say these times."""

    def data(self, folder, *cells):
        """A report of rows (library, variant, algorithm, robot, time, disturbed)."""
        with open(os.path.join(folder, "times-gcc.csv"), "w", newline="") as f:
            csv.writer(f).writerows([Schemas.COLUMNS, *(
                [library, "1", "gcc", "double", robot, algorithm, 1, 1, 9 * time, 0, time, 0, 1e-15, variant, disturbed]
                for library, variant, algorithm, robot, time, disturbed in cells)])
        return Data(folder, ["gcc"])

    CELLS = [("rbd", "run-time", "id", "iiwa", 50, 0), ("rbd", "run-time", "id", "hyq", 100, 0),
             ("Pinocchio", "run-time", "id", "iiwa", 400, 0), ("Pinocchio", "run-time", "id", "hyq", 1000, 0),
             ("Pinocchio", "run-time avx512f", "id", "iiwa", 300, 0),
             ("Pinocchio", "run-time avx512f", "id", "hyq", 1100, 0), ("RBDL", "run-time", "id", "iiwa", 5000, 1),
             ("rbd", "lanes 4", "id", "iiwa", 20, 0), ("rbd", "lanes 8", "id", "iiwa", 9.5, 0),
             ("rbd", "generated", "id", "iiwa", 40, 0), ("rbd", "generated", "mm", "iiwa", 30, 0),
             ("rbd", "generated", "mm_packed", "iiwa", 25, 0), ("rbd", "generated", "id_derivatives", "iiwa", 150, 0),
             ("rbd", "generated", "hybrid", "iiwa", 77, 0), ("Pinocchio", "generated code", "mm", "iiwa", 75, 1),
             ("Pinocchio", "generated code", "id", "iiwa", 120, 0),
             ("Pinocchio", "generated code", "id_derivatives", "iiwa", 1500, 0),
             ("RobCoGen", "generated", "id", "iiwa", 200, 0)]

    def test_pinocchio_at_its_best_beside_the_run_time_model(self):
        with tempfile.TemporaryDirectory() as folder:
            lines = readme.run_time(self.data(folder, *self.CELLS)).splitlines()
        self.assertEqual(lines[0], "| ns: iiwa / HyQ / Atlas | rbd | Pinocchio 1 | times as fast as Pinocchio | RBDL 1 |")
        self.assertEqual(lines[2:], ["| inverse dynamics | 50.0 / 100 / – | 300 / 1000 / – | 6.0 / 10 / – | 5000* / – / – |"])

    def test_generated_code_stands_beside_generated_code(self):
        with tempfile.TemporaryDirectory() as folder:
            lines = readme.generated(self.data(folder, *self.CELLS)).splitlines()
        self.assertEqual(lines[0], "| ns: iiwa / HyQ / Atlas | rbd | Pinocchio 1 | times as fast as Pinocchio | RobCoGen 1 |")
        self.assertEqual(lines[2:], [
            "| inverse dynamics | 40.0 / – / – | 120 / – / – | 3.0 / – / – | 200 / – / – |",
            "| mass matrix, one triangle | 25.0 / – / – | 75.0* / – / – | 3.0 / – / – | – |",
            "| derivatives of inverse dynamics | 150 / – / – | 1500 / – / – | 10 / – / – | – |"])

    def test_generated_code_alone_is_in_its_table(self):
        with tempfile.TemporaryDirectory() as folder:
            lines = readme.generated(self.data(folder, *(c for c in self.CELLS if c[0] == "rbd"))).splitlines()
        self.assertEqual(lines[0], "| ns: iiwa / HyQ / Atlas | rbd |")
        self.assertEqual(lines[2:4], ["| inverse dynamics | 40.0 / – / – |", "| mass matrix | 30.0 / – / – |"])

    def test_batches_are_compared_with_no_library(self):
        with tempfile.TemporaryDirectory() as folder:
            lines = readme.batches(self.data(folder, *self.CELLS)).splitlines()
        self.assertEqual(lines[0], "| ns: iiwa / HyQ / Atlas | lanes 4 | lanes 8 |")
        self.assertEqual(lines[2:], ["| inverse dynamics | 20.0 / – / – | 9.50 / – / – |"])

    def test_one_triangle_is_compared_with_one_triangle(self):
        with tempfile.TemporaryDirectory() as folder:
            lines = readme.run_time(self.data(folder, ("rbd", "run-time", "mm", "iiwa", 60, 0),
                                              ("rbd", "run-time", "mm_packed", "iiwa", 50, 0),
                                              ("RBDL", "run-time", "mm", "iiwa", 900, 0),
                                              ("Pinocchio", "run-time", "mm", "iiwa", 500, 0),
                                              ("RigidBodyDynamics.jl", "run-time", "mm", "iiwa", 700, 0))).splitlines()
        self.assertEqual(lines[2:], ["| mass matrix | 60.0 / – / – | – | – | 900 / – / – | – |",
                                     "| mass matrix, one triangle | 50.0 / – / – | 500 / – / – | 10 / – / – | – | 700 / – / – |"])

    def test_tables_are_put_between_their_marks(self):
        with tempfile.TemporaryDirectory() as folder:
            expected = readme.run_time(self.data(folder, *self.CELLS))
            text = "a\n<!-- run-time of %s -->\n%s<!-- end -->\nb\n"
            name = os.path.relpath(folder, readme.ROOT)
            for before in ("", "old\n", expected):
                self.assertEqual(readme.rewritten(text % (name, before)), text % (name, expected))
            self.assertEqual(readme.rewritten(text % ("elsewhere", ""), name), text % (name, expected))

    def test_the_documents_have_the_tables_of_their_report(self):
        names = []
        for document in readme.DOCUMENTS:
            with open(os.path.join(readme.ROOT, document)) as f:
                text = f.read()
            names += [name for _, name, _, _ in readme.MARK.findall(text)]
            self.assertEqual(readme.rewritten(text, document=document), text, "not so: bench/workload/readme.py --write")
        self.assertEqual(sorted(names), sorted(readme.TABLES), "each table stands in one document")


class Sizes(unittest.TestCase):
    """Of generated code: operations that are known, and the command that wrote it."""

    HEADER = ("/* iiwa_code.h - iiwa\n       rbd-codegen --name iiwa --output bench --algorithm id,mm --limbs 4 'a b/iiwa.urdf'\n\n"
              "   Operations: 935 multiplications, 736 additions, 2 divisions, 1 roots, 30 sines and cosines.\n"
              "   Of these 1388 are of 2 limbs at once.\n   And 9048 on four columns of rows at once. */\n")

    def test_operations(self):
        self.assertEqual(sizes.said_operations(self.HEADER), 935 + 736 + 2 + 1 + 9048)
        for source, count in (("y[0] = x[1];", 0), ("v[5] = - v[4];", 0), ("v[1] = -1 * v[0];", 1), ("v[2] = cos(x[1]);", 0),
                              ("y[2] = v[1] * (v[2] + x[3]) - v[4] / 2.5 + -3.e-05 * y[2];", 6), ("// a - b", 1)):
            self.assertEqual(sizes.counted_operations(source), count, source)

    def test_one_function_is_written_by_the_same_command(self):
        self.assertEqual(sizes.command_for(self.HEADER, "fd", "/tmp/x"),
                         ["--name", "iiwa", "--output", "/tmp/x", "--algorithm", "fd", "--limbs", "4", "a b/iiwa.urdf"])

    @unittest.skipUnless(shutil.which("gcc") and shutil.which("size"), "needs gcc and size")
    def test_machine_code_is_measured(self):
        with tempfile.TemporaryDirectory() as folder:
            found = []
            for statements in (1, 1000):
                path = os.path.join(folder, "code.c")
                with open(path, "w") as f:
                    f.write("void f(volatile int *x) { %s }\n" % ("*x = 1; " * statements))
                found.append(sizes.compiled(["gcc"], path, folder))
            self.assertGreater(found[1][0] - found[0][0], 3 * 999)
            self.assertTrue(all(seconds > 0 for _, seconds in found))


@unittest.skipUnless(shutil.which("gnuplot"), "needs gnuplot")
class Page(unittest.TestCase):
    """A page of made-up numbers says these numbers, and others when they are others."""

    def write(self, folder, peer_time, with_counts, disturbed=()):
        times = [Schemas.COLUMNS]
        counts = [callgrind.HEADER, *counts_of(VALGRIND, "rbd", 100), *counts_of(VALGRIND, "MuJoCo", peer_time)]
        for robot, size in (("iiwa", 1), ("hyq", 2), ("atlas", 4)):
            for algorithm in ("id", "mm", "fd"):
                for library, time in (("rbd", 100), ("MuJoCo", peer_time)):
                    times.append([library, "1", "gcc", "double", robot, algorithm, 1, 1, time * size, 0, time * size,
                                  1e-15, 1e-15, "run-time", int((library, robot, algorithm) in disturbed)])
        tables = {"times-gcc": times, "times-haswell-gcc": times}
        if with_counts:
            tables["counts-valgrind-gcc"] = counts
        for name, rows in tables.items():
            with open(os.path.join(folder, name + ".csv"), "w", newline="") as f:
                csv.writer(f).writerows(rows)
        page.write(Data(folder, ["gcc"]), folder, [("machine", "a & b")], ["a note"])
        with open(os.path.join(folder, "report.md")) as f, open(os.path.join(folder, "report.html")) as g:
            return f.read(), g.read()

    def test_sentences_follow_the_data(self):
        with tempfile.TemporaryDirectory() as folder:
            text, html = self.write(folder, 700, True)
            self.assertIn("MuJoCo takes 7.00 (", text)
            self.assertIn("10.0 % load", text)
            self.assertIn("a &amp; b", html)
            self.assertEqual(html.count("data:image/svg+xml;base64,"), text.count("!["))
            self.assertIn("MuJoCo takes 3.00 (", self.write(folder, 300, True)[0])

    def test_disturbed_times_are_marked_and_not_built_on(self):
        with tempfile.TemporaryDirectory() as folder:
            robots, algorithms = ("iiwa", "hyq", "atlas"), ("id", "mm", "fd")
            text, html = self.write(folder, 700, False, [("MuJoCo", "hyq", "mm")])
            for form in (text, html):
                self.assertIn("1400* (7.00×)", form)
                self.assertEqual(form.count("1400* "), 1)
                self.assertIn("left out of the sentences: their least time did not come twice to 3 %", form)
                self.assertIn("may be too large: MuJoCo, HyQ, mass matrix.", form)
            self.assertIn("MuJoCo takes 7.00 (", text)
            text, _ = self.write(folder, 700, False, [("MuJoCo", r, a) for r in robots for a in algorithms])
            self.assertNotIn("MuJoCo takes", text)
            text, _ = self.write(folder, 700, False, [("rbd", r, a) for r in robots for a in algorithms])
            self.assertNotIn("MuJoCo takes", text)
            self.assertNotIn("ns a state. ", text)
            self.assertNotIn("Disturbed", self.write(folder, 700, False)[0])

    def test_a_disturbed_bar_has_a_star(self):
        data = type("data", (), {"robots": [("iiwa", "iiwa"), ("hyq", "HyQ")]})
        bar = figures.Bar("one", "One", "rbd", "run-time")
        drawn = figures.Bars(data, [bar], ["time"], lambda *_: [2.0],
                             "us", True, lambda b, robot, algorithm: robot == "hyq")
        marks = drawn.panel("id", [bar], [])[2]
        self.assertEqual(["*" in m for m in marks], [True])
        self.assertIn("first 2.2, first 2 ", marks[0])

    def test_rbd_has_a_row_of_its_own_beside_much_higher_bars(self):
        data = type("data", (), {"robots": [("iiwa", "iiwa")]})
        ours, peer = figures.Bar("a", "A", "rbd", "run-time"), figures.Bar("b", "B", "KDL", "run-time")
        for height, log, rows in ((40, False, [[ours, peer], [ours]]), (3, False, [[ours, peer]]),
                                  (40, True, [[ours, peer]])):
            rows = [(bars, figures.ALGORITHMS) for bars in rows]
            value = lambda bar, *_: [0.5, 0.5] if bar is ours else [height / 2, height / 2]
            self.assertEqual(figures.Bars(data, [ours, peer], ["x", "y"], value, "", log).rows(), rows)
        self.assertEqual(figures.Bars(data, [ours], ["x"], lambda *_: None, "").rows(), [([ours], figures.ALGORITHMS)])

    def test_other_algorithms_have_rows_of_panels(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "times-gcc.csv"), "w", newline="") as f:
                csv.writer(f).writerows([Schemas.COLUMNS, *(
                    [library, "1", "gcc", "double", "iiwa", algorithm, 1, 1, time, 0, time, 0, 0, "run-time", 0]
                    for algorithm in ("id", "id_derivatives_mm", "minv") for library, time in (("rbd", 100), ("Pinocchio", 250)))])
            data = Data(folder, ["gcc"])
            self.assertEqual([[a for a, _ in g] for g in data.groups], [["id", "mm", "fd"], ["id_derivatives_mm", "fd_derivatives", "minv"]])
            self.assertEqual(page.ratios_table(data)[2], ["Pinocchio", "2.50", "–", "–", "2.50", "–", "2.50"])

    def test_panels_of_other_algorithms_have_only_who_can(self):
        data = type("data", (), {"robots": [("iiwa", "iiwa"), ("hyq", "HyQ")]})
        ours, peer, third = (figures.Bar(name, name, name, "run-time") for name in ("rbd", "KDL", "RBDL"))
        has = {"constrained_fd": [(ours, "hyq"), (peer, "hyq")], "id": [(ours, "hyq")], "fd_derivatives": []}
        value = lambda bar, robot, algorithm: [1.0] if (bar, robot) in has[algorithm] else None
        drawn = figures.Bars(data, [ours, peer, third], ["time"], value, "us")
        self.assertEqual(drawn.cells("constrained_fd", drawn.bars), ([ours, peer], [("hyq", "HyQ")]))
        for algorithm in ("id", "fd_derivatives"):
            self.assertEqual(drawn.cells(algorithm, drawn.bars), (drawn.bars, data.robots))

    def test_each_library_has_a_shade_of_its_own_where_nothing_is_stacked(self):
        data = type("data", (), {"robots": [("iiwa", "iiwa")]})
        ours, peer = figures.Bar("a", "A", "rbd", "run-time"), figures.Bar("b", "B", "KDL", "run-time")
        third, code = figures.Bar("c", "C", "RBDL", "run-time"), figures.Bar("d", "D", "RBDL", "generated")
        plain = figures.Bars(data, [ours, peer, third, code], ["time"], lambda *_: [2.0], "us")
        self.assertEqual(dict(plain.key()), {"rbd": plain.shade(ours, 0), "KDL": plain.shade(peer, 0), "RBDL": plain.shade(third, 0)})
        self.assertEqual(len({plain.shade(b, 0) for b in plain.bars}), 3)
        self.assertEqual(plain.shade(third, 0), plain.shade(code, 0))
        self.assertEqual(figures.Bars(data, [ours], ["time"], lambda *_: [2.0], "us").key(), [])
        stacked = figures.Bars(data, [ours, peer], ["x", "y"], lambda *_: [1.0, 1.0], "us")
        self.assertEqual(dict(stacked.key()), {"x": stacked.shade(peer, 0), "y": stacked.shade(peer, 1)})
        blocks = []
        plain.panel("id", plain.bars, blocks)
        self.assertEqual([int(line.split()[3]) for line in blocks[0].splitlines()],
                         [int(plain.shade(b, 0)[1:], 16) for b in plain.bars])

    def test_code_for_one_robot_and_single_calls_in_float_have_tables(self):
        code = [sizes.HEADER, ["rbd", "iiwa", "id", 12345, 400, 6789, 0.25], ["Pinocchio", "iiwa", "id", 23456, 500, 7890, 1.5],
                ["rbd", "hyq", "id", 1000, 100, 2000, 0.5]]
        grid = [Schemas.COLUMNS, ["rbd", "1", "gcc", "float", "iiwa", "id", 1, 1, 99, 0, 81, 0, "", "run-time", 0],
                ["rbd", "1", "gcc", "float", "hyq", "fd_derivatives", 1, 1, 9999, 0, 1234, 0, "", "run-time", 1],
                ["rbd", "1", "gcc", "float", "atlas", "id", 1, 1, 99, 0, 27, 0, "", "generated", 0]]
        with tempfile.TemporaryDirectory() as folder:
            self.assertNotIn("GRiD", self.write(folder, 700, False)[0])
            for name, rows in (("code-gcc", code), ("grid-gcc", grid)):
                with open(os.path.join(folder, name + ".csv"), "w", newline="") as f:
                    csv.writer(f).writerows(rows)
            text = self.write(folder, 700, False)[0]
        self.assertIn("| id | iiwa | 12.3 / 23.5 | 400 / 500 | 6.8 / 7.9 | 0.25 / 1.50 |", text)
        self.assertIn("| id | HyQ | 1.0 / – | 100 / – | 2.0 / – | 0.50 / – |", text)
        self.assertIn("| ID | 0.081 | – | – |", text)
        self.assertIn("| ∇FD | – | 1.234* | – |", text)
        self.assertIn("| ID, generated code | – | – | 0.027 |", text)
        self.assertNotIn("| ∇FD, generated code |", text)

    def test_without_counts_there_are_only_times(self):
        with tempfile.TemporaryDirectory() as folder:
            text, _ = self.write(folder, 700, False)
            self.assertIn("Figure 2", text)
            self.assertNotIn("Figure 4", text)


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=2).result
    sys.exit(1 if not result.wasSuccessful() else 77 if result.skipped else 0)
