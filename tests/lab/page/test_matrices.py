"""The page's formulas against the chain, Drake and SymPy."""

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
import sympy as sp

from drake_leg.kinematics.leg import LegGeometry
from drake_leg.lab.page import mathematics
from drake_leg.lab.page.contents import SUBJECTS, chapters
from drake_leg.lab.page.mathematics import comparisons, khalil_table, methods
from drake_leg.robot.robots import LEG_B
from drake_leg.symbolic.catalogue import derived, derived_equations
from drake_leg.symbolic.equations import html

NAMES = ("leg-a", "leg-b", "scara")


def posed(name, seed):
    subject = SUBJECTS[name]
    q = np.random.default_rng(seed).uniform(0.3, 1.2, len(subject.q))
    return replace(subject, q=tuple(q.tolist()))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", NAMES)
def test_every_formula_agrees_with_the_chain_and_with_drake(name, seed):
    for matrix, comparison in comparisons(posed(name, seed)).items():
        least = 1e-12 if matrix == "J⁻¹" else 2e-15
        assert comparison.from_chain < least, matrix
        assert comparison.from_drake < least, matrix


@pytest.mark.parametrize("entry", [(0, 0), (1, 3), (2, 2)])
def test_a_wrong_entry_is_seen(entry, monkeypatch):
    row, column = entry
    right = mathematics.matrices(derived("leg-b"))
    wrong = sp.Matrix(right["T04"])
    wrong[row, column] += sp.cos(derived("leg-b").table.q[0])
    monkeypatch.setattr(mathematics, "matrices", lambda _: right | {"T04": wrong})
    compared = comparisons(posed("leg-b", 0))["T04"]
    assert min(compared.from_chain, compared.from_drake) > 0.1


@pytest.mark.slow
def test_an_equation_names_a_matrix_or_is_a_text_with_an_equals_sign():
    for item in (item for chapter in chapters() for item in chapter.items if item.equations):
        known = comparisons(SUBJECTS[item.subject])
        for _, name in item.equations:
            assert name in known or " = " in name


@pytest.mark.parametrize("name", NAMES)
def test_direct_and_indirect_jacobian_are_one(name):
    found = methods(SUBJECTS[name])
    assert found.difference < 1e-14
    np.testing.assert_allclose(found.direct, found.indirect, atol=1e-15)
    np.testing.assert_allclose(found.direct, comparisons(SUBJECTS[name])["J"].value, atol=1e-15)


@pytest.mark.parametrize(
    ("matrix", "place", "leg_a", "leg_b"),
    [
        ("T12", (1, 2), "1", "−1"),
        ("T12", (2, 0), "−s2", "s2"),
        ("T02", (1, 2), "c1", "−c1"),
        ("T02", (0, 2), "−s1", "s1"),
        ("T04", (2, 3), "−l2 s2 − l3 s23", "l2 s2 + l3 s23"),
        ("T02", (1, 0), "s1 c2", "s1 c2"),
    ],
)
def test_a_variant_has_its_own_signs(matrix, place, leg_a, leg_b):
    for name, shown in (("leg-a", leg_a), ("leg-b", leg_b)):
        entry = html(mathematics.matrices(derived(name))[matrix][place])
        assert " ".join(unescape(re.sub("<[^>]*>", "", entry)).split()) == shown


@pytest.mark.parametrize("name", ["leg-a", "leg-b"])
def test_the_leg_is_singular_in_the_postures_that_are_named(name):
    subject = SUBJECTS[name]
    leg = LegGeometry.from_robot(subject.robot)
    for posture, degrees in subject.singular:
        _, q2, q3 = np.radians(degrees)
        reach = leg.l1 + leg.l2 * np.cos(q2) + leg.l3 * np.cos(q2 + q3)
        families = (abs(np.sin(q3)) < 1e-12, abs(reach) < 1e-12)
        expected = {"foot on the hip axis": (False, True), "both at once": (True, True)}
        assert families == expected.get(posture, (True, False))


@pytest.mark.parametrize("name", [pytest.param("leg-a", marks=pytest.mark.slow), "leg-b", "scara"])
def test_sympy_derives_the_same(name):
    subject = posed(name, 4)
    values = {f"q{i}": q for i, q in enumerate(subject.q, start=1)}
    values |= {f"l{i}": row.d for i, row in enumerate(subject.robot.rows[1:], start=1) if row.d}
    values["h"] = subject.robot.rows[0].r
    known = comparisons(subject)
    checked = set()
    for equation in derived_equations(name):
        matrix = str(equation.left).replace("_", "")
        if matrix not in known or not hasattr(equation.right, "shape"):
            continue
        right = sp.Matrix(equation.right).subs(
            {s: values[str(s).replace("_", "")] for s in equation.right.free_symbols
             if str(s).replace("_", "") in values}
        )  # fmt: skip
        if right.free_symbols:
            continue
        np.testing.assert_allclose(
            np.array(right, dtype=float), known[matrix].value, atol=1e-12, err_msg=matrix
        )
        checked.add(matrix)
    assert {"T01", "T12", "T23", "T34", "J"} <= checked


def test_a_table_keeps_the_offset_of_a_joint():
    bent = replace(LEG_B.segments[0], row=replace(LEG_B.segments[0].row, theta=0.3))
    robot = replace(LEG_B, segments=(bent, *LEG_B.segments[1:]))
    assert "<i>q</i><sub>1</sub> + 0.3</td>" in khalil_table(robot)
    assert "<i>q</i><sub>1</sub></td>" in khalil_table(LEG_B)
