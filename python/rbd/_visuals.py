# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""The visual shapes of a URDF, for pictures: boxes, cylinders, balls, and meshes of STL, OBJ and Collada files."""
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
    named = {material.get("name"): _colour(material) for material in robot.findall("material")}
    places = {frame.link: frame for frame in frames}
    for link in robot.findall("link"):
        frame = places.get(link.get("name"))
        for visual in link.findall("visual") if frame else ():
            try:
                shape, place = _shape_of(visual, Path(path), meshes)
            except (_Unreadable, OSError) as error:
                missing.append(f"Link '{frame.link}': {error}")
                continue
            material = visual.find("material")
            colour = None if material is None else _colour(material) or named.get(material.get("name"))
            turned, moved = frame.rotation @ place[0], frame.position + frame.rotation @ place[1]
            items.append({"shape": shape, "body": frame.body, "kind": "shapes", "place": [*turned.ravel(), *moved],
                          "colour": colour or [0.72, 0.75, 0.78, 1.0]})
    return items, meshes, missing


def _attribute(element, name, count, default=""):
    """The numbers of an attribute, finite and so many."""
    text = default if element is None else element.get(name, default)
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.zeros(0)
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise _Unreadable(f"{name} is '{text}'; it must have {count} number{'s' * (count > 1)}")
    return numbers


def _colour(material):
    """Red, green, blue and opacity of a material; None where there are none, or no numbers: other programs pass over
    such colours too."""
    try:
        return _attribute(material.find("color"), "rgba", 4).tolist()
    except _Unreadable:
        return None


def _turned(roll, pitch, yaw):
    """The rotation of URDF's angles: about x, then y, then z, all fixed."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def _shape_of(visual, path, meshes):
    """The shape's name, and the matrix and position that place it in its link."""
    origin = visual.find("origin")
    R, p = _turned(*_attribute(origin, "rpy", 3, "0 0 0")), _attribute(origin, "xyz", 3, "0 0 0")
    geometry = next(iter(visual.findall("geometry/*")), None)
    kind = "nothing" if geometry is None else geometry.tag
    if kind == "box":
        return kind, (R * _attribute(geometry, "size", 3), p)
    if kind == "sphere":
        return kind, (R * _attribute(geometry, "radius", 1), p)
    if kind == "cylinder":  # about its middle; that of the page begins at 0
        [radius], [length] = _attribute(geometry, "radius", 1), _attribute(geometry, "length", 1)
        return kind, (R * [radius, radius, length], p - R[:, 2] * length / 2)
    if kind != "mesh":
        raise _Unreadable(f"<{kind}> is not drawn")
    name = geometry.get("filename", "")
    if name not in meshes:
        meshes[name] = _packed(_mesh(name, path))
    return name, (R * _attribute(geometry, "scale", 3, "1 1 1"), p)


def _mesh(name, path):
    """Corners of the triangles of a mesh that a file names: 3 n x 3."""
    try:
        corners = _triangles(_found(name, path))
    except (ValueError, struct.error) as error:
        raise _Unreadable(f"the mesh '{name}' cannot be read: {error}") from None
    if corners.ndim != 2 or corners.shape[1] != 3 or not np.isfinite(corners).all():
        raise _Unreadable(f"the mesh '{name}' has corners that are not three finite numbers")
    return corners


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
    if ending == ".dae":
        return _collada(path)
    if ending != ".stl":
        raise _Unreadable(f"'{path.name}': STL, OBJ and Collada files are drawn, not {ending or 'such'}")
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
            face = [vertices[k - 1 if k > 0 else k] for k in face if k and -len(vertices) <= k <= len(vertices)]
            for second, third in zip(face[1:], face[2:]):
                corners += [face[0], second, third]
    if not corners:
        raise _Unreadable("an OBJ without faces")
    return np.array(corners, float)


def _collada(path):
    """Corners of the triangles of a Collada file, in metres. Its upward axis is not heeded, as nowhere in ROS."""
    try:
        root = ElementTree.parse(path).getroot()
        found = {f"#{part.get('id')}": part for part in root.iter() if part.get("id")}
        unit = root.find("{*}asset/{*}unit")
        corners = []
        for scene in root.findall("{*}library_visual_scenes/{*}visual_scene"):
            corners += _of_node(scene, np.eye(4), found)
        return np.concatenate(corners) * float(unit.get("meter", 1) if unit is not None else 1)
    except (ElementTree.ParseError, AttributeError, KeyError, IndexError, ValueError, RecursionError) as error:
        raise _Unreadable(f"'{path.name}' is no Collada that can be drawn: {error}") from None


def _of_node(node, place, found):
    """Corners of the meshes of a node and of those that it carries."""
    corners = []
    for part in node:
        kind = part.tag.rpartition("}")[2]
        if kind in ("matrix", "translate", "rotate", "scale"):
            place = place @ _transform(kind, np.array(part.text.split(), float))
        elif kind == "instance_geometry":
            for mesh in found[part.get("url")].findall("{*}mesh"):
                corners += [points @ place[:3, :3].T + place[:3, 3] for points in _of_mesh(mesh, found)]
        elif kind in ("node", "instance_node"):
            corners += _of_node(part if kind == "node" else found[part.get("url")], place, found)
    return corners


def _transform(kind, x):
    """A step of a node's place: 4 x 4."""
    if kind == "matrix":
        return x.reshape(4, 4)
    result = np.eye(4)
    if kind == "translate":
        result[:3, 3] = x
    elif kind == "scale":
        result[:3, :3] = np.diag(x)
    else:  # an axis, and degrees
        (a, b, c), angle = x[:3] / np.linalg.norm(x[:3]), np.radians(x[3])
        K = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
        result[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    return result


def _of_mesh(mesh, found):
    """Corners of the triangles of a mesh; polygons as fans."""
    for part in mesh:
        if part.tag.rpartition("}")[2] not in ("triangles", "polylist", "polygons"):
            continue
        inputs = part.findall("{*}input")
        wide = 1 + max(int(entry.get("offset")) for entry in inputs)
        vertex = next(entry for entry in inputs if entry.get("semantic") == "VERTEX")
        source = next(entry for entry in found[vertex.get("source")] if entry.get("semantic") == "POSITION").get("source")
        points = np.array(found[source].find("{*}float_array").text.split(), float).reshape(-1, 3)
        lists = [np.array((p.text or "").split(), int).reshape(-1, wide)[:, int(vertex.get("offset"))] for p in part.findall("{*}p")]
        counts = part.find("{*}vcount")
        for corners in lists:
            if counts is not None:
                faces = np.split(corners, np.cumsum(np.array(counts.text.split(), int))[:-1])
            else:
                faces = [corners] if part.tag.endswith("polygons") else corners.reshape(-1, 3)
            fans = [k for face in faces for k in zip(face[:1].repeat(len(face) - 2), face[1:], face[2:])]
            if fans:
                yield points[np.array(fans).ravel()]


def _packed(numbers):
    """Numbers for the page: float32 of little end, as base64."""
    return base64.b64encode(np.ascontiguousarray(numbers, "<f4").tobytes()).decode()
