# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""rbd-identify: friction, base parameters and a physical model of a robot, from logged trajectories.

    rbd-identify robot.urdf log.csv --validate other.csv --out found

docs/identification.md has the why and the how."""
from __future__ import annotations

import argparse
import csv
import difflib
import math
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from . import Model, load_urdf
from ._descriptions import Body
from ._identify import (FRICTION, Identified, IdentifyError, Log, identify, predict, smooth, steady, together, told)

__all__ = ["IdentifyError", "Identified", "Log", "identify", "main", "predict", "read_log"]
KINDS = ("q", "v", "tau", "current")


# ---- logs ----

def read_columns(path):
    """The columns of a CSV file by name, as numbers."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row]
    except OSError as error:
        raise IdentifyError(f"{path}: {error.strerror}") from None
    if len(rows) < 2:
        raise IdentifyError(f"{path}: no samples: a header and a row for each sample are needed")
    header = [name.strip() for name in rows[0]]
    values = np.empty((len(rows) - 1, len(header)))
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            raise IdentifyError(f"{path}, row {number}: {len(row)} values, but the header has {len(header)} columns")
        for name, word, at in zip(header, row, range(len(header))):
            try:
                values[number - 2, at] = float(word)
            except ValueError:
                raise IdentifyError(f"{path}, row {number}, column '{name}': '{word}' is no number") from None
            if not math.isfinite(values[number - 2, at]):
                raise IdentifyError(f"{path}, row {number}, column '{name}': {word} is not finite")
    twice = [name for name in header if header.count(name) > 1]
    if twice:
        raise IdentifyError(f"{path}: column '{twice[0]}' stands twice")
    return dict(zip(header, values.T))


def check_names(path, columns, joints):
    """All columns are time, or a kind and a joint; each joint has a position and a torque or current."""
    known = ["time"] + [f"{kind}:{joint}" for kind in KINDS for joint in joints]
    for name in columns:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            hint = f": did you mean '{near[0]}'?" if near else \
                "; columns are time, and q:, v:, tau: or current: with the name of a joint"
            raise IdentifyError(f"{path}: unknown column '{name}'{hint}")
    for joint in joints:
        if f"q:{joint}" not in columns:
            raise IdentifyError(f"{path}: joint '{joint}' has no column 'q:{joint}'")
        if (f"tau:{joint}" in columns) == (f"current:{joint}" in columns):
            raise IdentifyError(f"{path}: joint '{joint}' needs either a column 'tau:{joint}' or 'current:{joint}'")


def sample_time(path, columns, dt):
    """Of a column `time`, whose steps must be equal, or as given."""
    if dt is not None:
        return dt
    if "time" not in columns:
        raise IdentifyError(f"{path}: no column 'time': give --dt, the sample time in seconds")
    steps = np.diff(columns["time"])
    middle = float(np.median(steps))
    if not middle > 0:
        raise IdentifyError(f"{path}: column 'time' does not grow")
    odd = np.flatnonzero(np.abs(steps - middle) > 0.3 * middle)
    if len(odd):
        raise IdentifyError(f"{path}, row {odd[0] + 3}: a step of {steps[odd[0]]:.4g} s; the others have {middle:.4g} s. "
                            "Fill gaps before, or cut the log there")
    return middle


def read_log(path, model, dt=None, window=0.1, constants=None):
    """A Log from a CSV file. window: s, of the filter; constants: N m/A of joints with currents, by name."""
    joints, columns, constants = list(model.dof_names), read_columns(path), constants or {}
    check_names(path, columns, joints)
    dt = sample_time(path, columns, dt)
    torques = []
    for joint in joints:
        if f"current:{joint}" in columns and joint not in constants:
            raise IdentifyError(f"{path}: joint '{joint}' has currents: give --constant '{joint}=N m/A'")
        torques.append(columns[f"tau:{joint}"] if f"tau:{joint}" in columns
                       else columns[f"current:{joint}"] * constants[joint])
    samples = max(5, 2 * round(window / dt / 2) + 1)
    if len(torques[0]) < 4 * samples:
        raise IdentifyError(f"{path}: {len(torques[0])} samples are too few for a window of {samples}")
    q, v, a = smooth(np.stack([columns[f"q:{joint}"] for joint in joints], axis=1), dt, samples)
    tau = smooth(np.stack(torques, axis=1), dt, samples)[0]
    if all(f"v:{joint}" in columns for joint in joints):
        v, a, _ = smooth(np.stack([columns[f"v:{joint}"] for joint in joints], axis=1), dt, samples)
    return Log(q, v, a, tau, steady(v, samples), together(samples))


