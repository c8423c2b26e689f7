import math

import numpy as np
import pytest

from drake_leg.robot.robots import LEG_B
from drake_leg.scene.parts import (
    BLUE,
    DASH,
    GREEN,
    RED,
    TRACE_SPACING,
    floor_parts,
    floor_square,
    trace_parts,
    triad_parts,
    triad_tips,
)
from drake_leg.scene.scene import at_rest

Q = [1.5, -0.9, -1.6]
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
    X_WF = at_rest(LEG_B, Q).poses()[0]
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
    parts = floor_parts(points)
    heights = {round(float(part.X_FP[2, 3]), 12) for part in parts}
    assert len(heights) == 1
    assert heights.pop() < -0.14
    along_x = [part for part in parts if "/x" in part.path]
    gaps = np.diff([part.X_FP[1, 3] for part in along_x])
    np.testing.assert_allclose(gaps, 0.05)
    assert along_x[0].X_FP[1, 3] <= 0.0
    assert along_x[-1].X_FP[1, 3] >= 0.25 - 1e-12
