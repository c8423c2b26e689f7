"""What a comparison found, as data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

Item = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Every block, wire and parameter of the model, and what became of it.

    The items are plain dictionaries, ready for JSON. ``what`` says what they are about:
    ``block``, ``wire``, ``node`` (a physical connection), ``parameter``, ``scale`` (one factor of
    all lengths).
    """

    matched: list[Item] = field(default_factory=list)
    missing: list[Item] = field(default_factory=list)
    extra: list[Item] = field(default_factory=list)
    different: list[Item] = field(default_factory=list)
    tolerated: list[Item] = field(default_factory=list)  # different, but not by what counts

    @property
    def agrees(self) -> bool:
        """Whether everything in the model has its counterpart, with equal values."""
        return not (self.missing or self.different)

    def as_json(self) -> dict[str, list[Item]]:
        """Return the lists under their names."""
        return {
            "matched": self.matched,
            "missing": self.missing,
            "extra": self.extra,
            "different": self.different,
            "tolerated": self.tolerated,
        }
