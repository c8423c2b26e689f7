"""Three joints that carry a point or a plane to where it should be (Pieper's method).

What the first joint cannot change is known of the goal: for a point, its position along the first
axis and its distance from it (or, of a joint that slides, its position across the axis); for a
plane, its angle to the axis and its distance from a point of it. These are two equations in the
positions of the other two joints,

``d (h1 cos b - h2 sin b) = g1(c)`` and ``s (h1 sin b + h2 cos b) = g2(c)``,

with the distance d and the sine s of the angle between the first two axes. Where one of both is
zero an equation has one unknown; otherwise the squares leave a quartic in c.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.inverse.one_unknown import (
    SMALL,
    quadratic,
    roots,
    sine_and_cosine,
)
from drake_leg.kinematics.inverse.screws import (
    PARALLEL,
    Normal,
    Screw,
    angle_about,
    angle_between,
    carried,
    common_normal,
    motion,
    motions,
    moved,
    moved_point,
    perpendicular,
    turned,
    vector_product,
)
from drake_leg.kinematics.khalil import Array

SHARPENING = 3  # steps of Newton's method
SHARP = 1e-16  # relative to the size: an error that no step makes smaller
NOWHERE = 1e-12  # relative to the size: a lever about which a turn changes nothing
BLURRED = 1e-6  # likewise, of a lever that depends on a root, which may be a double one
GUESSES = tuple(
    k * math.pi / 4.0 for k in (0, 1, -1, 2, -2, 3, -3, 4)
)  # [rad], of a joint that may be anywhere


class Found(NamedTuple):
    """Positions of some joints [rad or m], and which of them could have any other."""

    q: tuple[float, ...]
    free: tuple[bool, ...]


class Plane(NamedTuple):
    """A plane, by its normal and one of its points."""

    n: Array  # (3,), unit vector
    p: Array  # (3,) [m]


class _Turn(NamedTuple):
    """The two equations of the module's text, where the middle joint turns."""

    z: Array  # axis of the middle joint
    n: Array  # along the common normal of the first two axes
    m: Array  # z x n
    d: float
    s: float
    y: Callable[[Array], Array]  # (k,) -> (k, 3), what the middle joint turns
    g1: Callable[[Array], Array]  # of y(c)
    g2: Callable[[Array], Array]
    scale: float  # of y


def carry_point(joints: Sequence[Screw], p: Array, goal: Array, size: float) -> Iterator[Found]:
    """Positions of three joints with ``M_a M_b M_c p = goal``; lengths of about ``size`` [m]."""
    for q, free in _point(joints, p, goal, size):
        for _ in range(SHARPENING):
            axes, M = _moved_axes(joints, q)
            there = moved_point(M, p)
            if np.linalg.norm(goal - there) < SHARP * size:
                break
            columns = [
                vector_product(axis.z, there - axis.o) / size if axis.turns else axis.z
                for axis in axes
            ]
            q = _stepped(joints, q, columns, (goal - there) / size, size)
        yield Found(q, free)


def carry_plane(joints: Sequence[Screw], plane: Plane, goal: Plane, size: float) -> Iterator[Found]:
    """Positions of three joints that carry a plane; at least two of them must turn."""
    turning = [joint for joint in joints if joint.turns]
    if len(turning) < 2:
        return
    find = _plane_turned if len(turning) == 3 else _plane_turned_and_slid
    for q, free in find(joints, plane, goal, size):
        for _ in range(SHARPENING):
            axes, M = _moved_axes(joints, q)
            n, there = M[:3, :3] @ plane.n, moved_point(M, plane.p)
            error = np.append(goal.n - n, goal.n @ (goal.p - there) / size)
            if np.linalg.norm(error) < SHARP:
                break
            columns = []
            for axis in axes:
                turn = vector_product(axis.z, n) if axis.turns else np.zeros(3)
                way = vector_product(axis.z, there - axis.o) / size if axis.turns else axis.z
                columns.append(np.append(turn, goal.n @ way))
            q = _stepped(joints, q, columns, error, size)
        yield Found(q, free)


def _moved_axes(joints: Sequence[Screw], q: Sequence[float]) -> tuple[list[Screw], Array]:
    """The joints' axes at their positions, and the motion of all of them."""
    axes, M = [], np.eye(4)
    for joint, position in zip(joints, q, strict=True):
        axes.append(moved(joint, M))
        M = M @ motion(joint, position)
    return axes, M


def _stepped(
    joints: Sequence[Screw], q: Sequence[float], columns: Sequence[Array], error: Array, size: float
) -> tuple[float, ...]:
    """The positions after a step of Newton's method; columns and error are in units of size."""
    step = np.linalg.lstsq(np.transpose(columns), error, rcond=PARALLEL)[0].tolist()
    return tuple(
        position + change * (1.0 if joint.turns else size)
        for joint, position, change in zip(joints, q, step, strict=True)
    )


