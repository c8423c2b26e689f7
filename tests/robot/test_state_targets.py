from dataclasses import replace

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.state_targets import initial_state


def leg(**mechanics):
    return replace(
        LEG_B,
        segments=tuple(
            replace(segment, mechanics=mechanics.get(segment.joint, segment.mechanics))
            for segment in LEG_B.segments
        ),
    )


def target(position=None, velocity=None, priority="high"):
    made = [
        None if value is None else StateTarget(value=value, priority=priority)
        for value in (position, velocity)
    ]
    return JointMechanics(position_target=made[0], velocity_target=made[1])


def test_every_target_of_a_chain_is_met_whatever_its_priority():
    robot = leg(knee=target(0.5, -2.0, "low"), ankle=target(velocity=3.0))
    state = initial_state(robot)
    assert state.q == (0.0, 0.5, 0.0)
    assert state.qdot == (0.0, -2.0, 3.0)
    assert state.unmet == ()


def test_a_motion_wins_over_a_target_of_low_priority_and_says_so():
    state = initial_state(leg(knee=target(0.5, 0.0, "low")), {"knee": (0.7, 1.0)})
    assert state.q == (0.0, 0.7, 0.0)
    assert state.qdot == (0.0, 1.0, 0.0)
    assert state.unmet == (
        "the position target of joint knee is 28.6478898 deg, but its motion starts at "
        "40.1070457 deg",
        "the velocity target of joint knee is 0 deg/s, but its motion starts at 57.2957795 deg/s",
    )


def test_a_motion_that_starts_at_the_target_meets_it():
    state = initial_state(leg(knee=target(0.5)), {"knee": (0.5 + 1e-12, 0.0)})
    assert state.unmet == ()


def test_a_target_of_high_priority_off_the_motion_is_refused():
    said = r"knee is 28.6\d+ deg, but its motion starts at 40.1\d+ deg: start the motion there"
    with pytest.raises(InvalidValueError, match=said):
        initial_state(leg(knee=target(0.5)), {"knee": (0.7, 0.0)})


def test_a_motion_of_no_joint_is_refused():
    with pytest.raises(InvalidValueError, match="leg_b has no joint 'wing'; its joints are hip"):
        initial_state(LEG_B, {"wing": (0.0, 0.0)})
