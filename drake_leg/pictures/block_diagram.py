"""Draws a diagram: its signals as Simulink would, the mechanism inside its plant, or one link."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import count, takewhile

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, System
from pydrake.systems.primitives import (
    Adder,
    ConstantVectorSource,
    Demultiplexer,
    Gain,
    Integrator,
    MatrixGain,
    Multiplexer,
    Sine,
    VectorLogSink,
)

from drake_leg.arguments import checked, printable
from drake_leg.colours import Background
from drake_leg.diagrams.wiring import LiveWire, plant_of, wires
from drake_leg.pictures.drawing import Drawing, draw
from drake_leg.pictures.mechanical import SIGNAL_WIDTH, link_picture, mechanism_picture, values_text
from drake_leg.pictures.svg import (
    ALL,
    MECHANISM,
    SIGNALS,
    DrawnBlock,
    Net,
    Picture,
    spaced,
    wrapped,
)
from drake_leg.robot.robot import Robot, frame_name
from drake_leg.simulink.model import Model
from drake_leg.systems.closed_loop import DrivenLoops, FreeLoops
from drake_leg.systems.frame_sensor import FrameSensor

Output = tuple[str, str]  # block, and its output

_PRETTY = {
    "qdot": "q\u0307",
    "qddot": "q\u0308",
    "det_j": "det J",
    "angular_velocity": "ω",
    "generalized_acceleration": "acceleration",
}
_NAMELESS = re.compile(r"[uy]\d+|data")
_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
TO_PHYSICAL, TO_SIGNAL = "Simulink-PS", "PS-Simulink"  # how converters' names begin
ACCELERATIONS = ("a", "qddot")  # inputs that only a motion's acceleration feeds
_GLYPHS: dict[type, str] = {
    ConstantVectorSource: "constant",
    Demultiplexer: "demux",
    Gain: "gain",
    Integrator: "integrator",
    MatrixGain: "gain",
    Multiplexer: "mux",
    MultibodyPlant: "plant",
    Sine: "sine",
    VectorLogSink: "scope",
}
_INSIDE = {
    "InverseJacobian": ("J⁻¹",),
    "DiscreteTimeIntegrator": ("h / (z - 1)",),
    "GaitBlock": ("gait",),
    "PrescribedMotion": ("inverse", "dynamics"),
    "FrameSensor": ("6 DOF",),
    "EnergySensor": ("T + V",),
}
# Blocks of the mechanical side, drawn as Simscape's are.
_PHYSICAL = ("MultibodyPlant", "PrescribedMotion", "FrameSensor", "EnergySensor")


def run_pictures(
    diagram: Diagram,
    robot: Robot | None = None,
    *,
    title: str,
    part: str = ALL,
    scopes: bool = True,
    accelerations: bool = True,
) -> tuple[Picture, ...]:
    """Read the pictures of a run's diagram: its signals, its mechanism, both, or one link.

    ``robot`` is what the plant was built from and has the shapes of its solids; without it they are
    boxes.

    Raises
    ------
    InvalidValueError
        If there is no such part.
    """
    plant, place = _mechanism(diagram)
    shapes = {
        segment.link.name: type(segment.link.solid.shape).__name__.lower()
        for segment in (robot.segments if robot else ())
        if segment.link is not None and segment.link.solid is not None
    }
    if part not in (SIGNALS, MECHANISM, ALL):
        heading = f"{title}: the link {part}"
        return (link_picture(plant, part, title=heading, shape=shapes.get(part, "solid")),)
    pictures = []
    if part != MECHANISM:
        pictures.append(
            diagram_picture(
                diagram, title=f"{title}: signals", scopes=scopes, accelerations=accelerations
            )
        )
    if part != SIGNALS:
        sensing = any(isinstance(system, FrameSensor) for system in diagram.GetSystems())
        frames = takewhile(plant.HasFrameNamed, map(frame_name, count()))
        pictures.append(
            mechanism_picture(
                plant,
                title=f"{title}: mechanism, {place}",
                shapes=shapes,
                sensed=list(frames)[-1] if sensing else None,
            )
        )
    return tuple(pictures)


def _mechanism(diagram: Diagram) -> tuple[MultibodyPlant, str]:
    """Find the plant of a diagram, and where it is: blocks of closed loops have one inside."""
    for system in diagram.GetSystems():
        if isinstance(system, FreeLoops | DrivenLoops):
            cuts = ", ".join(system.loops.cuts)
            return system.tree, f"inside {pretty(system.get_name())}: the tree, cut at {cuts}"
    return plant_of(diagram), "inside the plant"


@checked
def block_diagram(
    diagram: Diagram | Model,
    *,
    part: str | None = None,
    title: str | None = None,
    robot: Robot | None = None,
    scopes: bool = True,
    accelerations: bool = True,
    background: Background = "auto",
) -> Drawing:
    """Draw any Drake diagram as Simulink would: blocks with ports, wires at right angles.

    The picture is read from the live diagram, so it shows what is simulated. A Simulink model that
    was read from its file is drawn in the same style.

    Parameters
    ----------
    diagram : Diagram or Model
        Built; or from ``drake_leg.simulink.reader.read_model``.
    part : str, optional
        "signals": the diagram's own blocks and wires. "mechanism": the bodies and joints inside
        its plant, as Simscape draws them. "all": both. Or the name of a link, as "femur". By
        default the signals of a diagram, and all of a Simulink model.
    title : str, optional
        By default the name of the diagram, or of its plant.
    robot : Robot, optional
        What the plant was built from. It gives the shapes of the solids in a mechanism; without
        it they are boxes.
    scopes : bool
        Whether logs are drawn.
    accelerations : bool
        Whether wires that only carry accelerations are drawn.
    background : {"auto", "white", "none"}
        "auto" is white or dark as the reader's system is; "none" is for light pages.

    Returns
    -------
    Drawing
        SVG text in ``drawing.svg``; a notebook shows it as a picture.

    Raises
    ------
    InvalidValueError
        If there is no such part, or a mechanism is asked for and the diagram has no plant.

    Examples
    --------
    >>> from drake_leg import PENDULUM, PendulumConfig, block_diagram, build_pendulum
    >>> diagram = build_pendulum(PendulumConfig(robot=PENDULUM))
    >>> drawing = block_diagram(diagram, part="all", robot=PENDULUM)
    >>> drawing.svg.startswith("<svg")
    True
    """
    if isinstance(diagram, Model):
        from drake_leg.pictures.of_simulink import model_pictures  # slow to load

        drawn = model_pictures(diagram, title=title or printable(diagram.name), part=part or ALL)
        return draw(*drawn, background=background)
    heading = title or diagram.get_name() or _plant_name(diagram) or "diagram"
    if part in (None, SIGNALS):
        picture = diagram_picture(
            diagram, title=heading, scopes=scopes, accelerations=accelerations
        )
        return draw(picture, background=background)
    pictures = run_pictures(
        diagram,
        robot,
        title=heading,
        part=part or SIGNALS,
        scopes=scopes,
        accelerations=accelerations,
    )
    return draw(*pictures, background=background)


def _plant_name(diagram: Diagram) -> str:
    """Return the name of the diagram's first plant, empty if it has none."""
    plants = (s for s in diagram.GetSystems() if isinstance(s, MultibodyPlant))
    return next((str(plant.get_name()) for plant in plants), "")


