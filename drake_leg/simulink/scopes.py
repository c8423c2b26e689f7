"""What names mean in a block: those of the masks around it, then the model's variables."""

from __future__ import annotations

import math
import re
from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.catalogue import OLD_NAMES
from drake_leg.simulink.diagram import Diagram, DrawnBlock
from drake_leg.simulink.matlab.data import array_of
from drake_leg.simulink.matlab.names import names_in
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.program import parsed_expression, plain, value
from drake_leg.simulink.model import Numbers
from drake_leg.simulink.sources import Variables, no_variables, variables_inside

_INFINITE = re.compile(r"\binf\b", re.IGNORECASE)
_SHOWN = 8  # choices in an error
_NAMED = re.compile(r"[A-Za-z]")


class Scope:
    """The names that a block may use; values of masks are evaluated when one is used.

    Parameters
    ----------
    variables : Variables
        Those of the model.
    block : DrawnBlock, optional
        A masked block, whose names come first.
    around : Scope, optional
        What the values of its mask are evaluated with, and what comes next.
    paths : mapping, optional
        All blocks by their paths.
    """

    def __init__(
        self,
        variables: Variables,
        block: DrawnBlock | None = None,
        around: Scope | None = None,
        paths: Mapping[str, DrawnBlock] | None = None,
    ) -> None:
        self.variables, self._block, self._around = variables, block, around
        self._paths = paths or {}

    def evaluate(self, text: str) -> Any:  # noqa: ANN401 - any value of MATLAB text
        """Evaluate an expression.

        Raises
        ------
        InvalidValueError
            If it is not well formed or uses what is not known, whose names it has.
        """
        try:
            used = names_in(parsed_expression(text))
        except MatlabError as fault:
            raise InvalidValueError(str(fault)) from None
        lacking = [self.lacking[name] for name in used if name in self.lacking]
        variables = self.variables
        local: Mapping[str, Any] = ChainMap(self.values, variables.own)
        if lacking:
            missing = variables.workspace.missing(used, local)
            masks = (name for error in lacking for name in error.names)
            names = dict.fromkeys((*masks, *(name for name in missing if name not in self.lacking)))
            raise UnknownValueError("; ".join(map(str, lacking)), names=names)
        found = variables.workspace.evaluate(text, local=local)
        for name in used:
            if name not in self.values:
                variables.note(name)
        return found

    def numbers(self, text: str) -> Numbers:
        """Evaluate an expression to numbers, of which some may be infinite."""
        if not _NAMED.search(text):
            return value(text, unbounded=True)
        try:
            return plain(self.evaluate(text), unbounded=True)
        except MatlabError as fault:
            raise InvalidValueError(str(fault)) from None

    def says_infinite(self, text: str) -> bool:
        """Whether a text says ``inf``, or uses a name that is infinite."""
        if says_infinite(text):
            return True
        return any(_is_infinite(self.values.get(name)) for name in _words(text))

    @cached_property
    def _settled(self) -> _Settled:
        if self._block is None or self._around is None:
            return _Settled()
        return _mask_values(self._block, self._around, self._paths)

    @property
    def values(self) -> dict[str, Any]:
        """Values of the masks' names."""
        return self._settled.values

    @property
    def lacking(self) -> dict[str, UnknownValueError]:
        """Names of the masks that have no value, and why."""
        return self._settled.lacking

    @property
    def changes(self) -> dict[str, dict[str, str]]:
        """Parameters of blocks inside that the mask gives other texts, by the block's path."""
        return self._settled.changes


