# SPDX-License-Identifier: MIT
"""HyQ without motors falls to the ground, by contacts that open and slip: a PNG for each twentieth of a
second, and what touches. Cells (# %%) for an editor that knows them; as a program: hyq_falls.py [FOLDER]."""

# %% The robot, and what may touch the ground: feet, knees and the corners of the trunk.
import subprocess
import sys
from pathlib import Path

import numpy as np

import rbd

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
hyq = rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"))
legs, dt, steps_per_frame, frames = ["lf", "rf", "lh", "rh"], 1e-3, 50, 30
toe = (0.33, 0, 0)  # in the lower leg, whose origin is the knee
corners = [(x, y, -0.1) for x in (0.45, -0.45) for y in (0.2, -0.2)]
rows = [rbd.Contact(f"{leg} foot", f"{leg}_lowerleg", point=toe, radius=0.02, friction=0.7) for leg in legs]
rows += [rbd.Contact(f"{leg} knee", f"{leg}_lowerleg", radius=0.04, friction=0.5) for leg in legs]
rows += [rbd.Contact(f"corner {k}", 0, point=corner, friction=0.4) for k, corner in enumerate(corners)]
ground = hyq.contacts(rows, options=rbd.ContactOptions(joint_limits=True, iterations=200))

# %% It starts 0.8 m up, a little to the side; its joints have dampers and nothing else.
q, v, tau = hyq.neutral(), np.zeros(hyq.nv), np.zeros(hyq.nv)
q[2], q[3], q[6] = 0.8, 0.15, np.sqrt(1 - 0.15**2)
q[7:] = [0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4]
damping = np.r_[np.zeros(6), np.full(12, 3.0)]
plot = """set terminal pngcairo size 480, 360
set xrange [-0.7:0.7]; set yrange [-0.9:0.9]; set zrange [0:0.9]; set xyplane at 0
set view 75, 28, 2.3; unset key; unset border; unset tics; set view equal xyz
"""


def lines():
    """The robot's lines, as gnuplot takes them: the trunk's outline and each leg. After kinematics."""
    trunk = [hyq.point_position(0, corners[k]) for k in (0, 1, 3, 2, 0)]
    chains = [trunk] + [[hyq.body_pose(f"{leg}_upperleg").p, hyq.body_pose(f"{leg}_lowerleg").p,
                         hyq.point_position(f"{leg}_lowerleg", toe)] for leg in legs]
    return "\n\n".join("\n".join("%g %g %g" % tuple(p) for p in chain) for chain in chains)


# %% The steps, and a frame after every fifty.
residuals = []
for frame in range(frames):
    touching = [row.name for row in rows if ground.get(row.name).state >= rbd.ContactState.STICKS]
    hyq.kinematics(q, v)
    floor = "-0.7 -0.9 0\n0.7 -0.9 0\n0.7 0.9 0\n-0.7 0.9 0\n-0.7 -0.9 0"
    plot += (f'set output "{folder}/hyq_falls_{frame:02}.png"\n$floor << end\n{floor}\nend\n'
             f'$robot << end\n{lines()}\nend\nset title "{frame * steps_per_frame * dt:.2f} s"\n'
             'splot $floor with lines lc "gray", $robot with linespoints lw 3 pt 7 lc "black"\n')
    print(f"{frame * steps_per_frame * dt:.2f} s: {sum(hyq.energy()):6.1f} J; touching: {', '.join(touching) or '-'}")
    for _ in range(steps_per_frame):
        q, v = ground.step(q, v, tau, dt, damping=damping)
        residuals.append(ground.last().residual)
weight, force = hyq.mass() * 9.81, ground.forces()[:, 2].sum()
unsolved = np.sum(np.array(residuals) > 1e-6)
print(f"it lies still, no speed above {np.abs(v).max():.0e}, with {force:.3f} N on the ground, weight {weight:.3f} N")
print(f"of {len(residuals)} steps {unsolved} are solved to no better than {max(residuals):.0e} m/s")

# %% The frames, of which a video tool makes a film: ffmpeg -framerate 20 -i hyq_falls_%02d.png fall.mp4
try:
    subprocess.run(["gnuplot"], input=plot, text=True, check=True)
    print(f"{folder}/hyq_falls_00.png to hyq_falls_{frames - 1}.png")
except FileNotFoundError:
    print("with gnuplot there would be pictures")