def _point(joints: Sequence[Screw], p: Array, goal: Array, size: float) -> Iterator[Found]:
    """The positions but for the rounding of the roots."""
    a, b, c = joints
    pairs = _point_turned if b.turns else _point_slid
    for found in pairs(a, b, c, p, goal, size):
        (qb, qc), free = found
        there = moved_point(motions((b, c), (qb, qc)), p)
        if not a.turns:
            yield Found((float(a.z @ (goal - there)), qb, qc), (False, *free))
            continue
        lever = np.linalg.norm(vector_product(a.z, goal - a.o))
        if lever < NOWHERE * size:
            yield from (Found((guess, qb, qc), (True, *free)) for guess in GUESSES)
        else:
            yield Found((angle_about(a.z, there - a.o, goal - a.o), qb, qc), (False, *free))


def turn_vector(z1: Array, z2: Array, v: Array, goal: Array) -> Iterator[Found]:
    """Angles of two turns about z1 and z2 with ``R_1 R_2 v = goal``: a spherical triangle.

    Its sides are the angles between z1 and z2, z2 and v, and z1 and the goal. Half-angle formulas
    keep the digits where it is nearly flat.
    """
    first, second, third = angle_between(z1, z2), angle_between(z2, v), angle_between(z1, goal)
    half = 0.5 * (first + second + third)
    near = math.sin(half - first) * math.sin(half - second)
    far = math.sin(half) * math.sin(half - third)
    if min(near, far) < -SMALL or min(math.sin(first), math.sin(second)) < PARALLEL:
        return
    corner = 2.0 * math.atan2(math.sqrt(max(near, 0.0)), math.sqrt(max(far, 0.0)))
    at_zero = angle_about(z2, z1, v)
    anywhere = math.sin(third) < NOWHERE
    for angle in (corner, -corner):
        q2 = angle - at_zero
        u = turned(z2, np.array([q2]), v)[0]
        for q1 in GUESSES if anywhere else (angle_about(z1, u, goal),):
            yield Found((q1, q2), (anywhere, False))


def _point_turned(
    a: Screw, b: Screw, c: Screw, p: Array, goal: Array, size: float
) -> Iterator[Found]:
    normal = common_normal(a, b) if a.turns else _across(a, b)
    n, m, o = normal.n, vector_product(b.z, normal.n), normal.foot_b
    if a.turns:
        axis, d, from_a = a.z, normal.d / size, goal - normal.foot_a
        rest = float(from_a @ from_a) - normal.d**2

        def g1(y: Array) -> Array:
            known: Array = 0.5 * (rest - (y * y).sum(axis=-1)) / size
            return known
    else:
        axis, d, from_a = vector_product(a.z, n), 1.0, goal - o

        def g1(y: Array) -> Array:
            return np.full(len(y), n @ from_a)

    def g2(y: Array) -> Array:
        known: Array = axis @ from_a - (axis @ b.z) * (y @ b.z)
        return known

    def y(t: Array) -> Array:
        return carried(c, t, p) - o

    yield from _turned_pairs(_Turn(b.z, n, m, d, float(axis @ m), y, g1, g2, size), c, size)


def _across(a: Screw, b: Screw) -> Normal:
    """A direction at right angles to two axes, the first of which slides."""
    across = vector_product(a.z, b.z)
    sine = float(np.linalg.norm(across))
    n = perpendicular(a.z) if sine < PARALLEL else across / sine
    return Normal(n, 0.0, sine, float(a.z @ b.z), a.o, b.o)


def _point_slid(
    a: Screw, b: Screw, c: Screw, p: Array, goal: Array, size: float
) -> Iterator[Found]:
    """Pairs (b, c) where the middle joint slides."""
    cosine = float(a.z @ b.z)
    if not a.turns:
        n = vector_product(a.z, b.z)
        across = vector_product(a.z, n)
        if np.linalg.norm(n) < PARALLEL:
            return

        def function(t: Array) -> Array:
            known: Array = (carried(c, t, p) - goal) @ n
            return known

        def slides(y: Array) -> list[float]:
            return [float(across @ (goal - y)) / float(across @ b.z)]

        scale = size
    elif abs(cosine) > PARALLEL:

        def slide(y: Array) -> Array:
            known: Array = ((goal - y) @ a.z) / cosine
            return known

        def function(t: Array) -> Array:
            y = carried(c, t, p)
            there = y + slide(y)[..., np.newaxis] * b.z - a.o
            known: Array = (there * there).sum(axis=-1) - (goal - a.o) @ (goal - a.o)
            return known

        def slides(y: Array) -> list[float]:
            return [float(slide(y))]

        scale = size * size
    else:

        def function(t: Array) -> Array:
            known: Array = (carried(c, t, p) - goal) @ a.z
            return known

        def slides(y: Array) -> list[float]:
            way, far = y - a.o, goal - a.o
            return quadratic(1.0, float(way @ b.z), float(way @ way - far @ far))

        scale = size
    for qc, free in _candidates(function, c, scale, size):
        y = carried(c, np.array([qc]), p)[0]
        yield from (Found((qb, qc), (False, free)) for qb in slides(y))


