import subprocess
import sys

import pytest

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.symbolic import catalogue
from drake_leg.symbolic.catalogue import (
    SUBJECTS,
    MissingSymPyError,
    derived_equations,
    require_sympy,
)


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


def test_without_sympy_one_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr(catalogue, "find_spec", lambda name: None)
    with pytest.raises(MissingSymPyError) as refusal:
        derived_equations("leg-a")
    assert isinstance(refusal.value, DrakeLegError)
    assert refusal.value.purpose == "the derivation of leg-a"
    assert str(refusal.value) == (
        "the derivation of leg-a needs SymPy: pip install 'drake-leg[symbolic]'"
    )


def test_with_sympy_nothing_is_said():
    assert require_sympy("anything") is None


def test_the_catalogue_itself_needs_neither_sympy_nor_drake():
    code = (
        "import sys, drake_leg.symbolic.catalogue; "
        "sys.exit(any(name.split('.')[0] in ('sympy', 'pydrake') for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
