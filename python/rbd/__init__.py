# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""rbd from Python: rigid-body dynamics of robots by rbd.h, on ctypes and numpy.

    import rbd
    model = rbd.Model.from_urdf("robot.urdf", floating=True)            # or a C table:
    model = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"))
    tau = model.rnea(q, v, a)                                           # one state: q nq, v and a nv
    tau = model.rnea(Q, V, A)                                           # n states: Q n x nq, V and A n x nv
    tau = model.rnea(Q, v, a)                                           # n states of the same v and a

The first use compiles rbd.h and its companions with the C compiler of this machine. That takes half a minute
to a minute; a line on standard error says so, unless $RBD_QUIET is set. The result stays in a cache folder
($RBD_CACHE, else ~/.cache/rbd), so that later uses start at once. A `Library` chooses the scalar and the
compiler's flags.

Every call has its name in C without `rbd_`, and the same contract. In short (rbd.h, [conventions]): SI units;
spatial vectors are angular first, (omega; v) and (moment; force); quantities of a body are in its own link
frame, at its origin; matrices are row-major; quaternions are (x, y, z, w). `nb`, `nq`, `nv` are the numbers
of bodies, coordinates and degrees of freedom, which stand in the order of the description.

- Inputs: anything that numpy turns into an array of real numbers of the right shape. Results are new arrays.
  Wrong shapes and types, masked arrays, NaN and infinity are refused by name (ValueError, TypeError) before C
  is called. A result that overflows is a FloatingPointError.
- Broadcasting is numpy's. The last axes of an argument are those of one state, as its help says; axes before
  them count states, and are broadcast against those of the other arguments. `rnea` of q (100, nq), v (nv,)
  and a (100, nv) gives (100, nv); q (20, 5, nq) gives (20, 5, nv).
- An error of the library is an `RbdError` with its `status` and a sentence.
- A call with several results gives a named tuple, in C's order. Results that C can leave out have a keyword:
  `model.id_derivatives(q, v, a, M=False).M` is None, and is not computed.
- Threads: C runs without Python's lock. Calls of one Model wait for each other; those of two run side by side
  (`model.copy()` is cheap). A Model keeps what `kinematics` computed: give each thread its own Model.
"""
from __future__ import annotations

import copy
import ctypes
import difflib
import enum
import functools
import hashlib
import inspect
import math
import operator
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from collections import namedtuple
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Iterable, Literal, Mapping, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["AxisAngle", "Body", "Constraint", "ConstraintSet", "Contact", "ContactOptions", "ContactResult",
           "ContactSet", "ContactSolution", "ContactState", "Frame", "JointInfo", "JointType", "Library",
           "Model", "Placement", "RbdError", "RbdWarning", "SOURCES", "Spatial", "Status", "Urdf",
           "UrdfStatus", "load_table", "load_urdf", "parse_urdf"]

Array = NDArray[Any]                                # of the library's scalar
Numbers = Union[Sequence[float], Array]             # in a description
Matrix = Sequence[Sequence[float]]


def __dir__():
    """The public names alone."""
    return [*__all__, "__doc__", "__file__", "__name__", "__version__"]


# ---- what the headers say: versions, enumerations, structures ----

def _find_sources():
    """The folder of rbd.h: beside this file where it is installed, above it in the repository."""
    here = Path(__file__).resolve().parent
    places = here / "sources", here.parents[1]
    for folder in places:
        if (folder / "rbd.h").is_file():
            return folder
    raise ImportError("rbd.h is neither in {} nor in {}".format(*places))


SOURCES: Path = _find_sources()  #: folder of rbd.h and of models/
_HEADERS = {name: (SOURCES / name).read_text() for name in
            ("rbd.h", "rbd_derivatives.h", "rbd_constraints.h", "rbd_contact.h", "rbd_batch.h", "rbd_spatial.h", "rbd_urdf.h")}
_TEXT = "\n".join(_HEADERS.values())
__version__: str = re.search(r'#define RBD_VERSION "(.*)"', _TEXT)[1]


def _enumerators(name, text):
    """The enumerators of a C enum, {name: value}."""
    body = re.search(rf"typedef enum {name} \{{(.*?)\}} {name};", text, re.S)[1]
    value, found = -1, {}
    for item in re.sub(r"/\*.*?\*/", "", body, flags=re.S).split(","):
        key, _, number = item.partition("=")
        value = int(number) if number else value + 1
        found[key.strip()] = value
    return found


def _enum(python_name, c_name, prefix):
    """A C enum as one of Python, without the prefix of its names."""
    members = {key[len(prefix):]: value for key, value in _enumerators(c_name, _TEXT).items()}
    return enum.IntEnum(python_name, members, module=__name__)


Status = _enum("Status", "rbd_status", "RBD_")
UrdfStatus = _enum("UrdfStatus", "rbd_urdf_status", "RBD_URDF_")
JointType = _enum("JointType", "rbd_joint_type", "RBD_")
ContactState = _enum("ContactState", "rbd_contact_state", "RBD_")


@functools.lru_cache(maxsize=None)
def structure(name, real=ctypes.c_double, text=_TEXT):
    """A C struct of a header as a ctypes.Structure of the same layout; `real` is rbd_real and rbd_const."""
    known = {"double": ctypes.c_double, "int": ctypes.c_int, "size_t": ctypes.c_size_t, "char": ctypes.c_char,
             "rbd_const": real, "rbd_real": real, "rbd_status": ctypes.c_int, "rbd_urdf_status": ctypes.c_int,
             "rbd_joint_type": ctypes.c_int}
    body = re.search(rf"typedef struct {name} \{{(.*?)\n\}} {name};", text, re.S)[1]
    members = []
    for declaration in re.sub(r"/\*.*?\*/", "", body, flags=re.S).split(";")[:-1]:
        base, rest = re.fullmatch(r"\s*(?:const )?(\w+)\s*(.*)", declaration, re.S).groups()
        for declarator in rest.split(","):
            member, length = re.search(r"(\w+)\s*(?:\[(\w+)\])?$", declarator.strip()).groups()
            if declarator.count("*") == 1 and base == "char":
                kind = ctypes.c_char_p
            elif "*" in declarator:
                kind = ctypes.c_void_p
            else:
                kind = known.get(base) or structure(base, real, text)
            if length:
                kind *= int(length if length.isdigit() else re.search(rf"#define {length} (\d+)", text)[1])
            members.append((member, kind))
    return type(name, (ctypes.Structure,), {"_fields_": members})


class RbdError(Exception):
    """An error of the library.

    status   a Status, or a UrdfStatus where a URDF is read
    results  the results of the call that are valid all the same: of n states those that have no error
    """
    status: Status | UrdfStatus
    results: Any

    def __init__(self, status: Status | UrdfStatus, text: str, results: Any = None):
        super().__init__(text)
        self.status = status
        self.results = results

    def __reduce__(self):
        return RbdError, (self.status, str(self), self.results)


class RbdWarning(UserWarning):
    """Something in a description or a URDF file is odd, but rbd can compute with it."""


def _warn(sentences):
    """Warns, at the line that called this module."""
    level, frame = 2, sys._getframe(1)
    while frame and frame.f_globals is globals():
        level, frame = level + 1, frame.f_back
    for sentence in sentences:
        warnings.warn(sentence, RbdWarning, stacklevel=level)


def _python_words(text):
    """A sentence of the library with Python's names: no prefix, options as keywords. Names of bodies and
    joints, in quotes, stay as they are, and so do macros."""
    def word(found):
        option, value = found.groups()
        if not option:
            return found[0] if found[0].startswith("'") else ""
        option = option.replace("-", "_")
        flags = "floating", "keep_all", "lock_massless", "strict", "messages"
        return f"{option}={value}" if value else f"{option}=True" if option in flags else option

    return re.sub(r"'[^']*'|(?:options\.\w+, )?(?:rbd-\w+ )?(?<![\w-])--([a-z][a-z-]*)(?: ('[^']*'))?|"
                  r"\b(?:RBD_(?!NO_)(?:URDF_)?|rbd_(?:urdf_)?)(?=\w)", word, text)


# ---- compiling ----

def _run(command):
    """Runs a compiler or the like and gives what it prints. An error says which command, how it ended, and
    what it printed."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace")
    except OSError as error:
        raise RuntimeError(f"rbd needs '{command[0]}': {error.strerror}") from None
    if done.returncode:
        status = done.returncode
        try:
            ended = f"exit status {status}" if status > 0 else f"killed by {signal.Signals(-status).name}"
        except ValueError:
            ended = f"killed by signal {-status}"
        if status == -signal.SIGKILL:
            ended += " (out of memory?)"
        printed = done.stdout.strip()
        raise RuntimeError(f"{shlex.join(command)}: {ended}; it printed" +
                           (f":\n{printed}" if printed else " nothing"))
    return done.stdout


# For code that computes no dynamics: without forced inlining the headers compile in a third of the time.
_QUICK = ["-O0"]


def _c_compiler():
    """The C compiler where none is named, as a list of words."""
    return _words("$CC", os.environ.get("CC", "").strip() or "cc")


def _words(name, text):
    """A command or flags, text as in a shell, as a list of words."""
    if not isinstance(text, str):
        raise TypeError(f"{name} must be text, as in a shell, not {text!r}")
    try:
        return shlex.split(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}: {text!r}") from None


