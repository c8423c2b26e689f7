"""Vectors that hold the physical signals at the ports of blocks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

Bus = tuple[tuple[str, tuple[int, ...]], ...]  # names, in which a dot leads inwards, and shapes


class Layout:
    """Entries of one vector, by the ports whose signals they hold."""

    def __init__(self) -> None:
        self._slices: dict[str, slice] = {}
        self._shapes: dict[str, tuple[int, ...]] = {}
        self.buses: dict[str, Bus] = {}  # of the ports that put one out
        self.size = 0

    @property
    def slices(self) -> Mapping[str, slice]:
        """Return the entries of each port."""
        return MappingProxyType(self._slices)

    @property
    def shapes(self) -> Mapping[str, tuple[int, ...]]:
        """Return the shape of each port's signal."""
        return MappingProxyType(self._shapes)

    def add(self, port: str, shape: tuple[int, ...] = ()) -> slice:
        """Make room for the signal of a port."""
        last = self.size + math.prod(shape)
        self._slices[port], self._shapes[port] = slice(self.size, last), shape
        self.size = last
        return self._slices[port]
