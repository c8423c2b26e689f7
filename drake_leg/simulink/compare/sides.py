"""Both sides of a comparison, with their mechanisms aligned link by link in one unit of length.

Both chains are compared in the frame of the joint that carries a link, so that one wrong offset
is one difference and not one for every link after it. Where a joint's two frames are turned about
its axis, or moved along it, by the same amount on both of its sides, nothing moves differently;
this freedom is used up before links are compared.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from drake_leg.diagrams.wiring import plant_of
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot
from drake_leg.simulink.compare.chain import ModelChain, find_route, read_chain
from drake_leg.simulink.compare.findings import Verdict, different
from drake_leg.simulink.compare.of_diagram import (
    DiagramSignals,
    Mechanism,
    PassedTransform,
    Place,
    read_plant,
)
from drake_leg.simulink.compare.signals import (
    Atom,
    Scalar,
    Signal,
    close,
    integral_roles,
)
from drake_leg.simulink.compare.simulink_signals import SimulinkSignals, senses_rotation
from drake_leg.simulink.mechanism import inverse
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.wiring import flatten
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.prescribed_motion import PrescribedMotion
from drake_leg.units import parse_unit

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
class AlignedLink:
    """A link of both chains, place by place."""

    pairs: list[Pair]
    gauge: Array  # pose of the model's frame M in the plant's
    misses: list[Miss]
    unmatched: list[Place]  # the model's solids
    absent: list[Place]  # the plant's solids


def scale_of(simulink: Mechanism, drake: Mechanism) -> float:
    """Find how many times as long as the plant's all links of the model are.

    A link's length is how far its next joint, or the sensed foot, is from its own joint's axis.
    The factor is 1 where no single one explains all lengths.
    """
    if len(simulink.bodies) != len(drake.bodies):
        return 1.0
    both = [
        (ours[key], theirs[key])
        for ours, theirs in (
            map(_lengths, bodies) for bodies in zip(simulink.bodies, drake.bodies, strict=True)
        )
        for key in ours.keys() & theirs.keys()
    ]
    ratios = [ours / theirs for ours, theirs in both if min(ours, theirs) > SMALLEST]
    lost = [pair for pair in both if min(pair) <= SMALLEST < max(pair)]
    if lost or len(ratios) < FEWEST or max(ratios) - min(ratios) > SAME * max(ratios):
        return 1.0
    factor = float(f"{np.mean(ratios):.9g}")
    return 1.0 if math.isclose(factor, 1.0, rel_tol=SAME) else factor


def shrunk(chain: ModelChain, scale: float) -> ModelChain:
    """Divide all lengths of a model's chain by a factor."""
    if scale == 1.0:
        return chain
    passed: dict[str, PassedTransform] = {}

    def nearer(X: Array) -> Array:
        found = X.copy()
        found[:3, 3] /= scale
        return found

    def shrunk_place(place: Place) -> Place:
        for one in place.way:
            if one.sid not in passed:
                X_before, X_BF = nearer(one.X_before), nearer(one.X_BF)
                passed[one.sid] = replace(one, X_before=X_before, X_BF=X_BF)
        solid = place.solid
        if solid is not None:
            solid = replace(solid, size=tuple(edge / scale for edge in solid.size))
        way = tuple(passed[one.sid] for one in place.way)
        return replace(place, X_M=nearer(place.X_M), way=way, solid=solid)

    bodies = tuple(tuple(map(shrunk_place, places)) for places in chain.mechanism.bodies)
    return replace(
        chain,
        mechanism=replace(chain.mechanism, bodies=bodies),
        frames={frame: (body, nearer(X)) for frame, (body, X) in chain.frames.items()},
    )


