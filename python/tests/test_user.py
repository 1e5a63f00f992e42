# SPDX-License-Identifier: MIT
"""What a user does first: install, the README's lines, the example."""
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rbd

PYTHON = rbd.SOURCES / "python"


def readme_program():
    return re.search(r"```python\n(.*?)```", (PYTHON / "README.md").read_text(), re.S)[1]


def run(*command, **options):
    done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          **options)
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_readme(tmp_path, monkeypatch):
    """The ten lines run, and write a table that a compiler takes."""
    program = readme_program()
    assert len(program.splitlines()) <= 12
    monkeypatch.setenv("PYTHONPATH", str(PYTHON))
    printed = run(sys.executable, "-c", program, cwd=tmp_path)
    assert printed.count("[") == 2
    (tmp_path / "main.c").write_text('#include "rbd.h"\n#define IIWA_MODEL_IMPLEMENTATION\n#include "iiwa_model.h"\n'
                                     "int main(void) { return iiwa_model.nv - 7; }\n")
    run("cc", f"-I{rbd.SOURCES}", "main.c", "-o", "main", cwd=tmp_path)
    run("./main", cwd=tmp_path)


def test_example(tmp_path, monkeypatch):
    """The feet carry the weight, the motors can do it, and all files are there."""
    monkeypatch.setenv("PYTHONPATH", str(PYTHON))
    printed = run(sys.executable, PYTHON / "examples/hyq_gait.py", tmp_path)
    assert "hyq_model.h" in printed
    table = np.genfromtxt(tmp_path / "hyq_gait.csv", delimiter=",", names=True)
    forces = np.array([table[f"{leg}_foot"] for leg in ("lf", "rf", "lh", "rh")])
    assert ((forces > 100).sum(0) == 2).all() and forces.max() < 600
    assert abs(forces.sum(0).mean() - 86.8 * 9.81) < 5
    torques = np.array([table[name] for name in table.dtype.names[1:13]])
    assert np.isfinite(torques).all() and 80 < np.abs(torques).max() < 150
    assert (tmp_path / "hyq_gait.png").read_bytes().startswith(b"\x89PNG")
    assert "HYQ_MODEL_H" in (tmp_path / "hyq_model.h").read_text()


def test_fall(tmp_path, monkeypatch):
    """It lies still in the end, no energy came from nothing, and all frames are there."""
    monkeypatch.setenv("PYTHONPATH", str(PYTHON))
    printed = run(sys.executable, PYTHON / "examples/hyq_falls.py", tmp_path)
    energy = [float(number) for number in re.findall(r"s: *([\d.]+) J", printed)]
    assert len(energy) == 30 and (np.diff(energy) <= 0).all() and energy[0] - energy[-1] > 300
    speed, force, weight = map(float, re.search(
        r"above (\S+), with ([\d.]+) N on the ground, weight ([\d.]+) N", printed).groups())
    assert speed < 1e-5 and abs(force - weight) < 0.05
    unsolved, worst = re.search(r"of 1500 steps (\d+) .* than (\S+) m/s", printed).groups()
    assert int(unsolved) < 40 and float(worst) < 0.05  # legs hit their limits and the ground at once
    frames = sorted(tmp_path.glob("hyq_falls_*.png"))
    assert len(frames) == 30 and all(path.read_bytes().startswith(b"\x89PNG") for path in frames)


def test_landing(tmp_path, monkeypatch):
    """It stands in the end, its feet carry it, and the page has two seconds."""
    monkeypatch.setenv("PYTHONPATH", str(PYTHON))
    printed = run(sys.executable, PYTHON / "examples/hyq_lands.py", tmp_path / "page.html")
    height, force, weight = map(float, re.search(r"stands at (\S+) m; its feet carry (\S+) N of (\S+) N", printed).groups())
    assert 0.5 < height < 0.65 and abs(force - weight) < 1
    page = (tmp_path / "page.html").read_text()
    assert '"bodies": 13' in page and len(page) > 13 * 12 * 4 * 120


@pytest.mark.skipif(not os.environ.get("RBD_ALL_TESTS"), reason="but by ./run test --all")
def test_servo_arm(tmp_path, monkeypatch):
    """What was identified explains the friction, and compensates it at each joint."""
    monkeypatch.setenv("PYTHONPATH", str(PYTHON))
    printed = run(sys.executable, PYTHON / "examples/servo_arm.py", tmp_path)
    table = np.array(re.findall(r"^.+? +([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+)$", printed, re.M), float)
    friction, left, before, after = table.T
    assert table.shape == (7, 4) and (left < 0.15 * friction).all()
    assert (before > 5).all() and (after < before / 7).all()
    factor = float(re.search(r"falls by a factor of ([\d.]+)", printed).group(1))
    assert factor > 18 and abs(factor - np.linalg.norm(before) / np.linalg.norm(after)) < 0.1
    assert (tmp_path / "servo_arm.png").read_bytes().startswith(b"\x89PNG")


def test_package_installs_without_network(tmp_path):
    """In a venv that sees the system's numpy, pip and setuptools, away from the repository."""
    run(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", tmp_path / "venv")
    python = tmp_path / "venv/bin/python"
    (tmp_path / "tree").mkdir()
    run("cp", "-r", PYTHON, *rbd.SOURCES.glob("rbd*.h"), rbd.SOURCES / "LICENSE", rbd.SOURCES / "models",
        rbd.SOURCES / "tools", tmp_path / "tree")
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    run(python, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index",
        tmp_path / "tree/python", env=environment)
    left = {path.name for path in (tmp_path / "tree/python").iterdir()}
    assert not left & {"build", "rbd.egg-info"}, f"pip left {left}"
    run("rm", "-r", tmp_path / "tree")
    where = run(python, "-c", "import rbd; print(rbd.__file__, rbd.__version__)", cwd=tmp_path,
                env=environment)
    assert str(tmp_path / "venv") in where and where.split()[1] == rbd.__version__
    assert "def rnea(" in Path(where.split()[0]).with_suffix(".pyi").read_text()
    run(python, "-c", readme_program(), cwd=tmp_path, env=environment)
    assert (tmp_path / "iiwa_model.h").stat().st_size > 1000
