"""Maps of the singularities and of the smallest singular value, for the leg and the SCARA."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import ArrayLike

from drake_leg.colours import BLUE, PURPLE, VERMILLION
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import scara
from drake_leg.kinematics.chain import geometry_of
from drake_leg.kinematics.khalil import Array, finite_vectors
from drake_leg.kinematics.leg import (
    BRANCHES,
    LegGeometry,
    branch_angles,
    determinant,
    foot_jacobian,
    foot_position,
)
from drake_leg.kinematics.movable import smallest_singular_value
from drake_leg.kinematics.scara import ScaraGeometry, lift_position, task_jacobian, tool_position
from drake_leg.pictures.plots.style import (
    INK,
    LEGEND_BELOW,
    STYLE,
    TITLE,
    ShownFigure,
    legend_above,
    new_figure,
)
from drake_leg.robot.robot import Robot
from drake_leg.singularity.families import (
    axis_reach,
    facing,
    folded_feet,
    hip_axis_arcs,
    leaning_over,
    stretched_feet,
)

MM = 1e3  # [mm/m]
CUBIC_CM = 1e6  # [cm^3/m^3]
TURN = (-180, -90, 0, 90, 180)  # [deg]
STAR: dict[str, Any] = {
    "color": "white",
    "markeredgecolor": "black",
    "markersize": 13.0,
    "linestyle": "none",
}
SHEET: dict[str, Any] = {"linewidth": 0, "rasterized": True}  # thousands of faces
STRETCHED, ON_AXIS = "sin $q_3$ = 0", "$\\rho$ = 0"
MARKED = "this posture"
SIDES = (1, -1)  # the foot in front of the hip, and behind it
Maps = dict[str, Callable[[], Figure]]


def determinant_map(leg: LegGeometry, start: ArrayLike, title: str) -> Figure:
    """Draw the determinant over knee and ankle, with both singular families as curves.

    The posture ``start`` (3,) [rad] is marked; report A, eq. 17.
    """
    q = finite_vectors("start", start, 3).reshape(1, 3)
    angles = np.linspace(-180.0, 180.0, 181)
    knee, ankle = np.meshgrid(angles, angles)
    grid = np.radians(np.stack([np.zeros_like(knee), knee, ankle], axis=-1))
    values = CUBIC_CM * determinant(leg, grid)
    most = float(np.abs(values).max())
    levels = MaxNLocator(12, steps=[1, 2, 4, 5, 10], symmetric=True).tick_values(-most, most)
    figure, (axes,) = new_figure(title, width=6.4, height=5.0)
    filled = axes.contourf(knee, ankle, values, levels=levels, cmap="RdBu_r", alpha=0.8)
    filled.set_rasterized(True)
    figure.colorbar(filled, label="det J [cm³/rad³]")
    for place, label in zip((-180, 0, 180), ("", STRETCHED, ""), strict=True):
        axes.axhline(place, color=BLUE, linewidth=3, clip_on=False, label=label)
    for number, arc in enumerate(hip_axis_arcs(leg)):
        label = "" if number else ON_AXIS
        axes.plot(*_wrapped_degrees(arc).T, color=VERMILLION, linewidth=3, label=label)
    axes.plot(*_wrapped_degrees(q)[:, 1:].T, "*", label=MARKED, **STAR)
    axes.set(xlabel="knee $q_2$ [deg]", ylabel="ankle $q_3$ [deg]", xticks=TURN, yticks=TURN)
    legend_above(axes)
    return figure


def joint_space(leg: LegGeometry, start: ArrayLike, title: str) -> Figure:
    """Draw both singular families as surfaces over hip, knee and ankle.

    The posture ``start`` (3,) [rad] is marked.
    """
    q = finite_vectors("start", start, 3).reshape(1, 3)
    figure, axes = _space(title)
    hip = np.linspace(-180.0, 180.0, 25)
    q1, q2 = np.meshgrid(hip, np.linspace(-180.0, 180.0, 25))
    for height in (-180.0, 0.0, 180.0):
        plane = np.full_like(q1, height)
        axes.plot_surface(q1, q2, plane, color=BLUE, alpha=0.22, **SHEET)
        axes.plot([-180, 180, 180, -180, -180], [-180, -180, 180, 180, -180], height, color=BLUE)
    for arc in hip_axis_arcs(leg, 61):
        for piece in _pieces(_wrapped_degrees(arc)):
            along = np.broadcast_to(hip[:, np.newaxis], (len(hip), len(piece)))
            knee, ankle = (np.broadcast_to(column, along.shape) for column in piece.T)
            axes.plot_surface(along, knee, ankle, color=VERMILLION, alpha=0.35, **SHEET)
            for end in (-180.0, 180.0):
                axes.plot(np.full(len(piece), end), *piece.T, color=VERMILLION)
    axes.plot(*_wrapped_degrees(q).T, "*", label=MARKED, **STAR)
    _legend(figure, axes, (BLUE, STRETCHED), (VERMILLION, ON_AXIS))
    axes.set(xlabel="hip $q_1$ [deg]", ylabel="knee $q_2$ [deg]", zlabel="ankle $q_3$ [deg]")
    axes.set(xticks=TURN, yticks=TURN, zticks=TURN)
    axes.view_init(elev=20, azim=-52)
    return figure


def foot_space(leg: LegGeometry, title: str) -> Figure:
    """Draw the foot's singular positions: a torus, a circle, a segment of the hip axis.

    The torus is cut open.
    """
    figure, axes = _space(title)
    turns, lean = np.radians(np.linspace(-40.0, 220.0, 66)), leaning_over(leg)
    outer = MM * stretched_feet(leg, turns, np.linspace(-lean, lean, 61))
    inner = MM * stretched_feet(leg, turns + np.pi, np.linspace(lean, 2.0 * np.pi - lean, 31))
    for feet, colour, opacity in ((outer, BLUE, 0.16), (inner, PURPLE, 0.25)):
        sheet = np.moveaxis(feet, -1, 0)
        axes.plot_surface(*sheet, color=colour, alpha=opacity, **SHEET)
        axes.plot_wireframe(*sheet, rstride=6, cstride=5, color=colour, linewidth=0.5)
    _draw_folded(axes, leg)
    near, far = axis_reach(leg)
    for low, high in ((-far, -near), (near, far)):
        axes.plot([0, 0], [0, 0], [MM * low, MM * high], color=VERMILLION, linewidth=4)
    _legend(
        figure,
        axes,
        (BLUE, "stretched, outer sheet: the workspace boundary"),
        (PURPLE, "stretched, inner sheet: leaning back over the hip"),
        (INK, "folded"),
        (VERMILLION, f"{ON_AXIS}: on the hip axis"),
    )
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]", aspect="equal")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.view_init(elev=24, azim=-68)
    return figure


def _draw_folded(axes: Axes3D, leg: LegGeometry) -> None:
    """Draw the folded leg's feet: a circle, or a torus where femur and tibia differ."""
    turns = np.radians(np.linspace(-40.0, 220.0, 66))
    if math.isclose(leg.l2, leg.l3):
        feet = MM * folded_feet(leg, np.linspace(-np.pi, np.pi, 181), np.zeros(1))
        axes.plot(*feet[0].T, color=INK, linewidth=2.5)
        return
    sheet = np.moveaxis(MM * folded_feet(leg, turns, np.linspace(-np.pi, np.pi, 61)), -1, 0)
    axes.plot_wireframe(*sheet, rstride=6, cstride=5, color=INK, linewidth=0.5)


