# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Identification of a robot from logged trajectories: the algebra. rbd-identify reads and writes files by _identifying."""
from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

from ._arguments import _Declared

PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
FRICTION = ("coulomb", "viscous", "offset")
SPREAD = 0.5    # how far bodies may be from the description, as a share


class IdentifyError(ValueError):
    """The log or the robot cannot be used: the message says where."""


@dataclass
class Log(_Declared):
    """Trajectories of all degrees of freedom: one row for each sample."""
    q: np.ndarray       #: rad or m
    v: np.ndarray       #: rad/s or m/s
    a: np.ndarray       #: rad/s^2 or m/s^2
    tau: np.ndarray     #: N m or N, of the motors
    steady: np.ndarray | None = None  #: flags: not where a joint turns back within the filter's window; None: all
    together: float = 1     #: how many samples have one noise: the filter spreads it
    without: list = field(default_factory=list)  #: names of joints whose torque is not known


@dataclass
class Identified(_Declared):
    """What a log tells of a robot."""
    joints: list            #: names
    friction: np.ndarray    #: joints x 3: coulomb, viscous, offset; of a joint whose torque is not known as described
    friction_deviation: np.ndarray  #: infinite of what the log does not tell, as base_deviation
    base_names: list        #: sums of parameters that torques can tell
    base: np.ndarray        #: their values
    base_deviation: np.ndarray  #: standard deviations
    base_before: np.ndarray     #: values of the description
    parameters: np.ndarray  #: bodies x 10: a model that is physical and explains the log
    noise: np.ndarray       #: standard deviation of what is left of each joint's torque
    unknown: list           #: names of base parameters that this log does not tell


