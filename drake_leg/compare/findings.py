"""Where a comparison's findings are gathered."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from drake_leg.compare.comparison import Comparison, Item
from drake_leg.compare.signals import close
from drake_leg.diagrams.wiring import Wire
from drake_leg.simulink.model import Block


@dataclass(kw_only=True)
class Findings:
    """A comparison under way.

    ``strict`` makes cross sections, colours and the converters' filters count.
    """

    strict: bool
    comparison: Comparison = field(default_factory=Comparison)
    seen: set[str] = field(default_factory=set)  # SIDs of blocks that have been judged
    used: set[str] = field(default_factory=set)  # names of live blocks that are a counterpart
    wired: set[Wire] = field(default_factory=set)  # live wires that are a counterpart

    def match(self, block: Block, counterpart: str, **more: Any) -> None:  # noqa: ANN401
        """Note the counterpart of a block; only the first one counts.

        Parameters
        ----------
        counterpart : str
            What stands for it.
        **more
            Further keys of the item.
        """
        if block.sid not in self.seen:
            self.seen.add(block.sid)
            item = {**_about(block), "counterpart": counterpart, **more}
            self.comparison.matched.append(item)

    def miss(self, block: Block, why: str) -> None:
        """Note a block that nothing stands for."""
        if block.sid not in self.seen:
            self.seen.add(block.sid)
            self.comparison.missing.append({**_about(block), "why": why})

    def differ(
        self,
        sid: str,
        name: str,
        parameter: str,
        simulink: object,
        drake: object,
        *,
        unit: str = "",
        counts: bool = True,
    ) -> None:
        """Note a value that is not the same on both sides.

        Parameters
        ----------
        simulink, drake : object
            Both values, in SI.
        counts : bool
            Whether it counts without ``strict``.
        """
        item = {
            "what": "parameter",
            "sid": sid,
            "name": name,
            "parameter": parameter,
            "simulink": simulink,
            "drake": drake,
            "unit": unit,
        }
        known = self.comparison.different if counts or self.strict else self.comparison.tolerated
        if item not in known:
            known.append(item)

    def scale(self, factor: float) -> None:
        """Note that all lengths of the model are so many times the diagram's.

        Parameters
        ----------
        factor : float
            The model's over the diagram's.
        """
        self.comparison.different.append(
            {
                "what": "scale",
                "sid": "",
                "name": "(model)",
                "parameter": "lengths",
                "simulink": factor,
                "drake": 1.0,
                "unit": "",
            }
        )

    def check(
        self,
        block: Block,
        parameter: str,
        simulink: float | str | tuple[float, ...],
        drake: float | str | tuple[float, ...],
        *,
        unit: str = "",
        counts: bool = True,
    ) -> Item:
        """Compare a parameter, and note it where it differs.

        Parameters
        ----------
        simulink, drake : float, str or tuple of float
            Both values, in SI.
        counts : bool
            Whether a difference counts without ``strict``.

        Returns
        -------
        dict
            The parameter with both values.
        """
        if not _same(simulink, drake):
            self.differ(block.sid, block.name, parameter, simulink, drake, unit=unit, counts=counts)
        return {"parameter": parameter, "simulink": simulink, "drake": drake, "unit": unit}


def _about(block: Block) -> Item:
    return {"what": "block", "sid": block.sid, "name": block.name, "kind": block.kind}


def _same(a: float | str | tuple[float, ...], b: float | str | tuple[float, ...]) -> bool:
    if isinstance(a, str) or isinstance(b, str):
        return a == b
    if isinstance(a, tuple) or isinstance(b, tuple):
        if not (isinstance(a, tuple) and isinstance(b, tuple)) or len(a) != len(b):
            return False
        scale = max(map(abs, (*a, *b)), default=0.0)
        return all(close(x, y) or abs(x - y) <= 1e-9 * scale for x, y in zip(a, b, strict=True))
    return close(a, b)
