# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Arguments and results: their names, shapes and meanings, and the checks of what a user gives."""
from __future__ import annotations

import difflib
import functools
import math
import operator
import re

import numpy as np

# Name, shape and meaning of all arguments and results. Docstrings, checks and type stubs are made from it.
_QUANTITIES = {name: (shape, text) for name, shape, text in (re.split(r"\s{2,}", line) for line in """
q             nq       configuration: rad, m, quaternions (x, y, z, w)
q0            nq       configuration
q1            nq       configuration
q_next        nq       configuration
v_next        nv       velocity
q_near        nq       configuration
rates         nq       dq/dt, of quaternions and (cos, sin) too
v             nv       velocity: rad/s, m/s; of a free base (omega; v) in body axes
v_plus        nv       velocity after the impact
v_near        nv       velocity
a             nv       acceleration dv/dt: rad/s^2, m/s^2
d             nv       tangent step: rad, m
tau           nv       torque or force of each degree of freedom: N m, N
c             nv       bias force: N m, N
g             nv       gravity torque: N m, N
p             nv       generalized momentum M v
ctv           nv       C' v
b             nv       right-hand side
x             nv       solution
given         nv       1 where the acceleration is given, 0 where the torque is
f_ext         nb 6     wrench (moment; force) on each body, in its axes, at its origin: N m, N; None = none
wrench        nb 6     wrench (moment; force) on each body from its joint, in its axes, at its origin: N m, N
M             nv nv    mass matrix: kg m^2, kg m, kg
Minv          nv nv    inverse of the mass matrix
C             nv nv    Coriolis matrix
H             nh       mass matrix, packed (packed_size, packed_index)
L             nh       factor of the mass matrix, packed
dtau_dq       nv nv    row: torque; column: tangent step of q
dtau_dv       nv nv    row: torque; column: velocity
dg_dq         nv nv    row: torque; column: tangent step of q
da_dq         nv nv    row: acceleration; column: tangent step of q
da_dv         nv nv    row: acceleration; column: velocity
da_dtau       nv nv    row: acceleration; column: torque
dnext_dq      nv nv    row: tangent step of q_next; column: of q
dnext_dv      nv nv    row: tangent step of q_next; column: velocity
dq_next_dq    nv nv    row: tangent step of q_next; column: of q
dq_next_dv    nv nv    row: tangent step of q_next; column: velocity
dq_next_dtau  nv nv    row: tangent step of q_next; column: torque
dv_next_dq    nv nv    row: v_next; column: tangent step of q
dv_next_dv    nv nv    row: v_next; column: velocity
dv_next_dtau  nv nv    row: v_next; column: torque
dd_dq0        nv nv    row: d; column: tangent step of q0
dd_dq1        nv nv    row: d; column: tangent step of q1
Y             nv 10nb  torque regressor: Y pi of all bodies, one after the other
Y_kinetic     10nb     regressor of the kinetic energy
Y_potential   10nb     regressor of the potential energy
pi            10       m, m c (3), and xx xy xz yy yz zz of the inertia about the link's origin, link axes
kinetic       -        J, the rotors' included
potential     -        J, zero at the world's origin
R             3 3      turns link vectors into world vectors
position      3        world frame: m
velocity      6        (omega; v): rad/s, m/s
acceleration  6        (angular; linear): rad/s^2, m/s^2
point         3        fixed in the body, link axes: m; None = the link's origin
f             6        wrench (moment about the point; force): N m, N
row           6        the wrench at the body's origin, in its axes: its row of f_ext
J             6 nv     row: (omega; v); column: degree of freedom
J_dot         6 nv     dJ/dt: 1/s times the entries of J
A             6 nv     centroidal momentum matrix
A_dot_v       6        dA/dt v
h             6        momentum (angular about the centre of mass; linear), world axes
h_dot         6        its rate: N m, N
gamma         rows     dJ/dt v
e             rows     position error: rad, m
lambda_       rows     (moment about frame 1's origin; force) of body 2 on body 1, axes of frame 2: N m, N
impulse       rows     the same of an impact: N m s, N s
dlambda_dq    rows nv  row: constraint force; column: tangent step of q
dlambda_dv    rows nv  row: constraint force; column: velocity
dlambda_dtau  rows nv  row: constraint force; column: torque
actuated      nv       1 where there is a motor, else 0; None = all but floating joints
weight        rows     from 0; None = 1
distance      -        rad, if lengths have weights of 1 / length^2 or 0
s             -        part of the way: 0 is q0, 1 is q1
damping       nv       implicit: tau acts as tau - damping v_next; of a controller kd + dt kp / 2; None = 0
dt            -        s
restitution   -        0 (nothing rebounds) to 1
body          -        index, or name of the link
reference     -        index, or name of the link; -1 = the world
axes          -        "world" or "link": the axes of the six components
""".strip().splitlines())}
_SCALARS = ["dt", "restitution", "s"]        # are numbers in C
_INTEGERS = ["body", "reference", "axes"]    # are whole numbers in C
_GAINS = ["restitution", "weight", "dt"]     # have a range: ERR_RANGE
_MASKS = {"given": np.dtype(np.uint8), "actuated": np.dtype(np.uint8)}  # are 0 or 1 in C


