"""From a .slx file to a model."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.simulink.archive import parameters as texts_of
from drake_leg.simulink.catalogue import OLD_NAMES
from drake_leg.simulink.diagram import Diagram, DrawnBlock, mask_of_file, read_diagram
from drake_leg.simulink.file import SimulinkFile, simulink_file
from drake_leg.simulink.linking import Libraries
from drake_leg.simulink.model import LOOPS, Block, Model, Parameters, Value
from drake_leg.simulink.overrides import overridden
from drake_leg.simulink.parameters import (
    complaining,
    evaluate,
    require_finite,
    values_of,
    why_unknown,
)
from drake_leg.simulink.placed_features import placed_features
from drake_leg.simulink.scopes import Scope, settled
from drake_leg.simulink.sources import Given, Variables, variables_of
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
    path: Path,
    *,
    paths: Sequence[Path] = (),
    variants: Mapping[str, str] | None = None,
    init: Sequence[Path] = (),
    values: Mapping[str, Any] | None = None,
    features: Mapping[str, Sequence[float]] | None = None,
    parameters: Mapping[str, str] | None = None,
) -> Model:
    """Read a Simulink file; nothing in it is executed or unpacked to the disk.

    Values are evaluated when they are asked for, and blocks of unknown kinds are blocks, too:
    ``lacks.lacks_of`` lists what is not understood.

    Parameters
    ----------
    path : Path
        The file.
    paths : sequence of Path
        Folders where its libraries, scripts and data are looked for, after the folder of the file
        itself; all folders inside them are searched, too.
    variants : mapping, optional
        Choices of variant subsystems, by the path or name of the subsystem: the name or label of
        the choice. The others are chosen as the file says.
    init : sequence of Path, optional
        Scripts and .mat files that give values to variables, as a person runs them before the
        model.
    values : mapping, optional
        Values of variables, before all others: numbers, arrays, or MATLAB text.
    features : mapping, optional
        Where features of files of CAD programs lie on which frames are, ``leg.step:planar surface
        2``: a point in the solid's reference frame [m], and after it the direction of its axis or
        normal, where a frame is along it.
    parameters : mapping, optional
        MATLAB texts that parameters of blocks have instead of those in the file, by block (path or
        name) and parameter: ``{"Link 1:Mass": "0.3"}``, in the unit of the file.

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
        file = simulink_file(path)
        drawn = read_diagram(file, Libraries(path.parent, paths))
        drawn = overridden(drawn, parameters or {})
        given = Given(values=values or {}, init=tuple(map(Path, init)), paths=tuple(paths))
        variables = variables_of(file, given, partial(_mentioned, drawn), _Texts(drawn))
        _require_used(given, file, drawn)
        drawn, scopes = settled(drawn, variables, mask_of_file(file))
        diagram = choose_variants(drawn, partial(_holds, scopes), variants)
        model = _model(file, diagram, scopes, variables)
        return replace(model, features=placed_features(features or {}, model.blocks))
    except InvalidValueError as error:
        raise InvalidValueError(f"{path}: {error}") from None


class _Texts:
    """The texts of a diagram's parameters, as callbacks read them before any has a value."""

    def __init__(self, diagram: Diagram) -> None:
        self._blocks = {block.path: block for block in diagram.blocks.values()}

    def get(self, path: str, name: str) -> str | None:
        """Find a parameter of the block of a path, which begins with the name of the model."""
        block = self._blocks.get(path.partition("/")[2])
        if block is None:
            return None
        names = OLD_NAMES.get("OverrideUsingVariant" if name == "ActiveVariant" else name, (name,))
        texts = block.texts | block.mask.values
        return next((texts[one] for one in names if one in texts), None)


