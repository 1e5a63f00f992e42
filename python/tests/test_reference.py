# SPDX-License-Identifier: MIT
"""Every call against the reference results: on every model and state, single and in batches, both scalars."""
import warnings
from dataclasses import replace

import numpy as np
import pytest
import reference

import rbd

BATCH = 11  # states of a batch: no multiple of the lanes


class Judge:
    """Compares with a bound by the scalar's rounding and the condition; knows what it has compared."""

    def __init__(self, library):
        self.epsilon = np.finfo(library.dtype).eps
        self.compared, self.asked = set(), set()
        self.where = ""

    def __call__(self, what, found, expected, condition=0.0, least=1e-3, direct=None):
        expected = np.asarray(expected)
        found = np.asarray(found, float)
        if found.shape != expected.shape:
            found = found.reshape(expected.shape)
        if self.epsilon < 1e-10:  # tests/data/README.md
            bound = max(direct or 1e-11, 1e-15 * condition)
        else:
            bound = 1000 * self.epsilon + 100 * self.epsilon * condition
        self.asked.add(what)
        assert np.isfinite(found).all(), f"{self.where}, {what}"
        if bound > 0.05:  # float, and a matrix so bad that no digit is sure
            return
        self.compared.add(what)
        error = np.abs(found - expected).max(initial=0) / max(np.abs(expected).max(initial=0), least)
        assert error <= bound, f"{self.where}, {what}: error {error:.3g} exceeds {bound:.3g}"


def build(bodies, library):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rbd.RbdWarning)  # bodies without mass among them
        return rbd.Model(bodies, library=library)


def batches(states):
    """The states of each gravity, repeated to the length of a batch: (gravity, states)."""
    groups = {}
    for state in states:
        groups.setdefault(tuple(state.gravity), []).append(state)
    for gravity, group in groups.items():
        yield gravity, [group[k % len(group)] for k in range(BATCH)]


def stacked(group, name):
    return np.array([getattr(state, name) for state in group])


# What a state's figures are called, how they are computed, whether M's inverse is in them. `s` is one state
# or the arrays of a batch.
DYNAMICS = [
    ("tau_rnea", lambda m, s: m.rnea(s.q, s.v, s.vdot), False),
    ("tau_rnea_ext", lambda m, s: m.rnea(s.q, s.v, s.vdot, s.f_ext), False),
    ("c", lambda m, s: m.bias(s.q, s.v), False),
    ("M", lambda m, s: m.crba(s.q), False),
    ("Minv", lambda m, s: m.minverse(s.q), True),
    ("qdd", lambda m, s: m.aba(s.q, s.v, s.tau), True),
    ("qdd_ext", lambda m, s: m.aba(s.q, s.v, s.tau, f_ext=s.f_ext), True),
    ("qdd", lambda m, s: m.fd_cholesky(s.q, s.v, s.tau), True),
    ("qdd_ext", lambda m, s: m.fd_cholesky(s.q, s.v, s.tau, s.f_ext), True),
    ("A_h", lambda m, s: m.momentum_matrix(s.q).A, False),
    ("dtau_dq", lambda m, s: m.id_derivatives(s.q, s.v, s.vdot).dtau_dq, False),
    ("dtau_dv", lambda m, s: m.id_derivatives(s.q, s.v, s.vdot, dtau_dq=False).dtau_dv, False),
    ("M", lambda m, s: m.id_derivatives(s.q, s.v, s.vdot, dtau_dq=False, dtau_dv=False).M, False),
    ("dqdd_dq", lambda m, s: m.fd_derivatives(s.q, s.v, s.tau).da_dq, True),
    ("dqdd_dv", lambda m, s: m.fd_derivatives(s.q, s.v, s.tau, a=False).da_dv, True),
    ("Minv", lambda m, s: m.fd_derivatives(s.q, s.v, s.tau, a=False, da_dq=False, da_dv=False).Minv, True),
    ("qdd", lambda m, s: m.fd_derivatives(s.q, s.v, s.tau, Minv=False).a, True),
]
CONTROL = [
    ("dtau_dq_ext", lambda m, s: m.id_derivatives(s.q, s.v, s.vdot, s.f_ext).dtau_dq, False),
    ("dtau_dv_ext", lambda m, s: m.id_derivatives(s.q, s.v, s.vdot, s.f_ext).dtau_dv, False),
    ("dqdd_dq_ext", lambda m, s: m.fd_derivatives(s.q, s.v, s.tau, s.f_ext).da_dq, True),
    ("dqdd_dv_ext", lambda m, s: m.fd_derivatives(s.q, s.v, s.tau, s.f_ext).da_dv, True),
    ("C", lambda m, s: m.coriolis(s.q, s.v), False),
    ("A_h_dot_v", lambda m, s: m.momentum_matrix(s.q, s.v).A_dot_v, False),
]


