# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Pictures of a robot: a page for the browser that needs no server and no network."""
from __future__ import annotations

import json
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ._arguments import _Declared, _array, _numbers
from ._headers import JointType, _warn

if TYPE_CHECKING:
    from ._model import Model

_PAGE = Path(__file__).resolve().parent / "viewer.html"
_FRAMES = 60        # pictures in a second of a motion
_MOST = 1500        # pictures in a page: of a longer motion they are further apart

_KINDS = {
    "shapes": ("shapes of the file", None),
    "links": ("links", [0.91, 0.525, 0.18, 1]),
    "joints": ("joint axes", [0.24, 0.29, 0.34, 1]),
    "inertias": ("inertia, as an ellipsoid of the same mass", [0.18, 0.435, 0.87, 0.18]),
    "com": ("centre of mass, and below it", [0.75, 0.15, 0.15, 1]),
    "frames": ("link frames: x red, y green, z blue", None),
}


class Picture(_Declared):
    """A page of a robot: the result of Model.show. In a notebook it is seen there."""
    html: str           #: the page
    path: Path | None   #: its file; None in a notebook

    def __init__(self, text: str, path: Path | None):
        self.html, self.path = text, path

    def _repr_html_(self):
        import html
        return (f'<iframe srcdoc="{html.escape(self.html)}" style="width: 100%; height: 480px; border: 0" '
                'title="rbd"></iframe>')

    def __repr__(self):
        return f"<rbd.Picture in {self.path}>" if self.path else "<rbd.Picture>"


def _show(model, q, times, file):
    """The picture of a model; opens the browser if it shall go into no file and no notebook."""
    import html  # these are read when a picture is asked for: rbd is imported sooner
    import webbrowser

    states, times = _states(model, q, times)
    states, step = _at_rate(model, states, times)
    scene = _scene(model, states, step, times[0])
    text = json.dumps(scene, allow_nan=False).replace("<", "\\u003c")
    page = _PAGE.read_text(encoding="utf-8").replace("SCENE", text, 1).replace("TITLE", html.escape(scene["title"]), 1)

    if file is None and "ipykernel" in sys.modules:
        return Picture(page, None)
    if file is None:
        number, file = tempfile.mkstemp(".html", "rbd-")
        os.close(number)
        opens = True
    else:
        opens = False
    path = Path(file).resolve()
    path.write_text(page, encoding="utf-8")
    if opens and not webbrowser.open(path.as_uri()):
        _warn([f"no browser was found; the picture is in {path}"])
    return Picture(page, path)


def _states(model, q, times):
    """States, n x nq, and their times."""
    q = model.neutral() if q is None else q
    if _array("show", "q", q).ndim != 2:
        if times is not None:
            raise ValueError("show: times are for a trajectory, q n x nq")
        return _numbers("show", "q", q, (model.nq,))[None], np.zeros(1)
    states = _numbers("show", "q", q, (None, model.nq), symbols=("n", "nq"))
    if not len(states):
        raise ValueError("show: q has no states")
    times = np.arange(len(states)) / _FRAMES if times is None else _numbers("show", "times", times, (len(states),))
    if (times[1:] <= times[:-1]).any():
        raise ValueError("show: times must grow")
    if abs(times).max() > 1e300:
        raise ValueError("show: times are too far apart")
    return states, times


def _at_rate(model, states, times):
    """The states that the page shows, and the seconds from one to the next."""
    length = times[-1] - times[0]
    count = int(min(_MOST, round(length * _FRAMES) + 1))
    if len(states) < 2 or count < 2:
        return states[:1], 0.0
    wanted = np.linspace(times[0], times[-1], count)
    after = np.clip(np.searchsorted(times, wanted), 1, len(times) - 1)
    share = (wanted - times[after - 1]) / (times[after] - times[after - 1])
    return model.interpolate(states[after - 1], states[after], np.clip(share, 0, 1)), length / (count - 1)


