"""A Simulink file as trees: its diagram, the systems in it, its charts, its configuration."""

from __future__ import annotations

import re
from functools import cached_property, lru_cache
from pathlib import Path
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import WHOLE, content_of, parameters, parts_of
from drake_leg.simulink.charts import Charts
from drake_leg.simulink.masks import Mask, read_mask

_ROOT = "simulink/systems/system_root.xml"
_CONFIGURATION = "simulink/configSet0.xml"
_WORKSPACE = "simulink/modelWorkspace.mxarray"
_MASK = "simulink/modelMask.xml"
_STATEFLOW = re.compile(r"simulink/stateflow(\.xml|/(machine|chart_\w+)\.xml)")
_SYSTEM = re.compile(r"\w{1,80}")
_HOLDERS = ("Model", "Library", "Subsystem")


KEPT = 8  # files, parsed


def simulink_file(path: Path) -> SimulinkFile:
    """Open a file; of the last ones, each content is parsed once.

    Raises
    ------
    InvalidValueError
        If it is not such a file or is damaged.
    """
    return _kept(path, content_of(path))


@lru_cache(maxsize=KEPT)
def _kept(path: Path, content: bytes) -> SimulinkFile:
    return SimulinkFile(path, content)


class SimulinkFile:
    """A file whose parts are parsed when they are asked for, each once.

    Raises
    ------
    InvalidValueError
        If it is not such a file or is damaged.
    """

    def __init__(self, path: Path, content: bytes) -> None:
        self.path = path
        self._parts = parts_of(content)
        self._trees: dict[str, Element | None] = {}

    @cached_property
    def top(self) -> Element:
        """The ``<System>`` of the top."""
        root = self._tree(_ROOT)
        if root is not None:
            return root
        for holder in _HOLDERS:
            system = self._whole.find(f"{holder}/System")
            if system is not None:
                return system if system.get("Ref") is None else self.system(system.get("Ref", ""))
        raise InvalidValueError(f"its part {WHOLE} has no diagram: save the model again")

    def system(self, name: str) -> Element:
        """Find the ``<System>`` that a ``<System Ref="...">`` names."""
        system = self._tree(f"simulink/systems/{name}.xml") if _SYSTEM.fullmatch(name) else None
        if system is None:
            raise InvalidValueError(
                f"it has no part for the system {name[:60]!r}: save the model again in Simulink"
            )
        return system

    @cached_property
    def charts(self) -> Charts:
        """The charts, MATLAB Functions among them."""
        names = [name for name in self._parts.names() if _STATEFLOW.fullmatch(name)]
        trees = [self._tree(name) for name in (*names, WHOLE)]
        return Charts(tree for tree in trees if tree is not None)

    @cached_property
    def configuration(self) -> Element | None:
        """What holds the settings of the solver; None where the file has none."""
        own = self._tree(_CONFIGURATION)
        return self._tree(WHOLE) if own is None else own

    @cached_property
    def callbacks(self) -> dict[str, str]:
        """Code that MATLAB runs when the model is opened or started, by the callback's name."""
        texts = parameters(self._holder) if self._holder is not None else {}
        return {name: text for name, text in texts.items() if name.endswith("Fcn")}

    @cached_property
    def workspace(self) -> dict[str, str]:
        """Where the model workspace comes from: ``WSDataSource`` and what belongs to it."""
        found = self._holder.find("ModelWorkspace") if self._holder is not None else None
        return {} if found is None else parameters(found)

    @cached_property
    def workspace_content(self) -> bytes | None:
        """The model workspace that the file itself keeps, packed."""
        return self._parts.read(_WORKSPACE)

    @cached_property
    def mask(self) -> Mask:
        """The mask of a subsystem in a file of its own; an empty one where it has none."""
        holder = Element("Block")
        own = self._tree(_MASK)
        if own is not None:
            holder.append(own)
        return read_mask(holder, {})

    def data(self, reference: str) -> bytes | None:
        """Read the data that a ``<P Ref="bdmxdata:...">`` names; None where there are none."""
        name = reference.removeprefix("bdmxdata:")
        found = _SYSTEM.fullmatch(name)
        return self._parts.read(f"simulink/bdmxdata/{name}.mxarray") if found else None

    @property
    def is_model(self) -> bool:
        """Whether it is a model, not a library or a subsystem, which others lend their values."""
        return self._holder is None or self._holder.tag == "Model"

    @property
    def is_library(self) -> bool:
        """Whether it holds blocks for other models."""
        return self._holder is not None and self._holder.tag == "Library"

    @cached_property
    def _holder(self) -> Element | None:
        """The element of the model, library or subsystem as a whole."""
        whole = self._tree(WHOLE)
        if whole is None:
            return None
        return next((found for name in _HOLDERS if (found := whole.find(name)) is not None), None)

    @property
    def _whole(self) -> Element:
        whole = self._tree(WHOLE)
        if whole is None:
            raise InvalidValueError(
                f"it has no part {_ROOT} and no {WHOLE}: it is not a model, or a protected "
                "one; choose a .slx that Simulink saved"
            )
        return whole

    def _tree(self, part: str) -> Element | None:
        if part not in self._trees:
            self._trees[part] = self._parts.tree(part)
        return self._trees[part]
