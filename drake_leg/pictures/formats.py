"""The file formats in which a run's figures are written, without matplotlib."""

from __future__ import annotations

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError, did_you_mean

FORMATS = ("png", "svg", "pdf")
CHOICES = {"none": (), **{name: (name,) for name in FORMATS}, "all": FORMATS}
CHOSEN = "png"  # by default: what a person looks at


def formats_of(figures: object) -> tuple[str, ...]:
    """Return the formats that a word of ``CHOICES`` asks for.

    Raises
    ------
    InvalidValueError
        If it is another word, or none.
    """
    if isinstance(figures, str) and figures in CHOICES:
        return CHOICES[figures]
    raise InvalidValueError(
        f"figures is {shown(figures)}; it must be one of {', '.join(CHOICES)}",
        advice=did_you_mean(figures, CHOICES) if isinstance(figures, str) else "",
    )
