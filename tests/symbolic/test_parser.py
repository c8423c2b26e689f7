"""Formulas as people write them, read by a whitelist."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.formulas import evaluate, names_in, substitute, written
from drake_leg.symbolic.parser import parse_formula
from drake_leg.symbolic.spelling import readable, spelled_as

VALUES = {"q1": 0.3, "q2": -1.1, "q3": 2.0, "l1": 50.0, "l2": 100.0, "r": 7.0, "sigma1": 3.0}
SPELLINGS = tomllib.loads((Path(__file__).parent / "spellings.toml").read_text(encoding="utf-8"))
C1, S1, C2 = math.cos(0.3), math.sin(0.3), math.cos(-1.1)
C23, S23 = math.cos(0.9), math.sin(0.9)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0.0),
        ("-1", -1.0),
        ("cos(q1)", C1),
        ("cos(θ1)", C1),
        ("cos(θ_1)", C1),
        ("cos(ϑ₁)", C1),
        ("cos(theta1)", C1),
        ("cos(th1)", C1),
        (r"\cos(\theta_1)", C1),
        (r"\cos\left(\theta_{1}\right)", C1),
        ("c1", C1),
        ("C_1", C1),
        ("c_{1}", C1),
        ("c23", C23),
        ("cos(θ23)", C23),
        (r"\cos\theta_{2 3}", C23),
        ("cos θ2 sin θ1", C2 * S1),
        ("sin 2θ1", math.sin(0.6)),
        ("cos 90°", 0.0),
        ("90°", math.pi / 2),
        (r"90^\circ", math.pi / 2),
        ("-π/2", -math.pi / 2),
        ("L1", 50.0),
        ("l_1 c_1", 50 * C1),
        ("c_1l_1 + c_1c_2l_2", C1 * 50 + C1 * C2 * 100),
        ("-s_1(l_1 + c_2l_2)", -S1 * (50 + C2 * 100)),
        ("-s_{23}l_2", -S23 * 100),
        (r"50 \cdot \cos(\theta_1) \cdot \sigma_1", 150 * C1),
        ("50·cos(θ1)×2", 100 * C1),
        ("2cos(θ2 − θ3) + 1", 2 * math.cos(-3.1) + 1),
        ("452.4-340-R", 105.4),
        ("cos(q1)^2 + sin(q1)**2", 1.0),
        ("s1²", S1**2),
        (r"\frac{L_1}{2}", 25.0),
        ("[1 + 2] 3", 9.0),
        ("2(3)(4)", 24.0),
        ("1e-3", 1e-3),
        ("sqrt(L1 2)", 10.0),
    ],
)  # fmt: skip
def test_the_reports_notation_is_understood(text, value):
    assert evaluate(parse_formula(text), VALUES) == pytest.approx(value, rel=1e-14, abs=1e-15)


@pytest.mark.parametrize(
    ("meaning", "text"),
    [
        pytest.param(meaning, text, id=f"{meaning}: {text}")
        for meaning, texts in SPELLINGS.items()
        for text in texts
    ],
)
def test_a_spelling_is_read_as_what_it_means(meaning, text):
    names = {**VALUES, "l3": 100.0, "l": 7.0, "lcoxa": 50.0}
    declared = [name for name in names if not name.startswith("q")]
    tree = parse_formula(text, declared)
    q = {name: np.array([0.3, -1.1, 2.0]) + 0.1 * i for i, name in enumerate(("q1", "q2", "q3"))}
    np.testing.assert_allclose(
        evaluate(tree, {**names, **q}), evaluate(parse_formula(meaning), q), rtol=1e-9, atol=1e-12
    )


def test_a_declared_symbol_is_found_in_a_product_without_signs():
    assert written(parse_formula("RcRL4", ("rl4", "rc"))) == "rc * rl4"
    assert written(parse_formula("RL4C3")) == "rl4 * cos(q3)"


@pytest.mark.parametrize(
    "text",
    [
        "a - (b - c) / d * 2",
        "-sin(q1) * (50 + 0.5 * l2 * cos(q2 - q3))",
        "--a^2 / (b * c)",
        "sqrt(a + 2)^(-3) + cos(30 * deg)",
        "a - -b",
    ],
)
def test_a_formula_is_written_as_it_was_read(text):
    assert written(parse_formula(text, ("a", "b", "c", "d"))) == text


def test_a_formula_is_evaluated_on_arrays():
    q1 = np.linspace(0.0, 1.0, 5)
    np.testing.assert_array_equal(evaluate(parse_formula("2c1"), {"q1": q1}), 2 * np.cos(q1))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "((",
        "1 +",
        "cos",
        "cos()",
        "cos(1, 2)",
        "sin^-1(q1)",
        "a..b",
        "x + 1 = 1",
        "__import__('os')",
        "lambda: 1",
        "'text'",
        "{1: 2}",
        "f(1)",
        "x" * 4001,
        "9" * 900,
        "9^9^9^9",
        "2^999",
        "2^q1",
        "(" * 41 + "1" + ")" * 41,
        "+".join(["c1"] * 300),
        "q10",
        "c10",
        "$",
    ],
)
def test_whatever_is_no_formula_is_refused_with_its_text(text):
    with pytest.raises(InvalidValueError) as raised:
        parse_formula(text) if text != "f(1)" else evaluate(parse_formula(text), {})
    assert "\n" not in str(raised.value)


@given(st.text(max_size=60) | st.text(alphabet="cosinqθ123()+-*/^.° _{}\\lL", max_size=60))
def test_any_text_is_a_formula_of_whitelisted_parts_or_a_sentence(text):
    try:
        tree = parse_formula(text)
    except InvalidValueError:
        return
    allowed = (
        sp.Integer | sp.Float | sp.Rational | sp.Symbol | sp.Add | sp.Mul | sp.Pow
        | sp.cos | sp.sin | sp.tan | type(sp.pi)
    )  # fmt: skip
    assert all(isinstance(part, allowed) for part in sp.preorder_traversal(tree))
    evaluate(tree, dict.fromkeys(names_in(tree), 1.0))


@pytest.mark.parametrize("text", ["1/0", "sqrt(-1)", "(-8)^(1/3)", "9e300^20"])
def test_a_formula_without_value_gives_no_finite_number_and_no_warning(text):
    assert not np.isfinite(evaluate(parse_formula(text), {}))


def test_a_symbol_without_value_is_named():
    with pytest.raises(InvalidValueError, match="l9 has no value"):
        evaluate(parse_formula("2 L9"), {})


def test_definitions_stand_for_their_names_in_one_another_too():
    definitions = {"sigma1": parse_formula("l1 + sigma2"), "sigma2": parse_formula("2 q1")}
    whole = substitute(parse_formula("3 sigma1"), definitions)
    assert names_in(whole) == {"l1", "q1"}
    assert evaluate(whole, VALUES) == 3 * (50 + 0.6)


def test_a_definition_by_itself_is_refused():
    definitions = {"a": parse_formula("b + 1"), "b": parse_formula("2 a")}
    with pytest.raises(InvalidValueError, match="defined by itself"):
        substitute(parse_formula("a"), definitions)


@pytest.mark.parametrize(
    ("spelling", "said"),
    [
        ("cos(θ1)", "-sin(θ2 + θ3)*cos(θ1)"),
        (r"\cos(\theta_1)", "-sin(θ2 + θ3)*cos(θ1)"),
        ("cos(th1)", "-sin(th2 + th3)*cos(th1)"),
        ("cos(q1)", "-sin(q2 + q3)*cos(q1)"),
        ("c_1 s_{2}", "-s23*c1"),
    ],
)
def test_what_is_right_is_said_in_the_prints_own_notation(spelling, said):
    assert spelled_as(spelling, "-sin(q2 + q3)*cos(q1)") == said


def test_latex_is_shown_without_its_commands():
    assert readable(r"50 \cdot \cos(\theta_1) \sigma_{12}") == "50 · cos(θ1) σ12"
    assert readable("c_1l_1") == "c1l1"
