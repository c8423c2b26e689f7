import numpy as np
import pytest

from drake_leg.kinematics.walking.gaits import Attitude, Command
from drake_leg.kinematics.walking.plan import WalkPlan, difference, walk_of
from drake_leg.robot.hexapods import HEIGHT, HEXABOT

START = walk_of(HEXABOT).earliest_start
WALK = walk_of(
    HEXABOT,
    commands=(Command(forward=0.1, turning=0.2, start=START),),
    attitudes=(Attitude(roll=0.05, pitch=-0.03, start=1.0),),
)


def test_the_robot_stands_first_as_its_starting_posture_says():
    row = WalkPlan(WALK, step=0.005).at(0.0)
    np.testing.assert_allclose(row.X_GB[:3, 3], [0.0, 0.0, HEIGHT], atol=1e-15)
    np.testing.assert_allclose(row.feet[:, 2], -HEIGHT, atol=1e-15)
    assert row.down.all()
    assert not row.twist.any()


@pytest.mark.parametrize("time", [0.0, 1.28, 2.5, 7.125, 7.1234567])
def test_a_row_is_the_walk_at_its_time(time):
    step = 1e-4
    row = WalkPlan(WALK, step=step).at(time)
    np.testing.assert_allclose(row.X_GB, WALK.body(time).value, atol=1e-15)
    np.testing.assert_allclose(row.feet, WALK.feet(time).value, atol=1e-15)
    X, dX, _ = WALK.body(time + step / 2.0)
    V = np.linalg.inv(X) @ dX
    np.testing.assert_allclose(row.twist[:3], [V[2, 1], V[0, 2], V[1, 0]], atol=1e-8)
    X, after = WALK.body([time, time + step]).value
    moved = X[:3, :3].T @ (after - X)[:3, 3]
    np.testing.assert_allclose(row.twist[3:], moved / step, atol=1e-11)
    middle = WALK.feet(time + step / 2.0)
    w, v = row.twist[:3], row.twist[3:]
    np.testing.assert_allclose(row.swing - v - np.cross(w, middle.value), middle.rate, atol=1e-5)


def test_rows_of_any_order_are_the_same():
    plan, times = WalkPlan(WALK, step=0.01), (5.0, 0.01, 2.57, 5.0, 9.99)
    for time in times:
        np.testing.assert_array_equal(plan.at(time).feet, WalkPlan(WALK, step=0.01).at(time).feet)


def test_torques_are_those_of_the_beginning_of_the_step():
    plan = WalkPlan(WALK, step=0.005, torques=lambda times: np.outer(times, np.arange(18.0)))
    np.testing.assert_allclose(plan.at(1.5).torques, 1.5 * np.arange(18.0), rtol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 1.0, 3.0])
def test_the_difference_of_two_poses_takes_one_to_the_other(angle):
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    R = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    S, p_S = WALK.body(3.0).value[:3, :3], np.array([0.1, 0.2, 0.3])
    planned = np.eye(4)
    planned[:3, :3], planned[:3, 3] = S @ R, p_S + S @ [0.01, 0.02, 0.03]
    np.testing.assert_allclose(
        difference(planned, S, p_S), [*(angle * axis), 0.01, 0.02, 0.03], atol=1e-12
    )
