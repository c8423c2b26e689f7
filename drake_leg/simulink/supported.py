"""The table of blocks: what of each is read, and what becomes of it in a mechanism.

``python -m drake_leg.simulink.supported`` writes the page ``docs/blocks.md``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

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
from drake_leg.simulink.multibody.variable import VARIABLE
from drake_leg.simulink.networks import drives, electrical, mechanical  # noqa: F401 - fill KINDS
from drake_leg.simulink.networks.assembly import KINDS as ELEMENTS
from drake_leg.simulink.networks.ports import LIBRARIES as NETWORKS
from drake_leg.simulink.running.kinds import kinds_of_blocks

HEAD = """# Blocks of Simulink and Simscape

What is known of each kind of block. Every other block of a file is opened, too, and listed by
`inspect` as not known. This page is written by `python -m drake_leg.simulink.supported`.

*Values* are the parameters that `inspect` evaluates, in SI units, with the defaults of those that
a file omits. Other parameters are shown as they stand in the file.
"""

MECHANISM = """
## Simscape Multibody

*Mechanism* tells what the block becomes by `drake-leg sdf` and `view`; what is left out there is
said each time. *In motion* tells what it does when the model runs.
"""

CONTACT_FORCES = """
## Contact Forces Library

These blocks act where the library's own file is not found; where it is, its blocks are read, and
act to rounding alike. The law *Custom*, and its other blocks, take the file.
"""

SIGNALS = """
## Simulink

