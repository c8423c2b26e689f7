import subprocess
import sys

import pytest

from drake_leg.cli import main

WITHOUT_SYMPY = (
    "import sys; sys.modules['sympy'] = None; "
    "from drake_leg.cli import main; sys.exit(main(sys.argv[1:]))"
)


def lines_of(capsys, *words):
    assert main(["derive", *words]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out.splitlines()


LEG = "l₂⋅l₃⋅s₃⋅(c₂⋅l₂ + c₂₃⋅l₃ + l₁)"


@pytest.mark.parametrize(
    ("name", "first", "last", "determinant"),
    [
        pytest.param("leg-a", "A, eq. 1:", "A, eq. 19:", LEG, marks=pytest.mark.slow),
        pytest.param("leg-b", "B, section 2.3:", "B, section 2.5.2:", f"-{LEG}"),
        pytest.param("scara", "B, section 1.3:", "B, section 1.6:", "l₁⋅l₂⋅s₂"),
    ],
    ids=["leg-a", "leg-b", "scara"],
)
def test_everything_is_printed(capsys, name, first, last, determinant):
    lines = lines_of(capsys, name)
    titles = [line for line in lines if line.startswith("Report")]
    assert titles[0].startswith(f"Report {first}")
    assert titles[-1].startswith(f"Report {last}")
    shown = [line.strip() for line in lines]
    assert "direct - indirect = 0" in shown
    assert f"│J│ = {determinant}" in shown
    assert any(line.endswith(" = π⋅k") for line in shown)
    hip_axis = 0 if name == "scara" else 1
    assert shown.count("c₂⋅l₂ + c₂₃⋅l₃ + l₁ = 0") == hip_axis
    assert sum("2⋅π⋅k + 2⋅atan" in line for line in shown) == 4 * hip_axis
    assert sum(line.endswith(" ≥ 0") for line in shown) == 2 * hip_axis


def test_latex_is_one_equation_a_line_under_a_comment(capsys):
    lines = lines_of(capsys, "scara", "--latex")
    assert lines[0].startswith("% SCARA arm")
    titles, equations = lines[1::2], lines[2::2]
    assert len(titles) == len(equations)
    assert all(title.startswith("% ") for title in titles)
    assert all("=" in equation and not equation.startswith("%") for equation in equations)
    assert "direct - indirect = 0" in equations
    assert all(equation.isascii() for equation in equations)


def test_an_unknown_name_is_refused(capsys):
    assert main(["derive", "leg-c"]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == (
        "drake-leg: there is no derivation 'leg-c'; the derivations are leg-a, leg-b, scara\n"
    )


def test_without_sympy_it_says_how_to_get_it():
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_SYMPY, "derive", "leg-a"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 2
    assert run.stdout == ""
    assert run.stderr == (
        "drake-leg: the derivation of leg-a needs SymPy: pip install 'drake-leg[symbolic]'\n"
    )


def test_all_else_goes_without_sympy():
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_SYMPY, "errata"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0
    assert run.stderr == ""
