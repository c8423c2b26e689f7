r"""Reads from a name what a matrix claims to be: T12, ^0T_4, A2, R01, p_04, J_v, \det(J)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.feet import random_configurations
from drake_leg.kinematics.khalil import Array, jacobian
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.spelling import plain, quoted, typed, without_latex

Kind = Literal["transform", "rotation", "position", "jacobian", "determinant"]

NAMES = "T12, T04 and the like, A2, R01, P04, J, Jv, Jw, detJ"
POSITION, PLANAR = (3, 4, 5), (3, 4, 2)  # rows x, y, z; x, y, yaw
FIRST_LENGTH = 3  # of a Jacobian's rows, rotation first
# Rows of a Jacobian by their names, rotation first.
JACOBIAN_ROWS = {
    **{"wx": 0, "wy": 1, "wz": 2, "yaw": 2},
    **{"x": 3, "y": 4, "z": 5, "vx": 3, "vy": 4, "vz": 5},
}
_KINDS: dict[str, Kind] = {
    **dict.fromkeys("tha", "transform"),
    "r": "rotation",
    "p": "position",
}
_ROWS = {
    "": (),
    **dict.fromkeys(("v", "p"), ("x", "y", "z")),
    **dict.fromkeys(("w", "omega", "o"), ("wx", "wy", "wz")),
}
_JACOBIAN = r"(?:jacobian|jacobienne|jacobien|jacobi|jac|j)(?:matrix)?"
# With and without the constant last row; a position may be a row.
_SHAPES: dict[Kind, tuple[tuple[int, int], ...]] = {
    "transform": ((4, 4), (3, 4)),
    "rotation": ((3, 3),),
    "position": ((3, 1), (4, 1), (1, 3), (1, 4)),
}
_ALL_ROWS = (0, 1, 2, 3, 4, 5)
_SAMPLES = 8  # configurations at which a Jacobian's rank is computed
_NEGLIGIBLE = 1e-9  # of a Jacobian's largest entry


@dataclass(frozen=True, kw_only=True)
class MatrixName:
    """A matrix's name as read."""

    kind: Kind
    frames: tuple[int, int] = (0, 0)  # pose of the second in the first
    rows: tuple[str, ...] = ()  # of a Jacobian, where its name says them


def read_name(text: str) -> MatrixName:
    """Read the name of a matrix, or refuse one that means nothing.

    ``T12`` is the pose of frame 2 in frame 1, ``T21`` that of frame 1 in frame 2, its inverse.
    Where one number is above and the other below, as in ``T_1^2`` and ``T_2^1``, prints differ
    on which is which: both are T12. In front, ``{}^1T_2`` and ``{}^1_2T``, the upper one is the
    reference frame.
    """
    try:
        name = without_latex(typed(text[:200]))
    except InvalidValueError:
        name = ""
    name = re.sub(r"\s|\{\}|[\[\]]|=$|:$", "", name)
    bare = re.sub(r"[{}]", "", name)
    found = _numbered(bare) or _step(bare) or _jacobian_name(bare)
    if not found:
        raise InvalidValueError(
            f"the matrix {quoted(text)} means nothing here; write one of {NAMES}"
        )
    return found


def kind_of_name(text: str) -> Kind | None:
    """Say what a matrix is, or None where its name means nothing."""
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


def _jacobian_name(name: str) -> MatrixName | None:
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
    kind: Kind = "determinant" if inside else "jacobian"
    return MatrixName(kind=kind, rows=_ROWS[found[1] or ""])


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What a matrix is according to its name and rows."""

    name: str  # as printed
    kind: Kind
    frames: tuple[int, int] = (0, 0)  # of a transform: the second in the first
    rows: tuple[int, ...] = ()  # of a Jacobian: indices, rotation first
    shape: tuple[int, int]

    @property
    def is_pose(self) -> bool:
        """Whether it is a transform, a rotation or a position."""
        return self.kind in _SHAPES


def claim_of(
    name: str, rows: Sequence[str], typed_shape: tuple[int, int], robot: Robot, rows_key: str
) -> Claim:
    """Read what a matrix is; raise ``InvalidValueError`` if its name means nothing for this robot.

    Parameters
    ----------
    name : str
        T12, T_0^4, R01, P04, J or detJ.
    rows : sequence of str
        Of a Jacobian, where the print says them.
    rows_key : str
        Where the print says them, for advice.
    """
    read = read_name(name)
    if read.kind in _SHAPES:
        if max(read.frames) > len(robot.rows):
            raise InvalidValueError(
                f"{robot.name} has the frames 0 to {len(robot.rows)}; write two of them"
            )
        first, *others = _SHAPES[read.kind]
        shape = typed_shape if typed_shape in others else first
        return Claim(name=name, kind=read.kind, frames=read.frames, shape=shape)
    asked = f"name every row {rows_key}, each one of {', '.join(JACOBIAN_ROWS)}"
    names = [plain(row).replace(" ", "").replace("omega", "w") for row in rows or read.rows]
    if any(row not in JACOBIAN_ROWS for row in names):
        raise InvalidValueError(f"its rows are named {', '.join(rows)}; {asked}")
    indices = tuple(JACOBIAN_ROWS[row] for row in names)
    if read.kind == "determinant":
        indices = indices or task_rows(robot, 3) or POSITION
        if len(indices) > len(robot.moving):
            raise InvalidValueError(
                f"a determinant of {len(indices)} rows, and {robot.name} has {len(robot.moving)} "
                f"joint positions; name as many rows {rows_key}"
            )
        return Claim(name=name, kind="determinant", rows=indices, shape=(1, 1))
    count, columns = typed_shape
    if not indices and count not in (len(POSITION), len(_ALL_ROWS)):
        raise InvalidValueError(f"it does not say what its rows are; {asked}")
    if not indices:
        six = count == len(_ALL_ROWS)
        indices = _ALL_ROWS if six else task_rows(robot, columns) or POSITION
    if not fewest_columns(robot, indices) <= columns <= len(robot.moving):
        columns = len(robot.moving)
    return Claim(name=name, kind="jacobian", rows=indices, shape=(len(indices), columns))


def task_rows(robot: Robot, columns: int) -> tuple[int, ...] | None:
    """Choose three rows of a Jacobian's first columns: x, y, z, or x, y, yaw if z does not move.

    None if both are singular everywhere.
    """
    Jv_BF = _jacobians(robot)[..., :columns]
    rank = min(len(POSITION), Jv_BF.shape[-1])
    for rows in (POSITION, PLANAR):
        part = Jv_BF[:, list(rows)]
        if np.linalg.matrix_rank(part, tol=_NEGLIGIBLE * np.abs(part).max()).max() == rank:
            return rows
    return None


def fewest_columns(robot: Robot, rows: tuple[int, ...]) -> int:
    """Count the columns of a Jacobian up to the last one that is not zero in some rows."""
    Jv_BF = np.abs(_jacobians(robot)[:, list(rows)])
    moved = np.flatnonzero(Jv_BF.max(axis=(0, 1)) > _NEGLIGIBLE * Jv_BF.max())
    return int(moved.max(initial=-1)) + 1


def _jacobians(robot: Robot) -> Array:
    rng = np.random.default_rng(0)
    return jacobian(robot.rows, random_configurations(robot, _SAMPLES, rng))
