"""A scene in Meshcat, which pages are made from."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from pydrake.geometry import Meshcat, MeshcatParams, Rgba
from pydrake.math import RigidTransform

from drake_leg.errors import DrakeLegError
from drake_leg.scene.scene import Scene
from drake_leg.scene.shapes import drake_shape

ROOT = "robot"  # Meshcat puts it under /drake


class MeshcatError(DrakeLegError):
    """Meshcat cannot listen."""


def open_meshcat() -> Meshcat:
    """Start a Meshcat with an empty world: no grid, no axes; pages are made from it.

    Returns
    -------
    Meshcat
        Which listens, on this machine only, as long as it lives.

    Raises
    ------
    MeshcatError
        If there is no free port.
    """
    settings = MeshcatParams()
    settings.host = "localhost"
    settings.show_stats_plot = False
    try:
        with _quiet():
            meshcat = Meshcat(settings)
    except RuntimeError:
        raise MeshcatError(
            "Meshcat, which pages are made from, finds none of the ports 7000 to 7999 free"
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
        path = f"{frame_path(part.frame)}/{part.path}"
        meshcat.SetObject(path, drake_shape(part.shape), Rgba(*part.colour, part.opacity))
        meshcat.SetTransform(path, RigidTransform(part.X_FP))


def frame_path(index: int) -> str:
    """Where the parts of a frame are in Meshcat's tree.

    Parameters
    ----------
    index : int
        Of the frame in the table; 0 is the base.
    """
    return f"{ROOT}/frame_{index}"


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Drake from announcing Meshcat's address: nobody needs it."""
    logger = logging.getLogger("drake")
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)
