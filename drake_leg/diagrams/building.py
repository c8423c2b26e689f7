"""Building a diagram whose blocks are named after a person's robot, too."""

from __future__ import annotations

from collections import Counter

from pydrake.systems.framework import Diagram, DiagramBuilder

from drake_leg.errors import InvalidValueError


def built(builder: DiagramBuilder) -> Diagram:
    """Build a diagram, unless two of its blocks have one name: that would end the process.

    Parameters
    ----------
    builder : DiagramBuilder
        With all blocks and wires.

    Returns
    -------
    Diagram

    Raises
    ------
    InvalidValueError
        If two blocks are called alike.
    """
    names = Counter(system.get_name() for system in builder.GetSystems())
    for name, count in names.items():
        if count > 1:
            raise InvalidValueError(
                f"{name!r} is the name of the robot and of another block of its diagram: "
                "give the robot another name"
            )
    return builder.Build()
