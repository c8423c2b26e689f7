"""Inverse geometric model: all postures whose foot is in a pose, or at a point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import joints_in_words
from drake_leg.kinematics.inverse.closed_form import ClosedForm, closed_forms, in_words
from drake_leg.kinematics.inverse.search import REACHED, STARTS, Search, scattered
from drake_leg.kinematics.inverse.three_joints import Found
from drake_leg.kinematics.khalil import Array, finite_vectors, real_numbers, table_length
from drake_leg.robot.robot import Robot, html_table, require_robot

CLOSES = 1e-12  # of the chain's length: how well a posture must reach the goal
NOT_A_ROTATION = 1e-3  # how far R R^T of a pose may be from the identity
MOST_ROUNDS, IDLE_ROUNDS = 20, 2  # of a numerical search: in all, and without anything new
MOST_OF_SIX = 16  # postures of six joints for one pose, if there are finitely many
TAKES_PART = 1e-6  # of the greatest rate: a joint that moves with others


@dataclass(frozen=True, kw_only=True)
class InverseGeometry:
    """All postures of a robot for one pose, or for one point, of its foot."""

    robot: Robot
    goal: Array  # X_BF (4, 4), or p_BF (3,) [m]
    solutions: Array  # (k, n) [rad or m], those within the joints' limits first
    residuals: Array  # (k,), distance from the goal over the chain's length
    within_limits: tuple[bool, ...]  # (k,)
    notes: tuple[str, ...]  # (k,): what is singular in a posture, or empty
    method: str
    complete: bool  # whether there is no other posture
    infinitely_many: bool  # whether joints can move while the foot stays
    nearest: tuple[float, float] | None  # [m, rad], by how much the nearest one found misses it
    units: tuple[str, ...] = field(init=False)  # of each joint's position in texts: deg or m

    def __post_init__(self) -> None:
        units = ("deg" if s.row.joint == "revolute" else "m" for s in self.robot.moving)
        object.__setattr__(self, "units", tuple(units))

    @property
    def heading(self) -> str:
        """How many postures there are, whether these are all, and by which method."""
        count = len(self.solutions)
        if not count:
            found = f"out of reach{self._by_how_much()}"
        elif self.infinitely_many:
            found = f"{count} of infinitely many postures"
        elif self.complete:
            found = {1: "the only posture", 2: "both postures"}.get(count, f"all {count} postures")
        else:
            found = f"{count} posture{'s' * (count > 1)} found; there may be more"
        return f"{found} ({self.method})"

    def _by_how_much(self) -> str:
        if self.nearest is None:
            return ""
        distance, angle = self.nearest
        least = REACHED * table_length(self.robot.rows)
        parts = [f"{distance:.4g} m"] * (distance > least or angle <= REACHED)
        parts += [f"{math.degrees(angle):.4g} deg"] * (angle > REACHED)
        return f", by {' and '.join(parts)} from the nearest posture that was found"

    def as_json(self) -> dict[str, Any]:
        """The same under the command line's keys, joints that turn in degrees."""
        return {
            "robot": self.robot.name,
            "method": self.method,
            "complete": self.complete,
            "infinitely_many": self.infinitely_many,
            "nearest_m": self.nearest and self.nearest[0],
            "nearest_deg": self.nearest and math.degrees(self.nearest[1]),
            "joints": [segment.joint for segment in self.robot.moving],
            "units": list(self.units),
            "solutions": [
                {"q": q, "residual": residual, "within_limits": inside, "note": note}
                for q, residual, inside, note in zip(
                    self._typed(),
                    self.residuals.tolist(),
                    self.within_limits,
                    self.notes,
                    strict=True,
                )
            ],
        }

    def _typed(self) -> list[list[float]]:
        turns = np.array([unit == "deg" for unit in self.units])
        degrees: list[list[float]] = np.where(
            turns, np.degrees(self.solutions), self.solutions
        ).tolist()
        return degrees

    def _table(self) -> tuple[list[str], list[list[str]]]:
        headings = [
            f"{segment.joint} [{unit}]"
            for segment, unit in zip(self.robot.moving, self.units, strict=True)
        ]
        rows = [
            [
                *(
                    f"{value:.4f}" if unit == "deg" else f"{value:.6f}"
                    for value, unit in zip(q, self.units, strict=True)
                ),
                f"{residual:.0e}",
                "; ".join(filter(None, ("" if inside else "outside the limits", note))),
            ]
            for q, residual, inside, note in zip(
                self._typed(), self.residuals.tolist(), self.within_limits, self.notes, strict=True
            )
        ]
        return [*headings, "residual", ""], rows

    def __repr__(self) -> str:
        if not len(self.solutions):
            return self.heading
        headings, rows = self._table()
        lines = [headings, *rows]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        table = (
            "  ".join(
                cell.ljust(width) if index == len(widths) - 1 else cell.rjust(width)
                for index, (cell, width) in enumerate(zip(line, widths, strict=True))
            ).rstrip()
            for line in lines
        )
        return "\n".join([self.heading, *table])

    def _repr_html_(self) -> str:
        headings, rows = self._table()
        return html_table(headings, rows, title=f"{self.robot.title}: {self.heading}")


