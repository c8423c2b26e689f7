"""Motions through way points of the Robotics System Toolbox."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.motions import polynomial_pieces, spline_pieces, trapezoidal_pieces
from drake_leg.simulink.running.code import Writer
from drake_leg.simulink.running.kinds import kind

_PROFILE = {
    "Peak Velocity": "PeakVelocity",
    "Acceleration": "Acceleration",
    "End Time": "EndTime",
    "Acceleration Time": "AccelTime",
}
_USUAL = {
    **dict.fromkeys(_PROFILE.values(), "[1;2]"),
    "Waypoints": "[0 2 1 5 0;-1 3 1 4 4]",
    "TimePoints": "[1:5]",
    "TimeInterval": "[1 4]",
    "VelocityBoundaryCondition": "zeros(2,5)",
    "AccelerationBoundaryCondition": "zeros(2,5)",
}
_CONDITIONS = ("VelocityBoundaryCondition", "AccelerationBoundaryCondition")
_METHODS = {"Cubic Polynomial": 1, "Quintic Polynomial": 2, "B-Spline": 0}  # conditions of each
Given = dict[str, str | NDArray[np.float64]]  # the code of what comes in, and what is set


def _given(w: Writer, names: list[str], way: tuple[str, ...]) -> Given:
    """What comes in through ports, after the time, and what the block sets itself."""
    outside = {
        name: w.settings.text("WaypointSource" if name in way else "ParameterSource", "Internal")
        == "External"
        for name in names
    }
    ports = iter(range(1, len(names) + 1))
    return {
        name: w.numeric(next(ports)).code
        if outside[name]
        else w.settings.matrix(name, _USUAL[name])
        for name in names
    }


def _codes(w: Writer, given: Given) -> list[str]:
    return [
        each if isinstance(each, str) else w.constant(each, name) for name, each in given.items()
    ]


def _moved(w: Writer, call: str) -> None:
    made = w.let(call, "motion")
    for place in range(min(len(w.node.outputs), 3)):
        w.out(f"{made.code}[{place}]", place)


@kind("Trapezoidal Velocity Profile Trajectory")
def trapezoidal_trajectory(w: Writer) -> None:
    """Go from way point to way point with trapezoids of velocity."""
    s, t = w.settings, w.numeric(0)
    names = []
    for place in range(int(s.number("NumParams", "0"))):
        said = s.text(f"Parameter{place + 1}", "Peak Velocity")
        if said not in _PROFILE:
            raise w.fault(f"sets the {said!r} of its profile, which is not known")
        names.append(_PROFILE[said])
    given = _given(w, ["Waypoints", *names], ("Waypoints",))
    fixed = {name: each for name, each in given.items() if not isinstance(each, str)}
    if len(fixed) < len(given):
        way, *values = _codes(w, given)
        _moved(w, f"on_trapezoids({t.code}, {way}, {names!r}, [{', '.join(values)}])")
        return
    try:
        pieces = trapezoidal_pieces(fixed.pop("Waypoints"), fixed)
    except ValueError as error:
        raise w.fault(f"cannot go through its way points: {error}") from None
    at, of = w.constant(pieces[0], "breaks"), w.constant(pieces[1], "pieces")
    _moved(w, f"trapezoids_at({t.code}, {at}, {of})")


@kind("Polynomial Trajectory")
def polynomial_trajectory(w: Writer) -> None:
    """Follow polynomials, or a B-spline, through way points at times."""
    method = w.settings.text("Method", "Cubic Polynomial")
    if method not in _METHODS:
        raise w.fault(f"has the method {method!r}, which does not run")
    way = ("Waypoints", "TimeInterval" if method == "B-Spline" else "TimePoints")
    given = _given(w, [*way, *_CONDITIONS[: _METHODS[method]]], way)
    fixed = [each for each in given.values() if not isinstance(each, str)]
    t = w.numeric(0).code
    if len(fixed) < len(given):
        function = "on_spline" if method == "B-Spline" else "on_polynomial"
        _moved(w, f"{function}({t}, {', '.join(_codes(w, given))})")
        return
    points, times, *conditions = fixed
    rising = times.size > 1 and bool(np.all(np.diff(times.ravel()) > 0.0))
    fits = method == "B-Spline" or times.size == points.shape[1]
    if not (rising and fits and all(each.shape == points.shape for each in conditions)):
        raise w.fault(
            f"has way points of {points.shape[0]}×{points.shape[1]} and {times.size} times: give "
            "rising times, one for each way point, and conditions of the way points' size"
        )
    if method == "B-Spline":
        breaks, rows = spline_pieces(points, times.ravel())
    else:
        breaks, rows = polynomial_pieces(times.ravel(), np.stack([points, *conditions]))
    at, of = w.constant(breaks, "breaks"), w.constant(rows, "pieces")
    _moved(w, f"polynomial_at({t}, {at}, {of})")