def check_rows(judge, m, s, rows, cond):
    for name, compute, inverse in rows:
        least = 1 if name == "c" else 1e-3  # which may vanish
        judge(name, compute(m, s), getattr(s, name), cond if inverse else 0, least)


class Stack:
    """The arrays of a batch under the names of a state's."""

    def __init__(self, group):
        self.group = group

    def __getattr__(self, name):
        return stacked(self.group, name)


def check_batches(judge, m, states, rows):
    for gravity, group in batches(states):
        m.set_gravity(gravity)
        check_rows(judge, m, Stack(group), rows, max(state.cond_M for state in group))


def check_kinematics(judge, m, s, pi):
    m.kinematics(s.q, s.v, s.vdot)
    for body in range(m.nb):
        pose = m.body_pose(body)
        judge("body_R", pose.R, s.body_R[body])
        judge("body_p", pose.p, s.body_p[body], least=1)
        judge("body_vel", m.body_velocity(body), s.body_vel[body], least=1)
        judge("body_acc", m.body_acceleration(body), s.body_acc[body], least=1)
        classical = m.body_acceleration_classical(body)
        judge("body_acc_classical", classical[3:], s.body_acc_classical[body], least=1)
    for name, found in m.energy()._asdict().items():
        judge(name, found, getattr(s, name), least=10)
    com = m.com()
    judge("com", com.position, s.com)
    judge("com_vel", com.velocity, s.com_vel)
    judge("com_acc", com.acceleration, s.com_acc)
    judge("mass", m.mass(), s.mass)
    judge("J_world", m.jacobian(s.jac_body), s.J_world)
    judge("J_local", m.jacobian(s.jac_body, axes="link"), s.J_local)
    judge("J_local", m.relative_jacobian(s.jac_body, reference=s.jac_body), 0 * s.J_local)
    J_dot, body = m.jacobian_derivative(s.jac_body), s.jac_body
    judge("dJ/dt v", J_dot @ s.v + s.J_world @ s.vdot, m.point_acceleration(body), least=1)
    judge("dJ/dt", m.relative_jacobian_derivative(body, reference=-1), J_dot)
    spatial = m.jacobian_derivative(body, axes="link") @ s.v + s.J_local @ s.vdot
    judge("dJ/dt v, link axes", spatial, s.body_acc[body], least=1)
    judge("h", m.momentum().h, s.h, least=1)
    judge("h_dot", m.momentum().h_dot, s.h_dot, least=10)
    f = s.f_ext[s.jac_body]
    judge("J'f", m.jacobian_transpose(s.jac_body, None, "world", f), s.J_world.T @ f, least=1)
    parameters = np.array([m.body_parameters(body) for body in range(m.nb)])
    judge("pi", parameters, pi)
    joint_wrench = m.joint_wrench(s.q, s.v, s.vdot)
    world = np.zeros(6)
    for body, row in enumerate(joint_wrench):
        if m.bodies[body].parent == -1 and m.bodies[body].type != "fixed":
            R, p = m.body_pose(body)
            moment, force = R @ row[:3], R @ row[3:]
            world -= np.concatenate([moment + np.cross(p, force), force])
    judge("world_wrench", world, s.world_wrench, least=10)


def check_steps(judge, m, s):
    judge("q_next", m.integrate(s.q, s.v, s.dt), s.q_next)
    judge("d", m.difference(s.q, m.integrate(s.q, s.v, s.dt)), s.v * s.dt, least=1)
    judge("v", m.velocity_from_rates(s.q, m.rates_from_velocity(s.q, s.v)), s.v)


