"""Changes of gait and direction, from the option to what was walked."""

import math

import numpy as np
import pytest

from drake_leg.cli.entry import _build_parser
from drake_leg.cli.run_options import options_of
from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.kinematics.walking.gaits import Walk
from drake_leg.kinematics.walking.sequence import WalkSequence
from drake_leg.runs.catalogue import run_kind
from drake_leg.runs.named import run
from drake_leg.runs.walk_options import WalkOptions


def test_what_a_change_does_not_say_stays():
    options = WalkOptions(then="gait=wave speed=0.03 at=5; sideways=0.02 at=20; lift=0.05 at=30")
    first, wave, aside, higher = options.the_paces
    assert (first.gait.name, first.forward, first.period) == ("tripod", 0.1, 1.0)
    assert (wave.gait.name, wave.forward, wave.period) == ("wave", 0.03, 3.0)
    assert (aside.gait.name, aside.forward, aside.sideways) == ("wave", 0.0, 0.02)
    assert (higher.lift, higher.sideways) == (0.05, 0.02)
    assert options.the_duration == 35.0


def test_a_change_of_direction_does_not_stop_the_body():
    walk = WalkOptions(then="sideways=0.1 at=4").the_walk()
    assert isinstance(walk, Walk)
    times = np.linspace(3.0, 8.0, 200)
    speed = np.linalg.norm(walk.level(times).rate[:, :2, 3], axis=1)
    assert speed.min() > 0.07  # half of each velocity, in the middle of the ramps
    np.testing.assert_allclose(walk.level(7.0).rate[:3, 3], [0.0, 0.1, 0.0], atol=1e-12)


def test_another_gait_begins_where_the_robot_has_stopped():
    walk = WalkOptions(then="gait=ripple speed=0.05 at=4").the_walk()
    assert isinstance(walk, WalkSequence)
    second = walk.parts[1]
    assert second.begins >= 5.0
    assert walk.down(second.begins).all()
    assert not walk.level(second.begins).rate.any()


def test_a_robot_that_stands_changes_when_it_is_told_to():
    walk = WalkOptions(then="speed=0 at=3; gait=wave speed=0.03 at=12").the_walk()
    assert walk.parts[1].begins == 12.0
    assert WalkOptions(speed=0.0, then="speed=0.05 at=4").the_walk().commands[0].start == 4.0


def test_the_option_may_be_given_several_times():
    words = [
        "run",
        "hexapod",
        "--out",
        "x",
        "--then",
        "sideways=0.1 at=4",
        "--then",
        "speed=0,at=8",
    ]
    options = options_of(run_kind("hexapod"), _build_parser().parse_args(words))
    assert options.then == "sideways=0.1 at=4; speed=0,at=8"
    assert [pace.at for pace in options.the_paces[1:]] == [4.0, 8.0]


@pytest.mark.parametrize(
    ("then", "said"),
    [
        ("gait=wave", "and not when"),
        ("gait=walz at=3", "the gait 'walz'; the gaits are tripod"),
        ("gate=wave at=3", "says 'gate=wave'; each part"),
        ("at=3 speed", "says 'speed'; each part"),
        ("at=3 at=4", "says at twice"),
        ("speed=fast at=3", "has speed=fast; it must be a finite number"),
        (
            "speed=0.05 at=1",
            "a change at 1 s, and the one before it begins to move",
        ),
        ("gait=wave at=4; speed=0.05 at=5", "a change at 5 s, and the one before it"),
        ("gait=wave duty=2 at=4", "duty"),
        ("period=-1 at=4", "the period is -1"),
    ],
)
def test_a_change_that_makes_no_sense_is_refused(then, said):
    with pytest.raises(InvalidValueError, match=said):
        WalkOptions(then=then).the_walk()


@pytest.mark.slow
def test_each_part_is_foreseen():
    with pytest.raises(DrakeLegError, match=r"a speed of 0\.0.* is the greatest that works"):
        run("hexapod", then="gait=wave at=3", duration=12.0)


@pytest.mark.slow
def test_the_summary_is_that_of_the_whole_walk():
    """Forward, then to the left with another gait: both ways count, and both are walked."""
    then = "gait=ripple sideways=0.05 at=1.8"
    walked = run("hexapod", then=then, duration=6.0)
    summary, recording = walked.summary, walked.recording
    # 0.1 m/s from 1.225 to 1.8 s, and 0.05 m/s from the second part's start on, its ramp halved.
    starts = (
        WalkOptions(then="gait=ripple sideways=0.05 at=1.8").the_walk().parts[1].commands[0].start
    )
    x, y = 0.1 * (1.8 - 1.225), 0.05 * (6.0 - starts - 0.5)
    assert recording["planned_x"][-1] == pytest.approx(x, abs=1e-9)
    assert recording["planned_y"][-1] == pytest.approx(y, abs=1e-9)
    assert summary["commanded_distance_m"] == pytest.approx(x + y, rel=1e-3)
    assert abs(summary["distance_error_percent"]) < 0.3
    assert math.hypot(recording["x"][-1] - x, recording["y"][-1] - y) < 1e-3
    assert (summary["gait"], summary["changes"][0]["gait"]) == ("tripod", "ripple")
    assert summary["planned_static_margin_m"] > 0.07
    assert not summary["fell"]
