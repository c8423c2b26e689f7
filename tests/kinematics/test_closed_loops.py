"""Closed loops: passive joints, rates and accelerations, against closed forms and differences."""

import math
from dataclasses import replace

import numpy as np
import pytest
from trees import parallelogram, two_fingers

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.kinematics.khalil import base_transforms, principal
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.linkages import (
    BENNETT,
    BENNETT_SHORT,
    BENNETT_TWIST,
    COUPLER,
    CRANK,
    FIVE_BAR,
    FOUR_BAR,
    GROUND,
    LINKAGES,
    PARALLELOGRAM_ARM,
    ROCKER,
    SLIDER_CRANK,
    SLIDER_CRANK_CUT_AT_SLIDE,
)

RNG = np.random.default_rng(14)
every_linkage = pytest.mark.parametrize("robot", LINKAGES, ids=lambda robot: robot.name)


def moving_somehow(robot):
    """A closed posture of a robot, with random rates and accelerations of its active joints."""
    loops = ClosedLoops(robot)
    q = loops.position([s.mechanics.position_target.value for s in active_of(loops)])
    return loops, q, *RNG.normal(size=(2, len(loops.active)))


def active_of(loops):
    return [loops.robot.moving[column] for column in loops.active_columns]


@pytest.mark.parametrize(
    ("robot", "freedom", "rank"),
    [
        (FOUR_BAR, 1, 2),
        (SLIDER_CRANK, 1, 2),
        (SLIDER_CRANK_CUT_AT_SLIDE, 1, 2),
        (FIVE_BAR, 2, 2),
        (BENNETT, 1, 2),
        (PARALLELOGRAM_ARM, 6, 2),
    ],
)
def test_redundant_equations_are_counted_by_their_rank(robot, freedom, rank):
    loops = ClosedLoops(robot)
    assert (loops.freedom, loops.rank) == (freedom, rank)
    assert len(loops.active) == freedom


def test_the_arm_has_the_frames_of_khalil():
    loops = ClosedLoops(PARALLELOGRAM_ARM)
    assert len(PARALLELOGRAM_ARM.rows) == loops.frames == 2 * 9 - 8


@every_linkage
def test_loops_close_to_rounding(robot):
    loops, q, _, _ = moving_somehow(robot)
    assert loops.closure(q) <= 1e-12


@every_linkage
def test_rates_and_accelerations_are_derivatives(robot):
    loops, q, qdot_a, qddot_a = moving_somehow(robot)
    qdot = loops.W(q) @ qdot_a
    qddot = loops.W(q) @ qddot_a + loops.bias(q, qdot)
    h = 1e-4  # [s]
    start = q[loops.active_columns]
    before, after = (loops.position(start + qdot_a * t + 0.5 * qddot_a * t * t, q) for t in (-h, h))
    assert np.abs((after - before) / (2 * h) - qdot).max() < 1e-6
    assert np.abs((after - 2 * q + before) / h**2 - qddot).max() < 1e-5
    cut = [loops.cut_motion(each).position for each in (before, q, after)]
    motion = loops.cut_motion(q, qdot, qddot)
    assert np.abs((cut[2] - cut[0]) / (2 * h) - motion.velocity).max() < 1e-6
    assert np.abs((cut[2] - 2 * cut[1] + cut[0]) / h**2 - motion.acceleration).max() < 1e-5


@every_linkage
def test_the_cut_joint_at_its_position_joins_both_frames(robot):
    loops, q, _, _ = moving_somehow(robot)
    X_B = base_transforms(robot.rows, q)
    for loop, position in zip(robot.loops, loops.cut_motion(q).position, strict=True):
        turned = np.eye(4)
        if robot.segments[loop.cut - 1].row.joint == "revolute":
            c, s = math.cos(position), math.sin(position)
            turned[:2, :2] = [[c, -s], [s, c]]
        else:
            turned[2, 3] = position
        assert np.abs(X_B[loop.cut - 1] @ turned - X_B[loop.end - 1]).max() < 1e-14


def test_a_four_bar_obeys_freudenstein():
    loops = ClosedLoops(FOUR_BAR)
    k1, k2 = GROUND / CRANK, GROUND / ROCKER
    k3 = (CRANK**2 - COUPLER**2 + ROCKER**2 + GROUND**2) / (2 * CRANK * ROCKER)
    for crank in np.linspace(-3, 3, 7):
        rocker = loops.position([crank])[2]
        left = k1 * math.cos(rocker) - k2 * math.cos(crank) + k3
        assert left == pytest.approx(math.cos(crank - rocker), abs=1e-13)


def test_both_cuts_of_a_slider_crank_are_one_mechanism():
    at_pin, at_slide = ClosedLoops(SLIDER_CRANK), ClosedLoops(SLIDER_CRANK_CUT_AT_SLIDE)
    for crank in np.linspace(0.3, 2.8, 5):
        x = CRANK * math.cos(crank) + math.sqrt(COUPLER**2 - (CRANK * math.sin(crank)) ** 2)
        rate = (
            -CRANK * math.sin(crank) * (1 + CRANK * math.cos(crank) / (x - CRANK * math.cos(crank)))
        )
        q, p = at_pin.position([crank]), at_slide.position([crank])
        assert q[2] == pytest.approx(x, abs=1e-14)
        assert at_slide.cut_motion(p).position == pytest.approx(x, abs=1e-14)
        assert at_pin.W(q)[2, 0] == pytest.approx(rate, abs=1e-13)
        moved = at_slide.cut_motion(p, at_slide.W(p)[:, 0])
        assert moved.velocity == pytest.approx(rate, abs=1e-13)


