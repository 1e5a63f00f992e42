# SPDX-License-Identifier: MIT
"""An arm of seven servos: their friction is identified from a log of the arm, and compensated. It prints the error
before and after, and draws it. Cells (# %%) for an editor that knows them; as a program: servo_arm.py [FOLDER]."""

# %% Friction of the servos from the base to the hand, as published: sixth model of BAM (Duclusaud and Passault 2024,
# arXiv 2410.08650).
import subprocess
import sys
from pathlib import Path

import numpy as np

import rbd

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
fields = ("coulomb", "viscous", "load_motor", "load_joint", "rest", "rest_motor", "rest_joint", "square_motor",
          "square_joint", "speed", "power")
published = {
    "eRob80, gear 100": (0.0005, 9.709, 0.0489, 0, 5.226, 0, 0.0512, 0.0027, 0.0026, 2.033, 3.000),
    "eRob80, gear 50": (3.259, 1.403, 0.0357, 0.0008, 0.3204, 0.0038, 0.0414, 0.0019, 0.0016, 2.830, 1.786),
    "Dynamixel MX-106": (0, 0.0507, 0.1980, 0.0222, 0.1220, 0.1986, 0.0871, 0.0100, 0.0001, 1.746, 1.143),
    "Dynamixel MX-64": (0, 0.0253, 0.3115, 0, 0.1227, 0.1877, 0.0141, 0.0069, 0.0100, 2.575, 0.8409),
    "Feetech STS3215": (0.0533, 0.0282, 0.0449, 0.2436, 0, 0.0001, 0.1423, 0.0076, 0.0034, 0.3711, 9.931),
    "Dynamixel XL-330": (0.0023, 0.0185, 0.2306, 0.2608, 0.0002, 0, 0.1516, 0.0056, 0.0038, 0.1153, 1.000),
    "Dynamixel XL-320": (0, 0.0072, 0, 0.1583, 0.0163, 0, 0.2455, 0.0036, 0.0047, 2.301, 1.707)}
truth = [rbd.Friction(**dict(zip(fields, values))) for values in published.values()]

# %% The arm, whose masses are known: joint, axis, its place in the link before (m), mass (kg), centre of mass (m),
# inertia of the rotor (kg m^2).
joints = [("base", "z", 0.10, 1.50, (0.00, 0, 0.05), 0.60), ("shoulder", "y", 0.10, 1.20, (0.01, 0, 0.12), 0.20),
          ("elbow", "y", 0.25, 0.50, (0.00, 0.01, 0.08), 0.020), ("roll", "z", 0.12, 0.25, (0.01, 0, 0.05), 0.012),
          ("wrist", "y", 0.10, 0.12, (0.00, 0, 0.03), 0.006), ("turn", "z", 0.05, 0.06, (0.01, 0, 0.02), 0.001),
          ("hand", "x", 0.04, 0.05, (0.00, 0.005, 0.03), 0.0005)]
bodies = [rbd.Body(f"{joint} link", joint, k - 1, "revolute", position=(0, 0, place),
                   axis=[axis == letter for letter in "xyz"], mass=mass, com=com, armature=rotor,
                   inertia=(mass * 4e-3, 0, 0, mass * 4e-3, 0, mass * 1e-3))
          for k, (joint, axis, place, mass, com, rotor) in enumerate(joints)]
arm = rbd.Model(bodies)
kp, kd = np.array([200, 200, 20, 10, 6, 2, 0.8]), np.array([20, 15, 1, 0.5, 0.2, 0.05, 0.02])
middle, dt = np.array([0, 0.8, 0.9, 0.3, 0.7, 0.5, 0.4]), 2e-3


def actuators(frictions):
    """The servos, whose drives take torques at the shaft, with such friction."""
    return arm.actuators([rbd.Motor(name, joint[0], gear=1, constant=1, friction=friction)
                          for name, joint, friction in zip(published, joints, frictions)])


def plan(seed, seconds):
    """Positions, velocities and accelerations: three sines for each joint, which begin softly."""
    random = np.random.default_rng(seed)
    t = np.arange(0, seconds, dt)[:, None, None]
    rate, phase = 2 * np.pi * random.uniform(0.1, 0.6, (2, 7, 3)) * [[[1]], [[10]]]
    begin = 1 - np.exp(-t[:, 0] ** 2)
    q = middle + begin * (0.25 * np.sin(rate * t + phase)).sum(axis=2)
    v = np.gradient(q, dt, axis=0)
    return q, v, np.gradient(v, dt, axis=0)


def follow(wanted, known):
    """The true arm follows a plan by feedback and the torques that it takes with the known friction. Returns positions,
    velocities and torques of the motors."""
    robot, controller = actuators(truth), actuators(known)
    q, v = wanted[0][0], wanted[1][0]
    robot.reset(q)
    log = []
    for position, speed, acceleration in zip(*wanted):
        torque = controller.inverse(position, speed, acceleration, arm.rnea(position, speed, acceleration)).torque
        q, v = robot.step(q, v, dt, torque=torque, position=position, speed=speed, kp=kp, kd=kd)
        log.append((q, v, robot.get().motor))
    return np.moveaxis(np.array(log), 1, 0)


