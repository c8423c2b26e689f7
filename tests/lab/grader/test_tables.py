"""The linter: every slip with its row and its remedy."""

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from trees import parallelogram, two_fingers

from drake_leg.lab.grader.findings import errors
from drake_leg.lab.grader.printed import read_printed
from drake_leg.lab.grader.table_slips import lint_branches, lint_friction, lint_sizes, lint_table
from drake_leg.lab.grader.tables import COLUMNS, Table, TableRow, repaired, table_of_document
from drake_leg.robot.robot import Link
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, ROBOTS, hexabot_leg
from drake_leg.robot.solids import Inertial
from drake_leg.robot.symoro.reader import read_par
from drake_leg.robot.symoro.writer import robot_par
from drake_leg.robot.toml.keys import parse_document
from drake_leg.robot.toml.reader import read_robot
from drake_leg.robot.toml.writer import robot_toml

PRINTED = Path(__file__).parent / "printed"


def table(*rows, convention="khalil", angles="deg", lengths="mm"):
    """Make a table of rows, each the text of its cells."""
    columns = COLUMNS[convention]
    cells = [dict(zip(columns, row.split("|"), strict=True)) for row in rows]
    return Table(
        rows=tuple(TableRow(frame="", cells=row) for row in cells),
        convention=convention, angles=angles, lengths=lengths,
    )  # fmt: skip


def only(findings):
    """Return the sentence of the one finding."""
    (finding,) = findings
    return finding.sentence()


@pytest.mark.parametrize("name", ["report_b_leg_table.txt", "report_b_leg.toml"])
def test_report_bs_leg_table_is_read_as_it_stands_and_every_shifted_row_is_named(name):
    """Erratum 17."""
    findings = lint_table(read_printed(PRINTED / name).table)
    assert [finding.place for finding in findings] == ["row 2", "row 3", "row 4"]
    assert all("one column to the left, and sigma is missing" in f.fault for f in findings)
    assert "sigma is 'L_1', a length; d is '90°', an angle" in findings[0].fault
    assert [finding.remedy for finding in findings] == [
        "write sigma = 0, d = L_1, alpha = 90°, r = 0, theta = θ_2",
        "write sigma = 0, d = L_2, alpha = 0, r = 0, theta = θ_3",
        "write sigma = ~, d = L_3, alpha = 0, r = 0, theta = 0",
    ]


def test_report_bs_scara_table_has_no_error():
    assert not errors(lint_table(read_printed(PRINTED / "report_b_scara_table.txt").table))
    assert not lint_table(read_printed(PRINTED / "report_b_scara.toml").table)


def test_a_table_of_numbers_is_read_without_sympy():
    code = (
        "import sys\n"
        "from drake_leg.lab.grader.table_slips import lint_table\n"
        "from drake_leg.lab.grader.tables import table_of_document\n"
        "row = {'sigma': 0, 'd': 0.1, 'alpha': -90.0, 'r': 1e-3, 'theta': 0}\n"
        "assert not lint_table(table_of_document({'angles': 'deg', 'row': [row]}))\n"
        "assert 'sympy' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_report_as_table_has_no_fault():
    assert not lint_table(read_printed(PRINTED / "report_a_leg.toml").table)


def test_shifted_rows_are_put_right():
    right = repaired(read_printed(PRINTED / "report_b_leg_table.txt").table)
    assert not lint_table(right)
    assert right.rows[1].cells["d"] == "L_1"


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_reports_robots_have_no_fault(robot):
    document = parse_document(robot_toml(robot), robot.name)
    assert not lint_table(table_of_document(document))
    assert not list(lint_sizes(robot))


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("|0|0|0|θ1", "sigma is missing; write sigma = 0"),
        ("|0|0|q1|0", "sigma is missing; write sigma = 1"),
        ("|L1|0|0|0", "sigma is missing; write sigma = ~"),
        ("R|0|0|0|θ1", "sigma is 'R', which is not a joint type; write sigma = 0"),
        ("prismatic|0|0|q1|0", "sigma is 'prismatic', which is not a joint type; write sigma = 1"),
        ("2|0|0|0|θ1", "sigma is '2', which is not a joint type; write sigma = 0"),
        ("0||0|0|θ1", "d is missing; write d = 0"),
        (
            "0|90°|L1|0|θ1",
            "d is '90°', an angle; alpha is 'L1', a length: d and alpha have changed",
        ),
        (
            "0|90°|L1|L2|θ1",
            "d is '90°', an angle; alpha is 'L1', a length: d and alpha have changed",
        ),
        ("0|90°|L1|90°|θ1", "d is '90°', an angle; a length belongs there"),
        ("0|θ1|0|0|θ1", "d is 'θ1', a joint's variable; a length belongs there"),
        ("0|L1|90°|0|0", "sigma is 0 and the row has no variable"),
        ("0|0|0|q1|0", "sigma is 0 and r has the variable q1; sigma = 0 moves by theta"),
        ("1|0|0|0|θ1", "sigma is 1 and theta has the variable θ1; sigma = 1 moves by r"),
        ("~|0|0|0|θ1", "sigma is ~ and theta has the variable θ1; a fixed row has no variable"),
    ],
)
def test_a_slip_in_a_symbolic_table_is_named_with_its_remedy(row, said):
    findings = lint_table(table(row, "0|0|0|0|θ9"))
    assert any(f.sentence().startswith(f"row 1: {said}") for f in findings), findings


