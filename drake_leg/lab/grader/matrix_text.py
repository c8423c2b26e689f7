r"""Reads a matrix pasted as text: what its name claims, and its entries.

A name is T12, ^0T_4, A2, R01, p_04, J_v or \det(J). The entries are in LaTeX, MATLAB, Python or
Markdown, or in plain rows: ``\begin{bmatrix} a & b \\ c & d \end{bmatrix}``, ``[a b; c d]``,
``Matrix([[a, b], [c, d]])``, ``| a | b |``, lines separated by tabs or spaces, SymPy's boxes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.spelling import quoted, typed, without_latex

Kind = Literal["transform", "rotation", "position", "jacobian", "determinant"]

NAMES = "T12, T04 and the like, A2, R01, P04, J, Jv, Jw, detJ"
_KINDS: dict[str, Kind] = {
    **dict.fromkeys("tha", "transform"),
    "r": "rotation",
    "p": "position",
}
# One number above and the other below, T_1^2 or T_2^1: prints differ on which is which.
_EITHER = re.compile(r"([thapr])(?:_(\d)\^|\^(\d)_)(\d)")
_POSES = (
    r"\^?(?P<first>\d)_?(?P<letter>[thapr])_?(?P<last>\d)",
    r"\^(?P<first>\d)_(?P<last>\d)(?P<letter>[thapr])",
    r"_(?P<last>\d)\^(?P<first>\d)(?P<letter>[thapr])",
    r"(?P<letter>[thapr])[_^]?(?P<first>\d)(?:[_,/-]|->|→|to)*(?P<last>\d)",
    r"(?P<letter>[ap])_?(?P<last>[1-9])(?P<first>)",  # A2 is T12, and P4 is P04
)
_JACOBIAN = re.compile(
    r"(?:\^?0)?(?:jacobian|jacobienne|jacobien|jacobi|jac|j)(?:matrix)?_?(?P<rows>v|p|w|omega|o)?"
    r"_?(?:0\d?)?(?:_?[1-9][x*][1-9])?(?:_?[4-9])?"
    r"(?:\((?:q|theta)(?:_?\d(?:,(?:q|theta)_?\d)*)?\))?"
)
_ROWS: dict[str | None, tuple[str, ...]] = {
    None: (),
    **dict.fromkeys(("v", "p"), ("x", "y", "z")),
    **dict.fromkeys(("w", "omega", "o"), ("wx", "wy", "wz")),
}


@dataclass(frozen=True, kw_only=True)
class MatrixName:
    """A matrix's name as read."""

    kind: Kind
    frames: tuple[int, int] = (0, 0)  # pose of the second in the first
    rows: tuple[str, ...] = ()  # of a Jacobian, where its name says them


def read_name(text: str) -> MatrixName:
    """Read the name of a matrix; refuse one without a meaning.

    ``T12`` is the pose of frame 2 in frame 1, ``T21`` that of frame 1 in frame 2, its inverse.
    ``T_1^2`` and ``T_2^1`` are both T12. In front, as in ``{}^1T_2`` and ``{}^1_2T``, the upper
    number is the reference frame.
    """
    try:
        name = without_latex(typed(text[:200]))
    except InvalidValueError:
        name = ""
    name = re.sub(r"[{}]", "", re.sub(r"\s|\{\}|[\[\]]|=$|:$", "", name))
    if either := _EITHER.fullmatch(name):
        name = either[1] + "".join(sorted(filter(None, either.groups()[1:])))
    for pattern in _POSES:
        if pose := re.fullmatch(pattern, name):
            last = int(pose["last"])
            first = int(pose["first"] or (last - 1 if pose["letter"] == "a" else 0))
            return MatrixName(kind=_KINDS[pose["letter"]], frames=(first, last))
    determinant = re.fullmatch(r"\|(.+)\||(?:determinant|det)(?:of)?(.*)", name)
    if determinant:
        name = determinant[1] or determinant[2] or "j"
    while name.startswith("(") and name.endswith(")"):
        name = name[1:-1]
    jacobian = _JACOBIAN.fullmatch(name)
    if not jacobian:
        raise InvalidValueError(
            f"the matrix {quoted(text)} means nothing here; write one of {NAMES}"
        )
    return MatrixName(
        kind="determinant" if determinant else "jacobian", rows=_ROWS[jacobian["rows"]]
    )


