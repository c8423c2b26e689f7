"""A SYMORO file in symbols: letters stay, numbers are exact, and it is the robot's table."""

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import base_transforms as poses
from drake_leg.robot.symoro.arithmetic import evaluate, parse_arithmetic
from drake_leg.robot.symoro.as_robot import numbers_of, robot_of_par
from drake_leg.robot.symoro.reader import load_par, read_par
from drake_leg.symbolic.par_table import sympy_of, table_of_par
from drake_leg.symbolic.table import base_transforms

SAMPLES = Path(__file__).parents[2] / "examples" / "symoro"
NUMBERS = {
    "rx90": {"D3": 0.45, "RL4": 0.4},
    "parallelogram-arm": {"D2": 0.2, "D3": 0.5, "D4": -0.1, "D8": 0.3, "RL4": 0.6},
    "two-fingers": {},
}


@pytest.mark.parametrize("name", NUMBERS)
def test_the_table_and_the_robot_of_a_file_are_in_the_same_places(name):
    par = load_par(SAMPLES / f"{name}.par")
    table = table_of_par(par)
    rows = robot_of_par(par, numbers_of(NUMBERS[name], name)).robot.rows
    q = np.random.default_rng(14).uniform(-math.pi, math.pi, len(table.q))
    numbers = dict(zip(table.q, map(sp.Float, q), strict=True))
    numbers |= {sp.Symbol(k, real=True): sp.Float(v) for k, v in NUMBERS[name].items()}
    cut = len(par.loops)  # the row of a cut is fixed in the robot, at 0
    numbers |= dict.fromkeys(table.q[len(table.q) - cut :], sp.Float(0)) if cut else {}
    found = [np.array(X.xreplace(numbers).evalf(), dtype=float) for X in base_transforms(table)]
    expected = poses(rows, q[: len(q) - cut] if cut else q)
    assert np.abs(np.array(found) - expected).max() < 1e-14


def test_the_rx_90_has_its_textbooks_symbols():
    table = table_of_par(load_par(SAMPLES / "rx90.par"))
    D3, RL4 = sp.symbols("D3 RL4", real=True)
    th1, th2, th3 = table.q[:3]
    P = base_transforms(table)[-1][:3, 3]
    reach = RL4 * sp.sin(th2 + th3) - D3 * sp.cos(th2)
    expected = [-sp.cos(th1) * reach, -sp.sin(th1) * reach]
    expected.append(RL4 * sp.cos(th2 + th3) + D3 * sp.sin(th2))
    assert [sp.expand(sp.expand_trig(a - b)) for a, b in zip(P, expected, strict=True)] == [0] * 3
    assert sp.Symbol("M6", real=True) == table.links[5].M
    assert table.links[5].force[2] == sp.Symbol("FZ6", real=True)
    assert table.gravity == (0, 0, sp.Symbol("G3", real=True))


def test_numbers_are_exact_and_may_be_put_in_place_of_letters():
    par = load_par(SAMPLES / "rx90.par")
    table = table_of_par(par, numbers_of({"D3": 0.45, "RL4": "2/5"}, "x"))
    assert table.rows[2].d == sp.Rational(9, 20)
    assert table.rows[3].r == sp.Rational(2, 5)
    assert table.rows[1].alpha == sp.pi / 2


def test_what_the_file_leaves_out_is_a_letter_or_zero():
    text = "sigma = {0}\nalpha = {0}\nd = {0}\ntheta = {th1}\nr = {0}\n"
    (link,) = table_of_par(read_par(text, "x.par")).links
    assert sp.Symbol("XX1", real=True) == link.XX
    assert (link.IA, link.FV, link.force) == (0, 0, (0, 0, 0))
    assert table_of_par(read_par(text, "x.par")).gravity[2] == sp.Symbol("G3", real=True)


@pytest.mark.parametrize(
    ("d", "said"),
    [
        ("L/(L - L)", "divides by zero"),
        ("atan2(1, L/(1 - 1))", "divides by zero"),
        ("L*tan(Pi/2)", "divides by zero"),
        ("L + sqrt(-1 - 0*L)", "not a real number|not defined"),
    ],
)
def test_what_has_no_value_is_refused_with_its_row(d, said):
    text = f"sigma = {{0}}\nalpha = {{0}}\nd = {{{d}}}\ntheta = {{th1}}\nr = {{0}}\n"
    with pytest.raises(InvalidValueError, match=f"x.par, line 3: d of row 1 .*({said})"):
        table_of_par(read_par(text, "x.par"))


def test_positions_are_q_with_the_number_of_their_joint():
    text = "sigma = {0,2,1}\nalpha = {0,0,q3}\nd = {0,L,0}\ntheta = {th1,0,0}\nr = {0,0,H + r3}\n"
    table = table_of_par(read_par(text, "x.par"))
    assert [symbol.name for symbol in table.q] == ["q1", "r3"]
    assert table.rows[2].r == sp.Symbol("H", real=True) + table.q[1]


LEAVES = st.sampled_from(["1", "2", "0.5", "0.1", "L", "H", "Pi/7"])
FORMULAS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda p: f"({p[0]}){p[1]}({p[2]})"),
        st.tuples(inner, st.sampled_from(["2", "-1", "(1/2)"])).map(lambda p: f"({p[0]})^{p[1]}"),
        st.tuples(st.sampled_from(["sin", "cos", "sqrt", "atan"]), inner).map(
            lambda p: f"{p[0]}({p[1]})"
        ),
        st.tuples(inner, inner).map(lambda p: f"atan2({p[0]}, {p[1]})"),
    ),
    max_leaves=5,
)


@settings(max_examples=40, deadline=None)
@given(formula=FORMULAS)
def test_arithmetic_has_the_same_value_in_symbols_and_in_numbers(formula):
    numbers = {"L": Fraction(3, 10), "H": Fraction(-7, 5)}
    expression = parse_arithmetic(formula)
    try:
        expected = float(evaluate(expression, numbers))
        found = sympy_of(expression, {})
    except InvalidValueError:
        return  # it divides by zero, or has no real value
    values = {sp.Symbol(n, real=True): sp.Rational(str(v)) for n, v in numbers.items()}
    assert complex(found.xreplace(values)) == pytest.approx(expected, rel=1e-9, abs=1e-9)