*In a run* tells what the block does when `drake-leg run` runs a model. A block for which it says
nothing is named as lacking; a value or a table can stand in for it.
"""
_OF_SIGNALS = ("block", "values", "in a run")
_AROUND = {
    **dict.fromkeys(("From", "Goto", "GotoTagVisibility", "ConnectionLabel"), "a wire"),
    **dict.fromkeys(("Connection Label", "Connection Port", "PMIOPort", "SimscapeBus"), "a wire"),
    "SubSystem": "its blocks run; one that is enabled, triggered, called, chosen runs at its times",
    "Signal Builder": "its subsystem runs: its signals are read from the file",
    "Solver Configuration": "nothing: Drake integrates",
}

_PARTS = {
    "World Frame": "the world",
    "Rigid Transform": "two frames of one body",
    "Reference Frame": "a frame",
    "Mechanism Configuration": "gravity",
    "Graphic": "nothing: it has no mass",
    "Inertia": "mass and inertia of a body",
    "File Solid": "a body of given mass, or that of an STL or STEP file; trimesh shows its shape",
    **dict.fromkeys(VARIABLE, "a body, where its sizes and mass are constant, or inputs that are"),
    "Solid": "as Brick, Cylindrical, Spherical, Ellipsoidal, Extruded, Revolved, File Solid",
    "Weld Joint": "two frames of one body; one that senses is a fixed joint",
    "Lead Screw Joint": "a screw joint along z",
    "6-DOF Joint": "a floating base; between connected bodies a sensor",
}
_AXES = {"P": "prismatic", "R": "revolute", "S": "ball"}
_COLUMNS = ("block", "values", "mechanism", "in motion")
_TOUCHING = (
    "Brick Solid", "Cylindrical Solid", "Spherical Solid", "Ellipsoidal Solid", "Extruded Solid",
    "Revolved Solid", "Solid",
)  # fmt: skip
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


_ACTS = "acts"
_HOLDS = "acts; met at the start"
_SENSES = "senses"
_MOVES = "moves: springs, dampers, limits, inputs, sensing"
_IN_MOTION = {
    "Transform Sensor": _SENSES,
    "Inertia Sensor": "senses; principal moments ascend",
    "Spatial Contact Force": "acts, with friction; senses",
    **dict.fromkeys(LIBRARIES["Contact_Forces_Lib"], "acts, with friction; puts out its bus"),
    "External Force and Torque": _ACTS,
    "Internal Force": _ACTS,
    "Spring and Damper Force": "acts; senses",
    "Inverse Square Law Force": "acts; senses",
    "Gravitational Field": _ACTS,
    "Mechanism Configuration": "gravity, constant or an input",
    "Infinite Plane": "touches",
    "Point": "touches",
    "Point Cloud": "touches",
    "Grid Surface": "touches",
    "Disk": "touches",
    "File Solid": "touches with its convex hull",
    "Common Gear Constraint": _ACTS,
    "Bevel Gear Constraint": _ACTS,
    "Rack and Pinion Constraint": _ACTS,
    "Worm and Gear Constraint": _ACTS,
    "Distance Constraint": _HOLDS,
    "Angle Constraint": _HOLDS,
    "Point on Curve Constraint": _HOLDS,
    "Spline": "a curve for points",
    "Weld Joint": "senses what it carries, where nothing else holds its frames together",
    "Lead Screw Joint": "moves: sensing",
    "6-DOF Joint": f"{_MOVES}; between connected bodies it senses, and acts where it has springs",
}


def in_motion(kind: str) -> str:
    """Say what a kind of block of Simscape Multibody does in a mechanism that moves."""
    if kind in _IN_MOTION:
        return _IN_MOTION[kind]
    if in_mechanism(kind) == REFUSED:
        return "–"
    if kind in JOINTS:
        return _MOVES
    if kind in (*FORCES, *CONSTRAINTS):
        return LEFT_OUT
    return "touches" if kind in _TOUCHING else "–"


def in_a_run(kind: str, *, in_network: bool = False) -> str:
    """Say what a kind of block does in a run, by itself or in a network of one dimension.

    It is "–" where it does not run.
    """
    work: Callable[..., None] | None = ELEMENTS.get(kind) if in_network else None
    found = kinds_of_blocks().get(kind)
    if work is None and found is not None:
        work = found.write
    if work is None:
        return _AROUND.get(kind, "–")
    said = (work.__doc__ or "").partition("\n")[0].rstrip(".")
    return f"{said[0].lower()}{said[1:]}" if said else "runs"


def page() -> str:
    """Write the page."""
    lines = [HEAD, MECHANISM, *_table(_COLUMNS, _multibody())]
    lines += [CONTACT_FORCES, *_table(_COLUMNS, _forces_of_contact())]
    lines += [SIGNALS, *_table(_OF_SIGNALS, _rows(BUILT_IN, WITHOUT_PARAMETERS))]
    for title, library in (
        ("Masked blocks of Simulink", "simulink"),
        ("Simscape utilities", "nesl_utility"),
        ("Simscape Foundation", "fl_lib"),
        ("Simscape Electrical", "ee_lib"),
        ("Simscape Battery", "batteryecm_lib"),
        ("Simscape Driveline", "sdl_lib"),
        ("Robotics System Toolbox", "robotcorelib"),
        ("Sources of the DSP System Toolbox", "dspsrcs4"),
        ("Statistics of the DSP System Toolbox", "dspstat3"),
        ("HDL Coder", "hdlsllib"),
        ("ROS Toolbox", "robotroslib"),
        ("Simulink 3D Animation", "vrlib"),
        ("Algorithms of mobile robots", "robotalgslib"),
        ("Rotations of the Aerospace Blockset", "sharedtransform"),
        ("Control System Toolbox", "cstblocks"),
    ):
        rows = _rows(LIBRARIES[library], in_network=library in NETWORKS)
        lines += [f"\n## {title}\n", *_table(_OF_SIGNALS, rows)]
    return "\n".join(lines) + "\n"


def _multibody() -> Iterator[tuple[str, ...]]:
    order = [*JOINTS, *(kind for kind in MULTIBODY if kind not in JOINTS)]
    for kind in order:
        yield kind, _count(MULTIBODY[kind]), in_mechanism(kind), in_motion(kind)


def _forces_of_contact() -> Iterator[tuple[str, ...]]:
    for kind, parameters in LIBRARIES["Contact_Forces_Lib"].items():
        yield kind, _count(parameters), in_mechanism(kind), in_motion(kind)


def _rows(
    kinds: dict[str, Parameters], others: frozenset[str] = frozenset(), *, in_network: bool = False
) -> Iterator[tuple[str, ...]]:
    for kind in sorted({*kinds, *others}, key=str.lower):
        yield kind, _count(kinds.get(kind, ())), in_a_run(kind, in_network=in_network)


def _count(parameters: Parameters) -> str:
    numeric = sum(parameter.numeric for parameter in parameters)
    return str(numeric) if numeric else "–"


def _table(head: tuple[str, ...], rows: Iterator[tuple[str, ...]]) -> list[str]:
    lines = [head, tuple("---" for _ in head), *rows]
    return [f"| {' | '.join(cells)} |" for cells in lines]


if __name__ == "__main__":
    print(page(), end="")
