"""``ode45`` and its kin: the steps of the MATLAB ODE Suite (Shampine and Reichelt, 1997).

``ode45`` and ``ode23`` take the steps of the published step control, so that as many rows come out
as from MATLAB; the others integrate by SciPy's solvers, to the same tolerances.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import LackError, Struct, numbers_of, settled
from drake_leg.simulink.matlab.inputs import scalar
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script
Array = NDArray[np.float64]
Slope = Callable[[float, Array], Array]


@dataclass(frozen=True)
class Pair:
    """An embedded pair of Runge and Kutta; the last stage is the first of the next step."""

    nodes: Array
    stages: Array  # one row a stage but the first; the last row gives the step
    error: Array
    between: Array  # one row a stage, one column a power of the part of the step
    order: int
    refine: int
    least: float  # part of a step that is tried first where one fails


_DORMAND_PRINCE = Pair(
    nodes=np.array([1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1]),
    stages=np.array([
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]),
    error=np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]),
    between=np.array([
        [1, -183 / 64, 37 / 12, -145 / 128],
        [0, 0, 0, 0],
        [0, 1500 / 371, -1000 / 159, 1000 / 371],
        [0, -125 / 32, 125 / 12, -375 / 64],
        [0, 9477 / 3392, -729 / 106, 25515 / 6784],
        [0, -11 / 7, 11 / 3, -55 / 28],
        [0, 3 / 2, -4, 5 / 2],
    ]),
    order=5,
    refine=4,
    least=0.1,
)  # fmt: skip
_BOGACKI_SHAMPINE = Pair(
    nodes=np.array([1 / 2, 3 / 4, 1]),
    stages=np.array([[1 / 2, 0, 0], [0, 3 / 4, 0], [2 / 9, 1 / 3, 4 / 9]]),
    error=np.array([-5 / 72, 1 / 12, 1 / 9, -1 / 8]),
    between=np.array([[1, -4 / 3, 5 / 9], [0, 1, -2 / 3], [0, 4 / 3, -8 / 9], [0, -1, 1]]),
    order=3,
    refine=1,
    least=0.5,
)
_SCIPY = {"ode15s": "BDF", "ode23s": "Radau", "ode23t": "Radau", "ode23tb": "Radau",
          "ode113": "DOP853", "ode78": "DOP853", "ode89": "DOP853"}  # fmt: skip
# Options that change no solution: speed, text on the screen, pictures of the built-in functions.
_IDLE = frozenset(("jacobian", "jpattern", "vectorized", "maxorder", "bdf", "stats"))
_HEEDED = frozenset(("reltol", "abstol", "maxstep", "initialstep", "refine", "events"))
_NAMES = (
    "AbsTol", "BDF", "Events", "InitialSlope", "InitialStep", "Jacobian", "JPattern", "Mass",
    "MassSingular", "MaxOrder", "MaxStep", "MinStep", "MStateDependence", "MvPattern",
    "NonNegative", "NormControl", "OutputFcn", "OutputSel", "Refine", "RelTol", "Stats",
    "Vectorized",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What is to be integrated, and how accurately."""

    slope: Slope
    at: Array  # the times: both ends, or all that are wanted
    start: Array
    relative: float
    absolute: Array
    longest: float
    first: float | None
    refine: int | None
    events: Callable[[float, Array], tuple[Array, Array, Array]] | None


@dataclass
class Course:
    """Rows of a solution, and the events on it."""

    t: list[float] = field(default_factory=list)
    y: list[Array] = field(default_factory=list)
    events: list[tuple[float, Array, int]] = field(default_factory=list)


Between = Callable[[float], Array]  # the solution at a time within the last step


def _explicit(problem: Problem, pair: Pair) -> Iterator[tuple[float, float, Between]]:
    """Take steps of an embedded pair: their ends, and the solution between."""
    t, end, y = float(problem.at[0]), float(problem.at[-1]), problem.start
    way, power = np.sign(end - t), 1.0 / pair.order
    threshold = problem.absolute / problem.relative
    slope = problem.slope(t, y)
    size = min(problem.longest, abs(float(problem.at[1]) - t))
    rate = np.max(np.abs(slope) / np.maximum(np.abs(y), threshold), initial=0.0)
    rate /= 0.8 * problem.relative**power
    size = problem.first or (1.0 / rate if size * rate > 1.0 else size)
    while t != end:
        least, first = 16.0 * abs(np.spacing(t)), True
        size = min(problem.longest, max(least, size))
        if 1.1 * size >= abs(end - t):
            size = abs(end - t)
        while True:
            h = way * size
            new, slopes = _stages(problem.slope, pair, t, y, slope, h)
            scale = np.maximum(np.maximum(np.abs(y), np.abs(new)), threshold)
            error = size * np.max(np.abs(slopes @ pair.error) / scale, initial=0.0)
            if error <= problem.relative:
                break
            if size <= least or (not np.isfinite(error) and size <= 1e-9 * abs(end - t)):
                raise MatlabError(f"the integration fails at t = {t:g}: no step is short enough")
            ratio = 0.8 * (problem.relative / error) ** power if np.isfinite(error) else 0.0
            size = max(least, size * (max(pair.least, ratio) if first else 0.5))
            first = False
        after = end if abs(end - t) == size else t + h

        def between(
            time: float, t: float = t, y: Array = y, h: float = h, slopes: Array = slopes
        ) -> Array:
            part = (time - t) / h
            powers = part ** np.arange(1, pair.between.shape[1] + 1)
            return y + h * slopes @ (pair.between @ powers)

        yield t, after, between
        t, y, slope = after, new, slopes[:, -1]
        if first:
            ratio = 1.25 * (error / problem.relative) ** power
            size *= 1.0 / ratio if ratio > 0.2 else 5.0


