# SPDX-License-Identifier: MIT
"""A wheel with compiled libraries: nothing is compiled by who uses it. And tables are read without a compiler."""
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest

import rbd
from rbd import _plain_table
from rbd._compiling import _run

PYTHON = Path(__file__).resolve().parent.parent
SAYS = """
import json, numpy, rbd
model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"))
q, v, a = model.random(seed=1), numpy.linspace(-1, 1, model.nv), numpy.ones(model.nv)
said = {"tau": model.rnea(q, v, a).tolist(), "many": model.rnea(model.random(2, n=50), v, a).sum(), "file": rbd.__file__}
said["table"] = model.c_model("iiwa")
try:
    said["nv"] = rbd.Model.from_urdf(rbd.SOURCES / "models/hyq.urdf", floating=True).nv
except RuntimeError as error:
    said["nv"] = str(error)
try:
    robot = rbd.parse_mjcf('<mujoco><worldbody><body><joint axis="0 1 0"/><geom size="0.1" pos="1 0 0" mass="2"/></body></worldbody></mujoco>')
    said["mjcf"] = rbd.Model(robot).gravity_torque([0]).tolist()
except RuntimeError as error:
    said["mjcf"] = str(error)
said["page"] = len(model.show(q, file="page.html").html)
print(json.dumps(said))
"""


