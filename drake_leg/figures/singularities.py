"""Where the leg is singular: over its joints, and where its foot is then."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import ArrayLike

from drake_leg.colours import BLUE, PURPLE, VERMILLION
from drake_leg.figures.style import INK, LEGEND_BELOW, STYLE, TITLE, legend_above, new_figure
from drake_leg.kinematics.batches import Array, finite_vectors
from drake_leg.kinematics.leg import LegGeometry, determinant
from drake_leg.singularity.sets import (
    axis_reach,
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
    """Draw where the foot is at the singular postures: torus, circle, piece of the hip axis.

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
        figure = Figure(figsize=(6.4, 5.6), layout="constrained")
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
    """Write an arc in -180 ... 180 degrees, with a gap of NaN where it leaves and comes back."""
    wrapped = np.degrees((arc + math.pi) % (2.0 * math.pi) - math.pi)
    jumps = np.flatnonzero(np.abs(np.diff(wrapped, axis=0)).max(axis=1) > 180.0) + 1
    return np.insert(wrapped, jumps, np.nan, axis=0)


def _pieces(arc: Array) -> Sequence[Array]:
    """Cut an arc at its gaps."""
    gaps = np.flatnonzero(np.isnan(arc).any(axis=1))
    return [piece[~np.isnan(piece).any(axis=1)] for piece in np.split(arc, gaps)]
