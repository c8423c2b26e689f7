"""Reads a print typed as text: CSV, columns separated by tabs or bars, or pasted matrices.

``angles,deg`` and ``lengths,mm`` say the units; two cells of which the second is a number give a
symbol its value (``L1,50``), otherwise its formula (``sigma1,2*cos(θ2)+1``). Three cells that
begin with ``joint``, ``cells``, ``caption`` or ``rows`` say something about a joint, a symbol or a
matrix, and ``singular,θ3 = kπ`` where the determinant is zero. A heading with σ, d, α, r, θ begins
a table, which an empty line ends. ``T01 = [...]``, in LaTeX, MATLAB or Python, is a matrix,
``L1 = 50`` a symbol. Every other line is a row of a matrix, its name first. Each line has its own
delimiter; a line that makes no sense is left out and reported.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.claims import kind_of_name
from drake_leg.lab.grader.matrix_text import spaced_cells
from drake_leg.robot.toml_keys import Document
from drake_leg.symbolic.spelling import quoted

_COLUMNS = ("sigma", "d", "alpha", "r", "theta")
_SETTINGS = ("title", "angles", "lengths")
_FRAME_WORDS = ("frame", "number", "i", "j", "row", "link", "joint", "n", "#")
_SPELLINGS = {"α": "alpha", "σ": "sigma", "θ": "theta", "ϑ": "theta"}
_STATEMENT = re.compile(
    r"\s*(?:\$\$?|\\\[|\\\()?\s*(?P<name>[^=;\t]{1,60}?)\s*+&?\s*+:?=(?P<rest>.*)$"
)
_HEADED = re.compile(r"\s*(?P<name>[^=,;\t:]{1,40}?)\s*+:(?!=)(?P<rest>.*)$")  # T12: and its rows
_OPENING = re.compile(
    r"\\begin\s*\{[a-z]*(?:matrix|array|tabular)|[\[⎡]|(?:(?<==)|^)\s*\{|"
    r"\b(?:[A-Za-z]+\.)?(?:Immutable|Mutable)?(?:Dense)?(?:Matrix|matrix|array|sym)\s*\("
)
_LAYOUT = re.compile(
    r"\\(?:begin|end)\s*\{(?:align|aligned|equation|gather|gathered|split|multline|eqnarray|"
    r"displaymath|math|center|document)(?:ed)?\*?\}|\\(?:nonumber|notag)\b|\\label\{[^{}]*\}"
)
_FENCE = re.compile(r"\s*(?:```.*|~~~.*|\$\$|\\\[|\\\])\s*$")
_EMPHASIS = re.compile(r"^(\s*)(\*\*|__|`)([^*`]{1,40}?)\2(?=\s*[:=]|\s*$)")
_COMMENT = re.compile(r"(?<=\S)\s*(?<!\\)(?:%|(?<![\w)])//|#(?!\s*[|,;\t])).*$")
_PROSE = re.compile(r"(?:[^\W\d_]+[-'.,:!?()]* +){2,}[^\W\d_]+[-'.,:!?()]*")
_EQUATION = re.compile(r"\s*+([^=,;\t|&]{1,40}?)\s*+&?\s*+:?=(.*[^\s;].*)$")
_SINGULAR = re.compile(
    r"\s*\$?(?:\\?det\b|\|)[^=]{1,20}=\s*0\s*"
    r"(?:(?:when|if|iff|for|where|at|si|pour|lorsque|quand)\b|[⇔⟺⇒⟹]|<?=>|\\[a-zA-Z]+)"
)
_DETERMINANT = re.compile(r"\s*(\|[^|=]{1,20}\|)\s*[,;=\t]\s*(.+)")
_SETTING = re.compile(r"(title|angles|lengths)\s*+[,;\t:=](.+)$", re.IGNORECASE)
_SINGULAR_LINE = re.compile(
    r"singular(?:ity|ities)?(?: postures?| positions?| configurations?)?\s*[,;\t:=]\s*(.+)$",
    re.IGNORECASE,
)
_JOINING = re.compile(r"^\s*(?:with|where|and|avec|où|et|let)\s+")
_NAME = re.compile(r"\s*[^\W\d][\w{}\\^]*\s*")
_RULE = re.compile(r"[\s|:+-]*-[\s|:+-]*$")
_LONGEST_BLOCK = 60  # lines
_LONGEST_LINE = 10_000  # characters in which a matrix may begin
_COMMENTS = ("#", "%", "//")


def parse_text(text: str, where: str) -> Document:
    """Read text into the tables that a TOML file would have.

    Under ``unread`` are the lines that make no sense, each with its place and a sentence. A table's
    row that does not fit its heading is refused, ``where`` being the file's name.
    """
    document = _Document()
    for statement in _Statements(where).of_lines(text.splitlines()):
        document.add(statement)
    return document.content


def parse_table(text: str, where: str) -> list[dict[str, str]]:
    """Read a pasted table with its heading, column to cell; refuse any line that makes no sense.

    Its columns are separated by bars, commas, semicolons, tabs or spaces.
    """
    document = parse_text(text.strip(), f"{where}: table")
    for place, sentence in document.get("unread", ()):
        raise InvalidValueError(f"{where}: table, {place}: {sentence}")
    rows: list[dict[str, str]] = document.get("table", [])
    if not rows:
        raise InvalidValueError(f"{where}: table has no heading; write i | σ | d | α | r | θ above")
    return rows


class _Statement(NamedTuple):
    """What one line, or several that belong together, say."""

    kind: Literal["matrix", "row", "pair", "table", "singular", "remark", "unread"]
    line: int
    name: str = ""  # of a matrix or a symbol; joint, cells, caption or rows of a remark
    text: str = ""
    cells: Sequence[str] = ()
    row: Mapping[str, str] = MappingProxyType({})  # of a table, column to cell


class _Statements:
    """Reads statements from lines, of which a table's heading holds for those below it."""

    def __init__(self, where: str) -> None:
        self._where = where
        self._heading: list[str] | None = None
        self._sign = ","  # that separates the table's cells

    def of_lines(self, lines: Sequence[str]) -> Iterator[_Statement]:
        """Read a whole text."""
        lines = [_tidy(line) for line in lines]
        at = 0
        while at < len(lines):
            line, number = lines[at], at + 1
            found = _block_begins(line)
            if found:
                name, rest = found
                end = _end_of_block(lines, at, rest)
                text = "\n".join([rest, *lines[at + 1 : end]])
                yield _Statement("matrix", number, name, text)
                self._heading = None
                at = end
                continue
            at += 1
            if _SINGULAR.match(line):
                yield _Statement("singular", number, text=line)
            elif bars := _DETERMINANT.match(line):
                yield _Statement("matrix", number, bars[1], bars[2])
            elif not _RULE.match(line):
                yield from self._of_line(line, number)

    def _of_line(self, line: str, number: int) -> Iterator[_Statement]:
        bare = line.strip()
        if self._heading is None and not bare.startswith(_COMMENTS):
            if setting := _SETTING.match(bare):
                yield _Statement("pair", number, setting[1], setting[2].strip(" ,;\t"))
                return
            if singular := _SINGULAR_LINE.match(bare):
                yield _Statement("singular", number, text=singular[1].strip(' "'))
                return
            equations = _equations(bare)
            for name, value in equations:
                yield from _of_equation(name, value, number)
            if equations or _is_prose(bare):
                return
        sign = self._sign if self._heading and self._sign in line else _delimiter(line)
        try:
            (cells,) = csv.reader([line], delimiter=sign, skipinitialspace=True)
        except csv.Error as error:
            yield _Statement("unread", number, text=f"{error}; write it in several lines")
            return
        cells = [cell.strip() for cell in cells]
        if sign == "|" and len(cells) > 2:  # the bars that begin and end a Markdown line
            cells = cells[cells[0] == "" : len(cells) - (cells[-1] == "")]
        yield from self._of_cells(cells, number, sign)

    def _of_cells(self, cells: list[str], number: int, sign: str) -> Iterator[_Statement]:
        if not any(cells):
            self._heading = None
            return
        if cells[0].startswith(_COMMENTS) and not _is_heading(cells):
            return
        if len(cells) == 1:
            cells = self._spaced(cells[0])
        first, *others = cells
        if re.fullmatch("singular(?:ity|ities)?", first.casefold()):
            yield _Statement("singular", number, text=", ".join(others))
        elif _is_heading(cells):
            self._heading, self._sign = [_column(cell) for cell in cells], sign
        elif self._heading is not None:
            yield self._table_row(cells, number)
        elif len(cells) == 2 and not _has_columns_of_one(first, others[0]):
            yield _Statement("pair", number, first, others[0])
        elif len(cells) == 3 and first in ("joint", "cells", "caption", "rows"):
            yield _Statement("remark", number, first, cells=others)
        elif others:
            yield _Statement("row", number, first, cells=others)
        else:
            sentence = (
                f"{quoted(first)} is alone on its line; a line has a name and what belongs to it, "
                "separated by =, commas, semicolons or tabs"
            )
            yield _Statement("unread", number, text=sentence)

    def _spaced(self, line: str) -> list[str]:
        """Split a line at its spaces where it is a table's."""
        words = spaced_cells(line)
        if self._heading is not None and len(words) == len(self._heading):
            return words
        return line.split() if _is_heading(line.split()) else [line]

    def _table_row(self, cells: list[str], number: int) -> _Statement:
        heading = self._heading or []
        if len(cells) != len(heading):
            raise InvalidValueError(
                f"{self._where}, line {number}: the table's row has {len(cells)} cells and its "
                f"heading {len(heading)}; an empty line ends a table"
            )
        row = {column: cell for column, cell in zip(heading, cells, strict=True) if column}
        return _Statement("table", number, row=row)