def check_cholesky(judge, m, s):
    packed = m.crba_packed(s.q)
    for i in range(m.nv):
        for j in range(i + 1):
            k = m.packed_index(i, j)
            judge("H", packed[k] if k >= 0 else 0.0, s.M[i, j], least=np.abs(s.M).max())
    factor = m.cholesky_factor(m.crba(s.q))
    judge("L", m.cholesky_factor_packed(packed), factor.astype(float), s.cond_M)
    judge("M^-1 b", m.cholesky_solve(factor, s.tau), s.Minv @ s.tau, s.cond_M)
    judge("M^-1 B", m.cholesky_solve_many(factor, np.eye(m.nv)[:, :3]), s.Minv[:, :3], s.cond_M)


def test_reference(library):
    judge = Judge(library)
    for model in reference.models():
        m = build(model.bodies, library)
        assert (m.nb, m.nq, m.nv) == (model.nb, model.nq, model.nv)
        for number, s in enumerate(model.states):
            judge.where = f"{model.name}, state {number}"
            m.set_gravity(s.gravity)
            check_rows(judge, m, s, DYNAMICS, s.cond_M)
            judge("g", m.gravity_torque(s.q), s.g, least=1)
            judge("Y", m.regressor(s.q, s.v, s.vdot), s.Y.reshape(m.nv, -1))
            check_kinematics(judge, m, s, model.pi)
            check_steps(judge, m, s)
            if number == 0:
                check_cholesky(judge, m, s)
        judge.where = f"{model.name}, batch"
        check_batches(judge, m, model.states, DYNAMICS)
        check_packed_batch(judge, m, model.states)
    assert judge.compared == judge.asked, judge.asked - judge.compared


def check_packed_batch(judge, m, states):
    """What a batch has beside these, against the single calls."""
    q, v, a = (stacked(states, name) for name in ("q", "v", "vdot"))
    judge("packed batch", m.crba_packed(q), [m.crba_packed(row).astype(float) for row in q])
    for number, state in enumerate(states):
        judge("J batch", m.batch_jacobian(q, state.jac_body)[number], state.J_world)
        judge("J batch", m.batch_jacobian(q, state.jac_body, axes="link")[number], state.J_local)
    h = m.batch_momentum(q, v, a)
    judge("h batch", h.h, stacked(states, "h"), least=1)
    m.kinematics(q[1], v[1], a[1])
    judge("h_dot batch", h.h_dot[1], m.momentum().h_dot.astype(float), least=10)


def check_points(judge, m, s):
    m.kinematics(s.q, s.v, s.vdot)
    for point in s.points:
        where = point.body, point.p
        judge("point_J", m.jacobian(*where), point.point_J)
        judge("point_J_link", m.jacobian(*where, "link"), point.point_J_link)
        judge("point_pos", m.point_position(*where), point.point_pos, least=1)
        judge("point_vel", m.point_velocity(*where), point.point_vel, least=1)
        judge("point_acc", m.point_acceleration(*where), point.point_acc_classical, least=1)
        f = s.f_ext[point.body]
        row = m.point_wrench(*where, "world", f)
        judge("point_wrench", row @ m.body_velocity(point.body), point.point_vel @ f, least=100)
    m.kinematics(s.q, s.v)
    for point in s.points:
        judge("point_bias", m.point_acceleration(point.body, point.p), point.point_bias, least=1)


