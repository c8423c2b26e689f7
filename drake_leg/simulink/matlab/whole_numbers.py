"""Functions of whole numbers: divisors, primes, bits, and the texts that write them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import Allowance, Known, numbers_of, of_values, settled
from drake_leg.simulink.matlab.inputs import of_array, of_two, scalar, whole
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script

_LARGEST = 2.0**53  # below it, every whole number is one
_DIGITS = "0123456789ABCDEF"


def _whole_numbers(values: Any) -> NDArray[np.int64]:
    """Take numbers for whole ones."""
    array = np.real(np.asarray(values, dtype=complex))
    if np.any(array != np.floor(array)) or np.any(np.abs(array) > _LARGEST):
        raise MatlabError("whole numbers are needed here")
    return array.astype(np.int64)


def _joined(function: Any) -> Known:
    return of_two(lambda a, b: function(_whole_numbers(a), _whole_numbers(b)).astype(float))


def _shifted(a: Any, k: Any) -> Any:
    return np.trunc(_whole_numbers(a) * 2.0 ** _whole_numbers(k))


def _bit(a: Any, place: Any) -> Any:
    return np.mod(np.floor(_whole_numbers(a) / 2.0 ** (_whole_numbers(place) - 1.0)), 2.0)


def _with_bit(a: Any, place: Any, value: Any = 1.0) -> Any:
    """``bitset``: set a bit of a number, or clear it."""
    number, power = whole(a), 2.0 ** (whole(place) - 1)
    is_set = math.floor(number / power) % 2 == 1
    return number + power * ((scalar(value) != 0.0) - is_set)


def _primes(budget: Allowance, wanted: int, most: Any) -> Any:
    """``primes``: all up to a number, by the sieve of Eratosthenes."""
    last = math.floor(scalar(most)) if math.isfinite(scalar(most)) else math.inf
    budget.room(max(float(last), 0.0))
    sieve = np.ones(max(int(last), 1) + 1, dtype=bool)
    sieve[:2] = False
    for number in range(2, math.isqrt(len(sieve)) + 1):
        if sieve[number]:
            sieve[number * number :: number] = False
    return settled(np.flatnonzero(sieve).astype(float).reshape(1, -1))


def _factors(budget: Allowance, number: int) -> list[float]:
    """Find the prime factors of a number, the least first."""
    budget.work(math.sqrt(max(number, 0)))
    found, divisor = [], 2
    while divisor * divisor <= number:
        while number % divisor == 0:
            found.append(float(divisor))
            number //= divisor
        divisor += 1
    return [*found, float(number)] if number > 1 or not found else found


def _factor(budget: Allowance, wanted: int, number: Any) -> Any:
    if whole(number) < 0 or whole(number) > _LARGEST:
        raise MatlabError("'factor' takes a whole number that is not negative")
    return settled(np.array([_factors(budget, whole(number))]))


def _is_prime(budget: Allowance, wanted: int, values: Any) -> Any:
    array = _whole_numbers(numbers_of(values))
    found = [n > 1 and _factors(budget, int(n)) == [float(n)] for n in array.ravel()]
    return settled(np.array(found, dtype=bool).reshape(array.shape))


def _next_power(x: Any) -> Any:
    fraction, power = np.frexp(np.abs(x))
    return power - (fraction == 0.5)


def _written(base: int) -> Any:
    def written(number: Any, least: Any = 1.0) -> str:
        rest = whole(number)
        if rest < 0 or rest > _LARGEST or whole(least) > 1_000:
            raise MatlabError("a whole number that is not negative is needed here")
        text = ""
        while rest:
            rest, digit = divmod(rest, base)
            text = _DIGITS[digit] + text
        return (text or "0").rjust(whole(least), "0")

    return of_values(written)


def _read(base: int) -> Any:
    def read(text: Any) -> float:
        plain = "".join(str(text).split()) if isinstance(text, str) else ""
        try:
            return float(int(plain, base))
        except (ValueError, OverflowError):
            raise MatlabError(f"{str(text)[:40]!r} is no number to the base {base}") from None

    return of_values(read)


def _limit(name: str) -> Known:
    def limit(kind: Any = "int32") -> float:
        text = str(kind)
        if text not in {f"{sign}int{n}" for sign in ("", "u") for n in (8, 16, 32, 64)}:
            raise MatlabError(f"'{name}' takes the name of a type of whole numbers")
        info = np.iinfo(text)
        return float(info.max if name == "intmax" else info.min)

    return of_values(limit)


WHOLE_NUMBERS: dict[str, Known] = {
    "gcd": _joined(np.gcd),
    "lcm": _joined(np.lcm),
    "bitxor": _joined(np.bitwise_xor),
    "bitshift": of_two(_shifted),
    "bitget": of_two(_bit),
    "bitset": of_values(_with_bit),
    "primes": _primes,
    "isprime": _is_prime,
    "factor": _factor,
    "nextpow2": of_array(_next_power),
    "dec2bin": _written(2),
    "dec2hex": _written(16),
    "bin2dec": _read(2),
    "hex2dec": _read(16),
    "intmax": _limit("intmax"),
    "intmin": _limit("intmin"),
}
