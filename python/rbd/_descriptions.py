# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Rows of a description: bodies, constraints, contacts; and C tables of them."""
from __future__ import annotations

import ctypes
import difflib
import operator
import os
import re
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np

from ._arguments import _Declared, _array, _flag, _int, _numbered, _utf8
from ._compiling import _c_compiler, _compile
from ._headers import JointType, Matrix, Numbers, _enumerator, structure
from ._plain_table import _plain_rows


@dataclass
class Body(_Declared):
    """One body and the joint that carries it: a row of a description, rbd_body of rbd.h.

    `parent` is the index or the name of an earlier body; -1 is the world. `type` is a name such as "revolute"
    or "floating"; JointType has all. A single number as armature, damping or friction counts for each degree
    of freedom."""
    name: str | None = None             #: of the link; unique
    joint: str | None = None            #: name of the joint; unique
    parent: int | str = -1              #: index or name of an earlier body, -1 = the world
    type: str = "fixed"                 #: of the joint
    axis: Numbers = (0, 0, 0)           #: in the joint frame
    axis2: Numbers = (0, 0, 0)          #: universal: the second axis
    pitch: float = 0.0                  #: helical: m/rad
    position: Numbers = (0, 0, 0)       #: of the joint frame's origin in the parent's link frame, m
    rotation: Numbers | Matrix = (0,) * 9  #: 3 x 3, joint-frame vectors into the parent's; all 0 = identity
    mass: float = 0.0                   #: kg
    com: Numbers = (0, 0, 0)            #: centre of mass, link frame, m
    inertia: Numbers = (0,) * 6         #: xx xy xz yy yz zz about the centre of mass, link axes, kg m^2
    armature: Numbers | float = 0.0     #: per degree of freedom: rotor inertia seen at the joint
    damping: Numbers | float = 0.0      #: per degree of freedom: see Model.passive
    friction: Numbers | float = 0.0     #: per degree of freedom: see Model.passive
    lower: float = 0.0                  #: limits of a revolute, prismatic or helical joint; both 0: none
    upper: float = 0.0
    velocity: float = 0.0               #: limit, 0 = none; carried for the user
    effort: float = 0.0                 #: limit, 0 = none; carried for the user
    mimic: str | None = None            #: name of the joint that this one follows
    mimic_ratio: float = 0.0            #: q = ratio * (q of that joint) + offset
    mimic_offset: float = 0.0


@dataclass
class Constraint(_Declared):
    """Frame 1, fixed in body 1, held to frame 2, fixed in body 2, along some axes: rbd_constraint of
    rbd_constraints.h. Bodies by index, or name of the link; -1 is the world."""
    name: str | None = None             #: for messages
    body1: int | str = -1
    body2: int | str = -1
    rotation1: Numbers | Matrix = (0,) * 9  #: 3 x 3, axes of frame 1 to those of body 1; all 0 = identity
    position1: Numbers = (0, 0, 0)      #: of its origin in body 1, m
    rotation2: Numbers | Matrix = (0,) * 9  #: the same of frame 2 in body 2
    position2: Numbers = (0, 0, 0)
    axes: Numbers = (0,) * 6            #: 1 = held: omega_x _y _z v_x _y _z, along the axes of frame 2
    kp: float = 0.0                     #: 1/s^2, Baumgarte's stabilisation: J a + gamma = -kd J v - kp e
    kd: float = 0.0                     #: 1/s


@dataclass
class Contact(_Declared):
    """A point of body 1, or a ball about it, that may touch a plane of body 2: rbd_contact of rbd_contact.h.
    Bodies by index, or name of the link; -1 is the world."""
    name: str | None = None             #: for messages
    body1: int | str = -1
    body2: int | str = -1
    point: Numbers = (0, 0, 0)          #: link axes of body 1, m
    radius: float = 0.0                 #: m; 0 = a point
    normal: Numbers = (0, 0, 0)         #: of the plane, axes of body 2, towards body 1; all 0 = z
    height: float = 0.0                 #: of the plane along the unit normal, m
    friction: float = 0.0               #: mu
    restitution: float = 0.0            #: 0 (does not rebound) to 1
    stiffness: float = 0.0              #: N/m; 0 = rigid
    damping: float = 0.0                #: N s/m: p/dt = -(stiffness gap + damping d gap/dt); needs a stiffness

    @property
    def on_body(self) -> bool:
        """Whether the plane is a body's: body2 of C is left out as 0, here as -1."""
        return self.body2 != -1


@dataclass
class ContactOptions(_Declared):
    """rbd_contact_options of rbd_contact.h; 0 is the default in brackets."""
    margin: float = 0.0         #: closer contacts are rows, m [0.005]
    slop: float = 0.0           #: penetration that is left, m [1e-5]
    correction: float = 0.0     #: share of the rest that a step takes back, up to 1 [0.2]
    bounce: float = 0.0         #: slower impacts do not rebound, m/s [0.05]; choose more than 2 g dt
    tolerance: float = 0.0      #: of the residual, m/s [1e-6, float 1e-5]
    iterations: int = 0         #: at most [40]
    joint_limits: bool = False      #: limits of joints push
    joint_friction: bool = False    #: the description's friction holds, or brakes
    joint_damping: bool = False     #: the description's damping, implicitly
    slip: float = 0.0           #: contacts that stick give way along the plane, m/s per newton [0]
    derivatives: bool = False       #: memory for step_derivatives
    first_order: bool = False       #: semi-implicit Euler: q_next is q moved by v_next, for planners
    momentum: bool = False          #: robots that float keep their momentum to rounding while nothing touches
    rows: int = 0               #: bounded rows of yours, for row_set [0]


