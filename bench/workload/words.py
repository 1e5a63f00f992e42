"""The paragraph under each figure, computed from what was measured. SPDX-License-Identifier: MIT"""
import figures
from data import ALGORITHMS, RUN_TIME, is_disturbed, mean, ratios

TITLES = dict(ALGORITHMS)
ROBOT = {"iiwa": "iiwa", "hyq": "HyQ", "atlas": "Atlas"}


def number(x):
    return "%.0f" % x if x >= 100 else "%.1f" % x if x >= 10 else "%.2f" % x


def place(found):
    return "%s, %s" % (ROBOT.get(found[1], found[1]), TITLES[found[2]])


def spread(found, unit):
    """The range of ratios with where the ends are, and the mean."""
    low, high = min(found), max(found)
    if len(found) == 1:
        return "%s %s (%s)" % (number(low[0]), unit, place(low))
    return "%s (%s) to %s %s (%s), in the geometric mean %s" % (
        number(low[0]), place(low), number(high[0]), unit, place(high), number(mean([f[0] for f in found])))


def compare(data, value, bars, verb):
    """A sentence for each bar: its value as a multiple of the run-time model's."""
    sentences = []
    for bar in bars:
        found = ratios(data, value, bar, RUN_TIME) if bar is not RUN_TIME else []
        if found:
            sentences.append("%s %s %s." % (bar.title, verb, spread(found, "times that")))
    return " ".join(sentences)


def span(data, value, bar=RUN_TIME):
    found = [(value(bar, r, a), r, a) for a, _ in ALGORITHMS for r, _ in data.robots
             if value(bar, r, a) is not None]
    if not found:
        return None
    low, high = min(found), max(found)
    return "%s (%s) to %s (%s)" % (number(low[0]), place(low), number(high[0]), place(high))


def single(value):
    """Of a function that gives a list of parts: their sum."""
    def total(*cell):
        numbers = value(*cell)
        return None if numbers is None else sum(numbers)
    return total


def share(data, bar, above, below):
    """The range of above / below in per cent for a bar."""
    found = []
    for a, _ in ALGORITHMS:
        for r, _ in data.robots:
            x, y = above(bar, r, a), below(bar, r, a)
            if x is not None and y:
                found.append(100 * x / y)
    return "%s to %s %%" % (number(min(found)), number(max(found))) if found else None


def shares(data, bar, parts, below):
    """The shares of the parts, (words with a %s, what is above), as far as they are known; empty if none is."""
    found = [(text, share(data, bar, above, below)) for text, above in parts]
    return ", ".join(text % s for text, s in found if s)


def known(sentence, found):
    """The sentence, which says what was found; empty if nothing was."""
    return sentence % found if found else ""


def disturbed(data):
    """Names the rows of Figure 2 whose times are too uncertain for a sentence; empty if none is."""
    found = ["%s, %s" % (bar.title, place((0, r, a))) for bar in data.bars for a, _ in ALGORITHMS
             for r, _ in data.robots if data.disturbed(bar, r, a)]
    return known("Disturbed, and left out of the sentences: their least time did not come twice to 3 %%, however "
                 "often it was measured, and may be too large: %s.", "; ".join(found))


def times(data):
    value = data.sure(data.time)
    text = known("The least of the experiments: rbd with a run-time model takes %s ns a state. ",
                 span(data, value)) + compare(data, value, data.bars, "takes")
    return (text + known(" * %s", disturbed(data))).strip()


def rate(data):
    value = single(figures.rate(data))
    if data.source != "perf":
        value = data.sure(value, table=data.haswell)
    unit = "instructions per cycle" if data.source == "perf" else "instructions per nanosecond"
    parts = ["%s: %s" % (bar.title, span(data, value, bar)) for bar in data.bars if span(data, value, bar)]
    return "In %s: %s." % (unit, "; ".join(parts))


def kinds(data):
    value = figures.instructions(data)
    text = known("rbd with a run-time model executes %s instructions a state. ", span(data, value))
    text += compare(data, value, data.bars, "executes")
    parts = [("%s load", lambda *cell: data.count(*cell, "loads")),
             ("%s store", lambda *cell: data.count(*cell, "stores")),
             ("%s branch", lambda *cell: data.count(*cell, "branches"))]
    for bar in data.bars:
        text += known(" Of the instructions of " + bar.title + ", %s.", shares(data, bar, parts, value))
    return text


