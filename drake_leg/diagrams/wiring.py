"""The wires and the plant of a live diagram, read from the diagram itself."""

from __future__ import annotations

from dataclasses import dataclass

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram

from drake_leg.errors import InvalidValueError


@dataclass(frozen=True, kw_only=True)
class Wire:
    """A connection between two blocks of a diagram."""

    source: str  # block
    output: str  # its port
    target: str  # block
    input: str  # its port


def plant_of(diagram: Diagram) -> MultibodyPlant:
    """Find the plant of a diagram.

    Parameters
    ----------
    diagram : Diagram
        Built.

    Returns
    -------
    MultibodyPlant

    Raises
    ------
    InvalidValueError
        If there is none, or more than one.
    """
    plants = [s for s in diagram.GetSystems() if isinstance(s, MultibodyPlant)]
    if len(plants) != 1:
        raise InvalidValueError(f"the diagram has {len(plants)} plants; it must have one")
    return plants[0]


def wires(diagram: Diagram) -> list[Wire]:
    """List the connections between a diagram's own blocks.

    Parameters
    ----------
    diagram : Diagram
        Built.

    Returns
    -------
    list of Wire
        In the order of the target blocks and their ports.
    """
    order = {system.get_name(): index for index, system in enumerate(diagram.GetSystems())}
    connections = sorted(
        diagram.connection_map().items(),
        key=lambda pair: (order[pair[0][0].get_name()], int(pair[0][1])),
    )
    return [
        Wire(
            source=source.get_name(),
            output=source.get_output_port(output).get_name(),
            target=target.get_name(),
            input=target.get_input_port(input_).get_name(),
        )
        for (target, input_), (source, output) in connections
    ]
