"""Numbers rounded or cut off in print, and numbers that are off by one in their last digit."""

import pytest

from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.robot.robots import LEG_B, SCARA


def wrong(name, entries, robot=LEG_B, **settings):
    document = {"lengths": "mm", "angles": "deg", **settings}
    document["matrix"] = [{"name": name, "entries": entries}]
    findings = grade(robot, printed_of_document(document, "print"))
    return [finding.place for finding in findings if finding.entries]


@pytest.mark.parametrize("length", ["49.9", "49.95", "50.1", "49.99", "49.999"])
def test_a_last_digit_off_by_one_is_wrong(length):
    entries = f"c2, -s2, 0, {length}; 0, 0, -1, 0; s2, c2, 0, 0; 0, 0, 0, 1"
    assert wrong("T12", entries) == ["T12 (1, 4)"]


def test_a_height_and_a_one_off_by_one_are_wrong():
    entries = "c1, -s1, 0, 0; s1, c1, 0, 0; 0, 0, 0.999, {}; 0, 0, 0, 1"
    assert wrong("T01", entries.format("452.4"), SCARA) == ["T01 (3, 3)"]
    assert wrong("T01", entries.format("452.3"), SCARA) == ["T01 (3, 3)", "T01 (3, 4)"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("x", "y"),
    [
        ("219.9*c1 + 239.9*c12", "219.9*s1 + 239.9*s12"),
        ("220.1*c1 + 239.9*c12", "220.1*s1 + 239.9*s12"),
        ("220.0*c1 + 239.9*c12", "219.9*s1 + 240.0*s12"),
    ],
)
def test_each_of_several_numbers_is_judged(x, y):
    assert wrong("P04", [x, y, "340 + q4"], SCARA, joints={"q4": "452.4-340-q4"}) == [
        "P04 (1, 1)",
        "P04 (2, 1)",
    ]


@pytest.mark.slow
def test_several_lengths_in_metres_off_by_one_are_wrong():
    reach = "(0.0499 + 0.0999*c2 + 0.0999*c23)"
    entries = [f"{reach}*c1", f"{reach}*s1", "0.1*s2 + 0.0999*s23"]
    assert wrong("P04", entries, lengths="m") == ["P04 (1, 1)", "P04 (2, 1)", "P04 (3, 1)"]


@pytest.mark.parametrize("alpha", ["1.5708", "1.5707", "1.571", "1.570", "1.57", "1.570796"])
def test_a_quarter_turn_may_be_rounded_or_cut_off(alpha):
    cosine, sine = f"cos({alpha})", f"sin({alpha})"
    entries = (
        f"c2, -s2, 0, 50; {cosine}*s2, {cosine}*c2, -{sine}, 0; {sine}*s2, {sine}*c2, {cosine}, 0;"
        "0, 0, 0, 1"
    )
    assert wrong("T12", entries) == []


@pytest.mark.parametrize("digits", ["0.7071", "0.70710", "0.707", "0.7072", "0.7070"])
def test_roots_of_a_half_may_be_rounded_or_cut_off(digits):
    entries = f"1.4142*{digits}*c1, -s1, 0, 0; s1, c1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1"
    assert wrong("T01", entries) == ([] if digits != "0.7072" else ["T01 (1, 1)"])


@pytest.mark.parametrize(("column", "text"), [("d", "49.9"), ("d", "99.9"), ("alpha", "89.9")])
def test_a_cell_of_a_table_off_by_one_is_wrong(column, text):
    rows = [
        {"d": "0", "alpha": "0", "r": "0", "theta": "q1", "sigma": "0"},
        {"d": "50", "alpha": "90", "r": "0", "theta": "q2", "sigma": "0"},
        {"d": "100", "alpha": "0", "r": "0", "theta": "q3", "sigma": "0"},
        {"d": "100", "alpha": "0", "r": "0", "theta": "0", "sigma": "~"},
    ]
    assert grade_rows(rows) == []
    row = 2 if text == "99.9" else 1
    rows[row][column] = text
    assert grade_rows(rows) == [f"row {row + 1}"]


def grade_rows(rows):
    table = {"lengths": "mm", "angles": "deg", "table": rows}
    return [finding.place for finding in grade(LEG_B, printed_of_document(table, "print"))]
