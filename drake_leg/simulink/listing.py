"""A model as lines for a person, and as JSON."""

from __future__ import annotations

import math
import re
import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from drake_leg.arguments import printable, some_of
from drake_leg.errors import UnknownValueError
from drake_leg.simulink.lacks import lacks_of
from drake_leg.simulink.model import Block, Model, Value, split_port
from drake_leg.simulink.parameters import default_values
from drake_leg.simulink.suggestions import suggested_init

_WIDTH = 100
_LONGEST_TEXT = 60
_UNITS = "Units"
PLACES = 3  # where something is used, that are told


def as_json(model: Model) -> dict[str, Any]:
    """Return a model as JSON can hold it: numbers in SI, infinite ones as ``inf`` or ``-inf``.

    A value that is not known is null, and ``lacks`` has its text and the reason where the block
    uses it.
    """
    lacks = lacks_of(model)
    hint = suggested_init(model, lacks)
    return {
        "blocks": [
            {
                "sid": block.sid,
                "name": block.name,
                "type": block.type,
                "source": block.source,
                "system": block.system,
                "parameters": _plain_values(block.parameters),
            }
            for block in model.blocks
        ],
        "wires": [
            {"from": wire.source, "to": wire.target, "name": wire.name} for wire in model.wires
        ],
        "nodes": [list(node) for node in model.nodes],
        "functions": [
            {"sid": function.sid, "name": function.name, "script": function.script}
            for function in model.functions
        ],
        "solver": _plain_values(model.solver),
        "variables": _variables(model),
        "skipped": [] if model.variables is None else _skipped(model),
        "init": None
        if hint is None
        else {
            "file": str(hint.path),
            "names": list(hint.names),
            "others": [str(path) for path in hint.others],
        },
        "lacks": [
            {
                "sid": lack.sid,
                "parameter": lack.parameter,
                "text": lack.text,
                "names": list(lack.names),
                "reason": lack.reason,
            }
            for lack in lacks
        ],
    }


def _variables(model: Model) -> dict[str, str]:
    """Variables that the model uses, each with its source."""
    return dict(model.variables.used) if model.variables else {}


def _skipped(model: Model) -> list[str]:
    """What scripts do that is not done here."""
    skipped = model.variables.workspace.skipped if model.variables else []
    return [str(one) for one in skipped]


def _plain_values(values: Mapping[str, Value]) -> dict[str, Any]:
    return {name: _plain_value(values, name) for name in values}


def _plain_value(values: Mapping[str, Value], name: str) -> Any:  # noqa: ANN401
    """Value of a parameter, None where it is not known, be it used or not."""
    try:
        return plain(values[name])
    except UnknownValueError:
        return None


def as_summary(model: Model) -> list[str]:
    """Return what a model is and what it lacks: its kinds of blocks, and what is not understood."""
    kinds = Counter(printable(block.kind) for block in model.blocks)
    charts = sum(function.is_chart for function in model.functions)
    counts = (
        (len(model.blocks), "block"),
        (len(model.wires), "wire"),
        (len(model.nodes), "physical connection"),
        (len(model.functions) - charts, "MATLAB function"),
        *([(charts, "chart")] if charts else []),
    )
    lines = [f"{printable(model.name)}: {', '.join(_counted(*count) for count in counts)}", ""]
    shown = [f"{kind} {number}" if number > 1 else kind for kind, number in kinds.most_common()]
    lines += [*_wrapped("kinds   ", ", ".join(shown), 8), *_solver(model)]
    lacking = _lacking(model)  # evaluates all values, so that all that is used is known
    return [*lines, *_sources(model), "", *lacking]


def _sources(model: Model) -> list[str]:
    """Say where the variables come from that the model uses, and what scripts leave out."""
    counts = Counter(re.sub(r", line \d+$", "", one) for one in _variables(model).values())
    shown = [f"{printable(source)} ({count})" for source, count in counts.most_common()]
    lines = _wrapped("values  ", ", ".join(shown), 8) if shown else []
    skipped = _skipped(model)
    if skipped:
        lines += _wrapped("skipped ", printable(some_of(skipped, PLACES, "; ")), 8)
    return lines


def _solver(model: Model) -> list[str]:
    shown = ", ".join(f"{key} {_held(model.solver, key)}" for key in model.solver)
    return _wrapped("solver  ", shown, 8)


@dataclass(frozen=True, kw_only=True)
class NotUnderstood:
    """What is not understood of a model, grouped as a person would mend it."""

    count: int
    kinds: Mapping[str, Sequence[str]]  # of blocks, to the blocks
    names: Mapping[str, Sequence[str]]  # without a value, to what uses them
    others: Sequence[str]  # sentences
    sids: frozenset[str]  # of the blocks of all these


def not_understood(model: Model) -> NotUnderstood:
    """Group what is not understood of a model."""
    lacks, paths = lacks_of(model), block_paths(model)
    kinds: dict[str, list[str]] = {}
    names: dict[str, list[str]] = {}
    others: list[str] = []
    for lack in lacks:
        at = f"{paths[lack.sid]!r}" if lack.sid else "the solver"
        if not lack.parameter:
            kinds.setdefault(lack.text, []).append(at)
        elif lack.names:
            for name in lack.names:
                names.setdefault(name, []).append(f"{at} {lack.parameter}")
        else:
            others.append(lack.reason)
    return NotUnderstood(
        count=len(lacks),
        kinds=kinds,
        names=names,
        others=others,
        sids=frozenset(lack.sid for lack in lacks if lack.sid),
    )


