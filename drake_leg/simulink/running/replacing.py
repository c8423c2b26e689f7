"""Blocks of a model replaced by what a person says that they put out."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from drake_leg.arguments import with_article
from drake_leg.errors import InvalidValueError
from drake_leg.files import read_text
from drake_leg.simulink.model import Block, Model, Parameters
from drake_leg.simulink.subsystems import block_named, inside

REPLACED = "Replaced"  # the type of a block that is replaced
CONSTANT = "constant"
LARGEST_TABLE = 256 << 20  # bytes
PHYSICAL = ("fl_lib/", "nesl_utility/", "sm_lib/")

Table = tuple[tuple[float, ...], ...]  # rows of time [s] and values


def replaced(model: Model, replacements: Mapping[str, str]) -> Model:
    """Let blocks put out something else: ``constant 0``, or a table from a CSV file.

    What a subsystem or a chart holds goes with it.

    Raises
    ------
    InvalidValueError
        If no block, or several, have such a name, or it is none of signals, or what it is to put
        out is neither.
    """
    found = {_block_of(model, name).sid: (name, text) for name, text in replacements.items()}
    if not found:
        return model
    gone = inside(model, frozenset(found))
    blocks = tuple(
        _put(block, *found[block.sid]) if block.sid in found else block
        for block in model.blocks
        if block.sid not in gone
    )
    return replace(
        model,
        blocks=blocks,
        wires=tuple(wire for wire in model.wires if _sid(wire.source) not in gone),
        nodes=tuple(node for node in model.nodes if not any(_sid(each) in gone for each in node)),
        functions=tuple(
            function
            for function in model.functions
            if function.sid not in gone and function.sid not in found
        ),
    )


def _sid(port: str) -> str:
    return port.partition("#")[0]


def _block_of(model: Model, name: str) -> Block:
    block = block_named(name, among=model.blocks, aim="block to replace")
    is_physical = block.unknown and any(_sid(port) == block.sid for n in model.nodes for port in n)
    if is_physical or block.source.startswith(PHYSICAL):
        raise InvalidValueError(
            f"the block {name!r} is {with_article(block.kind)}, which is physical: only blocks "
            "of signals can be replaced"
        )
    return block


def _put(block: Block, name: str, text: str) -> Block:
    given = block.parameters
    parameters = Parameters(given.evaluate if isinstance(given, Parameters) else None)
    word, _, value = text.strip().partition(" ")
    if word == CONSTANT and value.strip():
        parameters.texts["Value"] = value.strip()
    elif text.strip().lower().endswith(".csv"):
        parameters.add("Table", table_of(Path(text.strip())))
    else:
        raise InvalidValueError(
            f"the block {name!r} cannot put out {text!r}",
            advice=f"write '{name}={CONSTANT} 0', or '{name}=FILE.csv'",
        )
    return replace(
        block, type=REPLACED, source="", mask=(), unknown="", parameters=parameters, ports={}
    )


def table_of(path: Path) -> Table:
    """Read a table of time and values, one row a line; a first line of names is left out.

    Raises
    ------
    InvalidValueError
        With the line that is wrong.
    """
    rows: list[tuple[float, ...]] = []
    lines = csv.reader(read_text(path, most=LARGEST_TABLE).splitlines())
    for number, words in enumerate(lines, start=1):
        if not words:
            continue
        try:
            row = tuple(float(word) for word in words)
        except ValueError:
            if number == 1:
                continue
            raise InvalidValueError(f"{path}, line {number}: not all are numbers") from None
        if not all(map(math.isfinite, row)):
            raise InvalidValueError(f"{path}, line {number}: not all are finite")
        if len(row) < 2 or (rows and len(row) != len(rows[0])):
            wanted = f"{len(rows[0])} numbers" if rows else "a time and a value at least"
            raise InvalidValueError(f"{path}, line {number}: it must have {wanted}")
        if rows and row[0] <= rows[-1][0]:
            raise InvalidValueError(f"{path}, line {number}: the times must rise")
        rows.append(row)
    if not rows:
        raise InvalidValueError(f"{path} has no rows of time and values")
    return tuple(rows)
