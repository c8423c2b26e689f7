"""Zeros, minima and integrals of functions of a script: ``fzero``, ``fminsearch``, ``integral``."""

from __future__ import annotations

import math
from collections.abc import Callable
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
_SILENT = frozenset(("display", "diagnostics", "funvalcheck"))  # change no result
_NAMES = {
    name.lower(): name
    for name in (
        "Algorithm", "Diagnostics", "Display", "FunctionTolerance", "FunValCheck", "Jacobian",
        "MaxFunctionEvaluations", "MaxFunEvals", "MaxIter", "MaxIterations",
        "OptimalityTolerance", "SpecifyObjectiveGradient", "StepTolerance", "TolFun", "TolX",
        "TypicalX",
    )
}  # fmt: skip
_ALIKE = {
    "steptolerance": "tolx",
    "functiontolerance": "tolfun",
    "maxiterations": "maxiter",
    "maxfunctionevaluations": "maxfunevals",
}


def _options(name: str, given: Any, heeded: tuple[str, ...], idle: tuple[str, ...] = ()) -> Any:
    """Options by their lower-case names; those that would change a result are refused."""
    if not isinstance(given, Struct):
        if np.size(given):
            raise MatlabError(f"the options of '{name}' are what 'optimset' returns")
        return {}
    lower = {key.lower(): value for key, value in given.items() if np.size(value)}
    options = {_ALIKE.get(key, key): value for key, value in lower.items()}
    for option in sorted(set(options) - {*heeded, *idle} - _SILENT):
        raise LackError(f"the option {option!r} of '{name}' is not known here")
    return options


