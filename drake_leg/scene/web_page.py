"""Pages that show a robot in 3D: Meshcat's viewer, with controls of our own around it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot
from drake_leg.scene.marks import triad_lengths
from drake_leg.scene.parts import corners
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import MARGIN, VIEWS, View

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat

ROOM = "drake_leg.scene"
STAGE = ("names.js", "gestures.js", "stage.js")  # what all pages do


class PageError(DrakeLegError):
    """Meshcat's page is not as this program knows it."""


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """What a page has beside the 3D."""

    title: str  # of the window
    body: str  # HTML: a header and a panel
    styles: tuple[str, ...] = ()  # after those that all pages have
    scripts: tuple[str, ...] = ()  # after those that all pages have
    data: Mapping[str, Any]  # for the scripts, as JSON


def web_page(
    scene: Scene, sheet: Sheet, *, draw_more: Callable[[Meshcat], None] | None = None
) -> str:
    """Make a page that needs no other file and no network.

    Parameters
    ----------
    sheet : Sheet
        What stands around it.
    draw_more : callable, optional
        Draws what is no part of the scene.

    Returns
    -------
    str
        HTML, about 2.5 MB, most of which is Meshcat.

    Raises
    ------
    MeshcatError
        If Meshcat finds no free port.
    PageError
        If Meshcat's page is not as this program knows it.
    """
    from drake_leg.scene.meshcat import draw, open_meshcat

    meshcat = open_meshcat()
    draw(meshcat, scene)
    if draw_more is not None:
        draw_more(meshcat)
    page = replaced(meshcat.StaticHtml(), "<html>", '<html lang="en">')
    page = replaced(
        page,
        "<title>Drake MeshCat</title>",
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(sheet.title)}</title>",
    )
    styles = "".join((page_text("stage.css"), *sheet.styles))
    data = json.dumps(sheet.data).replace("</", "<\\/")
    scripts = "".join(
        f"<script>\n{text}</script>\n" for text in (*map(page_text, STAGE), *sheet.scripts)
    )
    return replaced(
        page,
        "</body>",
        f"<style>\n{styles}</style>\n{sheet.body}"
        f'<script type="application/json" id="page-data">{data}</script>\n{scripts}</body>',
    )


def page_text(name: str, room: str = ROOM) -> str:
    """Read a part of a page.

    Parameters
    ----------
    room : str
        In whose folder ``page`` it is.
    """
    return (files(room) / "page" / name).read_text(encoding="utf-8")


def stage_data(scene: Scene, first: View) -> dict[str, Any]:
    """Tell what the script needs that all pages have.

    Parameters
    ----------
    first : View
        From where it is seen first.
    """
    robot = scene.robot
    moving = range(1, len(robot.rows) + 1)
    return {
        "margin": MARGIN,
        "views": [_view_data(scene, view) for view in VIEWS.values()],
        "points": np.round(scene.hull(), 6).tolist(),
        "floor": round(float(scene.floor[0, 2]), 6),
        "first": list(VIEWS).index(first.name),
        "paths": [drake_path(index) for index in moving],
        "triads": [f"{drake_path(index)}/triad" for index in (0, *moving)],
        "axes": triad_lengths(robot, scene.size),
        "held": [_held(robot, index, scene.size) for index in moving],
        "trace": f"{drake_path(0)}/trace",
    }


def drake_path(index: int) -> str:
    """Where the parts of a frame are in a page's tree.

    Parameters
    ----------
    index : int
        Of the frame in the table; 0 is the base.
    """
    from drake_leg.scene.meshcat import frame_path

    return f"/drake/{frame_path(index)}"


def pose_rows(X_WF: Array) -> Array:
    """Write poses as pages take them.

    Parameters
    ----------
    X_WF : (..., 4, 4) ndarray
        Homogeneous transforms [-, m].

    Returns
    -------
    (..., 7) ndarray
        x, y, z [m] and the quaternion w, x, y, z.
    """
    rotations = Rotation.from_matrix(X_WF[..., :3, :3].reshape(-1, 3, 3))
    quaternions = rotations.as_quat()[:, [3, 0, 1, 2]].reshape(*X_WF.shape[:-2], 4)
    return np.concatenate([X_WF[..., :3, 3], quaternions], axis=-1)


def replaced(page: str, old: str, new: str) -> str:
    """Replace what stands once on Meshcat's page; at its end, where it stands in a script too.

    Parameters
    ----------
    page, old, new : str
        The page, what it must have, and what takes its place.

    Raises
    ------
    PageError
        If it is not there.
    """
    before, found, after = page.rpartition(old)
    if not found:
        raise PageError(f"Meshcat's page has no {old}: this version of Drake is not known")
    return before + new + after


def _view_data(scene: Scene, view: View) -> dict[str, Any]:
    return {
        "label": view.label,
        "field": view.field,
        "axes": view.axes.T.tolist(),  # right, up, towards the camera
        "target": scene.framing(view).target.tolist(),
    }


def _held(robot: Robot, index: int, size: float) -> list[list[float]]:
    """Points on a frame that a picture must hold [m]."""
    tips = triad_lengths(robot, size)[index] * np.eye(3)
    return [[round(float(x), 6) for x in p] for p in (*corners(robot, index), *tips)]
