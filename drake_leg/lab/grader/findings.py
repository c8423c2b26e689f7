"""A finding: one fault of what is printed, with its place and its remedy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY, asdict, dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Finding:
    """One fault of a table or of a printed matrix, or a part of it that cannot be read.

    An error is certainly wrong, a warning probably. Something that is not understood may be right;
    its remedy says what to write instead.
    """

    place: str  # row 2, or T12 (3, 2)
    fault: str
    remedy: str
    _: KW_ONLY
    severity: Literal["error", "warning"] = "error"
    understood: bool = True  # False: it cannot be read, and may be right
    kind: str = ""  # of the mistake, in a word or a few: transposed, unit, sign
    matrix: str = ""  # name as printed; empty where it is of a table
    entries: tuple[tuple[int, int], ...] = ()  # rows and columns, from 1, that it is about

    def sentence(self) -> str:
        """Write it as one sentence, without a full stop."""
        mark = "" if self.severity == "error" else " (a guess)"
        if not self.understood:
            mark = " (not understood)"
        return f"{self.place}{mark}: {self.fault}; {self.remedy}"

    def as_json(self) -> dict[str, Any]:
        """Return the fields by name."""
        return asdict(self)


def unreadable(place: str, sentence: object, matrix: str = "") -> Finding:
    """Make a finding of a sentence or an error, "what is not understood; what to write"."""
    fault, _, remedy = str(sentence).partition("; ")
    return Finding(place, fault, remedy or "write it another way", understood=False, matrix=matrix)


def errors(findings: Iterable[Finding]) -> list[Finding]:
    """Keep the errors that are understood."""
    return [f for f in findings if f.severity == "error" and f.understood]


def not_understood(findings: Iterable[Finding]) -> list[Finding]:
    """Keep the findings about what cannot be read."""
    return [finding for finding in findings if not finding.understood]
