"""The walk along a chain against the products of its transforms, and against differences."""

import numpy as np
import pytest
from chains import POSTURES, chain_of, fixed, random_chain, turn
from witnesses import jacobian_rate_bias

from drake_leg.kinematics.chain import foot_jacobian, foot_jacobian_rate, sweep
from drake_leg.kinematics.khalil import chain_length, foot_pose, jacobian


def test_the_size_of_a_chain_is_the_way_from_frame_to_frame():
    rows = chain_of([turn(d=0.3, r=0.4), fixed(d=-0.5)]).rows
    assert chain_length(rows) == pytest.approx(1.0)
    assert chain_length([turn()]) == 1.0


@pytest.mark.parametrize("joints", range(1, 10))
def test_foot_and_jacobian_are_those_of_the_transforms(rng, joints):
    for _ in range(5):
        robot, q = random_chain(rng, joints)
        here = sweep(robot.rows, q.tolist())
        X_BF = foot_pose(robot.rows, q)
        np.testing.assert_allclose(here.foot, X_BF[:3, 3], rtol=0, atol=1e-14)
        np.testing.assert_allclose(np.transpose(here.rotation), X_BF[:3, :3], rtol=0, atol=1e-14)
        np.testing.assert_allclose(foot_jacobian(here), jacobian(robot.rows, q), rtol=0, atol=1e-14)


@pytest.mark.parametrize(("robot", "q"), POSTURES.values(), ids=POSTURES)
def test_the_jacobians_rate_is_its_derivative_along_the_motion(rng, robot, q, derivative):
    qdot = rng.normal(size=len(q))
    rate = foot_jacobian_rate(sweep(robot.rows, q.tolist()), qdot.tolist())
    differences = derivative(lambda t: jacobian(robot.rows, q + t * qdot))
    np.testing.assert_allclose(rate, differences, rtol=0, atol=1e-9)
    bias = jacobian_rate_bias(robot.rows, q, qdot)
    np.testing.assert_allclose(rate @ qdot, bias, rtol=0, atol=1e-13)
