import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget

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
