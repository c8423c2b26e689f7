"""Which bodies and joints of two mechanisms stand for each other.

Trees are matched from their roots by what they are: kinds of joints, what hangs there, what is
sensed. Of branches that are alike in that, those are paired that are nearest in their values; where
even these are the same, names decide, and then the order. Lengths count relative to the size of the
whole, so that a model in other units is matched as well.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from drake_leg.simulink.compare.graph import WORLD, Graph, GraphJoint, Place, Sensor

OTHER_JOINT = 0.25  # what a pair of joints of different kinds is worth; 1 of the same kind
SAME_SENSING, SAME_SOLIDS = 0.5, 0.25  # what is added for bodies that are alike
VALUES, NAMES = 1e-4, 1e-6  # of these only as much that they break ties
Pair = tuple[int, int]  # numbers of bodies: ours, theirs

MOST_PAIRS = 144  # of children that are tried in all ways; more are paired by their signatures


@dataclass(frozen=True, kw_only=True)
class Matching:
    """The bodies and joints that stand for each other: ours -> theirs, from the roots on."""

    bodies: dict[int, int]
    joints: dict[int, int]
    sensors: dict[int, int]
    loops: dict[int, int]
    turned: frozenset[int]  # our sensors whose base and follower are exchanged

    @property
    def is_grounded(self) -> bool:
        """Whether no tree without a world stands for one with it."""
        return all((ours == WORLD) == (theirs == WORLD) for ours, theirs in self.bodies.items())


def match(ours: Graph, theirs: Graph) -> Matching:
    """Match two mechanisms."""
    trees = _Pairs(_Side(ours), _Side(theirs))
    bodies, joints = trees.best()
    sensors = _matched_sensors(ours, theirs, bodies)
    return Matching(
        bodies=bodies,
        joints=joints,
        sensors=sensors,
        loops=_matched_loops(ours, theirs, bodies),
        turned=frozenset(
            a for a, b in sensors.items() if _is_turned(ours.sensors[a], theirs.sensors[b], bodies)
        ),
    )


class _Side:
    """One mechanism, with what its bodies are."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.children = graph.children
        self.places = graph.place_of_joint
        self.solids = [_solids(places) for places in graph.bodies]
        self.masses = [_mass(places) for places in graph.bodies]
        self.sensed = Counter(sensor.foot for sensor in graph.sensors)
        lengths = [float(np.linalg.norm(p.X_M[:3, 3])) for p in self.places.values()]
        self.size = max([*lengths, 1e-12])
        self.signatures = self._signatures()

    def _signatures(self) -> list[str]:
        """Describe the tree from each body on, the same words for the same structure."""
        found = [""] * len(self.graph.bodies)
        words: dict[tuple[object, ...], str] = {}
        ends = [joint.child for joint in reversed(self.graph.joints)]
        for body in (*ends, *self.graph.floating, WORLD):
            below = sorted(f"{joint.type} {found[joint.child]}" for joint in self.children[body])
            what = (*below, *sorted(self.solids[body].elements()), self.sensed[body])
            found[body] = words.setdefault(what, str(len(words)))
        return found


def _solids(places: Sequence[Place]) -> Counter[str]:
    return Counter(place.solid.shape for place in places if place.solid is not None)


def _mass(places: Sequence[Place]) -> float:
    return sum(place.solid.mass for place in places if place.solid is not None)