def _stages(
    function: Slope, pair: Pair, t: float, y: Array, slope: Array, h: float
) -> tuple[Array, Array]:
    slopes = np.zeros((y.size, pair.nodes.size + 1))
    slopes[:, 0] = slope
    new = y
    for k, (node, row) in enumerate(zip(pair.nodes, pair.stages, strict=True)):
        new = y + h * slopes[:, : row.size] @ row
        slopes[:, k + 1] = function(t + h * node, new)
    return new, slopes


def _of_scipy(problem: Problem, method: str) -> Iterator[tuple[float, float, Between]]:
    from scipy import integrate  # takes a while to load, and few scripts need it

    solvers = {
        "BDF": integrate.BDF,
        "Radau": integrate.Radau,
        "DOP853": integrate.DOP853,
    }
    solver = solvers[method](
        problem.slope,
        float(problem.at[0]),
        problem.start,
        float(problem.at[-1]),
        rtol=max(problem.relative, 1e-13),
        atol=problem.absolute,
        max_step=problem.longest,
        first_step=problem.first,
    )
    while solver.status == "running":
        before = solver.t
        if message := solver.step():
            raise MatlabError(f"the integration fails at t = {before:g}: {message}")
        yield float(before), float(solver.t), solver.dense_output()


def solved(problem: Problem, steps: Iterator[tuple[float, float, Between]], refine: int) -> Course:
    """Collect the wanted rows of steps, up to their end or an event that ends them."""
    course = Course([float(problem.at[0])], [problem.start])
    way, pending = np.sign(problem.at[-1] - problem.at[0]), list(problem.at[1:])
    before = problem.events(course.t[0], problem.start)[0] if problem.events else None
    for t, after, between in steps:
        stop = after
        if problem.events and before is not None:
            before, stop = _events(problem, course, (t, after, between), before)
        if len(problem.at) == 2:
            times = [t + (after - t) * k / refine for k in range(1, refine)]
            times = [*(each for each in times if (each - stop) * way < 0), stop]
        else:
            times = []
            while pending and (pending[0] - stop) * way <= 0:
                times.append(pending.pop(0))
            if stop != after and (not times or times[-1] != stop):
                times.append(stop)
        course.t.extend(map(float, times))
        course.y.extend(between(time) for time in times)
        if stop != after:
            break
    return course


def _events(
    problem: Problem, course: Course, step: tuple[float, float, Between], before: Array
) -> tuple[Array, float]:
    """Find where event functions change their signs in a step, and which of them ends it."""
    from scipy.optimize import brentq

    t, after, between = step
    assert problem.events is not None
    value, ends, ways = problem.events(after, between(after))
    found: list[tuple[float, int]] = []
    for k in np.flatnonzero(np.sign(before) * np.sign(value) < 0).tolist():
        if ways[k] and np.sign(value[k]) != np.sign(ways[k]):
            continue

        def height(time: float, k: int = k) -> float:
            assert problem.events is not None
            return float(problem.events(time, between(time))[0][k])

        found.append((float(brentq(height, t, after, xtol=1e-14, rtol=1e-14)), k))
    for time, k in sorted(found, key=lambda each: abs(each[0] - t)):
        course.events.append((time, between(time), k + 1))
        if ends[k]:
            return value, time
    return value, after


# --- what a script calls ----------------------------------------------------------------------


def _options(given: Any) -> dict[str, Any]:
    if isinstance(given, Struct):
        return {name.lower(): value for name, value in given.items() if np.size(value)}
    if np.size(given):
        raise MatlabError("the options of an integration are what 'odeset' returns")
    return {}


