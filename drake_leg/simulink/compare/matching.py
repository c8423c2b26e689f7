"""Which bodies and joints of two mechanisms stand for each other.

Trees are matched from their roots by what they are: kinds of joints, what hangs there, what is
sensed. Of branches that are alike in that, those are paired that are nearest in their values; where
even these are the same, names decide, and then the order. Lengths count relative to the size of the
whole, so that a model in other units is matched as well.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from drake_leg.simulink.compare.graph import WORLD, Graph, GraphJoint, Place, Sensor

OTHER_JOINT = 0.25  # what a pair of joints of different kinds is worth; 1 of the same kind
SAME_SENSING, SAME_SOLIDS = 0.5, 0.25  # what is added for bodies that are alike
SKIPPED = 0.5  # what a joint too many takes off
VALUES, NAMES = 1e-4, 1e-6  # of these only as much that they break ties
Pair = tuple[int, int]  # numbers of bodies: ours, theirs

MOST_PAIRS = 144  # of children that are tried in all ways; more are paired by their signatures


@dataclass(frozen=True, kw_only=True)
class Matching:
    """The bodies and joints that stand for each other: ours -> theirs, from the roots on."""

    bodies: dict[int, int]
    joints: dict[int, int]
    places: dict[int, int]  # joints whose bases are at one place, a joint too many included
    sensors: dict[int, int]
    loops: dict[int, int]
    turned: frozenset[int]  # our sensors whose base and follower are exchanged

    @property
    def is_grounded(self) -> bool:
        """Whether no tree without a world stands for one with it."""
        return all((ours == WORLD) == (theirs == WORLD) for ours, theirs in self.bodies.items())


def match(ours: Graph, theirs: Graph) -> Matching:
    """Match two mechanisms."""
    words: dict[tuple[object, ...], str] = {}
    trees = _Pairs(_Side(ours, words), _Side(theirs, words))
    bodies, joints = trees.best()
    sensors = _matched_sensors(ours, theirs, bodies)
    return Matching(
        bodies=bodies,
        joints=joints,
        places=dict(_places(ours, theirs, bodies, joints)),
        sensors=sensors,
        loops=_matched_loops(ours, theirs, bodies),
        turned=frozenset(
            a for a, b in sensors.items() if _is_turned(ours.sensors[a], theirs.sensors[b], bodies)
        ),
    )


class _Side:
    """One mechanism, with what its bodies are."""

    def __init__(self, graph: Graph, words: dict[tuple[object, ...], str]) -> None:
        self.graph = graph
        self.children = graph.children
        self.places = graph.place_of_joint
        self.solids = [_solids(places) for places in graph.bodies]
        self.masses = [_mass(places) for places in graph.bodies]
        self.sensed = Counter(sensor.foot for sensor in graph.sensors)
        lengths = [float(np.linalg.norm(p.X_M[:3, 3])) for p in self.places.values()]
        self.size = max([*lengths, 1e-12])
        self.depths = [0] * len(graph.bodies)
        for joint in graph.joints:
            self.depths[joint.child] = self.depths[joint.parent] + 1
        self._signatures = self._described(words)

    def signature(self, joint: GraphJoint) -> str:
        """Describe a joint and all beyond it: the same text for the same structure."""
        return f"{joint.type} {self._signatures[joint.child]}"

    def _described(self, words: dict[tuple[object, ...], str]) -> list[str]:
        """Describe the tree from each body on, in words that both sides share."""
        found = [""] * len(self.graph.bodies)
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
        for pair in sorted(self._below, key=lambda pair: -self._depth(pair)):
            self._assess(pair)

    def _depth(self, pair: Pair) -> int:
        return self._ours.depths[pair[0]] + self._theirs.depths[pair[1]]

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
        """List the pairs of joints beyond two bodies that may stand for each other."""
        ours, theirs = self._ours.children[a], self._theirs.children[b]
        if len(ours) * len(theirs) > MOST_PAIRS:
            return self._alike(ours, theirs)
        pairs = [(one, other) for one in ours for other in theirs]
        return [*pairs, *(beyond for pair in pairs for beyond in self._beyond(*pair))]

    def _alike(
        self, ours: list[GraphJoint], theirs: list[GraphJoint]
    ) -> list[tuple[GraphJoint, GraphJoint]]:
        """Pair very many joints by what they and all beyond them are, then in order."""
        by_signature: dict[str, list[GraphJoint]] = {}
        for joint in reversed(theirs):
            by_signature.setdefault(self._theirs.signature(joint), []).append(joint)
        found, left = [], []
        for joint in ours:
            alike = by_signature.get(self._ours.signature(joint))
            if alike:
                found.append((joint, alike.pop()))
            else:
                left.append(joint)
        taken = {other.number for _, other in found}
        others = [joint for joint in theirs if joint.number not in taken]
        return [*found, *zip(left, others, strict=False)]

    def _beyond(self, a: GraphJoint, b: GraphJoint) -> list[tuple[GraphJoint, GraphJoint]]:
        """Pair a joint with one beyond the other, if that one is a joint too many."""
        ours, theirs = self._ours, self._theirs
        if ours.signature(a) == theirs.signature(b):
            return []
        found = [(one, b) for one in ours.children[a.child]]
        found += [(a, other) for other in theirs.children[b.child]]
        return [(x, y) for x, y in found if ours.signature(x) == theirs.signature(y)]

    def _assess(self, pair: Pair) -> None:
        """Choose the joints beyond a pair of bodies that stand for each other."""
        worths: dict[Pair, float] = {}
        direct: dict[Pair, float] = {}
        for a, b in self._below[pair]:
            skips = (a.parent != pair[0]) + (b.parent != pair[1])
            beyond = self._worth[a.child, b.child]
            numbers = a.number, b.number
            worths[numbers] = self._of_joints(a, b) + beyond - SKIPPED * skips
            if not skips:
                direct[numbers] = worths[numbers]
        best = _assigned(direct)
        if len(direct) < len(worths):
            by_numbers = {(a.number, b.number): (a, b) for a, b in self._below[pair]}
            other = _apart(sorted(_assigned(worths), key=lambda n: -worths[n]), by_numbers)
            best = max(best, other, key=lambda chosen: sum(worths[n] for n in chosen))
        wanted = set(best)
        self._chosen[pair] = [
            (a, b) for a, b in self._below[pair] if (a.number, b.number) in wanted
        ]
        self._worth[pair] = self._of_bodies(*pair) + sum(worths[numbers] for numbers in best)

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


def _in_a_row(a: GraphJoint, b: GraphJoint) -> bool:
    """Tell whether one of two joints leads to the other."""
    return a.parent == b.child or b.parent == a.child


def _apart(
    ranked: Sequence[Pair], joints: Mapping[Pair, tuple[GraphJoint, GraphJoint]]
) -> list[Pair]:
    """Leave out pairs of which a joint leads to one of a pair before it."""
    found: list[Pair] = []
    for numbers in ranked:
        a, b = joints[numbers]
        before = (joints[other] for other in found)
        if not any(_in_a_row(a, x) or _in_a_row(b, y) for x, y in before):
            found.append(numbers)
    return found


def _assigned(worths: Mapping[Pair, float]) -> list[Pair]:
    """Choose pairs of numbers, each number once, that are worth most together."""
    rows = {number: place for place, number in enumerate(dict.fromkeys(a for a, _ in worths))}
    columns = {number: place for place, number in enumerate(dict.fromkeys(b for _, b in worths))}
    if len(worths) == min(len(rows), len(columns)):
        return list(worths)
    matrix = np.zeros((len(rows), len(columns)))
    for (a, b), worth in worths.items():
        matrix[rows[a], columns[b]] = worth
    places = zip(*linear_sum_assignment(matrix, maximize=True), strict=True)
    chosen = {(row, column) for row, column in places}
    return [pair for pair in worths if (rows[pair[0]], columns[pair[1]]) in chosen]


def _likeness(ours: Counter[str], theirs: Counter[str]) -> float:
    """Tell how many of the solids are of the same shapes, 0 to 1."""
    most = max(ours.total(), theirs.total())
    return (ours & theirs).total() / most if most else 1.0


def _places(
    ours: Graph, theirs: Graph, bodies: Mapping[int, int], joints: Mapping[int, int]
) -> Iterator[Pair]:
    """Pair the joints that lead away from a pair of bodies, those too many included."""
    by_number = {joint.number: joint for joint in theirs.joints}
    for joint in ours.joints:
        after = [joint, *ours.children[joint.child]]
        others = [by_number[joints[each.number]] for each in after if each.number in joints]
        before = [theirs.inbound.get(other.parent, other) for other in others]
        at_place = (one for one in (*others, *before) if one.parent == bodies.get(joint.parent))
        there = next(at_place, None)
        if there is not None:
            yield joint.number, there.number


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
