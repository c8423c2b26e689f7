"""All errata, through both reports."""

from __future__ import annotations

import tomllib
from importlib.resources import files

from drake_leg.errata import leg_a, leg_b, pendulum, scara
from drake_leg.errata.erratum import Effects, Erratum, filled

EFFECTS: Effects = {
    **pendulum.EFFECTS,
    **leg_a.EFFECTS,
    **scara.EFFECTS,
    **leg_b.EFFECTS,
}


def errata() -> tuple[Erratum, ...]:
    """List what the reports print wrongly, by number.

    Their effects are computed now, at the robots' and the runs' own numbers.
    """
    text = (files(__package__) / "errata.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["erratum"]:
        values = EFFECTS[entry["number"]]() if entry["number"] in EFFECTS else {}
        for part in ("printed", "right", "effect"):
            entry[part] = filled(entry[part], values)
        found.append(Erratum(**entry))
    return tuple(found)