def align(simulink: Mechanism, drake: Mechanism, *, orientation: bool) -> list[AlignedLink]:
    """Align two chains; ``orientation`` tells whether the foot's orientation is sensed."""
    bodies = list(zip(simulink.bodies, drake.bodies, strict=False))
    paired = [_pairs(mine, theirs) for mine, theirs in bodies]
    found: list[AlignedLink] = []
    gauge = np.eye(4)
    for body, ((mine, theirs), pairs) in enumerate(zip(bodies, paired, strict=True)):
        misses = _misses(pairs, gauge, orientation=orientation)
        following = np.eye(4)
        joint = next((pair for pair in pairs if pair[0].role == "joint"), None)
        if joint is not None and body + 1 < len(bodies):
            D = inverse(joint[1].X_M) @ gauge @ joint[0].X_M
            others = [miss for miss in misses if miss.place is not joint[0]]
            folded, unfolded = (
                len(_misses(paired[body + 1], G, orientation=orientation)) for G in (D, following)
            )
            if _about_z(D) and folded + len(others) < unfolded + len(misses):
                following, misses = D, others
        unmatched, absent = (
            [place for place in places if place.role == "solid" and id(place) not in taken]
            for places, taken in (
                (mine, {id(ours) for ours, _ in pairs}),
                (theirs, {id(live) for _, live in pairs}),
            )
        )
        found.append(
            AlignedLink(pairs=pairs, gauge=gauge, misses=misses, unmatched=unmatched, absent=absent)
        )
        gauge = following
    return found


def _lengths(places: tuple[Place, ...]) -> dict[tuple[str, int], float]:
    return {
        (place.role, place.number): math.hypot(*place.X_M[:2, 3])
        for place in places
        if place.role in ("joint", "foot")
    }


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


# --- both sides -----------------------------------------------------------------------------

MOST_TURNED = 6  # joints that are tried with their ends exchanged
ANGLE_UNITS = tuple(float(parse_unit(unit).factor) for unit in ("rad", "deg", "rev", "rpm"))


@dataclass(frozen=True, kw_only=True)
class LiveModel:
    """What a model is compared with."""

    diagram: Diagram
    root: Context  # as a run starts
    robot: Robot  # for the shapes and colors of its solids
    duration: float  # [s]
    scheme: str  # the integrator's name


@dataclass(frozen=True, kw_only=True)
class Sides:
    """A Simulink model, ``ours``, and a diagram, ``live``, each read on its own."""

    model: Model  # as drawn
    flat: Model  # without subsystems
    chain: ModelChain
    ours: SimulinkSignals
    run: LiveModel
    plant: MultibodyPlant
    drake: Mechanism
    live: DiagramSignals
    links: list[AlignedLink]  # of the chain and the plant
    scale: float  # by which the model's lengths were divided before that

    def block(self, sid: str) -> Block:
        """Find a block of the model."""
        return self.ours.blocks[sid]

    def origins(self, scalar: Scalar) -> list[Block]:
        """List the sources, integrators and converters of a signal, in the model's order."""
        return [self.block(sid) for sid in sorted(scalar.origins, key=self.ours.order.__getitem__)]

    def sources(self, scalar: Scalar, types: Collection[str]) -> list[Block]:
        """List the sources of some types that a signal comes from."""
        return [block for block in self.origins(scalar) if block.type in types]

    def unit_of(self, joint: int) -> str:
        """Return the SI unit of a joint's position."""
        turns = self.chain.mechanism.joints[joint - 1].type == "revolute"
        return "rad" if turns else "m"

    def rates(self) -> dict[int, tuple[str, Scalar | None]]:
        """Map each joint to its integrator's SID and to the rate that it has because of it.

        The rate is the scalar that is integrated, times the factor after the integrator.
        """
        found = {}
        for sid, joint in self.chain.joints.items():
            terms = [t for scalar in self.ours.motion(sid) or () for t in scalar.terms.items()]
            for atom, factor in terms:
                if atom.kind == "integral":
                    signal = self.ours.input(atom.of, 1) or ()
                    index = atom.index if len(signal) > 1 else 0
                    part = signal[index].scaled(factor) if index < len(signal) else None
                    found[joint] = (atom.of, part)
        return found

    def rate_unit(self) -> float:
        """Value in rad/s of the unit in which the model's function returns joint rates.

        It is 1 unless all rates are scaled by the same factor, and that is an angle's unit.
        """
        factors = [
            factor
            for _, scalar in self.rates().values()
            for atom, factor in (scalar.terms.items() if scalar else ())
            if atom.kind == "function"
        ]
        common = len(factors) > 1 and all(close(factor, factors[0]) for factor in factors)
        return next((u for u in ANGLE_UNITS if common and close(factors[0], u)), 1.0)


