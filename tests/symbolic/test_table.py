"""Khalil tables in symbols: names, trees, links' parameters."""

import math

import pytest
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.symbolic.table import (
    LinkParameters,
    SymbolicRow,
    SymbolicTable,
    base_transforms,
    row_transform,
    table_of_robot,
    table_of_rows,
)

PUMA_560 = (
    Row(joint="revolute"),
    Row(joint="revolute", alpha=-math.pi / 2, r=0.2435),
    Row(joint="revolute", d=0.4318, r=-0.0934),
    Row(joint="revolute", d=-0.0203, alpha=math.pi / 2, r=0.4331),
    Row(joint="revolute", alpha=-math.pi / 2),
    Row(joint="revolute", alpha=math.pi / 2),
)
ODD = (
    Row(joint="prismatic", d=0.1, alpha=0.3, r=-0.2, theta=1.1),
    Row(joint="fixed", d=-0.4, alpha=-2.0, r=0.05, theta=math.pi / 3),
    Row(joint="revolute", alpha=math.pi / 4, theta=-0.7),
    Row(joint="prismatic", d=0.25, theta=-math.pi / 2),
    Row(joint="revolute", d=0.3, r=0.1),
    Row(joint="fixed", alpha=math.pi, r=0.2),
)


def test_a_row_is_its_six_motions():
    gamma, b, alpha, d, theta, r = sp.symbols("gamma b alpha d theta r", real=True)
    row = SymbolicRow(joint="fixed", d=d, alpha=alpha, r=r, theta=theta, gamma=gamma, b=b)

    def along(axis, length):
        motion = sp.eye(4)
        motion[axis, 3] = length
        return motion

    about_x = sp.diag(sp.rot_axis1(-alpha), 1)
    about_z, about_first = (sp.diag(sp.rot_axis3(-angle), 1) for angle in (theta, gamma))
    motions = about_first * along(2, b) * about_x * along(0, d) * about_z * along(2, r)
    assert (row_transform(row) - motions).expand() == sp.zeros(4)


@pytest.mark.parametrize(
    ("robot", "lengths"),
    [
        (LEG_A, {"l1": 0.05, "l2": 0.1, "l3": 0.1}),
        (LEG_B, {"l1": 0.05, "l2": 0.1, "l3": 0.1}),
        (SCARA, {"h": 0.4524, "l1": 0.22, "l2": 0.24}),
        (PENDULUM, {"l1": 0.2}),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_reports_lengths_have_the_reports_names(robot, lengths):
    table = table_of_rows(robot.rows)
    assert {symbol.name: value for symbol, value in table.values.items()} == lengths
    assert [symbol.name for symbol in table.q] == [
        f"q{number}" for number in range(1, len(robot.moving) + 1)
    ]


def test_angles_are_exact_fractions_of_pi_or_symbols():
    table = table_of_rows(ODD)
    assert [row.alpha for row in table.rows[2:]] == [sp.pi / 4, 0, 0, sp.pi]
    assert table.rows[1].theta == sp.pi / 3
    assert table.rows[3].theta == -sp.pi / 2
    names = {symbol.name: value for symbol, value in table.values.items()}
    assert names["alpha1"] == 0.3
    assert names["theta3"] == -0.7
    assert table.rows[2].theta == table.q[1] + sp.Symbol("theta3", real=True)


def test_nearly_a_fraction_of_pi_is_not_taken_for_one():
    nearly = math.pi / 2 + 1e-14
    table = table_of_rows([Row(joint="revolute", alpha=nearly)])
    assert list(table.values.values()) == [nearly]


def test_a_negative_length_is_minus_a_positive_symbol():
    table = table_of_rows([Row(joint="prismatic", d=-0.4, r=-0.1)])
    l1, h = sp.Symbol("l1", positive=True), sp.Symbol("h", positive=True)
    assert table.rows[0].d == -l1
    assert table.rows[0].r == table.q[0] - h
    assert table.values == {h: 0.1, l1: 0.4}


def test_several_lengths_along_z_are_numbered():
    names = {symbol.name for symbol in table_of_rows(PUMA_560).values}
    assert names == {"l1", "l2", "h1", "h2", "h3"}


def fork(**changes):
    """A trunk with two arms, the second from an auxiliary axis."""
    q = sp.symbols("q1:4", real=True)
    zero = sp.Integer(0)
    row = {"joint": "revolute", "d": zero, "alpha": zero, "r": zero}
    rows = (
        SymbolicRow(**row, theta=q[0]),
        SymbolicRow(**row | {"d": sp.Symbol("D2")}, theta=q[1], antecedent=1),
        SymbolicRow(
            **row | {"joint": "prismatic", "r": q[2]},
            theta=zero,
            gamma=sp.Symbol("gamma3"),
            b=sp.Symbol("B3"),
            antecedent=1,
        ),
    )
    return SymbolicTable(**{"name": "fork", "rows": rows, "q": q} | changes)


def test_a_trees_frames_follow_their_antecedents():
    table = fork()
    trunk, arm, side = base_transforms(table)
    assert arm == trunk * row_transform(table.rows[1])
    assert side == trunk * row_transform(table.rows[2])
    assert table.tips == (2, 3)
    assert [table.path(frame) for frame in range(4)] == [(), (1,), (1, 2), (1, 3)]


@pytest.mark.parametrize("antecedent", [2, 3, -1])
def test_an_antecedent_that_is_not_earlier_is_refused(antecedent):
    table = fork()
    first, second, third = table.rows
    moved = SymbolicRow(**vars(second) | {"antecedent": antecedent})
    with pytest.raises(InvalidValueError, match="row 2 of fork has the antecedent"):
        fork(rows=(first, moved, third))


def test_a_frame_that_is_not_there_is_refused():
    with pytest.raises(InvalidValueError, match="fork has no frame 4; its frames are 0 to 3"):
        fork().path(4)


def test_letters_become_numbers():
    table = fork(links=(LinkParameters(M=sp.Symbol("M1")), LinkParameters(), LinkParameters()))
    numbers = table.with_values({"D2": 0.3, "M1": 2.0})
    assert numbers.rows[1].d == sp.Float(0.3)
    assert sp.Float(2.0) == numbers.links[0].M
    assert {symbol.name for symbol in numbers.free_symbols} == {"gamma3", "B3", "g"}
    with pytest.raises(InvalidValueError, match="fork has no letter 'D3'; its letters are B3, D2"):
        table.with_values({"D3": 0.3})
    with pytest.raises(InvalidValueError, match="no letter 'q1'"):
        table.with_values({"q1": 0.3})


def test_inertias_are_about_the_origin_of_the_frame():
    table = table_of_robot(LEG_B)
    values = {symbol.name: value for symbol, value in table.values.items()}
    number, segment = next((n, s) for n, s in enumerate(LEG_B.segments, 1) if s.link is not None)
    mass = values[f"M{number}"]
    x, y, _ = segment.link.centre_of_mass
    assert values[f"MX{number}"] == mass * x
    brick = segment.link.solid.shape
    about_z = mass * ((brick.length**2 + brick.width**2) / 12 + x * x + y * y)
    assert values[f"ZZ{number}"] == pytest.approx(about_z, rel=1e-14)