def _problem(self: Interpreter, name: str, arguments: Values, frame: Frame) -> Problem:
    if len(arguments) < 3:
        raise MatlabError(f"'{name}' takes a function, a span of times and a start")
    function, span, start, *rest = arguments
    at, y0 = numbers_of(span).ravel(order="F"), numbers_of(start).ravel(order="F")
    if np.iscomplexobj(y0) or np.iscomplexobj(at):
        raise LackError(f"'{name}' integrates real numbers only")
    if at.size < 2 or np.any(np.diff(at) * (at[-1] - at[0]) <= 0.0):
        raise MatlabError(f"'{name}' takes two times or more that rise or fall")
    options, more = _options(rest[0]) if rest else {}, rest[1:]
    for option in sorted(set(options) - _HEEDED - _IDLE):
        raise LackError(f"the option {option!r} of '{name}' is not known here")
    relative = max(scalar(options.get("reltol", 1e-3)), 100.0 * np.finfo(float).eps)
    absolute = numbers_of(options.get("abstol", 1e-6)).ravel()
    if absolute.size not in (1, y0.size) or np.any(absolute <= 0.0):
        raise MatlabError(f"the AbsTol of '{name}' is one positive number or one for each state")

    def slope(t: float, y: Array) -> Array:
        self.budget.step()
        found = self.apply(function, [t, settled(y.reshape(-1, 1)), *more], 1, frame)
        rates = numbers_of(found[0]).ravel(order="F")
        if rates.size != y.size:
            raise MatlabError(f"the function of '{name}' returns {rates.size} of {y.size} slopes")
        if np.iscomplexobj(rates):
            raise MatlabError(f"the function of '{name}' returns complex slopes")
        return rates

    def events(t: float, y: Array) -> tuple[Array, Array, Array]:
        given = [t, settled(y.reshape(-1, 1)), *more]
        value, ends, ways = self.apply(options["events"], given, 3, frame)
        first, *others = (numbers_of(each).ravel() for each in (value, ends, ways))
        last, way = (np.broadcast_to(each, first.shape) for each in others)
        return first, last, way

    return Problem(
        slope=slope,
        at=at,
        start=y0,
        relative=relative,
        absolute=np.broadcast_to(absolute, y0.shape),
        longest=abs(scalar(options.get("maxstep", 0.1 * abs(at[-1] - at[0])))),
        first=abs(scalar(options["initialstep"])) if "initialstep" in options else None,
        refine=int(scalar(options["refine"])) if "refine" in options else None,
        events=events if "events" in options else None,
    )


def _integration(name: str) -> Any:
    """``[t, y] = ode45(function, span, start, options)``: one row a time."""

    def integrate(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
        if not wanted:
            self.host.skip(name, frame, "pictures are not drawn")
            return []
        if wanted == 1:
            raise LackError(f"'{name}' returns times and states, as in [t, y] = {name}(...)")
        problem = _problem(self, name, arguments, frame)
        if name in _SCIPY:
            steps, refine = _of_scipy(problem, _SCIPY[name]), 1
        else:
            pair = _DORMAND_PRINCE if name == "ode45" else _BOGACKI_SHAMPINE
            steps, refine = _explicit(problem, pair), pair.refine
        course = solved(problem, steps, problem.refine or refine)
        self.budget.room(len(course.t) * (problem.start.size + 1.0))
        times, states, which = _columns(course.events, problem.start.size)
        rows = [np.array(course.t).reshape(-1, 1), np.array(course.y)]
        return [settled(each) for each in (*rows, times, states, which)][:wanted]

    return integrate


def _columns(events: list[tuple[float, Array, int]], size: int) -> tuple[Array, Array, Array]:
    if not events:
        return np.zeros((0, 1)), np.zeros((0, size)), np.zeros((0, 1))
    times, states, which = zip(*events, strict=True)
    return np.array([times]).T, np.array(states), np.array([which], dtype=float).T


def _odeset(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``odeset``: options by name, whatever its case, on top of others."""
    known = {name.lower(): name for name in _NAMES}
    made: dict[str, Any] = {}
    while arguments and not isinstance(arguments[0], str):
        given, *arguments = arguments
        made |= {known[name]: value for name, value in _options(given).items() if name in known}
    for name, value in zip(arguments[::2], arguments[1::2], strict=False):
        matches = [full for low, full in known.items() if low.startswith(str(name).lower())]
        exact = known.get(str(name).lower())
        if not (exact or len(matches) == 1):
            raise MatlabError(f"'odeset' has no option {str(name)[:40]!r}")
        made[exact or matches[0]] = value
    return [Struct(made)]


DIFFERENTIAL: dict[str, Any] = {
    **{name: _integration(name) for name in ("ode45", "ode23", *_SCIPY)},
    "odeset": _odeset,
}
