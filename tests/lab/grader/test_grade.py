"""The grader: report B's misprints, typed as they stand, each come back with its name."""

import math
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from trees import two_fingers

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.claims import Claim
from drake_leg.lab.grader.grade import _grade_caption, grade, rotation_fault
from drake_leg.lab.grader.printed import Printed, PrintedMatrix, read_printed
from drake_leg.lab.grader.slips import Vocabulary, explain
from drake_leg.lab.grader.tables import Table, TableRow
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.robot.toml.reader import read_robot
from drake_leg.symbolic.formulas import evaluate
from drake_leg.symbolic.parser import parse_formula

HERE = Path(__file__).parent
FINGERS = two_fingers()
BOTTOM = ("0", "0", "0", "1")
RIGHT_T12 = (("c2", "-s2", "0", "50"), ("0", "0", "-1", "0"), ("s2", "c2", "0", "0"), BOTTOM)


@pytest.fixture(scope="module")
def leg():
    """Findings about report B's leg, place to fault and remedy."""
    return by_place(grade(LEG_B, read_printed(HERE / "printed" / "report_b_leg.toml")))


@pytest.fixture(scope="module", params=["report_b_scara.toml", "report_b_scara.csv"])
def scara(request):
    return by_place(grade(SCARA, read_printed(HERE / "printed" / request.param)))


def by_place(findings):
    places = {}
    for finding in findings:
        whole = ", whole" if finding.matrix == finding.place and finding.entries else ""
        place = re.sub(r"T_(\d)\^", r"T\1", finding.place + whole)
        assert place not in places
        places[place] = (finding.fault, finding.remedy)
    return places


def wrong_entries(findings, name):
    """Return the wrong entries of a matrix that stand alone: (row, column) -> what is right."""
    entries = {}
    for place, (_, remedy) in findings.items():
        if place.startswith(f"{name} ("):
            row, column = place.removeprefix(f"{name} (").removesuffix(")").split(", ")
            entries[int(row), int(column)] = remedy.removeprefix("it should be ")
    return entries


def test_erratum_12_the_scaras_height(scara):
    assert wrong_entries(scara, "T01") == {(3, 4): "452.4"}
    assert wrong_entries(scara, "T03") in ({(3, 4): "452.4"}, {})  # the CSV has no T03


def test_erratum_13_the_scaras_t12(scara):
    assert wrong_entries(scara, "T12") == {(3, 2): "0", (3, 3): "1"}
    assert "not a rotation: columns 2 and 3 are not of length 1" in scara["T12"][0]


def test_erratum_14_the_scaras_t34(scara):
    right = {(1, 3): "0", (2, 2): "-1", (2, 4): "0", (3, 4): "R - 112.4"}
    assert wrong_entries(scara, "T34") == right
    assert "not a rotation" in scara["T34"][0]


def test_erratum_15_the_first_two_dof_are_three(scara):
    fault, remedy = scara["J, caption"]
    assert fault == "it says two degrees of freedom, and the matrix spans three joints"
    assert remedy == "write three"


@pytest.mark.parametrize(("word", "remedies"), [("three", ["write 12"]), ("12", []), ("²", [])])
def test_a_caption_may_count_more_than_nine_joints(word, remedies):
    claim = Claim(name="J", kind="jacobian", rows=(3, 4, 5), shape=(3, 12))
    matrix = SimpleNamespace(caption=f"{word} DOF", claim=claim)
    assert [finding.remedy for finding in _grade_caption(matrix, LEG_B)] == remedies


def test_the_scaras_table_jacobian_and_determinant_are_right(scara):
    named = {place.split(" ")[0].rstrip(",") for place in scara}
    assert named <= {"T01", "T12", "T34", "T03", "J"}
    assert not wrong_entries(scara, "J")


@pytest.mark.slow
def test_erratum_17_the_legs_table(leg):
    assert [place for place in leg if place.startswith("row")] == ["row 2", "row 3", "row 4"]


def test_erratum_18_the_legs_t12(leg):
    right = {(1, 2): "-sin(θ2)", (1, 3): "0", (3, 2): "cos(θ2)", (3, 3): "0"}
    assert wrong_entries(leg, "T12") == right
    assert "not a rotation" in leg["T12"][0]