def _lacking(model: Model) -> list[str]:
    """Return what is not understood: kinds of blocks, names without a value, other values."""
    lacking = not_understood(model)
    if not lacking.count:
        return ["everything is understood as data; whether it runs, `drake-leg run` tells"]
    lines = [f"not understood: {lacking.count}"]
    for title, found in (
        ("kinds of blocks", lacking.kinds),
        ("names without a value", lacking.names),
    ):
        if found:
            rows = [
                (f"  {printable(name)}", some_of(places, PLACES)) for name, places in found.items()
            ]
            lines += ["", f"{title} ({len(found)})", *_table(("  name", "used by"), rows)[1:]]
    if lacking.others:
        lines += ["", f"other values ({len(lacking.others)})"]
        for reason in lacking.others:
            lines += _wrapped("  ", printable(reason), 4)
    return lines


def as_lines(model: Model) -> list[str]:
    """Return a model as tables; of the blocks' settings, those that are not the default."""
    names = block_paths(model)
    blocks = [
        (block.sid, names[block.sid], printable(block.kind), ", ".join(_settings(block)))
        for block in model.blocks
    ]
    wires = [
        (_port(wire.source, names), "->", _port(wire.target, names), printable(wire.name))
        for wire in model.wires
    ]
    lines = [f"{printable(model.name)}: {_counted(len(blocks), 'block')}", ""]
    lines += _table(("SID", "block", "kind", "settings that are not the default, in SI"), blocks)
    lines += ["", _counted(len(wires), "wire"), *_table(("from", "", "to", "signal"), wires)]
    lines += ["", _counted(len(model.nodes), "physical connection")]
    for node in model.nodes:
        lines += _wrapped("", " - ".join(_port(port, names) for port in node), 2)
    for function in model.functions:
        lines += ["", f"code of {names[function.sid]} (SID {function.sid})"]
        code = function.script or "(none in the file)"
        lines += [f"  {printable(row.expandtabs(4))}" for row in code.strip("\n").splitlines()]
    lacking = _lacking(model)
    return [*lines, "", *_solver(model), *_sources(model), "", *lacking]


def block_paths(model: Model) -> dict[str, str]:
    """Map a block's SID to its path: names of its subsystems and its own, a slash between."""
    blocks = {block.sid: block for block in model.blocks}
    names: dict[str, str] = {}
    for block in model.blocks:
        above = f"{names[block.system]}/" if block.system in blocks else ""
        names[block.sid] = above + (printable(block.name) or f"SID {block.sid}")
    return names


def _settings(block: Block) -> list[str]:
    defaults = default_values(block.type, block.source)
    return [
        " ".join(
            filter(
                None,
                (name, _held(block.parameters, name), str(block.parameters.get(name + _UNITS, ""))),
            )
        )
        for name in block.parameters
        if (name in block.mask or _is_telling(block.parameters, name, defaults))
        and name != "SFBlockType"
    ]


def _held(values: Mapping[str, Value], name: str) -> str:
    """Show a value, or the text of one that is not known."""
    try:
        return _shown(values[name])
    except UnknownValueError as error:
        return f"({_shown(error.text)}: not known)"


def _is_telling(values: Mapping[str, Value], name: str, defaults: Mapping[str, Value]) -> bool:
    try:
        value = values[name]
    except UnknownValueError:
        return True
    if name in defaults:
        return value != defaults[name]
    return not isinstance(value, str)


def _port(port: str, names: dict[str, str]) -> str:
    sid, kind, number = split_port(port)
    place = str(number) if kind in ("in", "out") else f"{kind} {number}"
    return f"{names[sid]} ({place})"


def _shown(value: Value) -> str:
    if isinstance(value, str):
        text = printable(value)
        return text if len(text) <= _LONGEST_TEXT else f"{text[: _LONGEST_TEXT - 3]}..."
    if not isinstance(value, tuple):
        return f"{value:.6g}"
    rows = [row if isinstance(row, tuple) else (row,) for row in value]
    flat = not any(isinstance(row, tuple) for row in value)
    separator = " " if flat else "; "
    return f"[{separator.join(' '.join(f'{entry:.6g}' for entry in row) for row in rows)}]"


def plain(value: object) -> object:
    """Return what JSON can hold: lists for tuples, text for numbers that are not finite."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Align all columns but the last, which continues on the next lines."""
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)][:-1]
    lines = []
    for row in (head, *rows):
        first = "".join(f"{cell:<{width}}  " for cell, width in zip(row, widths, strict=False))
        lines += _wrapped(first, row[-1], len(first))
    return lines


def _wrapped(first: str, text: str, indent: int) -> list[str]:
    width = max(_WIDTH, indent + 40)
    rest = " " * indent
    folded = textwrap.wrap(
        text, width - indent, break_long_words=False, break_on_hyphens=False
    ) or [""]
    lines = [(first or rest) + folded[0], *(rest + line for line in folded[1:])]
    return [line.rstrip() for line in lines]