def cycles(data):
    names, parts, total = figures.cycle_parts(data)
    text = ""
    if data.source != "perf":
        text = ("Cycles and both kinds of stalls were not counted by hardware, so this is callgrind's model and not a measurement: an "
                "instruction costs 1, a miss of the simulated L1 data cache or a mispredicted branch 10. ")
    counter = lambda name: lambda *cell: data.count(*cell, name)
    parts = [(name.split(" (")[0] + " %s", counter(part) if isinstance(part, str) else part)
             for name, part in zip(names, parts)]
    for bar in data.bars:
        text += known(bar.title + ": %s. ", shares(data, bar, parts, total))
    return text.strip()


def widths(data):
    value = figures.fp_total(data)
    text = known("rbd with a run-time model executes %s floating-point operations a state. ", span(data, value))
    text += compare(data, value, data.bars, "executes")
    for bar in data.bars:
        wide = lambda *cell: value(*cell) - (data.count(*cell, "fp_scalar") or 0) if value(*cell) is not None else None
        text += known(" In packed instructions, " + bar.title + ": %s.", share(data, bar, wide, value))
    floor = [(value(RUN_TIME, r, a) / data.operation(r, a, "op_mul", "op_add", "op_div", "op_sqrt"), r, a)
             for a, _ in ALGORITHMS for r, _ in data.robots
             if value(RUN_TIME, r, a) and data.operation(r, a, "op_mul", "op_add", "op_div", "op_sqrt")]
    if floor:
        text += (" The counting scalar finds the floor: multiplications, additions, divisions and roots of the "
                 "algorithm itself, without sines. Executed are %s; sines and cosines are in the difference."
                 % spread(floor, "times as many"))
    return text


def caches(data):
    value = figures.l1_total(data)
    misses = lambda *cell: data.count(*cell, "l1d_misses")
    text = known("rbd with a run-time model accesses the L1 data cache %s times a state. ", span(data, value))
    text += compare(data, value, data.bars, "does so")
    for bar in data.bars:
        text += known(" Misses of " + bar.title + ": %s of the accesses.", share(data, bar, misses, value))
    return text


def throughput(data):
    value = data.sure(single(figures.throughput(data)))
    text = known("rbd with a run-time model computes %s million states a second on one core.", span(data, value))
    for bar in figures.throughput_bars(data):
        found = ratios(data, value, bar, RUN_TIME) if bar is not RUN_TIME else []
        if found:
            text += " %s: %s." % (bar.title, spread(found, "times as many"))
    lanes = [b for b in data.ours if b.variant == "lanes"]
    for bar in data.threads() if lanes else []:
        found = ratios(data, value, bar, lanes[0])
        if found:
            text += " Batches on %s threads against one: %s." % (bar.variant.split()[1],
                                                                  spread(found, "times as many"))
    return text


def scaling(data):
    rows, text = data.scaling[data.main], ""
    for algorithm, title in ALGORITHMS:
        for shape in ("chain", "tree"):
            points = {int(r["bodies"]): float(r["ns"]) for r in rows
                      if r["shape"] == shape and r["algorithm"] == algorithm and not is_disturbed(r)}
            sizes = sorted(points)
            if len(sizes) > 2:
                start = 10 if 10 in points else sizes[0]
                ten, last = points[start] / start, points[sizes[-1]] / sizes[-1]
                text += "%s of a %s: %s ns a body at %d bodies, %s at %d (%s times). " % (
                    title.capitalize(), {"chain": "chain", "tree": "binary tree"}[shape], number(ten), start,
                    number(last), sizes[-1], number(last / ten))
    left_out = ["%s of %s, %s" % (r["shape"], r["bodies"], TITLES[r["algorithm"]]) for r in rows if is_disturbed(r)]
    return (text + known("Disturbed, and left out: %s.", "; ".join(left_out))).strip()


def accuracy(data):
    text = []
    for bar in figures.accuracy_bars(data):
        found = [(data.time(bar, r, a, field="quad_error"), r, a) for a, _ in ALGORITHMS for r, _ in data.robots]
        found = [f for f in found if f[0] is not None]
        if found:
            worst = max(found)
            text.append("%s: at most %.1e (%s)" % (bar.title, worst[0], place(worst)))
    return "Largest relative error against quad precision over the states compared. %s." % "; ".join(text)


def compilers(data):
    text = []
    for c in data.compilers[1:]:
        value = lambda compiler: data.sure(lambda bar, r, a: data.time(bar, r, a, compiler), compiler)
        found = [(value(c)(RUN_TIME, r, a) / value(data.main)(RUN_TIME, r, a), r, a) for a, _ in ALGORITHMS
                 for r, _ in data.robots if value(c)(RUN_TIME, r, a) and value(data.main)(RUN_TIME, r, a)]
        if found:
            text.append("With %s the run-time model takes, against %s, %s." % (
                c, data.main, spread(found, "times as long")))
    return " ".join(text)
