"""Makes pages that show a plant in 3D: Meshcat's viewer, with our controls around it."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import cache
from html import escape
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined, Template, select_autoescape
from pydrake.geometry import Meshcat, MeshcatParams, Rgba
from pydrake.math import RigidTransform
from scipy.spatial.transform import Rotation

from drake_leg.colours import Colour
from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.khalil import Array
from drake_leg.models.log import quiet_drake
from drake_leg.scene.furniture import BLUE, GREEN, RED, TRACE, TRACE_RADIUS, triad_lengths
from drake_leg.scene.lettering import PLACEMENT
from drake_leg.scene.scene import Scene
from drake_leg.scene.server import MOST_PIECES
from drake_leg.scene.views import MARGIN, VIEWS, View, frame

ROBOT = "/drake/robot"  # in a page's tree
Entry = tuple[str, tuple[Colour, ...]]  # of a legend: words, and the colors of what they name
AXES: tuple[Entry, ...] = (("x", (RED,)), ("y", (GREEN,)), ("z", (BLUE,)))


class MeshcatError(DrakeLegError):
    """Meshcat cannot listen."""


class PageError(DrakeLegError):
    """Meshcat's page is not as expected."""


def web_page(
    scene: Scene,
    template: str | Template,
    *,
    title: str,
    data: Mapping[str, Any],
    draw_more: Callable[[Meshcat], None] | None = None,
    **values: object,
) -> str:
    """Make a page that needs no other file and no network: about 2.5 MB, most of it Meshcat.

    ``template`` is what is around the 3D: a file in ``page/`` that extends ``page.html``; ``data``
    is for the scripts, as JSON, ``stage_data`` and more; ``draw_more`` draws what is not part of
    the scene; the other values are for the template.
    """
    meshcat = open_meshcat()
    for part in scene.parts:
        if scene.footing is not None and part.path.startswith("trace/"):
            continue  # the script draws what has been walked
        path = f"{drake_path(part.frame)}/{part.path}"
        meshcat.SetObject(path, part.shape, Rgba(*part.colour, part.opacity))
        meshcat.SetTransform(path, RigidTransform(part.X_FP))
    meshcat.SetTransform(drake_path(0), RigidTransform(scene.shown.X_UW))
    if draw_more is not None:
        draw_more(meshcat)
    source = templates().get_template(template) if isinstance(template, str) else template
    square = f"{1e3 * scene.floor_square:g}"
    around = source.render(data=data, square=square, notes=scene.notes, **values)
    page = replaced(meshcat.StaticHtml(), "<html>", '<html lang="en">')
    page = replaced(
        page,
        "<title>Drake MeshCat</title>",
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>",
    )
    return replaced(page, "</body>", f"{around}</body>")


@cache
def templates() -> Environment:
    """Read the pages' templates in ``page/``."""
    environment = Environment(
        loader=PackageLoader("drake_leg.scene", "page"),
        autoescape=select_autoescape(["html"], default_for_string=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["css"] = _css
    return environment


def stage_data(scene: Scene, first: View) -> dict[str, Any]:
    """Collect the data that the scripts of all pages need; ``first`` is the initial view."""
    count, lengths = scene.triads, triad_lengths(scene.triads, scene.triad_size)
    held = scene.shown.held()
    for index, length in enumerate(lengths):
        held[index] = np.concatenate([held[index], length * np.eye(3)])
    return {
        "margin": MARGIN,
        "views": [
            {
                "label": view.label,
                "field": view.field,
                "axes": view.axes.T.tolist(),  # right, up, toward the camera
            }
            for view in scene.views.values()
        ],
        "targets": [scene.framing(view).target.tolist() for view in scene.views.values()],
        "points": np.round(scene.hull(), 6).tolist(),
        "floor": round(float(scene.floor[0, 2]), 6),
        "first": list(VIEWS).index(first.name),
        "paths": [drake_path(index) for index in range(1, len(scene.shown.frames))],
        "triads": [f"{drake_path(index)}/triad" for index in range(count)],
        "framed": scene.has_frames,
        "upright": scene.shown.X_UW.T.ravel().tolist(),  # column by column
        "frames": scene.shown.names[:count],
        "marks": scene.shown.marks[:count],
        "axes": lengths,
        "placement": asdict(PLACEMENT),
        "held": [np.round(points, 6).tolist() for points in held[1:]],
        "trace": f"{drake_path(0)}/trace",
        "walk": _walk_data(scene),
    }


def _walk_data(scene: Scene) -> dict[str, Any] | None:
    """How pages follow a robot that walks, and where they see all of its way."""
    if scene.footing is None or scene.whole is None:
        return None
    targets = [frame(view, scene.whole).target for view in scene.views.values()]
    return {
        "path": ROBOT,
        "origin": scene.footing.X_WG[:3, 3].tolist(),
        "normal": scene.footing.X_WG[:3, 2].tolist(),
        "whole": {
            "points": np.round(scene.whole, 6).tolist(),
            "targets": [target.tolist() for target in targets],
        },
    }


def drake_path(index: int) -> str:
    """Path of a shown frame in a page's tree; 0 is the world."""
    return f"{ROBOT}/frame_{index}"


def pose_rows(X_WF: Array) -> Array:
    """Write poses (..., 4, 4) as pages take them: x, y, z [m], quaternion w, x, y, z, (..., 7)."""
    rotations = Rotation.from_matrix(X_WF[..., :3, :3].reshape(-1, 3, 3))
    quaternions = rotations.as_quat()[:, [3, 0, 1, 2]].reshape(*X_WF.shape[:-2], 4)
    return np.concatenate([X_WF[..., :3, 3], quaternions], axis=-1)


def open_meshcat() -> Meshcat:
    """Start a Meshcat with an empty world, without grid and axes.

    It listens, on this machine only, as long as it lives.
    """
    settings = MeshcatParams()
    settings.host = "localhost"
    settings.show_stats_plot = False
    try:
        with quiet_drake(logging.WARNING):  # it logs its address
            meshcat = Meshcat(settings)
    except RuntimeError:
        raise MeshcatError(
            "Meshcat, which pages are made from, finds no free port from 7000 to 7999"
        ) from None
    for path in ("/Grid", "/Axes"):
        meshcat.SetProperty(path, "visible", False)
    return meshcat


def replaced(page: str, old: str, new: str) -> str:
    """Replace the last occurrence of a text on a page; scripts may contain it earlier."""
    before, found, after = page.rpartition(old)
    if not found:
        raise PageError(f"Meshcat's page has no {old}: this version of Drake is not supported")
    return before + new + after


def _css(colour: Colour) -> str:
    return f"rgb({' '.join(f'{255 * part:.0f}' for part in colour)})"


def live_data(scene: Scene, first: View, session: str) -> dict[str, Any]:
    """Collect the data for the scripts of all live pages, which follow a session's feed."""
    pen = {"most": MOST_PIECES, "radius": TRACE_RADIUS * scene.size, "colour": TRACE}
    return {**stage_data(scene, first), "pen": pen, "session": session}


def millimetres(point: Array) -> list[float]:
    """Write a point [m] as pages show it."""
    return [round(1e3 * float(part), 2) + 0.0 for part in point]
