import subprocess
import sys
from pathlib import Path

import pytest

from drake_leg.cli import main

WITHOUT_SYMPY = (
    "import sys; sys.modules['sympy'] = None; "
    "from drake_leg.cli import main; print([main(words.split()) for words in sys.argv[1:]])"
)


def lines_of(capsys, *words):
    assert main(["derive", *words]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out.splitlines()


LEG = "l₂⋅l₃⋅s₃⋅(c₂⋅l₂ + c₂₃⋅l₃ + l₁)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "first", "last", "determinant"),
    [
        pytest.param("leg-a", "A, eq. 1:", "A, eq. 19:", LEG, marks=pytest.mark.slow),
        pytest.param(
            "leg-b", "B, section 2.3:", "B, section 2.5.2:", f"-{LEG}", marks=pytest.mark.slow
        ),
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


DESK = str(Path(__file__).parents[1] / "lab" / "grader" / "robots" / "desk_arm.toml")


@pytest.mark.slow
def test_a_robot_of_ones_own_is_derived_from_its_table(capsys):
    lines = lines_of(capsys, DESK)
    assert lines[0].endswith("h1 = 0.12 m, l1 = 0.03 m, h2 = 0.05 m, l2 = 0.2 m, h3 = 0.02 m")
    shown = [line.strip() for line in lines]
    assert {f"frame {i} in frame {i - 1}" for i in (1, 2, 3, 4)} <= set(shown)
    assert "frame 4 in the base" in shown
    assert "direct - indirect = 0" in shown
    assert "determinant of the rows v_x, v_y, v_z" in shown
    assert "│J│ = (h₂ + h₃ + q₃)⋅(c₂⋅l₂ + h₂⋅s₂ + h₃⋅s₂ + l₁ + q₃⋅s₂)" in shown
    assert "q₃ = -h₂ - h₃" in shown


def test_latex_of_ones_own_is_one_equation_a_line_under_a_comment(capsys):
    lines = lines_of(capsys, "pendulum", "--latex")
    assert lines[0] == (
        "% Simple pendulum, derived from its table: c1 = cos(q1), s1 = sin(q1), "
        "c23 = cos(q2 + q3) and so on; l1 = 0.2 m"
    )
    assert "direct - indirect = 0" in lines
    assert lines[-2] == "% determinant: none, as no rows of the Jacobian make it square"
    assert all(line.startswith("% ") or "=" in line for line in lines)


def test_what_is_not_derived_in_time_is_said(capsys, monkeypatch, for_ever):
    monkeypatch.setattr("drake_leg.symbolic.derivation.tidy", for_ever)
    assert main(["derive", DESK, "--budget", "5"]) == 3
    printed = capsys.readouterr()
    assert "frame 4 in frame 3" in printed.out
    assert printed.err == (
        "drake-leg: not derived within 5 s: frame 2 in the base; frame 3 in the base; frame 4 in "
        "the base; Jacobian, its rows w_x, w_y, w_z, v_x, v_y, v_z; Jacobian by both methods; "
        "determinant and 1 more: give it more with --budget\n"
    )


def test_a_reports_equations_have_a_budget_too(capsys):
    assert main(["derive", "leg-a", "--budget", "1e-9"]) == 3
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == (
        "drake-leg: the derivation of leg-a is not done within 1e-09 s: give it more with "
        "--budget\n"
    )


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("leg-c", "did you mean leg-b?"),
        ("LEG-B", "did you mean leg-b?"),
        ("leg", "did you mean leg-a or leg-b?"),
        ("pendulm", "did you mean pendulum?"),
        (
            "robot",
            "the robots are pendulum, leg-a, leg-b, scara, hexabot, phantomx, four-bar, "
            "slider-crank, five-bar, bennett, parallelogram-arm; one of your own is a file "
            "ending in .toml or .par",
        ),
    ],
)
def test_an_unknown_name_is_refused(name, advice, capsys):
    assert main(["derive", name]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == f"drake-leg: there is no robot {name!r}: {advice}\n"


@pytest.mark.slow
def test_what_shows_no_formula_does_not_import_sympy(tmp_path):
    posture, run = "doctor leg-b --q 90,-50,-90", "run pendulum --duration 0.1 --out here"
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_SYMPY, "list", posture, run],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines()[-1] == "[0, 0, 0]"
    progress = "at work for"  # printed every ten seconds, on a busy machine
    assert [line for line in done.stderr.splitlines() if progress not in line] == []
