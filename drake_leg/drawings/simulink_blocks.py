"""How one block among the signals of a Simulink model looks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

from drake_leg.drawings.captions import SIGNAL_WIDTH, number_text, values_text
from drake_leg.drawings.picture import DrawnBlock
from drake_leg.drawings.simulink_bodies import JOINT_GLYPHS
from drake_leg.drawings.simulink_names import cut, name_lines
from drake_leg.drawings.simulink_network import TO_PHYSICAL, TO_SIGNAL
from drake_leg.drawings.text import spaced, wrapped
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import Program, program
from drake_leg.simulink.model import Block, Value, split_port

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


def signal_block(
    block: Block, *, name: str, inputs: Sequence[str], outputs: Sequence[str], script: str
) -> DrawnBlock:
    """Draw a block of the signals, with the parameters that tell most.

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
