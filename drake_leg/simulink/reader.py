"""From a .slx file to a model."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import Parts, parameters, parse_markup
from drake_leg.simulink.diagram import Charts, read_diagram
from drake_leg.simulink.model import Block, Model, Parameters, Value
from drake_leg.simulink.parameters import (
    complaining,
    evaluate,
    names_of,
    require_finite,
    values_of,
    why_unknown,
)
from drake_leg.simulink.wiring import nodes_of, wires_of

_ROOT = "simulink/systems/system_root.xml"
_WHOLE = "simulink/blockdiagram.xml"  # in older files the diagram, too
_CONFIGURATION = "simulink/configSet0.xml"
_STATEFLOW = re.compile(r"simulink/stateflow(\.xml|/(machine|chart_\w+)\.xml)")
_SYSTEM = re.compile(r"\w{1,80}")
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


def read_model(path: Path) -> Model:
    """Read a Simulink file; nothing in it is executed or unpacked to the disk.

    Values are evaluated when they are asked for, and blocks of unknown kinds are blocks, too:
    ``lacks.lacks_of`` lists what is not understood.

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
        return _File(Parts(path)).model(path.stem)
    except InvalidValueError as error:
        raise InvalidValueError(f"{path}: {error}") from None


class _File:
    """The parts of a file as trees, each parsed once."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._trees: dict[str, Element | None] = {}

    def model(self, name: str) -> Model:
        top = self._top()
        charts = Charts(self._stateflow())
        diagram = read_diagram(top, self._system, charts)
        names = names_of(diagram.blocks.values())
        return Model(
            name=name,
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
            solver=_solver(self._configuration()),
        )

    def _tree(self, part: str) -> Element | None:
        if part not in self._trees:
            content = self._parts.read(part)
            self._trees[part] = None if content is None else parse_markup(content, part)
        return self._trees[part]

    def _top(self) -> Element:
        root = self._tree(_ROOT)
        if root is not None:
            return root
        whole = self._tree(_WHOLE)
        if whole is None:
            raise InvalidValueError(
                f"it has no part {_ROOT} and no {_WHOLE}: it is not a model, or a protected "
                "one; choose a .slx that Simulink saved"
            )
        for holder in ("Model", "Library", "Subsystem"):
            system = whole.find(f"{holder}/System")
            if system is not None:
                return system if system.get("Ref") is None else self._system(system.get("Ref", ""))
        raise InvalidValueError(f"its part {_WHOLE} has no diagram: save the model again")

    def _system(self, name: str) -> Element:
        system = self._tree(f"simulink/systems/{name}.xml") if _SYSTEM.fullmatch(name) else None
        if system is None:
            raise InvalidValueError(
                f"it has no part for the system {name[:60]!r}: save the model again in Simulink"
            )
        return system

    def _stateflow(self) -> list[Element]:
        names = [name for name in self._parts.names() if _STATEFLOW.fullmatch(name)]
        trees = [self._tree(name) for name in (*names, _WHOLE)]
        return [tree for tree in trees if tree is not None]

    def _configuration(self) -> Element | None:
        own = self._tree(_CONFIGURATION)
        return self._tree(_WHOLE) if own is None else own


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
        found.add(name, partial(_setting, name, text), text)
    return found


def _setting(name: str, text: str) -> Value:
    with complaining(f"solver setting {name}"):
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
