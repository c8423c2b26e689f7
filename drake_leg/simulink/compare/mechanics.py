"""What differs in two mechanisms: joints, bodies, solids, and between what sensors measure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.alignment import NEAR, AlignedBody, Miss
from drake_leg.simulink.compare.findings import (
    Check,
    Verdict,
    check,
    differences,
    different,
    extra,
    matched,
    missing,
)
from drake_leg.simulink.compare.graph import GraphJoint, Passed, Place, SolidFacts
from drake_leg.simulink.compare.mechanisms import Mechanisms
from drake_leg.simulink.compare.of_model import SENSORS
from drake_leg.simulink.mechanism import rotation_text
from drake_leg.simulink.model import Block

UNITS = {  # of a turning joint's parameters, and of a sliding one's
    "SpringStiffness": ("N*m/rad", "N/m"),
    "DampingCoefficient": ("N*m*s/rad", "N*s/m"),
    "EquilibriumPosition": ("rad", "m"),
    "PositionTargetValue": ("rad", "m"),
    "VelocityTargetValue": ("rad/s", "m/s"),
    "Bound": ("rad", "m"),
    "Stiffness": ("N*m/rad", "N/m"),
    "Damping": ("N*m*s/rad", "N*s/m"),
    "TransitionRegionWidth": ("rad", "m"),
}
DEFAULTS = {"JointMode": "Normal"}
DIMENSIONS = {
    "brick": ("BrickDimensions",),
    "cylinder": ("CylinderRadius", "CylinderLength"),
    "sphere": ("SphereRadius",),
}
GOALS = {
    "joint": "the next joint",
    "foot": "the sensed frame",
    "sensor": "the sensor's base",
    "solid": "the solid",
    "loop base": "the joint that closes a loop",
    "loop follower": "the joint that closes a loop",
}
LEADS_TO = {
    "solid": "center of body",
    "joint": "frame of joint",
    "foot": "frame",
    "sensor": "frame",
    "loop base": "frame of joint",
    "loop follower": "frame of joint",
}
METHODS = {
    "StandardAxis": "TranslationStandardOffset",
    "Cartesian": "TranslationCartesianOffset",
    "Cylindrical": "translation",
    "None": "TranslationCartesianOffset",
}
PLACED = ("sm_lib/Body Elements/", "sm_lib/Joints/")  # what has a place in a mechanism
UNPLACED = ("Graphic", "Inertia Sensor", "Variable Mass")
SAME_INERTIA = 1e-6  # of the greatest moment
NOWHERE = "it is connected to nothing that leads to the World Frame"


def compare_mechanism(sides: Mechanisms) -> Iterator[Verdict]:
    """Compare the joints, and the bodies that are aligned already."""
    by_number = {joint.number: joint for joint in sides.ours.joints}
    for number in sides.alignment.exchanged:
        joint = by_number[number]
        yield different(
            joint.sid, joint.name, "base and follower", "exchanged", "base towards the world"
        )
    for joint in sides.ours.joints:
        yield from _compare_joint(joint, sides.counterpart(joint), sides)
    for joint in sides.ours.loops:
        yield from _compare_joint(joint, _loop_of(sides, joint), sides)
    yield from _further_joints(sides)
    for miss in (miss for body in sides.alignment.bodies for miss in body.misses):
        yield _misplaced(miss, sides)
    for body in sides.alignment.bodies:
        yield from _compare_body(body, sides)
    yield from _absent_solids(sides)
    for sid, number in sides.body_of.items():
        yield missing(sides.block(sid), _why_lost(sides, number))
    if not sides.matching.is_grounded:
        yield different("", "(model)", "World Frame", "not at the chain", "at the chain's base")
    for block in sides.blocks.values():
        if _is_mechanical(block):
            yield missing(block, NOWHERE)


def _is_mechanical(block: Block) -> bool:
    """Tell whether a block is a solid, a transform or a joint, which has a place in a mechanism."""
    placed = block.kind == "Rigid Transform" or block.source.startswith(PLACED)
    return placed and block.kind not in (*SENSORS, *UNPLACED)


def _further_joints(sides: Mechanisms) -> Iterator[Verdict]:
    """List joints that only the other side has; one between joints of ours is a difference."""
    ours = {joint.number: joint for joint in sides.ours.joints}
    counterparts = {theirs: ours[number] for number, theirs in sides.matching.joints.items()}
    for theirs in sides.theirs.joints:
        if theirs.number in counterparts:
            continue
        yield extra("joint", name=theirs.name)
        for after in sides.theirs.children[theirs.child]:
            if after.number in counterparts:
                joint = counterparts[after.number]
                lacking = f"{theirs.type} joint {theirs.name!r}"
                yield different(joint.sid, joint.name, "joint before it", "none", lacking)
    loops = set(sides.matching.loops.values())
    for theirs in sides.theirs.loops:
        if theirs.number not in loops:
            yield extra("joint", name=theirs.name)


def _compare_body(body: AlignedBody, sides: Mechanisms) -> Iterator[Verdict]:
    """Compare a body's solids, and name what the transforms on it lead to."""
    seen: set[str] = set()
    for ours, theirs in body.pairs:
        yield from _compare_solid(ours, theirs, body.gauge, sides)
    for ours, theirs in sorted(body.pairs, key=_length_of_way):
        here = ours.way
        while here is not None and here.sid not in seen:
            seen.add(here.sid)
            yield matched(sides.block(here.sid), f"{LEADS_TO[ours.role]} {theirs.name!r}")
            here = here.after
    where = sides.theirs.name_of(body.theirs)
    for place in body.unmatched:
        yield missing(sides.block(place.sid), f"{where} has no such solid in {sides.other}")


