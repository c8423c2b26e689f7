"""Names in a robot's model: which ones SDF takes, and those that are made here."""

from __future__ import annotations

import re
from collections.abc import Iterable

from drake_leg.errors import InvalidValueError

BASE = "base"  # the link that is welded to the world
BASE_WELD = "base_weld"
PLACES = ("base", "cog", "end")  # of every link: a frame each


def frame_name(index: int) -> str:
    """Name the frame of a row.

    Parameters
    ----------
    index : int
        Of the row, counted from 1; 0 is the base.
    """
    return f"frame_{index}"


def place_name(link: str, place: str) -> str:
    """Name a frame on a link.

    Parameters
    ----------
    link : str
        Name of the link.
    place : {"base", "cog", "end"}
        Where on the link.
    """
    return f"{link}_{place}"


def require_name(what: str, name: str) -> None:
    """Refuse a name that SDF reserves or that other programs stumble over.

    Parameters
    ----------
    what : str
        What is named, for the error's sentence.
    name : str
        Letters, digits, _ and -, a letter or _ first.

    Raises
    ------
    InvalidValueError
        With the name and the reason.
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
    """Refuse text that cannot stand on one line of a file.

    Parameters
    ----------
    what : str
        What the text is, for the error's sentence.
    text : str
        Printable characters, or none.

    Raises
    ------
    InvalidValueError
        With the text.
    """
    if not text.isprintable():
        raise InvalidValueError(f"{what} is {text!r}; it must be printable text on one line")


def require_unique(names: Iterable[tuple[str, str]]) -> None:
    """Refuse a name that is given twice.

    Parameters
    ----------
    names : iterable of (str, str)
        Every name with what it names.

    Raises
    ------
    InvalidValueError
        With the name and the two things.
    """
    owners: dict[str, str] = {}
    for name, what in names:
        if name in owners:
            raise InvalidValueError(
                f"the name {name!r} is given twice, to {owners[name]} and to {what}; every link, "
                "joint and frame must have its own"
            )
        owners[name] = what
