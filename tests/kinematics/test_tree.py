"""Frames and Jacobians of tables with branches."""

import math
from dataclasses import replace

import numpy as np
import pytest
from trees import hexapod, two_fingers

from drake_leg.kinematics.chain import MovableChain
from drake_leg.kinematics.khalil import (
    base_transforms,
    chain_length,
    foot_pose,
    jacobian,
    jacobian_by_differentiation,
    row_transform,
)
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_B

ROTATION = (np.array([[0, -1, 0], [1, 0, 0], [0, 0, 0]]), 2)


def about(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    X = np.eye(4)
    first, second = ((0, 1), (1, 2))[axis == "x"]
    X[first, first], X[first, second], X[second, first], X[second, second] = c, -s, s, c
    return X


def along(x, y, z):
    X = np.eye(4)
    X[:3, 3] = x, y, z
    return X


def test_a_row_is_six_elementary_transforms():
    row = Row(joint="revolute", gamma=0.3, b=0.1, alpha=-0.7, d=0.2, theta=0.5, r=-0.4)
    expected = (
        about("z", 0.3)
        @ along(0, 0, 0.1)
        @ about("x", -0.7)
        @ along(0.2, 0, 0)
        @ about("z", 0.5 + 1.1)
        @ along(0, 0, -0.4)
    )
    assert np.abs(row_transform(row, 1.1) - expected).max() < 1e-15


@pytest.mark.parametrize("robot", [two_fingers(), hexapod()], ids=["hand", "hexapod"])
def test_frames_are_products_along_their_branch(robot):
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (5, len(robot.moving)))
    X_B = base_transforms(robot.rows, q)
    moving = [index for index, row in enumerate(robot.rows) if row.joint != "fixed"]
    for row in range(1, len(robot.rows) + 1):
        X = np.eye(4)
        for index in robot.path(row):
            place = index - 1
            values = q[:, moving.index(place)] if place in moving else np.zeros(5)
            X = X @ row_transform(robot.rows[place], values)
        assert np.abs(X_B[:, row - 1] - X).max() < 1e-14


@pytest.mark.parametrize("tip", ["left_tip", "right_tip"])
def test_the_jacobian_of_any_frame_is_the_derivative_of_its_pose(tip):
    robot = two_fingers()
    rows = robot.rows[: robot.tips[tip]]
    q = np.random.default_rng(2).uniform(-2.0, 2.0, (4, sum(r.joint != "fixed" for r in rows)))
    J = jacobian(rows, q)
    assert np.abs(J - jacobian_by_differentiation(rows, q)).max() < 1e-14
    if tip == "right_tip":
        assert not J[..., 1].any()
        assert J[..., [0, 2]].any()


def test_one_foot_of_a_tree_moves_as_in_the_tree():
    robot = two_fingers()
    posture = (0.3, -0.5, 0.8)
    rows = robot.rows[: robot.tips["left_tip"]]
    left = robot.at_tip("left_tip", posture)
    assert np.allclose(foot_pose(left.rows, posture[:2]), foot_pose(rows, posture[:2]), atol=1e-15)
    assert chain_length(left.rows) == chain_length(rows)


@pytest.mark.parametrize("q", [(0.3, -0.4, 0.9), (1.0, 0.2, -0.6)])
def test_a_bias_of_a_tree_is_the_derivative_of_its_jacobian(q):
    robot = two_fingers()
    chain = MovableChain(robot.rows, np.eye(6)[:, 3:5])
    q, qdot, step = np.array(q), np.array([0.4, -1.2, 0.7]), 1e-5
    change = jacobian(robot.rows, q + step * qdot) - jacobian(robot.rows, q - step * qdot)
    expected = (change / (2 * step) @ qdot)[3:5]
    assert np.abs(chain.bias(q, qdot) - expected).max() < 1e-9


def test_a_chain_with_its_antecedents_named_is_the_same_chain():
    rows = [replace(row, antecedent=index) for index, row in enumerate(LEG_B.rows)]
    q = (0.2, -0.7, 1.1)
    assert (base_transforms(rows, q) == base_transforms(LEG_B.rows, q)).all()
    assert (jacobian(rows, q) == jacobian(LEG_B.rows, q)).all()
