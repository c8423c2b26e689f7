"""Proves a robot: its chain, SymPy's derivation and Drake's plant agree on foot and Jacobian.

Four witnesses that share no formula: the chain (``kinematics.khalil``), the same table derived in
symbols, Drake on the SDF, and differences of the chain's foot. A foot's coordinate is a sum of
``a cos q + b sin q + c`` in a turning joint and linear in a sliding one, so that the difference
over a quarter turn to either side, halved, *is* the derivative, with no error but rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache, partial
from itertools import combinations
from numbers import Integral
from typing import Any

import numpy as np

from drake_leg.arguments import require_callable, shown
from drake_leg.errors import InvalidValueError, TimeBudgetError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.feet import greatest_reach, random_configurations
from drake_leg.kinematics.khalil import Array
from drake_leg.models.witnesses import DrakeWitness, Testimony, one_by_one, widened
from drake_leg.progress import BUDGET, TimeBudget
from drake_leg.robot.robot import Robot, Row, Segment, html_table, require_robot
from drake_leg.units import require_positive

TOLERANCE = 1e-12  # of 1 where an entry is a rotation, of the robot's size where it is a length
SAMPLES = 32
MOST_SAMPLES = 10_000
WITNESSES = ("loops", "chain", "SymPy", "Drake", "differences")
ORDER = ("loops", "chain", "differences", "Drake", "SymPy")  # the quickest first
FOOT, JACOBIAN = "foot", "Jacobian"

Report = Callable[[str], None]  # called with what is computed next


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Two witnesses compared on all configurations: where they differ most."""

    quantity: str  # foot or Jacobian; of which tip, if there are several
    first: str  # loops, chain, SymPy, Drake or differences
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
        """Return the fields by name; units in the names."""
        fields = asdict(self)
        q = fields.pop("q")
        return {"agrees": self.agrees, **fields, "q_rad_or_m": q}


@dataclass(frozen=True, kw_only=True)
class Missing:
    """A witness without an answer."""

    quantity: str  # foot or Jacobian
    witness: str  # chain, SymPy, Drake or differences
    why: str


