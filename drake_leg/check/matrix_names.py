r"""What a matrix is by its printed name: T12, ^0T_4, A2, R01, p_04, J_v, \det(J), |J|."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from drake_leg.check.characters import typed
from drake_leg.check.latex import without_latex
from drake_leg.check.notation import quoted
from drake_leg.errors import InvalidValueError

Kind = Literal["transform", "rotation", "position", "jacobian", "determinant"]

NAMES = "T12, T04 and the like, A2, R01, P04, J, Jv, Jw, detJ"
_KINDS: dict[str, Kind] = {
    "t": "transform",
    "h": "transform",
    "a": "transform",
    "r": "rotation",
    "p": "position",
}
_ROWS = {
    "": (),
    "v": ("x", "y", "z"),
    "p": ("x", "y", "z"),
    "w": ("wx", "wy", "wz"),
    "omega": ("wx", "wy", "wz"),
    "o": ("wx", "wy", "wz"),
}
_JACOBIAN = r"(?:jacobian|jacobienne|jacobien|jacobi|jac|j)(?:matrix)?"


@dataclass(frozen=True, kw_only=True)
class MatrixName:
    """A matrix's name as read."""

    kind: Kind
    frames: tuple[int, int] = (0, 0)  # pose of the second in the first
    rows: tuple[str, ...] = ()  # of a Jacobian, where its name says them


def read_name(text: str) -> MatrixName:
    """Read the name of a matrix.

    ``T12`` is the pose of frame 2 in frame 1, ``T21`` that of frame 1 in frame 2, its inverse.
    Where one number stands above and the other below, as in ``T_1^2`` and ``T_2^1``, prints differ
    on which is which: both are T12. In front, ``{}^1T_2`` and ``{}^1_2T``, the upper one is the
    frame that is looked from.

    Raises
    ------
    InvalidValueError
        If it means nothing.
    """
    try:
        name = without_latex(typed(text[:200]))
    except InvalidValueError:
        name = ""
    name = re.sub(r"\s|\{\}|[\[\]]|=$|:$", "", name)
    bare = re.sub(r"[{}]", "", name)
    found = _numbered(bare) or _step(bare) or _jacobian(bare)
    if not found:
        raise InvalidValueError(
            f"the matrix {quoted(text)} means nothing here; write one of {NAMES}"
        )
    return found


def kind_of_name(text: str) -> Kind | None:
    """Say what a matrix is, or None where its name means nothing.

    Returns
    -------
    str or None
    """
    try:
        return read_name(text).kind
    except InvalidValueError:
        return None


def _numbered(name: str) -> MatrixName | None:
    """Read a name with two frames."""
    letters = "".join(_KINDS)
    before = re.fullmatch(rf"\^?(\d)_?([{letters}])_?(\d)", name)
    if before:
        return _named(before[2], int(before[1]), int(before[3]))
    stacked = re.fullmatch(rf"(?:\^(\d)_(\d)|_(\d)\^(\d))([{letters}])", name)
    if stacked:
        upper, lower = stacked[1] or stacked[4], stacked[2] or stacked[3]
        return _named(stacked[5], int(upper), int(lower))
    either = re.fullmatch(rf"([{letters}])(?:_(\d)\^(\d)|\^(\d)_(\d))", name)
    if either:
        first, last = sorted(int(digit) for digit in either.groups()[1:] if digit)
        return _named(either[1], first, last)
    after = re.fullmatch(rf"([{letters}])[_^]?(\d)(?:[_,/-]|->|→|to)*(\d)", name)
    return _named(after[1], int(after[2]), int(after[3])) if after else None


def _named(letter: str, first: int, last: int) -> MatrixName:
    return MatrixName(kind=_KINDS[letter], frames=(first, last))


def _step(name: str) -> MatrixName | None:
    """Read A2, the pose of frame 2 in frame 1, and P4, the position of frame 4 in frame 0."""
    found = re.fullmatch(r"([ap])_?([1-9])", name)
    if not found:
        return None
    return _named(found[1], int(found[2]) - 1 if found[1] == "a" else 0, int(found[2]))


def _jacobian(name: str) -> MatrixName | None:
    """Read a Jacobian or its determinant."""
    inside = re.fullmatch(r"\|(.+)\||(?:determinant|det)(?:of)?(.*)", name)
    inner = next(filter(None, inside.groups()), "j") if inside else name
    while inner.startswith("(") and inner.endswith(")"):
        inner = inner[1:-1]
    found = re.fullmatch(
        rf"(?:\^?0)?{_JACOBIAN}_?(v|p|w|omega|o)?_?(?:0\d?)?(?:_?[1-9][x*][1-9])?"
        r"(?:_?[4-9])?(?:\((?:q|theta)(?:_?\d(?:,(?:q|theta)_?\d)*)?\))?",
        inner,
    )
    if not found:
        return None
    rows = _ROWS[found[1] or ""]
    return MatrixName(kind="determinant" if inside else "jacobian", rows=rows)
