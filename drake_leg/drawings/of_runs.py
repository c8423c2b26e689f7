"""The pictures of a run: its signals, the mechanism inside its plant, one link of it."""

from __future__ import annotations

from itertools import count, takewhile

from pydrake.systems.framework import Diagram

from drake_leg.diagrams.wiring import plant_of
from drake_leg.drawings.of_diagram import diagram_picture
from drake_leg.drawings.of_link import link_picture
from drake_leg.drawings.of_plant import mechanism_picture
from drake_leg.drawings.picture import ALL, MECHANISM, SIGNALS, Picture
from drake_leg.names import frame_name
from drake_leg.robot import Robot
from drake_leg.systems.frame_sensor import FrameSensor


def run_pictures(
    diagram: Diagram,
    robot: Robot | None = None,
    *,
    title: str,
    part: str = ALL,
    scopes: bool = True,
    accelerations: bool = True,
) -> tuple[Picture, ...]:
    """Read the pictures of what a run simulates: signals, mechanism, all (both), or a link's.

    ``robot`` is what the plant was built from: it tells the shapes of the solids, which are boxes
    without it.

    Raises
    ------
    InvalidValueError
        If there is no such part.
    """
    plant = plant_of(diagram)
    shapes = {
        segment.link.name: type(segment.link.solid.shape).__name__.lower()
        for segment in (robot.segments if robot else ())
        if segment.link is not None and segment.link.solid is not None
    }
    if part not in (SIGNALS, MECHANISM, ALL):
        heading = f"{title}: the link {part}"
        return (link_picture(plant, part, title=heading, shape=shapes.get(part, "solid")),)
    pictures = []
    if part != MECHANISM:
        pictures.append(
            diagram_picture(
                diagram, title=f"{title}: signals", scopes=scopes, accelerations=accelerations
            )
        )
    if part != SIGNALS:
        sensing = any(isinstance(system, FrameSensor) for system in diagram.GetSystems())
        frames = takewhile(plant.HasFrameNamed, map(frame_name, count()))
        pictures.append(
            mechanism_picture(
                plant,
                title=f"{title}: mechanism, inside the plant",
                shapes=shapes,
                sensed=list(frames)[-1] if sensing else None,
            )
        )
    return tuple(pictures)
