"""Strokes: the closed forms against a walk along the line with the inverse kinematics."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_position, inverse_kinematics
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.kinematics.scara import determinant as scara_determinant
from drake_leg.kinematics.scara import inverse_kinematics as scara_inverse
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA, hexabot_leg
from drake_leg.singularity.families import LegFamilies, ScaraFamilies
from drake_leg.singularity.stroke import (
    closed_stroke,
    greatest_amplitude,
)

DEFAULT = np.radians([90.0, -50.0, -90.0])


def random_posture(rng):
    while True:
        q = rng.uniform(-np.pi, np.pi, 3)
        if abs(np.sin(q[2])) > 0.1:
            return q


def random_direction(rng):
    d = rng.normal(size=3)
    return d / np.linalg.norm(d)


def grazes(leg, p, d):
    """Whether the line is nearly tangent to the boundary that it meets at p."""
    h = np.hypot(p[0], p[1])
    for u in (h - leg.l1, h + leg.l1):
        normal = np.array([u * p[0] / h, u * p[1] / h, p[2]]) / np.hypot(u, p[2])
        if abs(normal @ d) < 1e-3:
            return True
    return False


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, hexabot_leg("B", l2=0.13, l3=0.06)])
def test_just_before_its_end_a_stroke_is_in_reach_and_just_beyond_it_is_not(rng, robot):
    leg = LegGeometry.from_robot(robot)
    for _ in range(100):
        q, d = random_posture(rng), random_direction(rng)
        stroke = closed_stroke(LegFamilies(leg), q, d)
        assert stroke.family == "stretch"  # a random line misses the hip axis
        p = foot_position(leg, q)
        if grazes(leg, p + stroke.length * d, d):
            continue
        ways = stroke.length * np.array([0.25, 0.5, 0.75, 1 - 1e-9, 1 + 1e-9])
        reached = np.isfinite(inverse_kinematics(leg, p + np.outer(ways, d), like=q)).all(axis=1)
        assert reached.tolist() == [True, True, True, True, False]


def test_at_the_end_of_a_stroke_the_determinant_is_zero(rng):
    leg = LegGeometry.from_robot(LEG_B)
    for _ in range(100):
        q, d = random_posture(rng), random_direction(rng)
        p = foot_position(leg, q) + (1 - 1e-12) * closed_stroke(LegFamilies(leg), q, d).length * d
        end = inverse_kinematics(leg, p, like=q)
        assert abs(determinant(leg, end)) < 1e-4 * leg.l2 * leg.l3 * (leg.l1 + leg.l2 + leg.l3)


def test_the_default_posture_has_the_reports_room_along_x():
    leg = LegGeometry.from_robot(LEG_B)
    stroke = closed_stroke(LegFamilies(leg), DEFAULT, [1.0, 0.0, 0.0])
    x0, y0, z0 = foot_position(leg, DEFAULT)
    boundary = math.sqrt((leg.l1 + math.sqrt((leg.l2 + leg.l3) ** 2 - z0**2)) ** 2 - y0**2) - x0
    assert stroke.length == pytest.approx(boundary, abs=1e-14)
    assert greatest_amplitude(stroke, 1.0) == pytest.approx(0.09411, abs=1e-5)
    assert greatest_amplitude(stroke, 2.0) == pytest.approx(stroke.length, abs=1e-15)


def test_a_line_through_the_hip_axis_meets_it():
    leg = LegGeometry.from_robot(LEG_B)
    stroke = closed_stroke(LegFamilies(leg), DEFAULT, [0.0, -1.0, 0.0])
    assert stroke.family == "hip-axis"
    assert stroke.length == pytest.approx(foot_position(leg, DEFAULT)[1], abs=1e-14)


@pytest.mark.parametrize("length", [1e-3, 1.0, 1e3])
def test_the_length_of_the_direction_does_not_matter(length):
    leg = LegGeometry.from_robot(LEG_B)
    one = closed_stroke(LegFamilies(leg), DEFAULT, [0.6, 0.0, 0.8])
    assert closed_stroke(
        LegFamilies(leg), DEFAULT, [0.6 * length, 0.0, 0.8 * length]
    ).length == pytest.approx(one.length, rel=1e-14)


def test_a_direction_that_is_zero_is_refused():
    with pytest.raises(InvalidValueError, match="direction is zero"):
        closed_stroke(LegFamilies(LegGeometry.from_robot(LEG_B)), DEFAULT, [0.0, 0.0, 0.0])


def test_a_scaras_stroke_ends_where_the_arm_is_flat(rng):
    arm = ScaraGeometry.from_robot(SCARA)
    for _ in range(100):
        q = rng.uniform(-3.0, 3.0, 3)
        angle = rng.uniform(-np.pi, np.pi)
        d = np.array([np.cos(angle), np.sin(angle), 0.0])
        stroke = closed_stroke(ScaraFamilies(arm), q, d)
        x = arm.l1 * np.cos(q[0]) + arm.l2 * np.cos(q[0] + q[1])
        y = arm.l1 * np.sin(q[0]) + arm.l2 * np.sin(q[0] + q[1])
        task = np.array([x, y, q.sum()]) + (1 - 1e-12) * stroke.length * d
        end = scara_inverse(arm, task, like=q)
        assert abs(scara_determinant(arm, end)) < 1e-4 * arm.l1 * arm.l2
        beyond = np.array([x, y, q.sum()]) + (1 + 1e-9) * stroke.length * d
        assert np.isnan(scara_inverse(arm, beyond, like=q)).all()


def test_a_scaras_stroke_is_horizontal():
    with pytest.raises(InvalidValueError, match="horizontal"):
        closed_stroke(
            ScaraFamilies(ScaraGeometry.from_robot(SCARA)), [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]
        )
