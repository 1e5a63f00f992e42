#!/usr/bin/env python3
"""Each figure of the documents is that of the file it comes from: figures.py [--write]

A sentence with figures is made here from its file, and must stand in its document. A figure with a unit that no such
sentence has, and a table with figures that no test holds, is an error: add its sentence, or take it out. --write puts
what is right in place of a sentence that differs in its figures alone. SPDX-License-Identifier: MIT"""
import csv
import pathlib
import re
import sys

import gpu_figures

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENTS = ["README.md", *(f"docs/{p.name}" for p in sorted((ROOT / "docs").glob("*.md"))), "examples/firmware/README.md"]
M4F, M7 = "cortex-m4f", "cortex-m7"


def rows_of(path):
    with open(ROOT / path, newline="") as file:
        return list(csv.DictReader(file))


FIRMWARE = rows_of("bench/results/firmware.csv")
EXAMPLES = {(r["target"], r["program"], r["figure"]): int(r["number"]) for r in rows_of("bench/results/firmware_examples.csv")}
INSTRUCTIONS = {(r["robot"], r["algorithm"]): int(r["instructions"]) for r in rows_of("bench/instructions.csv")
                if r["compiler"].startswith("gcc") and r["scalar"] == "double" and r["variant"] == "run-time"}


def firmware(figure, **wanted):
    """All such figures of firmware.csv."""
    found = [int(r[figure]) for r in FIRMWARE if all(r[k] == v for k, v in wanted.items())]
    if not found:
        sys.exit(f"figures.py: firmware.csv has no {figure} of {wanted}")
    return found


def m4f(figure, robot, algorithm):
    return firmware(figure, target=M4F, scalar="float", level="2", robot=robot, algorithm=algorithm)[0]


def ratios(figure, above, below):
    """Of all calls on the Cortex-M4F, from the least: this figure of one scalar and level over that of another."""
    def rows(scalar, level):
        return {(r["robot"], r["algorithm"]): int(r[figure]) for r in FIRMWARE
                if r["target"] == M4F and r["scalar"] == scalar and r["level"] == level and r["model"] != "0"
                and not r["algorithm"].endswith("_own")}
    over, under = rows(*above), rows(*below)
    return sorted(over[k] / under[k] for k in over if k in under)


def k_bytes(x):
    return f"{x / 1000:.1f}"


def thousands(x):
    return f"{int(round(x, -3)):,}"


