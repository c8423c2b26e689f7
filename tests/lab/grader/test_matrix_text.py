"""One matrix in every form that people paste, and its names as people write them."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.matrix_text import read_name, rows_of_text
from drake_leg.lab.grader.printed_text import parse_table, parse_text

ROWS = [["cos(q1)", "-sin(q1)", "0"], ["sin(q1)", "cos(q1)", "0"], ["0", "0", "1"]]
FORMS = {
    "bmatrix": r"\begin{bmatrix} cos(q1) & -sin(q1) & 0 \\ sin(q1) & cos(q1) & 0 \\ 0 & 0 & 1 "
    r"\end{bmatrix}",
    "pmatrix": r"\begin{pmatrix}cos(q1)&-sin(q1)&0\\sin(q1)&cos(q1)&0\\0&0&1\end{pmatrix}",
    "array": r"$$\left[\begin{array}{ccc} cos(q1) & -sin(q1) & 0 \\[2pt] sin(q1) & cos(q1) & 0 \\ "
    r"0 & 0 & 1 \\ \hline \end{array}\right]$$",
    "ampersands": r"cos(q1) & -sin(q1) & 0 \\ sin(q1) & cos(q1) & 0 \\ 0 & 0 & 1",
    "lines of ampersands": "cos(q1) & -sin(q1) & 0\nsin(q1) & cos(q1) & 0\n0 & 0 & 1",
    "MATLAB": "[cos(q1) -sin(q1) 0; sin(q1) cos(q1) 0; 0 0 1]",
    "MATLAB with commas": "[cos(q1), -sin(q1), 0; sin(q1), cos(q1), 0; 0, 0, 1];",
    "MATLAB in lines": "[cos(q1) -sin(q1) 0\n sin(q1) cos(q1) 0\n 0 0 1]",
    "MATLAB continued": "[cos(q1) -sin(q1) ...\n 0; sin(q1) cos(q1) 0; 0 0 1]",
    "MATLAB symbolic": "sym([cos(q1), -sin(q1), 0; sin(q1), cos(q1), 0; 0, 0, 1])",
    "SymPy": "Matrix([[cos(q1), -sin(q1), 0], [sin(q1), cos(q1), 0], [0, 0, 1]])",
    "SymPy by module": "sp.Matrix([\n[cos(q1), -sin(q1), 0],\n[sin(q1), cos(q1), 0],\n[0,0,1]])",
    "NumPy": "np.array([[cos(q1), -sin(q1), 0],\n [sin(q1), cos(q1), 0],\n [0, 0, 1],\n])",
    "NumPy as printed": "[[cos(q1) -sin(q1) 0]\n [sin(q1) cos(q1) 0]\n [0 0 1]]",
    "lists": "[[cos(q1), -sin(q1), 0], [sin(q1), cos(q1), 0], [0, 0, 1]]",
    "braces": "{{cos(q1), -sin(q1), 0}, {sin(q1), cos(q1), 0}, {0, 0, 1}}",
    "Markdown": "| cos(q1) | -sin(q1) | 0 |\n|---|---|---|\n"
    "| sin(q1) | cos(q1) | 0 |\n| 0 | 0 | 1 |",
    "columns": "cos(q1)  -sin(q1)  0\nsin(q1)  cos(q1)  0\n0  0  1",
    "spaces": "cos(q1) -sin(q1) 0\nsin(q1) cos(q1) 0\n0 0 1",
    "tabs": "cos(q1)\t-sin(q1)\t0\nsin(q1)\tcos(q1)\t0\n0\t0\t1",
    "commas": "cos(q1), -sin(q1), 0\nsin(q1), cos(q1), 0\n0, 0, 1",
    "SymPy's box": "⎡cos(q1)  -sin(q1)  0⎤\n⎢                    ⎥\n⎢sin(q1)  cos(q1)   0⎥\n"
    "⎢                    ⎥\n⎣   0        0      1⎦",
}


@pytest.mark.parametrize("form", FORMS)
def test_a_matrix_is_read_in_every_form(form):
    assert rows_of_text(FORMS[form]) == ROWS


MATLAB = "[cos(q1) -sin(q1) 0; sin(q1) cos(q1) 0; 0 0 1]"
LATEX = FORMS["bmatrix"]


@pytest.mark.parametrize(
    "text",
    [
        MATLAB + " % from frame 0",
        MATLAB + " # from frame 0",
        MATLAB + " // from frame 0",
        MATLAB + ".",
        MATLAB + " (mm)",
        MATLAB + " [mm]",
        "[cos(q1) -sin(q1) 0; % first row\n sin(q1) cos(q1) 0;\n\n 0 0 1];",
        "[cos(q1) sin(q1) 0; -sin(q1) cos(q1) 0; 0 0 1]'",
        "[cos(q1) sin(q1) 0; -sin(q1) cos(q1) 0; 0 0 1]^T",
        "[cos(q1), -sin(q1), 0]\n[sin(q1), cos(q1), 0]\n[0, 0, 1]",
        FORMS["NumPy"] + "  # from frame 0",
        FORMS["NumPy"].removesuffix(")") + ", dtype=float)",
        "Matrix(3, 3, [cos(q1), -sin(q1), 0, sin(q1), cos(q1), 0, 0, 0, 1])",
        "np.matrix('cos(q1) -sin(q1) 0; sin(q1) cos(q1) 0; 0 0 1')",
        rf"$$\left( {LATEX} \right).$$",
        rf"\[ {LATEX} \] (mm)",
        r"\begin{bmatrix} cos(q1) & sin(q1) & 0 \\ -sin(q1) & cos(q1) & 0 \\ 0 & 0 & 1 "
        r"\end{bmatrix}^{\top}",
    ],
)
def test_what_changes_nothing_may_stand_around_a_matrix(text):
    assert rows_of_text(text) == ROWS


@pytest.mark.parametrize("matrix", [MATLAB, LATEX, FORMS["NumPy"]])
@pytest.mark.parametrize(
    "around", ["-{}", "2*{}", "1/2 {}", r"\frac{1}{2}{}", "{}*2", r"{} \cdot 2", "{}^{-1}", "{}{}"]
)
def test_a_factor_around_a_matrix_is_refused(around, matrix):
    with pytest.raises(InvalidValueError, match="is beside the matrix; multiply it in"):
        rows_of_text(around.replace("{}", matrix))


def test_two_matrices_on_one_line_are_refused():
    with pytest.raises(InvalidValueError, match="write each matrix in a line of its own"):
        rows_of_text("[1 0; 0 1], T23 = [1 0; 0 1]")


def test_of_a_position_every_line_is_one_entry():
    entries = [["c1 (L1 + L2 c2)"], ["s1 (L1 + L2 c2)"], ["L2 s2"]]
    for sign in (";", "\n"):
        assert rows_of_text(f"[{sign.join(row[0] for row in entries)}]", column=True) == entries
    assert rows_of_text("(L1 c1, L1 s1, 0)", column=True) == [["L1 c1", "L1 s1", "0"]]


def test_spaces_part_entries_as_in_matlab():
    assert rows_of_text("[c1*l1 + c2*l2 ; a - b; -c]") == [["c1*l1 + c2*l2"], ["a - b"], ["-c"]]
    assert rows_of_text("[a -b; sin q1 cos (q2)]") == [["a", "-b"], ["sin q1", "cos (q2)"]]
    assert rows_of_text("50\n0\n-1") == [["50"], ["0"], ["-1"]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("a & b \\\\ c", "have 1 or 2 entries; separate the entries by commas"),
        ("1 " * 20_000, "write at most"),
        ("[1 0; 0 1", "a bracket is not closed"),
        ("1 0; 0 1]", "] closes no bracket"),
        (r"\begin{bmatrix} 1 & 0", "a matrix is not closed"),
        ("Matrix(2, 2, [1, 0, 0])", "has 3 entries; write 4"),
        ("np.array(T12)", "is not a list of rows"),
    ],
)
def test_a_matrix_that_is_none_is_refused(text, said):
    with pytest.raises(InvalidValueError) as raised:
        rows_of_text(text)
    assert said in str(raised.value)


@given(st.text(alphabet="[](){};,&|\\ \n\tbegin{matrix}ends01-+*⎡⎤", max_size=120))
def test_any_text_is_a_matrix_or_a_sentence(text):
    with contextlib.suppress(InvalidValueError):
        rows = rows_of_text(text)
        assert len({len(row) for row in rows}) == 1


TABLE_ROW = {"frame": "2", "sigma": "0", "d": "L1", "alpha": "90°", "r": "0", "theta": "θ2"}


@pytest.mark.parametrize(
    "text",
    [
        "| j | σ | d | α | r | θ |\n|---|:-:|---|---|---|---|\n| 2 | 0 | L1 | 90° | 0 | θ2 |",
        "i σ_i d_i α_i r_i θ_i\n2 0 L1 90° 0 θ2",
        "i\tσ_i\td_i\tα_i\tr_i\tθ_i\n2\t0\tL1\t90°\t0\tθ2",
        "Link; sigma; d (mm); alpha [deg]; r (mm); theta\n2; 0; L1; 90°; 0; θ2",
        "j,σⱼ,dⱼ,αⱼ,rⱼ,θⱼ\n2,0,L1,90°,0,θ2",
        r"$j$ | $\sigma_{j}$ | $d_{j}$ | $\alpha_{j-1}$ | $r_{j}$ | $\theta_{j}$"
        "\n2 | 0 | L1 | 90° | 0 | θ2",
        "j|σ_j|α_j|d_j|θ_j|r_j\n2|0|90°|L1|θ2|0",
    ],
)
def test_a_pasted_table_is_read_by_its_heading(text):
    assert parse_table(text, "print.toml") == [TABLE_ROW]


def test_a_table_without_a_heading_is_refused():
    with pytest.raises(InvalidValueError, match="table has no heading; write i"):
        parse_table("T12,1,0,0,0", "print.toml")


def test_a_line_behind_a_table_is_not_lost():
    with pytest.raises(InvalidValueError, match=r"table, line 4: 'nonsense' is alone on its line"):
        parse_table("i σ d α r θ\n2 0 L1 90° 0 θ2\n\nnonsense", "print.toml")


PASTED = r"""
lengths = mm
L1 = 50
T01 = [c1 -s1 0 0
       s1 c1 0 0
       0 0 1 0
       0 0 0 1];
