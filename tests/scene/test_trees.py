"""Robots with branches, floating bases and poses of the base, shown."""

from dataclasses import replace

import numpy as np
import pytest
from trees import hexapod, two_fingers

from drake_leg import LEG_B
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.robot.robot import Robot
from drake_leg.scene.motion import at_rest
from drake_leg.scene.showable import shown

STANDING = ((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0.5), (0, 0, 0, 1))


def shuffled():
    """Two fingers whose rows take turns, so that the plant orders the joints another way."""
    one = two_fingers()
    wrist, left, left_tip, right, right_tip = one.segments
    right = replace(right, row=replace(right.row, antecedent=1))
    left = replace(left, row=replace(left.row, antecedent=1))
    left_tip = replace(left_tip, row=replace(left_tip.row, antecedent=2))
    right_tip = replace(right_tip, row=replace(right_tip.row, antecedent=3))
    return replace(one, segments=(wrist, left, right, left_tip, right_tip))


@pytest.mark.parametrize("robot", [two_fingers(), shuffled(), hexapod()], ids=Robot.__repr__)
def test_joints_are_given_in_the_order_of_the_table(robot):
    q = np.random.default_rng(3).uniform(-1.0, 1.0, len(robot.moving))
    motion = at_rest(robot, q)
    X_WF = dict(zip(motion.shown.names, motion.poses()[0], strict=True))
    X_W0 = np.eye(4) if robot.base_pose is None else np.array(robot.base_pose)
    for index, X_0 in enumerate(base_transforms(robot.rows, q), start=1):
        assert np.abs(X_WF[f"frame_{index}"] - X_W0 @ X_0).max() < 1e-14


def test_a_floating_robot_is_also_placed_by_all_of_its_positions():
    robot = hexapod()
    q = shown(robot).default.copy()
    q[4:7] = 1.0, 2.0, 3.0
    motion = at_rest(robot, q)
    assert motion.poses()[0, 1, :3, 3].tolist() == [1.0, 2.0, 3.0]


def test_axes_have_the_numbers_of_the_table():
    assert shown(LEG_B).marks == ("0", "1", "2", "3", "4")
    on_a_wall = shown(replace(LEG_B, base_pose=STANDING))
    assert on_a_wall.marks == ("W", "0", "1", "2", "3", "4")
    assert shown(hexapod()).marks[:3] == ("W", "0", "1")
