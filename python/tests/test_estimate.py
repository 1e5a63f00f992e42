# SPDX-License-Identifier: MIT
"""External torques, friction and payload: rbd_estimate.h."""
import copy
import pickle

import numpy as np
import pytest

import rbd


def plan(t, n=7):
    k = np.arange(n)
    f, g = 1.1 + 0.37 * k, 2.3 - 0.19 * k
    return (0.6 * np.sin(f * t + k) + 0.3 * np.cos(g * t), 0.6 * f * np.cos(f * t + k) - 0.3 * g * np.sin(g * t),
            -0.6 * f ** 2 * np.sin(f * t + k) - 0.3 * g ** 2 * np.cos(g * t))


def test_a_payload_and_friction_are_found(library):
    bare = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"), library=library)
    loaded = bare.copy()
    loaded.add_payload(6, 2.5, (0.02, -0.03, 0.11), (0.012, 0, 0.001, 0.010, 0, 0.006))
    truth = np.stack([np.linspace(3, 0.4, 7), np.linspace(1, 0.1, 7), np.linspace(-0.1, 0.1, 7)], axis=1)
    hand = rbd.Estimator(bare, 6, noise=np.full(7, 0.01))
    for k in range(300):
        q, v, a = plan(0.01 * k)
        hand.add(q, v, a, loaded.rnea(q, v, a) + truth[:, 0] * np.sign(v) + truth[:, 1] * v + truth[:, 2])
        found = hand.solve()
        library.check_parameters(found.payload)
    assert abs(found.payload[0] - 2.5) < 2e-4 and np.abs(found.friction - truth).max() < 1e-3
    assert found.misfit < 0.05
    sure = hand.deviations()
    assert sure.payload[0] < 0.01 and sure.friction.shape == (7, 3)
    hand.release()
    assert not hand.solve().payload.any()
    hand.grip()
    assert hand.deviations().payload[0] == pytest.approx(5, rel=1e-6)


def test_an_observer_feels_a_torque(library):
    model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"), library=library)
    q, v, push = np.full(7, 0.3), np.zeros(7), np.arange(7) - 3.0
    observer = rbd.Observer(model, gain=5000)
    assert not observer.step(q, v, np.zeros(7), 1e-3).r.any()
    for k in range(30):
        felt = observer.step(q, v, model.gravity_torque(q) - push, 1e-3)
    assert np.allclose(felt.r, push, atol=1e-3) and not felt.band.any()
    observer.friction[:, 0] = 2
    for k in range(30):
        felt = observer.step(q, v, model.gravity_torque(q) - push, 1e-3)
    assert np.allclose(felt.band, 2, atol=1e-5)
    for again in copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x)):  # with its options, from the beginning
        other = again(observer)
        assert not other.step(q, v, np.zeros(7), 1e-3).r.any()
        for k in range(30):
            felt = other.step(q, v, model.gravity_torque(q) - push, 1e-3)
        assert np.allclose(felt.r, push, atol=1e-3) and np.allclose(felt.band, 2, atol=1e-5)
    observer.reset()
    assert not observer.step(q, v, np.zeros(7), 1e-3).r.any()


def test_bad_input_is_named(iiwa):
    q = np.zeros(7)
    with pytest.raises(rbd.RbdError, match="observer_init: gain: out of range"):
        rbd.Observer(iiwa, gain=0)
    with pytest.raises(rbd.RbdError, match=r"observer_init: coulomb\[2\]: out of range"):
        rbd.Observer(iiwa, 40, friction=[[-(k == 2), 0, 0] for k in range(7)])
    observer = rbd.Observer(iiwa, gain=40)
    with pytest.raises(rbd.RbdError, match="observer_step: dt: out of range"):
        observer.step(q, q, q, 0)
    with pytest.raises(ValueError, match="observer_step: tau"):
        observer.step(q, q, [np.nan] * 7, 1e-3)
    with pytest.raises(ValueError, match=r"observer_step: v must have the shape"):
        observer.step(q, q[:3], q, 1e-3)
    with pytest.raises(rbd.RbdError, match=r"estimate_init: noise\[0\]: out of range"):
        rbd.Estimator(iiwa, 6, noise=np.zeros(7))
    with pytest.raises(rbd.RbdError, match="Estimator: no such body"):
        rbd.Estimator(iiwa, 9)
    alone = rbd.Estimator(iiwa)
    with pytest.raises(rbd.RbdError, match="estimate_grip: no such body"):
        alone.grip()
    with pytest.raises(rbd.RbdError, match=r"estimate_add: tau\[3\]: out of range"):
        alone.add(q, q + 1, q, [0, 0, 0, 1e30, 0, 0, 0])
