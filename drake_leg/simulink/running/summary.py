"""What a run of a model recorded: named columns, axes as its sinks would show, a summary."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulation.recording import Recording
from drake_leg.simulink.catalogue import JOINTS
from drake_leg.simulink.model import Model, split_port
from drake_leg.simulink.running.code import Recorded
from drake_leg.simulink.running.network import Node, SignalNetwork
from drake_leg.simulink.running.running import Array, ModelRun, Runnable
from drake_leg.simulink.running.settings import shape_of

SETTINGS = ("Solver", "SolverType", "StartTime", "StopTime", "RelTol", "AbsTol", "MaxStep",
            "FixedStep")  # fmt: skip
MOST_NAMES = 60  # of states and skipped callbacks that a summary lists
TIME = "time[s]"
WORKSPACE, XY = "ToWorkspace", "XY Graph"
NO_SINK = "no Scope or other sink of the model shows a signal"


@dataclass(frozen=True, eq=False, kw_only=True)
class Column:
    """One number of a signal that a sink shows, over time."""

    header: str  # unique
    label: str  # as in a legend
    sink: str  # path of the block
    kind: str  # of the block
    port: int
    signal: str  # "" where it has no name
    values: Array  # (rows,)


def columns_of(ready: Runnable, run: ModelRun) -> tuple[Column, ...]:
    """Name what was recorded: ``Scope.theta``, ``simout(1)``."""
    sinks = {_place(node): node for node in ready.network.nodes.values()}
    short = _shortened({each.block for each in ready.code.recorded})
    used = {"time"}
    found: list[Column] = []
    for recorded, shown in zip(ready.code.recorded, run.shown, strict=True):
        node = sinks.get(recorded.block)
        label = _plain(recorded.name or _driver(ready.network, node, recorded.port))
        base = _base(recorded, node, short[recorded.block], label)
        for index, values in zip(_indices(recorded.value), shown.values.T, strict=True):
            found.append(
                Column(
                    header=_unique(f"{base}{index}", used),
                    label=f"{label}{index}",
                    sink=recorded.block,
                    kind=node.block.kind if node else "",
                    port=recorded.port,
                    signal=recorded.name,
                    values=values,
                )
            )
    return tuple(found)


def recording_of(run: ModelRun, columns: Iterable[Column]) -> Recording:
    """Return the table of a run."""
    return Recording({TIME: run.time, **{each.header: each.values for each in columns}})


def _place(node: Node) -> str:
    return node.block.path or node.block.name


def _base(recorded: Recorded, node: Node | None, sink: str, label: str) -> str:
    if node is not None and node.block.kind == WORKSPACE:
        return label
    alone = node is not None and sum(port is not None for port in node.inputs) == 1
    if label == sink or (alone and not recorded.name):
        return sink
    return f"{sink}.{label}"


def _driver(network: SignalNetwork, node: Node | None, port: int) -> str:
    """Name the block that drives a port, as a Scope's legend does where a signal has no name."""
    source = node.inputs[port - 1] if node is not None else None
    if source is None:
        return f"port {port}"
    sid, _, number = split_port(source)
    driver = network.nodes.get(sid)
    if driver is None:
        return f"port {port}"
    return driver.block.name if len(driver.outputs) < 2 else f"{driver.block.name}:{number}"


def _indices(value: Any) -> list[str]:  # noqa: ANN401 - a signal
    """Number the entries of a signal, a matrix by columns."""
    shape = shape_of(value)
    if not shape:
        return [""]
    if len(shape) == 1:
        return [f"({n + 1})" for n in range(shape[0])]
    return [f"({row + 1},{column + 1})" for column in range(shape[1]) for row in range(shape[0])]


def _plain(name: str) -> str:
    """Write a name so that a header can hold it, where brackets hold units."""
    return " ".join(name.replace("[", "(").replace("]", ")").split())


def _shortened(paths: set[str]) -> dict[str, str]:
    """Shorten paths to as many of their last names as tell them apart."""
    found = {}
    for path in paths:
        parts = path.split("/")
        for count in range(1, len(parts) + 1):
            short = "/".join(parts[-count:])
            if sum(other == short or other.endswith(f"/{short}") for other in paths) == 1:
                break
        found[path] = _plain(short)
    return found


