"""report.md, and the same as one HTML file that needs no other. SPDX-License-Identifier: MIT"""
import base64
import html
import os

import figures
import words
from data import ALGORITHMS, RUN_TIME, is_disturbed, mean, ratios


class Figure:
    def __init__(self, name, title, caption, draw, text):
        self.name, self.title, self.caption, self.draw, self.text = name, title, caption, draw, text


def bars(data, which, parts, value, ylabel, log=False, disturbed=None, groups=(ALGORITHMS,)):
    return lambda folder, name, title: figures.Bars(data, which, parts, value, ylabel, log, disturbed, groups).draw(
        folder, name, title)


STAR = " A star: disturbed, its least time did not come twice to 3 % and may be too large."


def figures_of(data):
    """The figures that the data suffice for."""
    f, found = figures, []
    add = lambda *arguments: found.append(Figure(*arguments))
    add("fig2_time", "Figure 2: time per state",
        "Microseconds per state, the least of the experiments, on a logarithmic axis. A dash: the library lacks this."
        + STAR,
        bars(data, data.bars, ["time"], f.times(data), "microseconds", True, data.disturbed, data.groups), words.times(data))
    counts(data, add)
    if data.scaling[data.main]:
        add("throughput", "Throughput", "States per second by calls of one state, by lanes and on threads; "
            "logarithmic. Threads take double." + STAR,
            bars(data, f.throughput_bars(data), ["throughput"], f.throughput(data), "million states / s", True,
                 data.disturbed),
            words.throughput(data))
        add("scaling", "Time against the number of bodies",
            "Chains and binary trees of revolute joints on a fixed base, run-time model, double.",
            lambda folder, name, title: f.scaling(data, folder, name, title), words.scaling(data))
    if any(r["quad_error"] for r in data.times[data.main]):
        add("accuracy", "Accuracy", "Largest relative error against the same source in quad precision; logarithmic.",
            bars(data, f.accuracy_bars(data), ["error"], f.accuracy(data), "relative error", True),
            words.accuracy(data))
    if len(data.compilers) > 1:
        add("compilers", "Compilers", "Time of the run-time model, as a multiple of that with %s.%s" % (data.main, STAR),
            bars(data, f.compiler_bars(data), ["time"], f.against_first(data), "time / time with " + data.main,
                 disturbed=f.disturbed_compilers(data)), words.compilers(data))
    return found


def counts(data, add):
    """Figures 3 to 7 of the paper, each from the first source that counted what it needs."""
    for figure, perf, valgrind in (
            (rate, ("instructions", "cycles"), ("instructions",)),
            (kinds, ("instructions", "loads", "stores", "branches"), ("instructions", "loads", "stores", "branches")),
            (cycles, ("cycles", "stall_cycles", "memory_stall_cycles"),
             ("instructions", "branch_misses", "l1d_misses")),
            (widths, ("fp_scalar", "fp_128", "fp_256"), ("fp_scalar", "fp_128", "fp_256")),
            (caches, ("l1d_accesses", "l1d_misses"), ("l1d_accesses", "l1d_misses"))):
        counted = data.counted(perf, valgrind)
        if counted:
            figure(counted, counted.source == "perf", add)


AGAINST = "as multiples of what rbd with a run-time model needs for the same robot and algorithm"


def rate(data, hardware, add):
    add("fig3_ipc", "Figure 3: " + ("instructions per cycle" if hardware else "instructions per nanosecond"),
        "By hardware counters." if hardware else
        "No cycle counter here: instructions of the -march=haswell build by valgrind, over the time of that build. "
        "Divided by the clock in GHz they are the instructions per cycle." + STAR,
        bars(data, data.bars, ["rate"], figures.rate(data), "instructions / " + ("cycle" if hardware else "ns"),
             disturbed=None if hardware else figures.disturbed_rate(data),
             groups=data.groups),
        words.rate(data))


def kinds(data, hardware, add):
    f = figures
    add("fig4_instructions", "Figure 4: instructions",
        "By %s; %s. One instruction may load, compute and store: kinds, in the text, do not add up to all." % (
            "hardware counters" if hardware else "valgrind", AGAINST),
        bars(data, data.bars, ["instructions"], f.counts_of(data, ["instructions"], f.instructions(data)),
             "instructions / rbd's", groups=data.groups), words.kinds(data))


def cycles(data, hardware, add):
    names, parts, total = figures.cycle_parts(data)
    add("fig5_cycles", "Figure 5: cycles" + ("" if hardware else " by a model"),
        "By %s; %s." % ("hardware counters" if hardware else "callgrind's estimate, not a measurement", AGAINST),
        bars(data, data.bars, names, figures.counts_of(data, parts, total), "cycles / rbd's", groups=data.groups), words.cycles(data))