def sentences():
    """Document and sentence, for a person to read; figures in braces."""
    def mpc(program, figure):
        return EXAMPLES[M7, "mpc_" + program, figure]
    rates = [mpc(p, "rate") for p in ("cart_pole", "iiwa")]
    yield "docs/firmware.md", (
        f"cart and pole takes {thousands(mpc('cart_pole', 'worst'))} instructions at worst, one of the iiwa "
        f"{thousands(mpc('iiwa', 'worst'))}; at 480 MHz and 1.5 cycles per instruction, an estimate, that is "
        f"{rates[0] / 1000:.1f} kHz and {rates[1]} Hz, with {mpc('cart_pole', 'ram') / 1000:.0f} and "
        f"{mpc('iiwa', 'ram') / 1000:.0f} KB of RAM and {max(mpc(p, 'flash') for p in ('cart_pole', 'iiwa')) / 1000:.0f} KB of "
        "flash at most.")
    standing = {figure: EXAMPLES[M7, "standing", figure] for figure in ("robot", "rate", "set")}
    yield "docs/contact_step.md", (
        f"On a Cortex-M7 a step of HyQ with four feet takes {thousands(standing['robot'])} instructions in `float`; its set of "
        f"contacts takes {k_bytes(standing['set'])} KB of RAM. With a controller in the same image that is "
        f"{int(round(standing['rate'], -2)):,} ticks a second at 480 MHz and 1.5 cycles per instruction, an estimate.")
    yield "docs/actuators.md", f"seven joints take {EXAMPLES[M4F, 'servo_arm', 'inverse']:,} instructions on a Cortex-M4F"
    yield "examples/firmware/README.md", (
        f"Of the backward pass of the iiwa a knot takes {thousands(mpc('iiwa', 'backward') / 20)} instructions.")
    yield "docs/firmware.md", (
        "At 100 MHz and 1.5 cycles per instruction a Cortex-M4F would thus do inverse dynamics of the iiwa "
        f"{thousands(100e6 / 1.5 / m4f('instructions', 'iiwa', 'id'))} times a second (an estimate).")
    code, count = (ratios(figure, ("float", "s"), ("float", "2")) for figure in ("code", "instructions"))
    yield "docs/porting.md", (
        f"`-Os` saves {100 * (1 - code[-1]):.0f} to {100 * (1 - code[0]):.0f} % of the code and costs up to "
        f"{100 * (count[-1] - 1):.0f} % more instructions (Cortex-M4F, `float`, by call).")
    stack = [s for a in {r["algorithm"] for r in FIRMWARE if r["model"] != "0"} for s in
             firmware("stack", target=M4F, scalar="float", level="2", algorithm=a)]
    yield "docs/porting.md", (
        "The stack that each call takes is in [`bench/results/firmware.csv`](../bench/results/firmware.csv): "
        f"{min(stack)} to {max(stack)} bytes in `float` on a Cortex-M4F.")
    yield "docs/porting.md", (
        f"iiwa, Cortex-M4F, `-O2`: inverse dynamics {m4f('instructions', 'iiwa', 'generated_id')} instructions in "
        f"{k_bytes(m4f('code', 'iiwa', 'generated_id'))} KB with {m4f('stack', 'iiwa', 'generated_id')} bytes of stack, where "
        f"`rbd.h` takes {m4f('instructions', 'iiwa', 'id')} in {k_bytes(m4f('code', 'iiwa', 'id'))} KB; forward dynamics "
        f"{m4f('instructions', 'iiwa', 'generated_fd')} instead of {m4f('instructions', 'iiwa', 'fd')}; Atlas "
        f"{m4f('instructions', 'atlas', 'generated_id')} and {m4f('instructions', 'atlas', 'generated_fd')}.")
    slow = ratios("instructions", ("double", "2"), ("float", "2"))
    yield "docs/porting.md", (
        f"`double` without a double-precision FPU takes {slow[0]:.0f} to {slow[-1]:.0f} times the instructions (Cortex-M4F).")
    near = re.search(r"rbd_aba takes up to (\w+ times as long)",  # held by control_loop.sh
                     " ".join((ROOT / "rbd.h").read_text().split()))
    yield "docs/control_loop.md", f"`rbd_aba` takes up to {near[1] if near else '(not in rbd.h)'}."
    calls = {"kinematics and the Jacobian of a hand or foot": "jacobian", "M⁻¹": "minv",
             "hybrid dynamics, the first six torques given (those of a base), else the accelerations": "hybrid",
             "centroidal momentum matrix": "momentum_matrix", "Coriolis matrix": "coriolis", "torque regressor": "regressor",
             "derivatives of inverse dynamics by q and v": "id_derivatives", "derivatives of forward dynamics by q, v and tau": "fd_derivatives",
             "constrained dynamics, four feet of HyQ as points and two of Atlas flat on the ground (12 rows each)":
                 "constrained_fd"}
    for title, algorithm in calls.items():
        cells = [INSTRUCTIONS.get((robot, algorithm), "–") for robot in ("iiwa", "hyq", "atlas")]
        yield "docs/performance.md", f"| {title} | " + " | ".join(map(str, cells)) + " |"
    yield from gpu_figures.sentences(ROOT)


# What has units but was not measured, and is held by another test or by its own program.
EXCUSED = {
    "docs/porting.md": [],
    "docs/actuators.md": ["at most 80 % of what was identified", "dt may be 10 ms"],  # an advice; tests/test_actuator.c
    "docs/gpu.md": [  # what nvcc 13.0 makes, and its time; explorations of the kept run
        "5 GB for contact steps", "1.7 MB in place of 0.6 MB", "a minute", "three times the code", "A step is 0.6 MB of instructions",
        "18 kB", "128 bytes", "hundred bytes", "pieces of 4 bytes", "twenty times"],
    "docs/predictive_control.md": ["10 % heavier than its model"],  # examples/mpc/horizon.c
    "docs/tasks.md": [  # by formulas that stand beside them
        "29 % of the friction", "lose 8 %", "in 50 ms", "6 % slower than asked at h = 0.01", "17 % at h = 0.1", "10 %, 25 % and h"],
    "examples/firmware/README.md": [  # what the examples are set to
        "predictive control at 1 kHz", "a whole arm at 125 Hz", "1 ms with an FPU, 8 ms without, 16 ms on the M0"],
}
# Tables that stand there for themselves, by what their first line begins with; and those between '<!-- ... -->' and
# '<!-- end -->' are held by the test of what the comment names.
TABLES = {
    "docs/performance.md": ["| instructions | iiwa | HyQ | Atlas |"],  # sentences, above
    "docs/gpu.md": ["| million", "| float", "| millions",  # sentences of gpu_figures.py
                    "| call | registers |"],  # what nvcc 13.0 says; kernels of tests/device
    "docs/accuracy_tables.md": ["| class | scalar | algorithm |", "| singularity |",  # build/tests/pivots, minutes
                         "| R in m |"],  # an illustration of the bound above it; no kept program prints it
}
UNITS = re.compile(r"(?<![\w.`])\d[\d,.]*(?: (?:to|and|or) \d[\d,.]*)?\s?(?:%|instructions|bytes|[kKM]B\b|ns\b|us\b|ms\b|µs|[km]?Hz|"
                   r"microseconds|seconds|minutes|times\b|of the time)")
MEASURED_CELL = re.compile(r"\|\s*-?\d(?:[\d,.]*\d|(?:\.\d+)?e-?\d+)\*?\s*(?=\|)")


