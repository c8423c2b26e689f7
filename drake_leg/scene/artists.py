"""Renders a scene with Drake's VTK engine, or draws it with matplotlib where VTK cannot work."""

from __future__ import annotations

import io
import math
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from pydrake.geometry import (
    Capsule,
    ClippingRange,
    ColorRenderCamera,
    Convex,
    Cylinder,
    Ellipsoid,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    LightParameter,
    MakeRenderEngineVtk,
    Mesh,
    PerceptionProperties,
    RenderCameraCore,
    RenderEngineVtkParams,
    Rgba,
    SceneGraph,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.sensors import CameraInfo

from drake_leg.colours import Colour
from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.plots.style import STYLE
from drake_leg.robot.robots import PENDULUM
from drake_leg.scene.lettering import LIGHT, Paper, Pixels
from drake_leg.scene.motion import at_rest
from drake_leg.scene.parts import Part
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View

EDGE = 0.06  # of the picture's width: room around what a scene holds, for what is thick

DPI = 120
SIDES = 12  # of a prism that stands for a cylinder
LAMP = np.array([-0.35, 0.6, 0.72])  # from the picture to the light: right, up, backwards
SHADOW = 0.55  # brightness of what the light does not reach
# Where lights come from, in the camera's frame (right, down, forwards), and how strong they are.
_LIGHTS = (((-0.6, -0.9, -0.5), 0.8), ((0.9, -0.2, -0.6), 0.4), ((0.1, 0.4, -1.0), 0.5))

TRIAL = """
from drake_leg.scene.artists import try_rendering
try_rendering()
"""
PATIENCE = 60.0  # [s]
MOST_SAID = 200  # letters of a reason
REMEDY = "install Mesa (Debian: libegl1 libgl1-mesa-dri)"


@dataclass(frozen=True, kw_only=True)
class _Shot:
    """A placed camera; it leaves out the empty edges of the picture."""

    X_WC: RigidTransform  # its axes point right, down and forwards
    focus: float  # focal length [pixels]
    cameras: tuple[ColorRenderCamera, ...]  # one for each paper
    beside: int  # left out on the left and on the right [pixels]
    above: int  # left out above and below [pixels]


class Renderer:
    """Renders one scene in any pose, in pictures of a size [pixels] on one of its papers.

    A scene graph by itself, without a diagram: the poses are fixed on its input port.
    """

    def __init__(
        self, scene: Scene, *, width: int, height: int, papers: tuple[Paper, ...] = (LIGHT,)
    ) -> None:
        self._scene, self.width, self.height = scene, width, height
        self._papers = papers
        self._shot = cache(self._aim)
        self._graph = SceneGraph()
        for engine, paper in enumerate(papers):
            self._graph.AddRenderer(str(engine), MakeRenderEngineVtk(_engine_parameters(paper)))
        self._source = self._graph.RegisterSource("robot")
        self._frames = [
            self._graph.RegisterFrame(self._source, GeometryFrame(f"frame_{index}"))
            for index in range(len(scene.shown.frames))
        ]
        for index, part in enumerate(scene.drawn):
            name = f"{index}: {part.path}"
            try:
                self._add(part, part.shape, name)
            except RuntimeError:  # VTK needs an OBJ's normals; its convex hull has some
                if not isinstance(part.shape, Mesh):
                    raise
                self._add(part, Convex(part.shape.source(), part.shape.scale3()), f"{name}, hull")
        self._context = self._graph.CreateDefaultContext()

    def _add(self, part: Part, shape: Shape, name: str) -> None:
        instance = GeometryInstance(RigidTransform(part.X_FP), shape, name)
        properties = PerceptionProperties()
        properties.AddProperty("phong", "diffuse", Rgba(*part.colour, part.opacity))
        instance.set_perception_properties(properties)
        self._graph.RegisterGeometry(self._source, self._frames[part.frame], instance)

    def image(self, X_WF: Array, view: View, paper: Paper | None = None) -> Pixels:
        """Render the frames' poses, (n, 4, 4) as one row of ``PlantMotion.poses``.

        The paper is one of the renderer's; by default its first.
        """
        paper = paper or self._papers[0]
        poses = FramePoseVector()
        for frame, X in zip(self._frames, X_WF, strict=True):
            poses.set_value(frame, RigidTransform(X))
        self._graph.get_source_pose_port(self._source).FixValue(self._context, poses)
        query = self._graph.get_query_output_port().Eval(self._context)
        shot = self._shot(view)
        camera = shot.cameras[self._papers.index(paper)]
        seen = query.RenderColorImage(camera, self._graph.world_frame_id(), shot.X_WC)
        image = np.empty((self.height, self.width, 3), dtype=np.uint8)
        image[:] = np.round(255.0 * np.array(paper.background))
        rows = slice(shot.above, self.height - shot.above)
        columns = slice(shot.beside, self.width - shot.beside)
        image[rows, columns] = seen.data[:, :, :3]
        return image

    def pixels(self, points: Array, view: View) -> Array:
        """Project points of the world (n, 3), to the right and down, (n, 2) [pixels]."""
        shot = self._shot(view)
        middle = np.array([self.width, self.height]) / 2.0
        return middle + _projected(points, shot.X_WC, shot.focus)

    def _aim(self, view: View) -> _Shot:
        framing = self._scene.framing(view)
        aspect = self.width / self.height
        right, up, back = view.axes.T
        axes = RotationMatrix(np.column_stack([right, -up, -back]))
        X_WC = RigidTransform(axes, framing.camera(aspect))
        focus = self.height / 2.0 / math.tan(view.field / 2.0)
        size = np.array([self.width, self.height])
        reach = size / 2.0  # around a robot that walks, its ground fills the picture
        if self._scene.footing is None:
            reach = np.abs(_projected(self._scene.held, X_WC, focus)).max(axis=0)
            reach += EDGE * self.width
        beside, above = np.maximum(size / 2.0 - reach, 0.0).astype(int).tolist()
        width, height = self.width - 2 * beside, self.height - 2 * above
        far = framing.distance(aspect) + self._scene.size
        lens = CameraInfo(width, height, focus, focus, width / 2.0 - 0.5, height / 2.0 - 0.5)
        depths = ClippingRange(far / 100.0, 2.0 * far)
        cameras = tuple(
            ColorRenderCamera(RenderCameraCore(str(engine), lens, depths, RigidTransform()), False)
            for engine in range(len(self._papers))
        )
        return _Shot(X_WC=X_WC, focus=focus, cameras=cameras, beside=beside, above=above)


class Sketcher:
    """Draws one scene in any pose, in parallel projection: shaded faces, far ones first."""

    def __init__(
        self, scene: Scene, *, width: int, height: int, papers: tuple[Paper, ...] = (LIGHT,)
    ) -> None:
        self._scene, self.width, self.height, self._papers = scene, width, height, papers
        self._framing = scene.framing

    def image(self, X_WF: Array, view: View, paper: Paper | None = None) -> Pixels:
        """Draw the frames' poses, (n, 4, 4) as one row of ``PlantMotion.poses``."""
        faces, colours = [], []
        for part in self._scene.drawn:
            X_WP = X_WF[part.frame] @ part.X_FP
            R_VP, p_VP = view.axes.T @ X_WP[:3, :3], view.axes.T @ X_WP[:3, 3]
            for face in _faces(part):
                seen = face @ R_VP.T + p_VP
                faces.append(seen)
                colours.append((*_shaded(part.colour, seen), part.opacity))
        far_first = np.argsort([face[:, 2].mean() for face in faces])
        polygons = [self._pixels(faces[index], view) for index in far_first]
        paper = paper or self._papers[0]
        return self._drawn(polygons, [colours[index] for index in far_first], paper)

    def pixels(self, points: Array, view: View) -> Array:
        """Project points of the world (n, 3), to the right and down, (n, 2) [pixels]."""
        return self._pixels(points @ view.axes, view)

    def _pixels(self, seen: Array, view: View) -> Array:
        framing = self._framing(view)
        aspect = self.width / self.height
        scale = self.height / (2.0 * framing.half_height(aspect))
        away = (seen - framing.target @ view.axes)[:, :2] * [scale, -scale]
        return np.asarray(away + np.array([self.width, self.height]) / 2.0)

    def _drawn(
        self, polygons: list[Array], colours: list[tuple[float, ...]], paper: Paper
    ) -> Pixels:
        with mpl.rc_context(STYLE):
            figure = Figure(figsize=(self.width / DPI, self.height / DPI), dpi=DPI)
            figure.set_facecolor(paper.background)
            FigureCanvasAgg(figure)
            axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
            axes.set_axis_off()
            axes.set_xlim(0.0, self.width)
            axes.set_ylim(self.height, 0.0)
            axes.add_collection(PolyCollection(polygons, facecolors=colours))
            buffer = io.BytesIO()
            figure.savefig(buffer, format="rgba", dpi=DPI)
        pixels = np.frombuffer(buffer.getvalue(), dtype=np.uint8)
        return pixels.reshape(self.height, self.width, 4)[:, :, :3]


class NoRenderingError(DrakeLegError):
    """OpenGL is missing or broken; ``reason`` is the last line of the trial's output."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(
            "no picture can be rendered here, OpenGL is missing or broken "
            f"({reason}): {REMEDY}, or use a replay page, which the browser renders"
        )


_TOLD: list[str | None] = []  # the result of a trial that another process has made


def tell_rendering(fault: str | None) -> None:
    """Spare this process the trial, whose result another process knows."""
    _TOLD[:] = [fault]
    rendering_fault.cache_clear()


@cache
def rendering_fault() -> str | None:
    """Try VTK in another process; return what went wrong, in one line, or None."""
    if _TOLD:
        return _TOLD[0]
    command = [sys.executable, "-c", TRIAL]
    try:
        trial = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"{type(error).__name__}"
    lines = [line.strip() for line in trial.stderr.splitlines() if line.strip()]
    return lines[-1][:MOST_SAID] if trial.returncode > 0 and lines else ended_by(trial.returncode)


def ended_by(status: int) -> str | None:
    """Say what the status of a trial's process means, where it said nothing."""
    if status < 0:
        return f"the renderer was ended by signal {-status}"
    return f"exit status {status}" if status else None


def try_rendering() -> None:
    """Render a small picture; without OpenGL this raises an error, or ends the process."""
    motion = at_rest(PENDULUM, [0.3])
    image = Renderer(scene_of(motion), width=64, height=48).image(motion.poses()[0], VIEWS["front"])
    if not np.ptp(image):
        raise RuntimeError("the picture is empty")


def require_rendering() -> None:
    """Check that VTK can render."""
    fault = rendering_fault()
    if fault is not None:
        raise NoRenderingError(fault)


def _projected(points: Array, X_WC: RigidTransform, focus: float) -> Array:
    """Project points of the world into a picture, from its middle [pixels]."""
    in_camera = (points - X_WC.translation()) @ X_WC.rotation().matrix()
    return np.asarray(focus * in_camera[:, :2] / in_camera[:, 2:])


def _engine_parameters(paper: Paper) -> RenderEngineVtkParams:
    lights = [
        LightParameter(
            type="directional", frame="camera", direction=-np.array(origin), intensity=strength
        )
        for origin, strength in _LIGHTS
    ]
    return RenderEngineVtkParams(default_clear_color=np.array(paper.background), lights=lights)


def _faces(part: Part) -> list[Array]:
    """Polygons around a solid, (k, 3) each; what is round is a stack of prisms, a mesh is a box."""
    shape = part.shape
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    heights = np.linspace(-np.pi / 2.0, np.pi / 2.0, SIDES // 2 + 1)
    if isinstance(shape, Cylinder):
        ring, half = shape.radius() * circle, shape.length() / 2.0
        return _between([(ring, -half), (ring, half)])
    if isinstance(shape, Sphere | Ellipsoid | Capsule):
        if isinstance(shape, Ellipsoid):
            a, b, c = shape.a(), shape.b(), shape.c()
        else:
            a = b = c = shape.radius()
        half = shape.length() / 2.0 if isinstance(shape, Capsule) else 0.0
        return _between(
            [
                (np.cos(h) * circle * [a, b], c * float(np.sin(h)) + math.copysign(half, h))
                for h in heights
            ]
        )
    corners = replace(part, X_FP=np.eye(4)).corners()
    if not len(corners):
        return []
    low, high = corners.min(axis=0), corners.max(axis=0)
    ring = np.array([[high[0], high[1]], [low[0], high[1]], [low[0], low[1]], [high[0], low[1]]])
    return _between([(ring, low[2]), (ring, high[2])])


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
