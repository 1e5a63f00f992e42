#!/usr/bin/env python3
"""Tables and figures of README.md and docs/performance.md, from a report that is kept in bench/results.

A table stands between '<!-- NAME of FOLDER -->' and '<!-- end -->'; NAME: a function of TABLES.

SPDX-License-Identifier: MIT
"""
import argparse
import os
import re
import sys
import textwrap

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from data import GENERATED, PEERS, ROBOTS, RUN_TIME, Bar, Data  # noqa: E402

DOCUMENTS = ("README.md", "docs/performance.md")
MARK = re.compile(r"(<!-- (\S+) of (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)

# A row: its title, rbd's algorithm, and that of libraries whose mass matrix is one triangle.
ROWS = [("inverse dynamics", "id", "id"), ("mass matrix", "mm", None), ("mass matrix, one triangle", "mm_packed", "mm"),
        ("forward dynamics", "fd", "fd"), ("M⁻¹", "minv", "minv"), ("Jacobian of the last body", "jacobian", "jacobian"),
        ("derivatives of inverse dynamics, and M", "id_derivatives_mm", "id_derivatives_mm"),
        ("derivatives of inverse dynamics", "id_derivatives", "id_derivatives"),
        ("derivatives of forward dynamics, and M⁻¹", "fd_derivatives", "fd_derivatives"), ("Coriolis matrix", "coriolis", "coriolis"),
        ("centroidal momentum matrix", "momentum_matrix", "momentum_matrix"), ("torque regressor", "regressor", "regressor"),
        ("constrained dynamics, 12 rows", "constrained_fd", "constrained_fd")]


def number(x):
    """Three digits, or all before the point."""
    return "%.0f" % x if x >= 100 else "%.1f" % x if x >= 10 else "%.2f" % x


def ratio(x):
    """Two digits, or all before the point."""
    return "%.0f" % x if x >= 10 else "%.1f" % x


def is_ours(bar):
    return bar.library == "rbd"


ONE_TRIANGLE = ("Pinocchio", "RigidBodyDynamics.jl")


def algorithm_of(bar, row):
    """The bar's algorithm for a row, or None."""
    _, ours, one_triangle = row
    return one_triangle if bar.library in ONE_TRIANGLE else ours


def cell(values):
    """Of the robots: what is known, with a dash for the others; empty if nothing is."""
    return " / ".join(values) if set(values) != {"–"} else "–"


def time_cell(data, bar, row):
    values = []
    for robot, _ in ROBOTS:
        found = data.time_row(bar, robot, algorithm_of(bar, row))
        star = "*" if found and data.disturbed(bar, robot, algorithm_of(bar, row)) else ""
        values.append(number(float(found["min_ns"])) + star if found else "–")
    return cell(values)


def ratio_cell(data, own, bar, row):
    """How many times as fast as the bar rbd's own is."""
    values = []
    for robot, _ in ROBOTS:
        ours, other = data.time(own, robot, row[1]), data.time(bar, robot, algorithm_of(bar, row))
        values.append(ratio(other / ours) if ours and other else "–")
    return cell(values)


def title(data, bar):
    """The library's name, of another with its version."""
    versions = {row["version"] for row in data.times[data.main] if bar.fits(row)} - {"code"}
    return bar.library if is_ours(bar) else " ".join([bar.library, *sorted(versions)[:1]])


def table(head, rows):
    """In Markdown, without the rows that say nothing."""
    rows = [row for row in rows if set(row[1:]) != {"–"}]
    return "".join("| %s |\n" % " | ".join(row) for row in [head, ["---"] + ["--:"] * (len(head) - 1)] + rows).replace(
        "| --- |", "|---|").replace(" --: |", "--:|")


def present(data, bars):
    return [b for b in bars if any(b.fits(row) for row in data.times[data.main])]


def beside(data, own):
    """One of rbd's bars beside the libraries that are called in the same way."""
    peers = present(data, [b for b in PEERS if b.variant == own.variant])
    peers.sort(key=lambda b: b.library != "Pinocchio")
    ratios = [b for b in peers if b.library == "Pinocchio"]
    bars = [own] + ratios
    others = [b for b in peers if b not in ratios]
    head = ["ns: " + " / ".join(t for _, t in ROBOTS)] + [title(data, b) for b in bars] + [
        "times as fast as %s" % b.library for b in ratios] + [title(data, b) for b in others]
    return table(head, [[row[0]] + [time_cell(data, b, row) for b in bars] + [ratio_cell(data, own, b, row) for b in ratios]
                        + [time_cell(data, b, row) for b in others] for row in ROWS
                        if any(data.time(b, r, algorithm_of(b, row)) for b in peers or bars for r, _ in ROBOTS)])


def run_time(data):
    """rbd and the libraries that take any robot when they run."""
    return beside(data, RUN_TIME)


def generated(data):
    """The code for one robot that rbd-codegen writes, and that of others."""
    return beside(data, GENERATED)


def batches(data):
    """rbd on many states at once."""
    variants = {row["variant"] for row in data.times[data.main] if row["library"] == "rbd" and row["scalar"] == "double"}
    bars = [Bar(v, v, "rbd", v) for v in sorted((v for v in variants if v.split()[0] in ("lanes", "generated-blocks")),
                                                key=lambda v: (v.split()[0] != "lanes", int(v.split()[1])))]
    return table(["ns: " + " / ".join(t for _, t in ROBOTS)] + [b.variant for b in bars],
                 [[row[0]] + [time_cell(data, b, row) for b in bars] for row in ROWS])


def facts_of(folder):
    """Name and value of each fact of report.md."""
    with open(os.path.join(folder, "report.md")) as f:
        rows = [line.strip("| \n").split(" | ") for line in f if line.startswith("|")]
    return dict(row for row in rows if len(row) == 2)


def paragraph(text):
    return textwrap.fill(" ".join(text.split()), 118, break_long_words=False, break_on_hyphens=False) + "\n"


def machine(data):
    """A paragraph on the machine, the compilers and their flags."""
    facts = facts_of(data.folder)
    return paragraph("""Times per state in double, the least of short chunks, on one core of a virtual machine (%s), by
        [this report](%s/report.md) of %s. rbd is compiled by %s with `%s`; %s.""" % (
            facts["machine"].split(",")[0], data.link, facts["date"].split()[0],
            facts["compilers"].split(";")[0], facts["flags"].split(";")[0], facts["flags of others"]))


def accuracy(data):
    """A sentence."""
    worst = {}
    for row in data.times[data.main]:
        if row["library"] == "rbd" and row["scalar"] == "double" and row["quad_error"]:
            group = row["algorithm"] in ("id", "mm", "mm_packed", "fd")
            worst[group] = max(worst.get(group, 0), float(row["quad_error"]))
    return paragraph("""Against quad precision the largest error of rbd's results in double, relative to the largest
        entry, over 200 states of each robot, was %.1e in inverse dynamics, mass matrix and forward dynamics, and %.1e in
        all calls.""" % (worst[True], max(worst.values())))


TABLES = {"machine": machine, "run-time": run_time, "generated": generated, "batches": batches, "accuracy": accuracy}


def rewritten(text, report=None, root=ROOT, document="README.md"):
    """The text of a document with its tables made anew, from another report if one is named."""
    def one(found):
        folder = report or found[3]
        compiler = sorted(os.listdir(os.path.join(root, folder)))
        compiler = [n[len("times-"):-len(".csv")] for n in compiler if n.startswith("times-") and "haswell" not in n]
        compiler.sort(key=lambda c: c != "gcc")
        data = Data(os.path.join(root, folder), compiler)
        data.folder = os.path.join(root, folder)
        data.link = os.path.relpath(folder, os.path.dirname(document))
        return "<!-- %s of %s -->\n%s%s" % (found[2], folder, TABLES[found[2]](data), found[4])
    return MARK.sub(one, text)


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("files", nargs="*", default=[os.path.join(ROOT, d) for d in DOCUMENTS])
    p.add_argument("--write", action="store_true", help="write the tables into the files (default: say whether they differ)")
    p.add_argument("--report", metavar="FOLDER", help="with --write: take this one of bench/results, as from the project's folder")
    o = p.parse_args()
    status = 0
    for path in o.files:
        with open(path) as f:
            text = f.read()
        new = rewritten(text, o.report, document=os.path.relpath(path, ROOT))
        if new == text:
            continue
        if o.write:
            with open(path, "w") as f:
                f.write(new)
        else:
            status = 1
            print("%s: its tables are not those of the report: bench/workload/readme.py --write" % path)
    return status


if __name__ == "__main__":
    sys.exit(main())