@dataclass(frozen=True, kw_only=True)
class Proof:
    """Result of comparing all witnesses of a robot."""

    robot: str
    samples: int
    seed: int
    size: float  # [m], lengths are compared relative to it
    comparisons: tuple[Comparison, ...]
    missing: tuple[Missing, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether all witnesses that answered agree."""
        return all(comparison.agrees for comparison in self.comparisons)

    @property
    def complete(self) -> bool:
        """Whether all witnesses answered."""
        return not self.missing

    @property
    def worst(self) -> Comparison | None:
        """The comparison with the greatest difference; NaN counts as the greatest."""
        return max(
            self.comparisons,
            key=lambda c: (math.isnan(c.difference), c.difference),
            default=None,
        )

    @property
    def verdict(self) -> str:
        """The result in one sentence."""
        if not self.comparisons:
            return "NOT proved: nothing was compared within the budget"
        if not self.holds:
            return f"NOT proved: at least one is above {TOLERANCE:g}"
        if not self.complete:
            return f"proved in part: none of these is above {TOLERANCE:g}"
        return f"proved: none is above {TOLERANCE:g}"

    def __repr__(self) -> str:
        return f"<Proof of {self.robot}: {self.verdict}>"

    def _repr_html_(self) -> str:
        rows = [
            (c.quantity, c.first, c.second, f"{c.difference:.1e}", "yes" if c.agrees else "NO")
            for c in self.comparisons
        ]
        rows += [(m.quantity, m.witness, "", m.why, "not compared") for m in self.missing]
        headings = ("quantity", "by", "and by", "greatest difference", "agree")
        title = (
            f"{self.robot}: {self.verdict} ({self.samples} random configurations, lengths "
            f"relative to {self.size:.6g} m)"
        )
        return html_table(headings, rows, title=title)

    def as_json(self) -> dict[str, Any]:
        """Return everything by name; units in the names."""
        return {
            "holds": self.holds,
            "complete": self.complete,
            "missing": [asdict(missing) for missing in self.missing],
            "samples": self.samples,
            "seed": self.seed,
            "size_m": self.size,
            "tolerance": TOLERANCE,
            "comparisons": [comparison.as_json() for comparison in self.comparisons],
        }


def prove(
    robot: Robot,
    *,
    samples: int = SAMPLES,
    seed: int = 0,
    budget: float = BUDGET,
    progress: Report | None = None,
) -> Proof:
    """Compare the chain with SymPy, with Drake and with its own differences.

    Of closed loops, pose and twist at each cut are compared with the motion of the cut joint, too,
    in closed postures. If a link has mass, the torques of random motions by SymPy's Newton-Euler
    equations are compared with Drake's inverse dynamics; closed loops are cut for that.

    Entries of a rotation are compared as they are, lengths relative to ``greatest_reach``, torques
    to the greatest of them; all must agree to 1e-12.

    Parameters
    ----------
    samples : int
        Random configurations within the joints' limits.
    seed : int
        Of their random numbers.
    budget : float
        Time budget [s]; comparisons not made by then are missing.
    progress : callable, optional
        Called with what is computed next.

    Returns
    -------
    Proof
        It does not prove that the table is that of the intended robot.

    Raises
    ------
    InvalidValueError
        If samples or the seed is not a whole number within its bounds, the budget is not positive,
        or progress is not a function.

    Examples
    --------
    >>> from drake_leg import PENDULUM, prove
    >>> proof = prove(PENDULUM)
    >>> proof.holds, proof.complete
    (True, True)
    >>> proof.worst.difference < 1e-15
    True
    """
    require_robot(robot)
    _require_whole("samples", samples, 1, MOST_SAMPLES)
    _require_whole("the seed", seed, 0)
    require_positive("the budget", budget, "s")
    require_callable("progress", progress)
    q = random_configurations(robot, samples, np.random.default_rng(seed))
    drake = cache(lambda: DrakeWitness(robot))
    spending = TimeBudget(budget)
    found, missing = _compute(_testimonies(robot, drake), q, spending, progress)
    size = greatest_reach(robot)
    closed, also_missing = _closed(robot, drake, q, spending, progress) if robot.loops else ((), ())
    driven, undriven = _driven(robot, drake, q, spending, progress)
    posed = [
        comparison
        for quantity, values in found.items()
        for comparison in _compare_all(
            quantity,
            values,
            q,
            _pose_scale(size) if quantity.startswith(FOOT) else _twist_scale(robot.moving, size),
        )
    ]
    return Proof(
        robot=robot.name,
        samples=samples,
        seed=seed,
        size=size,
        comparisons=(*posed, *closed, *driven),
        missing=(*missing, *also_missing, *undriven),
    )


def _require_whole(what: str, value: object, least: int, most: float = math.inf) -> None:
    """Refuse what is not an integer between two bounds."""
    if (
        isinstance(value, bool)
        or not isinstance(value, Integral)
        or not least <= int(value) <= most
    ):
        span = f"{least} to {most}" if math.isfinite(most) else f"at least {least}"
        raise InvalidValueError(f"{what} is {shown(value)}; it must be a whole number, {span}")


def _closed(
    robot: Robot,
    drake: Callable[[], DrakeWitness],
    q: Array,
    budget: TimeBudget,
    progress: Report | None,
) -> tuple[list[Comparison], list[Missing]]:
    """Compare what the witnesses say of the loops, in closed postures near q (N, m)."""
    from drake_leg.kinematics.closed_loops import ClosedLoops
    from drake_leg.models.loop_proof import CLOSURE, closed_postures, loop_testimonies

    try:
        loops = ClosedLoops(robot)
        postures = closed_postures(loops, q)
    except InvalidValueError as error:
        return [], [Missing(quantity="closure", witness="loops", why=str(error))]
    testimonies = sorted(loop_testimonies(loops, drake), key=lambda one: ORDER.index(one.witness))
    found, missing = _compute(testimonies, postures, budget, progress)
    active = [robot.moving[column] for column in loops.active_columns]
    of_rates = _twist_scale(active, loops.size)
    compared = [
        comparison
        for quantity, values in found.items()
        for comparison in _compare_all(
            quantity,
            values,
            postures,
            _pose_scale(loops.size) if quantity.startswith(CLOSURE) else of_rates,
        )
    ]
    return compared, missing


def _driven(
    robot: Robot,
    drake: Callable[[], DrakeWitness],
    q: Array,
    budget: TimeBudget,
    progress: Report | None,
) -> tuple[list[Comparison], list[Missing]]:
    """Compare the torques of random motions through the postures q (N, m), if there is mass."""
    from drake_leg.models.dynamics_proof import dynamic_testimonies

    found, missing = _compute(list(dynamic_testimonies(robot, drake)), q, budget, progress)
    compared = [
        comparison
        for quantity, values in found.items()
        for comparison in _compare_all(quantity, values, q, _greatest(values))
    ]
    return compared, missing


def _greatest(values: dict[str, Array]) -> Array:
    """Greatest size among what all witnesses say; 1 if all is 0."""
    return np.array(max((float(np.abs(each).max()) for each in values.values()), default=0.0) or 1)


def _testimonies(robot: Robot, drake: Callable[[], DrakeWitness]) -> list[Testimony]:
    """List every witness's foot and Jacobian, the quickest first; of a tree, of all its leaves."""
    several = len(robot.leaves) > 1
    found = [
        testimony
        for leaf, row in robot.leaves.items()
        for testimony in _testimonies_on(robot, row, f" of {leaf}" if several else "", drake)
    ]
    return sorted(found, key=lambda one: ORDER.index(one.witness))


def _testimonies_on(
    robot: Robot, row: int, which: str, drake: Callable[[], DrakeWitness]
) -> Iterator[Testimony]:
    """Ask every witness about the frame of one row."""
    from drake_leg.symbolic.derivation import foot_function, jacobian_function

    rows = robot.rows[:row]
    moving, on_the_way = khalil.moving_rows(robot.rows), set(robot.path(row))
    before = [column for column, index in enumerate(moving) if index < row]
    leading = [column for column, index in enumerate(moving) if index + 1 in on_the_way]
    path = khalil.foot_rows(rows)

    def wide(columns: Sequence[int], J: Array) -> Array:
        return widened(J, columns, len(moving))

    foot, jacobian = FOOT + which, JACOBIAN + which
    chain = {
        foot: lambda q: khalil.foot_pose(rows, q[:, before]),
        jacobian: lambda q: wide(before, khalil.jacobian(rows, q[:, before])),
    }
    symbols = {
        foot: lambda q: one_by_one(foot_function(path), q[:, leading]),
        jacobian: lambda q: wide(leading, one_by_one(jacobian_function(path), q[:, leading])),
    }
    plant = {
        foot: lambda q: one_by_one(partial(drake().foot, row=row), q),
        jacobian: lambda q: one_by_one(partial(drake().jacobian, row=row), q),
    }
    differences = {
        jacobian: lambda q: wide(before, difference_jacobian(rows, q[:, before])),
    }
    witnesses = zip(ORDER[1:], (chain, differences, plant, symbols), strict=True)
    for witness, functions in witnesses:
        for quantity, function in functions.items():
            yield Testimony(quantity, witness, function)


def _compute(
    testimonies: Sequence[Testimony], q: Array, budget: TimeBudget, progress: Report | None
) -> tuple[dict[str, dict[str, Array]], list[Missing]]:
    """Ask the witnesses one after the other, as long as the budget lasts."""
    found: dict[str, dict[str, Array]] = {one.quantity: {} for one in testimonies}
    missing = []
    for quantity, witness, function in testimonies:
        if progress is not None:
            progress(f"{quantity} by {witness}")
        try:
            found[quantity][witness] = budget.spend(partial(function, q))
        except TimeBudgetError as error:
            missing.append(Missing(quantity=quantity, witness=witness, why=str(error)))
    return found, missing


def _pose_scale(size: float) -> Array:
    scale = np.ones((4, 4))
    scale[:3, 3] = size
    return scale


def _twist_scale(joints: Sequence[Segment], size: float) -> Array:
    """Scale angular rows and sliding joints' columns by 1, lengths by the robot's size."""
    scale = np.ones((6, len(joints)))
    turning = [segment.row.joint == "revolute" for segment in joints]
    scale[3:, turning] = size
    return scale


def _compare_all(
    quantity: str, values: dict[str, Array], q: Array, scale: Array
) -> Iterator[Comparison]:
    """Compare every witness with every other."""
    for first, second in combinations([name for name in WITNESSES if name in values], 2):
        a, b = values[first], values[second]
        differences = np.abs(a - b) / scale
        sample, row, column = map(int, np.unravel_index(differences.argmax(), differences.shape))
        yield Comparison(
            quantity=quantity,
            first=first,
            second=second,
            difference=float(differences[sample, row, column]),
            entry=(row + 1, column + 1),
            q=tuple(q[sample].tolist()),
            values=(float(a[sample, row, column]), float(b[sample, row, column])),
        )


def difference_jacobian(rows: Sequence[Row], q: Array) -> Array:
    """Jacobian from exact differences of the chain's foot, at joint positions (..., m) [rad or m].

    Jv_BF, (..., 6, m): rows 0-2 angular, rows 3-5 translational, in the base frame [rad, m per rad
    or m].
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