_PER_DOF = ("armature", "damping", "friction")
_BODIES = ("parent", "body1", "body2")


def _to_c(values, row, where):
    """Writes a Body, Constraint, Contact or ContactOptions into a C struct."""
    types = {field.name: field.type for field in fields(values)}
    for member, kind in row._fields_:
        value = getattr(values, member)
        if issubclass(kind, ctypes.Array):
            array = _array(f"{where}, field '{member}'", "it", value)
        if member == "type":
            row.type = _enumerator(where, JointType, value, "joint type", ("JOINT_TYPES",))
            continue
        if kind is ctypes.c_int and types.get(member, "bool") == "bool":  # on_body is no field
            setattr(row, member, _flag(f"{where}, field '{member}'", "it", value))
            continue
        try:
            if kind is ctypes.c_char_p:
                value = _utf8(value) if value is not None else None
            elif issubclass(kind, ctypes.Array):
                numbers = array.astype(float).reshape(-1)
                if member in _PER_DOF and np.ndim(value) == 0:
                    numbers = np.repeat(numbers, kind._length_)
                short = member in _PER_DOF and len(numbers) < kind._length_
                if len(numbers) != kind._length_ and not short:
                    raise ValueError(f"has {len(numbers)} numbers instead of {kind._length_}" +
                                     " (xx xy xz yy yz zz)" * (member == "inertia"))
                if kind._type_ is ctypes.c_int:
                    if (~np.isfinite(numbers) | (numbers != np.rint(numbers))).any():
                        raise ValueError("must be whole numbers")
                    numbers = [_int(int(x)) for x in numbers]
                value = kind(*numbers)
            elif kind is ctypes.c_int:
                if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
                    raise TypeError("must be " + ("an index or a name" if member in _BODIES else
                                                  "a whole number") + f", not {value!r:.60}")
                value = _int(operator.index(value))
            elif isinstance(value, (bool, np.bool_)) or getattr(value, "ndim", 0):
                raise TypeError(f"must be a number, not {value!r:.60}")
            setattr(row, member, value)
        except OverflowError:  # a whole number of Python has no limit
            raise ValueError(f"{where}, field '{member}': is too large for a float") from None
        except (TypeError, ValueError, AttributeError) as error:
            raise type(error)(f"{where}, field '{member}': {error}") from None


def _from_c(row):
    """The Body of a C struct."""
    values = {}
    for member, kind in row._fields_:
        value = getattr(row, member)
        if isinstance(value, bytes):
            value = value.decode(errors="replace")
        elif isinstance(value, ctypes.Array):
            value = tuple(value)
        values[member] = value
    values["type"] = JointType(row.type).name.lower()
    return Body(**values)


def _rows(bodies):
    """Bodies as an array of rbd_body."""
    index = {}
    rows = (structure("rbd_body") * len(bodies))()
    for number, body in enumerate(bodies):
        where = _numbered("body", number, body)
        if not isinstance(body, Body):
            raise TypeError(f"{where}: must be a Body, not {type(body).__name__}")
        if isinstance(body.parent, str):
            if body.parent not in index:
                near = difflib.get_close_matches(body.parent, [name for name in index if name], 1)
                raise ValueError(f"{where}, field 'parent': no earlier body is called '{body.parent}'" +
                                 (f"; did you mean '{near[0]}'?" if near else ""))
            body = replace(body, parent=index[body.parent])
        _to_c(body, rows[number], where)
        index.setdefault(body.name, number)
    return rows


class _Table(list):
    """Rows of a C table, which has the robot's name in that of its array."""

    def __init__(self, rows, array):
        super().__init__(rows)
        self.name = re.sub("_bodies$", "", array)

    def __reduce__(self):
        return list, (list(self),)


def load_table(path: str | os.PathLike[str], name: str | None = None) -> list[Body]:
    """The description in a C table, as rbd-model writes it and models/ has it: a list of Body. A table with
    more C in it is compiled.

    path   of a C header with `static const rbd_body NAME_bodies[...]`
    name   of the array, where there are several
    """
    path = Path(path).resolve()
    try:
        text = path.read_text()
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not text in UTF-8") from None
    arrays = re.findall(r"\brbd_body\s+(\w+)\s*\[", text)
    if name is None and len(arrays) != 1 or name is not None and name not in arrays:
        raise ValueError(f"{path}: " + (f"has the arrays of rbd_body {', '.join(arrays)}" if arrays
                                        else "has no array of rbd_body" +
                                        ("; load_urdf reads URDF files" if "<robot" in text else
                                         "; a built model (rbd_model) is no description"
                                         if "rbd_model" in text else "")))
    array = name or arrays[0]
    plain = _plain_rows(text, array)
    if plain:
        return _Table([_from_c(row) for row in plain], array)
    unit = (f'#include "rbd.h"\n{text}\nconst rbd_body *const table = {array};\n'
            f"const int length = sizeof {array} / sizeof *{array};\n")
    library = _compile([unit], [*_c_compiler(), f"-I{path.parent}"])
    pointer = ctypes.POINTER(structure("rbd_body")).in_dll(library, "table")
    return _Table([_from_c(pointer[k]) for k in range(ctypes.c_int.in_dll(library, "length").value)], array)