def kernels(window):
    """Rows of the polynomials of degree 4 over 2 half + 1 samples, t from -1 to 1: value, slope, half the curvature."""
    half = max(2, window // 2)
    t = np.arange(-half, half + 1) / half
    return np.linalg.pinv(np.vander(t, 5, increasing=True)), half


def smooth(q, dt, window):
    """Positions, velocities and accelerations by polynomials of degree 4 over `window` samples around each, without
    lag (Savitzky and Golay 1964); the half window at both ends is dropped."""
    rows, half = kernels(window)
    length, q = half * dt, np.asarray(q, float)

    def filtered(row, factor):
        kernel = row[::-1] * factor
        return np.stack([np.convolve(column, kernel, "valid") for column in q.T], axis=1)

    return filtered(rows[0], 1), filtered(rows[1], 1 / length), filtered(rows[2], 2 / length ** 2)


def together(window):
    """How many samples have one noise after the filter: it keeps the slow part of white noise, and this share of all."""
    return 1 / np.sum(kernels(window)[0][0] ** 2)


def steady(v, window):
    """Where each joint moves one way in the whole window: elsewhere the filter has mixed both signs of friction."""
    half = max(2, window // 2)
    padded = np.pad(np.sign(v), ((half, half), (0, 0)), "edge")
    views = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1, axis=0)
    return np.abs(views.sum(axis=2)) == 2 * half + 1


def friction_rows(v, joints):
    """Rows of coulomb, viscous and offset of these joints: samples x dofs x 3 joints."""
    n, dofs = v.shape
    rows = np.zeros((n, dofs, len(joints), 3))
    for k, i in enumerate(joints):
        rows[:, i, k, 0] = np.sign(v[:, i])
        rows[:, i, k, 1] = v[:, i]
        rows[:, i, k, 2] = 1
    return rows.reshape(n, dofs, 3 * len(joints))


def described_parameters(model):
    return np.array([model.body_parameters(body) for body in range(model.nb)])


def described_friction(model):
    """Coulomb, viscous and offset of each joint."""
    friction, joints = np.zeros((model.nv, 3)), list(model.dof_names)
    for body in map(model.describe, range(model.nb)):
        if body.joint in joints:
            friction[joints.index(body.joint), :2] = np.atleast_1d(body.friction)[0], np.atleast_1d(body.damping)[0]
    return friction


def structure_of(model, seed=1):
    """Which columns of the regressor are independent, and how the others hang on them: base parameters are
    pi[independent] + combinations @ pi (Gautier 1991)."""
    random = np.random.default_rng(seed)
    states = 20 * model.nb + 100
    q = random.uniform(-3, 3, (states, model.nq))
    v, a = random.uniform(-3, 3, (2, states, model.nv))
    Y = model.regressor(q, v, a).reshape(-1, 10 * model.nb)
    size = np.linalg.norm(Y, axis=0)
    independent, basis = [], np.zeros((len(Y), 0))
    for k in range(Y.shape[1]):
        rest = Y[:, k] - basis @ (basis.T @ Y[:, k])
        rest -= basis @ (basis.T @ rest)
        if np.linalg.norm(rest) > 1e-8 * max(size[k], 1e-3 * size.max()):
            independent.append(k)
            basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
    combinations = np.linalg.lstsq(Y[:, independent], Y, rcond=None)[0]
    combinations[np.abs(combinations) < 1e-9] = 0
    return independent, combinations


def name_of(model, k):
    return f"{PARAMETERS[k % 10]}({model.body_name(k // 10)})"


def base_name(model, row, most=4):
    """A base parameter as a sum; of a long one the first terms."""
    terms = [(k, row[k]) for k in np.flatnonzero(row)]
    words = [name_of(model, k) if abs(x - 1) < 1e-9 else f"{x:+.4g} {name_of(model, k)}" for k, x in terms[:most]]
    return " ".join(words) + (" + ..." if len(terms) > most else "")


def told(log, slow):
    """Which samples of which joints tell something."""
    moves = np.abs(log.v) > slow
    return moves if log.steady is None else moves & log.steady


def known_torque(model, log):
    """The part of the torques that no parameter has: that of rotors."""
    Y = model.regressor(log.q, log.v, log.a)
    pi = described_parameters(model).reshape(-1)
    return model.rnea(log.q, log.v, log.a) - Y @ pi, Y, pi


def scale_of(described, v, torque):
    """Least squares of factor described + coulomb sign(v) + viscous v + offset = torque, where the first three are 0 or more:
    the factor, coulomb + viscous, and the standard deviation of what is left."""
    columns = np.stack([described, np.sign(v), v, np.ones_like(v)], axis=1)
    best = 0.0, 0.0, float(np.std(torque))
    for chosen in itertools.product((False, True), repeat=3):
        x, use = np.zeros(4), np.append(chosen, True)
        x[use] = np.linalg.lstsq(columns[:, use], torque, rcond=None)[0]
        left = float(np.std(torque - columns @ x))
        if (x[:3] >= 0).all() and left < best[2]:
            best = x[0], x[1] + x[2], left
    return best


def least_squares(A, b, weight):
    """x, and its covariance, of rows that are divided by their noise."""
    A, b = A * weight[:, None], b * weight
    scale = np.linalg.norm(A, axis=0)
    scale[scale <= 0] = 1
    inverse = np.linalg.pinv((A / scale).T @ (A / scale), rcond=1e-14)
    return inverse @ ((A / scale).T @ b) / scale, inverse / np.outer(scale, scale)


def identify(model, log, slow=0.02):
    """Friction, base parameters with their deviations, and a physical model. slow: rad/s; a joint that is slower
    tells nothing, because friction hides what holds it."""
    joints = [i for i, name in enumerate(model.dof_names) if name not in log.without]
    rotors, Y, before = known_torque(model, log)
    independent, combinations = structure_of(model)
    names = [base_name(model, row) for row in combinations]
    A = np.concatenate([Y[:, :, independent], friction_rows(log.v, joints)], axis=2)
    moves = told(log, slow)
    for i in joints:
        if moves[:, i].sum() < 20:
            name = model.dof_names[i]
            raise IdentifyError(f"joint '{name}' moves faster than {slow} rad/s in {moves[:, i].sum()} samples only: not enough to "
                                f"tell its friction. If it stood still: --without '{name}'")

    # the noise of each joint is what is left of it: a first pass takes one for all, then it settles
    rows, left = A[moves], (log.tau - rotors)[moves]
    joint = np.broadcast_to(np.arange(model.nv), moves.shape)[moves]
    noise = np.ones(model.nv)
    for _ in range(4):
        x, covariance = least_squares(rows, left, 1 / noise[joint])
        rest = left - rows @ x
        noise[joints] = [max(np.sqrt(np.mean(rest[joint == i] ** 2)), 1e-9) for i in joints]
    unknown = not_told(rows / noise[joint][:, None], names + friction_names(model, joints))
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0) * log.together)
    deviation[[name in unknown for name in names + friction_names(model, joints)]] = np.inf

    count, friction, friction_deviation = len(independent), described_friction(model), np.full((model.nv, 3), np.inf)
    friction_deviation[joints] = deviation[count:].reshape(-1, 3)
    friction[joints] = x[count:].reshape(-1, 3)
    parameters, friction[joints] = physical(model, before, Y, log, rotors, moves, noise, friction[joints], joints)
    noise[[i for i in range(model.nv) if i not in joints]] = np.inf
    return Identified(list(model.dof_names), friction, friction_deviation, names, x[:count], deviation[:count],
                      combinations @ before, parameters, noise, unknown)


def friction_names(model, joints):
    return [f"{what} of '{model.dof_names[i]}'" for i in joints for what in FRICTION]


