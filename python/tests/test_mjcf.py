# SPDX-License-Identifier: MIT
"""MJCF files: rows, constraints, states of MuJoCo; what is said without MuJoCo."""
from pathlib import Path

import numpy as np
import pytest

import rbd
from rbd import _mjcf

FILES = Path(__file__).resolve().parents[2] / "tests/mjcf"
ARM = """<mujoco model="arm"><option gravity="0 0 -5"/><worldbody><body name="a"><joint name="j" axis="0 1 0" range="-90 90"
limited="true"/><geom size="0.1" pos="1 0 0" mass="2"/></body></worldbody></mujoco>"""


@pytest.fixture(scope="module")
def mujoco():
    try:
        return _mjcf._mjcf_library()
    except RuntimeError as error:
        pytest.skip(f"SKIPPED: {error}")


def test_the_torque_of_gravity(mujoco):
    robot = rbd.parse_mjcf(ARM)
    assert robot.name == "arm" and robot.gravity == (0, 0, -5) and robot.places == {"j": (0, 0)}
    assert robot.bodies[0].lower == pytest.approx(-np.pi / 2)
    assert rbd.Model(robot).gravity_torque([0]) == pytest.approx([-2 * 5])
    assert rbd.Model(rbd.parse_mjcf(ARM, gravity=(0, 0, -1))).gravity_torque([0]) == pytest.approx([-2])


def test_states_of_mujoco(mujoco):
    robot = rbd.load_mjcf(FILES / "joints.xml")
    model = rbd.Model(robot)
    random = np.random.default_rng(1)
    q = np.array([model.integrate(model.neutral(), random.uniform(-1, 1, model.nv), 1) for _ in range(3)])
    v = random.uniform(-1, 1, (3, model.nv))
    qpos = robot.qpos_of_q(q)
    qvel = robot.qvel_of_v(qpos, v)
    assert (qpos.shape, qvel.shape) == ((3, robot.nqpos), (3, robot.nqvel)) == ((3, 30), (3, 26))
    assert np.allclose(robot.q_of_qpos(qpos), q, 0, 1e-14) and np.allclose(robot.v_of_qvel(qpos, qvel), v, 0, 1e-14)
    drone = [frame.link for frame in robot.frames].index("drone")
    iq, iv = robot.places["flight"]
    model.kinematics(q[1], v[1])
    R, p = model.body_pose(robot.frames[drone].body)
    velocity = model.body_velocity(robot.frames[drone].body)
    assert np.allclose(qpos[1, iq:iq + 3], p) and np.allclose(qvel[1, iv:iv + 3], R @ velocity[3:])
    assert np.allclose(qvel[1, iv + 3:iv + 6], velocity[:3])
    with pytest.raises(ValueError, match=r"q_of_qpos: qpos must have the shape \(\.\.\., 30\), not \(29,\)"):
        robot.q_of_qpos(np.zeros(29))


def test_states_of_a_description_that_was_changed(mujoco):
    """Bodies may be removed, and bodies without joints added; a joint that MuJoCo does not know is named."""
    text = ARM.replace("</body></worldbody>", "<body name='b' pos='1 0 0'><joint name='k'/><geom size='0.1'/></body></body>"
                       "<body name='c' pos='9 0 0'><joint name='l' type='slide'/><geom size='0.1'/></body></worldbody>")
    robot = rbd.parse_mjcf(text)
    assert robot.q_of_qpos([1, 2, 3]).tolist() == [1, 2, 3]
    robot.bodies.append(rbd.Body("tool", parent=1, type="fixed"))
    assert robot.q_of_qpos([1, 2, 3]).tolist() == [1, 2, 3]
    del robot.bodies[1]  # k of b: l is behind it
    robot.bodies[-1].parent = 0
    assert robot.q_of_qpos([1, 2, 3]).tolist() == [1, 3] and robot.qpos_of_q([4, 5]).tolist() == [4, 0, 5]
    robot.bodies.append(rbd.Body("hand", parent=0, type="revolute", joint="grip"))
    for call, arguments in ("q_of_qpos", [[1, 2, 3]]), ("qvel_of_v", [[1, 2, 3], [1, 2, 3]]):
        with pytest.raises(ValueError, match=f"{call}: joint 'grip' of body 'hand' is not in the MJCF file"):
            getattr(robot, call)(*arguments)


def test_equalities_are_mimics_and_constraints(mujoco):
    with pytest.warns(rbd.RbdWarning, match="equality 'curved'"):
        robot = rbd.load_mjcf(FILES / "equalities.xml")
    model = rbd.Model(robot)
    constraints = rbd.ConstraintSet(model, robot.constraints)
    assert constraints.rows == 18 and [k.name for k in robot.constraints] == ["hook", "hung", "glue", "turned"]
    assert robot.nqvel - model.nv == 3
    with pytest.warns(rbd.RbdWarning):
        free = rbd.load_mjcf(FILES / "equalities.xml", free_mimics=True)
    assert set(free.places) - set(robot.places) == {"still"}


def test_options_and_errors(mujoco):
    model = rbd.Model.from_mjcf(FILES / "joints.xml", keep="on_plate", lock={"roll": 0.3})
    assert (model.body_index("on_plate"), model.nv) == (model.nb - 1, 25)
    with pytest.raises(rbd.RbdError, match="MJCF:2: MuJoCo .*: XML Error") as error:
        rbd.parse_mjcf("<mujoco>\n<bad/></mujoco>")
    assert error.value.status == rbd.MjcfStatus.ERR_COMPILER
    with pytest.raises(rbd.RbdError, match="lock: there is no joint 'x'"):
        rbd.parse_mjcf(ARM, lock="x")
    with pytest.raises(TypeError, match="load_mjcf: there is no option 'kep'; did you mean 'keep'"):
        rbd.load_mjcf("x.xml", kep="a")
    with pytest.raises(FileNotFoundError):
        rbd.load_mjcf("/no/such.xml")


def test_without_mujoco_the_error_says_what_to_do(monkeypatch):
    monkeypatch.setenv("CXX", "/no/such/compiler")
    _mjcf._mjcf_library.cache_clear()
    try:
        with pytest.raises(RuntimeError, match="libmujoco-dev; or pip install mujoco.*load_table"):
            rbd.parse_mjcf(ARM)
    finally:
        _mjcf._mjcf_library.cache_clear()
