"""From File: a matrix over time, the time in its first row, against lines by hand."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.io import savemat

from drake_leg.errors import InvalidValueError

TIMES = np.array([0.2, 0.5, 0.8])
ONE, OTHER = np.array([1.0, 3.0, 2.0]), np.array([0.0, -1.0, 4.0])


def from_file(folder, **settings):
    savemat(folder / "data.mat", {"points": np.array([TIMES, ONE, OTHER])})
    rig = Rig()
    rig.show(rig.block("FromFile", "file", FileName="data.mat", **settings), "y")
    return rig.run(folder, 1.0)


def test_values_go_on_along_lines(tmp_path):
    run = from_file(tmp_path)
    t, y = run.time, shown(run, "y")
    within = (t >= TIMES[0]) & (t <= TIMES[-1])
    np.testing.assert_allclose(y[within, 0], np.interp(t, TIMES, ONE)[within], atol=1e-12)
    np.testing.assert_allclose(y[0], [1.0 - 0.2 * 2.0 / 0.3, 0.2 / 0.3], atol=1e-12)
    np.testing.assert_allclose(y[-1], [2.0 - 0.2 / 0.3, 4.0 + 0.2 * 5.0 / 0.3], atol=1e-12)


@pytest.mark.parametrize(("early", "first"), [("Hold first value", 1.0), ("Ground value", 0.0)])
@pytest.mark.parametrize(("late", "last"), [("Hold last value", 2.0), ("Ground value", 0.0)])
def test_values_are_held_outside_of_the_times(early, first, late, last, tmp_path):
    run = from_file(tmp_path, ExtrapolationBeforeFirstDataPoint=early,
                    ExtrapolationAfterLastDataPoint=late)  # fmt: skip
    t, y = run.time, shown(run, "y")[:, 0]
    assert np.all(y[t < 0.2 - 1e-9] == first)
    assert np.all(y[t > 0.8 + 1e-9] == last)
    between = (t > 0.2 + 1e-9) & (t < 0.8 - 1e-9)
    np.testing.assert_allclose(y[between], np.interp(t, TIMES, ONE)[between], atol=1e-12)


def test_values_are_held_between_the_times(tmp_path):
    run = from_file(tmp_path, InterpolationWithinTimeRange="Zero order hold",
                    ExtrapolationAfterLastDataPoint="Hold last value")  # fmt: skip
    t, y = run.time, shown(run, "y")[:, 1]
    expected = np.select([t < 0.5, t < 0.8], [0.0, -1.0], 4.0)
    off = np.abs(t[:, None] - TIMES).min(axis=1) > 1e-9
    np.testing.assert_array_equal(y[off], expected[off])


def test_a_file_that_holds_something_else_is_refused(tmp_path):
    rig = Rig()
    rig.show(rig.block("FromFile", "file", FileName="other.mat"), "y")
    with pytest.raises(InvalidValueError, match="which is not in the given folders"):
        rig.code(tmp_path)
    savemat(tmp_path / "other.mat", {"a": np.eye(2), "b": np.eye(3)})
    with pytest.raises(InvalidValueError, match="holds 0 series and 2 matrices: let it hold one"):
        rig.code(tmp_path)


def test_a_hold_does_not_go_on_along_a_line(tmp_path):
    with pytest.raises(InvalidValueError, match="hold the last value"):
        from_file(tmp_path, InterpolationWithinTimeRange="Zero order hold")
