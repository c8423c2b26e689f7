import math

import numpy as np
import pytest

from drake_leg.kinematics.inverse.one_unknown import quadratic, roots, sine_and_cosine


def test_sine_and_cosine(rng):
    for x, y, angle in rng.uniform(-2.0, 2.0, (10, 3)):
        found = sine_and_cosine(x, y, x * math.sin(angle) + y * math.cos(angle))
        assert min(abs(math.remainder(q - angle, math.tau)) for q in found) < 1e-7
    assert sine_and_cosine(1.0, 0.0, 1.1) == []
    assert sine_and_cosine(0.0, 0.0, 0.0) == []


def test_quadratic():
    assert sorted(quadratic(2.0, -3.0, 4.0)) == pytest.approx([1.0, 2.0])
    assert quadratic(1.0, 0.0, 1.0) == []
    assert quadratic(1.0, 0.0, 0.0) == [0.0, 0.0]


@pytest.mark.parametrize("wanted", [(0.3, -1.2, 2.0, 2.9), (0.5, 0.5, -2.0, 1.0), (0.7,) * 4])
def test_the_roots_of_a_trigonometric_quartic(wanted):
    def function(t):
        return np.prod([np.sin((t - root) / 2.0) for root in wanted], axis=0)

    found = roots(function, turns=True, scale=1.0, reach=1.0)
    assert len(found) == 4
    for root in wanted:
        assert np.abs(np.array(found) - root).min() < 1e-3


def test_the_roots_of_a_quartic():
    found = roots(
        lambda t: (t - 3.0) * (t + 2.0) * (t * t + 1.0), turns=False, scale=1.0, reach=2.0
    )
    assert sorted(found)[0] == pytest.approx(-2.0)
    assert sorted(found)[-1] == pytest.approx(3.0)
    found = roots(lambda t: 2.0 * t - 1.0, turns=False, scale=1.0, reach=2.0)
    assert found == pytest.approx([0.5] * len(found))


def test_what_is_zero_everywhere_has_no_roots_and_says_so():
    for turns in (True, False):
        assert roots(lambda t: 0.0 * t + 1e-14, turns=turns, scale=1.0, reach=1.0) is None
        assert roots(lambda t: 0.0 * t + 0.1, turns=turns, scale=1.0, reach=1.0) == []
