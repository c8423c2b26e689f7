"""What a matrix is by its name, as people write it."""

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.claims import read_name


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
