"""Formulas as text in the reports' own symbols, which is both shown and evaluated.

Lengths are in mm, as in report B.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from drake_leg.kinematics.batches import Array

Formula = tuple[tuple[str, ...], ...]  # rows of entries
Values = Mapping[str, float]

BOTTOM = ("0", "0", "0", "1")


def evaluate(formula: Formula, values: Values) -> Array:
    """Evaluate a matrix.

    Parameters
    ----------
    formula : (m, n) tuple of tuples of str
        Entries in the names of ``values``, cos and sin.
    values : mapping
        Of the names [mm or rad].

    Returns
    -------
    (m, n) ndarray
        In the entries' units.
    """
    return np.array([[evaluate_entry(entry, values) for entry in row] for row in formula])


def evaluate_entry(entry: str, values: Values) -> float:
    """Evaluate one formula.

    Parameters
    ----------
    entry : str
        In the names of ``values``, cos and sin.
    values : mapping
        Of the names [mm or rad].

    Returns
    -------
    float
        In the formula's unit.
    """
    names = {"cos": math.cos, "sin": math.sin, **values}
    return float(eval(entry, {"__builtins__": {}}, names))


def shown(formula: Formula) -> str:
    """Write a matrix in one line, rows between semicolons."""
    rows = "; ".join(", ".join(row) for row in formula)
    return f"[{rows}]".replace("*", "·").replace("-", "−")


def angle_values(q: Sequence[float]) -> dict[str, float]:
    """Name joint angles as report B does.

    Parameters
    ----------
    q : (n,) sequence of float
        [rad].
    """
    return {f"θ{joint}": angle for joint, angle in enumerate(q, start=1)}


def multiplied(neighbours: Mapping[str, Formula], values: Values) -> Array:
    """Multiply a report's four transforms between neighbours.

    Parameters
    ----------
    neighbours : mapping
        With T01, T12, T23 and T34.
    values : mapping
        Of the names in them [mm or rad].

    Returns
    -------
    (4, 4) ndarray
        T04 [-, mm].
    """
    T04 = np.eye(4)
    for name in ("T01", "T12", "T23", "T34"):
        T04 = T04 @ evaluate(neighbours[name], values)
    return T04


def rotation_defect(X: Array) -> tuple[float, float]:
    """Say how far the upper left of a transform is from a rotation.

    Parameters
    ----------
    X : (4, 4) ndarray
        Called a homogeneous transform.

    Returns
    -------
    determinant : float
        1 for a rotation.
    deviation : float
        Greatest entry of ``R' R - 1``, 0 for a rotation.
    """
    R = X[:3, :3]
    return float(np.linalg.det(R)), float(np.abs(R.T @ R - np.eye(3)).max())