def check_control(judge, m, s, armature):
    judge("J_com", m.com_jacobian(s.q), s.J_com)
    hybrid = m.hybrid(s.q, s.v, s.hybrid_given, s.vdot, s.tau)
    judge("hybrid a", hybrid.a, s.hybrid_a, s.cond_M)
    judge("hybrid tau", hybrid.tau, s.hybrid_tau, s.cond_M)
    free = m.id_free_base(s.q, s.v, s.vdot, s.tau_rnea_ext, s.f_ext)
    judge("free base a", free.a, s.vdot, s.cond_M)
    judge("free base tau", free.tau, s.tau_rnea_ext, s.cond_M)
    momentum = m.generalized_momentum(s.q, s.v)
    judge("p", momentum.p, s.M @ s.v)
    judge("C'v", momentum.ctv, s.C.T @ s.v, least=1)
    assert m.generalized_momentum(s.q, s.v, ctv=False).ctv is None
    pi = np.concatenate([m.body_parameters(body) for body in range(m.nb)]).astype(float)
    energies = m.energy_regressors(s.q, s.v)
    judge("kinetic", energies.Y_kinetic @ pi + armature @ s.v**2 / 2, s.kinetic, least=10)
    judge("potential", energies.Y_potential @ pi, s.potential, least=100)
    assert m.energy_regressors(s.q).Y_kinetic is None
    judge("q_plus", m.integrate(s.q, s.integrate_d, 1), s.integrate_q_plus)
    judge("difference", m.difference(s.q, s.difference_q1), s.difference_d, least=1)
    step = m.integrate_derivatives(s.integrate_d, 1)
    judge("d_dq", step.dnext_dq, s.integrate_d_dq)
    judge("d_dd", step.dnext_dv, s.integrate_d_dd)
    half = m.integrate(s.q, s.difference_d / 2, 1)
    judge("half way", m.interpolate(s.q, s.difference_q1, 0.5), half)
    judge("way", m.interpolate(s.q, s.difference_q1, 1), m.integrate(s.difference_q1, 0 * s.v, 1))
    judge("distance", m.distance(s.q, s.difference_q1), np.linalg.norm(s.difference_d.astype(float)), least=1)
    weight = np.arange(m.nv) % 3
    weighted = np.sqrt(weight @ s.difference_d.astype(float) ** 2)
    judge("weighted distance", m.distance(s.q, s.difference_q1, weight), weighted, least=1)
    difference = m.difference_derivatives(s.q, s.difference_q1)
    judge("d_dq0", difference.dd_dq0, s.difference_d_dq0)
    judge("d_dq1", difference.dd_dq1, s.difference_d_dq1)
    m.set_gravity(s.gravity)
    at_rest = m.id_derivatives(s.q, 0 * s.v, 0 * s.v)
    judge("dg_dq", m.gravity_torque_derivatives(s.q), at_rest.dtau_dq.astype(float))


def check_set(judge, m, s, reference_set):
    """The results of one set of constraints."""
    r = reference_set
    cond = s.cond_M + r.cond
    rows = [rbd.Constraint(None, k.body1, k.body2, k.R1, k.p1, k.R2, k.p2, k.axes) for k in r.constraints]
    plain = m.constraint_set(rows)
    held = m.constraint_set([replace(row, kp=r.kp, kd=r.kd) for row in rows])
    assert plain.rows == r.rows and plain.first(0) == 0
    jacobian = plain.constraint_jacobian(s.q, s.v)
    judge("J_c", jacobian.J, r.J_c)
    judge("gamma", jacobian.gamma, r.gamma, least=1)
    judge("e", jacobian.e, r.e, least=1)
    for name, c, f_ext, expected in (("c", plain, None, (r.qdd_c, vars(r)["lambda"])),
                                     ("b", held, None, (r.qdd_b, r.lambda_b)),
                                     ("ext", plain, s.f_ext, (r.qdd_c_ext, r.lambda_ext))):
        for found, value in zip(c.constrained_fd(s.q, s.v, s.tau, f_ext), expected):
            judge(f"constrained {name}", found, value, cond)
        repeated = [np.repeat(x[None], 5, 0) for x in (s.q, s.v, s.tau)]
        f_batch = None if f_ext is None else np.repeat(f_ext[None], 5, 0)
        for found, value in zip(c.constrained_fd(*repeated, f_batch), expected):
            judge(f"constrained {name}", found, np.repeat(value[None], 5, 0), cond)
    if judge.epsilon < 1e-10:
        assert plain.rank() == r.rank
    for restitution, expected in ((0, (r.v_plus, r.impulse)), (r.restitution, (r.v_plus_r, r.impulse_r))):
        for found, value in zip(plain.impact(s.q, r.v_minus, restitution), expected):
            judge("impact", found, value, cond)
    if r.dqdd_c_dq is not None:
        check_constrained_derivatives(judge, plain, held, s, r, cond)


