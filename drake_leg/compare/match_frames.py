"""The links of both sides, laid beside each other frame by frame.

Both chains are compared link by link, in the frame of the joint that carries the link, so that
one wrong offset is one difference and not one for every link behind it. Where a joint's two
frames are turned about its axis, or moved along it, by the same amount on both of its sides,
nothing moves differently; this freedom is taken up before links are compared.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drake_leg.compare.findings import Findings
from drake_leg.compare.mechanism import Mechanism, Place, Step
from drake_leg.kinematics.batches import Array
from drake_leg.simulink.model import Block
from drake_leg.simulink.poses import inverse, rotation_text

NEAR = 1e-9  # [m] or of a rotation's entries
GOALS = {"joint": "the next joint", "foot": "the sensed frame", "solid": "the solid"}

Pair = tuple[Place, Place]  # the model's, the plant's


@dataclass(frozen=True)
class Miss:
    """A place that is not where it is in the plant."""

    place: Place
    steps: tuple[Step, ...]
    what: str  # "translation", "rotation"
    measured: Array  # displacement or rotation in the plant's frame M
    expected: Array
    gauge: Array


@dataclass(kw_only=True)
class Alignment:
    """Both chains beside each other."""

    pairs: list[list[Pair]] = field(default_factory=list)  # of each body
    gauges: list[Array] = field(default_factory=list)  # of each body: the model's M in the plant's
    misses: list[Miss] = field(default_factory=list)
    unmatched: list[tuple[int, Place]] = field(default_factory=list)  # the model's solids
    absent: list[tuple[int, Place]] = field(default_factory=list)  # the plant's solids


def align(simulink: Mechanism, drake: Mechanism, *, orientation: bool) -> Alignment:
    """Lay two chains beside each other.

    Parameters
    ----------
    simulink, drake : Mechanism
        Of the model and of the plant.
    orientation : bool
        Whether the foot's orientation is sensed, so that it matters.
    """
    found = Alignment()
    gauge = np.eye(4)
    bodies = list(zip(simulink.bodies, drake.bodies, strict=False))
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
        found.misses += misses
        gauge = following
    return found


def report(alignment: Alignment, blocks: dict[str, Block], findings: Findings) -> None:
    """Note every place that is elsewhere, by the transforms that lead there.

    Parameters
    ----------
    blocks : dict
        The model's blocks by SID.
    findings : Findings
        What is found is noted there.
    """
    for miss in alignment.misses:
        steps = miss.steps
        if miss.what == "rotation":
            turning = tuple(s for s in steps if np.abs(s.X_BF[:3, :3] - np.eye(3)).max() > NEAR)
            steps = turning or steps
        if len(steps) == 1:
            _report_one(miss, steps[0], findings)
        else:
            _report_many(miss, steps, blocks, findings)


def _pairs(simulink: tuple[Place, ...], drake: tuple[Place, ...]) -> list[Pair]:
    """Find for every place of a body the plant's one of the same role.

    Solids of the same shape come first, then the nearest, whoever is drawn first.
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
    return len(shapes) > 1, _distance(*pair)


def _distance(a: Place, b: Place) -> float:
    return float(np.linalg.norm(a.X_M[:3, 3] - b.X_M[:3, 3]))


def _about_z(D: Array) -> bool:
    """Tell whether a pose only turns about the z axis and moves along it."""
    along = abs(D[0, 3]) < NEAR and abs(D[1, 3]) < NEAR
    return bool(along and abs(D[2, 2] - 1.0) < NEAR)


def _misses(pairs: list[tuple[Place, Place]], gauge: Array, *, orientation: bool) -> list[Miss]:
    found = []
    for ours, theirs in pairs:
        before = _before(ours, pairs)
        measured, expected = (gauge @ ours.X_M)[:3, 3], theirs.X_M[:3, 3]
        if before:
            measured = measured - (gauge @ before[0].X_M)[:3, 3]
            expected = expected - before[1].X_M[:3, 3]
        steps = ours.way[len(before[0].way) if before else 0 :]
        if np.abs(measured - expected).max() > NEAR:
            found.append(Miss(ours, steps, "translation", measured, expected, gauge))
        if ours.role == "joint" or (ours.role == "foot" and orientation):
            R = gauge[:3, :3] @ ours.X_M[:3, :3]
            wanted = theirs.X_M[:3, :3]
            if np.abs(R - wanted).max() > NEAR:
                found.append(Miss(ours, ours.way, "rotation", R, wanted, gauge))
    return found


def _before(place: Place, pairs: list[tuple[Place, Place]]) -> tuple[Place, Place] | None:
    """Return the last place with a counterpart on the way to a place."""
    sids = [step.sid for step in place.way]
    on_way = [
        pair
        for pair in pairs
        if pair[0] is not place
        and len(pair[0].way) < len(sids)
        and pair[0].way
        and [step.sid for step in pair[0].way] == sids[: len(pair[0].way)]
    ]
    return max(on_way, key=lambda pair: len(pair[0].way), default=None)


def _report_one(miss: Miss, step: Step, findings: Findings) -> None:
    typed, wanted = _typed(miss, step)
    if miss.what == "rotation":
        both = rotation_text(typed), rotation_text(wanted)
        findings.differ(step.sid, step.name, "rotation", *both)
        return
    standard = step.method == "StandardAxis"
    name = f"Translation{'Standard' if standard else 'Cartesian'}Offset"
    findings.differ(step.sid, step.name, name, _rounded(typed), _rounded(wanted), unit="m")


def _report_many(
    miss: Miss, steps: tuple[Step, ...], blocks: dict[str, Block], findings: Findings
) -> None:
    named: list[Step | Block] = [*steps] or [blocks[miss.place.sid]]
    sid, name = (", ".join(getattr(one, part) for one in named) for part in ("sid", "name"))
    what = f"{miss.what} from the joint to {GOALS[miss.place.role]}"
    if miss.what == "rotation":
        both = rotation_text(miss.measured), rotation_text(miss.expected)
        findings.differ(sid, name, what, *both)
    else:
        both_places = _rounded(miss.measured), _rounded(miss.expected)
        findings.differ(sid, name, what, *both_places, unit="m")


def _typed(miss: Miss, step: Step) -> tuple[Array, Array]:
    """Bring what is and what should be into the axes in which the block states it."""
    R_before = miss.gauge[:3, :3] @ step.X_before[:3, :3]
    R_BF = step.X_BF[:3, :3]
    if miss.what == "rotation":
        wanted = R_before.T @ miss.expected
        return R_BF, wanted.T if step.back else wanted
    wanted = R_before.T @ miss.expected
    return step.X_BF[:3, 3], -R_BF @ wanted if step.back else wanted


def _rounded(vector: Array) -> tuple[float, ...]:
    return tuple(float(round(value, 12)) + 0.0 for value in vector.tolist())
