"""What the script of a ported model uses: signals whose code it holds, a mechanism from data."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from drake_leg.simulink.dynamics.system import MechanismSystem, mechanism_dynamics
from drake_leg.simulink.matlab.folders import Folders, parsed
from drake_leg.simulink.matlab.frames import File
from drake_leg.simulink.model import Block, Model, Value
from drake_leg.simulink.networks.reflection import Reflected
from drake_leg.simulink.running.code import Recorded
from drake_leg.simulink.running.compiling import FUNCTIONS, Code, Ports
from drake_leg.simulink.running.diagram import Array, ModelDiagram
from drake_leg.simulink.running.network import SignalNetwork
from drake_leg.simulink.running.rates import Rate
from drake_leg.simulink.running.running import ModelRun, Runnable, run_model


@dataclass(frozen=True, eq=False, kw_only=True)
class WrittenCode(Code):
    """The signals of a model whose functions are written in a script."""

    source: str = ""
    scope: Mapping[str, Any] = field(default_factory=dict)
    x: Array = field(default_factory=lambda: np.zeros(0))
    memory: tuple[Any, ...] = ()
    rates: tuple[Rate, ...] = ()
    has_major: bool = False
    resets: bool = False
    has_edges: bool = False
    recorded: tuple[Recorded, ...] = ()
    stops: tuple[tuple[str, str], ...] = ()
    breaks: tuple[float, ...] = ()
    waves: tuple[tuple[float, float], ...] = ()
    needs_sensed: bool = False
    needs_efforts: bool = False
    states: tuple[str, ...] = ()
    fastest: float = 0.0
    begins: float = 0.0
    read_at_once: frozenset[str] = frozenset()
    closing: tuple[int, ...] = ()
    calls: tuple[Callable[..., Any], ...]  # those of its functions that do something

    def functions(self) -> dict[str, Callable[..., Any]]:
        """Return the functions by their names; what is not written does nothing."""
        idle = dict.fromkeys(FUNCTIONS, _nothing)
        return {**idle, **{function.__name__: function for function in self.calls}}


def _nothing(*_: object) -> Array:
    return np.zeros(0)


class WrittenFunctions(Folders):
    """MATLAB functions in files whose lines are given, by their names."""

    def __init__(self, lines: Mapping[str, Sequence[str]]) -> None:
        super().__init__()
        self._lines, self._read = lines, dict[str, File]()

    def code(self, name: str, beside: Path | None = None) -> Path | None:
        """Name the file that has a function."""
        return Path(f"{name}.m") if name in self._lines else None

    def function(self, name: str, beside: Path | None, *, known: bool) -> File | None:
        """Find the file of a function."""
        if name in self._lines and name not in self._read:
            tree = parsed("\n".join(self._lines[name]), f"{name}.m")
            functions = {one.name: one for one in tree.functions}
            self._read[name] = File(name=f"{name}.m", functions=functions, folder=Path())
        return self._read.get(name)


def shown(block: str, port: int, name: str, shape: tuple[int, ...] = ()) -> Recorded:
    """Describe a signal that a sink shows at a port."""
    value = np.zeros(shape) if shape else 0.0
    return Recorded(block=block, port=port, name=name, code="", value=value)


def mechanism_from(data: Mapping[str, Any]) -> MechanismSystem:
    """Build a mechanism from the data of its blocks and of what connects their ports."""
    blocks = [
        Block(
            sid=each["sid"],
            name=each["name"],
            type=each["type"],
            source=each.get("source", ""),
            system="",
            parameters={name: _value(value) for name, value in each["parameters"].items()},
            mask=tuple(each.get("mask", ())),
            path=each.get("path", each["name"]),
        )
        for each in data["blocks"]
    ]
    model = Model(
        name=data["name"],
        blocks=tuple(blocks),
        wires=(),
        nodes=tuple(tuple(node) for node in data["connections"]),
        functions=(),
        solver={},
        features={name: tuple(each) for name, each in data.get("features", {}).items()},
    )
    reflected = [Reflected(**each) for each in data.get("reflected", ())]
    return mechanism_dynamics(model, contact=data["contact"], reflected=reflected)


def _value(value: Any) -> Value:  # noqa: ANN401 - as JSON has it
    found = tuple(map(_value, value)) if isinstance(value, list) else value
    return cast(Value, found)


def positive(text: str) -> float:
    """Read a positive number of the command line.

    Raises
    ------
    ValueError
        If the text is none.
    """
    value = float(text)
    if not 0.0 < value < math.inf:
        raise ValueError(text)
    return value


def simulated(
    diagram: ModelDiagram,
    *,
    name: str,
    start: Array | None = None,
    accuracy: float | None = None,
    **solver: float,
) -> ModelRun:
    """Simulate a diagram as `drake-leg run` simulates its model.

    ``start`` is what enters the mechanism at the start; ``solver`` has the ``duration`` [s], and
    where the model's file has them, its ``tolerance``, ``longest_step`` [s] and ``fixed_step`` [s];
    it has ``stiff`` where the file's solver is one for stiff systems.
    """
    ready = Runnable(
        name=name,
        diagram=diagram,
        code=diagram.signals.code,
        ports=Ports(),
        network=SignalNetwork(nodes={}, commands={}, sensed=frozenset()),
        solver={key.replace("_", " "): value for key, value in solver.items()},
        start=start,
    )
    return run_model(ready, accuracy=accuracy)