# %% A log without compensation, as sensors have it: noise of the positions, and of the torques by the current.
nothing = [rbd.Friction()] * arm.nv
random = np.random.default_rng(1)
q, _, motor = follow(plan(2, 30), nothing)
q = q + 1e-4 * random.normal(size=q.shape)
motor = motor * (1 + 0.01 * random.normal(size=q.shape))

# %% What the model does not explain is friction. Velocities and accelerations by differences of what a window smooths.
window = np.hanning(53)[1:-1] / np.hanning(53).sum()


def smooth(x):
    return np.stack([np.convolve(column, window, "same") for column in x.T], axis=1)


q = smooth(q)
v = smooth(np.gradient(q, dt, axis=0))
a = np.gradient(v, dt, axis=0)
inner = slice(100, -100, 5)
q, v, a, motor = q[inner], v[inner], a[inner], smooth(smooth(motor))[inner]
friction = motor - arm.rnea(q, v, a)


def friction_of(x):
    """Six fields of rbd_gear_friction. x has their square roots, so that none is negative. The power is 1."""
    coulomb, viscous, load_motor, rest, rest_motor, speed = x**2
    return rbd.Friction(coulomb, viscous, min(load_motor, 0.9), rest=rest, rest_motor=rest_motor, speed=speed + 0.05,
                        power=1)


def law(x, v, motor):
    """What this friction takes."""
    f = friction_of(x)
    level = f.coulomb + f.load_motor * np.abs(motor)
    level += np.exp(-np.abs(v) / f.speed) * (f.rest + f.rest_motor * np.abs(motor))
    return np.sign(v) * level + f.viscous * v


def least_squares(residual, x):
    """Levenberg and Marquardt's method with differences."""
    damping, r = 1e-2, residual(x)
    for _ in range(100):
        J = np.stack([(residual(x + 1e-6 * unit) - r) / 1e-6 for unit in np.eye(len(x))], axis=1)
        step = np.linalg.solve(J.T @ J + damping * np.diag((J * J).sum(axis=0) + 1e-9), -J.T @ r)
        better = residual(x + step)
        if better @ better < r @ r:
            x, r, damping = x + step, better, damping / 3
        else:
            damping *= 5
    return x


found, fitted = [], np.zeros_like(friction)
moves = np.abs(v) > 0.05  # what stands still or turns back has another friction
for k in range(arm.nv):
    rows, size = moves[:, k], np.abs(friction[moves[:, k], k]).mean()
    start = np.sqrt([size / 2, size / 2, 0.1, size / 2, 0.1, 0.5])

    def residual(x):  # the last rows keep small what the log does not tell
        left = law(x, v[rows, k], motor[rows, k]) - friction[rows, k]
        return np.append(left, 0.05 * size * x / start)

    x = least_squares(residual, start)
    fitted[:, k] = law(x, v[:, k], motor[:, k])
    found.append(friction_of(x))

# %% Another motion, without and with compensation of what was found.
wanted = plan(3, 12)
before, after = (follow(wanted, known)[0] - wanted[0] for known in (nothing, found))


def rms(x, where=True):
    return np.sqrt((x**2).mean(axis=0, where=where))


table = np.stack([rms(friction, moves), rms(friction - fitted, moves), 1e3 * rms(before), 1e3 * rms(after)], axis=1)
print("servo              friction, not explained, N m   error before, after, mrad")
for name, row in zip(published, table):
    print(f"{name:18} {row[0]:8.4f} {row[1]:14.4f} {row[2]:20.2f} {row[3]:8.2f}")
print(f"the error falls by a factor of {np.linalg.norm(table[:, 2]) / np.linalg.norm(table[:, 3]):.1f}")

# %% A picture: friction against speed in the log, and the errors of the other motion.
time = dt * np.arange(len(before))
log_csv, errors_csv, png = (folder / f"servo_arm{end}" for end in ("_log.csv", "_errors.csv", ".png"))
np.savetxt(log_csv, np.column_stack([v, friction, fitted])[::3], "%.6g", ",")
np.savetxt(errors_csv, np.column_stack([time, 1e3 * before, 1e3 * after]), "%.6g", ",")
rows = "\n".join(f"""
set title "{name}: friction, N m, by speed, rad/s"; set xrange [*:*]; set key bottom right vertical textcolor variable
plot "{log_csv}" using {k + 1}:{k + 8} with points pt 7 ps 0.4 lc "#888888" title "log", \\
     "" using {k + 1}:{k + 15} with points pt 7 ps 0.2 lc "#c00000" title "identified"
set title "joint {joint[0]}: error, mrad, by time, s"; set xrange [0:{time[-1]:.0f}]; set key top right horizontal
plot "{errors_csv}" using 1:{k + 2} with lines lc "#888888" title "before", \\
     "" using 1:{k + 9} with lines lw 2 lc "#c00000" title "after"
""" for k, (name, joint) in enumerate(zip(published, joints)))
plot = f"""
set terminal pngcairo size 800, 1120 font ",8"
set output "{png}"
set datafile separator comma
set grid; set offsets 0, 0, graph 0.2, 0; set multiplot layout 7, 2
{rows}
"""
try:
    subprocess.run(["gnuplot"], input=plot, text=True, check=True)
    print(png)
except FileNotFoundError:
    print(f"{errors_csv}; with gnuplot there would be a picture")
