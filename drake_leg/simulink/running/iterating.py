"""Subsystems that iterate, in code: their blocks run again and again within one step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drake_leg.simulink.running.assembling import needed
from drake_leg.simulink.running.code import CONTINUOUS, MAJOR, Operand, Pen, Section, Writer
from drake_leg.simulink.running.settings import Signal, zero_like


@dataclass(kw_only=True)
class IterationSection(Section):
    """All blocks of a subsystem that iterates: a function of the memory that is called at once."""

    made: frozenset[str]
    own: frozenset[str]  # names within the function

    def settle(self) -> None:
        """Find the names that the lines make and read."""
        super().settle()
        self.reads = (self.reads - self.own - self.made) | {"m"}
        self.makes = self.made


def iterated(pen: Pen, w: Writer, parts: Sequence[Section], slots: range) -> list[Section]:
    """Make sections of what the blocks of a subsystem wrote, which the iterator's writer leads.

    Parameters
    ----------
    pen : Pen
        What was written before.
    w : Writer
        That of the iterator: it has kept how often, and until when, the blocks run.
    parts : sequence of Section
        What the blocks wrote: their outputs, then what they remember.
    slots : range
        The places of the memory that the blocks have.
    """
    outputs = [part for part in parts if not part.after]
    count = Section(title="", lines=[f"count = {w.kept['count']}"], rate=CONTINUOUS)
    count.settle()
    before = needed(outputs, count.reads)
    made = sorted({name for part in outputs for name in part.makes})
    places = {name: pen.slot(_start(pen.scope[name])) for name in made}
    kept = {slot: pen.name(f"kept_{slot}") for slot in slots}
    function, number = pen.name("iterated"), w.kept["iteration"]
    body = [f"{name} = m[{place}]" for name, place in places.items()]
    if w.kept["resets"]:
        body += [f"m[{slot}] = m[{pen.slot(pen.slots[slot])}]" for slot in slots]
    body += [line for part in before for line in part.lines]
    body.append(f"for {number} in range(int({w.kept['count']})):")
    inner = [f"{number} = float({number} + {w.kept['first']})"]
    inner += [line for part in parts for line in _gated(part, w.gates)]
    if w.kept["until"]:
        inner += [f"if not {w.kept['until']}:", "    break"]
    body += [f"    {line}" for line in inner]
    results = [*made, *(f"m[{slot}]" for slot in slots)]
    body.append(f"return [{', '.join(results)}]")
    names = [*made, *kept.values()]
    lines = [f"def {function}(m):", *(f"    {line}" for line in body)]
    if names:
        lines.append(f"[{', '.join(names)}] = {function}(list(m))")
    section = IterationSection(
        title=w.node.block.path or w.node.block.name,
        lines=lines,
        rate=w.rate,
        gates=w.gates,
        made=frozenset(names),
        own=frozenset({number}),
    )
    pen.scope["m"] = pen.slots
    pen.run(section)
    pen.sections.remove(section)
    stores = [f"m[{place}] = {name}" for name, place in places.items()]
    stores += [f"m[{slot}] = {name}" for slot, name in kept.items() if not w.kept["resets"]]
    after = Section(
        title=section.title,
        lines=stores or ["pass"],
        rate=MAJOR if w.rate == CONTINUOUS else w.rate,
        gates=w.gates,
        after=True,
    )
    after.settle()
    return [section, after]


def _start(value: Signal) -> Signal:
    """Return what a signal is before the blocks run for the first time."""
    return value if isinstance(value, dict | str | tuple) else zero_like(value)


def _gated(part: Section, around: Sequence[str]) -> list[str]:
    """Write a part, under what lets it run within the subsystem."""
    gates = [gate for gate in part.gates if gate not in around]
    if not gates:
        return part.lines
    return [f"if {' and '.join(gates)}:", *(f"    {line}" for line in part.lines)]


def first_value(pen: Pen, w: Writer, first: float) -> Operand:
    """Name the number of the iteration; it is the first where the lines are carried out."""
    name = pen.name("iteration")
    pen.scope[name] = first
    w.kept["iteration"], w.kept["first"] = name, first
    return Operand(code=name, value=first)
