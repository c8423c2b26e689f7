"""The task of a foot, in closed form and from the chain alone."""

from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.foot_task import foot_task
from drake_leg.kinematics.khalil import jacobian, jacobian_rate_bias
from drake_leg.robot import Row
from drake_leg.robots import LEG_A, LEG_B, SCARA


def with_offset(robot, offset):
    first, knee, *rest = robot.segments
    row = replace(knee.row, r=offset)
    return replace(robot, segments=(first, replace(knee, row=row), *rest))


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, with_offset(LEG_B, 0.02)])
def test_rates_and_accelerations_move_the_foot_as_told(rng, robot):
    task = foot_task(robot)
    for _ in range(50):
        q, v, a = rng.uniform(0.3, 1.2, 3), rng.normal(size=3), rng.normal(size=3)
        J = jacobian(robot.rows, q)[3:]
        qdot = np.array(task.rates(q.tolist(), v.tolist()))
        qddot = np.array(task.accelerations(q.tolist(), qdot.tolist(), a.tolist()))
        np.testing.assert_allclose(J @ qdot, v, atol=1e-10)
        bias = jacobian_rate_bias(robot.rows, q, qdot)[3:]
        np.testing.assert_allclose(J @ qddot + bias, a, atol=1e-8)
        assert task.determinant(q) == pytest.approx(np.linalg.det(J), rel=1e-9)


def test_a_table_with_a_vanishing_offset_has_the_closed_forms_rates(rng):
    near, exact = foot_task(with_offset(LEG_B, 1e-300)), foot_task(LEG_B)
    q, v = rng.uniform(0.3, 1.2, 3).tolist(), rng.normal(size=3).tolist()
    np.testing.assert_allclose(near.rates(q, v), exact.rates(q, v), rtol=1e-11)


def test_four_joints_are_too_many():
    with pytest.raises(InvalidValueError, match="4 joint positions"):
        foot_task(SCARA)


def test_a_sliding_joint_is_a_joint(rng):
    turn, reach, lift = SCARA.segments[0], SCARA.segments[1], SCARA.segments[3]
    arm = replace(
        SCARA,
        name="cylindrical",
        segments=(turn, reach, replace(lift, row=Row(joint="prismatic", d=0.24, alpha=np.pi))),
    )
    task = foot_task(arm)
    q, v = [0.2, 0.9, 0.05], rng.normal(size=3)
    np.testing.assert_allclose(jacobian(arm.rows, q)[3:] @ task.rates(q, v.tolist()), v, atol=1e-12)
