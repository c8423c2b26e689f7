"""Maps of singular postures: the families are where the determinant says, nothing is cut."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.figures import singularities
from drake_leg.figures.of_postures import maps_of_posture
from drake_leg.figures.style import BLUE, ORANGE, for_light_and_dark, save
from drake_leg.kinematics.leg import LegGeometry, determinant
from drake_leg.robots import LEG_A, LEG_B, PENDULUM, SCARA, hexabot_leg

LEG = LegGeometry.from_robot(LEG_B)
START = np.radians([90.0, -50.0, -90.0])
ARM = np.radians([30.0, 90.0, -120.0])


def lines_of(axes, colour):
    return [line for line in axes.lines if line.get_color() == colour]


def test_the_curves_on_the_map_are_where_the_determinant_is_zero():
    axes = singularities.determinant_map(LEG, START, "title").axes[0]
    for line in lines_of(axes, ORANGE):
        knee, ankle = np.radians(line.get_data())
        given = np.isfinite(knee)
        q = np.column_stack([np.zeros(given.sum()), knee[given], ankle[given]])
        np.testing.assert_allclose(determinant(LEG, q), 0.0, atol=1e-12)
    for line in lines_of(axes, BLUE):
        (ankle,) = set(np.radians(line.get_ydata()))
        np.testing.assert_allclose(determinant(LEG, [0.3, 0.7, ankle]), 0.0, atol=1e-12)


def test_a_curve_that_leaves_the_map_leaves_a_gap():
    for line in lines_of(singularities.determinant_map(LEG, START, "title").axes[0], ORANGE):
        steps = np.abs(np.diff(np.column_stack(line.get_data()), axis=0))
        assert np.nanmax(steps) < 30.0


@pytest.mark.parametrize(
    ("robot", "q", "names"),
    [
        (LEG_A, -START, ["determinant", "singular_postures", "singular_feet", "sigma_min"]),
        (hexabot_leg("B", l1=0.3), START, ["determinant", "singular_postures", "singular_feet",
                                           "sigma_min"]),
        (hexabot_leg("B", l3=0.06), START, ["determinant", "singular_postures", "singular_feet",
                                            "sigma_min"]),
        (SCARA, ARM, ["sigma_min"]),
        (SCARA, [*ARM, 0.06], ["sigma_min"]),
    ],
    ids=["leg_a", "short", "unequal", "scara", "scara with its lift"],
)  # fmt: skip
def test_every_map_is_drawn_and_nothing_leaves_the_figure(robot, q, names):
    maps = maps_of_posture(robot, q, stroke=0.1)
    assert list(maps) == names
    for draw in maps.values():
        figure = draw()
        figure.draw_without_rendering()
        page, drawn = figure.bbox, figure.get_tightbbox()
        dots = figure.dpi
        assert drawn.x0 * dots >= page.x0 - 1.0
        assert drawn.y0 * dots >= page.y0 - 1.0
        assert drawn.x1 * dots <= page.x1 + 1.0
        assert drawn.y1 * dots <= page.y1 + 1.0


def test_other_robots_have_none_and_are_told_what_to_do():
    with pytest.raises(InvalidValueError, match=r"'pendulum'.*leave --out away"):
        maps_of_posture(PENDULUM, [0.5])


def test_a_map_is_small_and_has_a_dark_side(tmp_path):
    paths = save(maps_of_posture(LEG_B, START)["singular_postures"](), tmp_path, "map")
    svg = paths["svg"].read_text(encoding="utf-8")
    assert len(svg) < 4e5
    assert "prefers-color-scheme: dark" in for_light_and_dark(svg)
