"""Integrations, zeros and minima of scripts against closed forms."""

import math

import numpy as np
import pytest

from drake_leg.simulink.matlab.workspace import Workspace


def ran(text):
    workspace = Workspace()
    workspace.run(text, name="s.m")
    return workspace


def test_van_der_pol_takes_the_steps_that_the_suite_is_known_for():
    """Its documentation tells 59 steps; each makes four rows."""
    found = ran(
        "[t, y] = ode45(@vdp, [0 20], [2; 0]);\nfunction d = vdp(t, y)\n"
        "d = [y(2); (1 - y(1)^2)*y(2) - y(1)];\nend"
    )
    assert found.evaluate("numel(t)") == 59 * 4 + 1
    assert not found.skipped


@pytest.mark.parametrize(
    "solver", ["ode45", pytest.param("ode23", marks=pytest.mark.slow), "ode15s", "ode113"]
)
def test_an_oscillator_comes_back(solver):
    found = ran(
        f"o = odeset('reltol', 1e-8, AbsTol=1e-10);\nw = 2;\n"
        f"[t, y] = {solver}(@(t, y, k) [y(2); -k^2*y(1)], 0:0.5:pi, [1; 0], o, w);\n"
        "e = max(abs(y(:,1) - cos(2*t)));"
    )
    assert found.evaluate("numel(t)") == 7
    assert found.evaluate("e") < 1e-5
    assert solver == "ode23" or found.evaluate("e") < 1e-6


def test_rows_between_steps_are_as_accurate_as_their_ends():
    found = ran("[t, y] = ode45(@(t, y) -y, [0 3], 1);\ne = max(abs(y - exp(-t)));")
    assert found.evaluate("e") < 1e-5
    back = ran("[t, y] = ode45(@(t, y) -y, [3 0], exp(-3));\ne = abs(y(end) - 1);")
    assert back.evaluate("e") < 1e-3


def test_an_event_ends_a_fall():
    found = ran(
        "o = odeset('Events', @ground);\n"
        "[t, y, te, ye, ie] = ode45(@(t, y) [y(2); -9.81], [0 5], [1; 0], o);\n"
        "function [value, ends, way] = ground(t, y)\nvalue = [y(1); y(2) + 1]; ends = [1; 0];"
        " way = [-1; 0];\nend"
    )
    assert found.evaluate("te").ravel().tolist() == pytest.approx(
        [1.0 / 9.81, math.sqrt(2.0 / 9.81)], abs=1e-12
    )
    assert found.evaluate("ie").ravel().tolist() == [2, 1]
    assert found.evaluate("t(end) - te(end)") == 0.0
    assert found.evaluate("ye(2, 2)") == pytest.approx(-math.sqrt(2.0 * 9.81), abs=1e-12)


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        ("[t, y] = ode45(@(t, y) y, [0 1], 1, odeset('Mass', 2));", "option 'mass' of 'ode45'"),
        ("[t, y] = ode45(@(t, y) [y; y], [0 1], 1);", "returns 2 of 1 slopes"),
        ("[t, y] = ode45(@(t, y) y, [0 1 0.5], 1);", "that rise or fall"),
        ("s = ode45(@(t, y) y, [0 1], 1);", "returns times and states"),
        ("[t, y] = ode45(@(t, y) y^2, [0 2], 1);", "fails at t = 0.999"),
        ("o = odeset('Tolerance', 1);", "no option 'Tolerance'"),
        ("x = fzero(@(x) x^2 + 1, [0 1]);", "needs a change of sign between 0 and 1"),
        ("x = fzero(@cos, 1, optimset('TolFun', 1));", "option 'tolfun' of 'fzero'"),
        ("x = fsolve(@(x) x^2 + 1, 1);", "finds no zero"),
        ("x = integral(@(x) 1/x, 0, 1);", "does not converge"),
    ],
)
def test_what_is_not_heeded_is_refused(call, reason):
    found = ran(call)
    assert reason in found.skipped[0].reason


def test_zeros_minima_and_integrals():
    found = ran(
        "a = fzero(@cos, 1); [b, f, flag] = fzero(@(x) x^3 - 2, [0 2]);\n"
        "[c, g] = fminsearch(@(x) 100*(x(2) - x(1)^2)^2 + (1 - x(1))^2, [-1.2 1]);\n"
        "d = fminbnd(@(x) (x - 2)^2 + 1, 0, 5);\n"
        "e = fsolve(@(x) [x(1)^2 + x(2)^2 - 1; x(1) - x(2)], [1; 0]);\n"
        "h = integral(@(x) exp(-x.^2), -Inf, Inf);\nk = fzero(@(x) x - 1e5, 1);"
    )
    assert found.evaluate("a") == pytest.approx(math.pi / 2, abs=1e-15)
    assert found.evaluate("b") == pytest.approx(2.0 ** (1 / 3), abs=1e-15)
    assert found.evaluate("g") == pytest.approx(8.1777e-10, rel=1e-4)  # as documented
    np.testing.assert_allclose(found.evaluate("c"), [[1.0, 1.0]], atol=1e-4)
    assert found.evaluate("d") == pytest.approx(2.0, abs=1e-4)
    np.testing.assert_allclose(found.evaluate("e"), np.full((2, 1), math.sqrt(0.5)), atol=1e-12)
    assert found.evaluate("h") == pytest.approx(math.sqrt(math.pi), abs=1e-12)
    assert found.evaluate("k") == pytest.approx(1e5, abs=1e-9)
