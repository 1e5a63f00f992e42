"""Code for one robot: how long it is, how many operations it has, how long it takes to compile.

SPDX-License-Identifier: MIT
"""
import os
import re
import resource
import shlex
import subprocess
import tempfile

HEADER = ["library", "robot", "algorithm", "source_bytes", "operations", "text_bytes", "compile_s"]
# rbd's functions, and the names of Pinocchio's: its mass matrix is one triangle.
FUNCTIONS = {"id": "id", "mm_packed": "mm", "fd": "fd", "minv": "minv", "id_derivatives": "id_derivatives",
             "fd_derivatives": "fd_derivatives"}
ROBOTS = ("iiwa", "hyq", "atlas")


def read(path):
    with open(path) as f:
        return f.read()


def said_operations(header):
    """Of one function, as the header that rbd-codegen wrote says: sines and cosines apart."""
    return sum(int(n) for n in re.findall(r"(\d+) (?:multiplications|additions|divisions|roots|on four columns)", header))


def counted_operations(source):
    """Signs with something on both sides, in C."""
    return len(re.findall(r"[\w\])] [-+*/] (?=[\w(-])", source))


def command_for(header, algorithm, folder):
    """The command that wrote a header, for this function alone into this folder."""
    words = shlex.split(next(line for line in header.splitlines() if line.strip().startswith("rbd-codegen ")))
    for option, value in (("--algorithm", algorithm), ("--output", folder)):
        words[words.index(option) + 1] = value
    return words[1:]


def compiled(command, path, folder):
    """Bytes of machine code and constants, and seconds of the processor."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = os.path.join(folder, "code.o")
    subprocess.run([*command, "-c", path, "-o", done], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    size = subprocess.run(["size", done], check=True, capture_output=True, text=True).stdout
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return int(size.splitlines()[1].split()[0]), round(seconds, 3)


def rows(build, codegen, compiler):
    """Of the code that a build of the bench has, compiled once more in the same way, each function alone."""
    flags = [compiler, "-std=c99", "-O3", "-march=native", "-w"]
    contract = "-ffp-contract=" + ("on" if "clang" in compiler else "fast")  # as rbd's code asks for itself
    with tempfile.TemporaryDirectory() as folder:
        for robot in ROBOTS:
            whole = read(os.path.join(build, robot + "_code_code.h"))
            for ours, theirs in FUNCTIONS.items():
                subprocess.run([codegen, *command_for(whole, ours, folder)], check=True, cwd=os.path.dirname(build))
                source, header = (os.path.join(folder, robot + "_code_code" + end) for end in (".c", ".h"))
                yield ["rbd", robot, ours, os.path.getsize(source), said_operations(read(header)),
                       *compiled(flags, source, folder)]
                path = os.path.join(build, "pinocchio_%s_%s.c" % (robot, theirs))
                if os.path.exists(path):
                    yield ["Pinocchio", robot, ours, os.path.getsize(path), counted_operations(read(path)),
                           *compiled([*flags, contract], path, folder)]
