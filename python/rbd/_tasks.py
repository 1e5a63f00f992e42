# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Whole-body control: rbd_tasks.h."""
from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Iterable, NamedTuple, Sequence, TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import (_array, _Declared, _flag, _int, _is_list, _left_out, _list, _mask, _model,
                         _number, _numbers, _placed, _whole)
from ._headers import Array, Matrix, Numbers, RbdError, Status, TaskKind, TasksStatus, _enumerator, structure

if TYPE_CHECKING:
    from ._model import Model

_LIMITS = {"position": 1, "speed": 2, "torque": 4}    # RBD_WITHOUT_...


@dataclass
class Task(_Declared):
    """A wish: rbd_task of rbd_tasks.h. Zero will do for every field that the kind needs not. With e from where it is to
    where it shall be, u its velocity and k the gain, its velocity shall be velocity + k e, or its acceleration
    acceleration + k^2 e + 2 damping k (velocity - u)."""
    kind: str                           #: "point", "pose", "rotation", "axis", "com", "momentum", "relative", "posture", "rows"
    body: int | str = 0                 #: index, or name of the link; not of "com", "momentum", "posture", "rows"
    level: int = 0                      #: 0 to 2: no task makes one of a lower level worse
    weight: float = 0.0                 #: of the squares of its rows beside the tasks of its level; 0 = 1
    gain: float = 0.0                   #: k, 1/s
    damping: float = 0.0                #: 0 = 1, critical
    reference: int | str = -1           #: "relative": the other body; -1 = the world
    point: Numbers = (0, 0, 0)          #: of the body, link axes, m
    position: Numbers = (0, 0, 0)       #: where point or centre of mass shall be, world, m; "relative": reference's axes
    rotation: Numbers | Matrix = (0,) * 9  #: 3 x 3, from link axes to these; all 0 = identity
    axis: Numbers = (0, 0, 0)           #: of the body, link axes, of a length of 1e-9 to 1e9
    direction: Numbers = (0, 0, 0)      #: where the axis shall point, world axes, of such a length
    velocity: Numbers = (0,) * 6        #: wanted (omega; v), in the axes of position; of a momentum the momentum
    acceleration: Numbers = (0,) * 6    #: its rate
    loose: Sequence[int] = (0,) * 6     #: 1 where a row, angular x y z or linear x y z, does not count
    q: ArrayLike | None = None          #: "posture": nq
    v: ArrayLike | None = None          #: "posture": nv, wanted velocity; None = 0
    a: ArrayLike | None = None          #: "posture": nv, wanted acceleration; None = 0
    weights: ArrayLike | None = None    #: "posture": nv, each dof's; None = 1, but 0 of passive dofs
    jacobian: ArrayLike | None = None   #: "rows": rows x nv
    y: ArrayLike | None = None          #: "rows": rows; J x = y


@dataclass
class TaskContact(_Declared):
    """A point of a body that touches the ground and is held there: rbd_task_contact of rbd_tasks.h."""
    body: int | str                     #: index, or name of the link
    point: Numbers = (0, 0, 0)          #: of the body, link axes, m
    normal: Numbers = (0, 0, 0)         #: of the ground, world axes, towards the robot; all 0 = z
    friction: float = 0.0               #: mu
    open: bool = False                  #: True: in the air
    sides: int = 4                      #: of the pyramid within the cone of friction, 4 or 8
    least: float = 0.0                  #: N: the normal force is at least that
    most: float = 0.0                   #: N, and at most; 0 = any
    cost: float = 0.0                   #: of each newton squared; 0 = that of the problem
    gain: float = 0.0                   #: 1/s: a velocity of the point decays so fast; 0 = 20


class TasksVelocity(NamedTuple):
    """Velocities that do what tasks ask for."""
    v: Array                #: nv
    status: TasksStatus     #: OK, which is 0, or INEXACT
    level: int              #: of the last quadratic program
    steps: int              #: rows of the quadratic programs that joined or left
    primal: float           #: the largest miss of a row, as a share of its terms, of the levels that count
    dual: float             #: the largest component of the gradient, as a share of its largest term


