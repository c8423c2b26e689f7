"""Which closed form the inverse geometry of a chain has, and its solutions.

The joints' motions are ``M_1 ... M_n = G``, with the foot's pose in G. Three joints that follow
each other and whose motions are a group, about a point or in a plane, leave that point or plane
where it is: what remains is an equation in the other three joints alone, which carry a point or a
plane (``three_joints``). The group's own joints follow (``three_axes``). A chain of fewer than six
joints is completed by joints that its solutions leave at zero. A form is used only if it finds
random postures of the chain again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice, product
from typing import Literal, NamedTuple

import numpy as np

from drake_leg.kinematics.inverse.screws import (
    PARALLEL,
    Screw,
    are_parallel,
    inverse,
    motions,
    moved,
    moved_point,
    perpendicular,
    screws_of,
    turned,
    vector_product,
)
from drake_leg.kinematics.inverse.three_axes import (
    common_plane,
    common_point,
    move_in_plane,
    turn_about_point,
)
from drake_leg.kinematics.inverse.three_joints import (
    Found,
    Plane,
    carry_plane,
    carry_point,
)
from drake_leg.kinematics.khalil import (
    Array,
    foot_pose,
    moving_rows,
    principal,
    table_length,
)
from drake_leg.robot.robot import Row

Group = Literal["point", "plane", "slides", "foot"]

TRIALS = 3  # random postures in which a closed form must hold
MOST_FORMS = 4  # of one chain
AGAIN = 1e-6  # [rad, or of the size]: how well it must find them
# A direction that no axis of a robot is likely to be parallel or perpendicular to.
ODD = np.array([0.48, 0.64, 0.6])


class Joint(NamedTuple):
    """A joint of the chain, or one that completes it."""

    number: int | None  # in the chain, from 0; None if it is not one of the chain's
    screw: Screw


class ClosedForm(NamedTuple):
    """The six joints in the order of their motions, and the three that are a group."""

    group: Group
    joints: tuple[Joint, ...]
    at: int  # of the first of the three
    center: Array  # (3,), the point or the normal of the plane
    foot: Array  # (4, 4), X_BF(0)
    size: float  # [m]

    @property
    def grouped(self) -> tuple[Joint, ...]:
        """The three joints of the group."""
        return self.joints[self.at : self.at + 3]

    @property
    def method(self) -> str:
        """The name of the method, and of the property of the chain that it rests on."""
        by = "Pieper's" if all(joint.number is not None for joint in self.joints) else "Paul's"
        return f"{by} method: {self._property()}"

    def _property(self) -> str:
        own = [j for j in self.grouped if j.number is not None]
        if self.group == "slides":
            own = [j for j in self.joints if j.number is not None and not j.screw.turns]
        names = in_words(sorted(j.number + 1 for j in own if j.number is not None))
        if self.group == "foot":
            return "three equations of the foot's position"
        if self.group == "slides":
            return f"the rotation first, then what joint{'s' * (len(own) > 1)} {names} slide"
        if len(own) == 1:
            return f"three equations of the position of a point on axis {names}"
        if self.group == "point":
            return f"axes {names} intersect"
        if all(joint.screw.turns for joint in own):
            return f"axes {names} are parallel"
        return f"joints {names} move in a plane"

    @property
    def is_whole(self) -> bool:
        """Whether all joints are the chain's own, but for those that turn a foot."""
        joints = self.joints[:3] if self.group == "foot" else self.joints
        return all(joint.number is not None for joint in joints)

    def solve(self, X_BF: Array) -> tuple[list[Found], bool]:
        """Candidates for the positions of the chain's joints, and whether any joint was free.

        A joint is free where an equation that should determine it holds for all of its positions.
        """
        far = float(np.linalg.norm(X_BF[:3, 3]))
        if far > self.size:
            return self._replace(size=far).solve(X_BF)
        G = X_BF @ inverse(self.foot)
        found = list(self._slides_last(G) if self.group == "slides" else self._group_last(G))
        loose = any(any(free) for _, free in found)
        return [self._of_chain(each) for each in found], loose

    def _group_last(self, G: Array) -> Iterator[Found]:
        """The other three joints first, by what the group leaves in its place."""
        left = [joint.screw for joint in self.joints[: self.at]]
        right = [joint.screw for joint in self.joints[self.at + 3 :]]
        group = [joint.screw for joint in self.grouped]
        back = inverse(G)
        others = [*right, *(moved(screw, back) for screw in left)]
        if self.group == "plane":
            o = next((screw.o for screw in group if screw.turns), np.zeros(3))
            goal = Plane(self.center, o)
            plane = Plane(back[:3, :3] @ goal.n, moved_point(back, o))
            outer = carry_plane(others, plane, goal, self.size)
        else:
            outer = carry_point(others, moved_point(back, self.center), self.center, self.size)
        for q, free in outer:
            of_right, of_left = q[: len(right)], q[len(right) :]
            T = inverse(motions(left, of_left)) @ G @ inverse(motions(right, of_right))
            for own, loose in self._of_group(group, T):
                yield Found(
                    (*of_left, *own, *of_right), (*free[len(right) :], *loose, *free[: len(right)])
                )

    def _of_group(self, group: Sequence[Screw], T: Array) -> Iterator[Found]:
        if self.group == "foot":
            yield Found((0.0,) * 3, (False,) * 3)
        elif self.group == "plane":
            yield from move_in_plane(group, self.center, T, self.size)
        else:
            yield from turn_about_point(group, T[:3, :3])

    def _slides_last(self, G: Array) -> Iterator[Found]:
        """The three joints that turn have the rotation, the three that slide the rest."""
        screws = [joint.screw for joint in self.joints]
        turning = [index for index, screw in enumerate(screws) if screw.turns]
        sliding = [index for index, screw in enumerate(screws) if not screw.turns]
        for angles, free in turn_about_point([screws[index] for index in turning], G[:3, :3]):
            q, loose = [0.0] * 6, [False] * 6
            for index, angle, any_angle in zip(turning, angles, free, strict=True):
                q[index], loose[index] = angle, any_angle
            origin = motions(screws, q)[:3, 3]
            columns = []
            for index in sliding:
                q[index] = 1.0
                columns.append(motions(screws, q)[:3, 3] - origin)
                q[index] = 0.0
            slides = np.linalg.lstsq(np.transpose(columns), G[:3, 3] - origin, rcond=PARALLEL)[0]
            for index, slide in zip(sliding, slides.tolist(), strict=True):
                q[index] = slide
            yield Found(tuple(q), tuple(loose))

    def _of_chain(self, found: Found) -> Found:
        """Leave out what completes the chain, and put the joints in its order."""
        own = sorted(
            (joint.number, q, free)
            for joint, q, free in zip(self.joints, *found, strict=True)
            if joint.number is not None
        )
        return Found(tuple(q for _, q, _ in own), tuple(free for _, _, free in own))


