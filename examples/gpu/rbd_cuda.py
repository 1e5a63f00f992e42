"""Kernels of a generated NAME_code.cuh for arrays on the GPU: CuPy's, PyTorch's and all that speak DLPack.

    rbd-codegen iiwa.urdf --cuda --scalar float --algorithm id,fd

    robot = rbd_cuda.Robot("iiwa_code.cuh")
    tau, = robot.id(q, v, a)                  # rows (n, nq), (n, nv): read where they are
    a, status = robot.fd(q, v, tau, out=(a, status))

NVRTC, which CuPy brings, compiles a kernel when it is called first; that takes seconds, and CuPy keeps the result in
its cache. A call is one launch on the current stream of the library that the first array is of. With out= nothing is
allocated, so that a CUDA graph may hold the call. Results without out= are of the first array's library; a status is
that of C. SPDX-License-Identifier: MIT"""

import re
import sys
from functools import partial

import cupy

THREADS = 128
SCALARS = {"float": cupy.float32, "double": cupy.float64}
ARGUMENT = re.compile(r"(const )?(scalar|int) \*__restrict__ (\w+)")


class Robot:
    """The kernels of one header, as methods of their names; `layout` is that of all arrays."""

    def __init__(self, path, layout="rows"):
        with open(path, encoding="utf-8") as file:
            self._code = file.read()
        self.name = re.search(r"^namespace (?!rbd\b)(\w+) \{", self._code, re.M).group(1)
        self.nq, self.nv = (int(re.search(rf"#define {self.name.upper()}_{what} (\d+)", self._code).group(1))
                            for what in ("NQ", "NV"))
        self._scalar = SCALARS[re.search(r"^typedef (\w+) scalar;", self._code, re.M).group(1)]
        self._layout = layout
        self._kernels = {}
        self.algorithms = re.findall(r"^RBD_KERNEL (\w+)_kernel\(", self._code, re.M)
        for algorithm in self.algorithms:
            setattr(self, algorithm, partial(self._call, algorithm))

    def arguments(self, algorithm):
        """(name, numbers a state, whether it is read, type) of each array of a kernel."""
        kernel = re.search(rf"^RBD_KERNEL {algorithm}_kernel\(int n, (.*?)\) \{{\n(.*?)\n\}}", self._code, re.M | re.S)
        sizes = dict(re.findall(r"L::at\((\w+), (\d+), n, i\)", kernel.group(2)))
        return [(name, int(sizes.get(name, 1)), bool(const), self._scalar if kind == "scalar" else cupy.int32)
                for const, kind, name in ARGUMENT.findall(kernel.group(1))]

    def _kernel(self, algorithm):
        if algorithm not in self._kernels:
            name = f"{self.name}::{algorithm}_kernel<rbd::{self._layout}>"
            module = cupy.RawModule(code=self._code, options=("--std=c++17",), name_expressions=(name,))
            self._kernels[algorithm] = module.get_function(name)
        return self._kernels[algorithm]

    def _call(self, algorithm, *arrays, out=None):
        arguments = self.arguments(algorithm)
        reads = [argument for argument in arguments if argument[2]]
        writes = [argument for argument in arguments if not argument[2]]
        if len(arrays) != len(reads):
            raise TypeError(f"{algorithm}: takes {', '.join(argument[0] for argument in reads)}")
        inputs = [self._view(x, algorithm, *argument) for x, argument in zip(arrays, reads)]
        n = self._states(inputs[0], reads[0][1])
        with _current_stream(arrays[0]):
            if out is None:
                out = [_like(arrays[0], cupy.empty(self._shape(n, size), kind)) for _, size, _, kind in writes]
            outputs = [self._view(x, algorithm, *argument) for x, argument in zip(out, writes)]
            if len(out) != len(writes):
                raise TypeError(f"{algorithm}: out= takes {', '.join(argument[0] for argument in writes)}")
            for x, (name, size, _, _) in zip(inputs + outputs, reads + writes):
                if x.size != self._numbers(n, size):
                    raise ValueError(f"{algorithm}: {name} has {x.size} numbers, not {self._numbers(n, size)}")
            if n:
                self._kernel(algorithm)(((n + THREADS - 1) // THREADS,), (THREADS,), (cupy.int32(n), *inputs, *outputs))
        return tuple(out)

    def _states(self, x, size):
        return x.shape[1] if self._layout == "columns" else x.size // size

    def _numbers(self, n, size):
        return (n + 31) // 32 * 32 * size if self._layout == "blocks" and size > 1 else n * size

    def _shape(self, n, size):
        if size == 1:
            return (n,)
        return {"rows": (n, size), "columns": (size, n), "blocks": ((n + 31) // 32, size, 32)}[self._layout]

    @staticmethod
    def _view(x, algorithm, name, size, _, kind):
        """The array as CuPy's, in the same memory."""
        view = cupy.asarray(x) if hasattr(x, "__cuda_array_interface__") else cupy.from_dlpack(x)
        if view.dtype != kind or not view.flags.c_contiguous:
            raise ValueError(f"{algorithm}: {name} has to be {kind.__name__}, row after row without gaps")
        return view


def _torch_of(x):
    """The module torch if x is a tensor of it."""
    torch = sys.modules.get("torch")
    return torch if torch and isinstance(x, torch.Tensor) else None


def _current_stream(x):
    torch = _torch_of(x)
    return cupy.cuda.ExternalStream(torch.cuda.current_stream(x.device).cuda_stream) if torch else cupy.cuda.get_current_stream()


def _like(x, y):
    torch = _torch_of(x)
    return torch.from_dlpack(y) if torch else y
