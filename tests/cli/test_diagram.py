"""``drake-leg diagram``."""

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from slx_writer import ModelBuilder

from drake_leg.cli import main
from drake_leg.robot.linkages import FOUR_BAR
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.toml.writer import robot_toml

MODEL = str(Path(__file__).parents[2] / "notebooks" / "leg.slx")


def draw(path, *words):
    return main(["diagram", *words, "--out", str(path)])


def title_of(path):
    return ET.parse(path).getroot().find("{http://www.w3.org/2000/svg}title").text


def test_a_run_is_drawn_with_its_mechanism(tmp_path, capsys):
    path = tmp_path / "leg.svg"
    assert draw(path, "leg-b") == 0
    assert capsys.readouterr().out == f"wrote {path}\n"
    assert title_of(path) == "Hexabot leg B: signals; Hexabot leg B: mechanism, inside the plant"
    assert "6-DOF Joint" in path.read_text()
    assert "mechanism, inside the plant" in path.read_text()


@pytest.mark.parametrize(
    ("part", "title"),
    [
        ("signals", "SCARA arm: signals"),
        ("mechanism", "SCARA arm: mechanism, inside the plant"),
        ("arm_1", "SCARA arm: the link arm_1"),
    ],
)
def test_a_part_is_drawn(tmp_path, part, title):
    path = tmp_path / "part.svg"
    assert draw(path, "scara", "--part", part) == 0
    assert title_of(path) == title


@pytest.mark.parametrize("part", [(), ("--part", "mechanism"), ("--part", "rocker_bar")])
def test_closed_loops_are_drawn_as_the_tree_that_is_cut(tmp_path, part):
    path, robot = tmp_path / "loop.svg", tmp_path / "four-bar.toml"
    robot.write_text(robot_toml(FOUR_BAR))
    assert draw(path, str(robot), *part) == 0
    where = "the link rocker_bar" if "rocker_bar" in part else "mechanism, inside Closed Loops"
    assert where in title_of(path)
    assert ("the tree, cut at pin" in title_of(path)) == ("rocker_bar" not in part)


@pytest.mark.slow
def test_frames_are_drawn(tmp_path):
    path = tmp_path / "frames.svg"
    assert draw(path, "pendulum-spring", "--part", "frames") == 0
    assert ET.parse(path).getroot().tag.endswith("svg")


def test_options_reach_the_picture(tmp_path):
    path = tmp_path / "leg.svg"
    words = ("--without-scopes", "--without-accelerations", "--background", "white")
    assert draw(path, "leg-b", "--part", "signals", *words) == 0
    text = path.read_text()
    assert "singularity" not in text
    assert "Mux of the derivatives" not in text
    assert "prefers-color-scheme" not in text


def test_a_robot_of_ones_own_is_drawn(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(robot_toml(LEG_B), encoding="utf-8")
    path = tmp_path / "mine.svg"
    assert draw(path, str(file)) == 0
    assert title_of(path).startswith(f"{LEG_B.title}: signals; ")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("leg-c",), "there is no run 'leg-c'"),
        (("leg-b", "--part", "thigh"), "leg_b has no link 'thigh'; its links are coxa, femur"),
        (("leg-b", "--part", "Femur"), "the other parts are signals, mechanism, all, frames"),
        (("leg-b", "--part", "femur", "--without-scopes"), "means nothing to femur: draw leg-b"),
        (("scara", "--part", "frames", "--without-accelerations"), "means nothing to frames"),
        (("leg-b", "--part", "mechanism", "--without-scopes"), "means nothing to mechanism"),
    ],
)
def test_what_there_is_not_is_refused(tmp_path, capsys, words, sentence):
    assert draw(tmp_path / "no.svg", *words) == 2
    assert sentence in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_file_is_replaced_only_on_request(tmp_path, capsys):
    path = tmp_path / "leg.svg"
    path.write_text("mine")
    assert draw(path, "pendulum") == 2
    assert "--overwrite" in capsys.readouterr().err
    assert path.read_text() == "mine"
    assert draw(path, "pendulum", "--overwrite") == 0
    assert path.read_text().startswith("<svg")


def test_another_ending_is_refused(tmp_path, capsys):
    assert draw(tmp_path / "leg.png", "pendulum") == 2
    assert ".svg" in capsys.readouterr().err


def test_a_simulink_model_is_drawn(tmp_path, capsys):
    path = tmp_path / "model.svg"
    assert draw(path, MODEL) == 0
    assert capsys.readouterr().out == f"wrote {path}\n"
    assert title_of(path) == "leg: signals; leg: mechanism"
    assert "leg: mechanism" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("part", ["signals", "mechanism"])
def test_a_part_of_a_simulink_model_is_drawn(tmp_path, part):
    path = tmp_path / "part.svg"
    assert draw(path, MODEL, "--part", part, "--background", "white") == 0
    assert title_of(path) == f"leg: {part}"
    assert "prefers-color-scheme" not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--without-scopes",), "--without-scopes is for runs and means nothing to a Simulink"),
        (("--without-accelerations",), f"draw {MODEL} without it"),
        (("--part", "frames"), f"{MODEL}: there is no part 'frames' of a Simulink model"),
        (("--part", "femur"), "its parts are signals and mechanism"),
    ],
)
def test_what_only_runs_have_is_refused_of_a_model(tmp_path, capsys, words, sentence):
    assert draw(tmp_path / "no.svg", MODEL, *words) == 2
    error = capsys.readouterr().err
    assert sentence in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_model_that_cannot_be_drawn_is_refused_in_a_sentence(tmp_path, capsys):
    empty, none = tmp_path / "empty.slx", tmp_path / "none.slx"
    ModelBuilder().write(empty)
    for file, sentence in ((empty, "has no blocks to draw"), (none, "cannot be read")):
        assert draw(tmp_path / "no.svg", str(file)) == 2
        error = capsys.readouterr().err
        assert sentence in error
        assert str(file) in error
        assert error.count("\n") == 1


def test_help_tells_of_simulink_models(capsys):
    with pytest.raises(SystemExit):
        main(["diagram", "--help"])
    assert "FILE.slx" in capsys.readouterr().out
