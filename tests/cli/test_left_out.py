"""What acts in a model and not in its run is refused or told; a library is no model to run."""

import json

import pytest
from mechanism_models import BODIES, pendulum
from slx_writer import write_parts

from drake_leg.cli import main
from drake_leg.pictures.model_page import model_page
from drake_leg.simulink.reader import read_model


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def with_block(kind):
    """A pendulum, at whose rod a block of a kind is."""
    built = pendulum()
    built.solver["StopTime"] = "0.02"
    built.add_library(BODIES + kind, "It")
    built.meet("Rod", "It lconn:1")
    return built


def test_a_run_without_a_pulley_is_refused_unless_it_is_asked_for(here, capsys):
    with_block("Pulley").write(here / "m.slx")
    command = ["run", "m.slx", "--out", "out", "--figures", "none"]
    assert main(command) == 2
    assert "Pulley 'It'" in (said := capsys.readouterr().err)
    assert "give --leave-out" in said
    assert main([*command, "--leave-out"]) == 0
    said = capsys.readouterr().err
    assert said.startswith(
        "drake-leg: the motion is not that of the model, as it is without Pulley"
    )
    assert said.count("not that of the model") == 1
    summary = json.loads((here / "out" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["complete"], summary["left_out"]) == (False, {"Pulley": ["It"]})
    page = model_page(read_model(here / "m.slx"), command="c", summary=summary)
    assert "The motion is not that of the model" in page
    assert "Not understood</dt><dd><a" in page
    assert "<li>Pulley</li>" not in page
    assert "<td>Pulley</td><td>It</td>" in page


def test_a_script_without_a_tire_says_so_at_its_head(here, capsys):
    with_block("Magic Formula Tire Force and Torque").write(here / "m.slx")
    assert main(["port", "m.slx", "--out", "m.py"]) == 0
    assert "without Magic Formula Tire Force and Torque 'It'" in capsys.readouterr().err
    text = (here / "m.py").read_text(encoding="utf-8")
    assert "WARNING: the motion is not that of the model" in text.split('"""')[1]


def test_leaving_nothing_out_is_refused(here, capsys):
    pendulum().write(here / "m.slx")
    assert main(["run", "m.slx", "--out", "out", "--leave-out"]) == 2
    assert "--leave-out is for constraints that are not computed" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "port"])
def test_a_library_that_does_not_run_is_told_as_one(here, capsys, command):
    """In place of what its blocks lack, which the models give that use them."""
    built = pendulum()
    built.set("Rod", BrickDimensions="[0.02 long 0.02]")
    parts = built.parts()
    whole = "simulink/blockdiagram.xml"
    parts[whole] = parts[whole].replace("<Model", "<Library").replace("</Model>", "</Library>")
    parts[whole] = parts[whole].replace("<LibraryInformation", "<ModelInformation")
    parts[whole] = parts[whole].replace("</LibraryInformation>", "</ModelInformation>")
    write_parts(here / "m.slx", parts)
    assert main([command, "m.slx", "--out", "m.py"]) == 2
    assert "m.slx: it is a library, whose blocks are for other models" in capsys.readouterr().err
    assert main([command, "m.slx", "--out", "m.py", "--set", "long=1"]) == 0
    assert "it is a library: its blocks run by themselves" in capsys.readouterr().err