def kind_of_name(text: str) -> Kind | None:
    """Say what a matrix is, or None where its name means nothing."""
    try:
        return read_name(text).kind
    except InvalidValueError:
        return None


# --- entries ---------------------------------------------------------------------------------

LONGEST = 20_000  # characters
_OPENING, _CLOSING = "([{", ")]}"
_FRAME = "⎡⎢⎣⎤⎥⎦⎛⎜⎝⎞⎟⎠│┌┐└┘"
_CALL = re.compile(
    r"(?:[A-Za-z]+\.)?(?:Immutable|Mutable)?(?:Dense)?(?:Matrix|matrix|array|sym)\s*\("
)
_FLAT = re.compile(r"(\d)\s*,\s*(\d)\s*,\s*\[(.*)\]$", re.DOTALL)  # Matrix(2, 2, [a, b, c, d])
_ENVIRONMENT = re.compile(
    r"\\begin\s*\{(?P<kind>[a-zA-Z]*(?:matrix|array|tabular))\*?\}(?P<rows>.*?)\\end\s*\{(?P=kind)\*?\}",
    re.DOTALL,
)
_COMMENT = re.compile(r"(?<!\\)(?:%|#|(?<![\w)])//)[^\n]*")
_BEFORE = re.compile(
    r"(?:\s|\$|\\\[|\\\(|\\[,;:!]|&|\\left\s*[\[(|.]|\\(?:big|Big)+l?\s*[\[(|]|[\[(])*$"
)
_TRANSPOSED = (
    r"\.?['\u2019]|ᵀ|\u22a4|\.T\b|\.transpose\(\)|\^\s*(?:T\b|\u22a4|\\top\b|"
    r"\{\s*(?:T|\u22a4|\\top|\\intercal|\\prime|\\(?:mathrm|text|mathsf)\{T\})\s*\})"
)
_UNIT = r"(?:\\,|\\;|~)?[\[(]?\s*(?:\\(?:mathrm|text|si|unit)\{)?(?:mm|cm|m|rad)\}?\s*[\])]?"
_TAIL = re.compile(
    rf"(?:(?P<transposed>{_TRANSPOSED})|\\right\s*[\])|.]|\\(?:big|Big)+r?\s*[\])|]|[\])]|"
    rf"\\[\])]|\$|\\\\|\\[,;:!]|[.,;]|(?<![\w*/^.]){_UNIT}(?![\w*/^])|\s)"
)


def rows_of_text(text: str, *, column: bool = False) -> list[list[str]]:
    """Split a matrix into rows of one length; of a ``column`` every line is one entry."""
    if len(text) > LONGEST:
        raise InvalidValueError(f"a matrix has {len(text)} characters; write at most {LONGEST}")
    text = _COMMENT.sub("", text)
    rows = _latex_rows(text) or _bracketed_rows(text, column) or _lines(text)
    if not rows:
        raise InvalidValueError(
            "a matrix is empty; write its rows, their entries separated by commas"
        )
    lengths = {len(row) for row in rows}
    if len(lengths) > 1:
        raise InvalidValueError(
            f"the rows of {quoted(text)} have {' or '.join(map(str, sorted(lengths)))} entries; "
            "separate the entries by commas or & and the rows by semicolons or new lines"
        )
    return rows


def _latex_rows(text: str) -> list[list[str]]:
    r"""Read rows that \\ ends, with entries that & separates."""
    found = _ENVIRONMENT.search(text)
    if not found and re.search(r"\\(?:begin|end)\b", text):
        raise InvalidValueError(
            r"a matrix is not closed; write \begin{bmatrix} before it and \end{bmatrix} after it"
        )
    if not found and not ("&" in text and re.search(r"\\\\", text)):
        return []
    inside = found["rows"] if found else text
    if found and found["kind"] in ("array", "tabular"):
        inside = re.sub(r"^\s*(?:\[\w\])?\s*\{[^{}]*\}", "", inside)
    inside = re.sub(r"\\(?:hline|toprule|midrule|bottomrule)(?![a-z])", "", inside)
    rows = [
        _stripped(row.split("&")) for row in re.split(r"\\\\(?:\[[^\]]*\])?", inside) if row.strip()
    ]
    if not found:
        return rows
    if not _BEFORE.match(text[: found.start()]):
        raise _something_beside(text[: found.start()])
    return _turned(rows) if _is_transposed(text[found.end() :]) else rows


