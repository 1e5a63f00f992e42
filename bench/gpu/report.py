#!/usr/bin/env python3
"""report.py FOLDER: makes FOLDER/report.md of what gpu.sh measured there, and prints the short of it.

SPDX-License-Identifier: MIT"""
import csv
import sys
from pathlib import Path

STEPS = 64  # of a rollout
ORDER = ["id", "mm", "minv", "fd", "fd_cholesky", "id_derivatives", "fd_derivatives", "fd_derivatives_in_parts", "product",
         "constrained", "rollout"]
LAYOUTS = ["rows", "blocks", "columns"]
COUNTERS = {
    "gpu__time_duration.sum": "time",
    "dram__throughput.avg.pct_of_peak_sustained_elapsed": "DRAM, % of peak",
    "smsp__issue_active.avg.pct_of_peak_sustained_active": "issue, % of peak",
    "sm__warps_active.avg.pct_of_peak_sustained_active": "warps, % of most",
    "dram__bytes.sum": "DRAM",
    "lts__t_bytes.sum": "L2",
    "l1tex__t_bytes_pipe_lsu_mem_local_op_ld.sum": "read of local memory",
    "smsp__inst_executed.sum": "warp instructions",
    "smsp__average_warps_issue_stalled_no_instruction_per_issue_active.ratio": "waiting for instructions",
    "smsp__average_warps_issue_stalled_long_scoreboard_per_issue_active.ratio": "for memory",
    "smsp__average_warps_issue_stalled_lg_throttle_per_issue_active.ratio": "for its queue",
    "smsp__thread_inst_executed_per_inst_executed.ratio": "threads at work, of 32",
}


def short(x):
    """Three digits with a unit of SI, as 12.3 G."""
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if x >= size:
            return f"{x / size:.3g} {unit}"
    return f"{x:.3g}"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" + "|--:" * (len(head) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


class Results:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.rows = [row for row in csv.DictReader(file) if row["GB_per_s"]]
        for row in self.rows:
            row["states"] = int(row["states"])
            row["rate"] = float(row["states_per_s"]) * (STEPS if row["algorithm"] == "rollout" else 1)

    def of(self, **wanted):
        return [row for row in self.rows if all(row[key] == value for key, value in wanted.items())]

    def values(self, key, **wanted):
        return list(dict.fromkeys(row[key] for row in self.of(**wanted)))

    def algorithms(self, **wanted):
        return sorted(self.values("algorithm", **wanted), key=ORDER.index)

    def best(self, **wanted):
        """The row with most states a second."""
        return max(self.of(**wanted), key=lambda row: row["rate"], default=None)


def layouts(results, scalar):
    rows = []
    for robot in results.values("robot", program="generated", scalar=scalar):
        for algorithm in results.algorithms(robot=robot, program="generated", scalar=scalar):
            cells = []
            for layout in LAYOUTS:
                best = results.best(robot=robot, algorithm=algorithm, scalar=scalar, layout=layout, program="generated")
                cells.append(f"{short(best['rate'])} ({float(best['GB_per_s']):.0f})" if best else "–")
            errors = [float(row["error"]) for row in results.of(robot=robot, algorithm=algorithm, scalar=scalar)]
            rows.append([f"{robot} {algorithm}"] + cells + [f"{max(errors):.0e}"])
    return table([f"{scalar}: states/s (GB/s)"] + LAYOUTS + ["error"], rows)


def sizes(results, scalar):
    wanted = {"program": "generated", "scalar": scalar, "layout": "blocks"}
    counts = sorted(set(results.values("states", **wanted)))
    rows = []
    for robot in results.values("robot", **wanted):
        for algorithm in results.algorithms(robot=robot, **wanted):
            cells = {row["states"]: short(row["rate"]) for row in results.of(robot=robot, algorithm=algorithm, **wanted)}
            rows.append([f"{robot} {algorithm}"] + [cells.get(n, "–") for n in counts])
    return table([f"{scalar}, blocks: states"] + [str(n) for n in counts], rows)


def beside_grid(results):
    rows = []
    for robot in results.values("robot", program="grid"):
        for algorithm in results.algorithms(robot=robot, program="grid"):
            for n in results.values("states", robot=robot, algorithm=algorithm, program="grid"):
                grid = results.best(robot=robot, algorithm=algorithm, program="grid", states=n)
                own = results.best(robot=robot, algorithm=algorithm, program="generated", scalar="float", states=n)
                rows.append([f"{robot} {algorithm} {n}", short(grid["rate"]), short(own["rate"]) if own else "–",
                             f"{own['rate'] / grid['rate']:.1f}" if own else "–", grid["right"]])
    return table(["states/s", "GRiD", "rbd", "ratio", "GRiD's results"], rows) if rows else ""


def counters(path):
    if not path.exists() or path.stat().st_size == 0:
        return ""
    kernels = {}
    with open(path, encoding="utf-8") as file:
        for row in csv.reader(file):
            name, unit, value = row[-3:]
            if name in COUNTERS:
                kernels.setdefault(" ".join(row[:3]), {})[name] = f"{value} {'' if unit in ('%', 'inst', 'ratio') else unit}".strip()
    return table(["one launch"] + list(COUNTERS.values()),
                 [[kernel] + [found.get(name, "–") for name in COUNTERS] for kernel, found in kernels.items()])


def text_of(path):
    return path.read_text(encoding="utf-8", errors="replace").strip() if path.exists() else ""


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    results = Results(folder / "results.csv")
    parts = ["# Generated code on a GPU\n", "```text\n" + text_of(folder / "machine.txt") + "\n```\n"]
    for row in results.of(program="device"):
        parts.append(f"A copy of {row['states'] * 4 >> 20} MiB: {float(row['GB_per_s']):.0f} GB/s, read and written "
                     f"({row['robot']}, {row['scalar']}).\n")
        break
    wrong = [row for row in results.rows if row["right"] != "right"]
    parts.append(f"{len(results.rows)} results, {len(wrong)} wrong: each kernel was compared with generated C in double.\n")
    parts += [f"WRONG: {row}\n" for row in wrong[:10]]
    parts.append("States a second, the most over all sizes; a rollout counts its steps.\n")
    for scalar in results.values("scalar", program="generated"):
        parts += [layouts(results, scalar), sizes(results, scalar)]
    parts += [beside_grid(results), counters(folder / "counters.csv")]
    for name in ("unprofiled.txt", "falling.txt", "python.txt", "mppi.txt", "errors.txt"):
        if text_of(folder / name):
            parts.append(f"{name.split('.')[0]}:\n\n```text\n{text_of(folder / name)}\n```\n")
    page = "\n".join(part for part in parts if part)
    (folder / "report.md").write_text(page, encoding="utf-8")
    print(page[-11000:])
    return 1 if wrong or text_of(folder / "errors.txt") else 0


if __name__ == "__main__":
    sys.exit(main())
