"""Mechanical blocks attached to each other's frames, and their captions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from pydrake.math import RigidTransform
from pydrake.multibody.tree import RigidBody

from drake_leg.pictures.svg import DrawnBlock, Net, Picture, wrapped
from drake_leg.simulink.mechanism import SHAPES

CAPTION_WIDTH = 84.0  # [px], of a mechanical block
SIGNAL_WIDTH = 88.0  # [px], of a signal block
SAME = 1e-12  # [m], and of a rotation matrix: what is nearer coincides
_KINDS = {shape: kind for kind, shape in SHAPES.items()}
Output = tuple[int, int]  # block, and its output


def number_text(value: float) -> str:
    """Write a number with four digits and a true minus sign."""
    return f"{value:.4g}".replace("-", "−")


def values_text(values: Iterable[float]) -> str:
    """Write one number, or how many different ones there are: ``0.5``, ``[3]``."""
    shown = [number_text(value) for value in values]
    return shown[0] if len(set(shown)) == 1 else f"[{len(shown)}]"


def gravity_words(gravity: Sequence[float]) -> tuple[str, ...]:
    """Write a vector of gravity (3,) [m/s^2]."""
    gx, gy, gz = gravity
    text = f"gravity {gx:g}, {gy:g}, {gz:.7g} m/s²".replace("-", "−")
    return wrapped(text, CAPTION_WIDTH + 10.0)


def mass_words(mass: float) -> str:
    """Write a mass [kg] in grams, from 1 kg on in kilograms."""
    return f"{mass:.4g} kg" if mass >= 1.0 else f"{1e3 * mass:.4g} g"


def damping_words(damping: float, *, turning: bool) -> tuple[str, ...]:
    """Describe a joint's damping, revolute [N*m*s/rad] or prismatic [N*s/m]; empty without any."""
    if damping <= 0.0:
        return ()
    return f"damping {damping:.4g}", "N·m·s/rad" if turning else "N·s/m"


def spring_words(stiffness: float, rest: float, *, turning: bool) -> tuple[str, ...]:
    """Describe a joint's spring, [N*m/rad] and [rad] or [N/m] and [m]; empty without any."""
    if stiffness <= 0.0:
        return ()
    if turning:
        return f"spring {stiffness:.4g} N·m/rad", f"at rest at {number_text(math.degrees(rest))}°"
    return f"spring {stiffness:.4g} N/m", f"at rest at {number_text(1e3 * rest)} mm"


def transform_words(X_AB: RigidTransform) -> list[str]:
    """Describe a transform: translation along the old axes, then rotation; empty if identity."""
    words: list[str] = []
    for axis, value in zip("xyz", X_AB.translation(), strict=True):
        if abs(value) > SAME:
            words += [f"{number_text(1e3 * value)} mm", f"along {axis}"]
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
        """Attach a transform to a frame, unless it is the identity."""
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
