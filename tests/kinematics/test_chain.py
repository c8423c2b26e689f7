"""The walk along a chain against the products of its transforms, and against differences."""

import functools
import math

import numpy as np
import pytest
from chains import POSTURES, chain_of, fixed, random_chain, turn
from witnesses import jacobian_rate_bias

from drake_leg.kinematics.chain import foot_jacobian_rate
from drake_leg.kinematics.khalil import (
    base_transforms,
    chain_frames,
    chain_length,
    foot_pose,
    jacobian,
    jacobian_by_differentiation,
    links_of,
    moving_rows,
    row_transform,
)
from drake_leg.kinematics.of_robot import movable


def test_the_size_of_a_chain_is_the_way_from_frame_to_frame():
    rows = chain_of([turn(d=0.3, r=0.4), fixed(d=-0.5)]).rows
    assert chain_length(rows) == pytest.approx(1.0)
    assert chain_length([turn()]) == 1.0


@pytest.mark.parametrize("joints", range(1, 10))
def test_foot_and_jacobian_are_those_of_the_transforms(rng, joints):
    for _ in range(5):
        robot, q = random_chain(rng, joints)
        positions = dict(zip(moving_rows(robot.rows), q, strict=True))
        steps = [row_transform(row, positions.get(i, 0.0)) for i, row in enumerate(robot.rows)]
        X_BF = functools.reduce(np.matmul, steps)
        np.testing.assert_allclose(foot_pose(robot.rows, q), X_BF, rtol=0, atol=1e-14)
        J = jacobian_by_differentiation(robot.rows, q)
        np.testing.assert_allclose(jacobian(robot.rows, q), J, rtol=0, atol=1e-14)


@pytest.mark.parametrize("joints", range(1, 10))
def test_one_posture_is_that_of_the_batch(rng, joints):
    robot, _ = random_chain(rng, joints)
    q = rng.uniform(-3.0, 3.0, (50, joints))
    for function in (base_transforms, foot_pose, jacobian):
        batch = function(robot.rows, q)
        singles = np.array([function(robot.rows, one) for one in q])
        np.testing.assert_allclose(singles, batch, rtol=0, atol=1e-15 * np.abs(batch).max())


@pytest.mark.parametrize(("robot", "q"), POSTURES.values(), ids=POSTURES)
def test_what_is_commanded_in_one_posture_is_that_of_the_batch(rng, robot, q):
    moved = movable(robot, q.tolist())
    near = q + 0.1 * rng.uniform(-1.0, 1.0, (20, len(q)))
    J = moved.twists.T @ jacobian(robot.rows, near)
    v = 0.1 * rng.normal(size=moved.size)
    expected = np.linalg.pinv(np.array(moved.row_lengths)[:, np.newaxis] * J)
    for index, one in enumerate(near.tolist()):
        least = 1e-15 * np.abs(J[index]).max()
        np.testing.assert_allclose(moved.jacobian(one), J[index], rtol=0, atol=least)
        qdot = expected[index] @ (moved.row_lengths * v)
        np.testing.assert_allclose(moved.rates(one, v.tolist()), qdot, rtol=1e-10, atol=1e-13)
        sign, logarithm = np.linalg.slogdet(J[index] @ J[index].T)
        size = math.exp(logarithm / 2.0) * sign
        assert abs(moved.determinant(one)) == pytest.approx(size, rel=1e-9)
        if not moved.is_redundant:
            assert moved.determinant(one) == pytest.approx(np.linalg.det(J[index]), rel=1e-12)


@pytest.mark.parametrize(("robot", "q"), POSTURES.values(), ids=POSTURES)
def test_the_jacobians_rate_is_its_derivative_along_the_motion(rng, robot, q, derivative):
    qdot = rng.normal(size=len(q))
    links = links_of(robot.rows)
    frames = chain_frames(links, (q.tolist(), math.cos, math.sin))
    rate = foot_jacobian_rate(links, frames, qdot.tolist())
    differences = derivative(lambda t: jacobian(robot.rows, q + t * qdot))
    np.testing.assert_allclose(rate, differences, rtol=0, atol=1e-9)
    bias = jacobian_rate_bias(robot.rows, q, qdot)
    np.testing.assert_allclose(rate @ qdot, bias, rtol=0, atol=1e-13)
