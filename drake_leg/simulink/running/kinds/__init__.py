"""How each kind of block runs.

A kind writes its outputs, and after all outputs are known, derivatives and what it remembers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from drake_leg.simulink.running.code import Writer
from drake_leg.simulink.running.network import Node
from drake_leg.simulink.running.settings import Settings

Write = Callable[[Writer], None]
Direct = Callable[[Node, Settings], Iterable[int]]


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of block."""

    write: Write  # its outputs
    finish: Write | None = None  # its derivatives, and what it remembers
    direct: Direct  # the inputs that its outputs depend on at once
    sampled: bool = False  # whether it is never continuous, as a delay
    continuous: bool | Callable[[Settings], bool] = False  # whether it always is: an integrator
    major: bool = False  # whether it changes at major steps alone, as a Memory
    stepwise: bool = False  # whether it does so unless what comes in is sampled
    constant: bool = False
    sample_time: str = "SampleTime"  # its parameter; "" where it has none

    def is_continuous(self, settings: Settings) -> bool:
        """Tell whether a block of this kind runs always, whatever comes in."""
        return self.continuous(settings) if callable(self.continuous) else self.continuous


def all_inputs(node: Node, _: Settings) -> Iterable[int]:
    """Every output depends on every input."""
    return range(len(node.inputs))


def no_inputs(_: Node, __: Settings) -> Iterable[int]:
    """No output depends on an input at once."""
    return ()


KINDS: dict[str, Kind] = {}


def kind(
    *names: str,
    finish: Write | None = None,
    direct: Direct = all_inputs,
    sampled: bool = False,
    continuous: bool | Callable[[Settings], bool] = False,
    major: bool = False,
    stepwise: bool = False,
    constant: bool = False,
    sample_time: str = "SampleTime",
) -> Callable[[Write], Write]:
    """Say that a function writes the outputs of kinds of blocks."""

    def noted(write: Write) -> Write:
        for name in names:
            KINDS[name] = Kind(
                write=write,
                finish=finish,
                direct=direct,
                sampled=sampled,
                continuous=continuous,
                major=major,
                stepwise=stepwise,
                constant=constant,
                sample_time=sample_time,
            )
        return write

    return noted


def kinds_of_blocks() -> dict[str, Kind]:
    """Return all kinds of blocks that run, by their names."""
    from drake_leg.simulink.running.kinds import (  # noqa: F401
        bits,
        continuous,
        controllers,
        discontinuities,
        discrete,
        functions,
        gates,
        iterators,
        lags,
        logic,
        maths,
        matrices,
        physical,
        replacements,
        robotics,
        routing,
        sinks,
        sources,
        tables,
        way_points,
    )

    return KINDS


def kind_of(node: Node) -> Kind | None:
    """Return the kind of a block, None where it does not run."""
    if node.part is not None:
        from drake_leg.simulink.running.kinds.networks import OF_NETWORKS

        return OF_NETWORKS
    kinds = kinds_of_blocks()
    return kinds.get(node.block.kind) or kinds.get(node.block.type)