def test_a_cell_that_is_no_formula_is_not_understood():
    (finding,) = lint_table(table("0|0|0|0|foo("))
    assert not finding.understood
    assert finding.fault == "theta is 'foo(', neither a number nor a formula"


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("0|90°|0|0|θ1", "write sigma = 0, d = ?, alpha = 90°, r = 0, theta = θ1"),
        ("|0|L1|90°|0", "write sigma = 0, d = L1, alpha = 90°, r = ?, theta = 0"),
        ("0.05|90|0|0|0", "write sigma = ?, d = 0.05, alpha = 90, r = 0, theta = 0"),
    ],
)
def test_a_shift_either_way_is_recognised(row, said):
    (finding,) = lint_table(table(row))
    assert "one column to the" in finding.fault
    assert finding.remedy == said


def test_a_variable_twice_is_named():
    assert "its variable θ1 is that of row 1" in only(lint_table(table("0|0|0|0|θ1", "0|1|0|0|θ1")))


def test_frames_out_of_order_are_named():
    rows = tuple(TableRow(frame=f, cells={"sigma": "0", "d": "0", "alpha": "0", "r": "0",
                                          "theta": f"q{f}"}) for f in "13")  # fmt: skip
    assert "its frame is '3'" in only(lint_table(Table(rows=rows, angles="deg", lengths="mm")))


@pytest.mark.parametrize(
    ("row", "units", "said"),
    [
        ("0|0|90|0|0", {"angles": "rad"}, "alpha is 90 rad, which is 14.3 turns"),
        ("0|0|0|0|-180", {"angles": "rad"}, "theta is -180 rad"),
        ("0|0|1.5708|0|0", {"angles": "deg"}, "alpha is 1.5708 deg, which is nearly 0.5 pi"),
        ("0|0|-3.14|0|0", {"angles": "deg"}, "alpha is -3.14 deg, which is nearly -1 pi"),
        ("0|100|0|0|0", {"lengths": "m"}, "d is 100 m; write 0.1 if it is 100 mm"),
        ("0|90|0|0|0", {"lengths": "m"}, "or move it if it is an angle"),
        ("0|0|0|-452.4|0", {"lengths": "m"}, "r is -452.4 m; write -0.4524"),
        ("0|0.05|0|0|0", {"lengths": "mm"}, "d is 0.05 mm; write 50 if it is 0.05 m"),
        ("0|50|0|20|0", {"lengths": None}, "the unit of its lengths is missing"),
        ("0|0|90|0|45", {"angles": None}, "the unit of its angles is missing"),
    ],
)
def test_a_number_in_another_unit_is_guessed_and_no_error(row, units, said):
    findings = lint_table(table(row, **units))
    assert not errors(findings)
    assert said in only(findings)
    assert "(a guess)" in only(findings)


@pytest.mark.parametrize(
    ("row", "units"),
    [
        ("0|0.5|1.5707963267948966|0|0", {"angles": "rad", "lengths": "m"}),
        ("0|50|90|0|-45", {}),
        ("0|452.4-340|90°|0|-π/2", {}),
        ("0|9.5|0|0|0", {"lengths": "m"}),
        ("0|0|30|0|0", {}),
    ],
)
def test_plain_numbers_raise_no_doubt(row, units):
    assert not lint_table(table(row, **units))


def test_a_classic_table_under_khalils_headings_is_guessed_with_honest_words():
    puma = ("0|0|-90|0|0", "0|431.8|0|149.09|0", "0|20.32|90|0|0", "0|0|0|56.25|0")
    said = only(lint_table(table(*puma)))
    for words in ("row 1 (a guess)", "alpha = -90", 'convention = "classic"', "nothing is wrong"):
        assert words in said


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, PENDULUM], ids=lambda robot: robot.name)
def test_a_khalil_table_is_not_taken_for_classic(robot):
    document = parse_document(robot_toml(robot), robot.name)
    assert not lint_table(table_of_document(document))


def test_a_classic_column_among_khalils_is_an_error():
    document = {"angles": "deg", "row": [{"sigma": 0, "theta": 0, "d": 0, "a": 0.4, "alpha": 0}]}
    said = only(lint_table(table_of_document(document)))
    assert said.startswith("row 1: it has a, a column of the classic (standard) convention")
    assert not lint_table(table_of_document({"convention": "classic", **document}))


