"""The commanded motion of the straight step and of the ellipse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import UP, EllipticStep, SineStep

TIME = np.linspace(0.0, 20.0, 401)
STEP = {"amplitude": 0.070, "frequency": 1.0, "direction": (1.0, 0.0, 0.0)}
OBLIQUE = {"amplitude": 0.3, "frequency": 2.5, "direction": (0.6, -0.8, 0.0)}

each_motion = pytest.mark.parametrize(
    "motion",
    [SineStep(**OBLIQUE), EllipticStep(**OBLIQUE, lift=0.04)],
    ids=["straight", "elliptic"],
)


@each_motion
def test_velocity_is_the_derivative_of_displacement(motion, derivative):
    rate = derivative(lambda shift: motion.displacement(TIME + shift))
    np.testing.assert_allclose(motion.velocity(TIME), rate, rtol=0, atol=1e-11)


@each_motion
def test_acceleration_is_the_derivative_of_velocity(motion, derivative):
    rate = derivative(lambda shift: motion.velocity(TIME + shift))
    np.testing.assert_allclose(motion.acceleration(TIME), rate, rtol=0, atol=1e-10)


@each_motion
def test_the_motion_begins_where_it_is_and_returns_there_every_period(motion):
    ends = np.arange(5) * motion.period
    velocity = motion.velocity(ends)
    np.testing.assert_allclose(motion.displacement(ends), 0.0, atol=1e-14)
    np.testing.assert_allclose(velocity, np.tile(velocity[0], (5, 1)), atol=1e-14)


@each_motion
def test_the_sine_waves_are_the_velocity(motion):
    waves = [(motion.wave, motion.direction)]
    if not motion.is_straight:
        waves.append((motion.rise, UP))
    velocity = sum(
        np.outer(wave.amplitude * np.sin(wave.frequency * TIME + wave.phase), way)
        for wave, way in waves
    )
    np.testing.assert_allclose(velocity, motion.velocity(TIME), atol=1e-15)


@each_motion
def test_nothing_moves_across_the_motion(motion):
    np.testing.assert_allclose(motion.displacement(TIME) @ motion.across, 0.0, atol=1e-15)


@each_motion
def test_no_speed_along_one_of_its_waves_is_greater_than_the_greatest(motion):
    along = np.abs(motion.velocity(TIME) @ np.array(motion.direction)).max()
    up = np.abs(motion.velocity(TIME) @ UP).max()
    assert max(along, up) == pytest.approx(motion.greatest_speed, rel=1e-2)


def test_the_way_and_the_time_are_those_of_the_displacement():
    step = SineStep(**OBLIQUE)
    for time in (0.1, 0.5, 1.2):
        way = step.displacement([time])[0] @ step.heading
        assert step.way(time) == pytest.approx(way, rel=1e-12)
        assert step.time(way) == pytest.approx(time, rel=1e-9)


@pytest.mark.parametrize(
    ("motion", "change", "message"),
    [
        (SineStep, {"amplitude": math.nan}, "the amplitude is nan; it must be a finite number"),
        (SineStep, {"frequency": 0.0}, "the frequency is 0.0 rad/s"),
        (SineStep, {"direction": (1.0, 1.0, 0.0)}, "must have length 1"),
        (EllipticStep, {"lift": math.inf}, "the lift is inf; it must be a finite number"),
        (EllipticStep, {"direction": (0.6, 0.0, 0.8)}, "must be horizontal"),
    ],
)
def test_a_motion_that_makes_no_sense_is_refused(motion, change, message):
    with pytest.raises(InvalidValueError, match=message):
        motion(**change)


def test_the_reports_step_is_a_line_of_140_mm_to_one_side():
    step = SineStep(**STEP)
    displacement, velocity = step.displacement(TIME), step.velocity(TIME)
    np.testing.assert_array_equal(displacement[:, 1:], 0.0)
    np.testing.assert_array_equal(velocity[:, 1:], 0.0)
    assert displacement.min() == 0.0
    assert step.displacement([math.pi])[0, 0] == pytest.approx(0.140)
    np.testing.assert_allclose(velocity[:, 0], 0.070 * np.sin(TIME), atol=1e-16)


@given(st.floats(1e-3, 10.0), st.floats(0.1, 50.0), st.floats(0.0, 6.28))
def test_the_straight_step_stays_on_a_line_of_length_two_a_over_w(amplitude, frequency, heading):
    direction = np.array([math.cos(heading), math.sin(heading), 0.0])
    motion = SineStep(amplitude=amplitude, frequency=frequency, direction=tuple(direction.tolist()))
    displacement = motion.displacement(TIME)
    along = displacement @ direction
    longest = 2 * amplitude / frequency
    assert (along >= -1e-15).all()
    assert (along <= longest * (1 + 1e-12)).all()
    across = displacement - np.outer(along, direction)
    np.testing.assert_allclose(across, 0.0, atol=1e-14 * longest)


def test_the_ellipse_is_an_ellipse_that_begins_at_its_rear_end():
    lift, direction = 0.04, np.array(OBLIQUE["direction"])
    motion = EllipticStep(**OBLIQUE, lift=lift)
    displacement = motion.displacement(TIME)
    half = OBLIQUE["amplitude"] / OBLIQUE["frequency"]
    along, up = displacement @ direction, displacement @ UP
    np.testing.assert_allclose(((along - half) / half) ** 2 + (2 * up / lift) ** 2, 1.0, atol=1e-12)
    np.testing.assert_allclose(
        motion.velocity(TIME)[0], lift / 2 * OBLIQUE["frequency"] * UP, atol=1e-16
    )


def test_an_ellipse_without_lift_is_the_straight_step():
    flat, straight = EllipticStep(**STEP, lift=0.0), SineStep(**STEP)
    np.testing.assert_array_equal(flat.displacement(TIME), straight.displacement(TIME))
    np.testing.assert_array_equal(flat.velocity(TIME), straight.velocity(TIME))


def test_a_direction_has_three_components():
    with pytest.raises(InvalidValueError, match="three finite numbers"):
        SineStep(direction=(1.0, 0.0))
