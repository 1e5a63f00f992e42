# SPDX-License-Identifier: MIT
"""examples/many_machines.py: the same counts to the bit in this process, in a pool, and where a worker dies."""
import contextlib
import functools
import importlib.util
import json
import os
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest

_path = Path(__file__).parent.parent / "examples/many_machines.py"
_spec = importlib.util.spec_from_file_location("many_machines", _path)
many = sys.modules["many_machines"] = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(many)


class Here(Executor):
    """Computes at once, in this process."""

    def submit(self, function, *arguments):
        future = Future()
        future.set_result(function(*arguments))
        return future


def dies_once(marker, number, states):
    """Chunk 2 ends its process the first time."""
    if number == 2 and not marker.exists():
        marker.touch()
        os._exit(1)
    return many.chunk(number, states)


def test_many_machines(tmp_path, capsys):
    many.hyq()
    serial = many.study(10_000, Here, size=2500)
    assert serial.shape == (12, many.BINS) and (serial.sum(axis=1) == 10_000).all()
    pool = many.study(10_000, lambda: ProcessPoolExecutor(2), size=2500, ahead=2)
    assert np.array_equal(serial, pool)
    marker = tmp_path / "died"
    killed = many.study(10_000, lambda: ProcessPoolExecutor(2), size=2500, task=functools.partial(dies_once, marker))
    assert marker.exists() and "a worker died" in capsys.readouterr().err
    assert np.array_equal(serial, killed)
    other = many.study(7_500, Here, size=2500)
    assert not np.array_equal(serial, other)


def test_many_machines_quantiles():
    counts = np.zeros((1, many.BINS), int)
    counts[0, [100, 200, 300]] = 1, 997, 2  # of a thousand
    width = 2 * many.LARGEST / many.BINS
    found = many.quantiles(counts)[0]
    assert np.allclose(found, (np.array([100, 200, 200, 200, 300]) + 0.5) * width - many.LARGEST)


@contextlib.contextmanager
def started(*command):
    """A program of distributed that runs meanwhile, with this folder's rbd."""
    paths = [str(_path.parent.parent), *sys.path]
    program = [sys.executable, "-m", f"distributed.cli.dask_{command[0]}", *command[1:]]
    process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))})
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.skipif(not os.environ.get("RBD_ALL_TESTS"), reason="but by ./run test --all")
def test_many_machines_distributed(tmp_path):
    """A scheduler and two workers, one of which is killed in the midst: some seconds of a processor."""
    distributed = pytest.importorskip("distributed")
    many.hyq()
    file = tmp_path / "scheduler.json"
    both = "--scheduler-file", str(file), "--no-dashboard"
    worker = "worker", *both, "--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path)
    with contextlib.ExitStack() as stack:
        stack.enter_context(started("scheduler", *both, "--port", "0", "--host", "127.0.0.1"))
        first, _ = (stack.enter_context(started(*worker)) for _ in range(2))
        for _ in range(600):
            if file.exists() and file.read_text().endswith("}"):
                break
            time.sleep(0.1)
        address = json.loads(file.read_text())["address"]

        class Kills(many.Dask):
            def submit(self, function, *arguments):
                if arguments[0] == 0:
                    self.client.wait_for_workers(2, timeout=3600)
                if arguments[0] == 4:
                    first.kill()
                return super().submit(function, *arguments)

        spread = many.study(20_000, lambda: Kills(address), size=2500, ahead=3)
        assert first.wait(10) != 0
        with distributed.Client(address) as client:
            assert len(client.scheduler_info()["workers"]) == 1
    assert np.array_equal(spread, many.study(20_000, Here, size=2500))
