import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian, foot_position
from drake_leg.robot.robots import hexabot_leg
from drake_leg.singularity.families import (
    axis_reach,
    folded_feet,
    hip_axis_arcs,
    leaning_over,
    stretched_feet,
)
from drake_leg.singularity.rank import examine

LEGS = [
    LegGeometry.from_robot(hexabot_leg(variant, **lengths))
    for variant in ("A", "B")
    for lengths in (
        {},
        {"l1": 0.02},
        {"l2": 0.06, "l3": 0.13},
        {"l1": 0.12, "l2": 0.1, "l3": 0.07},
        {"l1": 0.02, "l2": 0.15, "l3": 0.05},
    )
]
each_leg = pytest.mark.parametrize("leg", LEGS)


@each_leg
def test_on_its_arcs_the_foot_is_on_the_hip_axis_and_the_leg_singular(leg, rng):
    arcs = hip_axis_arcs(leg, 50)
    assert len(arcs) == 4
    for arc in arcs:
        q = np.column_stack([rng.uniform(-np.pi, np.pi, len(arc)), arc])
        np.testing.assert_allclose(foot_position(leg, q)[:, :2], 0.0, atol=2e-10)
        np.testing.assert_allclose(determinant(leg, q), 0.0, atol=1e-12)


@each_leg
def test_the_arcs_hold_every_posture_with_the_foot_on_the_hip_axis(leg):
    """On a fine grid the distance from the axis changes its sign only next to an arc."""
    angles = np.linspace(-np.pi, np.pi, 241)
    knee, ankle = np.meshgrid(angles, angles)
    rho = leg.l1 + leg.l2 * np.cos(knee) + leg.l3 * np.cos(knee + ankle)
    crossed = np.flatnonzero(np.diff(np.signbit(rho), axis=1))
    places = np.exp(1j * np.stack([knee[:, :-1].flat[crossed], ankle[:, :-1].flat[crossed]]))
    known = np.exp(1j * np.concatenate(hip_axis_arcs(leg, 2000)).T)
    step = 2.0 * (angles[1] - angles[0])
    for place in places.T[::7]:
        assert np.abs(known - place[:, np.newaxis]).max(axis=0).min() < step


def test_a_leg_too_short_to_reach_its_hip_axis_has_no_arcs():
    leg = LegGeometry.from_robot(hexabot_leg("B", l1=0.3))
    assert hip_axis_arcs(leg) == ()
    assert axis_reach(leg) == (0.0, 0.0)
    assert leaning_over(leg) == math.pi


def test_an_arc_takes_two_samples():
    with pytest.raises(InvalidValueError, match="1 samples"):
        hip_axis_arcs(LEGS[0], 1)


@each_leg
def test_stretched_feet_lie_on_a_torus(leg):
    feet = stretched_feet(leg, np.linspace(-3, 3, 20), np.linspace(-3, 3, 30))
    x, y, z = np.moveaxis(feet, -1, 0)
    squares = [(np.hypot(x, y) - side * leg.l1) ** 2 + z**2 for side in (1.0, -1.0)]
    off = np.abs(np.stack(squares) - (leg.l2 + leg.l3) ** 2).min(axis=0)
    np.testing.assert_allclose(off, 0.0, atol=1e-15)


@each_leg
def test_folded_feet_are_at_the_difference_of_femur_and_tibia_from_the_knee(leg):
    turns, lean = np.linspace(-3, 3, 20), np.array([0.0, 0.7, 2.0])
    feet = folded_feet(leg, turns, lean)
    knees = leg.l1 * np.stack([np.cos(turns), np.sin(turns), 0.0 * turns], axis=-1)
    away = np.linalg.norm(feet - knees + 0.0, axis=-1)
    np.testing.assert_allclose(away, abs(leg.l2 - leg.l3), atol=1e-15)


@each_leg
def test_where_both_families_meet_the_rank_is_one_and_the_axis_ends(leg):
    q = np.array([0.4, leaning_over(leg), 0.0])
    assert examine(foot_jacobian(leg, q)).rank == 1
    assert abs(foot_position(leg, q)[2]) == pytest.approx(axis_reach(leg)[1], rel=1e-12)


@each_leg
def test_the_foot_reaches_the_axis_between_both_ends_and_nowhere_else(leg):
    near, far = axis_reach(leg)
    heights = np.concatenate(
        [np.abs(foot_position(leg, np.column_stack([arc[:, 0] * 0, arc]))[:, 2])
         for arc in hip_axis_arcs(leg, 2000)]
    )  # fmt: skip
    assert far - 1e-6 < heights.max() < far + 1e-12
    assert near - 1e-12 < heights.min() < near + 2e-4
