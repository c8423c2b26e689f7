"""The commanded motion of the straight step and of the ellipse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.kinematics.paths import UP, elliptic_path, straight_path

TIME = np.linspace(0.0, 20.0, 401)
STEP = {"amplitude": 0.070, "frequency": 1.0, "direction": [1.0, 0.0, 0.0]}
OBLIQUE = {"amplitude": 0.3, "frequency": 2.5, "direction": [0.6, -0.8, 0.0]}

each_motion = pytest.mark.parametrize(
    "path",
    [
        lambda time: straight_path(time, **OBLIQUE),
        lambda time: elliptic_path(time, **OBLIQUE, lift=0.04),
    ],
    ids=["straight", "elliptic"],
)


@each_motion
def test_velocity_is_the_derivative_of_displacement(path, derivative):
    rate = derivative(lambda shift: path(TIME + shift).displacement)
    np.testing.assert_allclose(path(TIME).velocity, rate, rtol=0, atol=1e-11)


@each_motion
def test_the_motion_begins_where_it_is_and_returns_there_every_period(path):
    period = 2 * math.pi / OBLIQUE["frequency"]
    motion = path(np.arange(5) * period)
    np.testing.assert_allclose(motion.displacement, 0.0, atol=1e-14)
    np.testing.assert_allclose(motion.velocity, np.tile(motion.velocity[0], (5, 1)), atol=1e-14)


def test_the_reports_step_is_a_line_of_140_mm_to_one_side():
    motion = straight_path(TIME, **STEP)
    np.testing.assert_array_equal(motion.displacement[:, 1:], 0.0)
    np.testing.assert_array_equal(motion.velocity[:, 1:], 0.0)
    assert motion.displacement.min() == 0.0
    assert straight_path([math.pi], **STEP).displacement[0, 0] == pytest.approx(0.140)
    np.testing.assert_allclose(motion.velocity[:, 0], 0.070 * np.sin(TIME), atol=1e-16)


@given(st.floats(1e-3, 10.0), st.floats(0.1, 50.0), st.floats(0.0, 6.28))
def test_the_straight_step_stays_on_a_line_of_length_two_a_over_w(amplitude, frequency, heading):
    direction = np.array([math.cos(heading), math.sin(heading), 0.0])
    motion = straight_path(TIME, amplitude=amplitude, frequency=frequency, direction=direction)
    along = motion.displacement @ direction
    longest = 2 * amplitude / frequency
    assert (along >= -1e-15).all()
    assert (along <= longest * (1 + 1e-12)).all()
    across = motion.displacement - np.outer(along, direction)
    np.testing.assert_allclose(across, 0.0, atol=1e-14 * longest)


def test_the_ellipse_is_an_ellipse_that_begins_at_its_rear_end():
    lift, direction = 0.04, np.array(OBLIQUE["direction"])
    motion = elliptic_path(TIME, **OBLIQUE, lift=lift)
    half = OBLIQUE["amplitude"] / OBLIQUE["frequency"]
    along, up = motion.displacement @ direction, motion.displacement @ UP
    np.testing.assert_allclose(((along - half) / half) ** 2 + (2 * up / lift) ** 2, 1.0, atol=1e-12)
    np.testing.assert_allclose(motion.velocity[0], lift / 2 * OBLIQUE["frequency"] * UP, atol=1e-16)


def test_an_ellipse_without_lift_is_the_straight_step():
    flat, straight = elliptic_path(TIME, **STEP, lift=0.0), straight_path(TIME, **STEP)
    np.testing.assert_array_equal(flat.displacement, straight.displacement)
    np.testing.assert_array_equal(flat.velocity, straight.velocity)