class TasksAcceleration(NamedTuple):
    """Accelerations, forces and torques that do what tasks ask for."""
    a: Array                #: nv
    forces: Array           #: contacts x 3, on the robot, world axes, N; 0 of open ones
    tau: Array              #: nv, torques of the motors, without damping and friction of the joints
    status: TasksStatus     #: OK, which is 0, or INEXACT
    level: int              #: of the last quadratic program
    steps: int              #: rows of the quadratic programs that joined or left
    primal: float           #: the largest miss of a row, as a share of its terms, of the levels that count
    dual: float             #: the largest component of the gradient, as a share of its largest term


class Tasks(_Declared):
    """A controller of the whole body, rbd_tasks.h: at each tick the velocities, or the accelerations, contact forces and
    torques, that do what tasks ask for as well as contacts, friction and limits allow.

        trunk = rbd.Task("pose", "trunk", position=(0, 0, 0.6), gain=10)
        feet = [rbd.TaskContact(f"{leg}_lowerleg", point=(0.33, 0, 0), friction=0.6) for leg in legs]
        control = rbd.Tasks(model, [trunk, rbd.Task("posture", q=home, gain=10, weight=1e-3)], feet, dt=1e-3)
        tau = control.acceleration(q, v).tau                # at each tick
        trunk.position = (0, 0, 0.5)                        # and as you like between them

        tasks, contacts   lists of Task and TaskContact; change them, and the attributes of these names, between ticks
        dt                s: until the next tick
        lower, upper      nv, rad or m; None: the model's; if one is None, there is none at that side
        speed, torque     nv; 0: none; None: the model's
        acceleration      nv; None: none. Its attribute is `limit`
        braking           rad/s^2 or m/s^2: limits of position and speed ask for no more; 0 = 10
        without           limits that do not count: "position", "speed", "torque"
        limit_weight      0: limits of motion are hard; else soft, of this weight; torque_weight: those of torque
        passive           nv: 1 where no motor is; None: floating joints
        motion_cost       of each component of x squared; 0 = 1e-6, of float 1e-4
        force_cost        of each newton squared; 0 = motion_cost / mass^2
        steps             of each level's quadratic program, at most; 0 = the library's default

    A tick begins with the limits that the last one ended at. It computes in the Model's memory: after it `kinematics`
    must be called anew. docs/tasks.md."""
    model: Model
    tasks: list[Task]
    contacts: list[TaskContact]
    dt: float
    lower: ArrayLike | None
    upper: ArrayLike | None
    speed: ArrayLike | None
    torque: ArrayLike | None
    limit: ArrayLike | None         #: the argument `acceleration`
    braking: float
    without: Iterable[str]
    limit_weight: float
    torque_weight: float
    passive: ArrayLike | None
    motion_cost: float
    force_cost: float
    steps: int

    def __init__(self, model: Model, tasks: Iterable[Task] = (), contacts: Iterable[TaskContact] = (), *,
                 dt: float = 1e-3, lower: ArrayLike | None = None, upper: ArrayLike | None = None,
                 speed: ArrayLike | None = None, torque: ArrayLike | None = None,
                 acceleration: ArrayLike | None = None, braking: float = 0.0, without: Iterable[str] = (),
                 limit_weight: float = 0.0, torque_weight: float = 0.0, passive: ArrayLike | None = None,
                 motion_cost: float = 0.0, force_cost: float = 0.0, steps: int = 0):
        self.model = _model("Tasks", model)
        self.tasks, self.contacts = _wishes(tasks, contacts)
        self.dt, self.lower, self.upper, self.speed, self.torque = dt, lower, upper, speed, torque
        self.limit, self.braking, self.without = acceleration, braking, _without(without)
        self.limit_weight, self.torque_weight, self.passive = limit_weight, torque_weight, passive
        self.motion_cost, self.force_cost, self.steps = motion_cost, force_cost, steps
        self._memory = ctypes.create_string_buffer(0)
        self._warm = ()  # what the memory was for

    def __repr__(self):
        return f"<rbd.Tasks, {len(self.tasks)} tasks, {len(self.contacts)} contacts>"

    def __reduce__(self):
        return _rebuilt, ({name: x for name, x in vars(self).items() if name not in ("_memory", "_warm")},)

    def velocity(self, q: ArrayLike, v: ArrayLike | None = None) -> TasksVelocity:
        """Velocities that do what the tasks ask for at q; v: of the last tick, for limits of acceleration."""
        model, dtype = self.model, self.model.library.dtype
        q = _numbers("Tasks", "q", q, (model.nq,), dtype)
        x = np.zeros(model.nv, dtype) if v is None else _numbers("Tasks", "v", v, (model.nv,), dtype).copy()
        return TasksVelocity(x, *self._run("tasks_velocity", None, [q], [x]))

    def acceleration(self, q: ArrayLike, v: ArrayLike, f_ext: ArrayLike | None = None) -> TasksAcceleration:
        """Accelerations, forces of the contacts and torques that do what the tasks ask for at q and v. f_ext: known
        wrenches, nb x 6."""
        model, dtype = self.model, self.model.library.dtype
        _, contacts = _wishes(self.tasks, self.contacts)
        state = [_numbers("Tasks", "q", q, (model.nq,), dtype), _numbers("Tasks", "v", v, (model.nv,), dtype)]
        f_ext = None if f_ext is None else _numbers("Tasks", "f_ext", f_ext, (model.nb, 6), dtype)
        out = [np.zeros(shape, dtype) for shape in (model.nv, (len(contacts), 3), model.nv)]
        return TasksAcceleration(*out, *self._run("tasks_acceleration", f_ext, state, out))

    def _run(self, call, f_ext, state, out):
        """One tick: fills out; status, level, steps and residuals."""
        library, scalar = self.model.library, self.model.library.scalar
        kept = [f_ext]  # arrays that C reads
        problem = self._problem(kept)
        problem.f_ext = _pointer(f_ext)
        shape = (call, *(task.kind for task in self.tasks), len(self.contacts))
        problem.warm = int(shape == self._warm)
        result = structure("rbd_tasks_result", scalar)()
        with self.model._lock:
            model, work = self.model._address("model"), self.model._address("work")
            size = library.call("tasks_size", model, problem, result=ctypes.c_size_t)
            if size > len(self._memory):
                self._memory = ctypes.create_string_buffer(size)
                problem.warm = 0
            status = library.call(call, model, work, problem, *state, self._memory,
                                  ctypes.c_size_t(len(self._memory)), *out, result)
            text = ctypes.create_string_buffer(200)
            library.call("tasks_text", status, result, text, ctypes.c_size_t(len(text)), result=ctypes.c_void_p)
        self._warm = shape if status >= 0 else ()
        if status < 0:
            error = Status.ERR_INFEASIBLE if status == TasksStatus.INFEASIBLE else Status(result.error)
            raise RbdError(error, f"Tasks: {text.value.decode()}")
        return TasksStatus(status), result.level, result.steps, result.primal, result.dual

    def _problem(self, kept):
        """The C struct of the problem; its arrays stay in `kept`."""
        scalar = self.model.library.scalar
        _wishes(self.tasks, self.contacts)  # they may have changed since the last tick
        task = (structure("rbd_task", scalar) * max(len(self.tasks), 1))()
        contact = (structure("rbd_task_contact", scalar) * max(len(self.contacts), 1))()
        problem = structure("rbd_tasks", scalar)(tasks=len(self.tasks), contacts=len(self.contacts))
        for number, given in enumerate(self.tasks):
            self._put_task(number, given, task[number], kept)
        for number, given in enumerate(self.contacts):
            self._put_contact(number, given, contact[number])
        kept += [task, contact]
        problem.task, problem.contact = ctypes.addressof(task), ctypes.addressof(contact)

        for name in "dt", "braking", "limit_weight", "torque_weight", "motion_cost", "force_cost":
            setattr(problem, name, _number("Tasks", name, getattr(self, name)))
        for name, value in ("lower", self.lower), ("upper", self.upper), ("speed", self.speed), ("torque", self.torque), \
                ("acceleration", self.limit):
            setattr(problem, name, self._keep("Tasks", name, value, (self.model.nv,), kept))
        if self.passive is not None:
            kept.append(_mask("Tasks", "passive", self.passive, self.model.nv))
            problem.passive = _pointer(kept[-1])
        for name in _without(self.without):
            problem.without |= _LIMITS[name]
        problem.steps = _int(_whole("Tasks", "steps", self.steps))
        return problem

    def _keep(self, where, name, value, shape, kept):
        """The address of an array, which stays in `kept`; None of None."""
        if value is None:
            return None
        kept.append(_numbers(where, name, value, shape, self.model.library.dtype))
        return _pointer(kept[-1])

    def _put_task(self, number, given, row, kept):
        """Writes a Task into a C struct."""
        where, dtype = f"Tasks: task {number}", self.model.library.dtype
        kind = row.kind = _enumerator(where, TaskKind, given.kind)
        if row.kind in (TaskKind.COM, TaskKind.MOMENTUM, TaskKind.POSTURE, TaskKind.ROWS):
            _left_out(where, given, "body", 0)
        else:
            row.body = self.model._body(given.body, f"{where}, field 'body'", None)
        if row.kind != TaskKind.RELATIVE:
            _left_out(where, given, "reference", -1)
            row.reference = -1
        else:
            row.reference = self.model._body(given.reference, f"{where}, field 'reference'", None, world=True)
        row.level = _int(_whole(where, "level", given.level))
        for field in "weight", "gain", "damping":
            setattr(row, field, _number(where, field, getattr(given, field)))
        for field in "point", "position", "axis", "direction", "velocity", "acceleration":
            length = 6 if field in ("velocity", "acceleration") else 3
            numbers = _numbers(where, field, getattr(given, field), (length,), dtype)
            getattr(row, field)[:] = _placed(where, kind, field, numbers)
        turn = _numbers(where, "rotation", _array(where, "rotation", given.rotation).reshape(-1), (9,), dtype)
        row.rotation[:] = _placed(where, kind, "rotation", turn)
        row.loose[:] = _mask(where, "loose", given.loose, 6, "row").tolist()
        for field in "q", "v", "a", "weights":
            if row.kind != TaskKind.POSTURE:
                _left_out(where, given, field, None)
            length = self.model.nq if field == "q" else self.model.nv
            setattr(row, field, self._keep(where, field, getattr(given, field), (length,), kept))
        if row.kind != TaskKind.ROWS:
            _left_out(where, given, "jacobian", None)
            _left_out(where, given, "y", None)
        else:
            row.jacobian = self._keep(where, "jacobian", given.jacobian, (None, self.model.nv), kept)
            if given.jacobian is None and given.y is not None:
                raise TypeError(f"{where}, field 'jacobian': missing")
            row.rows = len(kept[-1]) if row.jacobian else 0
            row.y = self._keep(where, "y", given.y, (row.rows,), kept)

    def _put_contact(self, number, given, row):
        """Writes a TaskContact into a C struct."""
        where = f"Tasks: contact {number}"
        row.body = self.model._body(given.body, f"{where}, field 'body'", None)
        row.open = _flag(where, "open", given.open)
        row.sides = _int(_whole(where, "sides", given.sides))
        for field in "point", "normal":
            getattr(row, field)[:] = _numbers(where, field, getattr(given, field), (3,), self.model.library.dtype)
        for field in "friction", "least", "most", "cost", "gain":
            setattr(row, field, _number(where, field, getattr(given, field)))


def _wishes(tasks, contacts):
    """The lists of tasks and of contacts, checked."""
    return _list("Tasks", "tasks", tasks, Task), _list("Tasks", "contacts", contacts, TaskContact)


def _without(names):
    """The names of the limits that do not count, checked."""
    if not _is_list(names):
        raise TypeError(f"Tasks: without must be a list of names, such as ['torque'], not {names!r:.60}")
    names = list(names)
    for name in names:
        if not isinstance(name, str) or name not in _LIMITS:
            raise ValueError(f"Tasks: without must be of 'position', 'speed' and 'torque', not {name!r:.60}")
    return names


def _rebuilt(attributes):
    """A copy of a Tasks, which begins cold."""
    tasks = Tasks(attributes["model"])
    vars(tasks).update(attributes)
    return tasks


def _pointer(array):
    """The address of an array's numbers; None of None."""
    return None if array is None else array.ctypes.data
