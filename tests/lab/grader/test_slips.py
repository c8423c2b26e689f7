"""One mistake in one entry is named in words, and its remedy is right."""

import pytest

from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.robot.robots import LEG_B, SCARA

LEG = {"L1": 50, "L2": 100, "L3": 100}


def sentence(robot, name, entries, symbols):
    document = {"lengths": "mm", "angles": "deg", "symbols": symbols}
    document["matrix"] = [{"name": name, "entries": entries}]
    (finding,) = grade(robot, printed_of_document(document, "print"))
    return finding.sentence()


def test_another_lengths_number_is_named():
    said = sentence(LEG_B, "T23", "c3, -s3, 0, 50; s3, c3, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1", LEG)
    assert "50 is L1, and L2 belongs there; it should be 100" in said


@pytest.mark.parametrize(
    ("text", "unit"),
    [("0.22*0.24*s2", "m"), ("22*24*s2", "cm"), ("220*240*s2/1000", ""), ("220*240*c2", "")],
)
def test_a_determinants_unit_is_that_of_its_lengths_product(text, unit):
    said = sentence(SCARA, "detJ", text, {"L1": 220, "L2": 240})
    assert (f"lengths are in {unit} and should be in mm" in said) == bool(unit)
    assert "degrees" not in said


@pytest.mark.parametrize("text", ["1000*52800*s2", "1e6*52800*s2", "52800*s2*s2"])
def test_a_wrong_determinant_is_not_said_to_be_in_degrees(text):
    said = sentence(SCARA, "detJ", text, {})
    assert "degrees" not in said
    assert said.endswith("it should be 52800*s2")


def test_numbers_are_said_as_they_are_written():
    entries = "c1, -s1, 0, 0; s1, c1, 0, 0; 0, 0, 1, 453.4 + 0*q1; 0, 0, 0, 1"
    said = sentence(SCARA, "T01", entries, {})
    assert "453.4 should be 452.4; it should be 452.4" in said


def test_one_row_and_one_column_are_counted_in_the_singular():
    said = sentence(LEG_B, "T23", "1", {})
    assert "it has 1 row and 1 column; it should have 4 rows and 4 columns" in said
