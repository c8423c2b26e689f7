"""What the doctor says, in Python and on the command line."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space

from drake_leg.cli import main
from drake_leg.kinematics.euler import euler_rotation
from drake_leg.kinematics.feet import feet
from drake_leg.kinematics.khalil import foot_pose, jacobian
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian, foot_position
from drake_leg.robot.robot import Row
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import LEG_B, PENDULUM, SCARA
from drake_leg.robot.toml.writer import robot_toml
from drake_leg.singularity.doctor import examine_posture
from drake_leg.singularity.rank import examine, examine_whole

ROBOTS = Path(__file__).parents[1] / "lab" / "grader" / "robots"
PUMA, DESK = str(ROBOTS / "puma560_modified.toml"), str(ROBOTS / "desk_arm.toml")

KEYS = {
    "rank",
    "sigma_min_m",
    "manipulability",
    "nearest_family",
    "lost_direction",
    "stroke_forward_m",
    "stroke_backward_m",
    "max_amplitude_m_s",
    "branches_deg",
}


def doctor(capsys, *words):
    assert main(["doctor", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_regular_posture(capsys):
    said = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--direction", "1,0,0")
    assert said.keys() >= KEYS
    assert said["rank"] == 3
    assert said["lost_direction"] is None
    assert said["nearest_family"] == "hip-axis"
    assert said["sigma_min_m"] == pytest.approx(0.0376743, abs=1e-7)
    assert said["max_amplitude_m_s"] == pytest.approx(said["stroke_forward_m"] / 2)
    assert said["branches_deg"] == []


def test_a_singular_posture(capsys):
    said = doctor(capsys, "leg-b", "--q", "90,-50,0")
    assert said["rank"] == 2
    assert said["nearest_family"] == "stretch"
    assert np.linalg.norm(said["lost_direction"]) == pytest.approx(1.0)
    assert said["stroke_forward_m"] is said["max_amplitude_m_s"] is None


def test_all_branches_put_the_foot_there(capsys):
    foot = [0.1, 0.05, -0.1]
    said = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--foot", "0.1,0.05,-0.1")
    assert len(said["branches_deg"]) == 4
    feet = foot_position(LegGeometry.from_robot(LEG_B), np.radians(said["branches_deg"]))
    np.testing.assert_allclose(feet, [foot] * 4, atol=1e-14)


def test_branches_out_of_reach_are_named_as_such(capsys):
    said = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--foot", "0.24,0,0")
    assert len(said["branches"]) == 4
    assert sum(branch["q_deg"] is None for branch in said["branches"]) == 2
    assert len(said["branches_deg"]) == 2


def test_the_frequency_scales_the_amplitude(capsys):
    slow = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--frequency", "0.5")
    fast = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--frequency", "2")
    assert fast["max_amplitude_m_s"] == pytest.approx(4 * slow["max_amplitude_m_s"])


def test_the_scara_is_asked_of_its_horizontal_motion(capsys):
    said = doctor(capsys, "scara", "--q", "30,90,-120", "--foot", "0.2,0.2,0.4")
    assert said["rank"] == 2
    assert said["nearest_family"] == "stretch"
    assert said["foot_m"][2] is None
    assert said["units"] == ["deg", "deg", "deg", "m"]
    assert "branches_deg" not in said
    for branch in said["branches"]:
        assert branch["within_limits"]
        q = [*np.radians(branch["q"][:3]), branch["q"][3]]
        np.testing.assert_allclose(foot_pose(SCARA.rows, q)[:3, 3], [0.2, 0.2, 0.4], atol=1e-14)
        assert sum(branch["q"][:3]) == pytest.approx(0.0, abs=1e-9)


def test_text_says_the_same(capsys):
    assert main(["doctor", "leg-b", "--q", "0,90,30"]) == 0
    text = capsys.readouterr().out
    assert "rank            2 of 3" in text
    assert "lost direction  (0, 1, 0)" in text
    assert "singular already" in text


def test_any_chain_has_a_rank():
    diagnosis = examine_posture(PENDULUM, [0.3])
    assert (diagnosis.rank.rank, diagnosis.nearness) == (1, ())


def test_a_scaras_lift_has_a_reach():
    low, high = (
        examine_posture(SCARA, [0.5, 1.0, 0.0], foot=[0.2, 0.2, height]) for height in (0.1, 0.4)
    )
    assert [solution.within_limits for solution in low.solutions] == [False, False]
    assert "0.34 ... 0.4524 m high" in low.feet.heading
    assert [solution.within_limits for solution in high.solutions] == [True, True]


def test_an_unknown_height_says_how_to_give_it():
    (_, foot), *_ = examine_posture(SCARA, [0.5, 1.0, 0.0]).entries
    assert foot.endswith("z unknown: give the lift as a fourth number) m")


def test_a_scaras_yaw_is_told_or_the_postures(capsys):
    assert main(["doctor", "scara", "--foot", "0.2,0.2,0.4", "--yaw", "15"]) == 0
    text = capsys.readouterr().out
    assert "at yaw 15 deg, as asked for" in text
    assert "0.052400 m" in text
    assert main(["doctor", "scara", "--foot", "0.2,0.2,0.4", "--q", "30,90,-100"]) == 0
    assert "at yaw 20 deg, that of the posture" in capsys.readouterr().out


@pytest.mark.slow
def test_where_the_foot_is_comes_first(capsys):
    assert main(["doctor", "leg-b", "--q", "0,0,0"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(
        "foot            (0.25, 0, 0) m\n"
        "orientation     roll 90, pitch 0, yaw 0 deg, about the base's x, y, z\n"
    )
    said = doctor(capsys, PUMA, "--q", "10,20,30,40,50,60")
    robot = load_robot(Path(PUMA))
    X_BF = foot_pose(robot.rows, np.radians([10, 20, 30, 40, 50, 60]))
    np.testing.assert_allclose(said["foot_m"], X_BF[:3, 3], atol=1e-14)
    roll, pitch, yaw = np.radians(said["foot_rpy_deg"])
    np.testing.assert_allclose(euler_rotation("ZYX", [yaw, pitch, roll]), X_BF[:3, :3], atol=1e-14)


def test_a_wrist_singularity_is_one_of_the_whole_jacobian(capsys):
    assert main(["doctor", PUMA, "--q", "0,0,0,0,0,0"]) == 0
    text = capsys.readouterr().out
    assert "rank            3 of 3 of the foot's translation\n" in text
    assert "                5 of 6 of the whole Jacobian\n" in text
    assert "lost twist      held in place, the foot cannot turn about (1, 0, 0)\n" in text
    assert "singular already, the foot's orientation held" in text
    whole = doctor(capsys, PUMA, "--q", "0,0,0,0,0,0")["whole_jacobian"]
    assert (whole["rank"], whole["full_rank"]) == (5, 6)
    assert whole["lost_twists"] == [{"turning": [1.0, 0.0, 0.0], "moving": None}]


@pytest.mark.slow
def test_six_joints_heed_direction_and_frequency(capsys):
    posture = [PUMA, "--q", "10,20,30,40,50,60"]
    along_x = doctor(capsys, *posture)
    along_z = doctor(capsys, *posture, "--direction", "0,0,1", "--frequency", "3")
    assert along_z["stroke_holds_orientation"]
    assert along_x["stroke_forward_m"] != along_z["stroke_forward_m"]
    assert along_z["max_amplitude_m_s"] == pytest.approx(1.5 * along_z["stroke_forward_m"])


@pytest.mark.slow
def test_a_redundant_arm_leaves_its_orientation_free(tmp_path, capsys):
    path = tmp_path / "five.toml"
    row = "[[row]]\nsigma = 0\nd = 0.1\nalpha = {}\nr = 0.05\ntheta = 0\n"
    path.write_text(
        'name = "five"\nangles = "deg"\n' + "".join(map(row.format, (0, 50, -70, 40, -80))),
        encoding="utf-8",
    )
    assert main(["doctor", str(path), "--q", "10,20,30,40,50"]) == 0
    text = capsys.readouterr().out
    assert "with the foot's orientation left free" in text
    assert "5 of 5 of the whole Jacobian" in text


def test_a_limit_that_comes_first_ends_the_stroke(capsys):
    robot, q = load_robot(Path(DESK)), np.array([math.radians(10), math.radians(20), 0.05])
    diagnosis = examine_posture(robot, q.tolist())
    assert diagnosis.forward.joint == diagnosis.backward.joint == "slide"
    assert diagnosis.greatest_amplitude == pytest.approx(diagnosis.forward.length / 2)
    goal = foot_pose(robot.rows, q)[:3, 3] + [diagnosis.forward.length, 0.0, 0.0]
    found = feet(robot, goal.tolist()).solutions
    assert any(abs(solution.q[2] - 0.1) < 1e-6 for solution in found)
    assert main(["doctor", DESK, "--q", "10,20,0.05"]) == 0
    assert "m, where joint slide reaches its limit" in capsys.readouterr().out


def test_a_legs_limit_comes_before_its_singularity(tmp_path):
    path = tmp_path / "leg.toml"
    limits = 'joint = "ankle"\nlimits = { lower = -100 } # deg'
    path.write_text(robot_toml(LEG_B).replace('joint = "ankle"', limits), encoding="utf-8")
    forward = examine_posture(load_robot(path), np.radians([90, -50, -90])).forward
    free = examine_posture(LEG_B, np.radians([90, -50, -90]))
    assert free.forward.family == "stretch"
    assert forward.length == free.forward.length
    inwards = examine_posture(
        load_robot(path), np.radians([90, -50, -90]), direction=(0.0, 0.0, 1.0)
    ).forward
    assert inwards.joint == "ankle"


def test_a_posture_outside_its_limits_is_remarked(capsys):
    assert main(["doctor", DESK, "--q", "10,-50,0.05"]) == 0
    text = capsys.readouterr().out
    sentence = "joint shoulder is at -50 deg, outside its limits -20 ... 120 deg"
    assert f"outside limits  {sentence}\n" in text
    assert "stroke forward  none: joint shoulder is at its limit, or outside\n" in text
    assert doctor(capsys, DESK, "--q", "10,-50,0.05")["outside_limits"] == [sentence]


@pytest.mark.slow
def test_a_planar_arm_is_not_called_singular(tmp_path, capsys):
    path = tmp_path / "planar.toml"
    row = "[[row]]\nsigma = 0\nd = 0.1\nalpha = 0\nr = 0\ntheta = 0\n"
    path.write_text('name = "planar"\nangles = "deg"\n' + 3 * row, encoding="utf-8")
    assert main(["doctor", str(path), "--q", "10,50,70"]) == 0
    text = capsys.readouterr().out
    assert "rank            2 of 3, and no posture of this table has more\n" in text
    assert "singular already" not in text
    assert main(["doctor", str(path), "--q", "10,50,70", "--direction", "0,0,1"]) == 0
    assert "none: the foot cannot go straight along it" in capsys.readouterr().out


@pytest.mark.slow
def test_a_foot_that_no_joint_moves_is_told_as_such(tmp_path, capsys):
    path = tmp_path / "spindle.toml"
    row = "[[row]]\nsigma = {}\nd = 0\nalpha = 0\nr = 0.1\ntheta = 0\n"
    table = row.format(0) + row.format('"~"').replace("alpha = 0", "alpha = 90").replace("0.1", "0")
    path.write_text(f'name = "spindle"\nangles = "deg"\n{table}', encoding="utf-8")
    assert main(["doctor", str(path), "--q", "10", "--foot", "0,0,0.1"]) == 0
    text = capsys.readouterr().out
    assert "rank            0 of 1, and no posture of this table has more\n" in text
    assert "4 found of infinitely many: joints can move while the foot stays" in text


@pytest.mark.parametrize(
    ("name", "foot", "count"),
    [("leg-b", "0.1,0.05,-0.1", 4), (DESK, "0.255046439,0.0449715685,0.0756409142", 1)],
)
def test_the_foot_alone_needs_no_posture(capsys, name, foot, count):
    said = doctor(capsys, name, "--foot", foot)
    assert sum(branch["within_limits"] for branch in said["branches"]) == count
    assert "rank" not in said


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["leg-c", "--q", "1,2,3"], "leg-c"),
        (["leg-b", "--q", "1,2"], "2 numbers"),
        (["leg-b", "--q", "1,x,3"], "'x'"),
        (["leg-b", "--q", "1,nan,3"], "nan"),
        (["leg-b", "--q", "90,-50,-90", "--direction", "0,0,0"], "zero"),
        (["leg-b", "--q", "90,-50,-90", "--frequency", "-1"], "-1"),
        (["leg-b", "--q", "90,-50,-90", "--foot", "1,2"], "1,2"),
        (["leg-b"], "give a posture by --q, or a point for the foot by --foot"),
        (["leg-b", "--foot", "1,2,3", "--direction", "1,0,0"], "--direction needs a posture"),
        (["leg-b", "--foot", "1,2,3", "--out", "maps"], "--out needs a posture"),
        (["leg-b", "--q", "90,-50,-90", "--rpy", "1,2,3"], "--rpy goes with --foot"),
        (["leg-b", "--foot", "1,2,3", "--rpy", "1,2,3"], "leave --rpy out"),
        (["leg-b", "--foot", "1,2,3", "--yaw", "1"], "a yaw is for a SCARA's tool"),
        (["scara", "--foot", "0.2,0.2,0.4"], "give --yaw"),
        (["scara", "--foot", "0.2,0.2,0.4", "--rpy", "1,2,3"], "give --yaw instead"),
    ],
)
def test_bad_input_is_one_sentence(capsys, words, said):
    assert main(["doctor", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_a_notebook_shows_what_the_command_prints():
    posture = [math.radians(angle) for angle in (90.0, 0.0, 0.0)]
    found = examine_posture(LEG_B, posture, foot=[0.1, 0.1, 0.0])
    html = found._repr_html_()
    assert html.count("<tr>") == 1 + len(found.entries) + 1 + 4  # the heading and four solutions
    assert "<td>rank</td><td>2 of 3</td>" in html
    assert "<td>lost direction</td><td>(0, 1, 0)</td>" in html
    assert "none: the posture is singular already" in html
    assert "<td>foot behind the hip, q3 negative</td>" in html


LEG = LegGeometry.from_robot(LEG_B)


def report_at(*degrees):
    return examine(foot_jacobian(LEG, np.radians(degrees)))


def test_a_regular_posture_loses_nothing(rng):
    for q in rng.uniform(-3.0, 3.0, (50, 3)):
        report = examine(foot_jacobian(LEG, q))
        assert report.rank == report.full_rank == 3
        assert report.lost_directions.shape == (0, 3)
        assert report.manipulability == pytest.approx(abs(determinant(LEG, q)), rel=1e-9)


def test_the_stretched_leg_loses_the_direction_along_itself():
    report = report_at(90.0, -50.0, 0.0)
    assert report.rank == 2
    along = [0.0, np.cos(np.radians(50.0)), -np.sin(np.radians(50.0))]
    np.testing.assert_allclose(report.lost_directions, [along], atol=1e-12)


def test_the_foot_on_the_hip_axis_loses_the_tangential_direction():
    report = report_at(0.0, 90.0, 30.0)
    assert report.rank == 2
    np.testing.assert_allclose(report.lost_directions, [[0.0, 1.0, 0.0]], atol=1e-12)


def test_where_both_families_meet_two_directions_are_lost():
    report = report_at(0.0, np.degrees(np.arccos(-0.25)), 0.0)
    assert report.rank == 1
    lost = report.lost_directions
    np.testing.assert_allclose(lost @ lost.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(
        lost @ foot_jacobian(LEG, [0.0, np.arccos(-0.25), 0.0]), 0.0, atol=1e-12
    )


def test_a_lost_direction_is_not_moved_in():
    for degrees in ((10.0, 20.0, 0.0), (70.0, -30.0, 180.0), (200.0, 90.0, 30.0)):
        J = foot_jacobian(LEG, np.radians(degrees))
        np.testing.assert_allclose(examine(J).lost_directions @ J, 0.0, atol=1e-12)


def test_a_jacobian_of_zeros_has_rank_zero():
    assert examine(np.zeros((3, 3))).rank == 0


def test_a_wrist_that_is_straight_loses_a_turn():
    rows = load_robot(ROBOTS / "puma560_modified.toml").rows
    whole = examine_whole(rows, np.zeros(6), 1.0)
    assert (whole.rank, whole.full_rank) == (5, 6)
    (lost,) = whole.lost
    np.testing.assert_allclose(lost.turning, [1.0, 0.0, 0.0], atol=1e-12)
    assert lost.moving is None
    regular = examine_whole(rows, np.radians([10, 20, 30, 40, 50, 60]), 1.0)
    assert (regular.rank, regular.lost) == (6, ())


def test_a_lost_twist_is_no_motion_that_the_joints_make(rng):
    rows = load_robot(ROBOTS / "puma560_modified.toml").rows
    for _ in range(10):
        q = rng.uniform(-2.0, 2.0, 6)
        q[4] = 0.0
        (lost,) = examine_whole(rows, q, 1.0).lost
        J = jacobian(rows, q)
        for axis, held, moved in ((lost.turning, 3, 0), (lost.moving, 0, 3)):
            if axis is not None:
                motions = J[moved : moved + 3] @ null_space(J[held : held + 3])
                assert np.abs(axis @ motions).max() < 1e-9


def test_a_table_that_never_has_more_loses_nothing():
    rows = [Row(joint="revolute", d=0.1) for _ in range(5)]
    whole = examine_whole(rows, [0.1, 0.5, 0.7, 0.2, 0.9], 0.5)
    assert (whole.rank, whole.full_rank, whole.lost) == (3, 5, ())


def test_a_stretched_scara_loses_its_direction():
    whole = examine_whole(SCARA.rows, [0.0, 0.0, 0.4, 0.0], 1.0)
    assert (whole.rank, whole.full_rank) == (3, 4)
    (lost,) = whole.lost
    np.testing.assert_allclose(lost.moving, [1.0, 0.0, 0.0], atol=1e-9)