def widths(data, hardware, add):
    wide = hardware and data.has("perf", "fp_512")  # valgrind's build has none; nor have all processors
    counters = ["fp_scalar", "fp_128", "fp_256"] + (["fp_512"] if wide else [])
    names = ["scalar", "128 bits", "256 bits"] + (["512 bits"] if wide else [])
    add("fig6_fp", "Figure 6: floating-point operations by width", "By %s, an FMA as two; %s." % (
        "FP_ARITH events" if hardware else "valgrind and disassembly", AGAINST),
        bars(data, data.bars, names, figures.counts_of(data, counters, figures.fp_total(data)), "operations / rbd's",
             groups=data.groups),
        words.widths(data))


def caches(data, hardware, add):
    f = figures
    add("fig7_l1", "Figure 7: L1 data cache, hits and misses",
        "By %s; %s." % ("hardware counters" if hardware else "valgrind's simulated cache", AGAINST),
        bars(data, data.bars, ["hits", "misses"],
             f.counts_of(data, [f.l1_hits(data), "l1d_misses"], f.l1_total(data)), "accesses / rbd's", groups=data.groups),
        words.caches(data))


# ---- tables ----

def times_table(data):
    rows = [["algorithm", "robot"] + [b.title for b in data.bars]]
    for a, title in sum(data.groups, []):
        for r, robot in data.robots:
            cells = []
            for bar in data.bars:
                t, own = data.time(bar, r, a), data.time(RUN_TIME, r, a)
                ratio = "" if bar is RUN_TIME or t is None or not own else " (%s×)" % words.number(t / own)
                star = "*" if data.disturbed(bar, r, a) else ""
                cells.append("–" if t is None else words.number(t) + star + ratio)
            rows.append([title, robot] + cells)
    return rows


def ratios_table(data):
    """Of each library against the run-time model, the geometric mean over the robots that it has."""
    rows = [["time / rbd's", *[title for _, title in sum(data.groups, [])]]]
    for bar in data.bars:
        cells = []
        for algorithm in sum(data.groups, []):
            found = ratios(data, data.time, bar, RUN_TIME, [algorithm])
            few = " (%s)" % ", ".join(words.ROBOT[f[1]] for f in found) if len(found) < len(data.robots) else ""
            cells.append(words.number(mean([f[0] for f in found])) + few if found else "–")
        rows.append([bar.title, *cells])
    return rows


GRID = [("id", "ID"), ("minv", "M⁻¹"), ("fd", "FD"), ("id_derivatives", "∇ID"), ("fd_derivatives", "∇FD")]


def grid_table(data):
    """The rows of GRiDBenchmarks' table, in its unit."""
    found = {(row["variant"], row["algorithm"], row["robot"]): row for row in data.grid}
    rows = [["microseconds", *[robot for _, robot in data.robots]]]
    for variant, code in (("run-time", ""), ("generated", ", generated code")):
        for algorithm, title in GRID:
            cells = [found.get((variant, algorithm, robot)) for robot, _ in data.robots]
            if any(cells):
                rows.append([title + code] + ["%.3f%s" % (float(row["min_ns"]) / 1000, "*" if is_disturbed(row) else "")
                                              if row else "–" for row in cells])
    return rows


CODE = [("source_bytes", "source, kB", 1e-3, "%.1f"), ("operations", "operations", 1, "%.0f"),
        ("text_bytes", "machine code, kB", 1e-3, "%.1f"), ("compile_s", "compiled in s", 1, "%.2f")]


def code_table(data):
    """A row for each function and robot: rbd's number and, where there is one, Pinocchio's."""
    found = {(row["library"], row["robot"], row["algorithm"]): row for row in data.code}
    rows = [["function", "robot"] + [title + ": rbd / Pinocchio" for _, title, _, _ in CODE]]
    for algorithm in dict.fromkeys(row["algorithm"] for row in data.code):
        for r, robot in data.robots:
            both = [found.get((library, r, algorithm)) for library in ("rbd", "Pinocchio")]
            rows.append([algorithm, robot] + [" / ".join(form % (float(row[name]) * unit) if row else "–" for row in both)
                                              for name, _, unit, form in CODE])
    return rows


def sources_table(data, robot, algorithm):
    """The three sources side by side, for the run-time model."""
    names = ["cycles", "instructions", "loads", "stores", "branches", "branch_misses", "l1d_accesses", "l1d_misses",
             "stall_cycles", "memory_stall_cycles", "fp_scalar", "fp_128", "fp_256", "fp_512", "task_clock_ns"]
    show = lambda x: "–" if x is None else "%.1f" % x
    rows = [["per state", "hardware and kernel (perf)", "valgrind (-march=haswell)", "counting scalar"]]
    for n in names:
        rows.append([n] + [show(data.count(RUN_TIME, robot, algorithm, n, s)) for s in ("perf", "valgrind")] + ["–"])
    for n in ["op_mul", "op_add", "op_div", "op_sqrt", "op_sin", "op_cos", "op_neg"]:
        rows.append([n[3:] + " operations", "–", "–", show(data.operation(robot, algorithm, n))])
    return [r for r in rows if r[1:] != ["–"] * 3]


