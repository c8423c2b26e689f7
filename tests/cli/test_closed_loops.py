"""Commands of robots with closed loops: doctor, check, sdf, view, run."""

import json
import math
from dataclasses import replace

import pytest

from drake_leg.cli import main
from drake_leg.kinematics.assemblies import closed_near
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget, starting_posture
from drake_leg.robot.linkages import FIVE_BAR, FOUR_BAR, SLIDER_CRANK
from drake_leg.robot.toml.writer import robot_toml


@pytest.mark.slow
def test_the_doctor_says_assemblies_and_dead_centers(capsys):
    assert main(["doctor", "four-bar", "--q", "60"]) == 0
    said = capsys.readouterr().out
    assert "1, cut at pin; 2 independent equations, 5 frames" in said
    assert "negative: crank 60 deg, coupler -33.4722 deg, rocker 97.5622 deg" in said
    assert "dead center of rocker, moving crank: crank 34.7719 deg, coupler 0 deg" in said


@pytest.mark.slow
def test_the_doctor_takes_all_joints_or_the_active_ones(capsys):
    assert main(["doctor", "slider-crank", "--q", "60,-80,0.28", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["q_rad_or_m"][0] == pytest.approx(math.radians(60.0))
    assert found["assembly"] == "1"
    assert main(["doctor", "slider-crank", "--q", "60,-80"]) == 2
    assert "--q has 2 numbers; slider_crank has 3 joint positions" in capsys.readouterr().err


def test_options_of_one_foot_are_refused(capsys):
    assert main(["doctor", "four-bar", "--foot", "0,0,0"]) == 2
    assert "--foot means nothing for a robot with closed loops" in capsys.readouterr().err


@pytest.mark.slow
def test_a_linkage_of_ones_own_is_checked_and_written(tmp_path, capsys):
    file = tmp_path / "linkage.toml"
    file.write_text(robot_toml(FOUR_BAR), encoding="utf-8")
    assert main(["check", str(file)]) == 0
    assert "closure at pin" in capsys.readouterr().out
    assert main(["sdf", str(file)]) == 0
    printed = capsys.readouterr()
    assert "SDF has no joint that closes a loop" in printed.err
    assert "frame_5" in printed.out


def test_too_many_actuated_joints_are_refused(tmp_path, capsys):
    text = robot_toml(SLIDER_CRANK).replace("actuated = false", "actuated = true")
    file = tmp_path / "driven.toml"
    file.write_text(text, encoding="utf-8")
    assert main(["doctor", str(file)]) == 2
    said = capsys.readouterr().err
    assert "has 1 degree of freedom with its loops closed" in said
    assert "3 (crank, rod, slide) are active" in said


def test_a_linkage_of_ones_own_runs(tmp_path, capsys):
    file = tmp_path / "linkage.toml"
    file.write_text(robot_toml(FOUR_BAR), encoding="utf-8")
    given = ["run", str(file), "--swing", "30", "--duration", "0.2", "--figures", "none"]
    assert main([*given, "--out", str(tmp_path / "out")]) == 0
    assert "loops closed to" in capsys.readouterr().out
    assert main([*given, "--out", str(tmp_path / "out"), "--amplitude", "0.1"]) == 2
    assert "has no option --amplitude" in capsys.readouterr().err


@pytest.mark.slow
def test_where_loops_do_not_close_at_the_start_a_closed_posture_is_searched(tmp_path, capsys):
    """Both cranks point outwards, and the rods are too short to meet."""
    targets = {"left": math.pi, "right": 0.0}
    segments = tuple(
        replace(
            one, mechanics=JointMechanics(position_target=StateTarget(value=targets[one.joint]))
        )
        if one.joint in targets
        else one
        for one in FIVE_BAR.segments
    )
    robot = replace(FIVE_BAR, segments=segments)
    loops = ClosedLoops(robot)
    start = starting_posture(robot)
    q, starts, closed = closed_near(loops, start)
    assert loops.gap(q) < 1e-12
    assert closed <= starts == 32
    path = tmp_path / "five.toml"
    path.write_text(robot_toml(robot))
    assert main(["doctor", str(path), "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["q_rad_or_m"] == pytest.approx(q.tolist())
    assert "do not close with left at 180 deg, right at 0 deg, where five_bar starts" in err
    assert f"of 32 starts of Newton's method, with all joints moving, {closed} closed" in err
    assert main(["doctor", str(path), "--q", "180,0"]) == 2
