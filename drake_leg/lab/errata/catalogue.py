"""The errors in the two reports: texts from ``errata.toml``, with effects computed here."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError
from drake_leg.lab.errata.of_leg_a import OF_LEG_A
from drake_leg.lab.errata.of_leg_b import OF_LEG_B
from drake_leg.lab.errata.of_the_pendulum import OF_THE_PENDULUM
from drake_leg.lab.errata.of_the_scara import OF_THE_SCARA
from drake_leg.lab.errata.wording import Filled

EFFECTS = {**OF_THE_PENDULUM, **OF_LEG_A, **OF_LEG_B, **OF_THE_SCARA}  # by the errata's numbers


@dataclass(frozen=True, kw_only=True)
class Erratum:
    """One error of a report."""

    number: int  # 1 to 25 through both reports, from 26 through both again
    source: str  # the report
    where: str  # section, equation, table or figure there
    printed: str  # what it prints: text in quotation marks, a formula without
    right: str  # what it should print
    effect: str  # a sentence on the error's effect, with computed numbers

    def _repr_html_(self) -> str:
        from drake_leg.lab.page.pieces import errata_in_notebook

        return errata_in_notebook([self.number])


@cache
def texts_by_number() -> Mapping[int, Mapping[str, Any]]:
    """Read ``errata.toml``: the fields of the errata, before the numbers are filled in."""
    content = (files(__package__) / "errata.toml").read_text(encoding="utf-8")
    return {entry["number"]: entry for entry in tomllib.loads(content)["erratum"]}


def errata() -> tuple[Erratum, ...]:
    """List the errors in the reports by number, with effects computed from the robots and runs."""
    return tuple(map(_computed, texts_by_number()))


@cache
def erratum_of(number: int) -> Erratum:
    """Return the erratum with a number, computed once; refuse a number without one."""
    if number not in texts_by_number():
        raise InvalidValueError(
            f"there is no erratum {shown(number)}; they are numbered from 1 to "
            f"{len(texts_by_number())}"
        )
    return _computed(number)


def _computed(number: int) -> Erratum:
    values = EFFECTS[number]() if number in EFFECTS else {}
    fields: dict[str, Any] = {
        name: Filled().vformat(field, (), values)
        if name in ("printed", "right", "effect")
        else field
        for name, field in texts_by_number()[number].items()
    }
    return Erratum(**fields)
