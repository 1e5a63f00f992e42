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

from . import Model, RbdError, load_urdf
from ._descriptions import Body
from ._headers import JointType
from ._identify import (FRICTION, Identified, IdentifyError, Log, identify, predict, smooth, steady, together, told)

__all__ = ["IdentifyError", "Identified", "Log", "identify", "main", "predict", "read_log"]
KINDS = ("q", "v", "tau", "current")


# ---- logs ----

def read_rows(path):
    """The rows of a CSV file that have something in them, and the line of each."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            rows = [(row, reader.line_num) for row in reader if any(cell.strip() for cell in row)]
    except UnicodeDecodeError:
        raise IdentifyError(f"{path}: it is no text in UTF-8: save it as CSV in UTF-8") from None
    except csv.Error as error:
        raise IdentifyError(f"{path}: it is no CSV: {error}") from None
    if len(rows) < 2:
        raise IdentifyError(f"{path}: no samples: a header and a row for each sample are needed")
    return [row for row, _ in rows], [line for _, line in rows]


def read_columns(path):
    """The columns of a CSV file by name, as numbers; and the row of the file in which each sample stands."""
    rows, lines = read_rows(path)
    header = [name.strip() for name in rows[0]]
    for mark in ";\t" if len(header) == 1 else "":
        if mark in header[0]:
            raise IdentifyError(f"{path}, row {lines[0]}: columns are parted by {mark!r}: part them by commas, and write numbers with a "
                                "point")
    values = np.empty((len(rows) - 1, len(header)))
    for sample, (row, line) in enumerate(zip(rows[1:], lines[1:])):
        if len(row) != len(header):
            raise IdentifyError(f"{path}, row {line}: {len(row)} values, but the header has {len(header)} columns")
        for at, (name, word) in enumerate(zip(header, row)):
            try:
                values[sample, at] = float(word)
            except ValueError:
                raise IdentifyError(f"{path}, row {line}, column '{name}': '{word}' is no number") from None
            if not math.isfinite(values[sample, at]):
                raise IdentifyError(f"{path}, row {line}, column '{name}': {word} is not finite")
    twice = [name for name in header if header.count(name) > 1]
    if twice:
        raise IdentifyError(f"{path}: column '{twice[0]}' stands twice")
    return dict(zip(header, values.T)), lines[1:]


def name_hint(word, known):
    near = difflib.get_close_matches(word, known, 1)
    return f": did you mean '{near[0]}'?" if near else ""


def check_names(path, columns, joints):
    """All columns are time, or a kind and a joint; each joint has a position and a torque or current."""
    known = ["time"] + [f"{kind}:{joint}" for kind in KINDS for joint in joints]
    for name in columns:
        if name in known:
            continue
        kind, _, joint = name.partition(":")
        near = difflib.get_close_matches(kind, KINDS, 1) if joint in joints else []
        hint = f": did you mean '{near[0]}:{joint}'?" if near else "" if joint in joints else name_hint(name, known)
        hint = hint or "; columns are time, and q:, v:, tau: or current: with the name of a joint"
        raise IdentifyError(f"{path}: unknown column '{name}'{hint}")
    for joint in joints:
        if f"q:{joint}" not in columns:
            raise IdentifyError(f"{path}: joint '{joint}' has no column 'q:{joint}'")
        if (f"tau:{joint}" in columns) == (f"current:{joint}" in columns):
            raise IdentifyError(f"{path}: joint '{joint}' needs either a column 'tau:{joint}' or 'current:{joint}'")


def sample_time(path, columns, lines, dt):
    """Of a column `time`, whose steps must be equal, or as given."""
    if dt is not None:
        return dt
    if "time" not in columns:
        raise IdentifyError(f"{path}: no column 'time': give --dt, the sample time in seconds")
    steps = np.diff(columns["time"])
    middle = float(np.median(steps))
    if not middle > 0:
        raise IdentifyError(f"{path}: column 'time' does not grow")
    if middle >= 1:
        raise IdentifyError(f"{path}: column 'time' grows by {middle:.4g} a row: is it in milliseconds? It must be in seconds")
    odd = np.flatnonzero(np.abs(steps - middle) > 0.3 * middle)
    if len(odd):
        raise IdentifyError(f"{path}, row {lines[odd[0] + 1]}: a step of {steps[odd[0]]:.4g} s; the others have {middle:.4g} s. "
                            "Fill gaps before, or cut the log there")
    return middle


def check_range(path, model, columns):
    """Positions far beyond a joint's limits are of another unit, or of another zero."""
    for name in model.dof_names:
        info = model.joint(name)
        bound = max(abs(info.lower), abs(info.upper))
        reach = np.abs(columns[f"q:{name}"]).max()
        if not info.lower < info.upper or reach < 1.5 * bound + 0.1:
            continue
        unit, wrong = ("m", "mm") if info.type == JointType.PRISMATIC else ("rad", "degrees")
        raise IdentifyError(f"{path}: column 'q:{name}' reaches {reach:.4g}, but the joint's limits are {info.lower:.4g} and "
                            f"{info.upper:.4g} {unit}: is it in {wrong}?")