# ---- the two forms ----

class Markdown:
    def __init__(self):
        self.text = []

    def title(self, text, level):
        self.text.append("#" * level + " " + text)

    def paragraph(self, text):
        self.text.append(text)

    def table(self, rows):
        lines = ["| " + " | ".join(r) + " |" for r in rows]
        lines.insert(1, "|" + "---|" * len(rows[0]))
        self.text.append("\n".join(lines))

    def picture(self, folder, figure):
        self.text.append("![%s](%s.png)" % (figure.title, figure.name))

    def write(self, path):
        write_whole(path, "\n\n".join(self.text) + "\n")


class Html:
    STYLE = ("body{font:16px/1.5 Helvetica,Arial,sans-serif;max-width:1240px;margin:2em auto;padding:0 1em;color:#222}"
             "img{width:100%;height:auto}table{border-collapse:collapse;margin:1em 0;font-size:14px}"
             "td,th{border:1px solid #bbb;padding:.25em .6em;text-align:right}"
             "td:first-child,th:first-child{text-align:left}"
             "p{max-width:60em}")

    def __init__(self):
        self.text = []

    def title(self, text, level):
        self.text.append("<h%d>%s</h%d>" % (level, html.escape(text), level))

    def paragraph(self, text):
        self.text.append("<p>%s</p>" % html.escape(text))

    def table(self, rows):
        cell = lambda tag, row: "<tr>%s</tr>" % "".join("<%s>%s</%s>" % (tag, html.escape(c), tag) for c in row)
        self.text.append("<table>%s%s</table>" % (cell("th", rows[0]), "".join(cell("td", r) for r in rows[1:])))

    def picture(self, folder, figure):
        with open(os.path.join(folder, figure.name + ".svg"), "rb") as f:
            code = base64.b64encode(f.read()).decode()
        self.text.append('<img alt="%s" src="data:image/svg+xml;base64,%s">' % (html.escape(figure.title), code))

    def write(self, path):
        write_whole(path, "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>rbd: workload</title>"
                    "<style>%s</style>\n%s\n</html>\n" % (self.STYLE, "\n".join(self.text)))


def write_whole(path, text):
    with open(path + ".tmp", "w") as f:
        f.write(text)
    os.replace(path + ".tmp", path)


def write(data, folder, facts, notes):
    """Draws the figures and writes both forms. facts: (name, value) of machine and run; notes: of the sources."""
    found = figures_of(data)
    for figure in found:
        figure.draw(folder, figure.name, figure.title)
    for form, name in ((Markdown(), "report.md"), (Html(), "report.html")):
        form.title("rbd: what its time is made of", 1)
        form.paragraph("After S. M. Neuman, T. Koolen, J. Drean, J. E. Miller, S. Devadas: Benchmarking and Workload "
                       "Analysis of Robot Dynamics Algorithms, IROS 2019. Figures 2 to 7 are in its arrangement; what "
                       "is measured is rbd and the libraries found here. Every result was verified before.")
        form.table([["", "this run"]] + [list(fact) for fact in facts])
        form.title("Where the counts come from", 2)
        for note in notes:
            form.paragraph(note)
        for figure in found:
            form.title(figure.title, 2)
            form.picture(folder, figure)
            form.paragraph(figure.caption)
            form.paragraph(figure.text)
        form.title("Times in numbers", 2)
        form.paragraph("ns per state, the least of the experiments; in brackets as a multiple of the run-time model's.")
        form.table(times_table(data))
        if words.disturbed(data):
            form.paragraph("* " + words.disturbed(data))
        form.title("Ratios", 2)
        form.paragraph("Time as a multiple of the run-time model's: the geometric mean over the robots, or over those "
                       "named. bench/peers/README.md says for each row what it computes and what it leaves out.")
        form.table(ratios_table(data))
        if data.code:
            form.title("Code for one robot", 2)
            form.paragraph("The text that rbd-codegen and Pinocchio's code generation wrote, and the code that %s made of it, function by function: "
                           "the mass matrix is one triangle, sines and cosines are not counted as operations, an operation "
                           "of rbd's on several limbs or on four columns counts once, and a second is one of the processor." % data.main)
            form.table(code_table(data))
        if data.grid:
            form.title("By the method of GRiDBenchmarks", 2)
            form.paragraph("Single calls in float with gravity, HyQ and Atlas with their base fixed to the world, as in the "
                           "table of github.com/A2R-Lab/GRiDBenchmarks (Plancher, Neuman, Ghosal, Kuindersma, Reddi, ICRA "
                           "2022): rbd's run-time model and its generated code, the least of the experiments, another state "
                           "at each call.")
            form.table(grid_table(data))
        robot = data.robots[0]
        form.title("The three sources side by side", 2)
        form.paragraph("rbd's run-time model, %s, inverse dynamics, double." % robot[1])
        form.table(sources_table(data, robot[0], "id"))
        form.write(os.path.join(folder, name))
