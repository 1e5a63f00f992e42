"""What was measured, as figures and sentences ask for it. SPDX-License-Identifier: MIT"""
import copy
import csv
import math
import os

ALGORITHMS = [("id", "inverse dynamics"), ("mm", "mass matrix"), ("fd", "forward dynamics")]
# Beside the paper's three: a row of panels each in the figures.
MORE = [[("id_derivatives_mm", "derivatives of inverse dynamics, and M"), ("fd_derivatives", "derivatives of forward dynamics"), ("minv", "M⁻¹")],
        [("jacobian", "Jacobian"), ("momentum_matrix", "momentum matrix"), ("regressor", "regressor")],
        [("coriolis", "Coriolis matrix"), ("constrained_fd", "constrained dynamics"),
         ("constrained_fd_hand", "constrained, a hand too")]]
ROBOTS = [("iiwa", "iiwa"), ("hyq", "HyQ"), ("atlas", "Atlas")]


class Bar:
    """One bar of a cluster: a library and how it is called."""

    def __init__(self, label, title, library, variant, scalar="double"):
        self.label, self.title, self.library, self.variant, self.scalar = label, title, library, variant, scalar

    def fits(self, row):
        return (row["library"] == self.library and row["scalar"] == self.scalar
                and row["variant"].split()[0] == self.variant.split()[0]
                and (" " not in self.variant or row["variant"] == self.variant))


RUN_TIME = Bar("run-time", "rbd with a run-time model", "rbd", "run-time")
GENERATED = Bar("generated", "rbd's generated code", "rbd", "generated")
OURS = [RUN_TIME, GENERATED, Bar("lanes", "rbd by lanes", "rbd", "lanes")]
GENERATED_LANES = Bar("generated lanes", "rbd's generated code by lanes", "rbd", "generated-lanes")
PEERS = [Bar("MuJoCo", "MuJoCo", "MuJoCo", "run-time"), Bar("KDL", "KDL", "KDL", "run-time"),
         Bar("RBDL", "RBDL", "RBDL", "run-time"), Bar("Pinocchio", "Pinocchio", "Pinocchio", "run-time"),
         Bar("Pinocchio code", "Pinocchio's generated code", "Pinocchio", "generated"),
         Bar("RobCoGen", "RobCoGen", "RobCoGen", "generated"), Bar("dynibo", "dynibo", "dynibo", "run-time"),
         Bar("RBD.jl", "RigidBodyDynamics.jl", "RigidBodyDynamics.jl", "run-time")]


def read(path):
    if not os.path.exists(path):
        return []
    with open(path, newline="") as f:
        return list(csv.DictReader(f))


def is_disturbed(row):
    """Of a row of times; tables from before this was measured do not tell."""
    return row.get("disturbed", "0") != "0"


