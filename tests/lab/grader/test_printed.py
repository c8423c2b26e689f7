"""Prints as typed: TOML and CSV with the same content, and the sentences about slips in them."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import is_print, printed_of_document, read_printed
from drake_leg.lab.grader.text_print import parse_text
from drake_leg.robot.robots import SCARA

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
        ({"matrix": [{**MATRIX, "entries": []}]}, "no list of rows"),
        ({"matrix": [{**MATRIX, "entries": [["1", "2"], []]}]}, "the row [] is no list of entries"),
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
    with pytest.raises(InvalidValueError, match="where: '2 \\+' is no formula"):
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
