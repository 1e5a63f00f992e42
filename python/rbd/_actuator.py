# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Motors, drives, gears and transmissions: rbd_actuator.h."""
from __future__ import annotations

import copy
import ctypes
import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Iterable, NamedTuple, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import (_array, _Declared, _entries, _flag, _instance, _int, _list, _model, _ndim, _number, _numbered,
                         _numbers, _text, _utf8, _whole)
from ._contacts import ContactSet
from ._headers import Array, Matrix, Numbers, RbdError, Status, TransmissionKind, structure

if TYPE_CHECKING:
    from ._library import Library
    from ._model import Model


@dataclass
class Friction(_Declared):
    """Friction of a gear at its shaft: rbd_gear_friction of rbd_actuator.h, which has the formula. Zero will do for
    every field."""
    coulomb: float = 0.0        #: N m: without load, at any speed
    viscous: float = 0.0        #: N m s: times the speed, beside the level
    load_motor: float = 0.0     #: share of the motor's torque: 1 - efficiency; below 1
    load_joint: float = 0.0     #: share of the joint's torque; 1: the gear locks itself
    rest: float = 0.0           #: N m more at rest
    rest_motor: float = 0.0     #: the same at rest; with load_motor below 1
    rest_joint: float = 0.0     #: share of the joint's torque at rest
    square_motor: float = 0.0   #: 1/(N m): at rest, of the square of the motor's torque
    square_joint: float = 0.0   #: 1/(N m): at rest, of the square of the joint's torque
    speed: float = 0.0          #: rad/s, at which the part of rest has fallen to 1/e
    power: float = 0.0          #: 0.1 to 10: how it fades
    bristle: float = 0.0        #: N m/rad: stiffness before it slips; 0: rigid
    still: float = 0.0          #: rad/s: the inverse compensates slower motion in proportion; 0: in full


@dataclass
class Motor(_Declared):
    """A motor with drive, gear and, perhaps, a spring behind the gear: rbd_motor of rbd_actuator.h. gear, constant and,
    without a Transmission, joint must be given."""
    name: str | None = None         #: for messages
    joint: str | None = None        #: name of the joint that it moves; None if a transmission moves it
    gear: float = 0.0               #: turns of the rotor for a turn of the shaft; signed, not 0
    constant: float = 0.0           #: N m/A at the rotor; 1 for a drive that takes torques
    inertia: float = 0.0            #: kg m^2, of the rotor; 0 if the model has it as armature
    resistance: float = 0.0         #: ohm
    current: float = 0.0            #: A: limit; 0: none
    voltage: float = 0.0            #: V: limit; 0: none
    copper: float = 0.0             #: 1/K: growth of the resistance above 25 degrees; copper 0.0039
    heat_winding: float = 0.0       #: J/K; 0: no heat
    heat_case: float = 0.0          #: J/K; 0: the case stays as cold as the air
    flow_winding: float = 0.0       #: K/W, from the winding to the case
    flow_case: float = 0.0          #: K/W, from the case to the air
    hot: float = 0.0                #: degrees: from here on the limit of current falls
    hottest: float = 0.0            #: degrees: here it is 0
    cogging: float = 0.0            #: N m at the rotor
    teeth: float = 0.0              #: periods of cogging in a turn of the rotor
    phase: float = 0.0              #: rad
    step: float = 0.0               #: rad at the shaft: resolution of the encoder
    offset: float = 0.0             #: rad at the shaft: its error
    stiffness: float = 0.0          #: N m/rad, of a spring from the gear to the joint; 0: rigid
    damping: float = 0.0            #: N m s/rad, of this spring
    backlash: float = 0.0           #: rad: play of the spring
    delay: int = 0                  #: steps that a command takes
    by_voltage: bool = False        #: True: the drive sets volts, as of a hobby servo, and needs a resistance; False: the current
    sampled: bool = False           #: True: the drive is as slow as the step; False: much faster
    friction: Friction | None = None  #: None: none


@dataclass
class Rod(_Declared):
    """A crank on the body before the first joint, and a rod to a point of the last joint's body: rbd_rod."""
    place: Numbers = (0, 0, 0)      #: of the crank's axis, m, axes of the body before the first joint
    axis: Numbers = (0, 0, 0)       #: of the crank, of unit length
    zero: Numbers = (0, 0, 0)       #: direction of the crank at angle 0, of unit length, across the axis
    crank: float = 0.0              #: m
    length: float = 0.0             #: m
    point: Numbers = (0, 0, 0)      #: m, of the last joint's body, link axes
    elbow: int = 1                  #: 1 or -1: which of the two angles that the rod allows


