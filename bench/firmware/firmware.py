#!/usr/bin/env python3
"""Builds rbd for microcontrollers, runs it under QEMU, proves and measures it: ./run firmware --help

bench/firmware/README.md has the method. SPDX-License-Identifier: MIT"""
import argparse
import csv
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys

import cold

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CROSS = ROOT / "examples/firmware/cross"
ACCEPTED = ROOT / "bench/results/firmware.csv"
ACCEPTED_EXAMPLES = ROOT / "bench/results/firmware_examples.csv"
TARGETS = ["cortex-m0", "cortex-m3", "cortex-m4f", "stm32f405", "cortex-m7", "cortex-m33", "cortex-m55", "rv32imafc",
           "rv64gc"]
SCALARS = ["float", "double"]
LEVELS = ["s", "2"]
PARTS = ["examples", "reference", "calls", "own", "more"]  # more: contacts, generated code, rbd_aba alone
ROBOTS = ["iiwa", "hyq", "atlas"]
SMALL = {"id": "rbd_rnea", "mm": "rbd_crba", "fd": "rbd_aba", "fd_cholesky": "rbd_fd_cholesky",
         "kinematics": "rbd_kinematics", "jacobian": "rbd_jacobian", "hybrid": "rbd_hybrid", "minv": "rbd_minverse"}
# Where RAM for Atlas is.
LARGE = {"momentum_matrix": "rbd_momentum_matrix", "coriolis": "rbd_coriolis", "id_derivatives": "rbd_id_derivatives",
         "fd_derivatives": "rbd_fd_derivatives"}
ALGORITHMS = {**SMALL, **LARGE}
# Straight-line code of rbd-codegen, for one robot: float, -O2, where RAM for Atlas is.
GENERATED = {"generated_id": "id", "generated_fd": "fd", "generated_constrained_fd": "constrained"}
CONSTRAINED = {"five_bar": "loop", "hyq": "feet"}  # of constrained dynamics, with models/ROBOT_SET.csv
# Float, -O2, where RAM for Atlas is, each in a library of its own: contacts, 12 rows (work: with the set of constraints),
# rbd_aba by RBD_NO_CHOLESKY without what only mimic joints need, and observer and estimate (work: with their memory).
KINDS = {"contacts": {"constrained_fd": "rbd_constrained_fd", "impact": "rbd_impact", "constrained_id": "rbd_constrained_id",
                      "constrained_fd_derivatives": "rbd_constrained_fd_derivatives"},
         "alone": {"fd_alone": "rbd_aba"},
         "estimate": {"observer_step": "rbd_observer_step", "estimate_add": "rbd_estimate_add",
                      "estimate_solve": "rbd_estimate_solve", "estimate_solve_early": "rbd_estimate_solve"}}
# Float, at all levels, in a library with the features of one robot alone.
OWN_ROBOTS = {"iiwa": "iiwa", "hyq": "HyQ"}
OWN = {"id_own": "rbd_rnea", "mm_own": "rbd_crba", "fd_own": "rbd_aba", "id_derivatives_own": "rbd_id_derivatives",
       "fd_derivatives_own": "rbd_fd_derivatives", "constrained_fd_own": "rbd_constrained_fd"}
# Figures that the examples print, on the targets of their README: words before or after a number.
EXAMPLES = {("cortex-m4f", "five_bar"): {"torques": r"torques (\d+) instructions", "motion": r"the mechanism (\d+)",
                                         "stack": r"stack (\d+) bytes", "set": r"loop (\d+)", "work": r"work (\d+)"}}
for name in ("mpc_cart_pole", "mpc_iiwa"):
    EXAMPLES["cortex-m7", name] = {"dynamics": r"dynamics and cost (\d+)", "derivatives": r"derivatives (\d+)",
                                   "backward": r"Riccati step (\d+)", "tick": r"together (\d+)", "worst": r"(\d+) at worst",
                                   "rate": r"(\d+) Hz", "stack": r"stack (\d+) bytes"}
EXAMPLES["cortex-m7", "standing"] = {"controller": r"controller (\d+)", "robot": r"robot (\d+) instructions",
                                     "worst": r"(\d+) at worst", "rate": r"(\d+) Hz", "set": r"set (\d+)",
                                     "stack": r"stack (\d+) bytes"}
EXAMPLES["cortex-m7", "whole_body"] = {"controller": r"controller (\d+)", "controller_worst": r"controller \d+ instructions, (\d+)",
                                       "robot": r"robot (\d+)", "robot_worst": r"robot \d+, (\d+)", "rate": r"(\d+) Hz",
                                       "tasks": r"tasks (\d+)", "stack": r"stack (\d+) bytes"}
EXAMPLES["cortex-m7", "recorded_control"] = {"push": r"push takes (\d+)", "controller": r"controller (\d+) instructions",
                                             "ring": r"ring (\d+) bytes"}
EXAMPLES["cortex-m4f", "servo_arm"] = {"inverse": r"torques (\d+) instructions", "memory": r"memory (\d+)"}
EXAMPLES.update({(target, "inverse_kinematics"): {
    "pose": r"far start (\d+)", "worst": r"instructions, (\d+) at worst", "evaluation": r"(\d+) an evaluation",
    "line": r"along a line (\d+)", "line_worst": r"line \d+, (\d+) at worst", "memory": r"memory (\d+)",
    "stack": r"stack (\d+) bytes"} for target in ("cortex-m4f", "cortex-m7")})
