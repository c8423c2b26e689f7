"""A Simulink model against a run's live diagram."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FrameIndex
from pydrake.systems.framework import Context, Diagram

from drake_leg.compare.comparison import Comparison
from drake_leg.compare.correspondence import Correspondence
from drake_leg.compare.diagram_signals import DiagramSignals
from drake_leg.compare.findings import Findings
from drake_leg.compare.match_blocks import match_carriers, match_sinks
from drake_leg.compare.match_mechanism import match_mechanism
from drake_leg.compare.match_motions import match_integrators, match_motions
from drake_leg.compare.match_velocity import match_inverse_jacobian
from drake_leg.compare.match_wires import match_wires, physical
from drake_leg.compare.mechanism import Mechanism
from drake_leg.compare.plant_mechanism import read_plant
from drake_leg.compare.simulink_mechanism import Network, read_network, vector
from drake_leg.compare.simulink_signals import SimulinkSignals
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot
from drake_leg.simulink.flatten import flatten
from drake_leg.simulink.model import Block, Model
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.prescribed_motion import PrescribedMotion

SAME_PLACE = 1e-9  # [m]
BOUNDARIES = ("SubSystem", "Inport", "Outport", "PMIOPort", "Goto", "From", "GotoTagVisibility")
CONVERTERS = ("Simulink-PS Converter", "PS-Simulink Converter")


@dataclass(frozen=True, kw_only=True)
class LiveModel:
    """What a model is compared with."""

    diagram: Diagram
    root: Context  # as a run starts
    robot: Robot | None  # whose colours the solids have
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
    live : LiveModel
        The diagram.
    strict : bool
        Whether cross sections, colours and the converters' filters count.

    Returns
    -------
    Comparison

    Raises
    ------
    InvalidValueError
        If a Rigid Transform or a MATLAB Function of the model cannot be read, or the diagram has
        no plant.
    """
    flat = flatten(model)
    findings = Findings(strict=strict)
    network = read_network(flat)
    ours = SimulinkSignals(flat, network)
    signals = DiagramSignals(live.diagram, live.root)
    plant = _plant(live.diagram)
    drake = _mechanism(live, plant)

    senses_turn = network.sensor is not None and any(
        ours.blocks[network.sensor].parameters.get(f"Sph{what}") == "on"
        for what in ("SensePosition", "SenseVelocity")
    )
    match_mechanism(network, drake, ours.blocks, findings, orientation=senses_turn)
    _match_sensor(network, drake, ours.blocks, findings, signals)
    findings.used.update({plant.get_name(), *signals.of_type(PrescribedMotion)})
    _match_settings(flat, drake, live, findings, plant)
    correspondence = Correspondence(flat, network, ours, signals, findings)
    for match in (
        match_motions,
        match_inverse_jacobian,
        match_integrators,
        match_carriers,
        match_sinks,
        match_wires,
    ):
        match(correspondence)
    _match_boundaries(model, flat, findings)
    _match_rest(flat, network, findings)
    _match_nodes(flat, network, plant, findings)
    _add_extra(signals, findings)
    return findings.comparison


def _plant(diagram: Diagram) -> MultibodyPlant:
    plants = [s for s in diagram.GetSystems() if isinstance(s, MultibodyPlant)]
    if len(plants) != 1:
        raise InvalidValueError(f"the diagram has {len(plants)} plants; it must have one")
    return plants[0]


def _mechanism(live: LiveModel, plant: MultibodyPlant) -> Mechanism:
    systems = live.diagram.GetSystems()
    sensor = next((s for s in systems if isinstance(s, FrameSensor)), None)
    foot = None
    if sensor is not None and live.robot is not None:
        foot = plant.GetFrameByName(f"frame_{len(live.robot.segments)}")
    return read_plant(
        plant,
        foot,
        driven=any(isinstance(s, PrescribedMotion) for s in systems),
        state=plant.GetMyContextFromRoot(live.root),
        colours=_colours(live.robot),
    )


def _colours(robot: Robot | None) -> dict[str, tuple[float, ...]]:
    links = [segment.link for segment in robot.segments] if robot else []
    return {link.name: link.solid.colour for link in links if link and link.solid}


def _match_sensor(
    network: Network,
    drake: Mechanism,
    blocks: dict[str, Block],
    findings: Findings,
    signals: DiagramSignals,
) -> None:
    if network.sensor is None:
        return
    block = blocks[network.sensor]
    names = signals.of_type(FrameSensor)
    sensed = [i for i, places in enumerate(drake.bodies) if any(p.role == "foot" for p in places)]
    ours = next(
        i
        for i, places in enumerate(network.mechanism.bodies)
        if any(p.sid == block.sid for p in places)
    )
    if not names:
        findings.miss(block, "the diagram senses no frame against another")
        return
    findings.used.update(names)
    findings.check(
        block, "body that is sensed, counted from the base", float(ours), float(sensed[0])
    )
    findings.match(block, f"{names[0]!r}")


