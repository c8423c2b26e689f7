"""The mechanical half: joints, links, frames and gravity of both sides, one by one.

Both chains are compared link by link, in the frame of the joint that carries the link, so that
one wrong offset is one difference and not one for every link behind it. Where a joint's two
frames are turned about its axis, or moved along it, by the same amount on both of its sides,
nothing moves differently; this freedom is taken up before links are compared.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_leg.compare.findings import Findings
from drake_leg.compare.mechanism import Joint, Mechanism, Place, Step
from drake_leg.compare.plant_mechanism import reshaped
from drake_leg.compare.poses import inverse, rotation_text
from drake_leg.compare.simulink_mechanism import Network
from drake_leg.kinematics.batches import Array
from drake_leg.simulink.model import Block

NEAR = 1e-9  # [m] or of a rotation's entries
UNITS = {
    "SpringStiffness": "N*m/rad",
    "DampingCoefficient": "N*m*s/rad",
    "EquilibriumPosition": "rad",
    "PositionTargetValue": "rad",
    "VelocityTargetValue": "rad/s",
    "LowerLimitBound": "rad",
    "UpperLimitBound": "rad",
}


@dataclass(frozen=True, kw_only=True)
class _Miss:
    """A place that is not where it is in the plant."""

    place: Place
    steps: tuple[Step, ...]
    what: str  # "translation", "rotation"
    measured: Array  # displacement or rotation in the plant's frame M
    expected: Array


def match_mechanism(
    network: Network,
    drake: Mechanism,
    blocks: dict[str, Block],
    findings: Findings,
    *,
    orientation: bool,
) -> None:
    """Compare the two chains.

    Parameters
    ----------
    network : Network
        Of the model.
    drake : Mechanism
        Of the live plant.
    blocks : dict
        The model's blocks by SID.
    findings : Findings
        What is found is noted there.
    orientation : bool
        Whether the foot's orientation is sensed, so that it matters.
    """
    simulink = network.mechanism
    _match_joints(simulink.joints, drake.joints, blocks, findings)
    gauge = np.eye(4)
    every: list[tuple[Place, Place]] = []
    for body in range(min(len(simulink.bodies), len(drake.bodies))):
        pairs = _pairs(simulink.bodies[body], drake.bodies[body], blocks, findings)
        every += pairs
        misses = _misses(pairs, gauge, orientation=orientation)
        turned = next((p for p in pairs if p[0].role == "joint"), None)
        following = np.eye(4)
        if turned is not None and body + 1 < len(drake.bodies) and _is_gauge(turned, gauge):
            D = inverse(turned[1].X_M) @ gauge @ turned[0].X_M
            beyond = _pairs(simulink.bodies[body + 1], drake.bodies[body + 1], blocks, None)
            folded = _misses(beyond, D, orientation=orientation)
            unfolded = _misses(beyond, np.eye(4), orientation=orientation)
            own = [miss for miss in misses if miss.place is turned[0]]
            if len(folded) < len(unfolded) + len(own):
                following = D
                misses = [miss for miss in misses if miss.place is not turned[0]]
        for miss in misses:
            _report(miss, gauge, blocks, findings)
        for ours, theirs in pairs:
            if ours.shape is not None:
                _match_solid(ours, theirs, gauge, blocks[ours.sid], findings)
        gauge = following
    _match_transforms(network, every, blocks, findings)


def _match_joints(
    simulink: tuple[Joint, ...],
    drake: tuple[Joint, ...],
    blocks: dict[str, Block],
    findings: Findings,
) -> None:
    for ours in simulink:
        block = blocks[ours.sid]
        if ours.number > len(drake):
            findings.miss(block, f"the Drake model has {len(drake)} joints only")
            continue
        theirs = drake[ours.number - 1]
        checked = [findings.check(block, "type", ours.type, theirs.type)]
        names = [*ours.parameters, *(n for n in theirs.parameters if n not in ours.parameters)]
        for name in names:
            if name.endswith("TargetValue") and name not in theirs.parameters:
                continue  # a joint that follows a motion starts on it
            default: float | str = 0.0 if not name.endswith("Bound") else "none"
            checked.append(
                findings.check(
                    block,
                    name,
                    ours.parameters.get(name, default),
                    theirs.parameters.get(name, default),
                    unit=UNITS.get(name, ""),
                )
            )
        findings.match(block, f"joint {theirs.name!r}", parameters=checked)
    for theirs in drake[len(simulink) :]:
        findings.comparison.extra.append({"what": "joint", "name": theirs.name})


def _pairs(
    simulink: tuple[Place, ...],
    drake: tuple[Place, ...],
    blocks: dict[str, Block],
    findings: Findings | None,
) -> list[tuple[Place, Place]]:
    """Find for every place of a body the plant's one of the same role."""
    pairs = []
    rest = list(drake)
    for ours in sorted(simulink, key=lambda place: place.role != "joint"):
        candidates = [p for p in rest if p.role == ours.role and p.number == ours.number]
        if not candidates:
            if findings and ours.role == "solid":
                findings.miss(blocks[ours.sid], "the Drake link has no further solid")
            continue
        nearest = min(candidates, key=lambda p: _distance(p, ours))
        rest.remove(nearest)
        pairs.append((ours, nearest))
    if findings:
        findings.comparison.extra.extend(
            {"what": "solid", "name": place.name} for place in rest if place.role == "solid"
        )
    return pairs


