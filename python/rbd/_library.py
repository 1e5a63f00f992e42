# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""rbd.h and its companions, compiled for one scalar."""
from __future__ import annotations

import ctypes
import functools
import os
import threading
from dataclasses import replace
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _Declared, _int, _number, _numbers, _whole
from ._compiled import _compiled_for_machine
from ._compiling import _c_compiler, _compile, _words
from ._contacts import ContactSolution
from ._descriptions import Body
from ._headers import Array, ContactState, RbdError, Status, __version__, _python_words, structure
from ._spatial import Spatial, _spatial_unit

_SINGLE = """
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_contact.h"
#include "rbd_ik.h"
#include "rbd_estimate.h"
#include "rbd_tasks.h"
#include "rbd_actuator.h"
#include "rbd_spatial.h"
#include "rbd_qp.h"
size_t rbd_qp_size(int n, int bounds, int rows, int soft) { return RBD_QP_SIZE(n, bounds, rows, soft); }
"""
_BATCH = """
#if defined __AVX512F__
#define RBD_LANES {}
#elif defined __AVX__
#define RBD_LANES {}
#else
#define RBD_LANES {}
#endif
#define RBD_BATCH_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_constraints.h"
#include "rbd_batch.h"
"""


def _batch_unit(real, lanes):
    """The unit of the batch calls, with as many lanes as the SIMD unit has unless told."""
    per_128 = {"double": 2, "float": 4}[real]
    return _BATCH.format(*(lanes or k * per_128 for k in (4, 2, 1)))


def _library_units(real, lanes=None):
    """The units of a library."""
    return [_SINGLE + _spatial_unit(), _batch_unit(real, lanes)]