def check_rate(path, name, slope, limit):
    """A joint that moves far quicker than it can, for most of the log, is in another unit; limit 0: not known."""
    quick = np.median(np.abs(slope))
    if limit > 0 and quick > 2 * limit:
        raise IdentifyError(f"{path}: column 'q:{name}' changes by {quick:.4g} a second and more in half of the log, but the "
                            f"joint's limit is {limit:.4g}: is it in degrees or mm, or the time in another unit?")


def check_speed(path, name, v, slope):
    """A column of velocities is the slope of that of positions, but for noise."""
    factor = v @ slope / max(slope @ slope, 1e-300)
    if np.sqrt(np.mean(slope ** 2)) > 1e-3 and not 0.5 < factor < 2:
        raise IdentifyError(f"{path}: column 'v:{name}' is {factor:.4g} times the slope of column 'q:{name}': it must be in rad/s "
                            "(m/s of a slide)")


def torques_of(path, columns, joints, constants):
    """Of all joints, from torques or from currents."""
    for name in constants:
        if name not in joints:
            raise IdentifyError(f"--constant '{name}': the robot has no joint of this name{name_hint(name, joints)}")
    lacking = [joint for joint in joints if f"current:{joint}" in columns and joint not in constants]
    if lacking:
        others = f"; the same of {', '.join(map(repr, lacking[1:]))}" if lacking[1:] else ""
        raise IdentifyError(f"{path}: joint '{lacking[0]}' has currents: give --constant '{lacking[0]}=N m/A'{others}")
    return np.stack([columns[f"tau:{joint}"] if f"tau:{joint}" in columns else columns[f"current:{joint}"] * constants[joint]
                     for joint in joints], axis=1)


def read_log(path, model, dt=None, window=0.1, constants=None):
    """A Log from a CSV file. window: s, of the filter; constants: N m/A of joints with currents, by name."""
    joints, (columns, lines) = list(model.dof_names), read_columns(path)
    check_names(path, columns, joints)
    check_range(path, model, columns)
    dt = sample_time(path, columns, lines, dt)
    torques = torques_of(path, columns, joints, constants or {})
    samples = max(5, 2 * round(window / dt / 2) + 1)
    if len(torques) < 4 * samples:
        raise IdentifyError(f"{path}: {len(torques)} samples are too few for a window of {samples}: four windows are the least")

    q, v, a = smooth(np.stack([columns[f"q:{joint}"] for joint in joints], axis=1), dt, samples)
    for i, joint in enumerate(joints):
        check_rate(path, joint, v[:, i], model.joint(joint).velocity)
        if f"v:{joint}" not in columns:
            continue
        measured, slope, _ = smooth(columns[f"v:{joint}"][:, None], dt, samples)
        check_speed(path, joint, measured[:, 0], v[:, i])
        v[:, i], a[:, i] = measured[:, 0], slope[:, 0]
    return Log(q, v, a, smooth(torques, dt, samples)[0], steady(v, samples), together(samples))


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
        if not equals or not math.isfinite(out[joint]) or out[joint] == 0:
            raise IdentifyError(f"--constant '{word}': write JOINT=NUMBER, in N m/A")
    return out


def above_zero(text):
    """A number of the command line."""
    try:
        number = float(text)
    except ValueError:
        number = 0
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number above 0")
    return number


def parse(arguments):
    parser = argparse.ArgumentParser(prog="rbd-identify", description=__doc__.split("\n")[0])
    parser.add_argument("urdf", help="the robot, as it is described")
    parser.add_argument("log", help="CSV: time, and of each joint q:NAME, tau:NAME or current:NAME, perhaps v:NAME")
    parser.add_argument("--validate", metavar="CSV", help="another log that judges; default: the last fifth of the log")
    parser.add_argument("--dt", type=above_zero, help="s, sample time, of logs without a column time")
    parser.add_argument("--window", type=above_zero, default=0.1, help="s, of the filter; a third of the quickest period")
    parser.add_argument("--slow", type=above_zero, default=0.02, help="rad/s; a slower joint tells nothing")
    parser.add_argument("--constant", action="append", default=[], metavar="JOINT=NM/A", help="of a joint with currents")
    parser.add_argument("--out", default="identified", help="folder for what was found")
    return parser.parse_args(arguments)


def part(log, rows):
    return Log(log.q[rows], log.v[rows], log.a[rows], log.tau[rows], log.steady[rows],
               log.together)


def run(options, show=print):
    try:
        urdf = load_urdf(options.urdf)
    except RbdError as error:
        hint = "; rbd-identify takes URDF: rbd-model --urdf ROBOT.xml makes one" if "of MJCF" in str(error) else ""
        raise IdentifyError(f"{error}{hint}") from None
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
    try:
        found = identify(model, log, options.slow)
    except IdentifyError as error:
        raise IdentifyError(f"{options.log}: {error}") from None

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
        known = isinstance(error, OSError) and error.filename
        print(f"rbd-identify: {f'{error.filename}: {error.strerror}' if known else error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
