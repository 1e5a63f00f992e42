# SPDX-License-Identifier: MIT
"""The type stubs are made from the package, agree with it, and find a user's mistakes."""
import ast
import enum
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rbd

PYTHON = Path(rbd.__file__).resolve().parents[1]

RIGHT = '''
import numpy as np
import rbd

library = rbd.Library("float")
model = rbd.Model.from_urdf("x.urdf", floating=True, lock={"a": 0.5}, keep="tool", library=library)
q = model.neutral()
tau = model.rnea(q, [0.0] * model.nv, np.zeros(model.nv), f_ext=None) * 2
d = model.fd_derivatives(q, tau, tau, Minv=False)
work: float = model.energy().kinetic + model.mass()
product = d.da_dq @ d.da_dv.T
R, p = model.body_pose("hand")
J = model.jacobian("hand", (0, 0, 1), axes="link")
held = model.constraint_set([model.point_contact("foot"), rbd.Constraint("tip", 0, rotation1=np.eye(3))])
force = held.constrained_fd(q, tau, tau).lambda_.sum()
names = [name.upper() for name in model.dof_names]
spatial = model.library.spatial
pose = spatial.placement_compose(model.body_pose(0), spatial.placement_exp(np.zeros(6)))
body = rbd.Body("rod", type="revolute", axis=[0, 1, 0], com=np.zeros(3))
same = body.com[0] == pose.rotation[0, 0] and model.joint("knee").type == rbd.JointType.REVOLUTE
try:
    model.aba(q, tau, tau)
except rbd.RbdError as error:
    if error.status == rbd.Status.ERR_SINGULAR:
        print(error.results)
'''
WRONG = '''
import rbd
model = rbd.Model.from_urdf("x.urdf", floating="yes")   # arg-type
model.rnea([0.0], [0.0])                                # call-arg
model.rnae([0.0])                                       # attr-defined
model.jacobian("hand", axes="body")                     # arg-type
model.joint(1.5)                                        # arg-type
model.fd_derivatives([0.0], [0.0], [0.0]).tau           # attr-defined
rbd.load_urdf("x", rooot="a")                           # call-arg
rbd.Library(lanes="4")                                  # arg-type
rbd.Path                                                # attr-defined
'''


@pytest.fixture
def stubs(tmp_path):
    """A folder for mypy's path with the stubs of the package."""
    folder = tmp_path / "stubs/rbd"
    folder.mkdir(parents=True)
    subprocess.run([sys.executable, str(PYTHON / "stubs.py"), str(folder / "__init__.pyi")], check=True)
    (folder / "py.typed").touch()
    return folder.parent


def test_stubs_have_every_public_name(stubs):
    """They are Python, and define each public name, and each method that a user can see."""
    tree = ast.parse((stubs / "rbd/__init__.pyi").read_text())
    found = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert set(rbd.__all__) - {"SOURCES"} <= set(found)
    for name in rbd.__all__:
        thing = getattr(rbd, name)
        if not isinstance(thing, type) or issubclass(thing, (tuple, enum.Enum, Warning)):
            continue
        body = [node for owner in thing.__mro__ if owner.__name__ in found for node in found[owner.__name__].body]
        methods = {node.name for node in body if isinstance(node, ast.FunctionDef)}
        methods |= {node.target.id for node in body if isinstance(node, ast.AnnAssign)}
        methods |= {target.id for node in body if isinstance(node, ast.Assign) for target in node.targets}
        seen = {member for member in dir(thing) if not member.startswith("_")} - set(dir(Exception))
        assert seen <= methods, f"{name}: {seen - methods}"
    assert (PYTHON / "rbd/py.typed").is_file()


@pytest.mark.skipif(not importlib.util.find_spec("mypy"), reason="mypy is not installed")
@pytest.mark.skipif(not os.environ.get("RBD_ALL_TESTS"), reason="but by ./run test --all")
def test_stubs_pass_mypy(tmp_path, stubs):
    """mypy --strict accepts the right program and finds each wrong line, and stubtest compares the stubs with rbd, of which
    they are made: test_stubs_have_every_public_name sees every day what is missing."""
    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(WRONG)
    environment = {**os.environ, "MYPYPATH": str(stubs), "PYTHONPATH": str(PYTHON)}

    def run(*command):
        return subprocess.run([sys.executable, "-m", *command], cwd=tmp_path, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    printed = run("mypy", "--strict", "-p", "rbd", "-m", "right", "-m", "wrong").stdout
    found = re.findall(r"^(\S+):(\d+): error: .*\[(\S+)\]$", printed, re.M)
    expected = [("wrong.py", str(number), line.partition("# ")[2])
                for number, line in enumerate(WRONG.splitlines(), 1) if "# " in line]
    assert found == expected and len(expected) == 9, printed
    compared = run("mypy.stubtest", "rbd", "--concise")
    assert compared.returncode == 0, compared.stdout
