"""Rodas5P: stiff equations in linearly implicit steps of order 5, with error control.

The method is G. Steinebach's: Construction of Rosenbrock-Wanner method Rodas5P and numerical
benchmarks within the Julia Differential Equations package, BIT Numerical Mathematics 63 (2023).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from drake_leg.simulink.running.sparsity import Pattern, groups_of

Array = NDArray[np.float64]
Rates = Callable[[float, Array], Array]

GAMMA = 0.21193756319429014
_A = """3
2.849394379747939 0.45842242204463923
-6.954028509809101 2.489845061869568 -10.358996098473584
2.8029986275628964 0.5072464736228206 -0.3988312541770524 -0.04721187230404641
-7.502846399306121 2.561846144803919 -11.627539656261098 -0.18268767659942256 0.030198172008377946
-7.502846399306121 2.561846144803919 -11.627539656261098 -0.18268767659942256 0.030198172008377946 1
-7.502846399306121 2.561846144803919 -11.627539656261098 -0.18268767659942256 0.030198172008377946 1 1
"""  # noqa: E501 - a row a line
_C = """-14.155112264123755
-17.97296035885952 -2.859693295451294
147.12150275711716 -1.41221402718213 71.68940251302358
165.43517024871676 -0.4592823456491126 42.90938336958603 -5.961986721573306
24.854864614690072 -3.0009227002832186 47.4931110020768 5.5814197821558125 -0.6610691825249471
30.91273214028599 -3.1208243349937974 77.79954646070892 34.28646028294783 -19.097331116725623 -28.087943162872662
37.80277123390563 -3.2571969029072276 112.26918849496327 66.9347231244047 -40.06618937091002 -54.66780262877968 -9.48861652309627
"""  # noqa: E501 - a row a line
NODES = (0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664,
         1.0, 1.0, 1.0)  # fmt: skip
OF_TIME = (0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734,
           2.325825639765069, 0.0, 0.0, 0.0)  # fmt: skip
BETWEEN = np.array([
    [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
     0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
    [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
     20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372],
    [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
     -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722],
])  # fmt: skip
STAGES = len(NODES)
DIFFERENCE = math.sqrt(np.finfo(float).eps)


def _lower(text: str) -> list[Array]:
    rows = [np.array(line.split(), dtype=float) for line in text.splitlines()]
    return [np.zeros(0), *rows]


A, C = _lower(_A), _lower(_C)


class Rosenbrock:
    """Linearly implicit steps: as long as the accuracy lets them be, however stiff the equations.

    Parameters
    ----------
    pattern : (n, n)
        Which rates, in rows, may depend on which states.
    """

    name = "rodas5p"

    def __init__(self, pattern: Pattern) -> None:
        self._pattern = pattern
        self._groups = groups_of(pattern)
        self._slopes = np.zeros((len(BETWEEN), len(pattern)))
        self._jacobian: Array = np.zeros(pattern.shape)
        self._now: Array = np.zeros(len(pattern))
        self._of_time: Array = self._now

    @property
    def cost(self) -> int:
        """Return how many evaluations a step takes."""
        return STAGES + 1 + len(self._groups)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Return the eigenvalues of the last Jacobian [1/s]; infinite ones where it has none."""
        if not np.isfinite(self._jacobian).all():
            return np.array([-np.inf + 0j])
        found: NDArray[np.complex128] = np.linalg.eigvals(self._jacobian).astype(complex)
        return found

    def begin(self, rates: Rates, t: float, x: Array, end: float) -> None:
        """Find the derivatives of the rates by the states, and by time."""
        now = rates(t, x)
        jacobian = np.zeros((x.size, x.size))
        steps = DIFFERENCE * np.maximum(1.0, np.abs(x))
        for group in self._groups:
            moved = x.copy()
            moved[group] += steps[group]
            change = (rates(t, moved) - now)[:, np.newaxis] / (moved - x)[group]
            jacobian[:, group] = np.where(self._pattern[:, group], change, 0.0)
        later = t + min(DIFFERENCE * max(1.0, abs(t)), 0.5 * (end - t))
        self._jacobian, self._now = jacobian, now
        self._of_time = (rates(later, x) - now) / (later - t)

    def attempt(self, rates: Rates, t: float, x: Array, h: float) -> tuple[Array, Array]:
        """Return the states after a step, and their errors."""
        increments = _increments(rates, t, x, h, self._now, self._jacobian, self._of_time)
        self._slopes = BETWEEN @ increments
        found: Array = x + A[-1] @ increments[:-1] + increments[-1]
        return found, np.abs(increments[-1])

    def between(self, share: float, before: Array, after: Array) -> Array:
        """Return the states at a share of the last step."""
        first, second, third = self._slopes
        bend = first + share * (second + share * third)
        found: Array = (1.0 - share) * before + share * (after + (1.0 - share) * bend)
        return found

    def forget(self) -> None:
        """Keep nothing from one step to the next."""


def _increments(
    rates: Rates, t: float, x: Array, h: float, now: Array, jacobian: Array, of_time: Array
) -> Array:
    """Return what each stage adds; the last is the error of the solution without it."""
    found = np.zeros((STAGES, x.size))
    lu, pivots, _ = dgetrf(np.eye(x.size) / (h * GAMMA) - jacobian, overwrite_a=True)
    for stage in range(STAGES):
        slope = now
        if stage:
            slope = rates(t + NODES[stage] * h, x + A[stage] @ found[:stage])
            slope = slope + C[stage] @ found[:stage] / h
        found[stage] = dgetrs(lu, pivots, slope + h * OF_TIME[stage] * of_time)[0]
    return found
