"""All errata, through both reports; SymPy is imported only when they are listed."""

from __future__ import annotations

import tomllib
from importlib.resources import files

from drake_leg.lab.errata.erratum import Effects, Erratum, filled
from drake_leg.symbolic.catalogue import require_sympy


def errata() -> tuple[Erratum, ...]:
    """List what the reports print wrongly, by number.

    Their effects are computed now, at the robots' and the runs' own numbers.

    Raises
    ------
    MissingSymPyError
        If SymPy is not installed.
    """
    effects = _effects()
    text = (files(__package__) / "errata.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["erratum"]:
        values = effects[entry["number"]]() if entry["number"] in effects else {}
        for part in ("printed", "right", "effect"):
            entry[part] = filled(entry[part], values)
        found.append(Erratum(**entry))
    return tuple(found)


def _effects() -> Effects:
    require_sympy("the list of errata")
    from drake_leg.lab.errata import leg_a_errors
    from drake_leg.lab.errata import leg_b_errors
    from drake_leg.lab.errata import pendulum_errors
    from drake_leg.lab.errata import scara_errors

    return {**pendulum_errors.EFFECTS, **leg_a_errors.EFFECTS, **scara_errors.EFFECTS, **leg_b_errors.EFFECTS}
