# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Inverse kinematics: rbd_ik.h."""
from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import NamedTuple

from ._arguments import _array, _Declared, _int, _left_out, _list, _mask, _number, _numbers, _placed, _whole
from ._headers import Array, IkKind, IkStatus, Matrix, Numbers, RbdError, Status, _enumerator, structure


@dataclass
class IkTarget(_Declared):
    """Something of the robot and where it shall be: rbd_ik_target of rbd_ik.h. Zero will do for every field that the
    kind needs not."""
    kind: str                           #: "point", "pose", "rotation", "axis" or "com"
    body: int | str = 0                 #: index, or name of the link; a centre of mass has none
    point: Numbers = (0, 0, 0)          #: of the body, link axes, m
    position: Numbers = (0, 0, 0)       #: where the point, or the centre of mass, shall be, world, m
    rotation: Numbers | Matrix = (0,) * 9  #: 3 x 3, from link axes to world axes; all 0 = identity
    axis: Numbers = (0, 0, 0)           #: of the body, link axes, of a length of 1e-9 to 1e9
    direction: Numbers = (0, 0, 0)      #: where the axis shall point, world axes, of such a length
    weight: float = 0.0                 #: of its squared error beside the other targets; 0 = 1


class IkResult(NamedTuple):
    """What Model.ik has found."""
    q: Array                #: nq: the configuration
    status: IkStatus        #: REACHED, which is 0; or AT_LIMIT, NEAREST, EVALUATIONS: the nearest that was found
    metres: float           #: the largest distance of a point or centre of mass from its place
    radians: float          #: the largest angle of a body or axis from what it should be
    limit: int              #: AT_LIMIT: the degree of freedom whose limit keeps the targets away most; else -1
    limits: int             #: how many degrees of freedom are at such limits
    starts: int             #: begun
    evaluations: int        #: of the targets


def _target(model, number, given, row):
    """Writes an IkTarget into a C struct."""
    where = f"ik: target {number}"
    row.kind = _enumerator(where, IkKind, given.kind)
    if row.kind == IkKind.COM:
        _left_out(where, given, "body", 0)
    else:
        row.body = model._body(given.body, f"{where}, field 'body'", None)
    for field in "point", "position", "axis", "direction", "rotation":
        shape = (9,) if field == "rotation" else (3,)
        value = getattr(given, field)
        if field == "rotation":
            value = _array(where, field, value).reshape(-1)
        getattr(row, field)[:] = _placed(where, IkKind(row.kind), field, _numbers(where, field, value, shape, model.library.dtype))
    row.weight = _number(where, "weight", given.weight)


def _ik(model, targets, q, held, options):
    """rbd_ik of a Model."""
    library, dtype, scalar = model.library, model.library.dtype, model.library.scalar
    targets = [targets] if isinstance(targets, IkTarget) else _list("ik", "targets", targets, IkTarget)
    q = model.neutral() if q is None else _numbers("ik", "q", q, (model.nq,), dtype).copy()
    rows = (structure("rbd_ik_target", scalar) * max(len(targets), 1))()
    for number, given in enumerate(targets):
        _target(model, number, given, rows[number])

    flags = None if held is None else _mask("ik", "held", held, model.nv)
    c_options = structure("rbd_ik_options", scalar)(
        held=None if flags is None else flags.ctypes.data,
        **{name: _int(_whole("ik", name, value)) if name in ("starts", "evaluations") else _number("ik", name, value)
           for name, value in options.items()})
    result = structure("rbd_ik_result", scalar)()
    with model._lock:
        address = model._address("model")
        size = library.call("ik_size", address, len(targets), result=ctypes.c_size_t)
        status = library.call("ik", address, model._address("work"), rows, len(targets), c_options,
                              ctypes.create_string_buffer(max(size, 1)), ctypes.c_size_t(size), q, result)
        text = ctypes.create_string_buffer(200)
        library.call("ik_text", status, result, text, ctypes.c_size_t(len(text)), result=ctypes.c_void_p)
    if status < 0:
        raise RbdError(Status(result.error), f"ik: {text.value.decode()}")
    return IkResult(q, IkStatus(status), *(getattr(result, name) for name in IkResult._fields[2:]))
