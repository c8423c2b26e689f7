"""Rank, lost directions and manipulability, at postures where they are known."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space

from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.robot.toml_reader import load_robot
from drake_leg.singularity.rank import examine, examine_whole

ROBOTS = Path(__file__).parents[1] / "lab" / "grader" / "robots"

LEG = LegGeometry.from_robot(LEG_B)


def report_at(*degrees):
    return examine(foot_jacobian(LEG, np.radians(degrees)))


def test_a_regular_posture_loses_nothing(rng):
    for q in rng.uniform(-3.0, 3.0, (50, 3)):
        report = examine(foot_jacobian(LEG, q))
        assert report.rank == report.full_rank == 3
        assert report.lost_directions.shape == (0, 3)
        assert report.manipulability == pytest.approx(abs(determinant(LEG, q)), rel=1e-9)


def test_the_stretched_leg_loses_the_direction_along_itself():
    report = report_at(90.0, -50.0, 0.0)
    assert report.rank == 2
    along = [0.0, np.cos(np.radians(50.0)), -np.sin(np.radians(50.0))]
    np.testing.assert_allclose(report.lost_directions, [along], atol=1e-12)


def test_the_foot_on_the_hip_axis_loses_the_tangential_direction():
    report = report_at(0.0, 90.0, 30.0)
    assert report.rank == 2
    np.testing.assert_allclose(report.lost_directions, [[0.0, 1.0, 0.0]], atol=1e-12)


def test_where_both_families_meet_two_directions_are_lost():
    report = report_at(0.0, np.degrees(np.arccos(-0.25)), 0.0)
    assert report.rank == 1
    lost = report.lost_directions
    np.testing.assert_allclose(lost @ lost.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(
        lost @ foot_jacobian(LEG, [0.0, np.arccos(-0.25), 0.0]), 0.0, atol=1e-12
    )


def test_a_lost_direction_is_not_moved_in():
    for degrees in ((10.0, 20.0, 0.0), (70.0, -30.0, 180.0), (200.0, 90.0, 30.0)):
        J = foot_jacobian(LEG, np.radians(degrees))
        np.testing.assert_allclose(examine(J).lost_directions @ J, 0.0, atol=1e-12)


def test_a_jacobian_of_zeros_has_rank_zero():
    assert examine(np.zeros((3, 3))).rank == 0


def test_a_wrist_that_is_straight_loses_a_turn():
    rows = load_robot(ROBOTS / "puma560_modified.toml").rows
    whole = examine_whole(rows, np.zeros(6), 1.0)
    assert (whole.rank, whole.full_rank) == (5, 6)
    (lost,) = whole.lost
    np.testing.assert_allclose(lost.turning, [1.0, 0.0, 0.0], atol=1e-12)
    assert lost.moving is None
    regular = examine_whole(rows, np.radians([10, 20, 30, 40, 50, 60]), 1.0)
    assert (regular.rank, regular.lost) == (6, ())


def test_a_lost_twist_is_no_motion_that_the_joints_make(rng):
    rows = load_robot(ROBOTS / "puma560_modified.toml").rows
    for _ in range(10):
        q = rng.uniform(-2.0, 2.0, 6)
        q[4] = 0.0
        (lost,) = examine_whole(rows, q, 1.0).lost
        J = jacobian(rows, q)
        for axis, held, moved in ((lost.turning, 3, 0), (lost.moving, 0, 3)):
            if axis is not None:
                motions = J[moved : moved + 3] @ null_space(J[held : held + 3])
                assert np.abs(axis @ motions).max() < 1e-9


def test_a_table_that_never_has_more_loses_nothing():
    rows = [Row(joint="revolute", d=0.1) for _ in range(5)]
    whole = examine_whole(rows, [0.1, 0.5, 0.7, 0.2, 0.9], 0.5)
    assert (whole.rank, whole.full_rank, whole.lost) == (3, 5, ())


def test_a_stretched_scara_loses_its_direction():
    whole = examine_whole(SCARA.rows, [0.0, 0.0, 0.4, 0.0], 1.0)
    assert (whole.rank, whole.full_rank) == (3, 4)
    (lost,) = whole.lost
    np.testing.assert_allclose(lost.moving, [1.0, 0.0, 0.0], atol=1e-9)
