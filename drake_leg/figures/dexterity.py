"""How well the leg's foot and the SCARA's tool move, over where they can be."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from drake_leg.colours import BLUE, VERMILLION
from drake_leg.figures.singularities import MARKED, MM, ON_AXIS, STAR
from drake_leg.figures.style import INK, LEGEND_BELOW, new_figure
from drake_leg.kinematics import scara
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.leg import (
    BRANCHES,
    LegGeometry,
    branch_angles,
    foot_jacobian,
    foot_position,
)
from drake_leg.kinematics.movable import smallest_singular_value
from drake_leg.kinematics.scara import ScaraGeometry, task_jacobian, tool_position
from drake_leg.singularity.families import facing
from drake_leg.singularity.sets import axis_reach

SIDES = (1, -1)  # the foot in front of the hip, and behind it


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