@functools.lru_cache(maxsize=None)
def _attributes(kind):
    """Names of the attributes that a class declares, those that it inherits too."""
    parts = [part for part in kind.__mro__ if part is not object]
    names = {name: None for part in reversed(parts) for name in getattr(part, "__annotations__", {})}
    values = {name: None for part in parts for name, value in vars(part).items()
              if not callable(value) and not isinstance(value, (classmethod, staticmethod, property))}
    return [name for name in {**names, **values} if not name.startswith("_")]


class _Declared:
    """Refuses to set an attribute that its class does not declare: a misspelt one would change nothing. Classes of
    a user that inherit may have others."""

    def __setattr__(self, name, value):
        kind = type(self)
        ours = kind.__module__.partition(".")[0] == __package__
        if ours and not name.startswith("_") and name not in _attributes(kind):
            raise AttributeError(f"{kind.__name__}: " + (f"'{name}' cannot be set" if hasattr(kind, name) else
                                                         f"'{name}' is no attribute; {_meant(kind, name)}"))
        super().__setattr__(name, value)


def _meant(kind, name):
    """Which attribute or call of a class a name may mean."""
    known, calls = _attributes(kind), [word for word in dir(kind) if not word.startswith("_")]
    near = difflib.get_close_matches(name, known, 1) or difflib.get_close_matches(name, calls, 1)
    return f"did you mean '{near[0]}'?" if near else f"there are: {', '.join(known)}"


def _shape(text, dims):
    """A shape, "nv 10nb", in numbers."""
    factors = (re.fullmatch(r"(\d*)([a-z]*)", word).groups() for word in text.replace("-", "").split())
    return tuple(int(number or 1) * (dims[name] if name else 1) for number, name in factors)


def _array(call, name, value, dtype=np.dtype(float)):
    """value as an array of real numbers, or of whole numbers if dtype is such; refuses others by name."""
    if value is None:
        raise TypeError(f"{call}: {name} is missing")
    parts = value if isinstance(value, (list, tuple)) else (value,)
    if any(isinstance(part, (np.ma.MaskedArray, type(np.ma.masked))) for part in parts):
        raise TypeError(f"{call}: {name} is a masked array, and its mask would be lost: fill it (.filled), "
                        "or leave the masked entries out (.compressed)")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError) as error:
        raise TypeError(f"{call}: {name} is not an array of numbers: {error}") from None
    kinds, what = ("biuf", "real") if dtype.kind == "f" else ("biu", "whole")
    if array.dtype.kind not in kinds or array.dtype.kind == "b" and not array.ndim:
        found = {"O": "Python objects", "U": "text", "S": "bytes", "V": "records"}.get(array.dtype.kind, "")
        found += f" ({array.dtype})" if found else str(array.dtype)
        if array.dtype.kind == "O" and array.size:
            found += f" such as {array.flat[0]!r:.60}"
        raise TypeError(f"{call}: {name} must be {what} numbers, not {found}")
    return array


def _ndim(call, name, value):
    """How many axes a value has; refuses rows of different lengths by name."""
    try:
        return np.ndim(value)
    except ValueError as error:
        raise TypeError(f"{call}: {name} is not an array of numbers: {error}") from None


