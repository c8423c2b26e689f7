"""The summary of a run of a model: what was understood, how it ran, what was recorded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from drake_leg.arguments import some_of
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import JOINTS
from drake_leg.simulink.dynamics.driven import DrivenMechanism
from drake_leg.simulink.dynamics.system import MechanismSystem
from drake_leg.simulink.model import Model, split_port
from drake_leg.simulink.running.closing import ABOUT
from drake_leg.simulink.running.columns import Column
from drake_leg.simulink.running.left_out import motion_of_another
from drake_leg.simulink.running.motions import FILTER
from drake_leg.simulink.running.running import ModelRun, Runnable

SETTINGS = ("Solver", "SolverType", "StartTime", "StopTime", "RelTol", "AbsTol", "MaxStep",
            "FixedStep")  # fmt: skip
MOST_NAMES = 60  # of states that a summary lists
SHOWN = 3  # of a kind, in a remark; the summary lists all
LAWS = {
    "smooth": "the blocks' law, which never pulls",
    "pulling": "the blocks' law, whose damper may pull",
    "drake": "Drake's point contact",
}
NO_SINK = "no Scope or other sink of the model shows a signal"


def summary_of(
    model: Model,
    ready: Runnable,
    run: ModelRun,
    columns: Iterable[Column],
    remarks: Iterable[str],
) -> dict[str, Any]:
    """Tell what was understood of a model, how it ran, and what was recorded."""
    return {
        "model": model.name,
        "complete": run.complete and not ready.left_out,
        "left_out": {kind: [*names] for kind, names in ready.left_out.items()},
        "duration_s": ready.solver["duration"],
        "started_at_s": run.began,
        "ended_at_s": run.ended,
        "stopped_at_s": None if run.complete else run.ended,
        "stop_reason": None if run.complete else run.stopped,
        "ended_by": run.stopped if run.by_block else None,
        "rows": len(run.time),
        "steps": run.steps,
        "wall_time_s": run.seconds,
        "real_time_factor": (run.ended - run.began) / run.seconds if run.seconds else 0.0,
        "solver": {
            "of_the_file": solver_of(model),
            "here": {
                "integrator": run.integrator,
                "accuracy": run.accuracy,
                "max_step_s": run.longest_step,
            },
        },
        "understood": _understood(model, ready),
        "columns": [
            {
                "header": label.header,
                "block": label.sink,
                "kind": label.kind,
                "port": label.port,
                "signal": label.signal,
            }
            for label in (column.label for column in columns)
        ],
        "skipped": skipped_in(model),
        "remarks": [*remarks],
    }


def skipped_in(model: Model) -> list[str]:
    """List what scripts and callbacks do that is not done here."""
    return [str(one) for one in model.variables.workspace.skipped] if model.variables else []


def solver_of(model: Model) -> dict[str, Any]:
    """Return the solver's settings in the file, as JSON can hold them."""
    found = {}
    for name in SETTINGS:
        try:
            value = model.solver.get(name)
        except InvalidValueError as error:
            value = getattr(error, "text", "")
        if value is not None:
            finite = not isinstance(value, float) or np.isfinite(value)
            found[name] = value if finite else str(value)
    return found


def _understood(model: Model, ready: Runnable) -> dict[str, Any]:
    code, mechanism = ready.code, ready.diagram.mechanism
    counted = Counter(node.block.kind for node in ready.network.nodes.values())
    found: dict[str, Any] = {
        "blocks": len(model.blocks),
        "signal_blocks": len(ready.network.nodes),
        "kinds_of_signal_blocks": dict(counted.most_common()),
        "continuous_states": len(code.x),
        "blocks_with_states": [*code.states[:MOST_NAMES]],
        "sample_times_s": [{"period": period, "offset": offset} for period, offset in code.rates],
        "algebraic_loops": [
            {"blocks": [block.path for block in loop.blocks], "unknown_signals": len(loop.torn)}
            for loop in code.loops
        ],
        "forces_and_accelerations_in_loops": len(code.closing),
        "networks": _of_networks(model, ready),
        "mechanism": None,
    }
    if mechanism is not None:
        plant = mechanism.plant
        found["mechanism"] = {
            "bodies": plant.num_bodies() - 1,
            "joints": sum(
                block.source.startswith("sm_lib/") and block.kind in JOINTS
                for block in model.blocks
            ),
            "positions": plant.num_positions(),
            "velocities": plant.num_velocities(),
            "inputs": len(mechanism.inputs),
            "motions": len(mechanism.motions),
            "sensed": len(mechanism.sensed) + len(mechanism.efforts),
            "contact": _contact(mechanism),
        }
    return found


