"""The rows of a Jacobian that a print means where it does not say them."""

from __future__ import annotations

import numpy as np

from drake_leg.check.sampling import random_configurations
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import jacobian
from drake_leg.robot import Robot

COUNT = 8  # configurations
NEGLIGIBLE = 1e-9  # of a Jacobian's largest entry
POSITION, PLANAR = (3, 4, 5), (3, 4, 2)  # x, y, z; x, y, yaw


def task_rows(robot: Robot, columns: int) -> tuple[int, ...] | None:
    """Choose three rows: x, y, z, or x, y, yaw where z is no task.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    columns : int
        Of the Jacobian, the first ones.

    Returns
    -------
    tuple of int or None
        Rows, rotation first; None where the columns leave both singular everywhere.
    """
    Jv_BF = _jacobians(robot)[..., :columns]
    rank = min(len(POSITION), Jv_BF.shape[-1])
    for rows in (POSITION, PLANAR):
        part = Jv_BF[:, list(rows)]
        if np.linalg.matrix_rank(part, tol=NEGLIGIBLE * np.abs(part).max()).max() == rank:
            return rows
    return None


def fewest_columns(robot: Robot, rows: tuple[int, ...]) -> int:
    """Count the columns of a Jacobian up to the last one that is not zero in some rows.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    """
    Jv_BF = np.abs(_jacobians(robot)[:, list(rows)])
    moved = np.flatnonzero(Jv_BF.max(axis=(0, 1)) > NEGLIGIBLE * Jv_BF.max())
    return int(moved.max(initial=-1)) + 1


def _jacobians(robot: Robot) -> Array:
    rng = np.random.default_rng(0)
    return jacobian(robot.rows, random_configurations(robot, COUNT, rng))
