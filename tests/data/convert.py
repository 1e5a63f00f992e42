#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Packs the reference results (*.json in the folder given) as NAME.bin next to itself, as reference.h lays them out.

usage: convert.py FOLDER

Of the models without `control_` the first KEPT states are taken, of the others all. Python 3.8 without packages."""
import json
import math
import sys
from pathlib import Path

from packed import HERE, STRUCTURES, SUFFIX, pack, root

KEPT = 3

# Joint types by their names in the results: (type in C, length of q, length of v).
JOINT_TYPES = {
    "fixed": ("RBD_FIXED", 0, 0),
    "revolute": ("RBD_REVOLUTE", 1, 1),
    "continuous": ("RBD_CONTINUOUS", 1, 1),
    "continuous_cs": ("RBD_CONTINUOUS_CS", 2, 1),
    "prismatic": ("RBD_PRISMATIC", 1, 1),
    "helical": ("RBD_HELICAL", 1, 1),
    "universal": ("RBD_UNIVERSAL", 2, 2),
    "spherical": ("RBD_SPHERICAL", 4, 3),
    "spherical_zyx": ("RBD_EULER_ZYX", 3, 3),
    "planar": ("RBD_PLANAR", 3, 3),
    "translation": ("RBD_TRANSLATION", 3, 3),
    "floating": ("RBD_FLOATING", 7, 6),
}


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def rotation(rpy):
    """URDF's Rz(yaw) Ry(pitch) Rx(roll), row by row."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a), math.cos(a)) for a in rpy)
    rx = [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    ry = [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]
    rz = [[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]
    return [rounded(x) for row in product(rz, product(ry, rx)) for x in row]


def rounded(x):
    """What only rounding keeps from 0, 1 or -1 is that number."""
    return round(x) if abs(x - round(x)) <= 1e-15 else x


def body(b):
    c_type, nq, nv = JOINT_TYPES[b["type"]]
    if (b["nq"], b["nv"]) != (nq, nv):
        raise ValueError(f"{b['name']}: a {b['type']} joint with nq, nv = {b['nq']}, {b['nv']}")
    return {"name": b["name"], "joint": b["joint"], "parent": b["parent"], "type": c_type,
            "axis": b.get("axis", [0, 0, 0]), "axis2": b.get("axis2", [0, 0, 0]), "pitch": b.get("pitch", 0),
            "position": b["xyz"], "rotation": rotation(b["rpy"]), "mass": b["mass"], "com": b["com"],
            "inertia": b["inertia"], "armature": b.get("armature", 0)}


def flat(x):
    return [number for item in x for number in flat(item)] if isinstance(x, list) else [x]


def dense_wrenches(state, nb):
    rows = [[0] * 6 for _ in range(nb)]
    for entry in state.pop("wrenches"):
        rows[entry["body"]] = entry["wrench"]
    return rows


def control_state(state, nv):
    """The state as reference.h lists it: of what there is one of, the members become the state's."""
    for owner in "hybrid", "integrate", "difference":
        state.update({f"{owner}_{key}": x for key, x in state.pop(owner).items()})
    state["hybrid_given"] = [int(k in state["hybrid_given"]) for k in range(nv)]
    for entry in state["constraint_sets"]:
        entry.update(count=len(entry["constraints"]), rows=len(entry["e"]))
        for constraint in entry["constraints"]:
            constraint["axes"] = list(map(int, constraint["axes"]))
    for key in "points", "constraint_sets":
        state["n" + key] = len(state[key])
    return state


def ordered(kind, record):
    """The members in the order of reference.h, arrays without rows."""
    members = STRUCTURES[kind]
    unknown = set(record) - {member.name for member in members}
    if unknown:
        raise ValueError(f"keys that reference.h does not have: {', '.join(sorted(unknown))}")
    out = {}
    for member in members:
        x = record.get(member.name)
        if member.kind in STRUCTURES and isinstance(x, list):
            x = [ordered(member.kind, row) for row in x]
        elif isinstance(x, list) and member.kind != "rbd_body":
            x = flat(x)
        out[member.name] = x
    return out


def converted(model):
    """The record of a model."""
    nb, nv = model["nb"], model["nv"]
    bodies = model["bodies"]
    record = {"name": model["name"], "about": model["about"], "nb": nb, "nq": model["nq"], "nv": nv,
              "pi": [b["pi"] for b in bodies]}
    record.update({f"body_{key}": [b[key] for b in bodies] for key in ("iq", "nq", "iv", "nv")})
    states = model["states"]
    for state in states:
        state["f_ext"] = dense_wrenches(state, nb)
    if root(model["name"]) == "ref_model":
        states = states[:KEPT]
        record.update(nstates=len(states), states=states)
        return {**ordered("ref_model", record), "bodies": list(map(body, bodies))}
    record = {**ordered("ref_model", {**record, "nstates": 0}), "bodies": list(map(body, bodies))}
    rest = {"nstates": len(states), "states": [control_state(state, nv) for state in states]}
    return {**ordered("ref_control", rest), "model": record}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    paths = sorted(Path(sys.argv[1]).glob("*.json"))
    if not paths:
        sys.exit(f"convert.py: no *.json in {sys.argv[1]}")
    for path in paths:
        model = json.loads(path.read_text(encoding="utf-8"))
        if model["name"] != path.stem:
            raise ValueError(f"{path}: the model is called {model['name']}")
        (HERE / f"{path.stem}{SUFFIX}").write_bytes(pack(root(path.stem), converted(model)))


if __name__ == "__main__":
    main()
