import math
from dataclasses import replace

import numpy as np

from drake_leg.kinematics.leg import LegGeometry, branch_angles, foot_position
from drake_leg.robot.robots import LEG_A, LEG_B
from drake_leg.scene.teleop import section_circles, section_triangles

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
