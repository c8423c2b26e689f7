"""Mechanical blocks attached to each other's frames: what mechanisms and links are drawn from."""

from __future__ import annotations

from dataclasses import replace

from pydrake.math import RigidTransform
from pydrake.multibody.tree import RigidBody

from drake_leg.drawings.captions import mass_words, transform_words
from drake_leg.drawings.picture import DrawnBlock, Net, Picture
from drake_leg.simulink.bodies import SHAPES

_KINDS = {shape: kind for kind, shape in SHAPES.items()}

Output = tuple[int, int]  # block, and its output


class Chain:
    """Blocks that are attached to each other's frames."""

    def __init__(self) -> None:
        self.blocks: list[DrawnBlock] = []
        self.attached: dict[Output, list[tuple[int, int]]] = {}
        self.labels: dict[Output, list[str]] = {}

    def add(self, block: DrawnBlock, *frames: Output) -> Output:
        """Attach a block to frames; return its own frame, the first one if it has several."""
        index = len(self.blocks)
        self.blocks.append(replace(block, inputs=("",) * len(frames), physical=True))
        for port, frame in enumerate(frames):
            self.attached.setdefault(frame, []).append((index, port))
        return index, 0

    def label(self, frame: Output, *names: str) -> None:
        """Write names at a frame."""
        self.labels.setdefault(frame, []).extend(names)

    def transform(self, frame: Output, X_AB: RigidTransform, what: str) -> Output:
        """Attach a transform to a frame, unless it does nothing."""
        words = transform_words(X_AB)
        if not words:
            return frame
        name = f"Rigid Transform of {what}"
        return self.add(DrawnBlock(name=name, caption=tuple(words), glyph="transform"), frame)

    def picture(self, title: str) -> Picture:
        """Make a picture of the blocks."""
        blocks = [
            replace(block, outputs=("",) * sum(frame[0] == index for frame in self.attached))
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
            for frame, targets in self.attached.items()
        ]
        return Picture(title=title, blocks=tuple(blocks), nets=tuple(nets))


def solid_of(body: RigidBody, shape: str) -> DrawnBlock:
    """Draw the solid of a body; a shape other than brick, cylinder and sphere is a box."""
    caption = (body.name(), _KINDS.get(shape, "Solid"), mass_words(body.default_mass()))
    return solid_block(f"Solid of {body.name()}", caption, shape)


def solid_block(name: str, caption: tuple[str, ...], shape: str) -> DrawnBlock:
    """Draw a solid; its name is unique in its picture."""
    known = shape in _KINDS
    return DrawnBlock(
        name=name,
        caption=caption,
        glyph=shape if known else "solid",
        text=() if known else ("m, I",),
    )


def connection_of(name: str) -> DrawnBlock:
    """Draw a subsystem's connection to the outside, by the name of the frame there."""
    return DrawnBlock(name=name, glyph="connection", text=(name,))
