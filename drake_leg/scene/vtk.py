"""Pictures of a scene by Drake's VTK renderer, which needs no display."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    ClippingRange,
    ColorRenderCamera,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    LightParameter,
    MakeRenderEngineVtk,
    PerceptionProperties,
    RenderCameraCore,
    RenderEngineVtkParams,
    Rgba,
    SceneGraph,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.sensors import CameraInfo

from drake_leg.kinematics.batches import Array
from drake_leg.scene.paper import LIGHT, Paper
from drake_leg.scene.scene import Scene
from drake_leg.scene.shapes import drake_shape
from drake_leg.scene.views import View

Image = NDArray[np.uint8]  # (height, width, 3), red, green, blue

EDGE = 0.06  # of the picture's width: room around what a scene holds, for what is thick

_ENGINE = "vtk"
# Where lights come from, in the camera's frame (right, down, forwards), and how strong they are.
_LIGHTS = (((-0.6, -0.9, -0.5), 0.8), ((0.9, -0.2, -0.6), 0.4), ((0.1, 0.4, -1.0), 0.5))


@dataclass(frozen=True, kw_only=True)
class _Shot:
    """A camera in its place; the edges of the picture, where nothing is, it leaves out."""

    X_WC: RigidTransform  # its axes point right, down and forwards
    focus: float  # focal length [pixels]
    camera: ColorRenderCamera
    beside: int  # left out on the left and on the right [pixels]
    above: int  # left out above and below [pixels]


class Renderer:
    """Renders one scene in any pose.

    A scene graph by itself, without a diagram: the poses are fixed on its input port.

    Parameters
    ----------
    scene : Scene
        What there is to see.
    width, height : int
        Of the pictures [pixels].
    """

    def __init__(self, scene: Scene, *, width: int, height: int, paper: Paper = LIGHT) -> None:
        self._scene, self._width, self._height = scene, width, height
        self._blank = np.empty((height, width, 3), dtype=np.uint8)
        self._blank[:] = np.round(255.0 * np.array(paper.background))
        self._shot = cache(self._aim)
        self._graph = SceneGraph()
        self._graph.AddRenderer(_ENGINE, MakeRenderEngineVtk(_engine_parameters(paper)))
        self._source = self._graph.RegisterSource("robot")
        self._frames = [
            self._graph.RegisterFrame(self._source, GeometryFrame(f"frame_{index}"))
            for index in range(len(scene.robot.rows) + 1)
        ]
        for index, part in enumerate(scene.parts):
            instance = GeometryInstance(
                RigidTransform(part.X_FP), drake_shape(part.shape), f"{index}: {part.path}"
            )
            properties = PerceptionProperties()
            properties.AddProperty("phong", "diffuse", Rgba(*part.colour, part.opacity))
            instance.set_perception_properties(properties)
            self._graph.RegisterGeometry(self._source, self._frames[part.frame], instance)
        self._context = self._graph.CreateDefaultContext()

    def image(self, X_WF: Array, view: View) -> Image:
        """Take a picture.

        Parameters
        ----------
        X_WF : (n + 1, 4, 4) ndarray
            Poses of the robot's frames, as one row of ``Motion.poses``.

        Returns
        -------
        (height, width, 3) ndarray of uint8
            Red, green, blue.
        """
        poses = FramePoseVector()
        for frame, X in zip(self._frames, X_WF, strict=True):
            poses.set_value(frame, RigidTransform(X))
        self._graph.get_source_pose_port(self._source).FixValue(self._context, poses)
        query = self._graph.get_query_output_port().Eval(self._context)
        shot = self._shot(view)
        seen = query.RenderColorImage(shot.camera, self._graph.world_frame_id(), shot.X_WC)
        image = self._blank.copy()
        rows = slice(shot.above, self._height - shot.above)
        columns = slice(shot.beside, self._width - shot.beside)
        image[rows, columns] = seen.data[:, :, :3]
        return image

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
        shot = self._shot(view)
        middle = np.array([self._width, self._height]) / 2.0
        return middle + _projected(points, shot.X_WC, shot.focus)

    def _aim(self, view: View) -> _Shot:
        framing = self._scene.framing(view)
        aspect = self._width / self._height
        right, up, back = view.axes.T
        axes = RotationMatrix(np.column_stack([right, -up, -back]))
        X_WC = RigidTransform(axes, framing.camera(aspect))
        focus = self._height / 2.0 / math.tan(view.field / 2.0)
        reach = np.abs(_projected(self._scene.held, X_WC, focus)).max(axis=0) + EDGE * self._width
        size = np.array([self._width, self._height])
        beside, above = np.maximum(size / 2.0 - reach, 0.0).astype(int).tolist()
        width, height = self._width - 2 * beside, self._height - 2 * above
        far = framing.distance(aspect) + self._scene.size
        core = RenderCameraCore(
            _ENGINE,
            CameraInfo(width, height, focus, focus, width / 2.0 - 0.5, height / 2.0 - 0.5),
            ClippingRange(far / 100.0, 2.0 * far),
            RigidTransform(),
        )
        camera = ColorRenderCamera(core, False)
        return _Shot(X_WC=X_WC, focus=focus, camera=camera, beside=beside, above=above)


def _projected(points: Array, X_WC: RigidTransform, focus: float) -> Array:
    """Where points of the world are in a picture, from its middle [pixels]."""
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
