"""A scene in Meshcat, which a browser shows."""

from __future__ import annotations

import logging
import math
import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from pydrake.geometry import Meshcat, MeshcatParams, Rgba
from pydrake.math import RigidTransform

from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.batches import Array
from drake_leg.scene.paper import LIGHT
from drake_leg.scene.parts import Part
from drake_leg.scene.scene import Scene
from drake_leg.scene.shapes import drake_shape

LOCALHOST = "localhost"
SHADE = (0.86, 0.87, 0.90)  # of the background below
ROOT = "robot"  # Meshcat puts it under /drake
_SMALLEST_PORT, _LARGEST_PORT = 1024, 65535


class MeshcatError(DrakeLegError):
    """Meshcat cannot listen where it was told to."""


def open_meshcat(*, host: str = LOCALHOST, port: int | None = None) -> Meshcat:
    """Start a Meshcat server with an empty world: no grid, no axes.

    Parameters
    ----------
    host : str
        Name or address to listen at; the default serves this machine only, ``*`` all that can
        reach it.
    port : int, optional
        To listen at; by default the first that is free from 7000 on.

    Returns
    -------
    Meshcat

    Raises
    ------
    MeshcatError
        If the port is taken or no port, or the host is not one of this machine's.
    """
    if port is not None and not _SMALLEST_PORT <= port <= _LARGEST_PORT:
        raise MeshcatError(f"--port is {port}; it must be in {_SMALLEST_PORT} ... {_LARGEST_PORT}")
    _require_host(host)
    settings = MeshcatParams()
    settings.host = host
    settings.port = port
    settings.show_stats_plot = False
    try:
        with _quiet():
            meshcat = Meshcat(settings)
    except RuntimeError:
        where = f"{host}, port {port}" if port is not None else f"{host}, ports 7000 to 7999"
        raise MeshcatError(
            f"Meshcat cannot listen at {where}: the port is taken, or the host is not this "
            "machine's; choose another --port or --host"
        ) from None
    for path in ("/Grid", "/Axes"):
        meshcat.SetProperty(path, "visible", False)
    return meshcat


def draw(meshcat: Meshcat, scene: Scene) -> None:
    """Send all parts of a scene.

    Parameters
    ----------
    meshcat : Meshcat
        To be drawn in.
    scene : Scene
        What there is to see.
    """
    for part in scene.parts:
        draw_part(meshcat, part)


def brighten(meshcat: Meshcat) -> None:
    """Make the background light, in place of Meshcat's grey.

    Parameters
    ----------
    meshcat : Meshcat
        Whose background it is.
    """
    for edge, colour in (("top_color", LIGHT.background), ("bottom_color", SHADE)):
        meshcat.SetProperty("/Background/<object>", edge, colour)


def draw_part(meshcat: Meshcat, part: Part) -> None:
    """Send one part.

    Parameters
    ----------
    meshcat : Meshcat
        To be drawn in.
    part : Part
        Replaces one with the same path on the same frame.
    """
    path = f"{frame_path(part.frame)}/{part.path}"
    meshcat.SetObject(path, drake_shape(part.shape), Rgba(*part.colour, part.opacity))
    meshcat.SetTransform(path, RigidTransform(part.X_FP))


def move(meshcat: Meshcat, X_WF: Array) -> None:
    """Put the robot into a posture.

    Parameters
    ----------
    meshcat : Meshcat
        With the robot drawn in it.
    X_WF : (n + 1, 4, 4) ndarray
        Poses of its frames, as one row of ``Motion.poses``.
    """
    for index, X in enumerate(X_WF):
        meshcat.SetTransform(frame_path(index), RigidTransform(X))


def frame_path(index: int) -> str:
    """Where the parts of a frame are in Meshcat's tree.

    Parameters
    ----------
    index : int
        Of the frame in the table; 0 is the base.

    Returns
    -------
    str
    """
    return f"{ROOT}/frame_{index}"


def look(meshcat: Meshcat, place: Sequence[float], target: Sequence[float], field: float) -> None:
    """Put the camera somewhere.

    Parameters
    ----------
    meshcat : Meshcat
        Whose browsers look.
    place, target : (3,) sequence of float
        Of the camera and of what it looks at, in the world [m].
    field : float
        Of view, from the lower to the upper edge [rad].
    """
    away = math.dist(place, target)
    for name, value in (("fov", math.degrees(field)), ("near", away / 50.0), ("far", 4.0 * away)):
        meshcat.SetProperty("/Cameras/default/rotated/<object>", name, value)
    meshcat.SetCameraPose(place, target)


def _require_host(host: str) -> None:
    """Refuse a host that is not this machine: Meshcat would try each of its thousand ports."""
    if host == "*":
        return
    try:
        places = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)
    except (OSError, ValueError):
        raise MeshcatError(
            f"Meshcat cannot listen at {host!r}: no machine of this name is known; "
            "choose another --host"
        ) from None
    if not any(_bindable(family, address) for family, _, _, _, address in places):
        raise MeshcatError(
            f"Meshcat cannot listen at {host}: it is not an address of this machine; "
            "choose another --host"
        )


def _bindable(family: int, address: tuple[object, ...]) -> bool:
    try:
        with socket.socket(family, socket.SOCK_STREAM) as trial:
            trial.bind(address)
    except OSError:
        return False
    return True


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Drake from announcing Meshcat's address: the command line does that."""
    logger = logging.getLogger("drake")
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)
