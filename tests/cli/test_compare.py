"""The command line of compare: exit status, JSON, options of the run."""

import json

import pytest
from slx_models import JACOB_INV, published_leg, published_pendulum

from drake_leg.cli import main


@pytest.fixture
def slx(tmp_path):
    def write(builder):
        return str(builder.write(tmp_path / "model.slx"))

    return write


@pytest.mark.slow
def test_the_published_leg_is_leg_b(slx, capsys):
    assert main(["compare", slx(published_leg()), "leg-b"]) == 0
    said = capsys.readouterr().out
    assert "Every block and wire of the model has its counterpart" in said
    assert "missing" not in said
    assert "Sine Wave (SID" in said


def test_a_difference_is_one_line_with_both_values_and_exit_1(slx, capsys):
    assert main(["compare", slx(published_leg(amplitude="50")), "leg-b"]) == 1
    lines = capsys.readouterr().out.splitlines()
    (line,) = [line for line in lines if "Amplitude is" in line]
    assert line.endswith("Amplitude is 0.05 m/s, in Drake 0.07 m/s")
    assert lines[-1] == "0 missing, 1 different: the diagram differs from the model."


@pytest.mark.slow
def test_another_unit_is_one_line(slx, capsys):
    model = published_leg()
    for block in model.blocks.values():
        for key in ("TranslationCartesianOffset", "BrickDimensions", "SphereRadius"):
            if key in block.parameters:
                block.parameters[key] = f"1000*{block.parameters[key]}"
    assert main(["compare", slx(model), "leg-b"]) == 1
    text = capsys.readouterr().out
    assert "different (1)\n  (model): lengths are 1000 times those of leg-b\n" in text


def test_unreadable_function_is_one_line(slx, capsys):
    script = JACOB_INV.replace("inv(J)", "reciprocal(J)")
    assert main(["compare", slx(published_leg(script=script)), "leg-b"]) == 1
    text = capsys.readouterr().out
    assert "different (1)\n  MATLAB Function (SID " in text
    assert "): could not be read: MATLAB function jacob_inv, line 11: 'reciprocal' is no" in text


@pytest.mark.slow
def test_options_of_the_run(slx):
    model = slx(published_leg(amplitude="50", initial=("pi/2", "-pi/4", "-pi/2")))
    assert main(["compare", model, "leg-b"]) == 1
    options = ["--amplitude", "0.05", "--q0", "90,-45,-90"]
    assert main(["compare", model, "leg-b", *options]) == 0


def test_json_has_the_four_lists(slx, capsys):
    assert main(["compare", slx(published_leg(amplitude="50")), "leg-b", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["agrees"] is False
    assert not found["missing"]
    assert [item["parameter"] for item in found["different"]] == ["Amplitude"]
    assert {item["what"] for item in found["matched"]} == {"block", "wire", "node", "solver"}
    assert found["extra"]


def test_strict(slx, capsys):
    model = slx(published_leg())
    assert main(["compare", model, "leg-b", "--strict"]) == 1
    assert "cross section is (0.001, 0.001) m, in Drake (0.008, 0.005) m" in capsys.readouterr().out


def test_pendulum(slx):
    assert main(["compare", slx(published_pendulum()), "pendulum"]) == 0


def test_the_filter_agrees_once_the_run_has_it(slx):
    model = slx(published_leg())
    assert main(["compare", model, "leg-b", "--filter-time-constant", "0.001"]) == 0


@pytest.fixture
def two(tmp_path):
    def write(first, second):
        builders = zip(("A.slx", "B.slx"), (first, second), strict=True)
        return [str(builder.write(tmp_path / name)) for name, builder in builders]

    return write


def test_two_models_that_are_the_same(two, capsys):
    assert main(["compare", *two(published_leg(), published_leg())]) == 0
    said = capsys.readouterr().out
    assert "Every block and wire of the model has its counterpart, and the values agree." in said
    assert "Drake" not in said


def test_two_models_differ_in_one_line_with_both_values(two, capsys):
    models = two(published_leg(), published_leg(amplitude="50"))
    assert main(["compare", *models]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{models[0]} compared with {models[1]}"
    assert "  Sine Wave (SID 17): Amplitude is 70, in B.slx 50" in lines
    assert lines[-1] == "0 missing, 1 different: B.slx differs from A.slx."
    assert main(["compare", *models, "--json"]) == 1
    (one,) = json.loads(capsys.readouterr().out)["different"]
    assert (one["first"], one["second"]) == (70.0, 50.0)


def test_set_gives_values_to_both_models(two, capsys):
    lengths = [published_leg().set("Brick Solid1", Density=rho) for rho in ("rho", "2*rho")]
    models = two(*lengths)
    assert main(["compare", *models]) == 2
    assert "'rho'" in capsys.readouterr().err
    assert main(["compare", *models, "--set", "rho=1000"]) == 1
    assert "Density is 1000 kg/m^3, in B.slx 2000 kg/m^3" in capsys.readouterr().out


@pytest.mark.slow
def test_values_come_from_the_script_that_a_person_would_run(two, tmp_path, capsys):
    models = two(*(published_leg().set("Brick Solid1", Density=rho) for rho in ("rho", "2*rho")))
    (tmp_path / "setup.m").write_text("rho = 500;\n", encoding="utf-8")
    assert main(["compare", *models]) == 1
    said = capsys.readouterr()
    assert "Density is 500 kg/m^3, in B.slx 1000 kg/m^3" in said.out
    assert "rho taken from" in said.err
    assert main(["compare", models[0], "leg-b"]) == 1
    assert "Density is 500 kg/m^3, in Drake 1000 kg/m^3" in capsys.readouterr().out


@pytest.mark.parametrize("option", [["--amplitude", "0.1"], ["--force"], ["--config", "a.yaml"]])
def test_options_of_runs_mean_nothing_to_two_models(two, capsys, option):
    assert main(["compare", *two(published_leg(), published_leg()), *option]) == 2
    said = f"{option[0]} is for runs and means nothing to two models"
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["nowhere.slx", "leg-b"],
        [__file__, "leg-b"],
        ["{model}", "leg-z"],
        ["{model}", "leg-b", "--amplitude", "much"],
        ["{model}", "pendulum", "--amplitude", "0.1"],
    ],
)
def test_bad_input_is_one_sentence_and_exit_2(slx, capsys, arguments):
    model = slx(published_leg())
    assert main(["compare", *(word.format(model=model) for word in arguments)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("drake-leg: ")
    assert captured.err.count("\n") == 1