def _of_equation(name: str, value: str, line: int) -> Iterator[_Statement]:
    """Read ``name = value``."""
    kind = kind_of_name(name)
    if kind in ("transform", "rotation") and re.search(r"[TtHhR]", name) and not _number(value):
        sentence = f"{quoted(name)} is given as {quoted(value, 30)}; write the resulting matrix, "
        yield _Statement("unread", line, text=sentence + "in brackets")
    elif _has_columns_of_one(name, value):
        yield _Statement("matrix", line, name, value)
    elif not all(map(_NAME.fullmatch, value.split("=")[:-1])):
        sentence = f"{quoted(name)} has several signs of equality; write the last"
        yield _Statement("unread", line, text=sentence)
    else:
        *others, last = value.split("=")
        for one in (name, *others):
            yield _Statement("pair", line, one.strip(), last.strip())


class _Document:
    """The tables of a file, filled statement by statement."""

    def __init__(self) -> None:
        self.content: Document = {}
        self._matrices: dict[str, list[dict[str, Any]]] = {}
        self._last = ""  # name of the matrix whose rows are directly above

    def add(self, statement: _Statement) -> None:
        """Add a statement under the same keys as in TOML."""
        name, content = statement.name, self.content
        match statement.kind:
            case "matrix":
                self._matrix(name, new=True)["entries"] = statement.text
                self._last = ""
            case "row":
                self._add_row(statement)
            case "pair":
                self._add_pair(statement)
            case "table":
                content.setdefault("table", []).append(dict(statement.row))
            case "singular":
                content.setdefault("singular", []).append(statement.text)
            case "remark":
                self._add_remark(name, *statement.cells)
            case "unread":
                self._leave_out(statement.line, statement.text)

    def _matrix(self, name: str, *, new: bool = False) -> dict[str, Any]:
        """Return the last matrix of a name; a new one if it has entries and may have none."""
        known = self._matrices.setdefault(name, [])
        if not known or (new and "entries" in known[-1]):
            former = known[-1] if known else {"name": name}
            known.append({key: value for key, value in former.items() if key != "entries"})
            self.content.setdefault("matrix", []).append(known[-1])
        return known[-1]

    def _add_row(self, statement: _Statement) -> None:
        """Read a row of a matrix; rows apart from others are another's."""
        name = statement.name
        if isinstance(self._matrix(name).get("entries"), str):
            self._leave_out(
                statement.line, f"{name} is already written above as a whole; write it once"
            )
            return
        matrix = self._matrix(name, new=self._last != name)
        matrix.setdefault("entries", []).append(list(statement.cells))
        self._last = name

    def _add_pair(self, statement: _Statement) -> None:
        name, value = statement.name, statement.text.strip()
        if name.casefold() in _SETTINGS:
            self.content[name.casefold()] = value.strip("\"'")
            return
        number = _number(value)
        kind, said = ("where", value) if number is None else ("symbols", number)
        known = {**self.content.get("symbols", {}), **self.content.get("where", {})}
        if name in known and known[name] != said:
            sentence = f"{name} already has another value above; write it once"
            self._leave_out(statement.line, sentence)
        else:
            self.content.setdefault(kind, {})[name] = said

    def _add_remark(self, what: str, name: str, value: str) -> None:
        if what in ("joint", "cells"):
            key = "joints" if what == "joint" else "cells"
            self.content.setdefault(key, {})[name] = value
        elif what == "caption":
            self._matrix(name)["caption"] = value
        else:
            self._matrix(name)
            for matrix in self._matrices[name]:
                matrix["rows"] = value.split()

    def _leave_out(self, line: int, sentence: str) -> None:
        """Record that a line makes no sense."""
        self.content.setdefault("unread", []).append((f"line {line}", sentence))


