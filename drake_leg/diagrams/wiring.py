"""Builds a diagram, and finds its plant and its wires."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder, System

from drake_leg.errors import InvalidValueError


@dataclass(frozen=True, kw_only=True)
class LiveWire:
    """A connection between two blocks of a diagram."""

    source: str  # block
    output: str  # its port
    target: str  # block
    input: str  # its port


def all_blocks(diagram: Diagram) -> Iterator[System]:
    """Iterate over the blocks of a diagram, and of the diagrams inside it."""
    for system in diagram.GetSystems():
        yield system
        if isinstance(system, Diagram):
            yield from all_blocks(system)


def built(builder: DiagramBuilder) -> Diagram:
    """Build a diagram, unless two of its blocks have the same name: that would end the process.

    Raises
    ------
    InvalidValueError
        If two blocks have the same name.
    """
    names = Counter(system.get_name() for system in builder.GetSystems())
    for name, count in names.items():
        if count > 1:
            raise InvalidValueError(
                f"{name!r} is the name of the robot and of another block of its diagram: "
                "give the robot another name"
            )
    return builder.Build()


def plant_of(diagram: Diagram) -> MultibodyPlant:
    """Find the plant of a diagram.

    Raises
    ------
    InvalidValueError
        If there is none, or more than one.
    """
    plants = [s for s in diagram.GetSystems() if isinstance(s, MultibodyPlant)]
    if len(plants) != 1:
        raise InvalidValueError(f"the diagram has {len(plants)} plants; it must have one")
    return plants[0]


def wires(diagram: Diagram) -> list[LiveWire]:
    """List the connections between a diagram's blocks, by the target blocks and their ports."""
    order = {system.get_name(): index for index, system in enumerate(diagram.GetSystems())}
    connections = sorted(
        diagram.connection_map().items(),
        key=lambda pair: (order[pair[0][0].get_name()], int(pair[0][1])),
    )
    return [
        LiveWire(
            source=source.get_name(),
            output=source.get_output_port(output).get_name(),
            target=target.get_name(),
            input=target.get_input_port(input_).get_name(),
        )
        for (target, input_), (source, output) in connections
    ]
