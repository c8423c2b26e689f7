"""Sums of multiples of a network's quantities."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from drake_leg.simulink.networks.elimination import RESIDUE

Role = Literal["across", "through", "rate", "state", "input", "law", "one"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Quantity:
    """A quantity of a network: one that its equations determine, or one that is given."""

    role: Role
    owner: str  # SID of its block, or a port of its connection
    number: int = 0  # among those of its block
    order: int = 0  # how often an input is differentiated
    of: Quantity | None = None  # the state whose rate it is


ONE = Quantity(role="one", owner="")


class Linear(Mapping[Quantity, float]):
    """A sum of multiples of quantities."""

    def __init__(self, terms: Mapping[Quantity, float] | Quantity | float = 0.0) -> None:
        if isinstance(terms, Quantity):
            terms = {terms: 1.0}
        elif isinstance(terms, int | float):
            terms = {ONE: float(terms)}
        self._terms = {quantity: float(factor) for quantity, factor in terms.items() if factor}

    def __getitem__(self, quantity: Quantity) -> float:
        return self._terms[quantity]

    def __iter__(self) -> Iterator[Quantity]:
        return iter(self._terms)

    def __len__(self) -> int:
        return len(self._terms)

    def __add__(self, other: Linear | float) -> Linear:
        other = other if isinstance(other, Linear) else Linear(other)
        both = {**self._terms, **other._terms}
        return Linear({q: self.get(q, 0.0) + other.get(q, 0.0) for q in both})

    def __neg__(self) -> Linear:
        return -1.0 * self

    def __sub__(self, other: Linear | float) -> Linear:
        return self + -1.0 * (other if isinstance(other, Linear) else Linear(other))

    def __rmul__(self, factor: float) -> Linear:
        return Linear({quantity: factor * own for quantity, own in self._terms.items()})


def total(parts: Iterable[tuple[float, Linear]]) -> Linear:
    """Add multiples of sums; what cancels up to rounding is gone."""
    found: dict[Quantity, float] = {}
    sizes: dict[Quantity, float] = {}
    for factor, part in parts:
        for quantity, own in part.items():
            found[quantity] = found.get(quantity, 0.0) + factor * own
            sizes[quantity] = sizes.get(quantity, 0.0) + abs(factor * own)
    return Linear({q: value for q, value in found.items() if abs(value) > RESIDUE * sizes[q]})