def test_a_bennett_linkage_obeys_its_half_angle_relation():
    loops = ClosedLoops(BENNETT)
    short = math.asin(BENNETT_SHORT / 0.2 * math.sin(BENNETT_TWIST))
    ratio = math.sin((BENNETT_TWIST + short) / 2) / math.sin((BENNETT_TWIST - short) / 2)
    for first in (0.4, 1.0, 2.0):
        q = loops.position([first])
        assert abs(math.tan(q[0] / 2) * math.tan(q[1] / 2)) == pytest.approx(ratio, rel=1e-9)
        assert math.cos(q[2]) == pytest.approx(math.cos(q[0]), abs=1e-13)  # opposite angles


def test_the_parallelogram_of_the_arm_obeys_khalil():
    loops = ClosedLoops(PARALLELOGRAM_ARM)
    q = loops.position([0.3, -1.2, 0.5, 0.1, 0.2, -0.7])
    th2, th3, th7, th8 = q[1], q[2], q[6], q[7]
    (th9,) = loops.cut_motion(q).position
    for found, exact in (
        (th3, math.pi / 2 + th7 - th2),
        (th8, th2 - th7),
        (th9, th7 - th2 - math.pi),
    ):
        assert principal(np.array(found - exact)) == pytest.approx(0.0, abs=1e-13)
    W = loops.W(q)
    rates = dict(zip(loops.active, W[2], strict=True))
    assert rates.pop("joint2") == pytest.approx(-1, abs=1e-13)
    assert rates.pop("joint7") == pytest.approx(1, abs=1e-13)
    assert max(map(abs, rates.values())) < 1e-13
    assert loops.bias(q, W @ RNG.normal(size=6)) == pytest.approx(np.zeros(8), abs=1e-12)


def test_an_assembly_is_kept_along_a_motion():
    loops = ClosedLoops(FOUR_BAR)
    turn = np.linspace(1.0, 1.0 + math.tau, 25)[:, np.newaxis]  # steps of 15 deg
    q = loops.follow(turn)
    assert loops.closure(q).max() <= 1e-12
    assert loops.distance(q[-1], q[0]) < 1e-12  # after one turn of the crank
    assert np.sign(np.sin(q[:, 1] + q[:, 0] - q[:, 2])).tolist() == [-1.0] * 25


def test_a_motion_that_meets_a_singular_assembly_is_refused():
    loops = ClosedLoops(FOUR_BAR, active=["rocker"])
    with pytest.raises(SingularConfigurationError, match=r"four_bar.*rocker at 1\d\d.*determine"):
        loops.follow(np.linspace(1.7, 3.0, 10)[:, np.newaxis])


def test_rates_are_refused_in_a_singular_assembly():
    loops = ClosedLoops(parallelogram(), active=["crank"])
    with pytest.raises(SingularConfigurationError, match="do not determine the passive"):
        loops.W([0.0, 0.0, 0.0])
    with pytest.raises(SingularConfigurationError, match="do not determine the passive"):
        loops.W([0.0, 2e-7, 3e-7])  # closed to rounding, as the flat one is


def test_active_joints_are_as_many_as_degrees_of_freedom():
    with pytest.raises(InvalidValueError, match=r"1 degree of freedom.*3 \(crank, pin, pivot\)"):
        ClosedLoops(parallelogram())
    with pytest.raises(InvalidValueError, match=r"2 degrees.*1 \(left\) is active"):
        ClosedLoops(FIVE_BAR, active=["left"])
    six = ["joint2", "joint3", "joint4", "joint5", "joint6", "joint7"]
    with pytest.raises(InvalidValueError, match=r"do not determine the posture of.*joint1, joint8"):
        ClosedLoops(PARALLELOGRAM_ARM, active=six)
    with pytest.raises(InvalidValueError, match="'knee' is no joint"):
        ClosedLoops(FOUR_BAR, active=["knee"])


def test_loops_that_never_close_are_refused():
    segments = list(FOUR_BAR.segments)
    segments[4] = replace(segments[4], row=replace(segments[4].row, d=0.9))
    with pytest.raises(InvalidValueError, match=r"do not close.*errors of 0\.\d+ or more"):
        ClosedLoops(replace(FOUR_BAR, segments=tuple(segments)))


def test_what_has_no_loop_or_does_not_close_is_refused():
    with pytest.raises(InvalidValueError, match="no closed loop"):
        ClosedLoops(two_fingers())
    with pytest.raises(InvalidValueError, match=r"left at 171\.887 deg, right at 11\.4592 deg"):
        ClosedLoops(FIVE_BAR).position([3.0, 0.2])
    with pytest.raises(InvalidValueError, match="one row of 1"):
        ClosedLoops(FOUR_BAR).follow([1.0])


def test_a_cut_joint_has_no_spring():
    segments = list(FOUR_BAR.segments)
    segments[3] = replace(segments[3], mechanics=JointMechanics(damping=0.1))
    with pytest.raises(InvalidValueError, match=r"'pin'.*damping, friction, a rotor or a spring"):
        ClosedLoops(replace(FOUR_BAR, segments=tuple(segments)))
