"""The reports' robots carry the reports' numbers."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import row_transform
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import (
    LEG_A,
    LEG_B,
    PENDULUM,
    ROBOTS,
    SCARA,
    hexabot_leg,
    pendulum,
    scara,
)
from drake_leg.robot.solids import Sphere

BAD_SIZES = (0.0, -0.1, math.nan, math.inf)

# The tables as printed and corrected: sigma, d [mm], alpha [deg], r [mm], theta [deg].
TABLES = {
    "leg_a": [(0, 0, 0, 0, 0), (0, 50, -90, 0, 0), (0, 100, 0, 0, 0), (None, 100, 0, 0, 0)],
    "leg_b": [(0, 0, 0, 0, 0), (0, 50, 90, 0, 0), (0, 100, 0, 0, 0), (None, 100, 0, 0, 0)],
    "scara": [(0, 0, 0, 452.4, 0), (0, 220, 0, 0, 0), (0, 240, 0, 0, 0), (1, 0, 180, 0, 0)],
    "pendulum": [(0, 0, -90, 0, 0), (None, 200, 0, 0, 0)],
}


def named(robot):
    return robot.name


def in_print(row):
    return (row.sigma, row.d * 1e3, math.degrees(row.alpha), row.r * 1e3, math.degrees(row.theta))


@pytest.mark.parametrize("robot", ROBOTS, ids=named)
def test_the_rows_are_the_reports_tables(robot):
    for row, printed in zip(robot.rows, TABLES[robot.name], strict=True):
        sigma, *numbers = in_print(row)
        assert sigma == printed[0]
        assert numbers == pytest.approx(printed[1:], abs=1e-12)


@pytest.mark.parametrize("robot", ROBOTS, ids=named)
def test_every_link_ends_where_the_next_one_begins(robot):
    linked = [segment for segment in robot.segments if segment.link]
    for segment, following in pairwise(linked):
        np.testing.assert_array_equal(segment.link.end, row_transform(following.row)[:3, 3])


@pytest.mark.parametrize("robot", ROBOTS, ids=named)
def test_names_of_links_and_joints_are_unique(robot):
    for names in (
        [segment.link.name for segment in robot.segments if segment.link],
        [segment.joint for segment in robot.segments if segment.joint],
    ):
        assert len(set(names)) == len(names)


def test_the_leg_has_report_bs_names():
    assert [s.link.name for s in LEG_B.segments] == ["coxa", "femur", "tibia", "foot"]
    assert [s.joint for s in LEG_B.moving] == ["hip", "knee", "ankle"]


def test_the_two_legs_differ_in_the_sense_of_the_knees_twist_alone():
    knee_a, knee_b = LEG_A.segments[1], LEG_B.segments[1]
    assert knee_a.row.alpha == -knee_b.row.alpha
    turned = replace(knee_a, row=replace(knee_a.row, alpha=-knee_a.row.alpha))
    assert (LEG_A.segments[0], turned, *LEG_A.segments[2:]) == LEG_B.segments


def test_the_pendulums_second_frame_is_at_the_centre_of_its_solid():
    assert PENDULUM.segments[0].link.solid.centre == (PENDULUM.rows[1].d, 0.0, 0.0)


def test_the_scaras_tool_hangs_from_the_arms_to_its_lowest_height():
    solid = SCARA.segments[3].link.solid
    assert solid.shape.length == pytest.approx(0.1124)
    assert solid.centre == (0.0, 0.0, -solid.shape.length / 2)


@pytest.mark.parametrize("variant", ["A", "B"])
def test_lengths_of_a_leg_reach_its_rows_and_its_solids(variant):
    leg = hexabot_leg(variant, l1=0.01, l2=0.02, l3=0.03)
    assert [row.d for row in leg.rows] == [0.0, 0.01, 0.02, 0.03]
    assert [s.link.solid.shape.length for s in leg.moving] == [0.01, 0.02, 0.03]


def test_lengths_of_a_scara_reach_its_rows_and_its_solids():
    arm = scara(l1=0.3, l2=0.1)
    assert [row.d for row in arm.rows] == [0.0, 0.3, 0.1, 0.0]
    assert [s.link.solid.shape.length for s in arm.segments[:2]] == [0.3, 0.1]


def test_density_and_damping_reach_every_solid_and_joint():
    for robot in (hexabot_leg("A", density=7.0, damping=0.5), scara(density=7.0, damping=0.5)):
        assert {s.link.solid.density for s in robot.segments if s.link.solid} == {7.0}
        assert {s.mechanics.damping for s in robot.moving} == {0.5}


def test_the_pendulum_takes_size_density_and_mechanics():
    mechanics = JointMechanics(damping=0.1, spring_stiffness=5.0, equilibrium_position=0.5)
    segment = pendulum(size=(0.4, 0.03, 0.02), density=8.0, mechanics=mechanics).segments[0]
    shape = segment.link.solid.shape
    assert (shape.length, shape.width, shape.height) == (0.4, 0.03, 0.02)
    assert segment.link.solid.density == 8.0
    assert segment.mechanics == mechanics


def test_the_foot_is_a_ball_and_the_pendulum_has_no_motor():
    assert isinstance(LEG_A.segments[3].link.solid.shape, Sphere)
    assert not PENDULUM.segments[0].mechanics.actuated
    assert all(s.mechanics.actuated for robot in (LEG_A, LEG_B, SCARA) for s in robot.moving)


@pytest.mark.parametrize("value", BAD_SIZES)
@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda **bad: hexabot_leg("A", **bad), "l1"),
        (lambda **bad: hexabot_leg("A", **bad), "l2"),
        (lambda **bad: hexabot_leg("B", **bad), "l3"),
        (lambda **bad: hexabot_leg("B", **bad), "density"),
        (scara, "l1"),
        (scara, "l2"),
        (scara, "density"),
        (pendulum, "density"),
    ],
)
def test_a_length_or_density_that_is_not_positive_is_refused(make, field, value):
    with pytest.raises(InvalidValueError, match=f"{field} is {value!r}"):
        make(**{field: value})


@pytest.mark.parametrize("value", [-0.01, math.nan])
@pytest.mark.parametrize("make", [lambda **bad: hexabot_leg("B", **bad), scara])
def test_negative_damping_is_refused(make, value):
    with pytest.raises(InvalidValueError, match=f"damping is {value!r}"):
        make(damping=value)


@pytest.mark.parametrize("value", BAD_SIZES)
@pytest.mark.parametrize(("place", "name"), [*enumerate(["length", "width", "height"])])
def test_a_pendulums_size_that_is_not_positive_is_refused(place, name, value):
    size = [0.3, 0.02, 0.01]
    size[place] = value
    with pytest.raises(InvalidValueError, match=f"{name} is {value!r}"):
        pendulum(size=tuple(size))


@pytest.mark.parametrize("variant", ["C", "a", ""])
def test_an_unknown_leg_is_refused(variant):
    with pytest.raises(InvalidValueError, match=f"{variant!r}; it must be 'A' or 'B'"):
        hexabot_leg(variant)
