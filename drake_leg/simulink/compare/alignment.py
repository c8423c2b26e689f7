"""Two mechanisms aligned body by body in one unit of length.

Both are compared in the frame of the joint that carries a body, so that one wrong offset is one
difference and not one for every body after it. Where a joint's two frames are turned about its
axis, or moved along it, by the same amount on both of its sides, nothing moves differently; this
freedom is used up before bodies are compared.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from statistics import median

import numpy as np
from scipy.optimize import linear_sum_assignment

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.graph import WORLD, Graph, GraphJoint, Passed, Place
from drake_leg.simulink.compare.matching import Matching
from drake_leg.simulink.compare.of_model import FLIP
from drake_leg.simulink.mechanism import inverse

NEAR = 1e-9  # [m] or of a rotation's entries
SAME = 1e-6  # relative, of ratios that are one factor
SMALLEST = 1e-9  # [m] of a length that has a ratio
FEWEST = 2  # lengths that one factor must explain
MOST = 0.75  # share of the lengths that it must explain
OTHER_SHAPE = 0.5  # how unlike solids of two shapes are; 1 is very far apart
OTHER_NAME = 1e-3  # solids with two names
MOST_TRIED = 250_000  # pairs of solids of a body
EXCHANGED = {"sensor": "foot", "foot": "sensor"}  # ends of a sensor that is turned

Pair = tuple[Place, Place]  # ours, theirs


@dataclass(frozen=True, eq=False)
class Miss:
    """A place that is not where its counterpart is."""

    place: Place
    way: tuple[Passed, ...]  # from the last place on the way that has a counterpart
    what: str  # "translation", "rotation"
    measured: Array  # displacement or rotation in their frame M
    expected: Array
    gauge: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class AlignedBody:
    """A body of both mechanisms, place by place."""

    ours: int
    theirs: int
    pairs: list[Pair]
    gauge: Array  # pose of our frame M in theirs
    misses: list[Miss]
    unmatched: list[Place]  # our solids
    absent: list[Place]  # their solids


@dataclass(frozen=True, eq=False, kw_only=True)
class _Passage:
    """A way through a joint, and what it leaves elsewhere."""

    gauge: Array  # of the next body
    misses: list[Miss]  # at the joint
    is_exchanged: bool
    unlikeliness: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Alignment:
    """All bodies that stand for each other, and joints that point the other way by mistake."""

    bodies: list[AlignedBody]
    exchanged: list[int]  # our joints whose base and follower are exchanged

    @cached_property
    def gauges(self) -> dict[int, Array]:
        """Map each of our bodies to the pose of its frame M in that of its counterpart."""
        return {body.ours: body.gauge for body in self.bodies}


# --- one unit of length ----------------------------------------------------------------------


def scale_of(ours: Graph, theirs: Graph, matching: Matching) -> float:
    """Find how many times as long as theirs all our lengths are.

    A body's length is how far its next joint, or the sensed foot, is from its own joint's axis.
    Where there are too few, solids count, too: how far they are, and their sizes. The factor is 1
    where no single one explains nearly all lengths.
    """
    lengths = list(_lengths(ours, theirs, matching))
    if len(lengths) < FEWEST:
        lengths += _solid_lengths(ours, theirs, matching)
    both = [pair for pair in lengths if max(pair) > SMALLEST]
    ratios = [a / b if min(a, b) > SMALLEST else math.inf for a, b in both]
    if len(ratios) < FEWEST:
        return 1.0
    middle = median(ratios)
    same = [ratio for ratio in ratios if math.isclose(ratio, middle, rel_tol=SAME)]
    if middle == math.inf or len(same) < max(FEWEST, MOST * len(ratios)):
        return 1.0
    factor = float(f"{np.mean(same):.9g}")
    return 1.0 if math.isclose(factor, 1.0, rel_tol=SAME) else factor


def _lengths(ours: Graph, theirs: Graph, matching: Matching) -> Iterator[tuple[float, float]]:
    for a, b in matching.bodies.items():
        live: dict[tuple[str, int | None], Place]
        live = {(place.role, place.number): place for place in theirs.bodies[b]}
        for place in ours.bodies[a]:
            number = counterpart(matching, place.role, place.number)
            if place.role in ("joint", "foot") and (place.role, number) in live:
                yield _off_axis(place), _off_axis(live[place.role, number])


def _solid_lengths(ours: Graph, theirs: Graph, matching: Matching) -> Iterator[tuple[float, float]]:
    """List lengths of solids that are the only ones of their bodies."""
    for a, b in matching.bodies.items():
        solids = [*_solids(ours.bodies[a]), *_solids(theirs.bodies[b])]
        if len(solids) == 2 and all(place.solid for place in solids):
            mine, other = solids
            yield _off_axis(mine), _off_axis(other)
            if mine.solid and other.solid and mine.solid.shape == other.solid.shape:
                yield max(mine.solid.size, default=0.0), max(other.solid.size, default=0.0)


def _off_axis(place: Place) -> float:
    return math.hypot(*place.X_M[:2, 3])


def counterpart(matching: Matching, role: str, number: int) -> int | None:
    """Return the number of what stands for a joint, a sensor or a loop of ours."""
    if role == "joint":
        return matching.places.get(number)
    if role in ("foot", "sensor"):
        return matching.sensors.get(number)
    if role.startswith("loop"):
        return matching.loops.get(number)
    return number


# --- places ----------------------------------------------------------------------------------


def align(
    ours: Graph, theirs: Graph, matching: Matching, turns: Callable[[Place], bool]
) -> Alignment:
    """Align two mechanisms; ``turns`` tells whether it matters how a place of ours is turned."""
    return _Aligning(ours, theirs, matching, turns).done()


class _Aligning:
    def __init__(
        self, ours: Graph, theirs: Graph, matching: Matching, turns: Callable[[Place], bool]
    ) -> None:
        self._ours, self._theirs, self._matching, self._turns = ours, theirs, matching, turns
        self._by_number = {joint.number: joint for joint in ours.joints}
        lengths = (np.linalg.norm(p.X_M[:3, 3]) for body in theirs.bodies for p in body)
        self._size = max(map(float, lengths), default=0.0) or SMALLEST
        self._pairs = {a: self._paired(a, b) for a, b in matching.bodies.items()}
        self._ways = {a: _by_way(pairs) for a, pairs in self._pairs.items()}

    def done(self) -> Alignment:
        """Align all bodies, from the roots on."""
        gauges: dict[int, Array] = {}
        found: list[AlignedBody] = []
        exchanged: list[int] = []
        for a, b in self._matching.bodies.items():
            gauge = gauges[a] if a in gauges else self._pose(a)
            misses: list[Miss] = []
            for pair in self._pairs[a]:
                if pair[0].role != "joint":
                    misses += self._misses(pair, pair[0].X_M, a, gauge)
                    continue
                joint = self._by_number[pair[0].number]
                passage = self._through(joint, a, pair, gauge)
                gauges[joint.child] = passage.gauge
                misses += passage.misses
                exchanged += [joint.number] * passage.is_exchanged
            found.append(self._aligned(a, b, gauge, misses))
        return Alignment(bodies=found, exchanged=exchanged)

    def _aligned(self, a: int, b: int, gauge: Array, misses: list[Miss]) -> AlignedBody:
        taken = [{id(pair[side]) for pair in self._pairs[a]} for side in (0, 1)]
        left = [
            [place for place in places if place.role == "solid" and id(place) not in of_side]
            for places, of_side in zip(
                (self._ours.bodies[a], self._theirs.bodies[b]), taken, strict=True
            )
        ]
        return AlignedBody(
            ours=a,
            theirs=b,
            pairs=self._pairs[a],
            gauge=gauge,
            misses=misses,
            unmatched=left[0],
            absent=left[1],
        )

    def _pose(self, body: int) -> Array:
        """Return the pose of a body that no pair of bodies leads to.

        A tree without a world may stand anywhere; beyond a joint too many nothing is moved.
        """
        grounded = body == WORLD and self._matching.bodies[body] == WORLD
        if grounded or body in self._ours.inbound:
            return np.eye(4)
        joint = next((pair for pair in self._pairs[body] if pair[0].role == "joint"), None)
        solid = next(iter(self._pairs[body]), None)
        first = joint or solid
        return np.eye(4) if first is None else first[1].X_M @ inverse(first[0].X_M)

    def _through(self, joint: GraphJoint, body: int, pair: Pair, gauge: Array) -> _Passage:
        """Go through a joint the likeliest way.

        Its frames may be turned about its axis, or its ends may have been exchanged by mistake.
        """
        found: list[_Passage] = []
        for is_exchanged in (False, True)[: 1 + joint.turned]:
            turn = FLIP if is_exchanged else np.eye(4)
            X_M = pair[0].X_M @ turn
            misses = self._misses(pair, X_M, body, gauge)
            D = inverse(pair[1].X_M) @ gauge @ X_M
            for following, left in ((turn, misses), (D @ turn, [])):
                if following is turn or (misses and _about_z(D)):
                    count = len(left) + self._count_misses(joint.child, following)
                    found.append(
                        _Passage(
                            gauge=following,
                            misses=left,
                            is_exchanged=is_exchanged,
                            unlikeliness=2 * count + is_exchanged,
                        )
                    )
        return min(found, key=lambda passage: passage.unlikeliness)

    def _count_misses(self, body: int, gauge: Array) -> int:
        """Count what is elsewhere in a body; a joint there may be exchanged."""
        count = 0
        for pair in self._pairs.get(body, ()):
            place = pair[0]
            turned = place.role == "joint" and self._by_number[place.number].turned
            poses = [place.X_M, place.X_M @ FLIP] if turned else [place.X_M]
            count += min(len(self._misses(pair, X_M, body, gauge)) for X_M in poses)
        return count

    def _misses(self, pair: Pair, X_M: Array, body: int, gauge: Array) -> list[Miss]:
        """Tell how a place, at a pose in our frame M, is elsewhere than its counterpart."""
        ours, theirs = pair
        found: list[Miss] = []
        measured, expected = (gauge @ X_M)[:3, 3], theirs.X_M[:3, 3]
        before = self._before(ours, body)
        skipped = 0
        if before is not None:
            measured = measured - (gauge @ before[0].X_M)[:3, 3]
            expected = expected - before[1].X_M[:3, 3]
            skipped = before[0].way.depth if before[0].way else 0
        if np.abs(measured - expected).max() > NEAR:
            way = tuple(ours.passed()[skipped:])
            found.append(Miss(ours, way, "translation", measured, expected, gauge))
        if self._turns(ours):
            R, wanted = gauge[:3, :3] @ X_M[:3, :3], theirs.X_M[:3, :3]
            if np.abs(R - wanted).max() > NEAR:
                found.append(Miss(ours, tuple(ours.passed()), "rotation", R, wanted, gauge))
        return found

    def _before(self, place: Place, body: int) -> Pair | None:
        """Return the last place with a counterpart on the way to a place."""
        here = place.way.after if place.way else None
        while here is not None:
            pair = self._ways[body].get(id(here))
            if pair is not None:
                return pair
            here = here.after
        return None

    def _paired(self, a: int, b: int) -> list[Pair]:
        """Find for every place of a body the other's one of the same role; joints come first."""
        mine, others = self._ours.bodies[a], self._theirs.bodies[b]
        theirs: dict[tuple[str, int], Place] = {(p.role, p.number): p for p in others}
        found: list[Pair] = []
        for place in mine:
            number = counterpart(self._matching, place.role, place.number)
            if place.role != "solid" and number is not None:
                role: str = place.role
                if place.number in self._matching.turned:
                    role = EXCHANGED.get(role, role)
                if (role, number) in theirs:
                    found.append((place, theirs[role, number]))
        found += _paired_solids(_solids(mine), _solids(others), self._size)
        return sorted(found, key=lambda pair: pair[0].role != "joint")


