"""The figures, by gnuplot: an SVG and a PNG each. SPDX-License-Identifier: MIT"""
import math
import os
import subprocess

from data import ALGORITHMS, GENERATED_LANES, Bar, RUN_TIME, is_disturbed

# From dark to light, so that black and white tell them apart; every area has a black edge.
SHADES = ["#1f2d4d", "#5f86b3", "#f0b860", "#fbf1dc"]
RIVALS = ["#f0b860", "#b5482f", "#8fae5d", "#7d5ba6", "#c9c9c9", "#3f9c9c", "#fbf1dc"]  # a library each
TOP_KEY = "at screen 0.5, screen 0.925 center top horizontal samplen 2 font ',12'"
GAP = 1.2  # between clusters, in bars
DWARFED = 4  # a bar is hard to read beside one that is so many times as high

HEAD = """set terminal {terminal}
set output '{output}'
set multiplot layout {rows},{panels} title "{title}" font ",15" noenhanced
set border 3 lc rgb '#444444'
set tics nomirror
set style fill solid 1 border lc rgb 'black'
set grid ytics lc rgb '#d8d8d8' lt 1
set bmargin {bottom}
set tmargin {top}
"""


def run_gnuplot(script, data, folder, name, title, panels, top=3.5, bottom=8, rows=1):
    """Draws folder/name.svg and .png, of rows of panels."""
    data_file = os.path.join(folder, name + ".dat")
    with open(data_file, "w") as f:
        f.write(data)
    # As wide as report.html's text, so that letters are as large as they say.
    for kind, terminal in (("svg", "svg size 1240,%d font 'Helvetica,14' background '#ffffff'" % (470 * rows)),
                           ("png", "pngcairo size 1550,%d font 'Helvetica,17' background '#ffffff'" % (590 * rows))):
        head = HEAD.format(terminal=terminal, output=os.path.join(folder, "%s.%s" % (name, kind)), panels=panels,
                           title=title, top=top, bottom=bottom, rows=rows)
        text = head + script.replace("DATA", data_file) + "unset multiplot\n"
        with open(os.path.join(folder, name + ".gp"), "w") as f:
            f.write(text)
        done = subprocess.run(["gnuplot", os.path.join(folder, name + ".gp")], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit("report: gnuplot failed on %s: %s" % (name, done.stderr.strip()))
    os.remove(os.path.join(folder, name + ".gp"))
    os.remove(data_file)


def legend(parts, rows):
    """What is stacked, or whose the bars are, (text, shade) each, in one row above the rows of panels: gnuplot's own key would break it to a panel's width."""
    low, middle, high = (1 - y / rows for y in (0.115, 0.1, 0.085))
    letter, box = 0.0062, 0.022  # widths, of the picture
    x = 0.5 - (sum(len(text) * letter + 2 * box for text, _ in parts) - box) / 2
    script = ""
    for i, (text, shade) in enumerate(parts):
        script += "set object %d rectangle from screen %g, screen %g to screen %g, screen %g fc rgb '%s'\n" % (
            i + 1, x, low, x + box, high, shade)
        script += "set label \"%s\" at screen %g, screen %g left font ',12'\n" % (text, x + 1.3 * box, middle)
        x += len(text) * letter + 2 * box
    return script


class Bars:
    """Clusters of (stacked) bars: a panel for each algorithm, a cluster for each robot, a bar for each library.
    Where others' bars would dwarf rbd's, a second row of panels has rbd's alone."""

    def __init__(self, data, bars, parts, value, ylabel, log=False, disturbed=None, groups=(ALGORITHMS,)):
        """parts: names of what is stacked; value(bar, robot, algorithm) gives as many numbers, or None.
        log: whether the axis is logarithmic; then there is one part only. disturbed(bar, robot, algorithm):
        whether the bar gets a star. groups: the algorithms of each row of panels."""
        self.groups = groups
        self.data, self.bars, self.parts, self.value = data, bars, parts, value
        self.ylabel, self.log = ylabel, self.decade_below() if log else None
        self.disturbed = disturbed or (lambda *cell: False)

    def rows(self):
        """The bars and the algorithms of each row of panels: the paper's with all bars, others with those that have any."""
        return [row for i, group in enumerate(self.groups) for row in self.rows_of(group, i == 0)]

    def rows_of(self, group, all_bars):
        shown = self.bars if all_bars else [b for b in self.bars if self.found([b], group)]
        ours = [b for b in shown if b.library == "rbd"]
        alone = not self.log and (ours if all_bars else ours[1:]) and (
            self.highest(shown, group) > DWARFED * self.highest(ours, group))
        return [(bars, group) for bars in [shown] + ([ours] if alone else []) if bars]

    def is_part(self, shown):
        """Whether these are the bars of rbd, without others'."""
        return len(shown) < len(self.bars) and all(b.library == "rbd" for b in shown)

    def rivals(self):
        return list(dict.fromkeys(b.library for b in self.bars if b.library != "rbd"))

    def shade(self, bar, part):
        """Of a part of a bar; where nothing is stacked, each library has its own."""
        if len(self.parts) > 1:
            return SHADES[part]
        return SHADES[1] if bar.library == "rbd" else RIVALS[self.rivals().index(bar.library) % len(RIVALS)]

    def key(self):
        """What the shades mean: (text, shade)."""
        if len(self.parts) > 1:
            return list(zip(self.parts, SHADES))
        ours, others = [b for b in self.bars if b.library == "rbd"], {b.library: b for b in self.bars if b.library != "rbd"}
        if not ours or not others:
            return []
        return [("rbd", SHADES[1])] + [(name, self.shade(others[name], 0)) for name in self.rivals()]

    def found(self, bars, group):
        values = [self.value(bar, robot, algorithm) for bar in bars for robot, _ in self.data.robots
                  for algorithm, _ in group]
        return [v for v in values if v]

    def highest(self, bars, group):
        return max((sum(f) for f in self.found(bars, group)), default=0)

    def decade_below(self):
        """The power of ten below the least number of all panels."""
        least = min(f[0] for group in self.groups for f in self.found(self.bars, group))
        return 10.0 ** math.floor(math.log10(least * 0.8))

    def cells(self, algorithm, shown):
        """The bars and robots of a panel: the paper's algorithms have all, with dashes; others those with a number."""
        has = lambda bars, robots: any(self.value(b, r, algorithm) for b in bars for r, _ in robots)
        if algorithm in dict(ALGORITHMS) or not has(shown, self.data.robots):
            return shown, self.data.robots
        return ([b for b in shown if has([b], self.data.robots)],
                [r for r in self.data.robots if has(shown, [r])])

    def panel(self, algorithm, shown, blocks):
        """Appends a block of data for each part; returns ticks, labels of clusters, labels of bars, the end of the
        axis, and the highest bar."""
        x, ticks, clusters, top = 0.0, [], [], 0.0
        rows = [[] for _ in self.parts]
        marks = []
        bars, robots = self.cells(algorithm, shown)
        for robot, title in robots:
            start = x
            for bar in bars:
                numbers = self.value(bar, robot, algorithm)
                ticks.append('"%s" %g' % (bar.label, x))
                if numbers is None:
                    marks.append("'–' at first %g, graph 0.02 center tc rgb '#777777'" % x)
                else:
                    low = self.log or 0.0
                    for i, number in enumerate(numbers):
                        high = number if self.log else low + number
                        rows[i].append("%g %g %g %d" % (x, low, max(high, low), int(self.shade(bar, i)[1:], 16)))
                        low = high
                    top = max(top, low)
                    if self.disturbed(bar, robot, algorithm):
                        marks.append("'*' at first %g, first %g center offset 0,0.2 font ',16'" % (x, low))
                x += 1
            clusters.append((title, (start + x - 1) / 2))
            x += GAP
        for part in rows:
            blocks.append("\n".join(part or ["0 NaN NaN 0"]) + "\n")
        return ticks, clusters, marks, x - GAP, top

    def draw(self, folder, name, title):
        blocks, script, rows = [], "", self.rows()
        for row, (shown, group) in enumerate(rows):
            script += self.row(row, shown, group, blocks, len(rows))
        run_gnuplot(script, "\n\n".join(blocks), folder, name, title, len(ALGORITHMS),
                    5 if self.key() else 3.5, rows=len(rows))

    def row(self, row, shown, group, blocks, rows):
        """The script for a row of panels, whose data it appends to the blocks."""
        script = ""
        for column, (algorithm, panel_title) in enumerate(group):
            first = len(blocks)
            ticks, clusters, marks, end, top = self.panel(algorithm, shown, blocks)
            script += "unset label\nset key off\nset title '%s' offset 0,-0.3\n" % (
                panel_title + (", rbd" if self.is_part(shown) else ""))
            script += "set xrange [-1:%g]\n" % end
            script += "set xtics rotate by 90 right font ',11' (%s) scale 0\n" % ", ".join(ticks)
            script += "set ylabel \"%s\"\n" % (self.ylabel if column == 0 else "")
            low, high = self.log or 0, top * (1.6 if self.log else 1.08) or 1
            script += "%s logscale y\n" % ("set" if self.log else "unset")
            script += "set format y '%s'\n" % ("10^{%T}" if self.log and self.log < 1e-3 else "%g")
            script += "set yrange [%g:%g]\n" % (low, high)
            for text, place in clusters:
                script += "set label '%s' at first %g, graph 0 offset character 0,-6.7 center font ',14'\n" % (text, place)
            for mark in marks:
                script += "set label %s\n" % mark
            script += legend(self.key(), rows) if row + column == 0 else "unset object\n"
            plots = ["'DATA' index %d using 1:2:($1-0.42):($1+0.42):2:3:4 with boxxyerror fc rgb variable" % (first + i)
                     for i in range(len(self.parts))]
            script += "plot %s\n" % ", \\\n  ".join(plots)
        return script


def scaling(data, folder, name, title):
    rows = [r for r in data.scaling[data.main] if not is_disturbed(r)]
    blocks, script = [], ""
    for column, (algorithm, panel_title) in enumerate(ALGORITHMS):
        plots = []
        for i, shape in enumerate(("chain", "tree")):
            points = ["%s %g" % (r["bodies"], float(r["ns"]) / int(r["bodies"])) for r in rows
                      if r["shape"] == shape and r["algorithm"] == algorithm]
            plots.append("'DATA' index %d using 1:2 with linespoints lw 2 pt %d ps 0.9 dt %d lc rgb '%s' title '%s'"
                         % (len(blocks), (7, 4)[i], i + 1, (SHADES[0], SHADES[1])[i],
                            ("chain", "binary tree")[i]))
            blocks.append("\n".join(points) + "\n")
        script += "set title '%s'\nset logscale x\nset xlabel 'bodies'\nset xrange [0.9:250]\n" % panel_title
        script += "set xtics (1,2,5,10,20,50,100,200)\nset ylabel '%s'\nset yrange [0:*]\n" % (
            "ns per body" if column == 0 else "")
        script += "set key %s\nplot %s\n" % (TOP_KEY if column == 0 else "off", ", ".join(plots))
    run_gnuplot(script, "\n\n".join(blocks), folder, name, title, len(ALGORITHMS), 5, 4)


# ---- what each figure shows: a function that gives its numbers, and a label ----

def counts_of(data, names, divide_by=None):
    """The counters of these names, as multiples of what divide_by gives for the run-time model."""

    def value(bar, robot, algorithm):
        numbers = [data.count(bar, robot, algorithm, n) if isinstance(n, str) else n(bar, robot, algorithm)
                   for n in names]
        if any(n is None for n in numbers):
            return None
        unit = divide_by(RUN_TIME, robot, algorithm) if divide_by else 1
        return [n / unit for n in numbers] if unit else None

    return value


def instructions(data):
    return lambda bar, robot, algorithm: data.count(bar, robot, algorithm, "instructions")


def rate(data):
    """IPC by hardware; else instructions of the haswell build per nanosecond of the same build."""

    def value(bar, robot, algorithm):
        count = data.count(bar, robot, algorithm, "instructions")
        if data.source == "perf":
            below = data.count(bar, robot, algorithm, "cycles")
        else:
            below = data.time(bar, robot, algorithm, table=data.haswell)
        return [count / below] if count is not None and below else None

    return value


# Callgrind's own estimate of cycles: what KCachegrind shows as such.
MISS_COST = 10


def modelled_cycles(data):
    def total(bar, robot, algorithm):
        numbers = [data.count(bar, robot, algorithm, n) for n in ("instructions", "branch_misses", "l1d_misses")]
        return None if None in numbers else numbers[0] + MISS_COST * (numbers[1] + numbers[2])

    return total


def cycle_parts(data):
    """(names, functions, total): by hardware the paper's, else those of the model."""
    scaled = lambda name: lambda *cell: (lambda n: None if n is None else MISS_COST * n)(data.count(*cell, name))
    if data.source != "perf":
        names = ["instructions", "L1 data misses (10 each)", "mispredictions (10 each)"]
        return names, ["instructions", scaled("l1d_misses"), scaled("branch_misses")], modelled_cycles(data)

    def other(*cell):
        stall, memory = data.count(*cell, "stall_cycles"), data.count(*cell, "memory_stall_cycles")
        return None if stall is None or memory is None else max(0, stall - memory)

    def running(*cell):
        cycles, stall = data.count(*cell, "cycles"), data.count(*cell, "stall_cycles")
        return None if cycles is None or stall is None else max(0, cycles - stall)

    names = ["execution", "other stalls", "memory stalls"]
    return names, [running, other, "memory_stall_cycles"], lambda *cell: data.count(*cell, "cycles")


def fp_total(data):
    def value(bar, robot, algorithm):
        numbers = [data.count(bar, robot, algorithm, n) for n in ("fp_scalar", "fp_128", "fp_256", "fp_512")]
        return sum(n or 0 for n in numbers) if any(n is not None for n in numbers) else None

    return value


def l1_total(data):
    return lambda *cell: data.count(*cell, "l1d_accesses")


def l1_hits(data):
    def value(*cell):
        accesses, misses = data.count(*cell, "l1d_accesses"), data.count(*cell, "l1d_misses")
        return None if accesses is None or misses is None else accesses - misses

    return value


def times(data):
    def value(bar, robot, algorithm):
        t = data.time(bar, robot, algorithm)
        return None if t is None else [t / 1000]

    return value


def throughput(data):
    def value(bar, robot, algorithm):
        t = data.time(bar, robot, algorithm)
        return [1000 / t] if t else None  # millions of states a second

    return value


def throughput_bars(data):
    return data.ours + [GENERATED_LANES, Bar("lanes, float", "rbd by lanes of float", "rbd", "lanes", "float")] + data.threads()


def accuracy(data):
    def value(bar, robot, algorithm):
        e = data.time(bar, robot, algorithm, field="quad_error")
        return None if e is None else [max(e, 1e-17)]

    return value


def accuracy_bars(data):
    return data.bars + [Bar("float", "rbd in float, run-time model", "rbd", "run-time", "float")]


def against_first(data):
    def value(bar, robot, algorithm):
        t = data.time(RUN_TIME, robot, algorithm, bar.compiler)
        first = data.time(RUN_TIME, robot, algorithm)
        return [t / first] if t and first else None

    return value


def compiler_bars(data):
    bars = []
    for c in data.compilers:
        bar = Bar(c, c, "rbd", "run-time")
        bar.compiler = c
        bars.append(bar)
    return bars


def disturbed_compilers(data):
    """Of the time of a bar, or of the one that it is a multiple of."""
    return lambda bar, *cell: data.disturbed(RUN_TIME, *cell, bar.compiler) or data.disturbed(RUN_TIME, *cell)


def disturbed_rate(data):
    return lambda *cell: data.disturbed(*cell, table=data.haswell)