def _scene(model, states, step, start):
    """All that the page draws."""
    from ._visuals import _packed, _visuals

    rows, (path, frames, name) = model._rows, model._drawn
    poses, centres = _poses(model.copy(), states)
    tips = _tips(model, rows)
    size = _extent(poses[:1], tips)[1]
    items, meshes, missing = _visuals(path, frames)
    shaped = {item["body"] for item in items}
    items += _rods(rows, tips, size, shaped)
    items += [item for body in range(model.nb) for item in _axes(body, 0.12 * size)]

    ends = [[*of, *_corners(items, body)] for body, of in enumerate(tips)]
    facts = f"{model.nb} bodies, {model.nv} degrees of freedom"
    return {
        "title": Path(path).stem if path else name or "A robot", "missing": missing, "meshes": meshes, "size": size,
        "facts": facts + (f", {model.mass():.4g} kg" if len(centres) else ""),
        "kinds": {kind: {"label": label, "colour": colour, "on": kind != "frames"} for kind, (label, colour) in _KINDS.items()},
        "items": [{**item, "place": [float(x) for x in item["place"]]} for item in items], "bodies": model.nb,
        "poses": _packed(poses), "step": step, "start": float(start), "com": _packed(centres) if len(centres) else None,
        "box": _extent(poses[::max(1, len(poses) // 50)], ends)[0],
    }


def _poses(model, states):
    """Poses of all bodies in all states, R by rows and p; and the centres of mass, of a robot that has mass."""
    poses, centres = np.empty((len(states), model.nb, 12)), []
    for q, frame in zip(states, poses):
        model.kinematics(q)
        for body, row in enumerate(frame):
            R, p = model.body_pose(body)
            row[:9], row[9:] = R.ravel(), p
        if model.mass() > 0:
            centres.append(model.com().position)
    return poses, centres


def _tips(model, rows):
    """Where links end, body by body: the origins of what they carry. A rod of a last link's mass would end at twice its
    centre of mass."""
    tips = [[] for _ in rows]
    for row in rows:
        if row.parent >= 0:
            tips[row.parent].append(np.array(row.position))
    for frame in model._drawn[1]:
        if frame.body >= 0 and np.any(frame.position):
            tips[frame.body].append(frame.position)
    for row, of in zip(rows, tips):
        if not of:
            of.append(2 * np.array(row.com))
    return tips


def _extent(poses, ends):
    """The box that holds the origins and these points of all bodies in these poses, and its diagonal."""
    points = []
    for body, of in enumerate(ends):
        R, p = poses[:, body, :9].reshape(-1, 3, 3), poses[:, body, 9:]
        points += [p, *(R @ np.asarray(end, float) + p for end in of)]
    points = np.concatenate(points) if points else np.zeros((1, 3))
    low, high = points.min(0), points.max(0)
    return [low.tolist(), high.tolist()], float(np.linalg.norm(high - low)) or 0.5


def _corners(items, body):
    """The ends of the ellipsoid and of the file's shapes of a body."""
    for item in items:
        if item["body"] == body and item["kind"] in ("inertias", "shapes") and item["shape"] in ("sphere", "box", "cylinder"):
            R, p = np.reshape(item["place"][:9], (3, 3)), np.array(item["place"][9:])
            yield from (p + sign * half for half in R.T for sign in (1, -1))


def _rods(rows, tips, size, shaped):
    """Rods to where links end, a cylinder along each joint's axis, and ellipsoids of inertia: of bodies without shapes."""
    thick = 0.013 * size * min(1.0, (12 / max(len(rows), 1)) ** 0.5)
    for number, row in enumerate(rows):
        if number in shaped:
            continue
        for tip in tips[number]:
            if np.linalg.norm(tip) > 1e-4:
                yield {"shape": "cylinder", "body": number, "kind": "links", "place": _between(0 * tip, tip, thick)}
        axis = np.array(row.axis)
        if np.any(axis) and row.type not in (JointType.FIXED, JointType.SPHERICAL, JointType.FLOATING):
            half = 2.2 * thick * axis / np.linalg.norm(axis)
            yield {"shape": "cylinder", "body": number, "kind": "joints", "place": _between(-half, half, 1.7 * thick)}
        if row.mass > 0:
            yield {"shape": "sphere", "body": number, "kind": "inertias", "place": _ellipsoid(row)}


def _axes(body, length):
    """The axes of a body's link frame."""
    for axis, colour in zip(length * np.eye(3), ([0.8, 0.1, 0.1, 1], [0.1, 0.6, 0.15, 1], [0.15, 0.3, 0.85, 1])):
        yield {"shape": "cylinder", "body": body, "kind": "frames", "place": _between(0 * axis, axis, 0.04 * length),
               "colour": colour}


def _between(start, end, radius):
    """The place of the page's cylinder from one point to another: a matrix by rows, and a position."""
    along = end - start
    z = along / np.linalg.norm(along)
    x = np.cross(z, np.eye(3)[np.argmin(abs(z))])
    x /= np.linalg.norm(x)
    return [*np.column_stack([radius * x, radius * np.cross(z, x), along]).ravel(), *start]


def _ellipsoid(row):
    """The place of the page's ball as the ellipsoid of a body's mass and inertia, with its mass evenly spread."""
    xx, xy, xz, yy, yz, zz = row.inertia
    moments, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    lengths = np.sqrt(np.maximum(1e-6, 2.5 / row.mass * (moments.sum() - 2 * moments)))
    return [*(axes * lengths).ravel(), *row.com]