def _tidy(line: str) -> str:
    """Remove the markup of text, LaTeX or Markdown around a statement."""
    if _FENCE.match(line):
        return ""
    if line.lstrip().startswith(_COMMENTS) or len(line) > _LONGEST_LINE:
        return line
    return _EMPHASIS.sub(r"\1\3", _LAYOUT.sub("", _COMMENT.sub("", line)))


def _block_begins(line: str) -> tuple[str, str] | None:
    """Return the name of a matrix that begins on a line, and what follows its last =."""
    if len(line) > _LONGEST_LINE or line.lstrip().startswith(_COMMENTS):
        return None
    found = _STATEMENT.match(line)
    if not found:
        found = _HEADED.match(line)
        if not found or not kind_of_name(found["name"]):
            return None
    name, rest = found["name"].strip(), found["rest"].strip()
    kind = kind_of_name(name)
    opening = _OPENING.search(rest)
    if kind == "determinant":
        return (name, rest) if not rest or re.match(r"[\[⎡]", rest) else None
    if opening and "=" in rest[: opening.start()]:
        rest = rest[rest.rindex("=", 0, opening.start()) + 1 :].strip()
    if kind:
        begins = opening or not rest or rest == "\\" or rest.startswith("(")
        return (name, re.sub(r"(?<!\\)\\$", "", rest)) if begins else None
    several = re.search(
        r"[,;&]|\]\s*,?\s*\[|\\begin|(?:Matrix|matrix|array|sym)\s*\(|\[[^\]]*$", rest
    )
    is_matrix = opening and not rest[: opening.start()].strip() and several
    return (name, rest) if is_matrix and _is_name(name) else None


