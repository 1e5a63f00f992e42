#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Turns the reference results (*.json in the folder given) into C that needs no JSON library.

usage: convert.py FOLDER

Writes next to itself reference.h (the structures), NAME.inc for each NAME.json, and
reference_models.h (the list of all). Numbers keep the text they have in the JSON files, which reads
back as exactly the double that was computed.
"""
import json
import math
import sys
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
WIDTH = 110

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
ZERO3 = ["0", "0", "0"]
LIMITS = ["lower", "upper", "velocity", "effort"]

# The results of a state: key in JSON and C, shape, meaning. Arrays are row-major.
# Where a shape is 1, the C field is a plain number.
STATE = [
    ("gravity", "3", "world axes"),
    ("q", "nq", ""),
    ("v", "nv", ""),
    ("vdot", "nv", "the acceleration given to inverse dynamics"),
    ("tau", "nv", "the torque given to forward dynamics"),
    ("f_ext", "nb x 6", "external wrenches, for the two _ext results only"),
    ("tau_rnea", "nv", "inverse dynamics of q, v, vdot, without wrenches"),
    ("tau_rnea_ext", "nv", "and with them"),
    ("g", "nv", "gravity torque"),
    ("c", "nv", "bias: inverse dynamics at vdot = 0, without wrenches"),
    ("M", "nv x nv", "mass matrix"),
    ("Minv", "nv x nv", "its inverse"),
    ("qdd", "nv", "forward dynamics of q, v, tau, without wrenches"),
    ("qdd_ext", "nv", "and with them"),
    ("kinetic", "1", "energy, with the rotors'"),
    ("potential", "1", "energy, zero at the world origin"),
    ("mass", "1", "of all bodies that a joint moves"),
    ("com", "3", "their centre of mass, world axes"),
    ("com_vel", "3", "its velocity"),
    ("com_acc", "3", "its acceleration, for vdot"),
    ("body_R", "nb x 9", "rotations, link to world axes"),
    ("body_p", "nb x 3", "link origins in the world"),
    ("body_vel", "nb x 6", "spatial velocities, link axes"),
    ("body_acc", "nb x 6", "spatial accelerations for vdot, link axes, no gravity"),
    ("body_acc_classical", "nb x 3", "accelerations of link origins for vdot, link axes"),
    ("jac_body", "1", "the body of the Jacobians"),
    ("J_local", "6 x nv", "J_local v = body_vel"),
    ("J_world", "6 x nv", "at the link origin, world axes"),
    ("Jdot_v_world", "6", "d J_world / dt v"),
    ("h", "6", "centroidal momentum (angular about the com; linear), world axes"),
    ("A_h", "6 x nv", "centroidal momentum matrix, A_h v = h"),
    ("h_dot", "6", "dh / dt for vdot"),
    ("dtau_dq", "nv x nv", "d tau_rnea / tangent step of q; row = torque"),
    ("dtau_dv", "nv x nv", "d tau_rnea / dv"),
    ("dqdd_dq", "nv x nv", "d qdd / tangent step of q; row = acceleration"),
    ("dqdd_dv", "nv x nv", "d qdd / dv"),
    ("Y", "nv x nb x 10", "regressor: tau_rnea = Y pi + armature vdot"),
    ("dt", "1", "step of q_next"),
    ("q_next", "nq", "integrate(q, v dt)"),
    ("world_wrench", "6", "put on the world by all roots, about its origin, for vdot"),
    ("cond_M", "1", "condition number of M"),
]
INTEGERS = ["jac_body"]
BODY_COUNTS = [
    ("iq", "where the joint lies in q"),
    ("nq", "how much of q it has"),
    ("iv", "where it lies in v"),
    ("nv", "how much of v it has"),
]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def rotation(rpy):
    """URDF's Rz(yaw) Ry(pitch) Rx(roll) as nine texts, row by row."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(float(a)), math.cos(float(a))) for a in rpy)
    rx = [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    ry = [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]
    rz = [[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]
    return [rounded(x) for row in product(rz, product(ry, rx)) for x in row]


def rounded(x):
    """17 digits; what only rounding keeps from 0, 1 or -1 is that number."""
    return str(round(x)) if abs(x - round(x)) <= 1e-15 else f"{x:.17g}"


def braces(numbers):
    return "{" + ", ".join(numbers) + "}"


def c_body(body, note):
    """The initialiser of one rbd_body.
    body: a dict in the words of the reference data, numbers as texts. note: a comment to identify it."""
    groups = [
        f'{braces(body.get("axis", ZERO3))}, {braces(body.get("axis2", ZERO3))}, {body.get("pitch", "0")},',
        f'{braces(body["xyz"])},',
        f'{braces(rotation(body["rpy"]))},',
        f'{body["mass"]}, {braces(body["com"])},',
        f'{braces(body["inertia"])},',
        f'{{{body.get("armature", "0")}}}, {{0}}, {{0}},',
        f'{", ".join(body.get(key, "0") for key in LIMITS)},',
        "NULL, 0, 0},"]
    lines = [f'{{"{body["name"]}", "{body["joint"]}", {body["parent"]}, {JOINT_TYPES[body["type"]][0]},'
             f" /* {note} */"]
    for group in groups:
        lines += wrapped(group, WIDTH - 5)
    return "    " + "\n     ".join(lines) + "\n"


def wrapped(code, width):
    return textwrap.wrap(code, width, break_long_words=False, break_on_hyphens=False)


def state_field(key, shape, meaning):
    if shape == "1":
        return f"{'int' if key in INTEGERS else 'double'} {key};", meaning
    return f"const double *{key};", shape + (f": {meaning}" if meaning else "")


def fields(entries):
    """Declarations with their comments in one column."""
    column = max(len(declaration) for declaration, _ in entries)
    lines = (f"    {declaration:{column}} /* {comment} */" for declaration, comment in entries)
    return "\n".join(lines)


def structures():
    """The text of reference.h."""
    counts = [(f"const int *body_{key};", f"nb: {meaning}") for key, meaning in BODY_COUNTS]
    model = [
        ("const char *name;", "as in the name of the .inc file"),
        ("const char *about;", "for a person"),
        ("int nb;", "bodies"),
        ("int nq;", "length of q"),
        ("int nv;", "degrees of freedom"),
        ("const rbd_body *bodies;", "nb"),
        ("const double *pi;", "nb x 10: m, m com, inertia xx xy xz yy yz zz about the link origin"),
        *counts,
        ("int nstates;", "5 to 10"),
        ("const ref_state *states;", "nstates")]
    return f"""\
/* reference.h - layout of the reference results; README.md has their origin. Include rbd.h before.
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
#ifndef REFERENCE_H
#define REFERENCE_H

/* One state of a model: inputs and results. Conventions are rbd's; arrays are row-major. */
typedef struct ref_state {{
{fields([state_field(*entry) for entry in STATE])}
}} ref_state;

/* A model with its states. */
typedef struct ref_model {{
{fields(model)}
}} ref_model;

#endif
"""


def index(names):
    """The text of reference_models.h."""
    includes = "".join(f'#include "{name}.inc"\n' for name in names)
    pointers = "".join(f"    &ref_{name},\n" for name in names)
    return f"""\
/* reference_models.h - all models with reference results. Include rbd.h before.
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
#ifndef REFERENCE_MODELS_H
#define REFERENCE_MODELS_H

{includes}
#define REF_MODELS {len(names)}

/* clang-format off */
static const ref_model *const ref_models[REF_MODELS] = {{
{pointers}}};
/* clang-format on */

#endif
"""


def flat(value):
    return [x for item in value for x in flat(item)] if isinstance(value, list) else [value]


def length(shape, model):
    product = 1
    for factor in shape.split(" x "):
        product *= int(model.get(factor, factor))
    return product


def c_array(ctype, name, numbers, expected):
    if len(numbers) != expected:
        raise ValueError(f"{name}: {len(numbers)} numbers instead of {expected}")
    lines = wrapped(", ".join(numbers), WIDTH - 6)
    return f"static const {ctype} {name}[{expected}] = {{\n    " + "\n    ".join(lines) + "};\n"


def dense_wrenches(state, nb):
    rows = [["0"] * 6 for _ in range(nb)]
    for entry in state["wrenches"]:
        rows[int(entry["body"])] = entry["wrench"]
    return rows


def c_states(prefix, model):
    """The arrays of every state, then the table of states that points to them."""
    arrays, rows = [], []
    for i, state in enumerate(model["states"]):
        state["f_ext"] = dense_wrenches(state, int(model["nb"]))
        unknown = set(state) - {key for key, _, _ in STATE} - {"wrenches"}
        if unknown:
            raise ValueError(f"{prefix}: keys that STATE does not list: {sorted(unknown)}")
        values = []
        for key, shape, _ in STATE:
            name = f"{prefix}_{i}_{key}"
            if shape == "1":
                values.append(state[key])
            else:
                arrays.append(c_array("double", name, flat(state[key]), length(shape, model)))
                values.append(name)
        rows.append("    {" + "\n     ".join(wrapped(", ".join(values), WIDTH - 5)) + "},\n")
    return "".join(arrays) + f"static const ref_state {prefix}_states[{len(rows)}] = {{\n{''.join(rows)}}};\n"


def c_bodies(prefix, model):
    bodies = model["bodies"]
    for i, body in enumerate(bodies):
        own = tuple(int(body[key]) for key in ("nq", "nv"))
        if own != JOINT_TYPES[body["type"]][1:]:
            raise ValueError(f"{prefix}, body {i}: a {body['type']} joint with (nq, nv) = {own}")
    rows = "".join(c_body(body, f"body {i}") for i, body in enumerate(bodies))
    return f"static const rbd_body {prefix}_bodies[{len(bodies)}] = {{\n{rows}}};\n"


def c_model(model):
    """The text of NAME.inc."""
    name, nb = model["name"], int(model["nb"])
    prefix = f"ref_{name}"
    counts = [f"{prefix}_body_{key}" for key, _ in BODY_COUNTS]
    head = f"""\
/* {name}.inc - reference results, {model["source"]}. Include rbd.h before.
   {model["about"]}
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
#include "reference.h"

"""
    pi = c_array("double", f"{prefix}_pi", flat([body["pi"] for body in model["bodies"]]), 10 * nb)
    joints = [c_array("int", array, [body[key] for body in model["bodies"]], nb)
              for (key, _), array in zip(BODY_COUNTS, counts)]
    tail = f"""\
static const ref_model {prefix} = {{
    "{name}",
    "{model["about"]}",
    {nb}, {model["nq"]}, {model["nv"]}, {prefix}_bodies, {prefix}_pi,
    {", ".join(counts)},
    {len(model["states"])}, {prefix}_states}};
"""
    return head + c_bodies(prefix, model) + pi + "".join(joints) + c_states(prefix, model) + tail


def read(path):
    """Numbers stay texts, so that no digit is lost or added."""
    model = json.loads(path.read_text(encoding="utf-8"), parse_float=str, parse_int=str)
    if model["name"] != path.stem:
        raise ValueError(f"{path}: the model is called {model['name']}")
    return model


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    paths = sorted(Path(sys.argv[1]).glob("*.json"))
    if not paths:
        sys.exit(f"convert.py: no *.json in {sys.argv[1]}")
    for path in paths:
        (HERE / f"{path.stem}.inc").write_text(c_model(read(path)), encoding="utf-8")
    (HERE / "reference.h").write_text(structures(), encoding="utf-8")
    (HERE / "reference_models.h").write_text(index([path.stem for path in paths]), encoding="utf-8")


if __name__ == "__main__":
    main()
