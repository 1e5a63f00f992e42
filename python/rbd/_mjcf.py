# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""MJCF files, by rbd_mjcf.h with MuJoCo's library."""
from __future__ import annotations

import ctypes
import functools
import importlib.util
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _flag, _number, _numbers
from ._compiled import _compiled_loader
from ._compiling import _QUICK, _compile, _words
from ._descriptions import Body, Constraint, _from_c, _rows
from ._headers import Array, MjcfStatus, RbdError, _python_words, _warn, structure
from ._urdf import Frame, Urdf, _takes_options, _texts

_MJCF = """
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#define RBD_MJCF_IMPLEMENTATION
#include "rbd_mjcf.h"
"""


@dataclass
class Mjcf(Urdf):
    """The content of an MJCF file: `Model(mjcf)` takes it. The calls below map states of MuJoCo and of that model: q and
    v have other orders in quaternions and free joints, and lack joints that mimic others or are held still. Axes before
    the last count states."""
    constraints: list[Constraint]   #: connect and weld, for `ConstraintSet(model, mjcf.constraints)`
    places: dict[str, tuple[int, int]]  #: of each joint that moves, by name: first index in qpos and in qvel
    nqpos: int                      #: length of MuJoCo's qpos
    nqvel: int                      #: and of its qvel

    def q_of_qpos(self, qpos: ArrayLike) -> Array:
        """Coordinates of rbd, nq, from those of MuJoCo, nqpos."""
        return self._convert("q_of_qpos", self._length(0), qpos=(qpos, self.nqpos))

    def v_of_qvel(self, qpos: ArrayLike, qvel: ArrayLike) -> Array:
        """Velocities of rbd, nv, from those of MuJoCo, nqvel."""
        return self._convert("v_of_qvel", self._length(1), qpos=(qpos, self.nqpos), qvel=(qvel, self.nqvel))

    def qpos_of_q(self, q: ArrayLike) -> Array:
        """Coordinates of MuJoCo from those of rbd; those of joints that are held are 0."""
        return self._convert("qpos_of_q", self.nqpos, q=(q, self._length(0)))

    def qvel_of_v(self, qpos: ArrayLike, v: ArrayLike) -> Array:
        """Velocities of MuJoCo from those of rbd, and from MuJoCo's coordinates; those of joints that are held are 0."""
        return self._convert("qvel_of_v", self.nqvel, qpos=(qpos, self.nqpos), v=(v, self._length(1)))

    def _length(self, velocities):
        """nq, or nv, of the model."""
        known = {"fixed": (0, 0), "spherical": (4, 3), "floating": (7, 6)}
        return sum(known.get(body.type, (1, 1))[velocities] for body in self.bodies if not body.mimic)

    def _place(self, name, body):
        """Where MuJoCo has the joint of a body."""
        if body.type == "fixed" or body.mimic:
            return -1, -1
        if body.joint not in self.places:
            raise ValueError(f"{name}: joint {body.joint!r} of body {body.name!r} is not in the MJCF file, so MuJoCo's states "
                             "have no numbers of it")
        return self.places[body.joint]

    def _convert(self, name, length, **inputs):
        """States one by one."""
        arrays = []
        for key, (value, needed) in inputs.items():
            array = np.asarray(value, float)
            if array.ndim < 1 or array.shape[-1] != needed:
                raise ValueError(f"{name}: {key} must have the shape (..., {needed}), not {array.shape}")
            arrays.append(array)
        shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        states = [np.ascontiguousarray(np.broadcast_to(array, (*shape, array.shape[-1])).reshape(-1, array.shape[-1]))
                  for array in arrays]
        result = np.zeros((len(states[0]), length))
        rows = _rows(self.bodies)
        places = (structure("rbd_mjcf_place") * len(rows))(*(self._place(name, body) for body in self.bodies))
        robot = structure("rbd_mjcf")(bodies=ctypes.addressof(rows), nb=len(rows), places=ctypes.addressof(places))
        call = _mjcf_library()[f"rbd_mjcf_{name}"]
        call.restype = None
        for number, out in enumerate(result):
            call(ctypes.byref(robot), *(array[number].ctypes.data_as(ctypes.c_void_p) for array in states),
                 out.ctypes.data_as(ctypes.c_void_p))
        return result.reshape(*shape, length)


def _installed_mujoco():
    """Flags of the compiler and of the linker for the library that Python's package mujoco brings, if it is there."""
    package = importlib.util.find_spec("mujoco")
    for folder in map(Path, package.submodule_search_locations or () if package else ()):
        libraries = sorted([*folder.glob("libmujoco*.so*"), *folder.glob("libmujoco*.dylib")])
        if (folder / "include/mujoco/mujoco.h").is_file() and libraries:
            return ["-isystem", str(folder / "include")], [str(libraries[-1]), f"-Wl,-rpath,{folder}"]
    return [], ["-lmujoco"]


@functools.lru_cache(maxsize=None)
def _mjcf_library():
    """The loader with MuJoCo: compiled with that of Python's package, else as the wheel brings it, else compiled with that
    of the system."""
    flags, libraries = _installed_mujoco()
    brought = _compiled_loader("mjcf")
    if brought and not flags:
        return brought
    compiler = _words("$CXX", os.environ.get("CXX", "").strip() or "c++")
    try:
        return _compile([_MJCF], [*compiler, *_QUICK, "-std=c++17", *flags], libraries,
                        "rbd_mjcf.h with MuJoCo, which takes some seconds")
    except RuntimeError as error:
        if brought:  # no compiler: the wheel's MuJoCo reads the file, which may be older
            return brought
        raise RuntimeError("MJCF files need MuJoCo with its headers (Debian: libmujoco-dev; or pip install mujoco) and a "
                           "C++ compiler. Without them a model is made of rows (Body) or of a C table (load_table), which "
                           f"rbd-model writes on another machine.\n{error}") from None


