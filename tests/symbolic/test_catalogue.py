import subprocess
import sys

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.catalogue import SUBJECTS, derived_equations


def test_the_subjects_are_the_reports():
    assert list(SUBJECTS) == ["leg-a", "leg-b", "scara"]


def test_the_numbered_equations_come_first_and_the_findings_last():
    equations = derived_equations("scara")
    labels = [equation.label for equation in equations]
    assert labels[:7] == ["1.3"] * 4 + ["1.4", "1.5", "1.6"]
    assert set(labels[7:]) == {""}
    assert len(labels) > 9


@pytest.mark.parametrize("name", ["", "leg", "pendulum", "leg_a", "SCARA"])
def test_an_unknown_name_is_refused_with_the_known_ones(name):
    with pytest.raises(InvalidValueError, match="leg-a, leg-b, scara") as refusal:
        derived_equations(name)
    assert repr(name) in str(refusal.value)


def test_the_catalogue_itself_needs_neither_sympy_nor_drake():
    code = (
        "import sys, drake_leg.symbolic.catalogue; "
        "sys.exit(any(name.split('.')[0] in ('sympy', 'pydrake') for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