@dataclass
class Transmission(_Declared):
    """As many motors as joints that move together: rbd_transmission of rbd_actuator.h. By a matrix, shaft speeds =
    matrix @ joint speeds, or by a rod for each of one or two joints."""
    motor: int = 0                  #: the first of its motors, which stand together in the table
    joint: Sequence[str] = ()       #: names of the joints; by rods from the base outwards
    matrix: Matrix | Array | None = None  #: n x n
    rod: Sequence[Rod] = ()         #: n
    name: str | None = None         #: for messages


@dataclass
class Rotor(_Declared):
    """A rotor on a body, round about its axis: rbd_rotor of rbd_actuator.h."""
    body: int | str = -1            #: that it is mounted on, index or name; -1: the world
    dof: int = 0                    #: that turns it, index into v
    axis: Numbers = (0, 0, 0)       #: body's axes, of any length
    gear: float = 0.0               #: turns of the rotor relative to the body for a unit of v
    inertia: float = 0.0            #: kg m^2, about the axis


class Drives(NamedTuple):
    """What the motors shall do, n each: the result of Actuators.inverse."""
    torque: Array           #: N m at the shaft, within the limits
    current: Array          #: A
    voltage: Array          #: V
    angle: Array            #: rad, of the shaft on the motor's side of a spring
    saturated: Array        #: 1 or -1 where a limit cut the torque; else 0
    by_torque: Array        #: slopes of the uncut torque by the shaft's torque,
    by_speed: Array         #: its viscous speed
    by_acceleration: Array  #: and its acceleration


class ActuatorStates(NamedTuple):
    """The shafts after the last step, n each: the result of Actuators.get."""
    angle: Array        #: rad, of the rotor, divided by gear
    speed: Array        #: rad/s
    motor: Array        #: N m at the shaft: torque of the motor
    joint: Array        #: N m: torque on the joint's side
    friction: Array     #: N m: level of dry friction in the step
    current: Array      #: A
    winding: Array      #: degrees
    housing: Array      #: degrees
    saturated: Array    #: 1 or -1 where a limit cut the torque; else 0
    repeats: Array      #: of the step; 50: it did not settle


def _fill(given, row, where):
    """Writes the fields of a dataclass into a C struct of the same names."""
    for item in fields(given):
        name, value = item.name, getattr(given, item.name)
        kind = dict(row._fields_)[name]
        if kind is ctypes.c_char_p:
            setattr(row, name, _text(where, name, value))
        elif kind is ctypes.c_int:
            setattr(row, name, _flag(where, name, value) if item.type == "bool" else _int(_whole(where, name, value)))
        elif isinstance(value, Friction):
            _fill(value, getattr(row, name), where)
        elif issubclass(kind, ctypes.Array):
            getattr(row, name)[:] = _numbers(where, name, value, (kind._length_,))
        elif name == "friction":
            if value is not None:
                raise TypeError(f"{where}, field '{name}': must be a Friction, not {type(value).__name__}")
        else:
            setattr(row, name, _number(where, name, value))


def _listed(names, most=8):
    """Names in quotes; of many the first ones."""
    return ", ".join(f"'{name}'" for name in names[:most]) + ", ..." * (len(names) > most)


def _transmission(given, row, where):
    """Writes a Transmission into a C struct."""
    rods = [] if given.rod is None else _list(where, "rod", given.rod, Rod)
    joints = [] if given.joint is None else [given.joint] if isinstance(given.joint, str) else _entries(
        where, "joint", given.joint, str)
    if not joints:
        raise ValueError(f"{where}, field 'joint': missing")
    if (given.matrix is None) == (not rods):
        raise ValueError(f"{where}: must have either a matrix or rods")
    if len(joints) > 3 or rods and len(rods) != len(joints) or len(rods) > 2:
        raise ValueError(f"{where}: has {len(joints)} joints and {len(rods)} rods; up to 3 joints by a matrix, up to 2 by "
                         "a rod each")
    row.name = _text(where, "name", given.name)
    row.kind = TransmissionKind.RODS if rods else TransmissionKind.MATRIX
    row.n, row.motor = len(joints), _int(_whole(where, "motor", given.motor))
    try:
        row.joint[:len(joints)] = [_utf8(joint) for joint in joints]
    except (TypeError, ValueError) as error:
        raise type(error)(f"{where}, field 'joint' {error}") from None
    if not rods:
        row.matrix[:len(joints)**2] = _numbers(where, "matrix", given.matrix, (len(joints),) * 2).reshape(-1)
    for number, rod in enumerate(rods):
        _fill(rod, row.rod[number], f"{where}, rod {number}")