def without_compiler(program, folder):
    """What a program prints that finds no command at all, as an error or as text."""
    environment = {"PYTHONPATH": str(folder), "PATH": "/nonexistent", "HOME": str(folder), "RBD_CACHE": str(folder / "cache")}
    return subprocess.run([sys.executable, "-c", program], env=environment, cwd=folder, text=True, capture_output=True)


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The folder of a package from a wheel for this machine."""
    if not os.environ.get("RBD_ALL_TESTS"):
        pytest.skip("but by ./run test --all: a wheel, of which the library is compiled")
    here = {"linux-x86_64": "linux-x86-64", "linux-aarch64": "linux-aarch64"}.get(sysconfig.get_platform())
    if here is None:
        pytest.skip(f"no wheel for {sysconfig.get_platform()}")
    folder = tmp_path_factory.mktemp("wheel")
    wheel = _run([sys.executable, str(PYTHON / "make_wheel.py"), "--quick", here, str(folder / "wheels")]).strip()
    assert re.fullmatch(rf"rbd-{re.escape(rbd.__version__)}-py3-none-manylinux_2_\d\d_\w+\.whl", Path(wheel).name)
    _run([sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index", "--target", str(folder / "site"), wheel])
    return folder / "site"


def test_package_of_a_wheel_compiles_nothing(installed):
    done = without_compiler(SAYS, installed)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    said = json.loads(done.stdout)
    assert said["file"].startswith(str(installed))

    model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"))
    q, v, a = model.random(seed=1), np.linspace(-1, 1, model.nv), np.ones(model.nv)
    np.testing.assert_allclose(said["tau"], model.rnea(q, v, a), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(said["many"], model.rnea(model.random(2, n=50), v, a).sum(), rtol=1e-10)
    assert said["table"] == model.c_model("iiwa")
    assert said["nv"] == 18 or "urdfdom" in said["nv"]
    if sysconfig.get_platform() == "linux-x86_64":
        assert said["mjcf"] == pytest.approx([-2 * 9.81])
    assert said["page"] > 10000
    assert not list(installed.glob("cache/*"))


def test_package_of_a_wheel_says_what_it_cannot(installed):
    """Other flags need a compiler, and so do other headers than those that were compiled."""
    for program in 'rbd.Library("double", flags="-O2")', 'rbd.Library("double", lanes=4)':
        assert "rbd needs 'cc'" in without_compiler(f"import rbd; {program}", installed).stderr
    header = installed / "rbd/sources/rbd_ik.h"
    text = header.read_text()
    header.write_text(text + "/* changed */\n")
    try:
        assert "rbd needs 'cc'" in without_compiler('import rbd; rbd.Library("double")', installed).stderr
    finally:
        header.write_text(text)


WINDOWS = """
#include <stdio.h>
#include <stdlib.h>
#include "rbd_batch.h"
#include "models/iiwa.h"
int rbd_machine_level(void);
int main(void) {
    static double q[50 * 7], v[50 * 7], a[50 * 7], tau[50 * 7];
    const rbd_model *model;
    rbd_batch *batch;
    size_t size = rbd_model_size(iiwa_bodies, IIWA_NB);
    if (rbd_model_build(iiwa_bodies, IIWA_NB, malloc(size), size, &model, NULL) != RBD_OK) return 1;
    size = rbd_batch_size(model);
    if (rbd_batch_init(model, malloc(size), size, &batch) != RBD_OK) return 2;
    for (int k = 0; k < 50 * 7; k++) q[k] = 0.01 * k, v[k] = 1 - 0.002 * k, a[k] = 0.5;
    if (rbd_batch_rnea(model, batch, 50, q, v, a, NULL, tau) != RBD_OK) return 3;
    for (int k = 0; k < 50 * 7; k++) printf("%.17g\\n", tau[k]);
    return rbd_machine_level() < 0;
}
"""


def test_package_of_a_windows_wheel(tmp_path):
    """Its libraries load, as ctypes would load them, and compute what those of this machine do; a Python for Windows is not
    at hand."""
    if not os.environ.get("RBD_ALL_TESTS"):
        pytest.skip("but by ./run test --all: a wheel, of which the library is compiled")
    if not shutil.which("wine") or not shutil.which("x86_64-w64-mingw32-gcc"):
        pytest.skip("wine or MinGW is not installed")
    wheel = _run([sys.executable, str(PYTHON / "make_wheel.py"), "--quick", "windows-x86-64", str(tmp_path)]).strip()
    assert wheel.endswith("-py3-none-win_amd64.whl")
    _run([sys.executable, "-m", "zipfile", "-e", wheel, str(tmp_path)])
    folder = tmp_path / "rbd/compiled"
    (folder / "main.c").write_text(WINDOWS)
    _run(["x86_64-w64-mingw32-gcc", "-std=c99", f"-I{rbd.SOURCES}", str(folder / "main.c"), str(folder / "double-0.dll"),
          str(folder / "machine.dll"), "-o", str(folder / "main.exe")])
    done = subprocess.run(["wine", str(folder / "main.exe")], env={**os.environ, "WINEDEBUG": "-all"}, stdout=subprocess.PIPE, text=True)
    assert done.returncode == 0
    k = np.arange(50 * 7).reshape(50, 7)
    model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"))
    expected = model.rnea(0.01 * k, 1 - 0.002 * k, np.full((50, 7), 0.5))
    np.testing.assert_allclose(np.array(done.stdout.split(), float).reshape(50, 7), expected, rtol=1e-10, atol=1e-10)


def compiled(path, text):
    """The rows by the compiler: `#if` stands in no plain table."""
    path.write_text(text.replace("_NB] = {\n", "_NB] = {\n#if 1\n", 1).replace("\n};\n/* clang", "\n#endif\n};\n/* clang", 1))
    assert "#if 1\n" in path.read_text()
    return rbd.load_table(path)


@pytest.mark.parametrize("name", ["atlas", "five_bar", "hyq"])
def test_tables_are_read_as_the_compiler_reads_them(name, tmp_path):
    text = (rbd.SOURCES / f"models/{name}.h").read_text()
    plain = _plain_table._plain_rows(text, f"{name}_bodies")
    assert plain and rbd.load_table(rbd.SOURCES / f"models/{name}.h") == compiled(tmp_path / "t.h", text)


def test_a_table_that_was_written_is_read(tmp_path):
    """Names and numbers that are hard to write."""
    rows = [rbd.Body(name='a "quoted\\" ??/ name, {0}; /* ', joint="j\u00e9", type="revolute", axis=(0, 1e-300, 1), mass=1e300,
                     inertia=(1, 0, 0, 1, 0, 1), lower=-0.1, upper=1 / 3, armature=1e-7),
            rbd.Body(name="b", joint="k", parent=0, type="spherical", mass=2.5e-7, com=(1 / 3, -0.0, 1e-9),
                     inertia=(1e-9, 0, 0, 1e-9, 0, 1e-9), damping=(1, 2, 3), friction=(0, 0, 0.5))]
    text = rbd.Model(rows).c_table("odd")
    path = tmp_path / "odd.h"
    path.write_text(text)
    plain = _plain_table._plain_rows(text, "odd_bodies")
    assert plain and rbd.load_table(path) == compiled(tmp_path / "t.h", text)


@pytest.mark.parametrize("change", [
    ("{1, 0, 0", "{.x = 1, 0, 0"), ("4, {", "(4), {"), ("4, {", "4 + 0, {"), ("RBD_REVOLUTE", "TYPE"), ('", "', '" "'),
    ("{0}, {0}", "{0} {0}"), ("4, {", "4,, {"), ("NULL, 0, 0}", "NULL, 0, 0, 0}"), ("4, {", "0x4, {"), ("4, {", "4.f, {"),
    ("{1, 0, 0", "{{1}, 0, 0"), ("};\n/* clang", "}, 0;\n/* clang"), ("4, {", "04, {"), ("-1, RBD_REVOLUTE", "99999999999, RBD_REVOLUTE"),
    ("IIWA_NB 7", "IIWA_NB 8"), ("[IIWA_NB]", "[6]"), ("static const rbd_body", "#ifdef OTHER\nstatic const rbd_body"),
    ("static const rbd_body", "#if 1\n#else\nstatic const rbd_body"),
    ("static const rbd_body", "rbd_body iiwa_bodies[1] = {{0}};\nstatic const rbd_body")])
def test_what_is_not_plain_is_left_to_a_compiler(change):
    text = (rbd.SOURCES / "models/iiwa.h").read_text()
    assert change[0] in text
    assert _plain_table._plain_rows(text.replace(*change, 1), "iiwa_bodies") is None


def test_a_table_in_a_comment_is_none():
    text = (rbd.SOURCES / "models/iiwa.h").read_text()
    rows = _plain_table._plain_rows("/* rbd_body iiwa_bodies[1] = {{0}}; */\n// rbd_body iiwa_bodies[1] = {{0}};\n" + text,
                                    "iiwa_bodies")
    assert len(rows) == 7
