# SPDX-License-Identifier: MIT
"""Whole-body control: rbd_tasks.h."""
import copy
import pickle

import numpy as np
import pytest

import rbd

LEGS = "lf", "rf", "lh", "rh"


def standing(model):
    """HyQ on z = 0, and its feet."""
    q = model.neutral()
    for k, leg in enumerate(LEGS):
        q[model.joint(f"{leg}_hfe_joint").iq] = 0.7 if k < 2 else -0.7
        q[model.joint(f"{leg}_kfe_joint").iq] = -1.4 if k < 2 else 1.4
    model.kinematics(q)
    q[2] -= model.point_position("lf_lowerleg", (0.33, 0, 0))[2]
    return q, [rbd.TaskContact(f"{leg}_lowerleg", point=(0.33, 0, 0), friction=0.5) for leg in LEGS]


def test_a_robot_stands(library):
    model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"), library=library)
    q, feet = standing(model)
    close = 1e-3 if library.real == "float" else 1e-5
    trunk = rbd.Task("pose", "base_link_0", position=q[:3], gain=10)
    control = rbd.Tasks(model, [trunk, rbd.Task("posture", q=q, gain=10, weight=1e-3)], feet)
    still = np.zeros(model.nv)
    for _ in range(2):  # cold, warm
        found = control.acceleration(q, still)
        assert found.status == rbd.TasksStatus.OK and found.a.dtype == library.dtype
        assert np.abs(found.forces.sum(0) - (0, 0, 9.81 * model.mass())).max() < close * 9.81 * model.mass()
        assert np.abs(found.a).max() < 100 * close and not found.tau[:6].any()
    feet[1].open = True
    control.contacts = feet
    trunk.velocity = (0, 0, 0, 0, 0, 0.1)
    assert not control.acceleration(q, still).forces[1].any()
    v = control.velocity(q).v
    assert abs(v[5] - 0.1) < 0.02  # the posture costs some
    model.kinematics(q, v)
    assert np.abs(model.point_velocity("lf_lowerleg", (0.33, 0, 0))[3:]).max() < close
    for again in copy.deepcopy(control), pickle.loads(pickle.dumps(control)):
        assert np.abs(again.velocity(q).v - v).max() < close
    assert repr(control) == "<rbd.Tasks, 2 tasks, 4 contacts>"


def test_levels_limits_and_rows(double):
    slide = rbd.Model([rbd.Body("cart", type="prismatic", axis=(1, 0, 0), mass=2, inertia=(1, 0, 0, 1, 0, 1), upper=0.5, lower=-0.5)], library=double)
    fast = rbd.Task("point", "cart", velocity=(0, 0, 0, 3, 0, 0), weight=3)
    rows = rbd.Task("rows", jacobian=[[1], [2]], y=[1, 2])
    control = rbd.Tasks(slide, [fast, rows], without=["position"])
    assert abs(control.velocity([0]).v[0] - (3 * 3 + 1 + 4) / 8) < 1e-5
    fast.level = 1
    assert abs(control.velocity([0]).v[0] - 1) < 1e-5
    control.without, control.tasks = (), [fast]
    assert control.velocity([0.5]).v[0] == 0
    control.limit = [2]
    assert abs(control.velocity([0], [0.5]).v[0] - 0.502) < 1e-12
    found = control.acceleration([0], [0], f_ext=[[0, 0, 0, 4, 0, 0]])
    assert abs(found.tau[0] + 4 - 2 * found.a[0]) < 1e-12


def test_what_contradicts_is_named(hyq):
    q, feet = standing(hyq)
    feet[2].most = 1
    for foot in feet:
        foot.friction = 0
    control = rbd.Tasks(hyq, contacts=feet, lower=np.zeros(hyq.nv), upper=np.zeros(hyq.nv), torque=np.full(hyq.nv, 1e-3))
    with pytest.raises(rbd.RbdError, match="contradicts") as error:
        control.acceleration(q, np.zeros(hyq.nv))
    assert error.value.status == rbd.Status.ERR_INFEASIBLE


def test_bad_input_is_named(iiwa):
    q, v = np.zeros(7), np.zeros(7)
    for tasks, contacts, options, kind, text in (
            ([rbd.Task("pint")], [], {}, ValueError, "task 0, field 'kind': unknown kind 'pint'; there are: point, pose"),
            ([rbd.Task("com"), rbd.Task("pose", 9)], [], {}, rbd.RbdError, "task 1, field 'body': no such body: 9"),
            ([rbd.Task("pose", 6, weight=-1)], [], {}, rbd.RbdError, "task 0, field 'weight'"),
            ([rbd.Task("pose", 6, position=(1, 2))], [], {}, ValueError, "position"),
            ([rbd.Task("posture")], [], {}, rbd.RbdError, "task 0, field 'q'"),
            ([rbd.Task("posture", q=np.zeros(6))], [], {}, ValueError, "q must"),
            ([rbd.Task("rows")], [], {}, rbd.RbdError, "field 'jacobian'"),
            ([6], [], {}, TypeError, "task 0 must be a Task, not int"),
            ([], [6], {}, TypeError, "contact 0 must be a TaskContact"),
            ([], [rbd.TaskContact(6, friction=-1)], {}, rbd.RbdError, "contact 0, field 'friction'"),
            ([], [], {"dt": 0}, rbd.RbdError, "field 'dt'"),
            ([], [], {"speed": [-1] * 7}, rbd.RbdError, "dof 0, field 'speed'"),
            ([], [], {"without": 8}, TypeError, "without must be a list of names"),
            ([], [], {"without": "torque"}, TypeError, "not 'torque'"),
            ([], [], {"without": ["weight"]}, ValueError, "'weight'")):
        with pytest.raises(kind, match=text.replace("'", ".")):
            rbd.Tasks(iiwa, tasks, contacts, **options).acceleration(q, v)
