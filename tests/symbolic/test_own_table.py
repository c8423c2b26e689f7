from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from trees import two_fingers

from drake_leg.kinematics import khalil
from drake_leg.robot.robot import Row
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import SCARA
from drake_leg.symbolic.derivation import Derivation, evaluator
from drake_leg.symbolic.equations import own_pieces
from drake_leg.symbolic.table import table_of_robot

ROBOTS = Path(__file__).parents[1] / "lab" / "grader" / "robots"
ODD = (
    Row(joint="prismatic", d=0.1, alpha=0.3, r=-0.2, theta=1.1),
    Row(joint="fixed", d=-0.4, alpha=-0.8),
    Row(joint="revolute", d=0.2, alpha=0.5, theta=-0.7),
    Row(joint="revolute", d=0.2),
)
PLANAR = (*(Row(joint="revolute", d=0.1),) * 3, Row(joint="fixed", d=0.1))
DESK = load_robot(ROBOTS / "desk_arm.toml").rows
TABLES = {"odd": ODD, "planar": PLANAR, "scara": SCARA.rows, "desk": DESK}
NAMES = [
    "scara",
    *(pytest.param(name, marks=pytest.mark.slow) for name in ("odd", "planar", "desk")),
]
SQUARE = {"odd": [3, 4, 5], "planar": [2, 3, 4], "scara": [2, 3, 4, 5], "desk": [3, 4, 5]}


@cache
def derived(rows):
    derivation = Derivation(rows)
    return derivation, {piece.title: piece.derive() for piece in own_pieces(derivation)}


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_matrix_is_the_numeric_one(name, rng):
    rows = TABLES[name]
    derivation, found = derived(rows)
    q = rng.uniform(-1.0, 1.0, len(derivation.table.q))
    for frame, X_BC in enumerate(khalil.base_transforms(rows, q), start=1):
        title = f"frame {frame} in the base" if frame > 1 else "frame 1 in frame 0"
        right = evaluator(derivation.table, sp.Matrix(found[title][0].right))
        np.testing.assert_allclose(right(q), X_BC, atol=1e-14)
    J = khalil.jacobian(rows, q)
    right = evaluator(
        derivation.table, found["Jacobian, its rows w_x, w_y, w_z, v_x, v_y, v_z"][0].right
    )
    np.testing.assert_allclose(right(q), J, atol=1e-14)
    assert found["Jacobian by both methods"][0].right == 0


@pytest.mark.parametrize("name", NAMES)
def test_the_determinant_is_that_of_the_rows_that_it_names(name, rng):
    rows, rows_of_jacobian = TABLES[name], SQUARE[name]
    derivation, found = derived(rows)
    (equation,) = found["determinant"]
    parts = ("w_x", "w_y", "w_z", "v_x", "v_y", "v_z")
    named = equation.title.removeprefix("determinant of the rows ").split(", ")
    assert named == [parts[row] for row in rows_of_jacobian]
    q = rng.uniform(-1.0, 1.0, len(derivation.table.q))
    value = float(evaluator(derivation.table, sp.Matrix([[equation.right]]))(q)[0, 0])
    right = np.linalg.det(khalil.jacobian(rows, q)[rows_of_jacobian])
    assert value == pytest.approx(right, abs=1e-14)


@pytest.mark.slow
def test_a_planar_arm_is_singular_where_it_is_stretched():
    _, found = derived(PLANAR)
    assert [equation.title for equation in found["singular postures"]] == [
        "singular where",
        "q2 there, k any integer",
    ]


@pytest.mark.slow
def test_an_arm_of_six_joints_has_its_wrist_among_its_families():
    derivation, found = derived(load_robot(ROBOTS / "rx90.toml").rows)
    stated = [
        equation for equation in found["singular postures"] if equation.title[:8] == "singular"
    ]
    assert sp.sin(derivation.table.q[4]) in [equation.left for equation in stated]
    assert found["Jacobian by both methods"][0].right == 0


@pytest.mark.slow
def test_a_tree_has_a_jacobian_for_each_tip_with_the_joints_that_move_it(rng):
    robot = two_fingers()
    table = table_of_robot(robot)
    titles = [piece.title for piece in own_pieces(Derivation(table))]
    for row, antecedent in enumerate(robot.antecedents, start=1):
        assert f"frame {row} in frame {antecedent}" in titles
    tips = sorted(robot.tips.values())
    assert [t for t in titles if t.startswith("Jacobian of frame") and "rows" in t] == [
        f"Jacobian of frame {tip}, its rows w_x, w_y, w_z, v_x, v_y, v_z, per "
        + ", ".join(str(q) for q in table.branch(tip).q)
        for tip in tips
    ]
    q = rng.uniform(-1.0, 1.0, len(table.q))
    for name, tip in robot.tips.items():
        branch = table.branch(tip)
        columns = [table.q.index(position) for position in branch.q]
        expected = khalil.jacobian(robot.at_tip(name).rows, q[columns])
        found = evaluator(branch, Derivation(branch).spatial_jacobian)(q[columns])
        np.testing.assert_allclose(found, expected, atol=1e-14)
