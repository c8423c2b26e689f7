"""A servo of one's own: written, read again, and every fault in one sentence."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.robot.servos import IDEAL, SERVOS, XL430
from drake_leg.robot.toml.servo import load_servo, read_servo, servo_toml

PLAIN = """
stall_torque = 1.5
no_load_speed = 59
speed_unit = "rpm"
stiffness = 5
"""
sizes = st.floats(1e-3, 1e3)


@pytest.mark.parametrize("servo", SERVOS.values(), ids=list(SERVOS))
def test_a_servo_is_read_back_as_it_was_written(servo, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(servo_toml(servo))
    assert load_servo(path) == load_servo(str(path)) == servo


@settings(max_examples=30)
@given(sizes, sizes, sizes, sizes, st.sampled_from([None, 0.1, 1 / 3]))
def test_whatever_its_numbers_are(torque, speed, stiffness, inertia, constant):
    servo = replace(
        IDEAL,
        stall_torque=torque,
        no_load_speed=speed,
        stiffness=stiffness,
        rotor_inertia=inertia,
        torque_constant=constant,
        resistance=constant,
        voltage=constant,
    )
    assert read_servo(servo_toml(servo), "x.toml") == servo


def test_the_manuals_speed_is_written_in_its_own_unit():
    assert "no_load_speed = 61 " in servo_toml(XL430)
    odd = replace(XL430, no_load_speed=math.pi)
    assert "no_load_speed = 30 " in servo_toml(odd)
    assert 'speed_unit = "rad/s"' in servo_toml(replace(XL430, no_load_speed=1 / 3))


def test_what_is_left_out_is_zero_or_not_known():
    servo = read_servo(PLAIN, "folder/ax.toml")
    assert (servo.name, servo.source) == ("ax", "ax.toml")
    assert servo.no_load_speed == pytest.approx(59 * 2 * math.pi / 60)
    assert (servo.damping, servo.rotor_inertia, servo.friction) == (0.0, 0.0, 0.0)
    assert (servo.torque_constant, servo.resistance, servo.voltage) == (None, None, None)
    unknown = replace(XL430, torque_constant=None, resistance=None, voltage=None)
    assert "voltage =" not in servo_toml(unknown)
    assert read_servo(servo_toml(unknown), "x.toml") == unknown


def test_a_gain_stands_for_the_stiffness():
    text = PLAIN.replace("stiffness = 5", "position_p_gain = 800")
    assert read_servo(text, "x.toml").stiffness == XL430.stiffness


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("stall_torque = 1.5", "", "x.toml: stall_torque is missing; it must be a number [N*m]"),
        ("stiffness = 5", "", "x.toml: stiffness is missing; it must be a number [N*m/rad]"),
        ("= 59", "= 0", "x.toml: no_load_speed is 0 rpm; it must be positive"),
        ("= 59", "= nan", "x.toml: no_load_speed is nan; it must be a finite number [rpm]"),
        ('"rpm"', '"rps"', 'x.toml: speed_unit is "rps"; it must be "rad/s" or "rpm"'),
        ("stiffness = 5", 'stiffness = "5"', 'stiffness is "5"; it must be a number [N*m/rad]'),
        ("stiffness = 5", "stifness = 5", "there is no key 'stifness'; did you mean 'stiffness'?"),
        ("stiffness = 5", "kp = 5", "there is no key 'kp'; write stiffness [N*m/rad], or position"),
        ("stiffness = 5", "stall_current = 1", "write torque_constant, the stall torque over the"),
        ("stiffness = 5", "stiffness = 5\nrow = 1", "this is the file of a robot, and not of a"),
        ("stiffness = 5", "stiffness = 5\nposition_p_gain = 8", "say the same; keep one"),
        ("stiffness = 5", "position_p_gain = 1e5", "x.toml: the gain is 100000; a DYNAMIXEL's"),
        ("stiffness = 5", "stiffness = 5\nresistance = 8", "has a resistance alone"),
        ("stiffness = 5", "stiffness = 5\nfriction = 2", "servo's friction is 2 N*m"),
        ("stiffness = 5", "stiffness = 5\ndamping = -1", "damping is -1 N*m*s/rad; it must not"),
        ("stiffness = 5", "stiffness = ", "x.toml, line 5: 'stiffness =' is not TOML"),
        ("stiffness = 5", "stiffness = " + 10_000 * "9", "x.toml is not TOML that can be read"),
    ],
)  # fmt: skip
def test_every_fault_is_said_in_one_sentence(old, new, words):
    with pytest.raises(InvalidValueError) as caught:
        read_servo(PLAIN.replace(old, new), "x.toml")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_no_file_or_no_servo_is_refused(tmp_path):
    with pytest.raises(InvalidValueError, match="cannot be read"):
        load_servo(tmp_path / "none.toml")
    with pytest.raises(InvalidValueError, match="the path of a servo's file is 3"):
        load_servo(3)
    with pytest.raises(InvalidValueError, match="the servo is 'xl430'; it must be a Servo"):
        servo_toml("xl430")
