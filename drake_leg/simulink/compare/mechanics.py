"""What differs in the mechanisms: joints, links, solids, the sensor, gravity, the run's times."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pydrake.multibody.tree import FrameIndex

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.findings import (
    Blocks,
    Check,
    Verdict,
    check,
    differences,
    different,
    extra,
    matched,
    missing,
)
from drake_leg.simulink.compare.of_diagram import ChainJoint, Links, PassedTransform, Place
from drake_leg.simulink.compare.sides import NEAR, Miss, Sides
from drake_leg.simulink.mechanism import DIMENSIONS, OTHER, SolidProperties, rotation_text
from drake_leg.simulink.model import Block, vector
from drake_leg.systems.frame_sensor import FrameSensor

UNITS = {  # of a revolute joint's parameters, and of a prismatic one's
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
GOALS = {"joint": "the next joint", "foot": "the sensed frame", "solid": "the solid"}
LEADS_TO = {"solid": "center of body", "joint": "frame of joint", "foot": "frame"}
SAME_PLACE = 1e-9  # [m]
ZERO = (0.0, 0.0, 0.0)


def compare_mechanism(sides: Sides) -> Iterator[Verdict]:
    """Compare the joints, and the links that are aligned already."""
    chain, drake, links = sides.chain, sides.drake, sides.links
    joints, bodies = chain.mechanism.joints, chain.mechanism.bodies
    for number in chain.exchanged:
        joint = joints[number - 1]
        yield different(
            joint.sid, joint.name, "base and follower", "exchanged", "base towards the world"
        )
    for ours in joints:
        yield from _compare_joint(ours, drake.joints, sides.block(ours.sid))
    for theirs in drake.joints[len(joints) :]:
        yield extra("joint", name=theirs.name)
    for miss in (miss for link in links for miss in link.misses):
        yield _misplaced(miss, sides)
    for link in links:
        for ours_at, theirs_at in link.pairs:
            yield from _compare_solid(ours_at, theirs_at, link.gauge, sides)
        for ours_at, theirs_at in sorted(link.pairs, key=lambda pair: len(pair[0].way)):
            leads_to = f"{LEADS_TO[ours_at.role]} {theirs_at.name!r}"
            yield from (matched(sides.block(passed.sid), leads_to) for passed in ours_at.way)
    for body, link in enumerate(links):
        where = f"the link of joint {drake.joints[body - 1].name!r}" if body else "the world"
        for place in link.unmatched:
            yield missing(sides.block(place.sid), f"{where} has no such solid in Drake")
    for joint, link in zip(joints, links[1:], strict=False):
        for place in link.absent:
            if place.solid is not None:
                mass = f"body {place.name!r} of {place.solid.mass:.6g} kg"
                yield different(joint.sid, joint.name, "solid on its follower", "none", mass)
    ways = (place.way for places in bodies for place in places)
    for sid in dict.fromkeys(passed.sid for way in ways for passed in way):
        yield missing(sides.block(sid), "what it leads to has no counterpart in Drake")
    if joints and not chain.grounded:
        yield different("", "(model)", "World Frame", "not at the chain", "at the chain's base")
    for sid, why in chain.unplaced.items():
        yield missing(sides.block(sid), why)


def compare_sensor(sides: Sides) -> Iterator[Verdict]:
    """Compare the sensor of the foot."""
    chain = sides.chain
    if chain.sensor is None:
        return
    block = sides.block(chain.sensor)
    names = sides.live.of_type(FrameSensor)
    if not names:
        yield missing(block, "the diagram senses no frame against another")
        return
    if chain.sensor_turned:
        yield different(
            block.sid, block.name, "base and follower", "exchanged", "base at the world"
        )
    ours, theirs = (
        next(i for i, places in enumerate(bodies) if any(p.role == "foot" for p in places))
        for bodies in (chain.mechanism.bodies, sides.drake.bodies)
    )
    link = "link that is sensed, counted from the base"
    yield from differences(check(block, link, float(ours), float(theirs)))
    seen_from = str(block.parameters.get("MeasurementFrame", "World"))
    if block.kind == "Transform Sensor" and seen_from not in ("World", "Base"):
        yield different(block.sid, block.name, "MeasurementFrame", seen_from, "World")
    for name, value in block.parameters.items():
        acts = any(name.endswith(what) for what in ("SpringStiffness", "DampingCoefficient"))
        if acts and "Limit" not in name and any(vector(value)):
            yield different(block.sid, block.name, name, value, 0.0)
        if name.endswith("ActuationMode") and str(value).startswith("Input"):
            yield different(block.sid, block.name, name, value, "none")
    yield matched(block, repr(names[0]), names)


def compare_settings(sides: Sides) -> Iterator[Verdict]:
    """Compare gravity and the times of the run; name the counterparts of world and solver."""
    live_gravity = tuple(sides.plant.gravity_field().gravity_vector().tolist())
    name, scheme, duration = sides.plant.get_name(), sides.run.scheme, sides.run.duration
    has_gravity = has_solver = False
    for block in sides.flat.blocks:
        if block.kind == "World Frame":
            yield matched(block, f"world frame of {name!r}")
        elif block.kind == "Reference Frame":
            yield matched(block, "a frame of the plant")
        elif block.kind == "Mechanism Configuration":
            has_gravity = True
            checked = _check_gravity(block, live_gravity)
            yield from differences(checked)
            yield matched(block, f"gravity of {name!r}", parameters=[checked.item])
        elif block.kind == "Solver Configuration":
            has_solver = True
            yield matched(block, f"the Simulator's integrator, {scheme}")
    if not has_gravity and any(live_gravity):
        yield different("", "(model)", "GravityVector", ZERO, live_gravity, unit="m/s^2")
    if not has_solver:
        yield extra("solver", name=scheme)
    solver = sides.model.solver
    stop, begin = solver.get("StopTime"), solver.get("StartTime", 0.0)
    if not isinstance(stop, float) or not np.isclose(stop, duration, rtol=1e-12, atol=0.0):
        yield different("", "(solver)", "StopTime", stop, duration, unit="s")
    if begin != 0.0:
        yield different("", "(solver)", "StartTime", begin, 0.0, unit="s")
    item = {
        "what": "solver",
        "name": str(solver.get("Solver", "")),
        "counterpart": f"integrator {scheme}",
        "parameters": [{"parameter": "StopTime", "simulink": stop, "drake": duration, "unit": "s"}],
    }
    yield Verdict(list="matched", item=item)


def locate_nodes(sides: Sides, judged: Blocks) -> Iterator[Verdict]:
    """Name the frame, or the signal at a joint, that every physical connection is."""
    frames = _frames(sides)
    for index, node in enumerate(sides.flat.nodes):
        if index not in sides.chain.frames:
            sids = {port.partition("#")[0] for port in node}
            lost = sids <= judged.missing.keys()
            counterpart = "nothing" if lost else "a signal of a joint or a sensor"
        else:
            body, X = sides.chain.frames[index]
            near = [
                name
                for other, name, p in frames
                if other == body and np.abs(p - X[:3, 3]).max() < SAME_PLACE
            ]
            shown = ", ".join(f"{value:.6g}" for value in X[:3, 3])
            counterpart = f"frame {near[0]!r}" if near else f"a pose of link {body} at ({shown}) m"
        item = {"what": "node", "ports": list(node), "counterpart": counterpart}
        yield Verdict(list="matched", item=item)


def _compare_joint(
    ours: ChainJoint, drake: tuple[ChainJoint, ...], block: Block
) -> Iterator[Verdict]:
    if ours.number > len(drake):
        joints = f"{len(drake)} joint{'' if len(drake) == 1 else 's'}"
        yield missing(block, f"the Drake model has only {joints}")
        return
    theirs = drake[ours.number - 1]
    checks = [check(block, "type", ours.type, theirs.type)]
    for name in dict.fromkeys([*ours.parameters, *theirs.parameters]):
        if name.endswith("TargetValue") and not _counts(ours, theirs, name):
            continue
        default: float | str = DEFAULTS.get(name, "none" if "Limit" in name else 0.0)
        values = (joint.parameters.get(name, default) for joint in (ours, theirs))
        unit = UNITS.get(name.removeprefix("LowerLimit").removeprefix("UpperLimit"), ("", ""))
        checks.append(check(block, name, *values, unit=unit[ours.type == "prismatic"]))
    yield from differences(*checks)
    yield matched(block, f"joint {theirs.name!r}", parameters=[each.item for each in checks])


def _counts(ours: ChainJoint, theirs: ChainJoint, target: str) -> bool:
    """Tell whether a state target counts: a motion overrides one of low priority."""
    driven = theirs.parameters["MotionActuationMode"] == "InputMotion"
    priority = ours.priorities.get(f"{target.removesuffix('Value')}Priority")
    return not driven or (target in ours.parameters and priority == "High")


def _misplaced(miss: Miss, sides: Sides) -> Verdict:
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
    named: list[PassedTransform | Block] = [*way] or [sides.block(miss.place.sid)]
    sid, names = (", ".join(getattr(one, part) for one in named) for part in ("sid", "name"))
    if miss.what == "rotation":
        return different(sid, names, name, *map(rotation_text, both))
    return different(sid, names, name, *map(_rounded, both), unit="m")


def _parameter(miss: Miss, passed: PassedTransform) -> str:
    if miss.what == "rotation":
        return "rotation"
    standard = passed.method == "StandardAxis"
    return f"Translation{'Standard' if standard else 'Cartesian'}Offset"


def _stated(miss: Miss, passed: PassedTransform) -> tuple[Array, Array]:
    """Bring what is and what should be into the axes in which the block states it."""
    R_before = miss.gauge[:3, :3] @ passed.X_before[:3, :3]
    R_BF = passed.X_BF[:3, :3]
    wanted = R_before.T @ miss.expected
    if miss.what == "rotation":
        return R_BF, wanted.T if passed.back else wanted
    return passed.X_BF[:3, 3], -R_BF @ wanted if passed.back else wanted


def _rounded(vector: Array) -> tuple[float, ...]:
    return tuple(float(round(value, 12)) + 0.0 for value in vector.tolist())


def _compare_solid(ours: Place, theirs: Place, gauge: Array, sides: Sides) -> Iterator[Verdict]:
    """Compare a solid with a body; ``gauge`` is the pose of the model's frame M in the plant's."""
    if ours.solid is None or theirs.solid is None:
        return
    mine, drake, block = ours.solid, theirs.solid, sides.block(ours.sid)
    checks = _check_mass(mine, drake, block)
    if mine.shape == OTHER:
        pass
    elif mine.shape != drake.shape:
        checks.append(check(block, "shape", mine.shape, drake.shape))
    elif mine.shape == "brick":
        size = _extents(gauge[:3, :3] @ ours.X_M[:3, :3], mine.size)
        checks += _check_brick(size, _extents(theirs.X_M[:3, :3], drake.size), block)
    else:
        checks += [
            check(block, name, a, b, unit="m", counts=name == "CylinderLength")
            for name, a, b in zip(DIMENSIONS[mine.shape], mine.size, drake.size, strict=True)
        ]
    if mine.colour and drake.colour:
        name = "GraphicDiffuseColor"
        checks.append(check(block, name, mine.colour, drake.colour, counts=False))
    yield from differences(*checks)
    yield matched(block, f"body {theirs.name!r}", parameters=[each.item for each in checks])


def _check_mass(mine: SolidProperties, drake: SolidProperties, block: Block) -> list[Check]:
    if mine.density is not None:
        if drake.density is None:
            return []
        return [check(block, "Density", mine.density, drake.density, unit="kg/m^3")]
    checks = [check(block, "Mass", mine.mass, drake.mass, unit="kg")]
    if mine.moments:
        moments = mine.moments, drake.moments
        checks.append(check(block, "MomentsOfInertia", *moments, unit="kg*m^2"))
    if any(mine.offsets):
        name, zero = "CenterOfMass and ProductsOfInertia", (0.0,) * len(mine.offsets)
        checks.append(check(block, name, mine.offsets, zero))
    return checks


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


def _check_gravity(block: Block, live: tuple[float, ...]) -> Check:
    uniform = str(block.parameters.get("UniformGravity", "Constant"))
    if uniform == "TimeVarying":
        return check(block, "UniformGravity", uniform, "Constant")
    gravity = ZERO if uniform == "None" else vector(block.parameters.get("GravityVector"))
    return check(block, "GravityVector", gravity, live, unit="m/s^2")


def _frames(sides: Sides) -> list[tuple[int, str, Array]]:
    """List the plant's frames: number of the joint that carries it, name, place in that link."""
    links = Links(sides.plant)
    found = []
    for index in range(sides.plant.num_frames()):
        frame = sides.plant.get_frame(FrameIndex(index))
        number, X = links.locate(frame)
        found.append((number, frame.name(), X[:3, 3]))
    return found
