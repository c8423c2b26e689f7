import json
import math
from pathlib import Path

import pytest

from drake_leg.cli.entry import main

RX90 = str(Path(__file__).parents[1] / "lab" / "grader" / "robots" / "rx90.toml")


def test_all_postures_of_a_point_in_degrees(capsys):
    assert main(["inverse", "leg-b", "--foot", "0.1,0.05,-0.1"]) == 0
    heading, names, *rows = capsys.readouterr().out.splitlines()
    assert heading == "all 4 postures (Paul's method: three equations of the foot's position)"
    assert names.startswith("hip [deg]")
    assert len(rows) == 4
    assert float(rows[0].split()[0]) == pytest.approx(
        math.degrees(math.atan2(-0.05, -0.1)), abs=1e-4
    )


def test_all_postures_of_a_pose_as_json(capsys):
    assert main(["inverse", RX90, "--q", "10,-30,50,20,40,10", "--json"]) == 0
    fields = json.loads(capsys.readouterr().out)
    assert fields["method"] == "Pieper's method: axes 4, 5 and 6 intersect"
    assert fields["complete"] is True
    assert len(fields["solutions"]) == 8
    assert all(solution["residual"] <= 1e-12 for solution in fields["solutions"])
    assert any(
        solution["q"] == pytest.approx([10, -30, 50, 20, 40, 10])
        for solution in fields["solutions"]
    )


def test_a_pose_by_its_angles_or_by_its_matrix(capsys):
    assert main(["inverse", "scara", "--foot", "0.2,0.2,0.4", "--rpy", "180,0,90", "--json"]) == 0
    by_angles = json.loads(capsys.readouterr().out)
    assert by_angles["method"] == "Paul's method: axes 1, 2 and 3 are parallel"
    matrix = "0,1,0,0.2,1,0,0,0.2,0,0,-1,0.4,0,0,0,1"
    assert main(["inverse", "scara", "--pose", matrix, "--json"]) == 0
    by_matrix = json.loads(capsys.readouterr().out)
    assert len(by_matrix["solutions"]) == 2
    for one, other in zip(by_angles["solutions"], by_matrix["solutions"], strict=True):
        assert one["q"] == pytest.approx(other["q"])


def test_what_is_out_of_reach_is_no_success(capsys):
    assert main(["inverse", "leg-b", "--foot", "0.5,0,0"]) == 1
    assert capsys.readouterr().out.startswith("out of reach, by 0.25 m from the nearest posture")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "nothing says where the foot should be: give one of --foot, --pose and --q"),
        (["--foot", "1,2,3", "--q", "1,2,3"], "--foot and --q says where the foot should be"),
        (["--foot", "1,2"], "it takes 3 numbers, not 2"),
        (["--pose", "1,2"], "it takes 16 numbers, not 2"),
        (["--pose", ",".join(["1"] * 16)], "the goal is no pose"),
        (["--q", "1,2,3", "--rpy", "1,2,3"], "--rpy goes with --foot: leave it out"),
        (["--q", "1,2"], "--q has 2 numbers"),
    ],
)
def test_what_makes_no_goal_is_refused_in_a_sentence(capsys, words, said):
    assert main(["inverse", "leg-b", *words]) == 2
    assert said in capsys.readouterr().err


def test_a_point_for_a_robot_of_more_joints_needs_an_orientation(capsys):
    assert main(["inverse", "scara", "--foot", "0.2,0.2,0.4"]) == 2
    assert "in infinitely many orientations: give one by --rpy" in capsys.readouterr().err