def in_words(names: Sequence[object]) -> str:
    """Write ``4, 5 and 6``."""
    words = [str(name) for name in names]
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]])) if words else ""


@lru_cache(maxsize=64)
def closed_forms(rows: tuple[Row, ...], *, pose: bool) -> tuple[ClosedForm, ...]:
    """Closed forms for the pose of a chain's foot, or for its position, the preferred one first.

    One alone may not see a posture in which the joints that complete the chain are singular.
    """
    size = table_length(rows)
    foot = foot_pose(rows, np.zeros(len(moving_rows(rows))))
    screws = screws_of(rows)
    if len(screws) > (6 if pose else 3):
        return ()
    forms = _forms(screws, foot, size) if pose else _point_forms(screws, foot, size)
    return tuple(islice((form for form in forms if _holds(form, rows, pose=pose)), MOST_FORMS))


def _holds(form: ClosedForm, rows: Sequence[Row], *, pose: bool) -> bool:
    """Whether random postures are found again, and are not among infinitely many."""
    rng = np.random.default_rng(0)
    turns = np.array([rows[index].joint == "revolute" for index in moving_rows(rows)])
    for q in rng.uniform(-1.0, 1.0, (TRIALS, len(turns))):
        q = np.where(turns, math.pi * q, form.size * q)
        X_BF = foot_pose(rows, q)
        if not pose:
            X_BF[:3, :3] = np.eye(3)
        found, loose = form.solve(X_BF)
        if loose or not any(_is_same(np.array(each), q, turns, form.size) for each, _ in found):
            return False
    return True


def _is_same(a: Array, b: Array, turns: Array, size: float) -> bool:
    difference = np.where(turns, principal(a - b), (a - b) / size)
    return bool(np.abs(difference).max() < AGAIN)


def _point_forms(screws: Sequence[Screw], foot: Array, size: float) -> Iterator[ClosedForm]:
    """The position of the foot: three joints carry its origin."""
    for more in _completions(3 - len(screws), size):
        joints = (*map(Joint, range(len(screws)), screws), *more)
        yield ClosedForm("foot", _with_a_foot(joints), 3, foot[:3, 3], foot, size)


