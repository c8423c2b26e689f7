"""Mechanical blocks hung on each other's frames: what a mechanism and a link are drawn from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pydrake.math import RigidTransform
from pydrake.multibody.tree import RigidBody

from drake_leg.drawings.picture import Block, Net, Picture

SAME = 1e-12  # [m], and of a rotation matrix: what is nearer coincides

Output = tuple[int, int]  # block, and its output


class Chain:
    """Blocks that are hung on each other's frames."""

    def __init__(self) -> None:
        self.blocks: list[Block] = []
        self.hung: dict[Output, list[tuple[int, int]]] = {}
        self.labels: dict[Output, list[str]] = {}

    def add(self, block: Block, *frames: Output) -> Output:
        """Hang a block on frames; return its own frame."""
        index = len(self.blocks)
        self.blocks.append(replace(block, inputs=("",) * len(frames), physical=True))
        for port, frame in enumerate(frames):
            self.hung.setdefault(frame, []).append((index, port))
        return index, 0

    def label(self, frame: Output, *names: str) -> None:
        """Write names at a frame."""
        self.labels.setdefault(frame, []).extend(names)

    def transform(self, frame: Output, X_AB: RigidTransform, what: str) -> Output:
        """Hang a transform on a frame, where it is one."""
        words = words_of(X_AB)
        if not words:
            return frame
        name = f"Rigid Transform of {what}"
        return self.add(Block(name=name, caption=tuple(words), glyph="transform"), frame)

    def picture(self, title: str) -> Picture:
        """Return what was hung together."""
        blocks = [
            replace(block, outputs=("",) if (index, 0) in self.hung else ())
            for index, block in enumerate(self.blocks)
        ]
        nets = [
            Net(
                source=frame,
                targets=tuple(targets),
                label=", ".join(self.labels.get(frame, ())),
                physical=True,
                arrow=False,
                wide=True,
            )
            for frame, targets in self.hung.items()
        ]
        return Picture(title=title, blocks=tuple(blocks), nets=tuple(nets))


def solid_of(body: RigidBody, shape: str) -> Block:
    """Draw the solid of a body.

    Parameters
    ----------
    body : RigidBody
        Its mass is written.
    shape : str
        "brick", "cylinder", "sphere"; anything else is a box.

    Returns
    -------
    Block
    """
    kind = {"brick": "Brick Solid", "cylinder": "Cylindrical Solid", "sphere": "Spherical Solid"}
    mass = f"{1e3 * body.default_mass():.4g} g"
    return Block(
        name=f"Solid of {body.name()}",
        caption=(body.name(), kind.get(shape, "Solid"), mass),
        glyph=shape if shape in kind else "solid",
        text=() if shape in kind else ("m, I",),
    )


def connection_of(name: str) -> Block:
    """Draw a subsystem's connection to the outside.

    Parameters
    ----------
    name : str
        Of the frame that it hands out.

    Returns
    -------
    Block
    """
    return Block(name=name, glyph="connection", text=(name,))


def words_of(X_AB: RigidTransform) -> list[str]:
    """Say what a transform does: translation in the old axes, then rotation.

    Parameters
    ----------
    X_AB : RigidTransform
        From the new frame B to the old frame A.

    Returns
    -------
    list of str
        Line by line; empty where it does nothing.
    """
    words: list[str] = []
    for axis, value in zip("xyz", X_AB.translation(), strict=True):
        if abs(value) > SAME:
            words += [f"{1e3 * value:.4g} mm".replace("-", "−"), f"along {axis}"]
    R_AB = X_AB.rotation()
    if not RigidTransform(R_AB).IsNearlyEqualTo(RigidTransform(), SAME):
        turn = R_AB.ToAngleAxis()
        words.append(f"{math.degrees(turn.angle()):.4g}° about {_axis(turn.axis())}")
    return words


def _axis(axis: Sequence[float]) -> str:
    """Name a unit vector: x, −x, or its numbers."""
    for letter, part in zip("xyz", axis, strict=True):
        if abs(abs(part) - 1.0) < 1e-9:
            return letter if part > 0.0 else f"−{letter}"
    return f"({', '.join(f'{part:.3g}' for part in axis)})"
