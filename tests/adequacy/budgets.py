#!/usr/bin/env python3
"""The weight of the library: text and compile time of a file that implements each header, and how its rooms read.

Text is the size of the code by gcc at -O2 for x86-64-v3 (AVX2 and FMA), in bytes. Compile time is processor time at -O2, as
a share of the time for the same header before the rooms, which git has. Both stand beside the budgets of
bench/results/budgets.csv. How the rooms read: see readable.py.

usage: budgets.py             measures all of it
       budgets.py --check     text of rbd.h alone: fails if it is 1 % above what is accepted, by the same version of gcc
       budgets.py --accept    measures, and makes what it finds the accepted values"""
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import readable
from source import HEADERS, ROOT

KEPT = ROOT / "bench" / "results" / "budgets.csv"
BEFORE = "cee950e"  # a commit before the rooms
COMPILED = HEADERS[:4]  # rbd_batch.h is made for one scalar, rbd_spatial.h is inline functions
REPEATS = 3


def compile_once(folder, header, out):
    """Processor seconds of compiling a file that implements the header of this folder."""
    before = os.times()
    subprocess.run(["gcc", "-std=c99", "-O2", "-march=x86-64-v3", "-I", str(folder), "-c", "-x", "c", "-", "-o", str(out)],
                   check=True, cwd=folder, input=f'#define RBD_IMPLEMENTATION\n#include "{header}"\n', text=True)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def text_of(header, scratch):
    compile_once(ROOT, header, scratch / "file.o")
    size = subprocess.run(["size", str(scratch / "file.o")], capture_output=True, text=True, check=True).stdout
    return int(size.splitlines()[1].split()[0])


def compiler():
    """The version of gcc."""
    return subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()


def measured(scratch):
    """{(what, of): value}."""
    out = {}
    for header in COMPILED:
        out["text", header] = text_of(header, scratch)
    for name in HEADERS:
        shown = subprocess.run(["git", "-C", str(ROOT), "show", f"{BEFORE}:{name}"], capture_output=True, text=True)
        (scratch / name).write_text(shown.stdout, encoding="utf-8")
    for header in COMPILED:
        if (scratch / header).stat().st_size:
            here, there = (min(compile_once(folder, header, scratch / "file.o") for _ in range(REPEATS))
                           for folder in (ROOT, scratch))
            out["compile time", header] = f"{here / there:.2f}"
    return out


def read():
    """The rows of budgets.csv: what, of, accepted, budget, compiler."""
    with KEPT.open(encoding="utf-8", newline="") as file:
        return {(row["what"], row["of"]): row for row in csv.DictReader(file)}


def check(kept):
    row = kept["text", "rbd.h"]
    if row["compiler"] != compiler():
        print(f"not checked: the budget is for gcc {row['compiler']}, this is {compiler()}")
        return 77
    with tempfile.TemporaryDirectory() as scratch:
        text = text_of("rbd.h", Path(scratch))
    if text <= 1.01 * int(row["accepted"]):
        return 0
    print(f"rbd.h: {text} bytes of text at -O2, accepted: {row['accepted']} (./run budgets --accept, if it is worth it)")
    return 1


def main(arguments):
    if arguments not in ([], ["--check"], ["--accept"]):
        raise SystemExit(__doc__)
    kept = read()
    if arguments == ["--check"]:
        return check(kept)
    with tempfile.TemporaryDirectory() as scratch:
        found = measured(Path(scratch))
    print(f"{'':14} {'of':18} {'found':>9} {'accepted':>9} {'budget':>9}")
    for (what, of), value in found.items():
        row = kept.get((what, of), {})
        budget = row.get("budget") or ""
        over = " over" if budget and float(value) > float(budget) else ""
        print(f"{what:14} {of:18} {value:>9} {row.get('accepted', ''):>9} {budget:>9}{over}")
    if arguments == ["--accept"]:
        with KEPT.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["what", "of", "accepted", "budget", "compiler"])
            for (what, of), value in found.items():
                writer.writerow([what, of, value, kept.get((what, of), {}).get("budget", ""), compiler()])
    return readable.main([])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