# ---- what was found ----

def write_table(path, header, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])


def write_tables(out, found):
    deviations = found.friction_deviation
    write_table(out / "friction.csv", ["joint", *FRICTION, *(f"{name} deviation" for name in FRICTION), "noise"],
                [[joint, *(f"{x:.6g}" for x in (*found.friction[i], *deviations[i], found.noise[i]))]
                 for i, joint in enumerate(found.joints)])
    write_table(out / "base_parameters.csv", ["parameter", "described", "found", "low", "high"],
                [[name, *(f"{x:.6g}" for x in (before, x, x - 1.96 * s, x + 1.96 * s))] for name, before, x, s in
                 zip(found.base_names, found.base_before, found.base, found.base_deviation)])


def bodies_of(urdf, found, library):
    """The description with what was found."""
    bodies = []
    for body, pi in zip(urdf.bodies, found.parameters):
        body = library.set_parameters(body, pi)
        if body.joint in found.joints:
            coulomb, viscous, _ = found.friction[found.joints.index(body.joint)]
            body = Body(**{**vars(body), "friction": coulomb, "damping": viscous})
        bodies.append(body)
    return bodies


def numbers(values):
    return " ".join(f"{x:.9g}" for x in values)


def write_urdf(source, target, urdf, bodies):
    """The file with the masses, inertias, damping and friction of the bodies. A link that is merged into another has no
    inertia any more: that of the other includes it."""
    tree = ET.parse(source, ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    by_name = {body.name: body for body in bodies}
    merged = {frame.link for frame in urdf.frames if frame.body >= 0 and frame.link not in by_name}
    for link in tree.iter("link"):
        body = by_name.get(link.get("name"))
        for old in link.findall("inertial") if body or link.get("name") in merged else []:
            link.remove(old)
        if body is None or body.mass <= 0:
            continue
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", xyz=numbers(body.com), rpy="0 0 0")
        ET.SubElement(inertial, "mass", value=numbers([body.mass]))
        ET.SubElement(inertial, "inertia", dict(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
                                                    (f"{x:.9g}" for x in body.inertia))))
    by_joint = {body.joint: body for body in bodies if body.joint and body.type != "fixed"}
    for joint in tree.iter("joint"):
        body = by_joint.get(joint.get("name"))
        if body is None or joint.get("type") is None:
            continue
        dynamics = joint.find("dynamics")
        dynamics = ET.SubElement(joint, "dynamics") if dynamics is None else dynamics
        dynamics.set("damping", numbers(np.atleast_1d(body.damping)[:1]))
        dynamics.set("friction", numbers(np.atleast_1d(body.friction)[:1]))
    tree.write(target, encoding="utf-8", xml_declaration=True)


def write_picture(path, joints, measured, before, after):
    """Residuals of each joint over the samples, as SVG: grey before, red after."""
    width, height, left = 900, 90, 160
    step = max(1, len(measured) // width)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width + left}" height="{height * len(joints) + 30}" '
             'font-family="sans-serif" font-size="12">',
             f'<text x="{left}" y="18">what is left of the torques: described (grey) and identified (red)</text>']
    for i, joint in enumerate(joints):
        size = max(np.abs(measured[:, i] - before[:, i]).max(), np.abs(measured[:, i] - after[:, i]).max(), 1e-9)
        middle = 30 + height * (i + 0.5)
        lines.append(f'<text x="4" y="{middle:.0f}">{joint}</text><text x="4" y="{middle + 15:.0f}" '
                     f'fill="#666">+- {size:.3g}</text>')
        for torques, colour in ((before, "#aaa"), (after, "#c00")):
            rest = (measured[::step, i] - torques[::step, i]) / size * height * 0.45
            points = " ".join(f"{left + k:.0f},{middle - y:.1f}" for k, y in enumerate(rest[:width]))
            lines.append(f'<polyline fill="none" stroke="{colour}" points="{points}"/>')
    Path(path).write_text("\n".join([*lines, "</svg>", ""]), encoding="utf-8")


def rms(x, rows):
    """Of each column, over the rows that count."""
    return np.sqrt((x ** 2 * rows).sum(axis=0) / np.maximum(rows.sum(axis=0), 1))


