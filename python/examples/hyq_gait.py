# SPDX-License-Identifier: MIT
"""HyQ trots: torques of its motors and forces under its feet over two strides, as a picture, and the table
for its firmware. Cells (# %%) for an editor that knows them; as a program: hyq_gait.py [FOLDER]."""

# %% The robot. models/ has it as URDF too: rbd.Model.from_urdf(..., floating=True)
import subprocess
import sys
from pathlib import Path

import numpy as np

import rbd

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
hyq = rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"))
legs = ["lf", "rf", "lh", "rh"]
toe = (0.33, 0, 0)  # in the lower leg
print(hyq, f"{hyq.mass():.1f} kg")

# %% The gait: diagonal pairs of feet in turns, half a stride each; the trunk moves evenly.
speed, stride, lift, height, dt = 0.4, 0.5, 0.08, 0.5, 2e-3  # m/s, s, m, m, s
time = np.arange(0, 2 * stride, dt)
near = hyq.neutral()
near[7:] = np.array([0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4])
hyq.kinematics(near)
middle = np.array([(x, y, 0) for x in (0.37, -0.37) for y in (0.32, -0.32)])  # of the feet's ways
middle[:, :2] += hyq.com().position[:2]


def place(leg, t):
    """Where a foot is in the world, and whether it stands: swings are smooth to the acceleration."""
    steps, phase = divmod(t / stride + (0.5 if leg in (0, 3) else 0), 1)
    start = (steps - 0.25 - (0.5 if leg in (0, 3) else 0)) * stride * speed  # from where it lifts off
    p = min(2 * phase, 1)
    forward = p**3 * (10 - 15 * p + 6 * p**2)
    up = 64 * (p * (1 - p)) ** 3
    return middle[leg] + (start + forward * speed * stride, 0, up * lift), p == 1


# %% Configurations: the feet are put in their places, near the configuration before; the trunk is heavy.
q = np.empty((len(time), hyq.nq))
stands = np.zeros((len(time), 4), bool)
for k, t in enumerate(time):
    places, stands[k] = zip(*(place(leg, t) for leg in range(4)))
    feet = hyq.constraint_set([hyq.point_contact(f"{leg}_lowerleg", toe, p) for leg, p in zip(legs, places)])
    near[:7] = speed * t, 0, height, 0, 0, 0, 1
    near = q[k] = feet.assemble(near, weight=[1e6] * 6 + [1] * 12).q_near

# %% Velocities and accelerations by differences, torques by inverse dynamics with the feet that stand.
v = np.array([hyq.difference(q[max(k - 1, 0)], q[min(k + 1, len(q) - 1)]) for k in range(len(q))]) / (2 * dt)
a = np.gradient(v, dt, axis=0)
tau, force = np.zeros((len(time), hyq.nv)), np.zeros((len(time), 4))
for pair in [0, 3], [1, 2]:
    feet = hyq.constraint_set([hyq.point_contact(f"{legs[leg]}_lowerleg", toe) for leg in pair])
    for k in np.flatnonzero(stands[:, pair[0]] & stands[:, pair[1]]):
        result = feet.constrained_id(q[k], v[k], a[k])
        tau[k], force[k, pair] = result.tau, result.lambda_[2::3]
inner = slice(3, -3)  # the differences are one-sided at the ends
missing = np.abs(tau[inner, :6]).max()
print(f"two feet carry all but {missing:.1f} N m about their line; torques up to "
      f"{np.abs(tau[inner, 6:]).max():.0f} N m, limit {hyq.joint('lf_upperleg').effort:.0f} N m")

# %% A table, and a picture of it.
names = hyq.dof_names[6:]
table = np.column_stack([time, tau[:, 6:], force])[inner]
csv, png = folder / "hyq_gait.csv", folder / "hyq_gait.png"
header = ",".join(["time", *names, *(f"{leg}_foot" for leg in legs)])
np.savetxt(csv, table, "%.6g", ",", header=header, comments="")
plot = f"""
set terminal pngcairo size 800, 640 font ",10"
set output "{png}"
set datafile separator comma
set grid; set lmargin 10; set multiplot layout 2, 1
set ylabel "torque, left fore leg, N m"; set key top right horizontal; set yrange [-20:150]
plot "{csv}" using 1:2 with lines lw 2 title "hip, sideways", \\
     "" using 1:6 with lines lw 2 title "hip, forward", "" using 1:10 with lines lw 2 title "knee"
set ylabel "force up, N"; set xlabel "time, s"; set yrange [0:600]
plot for [c = 14:17] "{csv}" using 1:c with lines lw 2 title word("{' '.join(legs)}", c - 13)
"""
try:
    subprocess.run(["gnuplot"], input=plot, text=True, check=True)
    print(png)
except FileNotFoundError:
    print(f"{csv}; with gnuplot there would be a picture")

# %% The constant model for the firmware: include it after rbd.h, pass &hyq_model.
(folder / "hyq_model.h").write_text(hyq.c_model("hyq", "hyq_gait.py"))
print(folder / "hyq_model.h")
