"""Half a sine wave of a force."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import Push

PUSH = Push(force=(0.1, -0.2, 0.3), at=2.0, lasting=0.5)


def test_it_is_greatest_in_the_middle_and_zero_before_and_after():
    np.testing.assert_allclose(PUSH.at_time(2.25), PUSH.force)
    np.testing.assert_allclose(PUSH.at_time([0.0, 2.0, 2.5, 9.0]), 0.0, atol=1e-15)
    np.testing.assert_allclose(PUSH.at_time(2.5 / 12 * 10), PUSH.at_time(2.5 - 0.5 / 6))


def test_its_impulse_is_the_integral_of_the_force():
    integral = [quad(lambda t: PUSH.at_time(t)[i], 2.0, 2.5)[0] for i in range(3)]  # noqa: B023
    np.testing.assert_allclose(PUSH.impulse, integral, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"force": (1.0, 2.0)}, "three finite numbers"),
        ({"force": (math.nan, 0.0, 0.0)}, "nan"),
        ({"force": (math.inf, 0.0, 0.0)}, "inf"),
        ({"at": -1.0}, "-1.0"),
        ({"at": math.nan}, "nan"),
        ({"lasting": 0.0}, "0.0"),
    ],
    ids=str,
)
def test_a_senseless_push_is_refused(change, named):
    with pytest.raises(InvalidValueError, match=named):
        Push(**{"force": (0.0, 0.0, 0.1), "at": 2.0, "lasting": 0.1, **change})
