"""What sinks show as named columns, and as the axes of their figures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulation.recording import Recording
from drake_leg.simulink.model import split_port
from drake_leg.simulink.running.code import Recorded
from drake_leg.simulink.running.network import Node, SignalNetwork
from drake_leg.simulink.running.settings import shape_of

Array = NDArray[np.float64]
TIME = "time[s]"
WORKSPACE, XY = "ToWorkspace", "XY Graph"


class Label(NamedTuple):
    """What one number of a signal that a sink shows is called."""

    header: str  # unique
    name: str  # as in a legend
    sink: str  # path of the block
    kind: str  # of the block
    port: int
    signal: str  # "" where it has no name


@dataclass(frozen=True, eq=False, kw_only=True)
class Column:
    """One number of a signal that a sink shows, over time."""

    label: Label
    values: Array  # (rows,)


def labels_of(recorded: Sequence[Recorded], network: SignalNetwork) -> tuple[Label, ...]:
    """Name what is recorded: ``Scope.theta``, ``simout(1)``."""
    sinks = {node.block.path or node.block.name: node for node in network.nodes.values()}
    short = _shortened({each.block for each in recorded})
    used = {"time"}
    found: list[Label] = []
    for each in recorded:
        node = sinks.get(each.block)
        name = _plain(each.name or _driver(network, node, each.port))
        base = _base(each, node, short[each.block], name)
        found += [
            Label(
                header=unique(f"{base}{index}", used),
                name=f"{name}{index}",
                sink=each.block,
                kind=node.block.kind if node else "",
                port=each.port,
                signal=each.name,
            )
            for index in _indices(each.value)
        ]
    return tuple(found)


def columns_of(labels: Sequence[Label], shown: Iterable[Array]) -> tuple[Column, ...]:
    """Give labels the values that were recorded, (rows, width) for each signal."""
    values = [column for signal in shown for column in signal.T]
    return tuple(Column(label=label, values=one) for label, one in zip(labels, values, strict=True))


def recording_of(time: Array, columns: Iterable[Column]) -> Recording:
    """Return the table of a run."""
    return Recording({TIME: time, **{each.label.header: each.values for each in columns}})


def _base(recorded: Recorded, node: Node | None, sink: str, name: str) -> str:
    if node is not None and node.block.kind == WORKSPACE:
        return name
    alone = node is not None and sum(port is not None for port in node.inputs) == 1
    if name == sink or (alone and not recorded.name):
        return sink
    return f"{sink}.{name}"


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


def unique(name: str, used: set[str]) -> str:
    """Number a name that is in use, and note it."""
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
        sinks.setdefault(column.label.sink, {}).setdefault(column.label.port, []).append(column)
    short = _shortened(set(sinks))
    used: set[str] = set()
    found = []
    for sink, ports in sinks.items():
        first = next(iter(ports.values()))[0]
        word = re.sub(r"[^\w.-]+", "_", short[sink]).strip("._") or "sink"
        found.append(
            SinkFigure(
                file_name=unique(word[:60].lower(), used),
                title=_plain(sink),
                axes=tuple(tuple(each) for each in ports.values()),
                is_xy=first.label.kind == XY and len(ports) == 2,
            )
        )
    return tuple(found)