def _plane_turned(
    joints: Sequence[Screw], plane: Plane, goal: Plane, size: float
) -> Iterator[Found]:
    a, b, c = joints
    normal = common_normal(a, b)
    n, m, o = normal.n, vector_product(b.z, normal.n), normal.foot_b
    distance = float(goal.n @ (goal.p - normal.foot_a))
    fixed = float(plane.n @ (plane.p - c.o))

    def y(t: Array) -> Array:
        return turned(c.z, t, plane.n)

    def g1(y: Array) -> Array:
        known: Array = (distance - fixed - y @ (c.o - o)) / size
        return known

    def g2(y: Array) -> Array:
        known: Array = a.z @ goal.n - (a.z @ b.z) * (y @ b.z)
        return known

    equations = _Turn(b.z, n, m, normal.d / size, float(a.z @ m), y, g1, g2, 1.0)
    anywhere = np.linalg.norm(vector_product(a.z, goal.n)) < NOWHERE
    for (qb, qc), free in _turned_pairs(equations, c, size):
        there = motions((b, c), (qb, qc))[:3, :3] @ plane.n
        for qa in GUESSES if anywhere else (angle_about(a.z, there, goal.n),):
            yield Found((qa, qb, qc), (bool(anywhere), *free))


def _plane_turned_and_slid(
    joints: Sequence[Screw], plane: Plane, goal: Plane, size: float
) -> Iterator[Found]:
    """Two joints turn the normal; the third moves the plane along it."""
    first, second = (index for index, joint in enumerate(joints) if joint.turns)
    third = 3 - first - second

    def offset(q: Sequence[float]) -> float:
        return float(goal.n @ (moved_point(motions(joints, q), plane.p) - goal.p))

    for (q1, q2), free in turn_vector(joints[first].z, joints[second].z, plane.n, goal.n):
        q, loose = [0.0] * 3, [False] * 3
        q[first], q[second] = q1, q2
        loose[first], loose[second] = free
        here = offset(q)
        q[third] = size
        slope = (offset(q) - here) / size
        loose[third] = abs(slope) < BLURRED
        slides = _lengths(size) if loose[third] else ()
        for slide in (*slides, -here / slope) if abs(slope) > NOWHERE else slides:
            q[third] = slide
            yield Found(tuple(q), tuple(loose))


def _lengths(size: float) -> tuple[float, ...]:
    """Positions of a joint that slides and may be anywhere [m]."""
    return tuple(guess * size / math.pi for guess in GUESSES)


def _turned_pairs(e: _Turn, c: Screw, size: float) -> Iterator[Found]:
    """Pairs (b, c) that solve both equations."""

    def squares(t: Array) -> Array:
        y = e.y(t)
        h = (y @ e.n) ** 2 + (y @ e.m) ** 2
        known: Array = (e.s * e.g1(y)) ** 2 + (e.d * e.g2(y)) ** 2 - (e.d * e.s) ** 2 * h
        return known

    forms: list[tuple[Callable[[Array], Array], float, bool, bool]] = []
    if abs(e.d) < SMALL:
        forms.append((lambda t: e.g1(e.y(t)), e.scale, False, True))
    if abs(e.s) < SMALL:
        forms.append((lambda t: e.g2(e.y(t)), e.scale, True, False))
    if min(abs(e.d), abs(e.s)) > PARALLEL:
        forms.append((squares, e.scale**2 * max(e.s**2, e.d**2), True, True))
    for function, scale, by_first, by_second in forms:
        for qc, free in _candidates(function, c, scale, size):
            for qb, loose in _middle(e, qc, by_first=by_first, by_second=by_second):
                yield Found((qb, qc), (loose, free))


def _middle(
    e: _Turn, qc: float, *, by_first: bool, by_second: bool
) -> Iterator[tuple[float, bool]]:
    """Positions of the middle joint, and whether it could have any."""
    y = e.y(np.array([qc]))
    h1, h2 = float(y[0] @ e.n), float(y[0] @ e.m)
    lever = math.hypot(h1, h2)
    if lever < BLURRED * e.scale:
        yield from ((guess, True) for guess in GUESSES)
    if lever < NOWHERE * e.scale:
        return
    if by_first and by_second:
        first, second = float(e.g1(y)[0]) / e.d, float(e.g2(y)[0]) / e.s
        yield math.atan2(second * h1 - first * h2, first * h1 + second * h2), False
    elif by_second and abs(e.s) > PARALLEL:
        yield from ((q, False) for q in sine_and_cosine(h1, h2, float(e.g2(y)[0]) / e.s))
    elif by_first and abs(e.d) > PARALLEL:
        yield from ((q, False) for q in sine_and_cosine(-h2, h1, float(e.g1(y)[0]) / e.d))


def _candidates(
    function: Callable[[Array], Array], c: Screw, scale: float, size: float
) -> Iterator[tuple[float, bool]]:
    """Positions of the last joint, and whether it could have any."""
    found = roots(function, turns=c.turns, scale=scale, reach=size)
    if found is None:
        yield from ((guess, True) for guess in (GUESSES if c.turns else _lengths(size)))
    else:
        yield from ((q, False) for q in found)
