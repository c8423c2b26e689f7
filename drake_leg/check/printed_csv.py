"""A print typed as text: CSV, columns parted by tabs or bars, or matrices as they are pasted.

``angles,deg`` and ``lengths,mm`` say the units; two cells of which the second is a number give a
symbol its value (``L1,50``), otherwise its formula (``sigma1,2*cos(θ2)+1``). Three cells that
begin with ``joint``, ``cells``, ``caption`` or ``rows`` say something about a joint, a symbol or a
matrix, and ``singular,θ3 = kπ`` where the determinant is zero. A heading with σ, d, α, r, θ begins
a table, which an empty line ends. ``T01 = [...]``, in LaTeX, MATLAB or Python, is a matrix,
``L1 = 50`` a symbol. Every other line is a row of a matrix, its name first. Each line has its own
delimiter, and one that makes no sense is left out and said.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from typing import Any

from drake_leg.check.matrix_names import kind_of_name
from drake_leg.check.matrix_text import spaced_cells
from drake_leg.check.notation import quoted
from drake_leg.errors import InvalidValueError
from drake_leg.robot_file.document import Document

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


def parse_csv(text: str, where: str) -> Document:
    """Read text into the tables that a TOML file would have.

    Parameters
    ----------
    text : str
        The file's content; the cells of a line are parted by the comma, semicolon, tab or bar that
        stands first in it.
    where : str
        Name of the file, for the error's sentence.

    Returns
    -------
    dict
        As ``tomllib`` would give it; under ``unread`` the lines that make no sense, each with its
        place and a sentence.

    Raises
    ------
    InvalidValueError
        If a table's row does not fit its heading.
    """
    reading = _Reading(where)
    for number, line in enumerate(_without_blocks(text.splitlines(), reading), start=1):
        reading.add_line(line, number)
    return reading.document


def parse_table(text: str, where: str) -> list[dict[str, str]]:
    """Read a pasted table with its heading.

    Parameters
    ----------
    text : str
        Columns parted by bars, commas, semicolons, tabs or spaces.
    where : str
        Name of the file.

    Returns
    -------
    list of dict
        Rows, column to cell.

    Raises
    ------
    InvalidValueError
        If it has no heading, or a row is not as long as that.
    """
    document = parse_csv(text.strip(), f"{where}: table")
    for place, sentence in document.get("unread", ()):
        raise InvalidValueError(f"{where}: table, {place}: {sentence}")
    rows: list[dict[str, str]] = document.get("table", [])
    if not rows:
        raise InvalidValueError(f"{where}: table has no heading; write i | σ | d | α | r | θ above")
    return rows


def _without_blocks(lines: list[str], reading: _Reading) -> Iterator[str]:
    """Read the matrices that are pasted, and leave an empty line for each of theirs."""
    lines = [_tidy(line) for line in lines]
    at = 0
    while at < len(lines):
        line = lines[at]
        found = _block_begins(line)
        if found:
            name, rest = found
            end = _end_of_block(lines, at, rest)
            block = "\n".join([rest, *lines[at + 1 : end]])
            reading.add_block(name, block, at + 1)
            yield from [""] * (end - at)
            at = end
            continue
        if _SINGULAR.match(line):
            reading.add_singular(line)
            line = "#"
        elif bars := _DETERMINANT.match(line):
            reading.add_block(bars[1], bars[2], at + 1)
            line = "#"
        yield "#" if _RULE.match(line) else line
        at += 1


def _tidy(line: str) -> str:
    """Take off what a line of text, of LaTeX or of Markdown has around a statement."""
    if _FENCE.match(line):
        return ""
    if line.lstrip().startswith(("#", "%", "//")) or len(line) > _LONGEST_LINE:
        return line
    return _EMPHASIS.sub(r"\1\3", _LAYOUT.sub("", _COMMENT.sub("", line)))


def _block_begins(line: str) -> tuple[str, str] | None:
    """Return the name of a matrix that begins on a line, and what stands behind its last =."""
    if len(line) > _LONGEST_LINE or line.lstrip().startswith(("#", "%", "//")):
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


def _unframed(cells: list[str], delimiter: str) -> list[str]:
    """Leave out the empty cells before the first bar and behind the last one."""
    if delimiter != "|" or len(cells) < 3:
        return cells
    return cells[cells[0] == "" : len(cells) - (cells[-1] == "")]


def _delimiter(line: str) -> str:
    """Find the sign that parts a line's cells: of a heading all, otherwise the first."""
    for sign in "\t|;,":
        if set(_COLUMNS) <= {_column(cell) for cell in line.split(sign)}:
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
    return not set(_COLUMNS) <= set(map(_column, line.split()))


