"""Rates of Euler angles against differentiation, Drake's roll-pitch-yaw and the pseudo-inverse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RollPitchYaw

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import (
    PROPER,
    SEQUENCES,
    angle_accelerations,
    angle_rates,
    euler_rotation,
    rate_matrix,
)

ALL = pytest.mark.parametrize("sequence", SEQUENCES)


def locked_angle(sequence, at):
    return (0.0, math.pi)[at] if sequence in PROPER else (math.pi / 2, -math.pi / 2)[at]


def spin(R):
    """Vector of a skew matrix dR/dt R^T."""
    return np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2


@ALL
def test_the_rate_matrix_is_the_derivative_of_the_rotation(sequence, rng, derivative):
    for angles, rates in rng.uniform(-2.0, 2.0, (5, 2, 3)):
        dR = derivative(lambda t, a=angles, r=rates: euler_rotation(sequence, a + t * r))
        w = spin(dR @ euler_rotation(sequence, angles).T)
        np.testing.assert_allclose(rate_matrix(sequence, angles) @ rates, w, atol=1e-10)


@ALL
def test_rates_are_the_inverse_of_the_rate_matrix(sequence, rng):
    angles = rng.uniform(-7.0, 7.0, (100, 3))
    w = rng.uniform(-5.0, 5.0, (100, 3))
    rates = angle_rates(sequence, angles, w)
    E = rate_matrix(sequence, angles)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", E, rates), w, atol=1e-12)
    np.testing.assert_array_equal(angle_rates(sequence, angles[0], w[0]), rates[0])


def test_rates_are_drakes_of_roll_pitch_yaw_read_backwards(rng):
    for rpy, w in rng.uniform(-1.4, 1.4, (20, 2, 3)):
        drake = RollPitchYaw(rpy)
        np.testing.assert_allclose(
            euler_rotation("ZYX", rpy[::-1]), drake.ToRotationMatrix().matrix(), atol=1e-15
        )
        expected = drake.CalcRpyDtFromAngularVelocityInParent(w)
        np.testing.assert_allclose(angle_rates("ZYX", rpy[::-1], w)[::-1], expected, atol=1e-13)


def test_accelerations_are_drakes_of_roll_pitch_yaw_read_backwards(rng):
    for rpy, rates, alpha in rng.uniform(-1.4, 1.4, (20, 3, 3)):
        expected = RollPitchYaw(rpy).CalcRpyDDtFromRpyDtAndAngularAccelInParent(rates, alpha)
        found = angle_accelerations("ZYX", rpy[::-1], rates[::-1], alpha)
        np.testing.assert_allclose(found[::-1], expected, rtol=1e-12, atol=1e-12)


@ALL
def test_accelerations_are_the_derivative_of_the_rates(sequence, rng, derivative):
    second = 0.8 if sequence in PROPER else 0.3
    regular = np.array([0.0, second, 0.0])
    for angles, rates, accelerations in regular + rng.uniform(-0.5, 0.5, (5, 3, 3)):

        def w(t, a=angles, r=rates, b=accelerations):
            return rate_matrix(sequence, a + t * r + t * t / 2 * b) @ (r + t * b)

        found = angle_accelerations(sequence, angles, rates, derivative(w))
        np.testing.assert_allclose(found, accelerations, atol=1e-9)


@ALL
@pytest.mark.parametrize("at", [0, 1])
def test_at_gimbal_lock_rates_are_the_least_squares_of_least_norm(sequence, at, rng):
    for first, third, *w in rng.uniform(-3.0, 3.0, (10, 5)):
        angles = [first, locked_angle(sequence, at), third]
        E = rate_matrix(sequence, angles)
        expected = np.linalg.pinv(E, rcond=1e-9) @ w
        np.testing.assert_allclose(angle_rates(sequence, angles, w), expected, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "sequence",
    [
        pytest.param(sequence, marks=() if number % 3 == 0 else pytest.mark.slow)
        for number, sequence in enumerate(SEQUENCES)
    ],
)
@given(data=st.data())
def test_nothing_is_ever_infinite(sequence, data):
    small = st.sampled_from([0.0, 1e-300, 1e-16, -1e-13, 1e-12, 1e-9, -1e-4, 1.0])
    second = locked_angle(sequence, data.draw(st.integers(0, 1))) + data.draw(small)
    angles = [data.draw(small), second, data.draw(small)]
    w = [data.draw(small) for _ in range(3)]
    rates = angle_rates(sequence, angles, w)
    assert np.isfinite(rates).all()
    assert np.isfinite(angle_accelerations(sequence, angles, rates, w)).all()


def test_every_vector_must_be_finite_and_three():
    good, bad, short = [0.1, 0.2, 0.3], [0, np.inf, 0], [0, 0]
    with pytest.raises(InvalidValueError, match="Euler angles has a value that is not finite"):
        angle_rates("XYZ", bad, good)
    with pytest.raises(InvalidValueError, match="angular velocity has shape"):
        angle_rates("XYZ", good, short)
    with pytest.raises(InvalidValueError, match="rates has a value that is not finite"):
        angle_accelerations("XYZ", good, bad, good)
    with pytest.raises(InvalidValueError, match="angular acceleration has shape"):
        angle_accelerations("XYZ", good, good, short)
