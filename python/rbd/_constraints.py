# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Sets of constraints: rbd_constraints.h."""
from __future__ import annotations

import copy
import ctypes
from dataclasses import replace
from typing import Iterable, Sequence, TYPE_CHECKING

from ._arguments import _entries, _instance, _int, _model, _numbered, _whole
from ._calls import _Owner, _c
from ._descriptions import Constraint, _to_c
from ._headers import RbdError, Status, structure

if TYPE_CHECKING:
    from ._library import Library
    from ._model import Model


def _pairs(model, rows, kind, call, name="rows"):
    """Constraints or contacts as a list, and as an array of the C struct."""
    word, held = kind.__name__.lower(), "held " if name == "held" else ""
    rows = _entries(call, name, rows, kind)
    array = (structure(f"rbd_{word}") * len(rows))()
    for number, row in enumerate(rows):
        _instance(call, f"{held}{word} {number}", row, kind)
        where = f"{call}: {held}{_numbered(word, number, row)}"
        bodies = {side: model._body(getattr(row, side), f"{where}, field '{side}'", None, world=True)
                  for side in ("body1", "body2")}
        _to_c(replace(row, **bodies), array[number], where)
    return copy.deepcopy(rows), array  # the caller may change his, and copies are made of these


class ConstraintSet(_Owner):
    """Contacts and closed loops that hold together, rbd_constraint_set of a Model; made by
    Model.constraint_set(rows).

    They compute in the Model's memory: after a call `kinematics` must be called anew."""
    model: Model
    list: Sequence[Constraint]
    rows: int                   #: the number of axes that all constraints hold
    nv: int                     #: number of degrees of freedom
    library: Library

    def __init__(self, model: Model, rows: Iterable[Constraint]):
        _model("constraint_set", model)
        super().__init__(model.library, model._lock)
        self.model, self.nv = model, model.nv
        self.list, self._rows = _pairs(model, rows, Constraint, "constraint_set")
        self._prepare("constraint_set", "work")
        self.rows = self.library.call("constraint_rows", self._addresses["constraint_set"])
        self._dims = {**model._dims, "rows": self.rows}

    def _prepare(self, kind, base):
        """Makes the memory of the set, or of its batches."""
        call, model, n = self.library.call, self.model._address("model"), len(self.list)
        size = call(f"{kind}_size", model, self._rows, n, result=ctypes.c_size_t)
        self._memories[kind] = memory = ctypes.create_string_buffer(max(size, 1))
        address, report = ctypes.c_void_p(), structure("rbd_report", self.library.scalar)()
        status = call(f"{kind}_init", model, self.model._address(base), self._rows, n, memory,
                      ctypes.c_size_t(size), ctypes.byref(address), report)
        if status:
            raise RbdError(Status(status), self.library.finding_text(report.error, "constraint_finding_text"))
        self._addresses[kind] = address

    def _address(self, kind):
        if kind == "batch_constraint_set" and kind not in self._addresses:
            self._prepare(kind, "batch")
        return self._addresses[kind] if kind in self._addresses else self.model._address(kind)

    def __reduce__(self):
        return ConstraintSet, (self.model, list(self.list))

    def _layout(self):
        return self.model._layout()

    def _error(self, call, status, results=None, states=None):
        error = self.model._error(call, status, results, states)
        row = self.infeasible_row()
        if status == Status.ERR_INFEASIBLE and row >= 0 and states is None:
            number = max(k for k in range(len(self.list)) if self.first(k) <= row)
            name = self.list[number].name
            error.args = (f"{error}; row {row}, of constraint {number}" + (f" '{name}'" if name else ""),)
        return error

    def first(self, constraint: int) -> int:
        """The first row of a constraint, -1 if there is none (rbd_constraint_first)."""
        number = _int(_whole("first", "constraint", constraint))
        return self.library.call("constraint_first", self._addresses["constraint_set"], number)

    def rank(self) -> int:
        """After constrained_fd and impact: the rank of J (rbd_constraint_rank)."""
        return self.library.call("constraint_rank", self._addresses["constraint_set"])

    def infeasible_row(self) -> int:
        """After Status.ERR_INFEASIBLE: a row that contradicts others or that rounding hides, else -1."""
        return self.library.call("infeasible_row", self._addresses["constraint_set"])

    @_c("constraint_set", "J? gamma? e?", J="rows nv")
    def constraint_jacobian(self, q, v=None, *, J=True, gamma=True, e=True):
        """Jacobian J of the constraints, row: constraint; dJ/dt v; and the position error. v: None = zero."""

    @_c("constraint_set", "a lambda_", batch=True)
    def constrained_fd(self, q, v, tau, f_ext=None):
        """Accelerations and constraint forces: M a + c = tau + sum J_b' f_ext + J' lambda and J a + gamma =
        -kd J v - kp e. Of dependent rows lambda is the solution of least norm. RBDA section 8.4."""

    @_c("constraint_set", "v_plus impulse")
    def impact(self, q, v, restitution=0.0):
        """Velocity after an impact: M (v_plus - v) = J' impulse, J v_plus = -restitution J v. RBDA section
        11.7."""

    @_c("constraint_set", "tau lambda_")
    def constrained_id(self, q, v, a, f_ext=None, actuated=None, weight=None):
        """Inverse dynamics with contacts, where only some joints have motors: of all lambda that leave tau =
        0 at the others, that with the least sum of weight lambda^2; else what comes nearest. Mistry, Buchli
        and Schaal (2010)."""

    @_c("constraint_set", "q_near v_near?v", weight="nv")
    def assemble(self, q, v=None, weight=None):
        """Closes loops, or puts feet in their places: q_near with e = 0 nearest to q, in the sum of weight
        d^2, d = difference(q, q_near); and, unless v is None, v_near with J v_near = 0 there nearest to v.
        Newton's method."""

    @_c("constraint_set derivatives",
        "a lambda_ da_dq?dq da_dv?dv da_dtau?dtau dlambda_dq?dq dlambda_dv?dv dlambda_dtau?dtau", struct=True)
    def constrained_fd_derivatives(self, q, v, tau, f_ext=None, *, dq=True, dv=True, dtau=True):
        """Derivatives of constrained_fd by q, v and tau; by those for which the keyword is True. Carpentier,
        Budhiraja and Mansard (2021)."""

    def __repr__(self):
        return f"<rbd.ConstraintSet, {len(self.list)} with {self.rows} rows>"
