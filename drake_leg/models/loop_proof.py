"""Proves closed loops: in closed postures, what the loops' equations say of each cut is so.

The pose of a cut's one side in the other must be the cut joint's motion alone, and so must the
twist for the rates that the active joints cause. Chain, SymPy and Drake compute both from the two
frames, without any equation of the loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cache, partial

import numpy as np

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.closed_loops import CLOSED, ClosedLoops
from drake_leg.kinematics.khalil import Array
from drake_leg.models.witnesses import DrakeWitness, Testimony, one_by_one, widened
from drake_leg.robot.robot import Robot
from drake_leg.robot.tree import Loop

LOOPS = "loops"  # the witness
CLOSURE, RATES = "closure at", "rates at"


def closed_postures(loops: ClosedLoops, q: Array) -> Array:
    """Close the loops from postures (N, n); those in which they do not close are left out."""
    found, error = loops.closest(q, range(q.shape[-1]))
    regular = []
    for posture in found[error <= CLOSED]:
        try:
            loops.W(posture)
        except SingularConfigurationError:
            continue
        regular.append(posture)
    if not regular:
        raise InvalidValueError(
            f"the loops of {loops.robot.name!r} close in none of {len(q)} random postures",
            advice="check the lengths of its links and the two frames of every cut",
        )
    return np.array(regular)


def loop_testimonies(loops: ClosedLoops, drake: Callable[[], DrakeWitness]) -> Iterator[Testimony]:
    """Ask every witness about pose and twist of each cut, in closed postures (N, n)."""
    for index, loop in enumerate(loops.robot.loops):
        closure, rates = f"{CLOSURE} {loop.joint}", f"{RATES} {loop.joint}"
        yield Testimony(closure, LOOPS, partial(one_by_one, partial(_motion, loops, index)))
        yield Testimony(rates, LOOPS, partial(one_by_one, partial(_rate, loops, index)))
        for witness, sides in (
            ("chain", partial(_by_chain, loops.robot, loop)),
            ("Drake", partial(_by_drake, drake, loop)),
            ("SymPy", _by_symbols(loops.robot, loop)),
        ):
            yield Testimony(closure, witness, partial(one_by_one, partial(_pose, sides)))
            yield Testimony(rates, witness, partial(one_by_one, partial(_twists, loops, sides)))


Side = tuple[Array, Array]  # pose (4, 4) and Jacobian (6, n) of a frame, in the base


def _motion(loops: ClosedLoops, index: int, q: Array) -> Array:
    """Pose (4, 4) that the motion of a cut joint makes."""
    position = float(loops.cut_motion(q).position[index])
    X = np.eye(4)
    if _turns(loops, index):
        c, s = math.cos(position), math.sin(position)
        X[:2, :2] = [[c, -s], [s, c]]
    else:
        X[2, 3] = position
    return X


def _rate(loops: ClosedLoops, index: int, q: Array) -> Array:
    """Twist (6, a) that the motion of a cut joint makes, as each active joint moves."""
    twist = np.zeros((6, len(loops.active)))
    for column, qdot in enumerate(_rates(loops, q).T):
        rate = loops.cut_motion(q, qdot).velocity[index]
        twist[2 if _turns(loops, index) else 5, column] = rate
    return twist


def _rates(loops: ClosedLoops, q: Array) -> Array:
    """Rates (n, a) of all joints as each active joint moves, none of them faster than 1."""
    W = loops.W(q)
    slowed: Array = W / np.maximum(1.0, np.abs(W).max(axis=0))
    return slowed


def _turns(loops: ClosedLoops, index: int) -> bool:
    cut = loops.robot.loops[index].cut
    return loops.robot.segments[cut - 1].row.joint == "revolute"


def _by_chain(robot: Robot, loop: Loop, q: Array) -> tuple[Side, Side]:
    first, second = (_of_row(robot, row, q) for row in (loop.cut, loop.end))
    return first, second


def _of_row(robot: Robot, row: int, q: Array) -> Side:
    rows = robot.rows[:row]
    own = q[: len(khalil.moving_rows(rows))]
    X, J = khalil.foot_pose_and_jacobian(rows, own)
    return X, widened(J, range(len(own)), len(q))


def _by_drake(drake: Callable[[], DrakeWitness], loop: Loop, q: Array) -> tuple[Side, Side]:
    plant = drake()
    # The frames of the table are counted from 0, the base.
    first, second = (
        (plant.pose(q, 0, row), plant.jacobian(q, row)) for row in (loop.cut, loop.end)
    )
    return first, second


def _by_symbols(robot: Robot, loop: Loop) -> Callable[[Array], tuple[Side, Side]]:
    moving = khalil.moving_rows(robot.rows)

    @cache
    def functions(row: int) -> tuple[list[int], Callable[[Array], Array], Callable[[Array], Array]]:
        from drake_leg.symbolic.derivation import foot_function, jacobian_function

        on_the_way = set(robot.path(row))
        columns = [column for column, index in enumerate(moving) if index + 1 in on_the_way]
        path = khalil.foot_rows(robot.rows[:row])
        if not columns:
            X = khalil.foot_pose(path, [])
            return columns, lambda _: X, lambda _: np.zeros((6, 0))
        return columns, foot_function(path), jacobian_function(path)

    def sides(q: Array) -> tuple[Side, Side]:
        found = []
        for row in (loop.cut, loop.end):
            columns, foot, jacobian = functions(row)
            found.append((foot(q[columns]), widened(jacobian(q[columns]), columns, len(q))))
        return found[0], found[1]

    return sides


def _pose(sides: Callable[[Array], tuple[Side, Side]], q: Array) -> Array:
    """Pose (4, 4) of a cut's end in its cut frame."""
    (X_BK, _), (X_BE, _) = sides(q)
    X: Array = np.linalg.inv(X_BK) @ X_BE
    return X


def _twists(loops: ClosedLoops, sides: Callable[[Array], tuple[Side, Side]], q: Array) -> Array:
    """Twist (6, a) of a cut's end in its cut frame, as each active joint moves."""
    (X_BK, J_K), (X_BE, J_E) = sides(q)
    R, p = X_BK[:3, :3], X_BE[:3, 3] - X_BK[:3, 3]
    spin = J_E[:3] - J_K[:3]
    moved = J_E[3:] - J_K[3:] - np.cross(J_K[:3].T, p).T
    twists: Array = np.vstack([R.T @ spin, R.T @ moved]) @ _rates(loops, q)
    return twists
