# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Sets of contacts: rbd_contact.h."""
from __future__ import annotations

import ctypes
import difflib
from dataclasses import replace
from typing import Iterable, NamedTuple, Sequence, TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _is_list, _model, _number, _numbers, _whole
from ._calls import _Owner, _c
from ._constraints import _pairs
from ._descriptions import Constraint, Contact, ContactOptions, _to_c
from ._headers import Array, ContactState, RbdError, Status, structure

if TYPE_CHECKING:
    from ._library import Library
    from ._model import Model


class ContactResult(NamedTuple):
    """What a contact did in the last step."""
    state: ContactState     #: APART, OPENS, STICKS or SLIPS
    gap: float              #: before the step, m
    force: Array            #: 3, on body 1, world axes, N


class RowResult(NamedTuple):
    """What a bounded row did in the last step."""
    state: ContactState     #: STICKS within the bounds, SLIPS at one, APART without a force
    force: float            #: N m or N


class ContactSolution(NamedTuple):
    """How well and how fast contacts were solved."""
    residual: float         #: m/s: 0 where all laws hold
    sweeps: int             #: Gauss-Seidel's
    newton_steps: int


def _fault_of_row(law):
    """Which number of a bounded row the library refuses."""
    if law.compliance < 0:
        return f"compliance is {law.compliance}, below 0"
    if law.lower > law.upper:
        return f"lower is {law.lower}, above upper, which is {law.upper}"
    return f"lower is {law.lower} and upper is {law.upper}; they must be below 1e30 and above -1e30"


