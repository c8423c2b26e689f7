"""Lengths that coincide hide nothing: symbols stand for cells of the robot's table."""

import math
import re

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil
from drake_leg.lab.grader.claims import chain_of
from drake_leg.lab.grader.definitions import Cell, cell_values, readings
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import Printed, PrintedMatrix, printed_of_document
from drake_leg.lab.grader.printed_text import parse_text
from drake_leg.lab.grader.tables import Table, TableRow
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import LEG_A, LEG_B, ROBOTS, SCARA, hexabot_leg

LEG = {"L1": 50.0, "L2": 100.0, "L3": 100.0}  # [mm], L2 = L3 = 2 L1
BOTTOM = ("0", "0", "0", "1")
T23 = (("c3", "-s3", "0", "L2"), ("s3", "c3", "0", "0"), ("0", "0", "1", "0"), BOTTOM)
T34 = (("1", "0", "0", "L3"), ("0", "1", "0", "0"), ("0", "0", "1", "0"), BOTTOM)
P04 = (("c1*(L1 + L2*c2 + L3*c23)",), ("s1*(L1 + L2*c2 + L3*c23)",), ("L2*s2 + L3*s23",))
J = (
    ("-s1*(L1 + L2*c2 + L3*c23)", "-c1*(L2*s2 + L3*s23)", "-L3*c1*s23"),
    ("c1*(L1 + L2*c2 + L3*c23)", "-s1*(L2*s2 + L3*s23)", "-L3*s1*s23"),
    ("0", "L2*c2 + L3*c23", "L3*c23"),
)
PRINTS = {"T23": T23, "T34": T34, "P04": P04, "J": J}


def said(prints, robot=LEG_B, symbols=LEG, **more):
    matrices = tuple(
        PrintedMatrix(name=name, entries=tuple(map(tuple, entries)))
        for name, entries in prints.items()
    )
    printed = Printed(
        origin="print", lengths="mm", angles="deg", symbols=symbols, matrices=matrices, **more
    )
    return [finding.sentence() for finding in grade(robot, printed)]


def with_names(entries, **names):
    """Write other names in all entries, all at once."""

    def other(found):
        return names.get(found[0], found[0])

    return [[re.sub(r"[A-Z]\d", other, cell) for cell in row] for row in entries]


def test_what_is_right_in_symbols_stays_right():
    assert said(PRINTS) == []


def test_swapped_lengths_that_are_equal_are_named_in_every_matrix():
    swapped = {name: with_names(m, L2="L3", L3="L2") for name, m in PRINTS.items()}
    assert said(swapped) == [
        "T23 (1, 4): printed L3, in which L3 should be L2; it should be L2",
        "T34 (1, 4): printed L2, in which L2 should be L3; it should be L3",
        "P04: L2 and L3 have changed places in (1, 1), (2, 1) and (3, 1); change them back",
        "J: L2 and L3 have changed places; change them back",
    ]


@pytest.mark.parametrize(
    ("printed", "words"),
    [
        ("2*L1*s2 + L3*s23", "2*L1 should be L2"),
        ("2*s2*L1 + L3*s23", "2*L1 should be L2"),
        ("L1*s2*2 + L3*s23", "2*L1 should be L2"),
        ("L2*s2 + L2*s23", "one L2 should be L3"),
        ("L3*(s2 + s23)", "right for L1 = 50, L2 = 100, L3 = 100 only"),
        ("L2*s2 + (L2 - L1 + 50)*s23", "one L2 should be L3"),
    ],
)
def test_a_multiple_or_an_equal_length_is_another_length(printed, words):
    (sentence,) = said({"P04": (*P04[:2], (printed,))})
    assert words in sentence
    assert sentence.endswith("it should be L2*s2 + L3*s23")


def test_half_a_length_is_another_length():
    entries = (("c2", "-s2", "0", "L2/2"), ("0", "0", "-1", "0"), ("s2", "c2", "0", "0"), BOTTOM)
    (sentence,) = said({"T12": entries})
    assert "L2/2 should be L1" in sentence


@pytest.mark.parametrize(
    "height",
    [
        "100*s2 + 100*s23",
        "2*50*s2 + 100*s23",
        "100*s2 + L3*s23",
        "L2*s2 + 100*s23",
        "100*(s2 + s23)",
    ],
)
def test_numbers_are_right_as_numbers(height):
    assert said({"P04": (*P04[:2], (height,))}) == []


@pytest.mark.slow
def test_a_number_beside_the_symbol_of_the_same_length_is_right():
    determinant = "L2*100*s3*(50 + 100*c2 + 100*c23)"
    (right,) = (s for s in (determinant, "-" + determinant) if not said({"detJ": ((s,),)}))
    assert said({"detJ": ((right.replace("L2", "L1"),),)})


