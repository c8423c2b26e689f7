"""Inertia matrix by composite bodies, and the direct dynamic model, as programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.dynamics import (
    Wrench,
    along_joint,
    at_antecedent,
    drive_torques,
    newton_euler,
)
from drake_leg.symbolic.loops import Closure, closure_of
from drake_leg.symbolic.mechanism import ORIGIN, Mechanism, Turn
from drake_leg.symbolic.programs import Output, Program, Steps
from drake_leg.symbolic.table import INERTIAL, LinkParameters, SymbolicTable

Namer = Callable[[sp.Expr], sp.Expr]
BASE_ROWS = 6  # of a floating base: angular, then linear


# --- bodies ----------------------------------------------------------------------------------


def turned(body: LinkParameters, turn: Turn, name: Namer) -> LinkParameters:
    """Inertial parameters of a body about the same point along axes turned back: ``R J R'``."""
    c, s = turn.cos, turn.sin
    cs, ss = name(c * s), name(s * s)
    double = name(1 - 2 * ss)  # cosine of twice the angle
    ms = turn.of(body.first_moments)
    if turn.axis == "z":
        first, second, mixed, one, two = "XX", "YY", "XY", "XZ", "YZ"
    else:
        first, second, mixed, one, two = "YY", "ZZ", "YZ", "XY", "XZ"
    value = {key: getattr(body, key) for key in INERTIAL}
    D = name(value[first] - value[second])
    e = name(ss * D + 2 * cs * value[mixed])
    value |= {
        first: value[first] - e,
        second: value[second] + e,
        mixed: cs * D + double * value[mixed],
        one: c * value[one] - s * value[two],
        two: s * value[one] + c * value[two],
        "MX": ms[0],
        "MY": ms[1],
        "MZ": ms[2],
    }
    return LinkParameters(**{key: name(entry) for key, entry in value.items()})


def shifted(body: LinkParameters, p: sp.Matrix, name: Namer) -> LinkParameters:
    """Inertial parameters of a body about a point from which the old one is at ``p``.

    ``J + 2 (p.h) 1 - p h' - h p'`` with ``h = ms + p M / 2``, and ``ms + p M``.
    """
    if p.is_zero_matrix:
        return body
    h = (body.first_moments + p * body.M / 2).applyfunc(name)
    xx, yy, zz = (name(p[k] * h[k]) for k in range(3))
    ms = body.first_moments + p * body.M
    value = {
        "XX": body.XX + 2 * (yy + zz),
        "YY": body.YY + 2 * (xx + zz),
        "ZZ": body.ZZ + 2 * (xx + yy),
        "XY": body.XY - p[0] * h[1] - p[1] * h[0],
        "XZ": body.XZ - p[0] * h[2] - p[2] * h[0],
        "YZ": body.YZ - p[1] * h[2] - p[2] * h[1],
        "MX": ms[0],
        "MY": ms[1],
        "MZ": ms[2],
        "M": body.M,
    }
    return LinkParameters(**{key: name(entry) for key, entry in value.items()})


def at_parent(
    body: LinkParameters, turns: Sequence[Turn], p: sp.Matrix, name: Namer
) -> LinkParameters:
    """Inertial parameters in the antecedent's frame of a body known in a row's frame."""
    for turn in reversed(turns):
        body = turned(body, turn, name)
    return shifted(body, p, name)


def together(first: LinkParameters, second: LinkParameters) -> LinkParameters:
    """Inertial parameters of two bodies as one, in one frame."""
    return LinkParameters(**{n: getattr(first, n) + getattr(second, n) for n in INERTIAL})


def _named(steps: Steps, number: int, body: LinkParameters) -> LinkParameters:
    return LinkParameters(**{n: steps.name(f"{n}C{number}", getattr(body, n)) for n in INERTIAL})


def composite_bodies(frames: Mechanism) -> list[LinkParameters]:
    """Inertial parameters of every link with all links behind it, the base's first."""
    table, steps = frames.table, frames.steps
    found = [table.base, *table.links]
    for number in range(len(table.rows), 0, -1):
        found[number] = _named(steps, number, found[number])
        i = table.rows[number - 1].antecedent
        if i or table.floating:
            turns, p = frames.turns[number - 1], frames.positions[number - 1]
            found[i] = together(found[i], at_parent(found[number], turns, p, steps.again))
    found[0] = _named(steps, 0, found[0]) if table.floating else found[0]
    return found


# --- the matrix ------------------------------------------------------------------------------


def inertia_matrix(frames: Mechanism) -> sp.Matrix:
    """Derive the inertia matrix; a floating base's six rows come first.

    A joint that turns at 1 rad/s^2 needs the wrench ``f = a x ms``, ``m = J a`` of the bodies
    behind it, a sliding one ``f = M a``, ``m = ms x a``; its parts along the joints before are the
    column. Rotors' inertias are on the diagonal.
    """
    table, bodies = frames.table, composite_bodies(frames)
    first = BASE_ROWS if table.floating else 0
    place = {number: first + k for k, number in enumerate(table.moving)}
    A = sp.zeros(first + len(place))
    if table.floating:
        A[:first, :first] = _spatial(bodies[0])
    for number, column in place.items():
        wrench, here = _unit_wrench(frames, number, bodies[number]), number
        A[column, column] = along_joint(frames, number, wrench) + table.links[number - 1].IA
        while table.rows[here - 1].antecedent or (table.floating and here):
            wrench = at_antecedent(frames, here, wrench)
            wrench = Wrench(
                force=frames.steps.vector("", wrench.force),
                moment=frames.steps.vector("", wrench.moment),
            )
            here = table.rows[here - 1].antecedent
            if here in place:
                A[place[here], column] = along_joint(frames, here, wrench)
            if here == 0:
                A[:first, column] = sp.Matrix([*wrench.moment, *wrench.force])
                break
    return sp.Matrix(A.rows, A.cols, lambda i, j: A[min(i, j), max(i, j)])


def _unit_wrench(frames: Mechanism, number: int, body: LinkParameters) -> Wrench:
    """What a unit acceleration of a joint needs, of the bodies behind it."""
    if frames.table.rows[number - 1].joint == "revolute":
        force, moment = sp.Matrix([-body.MY, body.MX, 0]), body.inertia[:, 2]
    else:
        force, moment = sp.Matrix([0, 0, body.M]), sp.Matrix([body.MY, -body.MX, 0])
    return Wrench(force=force, moment=moment)


def _spatial(body: LinkParameters) -> sp.Matrix:
    """The matrix from angular and linear acceleration to moment and force, (6, 6)."""
    x, y, z = body.first_moments
    S = sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return sp.Matrix([[body.inertia, S], [-S, body.M * sp.eye(3)]])


def _symmetric_result(frames: Mechanism, A: sp.Matrix, name: str = "A") -> sp.Matrix:
    """Name the entries on and above the diagonal; those below are the same."""

    def entry(i: int, j: int) -> sp.Expr:
        value = A[i, j]
        return frames.steps.result(f"{name}{i + 1}_{j + 1}", value) if value.free_symbols else value

    above = {(i, j): entry(i, j) for i in range(A.rows) for j in range(i, A.cols)}
    return sp.Matrix(A.rows, A.cols, lambda i, j: above[min(i, j), max(i, j)])


def inertia(table: SymbolicTable) -> Program:
    """Inertia matrix ``A(q)``; a floating base's six rows come first, the angular ones first."""
    frames = Mechanism(table, "q")
    value = _symmetric_result(frames, inertia_matrix(frames))
    meaning = "inertia matrix, rotors' inertias included"
    outputs = [Output(name="A", value=value, meaning=meaning)]
    closure = closure_of(frames)
    if closure is not None:
        closed = _symmetric_result(frames, _projected(frames, closure, value), "A_motor")
        meaning = "inertia matrix of the actuated joints, where the loops are closed"
        outputs.append(Output(name="A_motor", value=closed, meaning=meaning))
    return frames.program("inertia", "inertia matrix", outputs)


def _projection(frames: Mechanism, closure: Closure) -> sp.Matrix:
    """Rates of the base and of all joints per rate of the base and of the actuated joints."""
    base = sp.eye(BASE_ROWS) if frames.table.floating else sp.zeros(0)
    return sp.diag(base, closure.W())


