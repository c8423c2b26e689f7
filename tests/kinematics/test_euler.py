"""Euler angles against SciPy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import (
    LOCK,
    PROPER,
    SEQUENCES,
    continuous_angles,
    euler_angles,
    euler_rotation,
    gimbal_distance,
)

ALL = pytest.mark.parametrize("sequence", SEQUENCES)


def random_rotations(rng, count):
    quaternions = rng.standard_normal((count, 4))
    return Rotation.from_quat(quaternions).as_matrix()


def locked_angle(sequence, at=0):
    return (0.0, math.pi)[at] if sequence in PROPER else (math.pi / 2, -math.pi / 2)[at]


def test_there_are_the_twelve():
    assert len(set(SEQUENCES)) == 12
    assert all(a != b != c for a, b, c in SEQUENCES)


@ALL
def test_the_matrix_is_scipys(sequence, rng):
    angles = rng.uniform(-7.0, 7.0, (50, 3))
    expected = Rotation.from_euler(sequence, angles).as_matrix()
    np.testing.assert_allclose(euler_rotation(sequence, angles), expected, atol=4e-15)
    np.testing.assert_allclose(euler_rotation(sequence, angles[0]), expected[0], atol=4e-15)


@ALL
def test_the_angles_are_scipys_principal_values(sequence, rng):
    rotations = random_rotations(rng, 200)
    angles = euler_angles(sequence, rotations)
    np.testing.assert_allclose(
        angles, Rotation.from_matrix(rotations).as_euler(sequence), atol=1e-12
    )
    np.testing.assert_allclose(euler_rotation(sequence, angles), rotations, atol=4e-15)
    np.testing.assert_allclose(euler_angles(sequence, rotations[0]), angles[0], atol=0)


@ALL
@pytest.mark.parametrize("distance", [1e-3, 1e-7, 1e-10, 1e-11, 1e-13, 1e-15, 0.0])
@pytest.mark.parametrize("at", [0, 1])
def test_near_gimbal_lock_the_angles_still_give_the_rotation(sequence, distance, at, rng):
    first, third = rng.uniform(-3.0, 3.0, (2, 20))
    second = np.full(20, locked_angle(sequence, at) + distance)
    rotations = euler_rotation(sequence, np.stack([first, second, third], axis=-1))
    angles = euler_angles(sequence, rotations)
    np.testing.assert_allclose(euler_rotation(sequence, angles), rotations, atol=2 * LOCK)
    np.testing.assert_allclose(gimbal_distance(sequence, angles), distance, atol=1e-15)
    if distance < LOCK / 2:
        np.testing.assert_array_equal(angles[:, 0], 0.0)
    elif distance >= 1e-7:
        np.testing.assert_allclose(euler_rotation(sequence, angles), rotations, atol=4e-15)


@ALL
def test_gimbal_distance_is_the_angle_between_the_axes_or_its_supplement(sequence, rng):
    angles = rng.uniform(-7.0, 7.0, (50, 3))
    first = np.eye(3)["XYZ".index(sequence[0])]
    third = euler_rotation(sequence, angles)[..., "XYZ".index(sequence[2])]
    cosine = np.abs(third @ first)
    np.testing.assert_allclose(gimbal_distance(sequence, angles), np.arccos(cosine), atol=1e-12)


@ALL
def test_a_recorded_series_is_made_continuous(sequence, rng):
    t = np.linspace(0.0, 20.0, 2001)
    true = np.stack([0.9 * t, 2.4 * np.sin(0.7 * t) + 0.2, -1.3 * t + np.sin(t)], axis=-1)
    recorded = euler_angles(sequence, euler_rotation(sequence, true))
    assert np.abs(np.diff(recorded, axis=0)).max() > 3.0
    mended = continuous_angles(sequence, recorded)
    # The same angles, up to the branch of the first sample.
    np.testing.assert_allclose(
        euler_rotation(sequence, mended), euler_rotation(sequence, true), atol=1e-12
    )
    np.testing.assert_allclose(mended - mended[0], signed(true, mended), atol=1e-9)


def signed(true, mended):
    """Changes of the true angles; the other branch turns the second angle the other way."""
    same = np.sign((mended[1] - mended[0])[1]) == np.sign((true[1] - true[0])[1])
    return (true - true[0]) * (1.0, 1.0 if same else -1.0, 1.0)


@ALL
def test_a_series_passes_straight_through_gimbal_lock(sequence):
    t = np.linspace(-0.5, 0.5, 101)  # its sample in the middle is at lock, to rounding
    true = np.stack([0.3 + 0 * t, locked_angle(sequence) + t, -0.8 + 0 * t], axis=-1)
    recorded = euler_angles(sequence, euler_rotation(sequence, true))
    mended = continuous_angles(sequence, recorded)
    assert np.abs(np.diff(mended, axis=0)).max() == pytest.approx(0.01, rel=1e-9)
    np.testing.assert_allclose(
        euler_rotation(sequence, mended), euler_rotation(sequence, true), atol=1e-11
    )


def test_a_series_dwelling_at_gimbal_lock_shares_what_turns():
    t = np.linspace(0.0, 1.0, 11)
    at_lock = np.stack([0 * t, 0 * t, 4 * t], axis=-1)
    recorded = np.vstack([[[0.3, 0.1, -0.3]], euler_angles("ZXZ", euler_rotation("ZXZ", at_lock))])
    mended = continuous_angles("ZXZ", recorded)
    np.testing.assert_allclose(mended[1:, 0], 0.3 + 2 * t, atol=1e-12)
    np.testing.assert_allclose(mended[1:, 2], -0.3 + 2 * t, atol=1e-12)


@pytest.mark.parametrize("sequence", ["XXY", "xyz", "XY", "XYZX", "", "ABC"])
def test_an_unknown_sequence_is_refused_with_the_twelve(sequence):
    with pytest.raises(InvalidValueError, match="XYZ, XZY") as refusal:
        euler_rotation(sequence, [0, 0, 0])
    assert repr(sequence) in str(refusal.value)


@pytest.mark.parametrize(
    "matrix", [-np.eye(3), 2 * np.eye(3), np.full((3, 3), np.nan), np.ones((3, 3)), np.eye(2)]
)
def test_what_is_no_rotation_is_refused(matrix):
    with pytest.raises(InvalidValueError, match="rotation"):
        euler_angles("XYZ", matrix)


def test_angles_must_be_finite_and_three():
    with pytest.raises(InvalidValueError, match="not finite"):
        euler_rotation("XYZ", [0, np.inf, 0])
    with pytest.raises(InvalidValueError, match="3 long"):
        gimbal_distance("XYZ", [0, 0])
    with pytest.raises(InvalidValueError, match=r"\(n, 3\)"):
        continuous_angles("XYZ", [0, 0, 0])
