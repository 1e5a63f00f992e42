# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
# Made by stubs.py from __init__.py: do not edit.
import ctypes
import os
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, Iterable, Literal, Mapping, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
Numbers = Union[Sequence[float], Array]
Matrix = Sequence[Sequence[float]]
_MaybeNone = Any  # None where a keyword leaves the result out

__all__ = [
    "AxisAngle",
    "Body",
    "Constraint",
    "ConstraintSet",
    "Contact",
    "ContactOptions",
    "ContactResult",
    "ContactSet",
    "ContactSolution",
    "ContactState",
    "Frame",
    "JointInfo",
    "JointType",
    "Library",
    "Model",
    "Placement",
    "RbdError",
    "RbdWarning",
    "SOURCES",
    "Spatial",
    "Status",
    "Urdf",
    "UrdfStatus",
    "load_table",
    "load_urdf",
    "parse_urdf",
]
__version__: str


class AxisAngle(NamedTuple):
    """A rotation about an axis."""
    axis: Array         #: 3, of unit length
    angle: float        #: rad


@dataclass
class Body:
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
class Constraint:
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


class ConstraintSet:
    """Contacts and closed loops that hold together, rbd_constraint_set of a Model; made by
    Model.constraint_set(rows).

    They compute in the Model's memory: after a call `kinematics` must be called anew."""
    model: Model
    list: Sequence[Constraint]
    rows: int                   #: the number of axes that all constraints hold
    nv: int                     #: number of degrees of freedom
    library: Library

    def __init__(self, model: Model, rows: Iterable[Constraint]) -> None:
        ...

    def first(self, constraint: int) -> int:
        """The first row of a constraint, -1 if there is none (rbd_constraint_first)."""

    def rank(self) -> int:
        """After constrained_fd and impact: the rank of J (rbd_constraint_rank)."""

    def infeasible_row(self) -> int:
        """After Status.ERR_INFEASIBLE: the first row that contradicts those behind it, else -1."""

    def constraint_jacobian(self, q: ArrayLike, v: ArrayLike | None = None, *, J: bool = True,
                            gamma: bool = True, e: bool = True) -> constraint_jacobian_results:
        """Jacobian J of the constraints, row: constraint; dJ/dt v; and the position error. v: None = zero.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            J            rows x nv row: (omega; v); column: degree of freedom
            gamma        rows      dJ/dt v
            e            rows      position error: rad, m
        Axes before these count states, and are broadcast: one call of C for each state."""

    def constrained_fd(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike,
                       f_ext: ArrayLike | None = None) -> constrained_fd_results:
        """Accelerations and constraint forces: M a + c = tau + sum J_b' f_ext + J' lambda and J a + gamma =
        -kd J v - kp e. Of dependent rows lambda is the solution of least norm. RBDA section 8.4.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            lambda_      rows      (moment about frame 1's origin; force) of body 2 on body 1, axes of frame 2: N m, N
        Axes before these count states, and are broadcast: C computes them together."""

    def impact(self, q: ArrayLike, v: ArrayLike, restitution: ArrayLike = 0.0) -> impact_results:
        """Velocity after an impact: M (v_plus - v) = J' impulse, J v_plus = -restitution J v. RBDA section
        11.7.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            restitution            0 (nothing rebounds) to 1
        gives
            v_plus       nv        velocity after the impact
            impulse      rows      the same of an impact: N m s, N s
        Axes before these count states, and are broadcast: one call of C for each state."""

    def constrained_id(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, f_ext: ArrayLike | None = None,
                       actuated: ArrayLike | None = None,
                       weight: ArrayLike | None = None) -> constrained_id_results:
        """Inverse dynamics with contacts, where only some joints have motors: of all lambda that leave tau =
        0 at the others, that with the least sum of weight lambda^2; else what comes nearest. Mistry, Buchli
        and Schaal (2010).

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
            actuated     nv        1 where there is a motor, else 0; None = all but floating joints at the root
            weight       rows      from 0; None = 1
        gives
            tau          nv        torque or force of each degree of freedom: N m, N
            lambda_      rows      (moment about frame 1's origin; force) of body 2 on body 1, axes of frame 2: N m, N
        Axes before these count states, and are broadcast: one call of C for each state."""

    def assemble(self, q: ArrayLike, v: ArrayLike | None = None,
                 weight: ArrayLike | None = None) -> assemble_results:
        """Closes loops, or puts feet in their places: q_near with e = 0 nearest to q, in the sum of weight
        d^2, d = difference(q, q_near); and, unless v is None, v_near with J v_near = 0 there nearest to v.
        Newton's method.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            weight       nv        from 0; None = 1
        gives
            q_near       nq        configuration
            v_near       nv        velocity
        Axes before these count states, and are broadcast: one call of C for each state."""

    def constrained_fd_derivatives(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike,
                                   f_ext: ArrayLike | None = None, *, dq: bool = True, dv: bool = True,
                                   dtau: bool = True) -> constrained_fd_derivatives_results:
        """Derivatives of constrained_fd by q, v and tau; by those for which the keyword is True. Carpentier,
        Budhiraja and Mansard (2021).

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            lambda_      rows      (moment about frame 1's origin; force) of body 2 on body 1, axes of frame 2: N m, N
            da_dq        nv x nv   row: acceleration; column: tangent step of q
            da_dv        nv x nv   row: acceleration; column: velocity
            da_dtau      nv x nv   row: acceleration; column: torque
            dlambda_dq   rows x nv row: constraint force; column: tangent step of q
            dlambda_dv   rows x nv row: constraint force; column: velocity
            dlambda_dtau rows x nv row: constraint force; column: torque
        Axes before these count states, and are broadcast: one call of C for each state."""


@dataclass
class Contact:
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
    damping: float = 0.0                #: N s/m: p/dt = -(stiffness gap + damping d gap/dt)

    @property
    def on_body(self) -> bool:
        """Whether the plane is a body's: body2 of C is left out as 0, here as -1."""
        return self.body2 != -1


@dataclass
class ContactOptions:
    """rbd_contact_options of rbd_contact.h; 0 is the default in brackets."""
    margin: float = 0.0         #: closer contacts are rows, m [0.005]
    slop: float = 0.0           #: penetration that is left, m [1e-5]
    correction: float = 0.0     #: share of the rest that a step takes back [0.2]
    bounce: float = 0.0         #: slower impacts do not rebound, m/s [0.05]; choose more than 2 g dt
    tolerance: float = 0.0      #: of the residual, m/s [1e-6, float 1e-5]
    iterations: int = 0         #: at most [40]
    joint_limits: bool = False      #: limits of joints push
    joint_friction: bool = False    #: the description's friction holds, or brakes
    joint_damping: bool = False     #: the description's damping, implicitly
    slip: float = 0.0           #: contacts that stick give way along the plane, m/s per newton [0]
    derivatives: bool = False       #: memory for step_derivatives
    first_order: bool = False       #: semi-implicit Euler: q_next is q moved by v_next, for planners


class ContactResult(NamedTuple):
    """What a contact did in the last step."""
    state: ContactState     #: APART, OPENS, STICKS or SLIPS
    gap: float              #: before the step, m
    force: Array            #: 3, on body 1, world axes, N