def test_erratum_19_the_legs_t34(leg):
    assert wrong_entries(leg, "T34") == {(1, 3): "0", (2, 4): "0"}
    assert "not a rotation" in leg["T34"][0]


def test_erratum_20_the_legs_t04(leg):
    assert leg["T04, whole"] == (
        "θ2 - θ3 should be θ2 + θ3 in (1, 1), (1, 4), (2, 1) and (2, 4)",
        "write θ2 + θ3 there",
    )
    wrong = wrong_entries(leg, "T04")
    assert set(wrong) == {(1, 2), (2, 2)}
    assert wrong[1, 2] == "-sin(θ2 + θ3)*cos(θ1)"
    for place in ("T04 (1, 2)", "T04 (2, 2)"):
        assert "θ2 - θ3 should be θ2 + θ3, and a minus sign in front is missing" in leg[place][0]
    assert "not a rotation" in leg["T04"][0]
    assert leg["T04, caption"][1] == "write three"


@pytest.mark.parametrize("name", ["J", "Jacobian"])
def test_erratum_21_the_legs_jacobian(leg, name):
    wrong = wrong_entries(leg, name)
    assert set(wrong) == {(1, 3), (2, 3)} | ({(1, 2)} if name == "J" else set())
    assert wrong[1, 3] == "-100*sin(θ2 + θ3)*cos(θ1)"
    assert wrong[2, 3] == "-100*sin(θ1)*sin(θ2 + θ3)"
    for row, column in wrong:
        assert "θ2 - θ3 should be θ2 + θ3" in leg[f"{name} ({row}, {column})"][0]
    others = "(1, 1), (2, 1) and (2, 2)" if name == "J" else "(1, 1), (1, 2), (2, 1) and (2, 2)"
    assert leg[f"{name}, whole"][0] == f"θ2 - θ3 should be θ2 + θ3 in {others}"
    if name == "J":
        assert "+ 1 should not be there" in leg["J (1, 2)"][0]


@pytest.mark.slow
def test_every_wrong_entry_of_the_leg_is_in_one_finding():
    findings = grade(LEG_B, read_printed(HERE / "printed" / "report_b_leg.toml"))
    entries = [(f.matrix, entry) for f in findings for entry in f.entries]
    assert len(entries) == len(set(entries))
    assert Counter(matrix for matrix, _ in entries) == {
        "T_1^2": 4, "T_3^4": 2, "T_0^4": 6, "P04": 2, "J": 6, "Jacobian": 6,
    }  # fmt: skip


def test_nothing_else_of_the_leg_is_called_wrong(leg):
    """T01 and T23 are right in print; P04 repeats the last column of T04."""
    matrices = {place.split(" ")[0].rstrip(",") for place in leg}
    assert matrices == {"row", "T12", "T34", "T04", "P04", "J", "Jacobian"}
    assert len(leg) == 24


def test_report_as_transforms_are_right_and_its_two_slips_are_named():
    """Erratum 9."""
    findings = by_place(grade(LEG_A, read_printed(HERE / "printed" / "report_a_leg.toml")))
    assert set(findings) == {"P04 (3, 1)", "J (1, 3)"}
    assert "z has no value" in findings["P04 (3, 1)"][0]
    assert findings["P04 (3, 1)"][1].startswith("it should be -l2*s2 - l3*s23")
    assert findings["J (1, 3)"] == (
        "printed -s1s23l3, in which s1 should be c1",
        "it should be -l3*s23*c1",
    )


def leg_print(name, entries, **more):
    return Printed(
        origin="print", lengths="mm", angles="deg",
        matrices=(PrintedMatrix(name=name, entries=entries, **more),),
    )  # fmt: skip


def leg_sentences(name, entries, robot=LEG_B, **more):
    return [finding.sentence() for finding in grade(robot, leg_print(name, entries, **more))]


def test_a_right_print_has_no_finding_in_any_notation():
    for spelling in ("c2", "cos(q2)", "cos(θ2)", r"\cos\theta_{2}", "cos th2"):
        entries = [[cell.replace("c2", spelling) for cell in row] for row in RIGHT_T12]
        assert not leg_sentences("T12", entries)


@pytest.mark.parametrize("name", ["T12", "T_1^2", "T_2^1", "T^1_2", "T1_2", "T_{12}"])
def test_a_transforms_name_is_read_in_either_order(name):
    assert not leg_sentences(name, RIGHT_T12)


