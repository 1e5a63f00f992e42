# SPDX-License-Identifier: MIT
"""A Monte-Carlo study on one machine or many: quantiles of HyQ's joint torques over random states and loads.

many_machines.py [--states 1e7] [--processes N | --dask ADDRESS] [--picture FILE.png]

Work goes to an executor of the standard interface, concurrent.futures: a process pool, or dask.distributed's client where
one machine does not suffice (Debian: python3-distributed; `dask-scheduler`, `dask-worker ADDRESS` on each machine). Each chunk
has its own seed and gives counts, whose sum does not depend on an order: the result is the same to the bit whatever
computes it, also where a worker dies and its chunks are computed again."""
import argparse
import math
import subprocess
import sys
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

import numpy as np

CHUNK = 20_000  # states of a task; part of the result, as its seed is
BINS, LARGEST = 4000, 1000.0  # of a histogram from -LARGEST to LARGEST, N m
QUANTILES = [0.001, 0.01, 0.5, 0.99, 0.999]
model = None


def hyq():
    """The robot, once in each process."""
    global model
    if model is None:
        import rbd
        model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"))
    return model


def chunk(number, states):
    """Counts of torques of so many random states: joints x bins, beyond the ends in the first and the last."""
    robot, random = hyq(), np.random.default_rng([2026, number])
    q = robot.random(seed=number + 1, n=states)
    v, a = random.uniform(-2, 2, (states, robot.nv)), random.uniform(-10, 10, (states, robot.nv))
    f_ext = np.zeros((states, robot.nb, 6))
    f_ext[:, 0, 3:] = random.normal(0, 200, (states, 3))  # the load: a push on the trunk, N
    for leg in "lf", "rf", "lh", "rh":  # and one at each toe, 0.33 m along x from its knee
        push, row = random.normal(0, 100, (states, 3)), f_ext[:, robot.body_index(f"{leg}_lowerleg")]
        row[:, 3:], row[:, 1], row[:, 2] = push, -0.33 * push[:, 2], 0.33 * push[:, 1]
    tau = robot.rnea(q, v, a, f_ext)[:, 6:]
    bins = np.clip(((tau + LARGEST) * (BINS / (2 * LARGEST))).astype(int), 0, BINS - 1)
    return np.stack([np.bincount(bins[:, joint], minlength=BINS) for joint in range(tau.shape[1])])


class Progress:
    """A bar on a terminal, else nothing."""

    def __init__(self, count):
        self.done, self.all = 0, count

    def step(self):
        self.done += 1
        if sys.stderr.isatty():
            filled = 40 * self.done // self.all
            end = "\n" if self.done == self.all else ""
            print(f"\r[{'#' * filled}{'.' * (40 - filled)}] {self.done} of {self.all}", end=end, file=sys.stderr, flush=True)


def study(states, new_executor, size=CHUNK, ahead=64, task=chunk):
    """The sum of all chunks' counts. new_executor makes an executor; if its processes die, another takes what is left."""
    tasks = [(k, min(size, states - k * size)) for k in range(math.ceil(states / size))]
    left, bar, total, broken = dict(tasks), Progress(len(tasks)), 0, 0
    while left:
        executor = new_executor()
        try:
            waiting = {}
            chunks = iter(list(left.items()))
            while True:
                while len(waiting) < ahead and (item := next(chunks, None)):
                    waiting[executor.submit(task, *item)] = item[0]
                if not waiting:
                    break
                # Each future tells for itself: dask.distributed's are of another class than the standard's.
                done = next_done(list(waiting))
                total = total + done.result()
                del left[waiting.pop(done)]
                bar.step()
        except BrokenProcessPool:
            broken += 1
            if broken > 3:
                raise
            print("a worker died: its chunks are computed again", file=sys.stderr)
        finally:
            executor.shutdown()
    return total


def next_done(futures):
    """The first of these that is done."""
    try:
        from distributed import Future, wait as wait_distributed
        if isinstance(futures[0], Future):
            return next(iter(wait_distributed(futures, return_when="FIRST_COMPLETED").done))
    except ImportError:
        pass
    return next(iter(wait(futures, return_when=FIRST_COMPLETED).done))


def quantiles(counts):
    """Joints x QUANTILES: the middle of the bin in which each lies, N m."""
    share = np.cumsum(counts, axis=1) / counts.sum(axis=1, keepdims=True)
    bins = np.stack([(share >= x).argmax(axis=1) for x in QUANTILES], axis=1)
    return (bins + 0.5) * (2 * LARGEST / BINS) - LARGEST


def draw(names, values, file):
    rows = "\n".join(f'"{name}" {" ".join(map(str, row))}' for name, row in zip(names, values))
    plot = f"""set terminal pngcairo size 900, 480 noenhanced font ",10"
set output "{file}"
$table << end
{rows}
end
set ylabel "torque, N m"; set grid; set xtics rotate by -40; set xrange [-0.6:{len(names) - 0.4}]; set key outside bottom center horizontal; set boxwidth 0.5
plot $table using 0:2:6:xtic(1) with points lc "white" notitle, \\
     "" using 0:3:2:6:5 with candlesticks fill solid 0.3 lc "steelblue" title "1 to 99 %, whiskers 0.1 to 99.9 %", \\
     "" using 0:4 with points pt 7 lc "black" title "median"
"""
    try:
        subprocess.run(["gnuplot"], input=plot, text=True, check=True)
        print(file)
    except FileNotFoundError:
        print("with gnuplot there would be a picture")


class Dask:
    """dask.distributed's client as an executor: a function's results are not kept, and retries are its own."""

    def __init__(self, address):
        from distributed import Client
        self.client = Client(address)
        self.client.upload_file(__file__)  # workers import it

    def submit(self, function, *arguments):
        return self.client.submit(function, *arguments, pure=False, retries=3)

    def shutdown(self):
        self.client.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--states", type=float, default=1e7)
    parser.add_argument("--processes", type=int, help="of the pool; default: one for each core")
    parser.add_argument("--dask", metavar="ADDRESS", help="of a scheduler, as tcp://host:8786")
    parser.add_argument("--picture", default="many_machines.png")
    arguments = parser.parse_args()
    robot = hyq()  # compiles here, once
    executor = (lambda: Dask(arguments.dask)) if arguments.dask else (lambda: ProcessPoolExecutor(arguments.processes))
    values = quantiles(study(int(arguments.states), executor))
    names = robot.dof_names[6:]
    print("torque, N m:".ljust(18) + "".join(f"{100 * x:g} %".rjust(9) for x in QUANTILES))
    for name, row in zip(names, values):
        print(name.ljust(18) + "".join(f"{x:9.1f}" for x in row))
    draw(names, values, arguments.picture)


if __name__ == "__main__":
    import many_machines  # other processes import it by this name
    many_machines.main()