def check_constrained_derivatives(judge, plain, held, s, r, cond):
    d = plain.constrained_fd_derivatives(s.q, s.v, s.tau)
    for name in "dq", "dv", "dtau":
        judge(f"da_{name}", getattr(d, f"da_{name}"), getattr(r, f"dqdd_c_{name}"), cond)
        judge(f"dlambda_{name}", getattr(d, f"dlambda_{name}"), getattr(r, f"dlambda_{name}"), cond)
    b = held.constrained_fd_derivatives(s.q, s.v, s.tau, dtau=False)
    assert b.da_dtau is None and b.dlambda_dtau is None
    for name in "dq", "dv":
        judge(f"da_{name}, b", getattr(b, f"da_{name}"), getattr(r, f"dqdd_b_{name}"), cond)
        judge(f"dlambda_{name}, b", getattr(b, f"dlambda_{name}"), getattr(r, f"dlambda_b_{name}"), cond)


def test_control(library):
    judge = Judge(library)
    for control in reference.controls():
        m = build(control.model.bodies, library)
        armature = np.concatenate([m.describe(body).armature[:m.joint(body).nv] for body in range(m.nb)])
        for number, s in enumerate(control.states):
            judge.where = f"{control.model.name}, state {number}"
            m.set_gravity(s.gravity)
            check_rows(judge, m, s, DYNAMICS + CONTROL, s.cond_M)
            check_points(judge, m, s)
            check_control(judge, m, s, armature)
            for reference_set in s.constraint_sets:
                judge.where = f"{control.model.name}, state {number}, {reference_set.name}"
                check_set(judge, m, s, reference_set)
        judge.where = f"{control.model.name}, batch"
        check_batches(judge, m, control.states, DYNAMICS + CONTROL)
    assert judge.compared == judge.asked, judge.asked - judge.compared


def test_inverse_dynamics_with_contacts(hyq):
    """tau of the motors and the feet's forces carry the robot; the base's share is 0."""
    feet = [f"{leg}_lowerleg" for leg in ("lf", "rf", "lh", "rh")]
    c = hyq.constraint_set([hyq.point_contact(foot, (0.33, 0, 0)) for foot in feet])
    q = hyq.neutral()
    q[7:] = np.repeat([-0.2, 0.7, -1.4], 4) * np.tile([1, 1, 1, 1], 3)
    v = a = np.zeros(hyq.nv)
    result = c.constrained_id(q, v, a)
    np.testing.assert_allclose(result.tau[:6], 0, atol=1e-9)
    np.testing.assert_allclose(np.sum(result.lambda_.reshape(4, 3), 0), [0, 0, 9.81 * hyq.mass()], atol=1e-8)
    J = c.constraint_jacobian(q).J
    np.testing.assert_allclose(result.tau + J.T @ result.lambda_, hyq.bias(q, v), atol=1e-9)
    heavy = c.constrained_id(q, v, a, weight=np.repeat([1, 1, 1, 100], 3))
    assert abs(heavy.lambda_[-1]) < abs(result.lambda_[-1])
    held = c.constrained_id(q, v, a, actuated=np.ones(hyq.nv, bool))
    np.testing.assert_allclose(held.lambda_, 0, atol=1e-9)


def test_assemble(double):
    """Two rods and a point of the second held: the loop closes, at the nearest place."""
    rod = dict(type="revolute", axis=(0, 1, 0), mass=1, com=(0.5, 0, 0), inertia=(0.01, 0, 0, 0.08, 0, 0.08))
    m = rbd.Model([rbd.Body("upper", "a", -1, **rod),
                   rbd.Body("lower", "b", "upper", position=(1, 0, 0), **rod)], library=double)
    tip = rbd.Constraint("tip", "lower", position1=(1, 0, 0), position2=(1, 0, -1), axes=(0, 0, 0, 1, 0, 1))
    c = m.constraint_set([tip])
    near = c.assemble([0.1, 1.4], [0.3, 0.2])
    m.kinematics(near.q_near, near.v_near)
    np.testing.assert_allclose(m.point_position("lower", (1, 0, 0)), [1, 0, -1], atol=1e-12)
    np.testing.assert_allclose(m.point_velocity("lower", (1, 0, 0))[3:], 0, atol=1e-12)
    assert c.assemble([0.1, 1.4]).v_near is None
    with pytest.raises(rbd.RbdError, match="row 0, of constraint 0 'far'") as caught:
        m.constraint_set([replace(tip, name="far", position2=(9, 0, 0))]).assemble([0.1, 1.4])
    assert caught.value.status == rbd.Status.ERR_INFEASIBLE