def _distance(a: Place, b: Place) -> float:
    return float(np.linalg.norm(a.X_M[:3, 3] - b.X_M[:3, 3]))


def _is_gauge(pair: tuple[Place, Place], gauge: Array) -> bool:
    """Tell whether two joint frames differ only about and along their common axis."""
    D = inverse(pair[1].X_M) @ gauge @ pair[0].X_M
    along = abs(D[0, 3]) < NEAR and abs(D[1, 3]) < NEAR
    return bool(along and abs(D[2, 2] - 1.0) < NEAR)


def _misses(pairs: list[tuple[Place, Place]], gauge: Array, *, orientation: bool) -> list[_Miss]:
    found = []
    for ours, theirs in pairs:
        before = _before(ours, pairs)
        measured, expected = (gauge @ ours.X_M)[:3, 3], theirs.X_M[:3, 3]
        if before:
            measured = measured - (gauge @ before[0].X_M)[:3, 3]
            expected = expected - before[1].X_M[:3, 3]
        steps = ours.way[len(before[0].way) if before else 0 :]
        if np.abs(measured - expected).max() > NEAR:
            found.append(
                _Miss(
                    place=ours,
                    steps=steps,
                    what="translation",
                    measured=measured,
                    expected=expected,
                )
            )
        if ours.role == "joint" or (ours.role == "foot" and orientation):
            R = gauge[:3, :3] @ ours.X_M[:3, :3]
            if np.abs(R - theirs.X_M[:3, :3]).max() > NEAR:
                found.append(
                    _Miss(
                        place=ours,
                        steps=ours.way,
                        what="rotation",
                        measured=R,
                        expected=theirs.X_M[:3, :3],
                    )
                )
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


def _report(miss: _Miss, gauge: Array, blocks: dict[str, Block], findings: Findings) -> None:
    steps = miss.steps
    if miss.what == "rotation":
        turning = tuple(s for s in steps if np.abs(s.X_BF[:3, :3] - np.eye(3)).max() > NEAR)
        steps = turning or steps
    if len(steps) == 1:
        step = steps[0]
        typed, wanted = _typed(miss, step, gauge)
        if miss.what == "rotation":
            findings.differ(
                step.sid, step.name, "rotation", rotation_text(typed), rotation_text(wanted)
            )
        else:
            name = {"StandardAxis": "TranslationStandardOffset"}.get(
                step.method, "TranslationCartesianOffset"
            )
            findings.differ(step.sid, step.name, name, _rounded(typed), _rounded(wanted), unit="m")
        return
    if steps:
        sid = ", ".join(step.sid for step in steps)
        name = ", ".join(step.name for step in steps)
    else:
        block = blocks[miss.place.sid]
        sid, name = block.sid, block.name
    goal = {"joint": "the next joint", "foot": "the sensed frame", "solid": "the solid"}
    what = f"{miss.what} from the joint to {goal[miss.place.role]}"
    if miss.what == "rotation":
        both = rotation_text(miss.measured), rotation_text(miss.expected)
        findings.differ(sid, name, what, *both)
    else:
        findings.differ(sid, name, what, _rounded(miss.measured), _rounded(miss.expected), unit="m")


