"""Runs in which a joint meets limits that push back."""

from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.joint_stop import limit_force
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import StraightOptions
from drake_leg.runs.pendulum_options import FreePendulumOptions, SpringPendulumOptions
from drake_leg.runs.step import run as run_robot

run_pendulum = RUNS["pendulum"].run

OPTIONS = StraightOptions(q0=[90.0, -50.0, -90.0], amplitude=0.07, duration=4.0)


def with_knee(**mechanics):
    hip, knee, *rest = LEG_B.segments
    made = replace(knee, mechanics=JointMechanics(**mechanics))
    return replace(LEG_B, segments=(hip, made, *rest))


@pytest.mark.slow
def test_a_falling_pendulum_is_caught_by_simscapes_stop_and_rests_in_it():
    summary = run_pendulum(FreePendulumOptions(duration=1.0, upper_limit=60.0)).summary
    assert summary["stop_reason"] is None
    assert summary["accuracy"] == 1e-9
    assert summary["energy_drift"] is None
    assert summary["max_angle_error_rad"] < 1e-7
    depth = np.degrees(summary["rest_angle_rad"]) - 60.0
    # m g L/2 cos(60 deg) = 0.03923 N*m against 1e4 N*m/deg x^3 (3 - 2 x/w) / w^2, w = 0.1 deg.
    assert depth == pytest.approx(0.0023684, abs=1e-6)
    assert summary["exact_rest_angle_rad"] == pytest.approx(summary["rest_angle_rad"], abs=1e-9)


@pytest.mark.slow
def test_a_soft_limit_lets_the_pendulum_bounce():
    options = FreePendulumOptions(
        duration=1.5, upper_limit=60.0, limit_stiffness=0.5, limit_damping=0.0, limit_width=0.5
    )
    outcome = run_pendulum(options)
    assert outcome.summary["max_angle_error_rad"] < 2e-6
    q = outcome.recording["q"]
    assert np.radians(60.5) < q.max() < np.radians(90.0)
    energy = outcome.recording["energy"]
    np.testing.assert_allclose(energy, energy[0], atol=1e-7)


def test_a_spring_may_be_said_in_simscapes_unit():
    stiffness = 5.0 * np.pi / 180.0
    per_degree = SpringPendulumOptions(
        duration=0.5, spring_stiffness=stiffness, spring_unit="N*m/deg"
    )
    per_radian = SpringPendulumOptions(duration=0.5)
    found, wanted = (run_pendulum(each).recording["q"] for each in (per_degree, per_radian))
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    with pytest.raises(InvalidValueError, match="spring unit is 'N/m'"):
        run_pendulum(SpringPendulumOptions(spring_unit="N/m"))


def test_a_velocity_target_is_where_the_speed_starts():
    outcome = run_pendulum(FreePendulumOptions(duration=1.0, velocity_target=-200.0))
    assert outcome.recording["qdot"][0] == pytest.approx(np.radians(-200.0))
    assert outcome.summary["max_angle_error_rad"] < 1e-9
    assert outcome.summary["energy_drift"] < 1e-9
    assert outcome.summary["exact_period_s"] is None


def test_a_motion_presses_a_joint_into_its_stop_with_the_torque_it_takes():
    stop = HardStop.rotational(0.02, 0.0, 1.0)
    robot = with_knee(upper=np.radians(-45.0), upper_stop=stop)
    outcome = run_robot(robot, OPTIONS)
    assert outcome.summary["stop_reason"] is None
    assert outcome.summary["max_position_error_m"] < 1e-9
    assert outcome.summary["max_torque_error_n_m"] < 1e-12
    free = run_robot(with_knee(), OPTIONS).recording
    q, qdot = outcome.recording["q2"], outcome.recording["qdot2"]
    push = limit_force(robot.segments[1].mechanics, q, qdot)
    assert push.min() < -0.01
    np.testing.assert_allclose(outcome.recording["tau2"], free["tau2"] - push, atol=1e-8)
    np.testing.assert_allclose(outcome.recording["tau3"], free["tau3"], atol=1e-8)


def targets(**priorities):
    return with_knee(position_target=StateTarget(value=np.radians(-50.0), **priorities))


def test_a_robot_without_q0_starts_at_its_state_targets():
    robot = replace(
        LEG_B,
        segments=tuple(
            replace(
                segment,
                mechanics=JointMechanics(position_target=StateTarget(value=np.radians(angle))),
            )
            if segment.joint in ("hip", "knee", "ankle")
            else segment
            for segment, angle in zip(LEG_B.segments, (90.0, -50.0, -90.0, 0.0), strict=True)
        ),
    )
    outcome = run_robot(robot, replace(OPTIONS, q0=None, duration=0.2))
    assert outcome.summary["q0_deg"] == [90.0, -50.0, -90.0]
    assert outcome.recording["q2"][0] == pytest.approx(np.radians(-50.0), abs=1e-15)


def test_a_target_of_high_priority_binds_the_motion_and_one_of_low_does_not():
    short = replace(OPTIONS, duration=0.2)
    assert run_robot(targets(), short).summary["stop_reason"] is None
    elsewhere = replace(short, q0=[90.0, -40.0, -90.0])
    assert run_robot(targets(priority="low"), elsewhere).summary["stop_reason"] is None
    with pytest.raises(InvalidValueError, match=r"position target of joint knee is -50 deg"):
        run_robot(targets(), elsewhere)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"upper_limit": float("nan")}, "upper_limit is nan"),
        ({"lower_limit": 10.0, "upper_limit": 5.0}, "the lower one must be less"),
        ({"upper_limit": 60.0, "limit_stiffness": 0.0}, "limit's stiffness is 0.0"),
        ({"upper_limit": 60.0, "limit_width": -1.0}, "limit's transition width is -0.017"),
        ({"velocity_target": float("inf")}, "velocity_target is inf"),
    ],
)
def test_senseless_limits_are_refused(changes, words):
    with pytest.raises(InvalidValueError, match=words):
        run_pendulum(FreePendulumOptions(**changes))
