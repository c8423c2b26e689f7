"""What the symbolic rooms' tests share: each robot is derived once."""

from functools import cache

import pytest

from drake_leg.symbolic import equations
from drake_leg.symbolic.catalogue import derived as derived_robot

NUMBERED = {
    "leg-a": equations.leg_a_equations,
    "leg-b": equations.leg_b_equations,
    "scara": equations.scara_equations,
}


@pytest.fixture(scope="session")
def derived():
    """Derivation of a subject of the catalogue."""
    return derived_robot


@pytest.fixture(scope="session")
def numbered():
    """Numbered equations of a subject: label -> list of equations."""

    @cache
    def by_label(name):
        found = {}
        for equation in NUMBERED[name](derived_robot(name)):
            found.setdefault(equation.label, []).append(equation)
        return found

    return by_label
