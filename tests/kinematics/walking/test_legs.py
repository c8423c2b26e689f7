"""Legs in closed form, against the chains of the tree's own table."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import base_transforms, jacobian
from drake_leg.kinematics.walking.gait import GAITS, LEGS
from drake_leg.kinematics.walking.gaits import Attitude, Command, Motion, Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.robot.hexapods import HEXABOT, Hip, hexapod
from drake_leg.robot.joint_mechanics import JointMechanics, starting_posture
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_B


def with_rows(robot, **changes):
    """The robot with other numbers in the rows of every leg's hip, knee, ankle and foot."""
    segments = list(robot.segments)
    for index, segment in enumerate(segments):
        change = changes.get(("hip", "knee", "ankle", "foot")[index % 4])
        if change:
            segments[index] = replace(segment, row=replace(segment.row, **change))
    return replace(robot, segments=tuple(segments))


FIVE = hexapod(
    name="five",
    lengths=(0.03, 0.08, 0.11),
    hips={f"leg{i}": Hip(0.1 * math.cos(i), 0.07 * math.sin(i), 1.3 * i) for i in range(5)},
)
ROBOTS = {
    "hexabot": HEXABOT,
    "knees turned the other way": with_rows(HEXABOT, knee={"alpha": -math.pi / 2}),
    "ankles turned the other way": with_rows(HEXABOT, ankle={"alpha": math.pi}),
    "hips upside down": with_rows(HEXABOT, hip={"alpha": math.pi}),
    "offsets": with_rows(
        HEXABOT,
        hip={"b": 0.02},
        knee={"theta": 0.2, "r": 0.01},
        ankle={"theta": -0.9, "r": -0.004},
        foot={"theta": 0.3, "r": -0.006, "d": 0.13},
    ),
    "five legs": FIVE,
}
each_robot = pytest.mark.parametrize("robot", ROBOTS.values(), ids=list(ROBOTS))


STANDING = (0.0, 0.6, -1.7)  # [rad], of the legs' own angles


def postures(legs, rows=40):
    """Random joint angles with the knees up and the feet in front of the hips."""
    own = np.random.default_rng(3).uniform(
        (-3.0, -0.9, -2.6), (3.0, 0.9, -0.1), (rows, legs.count, 3)
    )
    own[..., 0] = 0.4 * own[..., 0] + legs.offsets[:, 0]
    reaches = legs.lengths[:, 0] + legs.lengths[:, 1] * np.cos(own[..., 1])
    reaches += legs.lengths[:, 2] * np.cos(own[..., 1] + own[..., 2])
    own[..., 1] += np.where(reaches < 0.01, 1.0, 0.0)
    return legs.signs * (own - legs.offsets)


@each_robot
def test_feet_are_where_the_chain_of_the_table_puts_them(robot):
    legs = Legs.of(robot)
    q = postures(legs)
    X_B = base_transforms(robot.rows, q.reshape(len(q), -1))
    tips = [row - 1 for row in robot.tips.values()]
    assert legs.feet(q) == pytest.approx(X_B[:, tips][..., :3, 3], abs=1e-15)
    # The leg's line has the table's knees and ankles, up to a shift along their axes.
    line = legs.joints_and_feet(q)
    for number in (1, 2):
        rows = [robot.path(row + 1)[number] - 1 for row in tips]
        axis, origin = X_B[:, rows][..., :3, 2], X_B[:, rows][..., :3, 3]
        apart = origin - line[..., number, :]
        along = (apart * axis).sum(axis=-1, keepdims=True)
        assert np.abs(apart - along * axis).max() < 1e-15


@each_robot
def test_jacobians_are_those_of_the_chain(robot):
    legs = Legs.of(robot)
    q = postures(legs, rows=7)
    J = legs.jacobians(q)
    for number, tip in enumerate(robot.tips):
        own = robot.at_tip(tip, q=np.zeros(len(robot.moving)))
        expected = jacobian(own.rows, q[:, number])[:, 3:]
        assert J[:, number] == pytest.approx(expected, abs=1e-15)
    assert legs.sigma_mins(q) == pytest.approx(
        np.linalg.svd(J, compute_uv=False)[..., -1], abs=1e-15
    )


@each_robot
def test_joints_and_feet_make_a_round_trip(robot):
    legs = Legs.of(robot)
    q = postures(legs)
    found = legs.joints(legs.feet(q))
    assert legs.feet(found) == pytest.approx(legs.feet(q), abs=1e-14)
    assert np.abs(np.sin((found - q) / 2.0)).max() < 1e-12
    # The knee is above the line from hip to foot.
    assert (np.sin(legs.offsets[:, 2] + legs.signs[:, 2] * found[..., 2]) < 0.0).all()


@each_robot
def test_rates_and_accelerations_are_the_derivatives_of_the_angles(robot):
    legs = Legs.of(robot)
    time = np.linspace(-0.8, 0.8, 7)
    w = np.random.default_rng(5).uniform(-1.0, 1.0, (2, legs.count, 3)) * 0.012
    near = legs.feet(legs.signs * (STANDING - legs.offsets + [[1.0, 0.0, 0.0]]))

    def feet(t):
        s, c = np.sin(t)[..., None, None], np.cos(t)[..., None, None]
        return Motion(near + w[0] * s + w[1] * c, w[0] * c - w[1] * s, -w[0] * s - w[1] * c)

    q, qdot, qddot = legs.motion(feet(time))
    assert np.isfinite(q).all()
    h = 1e-3
    ahead, behind, two_ahead, two_behind = (
        legs.joints(feet(time + k * h).value) for k in (1, -1, 2, -2)
    )
    rates = (8.0 * (ahead - behind) - (two_ahead - two_behind)) / (12.0 * h)
    assert qdot == pytest.approx(rates, abs=1e-9)
    bends = (16.0 * (ahead + behind) - (two_ahead + two_behind) - 30.0 * q) / (12.0 * h**2)
    assert qddot == pytest.approx(bends, abs=1e-6)
    J = legs.jacobians(q)
    assert np.einsum("...ij,...j->...i", J, qdot) == pytest.approx(feet(time).rate, abs=1e-14)


