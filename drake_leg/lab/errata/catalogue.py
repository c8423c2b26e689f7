"""Lists the errata: their texts from ``errata.toml``, with computed numbers filled in."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from drake_leg.errors import InvalidValueError
from drake_leg.lab.errata import leg_a_errors, leg_b_errors, pendulum_errors, scara_errors
from drake_leg.lab.errata.erratum import Effects, Erratum, filled

EFFECTS: Effects = {
    **pendulum_errors.EFFECTS,
    **leg_a_errors.EFFECTS,
    **scara_errors.EFFECTS,
    **leg_b_errors.EFFECTS,
}


def errata() -> tuple[Erratum, ...]:
    """List the errors in the reports by number, with effects computed from the robots and runs."""
    text = (files(__package__) / "errata.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["erratum"]:
        values = EFFECTS[entry["number"]]() if entry["number"] in EFFECTS else {}
        for part in ("printed", "right", "effect"):
            entry[part] = filled(entry[part], values)
        found.append(Erratum(**entry))
    return tuple(found)


@cache
def errata_by_number() -> Mapping[int, Erratum]:
    """List the errata, computed once."""
    return {erratum.number: erratum for erratum in errata()}


def erratum_of(number: int) -> Erratum:
    """Return the erratum with a number.

    Raises
    ------
    InvalidValueError
        If there is none.
    """
    by_number = errata_by_number()
    if number not in by_number:
        raise InvalidValueError(
            f"there is no erratum {number}; they are numbered from 1 to {len(by_number)}"
        )
    return by_number[number]