def inverse_geometry(robot: Robot, goal: ArrayLike, *, tip: str | None = None) -> InverseGeometry:
    """Find all postures whose foot is in a pose, or at a point.

    Three axes that intersect or are parallel, or three joints that slide, give a robot of six
    joints a closed form (Pieper); most robots of fewer joints have one, too (Paul). Then the
    solutions are all there are. Other robots are solved numerically, from random postures, until
    the search finds nothing new; the result says so. ``foot_pose(rows, q)`` is the goal to 1e-12
    of the chain's length for every solution. Postures that differ by less than 1e-4 rad count as
    one, as where an arm is stretched.

    Parameters
    ----------
    robot : Robot
        A serial chain, or a tree.
    goal : (4, 4) or (3,) array
        Pose X_BF of the foot in the base frame, or, for at most three joints, its position p_BF
        [m]. A rotation that is a little off by rounding is replaced by the nearest one.
    tip : str, optional
        Which of a tree's feet is meant; the solutions are of the joints that lead to it.

    Returns
    -------
    InverseGeometry
        ``solutions`` (k, n) [rad or m], ``residuals``, ``method``, ``complete``; a notebook shows
        them as a table.

    Raises
    ------
    InvalidValueError
        If the goal is neither a pose nor a point, or a point of a robot that can reach it in
        infinitely many ways.

    Examples
    --------
    >>> import numpy as np
    >>> from drake_leg import LEG_B, inverse_geometry
    >>> found = inverse_geometry(LEG_B, [0.1, 0.05, -0.1])
    >>> found.complete, found.solutions.shape
    (True, (4, 3))
    >>> print(found.method)
    Paul's method: three equations of the foot's position
    """
    require_robot(robot)
    robot = robot.at_tip(tip)
    array = real_numbers("the goal", goal)
    if array.shape == (3,):
        goal, pose = finite_vectors("the goal", array, 3), np.eye(4)
        pose[:3, 3] = goal
        return _solved(robot, goal, pose, has_pose=False)
    if array.shape != (4, 4):
        raise InvalidValueError(
            f"the goal has shape {array.shape}; it must be a pose (4, 4), or a point (3,)"
        )
    pose = _pose(finite_vectors("the goal", array, 4))
    return _solved(robot, pose, pose, has_pose=True)


def _pose(matrix: Array) -> Array:
    """The rigid motion that a matrix is to rounding."""
    R = matrix[:3, :3]
    off = float(np.abs(R @ R.T - np.eye(3)).max())
    if not off < NOT_A_ROTATION or np.linalg.det(R) < 0.0 or (matrix[3] != [0, 0, 0, 1]).any():
        raise InvalidValueError(
            f"the goal is no pose: its first three rows and columns must be a rotation R (R R^T is "
            f"off by {off:.3g}), its last row 0, 0, 0, 1"
        )
    U, _, Vt = np.linalg.svd(R)
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = U @ Vt, matrix[:3, 3]
    return X


def _solved(robot: Robot, goal: Array, pose: Array, *, has_pose: bool) -> InverseGeometry:
    rows = tuple(robot.rows)
    if not has_pose and len(robot.moving) > 3:
        raise InvalidValueError(
            f"the goal is a point, which the foot of {robot.name!r} can reach in infinitely many "
            f"orientations, with {joints_in_words(robot)}",
            advice="give a pose (4, 4)",
        )
    limits = [segment.mechanics.bounds for segment in robot.moving]
    search = Search(rows, pose, turning=has_pose, limits=limits)
    forms = closed_forms(rows, pose=has_pose)
    if not forms:
        return _searched(robot, goal, pose, search, has_pose=has_pose)
    return _closed(robot, goal, pose, search, forms)


