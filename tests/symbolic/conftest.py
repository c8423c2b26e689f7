"""What the symbolic rooms' tests share: each robot is derived once."""

from functools import cache

import pytest

from drake_leg.symbolic import equations
from drake_leg.symbolic.catalogue import SUBJECTS
from drake_leg.symbolic.derivation import derive

NUMBERED = {
    "leg-a": equations.leg_a_equations,
    "leg-b": equations.leg_b_equations,
    "scara": equations.scara_equations,
}


@cache
def _derivation(name):
    return derive(SUBJECTS[name].robot.rows, SUBJECTS[name].task)


@pytest.fixture(scope="session")
def derived():
    """Derivation of a subject of the catalogue."""
    return _derivation


@pytest.fixture(scope="session")
def numbered():
    """Numbered equations of a subject: label -> list of equations."""

    @cache
    def by_label(name):
        found = {}
        for equation in NUMBERED[name](_derivation(name)):
            found.setdefault(equation.label, []).append(equation)
        return found

    return by_label
