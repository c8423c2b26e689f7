"""Explicit steps of order 5 with error control, for what is not stiff.

The method is that of J. R. Dormand and P. J. Prince: A family of embedded Runge-Kutta formulae,
J. Comput. Appl. Math. 6 (1980), with SciPy's numbers.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import RK45

from drake_leg.simulink.running.rosenbrock import Array, Rates

STABLE = 3.3  # largest product of a step and an eigenvalue
STABLE_SWING = 1.0  # that of one whose real part is a small share of it
SWING = 0.01  # that share
BOUND = 0.15  # of it, from which on a step is taken to be bounded by what is fast


def longest_stable(poles: NDArray[np.complex128]) -> float:
    """Return the longest step that is stable for eigenvalues [1/s], infinite where all are."""
    sizes = np.abs(poles)
    products = np.where(_are_swings(poles), STABLE_SWING, STABLE)
    return float((products / np.maximum(sizes, 1e-300)).min(initial=math.inf))


def swings(poles: NDArray[np.complex128]) -> bool:
    """Tell whether the largest of some eigenvalues is one of a swing that hardly decays."""
    sizes = np.abs(poles)
    return bool((_are_swings(poles) & (sizes == sizes.max(initial=0.0))).any())


def _are_swings(poles: NDArray[np.complex128]) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = np.abs(poles.real) < SWING * np.abs(poles)
    return found


class DormandPrince:
    """Explicit steps: cheap where their length is not bounded by what is fast."""

    name = "dopri5"
    cost = 6

    def __init__(self, size: int) -> None:
        self._stages = np.zeros((7, size))
        self._is_kept = False  # whether the last stage is where the next step begins
        self._h = 0.0
        self.is_bounded = False  # whether the last step is as long as what is fast lets it be

    def begin(self, rates: Rates, t: float, x: Array, _: float) -> None:
        """Find the first stage, unless the last step knows it."""
        self._stages[0] = self._stages[6] if self._is_kept else rates(t, x)
        self._is_kept = False

    def attempt(self, rates: Rates, t: float, x: Array, h: float) -> tuple[Array, Array]:
        """Return the states after a step, and their errors."""
        k = self._stages
        for stage in range(1, 6):
            last = x + h * (RK45.A[stage, :stage] @ k[:stage])
            k[stage] = rates(t + RK45.C[stage] * h, last)
        new: Array = x + h * (RK45.B @ k[:6])
        k[6] = rates(t + h, new)
        # Two stages at one time tell the largest eigenvalue, as E. Hairer and G. Wanner use them.
        apart = np.abs(new - last).max(initial=0.0)
        faster = np.abs(k[6] - k[5]).max(initial=0.0)
        self.is_bounded = bool(h * faster > BOUND * STABLE * apart)
        self._h, self._is_kept = h, True
        return new, np.abs(h * (RK45.E @ k))

    def between(self, share: float, before: Array, _: Array) -> Array:
        """Return the states at a share of the last step."""
        powers = share ** np.arange(1.0, 5.0)
        found: Array = before + self._h * (RK45.P @ powers) @ self._stages
        return found

    def forget(self) -> None:
        """Begin the next step anew: the states or the rates have changed."""
        self._is_kept = False
