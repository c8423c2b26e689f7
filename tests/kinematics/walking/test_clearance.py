"""Distances between the legs, as capsules around their links."""

import numpy as np
import pytest

from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.walking.clearance import (
    capsules_of,
    gaps_between_legs,
    segment_distance,
)
from drake_leg.robot.hexapods import HEXABOT, Hip, hexapod


def test_distances_of_segments_are_the_least_of_all_their_points():
    random = np.random.default_rng(1)
    first, second = random.uniform(-1.0, 1.0, (2, 40, 2, 3))
    second[30:] = second[30:, :1]  # a point
    first[20:30] = second[20:30] + random.uniform(-1.0, 1.0, (10, 1, 3))  # parallel
    share = np.linspace(0.0, 1.0, 101)

    def points(ends):
        return ends[:, :1] + share[:, np.newaxis] * (ends[:, 1:] - ends[:, :1])

    apart = np.linalg.norm(
        points(first)[:, :, np.newaxis] - points(second)[:, np.newaxis], axis=-1
    ).min(axis=(1, 2))
    found = segment_distance(first, second)
    assert (found <= apart + 1e-14).all()
    assert found == pytest.approx(apart, abs=2e-2)
    assert segment_distance(second, first) == pytest.approx(found, abs=1e-14)
    assert segment_distance(second[30:], second[30:]).tolist() == [0.0] * 10


def test_capsules_hold_the_solids_of_the_legs():
    capsules = capsules_of(HEXABOT)
    assert capsules.legs == tuple(leg for leg in range(6) for _ in range(4))
    assert capsules.names[:4] == tuple(
        f"left_front_{link}" for link in ("coxa", "femur", "tibia", "foot")
    )
    # A femur is 100 mm long; its corners are 12 and 15 mm from its axis.
    assert capsules.ends[1] == pytest.approx(np.array([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0)]))
    assert capsules.radii[1] == pytest.approx(np.hypot(0.012, 0.015))
    assert capsules.radii[3] == 0.006


def test_legs_that_are_stretched_side_by_side_are_as_far_apart_as_their_hips():
    robot = hexapod(hips={"one": Hip(0.05, 0.1, 0.0), "other": Hip(0.05, -0.1, 0.0)})
    capsules = capsules_of(robot)
    X_B = base_transforms(robot.rows, np.zeros((2, 6)))
    gaps = gaps_between_legs(capsules, X_B)
    assert gaps.distances.shape == (2, 16)
    thick = 2.0 * np.hypot(0.012, 0.015)
    assert gaps.distances.min(axis=1) == pytest.approx(0.2 - thick, abs=1e-15)
    one, other = gaps.pairs[gaps.distances[0].argmin()]
    assert capsules.legs[one] != capsules.legs[other]
    # The legs turn towards each other until they cross.
    q = np.zeros(6)
    q[0], q[3] = -1.0, 1.0
    assert gaps_between_legs(capsules, base_transforms(robot.rows, q)).distances.min() == (
        pytest.approx(-thick, abs=1e-12)
    )