def test_lengths_in_metres_are_metres():
    entries = [[cell.replace("50", "0.05") for cell in row] for row in RIGHT_T12]
    matrix = PrintedMatrix(name="T12", entries=tuple(map(tuple, entries)))
    assert not grade(LEG_B, Printed(origin="print", lengths="m", matrices=(matrix,)))


def test_a_left_handed_matrix_is_no_rotation():
    mirror = (("c2", "s2", "0", "0"), ("s2", "-c2", "0", "0"), ("0", "0", "1", "0"), BOTTOM)
    assert any("a mirror's" in sentence for sentence in leg_sentences("T01", mirror))


def test_a_matrix_of_another_shape_is_named():
    (said,) = leg_sentences("T01", (("1", "0"), ("0", "1")))
    assert said == "T01: it has 2 rows and 2 columns; it should have 4 rows and 4 columns"
    (said,) = leg_sentences("J", [["0"] * 4] * 3)
    assert "it should have 3 rows and 3 columns" in said


def test_an_entry_that_is_no_formula_is_named_with_what_is_right():
    entries = (("c2", "-s2 +", "0", "50"), *RIGHT_T12[1:])
    (said,) = leg_sentences("T12", entries)
    assert said.startswith("T12 (1, 2) (not understood): '-s2 +' is not a formula")
    assert said.endswith("it should be -s2")


def test_a_joint_that_the_robot_has_not_is_named():
    (said,) = leg_sentences("T12", (("c5", "-s2", "0", "50"), *RIGHT_T12[1:]))
    assert "q5 has no value" in said


@pytest.mark.parametrize(
    ("name", "rows", "said"),
    [
        ("T05", (), "frames 0 to 4"),
        ("K", (), "means nothing here"),
        ("J", ("x", "y", "roll"), "name every row"),
    ],
)
def test_a_claim_that_means_nothing_is_not_understood(name, rows, said):
    (finding,) = grade(LEG_B, leg_print(name, RIGHT_T12[:3], rows=rows))
    assert not finding.understood
    assert said in finding.sentence()


def test_a_jacobian_of_four_rows_must_say_which():
    (said,) = leg_sentences("J", [["0"] * 3] * 4)
    assert "name every row" in said


def test_a_jacobian_of_six_rows_has_the_rotation_first():
    rotation = (("0", "s1", "s1"), ("0", "-c1", "-c1"), ("1", "0", "0"))
    translation = (
        ("-s1*(50 + 100c2 + 100c23)", "-c1*(100s2 + 100s23)", "-100c1*s23"),
        ("c1*(50 + 100c2 + 100c23)", "-s1*(100s2 + 100s23)", "-100s1*s23"),
        ("0", "100c2 + 100c23", "100c23"),
    )
    assert not leg_sentences("J", rotation + translation)
    names = ("x", "y", "z", "wx", "wy", "wz")
    assert not leg_sentences("J", translation + rotation, rows=names)


def test_a_sliding_joints_column_has_no_unit():
    """(x, y, z) of the SCARA against all four joints, in mm."""
    entries = (
        ("-220s1 - 240s12", "-240s12", "0", "0"),
        ("220c1 + 240c12", "240c12", "0", "0"),
        ("0", "0", "0", "-1"),
    )
    assert not grade(SCARA, leg_print("J", entries))


def test_without_units_matrices_are_not_graded():
    matrix = PrintedMatrix(name="T12", entries=RIGHT_T12)
    with pytest.raises(InvalidValueError, match=r"lengths is missing; .* not a file of printed"):
        grade(LEG_B, Printed(origin="print", matrices=(matrix,)))


def test_without_units_a_table_of_symbols_is_compared():
    findings = grade(LEG_B, read_printed(HERE / "printed" / "report_b_leg_table.txt"))
    assert Counter(finding.understood for finding in findings) == {True: 3, False: 3}
    assert {f.fault for f in findings if not f.understood} == {
        f"d is L_{i}: l{i} has no value" for i in (1, 2, 3)
    }


def test_without_units_a_table_with_lengths_is_not_compared():
    printed = replace(branching_table(), lengths=None)
    with pytest.raises(InvalidValueError, match="lengths is missing"):
        grade(FINGERS, printed)


