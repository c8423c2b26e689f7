"""Rotation matrices of quaternions, against SciPy and Drake."""

import math

import numpy as np
import pytest
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RotationMatrix
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import quaternions, rotation_matrices


def unit_quaternions(rng, *shape):
    wxyz = rng.normal(size=(*shape, 4))
    return wxyz / np.linalg.norm(wxyz, axis=-1, keepdims=True)


def test_scipy_and_drake_have_the_same_matrices(rng):
    given = unit_quaternions(rng, 50)
    R = rotation_matrices(given)
    scipys = Rotation.from_quat(given, scalar_first=True).as_matrix()
    np.testing.assert_allclose(R, scipys, rtol=0, atol=1e-14)
    for own, wxyz in zip(R, given, strict=True):
        drakes = RotationMatrix(Quaternion(wxyz)).matrix()
        np.testing.assert_allclose(own, drakes, rtol=0, atol=1e-14)


def test_a_quaternion_and_its_negative_are_the_same_rotation(rng):
    given = unit_quaternions(rng, 20)
    np.testing.assert_array_equal(rotation_matrices(given), rotation_matrices(-given))


@pytest.mark.parametrize("shape", [(), (1,), (7,), (2, 5), (3, 3), (2, 3, 4)])
def test_the_axes_of_a_batch_keep_their_order(rng, shape):
    given = unit_quaternions(rng, *shape)
    R = rotation_matrices(given)
    assert R.shape == (*shape, 3, 3)
    for place in np.ndindex(*shape):
        np.testing.assert_allclose(R[place], rotation_matrices(given[place]), atol=1e-15)


def test_a_quarter_turn_about_z_takes_x_to_y():
    half = math.sqrt(0.5)
    np.testing.assert_allclose(
        rotation_matrices([half, 0.0, 0.0, half]) @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15
    )


def test_what_is_no_quaternion_is_refused():
    with pytest.raises(InvalidValueError, match=r"the quaternion has shape \(3,\)"):
        rotation_matrices([1.0, 0.0, 0.0])
    with pytest.raises(
        InvalidValueError, match=r"the quaternion has a value that is not finite.*nan"
    ):
        rotation_matrices([math.nan, 0.0, 0.0, 0.0])


def test_quaternions_undo_rotation_matrices(rng):
    given = unit_quaternions(rng, 500)
    given[:4] = np.eye(4)  # half turns, where the greatest component changes
    given = np.where(given[:, :1] < 0.0, -given, given)
    assert quaternions(rotation_matrices(given)) == pytest.approx(given, abs=1e-12)


def test_quaternions_are_drakes(rng):
    R = rotation_matrices(unit_quaternions(rng, 50))
    drakes = [RotationMatrix(each).ToQuaternion().wxyz() for each in R]
    assert quaternions(R) == pytest.approx(np.array(drakes), abs=1e-12)
