import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from drake_leg.diagrams import pendulum
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, build
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, PENDULUM_SIZE, ROBOTS, SCARA
from drake_leg.scene.furniture import (
    BLUE,
    DASH,
    GREEN,
    RED,
    TRACE_SPACING,
    floor_corners,
    floor_parts,
    floor_square,
    trace_parts,
    triad_parts,
    triad_tips,
)
from drake_leg.scene.motion import OtherRobotError, PlantMotion, at_rest, motion_of
from drake_leg.scene.showable import shown
from drake_leg.scene.views import VIEWS, as_view, frame
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import Scopes, simulate

TIME = np.array([1.0, 1.5, 3.0])
Q = np.array([[1.5, -0.9, -1.6], [1.6, -0.8, -1.5], [1.1, -0.5, -1.2]])


def recording(robot=LEG_B, **changed):
    motion = PlantMotion(shown=shown(robot), time=TIME, q=Q)
    columns = {"time[s]": TIME, **{f"q{i + 1}[rad]": Q[:, i] for i in range(3)}}
    columns |= {f"{letter}[m]": motion.paths()[0][:, i] for i, letter in enumerate("xyz")}
    return Recording({**columns, **changed})


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_frames_are_where_drake_has_them(robot, rng, drake_frames):
    q = rng.uniform(-1.0, 1.0, len(robot.moving))
    X_WF = at_rest(robot, q).poses()[0]
    assert np.array_equal(X_WF[0], np.eye(4))
    np.testing.assert_allclose(X_WF[1:], drake_frames(robot, q), atol=1e-14)


def test_the_pendulums_tip_is_the_end_of_its_bar():
    ((x, y, z),) = at_rest(PENDULUM, [math.pi / 2]).paths()[0]
    np.testing.assert_allclose([x, y, z], [0.0, 0.0, -PENDULUM_SIZE[0]], atol=1e-15)


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, SCARA], ids=lambda robot: robot.name)
def test_the_tip_of_the_others_is_their_last_frame(robot, rng):
    motion = at_rest(robot, rng.uniform(-1.0, 1.0, len(robot.moving)))
    np.testing.assert_allclose(motion.paths()[0], motion.poses()[:, -1, :3, 3], atol=1e-15)


def test_the_tip_is_a_tool_that_is_farther_out_than_the_links_end():
    bar, centre = PENDULUM.segments
    tool = replace(centre, row=Row(joint="fixed", d=1.5 * PENDULUM_SIZE[0]))
    robot = replace(PENDULUM, segments=(bar, tool))
    np.testing.assert_allclose(at_rest(robot, [0.0]).paths()[0][0, 0], 1.5 * PENDULUM_SIZE[0])


def test_samples_are_equally_apart_from_the_first_row_and_lie_between_the_rows():
    motion = PlantMotion(shown=shown(LEG_B), time=TIME, q=Q).sampled(4.0)
    np.testing.assert_allclose(motion.time, np.arange(1.0, 3.1, 0.25))
    np.testing.assert_allclose(motion.q[1], (Q[0] + Q[1]) / 2.0)
    np.testing.assert_allclose(motion.q[5], Q[1] + (2.25 - 1.5) / 1.5 * (Q[2] - Q[1]))
    assert motion.duration == 2.0


def test_one_row_stays_one_row():
    assert len(at_rest(LEG_B, Q[0]).sampled(30.0).time) == 1


def test_a_recording_gives_its_joint_positions():
    np.testing.assert_array_equal(motion_of(LEG_B, recording()).q, Q)
    swing = Recording({"time[s]": TIME, "q[rad]": Q[:, 0]})
    np.testing.assert_array_equal(motion_of(PENDULUM, swing).q, Q[:, :1])


def test_a_recording_may_have_lists():
    lists = {name: values.tolist() for name, values in recording().columns.items()}
    np.testing.assert_array_equal(motion_of(LEG_B, Recording(lists)).q, Q)
    with pytest.raises(InvalidValueError, match=r"the column q1 is .*; it must be real num"):
        motion_of(LEG_B, recording(**{"q1[rad]": ["a", "b", "c"]}))


def test_a_recording_without_one_joint_is_not_read_as_another():
    columns = {"time": TIME, "q1": Q[:, 0], "q2": Q[:, 1], "q4": Q[:, 2]}
    with pytest.raises(InvalidValueError, match="no column 'q3'; the recording has time, q1, q2"):
        motion_of(LEG_B, Recording(columns))


