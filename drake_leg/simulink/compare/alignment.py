"""The mechanisms of both sides in one unit of length, aligned link by link.

Both chains are compared in the frame of the joint that carries a link, so that one wrong offset
is one difference and not one for every link behind it. Where a joint's two frames are turned about
its axis, or moved along it, by the same amount on both of its sides, nothing moves differently;
this freedom is used up before links are compared.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.plant_mechanism import Mechanism, PassedTransform, Place
from drake_leg.simulink.compare.simulink_mechanism import Network
from drake_leg.simulink.mechanism import inverse

NEAR = 1e-9  # [m] or of a rotation's entries
SAME = 1e-6  # relative, of ratios that are one factor
SMALLEST = 1e-9  # [m] of a length that has a ratio
FEWEST = 2  # lengths that one factor must explain

Pair = tuple[Place, Place]  # the model's, the plant's


@dataclass(frozen=True)
class Miss:
    """A place that is not where it is in the plant."""

    place: Place
    way: tuple[PassedTransform, ...]  # from the last place on the way that is in both chains
    what: str  # "translation", "rotation"
    measured: Array  # displacement or rotation in the plant's frame M
    expected: Array
    gauge: Array


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """Both chains, place by place."""

    pairs: list[list[Pair]] = field(default_factory=list)  # of each body
    gauges: list[Array] = field(default_factory=list)  # of each body: the model's M in the plant's
    misses: list[Miss] = field(default_factory=list)
    unmatched: list[tuple[int, Place]] = field(default_factory=list)  # the model's solids
    absent: list[tuple[int, Place]] = field(default_factory=list)  # the plant's solids


def scale_of(simulink: Mechanism, drake: Mechanism) -> float:
    """Find how many times as long as the plant's all links of the model are.

    A link's length is how far its next joint, or the sensed foot, is from its own joint's axis.
    The factor is 1 where no single one explains all lengths.
    """
    if len(simulink.mechanism) != len(drake.bodies):
        return 1.0
    both = [
        (ours[key], theirs[key])
        for ours, theirs in (
            map(_lengths, bodies) for bodies in zip(simulink.mechanism, drake.bodies, strict=True)
        )
        for key in ours.keys() & theirs.keys()
    ]
    ratios = [ours / theirs for ours, theirs in both if min(ours, theirs) > SMALLEST]
    lost = [pair for pair in both if min(pair) <= SMALLEST < max(pair)]
    if lost or len(ratios) < FEWEST or max(ratios) - min(ratios) > SAME * max(ratios):
        return 1.0
    factor = float(f"{np.mean(ratios):.9g}")
    return 1.0 if math.isclose(factor, 1.0, rel_tol=SAME) else factor


def shrunk(network: Network, scale: float) -> Network:
    """Divide all lengths of a model's chain by a factor."""
    mechanism = replace(
        network.mechanism,
        bodies=tuple(
            tuple(_shrunk(place, scale) for place in places) for places in network.mechanism.bodies
        ),
    )
    frames = {node: (body, _nearer(X, scale)) for node, (body, X) in network.frames.items()}
    return replace(network, mechanism=mechanism, frames=frames)


def align(simulink: Mechanism, drake: Mechanism, *, orientation: bool) -> Alignment:
    """Align two chains; ``orientation`` tells whether the foot's orientation is sensed."""
    found = Alignment()
    gauge = np.eye(4)
    bodies = list(zip(simulink.mechanism, drake.bodies, strict=False))
    for body, (mine, theirs) in enumerate(bodies):
        pairs = _pairs(mine, theirs)
        misses = _misses(pairs, gauge, orientation=orientation)
        found.pairs.append(pairs)
        found.gauges.append(gauge)
        taken = [id(place) for pair in pairs for place in pair]
        for places, lost in ((mine, found.unmatched), (theirs, found.absent)):
            lost += [(body, p) for p in places if p.role == "solid" and id(p) not in taken]
        joint = next((pair for pair in pairs if pair[0].role == "joint"), None)
        following = np.eye(4)
        if joint is not None and body + 1 < len(bodies):
            D = inverse(joint[1].X_M) @ gauge @ joint[0].X_M
            own = [miss for miss in misses if miss.place is joint[0]]
            beyond = _pairs(*bodies[body + 1])
            folded = len(_misses(beyond, D, orientation=orientation))
            unfolded = len(_misses(beyond, following, orientation=orientation))
            if _about_z(D) and folded < unfolded + len(own):
                following = D
                misses = [miss for miss in misses if miss.place is not joint[0]]
        found.misses.extend(misses)
        gauge = following
    return found


