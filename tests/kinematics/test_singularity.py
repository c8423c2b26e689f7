"""Rank, lost directions and manipulability, at postures where they are known."""

import numpy as np
import pytest

from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian
from drake_leg.kinematics.singularity import examine
from drake_leg.robots import LEG_B

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
