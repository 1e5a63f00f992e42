#!/usr/bin/env python3
"""examples/gpu/rbd_cuda.py without a GPU: numpy stands in for CuPy, and kernels are the loops that a C++ compiler makes of them.

usage: rbd_cuda.py ROOT RBD_CODEGEN
SPDX-License-Identifier: MIT"""
import contextlib
import ctypes
import os
import re
import subprocess
import sys
import tempfile
import types
from pathlib import Path

import numpy as np

FOLDER = tempfile.TemporaryDirectory()
COMPILER = os.environ.get("CXX", "c++").split()


class Array(np.ndarray):
    """An array of the stand-in: those of numpy alone are none, as memory of the host is none of a GPU."""

    @property
    def __cuda_array_interface__(self):
        return self.__array_interface__


class RawModule:
    def __init__(self, code, options, name_expressions):
        self.code, self.folder = code, Path(tempfile.mkdtemp(dir=FOLDER.name))
        assert options == ("--std=c++17",) and len(name_expressions) == 1

    def get_function(self, name):
        """The loop over all states, called with a grid that covers them and the arguments of the kernel."""
        space, kernel = re.match(r"(\w+)::(\w+)<", name).groups()
        parameters = re.search(rf"RBD_KERNEL {kernel}\((.*?)\) \{{", self.code, re.S).group(1)
        names = ", ".join(re.search(r"(\w+)$", p).group(1) for p in parameters.split(", "))
        source = self.folder / "kernel.cpp"
        source.write_text(f'{self.code}\nusing namespace {space};\nextern "C" void run({parameters}) {{ {name}({names}); }}\n')
        subprocess.check_call([*COMPILER, "-shared", "-fPIC", "-std=c++17", source, "-o", self.folder / "kernel.so"])
        run = ctypes.CDLL(str(self.folder / "kernel.so")).run

        def call(grid, block, arguments):
            n = int(arguments[0])
            assert grid[0] * block[0] >= n > (grid[0] - 1) * block[0] and block == (128,)
            run(n, *(ctypes.c_void_p(x.ctypes.data) for x in arguments[1:]))

        return call


def stand_in():
    module = types.ModuleType("cupy")
    module.float32, module.float64, module.int32 = np.float32, np.float64, np.int32
    module.asarray = lambda x: np.asarray(x).view(Array)
    module.empty = lambda shape, kind: np.full(shape, 77, kind).view(Array)
    module.RawModule = RawModule
    module.cuda = types.SimpleNamespace(get_current_stream=contextlib.nullcontext)
    return module


def columns_to_blocks(x):
    """[n][size] as [n / 32][size][32]"""
    return np.ascontiguousarray(x.reshape(-1, 32, x.shape[1]).transpose(0, 2, 1)).view(Array)


def refused(error, text, call, *arguments, **named):
    try:
        call(*arguments, **named)
    except error as found:
        assert text in str(found), f"'{text}' is not in '{found}'"
        return
    raise AssertionError(f"not refused: {text}")


def main():
    root, codegen = Path(sys.argv[1]), sys.argv[2]
    sys.modules["cupy"] = stand_in()
    sys.path.insert(0, str(root / "examples/gpu"))
    import rbd_cuda
    folder = FOLDER.name
    subprocess.check_call([codegen, root / "models/double_pendulum.urdf", "--name", "arm", "--cuda", "--scalar", "float", "--algorithm",
                           "id,mm,fd", "--output", folder])
    robot = rbd_cuda.Robot(f"{folder}/arm_code.cuh")
    assert (robot.name, robot.nq, robot.nv, robot.algorithms) == ("arm", 2, 2, ["id", "mm", "fd"])
    random = np.random.default_rng(1)
    q, v, a = (random.uniform(-1, 1, (160, 2)).astype(np.float32).view(Array) for _ in range(3))

    tau, = robot.id(q, v, a)
    M, = robot.mm(q)
    bias, = robot.id(q, v, 0 * a)
    assert tau.shape == (160, 2) and M.shape == (160, 4)
    assert np.abs(np.einsum("nij,nj->ni", M.reshape(-1, 2, 2), a) + bias - tau).max() < 1e-4

    out = np.zeros_like(a), np.full(160, 5, np.int32).view(Array)
    again = robot.fd(q, v, tau, out=out)
    assert again[0] is out[0] and again[1] is out[1] and not out[1].any() and np.abs(out[0] - a).max() < 1e-3

    blocks = rbd_cuda.Robot(f"{folder}/arm_code.cuh", "blocks")
    assert np.array_equal(blocks.mm(columns_to_blocks(q))[0], columns_to_blocks(M))
    columns = rbd_cuda.Robot(f"{folder}/arm_code.cuh", "columns")
    assert np.array_equal(columns.mm(np.ascontiguousarray(q.T).view(Array))[0], M.T)

    refused(TypeError, "takes q, v, a", robot.id, q, v)
    refused(TypeError, "out= takes a, status", robot.fd, q, v, tau, out=out[:1])
    refused(ValueError, "v has 20 numbers, not 320", robot.id, q, v[:10], a)
    refused(ValueError, "q has to be float32", robot.id, q.astype(np.float64), v, a)
    refused(ValueError, "q has to be float32", robot.id, q[:, ::-1], v, a)


if __name__ == "__main__":
    main()
