# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Logs of rbd-identify: CSV files, and slips that would give wrong numbers without a word."""
from __future__ import annotations

import csv
import difflib
import math
from dataclasses import dataclass, replace

import numpy as np

from ._arguments import _Declared
from ._headers import JointType
from ._identify import IdentifyError, Log, described_parameters, predict, scale_of, smooth, steady, together, told

KINDS = ("q", "v", "tau", "current")


@dataclass
class Reading(_Declared):
    """How a file is read."""
    dt: float | None = None         #: s, of files without a column `time`
    window: float = 0.1             #: s, of the filter
    slow: float = 0.02              #: rad/s: a slower joint tells nothing
    constants: dict | None = None   #: by joint: N m/A of currents, or a factor of torques
    without: dict | None = None     #: joints whose torque is not known: where they stood, None as logged


# ---- the file ----

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
            raise IdentifyError(f"{path}, row {lines[0]}: columns are parted by {mark!r}: part them by commas, and write "
                                "numbers with a point")
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


def others(names, what="the same of"):
    """What is said of the first is said of these too."""
    return f"; {what} {', '.join(map(repr, names[1:]))}" if names[1:] else ""


def check_names(path, columns, joints, without):
    """All columns are time, or a kind and a joint; each joint has a position and a torque or current, but those that the
    log is without."""
    known = ["time"] + [f"{kind}:{joint}" for kind in KINDS for joint in joints]
    for name in columns:
        if name in known:
            continue
        kind, _, joint = name.partition(":")
        near = difflib.get_close_matches(kind, KINDS, 1) if joint in joints else []
        hint = f": did you mean '{near[0]}:{joint}'?" if near else "" if joint in joints else name_hint(name, known)
        hint = hint or "; columns are time, and q:, v:, tau: or current: with the name of a joint"
        raise IdentifyError(f"{path}: unknown column '{name}'{hint}")

    lacking = [joint for joint in joints if f"q:{joint}" not in columns and without.get(joint) is None]
    if lacking:
        raise IdentifyError(f"{path}: joint '{lacking[0]}' has no column 'q:{lacking[0]}'{others(lacking)}. If it stood still, say "
                            f"where: --without '{lacking[0]}=POSITION'")
    for joint in joints:
        if joint not in without and (f"tau:{joint}" in columns) == (f"current:{joint}" in columns):
            raise IdentifyError(f"{path}: joint '{joint}' needs either a column 'tau:{joint}' or 'current:{joint}'")


def check_joints(option, names, joints):
    for name in names:
        if name not in joints:
            raise IdentifyError(f"{option} '{name}': the robot has no joint of this name{name_hint(name, joints)}")


# ---- time ----

def pieces_of(path, columns, lines, dt):
    """The sample time, and the pieces between gaps: by a column `time`, or as given."""
    if dt is not None:
        logged = float(np.median(np.diff(columns["time"]))) if "time" in columns else dt
        if not abs(logged - dt) <= dt / 5:
            raise IdentifyError(f"{path}: --dt is {dt:g} s, but column 'time' has steps of {logged:g} s: leave out one of them")
        return dt, [slice(0, len(lines))]
    if "time" not in columns:
        raise IdentifyError(f"{path}: no column 'time': give --dt, the sample time in seconds")
    steps = np.diff(columns["time"])
    middle = float(np.median(steps))
    if not middle > 0:
        raise IdentifyError(f"{path}: column 'time' does not grow")
    if middle >= 1:
        raise IdentifyError(f"{path}: column 'time' grows by {middle:.4g} a row: is it in milliseconds? It must be in seconds")

    gaps = steps > 1.5 * middle
    odd = np.flatnonzero((np.abs(steps - middle) > 0.3 * middle) & ~gaps)
    if len(odd):
        raise IdentifyError(f"{path}, row {lines[odd[0] + 1]}: a step of {steps[odd[0]]:.4g} s; the others have {middle:.4g} s. "
                            "Resample the log; or give --dt if the samples are even, and only their times are not")
    ends = [0, *(np.flatnonzero(gaps) + 1), len(lines)]
    return middle, [slice(begin, end) for begin, end in zip(ends, ends[1:])]


def long_pieces(path, columns, lines, pieces, dt, samples):
    """The pieces that are long enough for the filter; and a sentence about gaps."""
    kept = [piece for piece in pieces if piece.stop - piece.start >= 2 * samples] if len(pieces) > 1 else pieces
    count = sum(piece.stop - piece.start for piece in kept)
    notes = []
    if len(pieces) > 1:
        at = pieces[1].start
        notes = [f"{path}, row {lines[at]}: a step of {columns['time'][at] - columns['time'][at - 1]:.4g} s; the others have "
                 f"{dt:.4g} s. {len(pieces) - 1} gaps: {count} of {len(lines)} samples stand in pieces that are long enough"]
    if count < 4 * samples:
        raise IdentifyError(f"{path}: {count} samples are too few for a window of {samples}: four windows are the least" +
                            "".join(f". {note}" for note in notes))
    return kept, notes


# ---- units and signs ----

def check_range(path, model, columns):
    """Positions far beyond a joint's limits are of another unit, or of another zero."""
    for name in model.dof_names:
        info = model.joint(name)
        bound = max(abs(info.lower), abs(info.upper))
        reach = np.abs(columns.get(f"q:{name}", np.zeros(1))).max()
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


def check_effort(path, name, torque, limit):
    """A torque far beyond the joint's, for most of the log, is of another unit; limit 0: not known."""
    middle = np.median(np.abs(torque))
    if 0 < limit < 0.5 * middle:
        raise IdentifyError(f"{path}: the torque of joint '{name}' is {middle:.4g} N m and more in half of the log, but the joint's "
                            f"limit is {limit:.4g}: is the current in mA, or --constant of another unit?")


