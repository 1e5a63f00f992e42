# SPDX-License-Identifier: MIT
"""Contacts that open and slip: rbd_contact.h."""
import copy
import gc
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import rbd

DT = 1e-3
LEGS = ["lf", "rf", "lh", "rh"]


@pytest.fixture
def block(library):
    """A point mass that may not turn, on three sliders."""
    rows = [rbd.Body(name, parent=k - 1, type="prismatic", axis=np.eye(3)[k]) for k, name in
            enumerate(("x", "y", "block"))]
    rows[2] = replace(rows[2], mass=2, inertia=(1e-3, 0, 0, 1e-3, 0, 1e-3))
    return rbd.Model(rows, library=library)


def feet_of(model, **more):
    return model.contacts([rbd.Contact(leg, f"{leg}_lowerleg", point=(0.33, 0, 0), friction=0.7)
                           for leg in LEGS], **more)


def test_a_block_slides_and_sticks_as_coulomb_says(block):
    """Down a slope of 30 degrees it has the acceleration g (sin - mu cos); with a larger mu it rests."""
    angle, g, steps, close = math.radians(30), 9.81, 100, 2e-4 if block.library.real == "float" else 1e-9
    normal = (math.sin(angle), 0, math.cos(angle))
    for friction, expected in (0.2, g * (math.sin(angle) - 0.2 * math.cos(angle))), (0.7, 0):
        ground = block.contacts([rbd.Contact("ground", "block", friction=friction)])
        ground.plane("ground", normal)
        q, v = block.neutral(), np.zeros(3)
        for _ in range(steps):
            q, v = ground.step(q, v, np.zeros(3), DT)
        assert q.dtype == v.dtype == block.library.dtype
        assert abs(np.hypot(v[0], v[2]) - expected * steps * DT) < close
        found = ground.get(0)
        assert found.state == (rbd.ContactState.SLIPS if expected else rbd.ContactState.STICKS)
        assert abs(found.force @ normal - 2 * g * math.cos(angle)) < 1e4 * close
        assert (ground.forces() == found.force).all() and ground.forces().shape == (1, 3)
        assert 0 <= ground.last().residual <= 1e-5 and ground.last().sweeps > 0


def test_a_height_is_where_it_lands(block):
    ground = block.contacts([rbd.Contact("ground", 2)])
    ground.plane(0, height=-0.05)
    q, v = block.neutral(), np.zeros(3)
    assert ground.get("ground").state == rbd.ContactState.APART
    for _ in range(300):
        q, v = ground.step(q, v, np.zeros(3), DT)
    assert abs(q[2] + 0.05) < 3e-5 and abs(v[2]) < 1e-5
    ground.reset()
    assert ground.get(0).state == rbd.ContactState.APART and not ground.forces().any()
    assert ground.last() == (0, 0, 0)


def test_a_quadruped_stands_and_the_acceleration_is_that_of_the_step(hyq):
    feet, q, v = feet_of(hyq), hyq.neutral(), np.zeros(hyq.nv)
    stance = q[7:] = np.array([0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4])
    hyq.kinematics(q)
    q[2] = -hyq.point_position("lf_lowerleg", (0.33, 0, 0))[2]
    kp, kd = 1500, 40
    damping = np.r_[np.zeros(6), np.full(12, kd + DT * kp)]
    for _ in range(1000):
        tau = np.r_[np.zeros(6), kp * (stance - q[7:])]
        begin, (q, v) = (q, v), feet.step(q, v, tau, DT, None, damping)
    a = pickle.loads(pickle.dumps(feet)).fd(*begin, tau, DT, damping=damping)
    assert abs(feet.forces()[:, 2].sum() - hyq.mass() * 9.81) < 1
    assert all(feet.get(leg).state == rbd.ContactState.STICKS for leg in LEGS)
    assert np.abs(hyq.step(*begin, a, DT).v_next - v).max() < 1e-6  # a new set has no shares to begin with
    wrench = np.zeros((hyq.nb, 6))
    wrench[0, 5] = 2 * hyq.mass() * 9.81
    for _ in range(200):
        q, v = feet.step(q, v, tau, DT, wrench, damping)
    assert v[5] > 1 and not feet.forces().any()
    assert all(feet.get(k).state in (rbd.ContactState.OPENS, rbd.ContactState.APART) for k in range(4))


