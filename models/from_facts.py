#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the robots' URDF files and C descriptions from facts/*.csv, next to itself.

Takes no argument. Numbers keep the text they have in the facts; the same facts give the same bytes.
"""
import csv
import math
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
WIDTH = 110

# robot: (full name, what its root is, where its figures come from)
ROBOTS = {
    "iiwa": ("KUKA LBR iiwa 14", "fixed to the world",
             "the Bullet physics data set's kuka_iiwa/model.urdf"),
    "hyq": ("HyQ", "on a floating joint",
            "Istituto Italiano di Tecnologia, DLS lab, hyq-description (no sensors)"),
    "atlas": ("Boston Dynamics Atlas", "on a floating joint",
              "the OSRF model for the DARPA Robotics Challenge, as kept by Drake (atlas_convex_hull.urdf)"),
}

# Joint types by their names in the facts: (type in C, length of q, length of v).
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
INERTIA = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
LIMITS = ["lower", "upper", "velocity", "effort"]
ROW_LAYOUT = """\
/* A row: {link, joint, parent, type,
           axis, axis2, pitch,
           position,
           rotation,
           mass, com,
           inertia,
           armature, damping, friction,
           lower, upper, velocity, effort,
           mimic, mimic_ratio, mimic_offset}, as rbd_body says. */
"""


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
    """The initialiser of one rbd_body, laid out as ROW_LAYOUT says.
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


def read_facts(path):
    """The links of a table, in the words of the reference data. The root link has no joint there."""
    with open(path, newline="", encoding="utf-8") as file:
        return [facts_of(row) for row in csv.DictReader(file)]


def facts_of(row):
    body = {"name": row["link"], "parent_name": row["parent"], "is_root": not row["joint"],
            "joint": row["joint"] or "root", "type": row["type"] or "floating", "mass": row["mass"]}
    columns = {"axis": ["axis_x", "axis_y", "axis_z"], "xyz": ["x", "y", "z"],
               "rpy": ["roll", "pitch", "yaw"], "com": ["com_x", "com_y", "com_z"], "inertia": INERTIA}
    body.update({key: [row[name] or "0" for name in names] for key, names in columns.items()})
    body.update({key: row[key] or "0" for key in LIMITS})
    return body


def c_table(robot, bodies):
    """The description as a header."""
    name, root, source = ROBOTS[robot]
    bodies = [body for body in bodies if body["mass"]]  # the link "world" is the world itself
    index = {body["name"]: i for i, body in enumerate(bodies)}
    rows = []
    for i, body in enumerate(bodies):
        parent = index.get(body["parent_name"], -1)
        note = f'body {i}, parent {body["parent_name"] or "world"}'
        rows.append(c_body(dict(body, parent=parent), note))
    nq, nv = (sum(JOINT_TYPES[body["type"]][k] for body in bodies) for k in (1, 2))
    upper = robot.upper()
    return f"""\
/* {robot}.h - {name}, {root}: the description that rbd_model_build takes.
   Include rbd.h before. SPDX-License-Identifier: MIT.
   Written by from_facts.py from facts/{robot}.csv: change those instead. Figures from
   {source}. */
#ifndef {upper}_H
#define {upper}_H

#define {upper}_NB {len(bodies)} /* bodies */
#define {upper}_NQ {nq} /* length of q */
#define {upper}_NV {nv} /* degrees of freedom */

/* clang-format off */
{ROW_LAYOUT}static const rbd_body {robot}_bodies[{upper}_NB] = {{
{"".join(rows)}}};
/* clang-format on */

#endif
"""


def urdf(robot, bodies):
    """The description as URDF. A floating joint is left to the program that loads it."""
    name, root, source = ROBOTS[robot]
    parts = [f"""\
<?xml version="1.0"?>
<!-- {name}, {root}. No meshes.
     Written by from_facts.py from facts/{robot}.csv: change those instead. Figures from
     {source}. -->
<robot name="{robot}">
"""]
    for body in bodies:
        parts.append(urdf_link(body) + urdf_joint(body))
    return "\n".join(parts) + "\n</robot>\n"


def urdf_link(body):
    if not body["mass"]:
        return f'  <link name="{body["name"]}"/>\n'
    inertia = [f'{key}="{value}"' for key, value in zip(INERTIA, body["inertia"])]
    return f"""\
  <link name="{body["name"]}">
    <inertial>
      <origin xyz="{" ".join(body["com"])}" rpy="0 0 0"/>
      <mass value="{body["mass"]}"/>
      <inertia {" ".join(inertia[:3])}
               {" ".join(inertia[3:])}/>
    </inertial>
  </link>
"""


def urdf_joint(body):
    if body["is_root"]:
        return ""
    limits = " ".join(f'{key}="{body[key]}"' for key in LIMITS)
    return f"""\
  <joint name="{body["joint"]}" type="{body["type"]}">
    <parent link="{body["parent_name"]}"/>
    <child link="{body["name"]}"/>
    <origin xyz="{" ".join(body["xyz"])}" rpy="{" ".join(body["rpy"])}"/>
    <axis xyz="{" ".join(body["axis"])}"/>
    <limit {limits}/>
  </joint>
"""


def main():
    for robot in ROBOTS:
        bodies = read_facts(HERE / "facts" / f"{robot}.csv")
        (HERE / f"{robot}.h").write_text(c_table(robot, bodies), encoding="utf-8")
        (HERE / f"{robot}.urdf").write_text(urdf(robot, bodies), encoding="utf-8")


if __name__ == "__main__":
    main()