def _projected(frames: Mechanism, closure: Closure, A: sp.Matrix) -> sp.Matrix:
    """``W' A W``, of the actuated joints."""
    name = frames.steps.again
    W = _projection(frames, closure)
    half = (A * W).applyfunc(name)
    upper = {
        (i, j): name((W[:, i].T * half[:, j])[0]) for i in range(W.cols) for j in range(i, W.cols)
    }
    return sp.Matrix(W.cols, W.cols, lambda i, j: upper[min(i, j), max(i, j)])


# --- direct dynamics -------------------------------------------------------------------------


def direct_dynamics(table: SymbolicTable) -> Program:
    """Joint accelerations from torques: ``A qddot = tau - H``, by ``A = L' D L`` without fill-in.

    The factors of a tree's matrix have its zeros: Featherstone, chapter 6. Of a floating base, the
    accelerations of its frame are found too. Of closed loops, ``W' A W qddot_a = W' (tau - H)``,
    where H has the accelerations b of the passive joints, and ``qddot = W qddot_a + b``.
    """
    frames = Mechanism(table, "q", "qdot", "tau", "w0", "g0")
    w0 = frames.base_motion[0] if table.floating else ORIGIN
    closure = closure_of(frames)
    follow = frames.still
    if closure is not None:
        follow = closure.bias(frames.motion(frames.qdot, frames.still, w0=w0))
    motion = frames.motion(frames.qdot, follow, w0=w0, vd0=-frames.gravity)
    bias = newton_euler(frames, motion, exerted=True)
    friction = drive_torques(frames).subs(dict(zip(frames.qddot, follow, strict=True)))
    torques = sp.Matrix(frames.torques) - bias.joints - friction
    rest = sp.Matrix([*(-bias.base), *torques])
    A = inertia_matrix(frames)
    first = BASE_ROWS if table.floating else 0
    if closure is None:
        _require_inertia(table, A)
        x = _solution(A, rest, frames.steps)
    else:
        W = _projection(frames, closure)
        A = A.applyfunc(frames.steps.again)
        rest = (W.T * rest.applyfunc(frames.steps.again)).applyfunc(frames.steps.again)
        found = _solution(_projected(frames, closure, A), rest, frames.steps)
        x = list(W * sp.Matrix(found) + sp.Matrix([0] * first + list(follow)))
    joints = frames.steps.matrix("qddot", sp.Matrix(x[first:]))
    outputs = [Output(name="qddot", value=joints, meaning="joint accelerations [rad/s^2 or m/s^2]")]
    if table.floating:
        value = frames.steps.matrix("base", sp.Matrix(x[:first]))
        meaning = "acceleration of the base, angular and of its origin, in frame 0"
        outputs.append(Output(name="base", value=value, meaning=meaning))
    closed = closure is not None
    return frames.program("direct_dynamics", "direct dynamic model", outputs, closed=closed)


def _require_inertia(table: SymbolicTable, A: sp.Matrix) -> None:
    """Refuse a joint that moves nothing, whose acceleration no torque determines."""
    first = A.rows - len(table.moving)
    for index, number in enumerate(table.moving):
        if A[first + index, first + index] == 0:
            raise InvalidValueError(
                f"the joint of row {number} of {table.name} moves no mass, so that its "
                "acceleration is not determined",
                advice="give its link or one behind it a mass, or the joint a rotor's inertia",
            )


def _solution(A: sp.Matrix, right: sp.Matrix, steps: Steps) -> list[sp.Expr]:
    """Solve ``A x = right`` for a symmetric A, eliminating from the last row to the first."""
    size, A = A.rows, sp.MutableDenseMatrix(A)
    inverse: list[sp.Expr] = [sp.Integer(0)] * size
    y = [steps.again(entry) for entry in right]
    for k in range(size - 1, -1, -1):
        inverse[k] = steps.again(1 / steps.again(A[k, k]))
        for i in range(k - 1, -1, -1):
            if A[k, i] == 0:
                continue
            factor = steps.again(A[k, i] * inverse[k])
            for j in range(i, -1, -1):
                if A[k, j] != 0:
                    A[i, j] = steps.again(A[i, j] - factor * A[k, j])
            y[i] = steps.again(y[i] - factor * y[k])
            A[k, i] = factor
    x: list[sp.Expr] = []
    for i in range(size):
        below = sum((A[i, j] * x[j] for j in range(i)), sp.Integer(0))
        x.append(steps.again(y[i] * inverse[i] - below))
    return x