def _match_settings(
    model: Model, drake: Mechanism, live: LiveModel, findings: Findings, plant: MultibodyPlant
) -> None:
    """World, gravity and solver."""
    has_gravity = False
    for block in model.blocks:
        if block.kind == "World Frame":
            findings.match(block, f"world frame of {plant.get_name()!r}")
        elif block.kind == "Reference Frame":
            findings.match(block, "a frame of the plant")
        elif block.kind == "Mechanism Configuration":
            has_gravity = True
            uniform = block.parameters.get("UniformGravity", "Constant") == "Constant"
            value = vector(block.parameters.get("GravityVector")) if uniform else (0.0, 0.0, 0.0)
            checked = findings.check(block, "GravityVector", value, drake.gravity, unit="m/s^2")
            findings.match(block, f"gravity of {plant.get_name()!r}", parameters=[checked])
        elif block.kind == "Solver Configuration":
            findings.match(block, f"the Simulator's integrator, {live.scheme}")
    if not has_gravity and any(drake.gravity):
        findings.differ(
            "", "(model)", "GravityVector", (0.0, 0.0, 0.0), drake.gravity, unit="m/s^2"
        )
    stop = model.solver.get("StopTime")
    if isinstance(stop, float) and not np.isclose(stop, live.duration, rtol=1e-12, atol=0.0):
        findings.differ("", "(solver)", "StopTime", stop, live.duration, unit="s")
    findings.comparison.matched.append(
        {
            "what": "solver",
            "name": str(model.solver.get("Solver", "")),
            "counterpart": f"integrator {live.scheme}, fixed steps chosen beforehand",
            "parameters": [
                {"parameter": "StopTime", "simulink": stop, "drake": live.duration, "unit": "s"}
            ],
        }
    )


def _match_boundaries(model: Model, flat: Model, findings: Findings) -> None:
    """What only groups and leads on: subsystems, their ports, Goto and From."""
    leaves = {block.sid for block in flat.blocks}
    for block in model.blocks:
        if block.sid not in leaves:
            findings.match(block, "the blocks and wires that it holds or joins")


def _match_rest(flat: Model, network: Network, findings: Findings) -> None:
    """Whatever has found no counterpart so far."""
    for block in flat.blocks:
        if block.sid in findings.seen:
            continue
        if block.kind in CONVERTERS:
            findings.miss(block, "it is connected to no joint or sensor of the chain")
        elif block.source.startswith("sm_lib"):
            findings.miss(block, "the Drake model has nothing of this kind")
        else:
            findings.miss(block, "no block of the diagram does this")


def _match_nodes(flat: Model, network: Network, plant: MultibodyPlant, findings: Findings) -> None:
    """Name the frame, or the signal at a joint, that every physical connection stands for."""
    frames = _frames(plant)
    for index, node in enumerate(flat.nodes):
        item = {"what": "node", "ports": list(node)}
        if index not in network.frames:
            counterpart = "a signal of a joint or a sensor"
        else:
            body, X = network.frames[index]
            near = [
                name
                for other, name, p in frames
                if other == body and np.abs(p - X[:3, 3]).max() < SAME_PLACE
            ]
            shown = ", ".join(f"{value:.6g}" for value in X[:3, 3])
            counterpart = f"frame {near[0]!r}" if near else f"a pose of link {body} at ({shown}) m"
        findings.comparison.matched.append({**item, "counterpart": counterpart})


def _frames(plant: MultibodyPlant) -> list[tuple[int, str, Array]]:
    """List the plant's frames: number of the joint that carries it, name, place in that link."""
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, np.zeros(plant.num_positions()))
    joints = [
        joint for joint in map(plant.get_joint, plant.GetJointIndices()) if joint.num_velocities()
    ]
    roots = [plant.world_frame(), *(joint.frame_on_child() for joint in joints)]
    welded = [set(plant.GetBodiesWeldedTo(root.body())) for root in roots]
    found = []
    for index in range(plant.num_frames()):
        frame = plant.get_frame(FrameIndex(index))
        for number, root in enumerate(roots):
            if frame.body() in welded[number]:
                found.append((number, frame.name(), frame.CalcPose(context, root).translation()))
    return found


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
