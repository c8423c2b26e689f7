"""Expressions of blocks."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled_expression
from drake_leg.simulink.matlab.folders import Folders

U = np.array([2.0, -3.0, 0.5])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("u(1)*exp(-u(2))", 2 * math.exp(3)),
        ("u[1] * u[3]", 1.0),
        ("u[1] > 1 && u[2] < 0", 1.0),
        ("u(1) == 2 || !(u(2) != 3)", 1.0),
        ("!u(1)", 0.0),
        ("pow(u[1], 3) + sgn(u[2]) + ln(1) + fabs(u(2))", 10.0),
        ("atan2(u(2), u(1)) + hypot(3, 4) + rem(7, 4)", math.atan2(-3, 2) + 5 + 3),
        ("k*u(1)^2", 12.0),
        ("norm(u)", math.sqrt(13.25)),
        ("sum", -0.5),
        ("twice", [4.0, -6.0, 1.0]),
        ("[u(1); -u(2)]*2", [4.0, 6.0]),
        ("u'*u", 13.25),
    ],
)
def test_expressions(text, expected, tmp_path):
    (tmp_path / "twice.m").write_text("function y = twice(x)\ny = 2*x;\n")
    folders = Folders()
    folders.add(tmp_path)
    expression = compiled_expression(text, variables={"k": 3.0, "unused": 1.0}, functions=folders)
    for _ in range(2):
        found = expression(U)
        np.testing.assert_allclose(found, expected, rtol=1e-15)
        assert not isinstance(found, bool)
    assert expression.names == ("u",)


def test_an_expression_of_numbers_is_pythons_own():
    expression = compiled_expression("a*exp(-b) + a > b", ("a", "b"))
    assert expression(1.0, 2.0) == 0.0
    assert "v_y = v_a * exp(-v_b) + v_a > v_b" in expression.source


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("u(1", "the expression 'u.1' is not well formed: '.' is never closed"),
        ("u(1)*other", "'other' is not a known function or constant"),
        ("", "the text is empty"),
        ("u(7)", "'u' is 3×1 and has no element 7"),
    ],
)
def test_what_is_wrong_is_said(text, reason):
    with pytest.raises(InvalidValueError, match=reason):
        compiled_expression(text)(U)


def test_what_functions_in_files_keep_goes_from_call_to_call(tmp_path):
    (tmp_path / "counted.m").write_text(
        "function y = counted(x)\npersistent n\nglobal K\nif isempty(n), n = 0; end\n"
        "n = n + 1;\ny = K*x + n;\nend\n"
    )
    folders = Folders()
    folders.add(tmp_path)
    expression = compiled_expression("counted(u(1))", functions=folders)
    assert expression.keeps
    kept = expression.start({"K": 10.0, "other": 3.0})
    assert kept == {"global K": 10.0}
    assert [expression(U, kept=kept) for _ in range(3)] == [21.0, 22.0, 23.0]
    assert expression(U, kept=expression.start({"K": 1.0})) == 3.0
