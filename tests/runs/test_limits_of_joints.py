"""Runs of robots whose joints have limits that must not be crossed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError, JointLimitError
from drake_leg.kinematics.khalil import jacobian
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.toml.reader import read_robot
from drake_leg.runs.options import StraightOptions
from drake_leg.runs.step import run as run_robot
from drake_leg.singularity.inverse import MARGIN
from drake_leg.units import AT_LIMIT, beyond, in_words, joint_entries

Q0 = (90.0, -50.0, -90.0)
BACK = StraightOptions(q0=list(Q0), amplitude=-0.2, frequency=3.0, duration=0.6, inverse="limited")

SLIDING = """
name = "gantry"
angles = "deg"
"""
for alpha, theta, bounds in ((0, 0, "upper = 0.05"), (90, 90, "lower = 0"), (90, 0, "lower = 0")):
    SLIDING += f"""
[[row]]
sigma = 1
d = 0
alpha = {alpha}
r = 0
theta = {theta}
[row.solid]
shape = "sphere"
radius = 0.02
density = 1000
[row.limits]
{bounds}
"""


def limited(**limits):
    """Give joints of leg B limits in degrees, by name."""
    segments = [
        replace(segment, mechanics=JointMechanics(**limits.get(str(segment.joint), {})))
        for segment in LEG_B.moving
    ]
    return replace(LEG_B, segments=(*segments, *LEG_B.segments[3:]))


@pytest.mark.parametrize("inverse", ["exact", "limited"])
def test_a_joint_that_starts_at_its_limit_and_goes_inwards_is_not_stopped(inverse):
    away = replace(BACK, inverse=inverse, amplitude=0.1)
    free = run_robot(LEG_B, away).recording
    knee = free["q2"]
    side = "upper" if knee.min() < knee[0] - 1e-3 else "lower"
    outcome = run_robot(limited(knee={side: math.radians(Q0[1])}), away)
    assert outcome.summary["stop_reason"] is None
    assert outcome.summary["max_position_error_m"] < (1e-6 if inverse == "limited" else 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("room", [0.0, 1e-5, 0.05])
def test_a_joint_comes_to_its_limit_and_never_crosses_it(room):
    free = run_robot(LEG_B, replace(BACK, inverse="exact")).recording["q2"]
    upwards = free[-1] > free[0]
    bound = math.radians(Q0[1]) + (room if upwards else -room)
    robot = limited(knee={"upper" if upwards else "lower": bound})
    outcome = run_robot(robot, BACK)
    left = (bound - outcome.recording["q2"]) * (1.0 if upwards else -1.0)
    assert outcome.summary["stop_reason"] is None
    assert left.min() >= -1e-15
    assert left.min() < (MARGIN + 1e-9 if room < MARGIN else 2e-3)
    assert outcome.summary["greatest_distance_from_command_m"] > 1e-3


def test_the_exact_inverse_stops_and_speaks_degrees():
    robot = limited(knee={"lower": math.radians(-50.5), "upper": math.radians(-49.5)})
    reason = run_robot(robot, replace(BACK, inverse="exact")).summary["stop_reason"]
    assert reason.startswith("joint knee is at -")
    assert "outside its limits -50.5 ... -49.5 deg: choose another posture" in reason


@pytest.mark.slow
@pytest.mark.parametrize("lag", [pytest.param(0.001, marks=pytest.mark.slow), 0.05])
def test_joints_that_lag_behind_input_filters_do_not_cross_their_limit_either(lag):
    robot = limited(knee={"lower": math.radians(-52.0), "upper": math.radians(-48.0)})
    slow = replace(BACK, filter_time_constant=lag, max_step=min(0.01, lag), duration=0.6)
    outcome = run_robot(robot, slow)
    assert outcome.summary["stop_reason"] is None
    q = np.degrees(outcome.recording["q2"])
    assert q.min() > -52.0
    assert q.max() < -48.0


def test_a_push_over_a_limit_is_said_to_be_one():
    robot = limited(knee={"lower": math.radians(-50.01), "upper": math.radians(-49.99)})
    pushed = replace(BACK, amplitude=0.0, frequency=1.0, push=[0.0, 0.0, 5.0], push_at=0.1)
    reason = run_robot(robot, pushed).summary["stop_reason"]
    assert "joint knee is at" in reason
    assert reason.endswith("or a weaker disturbance")


def test_a_rate_limit_means_nothing_where_no_joint_turns():
    gantry = read_robot(SLIDING, "gantry.toml")
    options = StraightOptions(q0=[0.0, 0.0, 0.0], inverse="limited", rate_limit=10.0)
    with pytest.raises(InvalidValueError, match="none of these does: leave it out"):
        run_robot(gantry, options)


@pytest.mark.slow
def test_three_sliding_joints_step_stop_and_brake_in_metres():
    gantry = read_robot(SLIDING, "gantry.toml")
    outwards = jacobian(gantry.rows, [0.0, 0.0, 0.0])[3:] @ np.ones(3)  # every joint goes up
    options = StraightOptions(q0=[0.0, 0.0, 0.0], direction=outwards.tolist(), duration=1.0)
    outcome = run_robot(gantry, replace(options, frequency=3.0))
    assert outcome.summary["stop_reason"] is None
    assert outcome.summary["max_position_error_m"] < 1e-9
    assert outcome.summary["q0"] == [0.0, 0.0, 0.0]
    assert outcome.summary["q0_units"] == ["m", "m", "m"]
    assert "q0_deg" not in outcome.summary
    far = run_robot(gantry, replace(options, amplitude=0.3, frequency=3.0))
    assert " m at t = " in far.summary["stop_reason"]
    assert "limits -inf ... 0.05 m" in far.summary["stop_reason"]
    braked = run_robot(gantry, replace(options, amplitude=0.3, frequency=3.0, inverse="limited"))
    assert braked.summary["stop_reason"] is None
    assert braked.recording["q1"].max() < 0.05


def test_a_limit_is_no_hairs_breadth():
    assert beyond(-1.63e-21, 0.0, 1.0) == 0.0
    assert beyond(math.radians(120.0) + 1e-9, -1.0, math.radians(120.0)) == 0.0
    assert beyond(2.0 * AT_LIMIT + 1.0, 0.0, 1.0) == pytest.approx(2.0 * AT_LIMIT)
    assert beyond(-0.5, 0.0, math.inf) == -0.5
    assert beyond(1e6, -math.inf, math.inf) == 0.0


def test_positions_are_written_as_they_are_typed():
    assert in_words(math.radians(120.0), slides=False) == "120 deg"
    assert in_words(0.12, slides=True) == "0.12 m"
    angles = np.radians([90.0, -50.0]).tolist()
    assert joint_entries("q0", angles, [False, False]) == {"q0_deg": [90.0, -50.0]}
    mixed = joint_entries("q0", [angles[0], 0.1], [False, True])
    assert mixed == {"q0": [90.0, 0.1], "q0_units": ["deg", "m"]}


@pytest.mark.slow
def test_a_start_outside_the_limits_is_said_in_the_joints_unit():
    gantry = read_robot(SLIDING, "gantry.toml")
    with pytest.raises(JointLimitError, match=r"is at -0\.1 m .* limits 0 \.\.\. inf m"):
        run_robot(gantry, StraightOptions(q0=[0.0, 0.0, -0.1]))