def test_a_copied_set_has_its_planes(block):
    """And what it was made of, whatever became of the caller's rows and arrays since."""
    normal, row, options = np.array([0.0, 0, 2]), rbd.Contact("ground", "block", friction=0.5), rbd.ContactOptions()
    ground = block.contacts([row], options=options)
    ground.plane("ground", normal, -0.05)
    normal[:], row.radius, options.margin = (1, 0, 0), 1, 1e-6
    q, v, tau = block.neutral(), np.zeros(3), np.zeros(3)
    for which in (ground, copy.copy(ground), copy.deepcopy(ground), pickle.loads(pickle.dumps(ground)),
                  pickle.loads(pickle.dumps(copy.deepcopy(ground)))):
        q[2] = -0.05 + 1e-3  # within the margin of 5 mm
        which.step(q, v, tau, DT)
        assert which.get(0).state != rbd.ContactState.APART and abs(which.get(0).gap - 1e-3) < 1e-7


def sliders(double, friction=0.0):
    """Two masses of 2 kg on rails of their own."""
    return rbd.Model([rbd.Body(joint=name, type="prismatic", axis=axis, mass=2.0, friction=friction,
                               inertia=(0.1, 0, 0, 0.1, 0, 0.1))
                      for name, axis in (("x", (1, 0, 0)), ("y", (0, 1, 0)))], library=double)


def test_bounded_rows_hold_brake_and_bend(double):
    """The same of copies, which have the rows, the friction and the matrix."""
    model = sliders(double, 4.0)
    first = model.contacts([], options=rbd.ContactOptions(rows=2, joint_friction=True))
    first.friction(0, 1.0)
    first.friction(1, 0.0)
    first.row_set(0, [0, 1], [1, -0.5], lower=-3, upper=3)
    first.row_set(1, [1], [1], lower=-1e30, upper=1e30, bias=0.25, compliance=0.5)
    added = np.zeros(model.packed_size())
    added[model.packed_index(1, 1)] = 2
    first.inertia(added)
    added[:] = math.nan  # it was copied
    for which in (first, copy.copy(first), pickle.loads(pickle.dumps(first))):
        q, v = which.step(np.zeros(2), [1.0, 0.0], np.zeros(2), DT)
        # x: friction 1 N and row 0's 3 N brake 2 kg; y: 4 kg, 1.5 N of row 0, and v + 0.25 + 0.5 p = 0
        p = -(0.25 + 1.5 * DT / 4) / (1 / 4 + 0.5)
        assert np.allclose(v, [1 - 2 * DT, (1.5 * DT + p) / 4], rtol=0, atol=1e-9)
        assert which.row_get(0) == rbd.RowResult(rbd.ContactState.SLIPS, -3.0)
        assert which.row_get(1).state == rbd.ContactState.STICKS and abs(which.row_get(1).force - p / DT) < 1e-5
    first.row_set(0)
    first.row_set(1)
    first.friction(0, 0)
    first.inertia(None)
    assert np.allclose(first.step(np.zeros(2), [1.0, 0], [0, 1], DT)[1], [1, DT / 2], rtol=0, atol=1e-15)
    assert first.row_get(0) == rbd.RowResult(rbd.ContactState.APART, 0.0)


def test_bad_bounded_rows_are_refused_by_name(double):
    rows = sliders(double).contacts([], options=rbd.ContactOptions(rows=1))
    with pytest.raises(ValueError, match="row_set: dofs has 4 entries"):
        rows.row_set(0, [0, 1, 0, 1], [1, 1, 1, 1])
    with pytest.raises(IndexError, match="row_set: no such row: 1; the set has 1"):
        rows.row_set(1, [0], [1])
    with pytest.raises(IndexError, match="row_set: no such dof: 2; the model has 2"):
        rows.row_set(0, [2], [1])
    with pytest.raises(ValueError, match="jacobian"):
        rows.row_set(0, [0, 1], [1])
    with pytest.raises(ValueError, match="row_set: upper is inf"):
        rows.row_set(0, [0], [1], upper=math.inf)
    with pytest.raises(ValueError, match="row_set: dofs has one twice: .1, 1."):
        rows.row_set(0, [1, 1], [1, 1])
    with pytest.raises(TypeError, match="row_set: dofs must be a list of whole numbers, not 0"):
        rows.row_set(0, 0, [1])
    for bad, match in (({"lower": 2, "upper": 1}, "row_set: lower is 2.0, above upper, which is 1.0"),
                       ({"compliance": -1}, "row_set: compliance is -1.0, below 0"),
                       ({"lower": 1e30, "upper": 1e31}, "row_set: lower is 1e.30 and upper is 1e.31")):
        with pytest.raises(rbd.RbdError, match=match) as error:
            rows.row_set(0, [0], [1], **bad)
        assert error.value.status == rbd.Status.ERR_RANGE
    with pytest.raises(rbd.RbdError, match="friction: dof 0 has no row of dry friction") as error:
        rows.friction(0, 1.0)
    assert error.value.status == rbd.Status.ERR_INDEX
    with pytest.raises(IndexError, match="row_get: no such row: -1"):
        rows.row_get(-1)
    with pytest.raises(ValueError, match="inertia: added"):
        rows.inertia(np.zeros(1))