def settled(
    diagram: Diagram, variables: Variables | None = None, masked: DrawnBlock | None = None
) -> tuple[Diagram, dict[str, Scope]]:
    """Give every block its names, and what masks change in the blocks inside them.

    The names that a block may use are those of its own mask, evaluated with the names around it,
    then those around it. A subsystem comes before the blocks inside it. Inside a model to which
    this one refers are the variables of its own workspace, and no names of the masks around. The
    mask of a file as a whole is that of the block ``masked``.

    Returns
    -------
    diagram : Diagram
        The blocks with the parameters that masks promote to them or set.
    scopes : dict
        What names mean in each block, by its SID.
    """
    top = Scope(variables or no_variables())
    scopes: dict[str, Scope] = {}
    inside: dict[str, Scope] = {}  # of models to which this one refers
    changes: dict[str, dict[str, str]] = {}
    blocks: dict[str, DrawnBlock] = {}
    paths = {block.path: block for block in diagram.blocks.values()}
    if masked is not None:
        top = Scope(top.variables, masked, top, paths)
        changes.update(top.changes)
    for sid, drawn in diagram.blocks.items():
        block = _changed(drawn, changes.get(drawn.path, {}))
        around = inside.get(block.system) or scopes.get(block.system, top)
        has_mask = block.mask.values or block.mask.code.strip()
        scope = Scope(around.variables, block, around, paths) if has_mask else around
        if sid in diagram.models:
            inside[sid] = Scope(variables_inside(diagram.models[sid], top.variables))
        if has_mask and (block.mask.promoted or top.variables.workspace.changes(block.mask.code)):
            for path, texts in scope.changes.items():
                changes.setdefault(path, {}).update(texts)
        blocks[sid], scopes[sid] = block, scope
    return replace(diagram, blocks=blocks), scopes


def _changed(block: DrawnBlock, texts: Mapping[str, str]) -> DrawnBlock:
    if not texts:
        return block
    values = {name: texts.get(name, text) for name, text in block.mask.values.items()}
    own = {name: text for name, text in texts.items() if name not in values}
    return replace(block, texts=block.texts | own, mask=replace(block.mask, values=values))


def says_infinite(text: str) -> bool:
    """Whether a text holds the word ``inf``, rather than too large a number."""
    return bool(_INFINITE.search(text))


def _words(text: str) -> list[str]:
    return re.findall(r"(?<![\w.])[A-Za-z]\w*", text)


def _is_infinite(given: Any) -> bool:  # noqa: ANN401 - any value of MATLAB text
    try:
        return given is not None and bool(np.isinf(array_of(given)).any())
    except (MatlabError, TypeError):
        return False


@dataclass(frozen=True, kw_only=True)
class _Settled:
    """What a mask comes to."""

    values: dict[str, Any] = field(default_factory=dict)
    lacking: dict[str, UnknownValueError] = field(default_factory=dict)
    changes: dict[str, dict[str, str]] = field(default_factory=dict)


class _Handle:
    """The block of a mask, as its initialization sees it."""

    def __init__(
        self, block: DrawnBlock, values: dict[str, Any], paths: Mapping[str, DrawnBlock]
    ) -> None:
        self.path, self.changes = block.path, dict[str, dict[str, str]]()
        self._block, self._values, self._paths = block, values, paths

    def get(self, path: str, name: str) -> Any:  # noqa: ANN401
        """Text of a parameter, or its value as ``value@name``; None where there is none."""
        if path == self.path and name.startswith("value@"):
            return self._values.get(name.removeprefix("value@"))
        block = self._block if path == self.path else self._paths.get(self._known(path))
        if block is None:
            return None
        own = OLD_NAMES.get(name, (name,))[0]
        return block.mask.values.get(name, block.texts.get(own))

    def set(self, path: str, name: str, text: str) -> None:
        """Change a parameter of a block inside."""
        if path.startswith(f"{self.path}/"):
            changed = dict.fromkeys(OLD_NAMES.get(name, (name,)), text)
            self.changes.setdefault(self._known(path), {}).update(changed)

    def found(self, path: str, wanted: Mapping[str, str]) -> list[str]:
        """Paths of a block and those inside it whose parameters have these texts."""
        start = self._known(path)
        inside = [
            block
            for place, block in self._paths.items()
            if not start or place == start or place.startswith(f"{start}/")
        ]
        return [
            block.path if self.path else f"/{block.path}"
            for block in inside
            if all(_property(block, name) == text for name, text in wanted.items())
        ]

    def _known(self, path: str) -> str:
        """Path by which a block is known: that of a file's own mask is empty."""
        return path if self.path else path.removeprefix("/")