def _mjcf_options(call, *, gravity: ArrayLike | None = None, keep: str | Iterable[str] = (), keep_all: bool = False,
                  free_mimics: bool = False, lock: str | Iterable[str] | Mapping[str, float] = (), strict: bool = False):
    """The options are those of rbd_mjcf.h.

    gravity      3, world frame, m/s^2; None = that of the file
    keep         bodies without joints, or sites, to keep as bodies; others are merged: a name or several
    keep_all     keep all bodies without joints
    free_mimics  joints of an equality move freely
    lock         joints to hold still, and those that mimic them: {joint: value, rad or m}, or names (at 0)
    strict       warnings are errors
    """
    flags = {"keep_all": keep_all, "free_mimics": free_mimics, "strict": strict}
    flags = {name: _flag(call, name, value) for name, value in flags.items()}
    g = None if gravity is None else (ctypes.c_double * 3)(*_numbers(call, "gravity", gravity, (3,)))
    kept = _texts(call, "keep", keep)
    kept = (ctypes.c_char_p * (len(kept) + 1))(*kept)
    values = [_number(call, f"lock['{joint}']", at) for joint, at in lock.items()] if isinstance(
        lock, Mapping) else None
    joints = _texts(call, "lock", lock)
    locks = (structure("rbd_mjcf_lock") * (len(joints) + 1))(*zip(joints, values or [0] * len(joints)))
    options = structure("rbd_mjcf_options")(gravity=g and ctypes.addressof(g), keep=ctypes.addressof(kept),
                                            lock=ctypes.addressof(locks), **flags)
    options.memory = g, kept, locks  # the structure has their addresses alone
    return options


_takes_mjcf_options = _takes_options(_mjcf_options)


@_takes_mjcf_options
def load_mjcf(path: str | os.PathLike[str], **options) -> Mjcf:
    """A robot from an MJCF file, MuJoCo's format. Files that it includes are found from there."""
    return _load_mjcf("load_mjcf", path, options)


@_takes_mjcf_options
def parse_mjcf(text: str | bytes, **options) -> Mjcf:
    """A robot from the text of an MJCF file. Files that it includes are found from the working folder."""
    if not isinstance(text, (str, bytes, bytearray)):
        raise TypeError(f"parse_mjcf: text must be str or bytes, not {type(text).__name__}")
    text = text.encode() if isinstance(text, str) else bytes(text)
    return _read_mjcf("parse_mjcf", "rbd_mjcf_parse", [text, ctypes.c_size_t(len(text))], "MJCF", options)


def _load_mjcf(call, path, options):
    """Reads a file, and the robot in it."""
    path = os.fspath(path)
    with open(path, "rb"):  # or Python's own error
        pass
    return _read_mjcf(call, "rbd_mjcf_load", [os.fsencode(path)], os.fsdecode(path), options)


def _read_mjcf(call, name, arguments, source, options):
    """Counts, makes room, and reads."""
    options = _mjcf_options(call, **options)
    load = _mjcf_library()[name]
    robot = structure("rbd_mjcf")()
    room = {}

    def said(finding):
        line = f":{finding.line}" if finding.line else ""
        return f"{source}{line}: {_python_words(finding.text.decode(errors='replace'))}"

    def make_room(member, kind, length):
        room[member] = (kind * length)()
        setattr(robot, member, ctypes.addressof(room[member]))
        setattr(robot, f"{member}_max", length)

    def read():
        status = load(*arguments, ctypes.byref(options), ctypes.byref(robot))
        sentences = [said(finding) for finding in room["warnings"][:robot.nwarnings]]
        if status:
            _warn(sentences)  # they may say where the error comes from
            raise RbdError(MjcfStatus(status), said(robot.error))
        return sentences

    make_room("warnings", structure("rbd_mjcf_finding"), 20)
    read()
    make_room("warnings", structure("rbd_mjcf_finding"), robot.nwarnings)
    make_room("bodies", structure("rbd_body"), robot.nb)
    make_room("frames", structure("rbd_mjcf_frame"), robot.nframes)
    make_room("places", structure("rbd_mjcf_place"), robot.nb)
    make_room("constraints", structure("rbd_constraint"), robot.nconstraints)
    make_room("names", ctypes.c_char, robot.names_size)
    sentences = read()
    _warn(sentences)
    bodies: list[Body] = [_from_c(row) for row in room["bodies"]]
    frames = [Frame(f.link.decode(), f.joint and f.joint.decode(), f.parent, f.body, np.array(f.position),
                    np.array(f.rotation).reshape(3, 3)) for f in room["frames"]]
    constraints = [Constraint(k.name.decode(), k.body1, k.body2, *(tuple(getattr(k, member)) for member in (
        "rotation1", "position1", "rotation2", "position2", "axes")), k.kp, k.kd) for k in room["constraints"]]
    return Mjcf(robot.name.decode(), bodies, frames, sentences, tuple(robot.gravity), robot.fixed_mass, constraints,
                {body.joint: (place.qpos, place.dof) for body, place in zip(bodies, room["places"]) if place.qpos >= 0},
                robot.nqpos, robot.nqvel)