def _closed(
    robot: Robot,
    goal: Array,
    pose: Array,
    search: Search,
    forms: Sequence[ClosedForm],
) -> InverseGeometry:
    candidates: list[Found] = []
    degenerate = False
    for form in forms:
        found, loose = form.solve(pose)
        candidates += found
        degenerate = degenerate or loose
        q, closes = _finished(search, candidates, len(robot.moving))
        if form.is_whole and not loose and closes.any():
            break
    method = forms[0].method
    nearest: tuple[float, float] | None = None
    many = any(search.moves_freely(one) for one in q[closes])
    numerical = not many and (degenerate or not closes.any())
    if numerical:
        ends, miss = search.run(inside=False)
        nearest = search.gap(ends[miss.argmin()])
        candidates += [Found(tuple(each), (False,) * len(each)) for each in ends.tolist()]
        q, closes = _finished(search, candidates, len(robot.moving))
        degenerate = degenerate or bool(closes.any())
        many = any(search.moves_freely(one) for one in q[closes])
        if degenerate:
            method += f"; it is degenerate here: Newton's method from {STARTS} random postures, too"
    reached = np.flatnonzero(closes).tolist()
    if many:
        reached = _one_of_each_family(search, candidates, q, closes)
    solutions, _ = search.different(q[reached], search.miss(q[reached]))
    if many and numerical:
        solutions = scattered(solutions)
    return _result(
        robot,
        goal,
        search,
        solutions,
        method=method,
        complete=not (many or degenerate),
        infinitely_many=many,
        nearest=None if len(solutions) else nearest,
    )


def _finished(
    search: Search, candidates: Sequence[Found], joints: int
) -> tuple[Array, NDArray[np.bool_]]:
    """The candidates by Newton's method, and which of them reach the goal."""
    q = search.polished(np.array([each.q for each in candidates]).reshape(-1, joints))
    return q, search.miss(q) <= CLOSES * search.size


def _one_of_each_family(
    search: Search, candidates: Sequence[Found], q: Array, closes: NDArray[np.bool_]
) -> list[int]:
    """Indices of the candidates that close; where a joint is free, those of one position of it.

    That is, if possible, one in which all joints are within their limits.
    """
    placed = search.turned(q)
    reached = np.flatnonzero(closes).tolist()
    first: dict[tuple[bool, ...], float] = {}
    chosen = []
    for index in sorted(reached, key=lambda index: not search.within_limits(placed[index])):
        position, free = candidates[index]
        if any(free) and search.moves_freely(q[index]):
            own = position[free.index(True)]
            if own != first.setdefault(free, own):
                continue
        chosen.append(index)
    return chosen


def _searched(
    robot: Robot, goal: Array, pose: Array, search: Search, *, has_pose: bool
) -> InverseGeometry:
    """Solve numerically: rounds of random starts, until some in a row find nothing new."""
    redundant = len(robot.moving) > (6 if has_pose else 3)
    q, idle, rounds = np.empty((0, len(robot.moving))), 0, 0
    best, nearest = math.inf, (math.inf, math.inf)
    many = redundant
    while rounds < MOST_ROUNDS and idle < IDLE_ROUNDS and len(q) < MOST_OF_SIX:
        found, miss = search.run(inside=False, seed=rounds)
        rounds += 1
        if miss.min() < best:
            best, nearest = float(miss.min()), search.gap(found[miss.argmin()])
        more = found[miss <= CLOSES * search.size]
        if redundant:
            q = scattered(more)
            break
        everything = np.concatenate([q, more])
        kept, _ = search.different(everything, search.miss(everything))
        many = many or any(search.moves_freely(one) for one in kept)
        if many:
            q = scattered(kept)
            break
        idle = idle + 1 if len(kept) == len(q) else 0
        q = kept
    bound = f"; a pose has at most {MOST_OF_SIX} postures, or infinitely many"
    bound *= has_pose and not redundant
    why = "more joints than the foot has freedoms" if redundant else "no closed form is known"
    return _result(
        robot,
        goal,
        search,
        q,
        method=f"{why}; Newton's method from {rounds * STARTS} random postures{bound}",
        complete=not many and len(q) == MOST_OF_SIX,
        infinitely_many=many and len(q) > 0,
        nearest=None if len(q) else nearest,
    )


def _result(
    robot: Robot,
    goal: Array,
    search: Search,
    q: Array,
    *,
    method: str,
    complete: bool,
    infinitely_many: bool,
    nearest: tuple[float, float] | None,
) -> InverseGeometry:
    return InverseGeometry(
        robot=robot,
        goal=goal,
        solutions=q,
        residuals=search.miss(q) / search.size,
        within_limits=tuple(search.within_limits(one) for one in q),
        notes=tuple(_note(robot, search, one) for one in q),
        method=method,
        complete=complete,
        infinitely_many=infinitely_many,
        nearest=nearest,
    )


def _note(robot: Robot, search: Search, q: Array) -> str:
    """Say what is singular in a posture."""
    rates = search.null_motion(q)
    if rates is None:
        return ""
    if not search.moves_freely(q):
        return "singular: postures meet here"
    names = [
        str(segment.joint)
        for segment, rate in zip(robot.moving, rates.tolist(), strict=True)
        if abs(rate) > TAKES_PART
    ]
    return f"{in_words(names)} can move while the foot stays"