class Library(_Declared):
    """rbd.h and its companions, compiled for one scalar. A wheel brings them compiled; they are taken where
    no argument and no $RBD_FLAGS asks for others.

    real      "double" or "float": the scalar of states, results and models
    flags     of the compiler; None = $RBD_FLAGS, else -O3 -march=native -ffp-contract=fast
    lanes     states per SIMD instruction in batches, a power of two; None = as many as the machine has
    compiler  the C compiler; None = $CC, else cc
    """
    real: str                #: "double" or "float"
    scalar: type[Any]        #: the ctypes type of it
    dtype: np.dtype[Any]     #: the numpy type of it: of all results
    lanes: int               #: states per SIMD instruction in batches
    spatial: Spatial         #: the calls of rbd_spatial.h

    def __init__(self, real: str = "double", flags: str | None = None, lanes: int | None = None,
                 compiler: str | None = None):
        if not isinstance(real, str) or real not in ("double", "float"):
            raise ValueError(f"real must be 'double' or 'float', not {real!r}")
        if lanes is not None:
            lanes = _whole("Library", "lanes", lanes)
            if lanes < 2 or lanes & (lanes - 1):
                raise ValueError(f"lanes must be 2, 4, 8 or another power of two, not {lanes}")
        self._settings = real, flags, lanes, compiler
        self.real = real
        self.scalar = {"double": ctypes.c_double, "float": ctypes.c_float}[real]
        self.dtype = np.dtype(real.replace("float", "float32"))
        flags = flags if flags is not None else os.environ.get("RBD_FLAGS") or None
        chosen = (flags, lanes, compiler) != (None, None, None)
        self._c = (None if chosen else _compiled_for_machine(real)) or self._compiled_here()
        self.lanes = self.call("batch_lanes")
        self.spatial = Spatial(self)

    def _compiled_here(self):
        """The library by the compiler of this machine, or from the cache."""
        real, flags, lanes, compiler = self._settings
        if flags is None:
            flags = os.environ.get("RBD_FLAGS") or "-O3 -march=native -ffp-contract=fast"
        compiler = _words("compiler", compiler or "") or _c_compiler()
        command = [*compiler, *_words("flags", flags), f"-DRBD_REAL={real}", "-Wno-psabi"]
        return _compile(_library_units(real, lanes), command, ["-lm"],
                        f"rbd.h for {real}, which takes half a minute to a minute")

    def function(self, name: str, result: Any = ctypes.c_int, arguments: Any = None) -> Any:
        """A C function by its name without `rbd_`: an object of its own, as threads may set its types."""
        try:
            function = self._c[f"rbd_{name}_{self.real}"]
        except AttributeError:
            function = self._c[f"rbd_{name}"]
        function.restype = result
        function.argtypes = arguments
        return function

    def call(self, name: str, *arguments: Any, result: Any = ctypes.c_int) -> Any:
        """Calls C: arrays and structures go as pointers, whole numbers as int."""
        return self.function(name, result)(*(
            ctypes.c_void_p(x.ctypes.data) if isinstance(x, np.ndarray) else
            ctypes.byref(x) if isinstance(x, (ctypes.Structure, ctypes.Array)) else x for x in arguments))

    def status_string(self, status: int) -> str:
        """The library's sentence for a Status."""
        number = _int(_whole("status_string", "status", status))
        text = self.call("status_string", number, result=ctypes.c_char_p)
        return _python_words(text.decode())

    def finding_text(self, finding: ctypes.Structure, function: str = "finding_text") -> str:
        """The library's sentence for a rbd_finding: it names body (or constraint) and field. finding: the
        ctypes structure; function: "finding_text", or "constraint_finding_text" of a set's."""
        if not isinstance(finding, ctypes.Structure) or type(finding).__name__ != "rbd_finding":
            raise TypeError(f"finding_text: finding must be a rbd_finding, not {type(finding).__name__}")
        if function not in ("finding_text", "constraint_finding_text"):
            raise ValueError("finding_text: function must be 'finding_text' or 'constraint_finding_text', "
                             f"not {function!r}")
        text = ctypes.create_string_buffer(400)
        self.call(function, finding, text, ctypes.c_size_t(len(text)), result=ctypes.c_void_p)
        return _python_words(text.value.decode(errors="replace"))

    def check_parameters(self, pi: ArrayLike) -> None:
        """Raises RbdError if no body can have these ten inertial parameters: negative mass, a centre of mass
        without mass, or an inertia that no distribution of mass has. pi: 10, as of Model.body_parameters."""
        status = self.call("check_parameters", _numbers("check_parameters", "pi", pi, (10,), self.dtype))
        if status:
            raise RbdError(Status(status), f"check_parameters: {self.status_string(status)}")

    def set_parameters(self, body: Body, pi: ArrayLike) -> Body:
        """A copy of a Body with the mass, com and inertia of these ten inertial parameters."""
        if not isinstance(body, Body):
            raise TypeError(f"set_parameters: body must be a Body, not {type(body).__name__}")
        row = structure("rbd_body")()
        status = self.call("set_parameters", row, _numbers("set_parameters", "pi", pi, (10,), self.dtype))
        if status:
            raise RbdError(Status(status), f"set_parameters: {self.status_string(status)}")
        return replace(body, mass=row.mass, com=tuple(row.com), inertia=tuple(row.inertia))

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
            iterations  at most; 0 = 40
        """
        name, dtype = "contact_solve", self.dtype
        friction = _numbers(name, "friction", friction, (None,), dtype)
        lower = _numbers(name, "lower", lower, (None,), dtype)
        upper = _numbers(name, "upper", upper, lower.shape, dtype)
        tolerance, iterations = _number(name, "tolerance", tolerance), _whole(name, "iterations", iterations)
        for what, bad in (("friction", friction < 0), ("lower", lower > upper), ("tolerance", tolerance < 0),
                          ("iterations", iterations < 0)):
            if np.any(bad):
                at = f"[{int(np.argmax(bad))}]" if np.ndim(bad) else ""
                raise RbdError(Status.ERR_RANGE, f"{name}: {what}{at} is " + ("above upper" if what == "lower" else "negative"))
        n, bounded = len(friction), len(lower)
        rows = 3 * n + bounded
        arrays = {"delta": _numbers(name, "delta", delta, (rows, rows), dtype), "friction": friction,
                  "b": _numbers(name, "b", b, (rows,), dtype), "lower": lower, "upper": upper}
        p = np.zeros(rows, dtype) if start is None else _numbers(name, "start", start, (rows,), dtype).copy()
        state = (ctypes.c_int * max(n, 1))()
        problem = structure("rbd_contact_problem", self.scalar)(
            contacts=n, bounded=bounded, tolerance=tolerance, iterations=_int(iterations),
            **{key: array.ctypes.data for key, array in arrays.items()})
        size = self.call("contact_solve_size", n, bounded, result=ctypes.c_size_t)
        solution = structure("rbd_contact_solution", self.scalar)()
        status = self.call(name, problem, ctypes.create_string_buffer(max(size, 1)), ctypes.c_size_t(size), p,
                           state, solution)
        if status:
            raise RbdError(Status(status), f"{name}: {self.status_string(status)}")
        return (p, [ContactState(x) for x in state[:n]],
                ContactSolution(*(getattr(solution, field) for field in ContactSolution._fields)))

    def __reduce__(self):
        return Library, self._settings

    def __repr__(self):
        return f"<rbd.Library {__version__}, {self.real}, {self.lanes} lanes>"


_library_lock = threading.Lock()


def _default_library():
    """The Library where none is named; threads that need it at once compile it once."""
    with _library_lock:
        return _only_library()


@functools.lru_cache(maxsize=None)
def _only_library():
    return Library()