def _space(title: str) -> tuple[Figure, Axes3D]:
    with mpl.rc_context(STYLE):
        figure = ShownFigure(figsize=(6.4, 5.6), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot(projection="3d")
        figure.suptitle(title, **TITLE)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
    return figure, axes


def _legend(figure: Figure, axes: Axes3D, *entries: tuple[str, str]) -> None:
    for colour, label in entries:
        axes.plot([], [], [], color=colour, linewidth=5, label=label)
    figure.legend(*axes.get_legend_handles_labels(), ncols=2, **LEGEND_BELOW)


def _wrapped_degrees(arc: Array) -> Array:
    """Write an arc in -180 ... 180 degrees, with a NaN gap where it wraps around."""
    wrapped = np.degrees((arc + math.pi) % (2.0 * math.pi) - math.pi)
    jumps = np.flatnonzero(np.abs(np.diff(wrapped, axis=0)).max(axis=1) > 180.0) + 1
    return np.insert(wrapped, jumps, np.nan, axis=0)


def _pieces(arc: Array) -> Sequence[Array]:
    """Cut an arc at its gaps."""
    gaps = np.flatnonzero(np.isnan(arc).any(axis=1))
    return [piece[~np.isnan(piece).any(axis=1)] for piece in np.split(arc, gaps)]


def dexterity(leg: LegGeometry, start: Sequence[float] | Array, title: str) -> Figure:
    """Draw the smallest singular value over the leg's own plane, for both ways of facing the foot.

    The posture ``start`` (3,) [rad] is marked.
    """
    reach, far = leg.l2 + leg.l3, leg.l1 + leg.l2 + leg.l3
    x, z = np.meshgrid(np.linspace(0.0, 1.02 * far, 221), np.linspace(-reach, reach, 361))
    angles = branch_angles(leg, np.stack([x, np.zeros_like(x), z], axis=-1))
    sigmas = [_foot_sigma(leg, angles[..., BRANCHES.index((side, 1)), :]) for side in SIDES]
    most = float(np.nanmax(sigmas))
    figure, panels = new_figure(title, columns=2, width=6.8, height=5.2)
    for axes, side, sigma in zip(panels, SIDES, sigmas, strict=True):
        colours = axes.pcolormesh(
            MM * x, MM * z, sigma, cmap="viridis", vmin=0.0, vmax=most, rasterized=True
        )
        _edges_in_plane(axes, leg, side)
        axes.set_title(f"the foot {'in front of' if side > 0 else 'behind'} the hip", fontsize=10)
        axes.set(xlabel="from the hip axis [mm]", aspect="equal")
        axes.set(
            xlim=(-0.03 * MM * far, 1.03 * MM * far), ylim=(-1.05 * MM * reach, 1.05 * MM * reach)
        )
    foot = MM * foot_position(leg, start)
    panels[0 if facing(leg, start) > 0.0 else 1].plot(
        np.hypot(*foot[:2]), foot[2], "*", label=MARKED, **STAR
    )
    panels[0].set(ylabel="z [mm]")
    named: dict[str, Artist] = {}
    for axes in panels:
        lines, labels = axes.get_legend_handles_labels()
        named |= dict(zip(labels, lines, strict=True))
    figure.legend(list(named.values()), list(named), ncols=4, **LEGEND_BELOW)
    figure.colorbar(colours, ax=panels, label="$\\sigma_{\\min}$ [mm/rad]")
    return figure


def arm_dexterity(arm: ScaraGeometry, start: ArrayLike, title: str) -> Figure:
    """Draw the smallest singular value of the tool's (x, y) from above, and both singular circles.

    The arm is drawn in the posture ``start`` (4,) [rad, the last one m]; report B, section 1.6.
    """
    far = arm.l1 + arm.l2
    side = np.linspace(-1.04 * far, 1.04 * far, 361)
    x, y = np.meshgrid(side, side)
    q = scara.branch_angles(arm, np.stack([x, y, np.zeros_like(x)], axis=-1))[..., 0, :]
    sigma = _where_reached(q, lambda inside: task_jacobian(arm, inside)[..., :2, :2])
    figure, (axes,) = new_figure(title, width=6.4, height=5.6)
    colours = axes.pcolormesh(MM * x, MM * y, sigma, cmap="viridis", rasterized=True)
    turn = np.linspace(-np.pi, np.pi, 361)
    circle = MM * np.stack([np.cos(turn), np.sin(turn)])
    axes.plot(*(far * circle), color=BLUE, linewidth=3, label="stretched")
    axes.plot(*(abs(arm.l1 - arm.l2) * circle), color=VERMILLION, linewidth=3, label="folded")
    shoulder = float(np.asarray(start)[0])
    tool = MM * tool_position(arm, start)
    elbow = MM * arm.l1 * np.array([math.cos(shoulder), math.sin(shoulder)])
    links = np.stack([np.zeros(2), elbow, tool[:2]]).T
    axes.plot(*links, color="black", linewidth=5.0)
    axes.plot(*links, "o-", color="white", linewidth=2.8, markeredgecolor="black", label="the arm")
    axes.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    figure.legend(ncols=4, **LEGEND_BELOW)
    figure.colorbar(colours, label="$\\sigma_{\\min}$ [mm/rad]")
    return figure


def _edges_in_plane(axes: Axes, leg: LegGeometry, side: int) -> None:
    """Draw the singular feet of one way of facing the foot; ``side`` as in ``BRANCHES``."""
    turn = np.linspace(-math.pi, math.pi, 721)
    for radius, colour, label in (
        (leg.l2 + leg.l3, BLUE, "stretched"),
        (abs(leg.l2 - leg.l3), INK, "folded"),
    ):
        circle = MM * np.stack([side * (leg.l1 + radius * np.cos(turn)), radius * np.sin(turn)])
        if radius > 0.0:
            seen = np.where(circle[0] >= 0.0, circle, np.nan)
            axes.plot(*seen, color=colour, linewidth=3, label=label)
        elif side > 0:
            axes.plot(*circle[:, 0], "o", color=colour, label=label)
    near, far = axis_reach(leg)
    for low, high in ((-far, -near), (near, far)):
        axes.plot([0.0, 0.0], [MM * low, MM * high], color=VERMILLION, linewidth=3, label=ON_AXIS)


def _foot_sigma(leg: LegGeometry, q: Array) -> Array:
    return _where_reached(q, lambda inside: foot_jacobian(leg, inside))


def _where_reached(q: Array, jacobian: Callable[[Array], Array]) -> Array:
    """Return smallest singular values [mm/rad], NaN where a point is out of reach."""
    inside = np.isfinite(q).all(axis=-1)
    sigma = np.full(inside.shape, np.nan)
    sigma[inside] = MM * smallest_singular_value(jacobian(q[inside]))
    return sigma


def maps_of_posture(robot: Robot, q: Sequence[float]) -> Maps:
    """Name the maps of a posture of a leg or the SCARA, and the functions that draw them.

    The posture (m,) [rad or m] is marked; the SCARA's lift may be left out.

    Raises
    ------
    InvalidValueError
        If it is another robot.
    """
    match geometry_of(robot):
        case LegGeometry() as leg:
            return _of_leg(robot.title, leg, q)
        case ScaraGeometry() as arm:
            return _of_scara(robot.title, arm, q)
    raise InvalidValueError(
        f"the robot is {robot.name!r}; maps are drawn of a hexabot leg or the SCARA",
        advice="without `out` the posture is described in words",
    )


def _of_leg(title: str, leg: LegGeometry, q: Sequence[float]) -> Maps:
    return {
        "determinant": lambda: determinant_map(
            leg, q, f"{title}: the determinant, and where it is zero"
        ),
        "singular_postures": lambda: joint_space(
            leg, q, f"{title}: both families of singular postures"
        ),
        "singular_feet": lambda: foot_space(
            leg, f"{title}: where the foot is at singular postures"
        ),
        "sigma_min": lambda: dexterity(
            leg, q, f"{title}: how well the foot moves in the leg's own plane"
        ),
    }


def _of_scara(robot: str, arm: ScaraGeometry, q: Sequence[float]) -> Maps:
    posture = q if len(q) == 4 else (*q, lift_position(arm, 0.0))
    title = f"{robot}: how well the tool moves, from above"
    return {
        "sigma_min": lambda: arm_dexterity(arm, posture, title),
    }
