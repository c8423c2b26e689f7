"""Pictures of a scene by Drake's VTK renderer, which needs no display."""

from __future__ import annotations

import math
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

_ENGINE = "vtk"
# Where lights come from, in the camera's frame (right, down, forwards), and how strong they are.
_LIGHTS = (((-0.6, -0.9, -0.5), 0.8), ((0.9, -0.2, -0.6), 0.4), ((0.1, 0.4, -1.0), 0.5))


class Renderer:
    """Renders one scene in any pose.

    A scene graph by itself, without a diagram: the poses are fixed on its input port.

    Parameters
    ----------
    scene : Scene
        What there is to see.
    width, height : int
        Of the pictures [pixels].
    paper : Paper
        Behind everything.
    """

    def __init__(self, scene: Scene, *, width: int, height: int, paper: Paper = LIGHT) -> None:
        self._scene, self._width, self._height = scene, width, height
        self._framing = cache(scene.framing)
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
        view : View
            From where.

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
        image = query.RenderColorImage(
            self._camera(view), self._graph.world_frame_id(), self._camera_pose(view)
        )
        return np.array(image.data[:, :, :3], dtype=np.uint8)

    def pixels(self, points: Array, view: View) -> Array:
        """Say where points of the world are in a picture.

        Parameters
        ----------
        points : (n, 3) ndarray
            In the world [m].
        view : View
            From where.

        Returns
        -------
        (n, 2) ndarray
            To the right and downwards from the picture's upper left corner [pixels].
        """
        X_WC = self._camera_pose(view)
        in_camera = (points - X_WC.translation()) @ X_WC.rotation().matrix()
        focus = self._height / 2.0 / math.tan(view.field / 2.0)
        middle = np.array([self._width, self._height]) / 2.0
        return np.asarray(middle + focus * in_camera[:, :2] / in_camera[:, 2:])

    def _camera(self, view: View) -> ColorRenderCamera:
        far = self._framing(view).distance(self._width / self._height) + self._scene.size
        core = RenderCameraCore(
            _ENGINE,
            CameraInfo(self._width, self._height, view.field),
            ClippingRange(far / 100.0, 2.0 * far),
            RigidTransform(),
        )
        return ColorRenderCamera(core, False)

    def _camera_pose(self, view: View) -> RigidTransform:
        """Pose of the camera, whose axes point right, down and forwards."""
        right, up, back = view.axes.T
        place = self._framing(view).camera(self._width / self._height)
        return RigidTransform(RotationMatrix(np.column_stack([right, -up, -back])), place)


def _engine_parameters(paper: Paper) -> RenderEngineVtkParams:
    lights = [
        LightParameter(
            type="directional", frame="camera", direction=-np.array(origin), intensity=strength
        )
        for origin, strength in _LIGHTS
    ]
    return RenderEngineVtkParams(default_clear_color=np.array(paper.background), lights=lights)
