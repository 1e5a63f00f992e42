#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Turns the reference results (*.json in the folder given) into C that needs no JSON library.

usage: convert.py FOLDER

Writes next to itself reference.h (the structures), NAME.inc for each NAME.json, and the lists of all:
reference_models.h, and control_models.h of those called control_*. Numbers keep the text they have in the
JSON files, which reads back as exactly the double that was computed.
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
INTEGERS = ["jac_body", "body", "npoints", "nconstraint_sets", "rows", "rank", "count", "hybrid_given"]

# The same of control_*.json, where (key, shape) alone is as above. A key of an object within the state has
# the object's name before it. What a state does not have is NULL.
CONTROL = [
    ("gravity", "3"), ("q", "nq"), ("v", "nv"), ("vdot", "nv"), ("tau", "nv"), ("f_ext", "nb x 6"),
    ("tau_rnea", "nv"), ("tau_rnea_ext", "nv"), ("qdd", "nv"), ("qdd_ext", "nv"), ("c", "nv"), ("g", "nv"),
    ("M", "nv x nv"), ("Minv", "nv x nv"),
    ("dtau_dq", "nv x nv"), ("dtau_dv", "nv x nv"), ("dqdd_dq", "nv x nv"), ("dqdd_dv", "nv x nv"),
    ("dtau_dq_ext", "nv x nv", "of tau_rnea_ext, wrenches held in link axes"),
    ("dtau_dv_ext", "nv x nv", ""),
    ("dqdd_dq_ext", "nv x nv", "of qdd_ext, likewise"),
    ("dqdd_dv_ext", "nv x nv", ""),
    ("C", "nv x nv", "Coriolis matrix: C v = c - g"),
    ("Mdot", "nv x nv", "dM / dt along v, which is C + C'"),
    ("npoints", "1", "3"),
    ("points", "npoints", ""),
    ("J_com", "3 x nv", "J_com v = com_vel"),
    ("A_h", "6 x nv"), ("h", "6", "centroidal momentum, world axes"), ("h_dot", "6"),
    ("A_h_dot_v", "6", "h_dot - A_h vdot"),
    ("hybrid_given", "nv", "1 where a is given by vdot, 0 where tau is given"),
    ("hybrid_a", "nv", "the full result: M a + c = tau"),
    ("hybrid_tau", "nv", ""),
    ("kinetic", "1"), ("potential", "1"),
    ("Y", "nv x nb x 10", "as before; NULL in the last states"),
    ("Y_kinetic", "nb x 10", "kinetic = Y_kinetic pi + sum armature v^2 / 2"),
    ("Y_potential", "nb x 10", "potential = Y_potential pi"),
    ("integrate_d", "nv", "a tangent step from q"),
    ("integrate_q_plus", "nq", "integrate(q, d)"),
    ("integrate_d_dq", "nv x nv", "d q_plus / tangent step of q"),
    ("integrate_d_dd", "nv x nv", "d q_plus / dd"),
    ("difference_q1", "nq", ""),
    ("difference_d", "nv", "difference(q, q1): q1 = integrate(q, d)"),
    ("difference_d_dq0", "nv x nv", "d d / tangent step of q"),
    ("difference_d_dq1", "nv x nv", "d d / tangent step of q1"),
    ("nconstraint_sets", "1", "1 to 3"),
    ("constraint_sets", "nconstraint_sets", "each for itself"),
    ("cond_M", "1"),
]
POINT = [
    ("body", "1", "the link"),
    ("p", "3", "the point, fixed in the link, link axes"),
    ("point_J", "6 x nv", "angular velocity; velocity of the point; world axes"),
    ("point_J_link", "6 x nv", "the same in link axes"),
    ("point_pos", "3", "world"),
    ("point_vel", "6", "point_J v"),
    ("point_acc_classical", "6", "d point_vel / dt for vdot"),
    ("point_bias", "6", "the same for vdot = 0: d point_J / dt v"),
]
CONSTRAINT_SET = [
    ("count", "1", "of constraints"),
    ("constraints", "count", ""),
    ("kp", "1", "1/s^2, of Baumgarte's method"),
    ("kd", "1", "1/s"),
    ("restitution", "1", "0.5"),
    ("v_minus", "nv", "velocity before the impact"),
    ("rows", "1", "axes held, of all the constraints"),
    ("rank", "1", "of J_c"),
    ("cond", "1", "largest over smallest non-zero singular value of J_c Minv J_c'"),
    ("J_c", "rows x nv", "J_c v = velocity of frame 1 seen from 2"),
    ("gamma", "rows", "dJ_c / dt v"),
    ("e", "rows", "position error"),
    ("qdd_c", "nv", "a of M a + c = tau + J_c' lambda, J_c a + gamma = 0"),
    ("lambda", "rows", ""),
    ("qdd_b", "nv", "the same with J_c a + gamma = -kd (J_c v) - kp e"),
    ("lambda_b", "rows", ""),
    ("qdd_c_ext", "nv", "as qdd_c, with the wrenches"),
    ("lambda_ext", "rows", ""),
    ("v_plus", "nv", "M (v_plus - v_minus) = J_c' impulse, J_c v_plus = 0"),
    ("impulse", "rows", ""),
    ("v_plus_r", "nv", "the same with J_c v_plus = -restitution J_c v_minus"),
    ("impulse_r", "rows", ""),
    ("dqdd_c_dq", "nv x nv", "derivatives; NULL where rank < rows"),
    ("dqdd_c_dv", "nv x nv", ""),
    ("dqdd_c_dtau", "nv x nv", ""),
    ("dlambda_dq", "rows x nv", ""),
    ("dlambda_dv", "rows x nv", ""),
    ("dlambda_dtau", "rows x nv", ""),
    ("dqdd_b_dq", "nv x nv", ""),
    ("dqdd_b_dv", "nv x nv", ""),
    ("dlambda_b_dq", "rows x nv", ""),
    ("dlambda_b_dv", "rows x nv", ""),
]
MEANINGS = {key: meaning for key, _, meaning in STATE}
CONTROL = [entry if len(entry) == 3 else (*entry, MEANINGS[entry[0]]) for entry in CONTROL]
OPTIONAL = ["Y"] + [key for key, _, _ in CONSTRAINT_SET if key.startswith("d")]
OBJECTS = {"points": "ref_point", "constraint_sets": "ref_constraint_set", "constraints": "ref_constraint"}
CONSTRAINT = ["body1", "R1", "p1", "body2", "R2", "p2", "axes"]
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


