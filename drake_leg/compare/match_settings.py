"""World, gravity, solver and sensor; what only groups blocks; physical connections."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FrameIndex

from drake_leg.compare.diagram_signals import DiagramSignals
from drake_leg.compare.findings import Findings
from drake_leg.compare.mechanism import Mechanism
from drake_leg.compare.plant_mechanism import Links
from drake_leg.compare.simulink_mechanism import SENSORS, Network
from drake_leg.kinematics.batches import Array
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.values import vector
from drake_leg.systems.frame_sensor import FrameSensor

SAME_PLACE = 1e-9  # [m]
CONVERTERS = ("Simulink-PS Converter", "PS-Simulink Converter")


def match_sensor(
    network: Network,
    drake: Mechanism,
    blocks: dict[str, Block],
    findings: Findings,
    signals: DiagramSignals,
) -> None:
    """Compare the sensor of the foot.

    Parameters
    ----------
    blocks : dict
        The model's blocks by SID.
    findings : Findings
        What is found is noted there.
    """
    if network.sensor is None:
        return
    block = blocks[network.sensor]
    names = signals.of_type(FrameSensor)
    if not names:
        findings.miss(block, "the diagram senses no frame against another")
        return
    findings.used.update(names)
    if network.sensor_turned:
        findings.differ(
            block.sid, block.name, "base and follower", "exchanged", "base at the world"
        )
    ours, theirs = (
        next(i for i, places in enumerate(bodies) if any(p.role == "foot" for p in places))
        for bodies in (network.mechanism.bodies, drake.bodies)
    )
    findings.check(block, "link that is sensed, counted from the base", float(ours), float(theirs))
    seen_from = str(block.parameters.get("MeasurementFrame", "World"))
    if block.kind == "Transform Sensor" and seen_from not in ("World", "Base"):
        findings.differ(block.sid, block.name, "MeasurementFrame", seen_from, "World")
    for name, value in block.parameters.items():
        acts = any(name.endswith(what) for what in ("SpringStiffness", "DampingCoefficient"))
        if acts and "Limit" not in name and any(vector(value)):
            findings.differ(block.sid, block.name, name, value, 0.0)
        if name.endswith("ActuationMode") and str(value).startswith("Input"):
            findings.differ(block.sid, block.name, name, value, "none")
    findings.match(block, repr(names[0]))


def match_settings(
    model: Model, plant: MultibodyPlant, findings: Findings, *, scheme: str, duration: float
) -> None:
    """Compare gravity and the duration; name what stands for world and solver.

    Parameters
    ----------
    findings : Findings
        What is found is noted there.
    scheme : str
        Name of the integrator.
    duration : float
        Of the run [s].
    """
    live_gravity = tuple(plant.gravity_field().gravity_vector().tolist())
    name = plant.get_name()
    has_gravity = has_solver = False
    for block in model.blocks:
        if block.kind == "World Frame":
            findings.match(block, f"world frame of {name!r}")
        elif block.kind == "Reference Frame":
            findings.match(block, "a frame of the plant")
        elif block.kind == "Mechanism Configuration":
            has_gravity = True
            uniform = str(block.parameters.get("UniformGravity", "Constant"))
            if uniform == "TimeVarying":
                checked = findings.check(block, "UniformGravity", uniform, "Constant")
            else:
                value = vector(block.parameters.get("GravityVector"))
                gravity = (0.0, 0.0, 0.0) if uniform == "None" else value
                checked = findings.check(
                    block, "GravityVector", gravity, live_gravity, unit="m/s^2"
                )
            findings.match(block, f"gravity of {name!r}", parameters=[checked])
        elif block.kind == "Solver Configuration":
            has_solver = True
            findings.match(block, f"the Simulator's integrator, {scheme}")
    if not has_gravity and any(live_gravity):
        zero = (0.0, 0.0, 0.0)
        findings.differ("", "(model)", "GravityVector", zero, live_gravity, unit="m/s^2")
    if not has_solver:
        findings.comparison.extra.append({"what": "solver", "name": scheme})
    stop = model.solver.get("StopTime")
    if not isinstance(stop, float) or not np.isclose(stop, duration, rtol=1e-12, atol=0.0):
        findings.differ("", "(solver)", "StopTime", stop, duration, unit="s")
    begin = model.solver.get("StartTime", 0.0)
    if begin != 0.0:
        findings.differ("", "(solver)", "StartTime", begin, 0.0, unit="s")
    times = {"parameter": "StopTime", "simulink": stop, "drake": duration, "unit": "s"}
    findings.comparison.matched.append(
        {
            "what": "solver",
            "name": str(model.solver.get("Solver", "")),
            "counterpart": f"integrator {scheme}",
            "parameters": [times],
        }
    )


def match_boundaries(model: Model, flat: Model, findings: Findings) -> None:
    """Note what only groups and leads on: subsystems, their ports, Goto and From.

    Parameters
    ----------
    model, flat : Model
        As drawn, and flattened.
    findings : Findings
        They are noted there.
    """
    leaves = {block.sid for block in flat.blocks}
    for block in model.blocks:
        if block.sid not in leaves:
            findings.match(block, "the blocks and wires that it holds or joins")


def miss_the_rest(flat: Model, findings: Findings) -> None:
    """Note what has found no counterpart so far.

    Parameters
    ----------
    findings : Findings
        With everything that has been judged.
    """
    for block in flat.blocks:
        if block.kind in CONVERTERS:
            findings.miss(block, "it is connected to no joint or sensor of the chain")
        elif block.kind in SENSORS:
            findings.miss(block, "it does not sense the chain from the world")
        elif block.source.startswith("sm_lib"):
            findings.miss(block, "the Drake model has nothing of this kind")
        else:
            findings.miss(block, "no block of the diagram does this")


def match_nodes(flat: Model, network: Network, plant: MultibodyPlant, findings: Findings) -> None:
    """Name the frame, or the signal at a joint, that every physical connection stands for.

    Parameters
    ----------
    findings : Findings
        They are noted there.
    """
    frames = _frames(plant)
    for index, node in enumerate(flat.nodes):
        item = {"what": "node", "ports": list(node)}
        if index not in network.frames:
            sids = {port.partition("#")[0] for port in node}
            lost = sids & {str(item.get("sid")) for item in findings.comparison.missing}
            counterpart = "nothing" if lost == sids else "a signal of a joint or a sensor"
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
    links = Links(plant)
    found = []
    for index in range(plant.num_frames()):
        frame = plant.get_frame(FrameIndex(index))
        number, X = links.locate(frame)
        found.append((number, frame.name(), X[:3, 3]))
    return found