def test_a_misspelt_column_is_recognised():
    document = {"angles": "deg", "row": [{"sigma": 0, "d": 0, "alfa": 0, "r": 0, "theta": 0}]}
    said = only(lint_table(table_of_document(document)))
    assert said == "row 1: alpha is missing; write alpha for 'alfa'"


@pytest.mark.parametrize("document", [{}, {"row": 1}, {"row": [1]}, {"row": {}}])
def test_a_document_without_a_table_is_left_to_the_reader(document):
    assert len(table_of_document(document).rows) == (document.get("row") == [1])


CELLS = st.sampled_from(
    ["", "0", "1", "~", "90", "90°", "L1", "θ1", "q2", "0.05", "R", "1/0", "a("]
)


@pytest.mark.slow
@given(st.lists(st.tuples(*[CELLS | st.text(max_size=5)] * 5), max_size=4), st.booleans())
def test_any_table_is_read_and_what_is_repaired_is_no_worse(rows, units):
    columns = COLUMNS["khalil"]
    cells = tuple(TableRow(frame="", cells=dict(zip(columns, row, strict=True))) for row in rows)
    printed = Table(rows=cells, angles="deg" if units else None, lengths="m" if units else None)
    before, after = lint_table(printed), lint_table(repaired(printed))
    faulty = {finding.place for finding in errors(before)}
    assert {finding.place for finding in errors(after) if "variable" not in finding.fault} <= faulty


def test_millimetres_in_the_place_of_metres_are_found_in_solids_too():
    long = hexabot_leg("B", l2=100.0)
    faults = {finding.fault for finding in lint_sizes(long)}
    assert "the solid's length is 100 m" in faults
    assert "the link's end is 100 m" in faults
    assert all(finding.severity == "warning" for finding in lint_sizes(long))
    assert read_robot(robot_toml(long), "x.toml") == long


def with_inertial(mass, moment):
    hip, *rest = hexabot_leg("B").segments
    body = Inertial(mass=mass, centre=(0.02, 0.0, 0.0), moments=(moment, moment, moment))
    link = replace(hip.link, inertial=body)
    return replace(hexabot_leg("B"), segments=(replace(hip, link=link), *rest))


def test_an_inertia_that_no_such_link_has_is_a_warning():
    (finding,) = lint_sizes(with_inertial(0.1, 0.1 * 0.141**2))
    assert finding.severity == "warning"
    assert finding.place == "row 1"
    assert "radius of gyration of 141 mm" in finding.fault
    assert not list(lint_sizes(with_inertial(0.1, 0.1 * 0.02**2)))


def test_no_robot_of_the_reports_has_such_an_inertia():
    for robot in ROBOTS:
        assert not list(lint_sizes(robot))


def test_gamma_and_b_are_doubtful_where_no_branch_needs_them():
    assert not list(lint_branches(two_fingers()))
    wrist, *others = two_fingers().segments
    turned = replace(wrist, row=replace(wrist.row, gamma=math.pi / 6, b=0.1))
    faults = [f.fault for f in lint_branches(replace(two_fingers(), segments=(turned, *others)))]
    assert [fault.partition(":")[0] for fault in faults] == [
        "gamma is 30 deg, which no branch needs",
        "b is 0.1 m, which no branch needs",
    ]


def test_a_link_of_a_tree_is_as_long_as_the_way_to_what_it_carries():
    """The row after the left tip belongs to the other finger, 0.09 m from the wrist."""
    tree = two_fingers()
    wide = 0.01 * 0.05**2  # a radius of gyration of 50 mm
    body = Inertial(mass=0.01, centre=(0.0, 0.0, 0.0), moments=(wide, wide, wide))
    tip = replace(tree.segments[2], link=Link(name="left_tip", inertial=body, end=(0.02, 0, 0)))
    segments = (*tree.segments[:2], tip, *tree.segments[3:])
    (finding,) = lint_sizes(replace(tree, segments=segments))
    assert "the link is 20 mm long" in finding.fault


def test_the_frames_of_a_loop_may_be_turned():
    robot = parallelogram()
    *links, cut, end = robot.segments
    turned = replace(cut, row=replace(cut.row, gamma=0.3))
    robot = replace(robot, segments=(*links, turned, end))
    assert not list(lint_branches(robot))
    assert not read_par(robot_par(robot), "x.par").notes


def test_dry_friction_is_said_to_be_in_no_simulation():
    mechanics = replace(LEG_B.segments[0].mechanics, dry_friction=0.3)
    first = replace(LEG_B.segments[0], mechanics=mechanics)
    (finding,) = lint_friction(replace(LEG_B, segments=(first, *LEG_B.segments[1:])))
    assert finding.sentence().startswith("row 1 (a guess): the dry friction is 0.3 N*m")
