import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.servos import IDEAL, XL430
from drake_leg.runs.walk_options import BESIDE, WalkOptions


def test_the_defaults_walk_forward():
    options = WalkOptions()
    assert options.the_robot is HEXABOT
    assert (options.the_speed, options.the_duration, options.the_period) == (0.1, 10.0, 1.0)
    assert options.the_servo is IDEAL
    X = options.the_walk().body(10.0).value
    assert X[0, 3] == pytest.approx(0.1 * (10.0 - options.starts - 0.5))


@pytest.mark.parametrize(
    ("gait", "period"), [("tripod", 1.0), ("ripple", 1.5), ("ripple-pairs", 1.5), ("wave", 3.0)]
)
def test_a_swing_lasts_about_half_a_second(gait, period):
    assert WalkOptions(gait=gait).the_period == period


def test_a_walk_to_the_side_does_not_go_forward():
    assert WalkOptions(sideways=0.1).the_speed == 0.0
    assert WalkOptions(turn=10.0).the_speed == 0.0
    assert WalkOptions(turn=10.0, speed=0.05).the_speed == 0.05


@pytest.mark.parametrize(
    "given", [{"sideways": 0.1}, {"turn": 20.0, "angle": 90.0}, {"then": "speed=0 at=7"}]
)
def test_what_follows_from_other_options_follows_from_changed_ones(given):
    # As the command line and a sweep change them: in options that are made already.
    made, changed = WalkOptions(**given), replace(WalkOptions(), **given)
    assert changed == made
    assert changed.the_speed == made.the_speed
    assert changed.the_duration == made.the_duration


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"then": "speed=0 at=7", "duration": 5.0}, "change begins at 7 s, and the run is over"),
        ({"push_speed": 0.5, "duration": 2.0}, "push begins at 3 s, and the run is over at 2 s"),
    ],
)
def test_what_would_come_after_the_end_is_refused(given, said):
    with pytest.raises(InvalidValueError, match=said):
        WalkOptions(**given)


def test_a_distance_is_walked_exactly():
    options = WalkOptions(distance=0.3, sideways=0.1)
    X = options.the_walk().body(options.the_duration).value
    np.testing.assert_allclose(X[:2, 3], [0.0, 0.3], atol=1e-14)


def test_an_angle_is_turned_exactly():
    options = WalkOptions(angle=90.0, turn=-20.0)
    X = options.the_walk().body(options.the_duration).value
    np.testing.assert_allclose(X[:2, :2], [[0.0, 1.0], [-1.0, 0.0]], atol=1e-14)


def test_effort_keeps_the_slope_of_the_motor():
    servo = WalkOptions(effort=0.4, servo="xl430", gain=640).the_servo
    assert servo.stall_torque == 0.4
    assert servo.back_emf_damping == pytest.approx(XL430.back_emf_damping)
    assert servo.stiffness == pytest.approx(0.8 * XL430.stiffness)


def test_a_push_changes_the_speed_of_the_robot():
    push = WalkOptions(push_speed=0.5, push_direction=0.0, payload=1.0).the_push
    mass = 2.1616 + 1.0
    np.testing.assert_allclose(push.impulse, [0.5 * mass, 0.0, 0.0], atol=1e-12)
    assert WalkOptions().the_push is None


def test_the_ground_is_that_of_the_options():
    ground = WalkOptions(
        slope=10.0, across=-5.0, friction=0.3, steps=0.02, step_count=2.0, blocks=0.01
    ).the_ground
    assert (ground.slope, ground.across) == (math.radians(10.0), math.radians(-5.0))
    assert (ground.steps.height, ground.steps.count, ground.blocks.height) == (0.02, 2, 0.01)


@pytest.mark.parametrize(("name", "other"), BESIDE.items())
def test_an_option_that_means_nothing_alone_is_refused(name, other):
    with pytest.raises(InvalidValueError, match=f"`{name}` means nothing without `{other}`"):
        WalkOptions(**{name: 1.0})


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"gait": "trot"}, "there is no gait 'trot'"),
        ({"gait": "own", "duty": 0.5}, "an own gait needs `phases` and `duty`"),
        ({"phases": [0.0]}, "the gait tripod has phases of its own"),
        ({"gait": "own", "duty": 0.6, "phases": [0.0, 0.5]}, "has 2 legs|2 legs"),
        ({"robot": "spider"}, "there is no robot 'spider'"),
        ({"servo": "mx-64"}, "there is no servo 'mx-64'"),
        ({"effort": -1.0}, "the effort is -1"),
        ({"friction": -0.1}, "the friction of the ground is -0.1"),
        ({"distance": 1.0, "speed": 0.0}, "the distance is 1 and the speed is 0"),
        ({"distance": 1.0, "angle": 90.0, "turn": 10.0}, "not both"),
        ({"shift": [0.01]}, "it must be two numbers"),
        ({"steps": 0.02, "step_count": 1.5}, "step_count is 1.5; it must be a whole number"),
        ({"period": 0.0}, "the period is 0"),
    ],
)
def test_what_makes_no_sense_is_refused(options, said):
    def asked():
        chosen = WalkOptions(**options)
        return chosen.the_servo, chosen.the_ground, chosen.the_walk()

    with pytest.raises(InvalidValueError, match=said):
        asked()
