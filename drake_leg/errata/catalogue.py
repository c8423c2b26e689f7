"""All errata, through both reports."""

from __future__ import annotations

from drake_leg.errata.erratum import Erratum
from drake_leg.errata.headings import headings_errata
from drake_leg.errata.leg_a import leg_a_errata
from drake_leg.errata.leg_b import leg_b_errata
from drake_leg.errata.pendulum import pendulum_errata
from drake_leg.errata.scara import scara_errata


def errata() -> tuple[Erratum, ...]:
    """List what the reports print wrongly, by number.

    Returns
    -------
    tuple of Erratum
        Numbered from 1; their effects computed now, at the robots' and the runs' own numbers.

    References
    ----------
    Report A, chapters 1 and 2; report B, experiments 1 and 2.
    """
    subjects = (pendulum_errata, leg_a_errata, scara_errata, leg_b_errata, headings_errata)
    found = (erratum for subject in subjects for erratum in subject())
    return tuple(sorted(found, key=lambda erratum: erratum.number))