def _length_of_way(pair: tuple[Place, Place]) -> int:
    return pair[0].way.depth if pair[0].way else 0


def _absent_solids(sides: Mechanisms) -> Iterator[Verdict]:
    """State that a joint's follower lacks solids that its counterpart has."""
    for body in sides.alignment.bodies:
        joint = sides.ours.inbound.get(body.ours)
        for place in body.absent:
            if place.solid is not None:
                sid, name = (joint.sid, joint.name) if joint else ("", "(model)")
                mass = f"body {place.name!r} of {place.solid.mass:.6g} kg"
                what = "solid on its follower" if joint else "solid on the world"
                yield different(sid, name, what, "none", mass)


def _why_lost(sides: Mechanisms, body: int) -> str:
    """Say why a block of one of our bodies has no counterpart."""
    if body in sides.matching.bodies:
        return f"what it leads to has no counterpart in {sides.other}"
    head = sides.branches.get(body)
    return NOWHERE if head is None else _on_branch(sides, head)


def _on_branch(sides: Mechanisms, head: GraphJoint) -> str:
    return (
        f"it is on the branch of {head.name!r} (SID {head.sid}), which {sides.other} does not have"
    )


def compare_sensors(sides: Mechanisms) -> Iterator[Verdict]:
    """Compare between which bodies sensors measure."""
    bodies = sides.matching.bodies
    for a, b in sides.matching.sensors.items():
        ours, theirs = sides.ours.sensors[a], sides.theirs.sensors[b]
        block = sides.block(ours.sid)
        ends = ours.base, ours.foot
        if a in sides.matching.turned:
            yield different(
                block.sid, block.name, "base and follower", "exchanged", "base at the world"
            )
            ends = ours.foot, ours.base
        for what, mine, other in zip(
            ("link that it measures from", "link that is sensed"),
            ends,
            (theirs.base, theirs.foot),
            strict=True,
        ):
            if bodies.get(mine) != other:
                here, there = sides.ours.name_of(mine), sides.theirs.name_of(other)
                yield different(block.sid, block.name, what, here, there)


