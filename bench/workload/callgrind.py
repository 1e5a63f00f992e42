#!/usr/bin/env python3
"""Counts out of callgrind's file: instructions, loads, stores, branches, caches, floating-point work by width.

usage: callgrind.py FILE    prints CSV: source,library,version,variant,scalar,robot,algorithm,counter,per_state,share

The file must come from valgrind --tool=callgrind --dump-instr=yes --compress-pos=no --compress-strings=no
--combine-dumps=yes --cache-sim=yes --branch-sim=yes, with a client request "KEY,SAMPLES" for each dump. What
callgrind cannot tell (which instructions are branches or floating-point arithmetic) comes from objdump: each
instruction is weighted with the number of times that it ran. SPDX-License-Identifier: MIT
"""
import re
import subprocess
import sys

KEYS = ["library", "version", "variant", "scalar", "robot", "algorithm"]
HEADER = ["source"] + KEYS + ["counter", "per_state", "share"]
WIDTHS = ["fp_scalar", "fp_128", "fp_256", "fp_512"]

# Arithmetic of SSE and AVX, as Intel's FP_ARITH events have it: an FMA is two operations.
ARITHMETIC = re.compile(r"^v?(?:add|sub|mul|div|sqrt|min|max|addsub|hadd|hsub)([sp])([sd])$")
FUSED = re.compile(r"^vfn?m(?:add|sub|addsub|subadd)(?:132|213|231)([sp])([sd])$")
BRANCH = re.compile(r"^(?:j[a-z]+|call|ret|loop[a-z]*)[ql]?$")
PREFIXES = {"bnd", "notrack", "rep", "repz", "repnz", "lock", "data16", "cs"}


def classify(instruction):
    """(counter, operations) of an instruction as objdump prints it, or None if it is of no interest."""
    words = instruction.split(None, 1)
    while words and words[0] in PREFIXES:
        words = words[1].split(None, 1) if len(words) > 1 else []
    if not words:
        return None
    mnemonic, operands = words[0], words[1] if len(words) > 1 else ""
    if BRANCH.match(mnemonic):
        return "branches", 1
    match = ARITHMETIC.match(mnemonic) or FUSED.match(mnemonic)
    if not match:
        return None
    times = 2 if FUSED.match(mnemonic) else 1
    if match.group(1) == "s":
        return "fp_scalar", times
    bits = 512 if "%zmm" in operands else 256 if "%ymm" in operands else 128
    return "fp_%d" % bits, times * bits // (64 if match.group(2) == "d" else 32)


def disassemble(path):
    """{address: (counter, operations)} of the instructions of an executable or library that are of interest."""
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", path], capture_output=True, text=True,
                          errors="replace", check=True).stdout
    found = {}
    for line in text.splitlines():
        address, colon, instruction = line.partition(":\t")
        kind = classify(instruction) if colon else None
        if kind:
            found[int(address, 16)] = kind
    return found


def parse(lines):
    """Yields (trigger, {event: count}, {object: {address: executions}}) for each dump that was asked for."""
    trigger = events = None
    totals, executed, current, inclusive = {}, {}, None, False
    for line in lines:
        if line.startswith("0x"):
            if inclusive:  # of a call: what it cost is counted where it ran
                inclusive = False
            elif current is not None:
                fields = line.split()
                address = int(fields[0], 16)
                current[address] = current.get(address, 0) + int(fields[2] if len(fields) > 2 else 0)
        elif line.startswith("calls="):
            inclusive = True
        elif line.startswith("ob="):
            current = executed.setdefault(line[3:].strip(), {})
        elif line.startswith("desc: Trigger:"):
            match = re.match(r"desc: Trigger: Client Request: (.*)", line)
            trigger = match.group(1).strip() if match else None
        elif line.startswith("events:"):
            events = line.split()[1:]
            executed, current = {}, None
        elif line.startswith("summary:"):
            numbers = [int(x) for x in line.split()[1:]]
            totals = dict(zip(events, numbers + [0] * (len(events) - len(numbers))))
        elif line.startswith("totals:"):
            if trigger:
                yield trigger, totals, executed
            trigger = None


def counters(totals, executed, disassembly):
    """The counters of one dump; disassembly: a function from an object to what disassemble gives."""
    get = lambda *names: sum(totals.get(name, 0) for name in names)
    result = {
        "instructions": get("Ir"), "loads": get("Dr"), "stores": get("Dw"), "branches": 0,
        "branch_misses": get("Bcm", "Bim"), "l1d_accesses": get("Dr", "Dw"), "l1d_misses": get("D1mr", "D1mw"),
        "l1i_misses": get("I1mr"), "ll_misses": get("ILmr", "DLmr", "DLmw"),
    }
    result.update(dict.fromkeys(WIDTHS, 0))
    for name, addresses in executed.items():
        kinds = disassembly(name)
        for address, times in addresses.items():
            if address in kinds:
                counter, operations = kinds[address]
                result[counter] += operations * times
    return result


def rows(path):
    """The rows of a file, each a list as HEADER says."""
    known = {}

    def disassembly(name):
        if name not in known:
            known[name] = disassemble(name) if name.startswith("/") else {}
        return known[name]

    with open(path, errors="replace") as lines:
        for trigger, totals, executed in parse(lines):
            *key, samples = trigger.split(",")
            if len(key) != len(KEYS):
                raise SystemExit("callgrind.py: %s: the trigger '%s' is none of rbd-bench's" % (path, trigger))
            for counter, count in counters(totals, executed, disassembly).items():
                yield ["valgrind"] + key + [counter, "%.4f" % (count / int(samples)), "1"]


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stdout if sys.argv[1:] in (["-h"], ["--help"]) else sys.stderr)
        return 0 if sys.argv[1:] in (["-h"], ["--help"]) else 2
    print(",".join(HEADER))
    for row in rows(sys.argv[1]):
        print(",".join(row))
    return 0


if __name__ == "__main__":
    sys.exit(main())