def _is_transposed(tail: str) -> bool:
    """Whether a transposition follows a matrix; refuse what changes it otherwise."""
    transposed, at = False, 0
    while at < len(tail):
        found = _TAIL.match(tail, at)
        if not found:
            raise _something_beside(tail[at:])
        transposed ^= bool(found["transposed"])
        at = found.end()
    return transposed


def _turned(rows: list[list[str]]) -> list[list[str]]:
    same_length = len({len(row) for row in rows}) == 1
    return [list(cells) for cells in zip(*rows, strict=True)] if same_length else rows


def _something_beside(text: str) -> InvalidValueError:
    where = "is beside the matrix; multiply it in, and write the resulting matrix"
    if "=" in text:
        where = "is on its line, too; write each matrix in a line of its own"
    return InvalidValueError(f"{quoted(text, 30)} {where}")


def _bracketed_rows(text: str, column: bool) -> list[list[str]]:
    """Read [a b; c d], [[a, b], [c, d]] and the calls that hold them."""
    text = re.sub(r"\.{3}[^\n]*\n", " ", text)
    text = re.sub(r"\\left\s*(?=[\[(])|\\right\s*(?=[\])])|\$", "", text).strip()
    call = _CALL.match(text)
    begin = call.end() - 1 if call else 0
    end = _end_of_bracket(text, begin)
    if end is None:
        return []
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    if len(lines) > 1 and all(_inside(line.rstrip(";,")) is not None for line in lines):
        return [_cells(line.rstrip(";,")[1:-1]) for line in lines]  # as MATLAB prints
    held = text[begin:end]
    if not call and held[0] == "(" and not _has_parts(held):
        return []
    if not call and text[end:].strip() and not _has_parts(held):
        return []  # a formula that begins with a bracket
    transposed = _is_transposed(text[end:])
    rows = _rows_of_call(held[1:-1]) if call else _rows_inside(held[1:-1], column)
    return _turned(rows) if transposed else rows


def _rows_of_call(text: str) -> list[list[str]]:
    """Read what is in the brackets of Matrix(...)."""
    text = re.sub(r",\s*dtype\s*=[^,\[\]]*$", "", text.strip().rstrip(",")).strip()
    flat = _FLAT.match(text)
    if flat:
        count, width = int(flat[1]), int(flat[2])
        cells = _stripped(_split(flat[3], ","))
        if len(cells) != count * width or not cells:
            raise InvalidValueError(
                f"a matrix of {count} rows and {width} columns has {len(cells)} entries; write "
                f"{count * width}"
            )
        return [cells[i : i + width] for i in range(0, len(cells), width)]
    if re.fullmatch(r"'[^']*'|\"[^\"]*\"", text):
        text = f"[{text[1:-1]}]"
    inside = _inside(text)
    if inside is None:
        raise InvalidValueError(
            f"{quoted(text)} is not a list of rows; write [[a, b], [c, d]] in the brackets"
        )
    return _rows_inside(inside, column=False)


def _rows_inside(inside: str, column: bool) -> list[list[str]]:
    """Read what is in the brackets of a matrix."""
    inner = [part for part in _split(inside, ",") if part.strip()]
    rows = [_inside(part) for part in inner]
    if inner and None not in rows:
        return [_cells(row) for row in rows if row is not None]
    spaced = [found[1] for found in re.finditer(r"\[([^\[\]]*)\]", inside)]
    if spaced and not re.sub(r"\[[^\[\]]*\]", "", inside).strip():
        return [_cells(row) for row in spaced]  # as NumPy prints
    parts = [line for part in _split(inside, ";") for line in _split(part, "\n")]
    lines = [line.strip() for line in parts if line.strip()]
    if column and len(lines) > 2 and all(len(_split(line, ",")) == 1 for line in lines):
        return [[line] for line in lines]
    return [_cells(line) for line in lines]