def torques_of(path, columns, model, reading):
    """Of all joints, from torques or from currents, times their constants; 0 where they are not known."""
    constants, without = reading.constants or {}, reading.without or {}
    measured = [joint for joint in model.dof_names if joint not in without]
    lacking = [joint for joint in measured if f"current:{joint}" in columns and joint not in constants]
    if lacking:
        raise IdentifyError(f"{path}: joint '{lacking[0]}' has currents: give --constant '{lacking[0]}=N m/A'{others(lacking)}")
    torques = np.zeros((len(next(iter(columns.values()))), model.nv))
    for i, joint in enumerate(model.dof_names):
        if joint in measured:
            torques[:, i] = columns.get(f"tau:{joint}", columns.get(f"current:{joint}")) * constants.get(joint, 1)
            check_effort(path, joint, torques[:, i], model.joint(joint).effort)
    return torques


def cut_off(torque):
    """Samples at the largest or the least torque, where more stand there than by chance: the log or the drive ends there."""
    flags = np.zeros(len(torque), bool)
    for extreme in (torque.max(), torque.min()):
        there = torque == extreme
        if extreme and there.sum() >= max(10, 0.005 * len(torque)):
            flags |= there
    return flags


def check_signs(path, model, log, slow):
    """Refuses torques that the description and friction explain with the other sign alone: motor or encoder count the other
    way. Returns sentences about torques of another size."""
    described = predict(model, described_parameters(model), np.zeros((model.nv, 3)), log)
    rows, turned, notes = told(log, slow), [], []
    for i in np.flatnonzero(rows.sum(axis=0) >= 20):
        samples = rows[:, i]
        own, v, torque, name = described[samples, i], log.v[samples, i], log.tau[samples, i], model.dof_names[i]
        factor, _, left = scale_of(own, v, torque)
        _, friction, left_turned = scale_of(own, v, -torque)
        if left_turned < 0.5 * left and friction > 0:
            turned.append(name)
        elif left < 0.5 * np.std(torque) < np.std(factor * own) and not 0.25 < factor < 4:
            notes.append(f"{path}: the torques of joint '{name}' are {factor:.3g} times what the description asks for: is their "
                         "unit right, or --constant?")
    if turned:
        raise IdentifyError(f"{path}: the torque of joint '{turned[0]}' fits friction and the description with the other sign "
                            f"alone{others(turned)}. Motor or encoder count the other way, or the columns of two joints are changed: turn "
                            "column q: (and v:), or give --constant with the other sign, JOINT=-1 of torques")
    return notes


# ---- the log ----

def filtered(path, columns, piece, positions, torques, cut, model, dt, samples):
    """One piece: positions, velocities, accelerations, torques, and where they tell something."""
    q, v, a = smooth(positions[piece], dt, samples)
    for i, joint in enumerate(model.dof_names):
        check_rate(path, joint, v[:, i], model.joint(joint).velocity)
        if f"v:{joint}" not in columns:
            continue
        measured, slope, _ = smooth(columns[f"v:{joint}"][piece][:, None], dt, samples)
        check_speed(path, joint, measured[:, 0], v[:, i])
        v[:, i], a[:, i] = measured[:, 0], slope[:, 0]
    near_cut = np.lib.stride_tricks.sliding_window_view(cut[piece], len(cut[piece]) - len(q) + 1, axis=0).any(axis=2)
    return q, v, a, smooth(torques[piece], dt, samples)[0], steady(v, samples) & ~near_cut


def read_log(path, model, reading=None, show=print):
    """A Log from a CSV file. show: for sentences about what is odd in it."""
    reading, joints = reading or Reading(), list(model.dof_names)
    without, (columns, lines) = reading.without or {}, read_columns(path)
    check_joints("--constant", reading.constants or {}, joints)
    check_joints("--without", without, joints)
    check_names(path, columns, joints, without)
    check_range(path, model, columns)
    dt, pieces = pieces_of(path, columns, lines, reading.dt)
    samples = max(5, 2 * round(reading.window / dt / 2) + 1)
    pieces, notes = long_pieces(path, columns, lines, pieces, dt, samples)

    torques = torques_of(path, columns, model, reading)
    positions = np.stack([columns[f"q:{joint}"] if without.get(joint) is None else np.full(len(lines), without[joint])
                          for joint in joints], axis=1)
    cut = np.stack([cut_off(column) for column in torques.T], axis=1)
    notes += [f"{path}: the torque of joint '{joints[i]}' stands at its largest or least value, {torques[cut[:, i], i][0]:.4g}, in "
              f"{cut[:, i].sum()} samples: is it cut off? They do not count" for i in np.flatnonzero(cut.any(axis=0))]

    parts = [filtered(path, columns, piece, positions, torques, cut, model, dt, samples) for piece in pieces]
    log = Log(*(np.concatenate(arrays) for arrays in zip(*parts)), together=together(samples), without=list(without))
    log.steady[:, [joints.index(joint) for joint in without]] = False
    log = thinned(log)
    for note in notes + check_signs(path, model, log, reading.slow):
        show(note)
    return log


def part(log, rows):
    """These samples of a log."""
    return replace(log, q=log.q[rows], v=log.v[rows], a=log.a[rows], tau=log.tau[rows], steady=log.steady[rows])


def thinned(log):
    """One of several samples that the filter has made alike, three to each independent one."""
    every = max(1, int(log.together / 3))
    return replace(part(log, slice(None, None, every)), together=max(1.0, log.together / every))