class Data:
    """The tables of one report. times and counts: {compiler: rows}; the first compiler is the one of the figures."""

    def __init__(self, folder, compilers):
        self.compilers = compilers
        self.times = {c: read(os.path.join(folder, "times-%s.csv" % c)) for c in compilers}
        self.haswell = {c: read(os.path.join(folder, "times-haswell-%s.csv" % c)) for c in compilers}
        self.counts = {c: sum((read(os.path.join(folder, "counts-%s-%s.csv" % (source, c)))
                               for source in ("perf", "valgrind")), []) for c in compilers}
        self.operations = read(os.path.join(folder, "operations.csv"))
        self.grid, self.code = (read(os.path.join(folder, "%s-%s.csv" % (name, compilers[0]))) for name in ("grid", "code"))
        self.scaling = {c: read(os.path.join(folder, "scaling-%s.csv" % c)) for c in compilers}
        self.main = compilers[0]
        self.source = None  # of count, unless told: see counted
        rows = self.times[self.main]
        self.peers = [b for b in PEERS if any(b.fits(r) for r in rows)]
        self.ours = [b for b in OURS if any(b.fits(r) for r in rows)]
        self.bars = self.ours + self.peers
        self.robots = [r for r in ROBOTS if any(row["robot"] == r[0] for row in rows)]
        timed = {row["algorithm"] for row in rows}
        self.groups = [ALGORITHMS] + [g for g in MORE if timed & {a for a, _ in g}]
        self.index = {}
        for c in compilers:
            for row in self.counts[c]:
                key = (c, row["source"], row["library"], row["variant"], row["scalar"], row["robot"],
                       row["algorithm"])
                self.index.setdefault(key, {})[row["counter"]] = float(row["per_state"])

    def time_row(self, bar, robot, algorithm, compiler=None, table=None):
        """A row of the table of times, or None: of a library that is compiled or called in several ways the least."""
        found = [row for row in (table or self.times)[compiler or self.main]
                 if bar.fits(row) and row["robot"] == robot and row["algorithm"] == algorithm]
        return min(found, key=lambda row: float(row["min_ns"]), default=None)

    def time(self, bar, robot, algorithm, compiler=None, field="min_ns", table=None):
        """A number of the table of times, or None."""
        row = self.time_row(bar, robot, algorithm, compiler, table)
        return float(row[field]) if row and row[field] else None

    def disturbed(self, bar, robot, algorithm, compiler=None, table=None):
        """Whether the least time did not come twice when it was measured: what sentences do not build on."""
        row = self.time_row(bar, robot, algorithm, compiler, table)
        return bool(row) and is_disturbed(row)

    def sure(self, value, compiler=None, table=None):
        """value(bar, robot, algorithm) where its time was not disturbed, else None."""
        return lambda *cell: None if self.disturbed(*cell, compiler, table) else value(*cell)

    def has(self, source, *counters):
        """Whether the source counted all of these."""
        return set(counters) <= {r["counter"] for r in self.counts[self.main] if r["source"] == source}

    def counted(self, perf, valgrind):
        """The same data with its counts from hardware if that has all of the counters named for it, else from
        valgrind if that has all of its; None if neither has."""
        for source, counters in (("perf", perf), ("valgrind", valgrind)):
            if self.has(source, *counters):
                one = copy.copy(self)
                one.source = source
                return one
        return None

    def count(self, bar, robot, algorithm, counter, source=None, compiler=None):
        """A counter per state, or None; of several ways the one that took the least time in the build that counted."""
        source = source or self.source
        found = {}
        for key, counters in self.index.items():
            c, s, library, variant, scalar, r, a = key
            if (c == (compiler or self.main) and s == source and r == robot and a == algorithm
                    and bar.fits({"library": library, "variant": variant, "scalar": scalar})):
                found[variant] = counters.get(counter)
        if len(found) > 1:
            row = self.time_row(bar, robot, algorithm, compiler, self.haswell if source == "valgrind" else self.times)
            if row and row["variant"] in found:
                return found[row["variant"]]
        return next(iter(found.values()), None)

    def operation(self, robot, algorithm, *names):
        found = [float(r["per_state"]) for r in self.operations
                 if r["robot"] == robot and r["algorithm"] == algorithm and r["counter"] in names]
        return sum(found) if found else None

    def threads(self):
        """The bars of lanes on several threads."""
        names = []
        for row in self.times[self.main]:
            if row["variant"].startswith("threads") and row["variant"] not in names:
                names.append(row["variant"])
        return [Bar(n, "rbd by lanes on %s threads" % n.split()[1], "rbd", n) for n in names]


def ratios(data, value, bar, reference, algorithms=ALGORITHMS):
    """value(bar, robot, algorithm) / value(reference, ...) wherever both are known, with their places."""
    found = []
    for algorithm, _ in algorithms:
        for robot, _ in data.robots:
            a, b = value(bar, robot, algorithm), value(reference, robot, algorithm)
            if a is not None and b:
                found.append((a / b, robot, algorithm))
    return found


def mean(numbers):
    """Geometric."""
    return math.exp(sum(math.log(x) for x in numbers) / len(numbers))