class ContactSet(_Owner):
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
                 options: ContactOptions | None = None):
        _model("contacts", model)
        super().__init__(model.library, model._lock)
        self.model, self.nv, self._dims = model, model.nv, model._dims
        self.list, self._rows = _pairs(model, rows, Contact, "contacts")
        self.held, self._held = _pairs(model, held, Constraint, "contacts", "held")
        options = ContactOptions() if options is None else options
        if not isinstance(options, ContactOptions):
            raise TypeError(f"contacts: options must be ContactOptions, not {type(options).__name__}")
        self.options = replace(options)
        self._planes = {}  # those that plane() set: normal and height, by number of the contact
        self._bounded, self._friction, self._added = {}, {}, None  # of row_set(), friction() and inertia()
        self._options = structure("rbd_contact_options")()
        _to_c(self.options, self._options, "contacts: options")
        self._address("contact_set")

    def _prepare(self, kind):
        """Makes the memory of the set."""
        call, model, work = self.library.call, self.model._address("model"), self.model._address("work")
        given = len(self.list), self._held, len(self.held), self._options
        size = call("contact_set_size", model, *given, result=ctypes.c_size_t)
        memory, address = ctypes.create_string_buffer(max(size, 1)), ctypes.c_void_p()
        report = structure("rbd_report", self.library.scalar)()
        status = call("contact_set_init", model, work, self._rows, *given, memory, ctypes.c_size_t(size),
                      ctypes.byref(address), report)
        if status:
            text = self.library.finding_text(report.error, "constraint_finding_text")
            number, first_held = report.error.body, len(self.list)
            if number >= 0:
                text = text.replace(f"constraint {number}", f"contact {number}" if number < first_held else
                                    f"held constraint {number - first_held}", 1)
            raise RbdError(Status(status), f"contacts: {text}")
        self._memories[kind], self._addresses[kind] = memory, address

    def _address(self, kind):
        return super()._address(kind) if kind == "contact_set" else self.model._address(kind)

    def __reduce__(self):
        state = self._planes, self._bounded, self._friction, self._added
        return ContactSet, (self.model, list(self.list), list(self.held), self.options), state

    def __setstate__(self, state):
        planes, rows, friction, added = state
        for contact, (normal, height) in planes.items():
            self.plane(contact, normal, height)
        for row, arguments in rows.items():
            self.row_set(row, **arguments)
        for dof, bound in friction.items():
            self.friction(dof, bound)
        self.inertia(added)

    def _layout(self):
        return self.model._layout()

    def _error(self, call, status, results=None, states=None):
        return self.model._error(call, status, results, states)

    def _contact(self, call, contact):
        """The number of a contact, from its name too."""
        names = [row.name for row in self.list]
        if isinstance(contact, str):
            if contact in names:
                return names.index(contact)
            near = difflib.get_close_matches(contact, filter(None, names), 1)
            raise KeyError(f"{call}: no contact is called '{contact}'" +
                           (f"; did you mean '{near[0]}'?" if near else ""))
        number = _whole(call, "contact", contact)
        if not 0 <= number < len(names):
            raise IndexError(f"{call}: no such contact: {number}; the set has {len(names)}")
        return number

    def _row(self, call, row):
        """The number of a bounded row."""
        number = _whole(call, "row", row)
        if not 0 <= number < self.options.rows:
            raise IndexError(f"{call}: no such row: {number}; the set has {self.options.rows}: ContactOptions(rows=...)")
        return number

    def _dof(self, call, dof):
        """The number of a degree of freedom."""
        number = _whole(call, "dof", dof)
        if not 0 <= number < self.nv:
            raise IndexError(f"{call}: no such dof: {number}; the model has {self.nv}")
        return number

    @_c("contact_set", "q_next v_next", c_name="contact_step", c_inputs="q v tau f_ext damping dt")
    def step(self, q, v, tau, dt, f_ext=None, damping=None):
        """A time step with contacts: q and v after dt. States and forces: get, forces; how well it is solved:
        last. Of many states each begins with the impulses of the one before."""

    @_c("contact_set", "a", c_name="contact_fd", c_inputs="q v tau f_ext damping dt")
    def fd(self, q, v, tau, dt, f_ext=None, damping=None):
        """The step's acceleration alone: Model.step with it gives the step's v_next, and q_next where nothing
        penetrates."""

    @_c("contact_set derivatives", "q_next v_next dq_next_dq?dq dq_next_dv?dv dq_next_dtau?dtau "
        "dv_next_dq?dq dv_next_dv?dv dv_next_dtau?dtau", struct=True, c_name="contact_step_derivatives",
        c_inputs="q v tau f_ext damping dt")
    def step_derivatives(self, q, v, tau, dt, f_ext=None, damping=None, *, dq=True, dv=True, dtau=True):
        """The step, and its derivatives by q, v and tau, while no contact changes its state; by those for which
        the keyword is True. Needs ContactOptions(derivatives=True)."""

    def plane(self, contact: int | str, normal: ArrayLike = (0, 0, 1), height: float = 0.0) -> None:
        """Another plane under a contact from the next step on: the tangent plane of terrain.

            contact   index, or name
            normal    3, axes of body 2, towards body 1
            height    along the unit normal, m
        """
        number = self._contact("plane", contact)
        normal = _numbers("plane", "normal", normal, (3,)).copy()
        height = _number("plane", "height", height)
        with self._lock:
            status = self.library.call("contact_plane", self._address("model"), self._address("contact_set"),
                                       number, normal, ctypes.c_double(height))
            if status:
                raise self._error("plane", status)
            self._planes[number] = normal, height

    def friction(self, dof: int, bound: float) -> None:
        """Another dry friction of a degree of freedom from the next step on, up to `bound`, N m or N. Needs
        ContactOptions(joint_friction=True), and friction in the description of that joint."""
        dof, bound = self._dof("friction", dof), _number("friction", "bound", bound)
        with self._lock:
            status = self.library.call("contact_friction", self._address("model"), self._address("contact_set"),
                                       dof, self.library.scalar(bound))
            if status == Status.ERR_INDEX:
                raise RbdError(Status(status), f"friction: dof {dof} has no row of dry friction: that takes "
                               "ContactOptions(joint_friction=True) and friction in the description")
            if status:
                raise RbdError(Status(status), f"friction: bound is {bound}; it must be 0 to 1e30")
            self._friction[dof] = bound

    def row_set(self, row: int, dofs: Sequence[int] = (), jacobian: ArrayLike = (), *, lower: float = 0.0,
                upper: float = 0.0, bias: float = 0.0, compliance: float = 0.0) -> None:
        """Another bounded row from the next step on, of ContactOptions(rows=...): a shaft with its friction, a
        bristle, a brake. Its force f, lower <= f <= upper, acts on the dofs by jacobian' f; at the end of the step
        jacobian v + bias + compliance dt f is 0, above 0 only if f is lower, below 0 only if it is upper.

            dofs         at most 3, each once; none: the row does nothing
            jacobian     of each: speed of the row per speed of the dof
            lower, upper N m or N; +-1e30 and beyond: no bound
            bias         rad/s or m/s
            compliance   speed per impulse, 1/(kg m^2) or 1/kg
        """
        call = "row_set"
        if not _is_list(dofs):
            raise TypeError(f"{call}: dofs must be a list of whole numbers, not {dofs!r:.60}")
        dofs = list(dofs)
        n = len(dofs)
        if n > 3:
            raise ValueError(f"{call}: dofs has {n} entries, and a row has 3 at most")
        dofs = [self._dof(call, dof) for dof in dofs]
        if len(set(dofs)) < n:
            raise ValueError(f"{call}: dofs has one twice: {dofs}")
        law = structure("rbd_contact_row", self.library.scalar)(dofs=n)
        law.dof[:n] = dofs
        law.jacobian[:n] = [float(x) for x in _numbers(call, "jacobian", jacobian, (n,))]
        law.bias, law.compliance = _number(call, "bias", bias), _number(call, "compliance", compliance)
        law.lower, law.upper = _number(call, "lower", lower), _number(call, "upper", upper)
        number = self._row(call, row)
        with self._lock:
            status = self.library.call("contact_row_set", self._address("model"), self._address("contact_set"),
                                       number, ctypes.byref(law))
            if status:
                raise RbdError(Status(status), f"{call}: {_fault_of_row(law)}")
            self._bounded[number] = {"dofs": dofs, "jacobian": list(law.jacobian[:n]), "lower": law.lower,
                                     "upper": law.upper, "bias": law.bias, "compliance": law.compliance}

    def row_get(self, row: int) -> RowResult:
        """What a bounded row did in the last step."""
        number, force = self._row("row_get", row), self.library.scalar()
        with self._lock:
            state = self.library.call("contact_row_get", self._address("contact_set"), number,
                                      ctypes.byref(force))
        return RowResult(ContactState(state), force.value)

    def inertia(self, added: ArrayLike | None) -> None:
        """Adds a packed matrix to M from the next step on, as of rotors that several joints drive; None: nothing.

            added     nh, as of Model.crba_packed; copied
        """
        if added is not None:
            added = _numbers("inertia", "added", added, (self._dims["nh"],), self.library.dtype).copy()
        with self._lock:
            status = self.library.call("contact_inertia", self._address("model"), self._address("contact_set"),
                                       added)
            if status:
                raise self._error("inertia", status)
            self._added = added  # C keeps the address

    def reset(self) -> None:
        """Forgets the last impulses, with which a step begins: after a jump of the state."""
        with self._lock:
            self.library.call("contact_reset", self._address("contact_set"), result=None)

    def get(self, contact: int | str) -> ContactResult:
        """What a contact, index or name, did in the last step."""
        number, gap = self._contact("get", contact), self.library.scalar()
        force = np.zeros(3, self.library.dtype)
        with self._lock:
            state = self.library.call("contact_get", self._address("contact_set"), number,
                                      ctypes.byref(gap), force)
        return ContactResult(ContactState(state), gap.value, force)

    def forces(self) -> Array:
        """Forces of all contacts in the last step: one row each, world axes, N."""
        return np.array([self.get(k).force for k in range(len(self.list))],
                        self.library.dtype).reshape(-1, 3)

    def last(self) -> ContactSolution:
        """Residual and iterations of the last step; a residual above options.tolerance is not solved."""
        kind = structure("rbd_contact_solution", self.library.scalar)
        with self._lock:
            found = self.library.call("contact_last", self._address("contact_set"), result=kind)
        return ContactSolution(*(getattr(found, name) for name in ContactSolution._fields))

    def __repr__(self):
        return f"<rbd.ContactSet, {len(self.list)} contacts>"
