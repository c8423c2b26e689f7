"""Inverse kinematics of any robot: what is found is where it was wanted, by the chain and Drake."""

from pathlib import Path

import numpy as np
import pytest
from chains import PLANAR_2

from drake_leg.kinematics.euler import euler_angles
from drake_leg.kinematics.feet import feet, limits_of, random_configurations, units_of
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.models.proof import DrakeWitness
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA

ROBOTS = Path(__file__).parents[1] / "lab" / "grader" / "robots"
SIX = ("puma560_modified", "puma560_classic", "puma560_classic_craig", "rx90")


def rpy_of(X_BF):
    return euler_angles("ZYX", X_BF[:3, :3])[::-1]


@pytest.mark.parametrize("name", SIX)
def test_all_eight_branches_of_a_wrist_of_six_are_found_and_are_drakes(name, rng):
    robot = load_robot(ROBOTS / f"{name}.toml")
    witness = DrakeWitness(robot)
    for q in random_configurations(robot, 3, rng):
        X_BF = foot_pose(robot.rows, q)
        found = feet(robot, X_BF[:3, 3], rpy=rpy_of(X_BF))
        assert len(found.solutions) == 8
        assert found.heading == "all 8 postures (Pieper's method: axes 4, 5 and 6 intersect)"
        for solution in found.solutions:
            np.testing.assert_allclose(witness.foot(np.array(solution.q)), X_BF, atol=1e-9)
            np.testing.assert_allclose(foot_pose(robot.rows, solution.q), X_BF, atol=1e-9)
        turns = np.array([np.subtract(s.q, q) for s in found.solutions]) / (2 * np.pi)
        assert np.abs(turns - np.round(turns)).max(axis=1).min() < 1e-6


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, SCARA], ids=lambda robot: robot.name)
def test_closed_forms_put_the_foot_there(robot, rng):
    for q in random_configurations(robot, 5, rng):
        q = q * 0.1
        goal = foot_pose(robot.rows, q)[:3, 3]
        yaw = float(q[:3].sum()) if robot is SCARA else None
        for solution in feet(robot, goal, yaw=yaw).solutions:
            if solution.q is not None:
                np.testing.assert_allclose(
                    foot_pose(robot.rows, solution.q)[:3, 3], goal, atol=1e-12
                )


@pytest.mark.slow
def test_six_joints_without_an_orientation_have_infinitely_many():
    robot = load_robot(ROBOTS / "rx90.toml")
    found = feet(robot, [0.3, 0.3, 0.5])
    assert found.heading.startswith("4 found of infinitely many: 6 joints")
    for solution in found.solutions:
        np.testing.assert_allclose(
            foot_pose(robot.rows, solution.q)[:3, 3], 3 * [0.3] + np.array([0, 0, 0.2]), atol=1e-9
        )


def test_what_is_out_of_reach_is_said_with_the_distance():
    found = feet(PENDULUM, [0.1, 0.0, 0.0])
    assert found.solutions == ()
    assert found.heading.startswith(
        "out of reach, by 0.1 m from the nearest posture that was found"
    )


def test_limits_are_told_and_units_are_the_joints():
    robot = load_robot(ROBOTS / "desk_arm.toml")
    q = [0.2, 0.4, 0.05]
    found = feet(robot, foot_pose(robot.rows, q)[:3, 3])
    assert [solution.within_limits for solution in found.solutions] == [True, False, False, False]
    np.testing.assert_allclose(found.solutions[0].q, q, atol=1e-9)
    assert found.units == units_of(robot) == ("deg", "deg", "m")
    assert limits_of(robot.moving)[2] == (0.0, 0.1)


@pytest.mark.slow
def test_a_stretched_arm_has_one_posture():
    found = feet(PLANAR_2, [0.5, 0.0, 0.0])
    assert len(found.solutions) == 1


def test_a_posture_may_be_an_array():
    given = feet(SCARA, [0.2, 0.2, 0.4], q=[0.5, 1.5, -2.0])
    assert feet(SCARA, [0.2, 0.2, 0.4], q=np.array([0.5, 1.5, -2.0])) == given