def ctype(key):
    return OBJECTS.get(key, "int" if key in INTEGERS else "double")


def state_field(key, shape, meaning):
    if shape == "1":
        return f"{ctype(key)} {key};", meaning
    return f"const {ctype(key)} *{key};", shape + (f": {meaning}" if meaning else "")


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
        ("int nstates;", "5 to 10; a control model's states are elsewhere: 0"),
        ("const ref_state *states;", "nstates; NULL")]
    control = [
        ("const ref_model *model;", "another one than those above, without states"),
        ("int nstates;", "4"),
        ("const ref_control_state *states;", "nstates")]
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

/* ---- what controllers ask; README.md has the definitions ---- */

/* A point fixed in a link. */
typedef struct ref_point {{
{fields([state_field(*entry) for entry in POINT])}
}} ref_point;

/* Frame 1 held to frame 2; R1, R2 turn frame vectors into the body's axes. */
typedef struct ref_constraint {{
    int body1;
    double R1[9], p1[3];
    int body2; /* -1: the world */
    double R2[9], p2[3];
    int axes[6]; /* held: omega_x omega_y omega_z v_x v_y v_z, along the axes of frame 2 */
}} ref_constraint;

/* Constraints that hold together. */
typedef struct ref_constraint_set {{
    const char *name;
{fields([state_field(*entry) for entry in CONSTRAINT_SET])}
}} ref_constraint_set;

/* One state: inputs and results. */
typedef struct ref_control_state {{
{fields([state_field(*entry) for entry in CONTROL])}
}} ref_control_state;

/* A model with its states. */
typedef struct ref_control {{
{fields(control)}
}} ref_control;

#endif
"""


def index(kind, names):
    """The text of KIND_models.h: all the ref_model, or all the ref_control."""
    includes = "".join(f'#include "{name}.inc"\n' for name in names)
    pointers = "".join(f"    &ref_{name},\n" for name in names)
    ctype, array = {"reference": ("ref_model", "ref_models"), "control": ("ref_control", "ref_controls")}[kind]
    guard, count = f"{kind.upper()}_MODELS_H", array.upper()
    return f"""\
