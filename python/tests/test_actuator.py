# SPDX-License-Identifier: MIT
"""Motors, gears and transmissions: rbd_actuator.h."""
import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import rbd
from conftest import FLAGS


def leg(library, **joint):
    return rbd.Model([rbd.Body("thigh", "hip", type="revolute", axis=(0, 1, 0), mass=4, com=(0, 0, -0.2), inertia=(0.05, 0, 0, 0.05, 0, 0.01)),
                      rbd.Body("shank", "knee", "thigh", "revolute", axis=(0, 1, 0), position=(0, 0, -0.4), mass=1.5,
                               com=(0, 0, -0.2), inertia=(0.02, 0, 0, 0.02, 0, 0.002), **joint)], library=library)


def test_efficiency_and_limits(library):
    model = leg(library)
    close = 1e-4 if library.real == "float" else 1e-12
    motors = [rbd.Motor(joint="hip", gear=50, constant=0.03, resistance=0.6, voltage=24, current=15),
              rbd.Motor(joint="knee", gear=1, constant=1, friction=rbd.Friction(load_motor=0.2))]
    arm = model.actuators(motors)
    up = arm.inverse([0, 0], [4, 1], [0, 0], [1000, 8])
    assert np.allclose(up.torque, [22.5, 10], atol=close) and list(up.saturated) == [1, 0]
    assert np.allclose(up.current, [15, 10], atol=close) and up.torque.dtype == library.dtype
    assert abs(arm.inverse([0, 0], [0, -1], [0, 0], [0, 8]).torque[1] - 8 / 1.2) < close
    assert abs(arm.friction(1, 1.0, 10, -8) - 2) < close


def test_copies_are_of_what_was_built(library):
    """Not of motors that the caller has changed since, and with shafts of their own."""
    model = leg(library)
    knee = rbd.Motor("K", "knee", gear=50, constant=0.03, friction=rbd.Friction(coulomb=2))
    both = rbd.Transmission(0, ["hip", "knee"], matrix=np.eye(2))
    arm = model.actuators([knee])
    pair = model.actuators([rbd.Motor(gear=2, constant=1), rbd.Motor(gear=3, constant=1)], [both])
    knee.gear, knee.friction.coulomb, both.matrix[0, 1] = 7, 5, 9
    assert b"rbd._" not in pickle.dumps([arm, pair], 0)  # the files of the package may change
    arm.reset([0, 0.3])
    arm.step([0, 0.3], [0, 1], 1e-3, torque=1)
    for again in copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x)):
        other, of_two = again(arm), again(pair)
        drives = [x.inverse([0, 0.3], [0, 1], [0, 0], [0, 10]) for x in (arm, other)]
        assert drives[0].current == drives[1].current == pytest.approx(12 / 50 / 0.03, rel=1e-5)
        assert arm.get().angle[0] > 0.29 and other.get().angle[0] == 0
        assert (of_two.map([0.1, 0.2])[0] == np.asarray([0.1, 0.2], library.dtype)).all()
    held, same = copy.deepcopy((arm, model))
    assert held.model is same and "1 motors" in repr(held)


def test_arrays_and_contacts_of_another_robot_are_refused(double, iiwa):
    """No call takes the model: its degrees of freedom are named."""
    model = leg(double)
    arm = model.actuators([rbd.Motor(joint="knee", gear=50, constant=0.03)])
    text = "{}: {} has 7 numbers, but these actuators are of a robot with 2: its degrees of freedom are 'hip', 'knee'"
    two, seven = np.zeros(2), np.zeros(7)
    for call, name, use in (("map", "q", lambda: arm.map(seven)), ("map", "v", lambda: arm.map(two, seven)),
                            ("inverse", "tau", lambda: arm.inverse(two, two, two, seven)), ("reset", "q", lambda: arm.reset(seven)),
                            ("step", "v", lambda: arm.step(two, seven, 1e-3)),
                            ("step", "tau", lambda: arm.step(two, two, 1e-3, tau=seven))):
        with pytest.raises(ValueError, match=text.format(call, name)):
            use()
    for shape in (), (1, 2), (7, 1):
        with pytest.raises(ValueError, match=r"map: q .*(2,)"):
            arm.map(np.zeros(shape))
    other = rbd.Model([replace(body, joint=joint) for body, joint in zip(model.bodies, ("hip", "ankle"))], library=double)
    with pytest.raises(ValueError, match="step: contacts are of another robot, with the degrees of freedom 'hip', 'ankle'; those "
                                         "of these actuators are 'hip', 'knee'"):
        arm.step(two, two, 1e-3, contacts=other.contacts([]))
    narrow = leg(rbd.Library("float", flags=FLAGS, lanes=4))
    with pytest.raises(ValueError, match="step: contacts are of a model in float, these actuators of one in double"):
        arm.step(two, two, 1e-3, contacts=narrow.contacts([]))
    arm.step(two, two, 1e-3, contacts=model.copy().contacts([]))  # a copy is the same robot
    with pytest.raises(ValueError, match="of a robot with 7: its degrees of freedom are 'lbr.*_1', .*_7'$"):
        iiwa.actuators([rbd.Motor(joint=iiwa.joint_names[0], gear=1, constant=1)]).map(two)


