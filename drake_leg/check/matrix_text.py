r"""A matrix pasted as one text: LaTeX, MATLAB, Python, Markdown, or rows as they stand.

``\begin{bmatrix} a & b \\ c & d \end{bmatrix}``, ``[a b; c d]``, ``Matrix([[a, b], [c, d]])``,
``| a | b |``, lines parted by tabs or spaces, and the boxes that SymPy draws.
"""

from __future__ import annotations

import re

from drake_leg.check.notation import quoted
from drake_leg.errors import InvalidValueError

LONGEST = 20_000  # characters
_OPENING, _CLOSING = "([{", ")]}"
_FRAME = "⎡⎢⎣⎤⎥⎦⎛⎜⎝⎞⎟⎠│┌┐└┘"
_CALL = re.compile(
    r"\s*(?:[A-Za-z]+\.)?(?:Immutable|Mutable)?(?:Dense)?(?:Matrix|matrix|array|sym)\s*\((?=.*\)\s*;?\s*$)",
    re.DOTALL,
)
_ENVIRONMENT = re.compile(
    r"\\begin\s*\{(?P<kind>[a-zA-Z]*(?:matrix|array|tabular))\*?\}(?P<rows>.*?)\\end\s*\{(?P=kind)\*?\}",
    re.DOTALL,
)


def rows_of_text(text: str) -> list[list[str]]:
    """Part a matrix into its entries.

    Parameters
    ----------
    text : str
        As pasted.

    Returns
    -------
    list of list of str
        Rows of one length.

    Raises
    ------
    InvalidValueError
        If it is too long, empty, or its rows have different lengths.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(f"a matrix has {len(text)} characters; write at most {LONGEST}")
    rows = _latex_rows(text) or _bracketed_rows(text) or _lines(text)
    if not rows:
        raise InvalidValueError("a matrix is empty; write its rows, their entries parted by commas")
    lengths = {len(row) for row in rows}
    if len(lengths) > 1:
        raise InvalidValueError(
            f"the rows of {quoted(text)} have {' or '.join(map(str, sorted(lengths)))} entries; "
            "part the entries by commas or & and the rows by semicolons or new lines"
        )
    return rows


def _latex_rows(text: str) -> list[list[str]]:
    r"""Read rows that \\ ends, with entries that & parts."""
    found = _ENVIRONMENT.search(text)
    if not found and not ("&" in text and re.search(r"\\\\", text)):
        return []
    inside = found["rows"] if found else text
    if found and found["kind"] in ("array", "tabular"):
        inside = re.sub(r"^\s*(?:\[\w\])?\s*\{[^{}]*\}", "", inside)
    inside = re.sub(r"\\(?:hline|toprule|midrule|bottomrule)(?![a-z])", "", inside)
    rows = re.split(r"\\\\(?:\[[^\]]*\])?", inside)
    return [_stripped(row.split("&")) for row in rows if row.strip()]


def _bracketed_rows(text: str) -> list[list[str]]:
    """Read [a b; c d], [[a, b], [c, d]] and the calls that hold them."""
    text = re.sub(r"\.{3}[^\n]*\n", " ", text).strip().rstrip(";").strip()
    call = _CALL.match(text)
    if call:
        text = text[call.end() :].rstrip()[:-1].strip().rstrip(",")
    inside = _inside(text)
    if inside is None:
        return []
    inner = [part for part in _parted(inside, ",") if part.strip()]
    rows = [_inside(part) for part in inner]
    if inner and None not in rows:
        return [_cells(row) for row in rows if row is not None]
    spaced = [found[1] for found in re.finditer(r"\[([^\[\]]*)\]", inside)]
    if spaced and not re.sub(r"\[[^\[\]]*\]", "", inside).strip():
        return [_cells(row) for row in spaced]  # as NumPy prints
    lines = [line for part in _parted(inside, ";") for line in _parted(part, "\n")]
    return [_cells(line) for line in lines if line.strip()]


def _inside(text: str) -> str | None:
    """Return what one pair of brackets holds that spans the whole text."""
    text = text.strip()
    if not text or text[0] not in "[{" or text[-1] not in "]}":
        return None
    depth = 0
    for index, letter in enumerate(text):
        depth += (letter in _OPENING) - (letter in _CLOSING)
        if depth == 0:
            return text[1:-1] if index == len(text) - 1 else None
    return None


def _lines(text: str) -> list[list[str]]:
    """Read one row a line."""
    lines = []
    for line in re.split(r"\n|;", text):
        bare = line.translate(dict.fromkeys(map(ord, _FRAME), " ")).strip()
        if bare and not re.fullmatch(r"[-|:\s]*", re.sub(r"-?\d", "0", bare)):
            lines.append(bare)
    for sign in ("|", "&", "\t", ","):
        if any(sign in line for line in lines):
            return [_stripped(_parted(_unframed(line, sign), sign)) for line in lines]
    wide = [re.split(r"\s{2,}", line) for line in lines]
    if len({len(row) for row in wide}) == 1 and len(wide[0]) > 1:
        return wide
    rows = [_cells(line) for line in lines]
    return rows if len({len(row) for row in rows}) == 1 else [[line] for line in lines]


def _unframed(line: str, sign: str) -> str:
    """Take the bars off that begin and end a line of a Markdown table."""
    return line.removeprefix("|").removesuffix("|") if sign == "|" else line.removesuffix(sign)


def _cells(row: str) -> list[str]:
    """Part a row by its commas, or else by its spaces as MATLAB does."""
    cells = _parted(row, ",")
    if len(cells) > 1:
        return _stripped(cells[:-1] if not cells[-1].strip() else cells)
    return spaced_cells(row)


def spaced_cells(row: str) -> list[str]:
    """Part a row by spaces: ``a - b`` is one entry and ``a -b`` are two, as in MATLAB.

    Parameters
    ----------
    row : str
        In one line.

    Returns
    -------
    list of str
    """
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


def _parted(text: str, sign: str) -> list[str]:
    """Split a text at a sign that stands in no brackets."""
    parts, depth, begin = [], 0, 0
    for index, letter in enumerate(text):
        depth += (letter in _OPENING) - (letter in _CLOSING)
        if letter == sign and depth == 0:
            parts.append(text[begin:index])
            begin = index + 1
    return [*parts, text[begin:]]


def _stripped(cells: list[str]) -> list[str]:
    return [cell.strip() for cell in cells]