/* {kind}_models.h - all models with {kind} results. Include rbd.h before.
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
#ifndef {guard}
#define {guard}

{includes}
#define {count} {len(names)}

/* clang-format off */
static const {ctype} *const {array}[{count}] = {{
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


class Arrays:
    """The arrays of one file; one that is there already is not written again."""

    def __init__(self):
        self.text, self.names = [], {}

    def add(self, name, kind, numbers, expected):
        key = (kind, *numbers)
        if key not in self.names:
            self.names[key] = name
            self.text.append(c_array(kind, name, numbers, expected))
        return self.names[key]


def dense_wrenches(state, nb):
    rows = [["0"] * 6 for _ in range(nb)]
    for entry in state["wrenches"]:
        rows[int(entry["body"])] = entry["wrench"]
    return rows


def c_row(name, record, entries, sizes, arrays):
    """The initialiser of one structure; the arrays it points to go before it."""
    unknown = set(record) - {key for key, _, _ in entries} - {"wrenches", "name"}
    if unknown:
        raise ValueError(f"{name}: keys that are not listed: {sorted(unknown)}")
    values = [f'"{record["name"]}"'] if "name" in record else []
    sizes = {**sizes, **{key: record[key] for key, shape, _ in entries if shape == "1"}}
    for key, shape, _ in entries:
        if shape == "1":
            values.append(record[key])
        elif key in OBJECTS:
            rows = [OBJECT_ROWS[key](f"{name}_{key}{i}", entry, sizes, arrays) for i, entry in enumerate(record[key])]
            arrays.text.append(c_rows(f"{OBJECTS[key]} {name}_{key}", rows))
            values.append(f"{name}_{key}")
        elif key in OPTIONAL and key not in record:
            values.append("NULL")
        else:
            values.append(arrays.add(f"{name}_{key}", ctype(key), flat(record[key]), length(shape, sizes)))
    return "    {" + "\n     ".join(wrapped(", ".join(values), WIDTH - 5)) + "},\n"


def c_rows(declaration, rows):
    return f"static const {declaration}[{len(rows)}] = {{\n{''.join(rows)}}};\n"


def c_point(name, point, sizes, arrays):
    return c_row(name, point, POINT, sizes, arrays)


def c_constraint(_, constraint, __, ___):
    values = [constraint[key] for key in CONSTRAINT]
    text = ", ".join(braces(map(str, map(int, value))) if key == "axes" else
                     braces(value) if isinstance(value, list) else value for key, value in zip(CONSTRAINT, values))
    return "    {" + "\n     ".join(wrapped(text, WIDTH - 5)) + "},\n"


def c_constraint_set(name, entry, sizes, arrays):
    counts = {"count": str(len(entry["constraints"])), "rows": str(len(entry["e"]))}
    return c_row(name, {**entry, **counts}, CONSTRAINT_SET, sizes, arrays)


OBJECT_ROWS = {"points": c_point, "constraint_sets": c_constraint_set, "constraints": c_constraint}


def control_state(state, nv):
    """The state as CONTROL lists it: objects that there is one of become keys."""
    state = dict(state)
    for owner in "hybrid", "integrate", "difference":
        state.update({f"{owner}_{key}": value for key, value in state.pop(owner).items()})
    given = set(map(int, state["hybrid_given"]))
    state["hybrid_given"] = [str(int(i in given)) for i in range(nv)]
    for key in "points", "constraint_sets":
        state["n" + key] = str(len(state[key]))
    return state


def is_control(model):
    return model["name"].startswith("control_")


def c_states(prefix, model):
    """The arrays of every state, then the table of states that points to them."""
    arrays, rows = Arrays(), []
    for i, state in enumerate(model["states"]):
        state["f_ext"] = dense_wrenches(state, int(model["nb"]))
        if is_control(model):
            rows.append(c_row(f"{prefix}_{i}", control_state(state, int(model["nv"])), CONTROL, model, arrays))
        else:
            rows.append(c_row(f"{prefix}_{i}", state, STATE, model, arrays))
    kind = "ref_control_state" if is_control(model) else "ref_state"
    return "".join(arrays.text) + c_rows(f"{kind} {prefix}_states", rows)


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
    states = f'{len(model["states"])}, {prefix}_states'
    tail = f"""\
static const ref_model {prefix}{"_model" if is_control(model) else ""} = {{
    "{name}",
    "{model["about"]}",
    {nb}, {model["nq"]}, {model["nv"]}, {prefix}_bodies, {prefix}_pi,
    {", ".join(counts)},
    {"0, NULL" if is_control(model) else states}}};
"""
    if is_control(model):
        tail += f"static const ref_control {prefix} = {{&{prefix}_model, {states}}};\n"
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
    for kind, listed in ("reference", False), ("control", True):
        names = [path.stem for path in paths if path.stem.startswith("control_") == listed]
        (HERE / f"{kind}_models.h").write_text(index(kind, names), encoding="utf-8")


if __name__ == "__main__":
    main()
