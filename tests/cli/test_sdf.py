"""``drake-leg sdf``, in process."""

from pathlib import Path

import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.cli import main
from drake_leg.models.plant import sdf_folder
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import LEG_B

ROBOTS = Path(__file__).parents[1] / "lab" / "grader" / "robots"
ARM = """
name = "arm"
title = "An arm -- of one's own"
angles = "deg"
row = [
  { sigma = 0, d = 0, alpha = 0, r = 0.3, theta = 0, limits = { lower = -90, upper = 90 } },
  { sigma = 0, d = 0.4, alpha = 90, r = 0, theta = 90 },
  { sigma = "~", d = 0.2, alpha = 0, r = 0, theta = 0 },
]
"""


@pytest.fixture
def arm(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.toml").write_text(ARM, encoding="utf-8")
    return "arm.toml"


def refused(capsys, *words):
    """Return the sentence on the standard error of a command that fails."""
    assert main(["sdf", *words]) == 2
    out, err = capsys.readouterr()
    assert not out
    assert err.startswith("drake-leg: ")
    assert err.count("\n") == 1
    return err


@pytest.mark.parametrize(
    ("name", "stem"),
    [("pendulum", "pendulum"), ("leg-a", "leg_a"), ("leg-b", "leg_b"), ("scara", "scara")],
)
def test_the_reports_robots_are_printed_as_they_lie_in_the_folder(name, stem, capsys):
    assert main(["sdf", name]) == 0
    assert capsys.readouterr().out == (sdf_folder() / f"{stem}.sdf").read_text(encoding="utf-8")


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
@pytest.mark.parametrize("name", ["arm", "desk_arm", "rx90", "puma560_classic"])
def test_a_robot_of_ones_own_is_parsed_strictly_and_without_a_warning(
    name, time_step, arm, caplog, capsys
):
    path = arm if name == "arm" else str(ROBOTS / f"{name}.toml")
    assert main(["sdf", path, "--out", "arm.sdf"]) == 0
    plant = MultibodyPlant(time_step)
    parser = Parser(plant)
    parser.SetStrictParsing()
    parser.AddModels("arm.sdf")
    plant.Finalize()
    assert plant.num_positions() == len(load_robot(Path(path)).moving)
    assert not caplog.records


def test_a_file_is_written_with_its_folder(arm, capsys):
    assert main(["sdf", arm, "--out", "deep/arm.sdf"]) == 0
    assert capsys.readouterr() == ("wrote deep/arm.sdf\n", "")
    assert list(Path("deep").iterdir()) == [Path("deep/arm.sdf")]


def test_the_toml_of_a_robot_is_a_beginning_for_ones_own(arm, capsys):
    assert main(["sdf", "leg-b", "--toml", "--out", "leg.toml"]) == 0
    assert load_robot(Path("leg.toml")) == LEG_B
    capsys.readouterr()
    assert main(["sdf", "leg.toml"]) == 0
    own = capsys.readouterr().out
    assert own.replace("Generated from leg.toml.", "Generated from drake_leg.robot.robots.") == (
        (sdf_folder() / "leg_b.sdf").read_text(encoding="utf-8")
    )


@pytest.mark.parametrize(
    ("name", "module"), [("scara", "robots"), ("phantomx", "hexapods"), ("bennett", "linkages")]
)
def test_the_sdf_of_a_named_robot_says_where_it_is_from(name, module, capsys):
    assert main(["sdf", name]) == 0
    assert f"Generated from drake_leg.robot.{module}." in capsys.readouterr().out


def test_a_file_that_is_there_is_not_replaced_unasked(arm, capsys):
    assert main(["sdf", arm, "--out", "arm.sdf"]) == 0
    capsys.readouterr()
    assert "--overwrite" in refused(capsys, "leg-b", "--out", "arm.sdf")
    assert main(["sdf", "leg-b", "--out", "arm.sdf", "--overwrite"]) == 0


def test_the_ending_must_be_what_is_written(arm, capsys):
    assert "does not end in .sdf" in refused(capsys, arm, "--out", "arm.toml")
    assert "does not end in .toml" in refused(capsys, arm, "--toml", "--out", "arm.sdf")


def test_a_length_in_millimetres_is_a_warning_and_no_error(arm, capsys):
    Path(arm).write_text(ARM.replace("d = 0.4", "d = 400"), encoding="utf-8")
    assert main(["sdf", arm]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("<?xml")
    assert err == ("drake-leg: arm.toml: row 2 (a guess): d is 400 m; write 0.4 if it is 400 mm\n")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("leg-c", "there is no robot 'leg-c': did you mean leg-"),
        ("spider", "the robots are pendulum, leg-a, leg-b, scara"),
        ("nowhere.toml", "nowhere.toml cannot be read: No such file"),
    ],
)
def test_what_is_neither_a_robot_nor_a_file_is_refused(name, said, arm, capsys):
    assert said in refused(capsys, name)


def test_a_fault_in_the_file_is_one_sentence_and_nothing_is_written(arm, capsys):
    Path(arm).write_text(ARM.replace("sigma = 0, d = 0.4", "d = 0.4"), encoding="utf-8")
    assert "arm.toml: row 2: sigma is missing" in refused(capsys, arm, "--out", "arm.sdf")
    assert list(Path().iterdir()) == [Path("arm.toml")]