def not_told(rows, words):
    """The unknowns that the log does not tell from each other, of these names."""
    scale = np.linalg.norm(rows, axis=0)
    silent = [words[k] for k in np.flatnonzero(scale <= 1e-9 * scale.max())]
    scale[scale <= 0] = 1
    sizes, directions = np.linalg.eigh((rows / scale).T @ (rows / scale))
    for size, direction in zip(sizes, directions.T):
        if size < 1e-10 * sizes[-1]:
            silent += [words[k] for k in np.flatnonzero(np.abs(direction) > 0.1 * np.abs(direction).max())]
    return list(dict.fromkeys(silent))


# ---- a physical model: pseudo-inertias that are positive definite (Wensing, Kim and Slotine 2018) ----

def pseudo_inertia(pi):
    Ixx, Ixy, Ixz, Iyy, Iyz, Izz = pi[4:]
    half = (Ixx + Iyy + Izz) / 2
    return np.array([[half - Ixx, -Ixy, -Ixz, pi[1]], [-Ixy, half - Iyy, -Iyz, pi[2]],
                     [-Ixz, -Iyz, half - Izz, pi[3]], [pi[1], pi[2], pi[3], pi[0]]])


UNITS = np.array([pseudo_inertia(unit) for unit in np.eye(10)])


def is_inside(pi):
    try:
        np.linalg.cholesky(pseudo_inertia(pi))
        return True
    except np.linalg.LinAlgError:
        return False


def is_possible(x, bodies, kept):
    return (x[kept] > 0).all() and all(is_inside(x[10 * k:10 * k + 10]) for k in range(bodies))


def barrier(pi):
    """-log det of the pseudo-inertia: gradient and second derivative."""
    W = np.linalg.inv(pseudo_inertia(pi)) @ UNITS
    return -np.trace(W, axis1=1, axis2=2), np.einsum("iab,jba->ij", W, W)


def physical(model, before, Y, log, rotors, moves, noise, friction, joints):
    """Parameters of all bodies and friction of these joints that exist: the least squares of the log, and of the distance from the
    description, inside the cone of pseudo-inertias. The distance is a share of each body, P0^-1 (P - P0), of which SPREAD
    counts as a standard deviation (Lee, Wensing and Park 2020). So what the log does not tell stays as described."""
    bodies = [k for k in range(model.nb) if is_inside(before[10 * k:10 * k + 10])]
    columns = np.concatenate([np.arange(10 * k, 10 * k + 10) for k in bodies]).astype(int)
    n = len(columns)
    others = np.setdiff1d(np.arange(10 * model.nb), columns)
    A = np.concatenate([Y[:, :, columns], friction_rows(log.v, joints)], axis=2)
    weight = (moves / noise)[:, :, None]
    b = (log.tau - rotors - Y[:, :, others] @ before[others]) * weight[:, :, 0]
    A = (A * weight).reshape(-1, n + 3 * len(joints))
    H, g = A.T @ A, A.T @ b.reshape(-1)
    for at, k in enumerate(bodies):
        part = slice(10 * at, 10 * at + 10)
        metric = barrier(before[10 * k:10 * k + 10])[1] / SPREAD ** 2
        H[part, part] += metric
        g[part] += metric @ before[10 * k:10 * k + 10]
    x = np.concatenate([before[columns], np.maximum(friction, [[1e-3, 1e-3, -np.inf]]).reshape(-1)])
    kept = np.array([n + 3 * i + j for i in range(len(joints)) for j in (0, 1)], int)
    x = descend(H, g, x, len(bodies), kept)
    parameters = before.copy()
    parameters[columns] = x[:n]
    return parameters.reshape(-1, 10), x[n:].reshape(-1, 3)


def descend(H, g, x, bodies, kept):
    """Newton's method with a barrier whose weight falls: x'Hx/2 - g'x with pseudo-inertias positive definite and the
    entries `kept` positive."""
    weight = 1e3
    while weight > 1e-3:
        for _ in range(30):
            slope, curve = H @ x - g, H.copy()
            for k in range(bodies):
                part = slice(10 * k, 10 * k + 10)
                first, second = barrier(x[part])
                slope[part] += weight * first
                curve[part, part] += weight * second
            slope[kept] -= weight / x[kept]
            curve[kept, kept] += weight / x[kept] ** 2
            scale = 1 / np.sqrt(np.diag(curve))
            step = -scale * np.linalg.solve(curve * np.outer(scale, scale), scale * slope)
            decrement = -step @ slope / weight
            share = 1.0
            while share > 1e-12 and not is_possible(x + share * step, bodies, kept):
                share *= 0.7
            x = x + (share if share == 1 else 0.9 * share) * step
            if decrement < 1e-2:
                break
        weight *= 0.5
    return x


def predict(model, parameters, friction, log):
    """Torques of motors by a model and its friction."""
    rotors, Y, _ = known_torque(model, log)
    n = len(log.q)
    return rotors + Y @ parameters.reshape(-1) + (friction_rows(log.v, range(model.nv)) @ friction.reshape(-1)).reshape(n, -1)
