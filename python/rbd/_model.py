# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""A robot: constants and memory."""
from __future__ import annotations

import copy
import ctypes
import inspect
import operator
import os
import threading
from typing import Iterable, Literal

import numpy as np
from numpy.typing import ArrayLike

from ._actuator import Actuators, Motor, Rotor, Transmission, _rotor_torque
from ._arguments import _flag, _is_list, _number, _numbers
from ._calls import _state
from ._constraints import ConstraintSet
from ._contacts import ContactSet
from ._derivatives import Derivatives
from ._descriptions import Body, Constraint, Contact, ContactOptions, _from_c, _rows, _Table
from ._dynamics import Dynamics
from ._headers import Array, RbdError, Status, _warn, structure
from ._kinematics import Kinematics
from ._library import Library, _default_library
from ._names import Names
from ._show import Picture, _show
from ._tables import _print_c
from ._mjcf import _load_mjcf, _takes_mjcf_options
from ._urdf import Urdf, _load_urdf, _takes_urdf_options

_MEMORIES = {  # what C computes in, and what it stands on
    "work": [],
    "derivatives": ["work"],
    "batch": [],
    "batch_derivatives": ["batch"],
}


class Model(Derivatives, Kinematics, Names):
    """A robot: constants, and the memory that one thread computes in.

    bodies     list of Body, parents first; or the result of load_urdf, whose gravity it takes
    gravity    3, world frame, m/s^2; None = (0, 0, -9.81)
    library    a Library; None = double, compiled for this machine
    kinematic  let joints move no mass: if one does, poses, Jacobians and inverse kinematics are computed, and
               dynamics is ERR_MASSLESS. None = as the file was loaded, else False

    If a body cannot be real, but can be computed with, an RbdWarning says so; `warnings` keeps the sentences.
    Of a URDF these are those of the loader, which sees the single links and their lines.
    """
    library: Library
    bodies: list[Body]
    warnings: list[str]     #: sentences
    nb: int                 #: number of bodies
    nq: int                 #: number of coordinates: the length of q
    nv: int                 #: number of degrees of freedom: the length of v
    kinematic: bool         #: whether joints may move no mass

    def __init__(self, bodies: Urdf | Iterable[Body], *, gravity: ArrayLike | None = None,
                 library: Library | None = None, kinematic: bool | None = None):
        urdf = bodies if isinstance(bodies, Urdf) else None
        kinematic = bool(urdf and urdf.kinematic) if kinematic is None else _flag("Model", "kinematic", kinematic)
        if urdf:
            gravity = urdf.gravity if gravity is None else gravity
            bodies = urdf.bodies
        if isinstance(bodies, (os.PathLike, Body)) or not _is_list(bodies):
            file = isinstance(bodies, (str, os.PathLike))
            raise TypeError("Model: bodies must be a list of Body, or the result of load_urdf, not "
                            f"{type(bodies).__name__}" + "; Model.from_urdf takes the name of a file" * file)
        drawn = (urdf._path, urdf.frames, urdf.name) if urdf else (None, (), bodies.name if isinstance(bodies, _Table) else None)
        self._setup(bodies, gravity, _default_library() if library is None else library, kinematic, drawn=drawn)
        if urdf and urdf.warnings:
            self.warnings = list(urdf.warnings)
        else:
            _warn(self.warnings)

    def _setup(self, bodies, gravity, library, kinematic, layout="rows", drawn=(None, (), None)):
        """What a new model and a copy have in common. drawn: the URDF file, the frames of its links and the robot's name,
        for pictures."""
        if not isinstance(library, Library):
            raise TypeError(f"Model: library must be a Library, as Library('float'), not {library!r}")
        super().__init__(library, threading.RLock())
        self._batch_layout, self._drawn = layout, drawn
        self.kinematic = bool(kinematic)
        bodies = list(bodies)
        self._rows = _rows(bodies)
        self.bodies = copy.deepcopy(bodies)  # the caller may change his, and copies are built of these
        self._build()
        self.nb, self.nq, self.nv = (self.library.call(n, self._address("model")) for n in ("nb", "nq", "nv"))
        self._dims = {"nb": self.nb, "nq": self.nq, "nv": self.nv, "nh": self.packed_size()}
        if gravity is not None:
            self.set_gravity(gravity)

    @classmethod
    @_takes_urdf_options
    def from_urdf(cls, path: str | os.PathLike[str], *, library: Library | None = None, **options) -> Model:
        """A model of a URDF file."""
        return cls(_load_urdf("from_urdf", path, options), library=library)

    @classmethod
    @_takes_mjcf_options
    def from_mjcf(cls, path: str | os.PathLike[str], *, library: Library | None = None, **options) -> Model:
        """A model of an MJCF file, MuJoCo's format. load_mjcf gives its constraints too, and maps of MuJoCo's states."""
        return cls(_load_mjcf("from_mjcf", path, options), library=library)

    def _build(self):
        """Builds the model from its rows."""
        rows, nb, call = self._rows, len(self._rows), self.library.call
        size = call("model_size", rows, nb, result=ctypes.c_size_t)
        self._memories["model"] = memory = ctypes.create_string_buffer(max(size, 1))
        self._addresses["model"] = model = ctypes.c_void_p()
        report = structure("rbd_report", self.library.scalar)()
        build = "model_build_kinematic" if self.kinematic else "model_build"
        status = call(build, rows, nb, memory, ctypes.c_size_t(size), ctypes.byref(model), report)
        if status:
            raise RbdError(Status(status), self.library.finding_text(report.error))
        found = report.warning[:min(report.warnings, len(report.warning))]
        self.warnings = [self.library.finding_text(finding) for finding in found]

    def _prepare(self, kind):
        """Makes this part of memory, or makes it anew in its place."""
        model, address, call = self._addresses["model"], ctypes.c_void_p(), self.library.call
        if kind not in self._memories:
            size = call(f"{kind}_size", model, result=ctypes.c_size_t)
            self._memories[kind] = ctypes.create_string_buffer(size)
        memory = self._memories[kind]
        status = call(f"{kind}_init", model, *map(self._address, _MEMORIES[kind]), memory,
                      ctypes.c_size_t(len(memory)), ctypes.byref(address))
        if status:
            raise self._error(f"{kind}_init", status)
        self._addresses[kind] = address
        if kind == "batch":
            call("batch_set_gravity", address, self.get_gravity())

    def _error(self, call, status, results=None, states=None):
        """The exception for a status: the library's sentence, and where it happened. states: of a batch, the
        axes of its states."""
        text = f"{call}: {self.library.status_string(status)}"
        if status == Status.ERR_MASSLESS:
            body = self.library.call("dof_body", self._address("model"), self.singular_dof())
            text += f"; joint '{self.joint_names[body]}', which carries '{self.body_names[body]}'"
        elif status in (Status.ERR_SINGULAR, Status.ERR_NAN):
            dof = self.singular_dof()
            if states is not None:
                state, dof = self.batch_singular()
                text += f"; state {_state(state, states)}"
            if dof >= 0:
                text += f"; degree of freedom {dof}, '{self.dof_names[dof]}'"
        return RbdError(Status(status), text, results)

    def _layout(self):
        return self._batch_layout

    def _body(self, body, call, name="body", world=False):
        """The index of a body, from its name too. name: of the argument, None where `call` has it; world: whether -1, the
        world, may be meant."""
        where = call if name in (None, "body") else f"{call}: {name}"
        if isinstance(body, str):
            return self._index(where, "body_index", body)
        if isinstance(body, (bool, np.bool_)) or not hasattr(body, "__index__"):
            raise TypeError(f"{where if name is None else f'{call}: {name}'} must be an index or a name, not {body!r:.60}")
        index = operator.index(body)
        if not -world <= index < self.nb:
            last = f"the model has 0 to {self.nb - 1}" + ", and -1 for the world" * world
            raise RbdError(Status.ERR_INDEX, f"{where}: no such body: {index}; {last}")
        return index

    def copy(self) -> Model:
        """Another Model of the same robot, with memory of its own: for another thread."""
        return _again(*self.__reduce__()[1])

    def __reduce__(self):
        return _again, (self.bodies, self.get_gravity(), self.library, self.kinematic, self._batch_layout,
                        self.warnings, self._drawn)

    def __repr__(self):
        return f"<rbd.Model of {self.nb} bodies, nq = {self.nq}, nv = {self.nv}, {self.library.real}>"

    # -- gravity, payload, errors --

    def batch_set_layout(self, layout: Literal["rows", "blocks"]) -> None:
        """Sets how the states of a batch stand in arrays, for the calls that C computes together: "rows", as
        in numpy, or "blocks" of as many states as the library has lanes, which stand along a last axis: q (n,
        nq, lanes), M (n, nv, nv, lanes). C need not transpose blocks. See rbd_layout."""
        if not isinstance(layout, str) or layout not in ("rows", "blocks"):
            raise ValueError(f"batch_set_layout: layout must be 'rows' or 'blocks', not {layout!r}")
        self._batch_layout = layout

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Sets gravity, 3 components in the world frame, m/s^2, for the calls that follow."""
        gravity = _numbers("set_gravity", "gravity", gravity, (3,), self.library.dtype)
        with self._lock:
            self.library.call("set_gravity", self._address("work"), gravity)
            if "batch" in self._addresses:
                self.library.call("batch_set_gravity", self._address("batch"), gravity)

    def get_gravity(self) -> Array:
        """Gravity as it is set: 3, world frame, m/s^2."""
        gravity = np.empty(3, self.library.dtype)
        self.library.call("get_gravity", self._address("work"), gravity)
        return gravity

    def add_payload(self, body: int | str, mass: float, com: ArrayLike = (0, 0, 0),
                    inertia: ArrayLike | None = None) -> None:
        """Adds mass to a body, as a load that a hand took up. The same call with mass and inertia negated
        takes it off again, to rounding.

            body      index, or name of the link
            mass      kg, may be negative
            com       3, of the payload, link frame, m
            inertia   xx xy xz yy yz zz about its com, link axes, kg m^2; None = a point
        """
        index = self._body(body, "add_payload")
        com = _numbers("add_payload", "com", com, (3,))
        inertia = None if inertia is None else _numbers("add_payload", "inertia", inertia, (6,))
        mass = ctypes.c_double(_number("add_payload", "mass", mass))
        with self._lock:
            status = self.library.call("add_payload", self._memories["model"], index, mass, com, inertia)
            if status:
                raise self._error("add_payload", status)
            for kind in "derivatives", "batch_derivatives":  # they hold constants of the model
                if kind in self._addresses:
                    self._prepare(kind)
            self.bodies[index] = self.library.set_parameters(self.bodies[index], self.body_parameters(index))

    def lock_joints(self, joints: int | str | Iterable[int | str], q: ArrayLike) -> Model:
        """Another Model of the robot, in which these joints are fixed at their pose in q, and with them those that
        mimic them. All bodies stay. q and v of the new model are those of the joints that still move, in the same
        order: see `q_names`.

            joints    names of joints, or the bodies that they carry: indices, or names of links
            q         nq, of this model
        """
        if isinstance(joints, (bytes, dict)):
            raise TypeError(f"lock_joints: joints must be names or indices, not {type(joints).__name__}; where they are held "
                            "is said by q")
        joints = [joints] if not _is_list(joints) else joints
        q = _numbers("lock_joints", "q", q, (self.nq,))
        locked = np.zeros(self.nb, np.uint8)
        for joint in joints:
            locked[self._joint_body(joint, "lock_joints", "joints")] = 1
        rows, held = _rows(self.bodies), (structure("rbd_body") * self.nb)()
        report = structure("rbd_report", self.library.scalar)()
        status = self.library.call("lock_joints", rows, self.nb, locked, q, held, report)
        if status:
            raise RbdError(Status(status), "lock_joints: " + self.library.finding_text(report.error))
        bodies = [body if row.type == new.type else _from_c(new)
                  for body, row, new in zip(self.bodies, rows, held)]
        return _again(bodies, self.get_gravity(), self.library, self.kinematic, self._batch_layout, self.warnings,
                      self._drawn)

    def singular_dof(self) -> int:
        """After Status.ERR_SINGULAR or ERR_NAN: the degree of freedom whose pivot is not above its rounding,
        or not a number; after ERR_MASSLESS the first that moves no mass; else -1."""
        return self.library.call("singular_dof", self._address("work"))

    def batch_singular(self) -> tuple[int, int]:
        """After that error of a batch: (the first singular state, its degree of freedom); else (-1, -1)."""
        dof = ctypes.c_int(-1)
        return self.library.call("batch_singular", self._address("batch"), ctypes.byref(dof)), dof.value

    # -- constraints: rbd_constraints.h --

    def constraint_set(self, rows: Iterable[Constraint]) -> ConstraintSet:
        """A set of constraints that hold together, from a list of Constraint: see ConstraintSet."""
        return ConstraintSet(self, rows)

    def _constraint(self, function, *arguments):
        """The Constraint of a function of C: names and indices are bodies, all else points and axes."""
        names = list(inspect.signature(getattr(Model, function)).parameters)[1:]
        row = self.library.call(function, *(
            self._body(x, function, name, world=True) if name.startswith("body") else
            None if x is None and name == "place" else _numbers(function, name, x, (3,))
            for name, x in zip(names, arguments)),
            result=structure("rbd_constraint"))
        values = {member: getattr(row, member) for member, _ in row._fields_}
        return Constraint(**{member: tuple(value) if isinstance(value, ctypes.Array) else value
                             for member, value in values.items()})

    def point_contact(self, body: int | str, point: ArrayLike = (0, 0, 0),
                      place: ArrayLike | None = None) -> Constraint:
        """A Constraint: a point of a body (3, body axes) held at a place (3, world; None = anywhere); 3
        rows."""
        return self._constraint("point_contact", body, point, place)

    def flat_contact(self, body: int | str, point: ArrayLike = (0, 0, 0),
                     place: ArrayLike | None = None) -> Constraint:
        """The same of a whole surface: 6 rows."""
        return self._constraint("flat_contact", body, point, place)

    def ball_loop(self, body1: int | str, point1: ArrayLike, body2: int | str,
                  point2: ArrayLike) -> Constraint:
        """A Constraint: points of two bodies, each in its body's axes, coincide; 3 rows."""
        return self._constraint("ball_loop", body1, point1, body2, point2)

    def hinge_loop(self, body1: int | str, point1: ArrayLike, axis1: ArrayLike, body2: int | str,
                   point2: ArrayLike, axis2: ArrayLike) -> Constraint:
        """The same, and the lines along axis1 and axis2 there coincide; 5 rows."""
        return self._constraint("hinge_loop", body1, point1, axis1, body2, point2, axis2)

    # -- contacts: rbd_contact.h --

    def contacts(self, rows: Iterable[Contact], held: Iterable[Constraint] = (),
                 options: ContactOptions | None = None) -> ContactSet:
        """Contacts that open and slip, from a list of Contact, for simulation: see ContactSet. held: a list of
        Constraint that hold at the same time, as loops; their kp and kd have no meaning here."""
        return ContactSet(self, rows, held, options)

    # -- actuators: rbd_actuator.h --

    def actuators(self, motors: Iterable[Motor], transmissions: Iterable[Transmission] = ()) -> Actuators:
        """The motors of this robot, from a list of Motor and one of Transmission: see Actuators."""
        return Actuators(self, motors, transmissions)

    def rotor_torque(self, rotors: Iterable[Rotor], q: ArrayLike, v: ArrayLike, a: ArrayLike,
                     f_ext: ArrayLike | None = None) -> Array:
        """Inverse dynamics as rnea, of one state, with what armature leaves out of spinning rotors: their gyroscopic torques,
        and those by accelerations of the bodies that carry them. rotors: a list of Rotor. It calls `kinematics`."""
        return _rotor_torque(self, rotors, q, v, a, f_ext)

    # -- to look at --

    def show(self, q: ArrayLike | None = None, times: ArrayLike | None = None, *,
             file: str | os.PathLike[str] | None = None) -> Picture:
        """Shows the robot in the browser, or in a notebook, as a page that needs neither server nor network. Bodies are
        drawn as the URDF file has them (boxes, cylinders, balls, and meshes of STL, OBJ and Collada files), others as rods from
        joint to joint, with the ellipsoids of their inertia.

            q       nq: a configuration, None = neutral; or n x nq: a motion, which the page plays
            times   n, s, growing: when the configurations are; None = 60 in a second. Between them `interpolate`
            file    to write the page into; no browser is opened then
        """
        return _show(self, q, times, file)

    # -- for firmware --

    def c_model(self, name: str, source: str = "a Model in Python") -> str:
        """The built model as a C table for firmware, for a file NAME_model.h: the same as rbd-model --c-model
        NAME writes. It serves double and float. source: the origin that its head names."""
        return _print_c(self, name, source, built=True)

    def c_table(self, name: str, source: str = "a Model in Python") -> str:
        """The description as a C table, for a file NAME.h: the same as rbd-model --c NAME writes."""
        return _print_c(self, name, source, built=False)


# Messages of Python's and help say Model.rnea, whichever part has it.
for _part in (Dynamics, Derivatives, Kinematics, Names):
    for _member in filter(inspect.isfunction, vars(_part).values()):
        _member.__qualname__ = f"Model.{_member.__name__}"


def _again(bodies, gravity, library, kinematic, layout, warnings, drawn=(None, (), None)):
    """A Model that was built before, and has warned."""
    model = Model.__new__(Model)
    model._setup(bodies, gravity, library, kinematic, layout, drawn)
    model.warnings = list(warnings)
    return model