def _numbers(call, name, value, shape, dtype=np.dtype(float), symbols=None):
    """An array of finite numbers of this type and shape, in one piece; refuses others by name. A `None` in
    the shape is any length. symbols: the shape in words, for messages."""
    array = _array(call, name, value, dtype)
    if array.ndim != len(shape) or not _ends_in(array.shape, shape):
        raise _wrong_shape(call, name, array.shape, shape, symbols or shape)
    return _checked(call, name, array, dtype)


def _checked(call, name, array, dtype):
    """The array in this type and in one piece; refuses numbers that C cannot take."""
    if name in _MASKS:
        bad = np.argwhere((array != 0) & (array != 1))
        if len(bad):
            raise ValueError(f"{call}: {name} must be 0 or 1 for each degree of freedom, not "
                             f"{array[tuple(bad[0])]} as at {bad[0].tolist()}")
    if array.dtype != dtype or not array.flags.c_contiguous:
        with np.errstate(over="ignore"):  # too large for float: infinite, which is refused next
            array = np.ascontiguousarray(array, dtype).reshape(array.shape)
    _finite(call, name, array)
    return array


def _broadcast(call, inputs, dtype):
    """The axes of the states, and an array (states, *core) for each input (name, value, core, symbols): the
    last axes of a value are the core, those before count states and are broadcast, as everywhere in numpy."""
    arrays = {}
    for name, value, core, symbols in inputs:
        array = _array(call, name, value, _MASKS.get(name, dtype))
        if not _ends_in(array.shape, core):
            raise _wrong_shape(call, name, array.shape, core, symbols, more=True)
        arrays[name] = _checked(call, name, array, _MASKS.get(name, dtype)), core
    loops = {name: array.shape[:array.ndim - len(core)] for name, (array, core) in arrays.items()}
    length = max(map(len, loops.values()), default=0)
    shape, chosen = [1] * length, [""] * length
    for name, loop in loops.items():
        for k, size in enumerate(loop, length - len(loop)):
            if size != 1:
                if chosen[k] and size != shape[k]:
                    raise ValueError(f"{call}: the numbers of states differ: " + ", ".join(
                        f"{who} {arrays[who][0].shape} has {n} in axis {k - length + len(loops[who])}"
                        for who, n in ((chosen[k], shape[k]), (name, size))))
                shape[k], chosen[k] = size, name
    loop, n = tuple(shape), math.prod(shape)
    return loop, {name: (array if array.shape == loop + core else np.ascontiguousarray(
        np.broadcast_to(array, loop + core))).reshape(n, *core) for name, (array, core) in arrays.items()}


def _ends_in(shape, core):
    """Whether the last axes of a shape are these."""
    return len(shape) >= len(core) and all(n in (None, m) for n, m in zip(core[::-1], shape[::-1]))


def _wrong_shape(call, name, found, core, symbols, more=False):
    """The error for a wrong shape: which argument, which axis, which sizes. symbols: the right shape in
    words; more: whether axes may stand before it."""
    more = more and len(found) > len(core)

    def text(sizes):
        words = ["..."] * more + ["n" if size is None else str(size) for size in sizes]
        return "(" + ", ".join(words) + ("," if len(words) == 1 else "") + ")"

    wanted = " = ".join(dict.fromkeys([text(symbols), text(core)]))
    where = ""
    if len(found) == len(core) or more:
        axis, size = next((k, size) for k, size in enumerate(core, len(found) - len(core))
                          if size not in (None, found[k]))
        where = f": axis {axis} is {found[axis]} long, not {size}"
    return ValueError(f"{call}: {name} must have the shape {wanted}, not {found}{where}")


def _finite(call, name, array, error=ValueError):
    """Refuses NaN and infinity, by name and index. Where the sum of squares is finite, all numbers are."""
    flat = array.reshape(-1)
    if array.dtype.kind == "f" and not math.isfinite(np.dot(flat, flat)):
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            where = ", ".join(map(str, bad[0]))
            raise error(f"{call}: {name}{f'[{where}]' if where else ''} is {array[tuple(bad[0])]}")


def _utf8(text):
    """A name as C's text. Bytes that are not UTF-8, as C may give them, are those that they were."""
    if not isinstance(text, str):
        raise TypeError(f"must be text, not {text!r:.60}")
    if "\0" in text:
        raise ValueError(f"{text!r} has a NUL, where text of C ends")
    try:
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raise ValueError(f"{text!r} is not text of Unicode") from None