def pretty(name: str) -> str:
    """Write a port's name as a symbol or as words; empty if it has only a number."""
    if _NAMELESS.fullmatch(name):
        return ""
    return _PRETTY.get(name, name.replace("_", " "))


def _of_block(port: str, block: str) -> str:
    """Leave out a plant's name from the names of the ports of its only robot."""
    return port.removeprefix(f"{block}_")


def signal_names(systems: Mapping[str, System], shown: Sequence[LiveWire]) -> dict[Output, str]:
    """Name the signals of outputs that have no name.

    A signal is named after the input that it feeds. A signal into a Mux, or out of a Demux, is
    named after the vector, with an index.
    """
    named: dict[Output, str] = {}
    for wire in shown:
        name = pretty(_of_block(wire.input, wire.target))
        if not pretty(wire.output) and name:
            named.setdefault((wire.source, wire.output), name)
    for wire in shown:
        if wire.output == "state" and isinstance(systems[wire.target], Demultiplexer):
            named.setdefault((wire.target, "y0"), "q")
            named.setdefault((wire.target, "y1"), "w")  # as a joint's port is named in Simscape
        elif isinstance(systems[wire.target], Demultiplexer):
            whole = pretty(wire.output) or named.get((wire.source, wire.output), "")
            outputs = systems[wire.target].num_output_ports()
            width = systems[wire.source].GetOutputPort(wire.output).size()
            for place in range(outputs if whole and outputs == width else 0):
                named.setdefault((wire.target, f"y{place}"), f"{whole}{_sub(place)}")
    for wire in shown:
        target = systems[wire.target]
        whole = named.get((wire.target, "y0"), "")
        joins = isinstance(target, Multiplexer) and not pretty(wire.output)
        if joins and whole and target.num_input_ports() == target.get_output_port(0).size():
            place = int(wire.input.removeprefix("u"))
            named.setdefault((wire.source, wire.output), f"{whole}{_sub(place)}")
    return {end: name for end, name in named.items() if not pretty(end[1])}


