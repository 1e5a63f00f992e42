# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""rbd from Python: rigid-body dynamics of robots by rbd.h, on ctypes and numpy.

    import rbd
    model = rbd.Model.from_urdf("robot.urdf", floating=True)            # or a C table:
    model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"))
    tau = model.rnea(q, v, a)                                           # one state: q nq, v and a nv
    tau = model.rnea(Q, V, A)                                           # n states: Q n x nq, V and A n x nv
    tau = model.rnea(Q, v, a)                                           # n states of the same v and a

The first use compiles rbd.h and its companions with the C compiler of this machine. That takes half a minute
to a minute; a line on standard error says so, unless $RBD_QUIET is set. The result stays in a cache folder
($RBD_CACHE, else ~/.cache/rbd), so that later uses start at once. A `Library` chooses the scalar and the
compiler's flags.

Every call has its name in C without `rbd_`, and the same contract. In short (rbd.h, [conventions]): SI units;
spatial vectors are angular first, (omega; v) and (moment; force); quantities of a body are in its own link
frame, at its origin; matrices are row-major; quaternions are (x, y, z, w). `nb`, `nq`, `nv` are the numbers
of bodies, coordinates and degrees of freedom, which stand in the order of the description.

- Inputs: anything that numpy turns into an array of real numbers of the right shape. Results are new arrays.
  Wrong shapes and types, masked arrays, NaN and infinity are refused by name (ValueError, TypeError) before C
  is called. A result that overflows is a FloatingPointError.
- Broadcasting is numpy's. The last axes of an argument are those of one state, as its help says; axes before
  them count states, and are broadcast against those of the other arguments. `rnea` of q (100, nq), v (nv,)
  and a (100, nv) gives (100, nv); q (20, 5, nq) gives (20, 5, nv).
- An error of the library is an `RbdError` with its `status` and a sentence.
- A call with several results gives a named tuple, in C's order. Results that C can leave out have a keyword:
  `model.id_derivatives(q, v, a, M=False).M` is None, and is not computed.
- Threads: C runs without Python's lock. Calls of one Model wait for each other; those of two run side by side
  (`model.copy()` is cheap). A Model keeps what `kinematics` computed: give each thread its own Model.
"""
import types

from ._actuator import Actuators, ActuatorStates, Drives, Friction, Motor, Rod, Rotor, Transmission
from ._calls import RESULTS as _RESULTS
from ._constraints import ConstraintSet
from ._contacts import ContactResult, ContactSet, ContactSolution, RowResult
from ._descriptions import Body, Constraint, Contact, ContactOptions, load_table
from ._estimate import Deviations, Estimate, Estimator, Felt, Observer
from ._headers import (SOURCES, Array, ContactState, IkKind, IkStatus, JointType, Matrix, MjcfStatus, Numbers, QpStatus,
                       RbdError, RbdWarning, Status, TaskKind, TasksStatus, UrdfStatus, __version__, structure)
from ._ik import IkResult, IkTarget
from ._library import Library
from ._mjcf import Mjcf, load_mjcf, parse_mjcf
from ._model import Model, _again
from ._names import JointInfo
from ._qp import QpSolution, qp
from ._show import Picture
from ._spatial import AxisAngle, Placement, Spatial
from ._tasks import Task, TaskContact, Tasks, TasksAcceleration, TasksVelocity
from ._urdf import Frame, Urdf, load_urdf, parse_urdf

__all__ = ["ActuatorStates", "Actuators", "AxisAngle", "Body", "Constraint", "ConstraintSet", "Contact", "ContactOptions",
           "ContactResult", "ContactSet", "ContactSolution", "ContactState", "Deviations", "Drives", "Estimate",
           "Estimator", "Felt", "Frame", "Friction", "IkKind", "IkResult", "IkStatus", "IkTarget", "JointInfo",
           "JointType", "Library", "Mjcf", "MjcfStatus", "Model", "Motor", "Observer", "Picture", "Placement", "QpSolution",
           "QpStatus", "RbdError", "RbdWarning", "Rod", "Rotor", "RowResult", "SOURCES", "Spatial", "Status", "Task",
           "TaskContact", "TaskKind", "Tasks", "TasksAcceleration", "TasksStatus", "TasksVelocity", "Transmission",
           "Urdf", "UrdfStatus", "load_mjcf", "load_table", "load_urdf", "parse_mjcf", "parse_urdf", "qp"]


def __dir__():
    """The public names alone."""
    return [*__all__, "__doc__", "__file__", "__name__", "__version__"]


# Pickles, messages and help say rbd.Body, wherever it is written; a pickle has the tuples of results by their names.
globals().update(_RESULTS)
for _thing in [*map(globals().get, __all__), _again, structure]:
    if isinstance(_thing, (type, types.FunctionType)):
        _thing.__module__ = __name__
