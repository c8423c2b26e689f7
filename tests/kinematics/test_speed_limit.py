"""A velocity shortened to a greatest speed, and its derivative."""

import numpy as np
import pytest

from drake_leg.kinematics.motions import limited_speed

LENGTHS = np.array([1.0, 1.0, 0.2])  # the third part is an angle's rate


def speed(v):
    return np.linalg.norm(LENGTHS * v)


def test_slow_velocities_pass_and_fast_ones_keep_their_direction(rng):
    for v, a in rng.normal(size=(20, 2, 3)):
        limited, changed = limited_speed(v.tolist(), a.tolist(), 1.0, LENGTHS)
        if speed(v) <= 1.0:
            assert (limited, changed) == (v.tolist(), a.tolist())
        else:
            assert speed(limited) == pytest.approx(1.0)
            np.testing.assert_allclose(np.cross(limited, v), 0.0, atol=1e-12)


def test_the_derivative_is_that_of_the_velocity(rng):
    step = 1e-6
    for v, a in rng.normal(size=(20, 2, 3)) * 3.0:
        _, derivative = limited_speed(v, a, 1.0, LENGTHS)
        before, after = (limited_speed(v + s * step * a, a, 1.0, LENGTHS)[0] for s in (-1, 1))
        np.testing.assert_allclose(
            derivative, np.subtract(after, before) / (2 * step), rtol=1e-6, atol=1e-8
        )
