"""Servos: the vendor's line, the stiffness of its firmware, and numbers that make no sense."""

import math
from dataclasses import fields, replace

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.servos import IDEAL, SERVOS, XL430, Servo


def test_the_line_ends_at_the_no_load_speed_of_the_manual():
    for servo in SERVOS.values():
        assert servo.no_load_speed == pytest.approx(61 * 2 * math.pi / 60)
        assert servo.stall_torque - servo.back_emf_damping * servo.no_load_speed == pytest.approx(0)


def test_stiffness_follows_from_the_firmwares_units():
    # At this error, gain 800 asks for all of the voltage, and so for the stall torque.
    counts = 885 * 128 / 800
    assert XL430.stiffness * counts * 2 * math.pi / 4096 == pytest.approx(XL430.stall_torque)
    assert XL430.stiffness == pytest.approx(6.9, abs=0.01)
    assert XL430.with_gain(800) == XL430
    assert XL430.with_gain(400) == replace(XL430, stiffness=XL430.stiffness / 2)
    # Half the torque at the same counts: the gain is one of voltage, not of torque.
    weak = replace(XL430, stall_torque=0.75).with_gain(800)
    assert weak.stiffness == pytest.approx(XL430.stiffness / 2)


def test_the_motor_takes_the_manuals_current_at_stall():
    for servo in SERVOS.values():
        assert servo.stall_torque / servo.torque_constant == pytest.approx(1.4)
        assert servo.voltage / servo.resistance == pytest.approx(1.4)


def test_the_ideal_servo_damps_its_rotor_at_least_critically():
    damping = IDEAL.damping + IDEAL.back_emf_damping
    assert damping > 2 * math.sqrt(IDEAL.stiffness * IDEAL.rotor_inertia)
    assert IDEAL.friction == 0.0


def test_friction_is_the_same_part_of_the_torque_as_the_xl330s():
    assert XL430.friction / XL430.stall_torque == pytest.approx(
        0.0128 / (0.387 * 5 / 4.017), rel=0.02
    )


def test_servos_are_found_by_name():
    assert SERVOS == {"ideal": IDEAL, "xl430": XL430}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"stall_torque": 0.0},
            "the servo's stall_torque is 0.0 N*m; it must be a positive number",
        ),
        (
            {"no_load_speed": math.inf},
            "the servo's no_load_speed is inf rad/s; it must be a positive",
        ),
        ({"stiffness": "stiff"}, "the servo's stiffness is 'stiff'; it must be a number"),
        ({"damping": -0.1}, "the servo's damping is -0.1 N*m*s/rad; it must be zero or positive"),
        ({"friction": 2.0}, "friction is 2 N*m and its stall_torque 1.5 N*m"),
        ({"torque_constant": None}, "the servo has a resistance alone"),
        ({"resistance": None}, "the servo has a torque_constant alone; give torque_constant and"),
        ({"voltage": math.nan}, "the servo's voltage is nan V"),
        ({"name": ""}, "the name of a servo is empty"),
        ({"name": 430}, "the name of a servo is 430; it must be a str"),
        ({"source": "a\nb"}, "must be printable text on one line"),
    ],
)
def test_wrong_numbers_are_refused(changes, words):
    with pytest.raises(InvalidValueError) as caught:
        replace(XL430, **changes)
    assert words in str(caught.value)


@pytest.mark.parametrize("gain", [0, -1, 16_384, math.nan, "high"])
def test_a_gain_that_the_firmware_does_not_take_is_refused(gain):
    with pytest.raises(InvalidValueError, match="the gain is"):
        XL430.with_gain(gain)


def test_what_is_not_known_is_none():
    bare = {f.name: getattr(XL430, f.name) for f in fields(Servo)}
    for name in ("torque_constant", "resistance", "voltage", "friction"):
        del bare[name]
    servo = Servo(**bare)
    assert (servo.torque_constant, servo.voltage, servo.friction) == (None, None, 0.0)
    assert not servo.is_electrical
    assert XL430.is_electrical
