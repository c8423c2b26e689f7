"""Transfer functions: their algebra, against their values at a point."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.numeric import quiet
from drake_leg.simulink.matlab.program import Program, program

S = 0.7


def at(text):
    """Value of a transfer function at S, by its numerator and denominator."""
    code: Program = program(
        f"function [n, d] = f(u)\ns = tf('s');\n[n, d] = tfdata({text}, 'v');\n"
    )
    with quiet():
        n, d = code.call(0.0)
    return np.polyval(n, S) / np.polyval(d, S)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("tf([1 2], [1 3 4])", (S + 2) / (S**2 + 3 * S + 4)),
        ("tf(2 + 3/s + 4*20*s/(s + 20))", 2 + 3 / S + 80 * S / (S + 20)),
        ("-s/(s + 1) - 1", -S / (S + 1) - 1),
        ("(s + 1)^2 / s^3", (S + 1) ** 2 / S**3),
        ("zpk(-1, [-2 -3], 4)", 4 * (S + 1) / ((S + 2) * (S + 3))),
        ("pid(2, 3, 4, 0.05)", 2 + 3 / S + 4 * S / (0.05 * S + 1)),
        ("feedback(2/s, 3)", (2 / S) / (1 + 6 / S)),
        ("series(tf(1, [1 1]), tf(2, 1))", 2 / (S + 1)),
    ],
)
def test_what_operators_and_functions_make(text, expected):
    assert at(text) == pytest.approx(expected, rel=1e-13)


def test_a_sampled_one_is_refused():
    with pytest.raises(InvalidValueError, match="sampled transfer function"):
        at("tf(1, [1 1], 0.1)")
