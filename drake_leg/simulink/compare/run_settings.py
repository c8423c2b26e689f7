"""What a run settles beside its plant's mechanism: the foot's sensor, gravity, times, frames."""

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
from drake_leg.simulink.compare.mechanics import compare_sensors
from drake_leg.simulink.compare.of_plant import Links
from drake_leg.simulink.compare.sides import Sides
from drake_leg.simulink.model import Block, vector
from drake_leg.systems.frame_sensor import FrameSensor

SAME_PLACE = 1e-9  # [m]
ZERO = (0.0, 0.0, 0.0)


def compare_sensor(sides: Sides) -> Iterator[Verdict]:
    """Compare the sensor of the foot."""
    pair = next(iter(sides.mechanisms.matching.sensors.items()), None)
    names = sides.live.of_type(FrameSensor)
    if pair is None:
        for sensor in sides.mechanisms.ours.sensors:
            block = sides.block(sensor.sid)
            yield missing(block, "the diagram senses no frame against another")
        return
    block = sides.block(sides.mechanisms.ours.sensors[pair[0]].sid)
    yield from compare_sensors(sides.mechanisms)
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
    for sensor in sides.mechanisms.ours.sensors:
        if sensor.number != pair[0]:
            yield missing(sides.block(sensor.sid), "the diagram senses one frame only")


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
        if index not in sides.mechanisms.frames:
            sids = {port.partition("#")[0] for port in node}
            lost = sids <= judged.missing.keys()
            counterpart = "nothing" if lost else "a signal of a joint or a sensor"
        else:
            body, X = sides.mechanisms.frames[index]
            theirs = sides.mechanisms.matching.bodies.get(body)
            near = [
                name
                for other, name, p in frames
                if other == theirs and np.abs(p - X[:3, 3]).max() < SAME_PLACE
            ]
            shown = ", ".join(f"{value:.6g}" for value in X[:3, 3])
            counterpart = f"frame {near[0]!r}" if near else f"a pose of link {body} at ({shown}) m"
            counterpart = "nothing" if theirs is None else counterpart
        item = {"what": "node", "ports": list(node), "counterpart": counterpart}
        yield Verdict(list="matched", item=item)


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
