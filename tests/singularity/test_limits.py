"""Bounds of joint rates: brakes before limits, and a way back for who starts at one."""

import math

import numpy as np
import pytest

from drake_leg.singularity.inverse import (
    BRAKING,
    FASTEST,
    FREE,
    HEADROOM,
    MARGIN,
    PART,
    RETREAT,
    RateBox,
)

MOST, SETTLING = 2.0, 0.1


def box(lower, upper):
    return RateBox([lower], [upper], [MOST], SETTLING)


def rates_at(bounds, q):
    ((low,), (high,)) = bounds.bounds([q])
    return low, high


def test_far_from_its_limits_a_joint_is_bound_by_its_greatest_rate_alone():
    fastest = (1.0 - HEADROOM) * MOST
    assert rates_at(box(-math.inf, math.inf), 1e3) == (-fastest, fastest)
    assert rates_at(box(-math.inf, 1.0), -5.0) == (-fastest, fastest)


def test_a_joint_brakes_to_its_margin_and_backs_from_its_limit():
    limited = box(-1.0, 1.0)
    assert rates_at(limited, 1.0 - MARGIN)[1] == pytest.approx(0.0, abs=1e-14)
    assert rates_at(limited, 0.95)[1] == pytest.approx((0.05 - MARGIN) / SETTLING)
    assert rates_at(limited, 1.0)[1] == pytest.approx(-MARGIN / RETREAT)
    assert rates_at(limited, -1.0)[0] == pytest.approx(MARGIN / RETREAT)


@pytest.mark.parametrize("width", [1e-9, 1e-6, 1e-3, 1.0, 100.0])
def test_there_is_a_rate_whatever_the_room(width):
    limited = box(0.3, 0.3 + width)
    for q in np.linspace(0.3 - width, 0.3 + 2.0 * width, 61):
        low, high = rates_at(limited, q)
        assert low < high
    middle = rates_at(limited, 0.3 + width / 2.0)
    assert middle[0] < 0.0 < middle[1]
    low, high = rates_at(limited, 0.3 + PART * width / 2.0)
    assert low >= 0.0 or width > MARGIN / PART
    assert high > 0.0


def test_what_bounds_a_rate_is_told():
    limited = box(-1.0, 1.0)
    fastest = (1.0 - HEADROOM) * MOST
    for q, rate, kind in (
        (0.0, 0.1, FREE),
        (0.0, fastest, FASTEST),
        (0.0, -fastest, -FASTEST),
        (0.95, rates_at(limited, 0.95)[1], BRAKING),
        (-0.95, rates_at(limited, -0.95)[0], -BRAKING),
        (1.0, rates_at(limited, 1.0)[1], BRAKING),
    ):
        assert limited.regime([q], [rate]) == (kind,)


def test_rates_within_their_bounds_are_held():
    limited = RateBox([-1.0, -1.0], [1.0, 1.0], [MOST, MOST], SETTLING)
    assert limited.holds([0.0, 0.95], [1.9, 0.4])
    assert not limited.holds([0.0, 0.95], [1.9, 0.6])
    assert not limited.holds([0.0, 0.95], [-2.0, 0.4])
