"""Maps of singular postures: the families are where the determinant says, nothing is cut."""

import numpy as np
import pytest

from drake_leg.colours import BLUE, VERMILLION
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian
from drake_leg.pictures.plots import singularity_maps
from drake_leg.pictures.plots.singularity_maps import maps_of_posture
from drake_leg.pictures.plots.style import for_light_and_dark, save
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA, hexabot_leg
from drake_leg.singularity.rank import examine

LEG = LegGeometry.from_robot(LEG_B)
START = np.radians([90.0, -50.0, -90.0])
ARM = np.radians([30.0, 90.0, -120.0])


def lines_of(axes, colour):
    return [line for line in axes.lines if line.get_color() == colour]


def test_the_curves_on_the_map_are_where_the_determinant_is_zero():
    axes = singularity_maps.determinant_map(LEG, START, "title").axes[0]
    assert (len(lines_of(axes, VERMILLION)), len(lines_of(axes, BLUE))) == (4, 3)
    for line in lines_of(axes, VERMILLION):
        knee, ankle = np.radians(line.get_data())
        given = np.isfinite(knee)
        q = np.column_stack([np.zeros(given.sum()), knee[given], ankle[given]])
        np.testing.assert_allclose(determinant(LEG, q), 0.0, atol=1e-12)
    for line in lines_of(axes, BLUE):
        (ankle,) = set(np.radians(line.get_ydata()))
        np.testing.assert_allclose(determinant(LEG, [0.3, 0.7, ankle]), 0.0, atol=1e-12)


def test_a_curve_that_leaves_the_map_leaves_a_gap():
    lines = lines_of(singularity_maps.determinant_map(LEG, START, "title").axes[0], VERMILLION)
    assert lines
    for line in lines:
        steps = np.abs(np.diff(np.column_stack(line.get_data()), axis=0))
        assert np.nanmax(steps) < 30.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "q", "names"),
    [
        pytest.param(LEG_A, -START, ["determinant", "singular_postures", "singular_feet",
                     "sigma_min"], marks=pytest.mark.slow),
        pytest.param(hexabot_leg("B", l1=0.3), START, ["determinant", "singular_postures",
                     "singular_feet", "sigma_min"], marks=pytest.mark.slow),
        pytest.param(hexabot_leg("B", l3=0.06), START, ["determinant", "singular_postures",
                     "singular_feet", "sigma_min"], marks=pytest.mark.slow),
        (SCARA, ARM, ["sigma_min"]),
        (SCARA, [*ARM, 0.06], ["sigma_min"]),
    ],
    ids=["leg_a", "short", "unequal", "scara", "scara with its lift"],
)  # fmt: skip
def test_every_map_is_drawn_and_nothing_leaves_the_figure(robot, q, names):
    maps = maps_of_posture(robot, q)
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


def stars(figure):
    found = [
        (axes, line) for axes in figure.axes for line in axes.lines if line.get_marker() == "*"
    ]
    assert len(found) == 1
    return found[0]


@pytest.mark.parametrize("turns", [(0, 0, 0), (1, -1, 1), (0, 2, -1)])
def test_a_posture_is_marked_in_the_map_whatever_its_turns(turns):
    q = START + 2.0 * np.pi * np.array(turns)
    for figure in (
        singularity_maps.determinant_map(LEG, q, "title"),
        singularity_maps.joint_space(LEG, q, "title"),
    ):
        _, star = stars(figure)
        places = star.get_data_3d() if hasattr(star, "get_data_3d") else star.get_data()
        np.testing.assert_allclose(np.ravel(places), [90.0, -50.0, -90.0][-len(places) :])


@pytest.mark.slow
@pytest.mark.parametrize(("posture", "panel"), [((90, -50, -90), 0), ((90, 130, 10), 1)])
def test_a_posture_is_marked_where_its_own_singular_value_is_drawn(posture, panel):
    q = np.radians(posture)
    figure = singularity_maps.dexterity(LEG, q, "title")
    axes, star = stars(figure)
    assert axes is figure.axes[panel]
    x, z = (float(np.ravel(values)[0]) for values in star.get_data())
    mesh = next(c for c in axes.collections if c.get_array() is not None)
    corners = mesh.get_coordinates()
    column = np.searchsorted(corners[0, :, 0], x) - 1
    row = np.searchsorted(corners[:, 0, 1], z) - 1
    drawn = np.ma.filled(mesh.get_array().reshape(corners.shape[0] - 1, -1), np.nan)[row, column]
    sigma = 1e3 * examine(foot_jacobian(LEG, q)).sigma_min
    assert drawn == pytest.approx(sigma, abs=3.0)


@pytest.mark.slow
@pytest.mark.parametrize("lengths", [{}, {"l3": 0.06}, {"l1": 0.02, "l2": 0.15, "l3": 0.05}])
def test_the_edges_in_the_leg_s_plane_are_where_the_leg_is_singular(lengths):
    """Each point drawn is a foot of a posture that is stretched, folded or on the hip axis."""
    leg = LegGeometry.from_robot(hexabot_leg("B", **lengths))
    figure = singularity_maps.dexterity(leg, START, "title")
    for side, axes in zip((1, -1), figure.axes[:2], strict=True):
        edges = [line for line in axes.lines if line.get_marker() != "*"]
        assert len(edges) >= 3
        for line in edges:
            x, z = (1e-3 * np.asarray(values, dtype=float) for values in line.get_data())
            given = np.isfinite(x)
            knee_to_foot = np.hypot(side * x[given] - leg.l1, z[given])
            off = np.minimum.reduce(
                [
                    np.abs(knee_to_foot - (leg.l2 + leg.l3)),
                    np.abs(knee_to_foot - abs(leg.l2 - leg.l3)),
                    np.where(knee_to_foot >= abs(leg.l2 - leg.l3) - 1e-9, np.abs(x[given]), 1.0),
                ]
            )
            np.testing.assert_allclose(off, 0.0, atol=1e-9)


def test_other_robots_have_none_and_are_told_what_to_do():
    with pytest.raises(InvalidValueError, match=r"'pendulum'.*without `out`"):
        maps_of_posture(PENDULUM, [0.5])


@pytest.mark.slow
def test_a_map_is_small_and_has_a_dark_side(tmp_path):
    draw = maps_of_posture(LEG_B, START)["singular_postures"]
    paths = save(draw(), tmp_path, "map", ["svg"])
    svg = paths["svg"].read_text(encoding="utf-8")
    assert len(svg) < 4e5
    assert "prefers-color-scheme: dark" in for_light_and_dark(svg)
