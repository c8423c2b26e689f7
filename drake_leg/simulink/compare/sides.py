"""Both sides of a comparison with a run: a model and a diagram, mechanisms and signals."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from drake_leg.diagrams.wiring import plant_of
from drake_leg.robot.robot import Robot
from drake_leg.simulink.compare.findings import Verdict, different
from drake_leg.simulink.compare.graph import Graph
from drake_leg.simulink.compare.mechanisms import Mechanisms, read_mechanisms
from drake_leg.simulink.compare.of_diagram import DiagramSignals
from drake_leg.simulink.compare.of_plant import read_plant
from drake_leg.simulink.compare.signals import (
    Atom,
    Scalar,
    Signal,
    close,
    integral_roles,
)
from drake_leg.simulink.compare.simulink_signals import SimulinkSignals
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.wiring import flatten
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.prescribed_motion import PrescribedMotion
from drake_leg.units import parse_unit

DRAKE = "Drake"  # what the diagram's side is called
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
    mechanisms: Mechanisms
    ours: SimulinkSignals
    run: LiveModel
    plant: MultibodyPlant
    live: DiagramSignals

    def block(self, sid: str) -> Block:
        """Find a block of the model."""
        return self.ours.blocks[sid]

    def origins(self, scalar: Scalar) -> list[Block]:
        """List the sources, integrators and converters of a signal, in the model's order."""
        return [self.block(sid) for sid in sorted(scalar.origins, key=self.ours.order.__getitem__)]

    def sources(self, scalar: Scalar, types: Collection[str]) -> list[Block]:
        """List the sources of some types that a signal comes from."""
        return [block for block in self.origins(scalar) if block.type in types]

    @cached_property
    def joints(self) -> dict[str, int]:
        """SID of a joint -> number of the plant's joint that it stands for, or one beyond."""
        return self.mechanisms.numbers

    def unit_of(self, joint: int) -> str:
        """Return the SI unit of a joint's position."""
        return "m" if joint in self._sliding else "rad"

    @cached_property
    def _sliding(self) -> set[int]:
        joints = self.mechanisms.ours.joints
        return {self.joints[joint.sid] for joint in joints if joint.type == "prismatic"}

    def rates(self) -> dict[int, tuple[str, Scalar | None]]:
        """Map each joint to its integrator's SID and to the rate that it has because of it.

        The rate is the scalar that is integrated, times the factor after the integrator.
        """
        found = {}
        for sid, joint in self.joints.items():
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
    mechanisms = read_mechanisms(model, flat, _graph(run, plant), DRAKE)
    foot = next(iter(mechanisms.matching.sensors), None)
    sensors = {} if foot is None else {mechanisms.ours.sensors[foot].sid: ""}
    return Sides(
        model=model,
        flat=flat,
        mechanisms=mechanisms,
        ours=SimulinkSignals(flat, mechanisms.numbers, sensors),
        run=run,
        plant=plant,
        live=DiagramSignals(run.diagram, run.root),
    )


def joint_roles(sides: Sides) -> Roles:
    """Call the integrals in the joints' commanded positions after the joints."""
    names: dict[Atom, Atom] = {}
    for sid, joint in sides.joints.items():
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


def _graph(run: LiveModel, plant: MultibodyPlant) -> Graph:
    systems = run.diagram.GetSystems()
    stops = [system for system in systems if isinstance(system, JointStops)]
    links = [segment.link for segment in run.robot.segments]
    sensor = None
    if any(isinstance(system, FrameSensor) for system in systems):
        fixed = run.robot.base_pose is None
        base = plant.world_frame() if fixed else plant.GetFrameByName("frame_0")
        sensor = base, plant.GetFrameByName(f"frame_{len(run.robot.segments)}")
    return read_plant(
        plant,
        sensor,
        driven=any(isinstance(system, PrescribedMotion) for system in systems),
        state=plant.GetMyContextFromRoot(run.root),
        solids={link.name: link.solid for link in links if link and link.solid},
        stops=stops[0].mechanics if stops else {},
    )