def _has_parts(held: str) -> bool:
    """Whether brackets hold more than one entry."""
    inside = held[1:-1].strip()
    if any(len(_split(inside, sign)) > 1 for sign in ",;\n"):
        return True
    return held[0] != "(" and len(spaced_cells(inside)) > 1


def _end_of_bracket(text: str, begin: int) -> int | None:
    """Return where the bracket closes that opens at a place; None if none opens there."""
    if text[begin : begin + 1] not in tuple(_OPENING):
        return None
    closed = next((index for index, _, depth in _depths(text[begin:]) if depth == 0), None)
    if closed is None:
        raise InvalidValueError(
            f"in {quoted(text)} a bracket is not closed; write it after the last row"
        )
    return begin + closed + 1


def _inside(text: str) -> str | None:
    """Return what one pair of brackets holds that spans the whole text."""
    text = text.strip()
    if not text or text[0] not in "[{" or text[-1] not in "]}":
        return None
    closed = next((index for index, _, depth in _depths(text) if depth == 0), None)
    return text[1:-1] if closed == len(text) - 1 else None


def _depths(text: str) -> Iterator[tuple[int, str, int]]:
    """Count how many brackets are open after every letter."""
    depth = 0
    for index, letter in enumerate(text):
        depth += (letter in _OPENING) - (letter in _CLOSING)
        yield index, letter, depth


def _lines(text: str) -> list[list[str]]:
    """Read one row a line."""
    _require_no_matrix(text)
    lines = []
    for line in re.split(r"\n|;", text):
        bare = line.translate(dict.fromkeys(map(ord, _FRAME), " ")).strip()
        if bare and not re.fullmatch(r"[-|:\s]*", re.sub(r"-?\d", "0", bare)):
            lines.append(bare)
    for sign in ("|", "&", "\t", ","):
        if any(sign in line for line in lines):
            return [_stripped(_split(_unframed(line, sign), sign)) for line in lines]
    wide = [re.split(r"\s{2,}", line) for line in lines]
    if len({len(row) for row in wide}) == 1 and len(wide[0]) > 1:
        return wide
    rows = [_cells(line) for line in lines]
    return rows if len({len(row) for row in rows}) == 1 else [[line] for line in lines]


def _require_no_matrix(text: str) -> None:
    """Refuse a bracketed matrix with something beside it."""
    begin = text.find("[")
    while begin >= 0:
        end = _end_of_bracket(text, begin) or len(text)
        before = text[:begin].rstrip()
        if _has_parts(text[begin:end]) and not before.endswith(("_", "^")):
            raise _something_beside(before or text[end:])
        begin = text.find("[", end)
    if text.count("]") > text.count("["):
        raise InvalidValueError(f"in {quoted(text)} ] closes no bracket; write [ before it")


def _unframed(line: str, sign: str) -> str:
    """Take the bars off that begin and end a line of a Markdown table."""
    return line.removeprefix("|").removesuffix("|") if sign == "|" else line.removesuffix(sign)


def _cells(row: str) -> list[str]:
    """Split a row by its commas, or else by its spaces as MATLAB does."""
    cells = _split(row, ",")
    if len(cells) > 1:
        return _stripped(cells[:-1] if not cells[-1].strip() else cells)
    return spaced_cells(row)


def spaced_cells(row: str) -> list[str]:
    """Split a row by spaces: ``a - b`` is one entry and ``a -b`` are two, as in MATLAB."""
    cells: list[str] = []
    depth = 0
    for word in row.split():
        joins = bool(cells) and (
            depth > 0
            or re.search(r"[-+*/^(.]$|(?:cos|sin|tan|sqrt)$", cells[-1]) is not None
            or re.match(r"[*/^)]|\.[*/^]|[-+]$", word) is not None
        )
        if joins:
            cells[-1] += f" {word}"
        else:
            cells.append(word)
        depth += sum((letter in _OPENING) - (letter in _CLOSING) for letter in word)
    return cells


def _split(text: str, sign: str) -> list[str]:
    """Split a text at a sign outside brackets."""
    parts, begin = [], 0
    for index, letter, depth in _depths(text):
        if letter == sign and depth == 0:
            parts.append(text[begin:index])
            begin = index + 1
    return [*parts, text[begin:]]


def _stripped(cells: list[str]) -> list[str]:
    return [cell.strip() for cell in cells]
