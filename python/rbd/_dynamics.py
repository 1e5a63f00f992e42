# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Dynamics of a Model."""
from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _QUANTITIES, _broadcast, _int, _numbers, _shape, _whole
from ._calls import _Owner, _c, _for_each_state, _results
from ._headers import Array

hybrid_results = _results("hybrid", "a", "tau")


class Dynamics(_Owner):
    """The calls of a Model that compute dynamics."""

    @_c("work", "tau", batch=True)
    def rnea(self, q, v, a, f_ext=None):
        """Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext. Recursive Newton-Euler, RBDA table 5.1."""

    @_c("work", "c", batch=True)
    def bias(self, q, v, f_ext=None):
        """Bias force c, the part of inverse dynamics that does not depend on a: velocity terms, gravity, minus
        external wrenches."""

    @_c("work", "g", batch="bias")
    def gravity_torque(self, q):
        """Gravity torque g, which holds the robot still: inverse dynamics at v = a = 0, without f_ext."""

    @_c("work", "p? ctv?")
    def generalized_momentum(self, q, v, *, p=True, ctv=True):
        """Generalized momentum p = M v and C' v, for a momentum observer: dp/dt = tau + C' v - g + sum J'
        f_ext."""

    @_c("work", "M", batch=True)
    def crba(self, q):
        """Mass matrix, both triangles. Composite rigid bodies, RBDA table 6.2."""

    @_c("work", "H", batch=True)
    def crba_packed(self, q):
        """Mass matrix packed: of the lower triangle what the tree fills, row after row; see packed_index."""

    @_c("work", "a", batch=True)
    def aba(self, q, v, tau, f_ext=None):
        """Forward dynamics a = M^-1 (tau - c + sum J' f_ext). Articulated bodies, RBDA table 7.1."""

    @_c("work", "a", batch=True)
    def fd_cholesky(self, q, v, tau, f_ext=None):
        """Forward dynamics by mass matrix, bias and branch-sparse L'DL, RBDA ch. 6."""

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
        return self._hybrid("hybrid", "work", {"q": q, "v": v, "given": given}, a, tau, f_ext)

    def _hybrid(self, call, memory, inputs, a, tau, f_ext):
        inputs = {**inputs, "a": a, "tau": tau, "f_ext": f_ext}
        shapes = {name: _QUANTITIES[name][0] for name in inputs}
        loop, arrays = _broadcast(call, [
            (name, value, _shape(shapes[name], self._dims), tuple(shapes[name].split()))
            for name, value in inputs.items() if name != "f_ext" or value is not None], self.library.dtype)

        def one(k):  # C writes a and tau, of which it reads the parts that are given
            state = {name: array[k] for name, array in arrays.items()}
            outputs = {name: state[name] for name in ("a", "tau")}
            self._run(call, [memory], [state.get(name) for name in inputs], outputs, pointers=())
        arrays["a"], arrays["tau"] = arrays["a"].copy(), arrays["tau"].copy()
        _for_each_state(loop, one)
        return hybrid_results(*(arrays[name].reshape(*loop, self.nv) for name in ("a", "tau")))

    @_c("work", "Minv", batch=True)
    def minverse(self, q):
        """Inverse of the mass matrix, both triangles."""

    @_c("work", "L")
    def cholesky_factor(self, M):
        """Factor of M = L' D L that keeps the tree's zeros, RBDA section 6.5: packed like crba_packed, L
        below the diagonal, 1/D on it. Only the lower triangle of M is read."""

    def cholesky_factor_packed(self, H: ArrayLike) -> Array:
        """The same of a packed mass matrix (crba_packed): a new packed array."""
        call, nh = "cholesky_factor_packed", self._dims["nh"]
        loop, arrays = _broadcast(call, [("H", H, (nh,), ("nh",))], self.library.dtype)
        factor = arrays["H"].copy()
        _for_each_state(loop, lambda k: self._run(call, ["work"], [], {"L": factor[k]}))
        return factor.reshape(*loop, nh)

    @_c("work", "x")
    def cholesky_solve(self, L, b):
        """Solves M x = b with the factor L. Right-hand sides as columns: cholesky_solve_many."""

    def cholesky_solve_many(self, L: ArrayLike, B: ArrayLike) -> Array:
        """Solves M X = B with the factor L. B: nv x n, right-hand sides as columns; gives X, nv x n."""
        call, dtype = "cholesky_solve_many", self.library.dtype
        B = _numbers(call, "B", B, (self.nv, None), dtype, ("nv", "n"))
        L = _numbers(call, "L", L, (self._dims["nh"],), dtype, ("nh",))
        return self._run(call, ["work"], [L, B.shape[1], B], {"X": np.zeros_like(B)})[0]

    def packed_size(self) -> int:
        """Number of entries of a packed matrix."""
        return self.library.call("packed_size", self._address("model"))

    def packed_index(self, i: int, j: int) -> int:
        """Where entry (i, j) lies in a packed matrix; -1 if the tree makes it zero."""
        return self.library.call("packed_index", self._address("model"),
                                 *(_int(_whole("packed_index", name, x)) for name, x in (("i", i), ("j", j))))

    @_c("work", "tau")
    def passive(self, v):
        """Passive torque of the joints, -damping v - friction sign(v): add it to the tau given to forward
        dynamics, subtract it from the tau that inverse dynamics gives."""
