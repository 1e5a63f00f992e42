#!/usr/bin/env python3
"""Lines of 32 bytes that a call out of a cold instruction cache fetches on a Cortex-M7, with and without RBD_FEATURES.
QEMU writes each block of instructions when it first meets it: code that rbd_work_init has run before does not count.
Nothing is timed. Exact, and the same again on any machine, for one compiler.
usage: cold.py      prints the rows and writes ../results/firmware_cold.csv; ./run firmware --documents writes the table"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "bench/results/firmware_cold.csv"
FIELDS = ["target", "compiler", "robot", "call", "level", "features", "lines", "instructions"]
LINE = 32  # bytes, of the Cortex-M7
CALLS = {"id": "rbd_rnea", "mm": "rbd_crba", "fd": "rbd_aba"}
FLAGS = ("-std=c99 -mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16 -DRBD_REAL=float -DRBD_NO_BUILD -fno-math-errno "
         "-ffunction-sections -fdata-sections -Wl,--gc-sections --specs=picolibc.specs --crt0=semihost --oslib=semihost "
         "-Wl,--defsym=__flash=0 -Wl,--defsym=__flash_size=0x400000 -Wl,--defsym=__ram=0x20000000 "
         "-Wl,--defsym=__ram_size=0x400000 -Wl,--defsym=__stack_size=0x4000").split()
QEMU = ("qemu-system-arm -M mps2-an500 -display none -monitor none -serial none -chardev stdio,id=con "
        "-semihosting-config enable=on,target=native,chardev=con -d in_asm").split()


def build(folder, robot, call, level, features):
    own = [f'-DROBOT_HEADER="models/{robot}_model.h"', f"-DROBOT_FEATURES={robot.upper()}_FEATURES"]
    program = [*own, f"-D{robot.upper()}_MODEL_IMPLEMENTATION", f"-DROBOT_PREFIX={robot.upper()}",
               f"-DROBOT_MODEL={robot}_model", f"-DCALL={call}"]
    here = pathlib.Path(__file__).parent
    for source, options in (("library.c", own if features else []), ("cold.c", program)):
        subprocess.run(["arm-none-eabi-gcc", *FLAGS, f"-O{level}", f"-I{ROOT}", *options, "-c", here / source, "-o",
                        folder / f"{source}.o"], check=True)
    subprocess.run(["arm-none-eabi-gcc", *FLAGS, folder / "library.c.o", folder / "cold.c.o", "-o", folder / "program", "-lm"],
                   check=True)


def executed(folder, call):
    """Addresses of the instructions that the call is the first to execute."""
    symbols = subprocess.run(["arm-none-eabi-nm", folder / "program"], check=True, capture_output=True, text=True).stdout
    start = int(re.search(rf"^(\S+) T {CALLS[call]}_float$", symbols, re.M)[1], 16)
    ends = int(re.search(r"^(\S+) T main$", symbols, re.M)[1], 16)
    log = folder / "log"
    subprocess.run([*QEMU, "-D", log, "-kernel", folder / "program"], check=True, timeout=7200)
    blocks = [[int(a, 16) for a in re.findall(r"^0x([0-9a-f]+):", text, re.M)] for text in log.read_text().split("IN:")[1:]]
    first = next(k for k, block in enumerate(blocks) if block[0] == start)
    addresses = set()
    for block in blocks[first:]:
        if ends <= block[0] < ends + 256:  # main again
            return addresses
        addresses.update(block)
    raise RuntimeError("the call does not return")


def measure():
    compiler = subprocess.run(["arm-none-eabi-gcc", "-dumpfullversion"], check=True, capture_output=True, text=True).stdout
    for robot in ("iiwa", "hyq"):
        for call in CALLS:
            for level in ("s", "2"):
                for features in (0, 1):
                    with tempfile.TemporaryDirectory() as name:
                        folder = pathlib.Path(name)
                        build(folder, robot, call, level, features)
                        addresses = executed(folder, call)
                    yield dict(zip(FIELDS, ["cortex-m7", "gcc " + compiler.strip(), robot, call, level, features,
                                            len({a // LINE for a in addresses}), len(addresses)]))


def table():
    """Of docs/firmware.md, from the stored rows."""
    with open(RESULTS, newline="") as file:
        some = {(r["robot"], r["call"], r["level"], r["features"]): int(r["lines"]) for r in csv.DictReader(file)}
    lines = ["| Cortex-M7, bytes fetched by a cold call | iiwa: -Os | with `RBD_FEATURES` | -O2 | with | HyQ: -Os | "
             "with `RBD_FEATURES` | -O2 | with |", "|---|" + "--:|" * 8]
    for call, name in CALLS.items():
        cells = [f"{LINE * some[robot, call, level, features]:,}" for robot in ("iiwa", "hyq") for level in ("s", "2")
                 for features in "01"]
        lines.append(f"| `{name}` | " + " | ".join(cells) + " |")
    return lines


def main():
    rows = []
    for row in measure():
        rows.append(row)
        print(",".join(str(x) for x in row.values()), flush=True)
    with open(RESULTS, "w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