def test_a_spring_keeps_its_load(double):
    """A knee on a spring, whose rotor is held by friction, hangs at gravity's torque over the stiffness."""
    model = leg(double)
    arm = model.actuators([rbd.Motor(joint="hip", gear=50, constant=1, friction=rbd.Friction(coulomb=100)),
                           rbd.Motor(joint="knee", gear=50, constant=1, inertia=1e-4, stiffness=50, damping=1,
                                     friction=rbd.Friction(coulomb=100))])
    q, v = np.array([0.5, 0.2]), np.zeros(2)
    arm.reset(q, air=20)
    for _ in range(3000):
        q, v = arm.step(q, v, 1e-3)
    state = arm.get()
    assert abs(q[0] - 0.5) < 1e-6 and state.angle[1] == 0.2 and state.winding[1] == 20
    assert abs(-50 * (q[1] - 0.2) - model.gravity_torque(q)[1]) < 1e-6


def test_drives_follow_their_commands(library):
    model = leg(library)
    arm = model.actuators([rbd.Motor(joint=joint, gear=20, constant=0.1) for joint in ("hip", "knee")])
    feet = model.contacts([], options=rbd.ContactOptions(first_order=True))
    q, v = np.zeros(2), np.zeros(2)
    for _ in range(1000):
        q, v = arm.step(q, v, 1e-3, position=[0.3, -0.5], kp=[3000, 3000], kd=60, torque=model.gravity_torque([0.3, -0.5]),
                        contacts=feet)
    assert np.allclose(q, [0.3, -0.5], atol=1e-3)


def test_drives_by_voltage(double):
    """12 V through 0.6 ohm and 1.5 V s: 8 rad/s without a load, which the inverse asks 12 V for; 24 V are the supply's."""
    wheel = rbd.Model([rbd.Body("wheel", joint="axle", type=rbd.JointType.CONTINUOUS, axis=(0, 0, 1), mass=1,
                                inertia=(0.1, 0, 0, 0.1, 0, 0.1))], library=double)
    motor = wheel.actuators([rbd.Motor(joint="axle", gear=50, constant=0.03, resistance=0.6, voltage=24, by_voltage=1)])
    q, v = wheel.neutral(), np.zeros(1)
    for _ in range(300):
        q, v = motor.step(q, v, 1e-2, voltage=12)
    assert abs(v[0] - 8) < 1e-10
    assert abs(motor.inverse(q, v, [0], [0]).voltage[0] - 12) < 1e-10
    far = motor.inverse(q, v, [0], [50])
    assert far.saturated[0] == 1 and abs(far.voltage[0] - 24) < 1e-12
    with pytest.raises(ValueError, match="step: motor 0 has a voltage, not a torque"):
        motor.step(q, v, 1e-2, torque=1)
    with pytest.raises(ValueError, match="step: motor 0 has a torque, not a voltage"):
        wheel.actuators([rbd.Motor(joint="axle", gear=50, constant=0.03)]).step(q, v, 1e-2, voltage=1)


def test_transmissions(double):
    model = leg(double)
    motors = [rbd.Motor(gear=2, constant=1), rbd.Motor(gear=3, constant=1)]
    both = rbd.Transmission(0, ("hip", "knee"), matrix=[[1, 0], [1, 1]])
    angle, speed = model.actuators(motors, [both]).map([0.1, 0.2], [1, 2])
    assert np.allclose(angle, [0.1, 0.3]) and np.allclose(speed, [1, 3])
    rod = rbd.Rod(place=(0, 0.05, -0.1), axis=(0, 1, 0), zero=(-1, 0, 0), crank=0.03, length=0.285, point=(-0.05, 0.05, 0.01))
    knee = model.actuators([rbd.Motor(joint="hip", gear=1, constant=1), motors[1]], [rbd.Transmission(1, "knee", rod=[rod])])
    high, low = (knee.map([0, x])[0][1] for x in (1e-6, -1e-6))
    assert abs((high - low) / 2e-6 - knee.map([0, 0], [0, 1])[1][1]) < 1e-8
    with pytest.raises(rbd.RbdError, match="transmission 0: a rod does not reach"):
        knee.map([0, -1.5])


def test_rotors(iiwa):
    """A rotor on the world has armature's torque alone; one on a body more."""
    v, a = np.ones(7), np.ones(7)
    q = np.linspace(-1, 1, 7)
    plain = iiwa.rnea(q, v, a)
    assert (iiwa.rotor_torque([rbd.Rotor(-1, 0, (0, 0, 1), 10, 1e-3)], q, v, a) == plain).all()
    assert np.abs(iiwa.rotor_torque([rbd.Rotor("lbr_iiwa_link_2", 2, (0, 1, 1), 10, 1e-3)], q, v, a) - plain).max() > 1e-3
    with pytest.raises(rbd.RbdError, match="rotor_torque"):
        iiwa.rotor_torque([rbd.Rotor(0, 0, (0, 0, 0), 1, 1)], q, v, a)