def test_a_recording_of_another_robot_is_refused():
    with pytest.raises(OtherRobotError, match=r"tip is up to 0\.\d+ m away .*'leg_a'"):
        motion_of(LEG_A, recording())
    with pytest.raises(OtherRobotError, match="positions of 3 joints and 'scara' has 4: pass"):
        motion_of(SCARA, recording())
    with pytest.raises(OtherRobotError, match="positions of 3 joints and 'pendulum' has 1: pass"):
        motion_of(PENDULUM, recording())


@pytest.mark.parametrize(
    ("time", "q", "said"),
    [
        (TIME, Q[:, :2], "one row of 3"),
        (TIME[::-1], Q, "must rise, but row 2 is at 1.5 s, after one at 3 s: sort the rows"),
        (TIME[[0, 1, 1]], Q, "must rise, but row 3 is at 1.5 s, after one at 1.5 s"),
        (np.zeros((3, 1)), Q, r"has an array \(3, 1\) of times"),
        (np.array(1.0), Q, r"has an array \(\) of times"),
        (TIME, Q * np.nan, "not finite"),
        (TIME[:0], Q[:0], "0 times"),
    ],
)
def test_what_is_no_motion_is_refused(time, q, said):
    with pytest.raises(InvalidValueError, match=said):
        PlantMotion(shown=shown(LEG_B), time=time, q=q)


def test_a_simulation_is_a_record_of_its_robot():
    config = HexabotLegConfig()
    done = simulate(build(config), duration=0.1)
    motion = motion_of(LEG_B, done)
    assert np.array_equal(motion.time, done.time)
    assert np.array_equal(motion.q, done.scopes["joint positions"])
    with pytest.raises(OtherRobotError, match=r"tip is up to .*: pass the robot that moved"):
        motion_of(LEG_A, done)
    swing = simulate(pendulum.build(pendulum.PendulumConfig()), duration=0.1)
    assert np.array_equal(motion_of(PENDULUM, swing).q, swing.scopes["q"])
    with pytest.raises(InvalidValueError, match="there is no scope 'joint positions'"):
        motion_of(LEG_B, replace(swing, scopes=Scopes(w=swing.scopes["w"])))


@pytest.mark.parametrize("record", [3, None, "leg", {}, (TIME,), (TIME, Q, Q), np.zeros((3, 3))])
def test_what_is_no_record_is_refused_with_what_is(record):
    with pytest.raises(InvalidValueError, match="is not the record of a motion: give what run"):
        motion_of(LEG_B, record)


@pytest.mark.parametrize("record", [("a", Q), (TIME, [[1.0, 2.0], [3.0]]), (TIME, None)])
def test_times_and_positions_are_numbers(record):
    with pytest.raises(InvalidValueError, match=r"(time|q) is .*must be|joint positions of shape"):
        motion_of(LEG_B, record)


def test_the_result_of_a_run_is_a_record():
    result = SimpleNamespace(recording=recording())
    np.testing.assert_array_equal(motion_of(LEG_B, result).q, Q)


@pytest.mark.parametrize("view", VIEWS.values(), ids=str)
def test_the_axes_of_a_view_are_a_rotation_with_z_up(view):
    R = view.axes
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert R[2, 1] >= 0.0
    assert abs(R[2, 0]) < 1e-15


