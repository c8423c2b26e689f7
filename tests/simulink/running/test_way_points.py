"""Motions through way points: the blocks against closed forms and SciPy, and in a port."""

import math

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.interpolate import BSpline, CubicHermiteSpline

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.motions import trapezoidal_motion, trapezoidal_pieces


def moving(tmp_path, kind, settings, *given, duration=4.0):
    """What a block puts out over time: position, speed and acceleration, one row a time."""
    rig = Rig()
    name = f"robotcorelib/{kind}"
    path = rig.add_library(name, "path", settings, ports={"in": 1 + len(given), "out": 3})
    rig.connect(rig.block("Clock", "clock"), f"{path}#in:1")
    for place, text in enumerate(given, start=2):
        rig.connect(rig.constant(text), f"{path}#in:{place}")
    for place, what in enumerate(("q", "qd", "qdd"), start=1):
        rig.show(f"{path}#out:{place}", what)
    run = rig.run(tmp_path, duration=duration)
    return run.time, *(shown(run, what) for what in ("q", "qd", "qdd"))


TRAPEZOID = "Trapezoidal Velocity Profile Trajectory"


@pytest.mark.parametrize("external", [False, True])
def test_a_way_takes_thirds_where_only_its_time_is_set(tmp_path, external):
    """It goes at 1.5 times its mean speed; in the first third 4.5 d (t/T)^2 / 2 of its way d."""
    source = "External" if external else "Internal"
    settings = {"NumParams": "1", "Parameter1": "End Time", "EndTime": "2",
                "Waypoints": "[0 3; 1 -1]", "WaypointSource": source}  # fmt: skip
    given = ["[0 3; 1 -1]"] if external else []
    t, q, qd, qdd = moving(tmp_path, TRAPEZOID, settings, *given)
    x = np.clip(t / 2.0, 0.0, 1.0)
    third = np.minimum(x, 1.0 - x) < 1.0 / 3.0
    part = np.where(third, 2.25 * np.minimum(x, 1.0 - x) ** 2, 1.5 * np.minimum(x, 1.0 - x) - 0.25)
    part = np.where(x > 0.5, 1.0 - part, part)
    np.testing.assert_allclose(q, np.outer(part, [3.0, -2.0]) + np.array([0.0, 1.0]), atol=1e-13)
    middle = np.abs(t - 1.0) < 0.3
    np.testing.assert_allclose(qd[middle], np.tile([2.25, -1.5], (middle.sum(), 1)), atol=1e-14)
    rates = np.where((t > 0.01) & (t < 0.6), 0.0, np.nan)
    np.testing.assert_allclose(np.nanmax(qdd[:, 0] + rates), 3.375, atol=1e-14)
    np.testing.assert_allclose(np.nanmin(qdd[:, 1] + rates), -2.25, atol=1e-14)
    assert not qd[t > 2.0].any()


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"EndTime": [2.0]},
        {"PeakVelocity": [3.0]},
        {"PeakVelocity": [2.0], "EndTime": [1.5]},
        {"PeakVelocity": [2.0], "Acceleration": [5.0]},
        {"PeakVelocity": [2.0], "AccelTime": [0.2]},
        {"EndTime": [1.5], "Acceleration": [9.0]},
        {"EndTime": [1.5], "AccelTime": [0.4]},
        {"Acceleration": [4.0], "AccelTime": [0.5]},
    ],
)
def test_a_trapezoid_keeps_what_is_set_and_meets_its_way_points(given):
    way = np.array([[1.0, 3.0, 1.0]])
    pieces = trapezoidal_pieces(way, {key: np.array(value) for key, value in given.items()})
    breaks = pieces[0][0]
    t = np.unique(np.concatenate([breaks, np.linspace(0.0, breaks[-1], 2001)]))
    q, qd, qdd = (each[0] for each in trapezoidal_motion(pieces, t))
    assert q[np.searchsorted(t, breaks[[0, 3, 6]])] == pytest.approx(way[0], abs=1e-14)
    np.testing.assert_allclose(np.diff(q), np.diff(t) * 0.5 * (qd[1:] + qd[:-1]), atol=1e-14)
    found = {"PeakVelocity": qd.max(), "Acceleration": qdd.max(), "EndTime": breaks[3],
             "AccelTime": breaks[1]}  # fmt: skip
    for key, value in given.items():
        assert found[key] == pytest.approx(value[0], abs=1e-12)
    assert breaks[3] == pytest.approx(breaks[6] - breaks[3])


def test_a_trapezoid_that_is_none_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no trapezoid goes 1 at the speed 9"):
        trapezoidal_pieces(
            np.array([[0.0, 1.0]]), {"EndTime": np.ones(1), "PeakVelocity": 9 * np.ones(1)}
        )
    settings = {"Waypoints": "[0 1]", "NumParams": "1", "Parameter1": "Acceleration"}
    with pytest.raises(InvalidValueError, match="give EndTime or PeakVelocity"):
        moving(tmp_path, TRAPEZOID, settings)


POLYNOMIAL = "Polynomial Trajectory"


@pytest.mark.parametrize("external", [False, True])
def test_a_cubic_has_the_speeds_that_are_set(tmp_path, external):
    way, at, speeds = "[0 1 -1]", "[0.5 1.5 3]", "[0 2 1]"
    settings = {"Waypoints": way, "TimePoints": at, "VelocityBoundaryCondition": speeds}
    given = []
    if external:
        settings |= {"WaypointSource": "External", "ParameterSource": "External"}
        given = [way, at, speeds]
    t, q, qd, qdd = moving(tmp_path, POLYNOMIAL, settings, *given)
    curve = CubicHermiteSpline([0.5, 1.5, 3.0], [0.0, 1.0, -1.0], [0.0, 2.0, 1.0])
    inside = (t >= 0.5) & (t <= 3.0)
    for order, found in enumerate((q, qd, qdd)):
        expected = curve(np.clip(t, 0.5, 3.0), order) * (inside | (order == 0))
        np.testing.assert_allclose(found.ravel(), expected, atol=1e-12)


def test_a_quintic_is_the_least_jerk(tmp_path):
    settings = {"Method": "Quintic Polynomial", "Waypoints": "[0 2]", "TimePoints": "[0 4]"}
    rests = ("VelocityBoundaryCondition", "AccelerationBoundaryCondition")
    settings |= dict.fromkeys(rests, "[0 0]")
    t, q, _, _ = moving(tmp_path, POLYNOMIAL, settings)
    x = t / 4.0
    np.testing.assert_allclose(q.ravel(), 2.0 * x**3 * (10 - 15 * x + 6 * x**2), atol=1e-13)


@pytest.mark.parametrize("external", [False, True])
def test_a_spline_is_clamped_to_its_control_points(tmp_path, external):
    points = "[0 1 2 3 4; 0 1 0 1 0]"
    settings = {"Method": "B-Spline", "Waypoints": points, "TimeInterval": "[1 3]",
                "WaypointSource": "External" if external else "Internal"}  # fmt: skip
    t, q, qd, _ = moving(tmp_path, POLYNOMIAL, settings, *([points, "[1 3]"] if external else []))
    knots = [1, 1, 1, 1, 2, 3, 3, 3, 3]
    curve = BSpline(knots, np.array([[0, 1, 2, 3, 4], [0, 1, 0, 1, 0]]).T, 3)
    inside = np.clip(t, 1.0, 3.0)
    np.testing.assert_allclose(q, curve(inside), atol=1e-13)
    np.testing.assert_allclose(qd[t < 1.0], 0.0)
    assert math.isclose(qd[np.argmin(abs(t - 2.0)), 1], curve(2.0, 1)[1], abs_tol=1e-2)


def test_times_that_do_not_fit_are_refused(tmp_path):
    settings = {
        "Waypoints": "[0 1 2]",
        "TimePoints": "[0 1]",
        "VelocityBoundaryCondition": "[0 0 0]",
    }
    with pytest.raises(InvalidValueError, match="way points of 1×3 and 2 times"):
        moving(tmp_path, POLYNOMIAL, settings)
