"""What a printed matrix claims to be, by its name, and what would be right there."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from drake_leg.check.chains import Chain
from drake_leg.check.notation import plain
from drake_leg.check.printed_file import PrintedMatrix
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

Kind = Literal["transform", "position", "jacobian", "determinant"]

NAMES = "T12, T04 and the like, P04, J, detJ"
# Rows of a Jacobian by their names, rotation first.
JACOBIAN_ROWS = {"wx": 0, "wy": 1, "wz": 2, "yaw": 2, "x": 3, "y": 4, "z": 5} | {
    "vx": 3,
    "vy": 4,
    "vz": 5,
}
_USUAL_ROWS = {3: ("x", "y", "z"), 6: ("wx", "wy", "wz", "x", "y", "z")}


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What a matrix says it is."""

    name: str  # as printed
    kind: Kind
    frames: tuple[int, int] = (0, 0)  # of a transform: from the second to the first
    rows: tuple[int, ...] = ()  # of a Jacobian: indices, rotation first
    shape: tuple[int, int]


def claim_of(matrix: PrintedMatrix, robot: Robot) -> Claim:
    """Read the name of a matrix.

    Parameters
    ----------
    matrix : PrintedMatrix
        Named T12, T_0^4, P04, J or detJ.
    robot : Robot
        Whose frames these are.

    Returns
    -------
    Claim

    Raises
    ------
    InvalidValueError
        If the name means nothing, or the robot has no such frame.
    """
    name = plain(matrix.name)
    numbered = re.fullmatch(r"([tp])\D*(\d)\D*(\d)\D*", name)
    if numbered:
        first, last = sorted((int(numbered[2]), int(numbered[3])))
        if last > len(robot.rows):
            raise InvalidValueError(
                f"{matrix.name}: {robot.name} has the frames 0 to {len(robot.rows)}"
            )
        kind: Kind = "transform" if numbered[1] == "t" else "position"
        shape = (4, 4) if kind == "transform" else (3, 1)
        return Claim(name=matrix.name, kind=kind, frames=(first, last), shape=shape)
    kinds: dict[str, Kind] = {"j": "jacobian", "jacobian": "jacobian", "detj": "determinant"}
    if name not in kinds:
        raise InvalidValueError(f"the matrix {matrix.name!r} means nothing here; there are {NAMES}")
    if kinds[name] == "determinant":
        rows = _row_indices(matrix, 3)
        return Claim(name=matrix.name, kind="determinant", rows=rows, shape=(1, 1))
    rows = _row_indices(matrix, len(matrix.entries))
    columns = min(len(matrix.entries[0]), len(robot.moving))
    return Claim(name=matrix.name, kind="jacobian", rows=rows, shape=(len(rows), columns))


def _row_indices(matrix: PrintedMatrix, count: int) -> tuple[int, ...]:
    names = matrix.rows or _USUAL_ROWS.get(count, ())
    if not names or any(name not in JACOBIAN_ROWS for name in names):
        raise InvalidValueError(
            f"{matrix.name}: rows is {list(names)}; name every row, each one of "
            f"{', '.join(JACOBIAN_ROWS)}"
        )
    return tuple(JACOBIAN_ROWS[name] for name in names)


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
    if claim.kind in ("transform", "position"):
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
    if claim.kind == "transform":
        return whole
    if claim.kind == "position":
        return whole[:, :3, 3:]
    Jv_BF = whole[:, list(claim.rows)]
    if claim.kind == "jacobian":
        return Jv_BF[..., : claim.shape[1]]
    determinants: Array = np.linalg.det(Jv_BF[..., : len(claim.rows)])
    return determinants[:, np.newaxis, np.newaxis]


def scales(claim: Claim, length: float) -> Array:
    """Say how large the entries of a claim can be.

    Parameters
    ----------
    claim : Claim
        What is compared.
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