EXAMPLES.update({(target, "quadratic_programs"): {
    **{f"{kind}_{form}": rf"{kind}: [^\n]*{words} (\d+)" for kind in ("mild", "hard")
       for form, words in {"forces": "12 forces", "body": "accelerations too"}.items()},
    **{f"{kind}_{form}_worst": rf"{kind}: [^\n]*{words} \d+[^(]*\(at most (\d+)" for kind in ("mild", "hard")
       for form, words in {"forces": "12 forces", "body": "accelerations too"}.items()},
    "memory": r"memory (\d+)", "stack": r"stack (\d+) bytes"} for target in ("cortex-m4f", "cortex-m7")})
KEYS = ["target", "compiler", "scalar", "level", "robot", "algorithm"]
FIGURES = ["code", "program", "model", "work", "stack", "frames", "instructions"]
BUDGETS = ["code", "program", "model", "work", "stack", "frames"]
UNSTATED = 128  # bytes of stack without a callgraph, at most
SLACK = 0.05  # by which a budget may be exceeded
CLOCK_MHZ, CPI = 100, 1.5  # of the estimated rates

problems = []


def say(*words):
    print(*words, file=sys.stderr, flush=True)


def problem(text):
    problems.append(text)
    say("firmware: FAILED:", text)


def die(text):
    sys.exit("firmware: " + text)


def output_of(*command):
    """What a command prints; ends with its messages if it fails."""
    done = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        say(done.stdout)
        die("failed: " + " ".join(str(word) for word in command))
    return done.stdout


# ---- what a target needs ----

def is_riscv(target):
    return target.startswith("rv")


def tool(target, name):
    return ("riscv64-unknown-elf-" if is_riscv(target) else "arm-none-eabi-") + name


def missing(target):
    """The programs and the library that this machine lacks for a target."""
    emulator = {"rv3": "qemu-system-riscv32", "rv6": "qemu-system-riscv64"}.get(target[:3], "qemu-system-arm")
    lacks = [name for name in (tool(target, "gcc"), emulator) if not shutil.which(name)]
    if not lacks and not pathlib.Path("/usr/lib/picolibc", tool(target, "")[:-1]).exists():
        lacks.append("picolibc for " + tool(target, "gcc"))
    return lacks


def compiler(target):
    return "gcc " + output_of(tool(target, "gcc"), "-dumpfullversion").strip()


# ---- build and run ----

def build(target, folder, scalars, levels, parts, codegen):
    family = "riscv.ini" if is_riscv(target) else "arm.ini"
    options = ["-Dfirmware_scalars=" + ",".join(scalars), "-Dfirmware_levels=" + ",".join(levels),
               "-Dfirmware_parts=" + ",".join(parts), "-Dcodegen=" + (str(codegen.absolute()) if codegen else "")]
    configured = folder / "firmware_options.txt"
    if not (folder / "build.ninja").exists():
        output_of("meson", "setup", "--wipe" if folder.exists() else "--warnlevel=2", "--cross-file",
                  CROSS / (target + ".ini"), "--cross-file", CROSS / family, *options, folder, ROOT)
    elif not configured.exists() or configured.read_text() != "\n".join(options):
        output_of("meson", "configure", folder, *options)
    configured.write_text("\n".join(options))

    output_of("ninja", "-C", folder, "--quiet")


