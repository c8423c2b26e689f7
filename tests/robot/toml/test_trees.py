"""Branches, bases and loops in TOML: read, written, read again; and every fault in one sentence."""

import math
from dataclasses import replace

import numpy as np
import pytest
from trees import hexapod, parallelogram, two_fingers

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robots import ROBOTS
from drake_leg.robot.toml.reader import read_robot
from drake_leg.robot.toml.writer import robot_toml

TREES = [two_fingers(), hexapod(), parallelogram()]


@pytest.mark.parametrize("robot", TREES, ids=lambda robot: robot.name)
def test_a_tree_is_read_back_as_it_was(robot):
    assert read_robot(robot_toml(robot), "x.toml") == robot


def test_a_body_of_the_base_and_a_pose_are_read_back_without_floating():
    robot = replace(hexapod(), floating=False)
    assert read_robot(robot_toml(robot), "x.toml") == robot
    bare = replace(robot, base_link=None)
    assert read_robot(robot_toml(bare), "x.toml") == bare


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_a_chain_is_written_without_the_keys_of_trees(robot):
    keys = ("antecedent", "gamma", "b =", "[base]", "[[loop]]")
    assert not [key for key in keys if key in robot_toml(robot)]


def test_roll_pitch_and_yaw_turn_the_base_as_in_sdf():
    line = next(line for line in robot_toml(hexapod()).splitlines() if line.startswith("rotation"))
    text = robot_toml(hexapod()).replace(line, "roll_pitch_yaw = [10, 20, 30]")
    roll, pitch, yaw = map(math.radians, (10, 20, 30))

    def about(axis, angle):
        skew = np.cross(np.eye(3), np.eye(3)[axis])
        return np.eye(3) + math.sin(angle) * skew + (1 - math.cos(angle)) * skew @ skew

    axes = np.array(read_robot(text, "x.toml").base_pose)[:3, :3]
    expected = about(2, yaw) @ about(1, pitch) @ about(0, roll)
    assert np.abs(axes - expected).max() < 1e-15


@pytest.mark.parametrize(
    ("robot", "old", "new", "said"),
    [
        (1, "antecedent = 0", "antecedent = 30", "row 21 of 'hexapod' has the antecedent 30"),
        (0, "antecedent = 1", "antecedent = 5", "row 4 of 'hand' has the antecedent 5"),
        (0, "antecedent = 1", "antecedent = -1", "row 4: antecedent is -1; it must be the number"),
        (0, "antecedent = 1", "antecedent = 1.0", "row 4: antecedent is 1.0; it must be the"),
        (0, "antecedent = 1", "parent = 1", "row 4: there is no key 'parent'; write antecedent"),
        (1, "floating = true", "floating = 1", "base: floating is 1; it must be true or false"),
        (1, "position", "pos", "base: there is no key 'pos'"),
        (1, "rotation", "rpy", "base: there is no key 'rpy'; write roll_pitch_yaw"),
        (1, "[0, 0.6,", "[0, 0.7,", "the base's pose is not one"),
        (1, "[[1, 0, 0],", "[[1, 0],", r"base: rotation is \[1, 0\]; it must be three numbers"),
        (1, "[[1, 0, 0],", "[", "base: rotation is .*; it must be three rows of three"),
        (1, "rotation", "roll_pitch_yaw = [0, 0, 0]\nrotation", "both turn the base; keep one"),
        (2, "[[loop]]", "[loop]", "loop is not a list of tables; every loop goes under"),
        (2, "end = 5", "", "loop 1: end is missing; it must be the number of a row"),
        (2, "end = 5", "end = 4", "has row 4 as its end"),
        (2, "end = 5", "finish = 5", "loop 1: there is no key 'finish'"),
        (2, "antecedent = 2", "antecedent = 3", "have one antecedent, 3"),
        (2, 'joint = "cut"', 'joint = "pin"', "'pin' is given twice"),
        (2, "d = 0.2    ", 'd = 0.2\nlink = "x"   ', "row 4: link is given at a row where a loop"),
    ],
)
def test_every_fault_of_a_tree_is_one_sentence_with_file_and_value(robot, old, new, said):
    text = robot_toml(TREES[robot])
    assert old in text
    before, _, after = text.rpartition(old)
    with pytest.raises(InvalidValueError, match=f"^x.toml.*{said}") as caught:
        read_robot(f"{before}{new}{after}", "x.toml")
    assert "\n" not in str(caught.value)
