"""A model as lines for a person, and as JSON."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from drake_leg.simulink.model import Block, Model, Value, split_port
from drake_leg.simulink.parameters import default_values

_WIDTH = 100
_LONGEST_TEXT = 60
_UNITS = "Units"


def as_json(model: Model) -> dict[str, Any]:
    """Return a model as JSON can hold it: numbers in SI, infinite ones as ``inf`` or ``-inf``."""
    return {
        "blocks": [
            {
                "sid": block.sid,
                "name": block.name,
                "type": block.type,
                "source": block.source,
                "system": block.system,
                "parameters": plain(dict(block.parameters)),
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
        "solver": plain(dict(model.solver)),
    }


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
    solver = [f"{key} {_shown(value)}" for key, value in model.solver.items()]
    return [*lines, "", *_wrapped("solver  ", ", ".join(solver), 8)]


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
            filter(None, (name, _shown(value), str(block.parameters.get(f"{name}{_UNITS}", ""))))
        )
        for name, value in block.parameters.items()
        if (name in block.mask or _is_telling(name, value, defaults)) and name != "SFBlockType"
    ]


def _is_telling(name: str, value: Value, defaults: Mapping[str, Value]) -> bool:
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


def printable(text: str) -> str:
    """Write control characters out, so that a name cannot speak to the terminal."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else f"\\x{ord(sign):02x}" for sign in text)


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
