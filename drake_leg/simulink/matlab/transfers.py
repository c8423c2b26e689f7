"""Transfer functions of one input and one output: ``tf``, ``zpk``, ``pid``, and their algebra."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Known,
    LackError,
    LinearSystem,
    boxed,
    numbers_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script


@dataclass(frozen=True, eq=False)
class TransferFunction(LinearSystem):
    """A fraction of polynomials in s, the highest powers first."""

    KIND = "tf"
    numerator: NDArray[np.float64]
    denominator: NDArray[np.float64]


def _row(value: Any) -> NDArray[np.float64]:
    if isinstance(value, Cell) and value.items.size == 1:
        value = value.items.flat[0]
    row = np.trim_zeros(np.atleast_1d(numbers_of(value).ravel()), "f")
    if np.iscomplexobj(row):
        raise LackError("a transfer function with complex coefficients is not known here")
    return row if row.size else np.zeros(1)


def _fraction(numerator: Any, denominator: Any) -> TransferFunction:
    n, d = _row(numerator), _row(denominator)
    if not d.any():
        raise MatlabError("the denominator of a transfer function is zero")
    return TransferFunction(n, d)


def transfer_of(value: Any) -> TransferFunction:
    """Take a number for a transfer function, too."""
    return value if isinstance(value, TransferFunction) else _fraction(value, 1.0)


def _tf(numerator: Any, denominator: Any = None, *options: Any) -> TransferFunction:
    if isinstance(numerator, str):
        if numerator != "s":
            raise LackError(f"tf('{numerator}') is not known here, only tf('s')")
        return _fraction(np.array([[1.0, 0.0]]), 1.0)
    if denominator is None:
        return transfer_of(numerator)
    if options and not isinstance(options[0], str) and numbers_of(options[0]).any():
        raise LackError("a sampled transfer function is not known here")
    return _fraction(numerator, denominator)


def _zpk(zeros: Any, poles: Any, gain: Any = 1.0) -> TransferFunction:
    n, d = (np.real(np.poly(numbers_of(each).ravel())) for each in (zeros, poles))
    return _fraction(numbers_of(gain).item() * np.atleast_1d(n), np.atleast_1d(d))


def _pid(kp: Any = 1.0, ki: Any = 0.0, kd: Any = 0.0, tf: Any = 0.0) -> TransferFunction:
    p, i, d, lag = (float(numbers_of(each).item()) for each in (kp, ki, kd, tf))
    s, one = np.array([1.0, 0.0]), np.ones(1)
    filtered = np.array([lag, 1.0]) if lag else one
    parts = (TransferFunction(p * one, one), _fraction(d * s, filtered))
    total = combined_transfers("+", *parts)
    return combined_transfers("+", total, _fraction(i * one, s)) if i else total


def _feedback(forward: Any, back: Any, sign: Any = -1.0) -> TransferFunction:
    g, h = transfer_of(forward), transfer_of(back)
    n = np.polymul(g.numerator, h.denominator)
    open_loop = np.polymul(g.numerator, h.numerator)
    factor = -float(numbers_of(sign).item())
    return _fraction(n, np.polyadd(np.polymul(g.denominator, h.denominator), factor * open_loop))


def combined_transfers(symbol: str, left: Any, right: Any) -> TransferFunction:
    """Carry out an operator on two transfer functions, one of which may be a number."""
    if symbol in ("^", ".^"):
        a, power = transfer_of(left), int(numbers_of(right).item())
        if power < 0:
            a, power = TransferFunction(a.denominator, a.numerator), -power
        found = _fraction(1.0, 1.0)
        for _ in range(min(power, 100)):
            found = combined_transfers("*", found, a)
        return found
    a, b = transfer_of(left), transfer_of(right)
    if symbol in ("/", "./"):
        b, symbol = _fraction(b.denominator, b.numerator), "*"
    if symbol in ("*", ".*"):
        return _fraction(
            np.polymul(a.numerator, b.numerator), np.polymul(a.denominator, b.denominator)
        )
    if symbol not in ("+", "-"):
        raise LackError(f"the operator {symbol} of transfer functions is not known here")
    joined: NDArray[Any] = a.denominator
    n1: NDArray[Any] = a.numerator
    n2: NDArray[Any] = b.numerator
    if not np.array_equal(a.denominator, b.denominator):
        joined = np.polymul(a.denominator, b.denominator)
        n1 = np.polymul(a.numerator, b.denominator)
        n2 = np.polymul(b.numerator, a.denominator)
    return _fraction(np.polyadd(n1, n2) if symbol == "+" else np.polysub(n1, n2), joined)


def _tfdata(budget: Allowance, wanted: int, system: Any, *how: Any) -> Any:
    found = transfer_of(system)
    size = max(found.numerator.size, found.denominator.size)
    rows = [
        settled(np.pad(row, (size - row.size, 0)).reshape(1, -1))
        for row in (found.numerator, found.denominator)
    ]
    parts = tuple(rows) if "v" in how else tuple(Cell(boxed([[row]])) for row in rows)
    return parts[: max(wanted, 1)] if wanted > 1 else parts[0]


TRANSFERS: dict[str, Known] = {
    "tf": of_values(_tf),
    "zpk": of_values(_zpk),
    "pid": of_values(_pid),
    "feedback": of_values(_feedback),
    "series": of_values(lambda a, b: combined_transfers("*", a, b)),
    "parallel": of_values(lambda a, b: combined_transfers("+", a, b)),
    "minreal": of_values(lambda system, *tolerance: transfer_of(system)),
    "tfdata": _tfdata,
}