def _text(where, name, value):
    """A field that is a name, as C's text; None of None."""
    try:
        return None if value is None else _utf8(value)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{where}, field '{name}' {error}") from None


def _numbered(word, number, row):
    """How messages call a row of a table: by its number, and its name if it has one."""
    name = getattr(row, "name", None)
    return f"{word} {number}" + (f" '{name}'" if isinstance(name, (str, int)) and name else "")


def _instance(call, name, value, kind):
    """A value of this class; refuses others by name."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise TypeError(f"{call}: {name} must be {article} {kind.__name__}, not {type(value).__name__}")
    return value


def _left_out(where, given, name, default):
    """Refuses a field that this kind of row does not read: it would be lost."""
    value = getattr(given, name)
    number = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not (value is None if default is None else number and value == default):
        raise ValueError(f"{where}, field '{name}': '{given.kind}' has none, but it is {value!r:.60}")


# What a target or task of a kind reads of its place, turn and axis.
_READS = {"point": "position", "pose": "position rotation", "relative": "position rotation", "rotation": "rotation",
          "axis": "axis direction", "com": "position"}


def _placed(where, kind, field, numbers):
    """The numbers of a field, which must be 0 if this kind of target or task does not read it."""
    if field in ("position", "rotation", "axis", "direction") and numbers.any():
        if field not in _READS.get(kind.name.lower(), "").split():
            reads = ", ".join(name for name, read in _READS.items() if field in read.split())
            raise ValueError(f"{where}, field '{field}': '{kind.name.lower()}' does not read it; these do: {reads}")
    return numbers


def _model(call, value):
    """A Model; refuses others."""
    from ._model import Model  # which imports this module
    return _instance(call, "model", value, Model)


def _is_list(value):
    """Whether a value has entries in an order; text and a dict have not."""
    return hasattr(value, "__iter__") and not isinstance(value, (str, bytes, dict)) and getattr(value, "ndim", 1) > 0


def _entries(call, name, value, kind):
    """The entries of a list, which should be of this class; refuses a single one, and what is no list."""
    if isinstance(value, kind) or not _is_list(value):
        raise TypeError(f"{call}: {name} must be a list of {kind.__name__}, not {type(value).__name__}")
    return list(value)


def _list(call, name, value, kind):
    """A list whose entries are all of this class; refuses others by name and number."""
    entries = _entries(call, name, value, kind)
    for number, entry in enumerate(entries):
        _instance(call, f"{name.rstrip('s')} {number}", entry, kind)
    return entries


def _mask(call, name, value, n, of="degree of freedom"):
    """Flags of n things, 0 or 1."""
    flags = _numbers(call, name, value, (n,))
    if ((flags != 0) & (flags != 1)).any():
        raise ValueError(f"{call}: {name} must be 0 or 1 for each {of}")
    return flags.astype(np.uint8)


def _int(index):
    """An index as a C int: one that does not fit becomes the largest or smallest, which is as unknown."""
    return max(-2**31, min(index, 2**31 - 1))


def _whole(call, name, value):
    """A whole number."""
    try:
        if not isinstance(value, (bool, np.bool_)):
            return operator.index(value)
    except TypeError:
        pass
    raise TypeError(f"{call}: {name} must be a whole number, not {value!r:.60}")


def _flag(call, name, value):
    """True or False."""
    if isinstance(value, (bool, np.bool_)) or isinstance(value, (int, np.integer)) and value in (0, 1):
        return bool(value)
    raise TypeError(f"{call}: {name} must be True or False, not {value!r}")


def _axes(call, value):
    """The enumerator of rbd_axes."""
    if not isinstance(value, str) or value not in ("world", "link"):
        raise ValueError(f"{call}: axes must be 'world' or 'link', not {value!r}")
    return int(value == "link")


def _number(call, name, value):
    """A finite number."""
    if isinstance(value, (str, bytes, bool, np.bool_)) or getattr(value, "ndim", 0):  # which float() would read
        raise TypeError(f"{call}: {name} must be a number, not {value!r:.60}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{call}: {name} must be a number, not {value!r:.60}") from None
    except OverflowError:  # a whole number of Python has no limit
        raise ValueError(f"{call}: {name} is too large for a float") from None
    if not math.isfinite(number):
        raise ValueError(f"{call}: {name} is {number}")
    return number
