"""Reads the signals and the mechanism of a Simulink model as pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

from drake_leg.arguments import printable, some_of
from drake_leg.errors import InvalidValueError
from drake_leg.pictures.mechanical import SIGNAL_WIDTH, number_text, values_text
from drake_leg.pictures.simulink_mechanism import (
    JOINT_GLYPHS,
    cut,
    model_mechanism_picture,
    name_lines,
    unique_names,
)
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
from drake_leg.simulink.lacks import with_texts
from drake_leg.simulink.matlab.program import Program, program
from drake_leg.simulink.mechanism import (
    TO_PHYSICAL,
    TO_SIGNAL,
    PhysicalNetwork,
    network_of,
    ports_by_block,
)
from drake_leg.simulink.model import Block, Model, Value, split_port
from drake_leg.simulink.subsystems import largest_subsystems, subsystem
from drake_leg.simulink.wiring import flatten

GLYPHS = JOINT_GLYPHS | {
    "BusCreator": "mux",
    "BusSelector": "demux",
    "Concatenate": "mux",
    "Constant": "constant",
    "Demux": "demux",
    "FloatingScope": "scope",
    "Gain": "gain",
    "Inport": "connection",
    "Integrator": "integrator",
    "Mux": "mux",
    "Outport": "connection",
    "Scope": "scope",
    "Sin": "sine",
    "Sum": "sum",
    TO_PHYSICAL: "converter",
    TO_SIGNAL: "converter",
}

# Parameters that are written inside, and the text inside other blocks.
_VALUES = {
    "Constant": "Value",
    "Fcn": "Expr",
    "Gain": "Gain",
    "Inport": "Port",
    "Math": "Operator",
    "Outport": "Port",
    "Trigonometry": "Operator",
}
_INSIDE = {
    "Product": ("×",),
    "Sum": ("Σ",),
    TO_PHYSICAL: ("S", "PS"),
    TO_SIGNAL: ("PS", "S"),
}
_SIGNS = {"+": "+", "-": "−", "*": "×", "/": "÷"}
MOST_BLOCKS = 300  # in one picture; more cannot be read
MOST_LISTED = 8  # subsystems in a sentence


def signal_blocks(
    model: Model,
    blocks: Iterable[Block],
    names: Mapping[str, str],
    inputs: Mapping[str, Sequence[str]],
    outputs: Mapping[str, Sequence[str]],
) -> Iterator[DrawnBlock]:
    """Draw blocks under their names, with their ports and their scripts."""
    scripts = {function.sid: function.script for function in model.functions}
    for block in blocks:
        yield signal_block(
            block,
            name=names[block.sid],
            inputs=inputs.get(block.sid, ()),
            outputs=outputs.get(block.sid, ()),
            script=scripts.get(block.sid, ""),
        )


def signal_block(
    block: Block, *, name: str, inputs: Sequence[str], outputs: Sequence[str], script: str
) -> DrawnBlock:
    """Draw a signal block with its main parameters.

    ``inputs`` and ``outputs`` are its ports that are wired, as ``SID#in:1``; ``script`` is the code
    of a MATLAB Function block.
    """
    glyph = GLYPHS.get(block.kind, "box")
    function = _function(script)
    labels_in, labels_out = _port_labels(block, function)
    details = _DETAILS.get(block.kind)
    words = details(block) if details else ()
    return DrawnBlock(
        name=name,
        caption=name_lines(block.name, SIGNAL_WIDTH) + tuple(map(cut, words)),
        glyph=glyph,
        text=_text(block, glyph, function),
        inputs=tuple(_label(port, labels_in) for port in inputs),
        outputs=tuple(_label(port, labels_out) for port in outputs),
        loose=bool(labels_in) or block.kind in JOINT_GLYPHS,  # converters tell their signals apart
    )


def value_text(value: Value | None) -> str:
    """Write a parameter: its number, how many numbers it has, or its text."""
    if isinstance(value, tuple):
        rows = (row if isinstance(row, tuple) else (row,) for row in value)
        return values_text(chain.from_iterable(rows)) if value else "[]"
    return number_text(value) if isinstance(value, float) else cut(str(value))


def _function(script: str) -> Program | None:
    """Read the code of a MATLAB Function block, if it can be read."""
    try:
        return program(script)
    except InvalidValueError:
        return None


def _port_labels(block: Block, function: Program | None) -> tuple[Sequence[str], Sequence[str]]:
    """Name the inputs and the outputs of a block, where they have names."""
    if function is not None:
        return function.inputs, function.outputs
    if block.kind in ("Product", "Sum"):
        signs = str(block.parameters.get("Inputs"))
        return [_SIGNS[sign] for sign in signs if sign in _SIGNS], ()
    return (), ()


def _label(port: str, labels: Sequence[str]) -> str:
    _, _, number = split_port(port)
    return cut(labels[number - 1]) if 0 < number <= len(labels) else ""


def _text(block: Block, glyph: str, function: Program | None) -> tuple[str, ...]:
    """The text inside: a value, or what the block computes."""
    if block.kind in _VALUES:
        return (value_text(block.parameters.get(_VALUES[block.kind])),)
    if function is not None:
        return (cut(function.name),)
    if block.kind in _INSIDE:
        return _INSIDE[block.kind]
    if glyph != "box":
        return ()
    return wrapped(spaced(block.kind), SIGNAL_WIDTH)


def _sine(block: Block) -> Iterator[str]:
    get = block.parameters.get
    yield f"amplitude {value_text(get('Amplitude'))}"
    yield f"{value_text(get('Frequency'))} rad/s"
    for what in ("Phase", "Bias"):
        if get(what) != 0.0:
            yield f"{what.lower()} {value_text(get(what))}"


def _integrator(block: Block) -> Iterator[str]:
    if block.parameters.get("InitialConditionSource") == "internal":
        yield f"from {value_text(block.parameters.get('InitialCondition'))}"


def _step(block: Block) -> Iterator[str]:
    get = block.parameters.get
    yield f"{value_text(get('Before'))} to {value_text(get('After'))}"
    yield f"at {value_text(get('Time'))} s"


def _converter(block: Block) -> Iterator[str]:
    get = block.parameters.get
    if get("Unit") != "1":
        yield str(get("Unit")).replace("*", "·")
    if get("FilteringAndDerivatives") == "filter":
        constant = get("InputFilterTimeConstant")
        order = "2 lags" if get("SimscapeFilterOrder") == 2.0 else "1 lag"
        shown = f"{number_text(1e3 * constant)} ms" if isinstance(constant, float) else "?"
        yield f"{order} of {shown}"


def _limits(block: Block) -> Iterator[str]:
    low, high = (value_text(block.parameters.get(f"{side}Limit")) for side in ("Lower", "Upper"))
    yield f"{low} to {high}"


_DETAILS: dict[str, Callable[[Block], Iterator[str]]] = {
    "Integrator": _integrator,
    "Saturate": _limits,
    "Sin": _sine,
    "Step": _step,
    TO_PHYSICAL: _converter,
    TO_SIGNAL: _converter,
}


@dataclass(frozen=True)
class _Line:
    """A signal from one port to all its targets."""

    source: str
    targets: tuple[str, ...]
    name: str
    physical: bool


def signals_picture(
    model: Model, network: PhysicalNetwork, names: Mapping[str, str], *, title: str
) -> Picture:
    """Draw the signals of a model, and the joints and sensors that they drive or come from.

    A model without signals has a picture without blocks.
    """
    lines = _lines(model, network)
    inputs = ports_by_block(port for line in lines for port in line.targets)
    outputs = ports_by_block(line.source for line in lines)
    blocks = [
        block
        for block in model.blocks
        if block.sid not in network.mechanical
        or block.sid in network.sensed
        or block.sid in inputs
        or block.sid in outputs
    ]
    blocks.sort(key=lambda block: block.sid not in outputs)  # so that scopes are below
    drawn = signal_blocks(model, blocks, names, inputs, outputs)
    return Picture(
        title=title,
        blocks=tuple(
            replace(picture, physical=block.sid in network.physical)
            for block, picture in zip(blocks, drawn, strict=True)
        ),
        nets=_nets(lines, blocks, inputs, outputs),
    )


def _nets(
    lines: Sequence[_Line],
    blocks: Sequence[Block],
    inputs: Mapping[str, list[str]],
    outputs: Mapping[str, list[str]],
) -> tuple[Net, ...]:
    index = {block.sid: place for place, block in enumerate(blocks)}
    glyph = {block.sid: GLYPHS.get(block.kind, "") for block in blocks}

    def end(port: str, ports: Mapping[str, list[str]]) -> tuple[int, int]:
        sid, _, _ = split_port(port)
        return index[sid], ports[sid].index(port)

    nets = [
        Net(
            source=end(line.source, outputs),
            targets=tuple(end(port, inputs) for port in line.targets),
            label=cut(line.name),
            physical=line.physical,
            wide=_is_wide(line, glyph),
        )
        for line in lines
    ]
    return tuple(sorted(nets, key=lambda net: net.source))


def _lines(model: Model, network: PhysicalNetwork) -> list[_Line]:
    """Group the wires and the physical signals by source port."""
    targets: dict[str, list[str]] = {}
    names: dict[str, str] = {}
    for wire in model.wires:
        targets.setdefault(wire.source, []).append(wire.target)
        names[wire.source] = names.get(wire.source) or wire.name
    return [
        *(_Line(source, tuple(ends), names[source], False) for source, ends in targets.items()),
        *(_Line(node[0], node[1:], "", True) for node in network.signals),
    ]


def _is_wide(line: _Line, glyph: Mapping[str, str]) -> bool:
    """Tell whether a line carries a vector: it leaves a Mux or enters a Demux."""
    ends = {glyph[split_port(port)[0]] for port in line.targets}
    return glyph[split_port(line.source)[0]] == "mux" or "demux" in ends


def model_pictures(
    model: Model, *, title: str, part: str = ALL, system: str | None = None
) -> tuple[Picture, ...]:
    """Read the pictures of a Simulink model; subsystems are opened, Goto and From become wires.

    There is one for each part that the model has. A joint or a sensor that signals reach or leave
    is in both, every other block in one. With ``system``, the path of a subsystem, or its name, it
    alone is drawn.

    Raises
    ------
    InvalidValueError
        If there is nothing to draw, or too much, or the model makes no sense.
    """
    if part not in (SIGNALS, MECHANISM, ALL):
        raise InvalidValueError(
            f"there is no part {part!r} of a Simulink model: its parts are {SIGNALS} and "
            f"{MECHANISM}, and {ALL} is both"
        )
    if system is not None:
        model, title = subsystem(model, system), f"{title}: {printable(system)}"
    flat = flatten(model, strict=False)
    names = unique_names(model)
    network = network_of(flat)
    pictures = {
        SIGNALS: signals_picture(with_texts(flat), network, names, title=f"{title}: signals"),
        MECHANISM: model_mechanism_picture(network, names, title=f"{title}: mechanism"),
    }
    chosen = [name for name, picture in pictures.items() if picture.blocks and part in (name, ALL)]
    if not chosen:
        raise InvalidValueError(
            "the model has no blocks to draw: add some, or take another model"
            if part == ALL
            else f"the model has no {part} to draw: draw all that it has"
        )
    for name in chosen:
        _require_drawable(pictures[name], name, model)
    return tuple(pictures[name] for name in chosen)


def _require_drawable(picture: Picture, part: str, model: Model) -> None:
    if len(picture.blocks) <= MOST_BLOCKS:
        return
    systems = largest_subsystems(model, MOST_BLOCKS)
    listed = some_of([f"{printable(path)!r} of {n} blocks" for path, n in systems], MOST_LISTED)
    raise InvalidValueError(
        f"the picture of its {part} would have {len(picture.blocks)} blocks; at most "
        f"{MOST_BLOCKS} can be drawn",
        advice=f"draw a subsystem with `system`: {listed}"
        if listed
        else "put some of its blocks into subsystems",
    )
