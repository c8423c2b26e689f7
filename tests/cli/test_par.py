"""SYMORO's files at the command line: wherever a robot in TOML is taken, and ``sdf --par``."""

import json
from pathlib import Path

import numpy as np
import pytest

from drake_leg.cli import main
from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.catalogue import run_kind

SAMPLES = Path(__file__).parents[2] / "examples" / "symoro"
RX90, LOOP, TREE = (str(SAMPLES / f"{n}.par") for n in ("rx90", "parallelogram-arm", "two-fingers"))
SET = "D3=0.45,RL4=0.45"
STEP = ("--duration", "0.2", "--figures", "none")


@pytest.fixture(autouse=True)
def _there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def leg(capsys):
    """Leg B as a file of SYMORO."""
    assert main(["sdf", "leg-b", "--par", "--out", "leg.par"]) == 0
    capsys.readouterr()
    return "leg.par"


def refused(capsys, *words):
    assert main(list(words)) == 2
    out, err = capsys.readouterr()
    assert not out
    assert err.startswith("drake-leg: ")
    assert err.count("\n") == 1
    return err


ASKING = [["check"], ["sdf"], ["doctor", "--q", "0,0,0,0,0,0"], ["view"]]


@pytest.mark.parametrize("command", ASKING, ids=lambda words: words[0])
def test_letters_without_numbers_are_asked_for_by_name(command, capsys):
    err = refused(capsys, command[0], RX90, *command[1:])
    assert "D3 (d of row 3) and RL4 (r of row 4) have no number" in err
    assert "give numbers, as --set D3=0.1,RL4=0.1" in err


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["D3"], "--set has 'D3' in it; write D3=0.45,RL4=0.45"),
        (["D3=1,,"], "--set has '' in it"),
        (["D3=1", "D3=2"], "--set gives D3 twice"),
        (["d3=1"], "has no letter 'd3': did you mean D3?"),
        (["D3=x"], "--set: D3 is 'x'; it must be a number"),
    ],
)
def test_settings_that_are_none_are_refused(settings, said, capsys):
    given = [word for setting in settings for word in ("--set", setting)]
    assert said in refused(capsys, "check", RX90, *given)


def test_numbers_may_be_arithmetic_with_commas(capsys):
    words = ["sdf", RX90, "--set", "D3=9/20,RL4=0.45*atan2(1, 1)*4/Pi", "--toml"]
    assert main(words) == 0
    assert capsys.readouterr().out.count("0.45") == 2