def test_options_and_held_constraints_count(double):
    rod = dict(type="revolute", axis=(0, 1, 0), mass=1, com=(0, 0, -0.5), inertia=(0.1, 0, 0, 0.1, 0, 1e-3),
               lower=-0.5, upper=0.5)
    model = rbd.Model([rbd.Body("rod", **rod)], library=double)
    limited = model.contacts([], options=rbd.ContactOptions(joint_limits=True))
    held = model.contacts([], held=[rbd.Constraint(body1="rod", axes=(0, 1, 0, 0, 0, 0))])
    free = model.contacts([])
    q = {which: (np.array([0.4]), np.array([1.0])) for which in (limited, held, free)}
    for _ in range(300):
        q = {which: which.step(*state, [3.0], DT) for which, state in q.items()}
    assert 0.4 < q[limited][0][0] <= 0.501 and q[free][0][0] > 0.6
    assert abs(q[held][0][0]) < 1e-4 and abs(q[held][1][0]) < 1e-9


def test_derivatives_are_those_of_the_step(block):
    """A point mass that slides down a compliant slope, against differences."""
    double = block.library.real == "double"
    ground = block.contacts([rbd.Contact("ground", "block", friction=0.2, stiffness=1e4, damping=100)],
                            options=rbd.ContactOptions(derivatives=True, slip=1e-4, tolerance=1e-12 * double))
    q, v, tau = np.array([0.1, 0.2, -0.001]), np.array([1, 0.5, 0.1]), np.array([1, 2, 3])
    found = ground.step_derivatives(q, v, tau, DT)
    ground.reset()
    assert (found.v_next == ground.step(q, v, tau, DT).v_next).all()
    for name, x in ("dq", q), ("dv", v), ("dtau", tau):
        for k in range(3 * double):
            t = (1e-4 if name == "dtau" else 1e-6) * np.eye(3)[k]
            ends = [ground.step(*[x + sign * t if y is x else y for y in (q, v, tau)], DT) for sign in (1, -1)]
            for end in "q", "v":
                column = getattr(found, f"d{end}_next_{name}")[:, k]
                difference = (getattr(ends[0], f"{end}_next") - getattr(ends[1], f"{end}_next")) / (2 * t[k])
                assert np.abs(column - difference).max() < 1e-7
    some = ground.step_derivatives(q, v, tau, DT, dq=False, dtau=False)
    assert some.dq_next_dq is None and np.abs(some.dv_next_dv - found.dv_next_dv).max() < (1e-9 if double else 1e-3)
    with pytest.raises(rbd.RbdError):
        block.contacts([rbd.Contact("ground", "block")]).step_derivatives(q, v, tau, DT)


def test_many_states_are_stepped_one_by_one(block):
    ground = block.contacts([rbd.Contact("ground", "block", friction=0.5)])
    q, v = np.array([[0, 0, 0.0], [0, 0, 1]]), np.array([1, 0, 0.0])
    many = ground.step(q, v, np.zeros(3), DT)
    for k in range(2):
        ground.reset()
        one = ground.step(q[k], v, np.zeros(3), DT)
        assert np.allclose(many.q_next[k], one.q_next) and np.allclose(many.v_next[k], one.v_next, atol=1e-5)


def test_a_set_keeps_what_it_needs(double):
    """The Model and the lists may go; two sets of a Model do not disturb each other."""
    def make(friction):
        model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"), library=double)
        return model.contacts([rbd.Contact(f"{leg} foot", f"{leg}_lowerleg", friction=friction) for leg in LEGS])
    sets = [make(friction) for friction in (0.5, 0.6)] * 3
    gc.collect()
    model = sets[0].model
    others = [feet_of(model) for _ in range(5)]
    q = model.neutral()
    expected = sets[0].step(q, np.zeros(model.nv), np.zeros(model.nv), DT).v_next
    for feet in others:
        feet.step(q, np.ones(model.nv), np.zeros(model.nv), DT)
    sets[0].reset()
    assert (sets[0].step(q, np.zeros(model.nv), np.zeros(model.nv), DT).v_next == expected).all()
    again = pickle.loads(pickle.dumps(sets[1]))
    assert again.list == sets[1].list and repr(again) == "<rbd.ContactSet, 4 contacts>"


