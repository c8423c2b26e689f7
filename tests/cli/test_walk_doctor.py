"""The doctor of a robot with legs says what a walk will meet."""

import json
from dataclasses import replace

import pytest

from drake_leg.cli import main
from drake_leg.kinematics.walking.foresight import foresee_walk
from drake_leg.kinematics.walking.gait import GAITS, usual_period
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.servos import XL430
from drake_leg.robot.toml.writer import robot_toml


def foreseen(gait, speed, servo):
    walk = walk_of(HEXABOT, GAITS[gait], period=usual_period(GAITS[gait]))
    command = Command(forward=speed, start=walk.earliest_start)
    return foresee_walk(HEXABOT, replace(walk, commands=(command,)), servo)


@pytest.mark.slow
def test_it_prints_the_foresight_as_json(capsys):
    words = ["--gait", "ripple", "--speed", "0.05", "--servo", "xl430", "--json"]
    assert main(["doctor", "hexapod", *words]) == 0
    told = json.loads(capsys.readouterr().out)
    named = {key: told.pop(key) for key in ("gait", "period_s", "speed_m_s")}
    assert named == {"gait": "ripple", "period_s": 1.5, "speed_m_s": 0.05}
    assert told == foreseen("ripple", 0.05, XL430).as_json()


@pytest.mark.slow
def test_it_says_margins_and_the_greatest_values_that_work(capsys):
    assert main(["doctor", "hexabot"]) == 0
    said = capsys.readouterr().out
    for words in (
        "gait: tripod, period 1 s, 0.1 m/s forward",
        "greatest speed: 0.296 m/s, a stride of 0.296 m",
        "static margin: 0.0779",
        "gap between legs",
        "rad/s, limit 6.388",
    ):
        assert words in said


@pytest.mark.slow
def test_a_walk_that_fails_is_said_with_what_works(capsys):
    assert main(["doctor", "phantomx", "--speed", "0.5"]) == 1
    said = capsys.readouterr().out
    assert "it fails: the foot of left_front would be" in said
    assert "instead: a speed of 0.2" in said
    assert "none works at this speed" in said


@pytest.mark.slow
def test_a_speed_that_is_not_given_is_one_that_works(capsys):
    """A wave at the usual 0.1 m/s is out of the legs' reach."""
    assert main(["doctor", "hexapod", "--gait", "wave", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["refusal"] is None
    assert 0.05 < told["speed_m_s"] < 0.1


@pytest.mark.slow
def test_it_takes_a_robot_from_a_file_and_one_of_its_feet(tmp_path, capsys):
    file = tmp_path / "six.toml"
    file.write_text(robot_toml(HEXABOT), encoding="utf-8")
    assert main(["doctor", str(file)]) == 0
    assert "static margin: 0.0779" in capsys.readouterr().out
    assert main(["doctor", str(file), "--tip", "left_front_foot", "--q", "0,-50,-90"]) == 0
    assert "sigma_min" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("hexapod --q 1,2,3", "--q means nothing for hexabot, which walks, unless --tip is given"),
        ("hexapod --speed 0", "--speed is 0: a walk needs another"),
        ("hexapod --gait walk", "there is no gait"),
        ("hexapod --servo strong", "there is no servo"),
    ],
)
def test_what_makes_no_sense_is_refused(words, said, capsys):
    assert main(["doctor", *words.split()]) == 2
    assert said in capsys.readouterr().err
