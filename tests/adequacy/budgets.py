#!/usr/bin/env python3
"""How much there is of the library: lines, text and compile time of each header, and functions and lines behind calls.

Prints a table beside the budgets of bench/results/budgets.csv. Text and time are those of a file that implements the
header, by gcc at -O2 and -O0 for x86-64-v3 (AVX2 and FMA, what the budgets were set for); the time is of the processor
and is given as a share of the time of the headers before the rooms, which git has.

usage: budgets.py             measures all of it
       budgets.py --check     lines and calls alone: fails if there is more than what is accepted
       budgets.py --accept    measures, and makes what it finds the accepted values"""
import csv
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from source import HEADERS, ROOT, Source

KEPT = ROOT / "bench" / "results" / "budgets.csv"
BEFORE = "a28df37"  # the commit before the rooms
NAME = re.compile(r"\b(?:rbdi?|RBDI?)_\w+")
COMPILED = HEADERS[:4]  # rbd_spatial.h is inline functions
CALLS = ["rbd_rnea", "rbd_crba", "rbd_aba", "rbd_fd_cholesky", "rbd_minverse", "rbd_kinematics", "rbd_model_build",
         "rbd_id_derivatives", "rbd_fd_derivatives", "rbd_constrained_fd", "rbd_constrained_fd_derivatives", "rbd_contact_solve",
         "rbd_contact_step"]


class Code:
    """lines[f]: of the definitions of function f, the longest of those for different builds. uses[x]: the names in
    function or macro x."""

    def __init__(self):
        self.lines, self.uses = {}, {}
        for source in (Source(ROOT / name) for name in COMPILED):
            i = 1
            while i < len(source.clean):
                i = self._macro(source, i) if source.clean[i].startswith("#define") else self._function(source, i)

    def _add(self, name, text):
        self.uses.setdefault(name, set()).update(NAME.findall(text))

    def _macro(self, source, i):
        first = i
        while source.clean[i].endswith("\\"):
            i += 1
        name = NAME.match(source.clean[first], len("#define "))
        if name:
            self._add(name[0], "\n".join(source.clean[first:i + 1]))
        return i + 1

    def _function(self, source, i):
        name, first = source.function[i], i
        if not name or i < source.first:
            return i + 1
        while source.function[i + 1] == name and not re.match(r"(RBD|static)\b.*\(", source.clean[i + 1]):
            i += 1
        self._add(name, "\n".join(source.clean[first:i + 1]))
        self.lines[name] = max(self.lines.get(name, 0), i + 1 - first)
        return i + 1

    def behind(self, call):
        """The functions that a call may come to, itself among them."""
        seen, wait = set(), [call]
        while wait:
            name = wait.pop()
            if name not in seen:
                seen.add(name)
                wait += self.uses.get(name, ())
        return [name for name in seen if name in self.lines]


def counted():
    """{(what, of): value} of all that is counted in the text."""
    code, out = Code(), {}
    for name in HEADERS:
        out["lines", name] = len((ROOT / name).read_text(encoding="utf-8").splitlines())
    for call in CALLS:
        functions = code.behind(call)
        if call not in functions:
            raise SystemExit(f"{call} is not there: see CALLS in budgets.py")
        out["functions", call] = len(functions)
        out["lines behind", call] = sum(code.lines[f] for f in functions)
    return out


def compile_once(folder, header, level, out):
    """Processor seconds of compiling a file that implements the header of this folder."""
    before = os.times()
    subprocess.run(["gcc", "-std=c99", level, "-march=x86-64-v3", "-I", str(folder), "-c", "-x", "c", "-", "-o", str(out)],
                   check=True, cwd=folder, input=f'#define RBD_IMPLEMENTATION\n#include "{header}"\n', text=True)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def measured():
    """The same of text, in bytes, and of compile time, as a share of the time before."""
    out = {}
    with tempfile.TemporaryDirectory() as scratch:
        before = Path(scratch)
        for name in HEADERS:
            shown = subprocess.run(["git", "-C", str(ROOT), "show", f"{BEFORE}:{name}"], capture_output=True, text=True)
            (before / name).write_text(shown.stdout, encoding="utf-8")
        for header in COMPILED:
            for level in ("-O2", "-O0"):
                here, there = (compile_once(folder, header, level, before / "file.o") for folder in (ROOT, before))
                out[f"compile {level}", header] = f"{here / there:.2f}" if (before / header).stat().st_size else ""
                out[f"seconds {level}", header] = f"{here:.2f}"
            compile_once(ROOT, header, "-O2", before / "file.o")
            size = subprocess.run(["size", str(before / "file.o")], capture_output=True, text=True, check=True).stdout
            out["text", header] = int(size.splitlines()[1].split()[0])
    return out


def read():
    """The rows of budgets.csv: what, of, accepted, budget."""
    with KEPT.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def main(arguments):
    if arguments not in ([], ["--check"], ["--accept"]):
        raise SystemExit(__doc__)
    found = counted()
    rows = read()
    kept = {(row["what"], row["of"]): row for row in rows}
    if arguments == ["--check"]:
        more = [key for key in found if key not in kept or found[key] > int(kept[key]["accepted"])]
        for what, of in more:
            print(f"{of}: {what} {found[what, of]}, accepted: {kept[what, of]['accepted'] if (what, of) in kept else 'nothing'}"
                  f" (./run budgets --accept, if it is worth it)")
        return 1 if more else 0
    found.update(measured())
    print(f"{'':18} {'of':28} {'found':>9} {'accepted':>9} {'budget':>9}")
    for (what, of), value in found.items():
        row = kept.get((what, of), {})
        budget = row.get("budget") or ""
        over = " over" if budget and value != "" and float(value) > float(budget) else ""
        print(f"{what:18} {of:28} {value:>9} {row.get('accepted', ''):>9} {budget:>9}{over}")
    if arguments == ["--accept"]:
        with KEPT.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["what", "of", "accepted", "budget"])
            for (what, of), value in found.items():
                if not what.startswith("seconds"):
                    writer.writerow([what, of, value, kept.get((what, of), {}).get("budget", "")])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