class ContactSet:
    """Contacts that push only, slip and open, rbd_contact_set of a Model; made by Model.contacts(rows):

        feet = model.contacts([rbd.Contact("left", "l_foot", friction=0.7), ...])
        q, v = feet.step(q, v, tau, dt=1e-3)

    docs/contact_step.md says what it promises. The set keeps the impulses of the last step, with which the
    next one begins; a copied or pickled set has its planes, and begins as after `reset`. It computes in the
    Model's memory: after a call `kinematics` must be called anew."""
    model: Model
    list: Sequence[Contact]
    held: Sequence[Constraint]
    options: ContactOptions
    nv: int                     #: number of degrees of freedom
    library: Library

    def __init__(self, model: Model, rows: Iterable[Contact], held: Iterable[Constraint] = (),
                 options: ContactOptions | None = None) -> None:
        ...

    def step(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, dt: ArrayLike, f_ext: ArrayLike | None = None,
             damping: ArrayLike | None = None) -> contact_step_results:
        """A time step with contacts: q and v after dt. States and forces: get, forces; how well it is solved:
        last. Of many states each begins with the impulses of the one before.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            dt                     s
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
            damping      nv        implicit: tau acts as tau - damping v_next; of a controller kd + dt kp / 2; None = 0
        gives
            q_next       nq        configuration
            v_next       nv        velocity
        Axes before these count states, and are broadcast: one call of C for each state."""

    def fd(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, dt: ArrayLike, f_ext: ArrayLike | None = None,
           damping: ArrayLike | None = None) -> Array:
        """The step's acceleration alone: Model.step with it gives the step's v_next, and q_next where nothing
        penetrates.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            dt                     s
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
            damping      nv        implicit: tau acts as tau - damping v_next; of a controller kd + dt kp / 2; None = 0
        gives
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
        Axes before these count states, and are broadcast: one call of C for each state."""

    def step_derivatives(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, dt: ArrayLike,
                         f_ext: ArrayLike | None = None, damping: ArrayLike | None = None, *,
                         dq: bool = True, dv: bool = True,
                         dtau: bool = True) -> contact_step_derivatives_results:
        """The step, and its derivatives by q, v and tau, while no contact changes its state; by those for which
        the keyword is True. Needs ContactOptions(derivatives=True).

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            dt                     s
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
            damping      nv        implicit: tau acts as tau - damping v_next; of a controller kd + dt kp / 2; None = 0
        gives
            q_next       nq        configuration
            v_next       nv        velocity
            dq_next_dq   nv x nv   row: tangent step of q_next; column: of q
            dq_next_dv   nv x nv   row: tangent step of q_next; column: velocity
            dq_next_dtau nv x nv   row: tangent step of q_next; column: torque
            dv_next_dq   nv x nv   row: v_next; column: tangent step of q
            dv_next_dv   nv x nv   row: v_next; column: velocity
            dv_next_dtau nv x nv   row: v_next; column: torque
        Axes before these count states, and are broadcast: one call of C for each state."""

    def plane(self, contact: int | str, normal: ArrayLike = (0, 0, 1), height: float = 0.0) -> None:
        """Another plane under a contact from the next step on: the tangent plane of terrain.

        contact   index, or name
        normal    3, axes of body 2, towards body 1
        height    along the unit normal, m"""

    def reset(self) -> None:
        """Forgets the last impulses, with which a step begins: after a jump of the state."""

    def get(self, contact: int | str) -> ContactResult:
        """What a contact, index or name, did in the last step."""

    def forces(self) -> Array:
        """Forces of all contacts in the last step: one row each, world axes, N."""

    def last(self) -> ContactSolution:
        """Residual and iterations of the last step; a residual above options.tolerance is not solved."""


class ContactSolution(NamedTuple):
    """How well and how fast contacts were solved."""
    residual: float         #: m/s: 0 where all laws hold
    sweeps: int             #: Gauss-Seidel's
    newton_steps: int


class ContactState(IntEnum):
    APART = 0
    OPENS = 1
    STICKS = 2
    SLIPS = 3


class Frame(NamedTuple):
    """A link of a URDF: its place on the bodies, as rbd_urdf_frame."""
    link: str
    joint: str | None   #: that carries the link; None for the root
    parent: int         #: index of the frame that carries it, -1 = it is the root
    body: int           #: index of the body that it is, or is merged into, -1 = the world
    position: Array     #: 3, in that body's frame, m
    rotation: Array     #: 3 x 3, turns vectors of the link into vectors of that body


class JointInfo(NamedTuple):
    """A joint: its type, place in q and in v, and limits.

    A mimic or fixed joint has nq = nv = 0 and iq = iv = -1. No limits if lower >= upper."""
    type: JointType
    iq: int
    nq: int
    iv: int
    nv: int
    lower: float
    upper: float
    velocity: float
    effort: float


class JointType(IntEnum):
    FIXED = 0
    REVOLUTE = 1
    CONTINUOUS = 2
    CONTINUOUS_CS = 3
    PRISMATIC = 4
    HELICAL = 5
    CYLINDRICAL = 6
    UNIVERSAL = 7
    SPHERICAL = 8
    EULER_ZYX = 9
    EULER_XYZ = 10
    EULER_YXZ = 11
    EULER_ZXY = 12
    PLANAR = 13
    TRANSLATION = 14
    FLOATING = 15
    JOINT_TYPES = 16


class Library:
    """rbd.h and its companions, compiled for one scalar.

    real      "double" or "float": the scalar of states, results and models
    flags     of the compiler; None = $RBD_FLAGS, else -O3 -march=native -ffp-contract=fast
    lanes     states per SIMD instruction in batches, a power of two; None = as many as the machine has
    compiler  the C compiler; None = $CC, else cc"""
    real: str                #: "double" or "float"
    scalar: type[Any]        #: the ctypes type of it
    dtype: np.dtype[Any]     #: the numpy type of it: of all results
    lanes: int               #: states per SIMD instruction in batches
    spatial: Spatial         #: the calls of rbd_spatial.h

    def __init__(self, real: str = 'double', flags: str | None = None, lanes: int | None = None,
                 compiler: str | None = None) -> None:
        ...

    def function(self, name: str, result: Any = ..., arguments: Any = None) -> Any:
        """A C function by its name without `rbd_`: an object of its own, as threads may set its types."""

    def call(self, name: str, *arguments: Any, result: Any = ...) -> Any:
        """Calls C: arrays and structures go as pointers, whole numbers as int."""

    def status_string(self, status: int) -> str:
        """The library's sentence for a Status."""

    def finding_text(self, finding: ctypes.Structure, function: str = 'finding_text') -> str:
        """The library's sentence for a rbd_finding: it names body (or constraint) and field. finding: the
        ctypes structure; function: "finding_text", or "constraint_finding_text" of a set's."""

    def check_parameters(self, pi: ArrayLike) -> None:
        """Raises RbdError if no body can have these ten inertial parameters: negative mass, a centre of mass
        without mass, or an inertia that no distribution of mass has. pi: 10, as of Model.body_parameters."""

    def set_parameters(self, body: Body, pi: ArrayLike) -> Body:
        """A copy of a Body with the mass, com and inertia of these ten inertial parameters."""

    def contact_solve(self, delta: ArrayLike, b: ArrayLike, friction: ArrayLike, lower: ArrayLike = (),
                      upper: ArrayLike = (), start: ArrayLike | None = None, tolerance: float = 0.0,
                      iterations: int = 0) -> tuple[Array, Sequence[ContactState], ContactSolution]:
        """Impulses p of contacts from u = delta p + b, for those who have a delta: rbd_contact_solve. Gives p,
        the contacts' states, and how well it is solved. Rows: three of each contact in the order tangent,
        tangent, normal, then the bounded ones.

            delta       rows x rows: J M^-1 J', symmetric and positive semidefinite, 1/kg
            b           rows: u where p = 0, m/s
            friction    contacts: mu
            lower       bounded rows: lower <= p <= upper, N s; +-1e30 = no bound
            upper       bounded rows
            start       rows: where to begin; None = 0
            tolerance   of the residual, m/s; 0 = 1e-6, of float 1e-5
            iterations  at most; 0 = 40"""


