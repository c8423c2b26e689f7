"""Rows and columns of a Jacobian that a print means without saying them."""

import pytest

from drake_leg.lab.grader.claims import PLANAR, POSITION, fewest_columns, task_rows
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA

LIFT = {"lift": "452.4-340-R"}
SCARA_J = "-220s1 - 240s12, -240s12, 0; 220c1 + 240c12, 240c12, 0; 1, 1, 1"
LEG_J = (
    "-s1*(50 + 100*c2 + 100*c23), -c1*(100*s2 + 100*s23), -100*c1*s23;"
    "c1*(50 + 100*c2 + 100*c23), -s1*(100*s2 + 100*s23), -100*s1*s23;"
    "0, 100*c2 + 100*c23, 100*c23"
)


def sentences(robot, name, entries, **matrix):
    document = {"lengths": "mm", "angles": "deg", "joints": LIFT if robot is SCARA else {}}
    document["matrix"] = [{"name": name, "entries": entries, **matrix}]
    findings = grade(robot, printed_of_document(document, "print"))
    return [finding.sentence() for finding in findings]


def test_z_is_no_task_where_a_sliding_joint_alone_moves_along_it():
    assert [task_rows(robot, 3) for robot in (LEG_A, LEG_B)] == [POSITION, POSITION]
    assert task_rows(SCARA, 3) == PLANAR
    assert task_rows(SCARA, 4) == POSITION
    assert task_rows(PENDULUM, 1) == POSITION


def test_columns_of_zeros_may_be_left_out():
    assert fewest_columns(SCARA, PLANAR) == 3
    assert fewest_columns(SCARA, POSITION) == 4
    assert fewest_columns(LEG_B, POSITION) == 3


@pytest.mark.parametrize("name", ["J", "Jacobian"])
def test_the_scaras_own_jacobian_needs_no_rows(name):
    assert sentences(SCARA, name, SCARA_J) == []
    assert sentences(SCARA, name, SCARA_J, rows=["x", "y", "yaw"]) == []


@pytest.mark.parametrize("text", ["220*240*s2", "52800 sin(θ2)"])
def test_the_scaras_own_determinant_needs_no_rows(text):
    assert sentences(SCARA, "detJ", text) == []


@pytest.mark.parametrize("columns", [1, 2])
def test_a_jacobian_without_its_last_columns_is_wrong(columns):
    rows = [row.split(",")[:columns] for row in LEG_J.split(";")]
    (sentence,) = sentences(LEG_B, "J", rows)
    assert "should have 3 rows and 3 columns" in sentence
    assert sentences(LEG_B, "J", LEG_J) == []


def test_rows_that_are_not_said_or_unknown_are_not_understood():
    (sentence,) = sentences(LEG_B, "J", "0, 1; 1, 0")
    assert "it does not say what its rows are; name every row under rows" in sentence
    (sentence,) = sentences(LEG_B, "J", "0, 1, 1; 1, 0, 1", rows=["x", "up"])
    assert "its rows are named x, up; name every row under rows" in sentence
