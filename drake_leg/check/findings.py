"""What a check finds: where, what is wrong, what should stand there."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One fault of a table or of a printed matrix.

    An error cannot be right; a warning can, but is seldom meant.
    """

    place: str  # row 2, or T12 (3, 2)
    fault: str
    remedy: str
    severity: Literal["error", "warning"] = "error"

    def sentence(self) -> str:
        """Say it in one sentence.

        Returns
        -------
        str
            Without a full stop.
        """
        mark = "" if self.severity == "error" else " (a guess)"
        return f"{self.place}{mark}: {self.fault}; {self.remedy}"

    def as_json(self) -> dict[str, str]:
        """Return the fields by name.

        Returns
        -------
        dict
        """
        return asdict(self)


def errors(findings: Iterable[Finding]) -> list[Finding]:
    """Keep what cannot be right.

    Parameters
    ----------
    findings : iterable of Finding
        Errors and warnings.

    Returns
    -------
    list of Finding
    """
    return [finding for finding in findings if finding.severity == "error"]
