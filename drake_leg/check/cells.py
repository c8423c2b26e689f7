"""A cell of a printed table: what its text is, and in which columns such a thing may stand."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Literal

from drake_leg.check.expressions import names_in, parse_formula
from drake_leg.check.notation import plain, quoted
from drake_leg.errors import InvalidValueError

Kind = Literal["nothing", "zero", "number", "length", "angle", "variable", "fixed", "other"]
Sort = Literal["type", "length", "offset", "twist", "turn"]

# What may stand in a column of each sort: d, r, alpha, theta; sigma has its own rule.
_FITTING: dict[Sort, set[Kind]] = {
    "length": {"zero", "number", "length"},
    "offset": {"zero", "number", "length", "variable"},
    "twist": {"zero", "number", "angle"},
    "turn": {"zero", "number", "angle", "variable"},
}
_UNITS = {"mm", "cm", "m"}
_WORDS: dict[Kind, str] = {
    "length": "a length",
    "angle": "an angle",
    "variable": "a joint's variable",
    "fixed": "the mark of a fixed row",
    "number": "a number",
    "zero": "zero",
    "nothing": "empty",
    "other": "neither a number nor a formula",
}


def kind_of(text: str, variables: Collection[str] = ()) -> Kind:
    """Say what the text of a cell is.

    Parameters
    ----------
    text : str
        As printed: ``0``, ``L_1``, ``90°``, ``θ_2``, ``~``, ``452.4-340-R``.
    variables : collection of str
        Names, in lower case, that stand for a joint's position, besides θ1, q1 and the like.

    Returns
    -------
    str
        A bare number is ``number``, whatever its unit.
    """
    if not text.strip():
        return "nothing"
    if text.strip() in ("~", "fixed"):
        return "fixed"
    try:
        tree = parse_formula(text, variables)
    except InvalidValueError:
        return "other"
    names = names_in(tree)
    if any(re.fullmatch(r"q\d", name) or name in variables for name in names):
        return "variable"
    if re.search(r"°|deg|rad|pi", plain(text)):
        return "angle"
    if names:
        return "length"
    return "zero" if re.fullmatch(r"[-+]?0*\.?0*", plain(text)) else "number"


def fits(text: str, sort: Sort, variables: Collection[str] = ()) -> bool:
    """Whether a cell's text may stand in a column."""
    if sort == "type":
        return text.strip() in ("0", "1", "~")
    return kind_of(text, variables) in _FITTING[sort]


def unreadable(text: str, variables: Collection[str] = ()) -> bool:
    """Whether a cell's text is no formula, so that nobody can say what it is."""
    return kind_of(text, variables) == "other"


def described(text: str, variables: Collection[str] = ()) -> str:
    """Show a cell with what it is.

    Returns
    -------
    str
        For example ``'L_1', a length``.
    """
    return f"{quoted(text, 40)}, {_WORDS[kind_of(text, variables)]}"