def test_a_walk_of_the_whole_robot_is_in_its_joints():
    legs = Legs.of(HEXABOT)
    assert legs.names == LEGS
    assert legs.joint_names[3] == ("right_front_hip", "right_front_knee", "right_front_ankle")
    start = np.array(starting_posture(HEXABOT)).reshape(6, 3)
    walk = Walk(
        gait=GAITS["tripod"],
        period=1.0,
        neutral=legs.feet(start),
        commands=[Command(forward=0.1, turning=0.2, start=1.0)],
        attitudes=[Attitude(roll=0.05, shift=(0.0, 0.0, 0.01), start=1.0)],
    )
    time = np.linspace(0.0, 6.0, 500)
    q, _, _ = legs.motion(walk.feet(time))
    assert q[0] == pytest.approx(start, abs=1e-14)
    assert legs.feet(q) == pytest.approx(walk.feet(time).value, abs=1e-15)
    X_B = base_transforms(HEXABOT.rows, q.reshape(500, 18))
    X_WB = walk.body(time).value[:, np.newaxis]
    feet = (X_WB @ X_B)[:, 3::4, :3, 3]
    assert feet == pytest.approx(walk.feet_in_world(time).value, abs=1e-12)


def test_out_of_reach_is_not_a_number_and_touches_no_other_leg():
    legs = Legs.of(HEXABOT)
    feet = legs.feet(np.tile([0.0, 0.5, -1.5], (6, 1)))
    feet[2] += (-0.3, 0.0, 0.0)
    q, qdot, qddot = legs.motion(Motion(feet, np.ones_like(feet), np.zeros_like(feet)))
    for found in (q, qdot, qddot):
        assert np.isnan(found[2]).any()
        assert np.isfinite(np.delete(found, 2, axis=0)).all()


def test_limits_are_those_of_the_joints_and_choose_the_turn():
    free = Legs.of(HEXABOT)
    assert np.isinf(free.limits).all()
    limits = JointMechanics(lower=5.5, upper=7.0)
    segments = [
        one if one.row.joint == "fixed" else replace(one, mechanics=limits)
        for one in HEXABOT.segments
    ]
    bounded = Legs.of(replace(HEXABOT, segments=tuple(segments)))
    assert bounded.limits[4, 1].tolist() == [5.5, 7.0]
    feet = free.feet(np.tile([0.1, 0.2, -0.4], (6, 1)))
    assert bounded.joints(feet) == pytest.approx(free.joints(feet) + math.tau, abs=1e-14)


def test_what_is_no_leg_is_refused_with_its_joint():
    for robot, words in (
        (LEG_B, "base of 'leg_b' is fixed; .* `floating=True`"),
        (with_rows(HEXABOT, hip={"alpha": 0.1}), "hip, 'left_front_hip', must be parallel"),
        (with_rows(HEXABOT, knee={"alpha": 1.5}), "knee, 'left_front_knee', must be horizontal"),
        (with_rows(HEXABOT, ankle={"alpha": 0.1}), "'left_front_ankle', must be parallel to that"),
        (with_rows(HEXABOT, knee={"d": 0.0}), "distance between hip and knee"),
        (with_rows(HEXABOT, foot={"d": 0.0}), "distance between ankle and foot"),
        (with_rows(HEXABOT, ankle={"r": 0.005}), "foot is 5 mm beside the plane"),
        (replace(HEXABOT, segments=HEXABOT.segments[:2]), "moved by 2 joints"),
    ):
        with pytest.raises(InvalidValueError, match=words):
            Legs.of(robot)
    sliding = list(HEXABOT.segments)
    sliding[2] = replace(sliding[2], row=Row(joint="prismatic", d=0.1))
    with pytest.raises(InvalidValueError, match=r"moved by 3 joints \(revolute, revolute, prism"):
        Legs.of(replace(HEXABOT, segments=tuple(sliding)))
    with pytest.raises(InvalidValueError, match="'hexabot' is not a Robot"):
        Legs.of("hexabot")
    with pytest.raises(InvalidValueError, match=r"shape \(5, 3\); 'hexabot' has 6 legs"):
        Legs.of(HEXABOT).joints(np.zeros((5, 3)))


def test_joints_that_legs_share_or_mix_are_refused():
    shared = list(HEXABOT.segments[:4])
    foot = shared[3]
    shared.append(
        replace(
            foot,
            row=replace(foot.row, antecedent=3),
            joint="second_weld",
            link=replace(foot.link, name="second_foot"),
        )
    )
    with pytest.raises(InvalidValueError, match="do not come leg by leg"):
        Legs.of(replace(HEXABOT, segments=tuple(shared)))


def test_forces_on_the_feet_cause_the_torques_that_are_given():
    legs = Legs.of(HEXABOT)
    q = np.tile([0.2, 0.4, -1.2], (6, 1)) + np.linspace(0.0, 0.3, 18).reshape(6, 3)
    f = np.linspace(-2.0, 9.0, 18).reshape(6, 3)
    torques = np.einsum("nij,ni->nj", legs.jacobians(q), f)
    np.testing.assert_allclose(legs.forces(q, torques), f, atol=1e-12)