def _sub(place: int) -> str:
    return str(place + 1).translate(_SUBSCRIPTS)


def diagram_picture(
    diagram: Diagram, *, title: str, scopes: bool = True, accelerations: bool = True
) -> Picture:
    """Read a diagram's own blocks and wires, not yet laid out.

    Without ``scopes`` the logs are left out; without ``accelerations`` the wires to inputs ``a``
    and ``qddot``, and what only they need. A SceneGraph is part of its plant.
    """
    systems = {system.get_name(): system for system in diagram.GetSystems()}
    shown = [w for w in wires(diagram) if not _is_of_geometry(systems, w)]
    if not scopes:
        shown = [w for w in shown if not isinstance(systems[w.target], VectorLogSink)]
    if not accelerations:
        shown = _without_accelerations(shown)
    if len(shown) < len(wires(diagram)):
        kept = {name for wire in shown for name in (wire.source, wire.target)}
        systems = {name: system for name, system in systems.items() if name in kept}
    names = list(systems)
    ports = {name: _ports(systems[name], name, shown) for name in names}
    blocks = tuple(_block(systems[name], *ports[name]) for name in names)
    return Picture(title=title, blocks=blocks, nets=_nets(systems, blocks, ports, shown))


def _is_of_geometry(systems: Mapping[str, System], wire: LiveWire) -> bool:
    """Whether a wire is between a plant and the SceneGraph in which its bodies touch."""
    return any(isinstance(systems[end], SceneGraph) for end in (wire.source, wire.target))


def _without_accelerations(shown: Sequence[LiveWire]) -> list[LiveWire]:
    """Leave out wires to accelerations, then blocks that no longer feed anything."""
    feeding = {wire.source for wire in shown}
    kept = [wire for wire in shown if wire.input not in ACCELERATIONS]
    while True:
        idle = feeding - {wire.source for wire in kept}
        fewer = [wire for wire in kept if wire.target not in idle]
        if len(fewer) == len(kept):
            return kept
        kept = fewer


def _ports(system: System, name: str, shown: Sequence[LiveWire]) -> tuple[list[str], list[str]]:
    """Names of the connected inputs and outputs, in the system's order."""
    used_inputs = {wire.input for wire in shown if wire.target == name}
    used_outputs = {wire.output for wire in shown if wire.source == name}
    inputs = [system.get_input_port(i).get_name() for i in range(system.num_input_ports())]
    outputs = [system.get_output_port(i).get_name() for i in range(system.num_output_ports())]
    return [p for p in inputs if p in used_inputs], [p for p in outputs if p in used_outputs]


