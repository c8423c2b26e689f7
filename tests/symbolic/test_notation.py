"""Formulas as they are written: shorthand, text and HTML."""

import re

import pytest
import sympy as sp

from drake_leg.symbolic.notation import html, shorthand, text

A, B, C = sp.symbols("q1:4", real=True)
L1, L2 = sp.symbols("l1 l2", positive=True)
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
