"""What can be shown: a robot, a plant, a diagram with one, or the text or file of a model."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

from pydrake.geometry import SceneGraph
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, System

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.robot import Robot
from drake_leg.scene.shown_plant import ShownPlant

LANGUAGES = {"<sdf": "sdf", "<robot": "urdf", "<mujoco": "xml"}  # of a model, and its file's ending
TO_BE_SHOWN = (
    "give a Robot, such as LEG_B or what load_robot returns, a MultibodyPlant, a Diagram with one, "
    "the path of an SDF, URDF or MuJoCo file, or its text"
)

Showable: TypeAlias = ShownPlant | Robot | MultibodyPlant | Diagram | Path | str


def shown(what: Showable, *, title: str | None = None, trace: Sequence[str] = ()) -> ShownPlant:
    """Prepare a robot, a plant, a diagram or a model to be shown, as ``still`` takes it."""
    if isinstance(what, ShownPlant):
        return what
    if isinstance(what, Robot):
        return _shown_robot(what, title, tuple(trace))
    if isinstance(what, MultibodyPlant):
        return ShownPlant(what, title=title, trace=trace)
    if isinstance(what, Diagram):
        plants = list(_systems(what, MultibodyPlant))
        if len(plants) != 1:
            raise InvalidValueError(
                f"the diagram has {len(plants)} plants; pass one with one plant, or a plant alone"
            )
        graph = next(_systems(what, SceneGraph), None)
        return ShownPlant(plants[0], graph and graph.model_inspector(), title=title, trace=trace)
    if isinstance(what, Path | str):
        return _parsed(what, title, trace)
    raise InvalidValueError(f"{shortened(what)} cannot be shown", advice=TO_BE_SHOWN)


@lru_cache(maxsize=32)
def _shown_robot(robot: Robot, title: str | None, trace: tuple[str, ...]) -> ShownPlant:
    found = _parsed(sdf_text(robot), title or robot.title, trace)
    joints = [found.plant.GetJointByName(str(segment.joint)) for segment in robot.moving]
    found.joints = [joint.position_start() for joint in joints]
    found.walks = robot.floating and len(robot.tips) > 1
    return found


def _parsed(model: Path | str, title: str | None, trace: Sequence[str]) -> ShownPlant:
    is_text = isinstance(model, str) and "<" in model
    if not is_text and not os.path.isfile(model):  # noqa: PTH113 - a name of any length
        raise InvalidValueError(
            f"there is no model file {shortened(str(model))}", advice=TO_BE_SHOWN
        )
    plant, graph = MultibodyPlant(time_step=0.0), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(graph)
    parser = Parser(plant)
    try:
        if is_text:
            kinds = [kind for tag, kind in LANGUAGES.items() if tag in str(model)]
            parser.AddModelsFromString(model, kinds[0] if kinds else "sdf")
        else:
            parser.AddModels(str(model))
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split()).removeprefix("error: ")
        raise InvalidValueError(f"Drake refuses the model: {reason}") from None
    return ShownPlant(plant, graph.model_inspector(), title=title, trace=trace)


def _systems(diagram: Diagram, kind: type) -> Iterator[System]:
    """Find the systems of a class, at any depth."""
    for system in diagram.GetSystems():
        if isinstance(system, kind):
            yield system
        elif isinstance(system, Diagram):
            yield from _systems(system, kind)


def shortened(value: object) -> str:
    """Write any value in a sentence, whatever its length."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:40]}...{text[-10:]}"
