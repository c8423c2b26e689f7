import math
from dataclasses import replace

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget, initial_state
from drake_leg.robot.robots import LEG_B

DEGREE = math.pi / 180.0


def test_simscapes_settings_of_a_revolute_joint_become_si():
    mechanics = JointMechanics.rotational(
        equilibrium_position=30.0,
        spring_stiffness=0.1,
        damping_coefficient=0.002,
        position_target=-45.0,
        position_priority="low",
        velocity_target=90.0,
        lower=-90.0,
        upper=120.0,
        upper_stop=HardStop.rotational(5.0, 0.1, 2.0),
        actuated=False,
    )
    assert mechanics.equilibrium_position == pytest.approx(math.pi / 6)
    # A turn of one degree takes 0.1 N*m, one degree a second 0.002 N*m.
    assert mechanics.spring_stiffness * DEGREE == pytest.approx(0.1)
    assert mechanics.damping * DEGREE == pytest.approx(0.002)
    assert mechanics.position_target == StateTarget(value=-math.pi / 4, priority="low")
    assert mechanics.velocity_target == StateTarget(value=math.pi / 2, priority="high")
    assert (mechanics.lower, mechanics.upper) == pytest.approx((-math.pi / 2, 2 * math.pi / 3))
    assert mechanics.lower_stop == HardStop.rotational()
    assert mechanics.upper_stop.stiffness * DEGREE == pytest.approx(5.0)
    assert mechanics.upper_stop.damping * DEGREE == pytest.approx(0.1)
    assert mechanics.upper_stop.transition_width == pytest.approx(2.0 * DEGREE)
    assert not mechanics.actuated


def test_by_default_nothing_acts_and_nothing_is_aimed_at():
    assert JointMechanics.rotational() == JointMechanics()
    assert JointMechanics().stops == ()


def test_stops_have_simscapes_values_by_default():
    turning, sliding = HardStop.rotational(), HardStop.translational()
    assert turning.stiffness * DEGREE == pytest.approx(1e4)
    assert turning.damping * DEGREE == pytest.approx(10.0)
    assert turning.transition_width == pytest.approx(0.1 * DEGREE)
    assert (sliding.stiffness, sliding.damping, sliding.transition_width) == (1e6, 1e3, 1e-4)


def test_a_limit_without_a_stop_does_not_push_back():
    stop = HardStop.rotational()
    mechanics = JointMechanics(lower=-1.0, upper=2.0, upper_stop=stop)
    assert mechanics.stops == ((1, 2.0, stop),)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: HardStop.rotational(stiffness=0.0), "limit's stiffness is 0.0"),
        (lambda: HardStop.rotational(damping=-1.0), "limit's damping is -"),
        (lambda: HardStop.rotational(transition_width=0.0), "transition width is 0.0 rad"),
        (lambda: HardStop.translational(stiffness=math.nan), "limit's stiffness is nan"),
        (lambda: StateTarget(value=math.inf), "state target is inf; it must be a finite angle"),
        (lambda: StateTarget(value=0.0, priority="none"), "is 'none'; it must be high or low"),
        (
            lambda: JointMechanics(lower_stop=HardStop.rotational()),
            "lower limit pushes back, but has no bound",
        ),
    ],
)
def test_senseless_mechanics_are_refused_in_words(make, words):
    with pytest.raises(InvalidValueError, match=words):
        make()


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


def test_a_rotor_has_a_motor():
    with pytest.raises(InvalidValueError, match=r"rotor's inertia is 0.1 .* not actuated"):
        JointMechanics(rotor_inertia=0.1, actuated=False)
