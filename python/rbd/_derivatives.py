# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Derivatives of a Model: rbd_derivatives.h."""
from __future__ import annotations

from numpy.typing import ArrayLike

from ._calls import _c
from ._dynamics import Dynamics, hybrid_results


class Derivatives(Dynamics):
    """The calls of a Model by rbd_derivatives.h: derivatives, and what else stands on a common frame."""

    @_c("derivatives", "A A_dot_v?v", batch=True)
    def momentum_matrix(self, q, v=None):
        """Centroidal momentum matrix A, A v = (angular momentum about the centre of mass; linear momentum),
        world axes; and dA/dt v unless v is None."""

    @_c("derivatives", "J", J="3 nv")
    def com_jacobian(self, q):
        """Jacobian of the centre of mass: J v is its velocity, world axes."""

    @_c("work", "J_dot")
    def jacobian_derivative(self, body, point=None, axes="world"):
        """dJ/dt of `jacobian` with the same arguments, after `kinematics` at q and v: J a + dJ/dt v is the rate of
        the components of J v, in world axes what `point_acceleration` gives."""

    @_c("work", "J_dot")
    def relative_jacobian_derivative(self, body, point=None, reference=-1, axes="world"):
        """dJ/dt of `relative_jacobian` with the same arguments, after `kinematics` at q and v."""

    @_c("derivatives", "C", batch=True)
    def coriolis(self, q, v):
        """The matrix C with C v = c - g and dM/dt - 2 C skew, of all such the one without torsion. Echeandia
        and Wensing (2021)."""

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
        return self._hybrid("id_free_base", "derivatives", {"q": q, "v": v}, a, tau, f_ext)

    @_c("derivatives", "dtau_dq? dtau_dv? M?", batch=True)
    def id_derivatives(self, q, v, a, f_ext=None, *, dtau_dq=True, dtau_dv=True, M=True):
        """Derivatives of the inverse dynamics. By q along integrate(q, t e_k), components of v and a held,
        wrenches in their bodies' axes; M = dtau/da."""

    @_c("derivatives", "dg_dq")
    def gravity_torque_derivatives(self, q):
        """Derivative of the gravity torque."""

    @_c("derivatives", "a? da_dq? da_dv? Minv?", batch=True)
    def fd_derivatives(self, q, v, tau, f_ext=None, *, a=True, da_dq=True, da_dv=True, Minv=True):
        """Derivatives of the forward dynamics, components of v and tau held; Minv = da/dtau."""

    @_c("derivatives", "Y", batch=True)
    def regressor(self, q, v, a):
        """Torque regressor: rnea(q, v, a) = Y pi + armature a, with the body_parameters pi of all bodies."""

    @_c("derivatives", "Y_kinetic?v Y_potential")
    def energy_regressors(self, q, v=None):
        """Energy regressors: kinetic = Y_kinetic pi + sum of armature v^2 / 2, potential = Y_potential pi."""

    @_c("", "pi")
    def body_parameters(self, body):
        """The ten inertial parameters of a body, as it was described. See Library.set_parameters,
        check_parameters."""

    @_c("", "dnext_dq dnext_dv")
    def integrate_derivatives(self, v, dt):
        """Derivatives of integrate(q, v, dt) in tangent components; they do not depend on q."""

    @_c("", "dd_dq0 dd_dq1")
    def difference_derivatives(self, q0, q1):
        """Derivatives of difference(q0, q1) in tangent components."""