class _Pairs:
    """The pairs of bodies of two mechanisms that may stand for each other, and their worth."""

    def __init__(self, ours: _Side, theirs: _Side) -> None:
        self._ours, self._theirs = ours, theirs
        self._roots = self._possible_roots()
        self._below: dict[Pair, list[tuple[GraphJoint, GraphJoint]]] = {}
        self._chosen: dict[Pair, list[tuple[GraphJoint, GraphJoint]]] = {}
        self._worth: dict[Pair, float] = {}
        line = list(self._roots)
        for pair in line:
            if pair not in self._below:
                self._below[pair] = self._candidates(*pair)
                line += [(a.child, b.child) for a, b in self._below[pair]]
        for pair in reversed(list(self._below)):
            self._assess(pair)

    def best(self) -> tuple[dict[int, int], dict[int, int]]:
        """Return the bodies and joints of the best matching, from the roots on."""
        bodies: dict[int, int] = {}
        joints: dict[int, int] = {}
        for root in self._best_roots():
            line = [root]
            for pair in line:
                bodies[pair[0]] = pair[1]
                for a, b in self._chosen[pair]:
                    joints[a.number] = b.number
                    line.append((a.child, b.child))
        return bodies, joints

    def _possible_roots(self) -> list[Pair]:
        """Pair the worlds, and trees without one; a world that leads nowhere gives its place."""
        ours, theirs = (side.graph for side in (self._ours, self._theirs))
        found = [(a, b) for a in ours.floating for b in theirs.floating]
        if not self._ours.children[WORLD]:
            found += [(a, WORLD) for a in ours.floating]
        if not self._theirs.children[WORLD]:
            found += [(WORLD, b) for b in theirs.floating]
        return [(WORLD, WORLD), *found]

    def _best_roots(self) -> list[Pair]:
        """Choose roots, the worthiest first."""
        found: list[Pair] = []
        taken: tuple[set[int], set[int]] = (set(), set())
        ranked = sorted(self._roots, key=lambda pair: (-self._worth[pair], pair))
        for pair in ranked:
            if pair[0] not in taken[0] and pair[1] not in taken[1]:
                found.append(pair)
                taken[0].add(pair[0])
                taken[1].add(pair[1])
        return found

    def _candidates(self, a: int, b: int) -> list[tuple[GraphJoint, GraphJoint]]:
        ours, theirs = self._ours.children[a], self._theirs.children[b]
        if len(ours) * len(theirs) <= MOST_PAIRS:
            return [(one, other) for one in ours for other in theirs]
        by_signature: dict[str, list[GraphJoint]] = {}
        for joint in reversed(theirs):
            key = f"{joint.type} {self._theirs.signatures[joint.child]}"
            by_signature.setdefault(key, []).append(joint)
        found, left = [], []
        for joint in ours:
            alike = by_signature.get(f"{joint.type} {self._ours.signatures[joint.child]}")
            if alike:
                found.append((joint, alike.pop()))
            else:
                left.append(joint)
        taken = {id(other) for _, other in found}
        others = [joint for joint in theirs if id(joint) not in taken]
        return [*found, *zip(left, others, strict=False)]

    def _assess(self, pair: Pair) -> None:
        below = self._below[pair]
        worth = [self._of_joints(a, b) + self._worth[a.child, b.child] for a, b in below]
        chosen = list(range(len(below)))
        columns = len({b.number for _, b in below})
        if below and len(below) > columns:  # all ours with all theirs
            rows, places = linear_sum_assignment(np.reshape(worth, (-1, columns)), maximize=True)
            chosen = [columns * row + place for row, place in zip(rows, places, strict=True)]
        elif below and len({a.number for a, _ in below}) < len(below):  # one of ours with many
            chosen = [int(np.argmax(worth))]
        self._chosen[pair] = [below[each] for each in chosen]
        self._worth[pair] = self._of_bodies(*pair) + sum(worth[each] for each in chosen)

    def _of_bodies(self, a: int, b: int) -> float:
        ours, theirs = self._ours, self._theirs
        found = SAME_SENSING * (bool(ours.sensed[a]) == bool(theirs.sensed[b]))
        found += SAME_SOLIDS * _likeness(ours.solids[a], theirs.solids[b])
        masses = ours.masses[a], theirs.masses[b]
        if min(masses) > 0.0:
            found += VALUES / (1.0 + abs(math.log(masses[0] / masses[1])))
        return found

    def _of_joints(self, a: GraphJoint, b: GraphJoint) -> float:
        near = self._nearness(self._ours.places[a.number], self._theirs.places[b.number])
        named = a.name.casefold() == b.name.casefold()
        return (1.0 if a.type == b.type else OTHER_JOINT) + VALUES * near + NAMES * named

    def _nearness(self, ours: Place, theirs: Place) -> float:
        p, r = ours.X_M[:3, 3], theirs.X_M[:3, 3]
        size = self._theirs.size
        apart = min(
            float(np.linalg.norm(p - r)) / size,
            float(np.linalg.norm(p / self._ours.size - r / size)),
        )
        turned = float(np.linalg.norm(ours.X_M[:3, :3] - theirs.X_M[:3, :3]))
        return 1.0 / (1.0 + apart) + 1.0 / (1.0 + turned)


def _likeness(ours: Counter[str], theirs: Counter[str]) -> float:
    """Tell how many of the solids are of the same shapes, 0 to 1."""
    most = max(ours.total(), theirs.total())
    return (ours & theirs).total() / most if most else 1.0


# --- sensors and loops -----------------------------------------------------------------------


def _matched_sensors(ours: Graph, theirs: Graph, bodies: dict[int, int]) -> dict[int, int]:
    """Match sensors: the nearer both ends are to those of the other, the better."""

    def unlikeness(pair: Pair) -> tuple[int, ...]:
        a, b = ours.sensors[pair[0]], theirs.sensors[pair[1]]
        turned = _is_turned(a, b, bodies)
        wrong = (bodies.get(a.base) != b.base) + (bodies.get(a.foot) != b.foot)
        foot = a.base if turned else a.foot
        return 0 if turned else wrong, turned, -foot, a.name != b.name

    return _greedily(len(ours.sensors), len(theirs.sensors), unlikeness)


def _is_turned(a: Sensor, b: Sensor, bodies: Mapping[int, int]) -> bool:
    """Tell whether a sensor measures the other one's base from its foot."""
    wrong = (bodies.get(a.base), bodies.get(a.foot)) == (b.foot, b.base)
    only_one_is_still = (a.foot == WORLD) != (b.foot == WORLD)
    return b.foot != b.base and (wrong or only_one_is_still)


def _matched_loops(ours: Graph, theirs: Graph, bodies: dict[int, int]) -> dict[int, int]:
    """Match joints that close loops by their kinds and the bodies that they connect."""

    def unlikeness(pair: Pair) -> tuple[int, ...]:
        a, b = ours.loops[pair[0]], theirs.loops[pair[1]]
        ends = [bodies.get(a.parent), bodies.get(a.child)]
        wrong = min(
            sum(x != y for x, y in zip(ends, other, strict=True))
            for other in ((b.parent, b.child), (b.child, b.parent))
        )
        return 3 * (a.type != b.type) + wrong, a.name != b.name

    return _greedily(len(ours.loops), len(theirs.loops), unlikeness)


def _greedily(
    ours: int, theirs: int, unlikeness: Callable[[Pair], tuple[int, ...]]
) -> dict[int, int]:
    """Pair the numbers below two others, the likeliest pairs first."""
    pairs = [(a, b) for a in range(ours) for b in range(theirs)]
    found: dict[int, int] = {}
    for a, b in sorted(pairs, key=unlikeness):
        if a not in found and b not in found.values():
            found[a] = b
    return found
