"""From a .slx file to a model."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import parameters
from drake_leg.simulink.diagram import Diagram, DrawnBlock, read_diagram
from drake_leg.simulink.file import SimulinkFile
from drake_leg.simulink.linking import Libraries
from drake_leg.simulink.model import Block, Model, Parameters, Value
from drake_leg.simulink.parameters import (
    Names,
    complaining,
    evaluate,
    names_of,
    require_finite,
    values_of,
    why_unknown,
)
from drake_leg.simulink.variants import choose_variants
from drake_leg.simulink.wiring import nodes_of, wires_of

_DEFAULTS = {
    "StartTime": "0.0",
    "StopTime": "10.0",
    "RelTol": "1e-3",
    "AbsTol": "auto",
    "MaxStep": "auto",
    "MinStep": "auto",
    "InitialStep": "auto",
    "FixedStep": "auto",
}
_UNBOUNDED = ("StopTime", "MaxStep")
_FIXED = re.compile(r"FixedStep\w*|ode(1|2|3|4|5|8|14x|1be|1b)")


def read_model(
    path: Path, *, paths: Sequence[Path] = (), variants: Mapping[str, str] | None = None
) -> Model:
    """Read a Simulink file; nothing in it is executed or unpacked to the disk.

    Values are evaluated when they are asked for, and blocks of unknown kinds are blocks, too:
    ``lacks.lacks_of`` lists what is not understood.

    Parameters
    ----------
    path : Path
        The file.
    paths : sequence of Path
        Folders where its libraries are looked for, after the folder of the file itself.
    variants : mapping, optional
        Choices of variant subsystems, by the path or name of the subsystem: the name or label of
        the choice. The others are chosen as the file says.

    Returns
    -------
    Model
        All blocks that are not commented out, those of subsystems included; the parts that a
        MATLAB Function block is made of are not blocks, and a block that is commented through is a
        wire.

    Raises
    ------
    InvalidValueError
        With the file, if it is not such a file or is damaged.
    """
    path = Path(path)
    try:
        file = SimulinkFile(path)
        drawn = read_diagram(file, Libraries(path.parent, paths))
        names = names_of(drawn.blocks.values())
        diagram = choose_variants(drawn, partial(_holds, names), variants)
        return _model(file, diagram, names)
    except InvalidValueError as error:
        raise InvalidValueError(f"{path}: {error}") from None


def _holds(names: Mapping[str, Names], block: DrawnBlock, condition: str) -> bool:
    """Whether the condition of a variant holds."""
    with complaining(f"the condition {condition!r}", condition):
        return bool(np.all(evaluate(condition, "", "", names[block.sid])))


def _model(file: SimulinkFile, diagram: Diagram, names: Mapping[str, Names]) -> Model:
    return Model(
        name=file.path.stem,
        blocks=tuple(
            Block(
                sid=block.sid,
                name=block.name,
                type=block.type,
                source=block.source,
                system=block.system,
                parameters=values_of(block, names[block.sid]),
                mask=tuple(block.mask.values),
                unknown=why_unknown(block),
            )
            for block in diagram.blocks.values()
        ),
        wires=wires_of(diagram),
        nodes=nodes_of(diagram),
        functions=tuple(diagram.functions),
        solver=_solver(file.configuration),
    )


def _solver(configuration: Element | None) -> Parameters:
    """Read the first configuration's times [s] and tolerances, defaults where they are absent."""
    texts = _texts(configuration)
    solver = texts.get("SolverName") or texts.get("Solver") or "VariableStepAuto"
    kind = "Fixed-step" if _FIXED.fullmatch(solver) else "Variable-step"
    found = Parameters()
    found.add("Solver", solver)
    found.add("SolverType", texts.get("SolverType", kind))
    for name, default in _DEFAULTS.items():
        text = texts.get(name, default)
        found.add(name, partial(_setting, name, text))
    return found


def _setting(name: str, text: str) -> Value:
    with complaining(f"solver setting {name}", text):
        found = evaluate(text, "", "")
        require_finite(found, text, unbounded=name in _UNBOUNDED)
    return found


def _texts(configuration: Element | None) -> dict[str, str]:
    if configuration is None:
        return {}
    for component in configuration.iter("Object"):
        if component.get("ClassName", "").endswith("SolverCC"):
            return parameters(component)
    for component in configuration.iter():
        texts = parameters(component)
        if "StopTime" in texts:
            return texts
    return {}
