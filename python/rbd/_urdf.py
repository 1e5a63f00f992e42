# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""URDF files, by rbd_urdf.h."""
from __future__ import annotations

import ctypes
import difflib
import functools
import inspect
import os
from dataclasses import dataclass
from typing import Iterable, Mapping, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _Declared, _flag, _number, _numbers, _utf8
from ._compiled import _compiled_loader
from ._compiling import _QUICK, _compile, _run, _words
from ._descriptions import Body, _from_c
from ._headers import Array, JointType, Numbers, RbdError, UrdfStatus, _python_words, _warn, structure

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
class Urdf(_Declared):
    """The content of a URDF file: `Model(urdf)` takes it."""
    name: str           #: of the robot
    bodies: list[Body]
    frames: list[Frame]     #: all links, fixed ones too
    warnings: list[str]     #: sentences
    gravity: Numbers        #: world frame, m/s^2
    fixed_mass: float       #: kg, of the links that are fixed to the world: in no body
    _path = None            #  of the file, where it was one
    kinematic = False       #: whether joints may move no mass: if one does, Model(urdf) is for kinematics alone


@functools.lru_cache(maxsize=None)
def _urdf_library():
    """The loader with urdfdom: as the wheel brings it, else compiled."""
    if brought := _compiled_loader("urdf"):
        return brought
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
                  kinematic: bool = False, free_mimics: bool = False, strict: bool = False, messages: bool = False):
    """The options are those of the command-line tools (rbd-model --help).

    floating       the root link is on a floating joint, not fixed to the world
    root           take only this link, as the root, and its subtree; None = all
    root_joint     the name of the floating joint; None = "root"
    gravity        3, world frame, m/s^2; None = (0, 0, -9.81)
    keep           links on fixed joints to keep as bodies; others are merged: a name or several
    keep_all       keep all links on fixed joints
    lock           joints to hold still, and those that mimic them: {joint: value, rad or m}, or names (at 0)
    lock_massless  hold joints still that move no mass, which else are an error
    kinematic      let them move, for poses, Jacobians and inverse kinematics alone
    free_mimics    let joints move freely whose <mimic> is wrong, which else is an error
    strict         warnings are errors
    messages       let urdfdom write its messages to standard error
    """
    names = {"root_link": root, "root_joint": root_joint}
    for name, value in names.items():
        option = name.replace("_link", "")
        if value is not None and not isinstance(value, str):
            raise TypeError(f"{call}: {option} must be a name or None, not {value!r}")
        names[name] = value if value is None else _texts(call, option, value)[0]
    flags = {"keep_all": keep_all, "lock_massless": lock_massless, "kinematic": kinematic,
             "free_mimics": free_mimics, "strict": strict, "messages": messages}
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


def _takes_options(reader):
    """A decorator that puts the options of a reader, as _urdf_options, into the signature and the docstring of a
    function that takes **options: their one place is there."""
    def decorator(function):
        own, options = inspect.signature(function), inspect.signature(reader)
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
        wrapper.__doc__ = f"{inspect.getdoc(function)}\n\n{inspect.getdoc(reader)}"
        return wrapper
    return decorator


_takes_urdf_options = _takes_options(_urdf_options)


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
    urdf = _read_urdf(call, text, os.fsdecode(path), options)
    urdf._path = os.path.abspath(os.fsdecode(path))
    return urdf


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
    urdf = Urdf(robot.name.decode(), [_from_c(row) for row in bodies],
                [Frame(frame.link.decode(), frame.joint and frame.joint.decode(), frame.parent, frame.body,
                       np.array(frame.position), np.array(frame.rotation).reshape(3, 3)) for frame in frames],
                sentences, tuple(robot.gravity), robot.fixed_mass)
    urdf.kinematic = bool(options.kinematic)
    return urdf