GOOD = rbd.Contact("toe", "lf_lowerleg", friction=0.7)
WRONG = [
    (dict(friction=-1), rbd.RbdError, "contacts: contact 1 'toe', field 'friction'"),
    (dict(restitution=1.5), rbd.RbdError, "contact 1 'toe', field 'restitution'"),
    (dict(normal=(0, math.nan, 0)), rbd.RbdError, "contact 1 'toe', field 'normal'"),
    (dict(stiffness=math.inf), rbd.RbdError, "contact 1 'toe', field 'stiffness'"),
    (dict(height=math.inf), rbd.RbdError, "contact 1 'toe', field 'height'"),
    (dict(body2="lf_lowerleg"), rbd.RbdError, "contact 1 'toe'"),
    (dict(body1="lf_lowerlge"), KeyError, "contact 1 'toe', field 'body1'.*did you mean 'lf_lowerleg'"),
    (dict(body1=99), rbd.RbdError, "field 'body1': no such body: 99"),
    (dict(damping=10.0), rbd.RbdError, "contact 1 'toe', field 'damping': a contact without stiffness is rigid"),
    (dict(point=(0, 0)), ValueError, "contact 1 'toe', field 'point'.*2 numbers instead of 3"),
    (dict(radius="big"), TypeError, "contact 1 'toe', field 'radius'"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_wrong_contacts_are_refused_by_name_and_field(hyq, number):
    change, error, text = WRONG[number]
    with pytest.raises(error, match=text):
        hyq.contacts([GOOD, replace(GOOD, **change)])


def test_wrong_sets_and_arguments_are_refused_by_name(hyq):
    q, v, options = hyq.neutral(), np.zeros(hyq.nv), rbd.ContactOptions
    with pytest.raises(TypeError, match="rows must be a list of Contact, not Contact"):
        hyq.contacts(GOOD)
    with pytest.raises(TypeError, match="contact 0 must be a Contact, not Constraint"):
        hyq.contacts([rbd.Constraint()])
    with pytest.raises(rbd.RbdError, match="held constraint 0 'pin', field 'axes'"):
        hyq.contacts([GOOD], held=[rbd.Constraint("pin", 0)])
    with pytest.raises(rbd.RbdError, match="field 'slop'"):
        hyq.contacts([GOOD], options=options(slop=-1))
    with pytest.raises(rbd.RbdError, match="field 'momentum'.*choose one"):
        hyq.contacts([GOOD], options=options(momentum=True, first_order=True))
    with pytest.raises(TypeError, match="field 'iterations'.*whole number"):
        hyq.contacts([GOOD], options=options(iterations=1.5))
    with pytest.raises(TypeError, match="must be ContactOptions"):
        hyq.contacts([GOOD], options={"slop": 1})
    feet = hyq.contacts([GOOD])
    for dt in 0, -1e-3:
        with pytest.raises(rbd.RbdError, match="step: dt") as error:
            feet.step(q, v, v, dt)
        assert error.value.status == rbd.Status.ERR_RANGE
    with pytest.raises(ValueError, match=r"step: v\[3\] is nan"):
        feet.step(q, [0, 0, 0, math.nan] + [0] * 14, v, DT)
    with pytest.raises(ValueError, match="fd: damping must have the shape"):
        feet.fd(q, v, v, DT, damping=[1.0])
    with pytest.raises(KeyError, match="get: no contact is called 'tow'; did you mean 'toe'"):
        feet.get("tow")
    for number in -1, 1:
        with pytest.raises(IndexError, match="the set has 1"):
            feet.plane(number, (0, 0, 1))
    with pytest.raises(ValueError, match=r"plane: normal\[0\] is nan"):
        feet.plane("toe", (math.nan, 0, 1))
    with pytest.raises(ValueError, match="plane: height is inf"):
        feet.plane("toe", (0, 0, 1), math.inf)


def test_the_solver_alone(library):
    """A contact of 1 kg that comes down and slides: p = (-mu, 0, 1) 2; and a bounded row beside it."""
    tiny = 1e-4 if library.real == "float" else 1e-9
    p, state, solution = library.contact_solve(np.eye(4), [3, 0, -2, 5], [0.25], [-1], [1e30])
    assert np.abs(p - [-0.5, 0, 2, -1]).max() < tiny and state == [rbd.ContactState.SLIPS]
    assert solution.residual < tiny and p.dtype == library.dtype
    p, state, _ = library.contact_solve(np.eye(3), [0.3, 0, -2], [0.25], start=p[:3])
    assert np.abs(p - [-0.3, 0, 2]).max() < tiny and state == [rbd.ContactState.STICKS]
    p, state, _ = library.contact_solve(np.eye(3), [0.3, 0, 2], [0.25])
    assert not p.any() and state == [rbd.ContactState.OPENS]
    with pytest.raises(rbd.RbdError, match="contact_solve"):
        library.contact_solve(np.eye(3), [0, 0, 0], [-1])
    with pytest.raises(ValueError, match="delta must have the shape"):
        library.contact_solve(np.eye(3), np.zeros(4), [1], [0], [1])
