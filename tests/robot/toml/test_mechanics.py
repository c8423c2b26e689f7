"""State targets, springs and limits that push back, as a robot's file says them."""

import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robots import pendulum
from drake_leg.robot.toml.reader import read_robot
from drake_leg.robot.toml.writer import robot_toml

ARM = """
name = "arm"
angles = "deg"
[[row]]
sigma = 0
d = 0
alpha = 0
r = 0
theta = 0
joint = "shoulder"
link = "upper_arm"
[row.solid]
shape = "sphere"
radius = 0.1
density = 1000
[row.mechanics]
spring_stiffness = 0.1
spring_unit = "N*m/deg"
position_target = 30
velocity_target = -90
velocity_priority = "low"
[row.limits]
lower = -20
upper = 70
lower_stop = {}
upper_stop = { stiffness = 5, spring_unit = "N*m/deg", damping = 2, transition_width = 0.5 }

[[row]]
sigma = 1
d = 0
alpha = 0
r = 0
theta = 0
joint = "slide"
link = "rod"
[row.solid]
shape = "sphere"
radius = 0.1
density = 1000
[row.limits]
upper = 0.1
upper_stop = { damping = 20 }
"""


def test_what_a_file_says_of_springs_targets_and_stops_is_read_in_si():
    shoulder, slide = (segment.mechanics for segment in read_robot(ARM, "arm.toml").segments)
    assert math.radians(1.0) * shoulder.spring_stiffness == pytest.approx(0.1)
    assert shoulder.position_target == StateTarget(value=math.radians(30.0), priority="high")
    assert shoulder.velocity_target == StateTarget(value=-math.radians(90.0), priority="low")
    assert shoulder.lower_stop == HardStop.rotational()
    stiffness = 5 * 180 / math.pi
    assert shoulder.upper_stop == HardStop(
        stiffness=stiffness, damping=2.0, transition_width=math.radians(0.5)
    )
    assert slide.upper_stop == HardStop.translational(damping=20.0)


def test_it_is_read_back_as_it_was():
    arm = read_robot(ARM, "arm.toml")
    assert read_robot(robot_toml(arm), "arm.toml") == arm


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"N*m/deg"\nposition', '"N*m"\nposition', 'spring_unit is "N*m"; it must be'),
        ("position_target = 30", "position_target = true", "position_target is true"),
        ('"low"', '"none"', 'velocity_priority is "none"; it must be "high" or "low"'),
        ("velocity_target = -90\n", "", "velocity_priority is 'low', but there is no"),
        ("spring_stiffness = 0.1\n", "", "but there is no spring_stiffness; give both"),
        ("stiffness = 5, ", "", "spring_unit is 'N*m/deg', but there is no stiffness; give both"),
        ("upper = 70\n", "", "the upper limit pushes back, but has no bound"),
        ("lower_stop = {}", "lower_stop = 5", "lower_stop is 5; it must be a table"),
        ("stiffness = 5,", "stiffness = 0,", "upper_stop: the limit's stiffness is 0.0"),
        ("damping = 2,", "damping = -2,", "damping is -2 N*m*s/rad; it must not be negative"),
        ("upper = 0.1", "max = 0.1", "there is no key 'max'; write upper"),
        ("position_target = 30", "home = 30", "there is no key 'home'; write position_target"),
        ("transition_width = 0.5", "width = 1", "there is no key 'width'; the keys are stiffness"),
        ("transition_width = 0.5", "transition_width = 0", "transition_width is 0 deg; it must be"),
    ],
)  # fmt: skip
def test_every_fault_is_one_sentence_with_file_key_and_value(old, new, said):
    assert ARM.count(old) == 1
    with pytest.raises(InvalidValueError) as raised:
        read_robot(ARM.replace(old, new), "arm.toml")
    assert str(raised.value).startswith("arm.toml")
    assert said in str(raised.value)


def test_a_spring_at_rest_somewhere_needs_a_stiffness():
    text = robot_toml(pendulum()).replace(
        "[row.mechanics]", "[row.mechanics]\nequilibrium_position = 20"
    )
    with pytest.raises(InvalidValueError) as caught:
        read_robot(text, "arm.toml")
    assert str(caught.value) == (
        "arm.toml: row 1, mechanics: equilibrium_position is 20 deg, but there is no "
        "spring_stiffness; give both"
    )
    soft = pendulum(mechanics=JointMechanics(equilibrium_position=0.5))
    assert read_robot(robot_toml(soft), "arm.toml") == soft