def _optimset(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``optimset``: options by name, whatever its case, on top of others."""
    made: dict[str, Any] = {}
    while arguments and not isinstance(arguments[0], str):
        given, *arguments = arguments
        made |= given if isinstance(given, Struct) else {}
    if len(arguments) == 1:
        return [Struct(made)]  # the defaults of a solver
    for name, value in zip(arguments[::2], arguments[1::2], strict=True):
        key = _NAMES.get(str(name).lower())
        if key is None:
            raise LackError(f"the option {str(name)[:40]!r} of 'optimset' is not known here")
        made[key] = value
    return [Struct(made)]


def _height(self: Interpreter, name: str, function: Any, frame: Frame) -> Callable[[Any], float]:
    def height(x: Any) -> float:
        self.budget.step()
        given = settled(x) if isinstance(x, np.ndarray) else float(x)
        found = numbers_of(self.apply(function, [given], 1, frame)[0])
        if found.size != 1 or np.iscomplexobj(found):
            raise MatlabError(f"the function of '{name}' must return one real number")
        return float(found.flat[0])

    return height


def _zero(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``[x, fval, flag] = fzero(function, start or bracket, options)``."""
    from scipy.optimize import brentq

    function, start, *rest = arguments
    options = _options("fzero", rest[0], ("tolx",)) if rest else {}
    height = _height(self, "fzero", function, frame)
    low, high = _bracket(height, numbers_of(start).ravel())
    tolerance = max(scalar(options.get("tolx", 2.3e-16)), 1e-300)
    x = low if low == high else float(brentq(height, low, high, xtol=tolerance, rtol=8.9e-16))
    return [x, height(x), 1.0][: max(1, wanted)]


def _bracket(height: Callable[[Any], float], start: Array) -> tuple[float, float]:
    """Two places at which the signs differ; around a start, further and further by √2."""
    if start.size == 2:
        low, high = map(float, start)
        a, b = height(low), height(high)
        if a * b > 0.0 or not math.isfinite(a + b):
            raise MatlabError(
                f"'fzero' needs a change of sign between {low:g} and {high:g}: the function is "
                f"{a:g} and {b:g} there"
            )
        return (low, low) if a == 0.0 else (high, high) if b == 0.0 else (low, high)
    middle = float(start[0])
    at, step = height(middle), abs(middle) / 50.0 or 1.0 / 50.0
    if at == 0.0:
        return middle, middle
    low = high = middle
    for _ in range(2_100):
        step *= math.sqrt(2.0)
        for end in (middle - step, middle + step):
            found = height(end)
            if not math.isfinite(found):
                raise MatlabError(f"'fzero' meets {found:g} at {end:g}: give a bracket")
            if found * at <= 0.0:
                return (low, end) if end > middle else (end, high)
    raise MatlabError(f"'fzero' finds no change of sign around {middle:g}")


def _simplex(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``[x, fval, flag] = fminsearch(function, start, options)``: Nelder and Mead's simplex."""
    from scipy.optimize import minimize

    function, start, *rest = arguments
    heeded = ("tolx", "tolfun", "maxiter", "maxfunevals")
    options = _options("fminsearch", rest[0], heeded) if rest else {}
    shape, x0 = numbers_of(start).shape, numbers_of(start).ravel(order="F")
    height = _height(self, "fminsearch", function, frame)
    found = minimize(
        lambda x: height(x.reshape(shape, order="F")),
        x0,
        method="Nelder-Mead",
        options={
            "xatol": scalar(options.get("tolx", 1e-4)),
            "fatol": scalar(options.get("tolfun", 1e-4)),
            "maxiter": int(scalar(options.get("maxiter", 200.0 * x0.size))),
            "maxfev": int(scalar(options.get("maxfunevals", 200.0 * x0.size))),
        },
    )
    x = settled(found.x.reshape(shape, order="F"))
    return [x, float(found.fun), float(found.success)][: max(1, wanted)]


def _within(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``[x, fval, flag] = fminbnd(function, low, high, options)``."""
    from scipy.optimize import minimize_scalar

    function, low, high, *rest = arguments
    options = _options("fminbnd", rest[0], ("tolx", "maxiter", "maxfunevals")) if rest else {}
    if scalar(low) > scalar(high):
        raise MatlabError(f"'fminbnd' needs bounds that rise, not {low:g} and {high:g}")
    counts = (options.get("maxiter", 500.0), options.get("maxfunevals", 500.0))
    found = minimize_scalar(
        _height(self, "fminbnd", function, frame),
        bounds=(scalar(low), scalar(high)),
        method="bounded",
        options={
            "xatol": scalar(options.get("tolx", 1e-4)),
            "maxiter": int(min(map(scalar, counts))),
        },
    )
    return [float(found.x), float(found.fun), float(found.success)][: max(1, wanted)]


def _solve(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``[x, fval, flag] = fsolve(function, start, options)``: a zero of several equations."""
    from scipy.optimize import root

    function, start, *rest = arguments
    heeded = ("tolx", "tolfun", "maxiter", "maxfunevals")
    idle = ("algorithm", "optimalitytolerance", "jacobian", "specifyobjectivegradient", "typicalx")
    if rest:
        _options("fsolve", rest[0], heeded, idle)  # more accurate than any of them asks
    shape, x0 = numbers_of(start).shape, numbers_of(start).ravel(order="F")

    def heights(x: Array) -> Array:
        self.budget.step()
        given = settled(x.reshape(shape, order="F"))
        return numbers_of(self.apply(function, [given], 1, frame)[0]).ravel(order="F")

    square = heights(x0).size == x0.size
    found = root(heights, x0, method="hybr" if square else "lm", tol=1e-12)
    value = heights(found.x)
    flag = 1.0 if np.max(np.abs(value), initial=0.0) < 1e-6 else -2.0
    if flag < 0.0 and wanted < 3:
        left = np.max(np.abs(value))
        raise MatlabError(f"'fsolve' finds no zero from its start: it ends where {left:g} is left")
    x = settled(found.x.reshape(shape, order="F"))
    return [x, settled(value.reshape(-1, 1)), flag][: max(1, wanted)]


def _integral(name: str) -> Any:
    """``integral(function, low, high)`` and its predecessors; their tolerances are met."""

    def integrate(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
        from scipy.integrate import quad

        function, low, high, *options = arguments
        for key in options[::2] if name in ("integral", "quadgk") else ():
            if str(key).lower() not in ("abstol", "reltol", "arrayvalued"):
                raise LackError(f"the option {str(key)[:40]!r} of '{name}' is not known here")
        height = _height(self, name, function, frame)
        ends = scalar(low), scalar(high)
        value, error, *_ = quad(height, *ends, epsabs=1e-12, epsrel=1e-10, limit=500, full_output=1)
        if not math.isfinite(value) or error > 1e-6 * max(1.0, abs(value)):
            raise MatlabError(f"'{name}' does not converge: its error is {error:g}")
        return [float(value)]

    return integrate


SEARCHING: dict[str, Any] = {
    "fzero": _zero,
    "fminsearch": _simplex,
    "fminbnd": _within,
    "fsolve": _solve,
    "optimset": _optimset,
    **{name: _integral(name) for name in ("integral", "quad", "quadl", "quadgk")},
}
