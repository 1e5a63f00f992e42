# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""rbd-identify: friction, base parameters and a physical model of a robot, from logged trajectories.

    rbd-identify robot.urdf log.csv --validate other.csv --out found

docs/identification.md has the why and the how."""
from __future__ import annotations

import argparse
import csv
import math
import sys
import xml.etree.ElementTree as ET
from html import escape
from pathlib import Path

import numpy as np

from . import Model, RbdError, load_urdf
from ._descriptions import Body
from ._identify import FRICTION, Identified, IdentifyError, Log, described_friction, described_parameters, identify, predict, told
from ._identify_log import Reading, part, read_log

__all__ = ["IdentifyError", "Identified", "Log", "Reading", "identify", "main", "predict", "read_log"]


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
        lines.append(f'<text x="4" y="{middle:.0f}">{escape(joint)}</text><text x="4" y="{middle + 15:.0f}" '
                     f'fill="#666">+- {size:.3g}</text>')
        for torques, colour in ((before, "#aaa"), (after, "#c00")):
            rest = (measured[::step, i] - torques[::step, i]) / size * height * 0.45
            points = " ".join(f"{left + k:.0f},{middle - y:.1f}" for k, y in enumerate(rest[:width]))
            lines.append(f'<polyline fill="none" stroke="{colour}" points="{points}"/>')
    Path(path).write_text("\n".join([*lines, "</svg>", ""]), encoding="utf-8")


MUCH = 0.3     # of a torque, if it is left of it


def rms(x, rows):
    """Of each column, over the rows that count."""
    return np.sqrt((x ** 2 * rows).sum(axis=0) / np.maximum(rows.sum(axis=0), 1))


def report(model, found, judge, name, slow, show):
    """Prints what was found and how well it predicts a log. Returns torques as described and as found."""
    before = predict(model, described_parameters(model), described_friction(model), judge)
    after = predict(model, found.parameters, found.friction, judge)
    rows = told(judge, slow)
    left = [rms(judge.tau - torques, rows) for torques in (before, after, 0)]
    show(f"{'joint':24}  Coulomb  viscous   offset | left of the torques of {name}: described, identified")
    for i, joint in enumerate(found.joints):
        words = "".join(f"{x:9.4f}" for x in found.friction[i])
        show(f"{joint:24}{words} | " + ("not known" if joint in judge.without else "it does not move" if not rows[:, i].any() else
                                       f"{left[0][i]:9.4f} {left[1][i]:9.4f} of {left[2][i]:.4g}"))
    sure = np.abs(found.base) > 2 * found.base_deviation
    show(f"{len(found.base)} base parameters; {int(sure.sum())} of them differ from 0 by more than two deviations")
    if found.unknown:
        show("not enough excitation: this log does not tell " + "; ".join(found.unknown))
    for i in np.flatnonzero(left[1] > MUCH * left[2]):
        show(f"look at joint '{found.joints[i]}': {left[1][i] / left[2][i]:.0%} of its torque are left. The reason may be its column, "
             "a sign, a contact or friction of another kind: docs/identification.md, What can go wrong")
    return before, after


def pairs_of(option, words, unit, bare=False):
    """Numbers by joint, of words JOINT=NUMBER; bare: without a number None."""
    out = {}
    for word in words:
        joint, equals, value = word.rpartition("=")
        joint = joint if equals else word
        if joint in out:
            raise IdentifyError(f"{option} '{word}': joint '{joint}' stands twice")
        if bare and not equals:
            out[word] = None
            continue
        try:
            out[joint] = float(value)
        except ValueError:
            equals = ""
        if not equals or not math.isfinite(out[joint]) or out[joint] == 0 and not bare:
            raise IdentifyError(f"{option} '{word}': write JOINT=NUMBER, in {unit}")
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


class Once(argparse.Action):
    """Of an option that stands twice the first one would be lost."""

    def __call__(self, parser, namespace, values, option_string=None):
        given = namespace.__dict__.setdefault("_given", set())
        if self.dest in given:
            parser.error(f"argument {option_string}: it stands twice")
        given.add(self.dest)
        setattr(namespace, self.dest, values)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="rbd-identify", description=__doc__.split("\n")[0], allow_abbrev=False)
    parser.register("action", None, Once)
    parser.add_argument("urdf", help="the robot, as it is described")
    parser.add_argument("log", help="CSV: time, and of each joint q:NAME, tau:NAME or current:NAME, perhaps v:NAME")
    parser.add_argument("--validate", metavar="CSV", help="another log that judges; default: the last fifth of the log")
    parser.add_argument("--dt", type=above_zero, help="s, sample time, of logs without a column time")
    parser.add_argument("--window", type=above_zero, default=0.1, help="s, of the filter; a third of the quickest period")
    parser.add_argument("--slow", type=above_zero, default=0.02, help="rad/s; a slower joint tells nothing")
    parser.add_argument("--constant", action="append", default=[], metavar="JOINT=NM/A",
                        help="of a joint with currents; of one with torques a factor")
    parser.add_argument("--without", action="append", default=[], metavar="JOINT[=POSITION]",
                        help="a joint whose torque is not known; it stood at this position, rad or m, if it has no column q:")
    parser.add_argument("--out", default="identified", help="folder for what was found")
    return parser.parse_args(arguments)


def run(options, show=print):
    try:
        urdf = load_urdf(options.urdf)
    except RbdError as error:
        hint = "; rbd-identify takes URDF: rbd-model --urdf ROBOT.xml makes one" if "of MJCF" in str(error) else ""
        raise IdentifyError(f"{error}{hint}") from None
    model = Model(urdf)
    if model.nq != model.nv or len(model.dof_names) != len(set(model.dof_names)) or any("[" in x for x in model.dof_names):
        raise IdentifyError(f"{options.urdf}: only robots on a fixed base, whose joints have one degree of freedom")
    reading = Reading(options.dt, options.window, options.slow, pairs_of("--constant", options.constant, "N m/A"),
                      pairs_of("--without", options.without, "rad or m", bare=True))
    if set(reading.without) >= set(model.dof_names):
        raise IdentifyError("--without: no joint is left")
    log = read_log(options.log, model, reading, show)
    if options.validate:
        judge, name = read_log(options.validate, model, reading, show), options.validate
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
    before, after = report(model, found, judge, name, options.slow, show)
    known = [i for i, joint in enumerate(found.joints) if joint not in judge.without]
    write_picture(out / "residuals.svg", [found.joints[i] for i in known],
                  *(torques[:, known] for torques in (judge.tau, before, after)))
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