def test_the_reports_views_look_along_the_axes():
    np.testing.assert_allclose(as_view("right").axes, [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    np.testing.assert_allclose(as_view("top").axes, np.eye(3), atol=2e-4)


@pytest.mark.parametrize("aspect", [0.5, 1.0, 16 / 9])
@pytest.mark.parametrize("view", VIEWS.values(), ids=str)
def test_every_point_is_inside_the_picture(view, aspect, rng):
    points = rng.normal(size=(200, 3)) * [0.1, 0.3, 0.2] + [1.0, -2.0, 0.5]
    framing = frame(view, points)
    seen = (points - framing.camera(aspect)) @ view.axes
    assert (seen[:, 2] < 0.0).all()
    slopes = np.abs(seen[:, :2] / seen[:, 2:]) / math.tan(view.field / 2.0)
    assert slopes[:, 1].max() < 1.0
    assert slopes[:, 0].max() < aspect
    assert max(slopes[:, 1].max(), slopes[:, 0].max() / aspect) > 0.7


@pytest.mark.parametrize("view", ["left", 3, None, ["3d"]])
def test_another_view_is_refused(view):
    with pytest.raises(InvalidValueError, match=r"no view .*; the views are 3d, right"):
        as_view(view)


@pytest.mark.parametrize(
    ("view", "title"),
    [
        ("3d", "Hexabot leg B"),
        ("right", "Hexabot leg B, from the right"),
        ("front", "Hexabot leg B, from the front"),
        ("top", "Hexabot leg B, from the top"),
    ],
)
def test_a_title_says_from_where(view, title):
    assert VIEWS[view].titled("Hexabot leg B") == title


POSTURE = [1.5, -0.9, -1.6]
FRAMES = len(LEG_B.rows) + 1


def ends_of(part):
    """Both ends of a rod, on its frame."""
    half = part.X_FP[:3, 2] * part.shape.length() / 2.0
    return part.X_FP[:3, 3] - half, part.X_FP[:3, 3] + half


def test_every_frame_has_red_green_and_blue_rods_along_x_y_and_z():
    parts = triad_parts(FRAMES, 0.2)
    assert len(parts) == 3 * FRAMES
    for part in parts:
        start, end = ends_of(part)
        axis = "xyz".index(part.path[-1])
        assert part.colour == (RED, GREEN, BLUE)[axis]
        np.testing.assert_allclose(start, 0.0, atol=1e-15)
        np.testing.assert_allclose(end / np.linalg.norm(end), np.eye(3)[axis], atol=1e-15)
        assert np.linalg.det(part.X_FP[:3, :3]) == pytest.approx(1.0)


def test_the_tips_are_where_the_rods_end():
    X_WF = at_rest(LEG_B, POSTURE).poses()[0]
    tips = triad_tips(X_WF, 0.2).reshape(-1, 3)
    for part, tip in zip(triad_parts(FRAMES, 0.2), tips, strict=True):
        X = X_WF[part.frame]
        np.testing.assert_allclose(X[:3, :3] @ ends_of(part)[1] + X[:3, 3], tip, atol=1e-15)


def test_a_trace_follows_its_way():
    angles = np.linspace(0.0, 2.0 * math.pi, 1000)
    circle = np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    pieces = trace_parts([circle], 2.0)
    length = sum(part.shape.length() for part in pieces)
    assert length == pytest.approx(2.0 * math.pi * (DASH - 1) / DASH, rel=0.01)
    middles = np.array([part.X_FP[:3, 3] for part in pieces])
    np.testing.assert_allclose(np.linalg.norm(middles, axis=1), 1.0, atol=1e-3)


def test_an_axis_inside_the_trace_is_seen_in_its_gaps():
    radii = {part.shape.radius() for part in triad_parts(FRAMES, 2.0)}
    way = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 50)
    dashes = trace_parts([way], 2.0)
    assert min(part.shape.radius() for part in dashes) > max(radii)
    starts, ends = np.array([ends_of(part) for part in dashes])[:, :, 0].T
    gaps = starts[1:] - ends[:-1]
    assert gaps.max() == pytest.approx(TRACE_SPACING * 2.0, rel=0.05)
    assert (gaps > 0.5 * TRACE_SPACING).sum() >= 8


def test_a_way_gone_many_times_is_traced_once():
    back_and_forth = np.zeros((4000, 3))
    back_and_forth[:, 0] = np.sin(np.linspace(0.0, 60.0, 4000))
    pieces = trace_parts([back_and_forth], 2.0)
    assert len(pieces) < 2.0 / (0.5 * TRACE_SPACING * 2.0)
    points = np.sort([end[0] for part in pieces for end in ends_of(part)])
    assert points[0] == pytest.approx(-1.0, abs=0.04)
    assert points[-1] == pytest.approx(1.0, abs=0.04)
    assert np.diff(points).max() < 0.04


def test_what_does_not_move_leaves_no_trace():
    assert trace_parts([np.ones((5, 3))], 0.2) == ()


@pytest.mark.parametrize(
    ("size", "square"), [(0.25, 0.05), (0.24, 0.02), (1.0, 0.2), (5.0, 1.0), (0.05, 0.01)]
)
def test_the_floors_squares_are_1_2_or_5(size, square):
    assert floor_square(size) == pytest.approx(square)


def test_the_floor_lies_under_everything():
    points = np.array([[-0.1, 0.0, -0.14], [0.1, 0.25, 0.0]])
    parts = floor_parts(floor_corners(points, 0.05), 0.05, 1e-3)
    heights = {round(float(part.X_FP[2, 3]), 12) for part in parts}
    assert len(heights) == 1
    assert heights.pop() < -0.14
    along_x = [part for part in parts if "/x" in part.path]
    gaps = np.diff([part.X_FP[1, 3] for part in along_x])
    np.testing.assert_allclose(gaps, 0.05)
    assert along_x[0].X_FP[1, 3] <= 0.0
    assert along_x[-1].X_FP[1, 3] >= 0.25 - 1e-12