class Actuators(_Declared):
    """The motors of a Model, rbd_actuators; made by Model.actuators(motors):

        arm = model.actuators([rbd.Motor(joint="elbow", gear=50, constant=0.06), ...])
        drives = arm.inverse(q, v, a, model.rnea(q, v, a))  # of a plan: drives.current
        q, v = arm.step(q, v, dt=1e-3, torque=drives.torque) # of a simulation

    docs/actuators.md leads from a data sheet to a table. The states of the shafts are those after the last step;
    `reset` begins anew. Motors that you change after they were given change nothing. A copy, or what was pickled, has the
    tables alone: its shafts are at rest at angle 0, call `reset`."""
    model: Model
    motors: Sequence[Motor]
    transmissions: Sequence[Transmission]
    n: int                      #: number of motors
    library: Library

    def __init__(self, model: Model, motors: Iterable[Motor], transmissions: Iterable[Transmission] = ()):
        self.model = _model("actuators", model)
        self.library, self._lock = model.library, model._lock
        tables = (_list("actuators", "motors", motors, Motor),
                  _list("actuators", "transmissions", transmissions, Transmission))
        self.motors, self.transmissions = copy.deepcopy(tables)  # copies are built of these
        self.n, scalar = len(self.motors), self.library.scalar
        self._rows = (structure("rbd_motor", scalar) * max(self.n, 1))()
        self._groups = (structure("rbd_transmission", scalar) * max(len(self.transmissions), 1))()
        for number, motor in enumerate(self.motors):
            _fill(motor, self._rows[number], f"actuators: {_numbered('motor', number, motor)}")
        for number, given in enumerate(self.transmissions):
            _transmission(given, self._groups[number], f"actuators: transmission {number}")
        self._make()

    def _make(self):
        """Makes the memory."""
        call, groups = self.library.call, len(self.transmissions)
        delay = max([row.delay for row in self._rows if 0 <= row.delay <= 1000], default=0)
        size = call("actuators_size", self.n, groups, delay, result=ctypes.c_size_t)
        self._memory, self._actuators = ctypes.create_string_buffer(max(size, 1)), ctypes.c_void_p()
        report = structure("rbd_report", self.library.scalar)()
        status = call("actuators_init", self.model._address("model"), self._rows, self.n, self._groups, groups, self._memory,
                      ctypes.c_size_t(size), ctypes.byref(self._actuators), report)
        if status:
            text = ctypes.create_string_buffer(400)
            call("actuators_finding_text", report.error, self.n, text, ctypes.c_size_t(len(text)), result=ctypes.c_void_p)
            raise RbdError(Status(status), f"actuators: {text.value.decode(errors='replace')}")

    def __repr__(self):
        return f"<rbd.Actuators, {self.n} motors of {self.model!r}>"

    def __reduce__(self):
        return Actuators, (self.model, self.motors, self.transmissions)

    def _state(self, call, name, value, width):
        """One state's array. One of another length is of another robot."""
        array = _array(call, name, value, self.library.dtype)
        if array.ndim == 1 and len(array) != width:
            raise ValueError(f"{call}: {name} has {len(array)} numbers, but these actuators are of a robot with {width}: its "
                             f"degrees of freedom are {_listed(self.model.dof_names)}")
        return _numbers(call, name, array, (width,), self.library.dtype)

    def _same_robot(self, contacts):
        """The contacts of a step are of this robot: their model may be a copy."""
        if contacts.model is self.model:
            return
        mine, theirs = self.model.dof_names, contacts.model.dof_names
        if mine != theirs:
            raise ValueError(f"step: contacts are of another robot, with the degrees of freedom {_listed(theirs)}; those of "
                             f"these actuators are {_listed(mine)}")
        if self.library.real != contacts.library.real:
            raise ValueError(f"step: contacts are of a model in {contacts.library.real}, these actuators of one in "
                             f"{self.library.real}")

    def _checked(self, call, status, number=""):
        """Raises the error of a call. number: the one that may be out of range."""
        if not status:
            return
        call += f": {number}" if status == Status.ERR_RANGE and number else ""
        where = self.library.call("actuators_fault", self._actuators)
        text = {Status.ERR_INFEASIBLE: "a rod does not reach", Status.ERR_SINGULAR: "a rod is at its dead centre"}.get(
            status, self.library.status_string(status))
        raise RbdError(Status(status), f"{call}: " + (f"transmission {where}: " if where >= 0 else "") + text)

    def map(self, q: ArrayLike, v: ArrayLike | None = None) -> tuple[Array, Array]:
        """Shaft angles and speeds, n each, of a state: q nq, v nv or None for zero."""
        q = self._state("map", "q", q, self.model.nq)
        v = None if v is None else self._state("map", "v", v, self.model.nv)
        angle, speed = np.zeros((2, self.n), self.library.dtype)
        with self._lock:
            self._checked("map", self.library.call("actuators_map", self._actuators, q, v, angle, speed))
        return angle, speed

    def inverse(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, tau: ArrayLike) -> Drives:
        """Motor torques, currents and voltages for wanted joint torques tau, nv, at q and the *planned* v and a: adds
        friction, the rotors' inertia and cogging, and obeys the limits."""
        sizes = {"q": self.model.nq, "v": self.model.nv, "a": self.model.nv, "tau": self.model.nv}
        given = [self._state("inverse", name, x, size) for (name, size), x in zip(sizes.items(), (q, v, a, tau))]
        rows = (structure("rbd_drive", self.library.scalar) * self.n)()
        with self._lock:
            self._checked("inverse", self.library.call("actuators_inverse", self._actuators, *given, rows))
        return Drives(*self._columns(rows, Drives._fields))

    def _columns(self, rows, names):
        """Each field of an array of C structs as an array of numpy."""
        kinds = dict(rows._type_._fields_)
        return [np.array([getattr(row, name) for row in rows],
                         int if kinds[name] is ctypes.c_int else self.library.dtype) for name in names]

    def reset(self, q: ArrayLike, air: float = 25.0) -> None:
        """Puts all shafts at rest where q has them, as warm as the air, in degrees."""
        q = self._state("reset", "q", q, self.model.nq)
        with self._lock:
            status = self.library.call("actuators_reset", self._actuators, q, self._real("reset", "air", air))
            self._checked("reset", status, f"air is {air}")

    def _real(self, call, name, value):
        return self.library.scalar(_number(call, name, value))

    def step(self, q: ArrayLike, v: ArrayLike, dt: float, *, torque: ArrayLike = 0.0, position: ArrayLike = 0.0,
             speed: ArrayLike = 0.0, kp: ArrayLike = 0.0, kd: ArrayLike = 0.0, voltage: ArrayLike = 0.0,
             tau: ArrayLike | None = None, f_ext: ArrayLike | None = None,
             contacts: ContactSet | None = None) -> tuple[Array, Array]:
        """A time step of the robot with its motors: q and v after dt. Each drive gives torque + kp (position - angle) +
        kd (speed - shaft's speed) at its shaft, numbers or arrays of n. Drives with by_voltage have a voltage, V, in place
        of the torque, and gains in V/rad and V s/rad.

            tau        nv: further torques of the joints; None = none
            f_ext      nb x 6: external wrenches; None = none
            contacts   the ContactSet that makes the step; None: Model.free_step"""
        call, model, dtype = self.library.call, self.model, self.library.dtype
        if contacts is not None:
            self._same_robot(_instance("step", "contacts", contacts, ContactSet))
        q, v = self._state("step", "q", q, model.nq), self._state("step", "v", v, model.nv)
        more = np.zeros(model.nv, dtype) if tau is None else self._state("step", "tau", tau, model.nv)
        f_ext = None if f_ext is None else _numbers("step", "f_ext", f_ext, (model.nb, 6), dtype)
        commands = (structure("rbd_command", self.library.scalar) * self.n)()
        for name, given, value in (("q", "position", position), ("v", "speed", speed), ("kp", "kp", kp), ("kd", "kd", kd),
                                   ("torque", "torque", torque), ("voltage", "voltage", voltage)):
            for row, x in zip(commands, self._command(given, value, name in ("kp", "kd"))):
                setattr(row, name, x)
        for number, (motor, row) in enumerate(zip(self._rows, commands)):
            if row.torque if motor.by_voltage else row.voltage:
                raise ValueError(f"step: motor {number} has a " + ("voltage, not a torque: by_voltage is 1" if motor.by_voltage
                                                                   else "torque, not a voltage: by_voltage is 0"))
        first_order = bool(contacts is not None and contacts.options.first_order)
        told, damping = np.zeros((2, model.nv), dtype)
        move = model.free_step if contacts is None else contacts.step
        with self._lock:
            status = call("actuators_begin", self._actuators, commands, q, v, self._real("step", "dt", dt), int(first_order),
                          told, damping)
            self._checked("step", status, f"dt is {dt}")
            v_next = np.full(model.nv, np.nan, dtype)
            try:
                while True:
                    q_next, v_next = move(q, v, told + more, dt=dt, f_ext=f_ext, damping=damping)
                    if not call("actuators_again", self._actuators, v_next, told, damping):
                        return q_next, v_next
            except Exception:  # a step that failed is none: the shafts stay as they were
                v_next[:] = np.nan
                call("actuators_again", self._actuators, v_next, told, damping)
                raise

    def _command(self, name, value, positive):
        """A number for each motor, from one or n."""
        if _ndim("step", name, value) == 0:
            value = np.full(self.n, _number("step", name, value))
        array = _numbers("step", name, value, (self.n,), self.library.dtype)
        if positive and (array < 0).any():
            raise ValueError(f"step: {name}[{int(np.argmin(array))}] is negative")
        if (np.abs(array) > 1e9).any():
            raise ValueError(f"step: {name}[{int(np.argmax(np.abs(array)))}] is above 1e9")
        return array

    def get(self) -> ActuatorStates:
        """The shafts after the last step."""
        rows = (structure("rbd_actuator_state", self.library.scalar) * self.n)()
        with self._lock:
            for number, row in enumerate(rows):
                self._checked("get", self.library.call("actuators_get", self._actuators, number, ctypes.byref(row)))
        return ActuatorStates(*self._columns(rows, ActuatorStates._fields))

    def friction(self, motor: int, speed: float, torque: float, joint: float) -> float:
        """The level of dry friction of a motor's gear, N m, at a speed of the shaft, rad/s; torque and joint: of the motor
        and of the joint on the shaft, N m."""
        number = _whole("friction", "motor", motor)
        if not 0 <= number < self.n:
            raise IndexError(f"friction: no such motor: {number}; there are {self.n}")
        values = [self._real("friction", name, x) for name, x in (("speed", speed), ("torque", torque), ("joint", joint))]
        level = self.library.call("friction_level", ctypes.byref(self._rows[number].friction), *values,
                                  result=self.library.scalar)
        assert math.isfinite(level)
        return level