def _typed(miss: _Miss, step: Step, gauge: Array) -> tuple[Array, Array]:
    """Bring what is and what should be into the axes in which the block states it."""
    R_before = gauge[:3, :3] @ step.X_before[:3, :3]
    R_BF = step.X_BF[:3, :3]
    if miss.what == "rotation":
        wanted = R_before.T @ miss.expected
        return R_BF, wanted.T if step.back else wanted
    wanted = R_before.T @ miss.expected
    return step.X_BF[:3, 3], -R_BF @ wanted if step.back else wanted


def _rounded(vector: Array) -> tuple[float, ...]:
    return tuple(float(round(value, 12)) + 0.0 for value in vector.tolist())


def _match_solid(
    ours: Place, theirs: Place, gauge: Array, block: Block, findings: Findings
) -> None:
    if ours.shape is None or theirs.shape is None:
        return
    checked = []
    kind = ours.shape.kind
    if kind == "other":
        checked.append(findings.check(block, "Mass", ours.shape.mass, theirs.shape.mass, unit="kg"))
        findings.match(block, f"body {theirs.name!r}", parameters=checked)
        return
    shape = reshaped(theirs.shape, kind)
    checked.append(
        findings.check(block, "Density", ours.shape.density, shape.density, unit="kg/m^3")
    )
    if kind == "brick":
        size = _extents(gauge[:3, :3] @ ours.X_M[:3, :3], ours.shape.size)
        wanted = _extents(theirs.X_M[:3, :3], shape.size)
        along = int(np.argmax(wanted))
        across = [axis for axis in range(3) if axis != along]
        checked += [
            findings.check(block, "length", float(size[along]), float(wanted[along]), unit="m"),
            findings.check(
                block,
                "cross section",
                tuple(size[across].tolist()),
                tuple(wanted[across].tolist()),
                unit="m",
                counts=False,
            ),
        ]
    elif kind == "cylinder":
        (radius, length), (wanted_radius, wanted_length) = ours.shape.size, shape.size
        checked += [
            findings.check(block, "CylinderLength", length, wanted_length, unit="m"),
            findings.check(block, "CylinderRadius", radius, wanted_radius, unit="m", counts=False),
        ]
    else:
        checked.append(
            findings.check(
                block, "SphereRadius", ours.shape.size[0], shape.size[0], unit="m", counts=False
            )
        )
    if ours.shape.colour and theirs.shape.colour:
        checked.append(
            findings.check(
                block, "GraphicDiffuseColor", ours.shape.colour, theirs.shape.colour, counts=False
            )
        )
    findings.match(block, f"body {theirs.name!r}", parameters=checked)


def _extents(R: Array, size: tuple[float, ...]) -> Array:
    """Edges of a brick along the axes of another frame."""
    turned: Array = np.abs(R) @ np.array(size)
    return turned


def _match_transforms(
    network: Network,
    pairs: list[tuple[Place, Place]],
    blocks: dict[str, Block],
    findings: Findings,
) -> None:
    """Name what every Rigid Transform leads to."""
    goal = {"solid": "centre of body", "joint": "frame of joint", "foot": "frame"}
    for ours, theirs in sorted(pairs, key=lambda pair: len(pair[0].way)):
        for step in ours.way:
            findings.match(blocks[step.sid], f"{goal[ours.role]} {theirs.name!r}")
    for sid in network.loose:
        findings.miss(blocks[sid], "it is connected to nothing that leads to the World Frame")
    for sid, why in network.unknown.items():
        findings.miss(blocks[sid], why)