def branching_table(**changed):
    """Write the table of two fingers; ``b2="40"`` changes a cell of row 2."""
    rows = []
    for number, row in enumerate(FINGERS.segments, start=1):
        cells = {"sigma": {"revolute": "0", "prismatic": "1", "fixed": "~"}[row.row.joint]}
        for column in ("d", "b", "r"):
            cells[column] = f"{1000 * getattr(row.row, column):.12g}"
        for column in ("alpha", "gamma", "theta"):
            cells[column] = f"{math.degrees(getattr(row.row, column)):.12g}"
        cells["antecedent"] = str(FINGERS.antecedents[number - 1])
        if row.row.joint != "fixed":
            moving = "theta" if row.row.joint == "revolute" else "r"
            cells[moving] = f"q{FINGERS.moving.index(row) + 1} + {cells[moving]}"
        for key, value in changed.items():
            if key.endswith(str(number)):
                cells[key.removesuffix(str(number))] = value
        rows.append(TableRow(frame="", cells=cells))
    table = Table(rows=tuple(rows), angles="deg", lengths="mm")
    return Printed(origin="print", angles="deg", lengths="mm", table=table)


def test_where_a_row_is_attached_is_compared():
    assert not [f for f in grade(FINGERS, branching_table()) if f.kind == "table"]
    wrong = branching_table(b2="40", gamma2="", antecedent2="0")
    assert [f.sentence() for f in grade(FINGERS, wrong) if f.place == "row 2"] == [
        "row 2: antecedent is 0, and hand has 1 there; write antecedent = 1",
        "row 2: gamma is missing, and hand has 28.6478898° there; write gamma = 28.6478898°",
        "row 2: b is 40; write 30",
    ]


