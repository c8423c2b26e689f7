"""Reads a print, a table, matrices and singular postures, from TOML, CSV or text."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.files import read_text
from drake_leg.lab.grader.findings import Finding, unreadable
from drake_leg.lab.grader.matrix_text import kind_of_name, rows_of_text
from drake_leg.lab.grader.printed_text import SETTINGS, parse_table, parse_text
from drake_leg.lab.grader.tables import BRANCHING, COLUMNS, Table, TableRow
from drake_leg.robot.toml.keys import Keys, as_toml, parse_document

METERS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}  # in m
_KEYS = (*SETTINGS, "symbols", "cells", "where", "joints", "table", "matrix", "singular")
_TABLE_KEYS = ("frame", *COLUMNS["khalil"], *BRANCHING)
_MATRIX_KEYS = ("name", "caption", "rows", "where", "entries")
# Joints by their letters, and what stands for a fixed row; Khalil's own sign for that is 2.
_SIGMAS = dict.fromkeys(("r", "revolute", "rotation", "rotoid"), "0")
_SIGMAS |= dict.fromkeys(("p", "t", "prismatic", "translation"), "1")
_SIGMAS |= dict.fromkeys(("2", "f", "fixed", "fixe", "-", "–", "−", "\u223c", r"\sim", "/"), "~")


@dataclass(frozen=True, kw_only=True)
class Format:
    """A kind of file: the words of advice on where to write something in it."""

    symbol: str  # a symbol's value
    meaning: str  # a symbol's value or its formula
    joints: str  # the formula of a joint's position
    rows: str  # the names of a Jacobian's rows
    cells: str  # what a symbol stands for, of {name} and {cell}


TOML = Format(
    symbol="under [symbols]",
    meaning="a number under [symbols], a formula under [where]",
    joints="under [joints]",
    rows="under rows",
    cells='cells = {{ {name} = "{cell}" }}',
)
TEXT = Format(
    symbol="in a line of its own, as L1 = 50",
    meaning="a number or a formula in a line of its own, as a = 50",
    joints="in a line as joint,q1,q1 + 90°",
    rows="in a line as rows,J,x y z",
    cells="cells,{name},{cell}",
)


@dataclass(frozen=True, kw_only=True)
class PrintedMatrix:
    """A matrix as printed."""

    name: str  # T12, T04, J, ...
    entries: tuple[tuple[str, ...], ...]
    caption: str = ""
    rows: tuple[str, ...] = ()  # of a Jacobian: x, y, z, wx, wy, wz; empty if missing
    where: Mapping[str, str] = field(default_factory=dict)  # name to formula, for this matrix

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.entries), len(self.entries[0])


@dataclass(frozen=True, kw_only=True)
class Printed:
    """A print as typed."""

    origin: str  # name of the file
    format: Format = TOML
    angles: str | None = None  # deg or rad, of bare numbers in a table
    lengths: str | None = None  # mm, cm or m, of bare numbers
    symbols: Mapping[str, float] = field(default_factory=dict)  # name to value in these units
    cells: Mapping[str, str] = field(default_factory=dict)  # symbol to the table's cells: d2
    where: Mapping[str, str] = field(default_factory=dict)  # name to formula: sigma1 and the like
    joints: Mapping[str, str] = field(default_factory=dict)  # joint to formula of its position
    table: Table | None = None
    matrices: tuple[PrintedMatrix, ...] = ()
    singular: tuple[str, ...] = ()  # sets of singular postures
    unread: tuple[Finding, ...] = ()  # parts that make no sense

    @property
    def unit(self) -> str:
        """The unit of lengths: m if the print does not say it."""
        return self.lengths or "m"

    @property
    def meters(self) -> float:
        """The unit of lengths in m."""
        return METERS[self.unit]


def read_printed(path: Path) -> Printed:
    """Read a print from TOML, or from CSV or text if its name does not end in .toml."""
    text, where = read_text(path), str(path)
    if path.suffix.lower() == ".toml":
        return printed_of_document(parse_document(text, where), where)
    document = parse_text(text, where)
    unread = [unreadable(*part) for part in document.pop("unread", ())]
    return replace(printed_of_document(document, where, unread), format=TEXT)


def is_print(document: Mapping[str, Any]) -> bool:
    """Whether a TOML file is a print rather than a robot."""
    return "row" not in document and any(key in document for key in ("table", "matrix", "singular"))


def printed_of_document(
    document: Mapping[str, Any], where: str, unread: Sequence[Finding] = ()
) -> Printed:
    """Read a print from a file's nested tables; errors say file, key and value.

    ``where`` is the file's name, and ``unread`` what is in it and makes no sense.
    """
    keys = Keys(document, where, _KEYS, {"row": "write a printed table's rows under [[table]]"})
    angles = keys.choice("angles", ("deg", "rad")) if keys.has("angles") else None
    lengths = keys.choice("lengths", tuple(METERS)) if keys.has("lengths") else None
    table = _table(keys, angles, lengths) if keys.has("table") else None
    read = [_matrix(part, f"{where}: matrix {i}") for i, part in _parts(keys, "matrix")]
    unread = (*unread, *(part for part in read if isinstance(part, Finding)))
    singular = keys.value("singular", [])
    singular = [singular] if isinstance(singular, str) else singular
    if not isinstance(singular, list) or not all(isinstance(text, str) for text in singular):
        raise keys.error(f'singular is {as_toml(singular)}; it must be text, as "θ3 = kπ"')
    if table is None and not read and not singular:
        if where.endswith(".toml"):
            raise keys.error("there is neither a [[table]] nor a [[matrix]] in it")
        first = f"; {unread[0].sentence()}" if unread else ""
        raise keys.error(f"there is neither a table nor a matrix, as T12 = [...], in it{first}")
    numbers, names = _named(keys, "symbols")
    return Printed(
        origin=where,
        angles=angles,
        lengths=lengths,
        symbols={name: numbers.number(name, "in the file's units") for name in names},
        cells=_formulas(keys, "cells"),
        where=_formulas(keys, "where"),
        joints=_formulas(keys, "joints"),
        table=table,
        matrices=tuple(matrix for matrix in read if isinstance(matrix, PrintedMatrix)),
        singular=tuple(singular),
        unread=unread,
    )


def _parts(keys: Keys, key: str) -> list[tuple[int, object]]:
    parts = keys.value(key, [])
    if not isinstance(parts, list):
        raise keys.error(f"{key} is one table; write [[{key}]] with two brackets")
    return list(enumerate(parts, start=1))


def _named(keys: Keys, key: str) -> tuple[Keys, tuple[str, ...]]:
    """Open a table whose keys are the print's own names."""
    table = keys.value(key, {})
    names = tuple(table) if isinstance(table, dict) else ()
    return Keys(table, f"{keys.where}: {key}", names), names