def test_a_file_is_proved_and_what_is_doubtful_is_said(capsys):
    assert main(["check", RX90, "--set", SET, "--samples", "4", "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["proof"]["holds"]
    assert "links 1 to 6 have no numbers: there the robot has no mass" in err


@pytest.mark.slow
@pytest.mark.parametrize("path", [TREE, LOOP], ids=["tree", "loop"])
def test_trees_and_loops_are_proved(path, capsys):
    lengths = ["--set", "D2=0.2,D3=0.5,D4=-0.1,D8=0.3,RL4=0.6"] if path == LOOP else []
    assert main(["check", path, "--samples", "2", *lengths]) == 0
    assert "proved" in capsys.readouterr().out


def test_gamma_where_no_branch_needs_it_is_allowed_and_said(capsys):
    text = Path(TREE).read_text(encoding="utf-8")
    text = text.replace("gamma = {0,0,0,Pi/3,0}", "gamma = {0,1,0,0,0}")
    Path("x.par").write_text(text.replace("ant = {0,1,2,1,4}", "ant = {0,1,2,3,4}"))
    assert main(["sdf", "x.par"]) == 0
    assert "x.par, line 13: gamma of row 2 is '1', which no branch needs" in capsys.readouterr().err


def test_the_sdf_of_a_file_has_the_masses_and_poses_of_the_robot(leg):
    """Two ways to Drake's mass matrix: of the robot in Python, and of its file."""
    assert main(["sdf", leg, "--out", "leg.sdf"]) == 0
    plants = [build_plant(robot) for robot in (LEG_B, load_robot(leg))]
    found = []
    for plant in plants:
        context = plant.CreateDefaultContext()
        plant.SetPositions(context, [0.3, -0.7, 1.1])
        found.append(
            (
                plant.CalcMassMatrix(context),
                plant.CalcGravityGeneralizedForces(context),
            )
        )
    for first, second in zip(*found, strict=True):
        assert np.abs(first - second).max() <= 1e-14 * np.abs(first).max()


def test_what_a_par_file_does_not_hold_is_said(capsys):
    assert main(["sdf", "leg-b", "--par"]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("(* Robotname = 'leg_b' *)\n")
    assert "a .par file does not hold names of links and joints, shapes of links" in err
    assert main(["sdf", TREE, "--par"]) == 0
    assert not capsys.readouterr().err


def test_a_file_is_written_in_one_format(capsys):
    with pytest.raises(SystemExit):
        main(["sdf", "leg-b", "--par", "--toml"])
    assert "not allowed with argument" in capsys.readouterr().err
    assert ".par" in refused(capsys, "sdf", "leg-b", "--par", "--out", "leg.toml")


@pytest.mark.slow
def test_a_file_is_run_replayed_and_drawn(leg, capsys):
    assert main(["run", leg, "--q0", "90,-50,-90", "--out", "r", *STEP]) == 0
    summary = json.loads(Path("r/summary.json").read_text(encoding="utf-8"))
    assert (summary["run"], summary["robot"]) == (leg, "leg_b")
    capsys.readouterr()
    assert "give its file with --robot" in refused(capsys, "replay", "r", "--out", "r.html")
    assert main(["replay", "r", "--robot", leg, "--out", "r.html"]) == 0
    assert main(["diagram", leg, "--part", "frames", "--out", "f.svg"]) == 0


def test_a_run_of_links_without_mass_asks_for_numbers(capsys):
    assert main(["run", RX90, "--set", SET, "--q0", "0,30,40,0,50,0", "--out", "r"]) == 2
    assert "in a .par file numbers for XX ... M" in capsys.readouterr().err


@pytest.mark.slow
def test_letters_stay_in_the_derivation_until_they_have_numbers(capsys):
    Path("arm.par").write_text(
        "sigma = {0,0,2}\nalpha = {0,Pi/2,0}\nd = {0,0,D3}\ntheta = {th1,th2,0}\nr = {0,0,0}\n"
    )
    assert main(["derive", "arm.par", "--budget", "30"]) == 0
    assert "D₃" in capsys.readouterr().out
    assert main(["derive", "arm.par", "--budget", "30", "--set", "D3=0.45"]) == 0
    out = capsys.readouterr().out
    assert "0.45" in out
    assert "D₃" not in out


@pytest.mark.parametrize("command", ["check", "sdf", "view", "derive", "run", "sweep"])
def test_a_damaged_file_is_refused_in_one_sentence_by_every_command(command, capsys):
    Path("x.par").write_text(Path(TREE).read_text(encoding="utf-8").replace("Pi/3", "Pi/"))
    after = {"run": ["--out", "r"], "sweep": ["--vary", "amplitude=0.01,0.02", "--out", "s"]}
    err = refused(capsys, command, "x.par", *after.get(command, []))
    assert "x.par, line 13: gamma of row 4 is 'Pi/'; it ends with '/'" in err


def test_python_takes_a_file_wherever_it_takes_toml(leg):
    assert run_kind(leg).own.rows == LEG_B.rows
    assert run_kind(Path(leg)).own.name == "leg_b"
    with pytest.raises(InvalidValueError, match=r"give numbers=\{'D3': 0.1, 'RL4': 0.1\}"):
        run_kind(RX90)


@pytest.mark.slow
@pytest.mark.parametrize(
    "path", [pytest.param(TREE, marks=pytest.mark.slow), LOOP], ids=["tree", "loop"]
)
def test_all_branches_are_drawn_with_their_frames(path):
    lengths = ["--set", "D2=0.2,D3=0.5,D4=-0.1,D8=0.3,RL4=0.6"] if path == LOOP else []
    assert main(["diagram", path, *lengths, "--part", "frames", "--out", "f.svg"]) == 0
    assert "joint_5" in Path("f.svg").read_text(encoding="utf-8")


def test_a_loop_whose_branches_all_end_in_it_is_proved_and_has_no_foot(capsys):
    Path("x.par").write_text(
        "NL = 3\nNJ = 4\nant = {0,1,0,3,2}\nsigma = {0,0,0,0,2}\nmu = {1,0,0,0,0}\n"
        "alpha = {0,0,0,0,0}\nd = {0,0.2,0.3,0.2,0.3}\ntheta = {th1,th2,th3,th4,0}\n"
        "r = {0,0,0,0,0}\n"
    )
    assert main(["check", "x.par", "--samples", "2"]) == 0
    assert "foot of frame_5" in capsys.readouterr().out
    assert main(["inverse", "x.par", "--foot", "0.1,0,0"]) == 2
    assert "has closed loops" in capsys.readouterr().err