def _with_a_foot(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """The joints, and three that turn the foot about its origin, which stay at zero."""
    still = Joint(None, Screw(turns=True, z=np.array([0.0, 0.0, 1.0]), o=np.zeros(3)))
    return (*joints, still, still, still)


def _forms(screws: Sequence[Screw], foot: Array, size: float) -> Iterator[ClosedForm]:
    """All closed forms that a chain may have, those with the most of its own joints first."""
    missing = 6 - len(screws)
    chain = [Joint(number, screw) for number, screw in enumerate(screws)]
    orders = list(_orders(chain))
    for own in (3, 2, 1):
        if own > len(screws) or 3 - own > missing:
            continue
        for order, at in product(orders, reversed(range(len(screws) - own + 1))):
            group = order[at : at + own]
            for kind, center, more in _groups([joint.screw for joint in group], size):
                for rest in _completions(missing - len(more), size):
                    joints = (*order[:at], *group, *more, *order[at + own :], *rest)
                    yield ClosedForm(kind, joints, at, center, foot, size)
    slides = sum(not screw.turns for screw in screws)
    if slides <= 3 and len(screws) - slides <= 3:
        lacking = [_slider(k) for k in range(3 - slides)]
        lacking += [_turner(k, size) for k in range(3 - len(screws) + slides)]
        yield ClosedForm("slides", (*chain, *lacking), 0, np.zeros(3), foot, size)
    if missing >= 3:
        for p in (foot[:3, 3], foot[:3, 3] + size * foot[:3, :3] @ ODD):
            for rest in _completions(missing - 3, size):
                yield ClosedForm("foot", _with_a_foot((*chain, *rest)), 3, p, foot, size)


def _orders(chain: Sequence[Joint]) -> Iterator[list[Joint]]:
    """The chain, and what joints whose motions commute make of it when exchanged."""
    seen: set[tuple[int | None, ...]] = set()
    waiting = [list(chain)]
    while waiting:
        order = waiting.pop(0)
        key = tuple(joint.number for joint in order)
        if key in seen:
            continue
        seen.add(key)
        yield order
        for at in range(len(order) - 1):
            first, second = order[at].screw, order[at + 1].screw
            slides = not (first.turns and second.turns)
            if slides and (not (first.turns or second.turns) or are_parallel(first.z, second.z)):
                waiting.append([*order[:at], order[at + 1], order[at], *order[at + 2 :]])


def _groups(own: Sequence[Screw], size: float) -> Iterator[tuple[Group, Array, tuple[Joint, ...]]]:
    """The groups that one to three joints of the chain are in, with the joints that they lack."""
    point = common_point(own, size)
    if point is not None:
        axes = [screw.z for screw in own]
        if len(axes) == 1:
            axes.append(perpendicular(axes[0]))
        if len(axes) == 2:
            axes.append(_third_axis(*axes))
        more = tuple(Joint(None, Screw(True, z, point)) for z in axes[len(own) :])
        yield "point", point, more
    normal = common_plane(own)
    if normal is not None and len(own) > 1:
        x = perpendicular(normal)
        lacking = (Joint(None, Screw(True, normal, own[-1].o + size * x)),)
        yield "plane", normal, lacking[: 3 - len(own)]


def _third_axis(first: Array, second: Array) -> Array:
    """An axis off the plane of two others, at another angle to the second than the first is."""
    across = vector_product(first, second)
    across = across / np.linalg.norm(across)
    angle = math.atan2(float(np.linalg.norm(vector_product(first, second))), float(first @ second))
    tilt = 1.2 if abs(math.sin(angle)) < 0.8 else 0.9
    axis: Array = math.cos(tilt) * second + math.sin(tilt) * across
    return axis


def _completions(missing: int, size: float) -> Iterator[tuple[Joint, ...]]:
    """Joints that complete the three outside of the group, in several kinds."""
    for kinds in product((True, False), repeat=missing):
        yield tuple(_turner(k, size) if turns else _slider(k) for k, turns in enumerate(kinds))


def _turner(k: int, size: float) -> Joint:
    return Joint(None, Screw(True, _odd(k), size * _odd(k + 1)))


def _slider(k: int) -> Joint:
    return Joint(None, Screw(False, _odd(k), np.zeros(3)))


def _odd(k: int) -> Array:
    """The k-th of some directions of no special kind."""
    axis: Array = turned(np.array([0.6, 0.0, 0.8]), np.array([2.1 * k]), ODD)[0]
    return axis