def _of_networks(model: Model, ready: Runnable) -> dict[str, Any]:
    """Count what runs of networks of one dimension, and name what they add to joints."""
    names = {block.sid: block.path for block in model.blocks}
    return {
        "blocks": sum(node.part is not None for node in ready.network.nodes.values()),
        "inertias_at_joints": [
            {"joint": names[split_port(one.driven)[0]], "inertia": one.inertia}
            for one in ready.network.reflected
        ],
    }


def _contact(mechanism: MechanismSystem | DrivenMechanism) -> str | None:
    """Name the law of contact, where bodies may touch."""
    if isinstance(mechanism, MechanismSystem) and mechanism.touches:
        return LAWS[mechanism.contact]
    return None


def remarks_of(model: Model, ready: Runnable, run: ModelRun) -> Iterator[str]:
    """Say what of a model was skipped or left out, and what runs otherwise than in Simulink."""
    yield from motion_of_another(ready.left_out)
    skipped = skipped_in(model)
    if skipped:
        more = f"; and {len(skipped) - SHOWN} more" if len(skipped) > SHOWN else ""
        yield f"skipped in scripts and callbacks: {'; '.join(skipped[:SHOWN])}{more}"
    if ready.network.entries:
        names = some_of([block.name for block in ready.network.entries], SHOWN)
        yield f"nothing is given at the model's own ports, which are 0: {names}"
    mechanism = ready.diagram.mechanism
    if isinstance(mechanism, MechanismSystem) and (ends := mechanism.unguided_loops(ready.start)):
        yield (
            f"no state target says to which side the loops at {some_of(ends, SHOWN)} close, and "
            "Simulink may start from the mirror image: give one of their joints a position target"
        )
    if ready.code.lagging:
        nodes = ready.network.nodes
        sids = [split_port(port)[0] for port in ready.code.lagging]
        names = ", ".join(nodes[sid].block.name if sid in nodes else "a sensor" for sid in sids)
        yield (
            f"nothing gives derivatives of the motions from {names}: joints follow them by a "
            f"filter of second order with {1e3 * FILTER:g} ms"
        )
    steady = [block.name for block in model.blocks if block.parameters.get("DoDC") == "on"]
    if steady:
        yield (
            f"the run starts at the targets of its states, not at rest as {', '.join(steady)} asks"
        )
    if "fixed step" in ready.solver:
        step = f"{ready.solver['fixed step']:g} s"
        yield (
            f"the continuous states are integrated by {run.integrator} with the fixed steps of "
            f"the file's solver, {step}, on which some blocks' outputs depend"
            if run.accuracy is None
            else f"the file's solver takes fixed steps of {step}; here the continuous states are "
            f"integrated by {run.integrator} with steps of its own choice, and delays of "
            "continuous signals take that step"
        )
    loops = ready.code.loops
    if loops:
        more = f"; and {len(loops) - SHOWN} more" if len(loops) > SHOWN else ""
        names = "; ".join(loop.names for loop in loops[:SHOWN])
        yield f"solved by Newton's method, algebraic loops of {names}{more}"
    if ready.code.closing:
        yield f"solved by Newton's method, {ABOUT}"
    if not run.shown:
        joints = ready.diagram.mechanism is not None
        yield f"{NO_SINK}{', so the joints alone are recorded' if joints else ''}"
    yield from run.remarks