@dataclass(frozen=True, kw_only=True)
class Roles:
    """What the model's atoms are called on both sides.

    A role is an atom that means the same on both sides: the integral of a joint's rate, an output
    of the inverse Jacobian. The signals of the diagram are written in roles from the start.
    """

    names: Mapping[Atom, Atom] = field(default_factory=dict)  # the model's atoms -> roles
    units: Mapping[Atom, float] = field(default_factory=dict)  # role -> unit of the model's, in SI

    def of(self, signal: Signal | None) -> Signal:
        """Write a signal of the model in roles; None counts as empty."""
        return tuple(scalar.renamed(self.names).per(self.units) for scalar in signal or ())


def read_sides(model: Model, run: LiveModel) -> Sides:
    """Read the model's and the diagram's mechanism and signals, and align the mechanisms."""
    flat = flatten(model)
    plant = plant_of(run.diagram)
    drake = _mechanism(run, plant)
    chain, links, scale = _aligned(flat, drake)
    return Sides(
        model=model,
        flat=flat,
        chain=chain,
        ours=SimulinkSignals(flat, chain.joints, chain.sensor),
        run=run,
        plant=plant,
        drake=drake,
        live=DiagramSignals(run.diagram, run.root),
        links=links,
        scale=scale,
    )


def joint_roles(sides: Sides) -> Roles:
    """Call the integrals in the joints' commanded positions after the joints."""
    names: dict[Atom, Atom] = {}
    for sid, joint in sides.chain.joints.items():
        for scalar in (sides.ours.motion(sid) or ())[:1]:
            names |= integral_roles(scalar, joint)
    return Roles(names=names)


def same_factors(ours: Scalar, live: Scalar) -> bool:
    """Tell whether all atoms but sines and integrals have the same factors.

    A factor after an integrator is one of the rate that it integrates.
    """
    return all(
        atom in live.terms and close(factor, live.terms[atom])
        for atom, factor in ours.terms.items()
        if atom.kind not in ("sine", "integral")
    )


def other_signal(
    sides: Sides, port: str, what: str, ours: Scalar | None, live: Scalar | None
) -> Verdict:
    """State that an input of the model takes another signal; None where nothing is connected."""
    sid, _, place = port.partition("#")
    return different(
        sid,
        sides.block(sid).name,
        f"{place}, {what}",
        "nothing" if ours is None else str(ours),
        "nothing" if live is None else str(live),
        what="wire",
        wrong=port,
    )


def _mechanism(run: LiveModel, plant: MultibodyPlant) -> Mechanism:
    systems = run.diagram.GetSystems()
    senses = any(isinstance(system, FrameSensor) for system in systems)
    stops = [system for system in systems if isinstance(system, JointStops)]
    links = [segment.link for segment in run.robot.segments]
    return read_plant(
        plant,
        plant.GetFrameByName(f"frame_{len(run.robot.segments)}") if senses else None,
        driven=any(isinstance(system, PrescribedMotion) for system in systems),
        state=plant.GetMyContextFromRoot(run.root),
        solids={link.name: link.solid for link in links if link and link.solid},
        stops=stops[0].mechanics if stops else {},
    )


def _aligned(flat: Model, drake: Mechanism) -> tuple[ModelChain, list[AlignedLink], float]:
    """Align the mechanisms in one unit of length; joints that point backwards the likelier way."""

    def aligned(chain: ModelChain) -> list[AlignedLink]:
        sensor = next((b for b in flat.blocks if b.sid == chain.sensor), None)
        orientation = sensor is not None and senses_rotation(sensor)
        return align(chain.mechanism, drake, orientation=orientation)

    route = find_route(flat)
    chain = read_chain(route)
    turned = chain.turned[:MOST_TURNED]
    readings = [chain] + [
        read_chain(route, taken_as_drawn=exchanged)
        for count in range(1, len(turned) + 1)
        for exchanged in combinations(turned, count)
    ]
    scale = scale_of(chain.mechanism, drake)
    both = [(reading, aligned(reading)) for reading in (shrunk(one, scale) for one in readings)]

    def unlikeliness(pair: tuple[ModelChain, list[AlignedLink]]) -> int:
        return 2 * sum(len(link.misses) for link in pair[1]) + len(pair[0].exchanged)

    return (*min(both, key=unlikeliness), scale)