def test_bad_tables_are_named(double):
    model = leg(double, armature=0.1)
    good = rbd.Motor("M1", "knee", 10, 1)
    for motor, kind, text in (
            (rbd.Motor("M1", "knee", constant=1), rbd.RbdError, "actuators: motor 0 'M1', field 'gear': missing"),
            (rbd.Motor("M1", "ankle", 10, 1), rbd.RbdError, "field 'joint': no such joint"),
            (rbd.Motor("M1", "knee", 10, 1, inertia=1e-4), rbd.RbdError, "field 'inertia': the rotor counts twice"),
            (rbd.Motor("M1", "knee", 10, 1, friction=rbd.Friction(coulomb=-1)), rbd.RbdError, "field 'coulomb'"),
            (rbd.Motor("M1", "knee", 10, 1, teeth=12), rbd.RbdError, "field 'teeth': does nothing without 'cogging'"),
            (rbd.Motor("M1", "knee", 10, 1, by_voltage=1), rbd.RbdError, "field 'resistance': missing"),
            (rbd.Motor("M1", "knee", 10, 1, friction=1), TypeError, "field 'friction': must be a Friction"),
            (rbd.Motor("M1", "knee", np.nan, 1), ValueError, "gear is nan"),
            (rbd.Motor("M1", "knee", 10, 1, current=10**400), ValueError, "actuators: motor 0 'M1': current is too large for a float"),
            ("M1", TypeError, "motor 0 must be a Motor, not str")):
        with pytest.raises(kind, match=text):
            model.actuators([motor])
    with pytest.raises(ValueError, match="either a matrix or rods"):
        model.actuators([good], [rbd.Transmission(0, ("knee",))])
    arm = model.actuators([good])
    for value, kind, text in ((-1, ValueError, r"step: kp\[0\] is negative"), ([1, 2], ValueError, "step: kp must have the shape"),
                              (None, TypeError, "step: kp must be"), (np.nan, ValueError, "step: kp is nan")):
        with pytest.raises(kind, match=text):
            arm.step([0, 0], [0, 0], 1e-3, kp=value)
    with pytest.raises(TypeError, match="transmission 0, field 'joint' must be text, not 3"):
        model.actuators([good], [rbd.Transmission(0, (3,), [[1]])])
    rod = rbd.Rod()
    for motors, transmissions, text in (
            (good, [], "motors must be a list of Motor, not Motor"), (5, [], "motors must be a list of Motor, not int"),
            ([good], rbd.Transmission(), "transmissions must be a list of Transmission, not Transmission"),
            ([good], 5, "transmissions must be a list of Transmission, not int"),
            ([good], [rbd.Transmission(joint=5, matrix=[[1]])], "transmission 0: joint must be a list of str, not int"),
            ([good], [rbd.Transmission(joint="knee", rod=5)], "transmission 0: rod must be a list of Rod, not int"),
            ([good], [rbd.Transmission(joint="knee", rod=rod)], "transmission 0: rod must be a list of Rod, not Rod"),
            ([good], [rbd.Transmission(0, "knee", [[1]], name=3)], "transmission 0, field 'name' must be text, not 3")):
        with pytest.raises(TypeError, match=f"^actuators: {text}"):
            model.actuators(motors, transmissions)
    with pytest.raises(TypeError, match="^actuators: model must be a Model, not str"):
        rbd.Actuators("m", [good])
    with pytest.raises(IndexError, match="rotor 0: no such dof: 2; there are 2"):
        model.rotor_torque([rbd.Rotor(0, 2, (0, 0, 1), 1, 1)], [0, 0], [0, 0], [0, 0])
    two = [0, 0]
    for use, kind, text in (
            (lambda: arm.step(None, two, 1e-3), TypeError, "step: q is missing"),
            (lambda: arm.step(two, None, 1e-3), TypeError, "step: v is missing"),
            (lambda: arm.inverse(two, two, two, None), TypeError, "inverse: tau is missing"),
            (lambda: arm.step(two, two, 0), rbd.RbdError, "step: dt is 0: .*out of range"),
            (lambda: arm.step(two, two, "x"), TypeError, "step: dt must be a number"),
            (lambda: arm.step(two, two, 1e-3, kp=2e9), ValueError, r"step: kp\[0\] is above 1e9"),
            (lambda: arm.step(two, two, 1e-3, contacts=5), TypeError, "step: contacts must be a ContactSet, not int"),
            (lambda: arm.step(two, two, 1e-3, f_ext=[1]), ValueError, "step: f_ext must have the shape"),
            (lambda: arm.step(two, two, 1e-3, f_ext=np.zeros((3, 2, 6))), ValueError, "step: f_ext must have the shape"),
            (lambda: arm.reset(two, air=-300), rbd.RbdError, "reset: air is -300: .*out of range")):
        with pytest.raises(kind, match=f"^{text}"):
            use()
    arm.map([0, 0])  # a step that failed is over
    with pytest.raises(ValueError, match="inverse: tau"):
        model.actuators([good]).inverse([0, 0], [0, 0], [0, 0], [0])
