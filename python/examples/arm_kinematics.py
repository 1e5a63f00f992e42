#!/usr/bin/env python3
"""Forward and inverse kinematics of a hobby arm of five axes, in degrees, as a robot's program has them: a class of forty
lines, the lengths of an SO-101, no URDF file and no masses. With a file: rbd.Model.from_urdf("arm.urdf").
SPDX-License-Identifier: MIT"""
import numpy as np

import rbd

# name, place in the parent's link (m), axis, limits (rad)
JOINTS = [("pan", (0.04, 0, 0.062), (0, 0, 1), -1.92, 1.92), ("lift", (0.03, -0.018, 0.054), (0, 1, 0), -1.75, 1.75),
          ("elbow", (0.028, 0, 0.113), (0, 1, 0), -1.69, 1.69), ("flex", (0.135, 0.005, 0), (0, 1, 0), -1.66, 1.66),
          ("roll", (0.061, 0.018, 0), (1, 0, 0), -2.74, 2.84)]
GRIPPER = (0.1, 0, 0)  # of the last link, m


class ArmKinematics:
    """Poses as 4 x 4 matrices, joints in degrees."""

    def __init__(self, joints=JOINTS, tool=GRIPPER):
        bodies = [rbd.Body(name, parent=k - 1, type="revolute", position=place, axis=axis, lower=low, upper=high, armature=1)
                  for k, (name, place, axis, low, high) in enumerate(joints)]
        self.model, self.tool, self.last = rbd.Model(bodies), tool, len(joints) - 1

    def forward_kinematics(self, degrees):
        self.model.kinematics(np.radians(degrees))
        pose = np.eye(4)
        pose[:3, :3] = self.model.body_pose(self.last).R
        pose[:3, 3] = self.model.point_position(self.last, self.tool)
        return pose

    def inverse_kinematics(self, degrees, pose, position_weight=1.0, orientation_weight=0.01):
        """Degrees for a pose, from where the arm is; and what was found. Five axes reach hardly any orientation: it has
        a small weight, or none."""
        targets = [rbd.IkTarget("point", self.last, self.tool, position=pose[:3, 3], weight=position_weight)]
        if orientation_weight > 0:
            targets.append(rbd.IkTarget("rotation", self.last, rotation=pose[:3, :3], weight=orientation_weight))
        found = self.model.ik(targets, np.radians(degrees))
        return np.degrees(found.q), found


def main():
    arm = ArmKinematics()
    there = arm.forward_kinematics([10, -40, 60, 50, 20])
    degrees, found = arm.inverse_kinematics([0, 0, 0, 0, 0], there)
    print("pose:", found.status.name, degrees.round(3))
    assert np.abs(arm.forward_kinematics(degrees) - there).max() < 1e-5

    there[:3, 3] += (0, 0, 0.02)  # 2 cm higher, whatever the orientation
    degrees, found = arm.inverse_kinematics(degrees, there, orientation_weight=0)
    print("place:", found.status.name, degrees.round(1))
    assert found.status == rbd.IkStatus.REACHED
    there[:3, 3] += (0.3, 0, 0)
    degrees, found = arm.inverse_kinematics(degrees, there, orientation_weight=0)
    print(f"too far: {found.status.name}, {found.metres:.3f} m away")
    assert found.status != rbd.IkStatus.REACHED


if __name__ == "__main__":
    main()
