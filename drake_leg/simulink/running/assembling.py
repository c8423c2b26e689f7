"""Functions assembled from the sections of blocks: of the present, and of what events change."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from drake_leg.simulink.running.code import CONTINUOUS, MAJOR, Section
from drake_leg.simulink.running.loops import LoopSection


def of_present(
    name: str,
    outputs: Sequence[Section],
    result: Sequence[str],
    held: Mapping[str, int],
    returned: str = "",
) -> str:
    """Write a function of the present: what is not computed always is read from the memory."""
    goal = _settled(result)
    chosen = needed(outputs, goal.reads)
    wanted = set(goal.reads).union(*((*each.reads, *each.gates) for each in chosen))
    body: list[str] = []
    for section in chosen:
        body += _present(section, held, wanted)
    returned = returned or result[0].partition(" ")[0]
    return _definition(f"def {name}(t, x, m, y, e):", [*body, *result, f"return {returned}"])


def of_events(
    outputs: Sequence[Section],
    afters: Sequence[Section],
    held: Mapping[str, int],
    happening: int = -1,
) -> str:
    """Write what happens at sample times and major steps: it changes the memory.

    Meanwhile a slot of it, ``happening``, is true, where it is not -1.
    """
    goals = {name for section in outputs if section.lasts for name in section.makes}
    goals |= {name for section in afters for name in (*section.reads, *section.gates)}
    body: list[str] = []
    for section in needed(outputs, goals):
        body += _at_major(section, held)
    for section in afters:
        condition = " and ".join((*_when(section), *section.gates))
        body += _comment(section)
        body += _under(condition, section.lines)
    if happening >= 0:
        body = [f"m[{happening}] = True", *body, f"m[{happening}] = False"]
    return _definition("def major(t, x, m, y, e, hits, step, after):", body or ["pass"])


def names_read(
    outputs: Sequence[Section], lines: Sequence[str], afters: Sequence[Section] = ()
) -> set[str]:
    """Find all that lines, and sections behind them, depend on."""
    goal = _settled(lines)
    names = set(goal.reads).union(*(section.reads for section in afters))
    found = set(names)
    for section in needed(outputs, names):
        found |= section.reads | section.makes
    return found


def _present(section: Section, held: Mapping[str, int], wanted: set[str]) -> list[str]:
    """Write a section as it is between events."""
    if isinstance(section, LoopSection) and not section.is_sampled:

        def part(inner: Section) -> list[str]:
            return _present(inner, held, wanted)

        return [*_comment(section), *section.code(part, part)]
    if isinstance(section, LoopSection):
        return [line for inner in section.parts for line in _present(inner, held, wanted)]
    reads = [f"{name} = m[{held[name]}]" for name in sorted(section.makes & wanted) if name in held]
    if section.rate != CONTINUOUS:
        return reads
    if not section.gates:
        return [*_comment(section), *section.lines]
    condition = " and ".join(section.gates)
    otherwise = ["else:", *(f"    {line}" for line in reads)] if reads else []
    return [*_comment(section), *_under(condition, section.lines), *otherwise]


def _at_major(section: Section, held: Mapping[str, int], *, stored: bool = True) -> list[str]:
    """Write a section as it is at an event."""
    if isinstance(section, LoopSection):
        return [
            *_comment(section),
            *section.code(
                lambda inner: _at_major(inner, held, stored=False),
                lambda inner: _at_major(inner, held),
                is_kept=True,
            ),
        ]
    names = sorted(name for name in section.makes if name in held)
    condition = " and ".join((*_when(section), *section.gates))
    if not condition:
        return [*_comment(section), *section.lines]
    stores = [f"m[{held[name]}] = {name}" for name in names] if stored else []
    reads = [f"{name} = m[{held[name]}]" for name in names]
    otherwise = ["else:", *(f"    {line}" for line in reads)] if reads else []
    return [*_comment(section), *_under(condition, [*section.lines, *stores]), *otherwise]


def _when(section: Section) -> tuple[str, ...]:
    if section.rate == CONTINUOUS:
        return ()
    return ("step",) if section.rate == MAJOR else (f"hits[{section.rate}]",)


def _under(condition: str, lines: Iterable[str]) -> list[str]:
    if not condition:
        return [*lines]
    return [f"if {condition}:", *(f"    {line}" for line in lines)]


def _comment(section: Section) -> list[str]:
    title = "".join(sign if sign.isprintable() else " " for sign in section.title)
    return [f"# {title}"]


def _definition(head: str, body: Iterable[str]) -> str:
    return "\n".join((head, *(f"    {line}" for line in body)))


def _settled(lines: Sequence[str]) -> Section:
    section = Section(title="", lines=list(lines), rate=CONTINUOUS)
    section.settle()
    return section


def needed(sections: Sequence[Section], goals: Iterable[str]) -> list[Section]:
    """Select the sections that make what is wanted, in order."""
    wanted = set(goals)
    found: list[Section] = []
    for section in reversed(sections):
        if section.makes & wanted:
            wanted |= section.reads | set(section.gates)
            found.append(section)
    return found[::-1]
