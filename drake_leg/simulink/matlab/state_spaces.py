"""Linear systems by their matrices: ``ss``, ``c2d``, ``ssdata``, ``lqr``, ``dlqr``."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from drake_leg.simulink.matlab import numeric
from drake_leg.simulink.matlab.data import (
    Allowance,
    Known,
    LackError,
    LinearSystem,
    Struct,
    settled,
)
from drake_leg.simulink.matlab.inputs import matrix, scalar
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.transfers import TransferFunction

# ruff: noqa: ANN401 - any value of a script
Array = NDArray[np.float64]


class StateSpace(LinearSystem, Struct):
    """A linear system: its fields A, B, C, D, also as small letters, and Ts, 0 if continuous."""

    KIND = "ss"

    @property
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """A, B, C and D."""
        return matrix(self["A"]), matrix(self["B"]), matrix(self["C"]), matrix(self["D"])


def state_space(a: Array, b: Array, c: Array, d: Array, step: float = 0.0) -> StateSpace:
    """Make a system of its matrices and its sample time [s].

    Raises
    ------
    MatlabError
        If their sizes do not fit.
    """
    if d.size == 1 and not np.any(d):
        d = np.zeros((len(c), b.shape[1]))
    n = len(a)
    if a.shape != (n, n) or len(b) != n or c.shape[1] != n or d.shape != (len(c), b.shape[1]):
        sizes = ", ".join(numeric.measure(each) for each in (a, b, c, d))
        raise MatlabError(f"matrices of {sizes} make no linear system")
    found = {name: settled(each) for name, each in zip("ABCDabcd", (a, b, c, d) * 2, strict=True)}
    return StateSpace(**found, Ts=step)


def state_space_of(system: Any) -> StateSpace:
    """Take a transfer function for a system in state space, too."""
    if isinstance(system, StateSpace):
        return system
    if isinstance(system, TransferFunction):
        from scipy.signal import tf2ss

        if system.numerator.size > system.denominator.size:
            raise MatlabError("its numerator has a higher degree than its denominator")
        return state_space(*tf2ss(system.numerator, system.denominator))
    raise LackError("a linear system of this kind is not known here")


def _ss(budget: Allowance, wanted: int, *given: Any) -> Any:
    numbers = [each for each in given if not isinstance(each, str)]
    if len(numbers) < len(given):
        raise LackError("options of 'ss' are not known here")
    if len(numbers) == 1:
        return state_space_of(numbers[0])
    if len(numbers) not in (4, 5):
        raise MatlabError("'ss' takes A, B, C, D, and a sample time")
    step = scalar(numbers[4]) if len(numbers) == 5 else 0.0
    a, b, c, d = map(matrix, numbers[:4])
    return state_space(a, b, c, d, step)


def _sampled(budget: Allowance, wanted: int, system: Any, step: Any, method: Any = "zoh") -> Any:
    """``c2d``: the same at the samples while the inputs are held (``zoh``), or by Tustin's rule."""
    given, h = state_space_of(system), scalar(step)
    a, b, c, d = given.matrices
    if given["Ts"] or h <= 0.0:
        raise MatlabError("'c2d' takes a continuous system and a sample time")
    n, m = b.shape
    budget.work(50.0 * (n + m) ** 3)
    if method == "zoh":
        both = scipy.linalg.expm(np.block([[a, b], [np.zeros((m, n + m))]]) * h)
        return state_space(both[:n, :n], both[:n, n:], c, d, h)
    if method == "tustin":
        half = np.linalg.inv(np.eye(n) - a * h / 2.0)
        return state_space(
            half @ (np.eye(n) + a * h / 2.0), half @ b * h, c @ half, d + c @ half @ b * h / 2.0, h
        )
    raise LackError(f"'c2d' by {method!r} is not known here")


def _matrices(budget: Allowance, wanted: int, system: Any) -> Any:
    given = state_space_of(system)
    return (*(given[name] for name in "ABCD"), given["Ts"])


def regulated(
    budget: Allowance, a: Any, b: Any, q: Any, r: Any, *, name: str, sampled: bool
) -> tuple[Any, Any, Any]:
    """Solve Riccati's equation: the gain, its cost matrix, and the closed loop's eigenvalues."""
    a, b, q = matrix(a), matrix(b), matrix(q)
    r = np.eye(b.shape[1]) if r is None else matrix(r)
    numeric.require_square(a, name)
    budget.work(200.0 * a.size * len(a))
    if sampled:
        cost = scipy.linalg.solve_discrete_are(a, b, q, r)
        gain = np.linalg.solve(r + b.T @ cost @ b, b.T @ cost @ a)
    else:
        cost = scipy.linalg.solve_continuous_are(a, b, q, r)
        gain = np.linalg.solve(r, b.T @ cost)
    closed = np.linalg.eigvals(a - b @ gain)[:, np.newaxis]
    return settled(gain), settled(cost), settled(closed)


def _regulator(name: str, *, sampled: bool) -> Known:
    """``lqr`` or ``dlqr``: gain, its cost matrix, and the closed loop's eigenvalues."""

    def regulator(budget: Allowance, wanted: int, *given: Any) -> Any:
        if given and isinstance(given[0], StateSpace):
            if bool(given[0]["Ts"]) != sampled:
                raise MatlabError("'lqr' takes a continuous system and 'dlqr' a sampled one")
            given = (given[0]["A"], given[0]["B"], *given[1:])
        if len(given) != 4:
            raise LackError("a regulator is made of A, B, Q and R only")
        return regulated(budget, *given, name=name, sampled=sampled)

    return regulator


STATE_SPACES: dict[str, Known] = {
    "ss": _ss,
    "c2d": _sampled,
    "ssdata": _matrices,
    "lqr": _regulator("lqr", sampled=False),
    "dlqr": _regulator("dlqr", sampled=True),
}
