"""A scene drawn by matplotlib, for where nothing can be rendered: shaded faces, far ones first."""

from __future__ import annotations

import io
from functools import cache
from itertools import pairwise

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from drake_leg.colours import Colour
from drake_leg.figures.style import STYLE
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Brick, Cylinder, Shape
from drake_leg.scene.paper import LIGHT, Paper
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import MARGIN, View

Image = NDArray[np.uint8]  # (height, width, 3), red, green, blue

DPI = 120
SIDES = 12  # of a prism that stands for a cylinder
LAMP = np.array([-0.35, 0.6, 0.72])  # from the picture to the light: right, up, backwards
SHADOW = 0.55  # brightness of what the light does not reach


class Sketcher:
    """Draws one scene in any pose, in parallel projection; to be used as ``vtk.Renderer``.

    Parameters
    ----------
    scene : Scene
        What there is to see.
    width, height : int
        Of the pictures [pixels].
    """

    def __init__(self, scene: Scene, *, width: int, height: int, paper: Paper = LIGHT) -> None:
        self._scene, self._width, self._height, self._paper = scene, width, height, paper
        self._framing = cache(scene.framing)

    def image(self, X_WF: Array, view: View) -> Image:
        """Draw a picture.

        Parameters
        ----------
        X_WF : (n + 1, 4, 4) ndarray
            Poses of the robot's frames, as one row of ``Motion.poses``.

        Returns
        -------
        (height, width, 3) ndarray of uint8
            Red, green, blue.
        """
        faces, colours = [], []
        for part in self._scene.parts:
            X_WP = X_WF[part.frame] @ part.X_FP
            R_VP, p_VP = view.axes.T @ X_WP[:3, :3], view.axes.T @ X_WP[:3, 3]
            for face in _faces(part.shape):
                seen = face @ R_VP.T + p_VP
                faces.append(seen)
                colours.append((*_shaded(part.colour, seen), part.opacity))
        far_first = np.argsort([face[:, 2].mean() for face in faces])
        polygons = [self._pixels(faces[index], view) for index in far_first]
        return self._drawn(polygons, [colours[index] for index in far_first])

    def pixels(self, points: Array, view: View) -> Array:
        """Say where points of the world are in a picture.

        Parameters
        ----------
        points : (n, 3) ndarray
            In the world [m].

        Returns
        -------
        (n, 2) ndarray
            To the right and downwards from the picture's upper left corner [pixels].
        """
        return self._pixels(points @ view.axes, view)

    def _pixels(self, seen: Array, view: View) -> Array:
        framing = self._framing(view)
        aspect = self._width / self._height
        half = MARGIN * max(framing.half_height, framing.half_width / aspect)
        scale = self._height / (2.0 * half)
        away = (seen - framing.target @ view.axes)[:, :2] * [scale, -scale]
        return np.asarray(away + np.array([self._width, self._height]) / 2.0)

    def _drawn(self, polygons: list[Array], colours: list[tuple[float, ...]]) -> Image:
        with mpl.rc_context(STYLE):
            figure = Figure(figsize=(self._width / DPI, self._height / DPI), dpi=DPI)
            figure.set_facecolor(self._paper.background)
            FigureCanvasAgg(figure)
            axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
            axes.set_axis_off()
            axes.set_xlim(0.0, self._width)
            axes.set_ylim(self._height, 0.0)
            axes.add_collection(PolyCollection(polygons, facecolors=colours))
            buffer = io.BytesIO()
            figure.savefig(buffer, format="rgba", dpi=DPI)
        pixels = np.frombuffer(buffer.getvalue(), dtype=np.uint8)
        return pixels.reshape(self._height, self._width, 4)[:, :, :3]


def _faces(shape: Shape) -> list[Array]:
    """Polygons around a solid, (k, 3) each; a ball is a prism's stack."""
    if isinstance(shape, Brick):
        x, y = shape.length / 2.0, shape.width / 2.0
        ring = np.array([[x, y], [-x, y], [-x, -y], [x, -y]])
        return _between([(ring, -shape.height / 2.0), (ring, shape.height / 2.0)])
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    if isinstance(shape, Cylinder):
        ring = shape.radius * circle
        return _between([(ring, -shape.length / 2.0), (ring, shape.length / 2.0)])
    heights = np.linspace(-np.pi / 2.0, np.pi / 2.0, SIDES // 2 + 1)
    return _between(
        [(shape.radius * np.cos(h) * circle, shape.radius * float(np.sin(h))) for h in heights]
    )


def _between(rings: list[tuple[Array, float]]) -> list[Array]:
    """Faces between rings of equally many corners, one above the other, with both ends."""
    rows = [np.column_stack([ring, np.full(len(ring), height)]) for ring, height in rings]
    faces = [rows[0], rows[-1]]
    for low, high in pairwise(rows):
        for corner in range(len(low)):
            after = (corner + 1) % len(low)
            faces.append(np.array([low[corner], low[after], high[after], high[corner]]))
    return faces


def _shaded(colour: Colour, face: Array) -> Colour:
    """Darken a face that turns away from the light, whichever side of it is seen."""
    diagonals = face[len(face) // 2] - face[0], face[-1] - face[len(face) // 4]
    normal = np.cross(*diagonals)
    length = float(np.linalg.norm(normal))
    lit = abs(float(normal @ LAMP)) / (length * float(np.linalg.norm(LAMP))) if length else 1.0
    red, green, blue = (part * (SHADOW + (1.0 - SHADOW) * lit) for part in colour)
    return red, green, blue
