"""The proof of a script: its diagram puts out at the start what the model's does."""

from __future__ import annotations

import runpy
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from pydrake.systems.framework import System

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.diagram import Array, ModelDiagram
from drake_leg.simulink.running.porting.files import Script, data_name
from drake_leg.simulink.running.running import Runnable


def prove(script: Script, ready: Runnable, name: str) -> None:
    """Carry the script out, and compare what its diagram puts out at the start."""
    with TemporaryDirectory() as folder:
        place = Path(folder) / f"{name}.py"
        place.write_text(script.text, encoding="utf-8")
        if script.data:
            (Path(folder) / data_name(name)).write_text(script.data, encoding="utf-8")
        theirs = _model_of(place)
    _require_whole(ready.diagram, theirs)
    ours = _outputs(ready.diagram, ready)
    for port, values in _outputs(theirs, ready).items():
        if not np.array_equal(ours[port], values, equal_nan=True):
            raise InvalidValueError(
                f"the script would differ from the model at the start, in its port {port!r}"
            )


def _require_whole(ours: ModelDiagram, theirs: ModelDiagram) -> None:
    """Refuse a script without the contacts whose shapes lie in files of CAD programs."""
    if ours.mechanism is None or theirs.mechanism is None:
        return
    kept, missing = ours.mechanism.left_out, theirs.mechanism.left_out
    lost = [kind for kind, names in missing.items() if tuple(names) != tuple(kept.get(kind, ()))]
    if lost:
        raise InvalidValueError(
            f"a script would be without {', '.join(lost)}, whose shapes are in other files"
        )


def _model_of(place: Path) -> ModelDiagram:
    names: dict[str, Any] = runpy.run_path(str(place))
    made: ModelDiagram = names["Model"]()
    return made


def _outputs(diagram: ModelDiagram, ready: Runnable) -> dict[str, Array]:
    """Return what the systems of a diagram put out at the start."""
    context = diagram.CreateDefaultContext()
    systems: list[System] = [diagram.signals]
    if diagram.mechanism is not None:
        diagram.mechanism.start(context, ready.start)
        systems.append(diagram.mechanism)
    return {
        f"{system.get_name()}:{port.get_name()}": port.Eval(system.GetMyContextFromRoot(context))
        for system in systems
        for port in (system.get_output_port(n) for n in range(system.num_output_ports()))
    }
