#!/usr/bin/env python3
"""batch.py FILE_code.cuh: dynamics of 65536 random states on the GPU, with CuPy and, if it is there, PyTorch.

FILE_code.cuh is of `rbd-codegen FILE.urdf --cuda --scalar float --algorithm id,fd`, a robot without a floating base.
SPDX-License-Identifier: MIT"""

import sys

import cupy

import rbd_cuda

N = 65536


def random_states(robot, n):
    random = cupy.random.default_rng(1)
    return [2 * random.random((n, size), dtype=cupy.float32) - 1 for size in (robot.nq, robot.nv, robot.nv)]


def largest(x):
    return float(abs(x).max())


def with_cupy(robot):
    q, v, a = random_states(robot, N)
    tau, = robot.id(q, v, a)
    again, status = robot.fd(q, v, tau)
    print(f"CuPy: forward dynamics of inverse dynamics gives a again to 1e-3: "
          f"{'yes' if largest(again - a) < 1e-3 and not status.any() else 'no'}")


def with_torch(robot):
    try:
        import torch
    except ImportError:
        print("PyTorch: not here")
        return
    q, v, a = (torch.from_dlpack(x) for x in random_states(robot, N))
    tau = torch.empty_like(a)
    again = torch.empty_like(a)
    status = torch.empty(N, dtype=torch.int32, device=a.device)

    def both():
        robot.id(q, v, a, out=(tau,))
        robot.fd(q, v, tau, out=(again, status))

    both()  # compiled now, not in the graph
    graph = torch.cuda.CUDAGraph()
    with torch.cuda.graph(graph):
        both()
    a.mul_(0.5)
    again.fill_(float("nan"))
    graph.replay()
    print(f"PyTorch: the same in a CUDA graph, without a copy: {'yes' if largest(again - a) < 1e-3 else 'no'}")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    robot = rbd_cuda.Robot(sys.argv[1])
    with_cupy(robot)
    with_torch(robot)


if __name__ == "__main__":
    main()
