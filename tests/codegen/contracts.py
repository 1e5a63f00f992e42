#!/usr/bin/env python3
"""Each function of generated headers has a whole contract: its arguments with shapes, the range of angles, what is not
checked, operations and stack; with a status, how pivots are judged. usage: contracts.py NAME_code.h..."""
import re
import sys
from pathlib import Path

LINES = [r"   Angles: .+", r"   Not checked: .+",
         r"   Operations: \d+ multiplications, \d+ additions, \d+ divisions, \d+ roots, \d+ sines and cosines\.",
         r"   Stack: arrays of \d+ bytes, .+"]
SIZES = {"float": 4, "double": 8}


def faults(header):
    text = header.read_text()
    source = header.with_suffix(".c").read_text()
    if not re.search(r"Written by rbd-codegen \d+\.\d+\.\d+.* from .+\n       rbd-codegen .+", text):
        yield "no version and command of the run"
    functions = list(re.finditer(r"/\* ((?:(?!\*/).)*) \*/\n(int|void) (\w+)\(([^\n]*)\);", text, re.S))
    if len(functions) != len(re.findall(r"^(?:int|void) \w+\(.*\);", text, re.M)) or not functions:
        yield "a function has no comment"
    scalar = re.search(r"^typedef (float|double) scalar;", source, re.M)[1]
    widths = {"real": int(re.search(r"#define LANES (\d+)", source)[1]),
              "limbs": int((re.search(r"#define LIMBS (\d+)", source) or [0, 1])[1])}
    for comment, result, name, arguments in (f.groups() for f in functions):
        lines = comment.split("\n")
        for argument in re.findall(r"(\w+)\[\d+\]", arguments):
            if not any(re.fullmatch(rf"   {argument} +\S.*", line) for line in lines):
                yield f"{name}: {argument} has no shape"
        for wanted in LINES + [r"   Pivots: .+"] * (result == "int"):
            if not any(re.fullmatch(wanted, line) for line in lines):
                yield f"{name}: no line '{wanted}'"
        body = re.search(rf"^{result} {name}\(.*\{{\n((?:    (?:ALIGNED )?(?:real|limbs) \w+\[\d+\];\n)*)", source, re.M)[1]
        stack = sum(int(n) * widths[kind] for kind, n in re.findall(r"(real|limbs) \w+\[(\d+)\];", body))
        if f"arrays of {stack * SIZES[scalar]} bytes" not in comment:
            yield f"{name}: its arrays have {stack * SIZES[scalar]} bytes"


bad = [f"{path}: {fault}" for path in sys.argv[1:] for fault in faults(Path(path))]
print("".join(fault + "\n" for fault in bad), end="")
sys.exit(bool(bad) or len(sys.argv) < 2)