def _cache():
    """The folder of compiled libraries."""
    caches = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser()
    folder = Path(os.environ.get("RBD_CACHE") or caches / "rbd")
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise RuntimeError(f"{folder}: {error.strerror}; "
                           "set $RBD_CACHE to a folder for compiled libraries") from None
    return folder


def _compile(units, command, libraries=(), what=""):
    """A shared library of the units, texts of C or C++, from the cache if it is there. Its name is the hash
    of all inputs. It is moved into its place when complete, so that several processes may do this at once.
    `what` is said on standard error beforehand."""
    language = "c++" if "++" in command[0] else "c"
    # The compiler's macros tell its version, and what -march=native is on this machine.
    machine = _run([*command, "-dM", "-E", "-x", language, os.devnull])
    digest = hashlib.sha256("\0".join([machine, *command, *libraries, *units, _TEXT]).encode())
    path = _cache() / f"{digest.hexdigest()[:32]}.so"
    if path.exists():
        return ctypes.CDLL(str(path))
    if what and not os.environ.get("RBD_QUIET"):
        print(f"rbd: compiling {what}; this is done once, the result is kept: {path} "
              "(RBD_QUIET=1 hides this line)", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        objects = [f"{folder}/{k}.o" for k in range(len(units))]

        def compile_unit(number):
            source = f"{folder}/{number}.{language}"
            Path(source).write_text(units[number])
            try:
                _run([*command, "-fPIC", f"-I{SOURCES}", "-x", language, "-c", source, "-o", objects[number]])
            except RuntimeError as error:
                failures.append(error)

        failures = []
        threads = [threading.Thread(target=compile_unit, args=(k,)) for k in range(len(units))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if failures:
            raise failures[0]
        _run([*command, "-shared", *objects, "-o", f"{folder}/library", *libraries])
        try:
            os.replace(f"{folder}/library", path)
        except FileNotFoundError:
            raise RuntimeError(f"'{shlex.join(command)}' wrote no library: is it a compiler?") from None
    return ctypes.CDLL(str(path))


_SINGLE = """
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_contact.h"
#include "rbd_spatial.h"
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


class Library:
    """rbd.h and its companions, compiled for one scalar.

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
        if flags is None:
            flags = os.environ.get("RBD_FLAGS") or "-O3 -march=native -ffp-contract=fast"
        self.real = real
        self.scalar = {"double": ctypes.c_double, "float": ctypes.c_float}[real]
        self.dtype = np.dtype(real.replace("float", "float32"))
        compiler = _words("compiler", compiler or "") or _c_compiler()
        command = [*compiler, *_words("flags", flags), f"-DRBD_REAL={real}", "-Wno-psabi"]
        self._c = _compile([_SINGLE + _spatial_unit(), _batch_unit(real, lanes)], command, ["-lm"],
                           f"rbd.h for {real}, which takes half a minute to a minute")
        self.lanes = self.call("batch_lanes")
        self.spatial = Spatial(self)

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
        lower = _numbers(name, "lower", np.asarray(lower, float), (None,), dtype)
        upper = _numbers(name, "upper", np.asarray(upper, float), lower.shape, dtype)
        n, bounded = len(friction), len(lower)
        rows = 3 * n + bounded
        arrays = {"delta": _numbers(name, "delta", delta, (rows, rows), dtype), "friction": friction,
                  "b": _numbers(name, "b", b, (rows,), dtype), "lower": lower, "upper": upper}
        p = np.zeros(rows, dtype) if start is None else _numbers(name, "start", start, (rows,), dtype).copy()
        state = (ctypes.c_int * max(n, 1))()
        problem = structure("rbd_contact_problem", self.scalar)(
            contacts=n, bounded=bounded, tolerance=_number(name, "tolerance", tolerance),
            iterations=_int(_whole(name, "iterations", iterations)),
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


# ---- arguments ----

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
actuated      nv       1 where there is a motor, else 0; None = all but floating joints at the root
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
    if array.dtype.kind not in kinds:
        found = {"O": "Python objects", "U": "text", "S": "bytes", "V": "records"}.get(array.dtype.kind, "")
        found += f" ({array.dtype})" if found else str(array.dtype)
        if array.dtype.kind == "O" and array.size:
            found += f" such as {array.flat[0]!r:.60}"
        raise TypeError(f"{call}: {name} must be {what} numbers, not {found}")
    return array


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
        raise TypeError(f"must be text, not {text!r}")
    if "\0" in text:
        raise ValueError(f"{text!r} has a NUL, where text of C ends")
    try:
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raise ValueError(f"{text!r} is not text of Unicode") from None


def _int(index):
    """An index as a C int: one that does not fit becomes the largest or smallest, which is as unknown."""
    return max(-2**31, min(index, 2**31 - 1))


def _whole(call, name, value):
    """A whole number."""
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{call}: {name} must be a whole number, not {value!r}") from None


def _flag(call, name, value):
    """True or False."""
    if isinstance(value, (bool, np.bool_)) or isinstance(value, int) and value in (0, 1):
        return bool(value)
    raise TypeError(f"{call}: {name} must be True or False, not {value!r}")


def _axes(call, value):
    """The enumerator of rbd_axes."""
    if not isinstance(value, str) or value not in ("world", "link"):
        raise ValueError(f"{call}: axes must be 'world' or 'link', not {value!r}")
    return int(value == "link")


def _number(call, name, value):
    """A finite number."""
    if isinstance(value, (str, bytes)):  # which float() would read
        raise TypeError(f"{call}: {name} must be a number, not {value!r}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{call}: {name} must be a number, not {value!r}") from None
    if not math.isfinite(number):
        raise ValueError(f"{call}: {name} is {number}")
    return number


# ---- calls ----

def _c(memory, gives="", batch=False, struct=False, c_name="", c_inputs="", **shapes):
    """Makes a method from its signature and docstring: it calls the C function of that name, after `rbd_`.

    The method's parameters are the inputs, in C's order, and then keywords that leave results out.
    c_name   the C function, where the method has another name
    c_inputs the inputs in C's order, where the method has another
    memory   the memory that C computes in, besides the model
    gives    the results in C's order; "dtau_dq?" is left out where the keyword dtau_dq is False, "A_dot_v?v"
             where v is None
    batch    whether C has the call for n states, as rbd_batch_...
    struct   whether C takes the results as a struct of pointers
    shapes   of quantities that have another shape here than in the table
    """
    def make(method):
        call = _Call(method, memory, gives, batch, struct, c_name, c_inputs, shapes)
        parameters = ", ".join(list(inspect.signature(method).parameters)[1:])
        # A lambda with this signature: Python itself then sorts out the arguments.
        source = (f"lambda {str(inspect.signature(method))[1:-1]}: "
                  f"(self._calls.get('{method.__name__}') or self._bind(call))({parameters})")
        wrapper = functools.update_wrapper(eval(source, {"call": call}), method)
        wrapper.__doc__ = call.documentation(method)
        wrapper._rbd_call = call
        return wrapper
    return make


def _results(call, *names):
    """A named tuple for the results of a call, in this module so that it can be pickled."""
    kind = globals()[f"{call}_results"] = namedtuple(f"{call}_results", names)
    return kind


class _Call:
    """A method's call of C: memory, inputs, outputs."""

    def __init__(self, method, memory, gives, batch, struct, c_name, c_inputs, shapes):
        self.name = method.__name__
        self.c_name = c_name or self.name
        self.memory = memory.split()
        self.batch = batch
        self.struct = struct
        parameters = list(inspect.signature(method).parameters.values())[1:]
        self.inputs = [p.name for p in parameters if p.kind is not p.KEYWORD_ONLY]
        self.c_inputs = c_inputs.split() or self.inputs
        self.optional = {p.name for p in parameters
                         if p.default is None or "None = " in _QUANTITIES.get(p.name, ("", ""))[1]}
        names = [p.name for p in parameters]
        self.keywords = dict(list(enumerate(names))[len(self.inputs):])  # parameters that leave results out
        self.outputs, self.flags = [], []  # names, and the parameter that decides on each, None: always there
        for item in gives.split():
            name, question, flag = item.partition("?")
            self.outputs.append(name)
            self.flags.append(names.index(flag or name) if question else None)
        self.shapes = {name: shapes.get(name, _QUANTITIES[name][0]) for name in self.inputs + self.outputs}
        self.symbols = {name: tuple(shape.replace("-", "").split()) for name, shape in self.shapes.items()}
        self.tuple = _results(self.c_name, *self.outputs) if len(self.outputs) > 1 else None

    def results(self, values):
        """One result, or a named tuple of several, or None."""
        return self.tuple(*values) if self.tuple else next(iter(values), None)

    def documentation(self, method):
        """The method's docstring, with shape and meaning of the arguments and results."""
        def lines(names):
            for name in names:
                shape = self.shapes[name].replace(" ", " x ").replace("-", "")
                yield f"    {name:<12} {shape:<9} {_QUANTITIES[name][1]}"
        text = [inspect.getdoc(method), "", *lines(self.inputs)]
        if self.outputs:
            text += ["gives", *lines(self.outputs)]
            if set(self.inputs) - set(_INTEGERS):
                text += ["Axes before these count states, and are broadcast: " +
                         ("C computes them together." if self.batch else "one call of C for each state.")]
        return "\n".join(text)


class _Bound:
    """A call of one object, with memory: inputs are copied into one array, results out of another, so that
    all of C's arguments but numbers and NULL are the same each time."""

    def __init__(self, call, owner):
        self.call, self.owner, self.lock = call, owner, owner._lock
        library = owner.library
        self.cores = {name: _shape(shape, owner._dims) for name, shape in call.shapes.items()}
        self.function = library.function(call.c_name, arguments=[
            library.scalar if name in _SCALARS else ctypes.c_int if name in _INTEGERS else ctypes.c_void_p
            for name in ["model", *call.memory, *call.c_inputs, *(["out"] if call.struct else call.outputs)]])
        arrays = [name for name in call.inputs if name not in _SCALARS + _INTEGERS]
        self.arena, views = self._carve([name for name in arrays if name != "actuated"])
        if "actuated" in arrays:
            views["actuated"] = np.zeros(owner.nv, np.uint8)
        self.output, results = self._carve(call.outputs)
        self.views = list(results.values())
        self.arguments = [owner._address(kind).value for kind in ["model", *call.memory]]
        self.inputs = [(len(self.arguments) + call.c_inputs.index(name), name, views.get(name),
                        name in call.optional) for name in call.inputs]
        self.arguments += [views[name].ctypes.data if name in views else None for name in call.c_inputs]
        self.results_at = len(self.arguments)
        self.arguments += [view.ctypes.data for view in self.views]
        self.flagged = [(place, flag) for place, flag in enumerate(call.flags, self.results_at)
                        if flag is not None]
        self.plain = len(self.views) == 1 and self.views[0].ndim > 0

    def _carve(self, names):
        """An array of numbers, and the part of it for each name."""
        shapes = {name: self.cores[name] for name in names}
        arena, start, views = np.zeros(sum(map(math.prod, shapes.values())), self.owner.library.dtype), 0, {}
        for name, shape in shapes.items():
            views[name] = arena[start:start + math.prod(shape)].reshape(shape)
            start += math.prod(shape)
        return arena, views

    def __call__(self, *values):
        arguments = self.arguments.copy()
        with self.lock:
            for (place, name, view, optional), value in zip(self.inputs, values):
                if value is None and optional:
                    arguments[place] = None
                elif view is None:
                    if name in _SCALARS and isinstance(value, (np.ndarray, list, tuple)) and np.ndim(value):
                        return self._many(values)
                    arguments[place] = self._convert(name, value)
                else:
                    if (type(value) is not np.ndarray or value.dtype is not view.dtype
                            or value.shape != view.shape or name in _MASKS):
                        value = _array(self.call.name, name, value, view.dtype)
                        if value.ndim > view.ndim:
                            return self._many(values)
                        value = _numbers(self.call.name, name, value, view.shape, view.dtype,
                                         self.call.symbols[name])
                    view[...] = value
            if not math.isfinite(self.arena.dot(self.arena)):
                self._refuse()
            for place, flag in self.flagged:
                if not self._wanted(flag, values[flag]):
                    arguments[place] = None
            results = arguments[self.results_at:]
            if self.call.struct:
                results = [(ctypes.c_void_p * len(results))(*results)]
            status = self.function(*arguments[:self.results_at], *results)
            if status or not math.isfinite(self.output.dot(self.output)):
                self._fail(status, arguments)
            return self.views[0].copy() if self.plain else self._results(arguments)

    def _convert(self, name, value):
        """An argument that is a number."""
        call = self.call.name
        return (_number(call, name, value) if name in _SCALARS else
                _axes(call, value) if name == "axes" else self.owner._body(value, call, name == "reference"))

    def _wanted(self, place, value):
        """Whether this value of a parameter asks for the results that it decides on."""
        if value is True or value is None or place not in self.call.keywords:
            return value is not None
        return _flag(self.call.name, self.call.keywords[place], value)

    def _results(self, arguments):
        """The results in memory of their own; None for those not wanted."""
        return self.call.results([None if argument is None else view.copy() if view.ndim else view.item()
                                  for argument, view in zip(arguments[self.results_at:], self.views)])

    def _refuse(self):
        """Names an input that is not finite, and forgets it."""
        try:
            for _, name, view, _ in self.inputs:
                if view is not None:
                    _finite(self.call.name, name, view)
        except ValueError:
            self.arena[...] = 0
            raise

    def _fail(self, status, arguments):
        """Raises the error of the call, if there is one, and forgets the results."""
        label = self.call.name
        if status == Status.ERR_RANGE:
            label += "".join(f": {name}" for name in self.call.inputs if name in _GAINS)
        try:
            if status:
                raise self.owner._error(label, status, self._results(arguments))
            for name, view in zip(self.call.outputs, self.views):
                _finite(self.call.name, name, view, FloatingPointError)
        except (RbdError, FloatingPointError):
            self.output[...] = 0
            raise

    def _many(self, values):
        """The same for many states: the arrays' axes before those of one state, broadcast. C computes them
        together where it has a batch of the call; else it is called for each."""
        call, owner = self.call, self.owner
        if not call.outputs:
            name, shape = next((name, np.shape(value)) for name, value in zip(call.inputs, values)
                               if np.ndim(value) > len(self.cores[name]))
            raise ValueError(f"{call.name}: {name} has the shape {shape}: this call takes one state, and "
                             "other calls read its results")
        blocks = call.batch and owner._layout() == "blocks"
        lanes = (owner.library.lanes,) if blocks else ()
        cores = {name: core + lanes for name, core in self.cores.items()}
        dtype, given = owner.library.dtype, dict(zip(call.inputs, values))
        loop, arrays = _broadcast(call.name, [
            (name, value, cores[name], call.symbols[name] + ("lanes",) * blocks)
            for name, value in given.items()
            if name not in _INTEGERS and (value is not None or name not in call.optional)], dtype)
        n = math.prod(loop)
        outputs = {name: np.zeros((n, *cores[name]), dtype) if flag is None or self._wanted(flag, values[flag])
                   else None for name, flag in zip(call.outputs, call.flags)}

        def results(found):
            return call.results([None if x is None else x.reshape(loop + x.shape[1:]) for x in found])

        if call.batch:
            return self._batch(arrays, outputs, loop, blocks, results)

        def one(k):
            found = self(*({**given, **{name: array[k] for name, array in arrays.items()}}).values(),
                         *values[len(given):])
            for array, result in zip(outputs.values(), found if call.tuple else [found]):
                if array is not None:
                    array[k] = result
        _for_each_state(loop, one)
        return results(outputs.values())

    def _batch(self, arrays, outputs, loop, blocks, results):
        """Calls C's batch."""
        call, owner = self.call, self.owner
        states = loop + (owner.library.lanes,) if blocks else loop
        inputs = [arrays.get(name) for name in call.inputs]
        memory = ["batch" if kind == "work" else f"batch_{kind}" for kind in call.memory]
        with owner._lock:
            layout = functools.partial(owner.library.call, "batch_set_layout", owner._address("batch"))
            layout(int(blocks))
            try:
                return owner._run(f"batch_{call.name}", memory, [math.prod(states), *inputs], outputs,
                                  results, call.name, states)
            finally:
                layout(0)


def _for_each_state(loop, one):
    """Calls one(k) for all states; an error says which state it was."""
    for k in range(math.prod(loop)):
        try:
            one(k)
        except (RbdError, FloatingPointError) as error:
            if loop:
                error.args, error.results = (f"{error}; state {_state(k, loop)}",), None
            raise


def _state(number, loop):
    """The index of a state, for messages."""
    return number if len(loop) < 2 else tuple(map(int, np.unravel_index(number, loop)))


class _Owner:
    """What Model, ConstraintSet and ContactSet have in common: memory for C, and the calls in it."""

    def __init__(self, library, lock):
        self.library, self._lock = library, lock
        self._calls, self._memories, self._addresses = {}, {}, {}

    def _address(self, kind):
        """Where this part of memory is; prepared when it is first asked for."""
        if kind not in self._addresses:
            with self._lock:
                if kind not in self._addresses:
                    self._prepare(kind)
        return self._addresses[kind]

    def _bind(self, call):
        """A method's call, made when it is first asked for."""
        with self._lock:
            if call.name not in self._calls:
                self._calls[call.name] = _Bound(call, self)
        return self._calls[call.name]

    def _run(self, function, memory, inputs, outputs, results=tuple, call=None, states=None, pointers=None):
        """Calls C with arrays that are right: whole numbers and inputs, then outputs by name. Gives
        results(outputs), checked. call: the name for messages; states: of a batch, the axes of its states;
        pointers: what C takes behind the inputs, if not all outputs."""
        call = call or function
        with self._lock:
            addresses = map(self._address, ["model", *memory])
            status = self.library.call(function, *addresses, *inputs,
                                       *(outputs.values() if pointers is None else pointers))
            if status:
                raise self._error(call, status, results(outputs.values()), states)
        for name, array in outputs.items():
            if array is not None:
                _finite(call, name, array, FloatingPointError)
        return results(outputs.values())


# ---- descriptions ----

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


_PER_DOF = ("armature", "damping", "friction")
_BODIES = ("parent", "body1", "body2")


def _to_c(values, row, where):
    """Writes a Body, Constraint, Contact or ContactOptions into a C struct."""
    for member, kind in row._fields_:
        value = getattr(values, member)
        if issubclass(kind, ctypes.Array):
            array = _array(f"{where}, field '{member}'", "it", value)
        try:
            if kind is ctypes.c_char_p:
                value = _utf8(value) if value is not None else None
            elif issubclass(kind, ctypes.Array):
                numbers = array.astype(float).reshape(-1)
                if member in _PER_DOF and np.ndim(value) == 0:
                    numbers = np.repeat(numbers, kind._length_)
                short = member in _PER_DOF and len(numbers) < kind._length_
                if len(numbers) != kind._length_ and not short:
                    raise ValueError(f"has {len(numbers)} numbers instead of {kind._length_}" +
                                     " (xx xy xz yy yz zz)" * (member == "inertia"))
                if kind._type_ is ctypes.c_int:
                    if (numbers != np.rint(numbers)).any():
                        raise ValueError("must be whole numbers")
                    numbers = map(int, numbers)
                value = kind(*numbers)
            elif member == "type":
                value = JointType[value.upper()] if isinstance(value, str) else JointType(value)
            elif kind is ctypes.c_int:
                if not hasattr(value, "__index__"):
                    raise TypeError("must be " + ("an index or a name" if member in _BODIES else
                                                  "a whole number") + f", not {value!r}")
                value = _int(operator.index(value))
            setattr(row, member, value)
        except KeyError:
            names = ", ".join(kind.name.lower() for kind in JointType if kind.name != "JOINT_TYPES")
            raise ValueError(f"{where}, field 'type': unknown joint type {value!r}; there are: "
                             f"{names}") from None
        except (TypeError, ValueError, AttributeError) as error:
            raise type(error)(f"{where}, field '{member}': {error}") from None


def _from_c(row):
    """The Body of a C struct."""
    values = {}
    for member, kind in row._fields_:
        value = getattr(row, member)
        if isinstance(value, bytes):
            value = value.decode(errors="replace")
        elif isinstance(value, ctypes.Array):
            value = tuple(value)
        values[member] = value
    values["type"] = JointType(row.type).name.lower()
    return Body(**values)


def _rows(bodies):
    """Bodies as an array of rbd_body."""
    index = {}
    rows = (structure("rbd_body") * len(bodies))()
    for number, body in enumerate(bodies):
        where = f"body {number}" + (f" '{body.name}'" if getattr(body, "name", None) else "")
        if not isinstance(body, Body):
            raise TypeError(f"{where}: must be a Body, not {type(body).__name__}")
        if isinstance(body.parent, str):
            if body.parent not in index:
                near = difflib.get_close_matches(body.parent, [name for name in index if name], 1)
                raise ValueError(f"{where}, field 'parent': no earlier body is called '{body.parent}'" +
                                 (f"; did you mean '{near[0]}'?" if near else ""))
            body = replace(body, parent=index[body.parent])
        _to_c(body, rows[number], where)
        index.setdefault(body.name, number)
    return rows


def load_table(path: str | os.PathLike[str], name: str | None = None) -> list[Body]:
    """The description in a C table, as rbd-model writes it and models/ has it: a list of Body. The file is
    compiled.

    path   of a C header with `static const rbd_body NAME_bodies[...]`
    name   of the array, where there are several
    """
    path = Path(path).resolve()
    try:
        text = path.read_text()
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not text in UTF-8") from None
    arrays = re.findall(r"\brbd_body\s+(\w+)\s*\[", text)
    if name is None and len(arrays) != 1 or name is not None and name not in arrays:
        raise ValueError(f"{path}: " + (f"has the arrays of rbd_body {', '.join(arrays)}" if arrays
                                        else "has no array of rbd_body" +
                                        ("; load_urdf reads URDF files" if "<robot" in text else
                                         "; a built model (rbd_model) is no description"
                                         if "rbd_model" in text else "")))
    array = name or arrays[0]
    unit = (f'#include "rbd.h"\n{text}\nconst rbd_body *const table = {array};\n'
            f"const int length = sizeof {array} / sizeof *{array};\n")
    library = _compile([unit], [*_c_compiler(), f"-I{path.parent}"])
    pointer = ctypes.POINTER(structure("rbd_body")).in_dll(library, "table")
    return [_from_c(pointer[k]) for k in range(ctypes.c_int.in_dll(library, "length").value)]


# ---- URDF files ----

_URDF = """
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#define RBD_URDF_IMPLEMENTATION
#include "rbd_urdf.h"
"""



class Frame(NamedTuple):
    """A link of a URDF: its place on the bodies, as rbd_urdf_frame."""
    link: str
    joint: str | None   #: that carries the link; None for the root
    parent: int         #: index of the frame that carries it, -1 = it is the root
    body: int           #: index of the body that it is, or is merged into, -1 = the world
    position: Array     #: 3, in that body's frame, m
    rotation: Array     #: 3 x 3, turns vectors of the link into vectors of that body


@dataclass
class Urdf:
    """The content of a URDF file: `Model(urdf)` takes it."""
    name: str           #: of the robot
    bodies: list[Body]
    frames: list[Frame]     #: all links, fixed ones too
    warnings: list[str]     #: sentences
    gravity: Numbers        #: world frame, m/s^2
    fixed_mass: float       #: kg, of the links that are fixed to the world: in no body


@functools.lru_cache(maxsize=None)
def _urdf_library():
    """The loader, compiled with urdfdom."""
    try:
        words = _run(["pkg-config", "--cflags", "--libs", "urdfdom"]).split()
    except RuntimeError as error:
        raise RuntimeError("URDF files need urdfdom, its headers and pkg-config (Debian: liburdfdom-dev "
                           "pkg-config). Without them a model is made of rows (Body) or of a C table "
                           f"(load_table), which rbd-model writes on another machine.\n{error}") from None
    libraries = [word for word in words if word.startswith(("-l", "-L"))]
    compiler = _words("$CXX", os.environ.get("CXX", "").strip() or "c++")
    command = [*compiler, *_QUICK, "-std=c++17", *(word for word in words if word not in libraries)]
    return _compile([_URDF], command, libraries, "rbd_urdf.h with urdfdom, which takes some seconds")


def _texts(call, what, names):
    """A name or several, as a list; refuses others."""
    try:
        names = [names] if isinstance(names, str) else list(names)
    except TypeError:
        names = [names]
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"{call}: {what} must be a name or a list of names, not {name!r}")
    try:
        return [_utf8(name) for name in names]
    except ValueError as error:
        raise ValueError(f"{call}: {what}: {error}") from None


def _urdf_options(call, *, floating: bool = False, root: str | None = None, root_joint: str | None = None,
                  gravity: ArrayLike | None = None, keep: str | Iterable[str] = (), keep_all: bool = False,
                  lock: str | Iterable[str] | Mapping[str, float] = (), lock_massless: bool = False,
                  strict: bool = False, messages: bool = False):
    """The options are those of the command-line tools (rbd-model --help).

    floating       the root link is on a floating joint, not fixed to the world
    root           take only this link, as the root, and its subtree; None = all
    root_joint     the name of the floating joint; None = "root"
    gravity        3, world frame, m/s^2; None = (0, 0, -9.81)
    keep           links on fixed joints to keep as bodies; others are merged: a name or several
    keep_all       keep all links on fixed joints
    lock           joints to hold still, and those that mimic them: {joint: value, rad or m}, or names (at 0)
    lock_massless  hold joints still that move no mass, which else are an error
    strict         warnings are errors
    messages       let urdfdom write its messages to standard error
    """
    names = {"root_link": root, "root_joint": root_joint}
    for name, value in names.items():
        option = name.replace("_link", "")
        if value is not None and not isinstance(value, str):
            raise TypeError(f"{call}: {option} must be a name or None, not {value!r}")
        names[name] = value if value is None else _texts(call, option, value)[0]
    flags = {"keep_all": keep_all, "lock_massless": lock_massless, "strict": strict, "messages": messages}
    flags = {name: _flag(call, name, value) for name, value in flags.items()}
    flags["show_messages"] = flags.pop("messages")
    g = None if gravity is None else (ctypes.c_double * 3)(*_numbers(call, "gravity", gravity, (3,)))
    kept = _texts(call, "keep", keep)
    kept = (ctypes.c_char_p * (len(kept) + 1))(*kept)
    values = [_number(call, f"lock['{joint}']", at) for joint, at in lock.items()] if isinstance(
        lock, Mapping) else None
    joints = _texts(call, "lock", lock)
    locks = (structure("rbd_urdf_lock") * (len(joints) + 1))(*zip(joints, values or [0] * len(joints)))
    options = structure("rbd_urdf_options")(
        root=JointType.FLOATING if _flag(call, "floating", floating) else JointType.FIXED,
        gravity=g and ctypes.addressof(g), keep=ctypes.addressof(kept), lock=ctypes.addressof(locks), **names,
        **flags)
    options.memory = g, kept, locks  # the structure has their addresses alone
    return options


def _takes_urdf_options(function):
    """Puts the options of _urdf_options into the signature and the docstring of a function that takes
    **options: their one place is there."""
    own, options = inspect.signature(function), inspect.signature(_urdf_options)
    parameters = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
    first = [p for p in parameters if p.kind is not p.KEYWORD_ONLY]
    options = list(options.parameters.values())[1:]
    signature = own.replace(parameters=[*first, *options, *parameters[len(first):]])
    known = list(signature.parameters)

    @functools.wraps(function)
    def wrapper(*arguments, **keywords):
        for name in keywords:
            if name not in known:
                near = difflib.get_close_matches(name, known, 1)
                raise TypeError(f"{function.__name__}: there is no option '{name}'" +
                                (f"; did you mean '{near[0]}'?" if near else ""))
        return function(*arguments, **keywords)
    wrapper.__signature__ = signature
    wrapper.__doc__ = f"{inspect.getdoc(function)}\n\n{inspect.getdoc(_urdf_options)}"
    return wrapper


@_takes_urdf_options
def load_urdf(path: str | os.PathLike[str], **options) -> Urdf:
    """A robot from a URDF file."""
    return _load_urdf("load_urdf", path, options)


@_takes_urdf_options
def parse_urdf(text: str | bytes, **options) -> Urdf:
    """A robot from the text of a URDF."""
    if not isinstance(text, (str, bytes, bytearray)):
        raise TypeError(f"parse_urdf: text must be str or bytes, not {type(text).__name__}")
    if text and ("<" if isinstance(text, str) else b"<") not in text:
        raise ValueError(f"parse_urdf: this is no XML: {text[:60]!r}; load_urdf takes the name of a file")
    text = text.encode() if isinstance(text, str) else bytes(text)
    return _read_urdf("parse_urdf", text, "URDF", options)


def _load_urdf(call, path, options):
    """Reads a file, and the robot in it."""
    path = os.fspath(path)
    with open(path, "rb") as file:
        text = file.read()
    return _read_urdf(call, text, os.fsdecode(path), options)


def _read_urdf(call, text, source, options):
    """Counts, makes room, and reads."""
    options = _urdf_options(call, **options)
    load, arguments = _urdf_library()["rbd_urdf_parse"], [text, ctypes.c_size_t(len(text))]
    robot = structure("rbd_urdf")()

    def said(finding):
        line = f":{finding.line}" if finding.line else ""
        return f"{source}{line}: {_python_words(finding.text.decode(errors='replace'))}"

    def read(room):
        findings = (structure("rbd_urdf_finding") * room)()
        robot.warnings, robot.warnings_max = ctypes.addressof(findings), room
        status = load(*arguments, ctypes.byref(options), ctypes.byref(robot))
        sentences = [said(finding) for finding in findings[:robot.nwarnings]]
        if status:
            _warn(sentences)  # they may say where the error comes from
            raise RbdError(UrdfStatus(status), said(robot.error))
        return sentences

    read(20)
    bodies = (structure("rbd_body") * robot.nb)()
    frames = (structure("rbd_urdf_frame") * robot.nframes)()
    names = ctypes.create_string_buffer(robot.names_size)
    robot.bodies, robot.bodies_max = ctypes.addressof(bodies), len(bodies)
    robot.frames, robot.frames_max = ctypes.addressof(frames), len(frames)
    robot.names, robot.names_max = ctypes.addressof(names), len(names)
    sentences = read(robot.nwarnings)
    _warn(sentences)
    return Urdf(robot.name.decode(), [_from_c(row) for row in bodies],
                [Frame(frame.link.decode(), frame.joint and frame.joint.decode(), frame.parent, frame.body,
                       np.array(frame.position), np.array(frame.rotation).reshape(3, 3)) for frame in frames],
                sentences, tuple(robot.gravity), robot.fixed_mass)


# ---- model ----

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


_HYBRID, _MOMENTA = _results("hybrid", "a", "tau"), _results("batch_momentum", "h", "h_dot")
_MEMORIES = {  # what C computes in, and what it stands on
    "work": [],
    "derivatives": ["work"],
    "batch": [],
    "batch_derivatives": ["batch"],
}


class Model(_Owner):
    """A robot: constants, and the memory that one thread computes in.

    bodies   list of Body, parents first; or the result of load_urdf, whose gravity it takes
    gravity  3, world frame, m/s^2; None = (0, 0, -9.81)
    library  a Library; None = double, compiled for this machine

    If a body cannot be real, but can be computed with, an RbdWarning says so; `warnings` keeps the sentences.
    Of a URDF these are those of the loader, which sees the single links and their lines.
    """
    library: Library
    bodies: list[Body]
    warnings: list[str]     #: sentences
    nb: int                 #: number of bodies
    nq: int                 #: number of coordinates: the length of q
    nv: int                 #: number of degrees of freedom: the length of v

    def __init__(self, bodies: Urdf | Iterable[Body], *, gravity: ArrayLike | None = None,
                 library: Library | None = None):
        urdf = bodies if isinstance(bodies, Urdf) else None
        if urdf:
            gravity = urdf.gravity if gravity is None else gravity
            bodies = urdf.bodies
        if isinstance(bodies, (str, bytes, os.PathLike, Body)) or not hasattr(bodies, "__iter__"):
            file = isinstance(bodies, (str, os.PathLike))
            raise TypeError("Model: bodies must be a list of Body, or the result of load_urdf, not "
                            f"{type(bodies).__name__}" + "; Model.from_urdf takes the name of a file" * file)
        self._setup(bodies, gravity, _default_library() if library is None else library)
        if urdf and urdf.warnings:
            self.warnings = list(urdf.warnings)
        else:
            _warn(self.warnings)

    def _setup(self, bodies, gravity, library, layout="rows"):
        """What a new model and a copy have in common."""
        if not isinstance(library, Library):
            raise TypeError(f"library must be a Library, as Library('float'), not {library!r}")
        super().__init__(library, threading.RLock())
        self._batch_layout = layout
        bodies = list(bodies)
        self._rows = _rows(bodies)
        self.bodies = copy.deepcopy(bodies)  # the caller may change his, and copies are built of these
        self._build()
        self.nb, self.nq, self.nv = (self.library.call(n, self._address("model")) for n in ("nb", "nq", "nv"))
        self._dims = {"nb": self.nb, "nq": self.nq, "nv": self.nv, "nh": self.packed_size()}
        if gravity is not None:
            self.set_gravity(gravity)

    @classmethod
    @_takes_urdf_options
    def from_urdf(cls, path: str | os.PathLike[str], *, library: Library | None = None, **options) -> Model:
        """A model of a URDF file."""
        return cls(_load_urdf("from_urdf", path, options), library=library)

    def _build(self):
        """Builds the model from its rows."""
        rows, nb, call = self._rows, len(self._rows), self.library.call
        size = call("model_size", rows, nb, result=ctypes.c_size_t)
        self._memories["model"] = memory = ctypes.create_string_buffer(max(size, 1))
        self._addresses["model"] = model = ctypes.c_void_p()
        report = structure("rbd_report", self.library.scalar)()
        status = call("model_build", rows, nb, memory, ctypes.c_size_t(size), ctypes.byref(model), report)
        if status:
            raise RbdError(Status(status), self.library.finding_text(report.error))
        found = report.warning[:min(report.warnings, len(report.warning))]
        self.warnings = [self.library.finding_text(finding) for finding in found]

    def _prepare(self, kind):
        """Makes this part of memory, or makes it anew in its place."""
        model, address, call = self._addresses["model"], ctypes.c_void_p(), self.library.call
        if kind not in self._memories:
            size = call(f"{kind}_size", model, result=ctypes.c_size_t)
            self._memories[kind] = ctypes.create_string_buffer(size)
        memory = self._memories[kind]
        status = call(f"{kind}_init", model, *map(self._address, _MEMORIES[kind]), memory,
                      ctypes.c_size_t(len(memory)), ctypes.byref(address))
        if status:
            raise self._error(f"{kind}_init", status)
        self._addresses[kind] = address
        if kind == "batch":
            call("batch_set_gravity", address, self.get_gravity())

    def _error(self, call, status, results=None, states=None):
        """The exception for a status: the library's sentence, and where it happened. states: of a batch, the
        axes of its states."""
        text = f"{call}: {self.library.status_string(status)}"
        if status in (Status.ERR_SINGULAR, Status.ERR_NAN):
            dof = self.singular_dof()
            if states is not None:
                state, dof = self.batch_singular()
                text += f"; state {_state(state, states)}"
            if dof >= 0:
                text += f"; degree of freedom {dof}, '{self.dof_names[dof]}'"
        return RbdError(Status(status), text, results)

    def _layout(self):
        return self._batch_layout

    def _body(self, body, call, world=False):
        """The index of a body, from its name too. world: whether -1, the world, may be meant."""
        if isinstance(body, str):
            return self._index(call, "body_index", body)
        try:
            index = operator.index(body)
        except TypeError:
            raise TypeError(f"{call}: a body is an index or a name, not {body!r}") from None
        if not -world <= index < self.nb:
            last = f"the model has 0 to {self.nb - 1}" + ", and -1 for the world" * world
            raise RbdError(Status.ERR_INDEX, f"{call}: no such body: {index}; {last}")
        return index

    def copy(self) -> Model:
        """Another Model of the same robot, with memory of its own: for another thread."""
        return _again(*self.__reduce__()[1])

    def __reduce__(self):
        return _again, (self.bodies, self.get_gravity(), self.library, self._batch_layout, self.warnings)

    def __repr__(self):
        return f"<rbd.Model of {self.nb} bodies, nq = {self.nq}, nv = {self.nv}, {self.library.real}>"

    # -- gravity, payload, errors --

    def batch_set_layout(self, layout: Literal["rows", "blocks"]) -> None:
        """Sets how the states of a batch stand in arrays, for the calls that C computes together: "rows", as
        in numpy, or "blocks" of as many states as the library has lanes, which stand along a last axis: q (n,
        nq, lanes), M (n, nv, nv, lanes). C need not transpose blocks. See rbd_layout."""
        if not isinstance(layout, str) or layout not in ("rows", "blocks"):
            raise ValueError(f"batch_set_layout: layout must be 'rows' or 'blocks', not {layout!r}")
        self._batch_layout = layout

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Sets gravity, 3 components in the world frame, m/s^2, for the calls that follow."""
        gravity = _numbers("set_gravity", "gravity", gravity, (3,), self.library.dtype)
        with self._lock:
            self.library.call("set_gravity", self._address("work"), gravity)
            if "batch" in self._addresses:
                self.library.call("batch_set_gravity", self._address("batch"), gravity)

    def get_gravity(self) -> Array:
        """Gravity as it is set: 3, world frame, m/s^2."""
        gravity = np.empty(3, self.library.dtype)
        self.library.call("get_gravity", self._address("work"), gravity)
        return gravity

    def add_payload(self, body: int | str, mass: float, com: ArrayLike = (0, 0, 0),
                    inertia: ArrayLike | None = None) -> None:
        """Adds mass to a body, as a load that a hand took up. The same call with mass and inertia negated
        takes it off again, to rounding.

            body      index, or name of the link
            mass      kg, may be negative
            com       3, of the payload, link frame, m
            inertia   xx xy xz yy yz zz about its com, link axes, kg m^2; None = a point
        """
        index = self._body(body, "add_payload")
        com = _numbers("add_payload", "com", com, (3,))
        inertia = None if inertia is None else _numbers("add_payload", "inertia", inertia, (6,))
        mass = ctypes.c_double(_number("add_payload", "mass", mass))
        with self._lock:
            status = self.library.call("add_payload", self._memories["model"], index, mass, com, inertia)
            if status:
                raise self._error("add_payload", status)
            for kind in "derivatives", "batch_derivatives":  # they hold constants of the model
                if kind in self._addresses:
                    self._prepare(kind)
            self.bodies[index] = self.library.set_parameters(self.bodies[index], self.body_parameters(index))

    def lock_joints(self, joints: int | str | Iterable[int | str], q: ArrayLike) -> Model:
        """Another Model of the robot, in which these joints are fixed at their pose in q, and with them those that
        mimic them. All bodies stay. q and v of the new model are those of the joints that still move, in the same
        order: see `q_names`.

            joints    names of joints, or the bodies that they carry: indices, or names of links
            q         nq, of this model
        """
        joints = [joints] if isinstance(joints, str) or not hasattr(joints, "__iter__") else joints
        q = _numbers("lock_joints", "q", q, (self.nq,))
        locked = np.zeros(self.nb, np.uint8)
        for joint in joints:
            locked[self._joint_body(joint, "lock_joints")] = 1
        rows, held = _rows(self.bodies), (structure("rbd_body") * self.nb)()
        report = structure("rbd_report", self.library.scalar)()
        status = self.library.call("lock_joints", rows, self.nb, locked, q, held, report)
        if status:
            raise RbdError(Status(status), "lock_joints: " + self.library.finding_text(report.error))
        bodies = [body if row.type == new.type else _from_c(new)
                  for body, row, new in zip(self.bodies, rows, held)]
        return _again(bodies, self.get_gravity(), self.library, self._batch_layout, self.warnings)

    def singular_dof(self) -> int:
        """After Status.ERR_SINGULAR or ERR_NAN: the degree of freedom whose pivot is not above its rounding,
        or not a number; else -1."""
        return self.library.call("singular_dof", self._address("work"))

    def batch_singular(self) -> tuple[int, int]:
        """After that error of a batch: (the first singular state, its degree of freedom); else (-1, -1)."""
        dof = ctypes.c_int(-1)
        return self.library.call("batch_singular", self._address("batch"), ctypes.byref(dof)), dof.value

    # -- dynamics --

    @_c("work", "tau", batch=True)
    def rnea(self, q, v, a, f_ext=None):
        """Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext. Recursive Newton-Euler, RBDA table 5.1."""

    @_c("work", "c", batch=True)
    def bias(self, q, v, f_ext=None):
        """Bias force c, the part of inverse dynamics that does not depend on a: velocity terms, gravity, minus
        external wrenches."""

    @_c("work", "g")
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
        return _HYBRID(*(arrays[name].reshape(*loop, self.nv) for name in ("a", "tau")))

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

    # -- kinematics: the calls after `kinematics` read its results --

    @_c("work")
    def kinematics(self, q, v=None, a=None):
        """Computes poses, velocities and accelerations of all bodies; the calls below read them. None =
        zero."""

    @_c("work")
    def body_kinematics(self, body, q, v=None, a=None):
        """Computes pose, velocity and acceleration of one body and its ancestors, in less time than `kinematics`.
        The calls below then know these bodies only."""

    @_c("work", "R p", p="3")
    def body_pose(self, body):
        """Pose of a body after `kinematics`: R, and p, the link's origin in the world, m."""

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

    @_c("work", "position velocity acceleration", velocity="3", acceleration="3")
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
        return _MOMENTA(*(x.reshape(*loop, 6) for x in results))

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

    # -- names --

    def _index(self, call, function, name):
        """Index of a body by the name of its link or joint; a KeyError says which names there are."""
        if not isinstance(name, str):
            raise TypeError(f"{call}: a name must be text, not {name!r}")
        try:
            index = self.library.call(function, self._address("model"), _utf8(name))
        except ValueError:
            index = -1  # no name of C
        if index >= 0:
            return index
        kind, names, others = "link", self.body_names, self.joint_names
        if function == "joint_index":
            kind, names, others = "joint", others, names
        where = others.index(name) if name in others else None
        text = f"{call}: no {kind} is called " + (f"'{name}'" if name.isprintable() else repr(name))
        if where is not None and names[where]:
            other = {"link": "joint", "joint": "link"}[kind]
            text += f"; the {other} '{name}' belongs to {kind} '{names[where]}'"
        names = [known for known in names if known]
        near = difflib.get_close_matches(name, names, 1)
        text += f"; did you mean '{near[0]}'? " if near and where is None else ". "
        text += f"There are: {', '.join(names[:12])}"
        text += f", ..., {len(names)} in all." if len(names) > 12 else "."
        if kind == "link":
            text += " Links on fixed joints are bodies only if load_urdf(keep=...) names them."
        raise KeyError(text)

    def body_index(self, name: str) -> int:
        """Index of a body by the name of its link; KeyError if there is none."""
        return self._index("body_index", "body_index", name)

    def joint_index(self, name: str) -> int:
        """Index of a body by the name of the joint that carries it; KeyError if there is none."""
        return self._index("joint_index", "joint_index", name)

    def _name(self, function, body):
        body = _int(_whole(function, "body", body))
        name = self.library.call(function, self._address("model"), body, result=ctypes.c_char_p)
        return None if name is None else name.decode("utf-8", "surrogateescape")

    def body_name(self, body: int) -> str | None:
        """Name of a body's link; None if nameless or no such body."""
        return self._name("body_name", body)

    def joint_name(self, body: int) -> str | None:
        """Name of the joint that carries a body; None if nameless or no such body."""
        return self._name("joint_name", body)

    @property
    def body_names(self) -> list[str | None]:
        """Names of all links, by body."""
        return [self.body_name(body) for body in range(self.nb)]

    @property
    def joint_names(self) -> list[str | None]:
        """Names of all joints, by body."""
        return [self.joint_name(body) for body in range(self.nb)]

    @property
    def dof_names(self) -> list[str]:
        """Names of the degrees of freedom: the joint's, with [k] where it has several."""
        return self._coordinates("iv", "nv", self.nv)

    @property
    def q_names(self) -> list[str]:
        """Names of the coordinates, likewise."""
        return self._coordinates("iq", "nq", self.nq)

    def _coordinates(self, first, count, length):
        names = [""] * length
        for body in range(self.nb):
            joint = self.joint(body)
            n, name = getattr(joint, count), self.joint_name(body) or f"joint {body}"
            for k in range(n):
                names[getattr(joint, first) + k] = name if n == 1 else f"{name}[{k}]"
        return names

    def _joint_body(self, joint, call):
        """The body that a joint carries: of its name or, if none has it, of that of the link, or of the index."""
        try:
            body = self._body(joint, call)
        except KeyError:
            body = -1
        if isinstance(joint, str) and (body < 0 or joint in self.joint_names):
            body = self._index(call, "joint_index", joint)
        return body

    def joint(self, joint: int | str) -> JointInfo:
        """JointInfo: type, place in q and v, and limits of a joint.

            joint        the name of the joint, or the body that it carries: index, or name of the link
        """
        body = self._joint_body(joint, "joint")
        info = structure("rbd_joint_info", self.library.scalar)()
        status = self.library.call("joint", self._address("model"), body, info)
        if status:
            raise self._error("joint", status)
        return JointInfo(JointType(info.type), *(getattr(info, name) for name in JointInfo._fields[1:]))

    def dof_body(self, dof: int) -> int:
        """The body whose joint has this degree of freedom, -1 if there is none."""
        return self.library.call("dof_body", self._address("model"), _int(_whole("dof_body", "dof", dof)))

    def describe(self, body: int | str) -> Body:
        """A Body read back from the model, from which a build makes the same, to rounding: its parent is the
        body whose joint carries it, axes are of unit length, an added payload is in it."""
        row = structure("rbd_body")()
        status = self.library.call("describe", self._address("model"), self._body(body, "describe"), row)
        if status:
            raise self._error("describe", status)
        return _from_c(row)

    # -- derivatives and what else stands on a common frame: rbd_derivatives.h --

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

    # -- constraints: rbd_constraints.h --

    def constraint_set(self, rows: Iterable[Constraint]) -> ConstraintSet:
        """A set of constraints that hold together, from a list of Constraint: see ConstraintSet."""
        return ConstraintSet(self, rows)

    def _constraint(self, function, *arguments):
        """The Constraint of a function of C: names and indices are bodies, all else points and axes."""
        names = list(inspect.signature(getattr(Model, function)).parameters)[1:]
        row = self.library.call(function, *(
            self._body(x, function, world=True) if name.startswith("body") else
            None if x is None and name == "place" else _numbers(function, name, x, (3,))
            for name, x in zip(names, arguments)),
            result=structure("rbd_constraint"))
        values = {member: getattr(row, member) for member, _ in row._fields_}
        return Constraint(**{member: tuple(value) if isinstance(value, ctypes.Array) else value
                             for member, value in values.items()})

    def point_contact(self, body: int | str, point: ArrayLike = (0, 0, 0),
                      place: ArrayLike | None = None) -> Constraint:
        """A Constraint: a point of a body (3, body axes) held at a place (3, world; None = anywhere); 3
        rows."""
        return self._constraint("point_contact", body, point, place)

    def flat_contact(self, body: int | str, point: ArrayLike = (0, 0, 0),
                     place: ArrayLike | None = None) -> Constraint:
        """The same of a whole surface: 6 rows."""
        return self._constraint("flat_contact", body, point, place)

    def ball_loop(self, body1: int | str, point1: ArrayLike, body2: int | str,
                  point2: ArrayLike) -> Constraint:
        """A Constraint: points of two bodies, each in its body's axes, coincide; 3 rows."""
        return self._constraint("ball_loop", body1, point1, body2, point2)

    def hinge_loop(self, body1: int | str, point1: ArrayLike, axis1: ArrayLike, body2: int | str,
                   point2: ArrayLike, axis2: ArrayLike) -> Constraint:
        """The same, and the lines along axis1 and axis2 there coincide; 5 rows."""
        return self._constraint("hinge_loop", body1, point1, axis1, body2, point2, axis2)

    # -- contacts: rbd_contact.h --

    def contacts(self, rows: Iterable[Contact], held: Iterable[Constraint] = (),
                 options: ContactOptions | None = None) -> ContactSet:
        """Contacts that open and slip, from a list of Contact, for simulation: see ContactSet. held: a list of
        Constraint that hold at the same time, as loops; their kp and kd have no meaning here."""
        return ContactSet(self, rows, held, options)

    # -- for firmware --

    def c_model(self, name: str, source: str = "a Model in Python") -> str:
        """The built model as a C table for firmware, for a file NAME_model.h: the same as rbd-model --c-model
        NAME writes. It serves double and float. source: the origin that its head names."""
        return _print_c(self, name, source, built=True)

    def c_table(self, name: str, source: str = "a Model in Python") -> str:
        """The description as a C table, for a file NAME.h: the same as rbd-model --c NAME writes."""
        return _print_c(self, name, source, built=False)


def _again(bodies, gravity, library, layout, warnings):
    """A Model that was built before, and has warned."""
    model = Model.__new__(Model)
    model._setup(bodies, gravity, library, layout)
    model.warnings = list(warnings)
    return model


# ---- constraints ----

def _pairs(model, rows, kind, what):
    """Constraints or contacts as a list, and as an array of the C struct."""
    word = kind.__name__.lower()
    if isinstance(rows, (kind, str, bytes, dict)) or not hasattr(rows, "__iter__"):
        raise TypeError(f"{what} must be a list of {kind.__name__}, not {type(rows).__name__}")
    rows = list(rows)
    array = (structure(f"rbd_{word}") * len(rows))()
    for number, row in enumerate(rows):
        if not isinstance(row, kind):
            raise TypeError(f"{word} {number} must be a {kind.__name__}, not {type(row).__name__}")
        where = f"{word} {number}" + (f" '{row.name}'" if row.name else "")
        bodies = {side: model._body(getattr(row, side), f"{where}, field '{side}'", world=True)
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
        super().__init__(model.library, model._lock)
        self.model, self.nv = model, model.nv
        self.list, self._rows = _pairs(model, rows, Constraint, "constraint_set: rows")
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


# ---- contacts: rbd_contact.h ----

class ContactResult(NamedTuple):
    """What a contact did in the last step."""
    state: ContactState     #: APART, OPENS, STICKS or SLIPS
    gap: float              #: before the step, m
    force: Array            #: 3, on body 1, world axes, N


class ContactSolution(NamedTuple):
    """How well and how fast contacts were solved."""
    residual: float         #: m/s: 0 where all laws hold
    sweeps: int             #: Gauss-Seidel's
    newton_steps: int


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
        super().__init__(model.library, model._lock)
        self.model, self.nv, self._dims = model, model.nv, model._dims
        self.list, self._rows = _pairs(model, rows, Contact, "contacts: rows")
        self.held, self._held = _pairs(model, held, Constraint, "contacts: held")
        options = ContactOptions() if options is None else options
        if not isinstance(options, ContactOptions):
            raise TypeError(f"contacts: options must be ContactOptions, not {type(options).__name__}")
        self.options = replace(options)
        self._planes = {}  # those that plane() set: normal and height, by number of the contact
        self._options = structure("rbd_contact_options")()
        _to_c(self.options, self._options, "options")
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
        return ContactSet, (self.model, list(self.list), list(self.held), self.options), self._planes

    def __setstate__(self, planes):
        for contact, (normal, height) in planes.items():
            self.plane(contact, normal, height)

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


# ---- C tables: the writers of rbd-model ----

# They print to standard output; here to a file.
_TO_FILE = """
#include <stdio.h>
extern FILE *rbd_out;
#define printf(...) fprintf(rbd_out, __VA_ARGS__)
#define putchar(c) fputc(c, rbd_out)
"""
_PRINT = """
#include <stdio.h>
#include <stdlib.h>
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "tools/print.h"

FILE *rbd_out;
const char *program = "rbd";
void *grown(void *memory, size_t size) {
    if (!(memory = realloc(memory, size))) abort();
    return memory;
}
void *allocate(size_t n, size_t size) {
    void *memory = calloc(n ? n : 1, size ? size : 1);
    if (!memory) abort();
    return memory;
}

int rbd_print(const char *path, int built, const char *name, const char *source, rbd_body *bodies, int nb,
              const double gravity[3]) {
    rbd_urdf_frame root = {0};
    robot r = {0};
    size_t size = rbd_model_size(bodies, nb);
    r.model_memory = allocate(size, 1);
    if (rbd_model_build(bodies, nb, r.model_memory, size, &r.model, NULL) == RBD_OK &&
        (rbd_out = fopen(path, "w"))) {
        rbd_model *m = (rbd_model *)r.model;
        m->gravity.x = gravity[0], m->gravity.y = gravity[1], m->gravity.z = gravity[2];
        root.body = bodies[0].type == RBD_FLOATING ? 0 : -1;
        r.path = source, r.urdf.name = name, r.urdf.bodies = bodies, r.urdf.nb = nb, r.urdf.frames = &root;
        (built ? print_c_model : print_c)(&r, name);
        built = ferror(rbd_out) | fclose(rbd_out) ? -1 : 0;
    } else {
        built = -1;
    }
    free(r.model_memory);
    return built;
}
"""
_print_lock = threading.Lock()


def _print_c(model, name, source, built):
    """The text that rbd-model writes of this robot. It builds anew, in double, from the description."""
    for what, text in ("name", name), ("source", source):
        if not isinstance(text, str):
            raise TypeError(f"{what} must be text, not {text!r}")
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.A):
        raise ValueError(f"{name!r} is not a C identifier")
    files = ("print", "print_c", "print_c_indices", "print_c_model")
    units = [_PRINT, *(f'{_TO_FILE}#line 1 "{file}.c"\n' + (SOURCES / f"tools/{file}.c").read_text()
                       for file in files)]
    command = [*_c_compiler(), *_QUICK, "-ffp-contract=off", f"-I{SOURCES / 'tools'}"]
    library = _compile(units, command, ["-lm"])
    rows = _rows(model.bodies)
    gravity = (ctypes.c_double * 3)(*model.get_gravity())
    with tempfile.TemporaryDirectory() as folder, _print_lock:
        path = Path(folder, "table.h")
        if library.rbd_print(os.fsencode(path), built, name.encode(), source.encode(), rows, len(rows),
                             gravity):
            raise RuntimeError(f"{path}: cannot be written")
        return path.read_text()


# ---- spatial algebra: rbd_spatial.h ----

class Placement(NamedTuple):
    """The place of a frame `of` in a frame `in`."""
    rotation: Array     #: 3 x 3, turns vectors from of's axes into in's
    position: Array     #: 3, of's origin, in in's axes


class AxisAngle(NamedTuple):
    """A rotation about an axis."""
    axis: Array         #: 3, of unit length
    angle: float        #: rad


# For each kind of quantity: its C type, None = an array of numbers; its shape; its name in docstrings.
_KINDS = {
    "number": ("rbd_real", (), "a number"),
    "vector": ("rbd_vec3", (3,), "3"),
    "rotation": ("rbd_rotation", (3, 3), "3 x 3"),
    "placement": ("rbd_placement", (12,), "a pair (rotation 3 x 3, position 3), as of body_pose"),
    "motion": ("rbd_motion", (6,), "6, (angular; linear)"),
    "force": ("rbd_force", (6,), "6, (moment; force)"),
    "inertia": ("rbd_inertia", (10,), "10: m, m c (3), xx xy xz yy yz zz about the origin"),
    "quaternion": (None, (4,), "4, (x, y, z, w)"),
    "rpy": (None, (3,), "3, roll pitch yaw as of URDF"),
    "axis_angle": (None, (4,), "a pair (axis 3, angle)"),
    "array3": (None, (3,), "3"),
    "array6": (None, (6,), "6: xx xy xz yy yz zz"),
}
# The calls: name(parameters: kinds) -> kind, meaning, and the C expression where it is not just the call.
_SPATIAL = [re.fullmatch(r"(\w+)\((.*)\) -> (\w+) \| ([^|]*?)(?:\n +\| (.*))?", line).groups()
            for line in re.split(r"\n(?=\w)", """
rotation_product(a: rotation, b: rotation) -> rotation | a b: first b, then a.
rotation_inverse(r: rotation) -> rotation | Its transpose.
rotate(r: rotation, v: vector) -> vector | r v.
rotate_back(r: rotation, v: vector) -> vector | r' v.
rotation_from_quaternion(q: quaternion) -> rotation | q of any length; zero gives the identity.
rotation_to_quaternion(r: rotation) -> quaternion | The unit quaternion with w >= 0. Shepperd (1978).
rotation_from_rpy(roll: number, pitch: number, yaw: number) -> rotation | Rz(yaw) Ry(pitch) Rx(roll), rad.
rotation_to_rpy(r: rotation) -> rpy | Roll and yaw in [-pi, pi], pitch in [-pi/2, pi/2].
rotation_exp(turn: vector) -> rotation | The rotation about turn by its length, rad.
rotation_log(r: rotation) -> vector | The shortest turn, at most pi, whose exp is r.
rotation_from_axis_angle(axis: vector, angle: number) -> rotation | The axis's length does not count.
rotation_to_axis_angle(r: rotation) -> axis_angle | The angle in [0, pi]; the axis is z where it is 0.
    | out[3] = rbd_rotation_to_axis_angle(r, (rbd_vec3 *)out)
placement_compose(b: placement, c: placement) -> placement | c in a, from b in a and c in b.
placement_inverse(x: placement) -> placement | The frame `in` seen from `of`.
placement_exp(v: motion) -> placement | Where a frame gets in unit time that moves with v.
    | rbd_placement_exp(v, 0)
placement_log(x: placement) -> motion | The v with the shortest turn whose exp is x.
point_up(x: placement, point: vector) -> vector | A point of frame `of` in coordinates of `in`.
point_down(x: placement, point: vector) -> vector | A point of frame `in` in coordinates of `of`.
motion_up(x: placement, m: motion) -> motion | A motion of frame `of` in frame `in`; RBDA (2.24).
motion_down(x: placement, m: motion) -> motion | A motion of frame `in` in frame `of`.
motion_cross(v: motion, m: motion) -> motion | v x m: the rate of a motion that v carries along; RBDA (2.31).
force_up(x: placement, f: force) -> force | A force of frame `of` in frame `in`; RBDA (2.25).
force_down(x: placement, f: force) -> force | A force of frame `in` in frame `of`.
force_cross(v: motion, f: force) -> force | v x* f: the rate of a force that v carries along; RBDA (2.32).
power(v: motion, f: force) -> number | v . f, W; the same in every frame.
inertia_of(mass: number, com: array3, inertia: array6) -> inertia | Of a description: inertia about com.
    | rbd_inertia_of(mass, com, inertia, 0)
inertia_up(x: placement, i: inertia) -> inertia | An inertia of frame `of` in frame `in`; RBDA (2.66).
inertia_down(x: placement, i: inertia) -> inertia | An inertia of frame `in` in frame `of`.
inertia_times(i: inertia, m: motion) -> force | i m: of a velocity the momentum; RBDA (2.63).
""".strip())]
_SPATIAL = {name: ([tuple(item.split(": ")) for item in parameters.split(", ")], result, text, code)
            for name, parameters, result, text, code in _SPATIAL}


def _spatial_unit():
    """C functions that take and give arrays, around the inline ones of the header, which take structs."""
    lines = ["#include <string.h>"]
    for name, (parameters, result, _, code) in _SPATIAL.items():
        arguments = ", ".join(f"const rbd_real *{p}_" for p, _ in parameters)
        lines.append(f"void rbd_array_{name}({arguments}, rbd_real *out) {{")
        for p, kind in parameters:
            c_type = _KINDS[kind][0]
            lines.append(f"    {c_type} {p}; memcpy(&{p}, {p}_, sizeof {p});" if c_type else
                         f"    const rbd_real *{p} = {p}_;")
        c_type, names = _KINDS[result][0], [p for p, _ in parameters]
        if c_type:
            call = code or f"rbd_{name}({', '.join(names)})"
            lines.append(f"    {c_type} result = {call}; memcpy(out, &result, sizeof result);")
        else:
            lines.append(f"    {code or 'rbd_' + name + '(' + ', '.join([*names, 'out']) + ')'};")
        lines.append("}")
    return "\n".join(lines)


class Spatial:
    """Rotations, placements and spatial vectors by rbd_spatial.h, as arrays: `library.spatial`,
    `model.library.spatial`.

    Spatial vectors are 6 numbers, angular first. A placement says where frame `of` stands in frame `in`: a
    pair of the rotation, which turns vectors from of's axes into in's, and the position of of's origin, in
    in's axes. up: from `of` to `in`, as from a child to its parent; down: back. Use numpy's + and * to add
    and scale them. Axes before those of one quantity are broadcast, as everywhere in numpy."""

    def __init__(self, library: Library):
        self._library = library

    def _call(self, name, values):
        parameters, result, _, _ = _SPATIAL[name]
        dtype, inputs = self._library.dtype, []
        for (parameter, kind), value in zip(parameters, values):
            if kind == "placement":
                try:
                    rotation, position = value
                except (TypeError, ValueError):
                    raise TypeError(
                        f"{name}: {parameter} must be a pair (rotation 3 x 3, position 3)") from None
                inputs += [(f"{parameter}.rotation", rotation, (3, 3), ("3", "3")),
                           (f"{parameter}.position", position, (3,), ("3",))]
            else:
                shape = _KINDS[kind][1]
                inputs.append((parameter, value, shape, tuple(map(str, shape))))
        loop, arrays = _broadcast(name, inputs, dtype)
        n, flat = math.prod(loop), []
        for parameter, kind in parameters:  # rotation and position of a placement are one argument of C
            parts = [arrays[parameter + part] for part in
                     ((".rotation", ".position") if kind == "placement" else ("",))]
            flat.append(np.concatenate([part.reshape(n, math.prod(part.shape[1:])) for part in parts], 1))
        out = np.zeros((n, *_KINDS[result][1]), dtype)
        for k in range(n):
            self._library.call(f"array_{name}", *(array[k] for array in flat), out[k:k + 1], result=None)
        out = out.reshape(loop + out.shape[1:])
        _finite(name, result, out, FloatingPointError)
        if result == "placement":
            return Placement(out[..., :9].reshape(*loop, 3, 3).copy(), out[..., 9:].copy())
        if result == "axis_angle":
            return AxisAngle(out[..., :3].copy(), out[..., 3] if loop else out[3].item())
        return out if out.ndim else out.item()


def _spatial_method(name, parameters, result, text):
    names = ", ".join(p for p, _ in parameters)
    method = eval(f"lambda self, {names}: self._call('{name}', ({names},))")
    method.__name__, method.__qualname__, method.__module__ = name, f"Spatial.{name}", __name__
    lines = [f"    {p:<12} {_KINDS[kind][2]}" for p, kind in parameters]
    method.__doc__ = "\n".join([text, "", *lines, "gives", f"    {'':<12} {_KINDS[result][2]}"])
    return method


for _name, (_parameters, _result, _text, _) in _SPATIAL.items():
    setattr(Spatial, _name, _spatial_method(_name, _parameters, _result, _text))
