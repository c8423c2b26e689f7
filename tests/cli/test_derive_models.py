"""``drake-leg derive --model``."""

from pathlib import Path

import pytest

from drake_leg.cli import main
from drake_leg.symbolic.models import MODELS

RX90 = str(Path(__file__).parents[2] / "examples" / "symoro" / "rx90.par")
FINGERS = str(Path(__file__).parents[2] / "examples" / "symoro" / "two-fingers.par")


def derived(capsys, *words):
    assert main(["derive", *words]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out


def refused(capsys, *words):
    assert main(["derive", *words]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    return printed.err


@pytest.mark.parametrize("model", MODELS)
def test_every_model_is_printed_with_its_counts(capsys, model):
    out = (
        derived(capsys, "pendulum", "--model", model)
        if model != "determinant"
        else derived(capsys, "leg-b", "--model", model)
    )
    assert f", {model} derived from its table" in out
    assert "multiplications" in out
    assert "with every name written out: " in out


@pytest.mark.slow
def test_base_parameters_are_in_the_letters_of_the_file(capsys):
    out = derived(capsys, RX90, "--model", "base-parameters").splitlines()
    assert "XXR3 = M4*RL4**2 + M5*RL4**2 + M6*RL4**2 + 2*MZ4*RL4 + XX3 - YY3 + YY4" in out
    assert out[-1].startswith("without effect: XX1, XY1")
    out = derived(capsys, "pendulum", "--model", "base-parameters", "--latex")
    assert "ZZR_{1} = IA_{1} + ZZ_{1}" in out.splitlines()


def test_a_zero_of_a_file_stays_zero_unless_all_parameters_are_named(capsys, tmp_path):
    file = tmp_path / "arm.par"
    file.write_text(
        "sigma = {0}\nalpha = {0}\nd = {0}\ntheta = {th1}\nr = {0}\nZZ = {ZZ1}\nXX = {0}\n"
        "XY = {0}\nXZ = {0}\nYY = {0}\nYZ = {0}\nMX = {0}\nMY = {0}\nMZ = {0}\nM = {M1}\n"
    )
    given = derived(capsys, str(file), "--model", "base-parameters")
    assert "ZZ1" in given
    assert "IA1" not in given
    every = derived(capsys, str(file), "--model", "base-parameters", "--all-parameters")
    assert "ZZR1 = IA1 + ZZ1" in every


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ("base-parameters", "all dynamic parameters of arm are 0"),
        ("identification", "all dynamic parameters of arm are 0"),
        ("direct", "the joint of row 1 of arm moves no mass"),
    ],
)
def test_a_table_without_mass_is_refused(capsys, tmp_path, model, said):
    zeros = "".join(
        f"{key} = {{0}}\n" for key in ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M"]
    )
    file = tmp_path / "arm.par"
    file.write_text(f"sigma = {{0}}\nalpha = {{0}}\nd = {{0}}\ntheta = {{th1}}\nr = {{0}}\n{zeros}")
    assert said in refused(capsys, str(file), "--model", model)


def test_code_is_printed_alone(capsys):
    out = derived(capsys, "leg-b", "--model", "gravity", "--code", "numpy")
    names = {}
    exec(out, names)
    assert names["gravity"]([0.0, 0.0, 0.0]).shape == (3,)


@pytest.mark.slow
def test_latex_is_one_equation_a_line(capsys):
    lines = derived(capsys, "leg-b", "--model", "determinant", "--latex").splitlines()
    assert lines[0] == "% Hexabot leg B, determinant derived from its table"
    assert all("=" in line for line in lines if not line.startswith("%"))


def test_a_frame_is_a_number_or_a_link(capsys):
    by_number = derived(capsys, "leg-b", "--model", "jacobian", "--frame", "2", "--in", "1")
    assert "Jacobian of frame 2 in frame 1" in by_number
    by_name = derived(capsys, "leg-b", "--model", "jacobian", "--frame", "femur", "--in", "coxa")
    assert by_name == by_number


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["leg-b", "--model", "dynamic"], "no model 'dynamic': did you mean dynamics?"),
        (["leg-b", "--model", "gravity", "--code", "cobol"], "there are numpy, c, matlab, julia"),
        (["leg-b", "--model", "jacobian", "--frame", "9"], "its frames are 0 to 4"),
        (["leg-b", "--model", "jacobian", "--frame", "thigh"], "has no frame 'thigh'"),
        ([RX90, "--model", "jacobian", "--frame", "hand"], "must be the number of a frame"),
        ([FINGERS, "--model", "jacobian"], "last frames are 3, 5: choose one with --frame"),
        (["pendulum", "--model", "determinant", "--frame", "0"], "no rows that make it square"),
        (["arm.toml", "--model", "gravity"], "arm.toml"),
    ],
)
def test_what_cannot_be_derived_is_said(capsys, words, said):
    err = refused(capsys, *words)
    assert said in err
    assert err.count("\n") == 1


def test_a_model_that_takes_too_long_is_said(capsys):
    assert main(["derive", "leg-b", "--model", "dynamics", "--budget", "1e-9"]) == 3
    assert "dynamics is not derived within 1e-09 s: give it more" in capsys.readouterr().err
