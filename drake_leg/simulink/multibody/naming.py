"""Names of bodies and joints, unique in a model, by the blocks that they come from."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import Protocol

from drake_leg.simulink.model import Block, Model

_OTHERS = re.compile(r"[^\w.+-]+")
RESERVED = ("", "world")


class _OfBlock(Protocol):
    @property
    def block(self) -> Block: ...


class Once:
    """Gives out names, each once: later ones are numbered."""

    def __init__(self, taken: Sequence[str] = ()) -> None:
        self._given = Counter(taken)

    def name(self, wanted: str) -> str:
        """Return a name, or the next one that is free."""
        name = wanted or "part"
        self._given[name] += 1
        while self._given[name] > 1:
            name = f"{name}_{self._given[name]}"
            self._given[name] += 1
        return name


class Names:
    """Gives out names, each once: a block's own, with its subsystems' where others share it."""

    def __init__(self, model: Model) -> None:
        self._blocks = {block.sid: block for block in model.blocks}
        self._once = Once(RESERVED)
        self._used = Counter(word(block.name) for block in model.blocks)

    def of(self, block: Block) -> str:
        """Name what a block makes."""
        path = self._path(block)
        name = path[-1]
        if self._used[name] > 1 and len(path) > 1:
            name = f"{path[-2]}_{name}"
        return self._once.name(name)

    def of_body(self, solids: Sequence[_OfBlock]) -> str:
        """Name a body by the subsystem that holds all its solids, or by its first solid."""
        if not solids:
            return self._once.name("frame")
        systems = {solid.block.system for solid in solids}
        (system,) = systems if len(systems) == 1 else ("",)
        return self.of(self._blocks[system] if system else solids[0].block)

    def _path(self, block: Block) -> list[str]:
        names = [word(block.name)]
        while block.system in self._blocks:
            block = self._blocks[block.system]
            names.insert(0, word(block.name))
        return names


def word(name: str) -> str:
    """Write a name without spaces and signs that a model format may not take."""
    return _OTHERS.sub("_", name).strip("_")
