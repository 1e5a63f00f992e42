# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Spatial algebra: rbd_spatial.h."""
from __future__ import annotations

import math
import re
from typing import NamedTuple, TYPE_CHECKING

import numpy as np

from ._arguments import _Declared, _broadcast, _finite
from ._headers import Array

if TYPE_CHECKING:
    from ._library import Library


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


class Spatial(_Declared):
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
