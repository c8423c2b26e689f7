"""Both sides of a comparison, and the roles in which their signals are compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from drake_leg.diagrams.wiring import plant_of
from drake_leg.robot.robot import Robot
from drake_leg.simulink.compare.alignment import Alignment, align, scale_of, shrunk
from drake_leg.simulink.compare.findings import Verdict, different
from drake_leg.simulink.compare.plant_mechanism import Mechanism, read_plant
from drake_leg.simulink.compare.signals import (
    Atom,
    DiagramSignals,
    Scalar,
    Signal,
    close,
    integral_roles,
)
from drake_leg.simulink.compare.simulink_mechanism import Network, read_network
from drake_leg.simulink.compare.simulink_signals import SimulinkSignals, senses_rotation
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.wiring import flatten
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.prescribed_motion import PrescribedMotion
from drake_leg.units import parse_unit

MOST_TURNED = 6  # joints that are tried with their ends exchanged
ANGLE_UNITS = tuple(float(parse_unit(unit).factor) for unit in ("rad", "deg", "rev", "rpm"))


@dataclass(frozen=True, kw_only=True)
class LiveModel:
    """What a model is compared with."""

    diagram: Diagram
    root: Context  # as a run starts
    robot: Robot  # for the shapes and colours of its solids
    duration: float  # [s]
    scheme: str  # the integrator's name


@dataclass(frozen=True, kw_only=True)
class Sides:
    """A Simulink model, ``ours``, and a diagram, ``live``, each read on its own."""

    model: Model  # as drawn
    flat: Model  # without subsystems
    network: Network
    ours: SimulinkSignals
    run: LiveModel
    plant: MultibodyPlant
    drake: Mechanism
    live: DiagramSignals
    alignment: Alignment  # of the network's mechanism and Drake's
    scale: float  # by which the model's lengths were divided before that

    def block(self, sid: str) -> Block:
        """Find a block of the model."""
        return self.ours.blocks[sid]

    def origins(self, scalar: Scalar, *types: str) -> list[Block]:
        """List the blocks of some types that a signal comes from or has passed."""
        return [b for b in self.flat.blocks if b.sid in scalar.origins and b.type in types]

    def unit_of(self, joint: int) -> str:
        """Return the SI unit of a joint's position."""
        turns = self.network.mechanism.joints[joint - 1].type == "revolute"
        return "rad" if turns else "m"

    def rates(self) -> dict[int, tuple[str, Scalar | None]]:
        """Map each joint to its integrator's SID and to the rate that it has because of it.

        The rate is the scalar that is integrated, times the factor behind the integrator.
        """
        found = {}
        for sid, joint in self.network.joints.items():
            terms = [t for scalar in self.ours.motion(sid) or () for t in scalar.terms.items()]
            for atom, factor in terms:
                if atom.kind == "integral":
                    signal = self.ours.input(atom.of, 1) or ()
                    wide = signal * (atom.index + 1) if len(signal) == 1 else signal
                    part = wide[atom.index].scaled(factor) if atom.index < len(wide) else None
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
    network, alignment, scale = _aligned(flat, drake)
    return Sides(
        model=model,
        flat=flat,
        network=network,
        ours=SimulinkSignals(flat, network.joints, network.sensor),
        run=run,
        plant=plant,
        drake=drake,
        live=DiagramSignals(run.diagram, run.root),
        alignment=alignment,
        scale=scale,
    )


def joint_roles(sides: Sides) -> Roles:
    """Call the integrals in the joints' commanded positions after the joints."""
    names: dict[Atom, Atom] = {}
    for sid, joint in sides.network.joints.items():
        for scalar in (sides.ours.motion(sid) or ())[:1]:
            names |= integral_roles(scalar, joint)
    return Roles(names=names)


def same_factors(ours: Scalar, live: Scalar) -> bool:
    """Tell whether all atoms but sines and integrals have the same factors.

    A factor behind an integrator is one of the rate that it integrates.
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


def _aligned(flat: Model, drake: Mechanism) -> tuple[Network, Alignment, float]:
    """Align the mechanisms in one unit of length; joints that point backwards the likelier way."""

    def aligned(network: Network) -> Alignment:
        sensor = next((b for b in flat.blocks if b.sid == network.sensor), None)
        orientation = sensor is not None and senses_rotation(sensor)
        return align(network.mechanism, drake, orientation=orientation)

    network = read_network(flat)
    turned = network.turned[:MOST_TURNED]
    readings = [network] + [
        read_network(flat, taken_as_drawn=exchanged)
        for count in range(1, len(turned) + 1)
        for exchanged in combinations(turned, count)
    ]
    scale = scale_of(network.mechanism, drake)
    both = [(reading, aligned(reading)) for reading in (shrunk(one, scale) for one in readings)]
    best = min(both, key=lambda pair: 2 * len(pair[1].misses) + len(pair[0].exchanged))
    return (*best, scale)
