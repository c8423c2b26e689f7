"""Text prints line by line: nothing that stands in one is lost without a word."""

import time

import pytest

from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import errors, not_understood, read_printed
from drake_leg.lab.grader.text_print import parse_text
from drake_leg.robot.robots import LEG_A

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
TABLE = "i|σ|d|α|r|θ\n1|0|0|0|0|θ1\n2|0|50|-90|0|θ2\n3|0|100|0|0|θ3\n4|~|100|0|0|0\n"


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
        "angles,deg\n\n" + TABLE,
        "angles,deg\n\n" + TABLE.replace("σ|d|α|r|θ", "σj|dj|αj|rj|θj").replace("|", " | "),
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
        (TABLE.replace("50", "L9"), "say its value in a line of its own, as L1 = 50"),
        ("J = [1 0; 0 1]", "name every row in a line as rows,J,x y z, each one of wx"),
    ],
)
def test_advice_is_what_a_text_says(graded, text, said):
    (finding,) = graded("angles,deg\n" + LENGTHS + "\n" + text)
    assert said in finding.remedy
    assert "[" not in finding.remedy


@pytest.mark.parametrize(
    "line", ["a" + " " * 50_000 + "b", "a = " + " " * 9_000 + "b", "x " * 30_000, "[" * 20_000]
)
def test_a_long_line_is_answered_at_once(line):
    begin = time.process_time()
    parse_text(f"{line}\nT12 = {line}\n", "print.txt")
    assert time.process_time() - begin < 1.0