def report(model, urdf, found, judge, name, slow, show):
    """Prints what was found and how well it predicts a log. Returns torques as described and as found."""
    described = np.array([model.body_parameters(k) for k in range(model.nb)])
    friction = np.zeros((model.nv, 3))
    for body in urdf.bodies:
        if body.joint in found.joints:
            friction[found.joints.index(body.joint), :2] = (np.atleast_1d(body.friction)[0],
                                                            np.atleast_1d(body.damping)[0])
    before = predict(model, described, friction, judge)
    after = predict(model, found.parameters, found.friction, judge)
    rows = told(judge, slow)
    left = [rms(judge.tau - torques, rows) for torques in (before, after, 0)]
    show(f"{'joint':24}  Coulomb  viscous   offset | left of the torques of {name}: described, identified")
    for i, joint in enumerate(found.joints):
        words = "".join(f"{x:9.4f}" for x in found.friction[i])
        show(f"{joint:24}{words} | {left[0][i]:9.4f} {left[1][i]:9.4f} of {left[2][i]:.4g}")
    sure = np.abs(found.base) > 2 * found.base_deviation
    show(f"{len(found.base)} base parameters; {int(sure.sum())} of them differ from 0 by more than two deviations")
    if found.unknown:
        show("not enough excitation: this log does not tell " + "; ".join(found.unknown))
    return before, after


def constants_of(words):
    out = {}
    for word in words:
        joint, equals, value = word.rpartition("=")
        try:
            out[joint] = float(value)
        except ValueError:
            equals = ""
        if not equals:
            raise IdentifyError(f"--constant '{word}': write JOINT=NUMBER, in N m/A")
    return out


def parse(arguments):
    parser = argparse.ArgumentParser(prog="rbd-identify", description=__doc__.split("\n")[0])
    parser.add_argument("urdf", help="the robot, as it is described")
    parser.add_argument("log", help="CSV: time, and of each joint q:NAME, tau:NAME or current:NAME, perhaps v:NAME")
    parser.add_argument("--validate", metavar="CSV", help="another log that judges; default: the last fifth of the log")
    parser.add_argument("--dt", type=float, help="s, sample time, of logs without a column time")
    parser.add_argument("--window", type=float, default=0.1, help="s, of the filter; a third of the quickest period")
    parser.add_argument("--slow", type=float, default=0.02, help="rad/s; a slower joint tells nothing")
    parser.add_argument("--constant", action="append", default=[], metavar="JOINT=NM/A", help="of a joint with currents")
    parser.add_argument("--out", default="identified", help="folder for what was found")
    return parser.parse_args(arguments)


def part(log, rows):
    return Log(log.q[rows], log.v[rows], log.a[rows], log.tau[rows], log.steady[rows],
               log.together)


def run(options, show=print):
    urdf = load_urdf(options.urdf)
    model = Model(urdf)
    if model.nq != model.nv or len(model.dof_names) != len(set(model.dof_names)) or any("[" in x for x in model.dof_names):
        raise IdentifyError(f"{options.urdf}: only robots on a fixed base, whose joints have one degree of freedom")
    reading = {"dt": options.dt, "window": options.window, "constants": constants_of(options.constant)}
    log = read_log(options.log, model, **reading)
    if options.validate:
        judge, name = read_log(options.validate, model, **reading), options.validate
    else:
        cut = len(log.q) * 4 // 5
        judge, name = part(log, slice(cut, None)), "the last fifth"
        log = part(log, slice(cut))
    found = identify(model, log, options.slow)

    out = Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    bodies = bodies_of(urdf, found, model.library)
    write_tables(out, found)
    write_urdf(options.urdf, out / "identified.urdf", urdf, bodies)
    (out / "identified.h").write_text(Model(bodies, gravity=urdf.gravity).c_table("identified", options.urdf), encoding="utf-8")
    before, after = report(model, urdf, found, judge, name, options.slow, show)
    write_picture(out / "residuals.svg", found.joints, judge.tau, before, after)
    show(f"written to {out}: identified.urdf, identified.h, friction.csv, base_parameters.csv, residuals.svg")
    return found


def main(arguments=None):
    """The command: exit status 1 and a sentence if it cannot."""
    try:
        run(parse(arguments))
    except (IdentifyError, OSError, ET.ParseError, ValueError) as error:
        print(f"rbd-identify: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
