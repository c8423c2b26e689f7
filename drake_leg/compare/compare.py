"""A Simulink model against a run's live diagram."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from drake_leg.compare.comparison import Comparison
from drake_leg.compare.correspondence import Correspondence
from drake_leg.compare.diagram_signals import DiagramSignals
from drake_leg.compare.findings import Findings
from drake_leg.compare.match_blocks import check_units, match_carriers, match_sinks
from drake_leg.compare.match_frames import Alignment, align
from drake_leg.compare.match_mechanism import match_mechanism
from drake_leg.compare.match_motions import match_integrators, match_motions
from drake_leg.compare.match_settings import (
    match_boundaries,
    match_nodes,
    match_sensor,
    match_settings,
    miss_the_rest,
)
from drake_leg.compare.match_velocity import match_inverse_jacobian
from drake_leg.compare.match_wires import match_wires, physical
from drake_leg.compare.mechanism import Mechanism
from drake_leg.compare.plant_mechanism import read_plant
from drake_leg.compare.scale import scale_of, shrunk
from drake_leg.compare.sensed import senses_rotation
from drake_leg.compare.simulink_mechanism import Network, read_network
from drake_leg.compare.simulink_signals import SimulinkSignals
from drake_leg.diagrams.wiring import plant_of
from drake_leg.robot import Robot
from drake_leg.simulink.flatten import flatten
from drake_leg.simulink.model import Model
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.prescribed_motion import PrescribedMotion

MOST_TURNED = 6  # joints that are tried with their ends exchanged


@dataclass(frozen=True, kw_only=True)
class LiveModel:
    """What a model is compared with."""

    diagram: Diagram
    root: Context  # as a run starts
    robot: Robot  # for the shapes and colours of its solids
    duration: float  # [s]
    scheme: str  # the integrator's name


def compare(model: Model, live: LiveModel, *, strict: bool = False) -> Comparison:
    """Find for every block, wire and parameter of a model what stands for it in the diagram.

    Signals are compared by what they are, not by how they are muxed, scaled and summed; links by
    where their solids and next joints are, not by how many transforms lead there.

    Parameters
    ----------
    model : Model
        As read from a file.
    strict : bool
        Whether cross sections, colours and the converters' filters count.

    Raises
    ------
    InvalidValueError
        If a Rigid Transform or a MATLAB Function of the model cannot be read, or the diagram has
        no plant.
    """
    flat = flatten(model)
    findings = Findings(strict=strict)
    plant = plant_of(live.diagram)
    drake = _mechanism(live, plant)
    network, alignment, scale = _aligned(flat, drake)
    if scale != 1.0:
        findings.scale(scale)
    ours = SimulinkSignals(flat, network)
    signals = DiagramSignals(live.diagram, live.root)
    findings.used.update({plant.get_name(), *signals.of_type(PrescribedMotion)})

    match_mechanism(network, drake, alignment, ours.blocks, findings)
    match_sensor(network, drake, ours.blocks, findings, signals)
    match_settings(flat, plant, findings, scheme=live.scheme, duration=live.duration)
    correspondence = Correspondence(flat, network, ours, signals, findings)
    match_motions(correspondence)
    match_inverse_jacobian(correspondence)
    match_integrators(correspondence)
    match_carriers(correspondence)
    match_sinks(correspondence)
    check_units(correspondence)
    match_boundaries(model, flat, findings)
    miss_the_rest(flat, findings)
    match_wires(correspondence)
    match_nodes(flat, network, plant, findings)
    _add_extra(signals, findings)
    return findings.comparison


def _mechanism(live: LiveModel, plant: MultibodyPlant) -> Mechanism:
    systems = live.diagram.GetSystems()
    senses = any(isinstance(system, FrameSensor) for system in systems)
    stops = [system for system in systems if isinstance(system, JointStops)]
    links = [segment.link for segment in live.robot.segments]
    return read_plant(
        plant,
        plant.GetFrameByName(f"frame_{len(live.robot.segments)}") if senses else None,
        driven=any(isinstance(system, PrescribedMotion) for system in systems),
        state=plant.GetMyContextFromRoot(live.root),
        solids={link.name: link.solid for link in links if link and link.solid},
        stops=stops[0].mechanics if stops else {},
    )


def _aligned(flat: Model, drake: Mechanism) -> tuple[Network, Alignment, float]:
    """Lay the chains beside each other, in one unit of length.

    Joints that point backwards are read the likelier way.
    """

    def beside(network: Network) -> Alignment:
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
    both = [(reading, beside(reading)) for reading in (shrunk(one, scale) for one in readings)]
    best = min(both, key=lambda pair: 2 * len(pair[1].misses) + len(pair[0].exchanged))
    return (*best, scale)


def _add_extra(signals: DiagramSignals, findings: Findings) -> None:
    """Note what the diagram has and the model has not."""
    covered = findings.wired | physical(signals)
    for name, system in signals.systems.items():
        if name not in findings.used:
            kind = type(system).__name__
            findings.comparison.extra.append({"what": "block", "name": name, "kind": kind})
    for wire in signals.wires:
        if wire not in covered:
            findings.comparison.extra.append(
                {
                    "what": "wire",
                    "from": f"{wire.source}.{wire.output}",
                    "to": f"{wire.target}.{wire.input}",
                }
            )