def _property(block: DrawnBlock, name: str) -> str | None:
    named = {"Name": block.name, "BlockType": block.type, "MaskType": block.mask.type}
    return named.get(name, block.mask.values.get(name, block.texts.get(name)))


def _mask_values(block: DrawnBlock, around: Scope, paths: Mapping[str, DrawnBlock]) -> _Settled:
    """Evaluate the parameters of a mask, and run its initialization on them."""
    own: dict[str, Any] = {}
    lacking: dict[str, UnknownValueError] = {}
    for name, text in block.mask.values.items():
        try:
            own[name] = _mask_value(block, name, text, around)
        except InvalidValueError as error:
            about = f"mask parameter {name} of {block} is {text[:60]!r}"
            names = getattr(error, "names", ())
            lacking[name] = UnknownValueError(f"{about}: {error}", names=names)
    handle = _Handle(block, own, paths)
    for name, targets in block.mask.promoted.items():
        for target in targets:
            inner, _, parameter = target.rpartition("/")
            text = _literal(own.get(name), block.mask.values[name])
            handle.set(f"{block.path}/{inner}", parameter, text)
    if block.mask.code.strip():
        _initialize(block, around, own, lacking, handle)
    values = {name: value for name, value in around.values.items() if name not in lacking}
    unknown = {name: error for name, error in around.lacking.items() if name not in own}
    return _Settled(
        values={**values, **own}, lacking={**unknown, **lacking}, changes=handle.changes
    )


def _literal(given: Any, text: str) -> str:  # noqa: ANN401
    """Write a value of numbers as MATLAB text; others keep their own text."""
    if isinstance(given, float | bool):
        return repr(float(given))
    if isinstance(given, np.ndarray) and given.ndim == 2 and given.dtype == np.float64:
        return "[" + ";".join(" ".join(map(repr, row)) for row in given.tolist()) + "]"
    return text


def _mask_value(block: DrawnBlock, name: str, text: str, around: Scope) -> Any:  # noqa: ANN401
    mask = block.mask
    if name in mask.literal:
        return text
    if name in mask.choices:
        choices = mask.choices[name]
        if text not in choices:
            listed = ", ".join(map(repr, choices[:_SHOWN]))
            why = f"it is none of its choices, {listed}" if listed else "it has no choices"
            raise InvalidValueError(why)
        return choices.index(text) + 1.0
    if name in mask.switches:
        return text == "on"
    found = around.evaluate(text)
    if isinstance(found, float) and math.isinf(found) and not around.says_infinite(text):
        raise InvalidValueError("it is infinite")
    return found


def _initialize(
    block: DrawnBlock,
    around: Scope,
    own: dict[str, Any],
    lacking: dict[str, UnknownValueError],
    handle: _Handle,
) -> None:
    """Run the initialization of a mask, which sees the mask's own names alone."""
    workspace = around.variables.workspace
    try:
        name = f"the mask of {block}"
        left_out = workspace.run(block.mask.code, name=name, local=own, masked=handle)
    except InvalidValueError as error:
        left_out = {}
        own.clear()
        for name in block.mask.values:
            lacking.setdefault(name, UnknownValueError(str(error)))
    causes = {cause for error in lacking.values() for cause in error.names}
    for name, why in left_out.items():
        because = (
            f"{name!r} is set by the mask initialization of {block}, where it is left out ({why})"
        )
        own.pop(name, None)
        lacking[name] = UnknownValueError(because, names=causes)