def _require_used(given: Given, file: SimulinkFile, diagram: Diagram) -> None:
    """Refuse a value of a variable that nothing in the model can use."""
    scripts = [*given.init, *filter(str.strip, file.callbacks.values())]
    workspaces = [each.workspace for each in (file, *diagram.models.values())]
    code = " ".join(workspace.get("WSMATLABCode", "") for workspace in workspaces)
    code += str(_solver_texts(file.configuration))
    words = _words(diagram) if given.values else set()
    for name in given.values:
        if not scripts and name not in words and not re.search(rf"\b{re.escape(name)}\b", code):
            raise InvalidValueError(
                f"the model uses no variable {name!r}",
                advice=did_you_mean(name, words, "leave its value out"),
            )


def _words(diagram: Diagram) -> set[str]:
    """Words in the parameters of all blocks."""
    return {word for text in _all_texts(diagram) for word in re.findall(r"[A-Za-z]\w*", text)}


def _mentioned(diagram: Diagram, name: str) -> bool:
    """Whether the text of a parameter holds a name."""
    return any(name in text for text in _all_texts(diagram))


def _all_texts(diagram: Diagram) -> Iterator[str]:
    for block in diagram.blocks.values():
        yield from block.texts.values()
        yield from block.mask.values.values()


def _holds(scopes: Mapping[str, Scope], block: DrawnBlock, condition: str) -> bool:
    """Whether the condition of a variant holds."""
    with complaining(f"the condition {condition!r}", condition):
        return bool(np.all(evaluate(condition, "", "", scopes[block.sid])))


def _model(
    file: SimulinkFile, diagram: Diagram, scopes: Mapping[str, Scope], variables: Variables
) -> Model:
    return Model(
        name=file.path.stem,
        blocks=tuple(
            Block(
                sid=block.sid,
                name=block.name,
                type=block.type,
                source=block.source,
                system=block.system,
                parameters=values_of(block, scopes[block.sid]),
                mask=tuple(block.mask.values),
                unknown=why_unknown(block),
                path=block.path,
                ports=block.ports,
            )
            for block in diagram.blocks.values()
        ),
        wires=wires_of(diagram),
        nodes=nodes_of(diagram),
        functions=tuple(diagram.functions),
        solver=_solver(file.configuration, Scope(variables)),
        variables=variables,
        is_library=file.is_library,
        logged=tuple(
            (f"{block.sid}#out:{number}", name)
            for block in diagram.blocks.values()
            for number, name in block.logged.items()
        ),
    )


def _solver(configuration: Element | None, scope: Scope) -> Parameters:
    """Read the first configuration's times [s] and tolerances, defaults where they are absent."""
    texts = _solver_texts(configuration)
    solver = texts.get("SolverName") or texts.get("Solver") or "VariableStepAuto"
    kind = "Fixed-step" if _FIXED.fullmatch(solver) else "Variable-step"
    found = Parameters()
    found.add("Solver", solver)
    found.add("SolverType", texts.get("SolverType", kind))
    for name, default in _DEFAULTS.items():
        text = texts.get(name, default)
        found.add(name, partial(_setting, name, text, scope))
    loops = _of_loops(configuration)
    if loops:
        found.add(LOOPS, loops)
    return found


def _setting(name: str, text: str, scope: Scope) -> Value:
    with complaining(f"solver setting {name}", text):
        found = evaluate(text, "", "", scope)
        require_finite(found, text, unbounded=name in _UNBOUNDED, scope=scope)
    return found


def _of_loops(configuration: Element | None) -> str:
    """Return what Simulink does about algebraic loops, none, warning or error; "" if not said."""
    components = () if configuration is None else configuration.iter()
    return next((text for each in components if (text := texts_of(each).get(LOOPS))), "")


def _solver_texts(configuration: Element | None) -> dict[str, str]:
    if configuration is None:
        return {}
    for component in configuration.iter("Object"):
        if component.get("ClassName", "").endswith("SolverCC"):
            return texts_of(component)
    for component in configuration.iter():
        texts = texts_of(component)
        if "StopTime" in texts:
            return texts
    return {}
