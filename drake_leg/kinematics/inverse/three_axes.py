"""Three joints whose motions are a group of their own: about a point, or in a plane.

Three axes that meet in a point make every rotation about it; three joints of which the axes that
turn are parallel, and those that slide are at right angles to them, make every motion in a plane.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from drake_leg.kinematics.inverse.one_unknown import SMALL, quadratic
from drake_leg.kinematics.inverse.screws import (
    PARALLEL,
    Screw,
    angle_about,
    common_normal,
    inverse,
    moved_point,
    perpendicular,
    rotation,
    vector_product,
)
from drake_leg.kinematics.inverse.three_joints import NOWHERE, Found, turn_vector
from drake_leg.kinematics.khalil import Array


def common_point(screws: Sequence[Screw], size: float) -> Array | None:
    """The point in which the axes of joints that turn meet, (3,) [m]; None if there is none."""
    if not all(screw.turns for screw in screws):
        return None
    if len(screws) == 1:
        return screws[0].o
    for first, second in pairwise(screws):
        normal = common_normal(first, second)
        if normal.sine < PARALLEL or abs(normal.d) > PARALLEL * size:
            return None
    point = normal.foot_a
    for screw in screws:
        if np.linalg.norm(vector_product(screw.z, point - screw.o)) > PARALLEL * size:
            return None
    return point


def common_plane(screws: Sequence[Screw]) -> Array | None:
    """The normal of the plane in which all of these joints move, (3,); None if there is none."""
    turning = [screw.z for screw in screws if screw.turns]
    if turning:
        normal = turning[0]
    elif len(screws) > 1:
        normal = vector_product(screws[0].z, screws[1].z)
        if np.linalg.norm(normal) < PARALLEL:
            return None
        normal = normal / np.linalg.norm(normal)
    else:
        return None
    for screw in screws:
        along = abs(float(normal @ screw.z))
        off = np.linalg.norm(vector_product(normal, screw.z)) if screw.turns else along
        if off > PARALLEL:
            return None
    return normal


def turn_about_point(joints: Sequence[Screw], R: Array) -> Iterator[Found]:
    """Angles of three turns whose rotation is R."""
    d, e, f = (joint.z for joint in joints)
    across = perpendicular(f)
    for (q1, q2), (free, _) in turn_vector(d, e, f, R @ f):
        left = rotation(e, -q2) @ rotation(d, -q1) @ R
        q3 = angle_about(f, across, left @ across)
        yield Found((q1, q2, q3), (free, False, free))


def move_in_plane(joints: Sequence[Screw], normal: Array, X: Array, size: float) -> Iterator[Found]:
    """Positions of three joints in a plane whose motion is X; points of it are complex numbers."""
    turns = [joint.turns for joint in joints]
    if turns == [False, True, True]:
        for q, free in move_in_plane(joints[::-1], normal, inverse(X), size):
            yield Found((-q[2], -q[1], -q[0]), free[::-1])
        return
    x = perpendicular(normal)
    y = vector_product(normal, x)

    def flat(v: Array) -> complex:
        return complex(float(v @ x), float(v @ y))

    def goal(point: complex) -> complex:
        return flat(moved_point(X, point.real * x + point.imag * y))

    angle = math.atan2(float(y @ X[:3, :3] @ x), float(x @ X[:3, :3] @ x))
    places = [flat(joint.o if joint.turns else joint.z) for joint in joints]
    if sum(turns) == 1:
        found = _one_turn(turns, places, goal(0j), angle)
    elif turns == [True, True, True]:
        found = _three_turns(places, goal(places[2]), angle, size)
    elif turns == [True, True, False]:
        found = _slide_last(places, goal(places[1]), angle, size)
    elif turns == [True, False, True]:
        found = _slide_between(places, goal(places[2]), angle, size)
    else:
        return
    signs = [math.copysign(1.0, float(j.z @ normal)) if j.turns else 1.0 for j in joints]
    for q, free in found:
        yield Found((signs[0] * q[0], signs[1] * q[1], signs[2] * q[2]), free)


def _three_turns(
    places: Sequence[complex], goal: complex, angle: float, size: float
) -> Iterator[Found]:
    """Two links and a hand: the triangle of the links and the distance of the third axis."""
    upper, fore, way = places[1] - places[0], places[2] - places[1], goal - places[0]
    a, b, c = abs(upper), abs(fore), abs(way)
    outer, inner = (a + b - c) * (a + b + c), (c - abs(a - b)) * (c + abs(a - b))
    if min(outer, inner) < -SMALL * size * size or min(a, b) < PARALLEL * size:
        return
    bend = 2.0 * math.atan2(math.sqrt(max(outer, 0.0)), math.sqrt(max(inner, 0.0)))
    at_zero = cmath.phase(fore / upper)
    for elbow in (bend, -bend):
        second = elbow - at_zero
        first, free = _turn(upper + fore * cmath.exp(1j * second), way, size)
        yield Found((first, second, angle - first - second), (free, False, free))


def _slide_last(
    places: Sequence[complex], goal: complex, angle: float, size: float
) -> Iterator[Found]:
    link, way, along = places[1] - places[0], goal - places[0], places[2] * cmath.exp(1j * angle)
    reach = abs(way) ** 2 - abs(link) ** 2
    for slide in quadratic(1.0, -(along.conjugate() * way).real, reach):
        first, free = _turn(link, way - slide * along, size)
        yield Found((first, angle - first, slide), (free, free, False))


def _slide_between(
    places: Sequence[complex], goal: complex, angle: float, size: float
) -> Iterator[Found]:
    link, way, along = places[2] - places[0], goal - places[0], places[1]
    reach = abs(link) ** 2 - abs(way) ** 2
    for slide in quadratic(1.0, (along.conjugate() * link).real, reach):
        first, free = _turn(link + slide * along, way, size)
        yield Found((first, slide, angle - first), (free, False, free))


def _one_turn(
    turns: Sequence[bool], places: Sequence[complex], origin: complex, angle: float
) -> Iterator[Found]:
    """Two joints that slide: two linear equations."""
    at, spin = turns.index(True), cmath.exp(1j * angle)
    first, second = (
        place * (spin if index > at else 1.0) for index, place in enumerate(places) if index != at
    )
    way = origin - places[at] * (1.0 - spin)
    determinant = (first.conjugate() * second).imag
    if abs(determinant) < PARALLEL:
        return
    slides = [
        (way.conjugate() * second).imag / determinant,
        (first.conjugate() * way).imag / determinant,
    ]
    slides.insert(at, angle)
    yield Found((slides[0], slides[1], slides[2]), (False, False, False))


def _turn(start: complex, end: complex, size: float) -> tuple[float, bool]:
    """Angle from one direction to another, and whether there is none, for lack of a lever."""
    if abs(end) < NOWHERE * size or start == 0.0:
        return 0.0, True
    return cmath.phase(end / start), False