def _compare_joint(
    ours: GraphJoint, theirs: GraphJoint | None, sides: Mechanisms
) -> Iterator[Verdict]:
    """Compare a joint of the tree, or one that closes a loop, with its counterpart.

    Of joints of two kinds, only what both have is compared.
    """
    block = sides.block(ours.sid)
    if theirs is None:
        yield missing(block, _why_no_joint(sides, ours))
        return
    checks = [check(block, "type", ours.type, theirs.type)]
    names = dict.fromkeys([*ours.parameters, *theirs.parameters])
    if ours.type != theirs.type:
        names = {name: None for name in ours.parameters if name in theirs.parameters}
    for name in names:
        if "TargetValue" in name and not _counts(ours, theirs, name):
            continue
        default: float | str = DEFAULTS.get(name, "none" if "Limit" in name else 0.0)
        mine, other = (joint.parameters.get(name, default) for joint in (ours, theirs))
        checks.append(check(block, name, mine, other, unit=_unit_of(ours, name)))
    yield from differences(*checks)
    yield matched(block, f"joint {theirs.name!r}", parameters=[each.item for each in checks])


def _loop_of(sides: Mechanisms, ours: GraphJoint) -> GraphJoint | None:
    number = sides.matching.loops.get(ours.number)
    return None if number is None else sides.theirs.loops[number]


def _why_no_joint(sides: Mechanisms, ours: GraphJoint) -> str:
    """Say why a joint has no counterpart."""
    head = sides.branches.get(ours.child)
    if head is not None and head.number != ours.number:
        return _on_branch(sides, head)
    if ours in sides.ours.loops:
        return f"it closes a loop, which {sides.other} does not have"
    if ours.parent not in sides.matching.bodies:
        return NOWHERE
    if any(joint.number in sides.matching.joints for joint in sides.ours.children[ours.child]):
        return f"it is a joint too many: {sides.other} has those before and after it"
    joints = len(sides.theirs.joints)
    return f"{sides.other} has only {joints} joint{'' if joints == 1 else 's'}, and no such branch"


def _unit_of(joint: GraphJoint, name: str) -> str:
    """Return the unit of a parameter, by what its degree of freedom does."""
    slides = joint.type == "prismatic"
    for prefix in ("Px", "Py", "Pz", "Rx", "Ry", "Rz", "Sph"):
        if name.startswith(prefix):
            name, slides = name.removeprefix(prefix), prefix[0] == "P"
            break
    plain = name.removeprefix("LowerLimit").removeprefix("UpperLimit")
    return UNITS.get(plain, ("", ""))[slides]


def _counts(ours: GraphJoint, theirs: GraphJoint, target: str) -> bool:
    """Tell whether a state target counts: a motion overrides one of low priority."""
    driven = theirs.parameters.get("MotionActuationMode") == "InputMotion"
    priority = ours.priorities.get(f"{target.removesuffix('Value')}Priority")
    return not driven or (target in ours.parameters and priority == "High")


def _misplaced(miss: Miss, sides: Mechanisms) -> Verdict:
    """State that a place is elsewhere, by the transforms that lead there."""
    way = miss.way
    if miss.what == "rotation":
        turning = tuple(t for t in way if np.abs(t.X_BF[:3, :3] - np.eye(3)).max() > NEAR)
        way = turning or way
    if len(way) == 1:
        (passed,) = way
        name, both = _parameter(miss, passed), _stated(miss, passed)
    else:
        name = f"{miss.what} from the joint to {GOALS[miss.place.role]}"
        both = miss.measured, miss.expected
    sids = dict.fromkeys([passed.sid for passed in way] or [miss.place.sid])
    sid, names = ", ".join(sids), ", ".join(sides.block(one).name for one in sids)
    if miss.what == "rotation":
        return different(sid, names, name, *map(rotation_text, both))
    return different(sid, names, name, *map(_rounded, both), unit="m")


def _parameter(miss: Miss, passed: Passed) -> str:
    if miss.what == "rotation":
        return "rotation"
    if passed.method not in METHODS:
        return "a frame of its own"
    return METHODS[passed.method]


def _stated(miss: Miss, passed: Passed) -> tuple[Array, Array]:
    """Bring what is and what should be into the axes in which the block states it."""
    R_before = miss.gauge[:3, :3] @ passed.X_before[:3, :3]
    R_BF = passed.X_BF[:3, :3]
    wanted = R_before.T @ miss.expected
    if miss.what == "rotation":
        return R_BF, wanted.T if passed.back else wanted
    return passed.X_BF[:3, 3], -R_BF @ wanted if passed.back else wanted


