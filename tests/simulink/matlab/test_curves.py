"""Splines and moving averages, against SciPy and sums by hand."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.program import value

X, Y = "[0 1 2.5 4]", "[1 3 -1 2]"
AT = "[-0.5 0.3 2.7 4.5]"
PLACES = np.array([-0.5, 0.3, 2.7, 4.5])
GIVEN = np.array([0.0, 1.0, 2.5, 4.0]), np.array([1.0, 3.0, -1.0, 2.0])


def test_splines_are_those_of_scipy():
    assert value(f"spline({X}, {Y}, {AT})") == pytest.approx(CubicSpline(*GIVEN)(PLACES))
    assert value(f"pchip({X}, {Y}, {AT})") == pytest.approx(PchipInterpolator(*GIVEN)(PLACES))
    clamped = CubicSpline(*GIVEN, bc_type=((1, 5.0), (1, -6.0)))(PLACES)
    assert value(f"ppval(spline({X}, [5 1 3 -1 2 -6]), {AT})") == pytest.approx(clamped)


def test_pieces_are_polynomials_from_where_they_begin():
    assert value("ppval(mkpp([0 1 3], [1 0 0; 2 1 1]), [0.5 1 2])") == (0.25, 1.0, 4.0)


@pytest.mark.parametrize(
    ("window", "expected"),
    [("3", (1.5, 2.0, 3.0, 3.5)), ("[1 0]", (1.0, 1.5, 2.5, 3.5)), ("2", (1.0, 1.5, 2.5, 3.5))],
)
def test_a_moving_average_is_over_less_at_the_ends(window, expected):
    assert value(f"movmean([1 2 3 4], {window})") == pytest.approx(expected)


def test_a_curve_of_one_point_is_refused():
    with pytest.raises(InvalidValueError, match="two points at least"):
        value("spline(1, 2, 3)")
