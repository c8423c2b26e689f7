"""Walks one after the other are one smooth function of time, their stance feet fixed."""

from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.cycle_times import times_of
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Attitude, Command
from drake_leg.kinematics.walking.plan import WalkPlan, walk_of
from drake_leg.kinematics.walking.sequence import WalkSequence, following
from drake_leg.robot.hexapods import HEXABOT

TURNS = Command(forward=0.08, turning=0.3, start=0.8, end=2.6)
FIRST = walk_of(HEXABOT, commands=(TURNS,), attitudes=(Attitude(roll=0.05, lasting=0.5),))
STANDS = following(FIRST, GAITS["ripple"], period=1.5, lift=0.04)
SECOND = replace(
    STANDS, commands=(Command(sideways=0.05, start=STANDS.earliest_start, end=9.0, ramp=0.7),)
)
SEQUENCE = WalkSequence((FIRST, SECOND))
PARTS = ("level", "body", "feet", "feet_in_world")


@pytest.mark.parametrize("name", PARTS)
def test_a_change_has_no_jump_in_place_velocity_or_acceleration(name):
    """The body rests there: all derivatives are those of bodies and feet at rest."""
    h = 1e-9
    before, after = (getattr(SEQUENCE, name)(SECOND.begins + side) for side in (-h, h))
    for left, right in zip(before, after, strict=True):
        np.testing.assert_allclose(left, right, atol=1e-6)
    np.testing.assert_allclose(before.value, after.value, atol=1e-12)


def test_derivatives_are_those_of_the_path():
    times = np.linspace(0.1, 9.5, 400)
    h = 1e-6
    for name in ("body", "feet"):
        motion = getattr(SEQUENCE, name)
        ahead, behind = motion(times + h), motion(times - h)
        rate = (ahead.value - behind.value) / (2.0 * h)
        np.testing.assert_allclose(motion(times).rate, rate, atol=1e-5)


def test_feet_that_stand_stay_where_they_are():
    times = np.linspace(0.0, 9.5, 4000)
    down, feet = SEQUENCE.down(times), SEQUENCE.feet_in_world(times).value
    both = down[1:] & down[:-1]
    np.testing.assert_allclose(np.diff(feet, axis=0)[both], 0.0, atol=1e-12)
    assert down.sum(axis=1).min() >= 3
    assert not down.all(axis=1).all()


@pytest.mark.parametrize("gait", list(GAITS))
def test_all_feet_stand_below_a_body_that_rests_and_not_before(gait):
    start = walk_of(HEXABOT, GAITS[gait], period=2.0).earliest_start
    commands = (Command(forward=0.03, start=start, end=7.3, ramp=0.9),)
    walk = walk_of(HEXABOT, GAITS[gait], period=2.0, commands=commands)
    stands = walk.stands_from
    later = stands + np.linspace(1e-9, 5.0, 50)
    assert walk.down(later).all()
    neutral = np.array(walk.neutral)
    X = walk.level(stands).value
    expected = neutral @ X[:3, :3].T + X[:3, 3]
    np.testing.assert_allclose(walk.feet_in_world(stands).value, expected, atol=1e-12)
    assert stands >= 8.2
    assert stands == pytest.approx(8.2) or not walk.down(stands - 1e-6).all()


def test_a_walk_that_never_stops_stands_never():
    endless = replace(FIRST, commands=(replace(TURNS, end=np.inf),))
    assert endless.stands_from == np.inf
    assert replace(FIRST, commands=()).stands_from == pytest.approx(1.0, abs=1.0)
    with pytest.raises(InvalidValueError, match="never stops"):
        following(endless, GAITS["wave"], period=3.0, lift=0.03)


def test_a_walk_that_begins_elsewhere_and_later_is_the_same_walk_there():
    X = np.eye(4)
    X[:2, :2], X[:2, 3] = [[0.0, -1.0], [1.0, 0.0]], [0.3, -0.2]
    times, late = np.linspace(0.0, 5.0, 101), 7.25
    moved = replace(TURNS, start=TURNS.start + late, end=TURNS.end + late)
    standing = replace(FIRST, attitudes=FIRST.attitudes[:1])
    there = replace(standing, begins=late, place=X, commands=(moved,))
    here = standing.feet_in_world(times).value
    np.testing.assert_allclose(
        there.feet_in_world(times + late).value, here @ X[:3, :3].T + X[:3, 3], atol=1e-12
    )
    np.testing.assert_allclose(
        there.body(times + late).value, X @ standing.body(times).value, atol=1e-12
    )
    np.testing.assert_allclose(there.swung(times + late), standing.swung(times), atol=1e-9)
    np.testing.assert_allclose(times_of(there, 20.0), times_of(standing, 20.0 - late) + late)


def test_a_plan_of_a_sequence_has_the_rows_of_its_parts():
    plan, step = WalkPlan(SEQUENCE, step=0.005), 0.005
    for time, part in ((1.0, FIRST), (SECOND.begins + 1.0, SECOND)):
        expected, row = WalkPlan(part, step=step).at(time), plan.at(time)
        np.testing.assert_allclose(row.feet, expected.feet, atol=1e-12)
        np.testing.assert_allclose(row.swung, expected.swung, atol=1e-9)
    firm = SEQUENCE.firmness(np.array([SECOND.begins - 1e-6, SECOND.begins + 1e-6]), 0.05)
    np.testing.assert_allclose(firm, 1.0)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ((), "has no parts"),
        ((FIRST, replace(SECOND, begins=2.0, commands=())), "begins at 2 s, and the feet"),
        ((FIRST, replace(SECOND, place=np.eye(4))), "off the place where the one before stands"),
        ((FIRST, replace(SECOND, attitudes=FIRST.attitudes[:1])), "off the place"),
        ((FIRST, replace(SECOND, neutral=2.0 * np.array(FIRST.neutral))), "same neutral feet"),
    ],
)
def test_parts_that_do_not_join_are_refused(parts, said):
    with pytest.raises(InvalidValueError, match=said):
        WalkSequence(parts)


def test_a_place_is_a_pose():
    with pytest.raises(InvalidValueError, match="it must be a pose"):
        replace(FIRST, place=np.zeros(4))
