"""The table of blocks: what of each is read, and what becomes of it in a mechanism.

``python -m drake_leg.simulink.supported`` writes the page ``docs/blocks.md``.
"""

from __future__ import annotations

from collections.abc import Iterator

from drake_leg.simulink.catalogue import (
    BUILT_IN,
    JOINTS,
    LIBRARIES,
    MULTIBODY,
    PRIMITIVES,
    WITHOUT_PARAMETERS,
    Parameters,
)
from drake_leg.simulink.multibody.connections import CONSTRAINTS, FORCES, PLACES, SOLIDS
from drake_leg.simulink.multibody.joints import SINGLE

HEAD = """# Blocks of Simulink and Simscape

What is known of each kind of block. Every other block of a file is opened, too, and listed by
`inspect` as not known. This page is written by `python -m drake_leg.simulink.supported`.

*Values* are the parameters that `inspect` evaluates, in SI units, with the defaults of those that
a file omits. Other parameters are shown as they stand in the file.
"""

MECHANISM = """
## Simscape Multibody

*Mechanism* tells what the block becomes by `drake-leg sdf` and `view`. What is left out is said
each time.
"""

_PARTS = {
    "World Frame": "the world",
    "Rigid Transform": "two frames of one body",
    "Reference Frame": "a frame",
    "Mechanism Configuration": "gravity",
    "Graphic": "nothing: it has no mass",
    "Inertia": "mass and inertia of a body",
    "File Solid": "a body of given mass; its shape is shown by trimesh",
    "Solid": "as Brick, Cylindrical, Spherical, Ellipsoidal, Extruded, Revolved, File Solid",
    "Weld Joint": "two frames of one body",
    "6-DOF Joint": "a floating base; between connected bodies a sensor",
}
_AXES = {"P": "prismatic", "R": "revolute", "S": "ball"}
LEFT_OUT = "left out, by name"
REFUSED = "not built: the model is refused, with its name"


def in_mechanism(kind: str) -> str:
    """Say what a kind of block of Simscape Multibody becomes in a mechanism."""
    if kind in _PARTS:
        return _PARTS[kind]
    names = SINGLE.get(kind) or PRIMITIVES.get(kind)
    if names:
        axes = [_AXES[name[0]] + (f" {name[1]}" if name != "Sph" else "") for name in names.split()]
        return f"joints: {', '.join(axes)}"
    if kind in SOLIDS:
        return "a body, with its own frames; mass by exact formulas or as given"
    if kind in (*FORCES, *CONSTRAINTS):
        return LEFT_OUT
    return "a frame" if kind in PLACES else REFUSED


def page() -> str:
    """Write the page."""
    lines = [HEAD, MECHANISM, *_table(("block", "values", "mechanism"), _multibody())]
    lines += ["\n## Simulink\n", *_table(("block", "values"), _rows(BUILT_IN, WITHOUT_PARAMETERS))]
    for title, library in (
        ("Masked blocks of Simulink", "simulink"),
        ("Simscape utilities", "nesl_utility"),
        ("Simscape Foundation", "fl_lib"),
    ):
        lines += [f"\n## {title}\n", *_table(("block", "values"), _rows(LIBRARIES[library]))]
    return "\n".join(lines) + "\n"


def _multibody() -> Iterator[tuple[str, ...]]:
    order = [*JOINTS, *(kind for kind in MULTIBODY if kind not in JOINTS)]
    for kind in order:
        yield kind, _count(MULTIBODY[kind]), in_mechanism(kind)


def _rows(
    kinds: dict[str, Parameters], others: frozenset[str] = frozenset()
) -> Iterator[tuple[str, ...]]:
    for kind in sorted({*kinds, *others}, key=str.lower):
        yield kind, _count(kinds.get(kind, ()))


def _count(parameters: Parameters) -> str:
    numeric = sum(parameter.numeric for parameter in parameters)
    return str(numeric) if numeric else "–"


def _table(head: tuple[str, ...], rows: Iterator[tuple[str, ...]]) -> list[str]:
    lines = [head, tuple("---" for _ in head), *rows]
    return [f"| {' | '.join(cells)} |" for cells in lines]


if __name__ == "__main__":
    print(page(), end="")
