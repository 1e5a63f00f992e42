# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Kinematics of a Model."""
from __future__ import annotations

import ctypes
import math
from typing import Iterable, Literal

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _axes, _broadcast, _numbers, _whole
from ._calls import _Owner, _c, _results
from ._headers import Array
from ._ik import IkResult, IkTarget, _ik

batch_momentum_results = _results("batch_momentum", "h", "h_dot")


class Kinematics(_Owner):
    """The calls of a Model about poses, motion, points, momentum, and the manifold of configurations."""

    # -- kinematics: the calls after `kinematics` read its results --

    @_c("work")
    def kinematics(self, q, v=None, a=None):
        """Computes poses, velocities and accelerations of all bodies; the calls below read them. None =
        zero."""

    @_c("work")
    def body_kinematics(self, body, q, v=None, a=None):
        """Computes pose, velocity and acceleration of one body and its ancestors, in less time than `kinematics`.
        The calls below then know these bodies only."""

    @_c("work", "R p", p="3  the link's origin, world frame: m")
    def body_pose(self, body):
        """Pose of a body after `kinematics`."""

    @_c("work", "velocity")
    def body_velocity(self, body):
        """Spatial velocity (omega; v of the link's origin) of a body, link axes."""

    @_c("work", "acceleration")
    def body_acceleration(self, body):
        """Spatial acceleration of a body, link axes, without gravity: d/dt of the components of the
        velocity."""

    @_c("work", "acceleration")
    def body_acceleration_classical(self, body):
        """Classical acceleration (domega/dt; of the link's origin), link axes, without gravity."""

    @_c("work", "kinetic potential")
    def energy(self):
        """Energies of all bodies that a joint moves, after `kinematics`."""

    @_c("work", "position velocity acceleration", velocity="3  world frame: m/s",
        acceleration="3  world frame: m/s^2")
    def com(self):
        """Centre of mass of those bodies, its velocity and acceleration, world frame, after `kinematics`."""

    def mass(self) -> float:
        """Mass of all bodies that a joint moves, kg."""
        return self.library.call("mass", self._address("model"), result=self.library.scalar)

    @_c("work", "wrench")
    def joint_wrench(self, q, v, a, f_ext=None):
        """The wrench that each body's joint transmits, fixed joints too: what loads gears and bearings. Calls
        `kinematics`."""

    # -- points and momentum, after `kinematics` --

    @_c("work", "J")
    def jacobian(self, body, point=None, axes="world"):
        """Jacobian of a point of a body, after `kinematics`: (omega; velocity of the point) = J v."""

    @_c("work", "J")
    def relative_jacobian(self, body, point=None, reference=-1, axes="world"):
        """Jacobian of a point of a body as seen from another body. "link" axes are the reference's."""

    @_c("work", "tau")
    def jacobian_transpose(self, body, point, axes, f):
        """tau = J' f for a wrench at a point; J is never formed. point may be None."""

    @_c("work", "position")
    def point_position(self, body, point=None):
        """Position of a point of a body in the world."""

    @_c("work", "velocity")
    def point_velocity(self, body, point=None, axes="world"):
        """Motion of a point: (omega of the body; velocity of the point)."""

    @_c("work", "acceleration")
    def point_acceleration(self, body, point=None, axes="world"):
        """(domega/dt; classical acceleration of the point), without gravity: J a + dJ/dt v."""

    @_c("work", "row")
    def point_wrench(self, body, point, axes, f):
        """A wrench at a point as the body's row of f_ext; rows of several points add up. point may be
        None."""

    @_c("work", "h h_dot")
    def momentum(self):
        """Centroidal momentum of all bodies that a joint moves, and its rate."""

    def batch_jacobian(self, q: ArrayLike, body: int | str, point: ArrayLike | None = None,
                       axes: Literal["world", "link"] = "world") -> Array:
        """Jacobians (..., 6, nv) of a point of a body at configurations q (..., nq); point and axes as of
        `jacobian`. It needs no `kinematics`."""
        call, dtype = "batch_jacobian", self.library.dtype
        loop, arrays = _broadcast(call, [("q", q, (self.nq,), ("nq",))], dtype)
        q = arrays["q"]
        point = None if point is None else _numbers(call, "point", point, (3,), dtype)
        J = np.zeros((len(q), 6, self.nv), dtype)
        inputs = [len(q), q, self._body(body, call), point, _axes(call, axes)]
        return self._run(call, ["batch"], inputs, {"J": J})[0].reshape(*loop, 6, self.nv)

    def batch_momentum(self, q: ArrayLike, v: ArrayLike | None = None,
                       a: ArrayLike | None = None) -> batch_momentum_results:
        """Centroidal momenta h and their rates h_dot, (..., 6) each, of states q (..., nq), v and a (...,
        nv). None = zero. It needs no `kinematics`."""
        call, dtype = "batch_momentum", self.library.dtype
        inputs = [("q", q, (self.nq,), ("nq",)), ("v", v, (self.nv,), ("nv",)), ("a", a, (self.nv,), ("nv",))]
        loop, arrays = _broadcast(call, [x for x in inputs if x[0] == "q" or x[1] is not None], dtype)
        n = math.prod(loop)
        outputs = {"h": np.zeros((n, 6), dtype), "h_dot": np.zeros((n, 6), dtype)}
        results = self._run(call, ["batch"], [n, *map(arrays.get, "qva")], outputs)
        return batch_momentum_results(*(x.reshape(*loop, 6) for x in results))

    # -- inverse kinematics --

    def ik(self, targets: IkTarget | Iterable[IkTarget], q: ArrayLike | None = None, *, starts: int = 0,
           evaluations: int = 0, metres: float = 0.0, radians: float = 0.0, length: float = 0.0,
           held: ArrayLike | None = None) -> IkResult:
        """Finds a configuration within all limits for which all targets are reached, rbd_ik of rbd_ik.h; if it finds
        none, the nearest that it found. `status` of the result says which: IkStatus.REACHED is 0.

            targets      IkTarget, or a list of them
            q            nq: where to begin; None = neutral
            starts       at most: q, then others; 1 = from q alone; 0 = 60
            evaluations  of the targets, at most, 2 or more; 0 = 5000
            metres       a target is reached if its place is this near; 0 = 1e-6, of float 1e-5
            radians      and its angle; 0 = 1e-6, of float 1e-5
            length       m: how much a radian of error counts; 0 = 0.3, a third of an arm's reach
            held         nv: 1 where a degree of freedom stays as it is; None = none. Of a spherical, planar or floating
                         joint all, or none

        After it `kinematics` must be called anew. Bad input raises RbdError with a Status, naming target and field; of
        a wrong type or shape, TypeError or ValueError."""
        options = {"starts": starts, "evaluations": evaluations, "metres": metres, "radians": radians, "length": length}
        return _ik(self, targets, q, held, options)

    # -- configuration manifold --

    @_c("", "q")
    def neutral(self):
        """The neutral configuration: zeros, identity quaternions, (cos, sin) = (1, 0)."""

    @_c("", "q_next")
    def integrate(self, q, v, dt):
        """q moved by the tangent step v dt: exponentials in body axes for spherical, planar and floating
        joints, addition for the others."""

    @_c("work", "q_next v_next", c_inputs="q v tau f_ext damping dt")
    def free_step(self, q, v, tau, dt, f_ext=None, damping=None):
        """A step of second order from torques, without contacts, which keeps the energy of what turns."""

    @_c("", "q_next v_next")
    def step(self, q, v, a, dt):
        """One step of semi-implicit Euler from the accelerations a of forward dynamics: v + dt a, then q moved by
        it, in the axes of the step's beginning. A body on which no force acts keeps its momentum."""

    @_c("", "d")
    def difference(self, q0, q1):
        """The tangent step d for which integrate(q0, d, 1) is q1, the shortest rotation."""

    @_c("", "q")
    def interpolate(self, q0, q1, s):
        """The part s of the way from q0 to q1, integrate(q0, difference(q0, q1), s): q0 at 0, q1 at 1."""

    @_c("", "distance", weight="nv")
    def distance(self, q0, q1, weight=None):
        """The square root of the sum of weight d^2, d = difference(q0, q1). With None a metre counts as much as a
        radian."""

    @_c("", "rates")
    def rates_from_velocity(self, q, v):
        """Rates dq/dt of the coordinates from the velocity, for filters and ODE solvers."""

    @_c("", "v")
    def velocity_from_rates(self, q, rates):
        """The velocity from such rates."""

    def random(self, seed: int, n: int | None = None) -> Array:
        """A random configuration, nq, or n of them, n x nq: uniform within limits where given, else angles in
        (-pi, pi), lengths in (-1, 1), orientations uniform. The same seed, a whole number, gives the same."""
        state = ctypes.c_uint64(_whole("random", "seed", seed))
        if n is not None and _whole("random", "n", n) < 0:
            raise ValueError(f"random: n must not be negative, it is {n}")
        q = np.zeros((1 if n is None else n, self.nq), self.library.dtype)
        for row in q:
            self.library.call("random", self._address("model"), ctypes.byref(state), row)
        return q[0] if n is None else q