def run_tests(target, folder):
    """Runs the examples, the reference tests and the figures; returns what each printed, by name."""
    log = folder / "meson-logs/testlog.json"
    log.unlink(missing_ok=True)
    subprocess.run(["meson", "test", "-C", folder, "--no-rebuild", "-q"], stdin=subprocess.DEVNULL,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    if not log.exists():
        die(target + ": meson test did not run")
    printed = {}
    for line in log.read_text().splitlines():
        test = json.loads(line)
        text = test.get("stdout", "").partition("\nrbd-recording ")[0].strip()  # the dump of recorded_control is long
        printed[test["name"].split("/")[-1].split(":")[-1].strip()] = text
        if test["result"] != "OK":
            problem(f"{target}: {test['name']}: {test['result']}\n{text}\n{test.get('stderr', '')}")
    if not printed:
        problem(target + ": no tests")
    return printed


# ---- proofs ----

# Functions that any compiler may call: of memory, and its own arithmetic.
ARITHMETIC = r"__((add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|unord|powi){0}[23]|fix\w*{0}[sd]i|float\w*{0})"
HELPERS = re.compile(r"mem(cpy|set|move)|__aeabi_\w+|__\w+[sd]i[23]?|__gnu_thumb1_case_\w+|"
                     + ARITHMETIC.format("[sd]f") + "|__extendsfdf2|__truncdfsf2")
DOUBLE = re.compile(r"__aeabi_(c?d\w+|\w+2d)|__extendsfdf2|__truncdfsf2|" + ARITHMETIC.format("df"))
DOUBLE_INSTRUCTION = re.compile(r"\t(v\w+(\.\w+)*\.f64|f\w+(\.\w+)*\.d)\b")


def undefined(target, library):
    symbols = set(re.findall(r"^\s+U (\S+)", output_of(tool(target, "nm"), "-u", library), re.M))
    return sorted(symbols)


def double_arithmetic(target, library, symbols):
    """The compiler's helpers for it that a library calls, and the instructions that it contains."""
    code = output_of(tool(target, "objdump"), "-d", library)
    instructions = {m[1] for m in DOUBLE_INSTRUCTION.finditer(code)}
    return sorted(instructions | {s for s in symbols if DOUBLE.fullmatch(s)})


def prove(target, folder, scalars, levels, parts):
    """What the objects of the library may show and what not; returns a line a proof."""
    lines = []
    here = folder / "bench/firmware"
    for library in [*sorted(here.glob("librbd_*.a")), *sorted(here.glob("libfreestanding_*.a"))]:
        name, scalar = library.stem.split("_")[:2]
        suffix = "f" if scalar == "float" else ""
        symbols = undefined(target, library)
        libm = {x + suffix for x in ("sin", "cos", "sqrt")}
        if name == "libfreestanding":  # this one has the model build, which is in double
            libm |= {"sin", "cos", "sqrt"}
        foreign = [s for s in symbols if s not in libm and not HELPERS.fullmatch(s)]
        lines.append(f"{library.stem}: undefined: {' '.join(symbols)}")
        if foreign:
            problem(f"{target}: {library.stem} needs {' '.join(foreign)}")
        if name == "librbd":
            doubles = double_arithmetic(target, library, symbols)
            lines.append(f"{library.stem}: double arithmetic: {' '.join(doubles) or 'none'}")
            if (scalar == "double") != bool(doubles):  # seen where it is, none where it must not be
                problem(f"{target}: {library.stem}: double arithmetic: {' '.join(doubles) or 'none seen'}")
    if "calls" in parts and len(lines) < (1 + 2 * len(levels)) * len(scalars):
        problem(f"{target}: libraries are missing: {lines}")
    programs = ("collision", "computed_torque", "five_bar", "gravity_compensation", "inverse_kinematics", "mpc_cart_pole",
                "mpc_iiwa", "quadratic_programs", "recorded_control", "recorded_servos", "servo_arm", "standing",
                "whole_body")
    for program in programs if "examples" in parts else ():
        if not (folder / "examples/firmware" / program).exists() and program.startswith(("five", "inverse", "mpc", "quad", "record", "servo", "stand", "whole")):  # an FPU
            continue
        symbols = output_of(tool(target, "nm"), folder / "examples/firmware" / program)
        names = {line.split()[-1] for line in symbols.splitlines()}
        checked = program in ("five_bar", "standing", "whole_body")  # their ..._set_init checks a description, which is in double
        unwanted = sorted(n for n in names if DOUBLE.fullmatch(n) and not checked
                          or n in ("malloc", "free", "sbrk", "_sbrk"))
        lines.append(f"{program}: of {len(names)} symbols, {'' if checked else 'double arithmetic or '}a heap: "
                     f"{' '.join(unwanted) or 'none'}")
        if unwanted:
            problem(f"{target}: {program} has {' '.join(unwanted)}")
    return lines


# ---- figures ----

def flash_bytes(target, path):
    """Code and constants, and what variables start with."""
    fields = output_of(tool(target, "size"), path).splitlines()[1].split()
    return int(fields[0]) + int(fields[1])


def worst_frames(graph_file):
    """The deepest sum of stack frames from each function, as GCC's -fcallgraph-info=su states them."""
    frame, calls = {}, {}
    for line in graph_file.read_text().splitlines():
        node = re.match(r'node: \{ title: "([^"]*)" label: "[^"]*?(?:\\n(\d+) bytes \((\w+)[^"]*)?"', line)
        edge = re.match(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"', line)
        if node and node[2]:
            frame[node[1]] = int(node[2])
            if node[3] != "static":
                problem(f"{node[1]}: the stack frame is {node[3]}")
        if edge:
            calls.setdefault(edge[1], set()).add(edge[2])
    worst, open_calls = {}, []

    def depth(function):
        if function in open_calls:
            problem("recursion: " + " ".join(open_calls + [function]))
            return 0
        if function not in worst:
            open_calls.append(function)
            worst[function] = frame.get(function, 0) + max(map(depth, calls.get(function, ())), default=0)
            open_calls.pop()
        return worst[function]

    return {re.sub("_(double|float)$", "", function): depth(function) for function in list(frame)}


def of_generated(target, here, robot, algorithm):
    """The robot's constants are in the code."""
    name = f"{robot}_{CONSTRAINED[robot]}" if algorithm == "generated_constrained_fd" else robot
    function = f"{name}_{GENERATED[algorithm]}"
    graph = next((here / f"libgenerated_{name}.a.p").glob("*.ci"))
    return dict(code=flash_bytes(target, here / f"code_generated_{function}"), model=0, frames=worst_frames(graph)[function])


def figures(target, folder, scalars, levels, parts, printed):
    here, title, rows = folder / "bench/firmware", compiler(target), []
    for scalar in scalars:
        model = {r: flash_bytes(target, here / f"libmodel_{scalar}_{r}.a") for r in ROBOTS}
        for level in levels if "calls" in parts else ():
            name = f"{scalar}_{level}"
            code = {g: flash_bytes(target, here / f"code_{name}_{g}") for g in ALGORITHMS}
            frames = worst_frames(next((here / f"librbd_{name}.a.p").glob("*.ci")))
            for line in re.findall(r"^\w+,\w+,\d+,\d+,\d+$", printed.get("figures " + name, ""), re.M):
                robot, algorithm, work, stack, instructions = line.split(",")
                row = dict(target=target, compiler=title, scalar=scalar, level=level, robot=robot, algorithm=algorithm,
                           work=int(work), stack=int(stack), instructions=int(instructions))
                if algorithm in GENERATED:
                    row.update(of_generated(target, here, robot, algorithm))
                else:
                    row.update(code=code[algorithm], model=model[robot], frames=frames[ALGORITHMS[algorithm]])
                check_stack(row)
                rows.append(row)
    for kind, algorithms in KINDS.items():
        lines = re.findall(r"^\w+,\w+,\d+,\d+,\d+$", printed.get("figures " + kind, ""), re.M)
        frames = worst_frames(next((here / f"lib{kind}_float_2.a.p").glob("*.ci"))) if lines else {}
        for robot, algorithm, work, stack, instructions in (line.split(",") for line in lines):
            rows.append(dict(target=target, compiler=title, scalar="float", level="2", robot=robot, algorithm=algorithm,
                             work=int(work), stack=int(stack), instructions=int(instructions)))
            if algorithm in GENERATED:
                rows[-1].update(of_generated(target, here, robot, algorithm))
            else:
                rows[-1].update(code=flash_bytes(target, here / f"code_float_2_{algorithm}"),
                                model=flash_bytes(target, here / f"libmodel_float_{robot}.a"),
                                frames=frames[algorithms[algorithm]])
            check_stack(rows[-1])
    for robot, level in ((r, level) for r in OWN_ROBOTS for level in levels if "own" in parts):
        name = f"own_{robot}_{level}"
        frames = worst_frames(next((here / f"lib{name}.a.p").glob("*.ci")))
        for line in re.findall(r"^\w+,\w+,\d+,\d+,\d+$", printed.get("figures " + name, ""), re.M):
            _, algorithm, work, stack, instructions = line.split(",")
            call = algorithm.removesuffix("_own")
            rows.append(dict(target=target, compiler=title, scalar="float", level=level, robot=robot, algorithm=algorithm,
                             code=flash_bytes(target, here / f"code_{name}_{call}"), work=int(work), stack=int(stack),
                             program=flash_bytes(target, here / f"program_{name}_{call}"),
                             model=flash_bytes(target, here / f"libmodel_float_{robot}.a"), frames=frames[OWN[algorithm]],
                             instructions=int(instructions)))
            check_stack(rows[-1])
    if "calls" in parts and len(rows) < len(scalars) * len(levels) * len(SMALL):
        problem(f"{target}: only {len(rows)} rows of figures")
    return rows


def example_figures(target, folder, parts, printed):
    """Of this target's examples: {(target, program, figure): number}, flash and RAM too."""
    found = {}
    for (wanted, program), patterns in EXAMPLES.items():
        if wanted != target or "examples" not in parts:
            continue
        for figure, pattern in patterns.items():
            match = re.search(pattern, printed.get(program, ""))
            if match:
                found[target, program, figure] = int(match[1])
            else:
                problem(f"{target}: {program} prints no '{pattern}'")
        text, data, bss = output_of(tool(target, "size"), folder / "examples/firmware" / program).splitlines()[1].split()[:3]
        found[target, program, "flash"] = int(text) + int(data)
        found[target, program, "ram"] = int(data) + int(bss)
    return found


def check_stack(row):
    """The painted stack is no more than the compiler states, but for the call's own arguments and the frames of
    what has no callgraph, the compiler's helpers."""
    if not 0 < row["stack"] <= row["frames"] + UNSTATED:
        problem(f"{key(row)}: stack {row['stack']} painted, {row['frames']} by -fstack-usage")


def key(row):
    return " ".join(row[k] for k in KEYS if k != "compiler")


# ---- budgets ----

def read_accepted():
    if not ACCEPTED.exists():
        return []
    with open(ACCEPTED, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row.update({f: int(row.get(f) or 0) for f in FIGURES})
    return rows


def excess(row, budget):
    """What exceeds its budget, as sentences."""
    return [f"{figure} {row[figure]}, budget {budget[figure]}: {100 * (row[figure] / budget[figure] - 1):+.1f} %"
            for figure in BUDGETS if row.get(figure, 0) > budget[figure] * (1 + SLACK)]


def read_accepted_examples():
    if not ACCEPTED_EXAMPLES.exists():
        return {}
    with open(ACCEPTED_EXAMPLES, newline="") as file:
        return {(r["target"], r["program"], r["figure"]): int(r["number"]) for r in csv.DictReader(file)}


def check_examples(found):
    """Says what is not as accepted; by more than the slack is a failure."""
    accepted = read_accepted_examples()
    for key_, number in found.items():
        before = accepted.get(key_)
        if before is None or key_[2] == "rate":
            continue
        if number > before * (1 + SLACK):
            problem(f"{' '.join(key_)}: {number}, accepted {before}; ./run firmware --accept")
        elif number != before:
            say(f"  stale: {' '.join(key_)}: {number}, accepted {before}")


def accept_examples(found):
    accepted = {**read_accepted_examples(), **found}
    lines = [",".join(map(str, (*key_, number))) for key_, number in sorted(accepted.items())]
    ACCEPTED_EXAMPLES.write_text("target,program,figure,number\n" + "\n".join(lines) + "\n")


def check_budgets(target, rows):
    """Returns a sentence for a person."""
    accepted = {key(r): r for r in read_accepted() if r["target"] == target}
    titles = {r["compiler"] for r in accepted.values()}
    if not accepted:
        problem(f"{target}: no accepted figures in {ACCEPTED.name}; ./run firmware --accept")
        return "no budgets"
    if titles != {rows[0]["compiler"]}:
        return f"budgets NOT checked: they are of {', '.join(titles)}, this is {rows[0]['compiler']}"
    known = {r["algorithm"] for r in accepted.values()}
    new = sorted({r["algorithm"] for r in rows} - known)
    if new:
        say(f"firmware: {target}: no budgets yet for {', '.join(new)}; ./run firmware --target {target} --accept")
    for row in rows:
        if row["algorithm"] in new:
            continue
        if key(row) not in accepted:
            problem(f"{key(row)}: no accepted figures; ./run firmware --accept")
            continue
        for text in excess(row, accepted[key(row)]):
            problem(f"{key(row)}: {text}")
    return f"{sum(r['algorithm'] in known for r in rows) * len(BUDGETS)} figures within their budgets"


def as_csv(rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, KEYS + FIGURES, restval=0, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def refuse_other_compilers(targets):
    """Some rows are accepted only beside those of the same compiler: check_budgets compares no others."""
    for target, title in sorted({(r["target"], r["compiler"]) for r in read_accepted() if r["target"] in targets}):
        if title != compiler(target):
            die(f"--brief --accept: the accepted figures of {target} are of {title}, this is {compiler(target)}; "
                f"./run firmware --target {target} --accept")


def accept(rows, brief):
    """In place of all rows of their targets; brief: of the same rows alone. What was there keeps its place, what is
    new comes last of its target."""
    targets, new = {r["target"] for r in rows}, {key(r): r for r in rows}
    accepted = {key(r): r for r in read_accepted() if brief or r["target"] not in targets or key(r) in new}
    rows = sorted({**accepted, **new}.values(), key=lambda r: TARGETS.index(r["target"]))
    ACCEPTED.parent.mkdir(exist_ok=True)
    partial = ACCEPTED.with_suffix(".new")
    partial.write_text(as_csv(rows))
    partial.replace(ACCEPTED)
    say("firmware: accepted, in", ACCEPTED.relative_to(ROOT))


# ---- report ----

def rate(instructions):
    """Calls per second at the stated clock and cycles per instruction, with three digits."""
    hertz = CLOCK_MHZ * 1e6 / (CPI * instructions)
    return f"{hertz / 1000:.3g} kHz" if hertz >= 1000 else f"{hertz:.3g} Hz"


def table(rows, robots):
    lines = [f"Bytes and executed instructions per call (not cycles); rate: at {CLOCK_MHZ} MHz and {CPI} cycles per "
             "instruction, an estimate."]
    groups = {}
    for row in rows:
        groups.setdefault((row["target"], row["compiler"], row["scalar"], row["level"]), []).append(row)
    for (target, title, scalar, level), group in groups.items():
        there = [r for r in robots if any(row["robot"] == r for row in group)]
        lines += ["", f"{f'{target}, {scalar}, -O{level}, {title}':43}" + "".join(f"{r:>21}" for r in there),
                  f"{'':17}{'code':>8}{'stack':>7}{'':11}" + f"{'instr.':>10}{'rate':>11}" * len(there)]
        for algorithm in [*ALGORITHMS, *(a for algorithms in KINDS.values() for a in algorithms)]:
            some = [row for row in group if row["algorithm"] == algorithm]
            if not some:
                continue
            by_robot = {row["robot"]: row for row in some}
            lines.append(f"  {algorithm:15}{some[0]['code']:>8}{max(r['stack'] for r in some):>7}{'':11}" + "".join(
                f"{by_robot[r]['instructions']:>10}{rate(by_robot[r]['instructions']):>11}" if r in by_robot else " " * 21
                for r in there).rstrip())
        for figure, text in (("model", "model, in flash"), ("work", "work, in RAM")):
            lines.append(f"  {text:41}" + "".join(
                f"{next(row[figure] for row in group if row['robot'] == r):>10}{'':11}" for r in there).rstrip())
        for row in group:
            if row["algorithm"] in GENERATED or row["algorithm"] in OWN:
                whole = f"  whole program {row['program']}" if row["algorithm"] in OWN else ""
                lines.append(f"  {row['algorithm'] + ' ' + row['robot']:23}{row['code']:>6}{row['stack']:>7}"
                             f"{row['instructions']:>15}{rate(row['instructions']):>11}{whole}")
    return "\n".join(lines)


def own_table(rows):
    """Of docs/firmware.md: whole programs for one robot alone, a line per target; all calls of the Cortex-M4F."""
    some = {(r["target"], r["robot"], r["algorithm"], r["level"]): r for r in rows if r["algorithm"] in OWN}

    def cells(target, robot, algorithm):
        found = [some.get((target, robot, algorithm, level)) for level in LEVELS]
        return [number(r[figure]) if r else "–" for r in found for figure in ("program", "instructions")]
    calls = [("iiwa", "id_own"), ("iiwa", "fd_own"), ("hyq", "fd_own")]
    head = " | ".join(f"{OWN_ROBOTS[robot]}, `{OWN[algorithm]}`: -Os | instr. | -O2 | instr." for robot, algorithm in calls)
    lines = [f"| whole program, float | {head} |", "|---|" + "--:|" * 12]
    for target in TARGETS:
        lines.append(f"| {target} | " + " | ".join(x for call in calls for x in cells(target, *call)) + " |")
    head = " | ".join(f"{name}: -Os | instr. | -O2 | instr." for name in OWN_ROBOTS.values())
    lines += ["", f"| cortex-m4f, whole program | {head} |", "|---|" + "--:|" * 8]
    for algorithm, call in OWN.items():
        lines.append(f"| `{call}` | " + " | ".join(x for robot in OWN_ROBOTS for x in cells("cortex-m4f", robot, algorithm)) + " |")
    return lines


def short_table(rows):
    """Of docs/firmware.md: what a controller costs on a Cortex-M4F, in three lines."""
    some = {(r["robot"], r["algorithm"]): r for r in rows if r["target"] == "cortex-m4f" and r["scalar"] == "float" and r["level"] == "s"}
    lines = ["| on a Cortex-M4F, float, -Os | flash, whole program | RAM, the work | stack | instructions per call |", "|---|--:|--:|--:|--:|"]
    for words, call in (("torques of a motion, an arm of seven joints", ("iiwa", "id_own")),
                        ("accelerations of the same arm", ("iiwa", "fd_own")),
                        ("torques of a motion, a robot with four legs", ("hyq", "id_own"))):
        r = {**some[call], "work": some[call[0], "id"]["work"]}  # without the constraints that HyQ's program has room for
        lines.append(f"| {words}: `{OWN[call[1]]}` | " + " | ".join(number(r[k]) for k in ("program", "work", "stack", "instructions")) + " |")
    return lines


def calls_table(rows):
    """Of docs/firmware.md: a line per target, float at -O2; and what each robot needs, which hardly depends on it."""
    some = {(r["target"], r["robot"], r["algorithm"]): r for r in rows if r["scalar"] == "float" and r["level"] == "2"}
    lines = ["| float, -O2 | RNEA: code | stack | iiwa | HyQ | Atlas | ABA: code | stack | iiwa | HyQ | Atlas |",
             "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"]
    for target in TARGETS:
        cells = [target]
        for algorithm in ("id", "fd"):
            there = [some.get((target, robot, algorithm)) for robot in ROBOTS]
            cells += [there[0]["code"], max(r["stack"] for r in there if r)]
            cells += [r["instructions"] if r else "–" for r in there]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    lines += ["", "| cortex-m4f | iiwa | HyQ | Atlas |", "|---|--:|--:|--:|"]
    for figure, name in (("model", "model, in flash"), ("work", "work, in RAM")):
        lines.append(f"| {name} | " + " | ".join(str(some["cortex-m4f", r, "id"][figure]) for r in ROBOTS) + " |")
    return "\n".join(lines + generated_table(some))


def generated_table(some):
    """Of the targets that ./run test has; nothing lies in RAM but the stack."""
    return (generated_lines(some, {"iiwa": "iiwa", "hyq": "HyQ", "atlas": "Atlas"},
                            {"generated_id": "RNEA", "generated_fd": "ABA"}) +
            generated_lines(some, {"five_bar": "five-bar, its loop", "hyq": "HyQ, four feet"},
                            {"generated_constrained_fd": "constrained"}))


def generated_lines(some, robots, algorithms):
    """As far as there are such rows."""
    lines = ["", "| rbd-codegen, float, -O2 | | " + " | ".join(f"{name}: code | stack | instr." for name in robots.values()) +
             " |", "|---|---|" + "--:|" * 3 * len(robots)]
    for target in ("cortex-m3", "cortex-m4f", "rv32imafc"):
        for algorithm, name in algorithms.items():
            rows = [some.get((target, robot, algorithm)) for robot in robots]
            cells = [str(row[f]) if row else "–" for row in rows for f in ("code", "stack", "instructions")]
            if any(rows):
                lines.append(f"| {target} | {name} | " + " | ".join(cells) + " |")
    return lines if len(lines) > 3 else []


# ---- tables in documents ----

def number(x):
    return f"{x:,}"


def five_bar_table(_, examples):
    def of(figure):
        return number(examples["cortex-m4f", "five_bar", figure])
    return ["| | |", "|---|--:|",
            f"| torques of both motors: computed torque and `rbd_constrained_id`, instructions | {of('torques')} |",
            f"| `rbd_constrained_fd` and `rbd_integrate`, instructions | {of('motion')} |",
            f"| the set of constraints, `rbd_work`, RAM, bytes | {of('set')} and {of('work')} |",
            f"| stack, painted, bytes | {of('stack')} |",
            f"| flash, of the whole program with `printf`, bytes | {of('flash')} |"]


def mpc_table(_, examples):
    names = {"dynamics": "dynamics and cost, along two trajectories: the start and the line search",
             "derivatives": "derivatives of the dynamics, `rbd_fd_derivatives` in all knots",
             "backward": "backward pass", "tick": "a tick", "worst": "the worst tick", "rate": "rate, of the worst tick",
             "flash": "flash, of the whole program with the simulated robot and `printf`, bytes",
             "ram": "RAM without stack, bytes", "stack": "stack, painted, bytes"}
    lines = ["| | cart and pole | iiwa |", "|---|--:|--:|"]
    for figure, name in names.items():
        cells = [examples["cortex-m7", program, figure] for program in ("mpc_cart_pole", "mpc_iiwa")]
        lines.append(f"| {name} | " + " | ".join(f"{x} Hz" if figure == "rate" else number(x) for x in cells) + " |")
    return lines


def standing_table(_, examples):
    names = {"controller": "the controller, instructions", "robot": "the robot, `rbd_contact_step`, instructions",
             "worst": "both, the worst tick", "rate": "ticks a second, of the worst",
             "flash": "flash, of the whole program with `printf`, bytes",
             "ram": "RAM without stack, bytes", "set": "of these the set of contacts", "stack": "stack, painted, bytes"}
    return ["| | |", "|---|--:|", *(f"| {name} | {number(examples['cortex-m7', 'standing', figure])} |"
                                    for figure, name in names.items())]


def whole_body_table(_, examples):
    names = {"controller": "the controller, `rbd_tasks_acceleration`, instructions", "controller_worst": "its worst tick",
             "robot": "the robot, `rbd_contact_step`, instructions", "robot_worst": "its worst tick",
             "rate": "ticks of both a second, of the worst",
             "flash": "flash, of the whole program with `printf`, bytes",
             "ram": "RAM without stack, bytes", "tasks": "of these the memory of the tasks", "stack": "stack, painted, bytes"}
    return ["| | |", "|---|--:|", *(f"| {name} | {number(examples['cortex-m7', 'whole_body', figure])} |"
                                    for figure, name in names.items())]


def ik_table(_, examples):
    names = {"pose": "a pose from a far start, instructions", "worst": "the worst of 60",
             "evaluation": "of these each evaluation", "line": "a millimetre along a line", "line_worst": "the worst of 200",
             "flash": "flash, of the whole program with `printf`, bytes", "memory": "memory of `rbd_ik`, RAM, bytes",
             "stack": "stack, painted, bytes"}
    lines = ["| iiwa, float, -O2 | Cortex-M4F | Cortex-M7 |", "|---|--:|--:|"]
    for figure, name in names.items():
        cells = [examples.get((target, "inverse_kinematics", figure)) for target in ("cortex-m4f", "cortex-m7")]
        lines.append(f"| {name} | " + " | ".join("–" if x is None else number(x) for x in cells) + " |")
    return lines


def qp_table(_, examples):
    names = {"mild_forces": "12 forces, 28 rows, mild: instructions", "mild_forces_worst": "the worst of 32",
             "hard_forces": "the same, hard", "hard_forces_worst": "the worst of 32",
             "mild_body": "18 accelerations and 12 forces, 46 rows, mild", "mild_body_worst": "the worst of 32",
             "hard_body": "the same, hard", "hard_body_worst": "the worst of 32",
             "memory": "memory of `rbd_qp_solve` for the larger, RAM, bytes", "stack": "stack, painted, bytes",
             "flash": "flash, of the whole program with HyQ and `printf`, bytes"}
    lines = ["| HyQ, float, -O2 | Cortex-M4F | Cortex-M7 |", "|---|--:|--:|"]
    for figure, name in names.items():
        cells = [examples[target, "quadratic_programs", figure] for target in ("cortex-m4f", "cortex-m7")]
        lines.append(f"| {name} | " + " | ".join(map(number, cells)) + " |")
    return lines


def recorded_table(_, examples):
    names = {"push": "a push of 42 scalars, instructions", "controller": "the controller, instructions",
             "ring": "the ring of 500 ticks, RAM, bytes", "ram": "RAM without stack, with the simulated robot, bytes",
             "flash": "flash, of the whole program with `printf`, bytes"}
    return ["| | |", "|---|--:|", *(f"| {name} | {number(examples['cortex-m7', 'recorded_control', figure])} |"
                                    for figure, name in names.items())]


def contacts_table(some, _):
    lines = ["| 12 rows, float, -O2 | flash | HyQ on four points: instructions | Atlas on two flat feet |", "|---|--:|--:|--:|"]
    for algorithm, call in {"fd": "rbd_aba", **KINDS["contacts"]}.items():
        rows = [some["cortex-m4f", robot, algorithm] for robot in ("hyq", "atlas")]
        lines.append(f"| `{call}` | {number(rows[0]['code'])} | " + " | ".join(number(r["instructions"]) for r in rows) + " |")
    rows = [some["cortex-m4f", robot, "constrained_fd"] for robot in ("hyq", "atlas")]
    lines.append("| stack of `rbd_constrained_fd`, bytes | | " + " | ".join(number(r["stack"]) for r in rows) + " |")
    return lines + ["| work and set, RAM, bytes | | " + " | ".join(number(r["work"]) for r in rows) + " |"]


def alone_table(some, _):
    lines = ["| float, -O2, bytes of flash | cortex-m3 | cortex-m4f | rv32imafc |", "|---|--:|--:|--:|"]
    for algorithm, name in (("id_own", "`rbd_rnea` with `RBD_FEATURES` of the iiwa"),
                            ("fd_own", "`rbd_aba` with `RBD_FEATURES` of the iiwa"),
                            ("id", "`rbd_rnea`"), ("fd", "`rbd_aba`"),
                            ("fd_alone", "`rbd_aba` with `RBD_NO_CHOLESKY`")):
        cells = [some.get((target, "iiwa", algorithm)) for target in ("cortex-m3", "cortex-m4f", "rv32imafc")]
        lines.append(f"| {name} | " + " | ".join(number(r["code"]) if r else "–" for r in cells) + " |")
    return lines


# In which document each stands, between <!-- firmware NAME --> and <!-- end -->.
BLOCKS = {"five_bar": ("examples/firmware/README.md", five_bar_table), "mpc": ("examples/firmware/README.md", mpc_table),
          "standing": ("examples/firmware/README.md", standing_table),
          "whole_body": ("examples/firmware/README.md", whole_body_table),
          "recorded": ("examples/firmware/README.md", recorded_table),
          "ik": ("examples/firmware/README.md", ik_table),
          "qp": ("examples/firmware/README.md", qp_table),
          "contacts": ("examples/firmware/README.md", contacts_table), "flash": ("docs/porting.md", alone_table),
          "short": ("docs/firmware.md", lambda _, __: short_table(read_accepted())),
          "own": ("docs/firmware.md", lambda _, __: own_table(read_accepted())),
          "cold": ("docs/firmware.md", lambda _, __: cold.table()),
          "calls": ("docs/firmware.md", lambda _, __: calls_table(read_accepted()).split("\n"))}


def documents(write):
    """Writes the accepted figures into the documents, or returns what differs."""
    some = {(r["target"], r["robot"], r["algorithm"]): r for r in read_accepted() if r["scalar"] == "float" and r["level"] == "2"}
    examples, stale = read_accepted_examples(), []
    for name, (document, table_of) in BLOCKS.items():
        path = ROOT / document
        before, start, rest = path.read_text().partition(f"<!-- firmware {name} -->\n")
        shown, end, after = rest.partition("\n<!-- end -->")
        if not start or not end:
            die(f"{document} has no place for the table {name}")
        table_now = table_of(some, examples)
        if write:
            path.write_text(before + start + "\n".join(table_now) + end + after)
        stale += [f"{document}: not '{line}'" for line in shown.split("\n") if line not in table_now]
        if name == "ik" and not write:
            stale += [f"{document}: no figure accepted in '{line}'; ./run firmware --accept" for line in table_now if "–" in line]
        stale += [f"{document}: '{line}' is missing" for line in table_now if line not in shown.split("\n")]
    if write:  # the sentences and the picture too
        subprocess.run([sys.executable, ROOT / "docs/site/draw.py", "--write"], check=True)
        subprocess.run([sys.executable, ROOT / "tests/figures.py", "--write"], stdout=subprocess.DEVNULL, check=False)
    return stale


# ---- the course ----

def options():
    parser = argparse.ArgumentParser(
        prog="./run firmware", description="Build rbd for microcontrollers, run the examples and the reference tests "
        "under QEMU, check proofs and budgets, and print what each call costs.")
    parser.add_argument("directory", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--target", action="append", choices=TARGETS + ["all"], help="once or several times; default: "
                        "all")
    parser.add_argument("--scalar", choices=SCALARS + ["all"], default="float", help="to show; default: float")
    parser.add_argument("--brief", metavar="PART,...", help="build, run and measure these alone, in float at --level "
                        "(default: both), in less time: " + ", ".join(PARTS))
    parser.add_argument("--level", choices=LEVELS + ["all"], help="of optimisation, to show: -Os or -O2; "
                        "default: 2")
    parser.add_argument("--robot", choices=[*ROBOTS, "five_bar", "all"], default="all", help="to show; default: all")
    parser.add_argument("--format", choices=["table", "csv"], default="table")
    parser.add_argument("--proofs", action="store_true", help="print what the proofs found")
    parser.add_argument("--accept", action="store_true", help="make these figures the budgets, bench/results/firmware.csv; "
                        "with --brief those shown alone, and of the examples all that ran")
    parser.add_argument("--codegen", type=pathlib.Path, help="an rbd-codegen, for the figures of generated code; ./run "
                        "firmware gives its own")
    parser.add_argument("--if-possible", action="store_true", help="exit with status 77 if something is not installed")
    parser.add_argument("--documents", action="store_true", help="only write the accepted figures into docs/ and "
                        "examples, as --accept does too")
    parser.add_argument("--check", action="store_true", help="only check that budgets are sharp and that the documents have "
                        "the accepted figures")
    return parser.parse_args()


def do_target(target, directory, scalars, levels, parts, proofs, codegen):
    say(f"firmware: {target}: building")
    build(target, directory / target, scalars, levels, parts, codegen)
    say(f"firmware: {target}: running")
    printed = run_tests(target, directory / target)
    for name, text in printed.items():
        if not name.startswith("figures"):
            say(f"  {name}: {text}")
    found = prove(target, directory / target, scalars, levels, parts)
    if proofs:
        say("  " + "\n  ".join(found))
    return (figures(target, directory / target, scalars, levels, parts, printed),
            example_figures(target, directory / target, parts, printed))


def check_accepted():
    """Budgets refuse what exceeds them by more than the slack and nothing else; docs/firmware.md has the table."""
    rows = read_accepted()
    budget = next(row for row in rows if row["program"])
    for factor, refused in ((1, False), (1 + SLACK - 0.01, False), (1 + SLACK + 0.01, True)):
        for figure in BUDGETS:
            row = dict(budget, **{figure: int(budget[figure] * factor)})
            over = excess(row, budget)
            if bool(over) != refused:
                sys.exit(f"{factor:.2f} of the budget for {figure}: {over or 'accepted'}")
    stale = documents(write=False)
    if stale:
        sys.exit("\n".join(["documents have other figures than bench/results/firmware*.csv; ./run firmware --documents", *stale]))
    print(f"budgets are sharp; the documents have the figures of {len(rows)} accepted rows")


def main():
    wanted = options()
    if wanted.check:
        check_accepted()
        return
    if wanted.documents:
        documents(write=True)
        return
    targets = TARGETS if not wanted.target or "all" in wanted.target else wanted.target
    for target in targets:
        if missing(target):
            say(f"firmware: {target} needs {' and '.join(missing(target))}")
            sys.exit(77 if wanted.if_possible else 1)
    wanted.directory.mkdir(parents=True, exist_ok=True)
    parts, scalars, levels = PARTS, SCALARS, LEVELS
    if wanted.brief:
        parts, scalars = wanted.brief.split(","), ["float"]
        levels = [wanted.level] if wanted.level in LEVELS else LEVELS
        if not set(parts) < set(PARTS):
            die("--brief takes some of " + ", ".join(PARTS))
        if wanted.accept:
            refuse_other_compilers(targets)
    codegen = wanted.codegen if "more" in parts else None
    level = wanted.level or levels[-1]
    rows, examples = [], {}
    for target in targets:
        new, of_examples = do_target(target, wanted.directory, scalars, levels, parts, wanted.proofs, codegen)
        rows, examples = rows + new, {**examples, **of_examples}
        if not wanted.accept:
            check_examples(of_examples)
            if new:
                say(f"  {check_budgets(target, new)}")
    shown = [r for r in rows if wanted.scalar in ("all", r["scalar"]) and level in ("all", r["level"])
             and wanted.robot in ("all", r["robot"])]
    robots = ROBOTS if wanted.robot == "all" else [wanted.robot]
    print({"table": lambda: table(shown, robots), "csv": lambda: as_csv(shown).rstrip()}[wanted.format]())
    if problems:
        sys.exit(f"firmware: {len(problems)} problems, the first: {problems[0]}")
    if wanted.accept:
        accept(shown if wanted.brief else rows, wanted.brief)
        accept_examples(examples)
        documents(write=True)


main()
