"""Prints as typed: TOML, CSV and text, the sentences about slips in them, and nothing lost."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.findings import errors, not_understood
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import is_print, printed_of_document, read_printed
from drake_leg.lab.grader.printed_text import parse_text
from drake_leg.robot.robots import LEG_A, SCARA

CSV = """\
# a comment
title;A print
angles;deg
lengths;mm
L1;50
sigma1;2 cos(θ1)
joint;lift;452.4-R
caption;T12;Transform of one DOF
T12;cos(θ1);-sin(θ1);0;0
T12;sin(θ1);cos(θ1);0;L1
rows;J;x y yaw
J;1;2

Frame, i;Joint, σ;Dist ; d;Angle ; α;Dist ; r;Angle ; θ
"""

TABLE = "Frame i,σ,d,α,r,θ\n1,0,0,0,0,θ1\n# tool\n2,~,L1,0,0,0\n\nL1,50\n"


def test_csv_has_everything_that_toml_has():
    document = parse_text("\n".join(CSV.splitlines()[:12]), "print.csv")
    assert document == {
        "title": "A print",
        "angles": "deg",
        "lengths": "mm",
        "symbols": {"L1": 50.0},
        "where": {"sigma1": "2 cos(θ1)"},
        "joints": {"lift": "452.4-R"},
        "matrix": [
            {
                "name": "T12",
                "caption": "Transform of one DOF",
                "entries": [["cos(θ1)", "-sin(θ1)", "0", "0"], ["sin(θ1)", "cos(θ1)", "0", "L1"]],
            },
            {"name": "J", "rows": ["x", "y", "yaw"], "entries": [["1", "2"]]},
        ],
    }


def test_a_heading_begins_a_table_and_an_empty_line_ends_it():
    document = parse_text(TABLE, "print.csv")
    assert [row["frame"] for row in document["table"]] == ["1", "2"]
    assert document["table"][1] == {
        "frame": "2", "sigma": "~", "d": "L1", "alpha": "0", "r": "0", "theta": "0"
    }  # fmt: skip
    assert document["symbols"] == {"L1": 50.0}


@pytest.mark.parametrize(
    "heading",
    [
        "Frame Number\tType of joint σ\tDistance along X_{i-1} , d\tAngle Around X_{i-1} , α\t"
        "Distance along Z_{i-1} , r\tAngle around Z, ϑ",
        "Frame, i\tJoint, σ\tDist X_{i-1} ; d\tAngle X_{i-1} ; α\tDist Z ; r\tAngle Z ; θ",
        "i\tsigma\td\talpha\tr\ttheta",
    ],
)
def test_the_reports_own_headings_are_understood(heading):
    document = parse_text(f"{heading}\n1\t0\tL_1\t90°\t0\tθ_1\n", "print.txt")
    assert document["table"] == [
        {"frame": "1", "sigma": "0", "d": "L_1", "alpha": "90°", "r": "0", "theta": "θ_1"}
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("alone", "'alone' is alone on its line"),
        ('T12,"' + "x" * 200_000, "field larger than field limit"),
    ],
)
def test_a_line_that_makes_no_sense_is_named(text, said):
    (place, sentence) = parse_text(text, "print.csv")["unread"][0]
    assert place == "line 1"
    assert said in sentence


def test_a_row_that_does_not_fit_its_heading_is_named():
    with pytest.raises(InvalidValueError, match=r"print\.csv, line 2: the table's row has 2 cells"):
        parse_text("σ,d,α,r,θ\n1,2", "print.csv")


MATRIX = {"name": "T12", "entries": [["1", 0], ["0", 1.5]]}


def test_entries_may_be_text_or_numbers():
    printed = printed_of_document({"lengths": "mm", "matrix": [MATRIX]}, "x.toml")
    assert printed.matrices[0].entries == (("1", "0"), ("0", "1.5"))


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({}, "neither a [[table]] nor a [[matrix]]"),
        ({"matrix": []}, "neither"),
        ({"matrix": MATRIX}, "two brackets"),
        ({"matrix": [1]}, "matrix 1 is 1; it must be a table"),
        ({"matrix": [{"name": "T12"}]}, "matrix 1 (T12): entries is missing"),
        ({"matrix": [{"entries": [["1"]]}]}, "matrix 1: name is missing"),
        ({"matrix": [{**MATRIX, "entries": []}]}, "not a list of rows"),
        (
            {"matrix": [{**MATRIX, "entries": [["1", "2"], []]}]},
            "the row [] is not a list of entries",
        ),
        ({"matrix": [{**MATRIX, "entries": [[True]]}]}, "entry true is neither text"),
        ({"matrix": [{**MATRIX, "rows": 3}]}, "must be a list of text"),
        ({"matrix": [{**MATRIX, "where": {"s": 1}}]}, "where: s is 1; it must be text"),
        ({"matrix": [MATRIX], "lengths": "inch"}, 'lengths is "inch"; it must be "mm"'),
        ({"matrix": [MATRIX], "symbols": {"L1": "50"}}, 'symbols: L1 is "50"'),
        ({"matrix": [MATRIX], "symbols": 3}, "symbols is 3; it must be a table"),
        ({"table": [{"sigma": [0]}]}, "table row 1: sigma is [0]; it must be text or a number"),
        ({"table": [{"sgima": 0}]}, "did you mean 'sigma'?"),
        ({"matrx": [MATRIX]}, "did you mean 'matrix'?"),
    ],
)
def test_a_slip_in_the_file_is_one_sentence(document, said):
    with pytest.raises(InvalidValueError) as raised:
        printed_of_document(document, "print.toml")
    assert str(raised.value).startswith("print.toml")
    assert said in str(raised.value)


def test_a_definition_that_is_no_formula_is_refused(tmp_path):
    path = tmp_path / "print.csv"
    path.write_text("lengths,mm\nsigma1,2 +\nT01,1,0,0,0\n", encoding="utf-8")
    with pytest.raises(InvalidValueError, match="where: '2 \\+' is not a formula"):
        grade(SCARA, read_printed(path))


@given(st.text(alphabet='T12JPLθdαrσ,;\t\n#01=+-*/ "', max_size=80))
def test_any_csv_is_a_print_or_a_sentence(text):
    with contextlib.suppress(InvalidValueError):
        printed_of_document(parse_text(text, "print.csv"), "print.csv")


def test_a_print_is_told_from_a_robot():
    assert is_print({"table": []})
    assert is_print({"matrix": []})
    assert not is_print({"row": [], "table": []})
    assert not is_print({})


LENGTHS = "lengths,mm\nL1,50\nL2,100\nL3,100\n"
T12 = "T12 = [c2 -s2 0 L1; 0 0 1 0; -s2 -c2 0 0; 0 0 0 1]\n"
BAD_T12 = "T12 = [c2 s2 0 L1; 0 0 1 0; s2 -c2 0 0; 0 0 0 1]\n"
ROWS = "[c2 -s2 0 L1; 0 0 1 0; -s2 -c2 0 0; 0 0 0 1]"
MARKDOWN = "| c2 | -s2 | 0 | L1 |\n|---|---|---|---|\n| 0 | 0 | 1 | 0 |\n| -s2 | -c2 | 0 | 0 |\n"
MATLAB = "[c2, -s2, 0, L1]\n[0, 0, 1, 0]\n[-s2, -c2, 0, 0]\n[0, 0, 0, 1]\n"
J = (
    "-s1*(L1+L2*c2+L3*c23) -c1*(L2*s2+L3*s23) -L3*c1*s23; "
    "c1*(L1+L2*c2+L3*c23) -s1*(L2*s2+L3*s23) -L3*s1*s23; 0 -(L2*c2+L3*c23) -L3*c23"
)
P04 = "c1 (L1 + L2 c2 + L3 c23); s1 (L1 + L2 c2 + L3 c23); -L2 s2 - L3 s23"
LEG_TABLE = "i|σ|d|α|r|θ\n1|0|0|0|0|θ1\n2|0|50|-90|0|θ2\n3|0|100|0|0|θ3\n4|~|100|0|0|0\n"


@pytest.fixture
def graded(tmp_path):
    def graded(text):
        path = tmp_path / "print.txt"
        path.write_text(text, encoding="utf-8")
        return grade(LEG_A, read_printed(path))

    return graded


@pytest.mark.parametrize(
    "text",
    [
        T12 + T12,
        f"T12 = T1*T2 = {ROWS}",
        f"T12 =\n\n{MATLAB}",
        f"T12 =\n{MATLAB}T34 =\n[1 0 0 L3]\n[0 1 0 0]\n[0 0 1 0]\n[0 0 0 1]\n",
        f"T12 = \\\n{ROWS}",
        f"**T12** =\n\n{MARKDOWN}| 0 | 0 | 0 | 1 |",
        f"T12:\n{MARKDOWN}| 0 | 0 | 0 | 1 |",
        f"```\nThe transform of frame two:\nT12 = {ROWS} % in mm\n```",
        "\\begin{align}\nT_{12} &= \\begin{bmatrix} c_2 & -s_2 & 0 & L_1 \\\\ 0 & 0 & 1 & 0 \\\\\n"
        "-s_2 & -c_2 & 0 & 0 \\\\ 0 & 0 & 0 & 1 \\end{bmatrix}\n\\end{align}",
        "$$\\det(J) = L_2\\,L_3\\,s_3\\,(L_1 + L_2\\,c_2 + L_3\\,c_{23})$$",
        f"J = [{J.replace('; ', ';' + chr(10) * 2)}]",
        f"J = \\frac{{\\partial f}}{{\\partial q}} = [{J}]",
        f"J(q1,q2,q3) = [{J}]",
        f"J_{{4}} = [{J}]",
        "\n".join("J;" + row.strip().replace(" ", ";") for row in J.split(";")),
        "\n".join("J | " + row.strip().replace(" ", " | ") for row in J.split(";")),
        f"P04 = [{P04}]",
        f"P04 =\n```\n{P04.replace('; ', chr(10))}\n```",
        f"P_4 = [{P04.replace('; ', chr(10))}]",
        f"P04 = ({P04.replace(';', ',')})",
        f"P04 = [{P04.replace(';', ',')}]'",
        "angles,deg\n\n" + LEG_TABLE,
        "angles,deg\n\n" + LEG_TABLE.replace("σ|d|α|r|θ", "σj|dj|αj|rj|θj").replace("|", " | "),
        "singularities: θ3 = kπ or L1 + L2 c2 + L3 c23 = 0",
        "L1 = 50; L2 = L3 = 100;\n" + T12,
        "L1 = 50 mm\nL4 = 20 mm\n" + T12.replace("L1", "50"),
        "σ1 = L1 + L2 c2 + L3 c23\nsingular,θ3 = kπ\nsingular,σ1 = 0",
    ],
)
def test_what_is_right_has_no_finding(graded, text):
    lengths = LENGTHS if "L1 = 50 mm" not in text else "lengths,mm\n"
    assert [finding.sentence() for finding in graded(lengths + text)] == []


@pytest.mark.parametrize(
    "text",
    [
        BAD_T12 + T12,
        T12 + BAD_T12,
        "T12,c2,s2,0,L1\nT12,0,0,1,0\nT12,s2,-c2,0,0\n" + "detJ = L2*L3*s3*(L1+L2*c2+L3*c23)\n"
        "T12,c2,-s2,0,L1\nT12,0,0,1,0\nT12,-s2,-c2,0,0\n",
        "detJ = L2*L3*s3\ndetJ = L2*L3*s3*(L1+L2*c2+L3*c23)",
        T12 + "Singularities,q1 = 0",
        T12 + "singularity = θ1 = 0",
    ],
)
def test_what_is_wrong_is_not_hidden_by_what_is_right(graded, text):
    assert errors(graded(LENGTHS + text))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("Δ = L2*L3*s2", "'Δ' is defined and used nowhere"),
        ("J11 = 0", "'J11' is defined and used nowhere"),
        ("P4 = 0", "'P4' is defined and used nowhere"),
        ("z = L2*s2", "'z' is defined and used nowhere"),
        ("M12 = [1 0; 0 1]", "the matrix 'M12' means nothing here; write one of T12"),
        ("T04 = T01*T12*T23*T34", "write the resulting matrix"),
        ("L2 = 60", "L2 already has another value above; write it once"),
        ("T12,1,2", "T12 is already written above as a whole; write it once"),
        ("J = 100*[1 0; 0 1]", "'100*' is beside the matrix; multiply it in"),
        (r"T34 = \begin{bmatrix} 1 & 0 \\ 0 & 1 \end{bmatrix}^{-1}", "'^{-1}' is beside"),
        ("T23 = [c3 -s3 0 L2; s3 c3 0]", "have 3 or 4 entries"),
        ("T23,c3,-s3,0,L2\nT23,s3,c3", "is not as long as the first one"),
        ("T23 = [c3 -s3 0 L2; s3 c3 0 0", "a bracket is not closed"),
        ("T12 is right", "is alone on its line"),
        ("the leg is never singular", "is alone on its line"),
    ],
)
def test_a_line_that_cannot_be_graded_is_said_beside_the_rest(graded, line, said):
    text = LENGTHS + T12 + "P04 = [s1; c1; 5]\n" + line + "\n"
    findings = graded(text)
    assert {finding.matrix for finding in errors(findings)} == {"P04"}
    (finding,) = not_understood(findings)
    assert said in finding.sentence()


def test_what_cannot_be_read_has_its_line():
    document = parse_text("lengths = mm\n\nnonsense\n", "print.txt")
    assert document["lengths"] == "mm"
    assert [place for place, _ in document["unread"]] == ["line 3"]


def test_rows_are_said_of_all_matrices_of_a_name():
    document = parse_text("J = [1 2]\nJ = [3 4]\nrows,J,x", "print.txt")
    assert [matrix["rows"] for matrix in document["matrix"]] == [["x"], ["x"]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("T12 = [c2 -s2 0 L9; 0 0 1 0; -s2 -c2 0 0]", "formula in a line of its own, as a = 50"),
        (LEG_TABLE.replace("50", "L9"), "say its value in a line of its own, as L1 = 50"),
        ("J = [1 0; 0 1]", "name every row in a line as rows,J,x y z, each one of wx"),
    ],
)
def test_advice_is_what_a_text_says(graded, text, said):
    (finding,) = graded("angles,deg\n" + LENGTHS + "\n" + text)
    assert said in finding.remedy
    assert "[" not in finding.remedy


@pytest.mark.slow
@pytest.mark.parametrize(
    "line", ["a" + " " * 500_000 + "b", "a = " + " " * 500_000 + "b", "x " * 10_000, "[" * 200_000]
)
def test_a_long_line_is_answered(line):
    """Work that grows with the square of the length would take hours."""
    assert isinstance(parse_text(f"{line}\nT12 = {line}\n", "print.txt"), dict)