def _is_name(text: str) -> bool:
    """Whether a text is short enough for the name of a matrix."""
    settings = (*_SETTINGS, "singular", "joint", "rows", "caption", "cells")
    return not re.search(r"[,|&]", text) and len(text.split()) < 4 and text not in settings


def _end_of_block(lines: list[str], at: int, rest: str) -> int:
    """Find the line behind a matrix: where its brackets are closed, or an empty one."""
    block = rest
    for end in range(at + 1, min(at + _LONGEST_BLOCK, len(lines) + 1)):
        latex = block.count(r"\begin") or block.count("⎡")
        closed = block.count(r"\end") if r"\begin" in block else block.count("⎦")
        opened = sum(map(block.count, "([{")) - sum(map(block.count, ")]}"))
        if block.strip() and ((latex and closed >= latex) or (not latex and rest and opened <= 0)):
            return end
        if end == len(lines) or _begins_anew(lines[end]):
            return end
        is_open = opened > 0 or (latex and closed < latex)
        if not lines[end].strip() and block.strip() and not is_open:
            return end
        block += "\n" + lines[end]
    return at + 1


def _begins_anew(line: str) -> bool:
    """Whether a line begins another statement."""
    if re.match(
        r"\s*(?:title|angles|lengths|joint|cells|caption|rows|singular\w*)\s*[,;\t=:]", line
    ):
        return True
    found = _STATEMENT.match(line)
    return found is not None and not found["name"].strip().startswith(("dtype", ")", "]", "[", "&"))


