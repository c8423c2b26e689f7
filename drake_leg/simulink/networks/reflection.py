"""Masses of networks that move as joints do: they are added to the mechanism's own.

What a network does to a joint may depend on the joint's acceleration, as with a rotor behind a
gear. It is then an inertia at the joint, and known together with the acceleration.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.mechanism import network_of
from drake_leg.simulink.model import Block, Model, split_port
from drake_leg.simulink.networks.assembly import parameter
from drake_leg.simulink.networks.reading import Network, Part, Row, Term, networks_of
from drake_leg.simulink.wiring import physical_part

GAIN = "PS Gain"


@dataclass(frozen=True, kw_only=True)
class Reflected:
    """An inertia that is felt at a joint."""

    driven: str  # the joint's port that takes the force or the torque
    sensed: str  # the joint's port that puts out the velocity
    inertia: float  # [kg*m^2 or kg]


def reflected_of(model: Model) -> tuple[Reflected, ...]:
    """Find the inertias that the networks of a model add to its joints."""
    physical = network_of(physical_part(model))
    drivers = {port: node[0] for node in physical.signals for port in node[1:]}
    networks = networks_of(physical.blocks, physical.nodes, drivers)
    return without_accelerations(networks, physical.blocks, drivers)[1]


def without_accelerations(
    networks: Sequence[Network], blocks: Mapping[str, Block], drivers: Mapping[str, str]
) -> tuple[list[Network], tuple[Reflected, ...]]:
    """Take from what networks do to joints what depends on the joints' accelerations."""
    job = _Reflection(blocks, drivers)
    return [job.of_network(network) for network in networks], tuple(job.found)


class _Reflection:
    def __init__(self, blocks: Mapping[str, Block], drivers: Mapping[str, str]) -> None:
        self._blocks, self._drivers = blocks, drivers
        self._readers: dict[str, list[str]] = {}
        for target, source in drivers.items():
            self._readers.setdefault(source, []).append(target)
        self.found: list[Reflected] = []

    def of_network(self, network: Network) -> Network:
        return replace(network, parts=tuple(self._of_part(part) for part in network.parts))

    def _of_part(self, part: Part) -> Part:
        outputs = tuple((port, self._of_output(port, row)) for port, row in part.outputs)
        rows = [row for _, row in outputs]
        rows += [row for _, _, row in part.states]
        rows += [row for _, _, arguments in part.laws for row in arguments]
        terms = dict.fromkeys(term for row in rows for term in row)
        faults = tuple(fault for term in terms if (fault := self._fault(part, term)))
        return replace(part, outputs=outputs, faults=(*part.faults, *faults))

    def _fault(self, part: Part, term: Term) -> InvalidValueError | None:
        """Say that the acceleration of a joint is not known where a block depends on it."""
        sensed, _ = self._source(term.port) if term.order else ("", 0.0)
        if not sensed:
            return None
        joint = self._blocks[split_port(sensed)[0]]
        return InvalidValueError(
            f"block {part.block.name!r} (SID {part.block.sid}) depends on the acceleration of the "
            f"joint {joint.name!r}, which is known only to a force that acts on joints alone: put "
            "a spring or a damper between the joint and what turns or slides with it"
        )

    def _of_output(self, port: str, row: Row) -> Row:
        kept = []
        for term in row:
            sensed, gain = self._source(term.port) if term.order == 1 else ("", 0.0)
            driven = list(self._driven(port)) if sensed else []
            if not driven or any(not target for target, _ in driven):
                kept.append(term)
                continue
            self.found += [
                Reflected(driven=target, sensed=sensed, inertia=-term.factor * gain * more)
                for target, more in driven
            ]
        return tuple(kept)

    def _source(self, port: str) -> tuple[str, float]:
        """Find the joint that senses what comes out of a port, and the gain in between."""
        block = self._blocks[split_port(port)[0]]
        if block.kind.endswith("Joint"):
            return port, 1.0
        driver = self._drivers.get(f"{block.sid}#lconn:1")
        if block.kind != GAIN or driver is None:
            return "", 0.0
        source, gain = self._source(driver)
        return source, gain * _gain(block)

    def _driven(self, port: str) -> Iterator[tuple[str, float]]:
        """Find the ports of joints that a port drives, with gains; "" for what is none."""
        for target in self._readers.get(port, ()):
            block = self._blocks[split_port(target)[0]]
            if block.kind.endswith("Joint"):
                yield target, 1.0
            elif block.kind == GAIN:
                gain = _gain(block)
                yield from (
                    (end, gain * more) for end, more in self._driven(f"{block.sid}#rconn:1")
                )
            else:
                yield "", 0.0


def _gain(block: Block) -> float:
    try:
        return parameter(block, "gain", 1.0)
    except InvalidValueError:
        return 0.0  # that it is not known is said where the block runs
