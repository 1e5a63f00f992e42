# SPDX-License-Identifier: MIT
"""Inverse kinematics: rbd_ik.h."""
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rbd


@pytest.fixture
def arm(library):
    return rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"), library=library)


def test_poses_are_reached_within_limits(arm):
    close = 2e-5 if arm.library.real == "float" else 2e-6
    for seed in range(20):
        arm.kinematics(arm.random(seed=seed))
        pose = arm.body_pose("lbr_iiwa_link_7")
        found = arm.ik(rbd.IkTarget("pose", "lbr_iiwa_link_7", position=pose.p, rotation=pose.R), arm.random(seed=99 - seed))
        assert found.status == rbd.IkStatus.REACHED and found.q.dtype == arm.library.dtype
        arm.kinematics(found.q)
        reached = arm.body_pose("lbr_iiwa_link_7")
        assert np.abs(reached.p - pose.p).max() < close and np.abs(reached.R - pose.R).max() < close
        for k in range(arm.nv):
            joint = arm.joint(k)
            assert joint.lower <= found.q[k] <= joint.upper


def test_what_is_out_of_reach_says_how_far(arm):
    slide = rbd.Model([rbd.Body("cart", type="prismatic", axis=(1, 0, 0), mass=2, inertia=(1, 0, 0, 1, 0, 1), upper=0.5, lower=-0.5)],
                      library=arm.library)
    found = slide.ik([rbd.IkTarget("point", "cart", position=(0.75, 0, 0))])
    assert found.status == rbd.IkStatus.AT_LIMIT and found.limit == 0 and found.q[0] == 0.5
    assert abs(found.metres - 0.25) < 1e-6
    found = slide.ik([rbd.IkTarget("com", position=(0.25, 0.125, 0))])
    assert found.status == rbd.IkStatus.NEAREST and abs(found.metres - 0.125) < 1e-6 and abs(found.q[0] - 0.25) < 1e-3
    found = slide.ik([rbd.IkTarget("com", position=(0.25, 0, 0))], [0.125], held=[1])
    assert found.status == rbd.IkStatus.NEAREST and found.q[0] == 0.125


def test_example(tmp_path, monkeypatch, quick):
    """A hobby arm of five axes: poses, places, and what is too far."""
    python = Path(__file__).resolve().parents[1]
    monkeypatch.setenv("PYTHONPATH", str(python))
    printed = subprocess.run([sys.executable, python / "examples/arm_kinematics.py"], capture_output=True, text=True, check=True)
    assert printed.stdout.startswith("pose: REACHED [ 10. -40.  60.  50.  20.]")


def test_bad_targets_are_named(iiwa):
    for target, kind, text in (
            (rbd.IkTarget("pint"), ValueError, "field 'kind': unknown kind 'pint'; there are: point, pose, rotation, axis, com"),
            (rbd.IkTarget("pose", 9), rbd.RbdError, "target 0, field 'body': no such body: 9"),
            (rbd.IkTarget("axis", 6), rbd.RbdError, "target 0, field 'axis'"),
            (rbd.IkTarget("point", 6, weight=-1), rbd.RbdError, "target 0, field 'weight'"),
            (rbd.IkTarget("point", 6, position=(1, 2)), ValueError, "position"),
            (rbd.IkTarget("point", 6, position=(1, 2, np.nan)), ValueError, "position"),
            (3, TypeError, "target")):
        with pytest.raises(kind, match=text.replace("(", r"\(")):
            iiwa.ik([target])
    with pytest.raises(ValueError, match="held must be 0 or 1"):
        iiwa.ik([rbd.IkTarget("point")], held=[2] * 7)
    with pytest.raises(rbd.RbdError):
        iiwa.ik([])
    with pytest.raises(rbd.RbdError, match="field 'starts'"):
        iiwa.ik(rbd.IkTarget("point"), starts=-1)
    with pytest.raises(rbd.RbdError, match="field 'evaluations'") as error:
        iiwa.ik(rbd.IkTarget("point"), evaluations=1)
    assert error.value.status == rbd.Status.ERR_RANGE
    ball = rbd.Model([rbd.Body("ball", type="spherical", mass=1, inertia=(1, 0, 0, 1, 0, 1))])
    with pytest.raises(rbd.RbdError, match="field 'held': only a part of a spherical, planar or floating joint is held"):
        ball.ik(rbd.IkTarget("point"), held=[1, 0, 1])


def test_enumerators_are_printed_by_name():
    assert f"{rbd.IkStatus.REACHED} {rbd.Status.ERR_INDEX} {rbd.JointType.REVOLUTE!s}" == \
        "IkStatus.REACHED Status.ERR_INDEX JointType.REVOLUTE"
    assert rbd.Status.ERR_INDEX == -4 and rbd.Status(-4) is rbd.Status.ERR_INDEX