def _lengths(places: tuple[Place, ...]) -> dict[tuple[str, int], float]:
    return {
        (place.role, place.number): math.hypot(*place.X_M[:2, 3])
        for place in places
        if place.role in ("joint", "foot")
    }


def _shrunk(place: Place, scale: float) -> Place:
    way = tuple(
        replace(one, X_before=_nearer(one.X_before, scale), X_BF=_nearer(one.X_BF, scale))
        for one in place.way
    )
    solid = place.solid
    if solid is not None:
        solid = replace(solid, size=tuple(edge / scale for edge in solid.size))
    return replace(place, X_M=_nearer(place.X_M, scale), way=way, solid=solid)


def _nearer(X: Array, scale: float) -> Array:
    nearer = X.copy()
    nearer[:3, 3] /= scale
    return nearer


def _pairs(simulink: tuple[Place, ...], drake: tuple[Place, ...]) -> list[Pair]:
    """Find for every place of a body the plant's one of the same role.

    Solids of the same shape come first, then the nearest, whichever is drawn first.
    """
    candidates = [
        (ours, theirs)
        for ours in simulink
        for theirs in drake
        if ours.role == theirs.role and ours.number == theirs.number
    ]
    found: dict[int, Place] = {}
    taken: set[int] = set()
    for ours, theirs in sorted(candidates, key=_unlikeness):
        if id(ours) not in found and id(theirs) not in taken:
            found[id(ours)] = theirs
            taken.add(id(theirs))
    ordered = sorted(simulink, key=lambda place: place.role != "joint")
    return [(place, found[id(place)]) for place in ordered if id(place) in found]


def _unlikeness(pair: Pair) -> tuple[bool, float]:
    """Tell how unlikely it is that two places are the same one."""
    shapes = {place.solid.shape for place in pair if place.solid is not None}
    ours, theirs = pair
    return len(shapes) > 1, float(np.linalg.norm(ours.X_M[:3, 3] - theirs.X_M[:3, 3]))


def _about_z(D: Array) -> bool:
    """Tell whether a pose only turns about the z axis and moves along it."""
    along = abs(D[0, 3]) < NEAR and abs(D[1, 3]) < NEAR
    return bool(along and abs(D[2, 2] - 1.0) < NEAR)


def _misses(pairs: list[Pair], gauge: Array, *, orientation: bool) -> list[Miss]:
    found = []
    for ours, theirs in pairs:
        before = _before(ours, pairs)
        measured, expected = (gauge @ ours.X_M)[:3, 3], theirs.X_M[:3, 3]
        if before:
            measured = measured - (gauge @ before[0].X_M)[:3, 3]
            expected = expected - before[1].X_M[:3, 3]
        way = ours.way[len(before[0].way) if before else 0 :]
        if np.abs(measured - expected).max() > NEAR:
            found.append(Miss(ours, way, "translation", measured, expected, gauge))
        if ours.role == "joint" or (ours.role == "foot" and orientation):
            R = gauge[:3, :3] @ ours.X_M[:3, :3]
            wanted = theirs.X_M[:3, :3]
            if np.abs(R - wanted).max() > NEAR:
                found.append(Miss(ours, ours.way, "rotation", R, wanted, gauge))
    return found


def _before(place: Place, pairs: list[Pair]) -> Pair | None:
    """Return the last place with a counterpart on the way to a place."""
    sids = [passed.sid for passed in place.way]
    on_way = [
        pair
        for pair in pairs
        if pair[0] is not place
        and 0 < len(pair[0].way) < len(sids)
        and [passed.sid for passed in pair[0].way] == sids[: len(pair[0].way)]
    ]
    return max(on_way, key=lambda pair: len(pair[0].way), default=None)
