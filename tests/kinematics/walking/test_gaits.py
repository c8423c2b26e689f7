"""Gaits as mathematics: feet that stand still, swings that join, distances in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS, Gait
from drake_leg.kinematics.walking.gaits import OVER_PLACE, Attitude, Command, Walk, smoothstep

NEUTRAL = [
    (0.19, 0.15, -0.085), (0.0, 0.21, -0.085), (-0.19, 0.15, -0.085),
    (0.19, -0.15, -0.085), (0.0, -0.21, -0.085), (-0.19, -0.15, -0.085),
]  # fmt: skip
FORWARD = Command(forward=0.1, start=1.0, end=8.5)
TURNING = Command(forward=0.05, sideways=-0.03, turning=0.4, start=1.0, end=6.8, ramp=0.7)
LEANING = Attitude(roll=0.05, pitch=-0.08, yaw=0.1, shift=(0.01, -0.02, 0.03), start=1.0)
WALKS = {
    f"{gait} {name}": Walk(
        gait=GAITS[gait], period=1.3, neutral=NEUTRAL, commands=commands, attitudes=attitudes
    )
    for gait in GAITS
    for name, commands, attitudes in (
        ("forward", [FORWARD], []),
        ("arc, leaning", [TURNING], [LEANING]),
        ("one after the other", [replace(TURNING, end=3.4), replace(FORWARD, start=2.6)], []),
    )
}
each_walk = pytest.mark.parametrize("walk", WALKS.values(), ids=list(WALKS))


@pytest.mark.parametrize(("name", "fewest"), [("tripod", 3), ("ripple", 4), ("ripple-pairs", 4),
                                              ("wave", 5)])  # fmt: skip
def test_enough_feet_are_down_at_any_time(name, fewest):
    gait = GAITS[name]
    assert gait.fewest_down == fewest
    time = np.linspace(0.0, 1.0, 4001)[:, np.newaxis]
    down = (time - np.array(gait.phases)) % 1.0 < gait.duty
    assert down.sum(axis=1).min() == fewest


def test_the_first_ripple_is_one_leg_after_the_other():
    starts = sorted(GAITS["ripple"].phases)
    assert np.diff(starts) == pytest.approx([1 / 6] * 5)
    # Legs of one side follow by a third of a period, and the sides differ by half of one.
    left, right = GAITS["ripple"].phases[:3], GAITS["ripple"].phases[3:]
    assert (np.array(left) - np.array(right)) % 1.0 == pytest.approx([0.5] * 3)


@each_walk
def test_standing_feet_are_at_rest_in_the_world(walk):
    time = np.linspace(0.0, 12.0, 601)
    place, speed, acceleration = walk.feet_in_world(time)
    down = walk.down(time)
    assert np.abs(speed[down]).max() < 1e-15
    assert np.abs(acceleration[down]).max() < 1e-15
    assert down.sum(axis=1).min() >= walk.gait.fewest_down
    # Back through the body: where it sees its standing feet, they have not moved.
    X = walk.body(time).value
    seen = np.einsum("tij,tnj->tni", X[:, :3, :3], walk.feet(time).value) + X[:, np.newaxis, :3, 3]
    assert np.abs(seen - place).max() < 1e-15
    for leg in range(6):
        together = down[1:, leg] & down[:-1, leg]
        moved = np.abs(np.diff(place[:, leg], axis=0)).max(axis=1)[together]
        assert np.median(moved) == 0.0


@each_walk
def test_derivatives_are_those_of_the_paths(walk):
    time, step = np.linspace(0.05, 9.0, 101) + 1e-3, 1e-6
    for path in (walk.body, walk.feet, walk.feet_in_world):
        before, here, after = (path(time + shift) for shift in (-step, 0.0, step))
        rate = (after.value - before.value) / (2.0 * step)
        bend = (after.rate - before.rate) / (2.0 * step)
        assert np.abs(rate - here.rate).max() < 2e-8
        assert np.abs(bend - here.acceleration).max() < 2e-6


def test_a_walk_ends_where_its_command_says_with_its_feet_at_neutral():
    for name in ("tripod forward", "wave forward"):
        walk = WALKS[name]
        end = walk.body(30.0).value
        assert end[:3, 3] == pytest.approx([0.1 * 7.5, 0.0, 0.0], abs=1e-15)
        assert np.abs(walk.feet(30.0).value - NEUTRAL).max() < 1e-15
        assert walk.down(30.0).all()
        assert walk.down(0.0).all()


def test_a_turn_is_the_screw_of_its_twist():
    walk = WALKS["tripod arc, leaning"]
    turned = 0.4 * 5.8
    X = walk.level(20.0).value
    assert X[:2, :2] == pytest.approx(
        np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    )
    v = np.array([0.05, -0.03]) / 0.4
    expected = [math.sin(turned) * v[0] - (1 - math.cos(turned)) * v[1],
                (1 - math.cos(turned)) * v[0] + math.sin(turned) * v[1]]  # fmt: skip
    assert X[:2, 3] == pytest.approx(expected)


def test_an_attitude_ends_in_the_pose_that_it_names():
    walk = Walk(gait=GAITS["wave"], period=3.0, neutral=NEUTRAL, attitudes=[LEANING])
    X = walk.body(5.0).value
    assert X[:3, 3] == pytest.approx(LEANING.shift, abs=1e-15)
    angle = math.acos((np.trace(X[:3, :3]) - 1.0) / 2.0)
    assert angle == pytest.approx(math.hypot(0.05, 0.08, 0.1))
    assert np.abs(walk.feet_in_world(5.0).value - NEUTRAL).max() == 0.0


def test_a_swing_rises_as_high_as_asked():
    walk = replace(WALKS["tripod forward"], lift=0.04)
    time = np.linspace(3.0, 6.0, 3001)
    height = walk.feet_in_world(time).value[..., 2] + 0.085
    assert height.max() == pytest.approx(0.04, rel=1e-4)
    assert height.min() > -1e-15


@each_walk
def test_a_foot_comes_down_on_its_place_from_above(walk):
    time = np.linspace(2.0, 6.0, 2001)
    feet, speeds, _ = walk.feet_in_world(time)
    lands = walk.swung(time) > OVER_PLACE
    swings = lands & ~walk.down(time)
    assert swings.any()
    assert np.abs(speeds[swings][:, :2]).max() == 0.0
    assert (feet[swings][:, 2] > -0.085).all()
    assert (speeds[swings][:, 2] < 0.0).all()


def test_smoothstep_is_flat_at_both_ends():
    value, rate, bend = smoothstep(np.array([-1.0, 0.0, 0.5, 1.0, 2.0]))
    assert value.tolist() == [0.0, 0.0, 0.5, 1.0, 1.0]
    assert rate.tolist() == [0.0, 0.0, 1.875, 0.0, 0.0]
    assert bend.tolist() == [0.0] * 5


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Gait(name="x", phases=(1.2,), duty=0.5, source=""), "a phase of the gait 'x' is"),
        (lambda: Gait(name="x", phases=(0.2,), duty=1.0, source=""), "duty factor of the gait 'x'"),
        (lambda: Gait(name="x", phases=(), duty=0.5, source=""), "has no leg"),
        (lambda: Command(forward=math.nan), "the command's forward is nan"),
        (lambda: Command(start=2.0, end=1.0), "the command ends at 1.0 s and starts at 2.0 s"),
        (lambda: Walk(gait=GAITS["wave"], period=0.0, neutral=NEUTRAL), "the period is 0.0 s"),
        (lambda: Walk(gait=GAITS["wave"], period=1.0, neutral=NEUTRAL[:5]), "has 6 legs"),
        (lambda: replace(WALKS["wave forward"], period=2.0), "start it at 1.16667 s"),
        (lambda: Gait(name="x", phases=5, duty=0.5, source=""), "the phases of a gait is 5"),
        (lambda: Attitude(roll=math.tau), "turns the body by 6.28319 rad"),
        (lambda: Attitude(shift=(1, 2)), "shift is .1, 2.; it must be three finite numbers"),
        (lambda: Walk(gait=3, period=1.0, neutral=NEUTRAL), "the gait is 3"),
        (lambda: replace(WALKS["wave forward"], commands=[3]), "one of the commands of a walk is"),
        (lambda: WALKS["wave forward"].feet("x"), "the time is 'x'"),
        (lambda: Attitude(lasting=-1.0), "how long the attitude changes is -1.0 s"),
    ],
)
def test_wrong_numbers_are_refused(make, said):
    with pytest.raises(InvalidValueError, match=said):
        make()
