"""Figures of docs/gpu.md, README.md: lines and sentences made from the kept run on a GPU, for figures.py.

SPDX-License-Identifier: MIT"""
import csv
import pathlib
import re

FOLDER = "bench/results/2026-11-27-h200"
ROBOTS = ["iiwa", "hyq", "atlas"]
ALGORITHMS = ["id", "mm", "minv", "fd", "fd_cholesky", "id_derivatives", "fd_derivatives", "fd_derivatives_in_parts",
              "constrained", "rollout"]
STEPS = 64  # of a rollout, whose rows count rollouts


def rows_of(root, name):
    with open(root / FOLDER / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def three_digits(x):
    return f"{float(f'{x:.3g}'):.10g}"


class Run:
    def __init__(self, root):
        self.rate, self.microseconds, self.error, self.gigabytes = {}, {}, {}, {}
        for row in rows_of(root, "results.csv"):
            key = row["program"], row["robot"], row["scalar"], row["algorithm"], row["layout"]
            steps = STEPS if row["algorithm"] == "rollout" else 1
            self.rate.setdefault(key, {})[int(row["states"])] = steps * float(row["states_per_s"])
            self.microseconds[key, int(row["states"])] = float(row["microseconds"])
            self.error[key[:4]] = max(float(row["error"]), self.error.get(key[:4], 0))
            self.gigabytes[key] = max(float(row["GB_per_s"]), self.gigabytes.get(key, 0))
        self.registers = {(r["robot"], r["scalar"], r["algorithm"], r["layout"]): r for r in rows_of(root, "registers.csv")}
        self.page = (root / FOLDER / "report.md").read_text(encoding="utf-8")

    def best(self, robot, algorithm, layout="blocks", scalar="float"):
        """States a second, the most over all sizes; None where it did not run."""
        found = self.rate.get(("generated", robot, scalar, algorithm, layout))
        return max(found.values()) if found else None

    def at(self, n, robot, algorithm, layout="blocks", program="generated"):
        return self.rate["generated" if program == "generated" else program, robot, "float", algorithm, layout][n]


def millions(x):
    return three_digits(x / 1e6) if x else "–"


def rates(run, scalar):
    """Rows: blocks and rows of each robot."""
    for algorithm in ALGORITHMS:
        cells = [millions(run.best(robot, algorithm, layout, scalar)) for robot in ROBOTS for layout in ("blocks", "rows")]
        if set(cells) != {"–"}:
            yield f"| `{algorithm}` | " + " | ".join(cells) + " |"


def registers(run):
    """Rows: registers, and bytes that are written to and read from local memory."""
    for algorithm in ALGORITHMS:
        cells = []
        for robot in ROBOTS:
            found = run.registers.get((robot, "float", algorithm, "blocks"))
            cells += [found["registers"], found["bytes spilled"]] if found else ["–", "–"]
        if set(cells) != {"–"}:
            yield f"| `{algorithm}` | " + " | ".join(cells) + " |"


def errors(run):
    for algorithm in ALGORITHMS:
        cells = [run.error.get(("generated", robot, "float", algorithm)) for robot in ROBOTS]
        yield f"| `{algorithm}` | " + " | ".join(f"{x:.0e}" if x else "–" for x in cells) + " |"


def beside_grid(run):
    for robot, title in (("grid_iiwa", "iiwa"), ("grid_hyq", "HyQ, fixed")):
        for algorithm in ("id", "fd_derivatives"):
            for n in (256, 4096, 65536, 1 << 20):
                other = run.at(n, robot, algorithm, "rows", "grid")
                own = [run.at(n, robot, algorithm, layout) for layout in ("blocks", "rows")]
                yield (f"| {title} `{algorithm}` {n} | {millions(other)} | {millions(own[0])} | {millions(own[1])} | "
                       f"{three_digits(own[0] / other)} | {three_digits(own[1] / other)} |")


def contact_steps(run):
    """Robots and steps a second, of the kept page."""
    return [(int(n), float(rate)) for n, rate in re.findall(r"^(\d+) robots, 1000 steps .*, (\S+) steps/s$", run.page, re.M)]


def marks(run):
    def row(what, mark, measured):
        return f"| {what} | {three_digits(mark / 1e6)} | {millions(measured)} | {'met' if measured >= mark else 'missed'} |"

    for algorithm, wanted in (("id", (1e10, 5e9, 2e9)), ("fd", (1e10, 3e9, 5e8)), ("fd_derivatives", (2e9,))):
        for robot, title, mark in zip(ROBOTS, ("iiwa", "HyQ", "Atlas"), wanted):
            yield row(f"`{algorithm}`, {title}", mark, run.best(robot, algorithm))
    yield row("contact steps, HyQ", 3e7, max(rate for _, rate in contact_steps(run)))


def ratios(run, algorithm, robot, layout, other):
    """Of the rates in two layouts, at the sizes from 65536 on."""
    of = [run.rate["generated", robot, "float", algorithm, name] for name in (layout, other)]
    return [of[0][n] / of[1][n] for n in of[0] if n >= 65536]


def sentences(root):
    run = Run(root)
    page = "docs/gpu.md"
    for lines in (rates(run, "float"), rates(run, "double"), registers(run), errors(run), beside_grid(run), marks(run)):
        yield from ((page, line) for line in lines)
    matrices = [x for a in ("mm", "minv", "id_derivatives", "fd_derivatives") for r in ROBOTS if run.best(r, a, "rows")
                for x in ratios(run, a, r, "blocks", "rows")]
    yield page, (f"Matrices in rows take {min(matrices):.0f} to {max(matrices):.0f} times as long as in blocks, from 65536 states on.")
    vectors = {r: max(ratios(run, "id", r, "blocks", "rows")) for r in ROBOTS}
    yield page, (f"Inverse dynamics in rows takes up to {vectors['iiwa']:.1f} times as long (iiwa), {vectors['hyq']:.1f} times (HyQ), "
                 f"{vectors['atlas']:.1f} times (Atlas);")
    forward = max(x for r in ("iiwa", "hyq") for x in ratios(run, "fd", r, "rows", "blocks"))
    yield page, f"`fd` of the iiwa and HyQ is faster in rows, up to {forward:.1f} times,"
    parts = run.best("hyq", "fd_derivatives_in_parts") / run.best("hyq", "fd_derivatives")
    yield page, f"For HyQ the parts are {parts:.1f} times as fast as one function."
    slower = [run.best(r, a) / run.best(r, a, scalar="double") for a in ALGORITHMS for r in ROBOTS
              if run.best(r, a, scalar="double")]
    yield page, f"`double` takes {min(slower):.1f} to {max(slower):.1f} times as long as `float` here"
    short, long = (run.microseconds[("generated", "iiwa", "float", "id", "blocks"), n] for n in (256, 16384))
    yield page, f"inverse dynamics of the iiwa takes {short:.1f} us for 256 states and {long:.1f} us for 16384"
    copy = re.search(r"A copy of .*: (\d+) GB/s", run.page)[1]
    most = max(run.gigabytes["generated", r, "float", "id", "blocks"] for r in ROBOTS)
    yield page, f"A copy runs at {copy} GB/s, `id` of the iiwa at {most:.0f}"
    ticks = re.findall(r"^(\d+) samples: a tick takes (\d+) us .*, (\d+) us", run.page, re.M)
    yield page, (f"A tick of {ticks[0][0]} samples takes {ticks[0][1]} us (cart-pole, 60 knots) and {ticks[0][2]} us (iiwa, 30 knots), one of "
                 f"{ticks[1][0]} samples {ticks[1][1]} and {ticks[1][2]} us.")
    steps = contact_steps(run)
    yield page, (f"{steps[0][0]} robots make {three_digits(steps[0][1] / 1e6)} million steps a second, {steps[-1][0]} robots "
                 f"{three_digits(steps[-1][1] / 1e6)} million.")
    giga = [run.best(r, "id") / 1e9 for r in ROBOTS]
    yield "README.md", ("One NVIDIA H200 computes, in `float`, "
                        f"{giga[0]:.0f} / {giga[1]:.0f} / {giga[2]:.0f} thousand million inverse dynamics a second (iiwa / HyQ / Atlas)")
    yield "README.md", f"and {max(rate for _, rate in steps) / 1e6:.0f} million contact steps of HyQ"
