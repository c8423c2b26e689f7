"""Text of a print, read into the tables that a TOML file would have.

``angles,deg`` and ``lengths,mm`` say the units; two cells of which the second is a number
give a symbol its value (``L1,50``), otherwise its formula (``sigma1,2*cos(θ2)+1``). Three cells
that begin with ``joint``, ``cells``, ``caption`` or ``rows`` say something about a joint, a symbol
or a matrix, and ``singular,θ3 = kπ`` where the determinant is zero. A heading with σ, d, α, r, θ
begins a table, which an empty line ends. ``T01 = [...]``, in LaTeX, MATLAB or Python, is a matrix,
``L1 = 50`` a symbol. Every other line is a row of a matrix, its name first. Each line has its own
delimiter; a line that makes no sense is left out and reported.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.matrix_text import kind_of_name, spaced_cells
from drake_leg.lab.grader.tables import column_named, delimiter_of, is_heading
from drake_leg.robot.toml.keys import Document
from drake_leg.symbolic.spelling import quoted

SETTINGS = ("title", "angles", "lengths")
_REMARKS = ("joint", "cells", "caption", "rows")
_STATEMENT = re.compile(
    r"\s*(?:\$\$?|\\\[|\\\()?\s*(?P<name>[^=;\t]{1,60}?)\s*+&?\s*+:?=(?P<rest>.*)$"
)
_HEADED = re.compile(r"\s*(?P<name>[^=,;\t:]{1,40}?)\s*+:(?!=)(?P<rest>.*)$")  # T12: and its rows
_BEGINS_ANEW = re.compile(
    r"\s*(?:title|angles|lengths|joint|cells|caption|rows|singular\w*)\s*[,;\t=:]"
)
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
    return _TextReader(where).document(text.splitlines())


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


class _TextReader:
    """Reads a text line by line; a table's heading holds for the lines below it."""

    def __init__(self, where: str) -> None:
        self._where = where
        self._content: Document = {}
        self._heading: list[str] | None = None
        self._sign = ","  # that separates the table's cells
        self._matrices: dict[str, list[dict[str, Any]]] = {}
        self._last = ""  # name of the matrix whose rows are directly above

    def document(self, lines: Sequence[str]) -> Document:
        """Read a whole text."""
        lines = [_tidy(line) for line in lines]
        at = 0
        while at < len(lines):
            line, number = lines[at], at + 1
            if found := _block_begins(line):
                name, rest = found
                at = _end_of_block(lines, at, rest)
                self._add_whole(name, "\n".join([rest, *lines[number:at]]))
                self._heading = None
                continue
            at += 1
            if _SINGULAR.match(line):
                self._add_to("singular", line)
            elif bars := _DETERMINANT.match(line):
                self._add_whole(bars[1], bars[2])
            elif not _RULE.match(line):
                self._read(line, number)
        return self._content

    def _read(self, line: str, number: int) -> None:
        bare = line.strip()
        if self._heading is None and not bare.startswith(_COMMENTS):
            if setting := _SETTING.match(bare):
                self._add_pair(setting[1], setting[2].strip(" ,;\t"), number)
                return
            if singular := _SINGULAR_LINE.match(bare):
                self._add_to("singular", singular[1].strip(' "'))
                return
            equations = _equations(bare)
            for name, value in equations:
                self._add_equation(name, value, number)
            if equations or _is_prose(bare):
                return
        sign = self._sign if self._heading and self._sign in line else delimiter_of(line)
        try:
            (cells,) = csv.reader([line], delimiter=sign, skipinitialspace=True)
        except csv.Error as error:
            self._leave_out(number, f"{error}; write it in several lines")
            return
        cells = [cell.strip() for cell in cells]
        if sign == "|" and len(cells) > 2:  # the bars that begin and end a Markdown line
            cells = cells[cells[0] == "" : len(cells) - (cells[-1] == "")]
        self._add_cells(cells, number, sign)

    def _add_cells(self, cells: list[str], number: int, sign: str) -> None:
        if not any(cells):
            self._heading = None
            return
        if cells[0].startswith(_COMMENTS) and not is_heading(cells):
            return
        if len(cells) == 1:
            cells = self._spaced(cells[0])
        first, *others = cells
        if re.fullmatch("singular(?:ity|ities)?", first.casefold()):
            self._add_to("singular", ", ".join(others))
        elif is_heading(cells):
            self._heading, self._sign = [column_named(cell) for cell in cells], sign
        elif self._heading is not None:
            self._add_to("table", self._table_row(self._heading, cells, number))
        elif len(cells) == 2 and not _has_columns_of_one(first, others[0]):
            self._add_pair(first, others[0], number)
        elif len(cells) == 3 and first in _REMARKS:
            self._add_remark(first, *others)
        elif others:
            self._add_row(first, others, number)
        else:
            self._leave_out(
                number,
                f"{quoted(first)} is alone on its line; a line has a name and what belongs to it, "
                "separated by =, commas, semicolons or tabs",
            )

    def _spaced(self, line: str) -> list[str]:
        """Split a line at its spaces where it is a table's."""
        words = spaced_cells(line)
        if self._heading is not None and len(words) == len(self._heading):
            return words
        return line.split() if is_heading(line.split()) else [line]

    def _table_row(self, heading: list[str], cells: list[str], number: int) -> dict[str, str]:
        if len(cells) != len(heading):
            raise InvalidValueError(
                f"{self._where}, line {number}: the table's row has {len(cells)} cells and its "
                f"heading {len(heading)}; an empty line ends a table"
            )
        return {column: cell for column, cell in zip(heading, cells, strict=True) if column}

    def _add_to(self, key: str, value: object) -> None:
        self._content.setdefault(key, []).append(value)

    def _leave_out(self, number: int, sentence: str) -> None:
        """Record that a line makes no sense."""
        self._add_to("unread", (f"line {number}", sentence))

    def _matrix(self, name: str, *, new: bool = False) -> dict[str, Any]:
        """Return the last matrix of a name; a new one if it has entries and may have none."""
        known = self._matrices.setdefault(name, [])
        if not known or (new and "entries" in known[-1]):
            former = known[-1] if known else {"name": name}
            known.append({key: value for key, value in former.items() if key != "entries"})
            self._add_to("matrix", known[-1])
        return known[-1]

    def _add_whole(self, name: str, text: str) -> None:
        self._matrix(name, new=True)["entries"] = text
        self._last = ""

    def _add_row(self, name: str, cells: list[str], number: int) -> None:
        """Read a row of a matrix; rows apart from others are another's."""
        if isinstance(self._matrix(name).get("entries"), str):
            self._leave_out(number, f"{name} is already written above as a whole; write it once")
            return
        matrix = self._matrix(name, new=self._last != name)
        matrix.setdefault("entries", []).append(cells)
        self._last = name

    def _add_equation(self, name: str, value: str, number: int) -> None:
        """Read ``name = value``."""
        matrix = kind_of_name(name) in ("transform", "rotation") and re.search("[TtHhR]", name)
        if matrix and not _number(value):
            self._leave_out(
                number,
                f"{quoted(name)} is given as {quoted(value, 30)}; write the resulting matrix, in "
                "brackets",
            )
        elif _has_columns_of_one(name, value):
            self._add_whole(name, value)
        elif not all(map(_NAME.fullmatch, value.split("=")[:-1])):
            sentence = f"{quoted(name)} has several signs of equality; write the last"
            self._leave_out(number, sentence)
        else:
            *others, last = value.split("=")
            for one in (name, *others):
                self._add_pair(one.strip(), last, number)

    def _add_pair(self, name: str, value: str, line: int) -> None:
        value = value.strip()
        if name.casefold() in SETTINGS:
            self._content[name.casefold()] = value.strip("\"'")
            return
        number = _number(value)
        key, said = ("where", value) if number is None else ("symbols", number)
        known = {**self._content.get("symbols", {}), **self._content.get("where", {})}
        if name in known and known[name] != said:
            self._leave_out(line, f"{name} already has another value above; write it once")
        else:
            self._content.setdefault(key, {})[name] = said

    def _add_remark(self, what: str, name: str, value: str) -> None:
        if what in ("joint", "cells"):
            key = "joints" if what == "joint" else "cells"
            self._content.setdefault(key, {})[name] = value
        elif what == "caption":
            self._matrix(name)["caption"] = value
        else:
            self._matrix(name)
            for matrix in self._matrices[name]:
                matrix["rows"] = value.split()


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
    reserved = (*SETTINGS, *_REMARKS, "singular")
    return not re.search(r"[,|&]", text) and len(text.split()) < 4 and text not in reserved


def _end_of_block(lines: list[str], at: int, rest: str) -> int:
    """Find the line after a matrix: where its brackets are closed, or an empty one."""
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
    if _BEGINS_ANEW.match(line):
        return True
    found = _STATEMENT.match(line)
    return found is not None and not found["name"].strip().startswith(("dtype", ")", "]", "[", "&"))


def _equations(line: str) -> list[tuple[str, str]]:
    """Read ``L1 = 50, L2 = 100;`` as two; nothing where = is after a line's first delimiter."""
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
    return not is_heading(line.split())


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
