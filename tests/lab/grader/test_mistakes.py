"""Mistakes of a whole matrix: one finding, and the few entries that it does not explain."""

import pytest

from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import Printed, PrintedMatrix
from drake_leg.robot.robots import LEG_B, PENDULUM, SCARA

REACH = "(50 + 100*c2 + 100*c23)"
BOTTOM = ("0", "0", "0", "1")
T04 = (
    ("c1*c23", "-c1*s23", "s1", f"c1*{REACH}"),
    ("s1*c23", "-s1*s23", "-c1", f"s1*{REACH}"),
    ("s23", "c23", "0", "100*s2 + 100*s23"),
    BOTTOM,
)
J = (
    (f"-s1*{REACH}", "-c1*(100*s2 + 100*s23)", "-100*c1*s23"),
    (f"c1*{REACH}", "-s1*(100*s2 + 100*s23)", "-100*s1*s23"),
    ("0", "100*c2 + 100*c23", "100*c23"),
)


def found(name, entries, robot=LEG_B, **more):
    matrix = PrintedMatrix(name=name, entries=tuple(map(tuple, entries)), **more)
    return grade(robot, Printed(origin="print", lengths="mm", matrices=(matrix,)))


def put(entries, row, column, text):
    """Write another text into an entry, counted from 1."""
    rows = [list(cells) for cells in entries]
    rows[row - 1][column - 1] = text
    return rows


def turned(entries):
    return [list(cells) for cells in zip(*entries, strict=True)]


def test_a_mistake_of_the_whole_says_its_kind_matrix_and_entries():
    (finding,) = found("T04", turned(T04))
    assert finding.sentence() == "T04: it is transposed; exchange its rows and columns"
    assert (finding.kind, finding.matrix) == ("transposed", "T04")
    assert (1, 2) in finding.entries
    assert (4, 1) in finding.entries
    assert (1, 1) not in finding.entries
    assert finding.as_json()["kind"] == "transposed"


def test_what_it_does_not_explain_has_its_own_finding():
    whole, entry = found("T04", put(turned(T04), 4, 3, "100*s2 - 90*c23"))
    assert whole.fault == "it is transposed"
    assert entry.sentence() == "T04 (4, 3): printed 100*s2 - 90*c23; it should be 0"


def test_two_slips_are_no_mistake_of_the_whole():
    findings = found("T04", put(put(T04, 1, 2, "c1*s23"), 3, 1, "-s23"))
    assert [finding.place for finding in findings] == ["T04 (1, 2)", "T04 (3, 1)", "T04"]
    assert findings[2].kind == "no rotation"


def test_what_cannot_be_read_stays_apart_from_what_is_wrong():
    unread, whole = sorted(found("T04", put(turned(T04), 1, 1, "???")), key=lambda f: f.understood)
    assert (unread.place, unread.understood) == ("T04 (1, 1)", False)
    assert whole.fault == "it is transposed"


METRES = [f"({row[3]})/1000" for row in T04[:3]]


@pytest.mark.parametrize(
    ("name", "entries", "words"),
    [
        ("R04", turned([row[:3] for row in T04[:3]]), "it is transposed"),
        ("P04", [METRES], "lengths are in m and should be in mm"),
        ("T04", [[*T04[i][:3], METRES[i]] for i in range(3)], "are in m and should be in mm"),
    ],
)
def test_parts_and_lying_positions_are_explained_too(name, entries, words):
    (finding,) = found(name, entries)
    assert words in finding.fault


def test_a_column_of_zeros_is_named():
    rows = [[*row[:2], "0"] for row in J]
    (finding,) = found("J", rows)
    assert finding.fault == "column 3 is zero"


def test_a_transposed_jacobian_of_six_rows_is_named_by_its_shape():
    six = (("0", "s1", "s1"), ("0", "-c1", "-c1"), ("1", "0", "0"), *J)
    assert found("J", six) == []
    (finding,) = found("J", turned(six))
    assert finding.fault == "it has 3 rows and 6 columns and seems transposed"


def test_one_wrong_entry_may_come_from_another_table():
    """Erratum 12: the SCARA's height is left out of T01."""
    rows = (("c1", "-s1", "0", "0"), ("s1", "c1", "0", "0"), ("0", "0", "1", "0"), BOTTOM)
    (finding,) = found("T01", rows, SCARA)
    assert finding.sentence() == (
        "T01 (3, 4): printed 0, in which r of row 1 is left out; it should be 452.4"
    )


def test_a_determinant_that_the_robot_has_not_is_not_understood():
    (finding,) = found("detJ", (("1",),), PENDULUM)
    assert not finding.understood
    assert "a determinant of 3 rows, and pendulum has 1 joint positions" in finding.fault