def _unique(name: str, used: set[str]) -> str:
    found, number = name, 2
    while found in used:
        found, number = f"{name}_{number}", number + 1
    used.add(found)
    return found


# --- as the sinks would show it ---------------------------------------------------------------


@dataclass(frozen=True, eq=False, kw_only=True)
class SinkFigure:
    """What a sink shows: axes, one for each port."""

    file_name: str  # without ending
    title: str
    axes: tuple[tuple[Column, ...], ...]
    is_xy: bool  # the second port over the first


def figures_of(columns: Iterable[Column]) -> tuple[SinkFigure, ...]:
    """Group the columns as the sinks show them."""
    sinks: dict[str, dict[int, list[Column]]] = {}
    for column in columns:
        sinks.setdefault(column.sink, {}).setdefault(column.port, []).append(column)
    short = _shortened(set(sinks))
    used: set[str] = set()
    found = []
    for sink, ports in sinks.items():
        first = next(iter(ports.values()))[0]
        word = re.sub(r"[^\w.-]+", "_", short[sink]).strip("._") or "sink"
        found.append(
            SinkFigure(
                file_name=_unique(word[:60].lower(), used),
                title=_plain(sink),
                axes=tuple(tuple(each) for each in ports.values()),
                is_xy=first.kind == XY and len(ports) == 2,
            )
        )
    return tuple(found)


# --- the summary -------------------------------------------------------------------------------


def summary_of(
    model: Model,
    ready: Runnable,
    run: ModelRun,
    columns: Iterable[Column],
    remarks: Iterable[str],
) -> dict[str, Any]:
    """Tell what was understood of a model, how it ran, and what was recorded."""
    columns = tuple(columns)
    return {
        "model": model.name,
        "duration_s": ready.solver["duration"],
        "ended_at_s": run.ended,
        "stopped_at_s": None if run.complete else run.ended,
        "stop_reason": None if run.complete else run.stopped,
        "ended_by": run.stopped if run.by_block else None,
        "rows": len(run.time),
        "steps": run.steps,
        "wall_time_s": run.seconds,
        "real_time_factor": run.ended / run.seconds if run.seconds else 0.0,
        "solver": {
            "of_the_file": _solver_of(model),
            "here": {
                "integrator": run.integrator,
                "accuracy": run.accuracy,
                "max_step_s": run.longest_step,
            },
        },
        "understood": _understood(model, ready),
        "columns": [
            {
                "header": column.header,
                "block": column.sink,
                "kind": column.kind,
                "port": column.port,
                "signal": column.signal,
            }
            for column in columns
        ],
        "remarks": [*remarks],
    }


def _solver_of(model: Model) -> dict[str, Any]:
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
        }
    return found


def remarks_of(model: Model, ready: Runnable, run: ModelRun) -> Iterator[str]:
    """Say what of a model was skipped or left out, and what runs otherwise than in Simulink."""
    skipped = [str(one) for one in model.variables.workspace.skipped] if model.variables else []
    if skipped:
        more = f"; and {len(skipped) - MOST_NAMES} more" if len(skipped) > MOST_NAMES else ""
        yield f"skipped in scripts and callbacks: {'; '.join(skipped[:MOST_NAMES])}{more}"
    if ready.diagram.mechanism is not None and ready.diagram.mechanism.left_out:
        yield f"left out of the mechanism: {_counted(ready.diagram.mechanism.left_out)}"
    if "fixed step" in ready.solver:
        yield (
            f"the file's solver takes fixed steps of {ready.solver['fixed step']:g} s; here the "
            f"continuous states are integrated by {run.integrator} with steps of its own choice, "
            "and delays of continuous signals take that step"
        )
    if not run.shown:
        yield NO_SINK
    yield from run.remarks


def _counted(left_out: Mapping[str, Iterable[str]]) -> str:
    return ", ".join(f"{kind} ({len(tuple(names))})" for kind, names in left_out.items())
