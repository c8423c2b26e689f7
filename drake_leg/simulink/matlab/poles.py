"""Gains of feedback that put poles where they are wanted, and Riccati's equations, of MATLAB."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab import numeric
from drake_leg.simulink.matlab.data import Allowance, Known, LackError, numbers_of, settled
from drake_leg.simulink.matlab.inputs import matrix
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.state_spaces import StateSpace, regulated

# ruff: noqa: ANN401 - any value of a script
Array = NDArray[Any]


def _pair(given: tuple[Any, ...], names: str, name: str) -> tuple[Array, Array]:
    """Take two matrices, or a system that has them."""
    if len(given) == 1 and isinstance(given[0], StateSpace):
        given = (given[0][names[0]], given[0][names[1]])
    if len(given) != 2:
        raise MatlabError(f"'{name}' takes {names[0]} and {names[1]}, or a system")
    first, second = (matrix(value) for value in given)
    numeric.require_square(first, name)
    return first, second


def _controllable(a: Array, b: Array) -> Array:
    """``[B, A B, A² B, ...]``."""
    if len(b) != len(a):
        raise MatlabError(f"A has {len(a)} rows and B {len(b)}")
    blocks = [b]
    for _ in range(len(a) - 1):
        blocks.append(a @ blocks[-1])
    return np.hstack(blocks)


def _ctrb(budget: Allowance, wanted: int, *given: Any) -> Any:
    a, b = _pair(given, "AB", "ctrb")
    budget.work(float(a.size * b.size * len(a)))
    return settled(_controllable(a, b))


def _obsv(budget: Allowance, wanted: int, *given: Any) -> Any:
    a, c = _pair(given, "AC", "obsv")
    budget.work(float(a.size * c.size * len(a)))
    return settled(_controllable(a.T, c.T).T)


def _acker(budget: Allowance, wanted: int, a: Any, b: Any, poles: Any) -> Any:
    """Ackermann's formula: the last row of the inverse of ``ctrb``, times the polynomial of A."""
    A, B = _pair((a, b), "AB", "acker")
    budget.work(50.0 * A.size * len(A))
    reach = _controllable(A, _one_input(B, "acker"))
    if np.linalg.matrix_rank(reach) < len(A):
        raise MatlabError("'acker': the input does not reach all states")
    wanted_poles = _poles(poles, len(A), "acker")
    value = np.zeros_like(A)
    for coefficient in np.real(np.poly(wanted_poles)):
        value = value @ A + coefficient * np.eye(len(A))
    last = np.zeros(len(A))
    last[-1] = 1.0
    return settled((np.linalg.solve(reach.T, last) @ value)[np.newaxis, :])


def _place(budget: Allowance, wanted: int, a: Any, b: Any, poles: Any) -> Any:
    from scipy.signal import place_poles

    A, B = _pair((a, b), "AB", "place")
    budget.work(500.0 * A.size * len(A))
    wanted_poles = _poles(poles, len(A), "place")
    inputs = np.linalg.matrix_rank(B)
    if any(np.count_nonzero(wanted_poles == pole) > inputs for pole in wanted_poles):
        raise MatlabError(
            f"'place' takes a pole at most {inputs} times, the rank of B: take 'acker'"
        )
    with warnings.catch_warnings():  # that the most robust gains were not found to the last digit
        warnings.simplefilter("ignore", UserWarning)
        return settled(place_poles(A, B, wanted_poles).gain_matrix)


def _one_input(b: Array, name: str) -> Array:
    if b.shape[1] != 1:
        raise MatlabError(f"'{name}' takes one input, not {b.shape[1]}: 'place' takes several")
    return b


def _poles(given: Any, count: int, name: str) -> Array:
    poles = numbers_of(given).ravel()
    if poles.size != count:
        raise MatlabError(f"'{name}' takes {count} poles, not {poles.size}")
    unpaired = np.sort_complex(poles) - np.sort_complex(poles.conj())
    if np.abs(unpaired).max(initial=0.0) > 1e-9 * np.abs(poles).max(initial=0.0):
        raise MatlabError(f"'{name}' takes complex poles in conjugate pairs")
    return poles


def _riccati(name: str, *, sampled: bool, gain_first: bool) -> Known:
    """Solution, gain and poles of the closed loop; the older functions put the gain last."""

    def riccati(
        budget: Allowance, wanted: int, a: Any, b: Any, q: Any, r: Any = None, *more: Any
    ) -> Any:
        if more:
            raise LackError("Riccati's equation has A, B, Q and R only here")
        gain, cost, poles = regulated(budget, a, b, q, r, name=name, sampled=sampled)
        return (cost, gain, poles) if gain_first else (cost, poles, gain)

    return riccati


POLES: dict[str, Known] = {
    "ctrb": _ctrb,
    "obsv": _obsv,
    "acker": _acker,
    "place": _place,
    "care": _riccati("care", sampled=False, gain_first=False),
    "icare": _riccati("icare", sampled=False, gain_first=True),
    "dare": _riccati("dare", sampled=True, gain_first=False),
    "idare": _riccati("idare", sampled=True, gain_first=True),
}