$T_{12} = \begin{bmatrix}
c_2 & -s_2 \\
s_2 & c_2
\end{bmatrix}$
P04 =
c1 L1
s1 L1

T23 = Matrix([[1, 0], [0, 1]])
detJ = 2 s3
sigma1 = 2 c1 + 1
"""


def test_matrices_pasted_into_a_text_are_read():
    document = parse_text(PASTED, "print.txt")
    assert document["lengths"] == "mm"
    assert document["symbols"] == {"L1": 50.0}
    assert document["where"] == {"sigma1": "2 c1 + 1"}
    names = ["T01", "T_{12}", "P04", "T23", "detJ"]
    assert [matrix["name"] for matrix in document["matrix"]] == names
    rows = [rows_of_text(m["entries"]) for m in document["matrix"] if isinstance(m["entries"], str)]
    assert rows[0][1] == ["s1", "c1", "0", "0"]
    assert rows[1] == [["c_2", "-s_2"], ["s_2", "c_2"]]
    assert rows[3] == [["1", "0"], ["0", "1"]]


@pytest.mark.parametrize(
    ("name", "kind", "frames"),
    [
        *((name, "transform", (0, 1)) for name in (
            "T01", "T_{01}", "T_0_1", "T_{0,1}", "T0-1", "0T1", "^0T_1", "{}^{0}T_{1}", "⁰T₁",
            "^{0}_{1}T", "T_0^1", "T_1^0", "T^0_1", "A1", "A_1", "H01", r"\\mathbf{T}_{01} =",
            "$^0T_1$", "t01",
        )),
        ("T10", "transform", (1, 0)),
        ("^1T_0", "transform", (1, 0)),
        ("^{1}_{0}T", "transform", (1, 0)),
        ("A3", "transform", (2, 3)),
        *((name, "rotation", (0, 4)) for name in ("R04", "R_0^4", "^0R_4")),
        *((name, "position", (0, 4)) for name in (
            "P04", "p_04", "p_{04}", "^0p_4", "P_4^0", "P4", "P_4",
        )),
    ],
)  # fmt: skip
def test_frames_are_read(name, kind, frames):
    found = read_name(name.replace(r"\\", "\\"))
    assert (found.kind, found.frames) == (kind, frames)


@pytest.mark.parametrize(
    ("name", "kind", "rows"),
    [
        *((name, "jacobian", ()) for name in (
            "J", "Jacobian", "Jacobian matrix", "J(q)", "J3x3", "J_{3×3}", "^0J", "J =", "J04",
            "{}^0J_4", "J_4", "J_{4}", "0J4", "J(q1,q2,q3)", "J(θ_1, θ_2)",
        )),
        *((name, "jacobian", ("x", "y", "z")) for name in ("Jv", "J_v", "J_{v}", "J_P")),
        *((name, "jacobian", ("wx", "wy", "wz")) for name in ("Jw", "J_ω", r"J_\omega", "J_O")),
        *((name, "determinant", ()) for name in (
            "detJ", "det J", "det(J)", r"\det J", r"\det(J)", "|J|", r"\left|J\right|", "|J(q)|",
            r"\lvert J \rvert", "Determinant", "Det(J) =",
        )),
    ],
)  # fmt: skip
def test_jacobians_and_determinants_are_read(name, kind, rows):
    found = read_name(name)
    assert (found.kind, found.rows) == (kind, rows)


@pytest.mark.parametrize("name", ["", "K", "T", "T1", "T123", "B12", "J_2", r"\foo", "x" * 5000])
def test_another_name_is_no_matrix(name):
    with pytest.raises(InvalidValueError, match="means nothing here; write one of T12"):
        read_name(name)
