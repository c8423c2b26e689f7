"""Distances between the legs, as capsules around their links."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.walking.clearance import (
    capsules_of,
    gaps_between_legs,
    lowest,
    segment_distance,
)
from drake_leg.robot.hexapods import HEXABOT, Hip, hexapod
from drake_leg.robot.solids import Brick, Cylinder, Solid, Sphere


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
    # The balls of the feet are inside of the tibias' capsules.
    assert capsules.legs == tuple(leg for leg in range(6) for _ in range(3))
    assert capsules.names[:3] == tuple(f"left_front_{link}" for link in ("coxa", "femur", "tibia"))
    # A femur is 100 mm long; its corners are 12 and 15 mm from its axis.
    assert capsules.ends[1] == pytest.approx(np.array([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0)]))
    assert capsules.radii[1] == pytest.approx(np.hypot(0.012, 0.015))


def test_a_ball_that_is_larger_than_its_leg_has_a_capsule():
    segments = list(HEXABOT.segments)
    foot = segments[3]
    ball = replace(foot.link.solid, shape=Sphere(radius=0.03))
    segments[3] = replace(foot, link=replace(foot.link, solid=ball))
    capsules = capsules_of(replace(HEXABOT, segments=tuple(segments)))
    assert capsules.names[3] == "left_front_foot"
    assert capsules.radii[3] == 0.03
    assert len(capsules.names) == 19


def test_pairs_are_of_legs_that_follow_each_other_around_the_body():
    capsules = capsules_of(HEXABOT)
    legs = np.array(capsules.legs)[capsules.pairs]
    beside = {tuple(sorted(pair)) for pair in legs.tolist()}
    assert beside == {(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (2, 5)}
    assert len(capsules.pairs) == 6 * 3 * 3


def test_the_lowest_point_of_a_solid_is_that_of_its_corners_or_rims():
    random = np.random.default_rng(8)
    X = np.tile(np.eye(4), (20, 1, 1))
    X[:, :3, :3] = np.linalg.qr(random.normal(size=(20, 3, 3)))[0]
    X[:, :3, 3] = random.normal(size=(20, 3))
    c = np.array([0.1, -0.2, 0.05])

    def heights(points):
        return (X[:, :3, :3] @ (c + points).T)[:, 2].min(axis=-1) + X[:, 2, 3]

    def solid(shape):
        return Solid(shape=shape, density=1.0, centre=tuple(c), colour=(0.0, 0.0, 0.0))

    corners = np.array(list(product((-0.2, 0.2), (-0.1, 0.1), (-0.05, 0.05))))
    brick = solid(Brick(length=0.4, width=0.2, height=0.1))
    assert lowest(brick, X) == pytest.approx(heights(corners), abs=1e-15)
    angle = np.linspace(0.0, 2.0 * np.pi, 2001)
    rim = np.column_stack([0.3 * np.cos(angle), 0.3 * np.sin(angle), np.full(2001, 0.25)])
    rims = np.vstack([rim, rim * [1.0, 1.0, -1.0]])
    cylinder = solid(Cylinder(radius=0.3, length=0.5))
    assert lowest(cylinder, X) == pytest.approx(heights(rims), abs=1e-6)
    ball = solid(Sphere(radius=0.3))
    assert lowest(ball, X) == pytest.approx(heights(np.zeros((1, 3))) - 0.3, abs=1e-15)


def test_legs_that_are_stretched_side_by_side_are_as_far_apart_as_their_hips():
    robot = hexapod(hips={"one": Hip(0.05, 0.1, 0.0), "other": Hip(0.05, -0.1, 0.0)})
    capsules = capsules_of(robot)
    X_B = base_transforms(robot.rows, np.zeros((2, 6)))
    gaps = gaps_between_legs(capsules, X_B)
    assert gaps.shape == (2, 9)
    thick = 2.0 * np.hypot(0.012, 0.015)
    assert gaps.min(axis=1) == pytest.approx(0.2 - thick, abs=1e-15)
    # The legs turn towards each other until they cross.
    q = np.zeros(6)
    q[0], q[3] = -1.0, 1.0
    assert gaps_between_legs(capsules, base_transforms(robot.rows, q)).min() == (
        pytest.approx(-thick, abs=1e-12)
    )
