# SPDX-License-Identifier: MIT
"""HyQ drops onto its feet, whose joints are springs and dampers, and stands. A page that the browser plays:
hyq_lands.py opens it, hyq_lands.py FILE.html writes it."""
import sys

import numpy as np

import rbd

hyq = rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"))
feet = hyq.contacts([rbd.Contact(leg, f"{leg}_lowerleg", point=(0.33, 0, 0), radius=0.02, friction=0.7)
                     for leg in ("lf", "rf", "lh", "rh")])

q, v = hyq.neutral(), np.zeros(hyq.nv)
bent = np.array([0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4])
q[2], q[7:] = 0.9, bent

kp, kd, dt = 300.0, 12.0, 1e-3
damping = np.r_[np.zeros(6), np.full(12, kd + dt * kp / 2)]
states = [q]
for _ in range(2000):
    tau = np.r_[np.zeros(6), kp * (bent - q[7:])]
    q, v = feet.step(q, v, tau, dt, damping=damping)
    states.append(q)

picture = hyq.show(states, dt * np.arange(len(states)), file=sys.argv[1] if len(sys.argv) > 1 else None)
weight = 9.81 * hyq.mass()
print(f"it stands at {q[2]:.3f} m; its feet carry {feet.forces()[:, 2].sum():.1f} N of {weight:.1f} N: {picture.path}")
