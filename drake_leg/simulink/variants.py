"""Variant subsystems: one of several choices takes their place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from drake_leg.errors import InvalidValueError, UnknownValueError, did_you_mean
from drake_leg.simulink.diagram import Diagram, DrawnBlock, DrawnLine
from drake_leg.simulink.model import split_port
from drake_leg.simulink.wiring import outer_ports

Condition = Callable[[DrawnBlock, str], bool]  # block whose names a text uses, and the text

_PORTS = ("Inport", "Outport", "PMIOPort")
_DEFAULT = "(default)"


def choose_variants(
    diagram: Diagram, holds: Condition, wanted: Mapping[str, str] | None = None
) -> Diagram:
    """Leave one choice in every variant subsystem, and draw the lines between their ports.

    A variant subsystem whose choice is not known keeps none, and says why.

    Parameters
    ----------
    holds : callable
        Whether a condition holds; it raises `UnknownValueError` where that is not known.
    wanted : mapping, optional
        Choices by path or name of the subsystem: name or label of the choice.

    Raises
    ------
    InvalidValueError
        If a wanted choice or its subsystem does not exist.
    """
    choosing = _Choosing(diagram, holds, wanted or {})
    for block in diagram.blocks.values():
        choosing.look_at(block)
    choosing.refuse_unused()
    return choosing.chosen()


class _Choosing:
    """Chooses from the outermost variant subsystem to the innermost."""

    def __init__(self, diagram: Diagram, holds: Condition, wanted: Mapping[str, str]) -> None:
        self._diagram, self._holds = diagram, holds
        self._wanted = dict(wanted)
        self._blocks = dict(diagram.blocks)
        self._lines = list(diagram.lines)
        self._dropped: set[str] = set()
        self._inside: dict[str, list[DrawnBlock]] = {}
        for block in diagram.blocks.values():
            self._inside.setdefault(block.system, []).append(block)

    def look_at(self, block: DrawnBlock) -> None:
        """Choose, if a block is a variant subsystem; drop what lies in a choice not taken."""
        if block.system in self._dropped or block.sid in self._dropped:
            self._dropped.add(block.sid)
            return
        if block.texts.get("Variant") != "on":
            return
        within = self._inside.get(block.sid, [])
        choices = [choice for choice in within if choice.type not in _PORTS]
        self._dropped.update(choice.sid for choice in choices)
        try:
            active = _active(block, choices, self._holds, self._wanted)
        except UnknownValueError as error:
            self._blocks[block.sid] = replace(block, undecided=error.problem)
            return
        self._dropped.remove(active.sid)
        ports = [port for port in within if port.type in _PORTS]
        self._lines += _joined(ports, active, self._inside.get(active.sid, []))

    def refuse_unused(self) -> None:
        """Refuse a choice that somebody wants of a subsystem that does not exist."""
        if not self._wanted:
            return
        name = next(iter(self._wanted))
        blocks = self._diagram.blocks.values()
        variants = [block.path for block in blocks if block.texts.get("Variant") == "on"]
        raise InvalidValueError(
            f"there is no variant subsystem {name!r}",
            advice=did_you_mean(name, variants, "give the name of one, or its path in the model"),
        )

    def chosen(self) -> Diagram:
        """Return the diagram with what was chosen alone."""
        kept = {sid: block for sid, block in self._blocks.items() if sid not in self._dropped}
        functions = [each for each in self._diagram.functions if each.sid in kept]
        lines = [line for line in map(_without(self._dropped), self._lines) if line.ends]
        return replace(self._diagram, blocks=kept, lines=lines, functions=functions)


def _active(
    block: DrawnBlock, choices: list[DrawnBlock], holds: Condition, wanted: dict[str, str]
) -> DrawnBlock:
    label = wanted.pop(block.path, None) or wanted.pop(block.name, None)
    asked = label is not None
    if label is None and block.texts.get("VariantControlMode", "label") == "label":
        label = block.texts.get("LabelModeActiveChoice")
    if label:
        fits = [one for one in choices if label in (one.name, one.texts.get("VariantControl"))]
        if asked and not fits:
            names = ", ".join(repr(one.name) for one in choices)
            raise InvalidValueError(f"{block} has no choice {label!r}: choose one of {names}")
        if not fits:
            raise UnknownValueError(f"none of its choices is {label!r}")
        return fits[0]
    others = None
    for choice in choices:
        condition = choice.texts.get("VariantControl", "").strip()
        if condition == _DEFAULT:
            others = choice
        elif condition and not condition.startswith("%") and holds(block, condition):
            return choice
    if others is None:
        raise UnknownValueError("no condition of its choices holds")
    return others


def _joined(
    ports: list[DrawnBlock], active: DrawnBlock, within: list[DrawnBlock]
) -> list[DrawnLine]:
    """Lines between the ports of a variant subsystem and those of like name of its choice."""
    inner = {(port.type, port.name.strip()): port for port in within if port.type in _PORTS}
    numbers = _numbers(within)
    found = []
    for port in ports:
        match = inner.get((port.type, port.name.strip()))
        if match is None:
            continue
        end = f"{active.sid}#{numbers[match.sid]}"
        if port.type == "Outport":
            found.append(_line(end, f"{port.sid}#in:1"))
        elif port.type == "Inport":
            found.append(_line(f"{port.sid}#out:1", end))
        else:
            own = f"{port.sid}#rconn:1"
            found.append(DrawnLine(name="", physical=True, source="", ends=(own, end)))
    return found


def _line(source: str, target: str) -> DrawnLine:
    return DrawnLine(name="", physical=False, source=source, ends=(target,))


def _numbers(within: list[DrawnBlock]) -> dict[str, str]:
    """Ports of a subsystem from outside, by the SIDs of the blocks inside: ``in:1``."""
    kinds = {"Inport": "in", "Outport": "out"}
    signals = {
        block.sid: f"{kinds[block.type]}:{_port_number(block)}"
        for block in within
        if block.type in kinds
    }
    return signals | outer_ports(
        (block.sid, block.texts.get("Side", "Left"), _port_number(block))
        for block in within
        if block.type == "PMIOPort"
    )


def _port_number(block: DrawnBlock) -> int:
    text = block.texts.get("Port", "1")
    return int(text) if text.isdecimal() else 1


def _without(dropped: set[str]) -> Callable[[DrawnLine], DrawnLine]:
    def kept(line: DrawnLine) -> DrawnLine:
        if line.source and split_port(line.source)[0] in dropped:
            return replace(line, ends=())
        ends = tuple(end for end in line.ends if split_port(end)[0] not in dropped)
        return line if len(ends) == len(line.ends) else replace(line, ends=ends)

    return kept
