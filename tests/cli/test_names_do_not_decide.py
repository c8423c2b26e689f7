"""What a robot is called decides nothing: each structure under each of the built-in names."""

import json

import numpy as np
import pytest
from chains import PLANAR_3, WHEEL

from drake_leg.cli import main
from drake_leg.pictures.plots.free_body import free_body
from drake_leg.pictures.plots.singularity_maps import maps_of_posture
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.robot.toml.reader import read_robot
from drake_leg.robot.toml.writer import robot_toml

NAMES = ["pendulum", "pendulum3", "leg_a", "leg_b", "scara", "hexabot_leg", "ellipse", "arm"]
STRUCTURES = {
    "leg": (LEG_B, "90,-50,-90"),
    "scara": (SCARA, "30,90,-120,0.05"),
    "planar": (PLANAR_3, "20,60,30"),
}
DRAWN = {"leg": "hip", "scara": "$l_1$", "planar": "drawn at", "pendulum": "$R$"}


def in_turn(structures):
    """Pair every structure with every name; one structure a name, in turn, with the fast tests."""
    for number, name in enumerate(NAMES):
        for place, structure in enumerate(structures):
            marks = () if place == number % len(structures) else pytest.mark.slow
            yield pytest.param(structure, name, id=f"{structure}-{name}", marks=marks)


def named(robot, name):
    """The same robot, called and titled otherwise."""
    text = robot_toml(robot).replace(f'"{robot.name}"', f'"{name}"', 1)
    return text.replace(f'"{robot.title}"', f'"{name}"', 1)


@pytest.fixture
def drawn(monkeypatch):
    """Note the names of figures instead of drawing them."""
    names = []

    monkeypatch.setattr(
        "drake_leg.runs.figures._write", lambda _draw, name, _formats, _folder: names.append(name)
    )
    return names


@pytest.mark.parametrize(("structure", "name"), list(in_turn(STRUCTURES)))
def test_a_run_is_that_of_its_structure(structure, name, drawn, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    robot, q0 = STRUCTURES[structure]
    (tmp_path / f"{name}.toml").write_text(named(robot, name), encoding="utf-8")
    words = ["run", f"{name}.toml", "--out", "out", "--q0", q0, "--duration", "0.2"]
    assert main(words) == 0, capsys.readouterr().err
    assert {"step", "foot_position", "joint_angles", "singularity"} <= set(drawn)
    assert ("foot_rotation" in drawn) == (structure == "leg")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["max_position_error_m"] < 1e-9
    assert summary["task"] == ("position" if structure == "leg" else "pose")


@pytest.mark.parametrize(("structure", "name"), list(in_turn(DRAWN)))
def test_frames_are_those_of_the_structure(structure, name):
    robot = PENDULUM if structure == "pendulum" else STRUCTURES[structure][0]
    figure = free_body(read_robot(named(robot, name), name))
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any(DRAWN[structure] in text for text in texts)


@pytest.mark.parametrize("name", NAMES)
def test_maps_are_those_of_the_structure(name):
    scara = read_robot(named(SCARA, name), name)
    assert list(maps_of_posture(scara, [0.5, 1.0, -1.0])) == ["sigma_min"]
    leg = read_robot(named(LEG_A, name), name)
    assert "determinant" in maps_of_posture(leg, [1.5, 0.8, 1.5])


def test_the_doctor_takes_three_numbers_of_a_scara_whatever_its_name(tmp_path, capsys):
    file = tmp_path / "pendulum.toml"
    file.write_text(named(SCARA, "pendulum"), encoding="utf-8")
    assert main(["doctor", str(file), "--q", "30,90,-120"]) == 0
    told = capsys.readouterr().out
    assert main(["doctor", "scara", "--q", "30,90,-120"]) == 0
    assert capsys.readouterr().out == told


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("leg_a", marks=pytest.mark.slow),
        pytest.param("scara", marks=pytest.mark.slow),
        "pendulum",
    ],
)
def test_a_run_of_a_file_is_replayed_with_its_file(name, drawn, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / f"{name}.toml").write_text(named(PLANAR_3, name), encoding="utf-8")
    words = ["run", f"{name}.toml", "--out", "out", "--q0", "20,60,30", "--duration", "0.2"]
    assert main(words) == 0
    assert main(["replay", "out", "--out", "out.html"]) != 0
    assert f"a robot of your own: give its file with --robot, as in --robot {name}.toml" in (
        capsys.readouterr().err
    )
    assert main(["replay", "out", "--out", "out.html", "--robot", f"{name}.toml"]) == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [*NAMES[:2], *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[2:])]
)
def test_a_wheel_is_no_pendulum_and_says_what_it_cannot_do(name, tmp_path, capsys):
    file = tmp_path / f"{name}.toml"
    file.write_text(named(WHEEL, name), encoding="utf-8")
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "takes its foot along a curve with its 1 joint" in capsys.readouterr().err
    assert main(["diagram", str(file), "--part", "frames", "--out", f"{tmp_path}/f.svg"]) == 0


def test_the_reports_scara_is_compared_in_its_own_task(drake_frames):
    """A file's SCARA keeps height and yaw as the reports' does, and moves as that does."""
    from drake_leg.runs.catalogue import RUNS
    from drake_leg.runs.options import ScaraOptions, StraightOptions
    from drake_leg.runs.step import run as run_robot

    own = RUNS["scara"].run(ScaraOptions(duration=1.0))
    lift = float(own.recording["q4"][0])
    other = read_robot(named(SCARA, "leg_b"), "leg_b")
    same = run_robot(other, StraightOptions(duration=1.0, q0=[30.0, 90.0, -120.0, lift]))
    for column in ("q1", "q2", "q3", "q4", "x", "y", "z"):
        np.testing.assert_allclose(
            np.interp(own.recording["time"], same.recording["time"], same.recording[column]),
            own.recording[column],
            atol=1e-4,
        )