def table_of(*lengths):
    cells = ("0", *lengths)
    alphas = ("0", "90", "0", "0")
    sigmas, thetas = ("0", "0", "0", "~"), ("θ1", "θ2", "θ3", "0")
    rows = tuple(
        TableRow(frame="", cells={"sigma": s, "d": d, "alpha": a, "r": "0", "theta": t})
        for s, d, a, t in zip(sigmas, cells, alphas, thetas, strict=True)
    )
    return Table(rows=rows, angles="deg", lengths="mm")


def test_a_printed_table_says_what_symbols_stand_for():
    table = table_of("a", "b", "c")
    symbols = {"a": 50.0, "b": 100.0, "c": 100.0}
    assert (
        said({"P04": with_names(P04, L1="a", L2="b", L3="c")}, symbols=symbols, table=table) == []
    )
    swapped = said({"P04": with_names(P04, L1="a", L2="c", L3="b")}, symbols=symbols, table=table)
    assert swapped == [
        "P04: b and c have changed places in (1, 1), (2, 1) and (3, 1); change them back"
    ]


def test_a_table_outweighs_the_numbers_in_names():
    table = table_of("L1", "L3", "L2")
    assert said({"P04": with_names(P04, L2="L3", L3="L2")}, table=table) == []


def test_names_that_begin_at_zero_are_read_so():
    symbols = {"L0": 50.0, "L1": 100.0, "L2": 100.0}
    entries = with_names(P04, L1="L0", L2="L1", L3="L2")
    assert said({"P04": entries}, symbols=symbols) == []
    assert (
        "L1 and L2 have changed places"
        in said({"P04": with_names(P04, L1="L0", L2="L2", L3="L1")}, symbols=symbols)[0]
    )


@pytest.mark.slow
def test_one_name_may_stand_for_two_equal_lengths():
    symbols = {"L1": 50.0, "L2": 100.0}
    assert said({"P04": with_names(P04, L3="L2")}, symbols=symbols) == []
    assert said({"P04": with_names(P04, L3="2*L1")}, symbols=symbols)


def test_names_without_numbers_are_read_as_they_fit():
    symbols = {"a": 50.0, "b": 100.0, "c": 100.0}
    for names in ({"L2": "b", "L3": "c"}, {"L2": "c", "L3": "b"}):
        assert said({"P04": with_names(P04, L1="a", **names)}, symbols=symbols) == []


def test_what_cannot_be_told_is_asked():
    symbols = {"a": 50.0, "b": 100.0, "c": 100.0}
    prints = {
        "T23": with_names(T23, L2="b"),
        "T34": with_names(T34, L3="b"),
    }
    sentences = said(prints, symbols=symbols)
    assert any("symbols (a guess): b can stand for d3 or for d4" in s for s in sentences)
    assert any("c should be b" in s or "b should be c" in s for s in sentences)
    told = said(prints, symbols=symbols, cells={"b": "d4", "c": "d3"})
    assert told == ["T23 (1, 4): printed b, in which b should be c; it should be c"]


def test_the_files_cells_outweigh_all_else():
    cells = {"L2": "d4", "L3": "d3"}
    assert said({"P04": with_names(P04, L2="L3", L3="L2")}, cells=cells) == []
    assert said({"P04": P04}, cells=cells)


@pytest.mark.parametrize("text", ["d9", "d1", "", "theta2"])
def test_a_cell_that_the_robot_has_not_is_refused(text):
    with pytest.raises(InvalidValueError, match=r"L2 is .*; the robot has d2, alpha2, d3"):
        said({"P04": P04}, cells={"L2": text})


def test_cells_are_read_from_toml_and_csv():
    csv = "lengths,mm\na,100\ncells,a,d3\nT01,1,0,0,0\n"
    assert printed_of_document(parse_text(csv, "p"), "p").cells == {"a": "d3"}
    document = {"matrix": [{"name": "T01", "entries": [["1"]]}], "cells": {"a": "d3 d4"}}
    assert printed_of_document(document, "p").cells == {"a": "d3 d4"}


@pytest.mark.parametrize("definition", ["100", "2*L1", "L3"])
def test_a_length_may_stand_among_the_definitions(definition):
    symbols = {"L1": 50.0, "L3": 100.0}
    where = {"L2": definition}
    assert said({"P04": P04}, symbols=symbols, where=where) == []
    swapped = said({"P04": with_names(P04, L2="L3", L3="L2")}, symbols=symbols, where=where)
    assert "L2 and L3 have changed places" in swapped[0]


def test_a_definition_of_several_lengths_stays_one():
    where = {"a": "L1 + L2*c2", "b": "2*L1"}
    right = (("c1*(a + L3*c23)",), ("s1*(a + L3*c23)",), ("L2*s2 + L3*s23",))
    assert said({"P04": right}, where=where) == []
    assert "2*L1 should be L2" in said({"P04": (*right[:2], ("b*s2 + L3*s23",))}, where=where)[0]


