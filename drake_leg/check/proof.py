"""A robot proved: its chain, SymPy's derivation and Drake's plant agree on foot and Jacobian.

Four witnesses that share no formula: the chain (``kinematics.khalil``), the same table derived in
symbols, Drake on the SDF, and differences of the chain's foot. A foot's coordinate is a sum of
``a cos q + b sin q + c`` in a turning joint and linear in a sliding one, so that the difference
over a quarter turn to either side, halved, *is* the derivative, with no error but rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from drake_leg.check.sampling import chain_size, random_configurations
from drake_leg.check.witness import DrakeWitness
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot, Row
from drake_leg.symbolic.optional import require_sympy

TOLERANCE = 1e-12  # of 1 where an entry is a rotation, of the robot's size where it is a length
SAMPLES = 32
MOST_SAMPLES = 10_000

Function = Callable[[Array], Array]  # of configurations (N, m), with the same first axis


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Two witnesses compared on all configurations: where they differ most."""

    quantity: str  # foot or Jacobian
    first: str  # chain, SymPy, Drake or differences
    second: str
    difference: float  # of 1, or of the robot's size
    entry: tuple[int, int]  # row and column, counted from 1
    q: tuple[float, ...]  # [rad or m], in the table's order
    values: tuple[float, float]  # of the two witnesses there [-, m]

    @property
    def agrees(self) -> bool:
        """Whether the greatest difference is rounding."""
        return self.difference <= TOLERANCE

    def as_json(self) -> dict[str, Any]:
        """Return the fields by name; units in the names.

        Returns
        -------
        dict
        """
        fields = asdict(self)
        q = fields.pop("q")
        return {"agrees": self.agrees, **fields, "q_rad_or_m": q}


@dataclass(frozen=True, kw_only=True)
class Proof:
    """What the witnesses say of a robot."""

    robot: str
    samples: int
    seed: int
    size: float  # [m], lengths are compared relative to it
    comparisons: tuple[Comparison, ...]

    @property
    def holds(self) -> bool:
        """Whether all witnesses agree."""
        return all(comparison.agrees for comparison in self.comparisons)

    @property
    def worst(self) -> Comparison:
        """Where two witnesses differ most; one that has no number is worse than any."""
        return max(self.comparisons, key=lambda c: (math.isnan(c.difference), c.difference))

    def as_json(self) -> dict[str, Any]:
        """Return everything by name; units in the names.

        Returns
        -------
        dict
        """
        return {
            "holds": self.holds,
            "samples": self.samples,
            "seed": self.seed,
            "size_m": self.size,
            "tolerance": TOLERANCE,
            "comparisons": [comparison.as_json() for comparison in self.comparisons],
        }


def prove(robot: Robot, *, samples: int = SAMPLES, seed: int = 0) -> Proof:
    """Compare the chain with SymPy, with Drake and with its own differences.

    Entries of a rotation are compared as they are, lengths relative to ``chain_size``; both must
    agree to 1e-12.

    Parameters
    ----------
    robot : Robot
        Any robot.
    samples : int
        Random configurations within the joints' limits.
    seed : int
        Of their random numbers.

    Returns
    -------
    Proof
        Which does not say that the table is the robot's that was meant.

    Raises
    ------
    InvalidValueError
        If there is no sample, or the seed is negative.
    MissingSymPyError
        If SymPy is not installed.
    """
    if not 1 <= samples <= MOST_SAMPLES:
        raise InvalidValueError(f"samples is {samples}; it must be 1 to {MOST_SAMPLES}")
    if seed < 0:
        raise InvalidValueError(f"the seed is {seed}; it must not be negative")
    require_sympy("drake-leg check")
    configurations = random_configurations(robot, samples, np.random.default_rng(seed))
    feet, jacobians = _witnesses(robot)
    size = chain_size(robot)
    return Proof(
        robot=robot.name,
        samples=samples,
        seed=seed,
        size=size,
        comparisons=(
            *_compare_all("foot", feet, configurations, _pose_scale(size)),
            *_compare_all("Jacobian", jacobians, configurations, _twist_scale(robot, size)),
        ),
    )


def _witnesses(robot: Robot) -> tuple[dict[str, Function], dict[str, Function]]:
    """Return every witness's foot and Jacobian as functions of all configurations."""
    from drake_leg.symbolic.chain import chain_functions

    symbolic, drake = chain_functions(robot.rows), DrakeWitness(robot)
    feet: dict[str, Function] = {
        "chain": lambda q: khalil.foot_pose(robot.rows, q),
        "SymPy": _one_by_one(symbolic.foot),
        "Drake": _one_by_one(drake.foot),
    }
    jacobians: dict[str, Function] = {
        "chain": lambda q: khalil.jacobian(robot.rows, q),
        "SymPy": _one_by_one(symbolic.jacobian),
        "Drake": _one_by_one(drake.jacobian),
        "differences": lambda q: difference_jacobian(robot.rows, q),
    }
    return feet, jacobians


def _one_by_one(function: Function) -> Function:
    return lambda configurations: np.array([function(q) for q in configurations])


def difference_jacobian(rows: Sequence[Row], q: Array) -> Array:
    """Jacobian from exact differences of the chain's foot.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which m rows move.
    q : (..., m) ndarray
        Joint positions [rad or m].

    Returns
    -------
    Jv_BF : (..., 6, m) ndarray
        Rows 0-2 angular, rows 3-5 translational, in the base frame [rad, m per rad or m].
    """
    X_BF = khalil.foot_pose(rows, q)
    columns = []
    for joint, index in enumerate(khalil.moving_rows(rows)):
        step = np.zeros(q.shape[-1])
        step[joint] = math.pi / 2.0 if rows[index].joint == "revolute" else 1.0
        dX = (khalil.foot_pose(rows, q + step) - khalil.foot_pose(rows, q - step)) / 2.0
        spin = dX[..., :3, :3] @ np.swapaxes(X_BF[..., :3, :3], -1, -2)
        twist = (spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0])
        columns.append(np.stack([*twist, *np.moveaxis(dX[..., :3, 3], -1, 0)], axis=-1))
    return np.stack(columns, axis=-1)


def _pose_scale(size: float) -> Array:
    scale = np.ones((4, 4))
    scale[:3, 3] = size
    return scale


def _twist_scale(robot: Robot, size: float) -> Array:
    """Scale angular rows and sliding joints' columns by 1, lengths by the robot's size."""
    scale = np.ones((6, len(robot.moving)))
    turning = [segment.row.joint == "revolute" for segment in robot.moving]
    scale[3:, turning] = size
    return scale


def _compare_all(
    quantity: str, witnesses: dict[str, Function], configurations: Array, scale: Array
) -> list[Comparison]:
    """Compare every witness with every other."""
    values = {name: witness(configurations) for name, witness in witnesses.items()}
    names = list(values)
    pairs = [(a, b) for i, a in enumerate(names) for b in names[i + 1 :]]
    return [_compare(quantity, a, b, values[a], values[b], configurations, scale) for a, b in pairs]


def _compare(
    quantity: str, first: str, second: str, a: Array, b: Array, q: Array, scale: Array
) -> Comparison:
    differences = np.abs(a - b) / scale
    sample, row, column = map(int, np.unravel_index(differences.argmax(), differences.shape))
    return Comparison(
        quantity=quantity,
        first=first,
        second=second,
        difference=float(differences[sample, row, column]),
        entry=(row + 1, column + 1),
        q=tuple(q[sample].tolist()),
        values=(float(a[sample, row, column]), float(b[sample, row, column])),
    )