def _rotor_torque(model, rotors, q, v, a, f_ext):
    """rbd_rotor_torque of a Model."""
    library, dtype = model.library, model.library.dtype
    rotors = _list("rotor_torque", "rotors", rotors, Rotor)
    rows = (structure("rbd_rotor", library.scalar) * max(len(rotors), 1))()
    for number, rotor in enumerate(rotors):
        where = f"rotor_torque: rotor {number}"
        if not 0 <= _whole(where, "dof", rotor.dof) < model.nv:
            raise IndexError(f"{where}: no such dof: {rotor.dof}; there are {model.nv}")
        if _number(where, "inertia", rotor.inertia) < 0:
            raise RbdError(Status.ERR_RANGE, f"{where}, field 'inertia': {rotor.inertia} is negative")
        _fill(Rotor(model._body(rotor.body, where, "body", world=True), rotor.dof, rotor.axis, rotor.gear, rotor.inertia),
              rows[number], where)
    arrays = [_numbers("rotor_torque", name, x, (size,), dtype) for name, x, size in
              (("q", q, model.nq), ("v", v, model.nv), ("a", a, model.nv))]
    wrenches = np.zeros((model.nb, 6), dtype)
    if f_ext is not None:
        wrenches[:] = _numbers("rotor_torque", "f_ext", f_ext, (model.nb, 6), dtype)
    tau = np.zeros(model.nv, dtype)
    with model._lock:
        status = library.call("rotor_torque", model._address("model"), model._address("work"), rows, len(rotors), *arrays,
                              wrenches, tau)
    if status:
        raise RbdError(Status(status), f"rotor_torque: {library.status_string(status)}")
    return tau
