import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from chains import PLANAR_2, PUMA, SIX, SLIDER, WHEEL

from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry, branch_angles, foot_position
from drake_leg.robot.robots import LEG_A, LEG_B
from drake_leg.robot.toml.reader import read_robot
from drake_leg.scene.driven_foot import DrivenFoot
from drake_leg.scene.teleop import section_circles, section_triangles, teleop_page, teleop_scene
from drake_leg.scene.views import VIEWS

Q = np.radians([90.0, -50.0, -90.0])
DESK = """
name = "desk"
title = "Desk < arm"
angles = "deg"
row = [
  { sigma = 0, d = 0, alpha = 0, r = 0.1, theta = 0 },
  { sigma = 0, d = 0, alpha = 90, r = 0, theta = 0, limits = { lower = -30, upper = 120 } },
  { sigma = 1, d = 0.25, alpha = 90, r = 0, theta = 0, limits = { lower = 0, upper = 0.1 } },
  { sigma = "~", d = 0.2, alpha = 0, r = 0, theta = 0 },
]
"""


def page_of(robot, q):
    drive = DrivenFoot(robot)
    return teleop_page(drive, teleop_scene(drive, np.asarray(q)), "abc")


def data_of(page):
    return json.loads(re.search(r'id="page-data">(.*?)</script>', page, re.DOTALL)[1])


@pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=lambda robot: robot.name)
def test_every_place_of_the_foot_is_in_every_view(robot, rng):
    scene = teleop_scene(DrivenFoot(robot), Q)
    feet = foot_pose(robot.rows, rng.uniform(-np.pi, np.pi, (3000, 3)))[:, :3, 3]
    for view in VIEWS.values():
        seen, held = feet @ view.axes, scene.hull() @ view.axes
        assert (seen.max(axis=0) <= held.max(axis=0) + 1e-3).all()
        assert (seen.min(axis=0) >= held.min(axis=0) - 1e-3).all()


def test_the_page_of_a_leg_names_its_reach_and_the_guards_numbers():
    page = page_of(LEG_B, Q)
    head = re.search(r"<header.*?</header>", page, re.DOTALL)[0]
    assert "$" not in re.search(r'<header.*?id="page-over"', page, re.DOTALL)[0]
    for words in ("Hexabot leg B", "reach in the leg&#39;s plane", "hip axis", "trace", "50 mm"):
        assert words in head
    assert "slows at 10, stops at 2.5" in page
    data = data_of(page)
    assert (data["session"], data["fastest"], data["paths"][-1]) == ("abc", 100.0, "/drake/region")
    assert (data["slow"], data["stop"]) == (pytest.approx(10.0), pytest.approx(2.5))


@pytest.mark.parametrize(
    ("robot", "q", "movable", "note"),
    [
        (LEG_B, Q, [True] * 3, ""),
        (PLANAR_2, [0.3, 1.0], [True, True, False], "in the plane at right angles to (0, 0, 1)"),
        (SLIDER, [0.1], [False, False, True], "The foot moves along (0, 0, 1) only"),
        (PUMA, SIX, [True] * 3, "It does not turn."),
        (WHEEL, [0.3], [True] * 3, "The foot goes along a curve or a surface"),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_the_page_says_along_what_the_foot_can_be_driven(robot, q, movable, note):
    page = page_of(robot, q)
    assert data_of(page)["movable"] == movable
    said = re.search(r'id="drive-note">(.*?)</p>', page)[1]
    assert note in said
    assert bool(note) == bool(said)


def test_the_page_of_another_robot_shows_no_reach():
    robot = read_robot(DESK, "desk")
    page = page_of(robot, [0.0, 1.0, 0.05])
    assert "<h1>Desk &lt; arm: drive the foot</h1>" in page
    assert "hip axis</span>" not in page
    data = data_of(page)
    assert data["region"] == []
    assert len(data["paths"]) == len(robot.rows)


UNEQUAL = replace(LegGeometry.from_robot(LEG_B), l3=0.06)


def test_the_borders_are_where_the_leg_is_stretched_and_folded():
    q2 = np.linspace(-3.0, 3.0, 50)
    for leg in (LegGeometry.from_robot(LEG_A), UNEQUAL):
        knee = [leg.l1, 0.0, 0.0]
        for circle, q3 in zip(section_circles(leg), (math.pi, 0.0), strict=True):
            feet = foot_position(leg, np.column_stack([0 * q2, q2, 0 * q2 + q3]))
            radii = np.linalg.norm(feet - knee, axis=1)
            np.testing.assert_allclose(np.linalg.norm(circle - knee, axis=1), radii[0], atol=1e-15)
            np.testing.assert_allclose(radii, radii[0], atol=1e-15)


def test_the_foot_reaches_what_is_inside_and_not_what_is_outside():
    inner, outer = section_circles(UNEQUAL)
    knee = np.array([UNEQUAL.l1, 0.0, 0.0])
    reached = lambda points: np.isfinite(branch_angles(UNEQUAL, points)[:, :2]).all(axis=-1)  # noqa: E731
    front = outer[:, 0] > 0.0
    assert reached(0.999 * (outer - knee) + knee)[front].all()
    assert not reached(1.001 * (outer - knee) + knee)[front].any()
    assert not reached(0.99 * (inner - knee) + knee).any()


def test_the_surface_has_the_area_of_the_ring():
    vertices, triangles = section_triangles(UNEQUAL)
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    ring = math.pi * ((UNEQUAL.l2 + UNEQUAL.l3) ** 2 - (UNEQUAL.l2 - UNEQUAL.l3) ** 2)
    assert abs(area / ring - 1.0) < 1e-3
