"""Draws a diagram: its signals, the mechanism inside its plant, or one link."""

from __future__ import annotations

from itertools import count, takewhile

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram

from drake_leg.arguments import checked
from drake_leg.colours import Background
from drake_leg.diagrams.wiring import plant_of
from drake_leg.pictures.drawing import Drawing, draw
from drake_leg.pictures.of_diagram import diagram_picture
from drake_leg.pictures.of_plant import link_picture, mechanism_picture
from drake_leg.pictures.of_simulink import model_pictures
from drake_leg.pictures.svg import ALL, MECHANISM, SIGNALS, Picture
from drake_leg.robot.robot import Robot, frame_name
from drake_leg.simulink.listing import printable
from drake_leg.simulink.model import Model
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
    """Read the pictures of a run's diagram: its signals, its mechanism, both, or one link.

    ``robot`` is what the plant was built from and has the shapes of its solids; without it they are
    boxes.

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


@checked
def block_diagram(
    diagram: Diagram | Model,
    *,
    part: str | None = None,
    title: str | None = None,
    robot: Robot | None = None,
    scopes: bool = True,
    accelerations: bool = True,
    background: Background = "auto",
) -> Drawing:
    """Draw any Drake diagram as Simulink would: blocks with ports, wires at right angles.

    The picture is read from the live diagram, so it shows what is simulated. A Simulink model that
    was read from its file is drawn in the same style.

    Parameters
    ----------
    diagram : Diagram or Model
        Built; or from ``drake_leg.simulink.reader.read_model``.
    part : str, optional
        "signals": the diagram's own blocks and wires. "mechanism": the bodies and joints inside
        its plant, as Simscape draws them. "all": both. Or the name of a link, as "femur". By
        default the signals of a diagram, and all of a Simulink model.
    title : str, optional
        By default the name of the diagram, or of its plant.
    robot : Robot, optional
        What the plant was built from. It gives the shapes of the solids in a mechanism; without
        it they are boxes.
    scopes : bool
        Whether logs are drawn.
    accelerations : bool
        Whether wires that only carry accelerations are drawn.
    background : {"auto", "white", "none"}
        "auto" is white or dark as the reader's system is; "none" is for light pages.

    Returns
    -------
    Drawing
        SVG text in ``drawing.svg``; a notebook shows it as a picture.

    Raises
    ------
    InvalidValueError
        If there is no such part, or a mechanism is asked for and the diagram has no plant.

    Examples
    --------
    >>> from drake_leg import PENDULUM, PendulumConfig, block_diagram, build_pendulum
    >>> diagram = build_pendulum(PendulumConfig(robot=PENDULUM))
    >>> drawing = block_diagram(diagram, part="all", robot=PENDULUM)
    >>> drawing.svg.startswith("<svg")
    True
    """
    if isinstance(diagram, Model):
        drawn = model_pictures(diagram, title=title or printable(diagram.name), part=part or ALL)
        return draw(*drawn, background=background)
    heading = title or diagram.get_name() or _plant_name(diagram) or "diagram"
    if part in (None, SIGNALS):
        picture = diagram_picture(
            diagram, title=heading, scopes=scopes, accelerations=accelerations
        )
        return draw(picture, background=background)
    pictures = run_pictures(
        diagram,
        robot,
        title=heading,
        part=part or SIGNALS,
        scopes=scopes,
        accelerations=accelerations,
    )
    return draw(*pictures, background=background)


def _plant_name(diagram: Diagram) -> str:
    """Return the name of the diagram's first plant, empty if it has none."""
    plants = (s for s in diagram.GetSystems() if isinstance(s, MultibodyPlant))
    return next((str(plant.get_name()) for plant in plants), "")
