"""Whether the signals at an input of two Simulink models are the same, and why they differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from drake_leg.errors import UnknownValueError
from drake_leg.simulink.compare.blocks import ActingBlocks
from drake_leg.simulink.compare.findings import (
    Quantity,
    Verdict,
    check,
    differences,
    different,
)
from drake_leg.simulink.compare.signals import SOURCES, Scalar, Signal, close
from drake_leg.simulink.compare.simulink_signals import SINKS, SimulinkSignals
from drake_leg.simulink.mechanism import TO_PHYSICAL, TO_SIGNAL
from drake_leg.simulink.model import Block, Model, Value, vector
from drake_leg.simulink.unused import unused_parameters

TOLD_BY_SIGNALS = {  # settings, by the kind of block
    "Integrator": ("InitialCondition",),
    "DiscreteIntegrator": ("InitialCondition",),
    TO_PHYSICAL: ("Unit",),
    TO_SIGNAL: ("Unit",),
}
STATED = {"Constant": ("Value",), "Sin": ("Amplitude", "Bias", "Frequency", "Phase")}
STATED |= {"SignalGenerator": ("Amplitude", "Frequency")}
LENGTHY = 3  # terms of a signal that are shown


@dataclass(frozen=True, kw_only=True)
class ModelSide:
    """A model in the form in which it is compared with another one."""

    drawn: Model
    flat: Model  # without subsystems
    signals: SimulinkSignals
    acting: ActingBlocks

    def block(self, sid: str) -> Block:
        """Find a block."""
        return self.signals.blocks[sid]

    @cached_property
    def scripts(self) -> dict[str, str]:
        """SID of a MATLAB Function -> its code."""
        return {function.sid: function.script for function in self.drawn.functions}

    @cached_property
    def solver(self) -> Mapping[str, Value]:
        """Return the settings of the solver that are known."""
        found: dict[str, Value] = {}
        for name in self.drawn.solver:
            try:
                found[name] = self.drawn.solver[name]
            except UnknownValueError as error:
                found[name] = error.text
        return found

    @cached_property
    def source_of(self) -> dict[str, str]:
        """Map an input to the output that is wired to it."""
        return {wire.target: wire.source for wire in self.flat.wires}

    @cached_property
    def _systems(self) -> dict[str, Block]:
        return {each.sid: each for each in self.drawn.blocks if each.type == "SubSystem"}

    def path(self, block: Block) -> tuple[str, ...]:
        """Return the names of a block and of the subsystems that hold it, itself first."""
        found = [block.name]
        while block.system in self._systems:
            block = self._systems[block.system]
            found.append(block.name)
        return tuple(found)

    def at_outputs(self, block: Block) -> Iterator[Scalar]:
        """List the signals at the outputs of a block that are connected."""
        for port in self.signals.outputs_of.get(block.sid, ()):
            yield from self.signals.output(port)

    def is_signal(self, block: Block) -> bool:
        """Tell whether signals reach or leave a block, or it makes one."""
        sid = block.sid
        wired = sid in self.signals.inputs_of or sid in self.signals.outputs_of
        return wired or block.type in SOURCES or self.signals.is_carrier(block)

    def sources(self, scalar: Scalar, kind: str) -> list[Block]:
        """List the blocks of a type that a signal comes from."""
        order = self.signals.order
        found = (self.block(sid) for sid in sorted(scalar.origins, key=order.__getitem__))
        return [block for block in found if block.type == kind]


Sides = tuple[ModelSide, ModelSide]


def typed_values(block: Block) -> dict[str, Quantity]:
    """Return the settings of a block that are told by no signal, and that it uses, in SI."""
    left_out = {*unused_parameters(block), *TOLD_BY_SIGNALS.get(block.kind, ())}
    if block.parameters.get("InitialConditionSource") == "external":
        left_out.add("InitialCondition")
    found: dict[str, Quantity] = {}
    for name, value in block.parameters.items():
        if name not in left_out and not name.endswith("Units"):
            found[name] = _quantity(value)
    return found


def _quantity(value: Value) -> Quantity:
    if isinstance(value, str):
        return value.strip()
    numbers = vector(value)
    return numbers[0] if len(numbers) == 1 else numbers


def compare_signals(
    sides: Sides, block: Block, port: str, ours: Signal | None, theirs: Signal | None
) -> Iterator[Verdict]:
    """Compare what reaches an input of a block and its counterpart, both in their atoms."""
    if ours is None or theirs is None or len(ours) != len(theirs):
        yield _other_signal(block, port, ours, theirs)
        return
    for mine, other in zip(ours, theirs, strict=True):
        if mine.shape != other.shape:
            yield _other_signal(block, port, ours, theirs)
            return
    for mine, other in zip(ours, theirs, strict=True):
        found = list(_compare_numbers(sides, block, port, mine, other))
        yield from found
        if found:
            return


def _other_signal(block: Block, port: str, ours: Signal | None, theirs: Signal | None) -> Verdict:
    return different(
        block.sid,
        block.name,
        f"{port}",
        _in_words(ours),
        _in_words(theirs),
        what="wire",
        wrong=f"{block.sid}#{port}",
    )


def _in_words(signal: Signal | None) -> str:
    if signal is None:
        return "nothing"
    shown = ", ".join(map(str, signal[:LENGTHY]))
    return f"({shown}, ...)" if len(signal) > LENGTHY else shown


def _compare_numbers(
    sides: Sides, block: Block, port: str, ours: Scalar, theirs: Scalar
) -> Iterator[Verdict]:
    """Compare the factors, sines and constants of two signals of one shape."""
    if not close(ours.constant, theirs.constant):
        yield from _other_constant(sides, block, port, ours, theirs)
    if ours.sines != theirs.sines and not _same(ours.sines, theirs.sines):
        yield from _other_sine(sides, block, port, ours, theirs)
    wrong = [
        atom
        for atom, factor in ours.terms.items()
        if atom.kind != "sine" and not close(factor, theirs.terms[atom])
    ]
    if wrong:
        factors = ours.terms[wrong[0]], theirs.terms[wrong[0]]
        shown = block.type in SINKS or block.kind in SINKS
        what = f"{port}, factor of {wrong[0]}"
        yield different(block.sid, block.name, what, *factors, counts=not shown)


def _same(ours: list[tuple[float, float, float]], theirs: list[tuple[float, float, float]]) -> bool:
    return len(ours) == len(theirs) and all(
        close(a, b)
        for one, other in zip(ours, theirs, strict=True)
        for a, b in zip(one, other, strict=True)
    )


def _other_constant(
    sides: Sides, block: Block, port: str, ours: Scalar, theirs: Scalar
) -> Iterator[Verdict]:
    """Name the block that states another constant, if it is a single one, or the input."""
    for kind, name in (("Constant", "Value"), ("Integrator", "InitialCondition")):
        stated = _stated(sides, ours, theirs, kind, (name,))
        if stated:
            yield from stated
            return
    both = ours.constant, theirs.constant
    yield different(block.sid, block.name, f"{port}, constant", *both)


def _other_sine(
    sides: Sides, block: Block, port: str, ours: Scalar, theirs: Scalar
) -> Iterator[Verdict]:
    for kind in ("Sin", "SignalGenerator"):
        stated = _stated(sides, ours, theirs, kind, STATED[kind])
        if stated and _told(ours, theirs, stated):
            yield from stated
            return
    names = ("frequency [rad/s]", "phase [rad]", "amplitude")
    if len(ours.sines) != len(theirs.sines):
        yield _other_signal(block, port, (ours,), (theirs,))
        return
    for one, other in zip(ours.sines, theirs.sines, strict=True):
        for name, a, b in zip(names, one, other, strict=True):
            if not close(a, b):
                yield different(block.sid, block.name, f"{port}, {name} of the sine", a, b)


def _told(ours: Scalar, theirs: Scalar, stated: list[Verdict]) -> bool:
    """Tell whether what two sources state makes the whole difference of two sines."""
    ratio = 1.0
    for verdict in stated:
        if verdict.item["parameter"] == "Amplitude":
            a, b = verdict.item["simulink"], verdict.item["drake"]
            ratio = a / b if a and b else 0.0
    (*_, mine), (*_, other) = ours.sines[0], theirs.sines[0]
    return bool(ratio) and close(mine, other * ratio)


def _stated(
    sides: Sides, ours: Scalar, theirs: Scalar, kind: str, names: tuple[str, ...]
) -> list[Verdict]:
    """Compare what the only sources of a kind state, where each signal has one."""
    mine, other = (
        side.sources(scalar, kind) for side, scalar in zip(sides, (ours, theirs), strict=True)
    )
    if len(mine) != 1 or len(other) != 1:
        return []
    checks = [
        check(
            mine[0],
            name,
            _quantity(mine[0].parameters.get(name, 0.0)),
            _quantity(other[0].parameters.get(name, 0.0)),
        )
        for name in names
    ]
    return list(differences(*checks))