class Model:
    """A robot: constants, and the memory that one thread computes in.

    bodies   list of Body, parents first; or the result of load_urdf, whose gravity it takes
    gravity  3, world frame, m/s^2; None = (0, 0, -9.81)
    library  a Library; None = double, compiled for this machine

    If a body cannot be real, but can be computed with, an RbdWarning says so; `warnings` keeps the sentences.
    Of a URDF these are those of the loader, which sees the single links and their lines."""
    library: Library
    bodies: list[Body]
    warnings: list[str]     #: sentences
    nb: int                 #: number of bodies
    nq: int                 #: number of coordinates: the length of q
    nv: int                 #: number of degrees of freedom: the length of v

    def __init__(self, bodies: Urdf | Iterable[Body], *, gravity: ArrayLike | None = None,
                 library: Library | None = None) -> None:
        ...

    @classmethod
    def from_urdf(cls, path: str | os.PathLike[str], *, floating: bool = False, root: str | None = None,
                  root_joint: str | None = None, gravity: ArrayLike | None = None,
                  keep: str | Iterable[str] = (), keep_all: bool = False,
                  lock: str | Iterable[str] | Mapping[str, float] = (), lock_massless: bool = False,
                  strict: bool = False, messages: bool = False, library: Library | None = None) -> Model:
        """A model of a URDF file.

        The options are those of the command-line tools (rbd-model --help).

        floating       the root link is on a floating joint, not fixed to the world
        root           take only this link, as the root, and its subtree; None = all
        root_joint     the name of the floating joint; None = "root"
        gravity        3, world frame, m/s^2; None = (0, 0, -9.81)
        keep           links on fixed joints to keep as bodies; others are merged: a name or several
        keep_all       keep all links on fixed joints
        lock           joints to hold still, and those that mimic them: {joint: value, rad or m}, or names (at 0)
        lock_massless  hold joints still that move no mass, which else are an error
        strict         warnings are errors
        messages       let urdfdom write its messages to standard error"""

    def copy(self) -> Model:
        """Another Model of the same robot, with memory of its own: for another thread."""

    def batch_set_layout(self, layout: Literal['rows', 'blocks']) -> None:
        """Sets how the states of a batch stand in arrays, for the calls that C computes together: "rows", as
        in numpy, or "blocks" of as many states as the library has lanes, which stand along a last axis: q (n,
        nq, lanes), M (n, nv, nv, lanes). C need not transpose blocks. See rbd_layout."""

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Sets gravity, 3 components in the world frame, m/s^2, for the calls that follow."""

    def get_gravity(self) -> Array:
        """Gravity as it is set: 3, world frame, m/s^2."""

    def add_payload(self, body: int | str, mass: float, com: ArrayLike = (0, 0, 0),
                    inertia: ArrayLike | None = None) -> None:
        """Adds mass to a body, as a load that a hand took up. The same call with mass and inertia negated
        takes it off again, to rounding.

            body      index, or name of the link
            mass      kg, may be negative
            com       3, of the payload, link frame, m
            inertia   xx xy xz yy yz zz about its com, link axes, kg m^2; None = a point"""

    def lock_joints(self, joints: int | str | Iterable[int | str], q: ArrayLike) -> Model:
        """Another Model of the robot, in which these joints are fixed at their pose in q, and with them those that
        mimic them. All bodies stay. q and v of the new model are those of the joints that still move, in the same
        order: see `q_names`.

            joints    names of joints, or the bodies that they carry: indices, or names of links
            q         nq, of this model"""

    def singular_dof(self) -> int:
        """After Status.ERR_SINGULAR or ERR_NAN: the degree of freedom whose pivot is not above its rounding,
        or not a number; else -1."""

    def batch_singular(self) -> tuple[int, int]:
        """After that error of a batch: (the first singular state, its degree of freedom); else (-1, -1)."""

    def rnea(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, f_ext: ArrayLike | None = None) -> Array:
        """Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext. Recursive Newton-Euler, RBDA table 5.1.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            tau          nv        torque or force of each degree of freedom: N m, N
        Axes before these count states, and are broadcast: C computes them together."""

    def bias(self, q: ArrayLike, v: ArrayLike, f_ext: ArrayLike | None = None) -> Array:
        """Bias force c, the part of inverse dynamics that does not depend on a: velocity terms, gravity, minus
        external wrenches.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            c            nv        bias force: N m, N
        Axes before these count states, and are broadcast: C computes them together."""

    def gravity_torque(self, q: ArrayLike) -> Array:
        """Gravity torque g, which holds the robot still: inverse dynamics at v = a = 0, without f_ext.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        gives
            g            nv        gravity torque: N m, N
        Axes before these count states, and are broadcast: one call of C for each state."""

    def generalized_momentum(self, q: ArrayLike, v: ArrayLike, *, p: bool = True,
                             ctv: bool = True) -> generalized_momentum_results:
        """Generalized momentum p = M v and C' v, for a momentum observer: dp/dt = tau + C' v - g + sum J'
        f_ext.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            p            nv        generalized momentum M v
            ctv          nv        C' v
        Axes before these count states, and are broadcast: one call of C for each state."""

    def crba(self, q: ArrayLike) -> Array:
        """Mass matrix, both triangles. Composite rigid bodies, RBDA table 6.2.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        gives
            M            nv x nv   mass matrix: kg m^2, kg m, kg
        Axes before these count states, and are broadcast: C computes them together."""

    def crba_packed(self, q: ArrayLike) -> Array:
        """Mass matrix packed: of the lower triangle what the tree fills, row after row; see packed_index.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        gives
            H            nh        mass matrix, packed (packed_size, packed_index)
        Axes before these count states, and are broadcast: C computes them together."""

    def aba(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, f_ext: ArrayLike | None = None) -> Array:
        """Forward dynamics a = M^-1 (tau - c + sum J' f_ext). Articulated bodies, RBDA table 7.1.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
        Axes before these count states, and are broadcast: C computes them together."""

    def fd_cholesky(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike,
                    f_ext: ArrayLike | None = None) -> Array:
        """Forward dynamics by mass matrix, bias and branch-sparse L'DL, RBDA ch. 6.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
        Axes before these count states, and are broadcast: C computes them together."""

    def hybrid(self, q: ArrayLike, v: ArrayLike, given: ArrayLike, a: ArrayLike, tau: ArrayLike,
               f_ext: ArrayLike | None = None) -> hybrid_results:
        """Hybrid dynamics: the acceleration or the torque of each degree of freedom is given, and the other
        is computed; M a + c = tau + sum J' f_ext. RBDA section 9.2. Gives (a, tau), all of both.

            q            nq        configuration
            v            nv        velocity
            given        nv        1 where the acceleration is given, 0 where the torque is
            a            nv        accelerations, read where they are given
            tau          nv        torques, read where they are given
            f_ext        nb x 6    wrenches on the bodies; None = none

        Axes before these count states, and are broadcast: one call of C for each state."""

    def minverse(self, q: ArrayLike) -> Array:
        """Inverse of the mass matrix, both triangles.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        gives
            Minv         nv x nv   inverse of the mass matrix
        Axes before these count states, and are broadcast: C computes them together."""

    def cholesky_factor(self, M: ArrayLike) -> Array:
        """Factor of M = L' D L that keeps the tree's zeros, RBDA section 6.5: packed like crba_packed, L
        below the diagonal, 1/D on it. Only the lower triangle of M is read.

            M            nv x nv   mass matrix: kg m^2, kg m, kg
        gives
            L            nh        factor of the mass matrix, packed
        Axes before these count states, and are broadcast: one call of C for each state."""

    def cholesky_factor_packed(self, H: ArrayLike) -> Array:
        """The same of a packed mass matrix (crba_packed): a new packed array."""

    def cholesky_solve(self, L: ArrayLike, b: ArrayLike) -> Array:
        """Solves M x = b with the factor L. Right-hand sides as columns: cholesky_solve_many.

            L            nh        factor of the mass matrix, packed
            b            nv        right-hand side
        gives
            x            nv        solution
        Axes before these count states, and are broadcast: one call of C for each state."""

    def cholesky_solve_many(self, L: ArrayLike, B: ArrayLike) -> Array:
        """Solves M X = B with the factor L. B: nv x n, right-hand sides as columns; gives X, nv x n."""

    def packed_size(self) -> int:
        """Number of entries of a packed matrix."""

    def packed_index(self, i: int, j: int) -> int:
        """Where entry (i, j) lies in a packed matrix; -1 if the tree makes it zero."""

    def passive(self, v: ArrayLike) -> Array:
        """Passive torque of the joints, -damping v - friction sign(v): add it to the tau given to forward
        dynamics, subtract it from the tau that inverse dynamics gives.

            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            tau          nv        torque or force of each degree of freedom: N m, N
        Axes before these count states, and are broadcast: one call of C for each state."""

    def kinematics(self, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None) -> None:
        """Computes poses, velocities and accelerations of all bodies; the calls below read them. None =
        zero.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2"""

    def body_kinematics(self, body: int | str, q: ArrayLike, v: ArrayLike | None = None,
                        a: ArrayLike | None = None) -> None:
        """Computes pose, velocity and acceleration of one body and its ancestors, in less time than `kinematics`.
        The calls below then know these bodies only.

            body                   index, or name of the link
            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2"""

    def body_pose(self, body: int | str) -> body_pose_results:
        """Pose of a body after `kinematics`: R, and p, the link's origin in the world, m.

            body                   index, or name of the link
        gives
            R            3 x 3     turns link vectors into world vectors
            p            3         generalized momentum M v"""

    def body_velocity(self, body: int | str) -> Array:
        """Spatial velocity (omega; v of the link's origin) of a body, link axes.

            body                   index, or name of the link
        gives
            velocity     6         (omega; v): rad/s, m/s"""

    def body_acceleration(self, body: int | str) -> Array:
        """Spatial acceleration of a body, link axes, without gravity: d/dt of the components of the
        velocity.

            body                   index, or name of the link
        gives
            acceleration 6         (angular; linear): rad/s^2, m/s^2"""

    def body_acceleration_classical(self, body: int | str) -> Array:
        """Classical acceleration (domega/dt; of the link's origin), link axes, without gravity.

            body                   index, or name of the link
        gives
            acceleration 6         (angular; linear): rad/s^2, m/s^2"""

    def energy(self) -> energy_results:
        """Energies of all bodies that a joint moves, after `kinematics`.

        gives
            kinetic                J, the rotors' included
            potential              J, zero at the world's origin"""

    def com(self) -> com_results:
        """Centre of mass of those bodies, its velocity and acceleration, world frame, after `kinematics`.

        gives
            position     3         world frame: m
            velocity     3         (omega; v): rad/s, m/s
            acceleration 3         (angular; linear): rad/s^2, m/s^2"""

    def mass(self) -> float:
        """Mass of all bodies that a joint moves, kg."""

    def joint_wrench(self, q: ArrayLike, v: ArrayLike, a: ArrayLike,
                     f_ext: ArrayLike | None = None) -> Array:
        """The wrench that each body's joint transmits, fixed joints too: what loads gears and bearings. Calls
        `kinematics`.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            wrench       nb x 6    wrench (moment; force) on each body from its joint, in its axes, at its origin: N m, N
        Axes before these count states, and are broadcast: one call of C for each state."""

    def jacobian(self, body: int | str, point: ArrayLike | None = None,
                 axes: Literal["world", "link"] = 'world') -> Array:
        """Jacobian of a point of a body, after `kinematics`: (omega; velocity of the point) = J v.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            axes                   "world" or "link": the axes of the six components
        gives
            J            6 x nv    row: (omega; v); column: degree of freedom
        Axes before these count states, and are broadcast: one call of C for each state."""

    def relative_jacobian(self, body: int | str, point: ArrayLike | None = None, reference: int | str = -1,
                          axes: Literal["world", "link"] = 'world') -> Array:
        """Jacobian of a point of a body as seen from another body. "link" axes are the reference's.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            reference              index, or name of the link; -1 = the world
            axes                   "world" or "link": the axes of the six components
        gives
            J            6 x nv    row: (omega; v); column: degree of freedom
        Axes before these count states, and are broadcast: one call of C for each state."""

    def jacobian_transpose(self, body: int | str, point: ArrayLike | None, axes: Literal["world", "link"],
                           f: ArrayLike) -> Array:
        """tau = J' f for a wrench at a point; J is never formed. point may be None.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            axes                   "world" or "link": the axes of the six components
            f            6         wrench (moment about the point; force): N m, N
        gives
            tau          nv        torque or force of each degree of freedom: N m, N
        Axes before these count states, and are broadcast: one call of C for each state."""

    def point_position(self, body: int | str, point: ArrayLike | None = None) -> Array:
        """Position of a point of a body in the world.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
        gives
            position     3         world frame: m
        Axes before these count states, and are broadcast: one call of C for each state."""

    def point_velocity(self, body: int | str, point: ArrayLike | None = None,
                       axes: Literal["world", "link"] = 'world') -> Array:
        """Motion of a point: (omega of the body; velocity of the point).

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            axes                   "world" or "link": the axes of the six components
        gives
            velocity     6         (omega; v): rad/s, m/s
        Axes before these count states, and are broadcast: one call of C for each state."""

    def point_acceleration(self, body: int | str, point: ArrayLike | None = None,
                           axes: Literal["world", "link"] = 'world') -> Array:
        """(domega/dt; classical acceleration of the point), without gravity: J a + dJ/dt v.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            axes                   "world" or "link": the axes of the six components
        gives
            acceleration 6         (angular; linear): rad/s^2, m/s^2
        Axes before these count states, and are broadcast: one call of C for each state."""

    def point_wrench(self, body: int | str, point: ArrayLike | None, axes: Literal["world", "link"],
                     f: ArrayLike) -> Array:
        """A wrench at a point as the body's row of f_ext; rows of several points add up. point may be
        None.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            axes                   "world" or "link": the axes of the six components
            f            6         wrench (moment about the point; force): N m, N
        gives
            row          6         the wrench at the body's origin, in its axes: its row of f_ext
        Axes before these count states, and are broadcast: one call of C for each state."""

    def momentum(self) -> momentum_results:
        """Centroidal momentum of all bodies that a joint moves, and its rate.

        gives
            h            6         momentum (angular about the centre of mass; linear), world axes
            h_dot        6         its rate: N m, N"""

    def batch_jacobian(self, q: ArrayLike, body: int | str, point: ArrayLike | None = None,
                       axes: Literal['world', 'link'] = 'world') -> Array:
        """Jacobians (..., 6, nv) of a point of a body at configurations q (..., nq); point and axes as of
        `jacobian`. It needs no `kinematics`."""

    def batch_momentum(self, q: ArrayLike, v: ArrayLike | None = None,
                       a: ArrayLike | None = None) -> batch_momentum_results:
        """Centroidal momenta h and their rates h_dot, (..., 6) each, of states q (..., nq), v and a (...,
        nv). None = zero. It needs no `kinematics`."""

    def neutral(self) -> Array:
        """The neutral configuration: zeros, identity quaternions, (cos, sin) = (1, 0).

        gives
            q            nq        configuration: rad, m, quaternions (x, y, z, w)"""

    def integrate(self, q: ArrayLike, v: ArrayLike, dt: ArrayLike) -> Array:
        """q moved by the tangent step v dt: exponentials in body axes for spherical, planar and floating
        joints, addition for the others.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            dt                     s
        gives
            q_next       nq        configuration
        Axes before these count states, and are broadcast: one call of C for each state."""

    def free_step(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, dt: ArrayLike,
                  f_ext: ArrayLike | None = None, damping: ArrayLike | None = None) -> free_step_results:
        """A step of second order from torques, without contacts, which keeps the energy of what turns.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            dt                     s
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
            damping      nv        implicit: tau acts as tau - damping v_next; of a controller kd + dt kp / 2; None = 0
        gives
            q_next       nq        configuration
            v_next       nv        velocity
        Axes before these count states, and are broadcast: one call of C for each state."""

    def step(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, dt: ArrayLike) -> step_results:
        """One step of semi-implicit Euler from the accelerations a of forward dynamics: v + dt a, then q moved by
        it, in the axes of the step's beginning. A body on which no force acts keeps its momentum.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            dt                     s
        gives
            q_next       nq        configuration
            v_next       nv        velocity
        Axes before these count states, and are broadcast: one call of C for each state."""

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Array:
        """The tangent step d for which integrate(q0, d, 1) is q1, the shortest rotation.

            q0           nq        configuration
            q1           nq        configuration
        gives
            d            nv        tangent step: rad, m
        Axes before these count states, and are broadcast: one call of C for each state."""

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, s: ArrayLike) -> Array:
        """The part s of the way from q0 to q1, integrate(q0, difference(q0, q1), s): q0 at 0, q1 at 1.

            q0           nq        configuration
            q1           nq        configuration
            s                      part of the way: 0 is q0, 1 is q1
        gives
            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        Axes before these count states, and are broadcast: one call of C for each state."""

    def distance(self, q0: ArrayLike, q1: ArrayLike, weight: ArrayLike | None = None) -> float:
        """The square root of the sum of weight d^2, d = difference(q0, q1). With None a metre counts as much as a
        radian.

            q0           nq        configuration
            q1           nq        configuration
            weight       nv        from 0; None = 1
        gives
            distance               rad, if lengths have weights of 1 / length^2 or 0
        Axes before these count states, and are broadcast: one call of C for each state."""

    def rates_from_velocity(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Rates dq/dt of the coordinates from the velocity, for filters and ODE solvers.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            rates        nq        dq/dt, of quaternions and (cos, sin) too
        Axes before these count states, and are broadcast: one call of C for each state."""

    def velocity_from_rates(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """The velocity from such rates.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            rates        nq        dq/dt, of quaternions and (cos, sin) too
        gives
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        Axes before these count states, and are broadcast: one call of C for each state."""

    def random(self, seed: int, n: int | None = None) -> Array:
        """A random configuration, nq, or n of them, n x nq: uniform within limits where given, else angles in
        (-pi, pi), lengths in (-1, 1), orientations uniform. The same seed, a whole number, gives the same."""

    def body_index(self, name: str) -> int:
        """Index of a body by the name of its link; KeyError if there is none."""

    def joint_index(self, name: str) -> int:
        """Index of a body by the name of the joint that carries it; KeyError if there is none."""

    def body_name(self, body: int) -> str | None:
        """Name of a body's link; None if nameless or no such body."""

    def joint_name(self, body: int) -> str | None:
        """Name of the joint that carries a body; None if nameless or no such body."""

    @property
    def body_names(self) -> list[str | None]:
        """Names of all links, by body."""

    @property
    def joint_names(self) -> list[str | None]:
        """Names of all joints, by body."""

    @property
    def dof_names(self) -> list[str]:
        """Names of the degrees of freedom: the joint's, with [k] where it has several."""

    @property
    def q_names(self) -> list[str]:
        """Names of the coordinates, likewise."""

    def joint(self, joint: int | str) -> JointInfo:
        """JointInfo: type, place in q and v, and limits of a joint.

        joint        the name of the joint, or the body that it carries: index, or name of the link"""

    def dof_body(self, dof: int) -> int:
        """The body whose joint has this degree of freedom, -1 if there is none."""

    def describe(self, body: int | str) -> Body:
        """A Body read back from the model, from which a build makes the same, to rounding: its parent is the
        body whose joint carries it, axes are of unit length, an added payload is in it."""

    def momentum_matrix(self, q: ArrayLike, v: ArrayLike | None = None) -> momentum_matrix_results:
        """Centroidal momentum matrix A, A v = (angular momentum about the centre of mass; linear momentum),
        world axes; and dA/dt v unless v is None.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            A            6 x nv    centroidal momentum matrix
            A_dot_v      6         dA/dt v
        Axes before these count states, and are broadcast: C computes them together."""

    def com_jacobian(self, q: ArrayLike) -> Array:
        """Jacobian of the centre of mass: J v is its velocity, world axes.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        gives
            J            3 x nv    row: (omega; v); column: degree of freedom
        Axes before these count states, and are broadcast: one call of C for each state."""

    def jacobian_derivative(self, body: int | str, point: ArrayLike | None = None,
                            axes: Literal["world", "link"] = 'world') -> Array:
        """dJ/dt of `jacobian` with the same arguments, after `kinematics` at q and v: J a + dJ/dt v is the rate of
        the components of J v, in world axes what `point_acceleration` gives.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            axes                   "world" or "link": the axes of the six components
        gives
            J_dot        6 x nv    dJ/dt: 1/s times the entries of J
        Axes before these count states, and are broadcast: one call of C for each state."""

    def relative_jacobian_derivative(self, body: int | str, point: ArrayLike | None = None,
                                     reference: int | str = -1,
                                     axes: Literal["world", "link"] = 'world') -> Array:
        """dJ/dt of `relative_jacobian` with the same arguments, after `kinematics` at q and v.

            body                   index, or name of the link
            point        3         fixed in the body, link axes: m; None = the link's origin
            reference              index, or name of the link; -1 = the world
            axes                   "world" or "link": the axes of the six components
        gives
            J_dot        6 x nv    dJ/dt: 1/s times the entries of J
        Axes before these count states, and are broadcast: one call of C for each state."""

    def coriolis(self, q: ArrayLike, v: ArrayLike) -> Array:
        """The matrix C with C v = c - g and dM/dt - 2 C skew, of all such the one without torsion. Echeandia
        and Wensing (2021).

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            C            nv x nv   Coriolis matrix
        Axes before these count states, and are broadcast: C computes them together."""

    def id_free_base(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, tau: ArrayLike,
                     f_ext: ArrayLike | None = None) -> hybrid_results:
        """Inverse dynamics of a robot that stands on nothing: the accelerations of all joints but those of
        floating bases are given, and the torques of these. The same as `hybrid`, in less time. Gives (a,
        tau), all of both.

            q            nq        configuration
            v            nv        velocity
            a            nv        accelerations, read but for floating bases
            tau          nv        torques, read for floating bases: 0 in flight
            f_ext        nb x 6    wrenches on the bodies; None = none

        Axes before these count states, and are broadcast: one call of C for each state."""

    def id_derivatives(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, f_ext: ArrayLike | None = None, *,
                       dtau_dq: bool = True, dtau_dv: bool = True, M: bool = True) -> id_derivatives_results:
        """Derivatives of the inverse dynamics. By q along integrate(q, t e_k), components of v and a held,
        wrenches in their bodies' axes; M = dtau/da.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            dtau_dq      nv x nv   row: torque; column: tangent step of q
            dtau_dv      nv x nv   row: torque; column: velocity
            M            nv x nv   mass matrix: kg m^2, kg m, kg
        Axes before these count states, and are broadcast: C computes them together."""

    def gravity_torque_derivatives(self, q: ArrayLike) -> Array:
        """Derivative of the gravity torque.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
        gives
            dg_dq        nv x nv   row: torque; column: tangent step of q
        Axes before these count states, and are broadcast: one call of C for each state."""

    def fd_derivatives(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, f_ext: ArrayLike | None = None, *,
                       a: bool = True, da_dq: bool = True, da_dv: bool = True,
                       Minv: bool = True) -> fd_derivatives_results:
        """Derivatives of the forward dynamics, components of v and tau held; Minv = da/dtau.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            tau          nv        torque or force of each degree of freedom: N m, N
            f_ext        nb x 6    wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
        gives
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
            da_dq        nv x nv   row: acceleration; column: tangent step of q
            da_dv        nv x nv   row: acceleration; column: velocity
            Minv         nv x nv   inverse of the mass matrix
        Axes before these count states, and are broadcast: C computes them together."""

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Torque regressor: rnea(q, v, a) = Y pi + armature a, with the body_parameters pi of all bodies.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            a            nv        acceleration dv/dt: rad/s^2, m/s^2
        gives
            Y            nv x 10nb torque regressor: Y pi of all bodies, one after the other
        Axes before these count states, and are broadcast: C computes them together."""

    def energy_regressors(self, q: ArrayLike, v: ArrayLike | None = None) -> energy_regressors_results:
        """Energy regressors: kinetic = Y_kinetic pi + sum of armature v^2 / 2, potential = Y_potential pi.

            q            nq        configuration: rad, m, quaternions (x, y, z, w)
            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
        gives
            Y_kinetic    10nb      regressor of the kinetic energy
            Y_potential  10nb      regressor of the potential energy
        Axes before these count states, and are broadcast: one call of C for each state."""

    def body_parameters(self, body: int | str) -> Array:
        """The ten inertial parameters of a body, as it was described. See Library.set_parameters,
        check_parameters.

            body                   index, or name of the link
        gives
            pi           10        m, m c (3), and xx xy xz yy yz zz of the inertia about the link's origin, link axes"""

    def integrate_derivatives(self, v: ArrayLike, dt: ArrayLike) -> integrate_derivatives_results:
        """Derivatives of integrate(q, v, dt) in tangent components; they do not depend on q.

            v            nv        velocity: rad/s, m/s; of a free base (omega; v) in body axes
            dt                     s
        gives
            dnext_dq     nv x nv   row: tangent step of q_next; column: of q
            dnext_dv     nv x nv   row: tangent step of q_next; column: velocity
        Axes before these count states, and are broadcast: one call of C for each state."""

    def difference_derivatives(self, q0: ArrayLike, q1: ArrayLike) -> difference_derivatives_results:
        """Derivatives of difference(q0, q1) in tangent components.

            q0           nq        configuration
            q1           nq        configuration
        gives
            dd_dq0       nv x nv   row: d; column: tangent step of q0
            dd_dq1       nv x nv   row: d; column: tangent step of q1
        Axes before these count states, and are broadcast: one call of C for each state."""

    def constraint_set(self, rows: Iterable[Constraint]) -> ConstraintSet:
        """A set of constraints that hold together, from a list of Constraint: see ConstraintSet."""

    def point_contact(self, body: int | str, point: ArrayLike = (0, 0, 0),
                      place: ArrayLike | None = None) -> Constraint:
        """A Constraint: a point of a body (3, body axes) held at a place (3, world; None = anywhere); 3
        rows."""

    def flat_contact(self, body: int | str, point: ArrayLike = (0, 0, 0),
                     place: ArrayLike | None = None) -> Constraint:
        """The same of a whole surface: 6 rows."""

    def ball_loop(self, body1: int | str, point1: ArrayLike, body2: int | str,
                  point2: ArrayLike) -> Constraint:
        """A Constraint: points of two bodies, each in its body's axes, coincide; 3 rows."""

    def hinge_loop(self, body1: int | str, point1: ArrayLike, axis1: ArrayLike, body2: int | str,
                   point2: ArrayLike, axis2: ArrayLike) -> Constraint:
        """The same, and the lines along axis1 and axis2 there coincide; 5 rows."""

    def contacts(self, rows: Iterable[Contact], held: Iterable[Constraint] = (),
                 options: ContactOptions | None = None) -> ContactSet:
        """Contacts that open and slip, from a list of Contact, for simulation: see ContactSet. held: a list of
        Constraint that hold at the same time, as loops; their kp and kd have no meaning here."""

    def c_model(self, name: str, source: str = 'a Model in Python') -> str:
        """The built model as a C table for firmware, for a file NAME_model.h: the same as rbd-model --c-model
        NAME writes. It serves double and float. source: the origin that its head names."""

    def c_table(self, name: str, source: str = 'a Model in Python') -> str:
        """The description as a C table, for a file NAME.h: the same as rbd-model --c NAME writes."""


class Placement(NamedTuple):
    """The place of a frame `of` in a frame `in`."""
    rotation: Array     #: 3 x 3, turns vectors from of's axes into in's
    position: Array     #: 3, of's origin, in in's axes


class RbdError(Exception):
    """An error of the library.

    status   a Status, or a UrdfStatus where a URDF is read
    results  the results of the call that are valid all the same: of n states those that have no error"""
    status: Status | UrdfStatus
    results: Any

    def __init__(self, status: Status | UrdfStatus, text: str, results: Any = None) -> None:
        ...


class RbdWarning(UserWarning):
    """Something in a description or a URDF file is odd, but rbd can compute with it."""


SOURCES: Path


class Spatial:
    """Rotations, placements and spatial vectors by rbd_spatial.h, as arrays: `library.spatial`,
    `model.library.spatial`.

    Spatial vectors are 6 numbers, angular first. A placement says where frame `of` stands in frame `in`: a
    pair of the rotation, which turns vectors from of's axes into in's, and the position of of's origin, in
    in's axes. up: from `of` to `in`, as from a child to its parent; down: back. Use numpy's + and * to add
    and scale them. Axes before those of one quantity are broadcast, as everywhere in numpy."""

    def __init__(self, library: Library) -> None:
        ...

    def rotation_product(self, a: ArrayLike, b: ArrayLike) -> Array:
        """a b: first b, then a.

            a            3 x 3
            b            3 x 3
        gives
                         3 x 3"""

    def rotation_inverse(self, r: ArrayLike) -> Array:
        """Its transpose.

            r            3 x 3
        gives
                         3 x 3"""

    def rotate(self, r: ArrayLike, v: ArrayLike) -> Array:
        """r v.

            r            3 x 3
            v            3
        gives
                         3"""

    def rotate_back(self, r: ArrayLike, v: ArrayLike) -> Array:
        """r' v.

            r            3 x 3
            v            3
        gives
                         3"""

    def rotation_from_quaternion(self, q: ArrayLike) -> Array:
        """q of any length; zero gives the identity.

            q            4, (x, y, z, w)
        gives
                         3 x 3"""

    def rotation_to_quaternion(self, r: ArrayLike) -> Array:
        """The unit quaternion with w >= 0. Shepperd (1978).

            r            3 x 3
        gives
                         4, (x, y, z, w)"""

    def rotation_from_rpy(self, roll: ArrayLike, pitch: ArrayLike, yaw: ArrayLike) -> Array:
        """Rz(yaw) Ry(pitch) Rx(roll), rad.

            roll         a number
            pitch        a number
            yaw          a number
        gives
                         3 x 3"""

    def rotation_to_rpy(self, r: ArrayLike) -> Array:
        """Roll and yaw in [-pi, pi], pitch in [-pi/2, pi/2].

            r            3 x 3
        gives
                         3, roll pitch yaw as of URDF"""

    def rotation_exp(self, turn: ArrayLike) -> Array:
        """The rotation about turn by its length, rad.

            turn         3
        gives
                         3 x 3"""

    def rotation_log(self, r: ArrayLike) -> Array:
        """The shortest turn, at most pi, whose exp is r.

            r            3 x 3
        gives
                         3"""

    def rotation_from_axis_angle(self, axis: ArrayLike, angle: ArrayLike) -> Array:
        """The axis's length does not count.

            axis         3
            angle        a number
        gives
                         3 x 3"""

    def rotation_to_axis_angle(self, r: ArrayLike) -> AxisAngle:
        """The angle in [0, pi]; the axis is z where it is 0.

            r            3 x 3
        gives
                         a pair (axis 3, angle)"""

    def placement_compose(self, b: tuple[ArrayLike, ArrayLike], c: tuple[ArrayLike, ArrayLike]) -> Placement:
        """c in a, from b in a and c in b.

            b            a pair (rotation 3 x 3, position 3), as of body_pose
            c            a pair (rotation 3 x 3, position 3), as of body_pose
        gives
                         a pair (rotation 3 x 3, position 3), as of body_pose"""

    def placement_inverse(self, x: tuple[ArrayLike, ArrayLike]) -> Placement:
        """The frame `in` seen from `of`.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
        gives
                         a pair (rotation 3 x 3, position 3), as of body_pose"""

    def placement_exp(self, v: ArrayLike) -> Placement:
        """Where a frame gets in unit time that moves with v.

            v            6, (angular; linear)
        gives
                         a pair (rotation 3 x 3, position 3), as of body_pose"""

    def placement_log(self, x: tuple[ArrayLike, ArrayLike]) -> Array:
        """The v with the shortest turn whose exp is x.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
        gives
                         6, (angular; linear)"""

    def point_up(self, x: tuple[ArrayLike, ArrayLike], point: ArrayLike) -> Array:
        """A point of frame `of` in coordinates of `in`.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            point        3
        gives
                         3"""

    def point_down(self, x: tuple[ArrayLike, ArrayLike], point: ArrayLike) -> Array:
        """A point of frame `in` in coordinates of `of`.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            point        3
        gives
                         3"""

    def motion_up(self, x: tuple[ArrayLike, ArrayLike], m: ArrayLike) -> Array:
        """A motion of frame `of` in frame `in`; RBDA (2.24).

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            m            6, (angular; linear)
        gives
                         6, (angular; linear)"""

    def motion_down(self, x: tuple[ArrayLike, ArrayLike], m: ArrayLike) -> Array:
        """A motion of frame `in` in frame `of`.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            m            6, (angular; linear)
        gives
                         6, (angular; linear)"""

    def motion_cross(self, v: ArrayLike, m: ArrayLike) -> Array:
        """v x m: the rate of a motion that v carries along; RBDA (2.31).

            v            6, (angular; linear)
            m            6, (angular; linear)
        gives
                         6, (angular; linear)"""

    def force_up(self, x: tuple[ArrayLike, ArrayLike], f: ArrayLike) -> Array:
        """A force of frame `of` in frame `in`; RBDA (2.25).

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            f            6, (moment; force)
        gives
                         6, (moment; force)"""

    def force_down(self, x: tuple[ArrayLike, ArrayLike], f: ArrayLike) -> Array:
        """A force of frame `in` in frame `of`.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            f            6, (moment; force)
        gives
                         6, (moment; force)"""

    def force_cross(self, v: ArrayLike, f: ArrayLike) -> Array:
        """v x* f: the rate of a force that v carries along; RBDA (2.32).

            v            6, (angular; linear)
            f            6, (moment; force)
        gives
                         6, (moment; force)"""

    def power(self, v: ArrayLike, f: ArrayLike) -> float:
        """v . f, W; the same in every frame.

            v            6, (angular; linear)
            f            6, (moment; force)
        gives
                         a number"""

    def inertia_of(self, mass: ArrayLike, com: ArrayLike, inertia: ArrayLike) -> Array:
        """Of a description: inertia about com.

            mass         a number
            com          3
            inertia      6: xx xy xz yy yz zz
        gives
                         10: m, m c (3), xx xy xz yy yz zz about the origin"""

    def inertia_up(self, x: tuple[ArrayLike, ArrayLike], i: ArrayLike) -> Array:
        """An inertia of frame `of` in frame `in`; RBDA (2.66).

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            i            10: m, m c (3), xx xy xz yy yz zz about the origin
        gives
                         10: m, m c (3), xx xy xz yy yz zz about the origin"""

    def inertia_down(self, x: tuple[ArrayLike, ArrayLike], i: ArrayLike) -> Array:
        """An inertia of frame `in` in frame `of`.

            x            a pair (rotation 3 x 3, position 3), as of body_pose
            i            10: m, m c (3), xx xy xz yy yz zz about the origin
        gives
                         10: m, m c (3), xx xy xz yy yz zz about the origin"""

    def inertia_times(self, i: ArrayLike, m: ArrayLike) -> Array:
        """i m: of a velocity the momentum; RBDA (2.63).

            i            10: m, m c (3), xx xy xz yy yz zz about the origin
            m            6, (angular; linear)
        gives
                         6, (moment; force)"""


class Status(IntEnum):
    OK = 0
    ERR_NULL = -1
    ERR_MEMORY = -2
    ERR_VERSION = -3
    ERR_INDEX = -4
    ERR_ORDER = -5
    ERR_SINGULAR = -6
    ERR_COUNT = -7
    ERR_NAME = -8
    ERR_PARENT = -9
    ERR_TYPE = -10
    ERR_AXIS = -11
    ERR_PITCH = -12
    ERR_POSITION = -13
    ERR_ROTATION = -14
    ERR_MASS = -15
    ERR_COM = -16
    ERR_INERTIA = -17
    ERR_LEAF = -18
    ERR_ARMATURE = -19
    ERR_DAMPING = -20
    ERR_FRICTION = -21
    ERR_LIMITS = -22
    ERR_MIMIC = -23
    ERR_WORK = -24
    ERR_NAN = -25
    ERR_RANGE = -26
    ERR_INFEASIBLE = -27
    ERR_LEFT_OUT = -28
    ERR_ARITHMETIC = -29
    WARN_INERTIA_NEGATIVE = 1
    WARN_INERTIA_TRIANGLE = 2
    WARN_INERTIA_ZERO = 3
    WARN_MASS_ZERO = 4
    WARN_LIMITS = 5


@dataclass
class Urdf:
    """The content of a URDF file: `Model(urdf)` takes it."""
    name: str           #: of the robot
    bodies: list[Body]
    frames: list[Frame]     #: all links, fixed ones too
    warnings: list[str]     #: sentences
    gravity: Numbers        #: world frame, m/s^2
    fixed_mass: float       #: kg, of the links that are fixed to the world: in no body


class UrdfStatus(IntEnum):
    OK = 0
    ERR_NULL = -1
    ERR_OPTION = -2
    ERR_FILE = -3
    ERR_ROOM = -4
    ERR_MEMORY = -5
    ERR_XML = -6
    ERR_ROBOT = -7
    ERR_NAME = -8
    ERR_NUMBER = -9
    ERR_INERTIAL = -10
    ERR_JOINT = -11
    ERR_AXIS = -12
    ERR_MIMIC = -13
    ERR_TREE = -14
    ERR_MODEL = -15
    ERR_PARSER = -16
    WARN_INERTIA = 1
    WARN_LIMIT = 2
    WARN_ROOT = 3
    WARN_LOCKED = 4
    WARN_AXIS = 5
    WARN_NAME = 6
    WARN_MIMIC = 7
    WARN_SINGULAR = 8
    WARN_DEGREES = 9
    WARN_UNREAD = 10
    WARN_MASSLESS = 11


def load_table(path: str | os.PathLike[str], name: str | None = None) -> list[Body]:
    """The description in a C table, as rbd-model writes it and models/ has it: a list of Body. The file is
    compiled.

    path   of a C header with `static const rbd_body NAME_bodies[...]`
    name   of the array, where there are several"""


def load_urdf(path: str | os.PathLike[str], *, floating: bool = False, root: str | None = None,
              root_joint: str | None = None, gravity: ArrayLike | None = None,
              keep: str | Iterable[str] = (), keep_all: bool = False,
              lock: str | Iterable[str] | Mapping[str, float] = (), lock_massless: bool = False,
              strict: bool = False, messages: bool = False) -> Urdf:
    """A robot from a URDF file.

    The options are those of the command-line tools (rbd-model --help).

    floating       the root link is on a floating joint, not fixed to the world
    root           take only this link, as the root, and its subtree; None = all
    root_joint     the name of the floating joint; None = "root"
    gravity        3, world frame, m/s^2; None = (0, 0, -9.81)
    keep           links on fixed joints to keep as bodies; others are merged: a name or several
    keep_all       keep all links on fixed joints
    lock           joints to hold still, and those that mimic them: {joint: value, rad or m}, or names (at 0)
    lock_massless  hold joints still that move no mass, which else are an error
    strict         warnings are errors
    messages       let urdfdom write its messages to standard error"""


def parse_urdf(text: str | bytes, *, floating: bool = False, root: str | None = None,
               root_joint: str | None = None, gravity: ArrayLike | None = None,
               keep: str | Iterable[str] = (), keep_all: bool = False,
               lock: str | Iterable[str] | Mapping[str, float] = (), lock_massless: bool = False,
               strict: bool = False, messages: bool = False) -> Urdf:
    """A robot from the text of a URDF.

    The options are those of the command-line tools (rbd-model --help).

    floating       the root link is on a floating joint, not fixed to the world
    root           take only this link, as the root, and its subtree; None = all
    root_joint     the name of the floating joint; None = "root"
    gravity        3, world frame, m/s^2; None = (0, 0, -9.81)
    keep           links on fixed joints to keep as bodies; others are merged: a name or several
    keep_all       keep all links on fixed joints
    lock           joints to hold still, and those that mimic them: {joint: value, rad or m}, or names (at 0)
    lock_massless  hold joints still that move no mass, which else are an error
    strict         warnings are errors
    messages       let urdfdom write its messages to standard error"""


class generalized_momentum_results(NamedTuple):
    p: Array | _MaybeNone
    ctv: Array | _MaybeNone


class body_pose_results(NamedTuple):
    R: Array
    p: Array


class energy_results(NamedTuple):
    kinetic: float
    potential: float


class com_results(NamedTuple):
    position: Array
    velocity: Array
    acceleration: Array


class momentum_results(NamedTuple):
    h: Array
    h_dot: Array


class free_step_results(NamedTuple):
    q_next: Array
    v_next: Array


class step_results(NamedTuple):
    q_next: Array
    v_next: Array


class momentum_matrix_results(NamedTuple):
    A: Array
    A_dot_v: Array | _MaybeNone


class id_derivatives_results(NamedTuple):
    dtau_dq: Array | _MaybeNone
    dtau_dv: Array | _MaybeNone
    M: Array | _MaybeNone


class fd_derivatives_results(NamedTuple):
    a: Array | _MaybeNone
    da_dq: Array | _MaybeNone
    da_dv: Array | _MaybeNone
    Minv: Array | _MaybeNone


class energy_regressors_results(NamedTuple):
    Y_kinetic: Array | _MaybeNone
    Y_potential: Array


class integrate_derivatives_results(NamedTuple):
    dnext_dq: Array
    dnext_dv: Array


class difference_derivatives_results(NamedTuple):
    dd_dq0: Array
    dd_dq1: Array


class constraint_jacobian_results(NamedTuple):
    J: Array | _MaybeNone
    gamma: Array | _MaybeNone
    e: Array | _MaybeNone


class constrained_fd_results(NamedTuple):
    a: Array
    lambda_: Array


class impact_results(NamedTuple):
    v_plus: Array
    impulse: Array


class constrained_id_results(NamedTuple):
    tau: Array
    lambda_: Array


class assemble_results(NamedTuple):
    q_near: Array
    v_near: Array | _MaybeNone


class constrained_fd_derivatives_results(NamedTuple):
    a: Array
    lambda_: Array
    da_dq: Array | _MaybeNone
    da_dv: Array | _MaybeNone
    da_dtau: Array | _MaybeNone
    dlambda_dq: Array | _MaybeNone
    dlambda_dv: Array | _MaybeNone
    dlambda_dtau: Array | _MaybeNone


class contact_step_results(NamedTuple):
    q_next: Array
    v_next: Array


class contact_step_derivatives_results(NamedTuple):
    q_next: Array
    v_next: Array
    dq_next_dq: Array | _MaybeNone
    dq_next_dv: Array | _MaybeNone
    dq_next_dtau: Array | _MaybeNone
    dv_next_dq: Array | _MaybeNone
    dv_next_dv: Array | _MaybeNone
    dv_next_dtau: Array | _MaybeNone


class hybrid_results(NamedTuple):
    a: Array
    tau: Array


class batch_momentum_results(NamedTuple):
    h: Array
    h_dot: Array
