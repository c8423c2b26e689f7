"""Frames of a solid's own, which Simscape places on its geometry or at its center of mass."""

from __future__ import annotations

import re

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, Model

_NAME = re.compile(r"<Name>([^<]*)</Name>")
SHOWN = 20  # in an error


def own_frames(solid: Block) -> tuple[str, ...]:
    """Return the names of the frames that a solid has beside its reference frame R, in order."""
    return tuple(_NAME.findall(str(solid.parameters.get("SerializedFrames", ""))))


def require_no_own_frames(model: Model) -> None:
    """Refuse a model whose solids have frames of their own.

    Raises
    ------
    InvalidValueError
        That lists all of them.
    """
    framed = [
        f"{block.name!r} (SID {block.sid}): {', '.join(own_frames(block))}"
        for block in model.blocks
        if own_frames(block)
    ]
    if not framed:
        return
    listed = framed[:SHOWN]
    if len(framed) > SHOWN:
        listed.append(f"and {len(framed) - SHOWN} more")
    solids = "solid has" if len(framed) == 1 else "solids have"
    raise InvalidValueError(
        "\n  ".join(
            (
                f"{len(framed)} {solids} frames of their own, which are not compared: connect the "
                "reference frame R instead, with a Rigid Transform",
                *listed,
            )
        )
    )