def _block(system: System, inputs: list[str], outputs: list[str]) -> DrawnBlock:
    name = system.get_name()
    glyph = next((g for kind, g in _GLYPHS.items() if isinstance(system, kind)), "box")
    converter = name.startswith((TO_PHYSICAL, TO_SIGNAL))
    kind = type(system).__name__.partition("_")[0]
    boxed = glyph in ("box", "plant") and not converter
    sign = "+" if isinstance(system, Adder) else ""
    return DrawnBlock(
        name=name,
        caption=wrapped(name, SIGNAL_WIDTH) + _start(system, glyph),
        glyph=glyph,
        text=_text(system, glyph, kind),
        inputs=tuple((pretty(_of_block(port, name)) if boxed else "") or sign for port in inputs),
        outputs=tuple(pretty(_of_block(port, name)) if boxed else "" for port in outputs),
        physical=converter or kind in _PHYSICAL or glyph == "plant",
        loose=boxed,
    )


def _start(system: System, glyph: str) -> tuple[str, ...]:
    """Write an integrator's initial value."""
    if glyph != "integrator":
        return ()
    context = system.CreateDefaultContext()
    return (f"from {values_text(context.get_continuous_state_vector().CopyToVector())}",)


def _text(system: System, glyph: str, kind: str) -> tuple[str, ...]:
    """The text inside: a value, or what the block computes."""
    if glyph == "constant":
        context = system.CreateDefaultContext()
        return (values_text(system.get_source_value(context).value()),)
    if isinstance(system, Gain):
        return (values_text(_response(system)),)
    if glyph == "gain":
        return ("K·u",)
    if isinstance(system, Adder):
        return ("Σ",)
    if glyph == "plant":
        return ("Multibody", "Plant")
    if glyph == "box":
        return _INSIDE.get(kind) or wrapped(spaced(kind), SIGNAL_WIDTH)
    return ()


def _response(system: Gain) -> Sequence[float]:
    """A gain's output for inputs of 1."""
    context = system.CreateDefaultContext()
    port = system.get_input_port()
    port.FixValue(context, [1.0] * port.size())
    values: Sequence[float] = system.get_output_port().Eval(context)
    return values


def _nets(
    systems: dict[str, System],
    blocks: Sequence[DrawnBlock],
    ports: dict[str, tuple[list[str], list[str]]],
    shown: Sequence[LiveWire],
) -> tuple[Net, ...]:
    index = {name: place for place, name in enumerate(systems)}
    targets: dict[tuple[str, str], list[LiveWire]] = {}
    for wire in shown:
        targets.setdefault((wire.source, wire.output), []).append(wire)
    labels = signal_names(systems, shown)
    sort_key: Callable[[tuple[str, str]], tuple[int, int]] = lambda end: (  # noqa: E731
        index[end[0]],
        ports[end[0]][1].index(end[1]),
    )
    return tuple(
        Net(
            source=sort_key(end),
            targets=tuple(
                (index[w.target], ports[w.target][0].index(w.input)) for w in targets[end]
            ),
            label=labels.get(end, ""),
            physical=_is_physical(blocks, index, targets[end]),
            arrow=True,
            wide=systems[end[0]].GetOutputPort(end[1]).size() > 1,
        )
        for end in sorted(targets, key=sort_key)
    )


def _is_physical(
    blocks: Sequence[DrawnBlock], index: dict[str, int], net: Sequence[LiveWire]
) -> bool:
    """Tell whether all ends of a net, apart from scopes, are mechanical."""
    ends = [blocks[index[w.target]] for w in net]
    inner = [block for block in ends if block.glyph != "scope"]
    source = blocks[index[net[0].source]]
    sides = [source.physical and not source.name.startswith(TO_SIGNAL)]
    sides += [block.physical and not block.name.startswith(TO_PHYSICAL) for block in inner]
    return bool(inner) and all(sides)
