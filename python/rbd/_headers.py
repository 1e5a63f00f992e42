# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""What the headers say: version, enumerations, structures, errors; and how it is said in Python."""
from __future__ import annotations

import ctypes
import enum
import functools
import re
import sys
import warnings
from pathlib import Path
from typing import Any, Sequence, Union

from numpy.typing import NDArray

Array = NDArray[Any]                                # of the library's scalar
Numbers = Union[Sequence[float], Array]             # in a description
Matrix = Sequence[Sequence[float]]


def _find_sources():
    """The folder of rbd.h: beside this file where it is installed, above it in the repository."""
    here = Path(__file__).resolve().parent
    places = here / "sources", here.parents[1]
    for folder in places:
        if (folder / "rbd.h").is_file():
            return folder
    raise ImportError("rbd.h is neither in {} nor in {}".format(*places))


SOURCES: Path = _find_sources()  #: folder of rbd.h and of models/
_HEADERS = {path.name: path.read_text() for path in sorted(SOURCES.glob("rbd*.h"))}
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


class _Named(enum.IntEnum):
    """A number that is printed by its name."""
    __str__ = enum.Enum.__str__


def _enum(python_name, c_name, prefix):
    """A C enum as one of Python, without the prefix of its names."""
    members = {key[len(prefix):]: value for key, value in _enumerators(c_name, _TEXT).items()}
    return _Named(python_name, members, module=__package__)


Status = _enum("Status", "rbd_status", "RBD_")
UrdfStatus = _enum("UrdfStatus", "rbd_urdf_status", "RBD_URDF_")
MjcfStatus = _enum("MjcfStatus", "rbd_mjcf_status", "RBD_MJCF_")
QpStatus = _enum("QpStatus", "rbd_qp_status", "RBD_QP_")
JointType = _enum("JointType", "rbd_joint_type", "RBD_")
ContactState = _enum("ContactState", "rbd_contact_state", "RBD_")
IkKind = _enum("IkKind", "rbd_ik_kind", "RBD_IK_")
TransmissionKind = _enum("TransmissionKind", "rbd_transmission_kind", "RBD_BY_")
IkStatus = _enum("IkStatus", "rbd_ik_status", "RBD_IK_")
TaskKind = _enum("TaskKind", "rbd_task_kind", "RBD_TASK_")
TasksStatus = _enum("TasksStatus", "rbd_tasks_status", "RBD_TASKS_")


@functools.lru_cache(maxsize=None)
def structure(name, real=ctypes.c_double, text=_TEXT):
    """A C struct of a header as a ctypes.Structure of the same layout; `real` is rbd_real and rbd_const."""
    known = {"double": ctypes.c_double, "int": ctypes.c_int, "size_t": ctypes.c_size_t, "char": ctypes.c_char,
             "rbd_const": real, "rbd_real": real, "rbd_status": ctypes.c_int, "rbd_urdf_status": ctypes.c_int,
             "rbd_mjcf_status": ctypes.c_int, "rbd_joint_type": ctypes.c_int, "rbd_ik_kind": ctypes.c_int,
             "rbd_transmission_kind": ctypes.c_int,
             "rbd_task_kind": ctypes.c_int, "rbd_tasks_part": ctypes.c_int, "rbd_qp_status": ctypes.c_int,
             "unsigned": ctypes.c_ubyte}  # unsigned char
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


def _enumerator(where, kind, value, what="kind", but=()):
    """A value of an enum of C, from its name or itself: a number would be a slip."""
    if isinstance(value, kind):
        return value
    if isinstance(value, str) and value.upper() in kind.__members__ and value.upper() not in but:
        return kind[value.upper()]
    names = ", ".join(one.name.lower() for one in kind if one.name not in but)
    raise ValueError(f"{where}, field '{what.split()[-1]}': unknown {what} {value!r:.60}; there are: {names}")


class RbdError(Exception):
    """An error of the library.

    status   a Status, or a UrdfStatus or MjcfStatus where such a file is read, or a QpStatus of qp
    results  the results of the call that are valid all the same: of n states those that have no error
    """
    status: Status | UrdfStatus | MjcfStatus | QpStatus
    results: Any

    def __init__(self, status: Status | UrdfStatus | MjcfStatus | QpStatus, text: str, results: Any = None):
        super().__init__(text)
        self.status = status
        self.results = results

    def __reduce__(self):
        return RbdError, (self.status, str(self), self.results)


class RbdWarning(UserWarning):
    """Something in a description or a URDF file is odd, but rbd can compute with it."""


def _warn(sentences):
    """Warns, at the line that called this package."""
    level, frame = 2, sys._getframe(1)
    while frame and frame.f_globals.get("__package__") == __package__:
        level, frame = level + 1, frame.f_back
    for sentence in sentences:
        warnings.warn(sentence, RbdWarning, stacklevel=level)


def _python_words(text):
    """A sentence of the library with Python's names: no prefix, options as keywords. Names of bodies and
    joints, in quotes, stay as they are, and so do macros."""
    def word(found):
        option, value = found.groups()
        if found[0] == "rbd_mjcf.h":
            return "load_mjcf"
        if not option:
            return found[0] if found[0].startswith("'") else ""
        option = option.replace("-", "_")
        flags = "floating", "keep_all", "lock_massless", "kinematic", "free_mimics", "strict", "messages"
        return f"{option}={value}" if value else f"{option}=True" if option in flags else option

    return re.sub(r"'[^']*'|rbd_mjcf\.h|(?:options\.\w+, )?(?:rbd-\w+ )?(?<![\w-])--([a-z][a-z-]*)(?: ('[^']*'))?|"
                  r"\b(?:RBD_(?!NO_)(?:URDF_|MJCF_)?|rbd_(?:urdf_|mjcf_)?)(?=\w)", word, text)
