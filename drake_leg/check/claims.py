"""What a printed matrix claims to be, by its name, and what would be right there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.check.chains import Chain
from drake_leg.check.matrix_names import Kind, read_name
from drake_leg.check.notation import plain
from drake_leg.check.printed_file import PrintedMatrix
from drake_leg.check.tasks import POSITION, fewest_columns, task_rows
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

# Rows of a Jacobian by their names, rotation first.
JACOBIAN_ROWS = {"wx": 0, "wy": 1, "wz": 2, "yaw": 2, "x": 3, "y": 4, "z": 5} | {
    "vx": 3,
    "vy": 4,
    "vz": 5,
}
# With and without a last row that is always the same; a position may lie.
_SHAPES: dict[Kind, tuple[tuple[int, int], ...]] = {
    "transform": ((4, 4), (3, 4)),
    "rotation": ((3, 3),),
    "position": ((3, 1), (4, 1), (1, 3), (1, 4)),
}
_ALL_ROWS = (0, 1, 2, 3, 4, 5)


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What a matrix says it is."""

    name: str  # as printed
    kind: Kind
    frames: tuple[int, int] = (0, 0)  # of a transform: the second in the first
    rows: tuple[int, ...] = ()  # of a Jacobian: indices, rotation first
    shape: tuple[int, int]


def claim_of(matrix: PrintedMatrix, robot: Robot) -> Claim:
    """Read the name of a matrix.

    Parameters
    ----------
    matrix : PrintedMatrix
        Named T12, T_0^4, R01, P04, J or detJ.
    robot : Robot
        Whose frames these are.

    Raises
    ------
    InvalidValueError
        If the name means nothing, or the robot has no such frame.
    """
    name = read_name(matrix.name)
    if name.kind in _SHAPES:
        if max(name.frames) > len(robot.rows):
            raise InvalidValueError(
                f"{robot.name} has the frames 0 to {len(robot.rows)}; write two of them"
            )
        typed = (len(matrix.entries), len(matrix.entries[0]))
        first, *others = _SHAPES[name.kind]
        shape = typed if typed in others else first
        return Claim(name=matrix.name, kind=name.kind, frames=name.frames, shape=shape)
    if name.kind == "determinant":
        rows = _row_indices(matrix, name.rows) or task_rows(robot, 3) or POSITION
        if len(rows) > len(robot.moving):
            raise InvalidValueError(
                f"a determinant of {len(rows)} rows, and {robot.name} has {len(robot.moving)} "
                "joint positions; name as many rows under rows"
            )
        return Claim(name=matrix.name, kind="determinant", rows=rows, shape=(1, 1))
    rows = _row_indices(matrix, name.rows) or _usual_rows(matrix, robot)
    fewest, joints = fewest_columns(robot, rows), len(robot.moving)
    typed_columns = len(matrix.entries[0])
    columns = typed_columns if fewest <= typed_columns <= joints else joints
    return Claim(name=matrix.name, kind="jacobian", rows=rows, shape=(len(rows), columns))


def _usual_rows(matrix: PrintedMatrix, robot: Robot) -> tuple[int, ...]:
    """Take the rows of a Jacobian that does not say them by their number."""
    count = len(matrix.entries)
    if count == len(_ALL_ROWS):
        return _ALL_ROWS
    if count != len(POSITION):
        raise InvalidValueError(f"it does not say what its rows are; {_name_rows()}")
    return task_rows(robot, len(matrix.entries[0])) or POSITION


def _row_indices(matrix: PrintedMatrix, named: Sequence[str]) -> tuple[int, ...]:
    names = [_row_name(name) for name in matrix.rows or named]
    if any(name not in JACOBIAN_ROWS for name in names):
        raise InvalidValueError(f"its rows are said to be {', '.join(matrix.rows)}; {_name_rows()}")
    return tuple(JACOBIAN_ROWS[name] for name in names)


def _name_rows() -> str:
    return f"name every row under rows, each one of {', '.join(JACOBIAN_ROWS)}"


def _row_name(name: str) -> str:
    """Read ω_x as wx."""
    return plain(name).replace(" ", "").replace("omega", "w")


def right_values(claim: Claim, chain: Chain) -> Array:
    """Evaluate what is claimed, in the chain's unit of lengths.

    Parameters
    ----------
    claim : Claim
        A transform, a position, a Jacobian or a determinant.
    chain : Chain
        The robot at N samples.

    Returns
    -------
    (N, r, c) ndarray
        Of the claim's shape.
    """
    if claim.kind in ("transform", "rotation", "position"):
        first, last = claim.frames
        X_B = chain.frames()
        return claimed_part(claim, between(X_B, first, last))
    return claimed_part(claim, chain.jacobian())


def between(X_B: Array, first: int, last: int) -> Array:
    """Transform from one frame to another.

    Parameters
    ----------
    X_B : (N, n + 1, 4, 4) ndarray
        Poses of all frames in the base.
    first, last : int
        To which frame, and from which.

    Returns
    -------
    (N, 4, 4) ndarray
    """
    relative: Array = np.linalg.inv(X_B[:, first]) @ X_B[:, last]
    return relative


def claimed_part(claim: Claim, whole: Array) -> Array:
    """Take what is claimed out of a pose, or out of a Jacobian of six rows.

    Parameters
    ----------
    claim : Claim
        What a matrix is.
    whole : (N, 4, 4) or (N, 6, m) ndarray
        Pose, or Jacobian with the rotation first.

    Returns
    -------
    (N, r, c) ndarray
        Of the claim's shape.
    """
    if claim.kind == "position":
        return whole[:, : max(claim.shape), 3].reshape(-1, *claim.shape)
    if claim.kind in ("transform", "rotation"):
        return whole[:, : claim.shape[0], : claim.shape[1]]
    Jv_BF = whole[:, list(claim.rows)]
    if claim.kind == "jacobian":
        return Jv_BF[..., : claim.shape[1]]
    determinants: Array = np.linalg.det(Jv_BF[..., : len(claim.rows)])
    return determinants[:, np.newaxis, np.newaxis]


def scales(claim: Claim, length: float) -> Array:
    """Say how large the entries of a claim can be.

    Parameters
    ----------
    length : float
        Of the robot's table, in the print's unit.

    Returns
    -------
    (r, c) ndarray
        1 for a rotation's entries, the length for others.
    """
    scale = np.ones(claim.shape)
    if claim.kind == "transform":
        scale[:3, 3] = length
    elif claim.kind == "position":
        scale[:] = length
    elif claim.kind == "jacobian":
        scale[[row >= 3 for row in claim.rows]] = length
    else:
        scale[:] = length ** sum(row >= 3 for row in claim.rows)
    return scale