def test_columns_of_branches_are_read_from_text(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("a(j),σ,γ,b,d,α,r,θ\n0,0,90°,b1,0,0,0,θ1\n", encoding="utf-8")
    (row,) = read_printed(path).table.rows
    assert (row.cells["antecedent"], row.cells["gamma"], row.cells["b"]) == ("0", "90°", "b1")


def test_an_antecedent_that_is_no_number_is_not_understood():
    (finding,) = [f for f in grade(FINGERS, branching_table(antecedent2="i")) if f.kind]
    assert (finding.place, finding.understood) == ("row 2", False)


def test_matrices_of_a_robot_that_branches_are_not_graded():
    matrix = PrintedMatrix(name="T12", entries=RIGHT_T12)
    printed = Printed(origin="print", lengths="mm", matrices=(matrix,))
    with pytest.raises(InvalidValueError, match="row 2 of hand has gamma or b"):
        grade(FINGERS, printed)


@pytest.mark.parametrize("name", ["c1", "s23", "q2", "theta1", "pi", "cos", "a b"])
def test_a_symbol_that_the_notation_takes_is_refused(name):
    matrix = PrintedMatrix(name="T12", entries=RIGHT_T12)
    wrong = Printed(origin="print", lengths="mm", symbols={name: 1.0}, matrices=(matrix,))
    with pytest.raises(InvalidValueError, match="choose another name"):
        grade(LEG_B, wrong)


def test_a_joint_with_a_formula_may_be_meant_by_its_number():
    entries = [["220c1 + 240c12"], ["220s1 + 240(s1c2 - s1s2)"], ["452.4 - q4"]]
    matrix = PrintedMatrix(name="P04", entries=tuple(map(tuple, entries)))
    printed = Printed(
        origin="print", lengths="mm", joints={"lift": "452.4-340-R"}, matrices=(matrix,)
    )
    (finding,) = grade(SCARA, printed)
    assert finding.place == "P04 (2, 1)"


def test_a_joint_that_is_not_the_robots_is_refused():
    matrix = PrintedMatrix(name="T12", entries=RIGHT_T12)
    wrong = Printed(origin="print", lengths="mm", joints={"lift": "R"}, matrices=(matrix,))
    with pytest.raises(InvalidValueError, match="has no joint 'lift'; it has hip, knee, ankle"):
        grade(LEG_B, wrong)


@pytest.mark.parametrize(
    "part",
    [
        {"joints": {"hip": "q1 +"}},
        {"where": {"sigma1": "2 +"}},
    ],
    ids=str,
)
def test_a_definition_that_is_no_formula_is_refused_with_the_files_name(part):
    right = {"matrices": (PrintedMatrix(name="T12", entries=RIGHT_T12),)}
    with pytest.raises(InvalidValueError, match=r"^print: (joints|where): .* is not a formula"):
        grade(LEG_B, Printed(origin="print", lengths="mm", **{**right, **part}))


def test_a_matrixs_own_definition_that_is_no_formula_is_not_understood():
    (finding,) = grade(LEG_B, leg_print("T12", RIGHT_T12, where={"sigma1": "2 +"}))
    assert not finding.understood
    assert "is not a formula" in finding.fault


def test_craigs_t06_typed_with_one_wrong_sign_is_found_out():
    arm = load_robot(HERE / "robots" / "puma560_modified.toml")
    (finding,) = grade(arm, read_printed(HERE / "printed" / "craig_puma560.csv"))
    assert finding.place == "T06 (3, 4)"
    assert "+ d4 * c23 should be - d4 * c23" in finding.fault


def test_an_angle_may_be_measured_from_elsewhere():
    entries = (("s2", "c2", "0", "50"), ("0", "0", "-1", "0"), ("-c2", "s2", "0", "0"), BOTTOM)
    matrix = PrintedMatrix(name="T12", entries=entries)
    shifted = Printed(origin="print", lengths="mm", joints={"knee": "q2 - 90°"}, matrices=(matrix,))
    assert not grade(LEG_B, shifted)


def test_a_long_chain_is_graded_with_numbers():
    arm = load_robot(HERE / "robots" / "rx90.toml")
    entries = (("c1", "-s1", "0", "0"), ("-s1", "c1", "0", "0"), ("0", "0", "1", "0"), BOTTOM)
    said, rotation = leg_sentences("T01", entries, robot=arm)
    assert said.startswith(
        "T01 (2, 1): printed -s1, in which the minus sign in front should not be there"
    )
    assert "at q1 = " in said
    assert "it should be " in said
    assert "not a rotation" in rotation


def test_of_a_longer_chain_what_is_right_is_said_in_numbers(monkeypatch):
    monkeypatch.setattr("drake_leg.lab.grader.grade.LARGEST_SYMBOLIC", 2)
    (said, _) = leg_sentences("T12", (("-c2", "-s2", "0", "50"), *RIGHT_T12[1:]))
    assert "it should be 0." in said or "it should be -0." in said


def table_of(*rows):
    columns = ("sigma", "d", "alpha", "r", "theta")
    return Table(
        rows=tuple(
            TableRow(frame="", cells=dict(zip(columns, row.split("|"), strict=True)))
            for row in rows
        ),
        angles="deg", lengths="mm",
    )  # fmt: skip


LEG_ROWS = ("0|0|0|0|θ1", "0|50|90|0|θ2", "0|100|0|0|θ3", "~|100|0|0|0")


def graded_table(*rows):
    printed = Printed(origin="print", angles="deg", lengths="mm", table=table_of(*rows))
    return [finding.sentence() for finding in grade(LEG_B, printed)]


def test_a_right_table_has_no_finding():
    assert not graded_table(*LEG_ROWS)
    assert not graded_table(*LEG_ROWS[:1], "0|50|-270|0|θ2", *LEG_ROWS[2:])


@pytest.mark.parametrize(
    ("number", "row", "said"),
    [
        (2, "0|50|-90|0|θ2", "row 2: alpha is -90; write 90°"),
        (2, "0|60|90|0|θ2", "row 2: d is 60; write 50"),
        (
            2,
            "0|L1|90|0|θ2",
            "row 2 (not understood): d is L1: l1 has no value; write 50, or say its value under "
            "[symbols]",
        ),
        (2, "0|50|90|0|θ2 + 90°", "row 2: theta is θ2 + 90°; write θ2"),
        (4, "0|100|0|0|θ4", "row 4: sigma is 0, and leg_b is fixed there; write sigma = ~"),
    ],
)
def test_a_cell_that_is_not_the_robots_is_named(number, row, said):
    rows = list(LEG_ROWS)
    rows[number - 1] = row
    assert said in graded_table(*rows)


def test_a_table_of_another_length_is_named():
    assert "table: it has 3 rows, and leg_b has 4" in graded_table(*LEG_ROWS[:3])[0]


def explained(wrong, right):
    q = {f"q{i}": np.linspace(0.1 * i, 1.7 * i, 7) for i in (1, 2, 3)}
    expected = evaluate(parse_formula(right), q)
    found = explain(
        parse_formula(wrong),
        Vocabulary(angles=3),
        lambda tree: np.allclose(evaluate(tree, q), expected, atol=1e-9),
        trials=iter(range(1000)),
    )
    return found and found.fault


@pytest.mark.parametrize(
    ("wrong", "right", "said"),
    [
        ("cos(q1 - q2)", "cos(q1 + q2)", "q1 - q2 should be q1 + q2"),
        ("-cos(q1)", "cos(q1)", "the minus sign in front should not be there"),
        ("cos(q1)", "-cos(q1)", "a minus sign in front is missing"),
        ("sin(q1)", "cos(q1)", "sin(q1) should be cos(q1)"),
        ("cos(q3)", "cos(q1)", "q3 should be q1"),
        ("2 c1 + 1", "2 c1", "+ 1 should not be there"),
        ("2 c1 - 3 s2", "2 c1 + 3 s2", "- 3 * sin(q2) should be + 3 * sin(q2)"),
        (
            "sin(q1 - q2)",
            "-sin(q1 + q2)",
            "q1 - q2 should be q1 + q2, and a minus sign in front is",
        ),
        ("2", "3", None),
        ("5 c1", "7 s2 + 1", None),
        ("+".join(["c1 s2"] * 12), "0", None),
    ],
)
def test_the_fewest_changes_that_make_an_entry_right_are_told(wrong, right, said):
    found = explained(wrong, right)
    assert found is None if said is None else found.startswith(said)


def test_a_rotation_is_none_where_columns_are_short_skew_or_mirrored():
    eye = np.eye(3)
    assert rotation_fault(eye[np.newaxis], 1e-9) is None
    assert "column 1 is not of length 1" in rotation_fault(np.diag([2.0, 1, 1])[np.newaxis], 1e-9)
    skew = np.array([[[1.0, 0.6, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 1.0]]])
    assert rotation_fault(skew, 1e-9) == "columns 1 and 2 are not at right angles"
    assert "mirror" in rotation_fault(np.diag([-1.0, 1, 1])[np.newaxis], 1e-9)


def test_t21_is_the_inverse_of_t12():
    inverse = (
        ("c2", "0", "s2", "-50c2"),
        ("-s2", "0", "c2", "50s2"),
        ("0", "-1", "0", "0"),
        BOTTOM,
    )
    assert not leg_sentences("T21", inverse)
    assert not leg_sentences("{}^2T_1", inverse)
    said = leg_sentences("T21", RIGHT_T12)
    assert said == ["T21: it is the inverse, T12; write T21, from frame 1 to frame 2"]


def test_parts_of_a_transform_are_graded():
    assert not leg_sentences("R12", [row[:3] for row in RIGHT_T12[:3]])
    assert not leg_sentences("T12", RIGHT_T12[:3])
    for position in ([["50"], ["0"], ["0"]], [["50"], ["0"], ["0"], ["1"]], [["50", "0", "0"]]):
        assert not leg_sentences("P12", position)
    (said,) = leg_sentences("P12", [["50", "1", "0"]])
    assert said == "P12 (1, 2): printed 1; it should be 0"


def test_decimals_are_right_within_their_digits():
    for sine in ("0.0000", "6.1e-17", "cos(1.5708)", "cos(1.5707963)", "0.5 - 0.500"):
        assert not leg_sentences("P12", [["50.0"], [sine], ["0"]])
    for length in ("50.1", "49.96", "50.06", "49", "cos(1.56) 50"):
        assert len(leg_sentences("P12", [[length], ["0"], ["0"]])) == 1


def test_rounded_entries_make_a_rotation():
    rows = (("0.7071", "-0.7071", "0"), ("0.7071", "0.7071", "0"), ("0", "0", "1"))
    zero = "d = 0\nalpha = 0\nr = 0\n"
    text = (
        f'name = "bent"\nangles = "deg"\n[[row]]\nsigma = 0\n{zero}theta = 0\n'
        f'[[row]]\nsigma = "~"\n{zero}theta = 45\n'
    )
    assert not leg_sentences("R12", rows, robot=read_robot(text, "bent.toml"))