def _delimiter(line: str) -> str:
    """Find the sign that separates a line's cells: of a heading all, otherwise the first."""
    for sign in "\t|;,":
        if _is_heading(line.split(sign)):
            return sign
    if line.lstrip().startswith("|"):
        return "|"
    depth = 0
    for letter in line:
        depth += (letter in "([{") - (letter in ")]}")
        if letter in ",;\t|" and depth <= 0:
            return letter
    return ","


def _equations(line: str) -> list[tuple[str, str]]:
    """Read ``L1 = 50, L2 = 100;`` as two; nothing where = is behind a line's first delimiter."""
    line = re.sub(
        r"^(?:\$\$?|\\\[|\\\()|(?:\$\$?|\\\]|\\\))[.,;]?$|\\\\$", "", line.strip()
    ).strip()
    found = _EQUATION.match(line)
    if not found or len(line) > _LONGEST_LINE:
        return []
    parts = [_EQUATION.match(part) for part in re.split(r"[,;]", line) if part.strip()]
    if all(parts):
        return [(_JOINING.sub("", part[1]), part[2].strip(" ;\t")) for part in parts if part]
    return [(found[1], found[2].strip(" ;\t"))]


def _is_prose(line: str) -> bool:
    """Whether a line is words alone, that claim nothing, and no heading."""
    if not _PROSE.fullmatch(line) or "singular" in line.casefold():
        return False
    return not _is_heading(line.split())


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _has_columns_of_one(name: str, value: str) -> bool:
    """Whether a row of one entry makes sense: a2 and r01 may be lengths, and p1 with a number."""
    kind = kind_of_name(name)
    if kind == "position" and len(re.findall(r"\d", name)) == 1:
        return _number(value) is None
    return kind in ("position", "jacobian", "determinant")


def _is_heading(cells: Iterable[str]) -> bool:
    """Whether cells name all columns of a table."""
    return set(_COLUMNS) <= set(map(_column, cells))


def _column(heading: str) -> str:
    """Recognise a column by the last word of its heading: ``Angle around Z, ϑ`` is theta."""
    words = re.sub(r"[$\\{}]|\([^()]*\)|\[[^\[\]]*\]", "", heading).casefold()
    last = re.split(r"[\s,;]+", words.strip(" ,;"))[-1]
    last = re.sub(r"(?:_[a-z]?(?:-1|\+1)?|[ᵢⱼ])$", "", last)
    last = re.sub(r"^(.|sigma|alpha|theta)[ijn](?:-1)?$", r"\1", last)  # σj
    last = _SPELLINGS.get(last, last)
    if last in _COLUMNS:
        return last
    return "frame" if last in _FRAME_WORDS else ""