class _Reading:
    """What has been read of a print."""

    def __init__(self, where: str) -> None:
        self.document: Document = {}
        self._where = where
        self._heading: list[str] | None = None
        self._sign = ","  # that parts the table's cells
        self._matrices: dict[str, list[dict[str, Any]]] = {}
        self._last = ""  # name of the matrix whose rows stand directly above

    def add_line(self, line: str, number: int) -> None:
        """Read one line that is not a pasted matrix's."""
        bare = line.strip()
        if self._heading is None and not bare.startswith(("#", "%", "//")):
            setting = _SETTING.match(bare)
            if setting:
                self._add_pair(setting[1], setting[2].strip(" ,;\t"), number)
                return
            singular = _SINGULAR_LINE.match(bare)
            if singular:
                self.add_singular(singular[1].strip(' "'))
                return
            equations = _equations(bare)
            for name, value in equations:
                self._add_equation(name, value, number)
            if equations or _is_prose(bare):
                return
        sign = self._sign if self._heading and self._sign in line else _delimiter(line)
        try:
            (cells,) = csv.reader([line], delimiter=sign, skipinitialspace=True)
        except csv.Error as error:
            self._leave_out(number, f"{error}; write it in several lines")
            return
        self.add(_unframed([cell.strip() for cell in cells], sign), number, sign)

    def add(self, cells: list[str], line: int, sign: str) -> None:
        """Read the cells of one line."""
        if not any(cells):
            self._heading = None
            return
        comment = cells[0].startswith(("#", "%", "//"))
        if comment and not set(_COLUMNS) <= set(map(_column, cells)):
            return
        if len(cells) == 1:
            cells = self._spaced(cells[0])
        if re.fullmatch("singular(?:ity|ities)?", cells[0].casefold()):
            self.add_singular(", ".join(cells[1:]))
            return
        heading = [_column(cell) for cell in cells]
        if set(_COLUMNS) <= set(heading):
            self._heading, self._sign = heading, sign
        elif self._heading is not None:
            self._add_row(cells, line)
        elif len(cells) == 2 and not _has_columns_of_one(cells[0], cells[1]):
            self._add_pair(cells[0], cells[1], line)
        elif len(cells) == 3 and cells[0] in ("joint", "cells", "caption", "rows"):
            self._add_remark(*cells)
        elif len(cells) >= 2:
            self._add_entries(cells[0], cells[1:], line)
        else:
            self._leave_out(
                line,
                f"{quoted(cells[0])} stands alone; a line has a name and what belongs to it, "
                "parted by =, commas, semicolons or tabs",
            )

    def _add_equation(self, name: str, value: str, line: int) -> None:
        """Read what a name is said to be."""
        kind = kind_of_name(name)
        if kind in ("transform", "rotation") and re.search(r"[TtHhR]", name) and not _number(value):
            self._leave_out(
                line,
                f"{quoted(name)} is said to be {quoted(value, 30)}; write the matrix that comes "
                "out, in brackets",
            )
        elif _has_columns_of_one(name, value):
            self.add_block(name, value, line)
        elif not all(map(_NAME.fullmatch, value.split("=")[:-1])):
            self._leave_out(line, f"{quoted(name)} has several signs of equality; write the last")
        else:
            *others, last = value.split("=")
            for one in (name, *others):
                self._add_pair(one.strip(), last.strip(), line)

    def _spaced(self, line: str) -> list[str]:
        """Part a line by its spaces where it is a table's."""
        words = spaced_cells(line)
        if self._heading is not None and len(words) == len(self._heading):
            return words
        if set(_COLUMNS) <= {_column(word) for word in line.split()}:
            return line.split()
        return [line]

    def add_block(self, name: str, text: str, line: int) -> None:
        """Read a matrix that is pasted as it stands; one of the same name is another."""
        matrix = self._matrix(name)
        if "entries" in matrix:
            matrix = self._another(name)
        matrix["entries"] = text
        self._last = ""

    def add_singular(self, text: str) -> None:
        """Read a set of singular postures."""
        self.document.setdefault("singular", []).append(text)

    def _add_row(self, cells: list[str], line: int) -> None:
        heading = self._heading or []
        if len(cells) != len(heading):
            raise InvalidValueError(
                f"{self._where}, line {line}: the table's row has {len(cells)} cells and its "
                f"heading {len(heading)}; an empty line ends a table"
            )
        row = {column: cell for column, cell in zip(heading, cells, strict=True) if column}
        self.document.setdefault("table", []).append(row)

    def _add_entries(self, name: str, cells: list[str], line: int) -> None:
        """Read a row of a matrix; rows that stand apart from others are another's."""
        matrix = self._matrix(name)
        if isinstance(matrix.get("entries"), str):
            self._leave_out(line, f"{name} stands above as a whole; write it once")
            return
        if "entries" in matrix and self._last != name:
            matrix = self._another(name)
        matrix.setdefault("entries", []).append(cells)
        self._last = name

    def _add_pair(self, name: str, value: str, line: int) -> None:
        value = value.strip()
        if name.casefold() in _SETTINGS:
            self.document[name.casefold()] = value.strip("\"'")
            return
        number = _number(value)
        kind, content = ("where", value) if number is None else ("symbols", number)
        known = {**self.document.get("symbols", {}), **self.document.get("where", {})}
        if name in known and known[name] != content:
            self._leave_out(line, f"{name} stands above with another value; write it once")
        else:
            self.document.setdefault(kind, {})[name] = content

    def _add_remark(self, what: str, name: str, value: str) -> None:
        if what == "joint":
            self.document.setdefault("joints", {})[name] = value
        elif what == "cells":
            self.document.setdefault("cells", {})[name] = value
        elif what == "rows":
            self._matrix(name)
            for matrix in self._matrices[name]:
                matrix["rows"] = value.split()
        else:
            self._matrix(name)["caption"] = value

    def _matrix(self, name: str) -> dict[str, Any]:
        if name not in self._matrices:
            self._matrices[name] = [{"name": name}]
            self.document.setdefault("matrix", []).append(self._matrices[name][0])
        return self._matrices[name][-1]

    def _another(self, name: str) -> dict[str, Any]:
        """Begin one more matrix of a name."""
        matrix = {**self._matrix(name)}
        del matrix["entries"]
        self._matrices[name].append(matrix)
        self.document["matrix"].append(matrix)
        return matrix

    def _leave_out(self, line: int, sentence: str) -> None:
        """Say that a line makes no sense."""
        self.document.setdefault("unread", []).append((f"line {line}", sentence))


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