def spaces(match):
    return re.sub(r"[^\n]", " ", match[0])


def without_code(text):
    """Code, and what other tests hold between comments, replaced by spaces."""
    text = re.sub(r"<!-- (?!end).*?<!-- end -->", spaces, text, flags=re.S)
    text = re.sub(r"```.*?```", spaces, text, flags=re.S)
    return re.sub(r"^(?: {4}|\t).*$", spaces, text, flags=re.M) if "\n1. " not in text else re.sub(
        r"^ {7}.*$", spaces, text, flags=re.M)


def pattern(sentence, figures="same"):
    """The sentence with any line breaks; with figures=any, whatever figures it has."""
    text = re.escape(sentence).replace(r"\ ", r"\s+")
    return re.compile(re.sub(r"(?:\d(?:\\?[.,]?\d)*|–)", lambda _: r"[\d.,–]*[\d–]", text) if figures == "any" else text)


ROWS_OF = re.compile(r"<!-- rows of (\S+) -->\n(.*?)\n?<!-- end -->", re.S)


def csv_table(match):
    """Such a table with the cells of its file: the first column is words, all others are figures."""
    with open(ROOT / match[1], newline="") as file:
        rows = ["|" + "|".join(f" {cell} " if cell else " " for cell in row) + "|" for row in csv.reader(file)]
    rows.insert(1, "|---" + "|--:" * (rows[0].count("|") - 2) + "|")
    return f"<!-- rows of {match[1]} -->\n" + "\n".join(rows) + "\n<!-- end -->"


def csv_tables(document, text):
    """Tables between <!-- rows of FILE.csv --> and <!-- end --> have the cells of that file."""
    for match in ROWS_OF.finditer(text):
        with open(ROOT / match[1], newline="") as file:
            rows = ["| " + " | ".join(row) + " |" for row in csv.reader(file)]
        shown = [re.sub(r"\|  \|", "| |", line) for line in match[2].split("\n") if not set(line) <= set("|-: ")]
        if shown != [re.sub(r"\|  \|", "| |", row) for row in rows]:
            yield f"{document}: the table of {match[1]} has other cells"


def check(write):
    problems, texts = [], {d: (ROOT / d).read_text() for d in DOCUMENTS}
    for document, text in texts.items():
        problems += csv_tables(document, text)
        texts[document] = ROWS_OF.sub(csv_table, text) if write else text
    left = {d: without_code(text) for d, text in texts.items()}
    for document, sentence in sentences():
        same = pattern(sentence).search(texts[document])
        if same:
            left[document] = left[document].replace(same[0], spaces(same))
            continue
        stale = pattern(sentence, "any").search(texts[document])
        if stale and write:
            fixed = iter(re.findall(r"\S+", sentence))
            texts[document] = texts[document].replace(stale[0], re.sub(r"\S+", lambda _: next(fixed), stale[0]))
        found = " ".join(stale[0].split()) if stale else "no such sentence"
        problems.append(f"{document}: {found}\n  now: {sentence}")
        if stale:
            left[document] = left[document].replace(stale[0], spaces(stale))
    for document, excused in EXCUSED.items():
        for words in excused:
            left[document] = pattern(words).sub(spaces, left[document])
    for document, text in left.items():
        table = None
        for number, line in enumerate(text.split("\n"), 1):
            here = f"{document}:{number}"
            table = (table or line) if line.startswith("|") else None
            if table:
                held = any(table.startswith(start) for start in TABLES.get(document, []))
                if MEASURED_CELL.search(line) and not held:
                    problems.append(f"{here}: a table that no test holds: {line[:60]}")
        for match in UNITS.finditer(re.sub(r"^\|.*$", spaces, text, flags=re.M)):
            problems.append(f"{document}:{text.count(chr(10), 0, match.start()) + 1}: a figure without its file: '{match[0]}'")
    if write:
        for document, text in texts.items():
            (ROOT / document).write_text(text)
    return problems


def self_test():
    """The test sees a figure that changed, one without a file, and a table that is not held."""
    assert pattern("takes 12 KB").search("takes\n  12 KB") and not pattern("takes 12 KB").search("takes 13 KB")
    assert pattern("takes 1,234 instructions, 5.6 KB.", "any").search("takes 99 instructions,\n7 KB.")
    assert not pattern("takes 1,234 instructions", "any").search("needs 99 instructions")
    for text in ("in 99 ns", "4 to 11 %", "130 to 1000 bytes", "1.2 kHz", "0.7 times", "0.3 of the time"):
        assert UNITS.search(text), text
    assert MEASURED_CELL.search("| RNEA | 123 | – |") and not MEASURED_CELL.search("| planar | 3 numbers |")


self_test()
found = check("--write" in sys.argv[1:])
print("\n".join(found))
print(f"{len(list(sentences()))} sentences, {len(found)} problems")
sys.exit(bool(found) and "--write" not in sys.argv[1:])