def test_lengths_of_the_joints_formulas_vary_with_them():
    symbols = {"H": 452.4, "L1": 220.0, "L2": 240.0}
    entries = (("L1*c1 + L2*c12",), ("L1*s1 + L2*s12",), ("h + R",))
    for h, joint in (
        ("340", "452.4 - 340 - R"),
        ("340", "H - 340 - R"),
        ("H - 112.4", "112.4 - R"),
    ):
        rows = (*entries[:2], (entries[2][0].replace("h", h),))
        assert said({"P04": rows}, SCARA, symbols, joints={"lift": joint}) == []
    by_number = (*entries[:2], ("H - q4",))
    assert said({"P04": by_number}, SCARA, symbols, joints={"lift": "H - 340 - R"}) == []


def own_arm(height, upper, fore):
    """An arm on a post: r1, d3 and d4 are its lengths."""
    rows = (
        Row(joint="revolute", r=height),
        Row(joint="revolute", alpha=math.pi / 2),
        Row(joint="revolute", d=upper),
        Row(joint="fixed", d=fore),
    )
    return Robot(
        name="arm", title="Arm", source="a sketch",
        segments=tuple(
            Segment(row=row, joint=f"joint_{i}", link=Link(name=f"link_{i}"))
            for i, row in enumerate(rows)
        ),
    )  # fmt: skip


@pytest.mark.parametrize("names", [("L1", "L2", "L3"), ("r1", "d3", "d4"), ("H", "L1", "L2")])
def test_lengths_along_z_and_x_are_told_apart(names):
    robot, symbols = own_arm(0.1, 0.1, 0.1), dict.fromkeys(names, 100.0)
    post, upper, fore = names

    def tip(a, b, c):
        out = f"({b}*c2 + {c}*c23)"
        return ((f"c1*{out}",), (f"s1*{out}",), (f"{a} + {b}*s2 + {c}*s23",))

    assert said({"P04": tip(post, upper, fore)}, robot, symbols) == []
    (sentence,) = said({"P04": tip(post, fore, upper)}, robot, symbols)
    assert f"{upper} and {fore} have changed places" in sentence
    (sentence,) = said({"P04": (*tip(post, upper, fore)[:2], tip(upper, upper, fore)[2])}, robot,
                       symbols)  # fmt: skip
    assert f"one {upper} should be {post}" in sentence


def test_equal_fixed_angles_are_told_apart():
    twist = math.radians(30.0)
    rows = (
        Row(joint="revolute", alpha=twist),
        Row(joint="revolute", alpha=twist, d=0.1),
        Row(joint="fixed", d=0.1),
    )
    robot = Robot(
        name="skew", title="Skew", source="a sketch",
        segments=tuple(
            Segment(row=row, joint=f"joint_{i}", link=Link(name=f"link_{i}"))
            for i, row in enumerate(rows)
        ),
    )  # fmt: skip
    symbols = {"alpha1": twist, "alpha2": twist, "a": 100.0}

    def step(name):
        c, s = f"cos({name})", f"sin({name})"
        return (
            ("c1", "-s1", "0", "0"),
            (f"s1*{c}", f"c1*{c}", f"-{s}", "0"),
            (f"s1*{s}", f"c1*{s}", c, "0"),
            BOTTOM,
        )

    assert said({"T01": step("alpha1")}, robot, symbols) == []
    (sentence,) = said({"T01": step("alpha2")}, robot, symbols)
    assert "alpha2 should be alpha1" in sentence


def test_a_wrong_number_is_named():
    (sentence,) = said({"T23": with_names(T23, L2="60")})
    assert sentence == "T23 (1, 4): printed 60; it should be 100"
    (sentence,) = said({"P04": with_names(P04, L1="50", L2="100", L3="60")})
    assert "60 should be 100 in (1, 1), (2, 1) and (3, 1)" in sentence


def test_a_length_in_metres_is_named():
    (sentence,) = said({"T23": with_names(T23, L2="0.1")})
    assert "lengths are in m and should be in mm" in sentence


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_chain_is_that_of_the_kinematics(robot):
    q = np.random.default_rng(3).uniform(-1.0, 1.0, (5, len(robot.moving)))
    chain = chain_of(robot.rows, q, 1.0)
    np.testing.assert_allclose(
        chain.frames()[:, 1:], khalil.base_transforms(robot.rows, q), atol=1e-14
    )
    np.testing.assert_allclose(chain.jacobian(), khalil.jacobian(robot.rows, q), atol=1e-14)


def test_symbols_are_bound_by_their_numbers():
    values = cell_values(hexabot_leg("B", l1=0.1, l2=0.1, l3=0.1), 1e-3)
    first, *_ = readings({"l1": 100.0, "l2": 100.0, "l3": 100.0}, values, {})
    assert first == {
        "l1": {Cell(1, "d")}, "l2": {Cell(2, "d")}, "l3": {Cell(3, "d")},
    }  # fmt: skip


def test_the_legs_conventions_are_told_apart_whatever_the_lengths():
    height = (*P04[:2], ("-L2*s2 - L3*s23",))
    assert said({"P04": height}, LEG_A) == []
    assert said({"P04": P04}, LEG_B) == []
    assert "minus sign in front" in said({"P04": height}, LEG_B)[0]
