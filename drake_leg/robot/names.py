"""Names in a robot's model and which of them SDF accepts; tables for notebooks."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape

from drake_leg.errors import InvalidValueError

BASE = "base"  # the link that is welded to the world
BASE_WELD = "base_weld"
PLACES = ("base", "cog", "end")  # of every link: a frame each


def frame_name(index: int) -> str:
    """Name the frame of a row, counted from 1; 0 is the base."""
    return f"frame_{index}"


def place_name(link: str, place: str) -> str:
    """Name a frame on a link: its base, its centre of gravity or its end."""
    return f"{link}_{place}"


def require_name(what: str, name: str) -> None:
    """Refuse a name that SDF reserves or that other programs cannot read.

    Allowed are letters, digits, _ and -, beginning with a letter or _.
    """
    if not name:
        raise InvalidValueError(f"{what} is empty; it must be a name")
    if "::" in name:
        raise InvalidValueError(
            f"{what} is {name!r}; SDF keeps '::' for models inside of models: leave it out"
        )
    if name == "world" or re.fullmatch(r"__.*__", name):
        raise InvalidValueError(f"{what} is {name!r}, which SDF reserves; choose another name")
    if not re.fullmatch(r"[^\W\d][\w-]*", name):
        raise InvalidValueError(
            f"{what} is {name!r}; it must have letters, digits, _ and - only, and begin with a "
            "letter"
        )


def require_line(what: str, text: str) -> None:
    """Refuse text that is not printable on one line."""
    if not text.isprintable():
        raise InvalidValueError(f"{what} is {text!r}; it must be printable text on one line")


def require_unique(names: Iterable[tuple[str, str]]) -> None:
    """Refuse a name that is used twice, from pairs of a name and what it names."""
    owners: dict[str, str] = {}
    for name, what in names:
        if name in owners:
            raise InvalidValueError(
                f"the name {name!r} is given twice, to {owners[name]} and to {what}; every link, "
                "joint and frame must have its own"
            )
        owners[name] = what


def html_table(headings: Sequence[str], rows: Iterable[Sequence[object]], *, title: str) -> str:
    """Return a table with its title above; all texts are escaped."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f"<p><b>{escape(title)}</b></p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )
