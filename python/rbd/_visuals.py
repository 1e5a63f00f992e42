# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""The visual shapes of a URDF, for pictures: boxes, cylinders, balls, and meshes of STL and OBJ files."""
from __future__ import annotations

import base64
import struct
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np


class _Unreadable(Exception):
    """Why a shape cannot be drawn."""


def _visuals(path, frames):
    """Items of a scene, meshes by name, and sentences of what is not drawn; for the file of a robot whose links are placed
    by these frames."""
    items, meshes, missing = [], {}, []
    try:
        robot = ElementTree.parse(path).getroot() if path else ElementTree.Element("robot")
    except (OSError, ElementTree.ParseError):
        return items, meshes, missing
    named = {material.get("name"): _colour(material) for material in robot.findall("material") if _colour(material)}
    places = {frame.link: frame for frame in frames}
    for link in robot.findall("link"):
        frame = places.get(link.get("name"))
        for visual in link.findall("visual") if frame else ():
            try:
                shape, place = _shape_of(visual, Path(path), meshes)
            except (_Unreadable, ValueError, struct.error) as error:
                missing.append(f"Link '{frame.link}': {error}")
                continue
            material = visual.find("material")
            colour = None if material is None else _colour(material) or named.get(material.get("name"))
            turned, moved = frame.rotation @ place[0], frame.position + frame.rotation @ place[1]
            items.append({"shape": shape, "body": frame.body, "kind": "shapes", "place": [*turned.ravel(), *moved],
                          "colour": colour or [0.72, 0.75, 0.78, 1.0]})
    return items, meshes, missing


def _three(element, name, default):
    """Numbers of an attribute."""
    return np.array([float(word) for word in (element.get(name, default) if element is not None else default).split()])


def _colour(material):
    """Red, green, blue and opacity of a material, or None."""
    colour = material.find("color")
    return None if colour is None else [float(word) for word in colour.get("rgba", "0.7 0.7 0.7 1").split()]


def _turned(roll, pitch, yaw):
    """The rotation of URDF's angles: about x, then y, then z, all fixed."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def _shape_of(visual, path, meshes):
    """The shape's name, and the matrix and position that place it in its link."""
    origin = visual.find("origin")
    R, p = _turned(*_three(origin, "rpy", "0 0 0")), _three(origin, "xyz", "0 0 0")
    geometry = next(iter(visual.findall("geometry/*")), None)
    kind = "nothing" if geometry is None else geometry.tag
    if kind == "box":
        return kind, (R * _three(geometry, "size", ""), p)
    if kind == "sphere":
        return kind, (R * float(geometry.get("radius", "")), p)
    if kind == "cylinder":  # about its middle; that of the page begins at 0
        radius, length = float(geometry.get("radius", "")), float(geometry.get("length", ""))
        return kind, (R * [radius, radius, length], p - R[:, 2] * length / 2)
    if kind != "mesh":
        raise _Unreadable(f"<{kind}> is not drawn")
    name = geometry.get("filename", "")
    if name not in meshes:
        meshes[name] = _packed(_triangles(_found(name, path)))
    return name, (R * _three(geometry, "scale", "1 1 1"), p)


def _found(name, path):
    """The file of a mesh: beside the robot's, or in the package that its name says, above it."""
    scheme, _, rest = name.rpartition("://")
    rest = rest.split("/", 1)[1] if scheme == "model" and "/" in rest else rest
    places = [path.parent / rest]
    for folder in path.resolve().parents if scheme else ():
        places += [folder / rest, *([folder / rest.split("/", 1)[1]] if folder.name == rest.split("/", 1)[0] else [])]
    for place in places:
        if place.is_file():
            return place
    raise _Unreadable(f"the mesh '{name}' is not there")


def _triangles(path):
    """Corners of the triangles of a mesh: 3 n x 3."""
    data, ending = path.read_bytes(), path.suffix.lower()
    if ending == ".obj":
        return _obj(data.decode(errors="replace"))
    if ending != ".stl":
        raise _Unreadable(f"'{path.name}': STL and OBJ files are drawn, not {ending or 'such'}")
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    if len(data) == 84 + 50 * count and count:
        rows = np.frombuffer(data, np.uint8, 50 * count, 84).reshape(count, 50)
        return np.ascontiguousarray(rows[:, 12:48]).view("<f4").reshape(-1, 3)
    words = data.decode(errors="replace").split()
    corners = [words[k + 1:k + 4] for k, word in enumerate(words) if word == "vertex"]
    if not corners or len(corners) % 3:
        raise _Unreadable(f"'{path.name}' is no STL")
    return np.array(corners, float)


def _obj(text):
    """Corners of the faces of an OBJ, as fans of triangles."""
    vertices, corners = [], []
    for line in text.splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append([float(x) for x in rest[:3]])
        elif word == "f":
            face = [int(corner.split("/")[0]) for corner in rest]
            face = [vertices[k - 1 if k > 0 else k] for k in face if -len(vertices) <= k <= len(vertices)]
            for second, third in zip(face[1:], face[2:]):
                corners += [face[0], second, third]
    if not corners:
        raise _Unreadable("an OBJ without faces")
    return np.array(corners, float)


def _packed(numbers):
    """Numbers for the page: float32 of little end, as base64."""
    return base64.b64encode(np.ascontiguousarray(numbers, "<f4").tobytes()).decode()
