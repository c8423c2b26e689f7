import re
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from drake_leg.kinematics import khalil
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.symbolic.derivation import evaluator, normal_form
from drake_leg.symbolic.equations import findings, html, shorthand, text

Q1, Q2, Q3 = sp.symbols("q1:4", real=True)
L1, L2, L3 = sp.symbols("l1:4", positive=True)
ROBOTS = {"leg-a": LEG_A, "leg-b": LEG_B, "scara": SCARA}
LABELS = {
    "leg-a": [*map(str, range(1, 18)), "19"],
    "leg-b": ["2.3", "2.4", "2.5.1", "2.5.2"],
    "scara": ["1.3", "1.4", "1.5", "1.6"],
}


def right_of(numbered, name, label, index=0):
    return numbered(name)[label][index].right


@pytest.mark.parametrize("name", ROBOTS)
def test_the_numbers_are_the_reports_in_order(numbered, name):
    assert list(numbered(name)) == LABELS[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", [pytest.param("leg-a", marks=pytest.mark.slow), "leg-b", "scara"])
def test_every_equation_is_one_line_of_latex_and_a_text(numbered, derived, name):
    stated = [e for group in numbered(name).values() for e in group]
    for equation in (*stated, *findings(derived(name))):
        latex, text = equation.latex(), equation.text()
        assert "\n" not in latex
        assert " = " in latex or r" \geq " in latex
        assert latex.count("{") == latex.count("}")
        assert "=" in text or "≥" in text
        assert equation.title


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("label", ["2", "3", "4", "5", "1.3", "2.3"])
def test_neighbours_are_the_chains(rng, numbered, derived, name, label):
    robot, chain = ROBOTS[name], derived(name).table
    q = rng.uniform(-3.0, 3.0, len(robot.moving))
    X_B = [np.eye(4), *khalil.base_transforms(robot.rows, q)]
    for equation in numbered(name).get(label, []):
        before, after = (int(digit) for digit in equation.left.name[-2:])
        right = np.linalg.solve(X_B[before], X_B[after])
        np.testing.assert_allclose(evaluator(chain, equation.right)(q), right, atol=1e-14)


@pytest.mark.parametrize(
    ("name", "label", "frame"),
    [("leg-a", "6", 2), ("leg-a", "7", 3), ("leg-a", "8", 4), ("leg-b", "2.4", 4),
     ("scara", "1.4", 3)],
)  # fmt: skip
def test_transforms_to_the_base_are_the_chains(rng, numbered, derived, name, label, frame):
    robot = ROBOTS[name]
    q = rng.uniform(-3.0, 3.0, len(robot.moving))
    (equation,) = numbered(name)[label]
    assert equation.left.name == f"T_0{frame}"
    shown = evaluator(derived(name).table, equation.right)(q)
    np.testing.assert_allclose(shown, khalil.base_transforms(robot.rows, q)[frame - 1], atol=1e-14)


@pytest.mark.parametrize(
    ("name", "label", "rows"),
    [("leg-a", "15", [3, 4, 5]), ("leg-b", "2.5.2", [3, 4, 5]), ("scara", "1.5", [3, 4, 2])],
)
def test_jacobians_are_the_chains(rng, numbered, derived, name, label, rows):
    robot = ROBOTS[name]
    q = rng.uniform(-3.0, 3.0, len(robot.moving))
    shown = evaluator(derived(name).table, right_of(numbered, name, label))(q)
    np.testing.assert_allclose(shown, khalil.jacobian(robot.rows, q)[rows, :3], atol=1e-14)


def test_the_contributions_are_the_columns_and_their_sum_the_velocity(numbered):
    equations = numbered("leg-a")
    columns = [equations[label][0].right for label in ("10", "11", "12")]
    velocity = equations["14"][0].right
    assert sp.expand(sum((c.doit() for c in columns), sp.zeros(3, 1)) - velocity.doit()) == (
        sp.zeros(3, 1)
    )
    assert equations["16"][0].right == velocity
    names = [equations[label][0].left for label in ("10", "11", "12")]
    assert equations["13"][0].right == sp.MatAdd(*names)


def test_equation_9_is_a_cross_product(numbered):
    contribution = right_of(numbered, "leg-a", "9")
    numbers = dict(zip(sp.symbols("z_x z_y z_z p_x p_y p_z"), (1, 2, 3, 5, 7, 11), strict=True))
    value = contribution.subs(numbers | {sp.Symbol("qdot_j"): 2}).doit()
    assert list(value) == [2 * entry for entry in np.cross((1, 2, 3), (5, 7, 11)).tolist()]


def test_equation_17_is_the_printed_form_and_equals_the_factored_one(numbered, derived):
    s2, c2, s3, c3 = sp.sin(Q2), sp.cos(Q2), sp.sin(Q3), sp.cos(Q3)
    printed = L2 * L3 * (L3 * s2 * c3**2 + L3 * c2 * s3 * c3 + L1 * s3 - L3 * s2 + L2 * c2 * s3)
    shown = right_of(numbered, "leg-a", "17")
    assert sp.expand(shown - printed) == 0
    assert shown.func is sp.Mul
    assert normal_form(derived("leg-a").determinant - printed) == 0


def test_equation_19_is_the_inverse(numbered, derived):
    J, inverse = derived("leg-a").jacobian, right_of(numbered, "leg-a", "19")
    unit = (J * inverse).applyfunc(sp.together)
    for i in range(3):
        for j in range(3):
            numerator, denominator = sp.fraction(unit[i, j])
            assert normal_form(numerator - int(i == j) * denominator) == 0


def test_the_foots_position_is_that_of_its_transform(numbered, derived):
    assert right_of(numbered, "leg-b", "2.5.1") == derived("leg-b").to_base[-1][:3, 3]


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_the_findings_say_that_both_methods_agree(derived, name):
    first, second, *zeros = findings(derived(name))
    assert first.text() == first.latex() == "direct - indirect = 0"
    assert second.right == derived(name).determinant
    assert [e.left for e in zeros if e.title == "singular where"] == [
        family.factor for family in derived(name).families
    ]


def test_where_the_methods_differ_their_difference_is_shown(derived):
    right = derived("scara")
    wrong = SimpleNamespace(
        difference=sp.Matrix([[L1]]), determinant=right.determinant, families=right.families
    )
    assert "l_{1}" in findings(wrong)[0].latex()


@pytest.mark.parametrize(
    ("name", "label", "latex"),
    [
        ("leg-a", "2", r"T_{01} = \left[\begin{matrix}c_{1} & - s_{1} & 0 & 0\\"),
        ("leg-a", "17", r"\left|{J}\right| = l_{2} l_{3} \left("),
        ("leg-a", "19", r"J^{-1} = "),
        ("leg-a", "10", r"V_{1} = \dot{q}_{1} \left["),
        ("scara", "1.6", r"\left|{J}\right| = l_{1} l_{2} s_{2}"),
    ],
)
def test_latex_has_the_reports_names(numbered, name, label, latex):
    assert numbered(name)[label][0].latex().startswith(latex)


A, B, C = sp.symbols("q1:4", real=True)
TH1, TH2, TH3, S1, R = sp.symbols("θ1 θ2 θ3 σ1 R")


@pytest.mark.parametrize(
    ("long", "short"),
    [
        (sp.cos(A), "c1"),
        (sp.sin(B + A), "s12"),
        (L1 * sp.cos(A + B + C) - sp.sin(C), "c123*l1 - s3"),
        (sp.cos(L1), "cos(l1)"),
        (sp.cos(2 * A), "cos(2*q1)"),
        (sp.atan(sp.sin(A)), "atan(s1)"),
    ],
)
def test_the_shorthand_is_the_reports(long, short):
    assert str(shorthand(long)) == short


def test_the_shorthand_reaches_into_matrices():
    assert shorthand(sp.Matrix([[sp.cos(A), -sp.sin(A)]])) == sp.Matrix([sp.symbols("c1 s1")]) * (
        sp.diag(1, -1)
    )


@pytest.mark.parametrize(
    ("expression", "line"),
    [
        (-50 * S1 * sp.cos(TH1), "−50·cos(θ1)·σ1"),
        (sp.cos(TH1) * sp.cos(TH2 - TH3), "cos(θ2 − θ3)·cos(θ1)"),
        (1 + 2 * sp.cos(TH2) + 2 * sp.cos(TH2 + TH3), "2·cos(θ2 + θ3) + 2·cos(θ2) + 1"),
        (R - 112.4, "R − 112.4"),
        (sp.Add(452.4, -340, -R, evaluate=False), "452.4 − 340 − R"),
        (-L1 * sp.cos(TH1) / (L2 * sp.sin(TH3)), "−l1·cos(θ1)/(l2·sin(θ3))"),
        (-1 / L1, "−1/l1"),
        (L1 * sp.sin(TH1) ** 2, "l1·sin(θ1)²"),
        (sp.Integer(-1), "−1"),
        (sp.Integer(0), "0"),
    ],
)
def test_a_line_has_the_reports_order(expression, line):
    assert text(expression) == line


def test_html_has_subscripts_and_no_signs_of_products():
    alpha = sp.Symbol("alpha")
    shown = html(-L1 * sp.cos(B + C) + sp.cos(C) ** 2 / sp.sin(alpha))
    assert re.sub("<[^>]*>", "", shown) == "&minus;l1&#8201;c23 + c32/sin&#8201;α"
    assert "<i>c</i><sub>23</sub>" in shown
    assert "<sub>3</sub><sup>2</sup>" in shown
