#!/usr/bin/env python3
"""What nvcc -Xptxas -v says of each kernel, on standard input, as lines of cuda_nvcc.csv. usage: cuda_table.py ROBOT GPU"""
import re
import sys

KERNEL = re.compile(r"Compiling entry function '(\S+)'.*?(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads"
                    r".*?Used (\d+) registers", re.S)
robot, gpu = sys.argv[1:]
rows = []
for mangled, stack, stored, loaded, registers in KERNEL.findall(sys.stdin.read()):
    name, layout = re.match(r"_ZN\d+[a-z]+?\d+(\w+)_kernelIN3rbd\d+(rows|blocks|columns)E", mangled).groups()
    rows.append(f"{robot},{gpu},{name},{layout},{registers},{stack},{int(stored) + int(loaded)}")
print("\n".join(sorted(rows)))
