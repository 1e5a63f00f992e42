# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Quadratic programs: rbd_qp.h."""
from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _array, _instance, _int, _ndim, _number, _numbers, _whole, _wrong_shape
from ._headers import Array, QpStatus, RbdError, _python_words, structure
from ._library import Library, _default_library

_NONE = 1e30    # RBD_QP_NONE


class QpSolution(NamedTuple):
    """The solution of a quadratic program."""
    x: Array            #: n
    multipliers: Array  #: of each side, bounds first: Hx + f + C'multipliers = 0; above 0 at the upper side
    side: Array         #: of each side: -1 where the lower one holds, 1 the upper one, 0 neither
    primal: float       #: the largest miss of a row, as a share of its terms
    dual: float         #: the largest component of Hx + f + C'multipliers, as a share of the cost's largest term
    steps: int          #: rows that joined or left
    rounds: int         #: of the proximal method: 0 if H is definite


def qp(H: ArrayLike, f: ArrayLike, C: ArrayLike | None = None, lower: ArrayLike | None = None,
       upper: ArrayLike | None = None, soft: ArrayLike | None = None, warm: QpSolution | None = None,
       steps: int = 0, rounds: int = 0, accuracy: float = 0.0, library: Library | None = None) -> QpSolution:
    """Minimises x'Hx/2 + f'x with lower <= (x, Cx) <= upper. rbd_qp.h

    H         n x n, symmetric, positive definite or semidefinite
    f         n
    C         rows x n; None = no rows
    lower     of as many x as there are bounds, then of each row of C; -inf: none; None = all none
    upper     the same, inf: none; equal to lower: an equality
    soft      the same, weights: a row that is missed by e costs weight e^2/2; 0 = a hard row; None = all
    warm      the solution of a similar problem, whose sides are a guess
    steps     rows that join or leave by steps, at most; 0 = the library's default, as of the next two
    rounds    of the proximal method, if H is semidefinite, at most
    accuracy  of rows and optimum, a share of their terms
    library   a Library, for float; None = the default, for double

    RbdError with a QpStatus: INFEASIBLE (the rows whose multipliers are not 0 contradict each other), UNBOUNDED,
    ITERATIONS and INACCURATE have the solution so far as its results."""
    library = _default_library() if library is None else _instance("qp", "library", library, Library)
    real = library.dtype
    f = _numbers("qp", "f", f, (None,), real)
    n = len(f)
    H = _numbers("qp", "H", H, (n, n), real)
    C = np.zeros((0, n), real) if C is None else _numbers("qp", "C", C, (None, n), real)
    lengths = {len(_array("qp", name, sides)) for name, sides in (("lower", lower), ("upper", upper))
               if sides is not None and _ndim("qp", name, sides) == 1}
    count = max(lengths, default=len(C))
    if not len(C) <= count <= n + len(C):
        raise ValueError(f"qp: lower and upper must have {len(C)} to {n + len(C)} entries, bounds of x and a side for "
                         f"each row of C, not {count}")
    low, high = (_sides(name, sides, count, none, real)
                 for name, sides, none in (("lower", lower, -_NONE), ("upper", upper, _NONE)))
    weights = None if soft is None else _numbers("qp", "soft", soft, (count,), real)
    x, multipliers, side = np.zeros(n, real), np.zeros(count, real), np.zeros(count, np.int8)
    if warm is not None:
        _instance("qp", "warm", warm, QpSolution)
        x[:] = _numbers("qp", "warm.x", warm.x, (n,), real)
        side[:] = _numbers("qp", "warm.side", warm.side, (count,), np.dtype(np.int8))

    problem = structure("rbd_qp_problem", library.scalar)(n, count - len(C), len(C), *(
        None if array is None else array.ctypes.data for array in (H, f, C, low, high, weights)))
    options = structure("rbd_qp_options", library.scalar)(
        _int(_whole("qp", "steps", steps)), int(warm is not None), _int(_whole("qp", "rounds", rounds)),
        _number("qp", "accuracy", accuracy))
    result = structure("rbd_qp_result", library.scalar)()
    size = library.call("qp_size", n, count - len(C), len(C), 0 if weights is None else int((weights > 0).sum()),
                        result=ctypes.c_size_t)
    memory = ctypes.create_string_buffer(size)
    status = QpStatus(library.call("qp_solve", problem, options, memory, ctypes.c_size_t(size), x, multipliers,
                                   side, result))
    solution = QpSolution(x, multipliers, side, result.primal, result.dual, result.steps, result.rounds)
    if status == QpStatus.OK:
        return solution
    text = ctypes.create_string_buffer(200)
    library.call("qp_text", int(status), result, text, ctypes.c_size_t(len(text)), result=ctypes.c_void_p)
    found = QpStatus.INACCURATE <= status <= QpStatus.INFEASIBLE
    raise RbdError(status, "qp: " + _python_words(text.value.decode()), solution if found else None)


def _sides(name, value, count, none, real):
    """Sides, of which infinite ones are none."""
    array = np.full(count, none) if value is None else _array("qp", name, value)
    if array.shape != (count,):
        raise _wrong_shape("qp", name, array.shape, (count,), ("bounds + rows",))
    if np.isnan(array).any():
        raise ValueError(f"qp: {name}[{int(np.argmax(np.isnan(array)))}] is nan")
    return np.ascontiguousarray(np.clip(array, -_NONE, _NONE), real)