def _by_way(pairs: Iterable[Pair]) -> dict[int, Pair]:
    """Map the last block on the way to a place to the place and its counterpart."""
    found: dict[int, Pair] = {}
    for pair in pairs:
        if pair[0].way is not None:
            found.setdefault(id(pair[0].way), pair)
    return found


def _about_z(D: Array) -> bool:
    """Tell whether a pose only turns about the z axis and moves along it."""
    along = abs(D[0, 3]) < NEAR and abs(D[1, 3]) < NEAR
    return bool(along and abs(D[2, 2] - 1.0) < NEAR)


def _paired_solids(ours: list[Place], theirs: list[Place], size: float) -> list[Pair]:
    """Pair solids of a body: of the same shape and near to each other, if there are any."""
    if len(ours) * len(theirs) > MOST_TRIED:
        return _by_order(ours, theirs)
    if not (ours and theirs):
        return []
    ends = [np.array([place.X_M[:3, 3] for place in places]) for places in (ours, theirs)]
    apart = np.linalg.norm(ends[0][:, None] - ends[1][None], axis=2)
    shapes = [np.array([_shape(place) for place in places]) for places in (ours, theirs)]
    names = [np.array([place.name for place in places]) for places in (ours, theirs)]
    unlike = OTHER_SHAPE * (shapes[0][:, None] != shapes[1][None]) + apart / (apart + 0.1 * size)
    unlike += OTHER_NAME * (names[0][:, None] != names[1][None])
    rows, columns = linear_sum_assignment(unlike)
    return [(ours[row], theirs[column]) for row, column in zip(rows, columns, strict=True)]


def _by_order(ours: list[Place], theirs: list[Place]) -> list[Pair]:
    """Pair very many solids: those of the same shape in the order in which they are met."""
    left: dict[str, list[Place]] = {}
    for place in reversed(theirs):
        left.setdefault(_shape(place), []).append(place)
    return [(place, left[_shape(place)].pop()) for place in ours if left.get(_shape(place))]


def _solids(places: Iterable[Place]) -> list[Place]:
    return [place for place in places if place.role == "solid"]


def _shape(place: Place) -> str:
    return place.solid.shape if place.solid else ""