def _rounded(vector: Array) -> tuple[float, ...]:
    return tuple(float(round(value, 12)) + 0.0 for value in vector.tolist())


def _compare_solid(
    ours: Place, theirs: Place, gauge: Array, sides: Mechanisms
) -> Iterator[Verdict]:
    """Compare two solids; ``gauge`` is the pose of our frame M in theirs."""
    if ours.solid is None or theirs.solid is None:
        return
    mine, other, block = ours.solid, theirs.solid, sides.block(ours.sid)
    R = theirs.X_M[:3, :3].T @ gauge[:3, :3] @ ours.X_M[:3, :3]  # our axes in theirs
    checks = _check_mass(mine, other, R, block)
    if "other" in (mine.shape, other.shape):
        pass
    elif mine.shape != other.shape:
        checks.append(check(block, "shape", mine.shape, other.shape))
    elif mine.shape == "brick":
        size = _extents(gauge[:3, :3] @ ours.X_M[:3, :3], mine.size)
        checks += _check_brick(size, _extents(theirs.X_M[:3, :3], other.size), block)
    elif mine.shape in DIMENSIONS:
        checks += [
            check(block, name, a, b, unit="m", counts=name == "CylinderLength")
            for name, a, b in zip(DIMENSIONS[mine.shape], mine.size, other.size, strict=True)
        ]
    else:
        checks.append(check(block, "dimensions", mine.size, other.size, unit="m"))
    if mine.colour and other.colour:
        name = "GraphicDiffuseColor"
        checks.append(check(block, name, mine.colour, other.colour, counts=False))
    yield from differences(*checks)
    yield matched(block, f"body {theirs.name!r}", parameters=[each.item for each in checks])


def _check_mass(mine: SolidFacts, other: SolidFacts, R: Array, block: Block) -> list[Check]:
    """Compare densities where both are stated, else masses and given inertias."""
    if mine.density is not None:
        if other.density is None:
            return _check_inertia(mine, other, R, block) if not other.homogeneous else []
        return [check(block, "Density", mine.density, other.density, unit="kg/m^3")]
    checks = [check(block, "Mass", mine.mass, other.mass, unit="kg")]
    if not (mine.homogeneous and other.homogeneous):
        checks += _check_inertia(mine, other, R, block)
    return checks


def _check_inertia(mine: SolidFacts, other: SolidFacts, R: Array, block: Block) -> list[Check]:
    """Compare moments and products about the center of mass, in the axes of our solid."""
    live = R.T @ other.inertia @ R
    greatest = max(np.abs(mine.inertia).max(), np.abs(live).max())
    if np.abs(mine.inertia - live).max() <= SAME_INERTIA * greatest:
        live = mine.inertia
    checks = [check(block, "MomentsOfInertia", *map(_moments, (mine.inertia, live)), unit="kg*m^2")]
    products = [_products(inertia) for inertia in (mine.inertia, live)]
    if products[0] != products[1]:
        checks.append(check(block, "ProductsOfInertia", *products, unit="kg*m^2"))
    return checks


def _moments(inertia: Array) -> tuple[float, ...]:
    return tuple(np.diag(inertia).tolist())


def _products(inertia: Array) -> tuple[float, ...]:
    return float(inertia[1, 2]), float(inertia[0, 2]), float(inertia[0, 1])


def _check_brick(size: Array, wanted: Array, block: Block) -> list[Check]:
    """Compare the edge along the link, which counts, and the cross section, which does not."""
    along = int(np.argmax(wanted))
    across = [axis for axis in range(3) if axis != along]
    mine, drake = (tuple(edges[across].tolist()) for edges in (size, wanted))
    return [
        check(block, "length", float(size[along]), float(wanted[along]), unit="m"),
        check(block, "cross section", mine, drake, unit="m", counts=False),
    ]


def _extents(R: Array, size: tuple[float, ...]) -> Array:
    """Edges of a brick along the axes of another frame."""
    turned: Array = np.abs(R) @ np.array(size)
    return turned
