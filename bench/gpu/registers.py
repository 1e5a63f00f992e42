#!/usr/bin/env python3
"""registers.py WORK: a CSV of what nvcc -Xptxas -v said of each kernel, in the logs WORK/SCALAR/ROBOT.kernelALGORITHM.o.log of
gpu.sh build. SPDX-License-Identifier: MIT"""
import re
import sys
from pathlib import Path

KERNEL = re.compile(r"Compiling entry function '(\S+)'.*?(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads"
                    r".*?Used (\d+) registers", re.S)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print("robot,scalar,algorithm,layout,registers,stack bytes,bytes spilled")
    for path in sorted(Path(sys.argv[1]).glob("*/*.kernel*.o.log")):
        robot, algorithm = path.name[:-len(".o.log")].split(".kernel")
        name = re.compile(rf"\w+?\d+{algorithm}_kernelIN3rbd\d+(rows|blocks|columns)E")
        for mangled, stack, stored, loaded, registers in KERNEL.findall(path.read_text(encoding="utf-8")):
            own = name.match(mangled)
            if own:
                print(f"{robot},{path.parent.name},{algorithm},{own[1]},{registers},{stack},{int(stored) + int(loaded)}")


if __name__ == "__main__":
    main()