def _formulas(keys: Keys, key: str) -> dict[str, str]:
    formulas, names = _named(keys, key)
    return {name: formulas.text(name) for name in names}


def _table(keys: Keys, angles: str | None, lengths: str | None) -> Table:
    rows = []
    pasted = keys.value("table")
    whole = parse_table(pasted, keys.where) if isinstance(pasted, str) else None
    for number, part in _parts(keys, "table") if whole is None else enumerate(whole, start=1):
        cells = Keys(part, f"{keys.where}: table row {number}", _TABLE_KEYS)
        texts = {key: _cell(cells, key) for key in _TABLE_KEYS if cells.has(key)}
        rows.append(TableRow(frame=texts.pop("frame", ""), cells=texts))
    return Table(rows=tuple(rows), angles=angles, lengths=lengths)


def _cell(keys: Keys, key: str) -> str:
    value = keys.value(key)
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise keys.error(f"{key} is {as_toml(value)}; it must be text or a number")
    text = str(value)
    return _SIGMAS.get(text.strip(" $").casefold(), text) if key == "sigma" else text


def _matrix(part: object, where: str) -> PrintedMatrix | Finding:
    """Read one matrix, or return a finding about what is wrong with its rows."""
    called = part.get("name", "") if isinstance(part, dict) else ""
    keys = Keys(part, f"{where} ({called})" if called else where, _MATRIX_KEYS)
    name = keys.text("name")
    entries = keys.value("entries", remedy="its rows are lists of text: [[..., ...], [..., ...]]")
    if isinstance(entries, list) and entries and all(isinstance(row, str) for row in entries):
        entries = "\n".join(entries)
    if isinstance(entries, str):
        try:
            entries = _pasted(name, entries)
        except InvalidValueError as error:
            return unreadable(name, error, name)
    if not isinstance(entries, list) or not entries:
        raise keys.error("entries is not a list of rows")
    for row in entries:
        if not isinstance(row, list) or not row:
            raise keys.error(f"the row {as_toml(row)} is not a list of entries")
        if len(row) != len(entries[0]):
            fault = f"the row {as_toml(row)} is not as long as the first one; write all its entries"
            return unreadable(name, fault, name)
    rows = keys.value("rows", [])
    if isinstance(rows, str):
        rows = rows.replace(",", " ").split()
    if not isinstance(rows, list) or not all(isinstance(row, str) for row in rows):
        raise keys.error(f"rows is {as_toml(rows)}; it must be a list of text, as x, y, yaw")
    return PrintedMatrix(
        name=name,
        entries=tuple(tuple(_entry(keys, cell) for cell in row) for row in entries),
        caption=keys.text("caption", ""),
        rows=tuple(rows),
        where=_formulas(keys, "where"),
    )


def _pasted(name: str, text: str) -> list[list[str]]:
    """Split a pasted matrix into its rows; a determinant is one entry, a position a column."""
    kind = kind_of_name(name)
    if kind == "determinant":
        return [[text]]
    if kind == "position" and not re.search(r"[;&|\t{]|^\s*\[|,(?!\d)", text):
        return [[line] for line in text.splitlines() if line.strip()]
    return rows_of_text(text, column=kind == "position")


def _entry(keys: Keys, cell: object) -> str:
    if isinstance(cell, bool) or not isinstance(cell, str | int | float):
        raise keys.error(f"the entry {as_toml(cell)} is neither text nor a number")
    return str(cell)
