"""Mechanics of one dimension: masses on a line or an axis, and what acts between them.

Every part of such a network becomes a node of signals. The velocity of a connection is that of its
mass, a state, or 0 at a reference; a part between two connections puts out the forces onto both.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from drake_leg.simulink.model import Block, split_port
from drake_leg.simulink.wiring import join

LIBRARY = "fl_lib/Mechanical/"
REFERENCES = ("Mechanical Translational Reference", "Mechanical Rotational Reference")
MASSES = ("Mass", "Inertia")
SOURCES = ("Ideal Force Source", "Ideal Torque Source")
SENSORS = ("Ideal Translational Motion Sensor", "Ideal Rotational Motion Sensor")
BETWEEN = ("Translational Spring", "Rotational Spring", "Translational Damper", "Rotational Damper")
_BESIDE = "Solver Configuration"
_R, _C = "lconn:1", "rconn:1"
_C_OF_SOURCE, SIGNAL = "rconn:2", "rconn:1"
Part = tuple[Block, tuple[str | None, ...], tuple[str, ...]]  # with its inputs and outputs


def parts_in_one_dimension(
    blocks: Mapping[str, Block], nets: Iterable[Sequence[str]], drivers: Mapping[str, str]
) -> Iterator[Part]:
    """Yield the parts of the networks whose every connection has a mass or is a reference."""
    own = {sid: block for sid, block in blocks.items() if _is_part(block)}
    ends = {f"{sid}#{port}" for sid, block in own.items() for port in _ends(block)}
    mine = [net for net in nets if ends.intersection(net)]
    velocities: dict[str, str | None] = {}
    refused: set[str] = set()  # ends at connections that are not understood
    masses: dict[str, set[str]] = {}  # SID -> ends of others at its connection
    for net in mine:
        held = [blocks[split_port(port)[0]] for port in net]
        heavy = [block.sid for block in held if block.sid in own and block.kind in MASSES]
        fixed = any(block.kind in REFERENCES for block in held)
        known = all(block.sid in own or block.kind == _BESIDE for block in held)
        if not known or len(heavy) + fixed != 1:
            refused.update(net)
        velocities |= dict.fromkeys(net, None if fixed or not heavy else velocity_of(heavy[0]))
        if heavy:
            masses[heavy[0]] = set(net)
    joined = join([[split_port(port)[0] for port in net] for net in mine])
    bad = {split_port(port)[0] for port in refused} | {
        sid
        for sid, block in own.items()
        if any(f"{sid}#{e}" not in velocities for e in _ends(block))
    }
    for network in joined:
        if not bad.intersection(network):
            yield from _parts(
                [own[sid] for sid in network if sid in own], velocities, masses, drivers
            )


def velocity_of(sid: str) -> str:
    """Name the port at which a mass puts out its velocity."""
    return f"{sid}#velocity:1"


def _is_part(block: Block) -> bool:
    kinds = (*REFERENCES, *MASSES, *SOURCES, *SENSORS, *BETWEEN)
    return block.source.startswith(LIBRARY) and block.kind in kinds


def _ends(block: Block) -> tuple[str, ...]:
    """Ports at which a part is connected: R and then C, or its only one."""
    if block.kind in (*REFERENCES, *MASSES):
        return (_R,)
    if block.kind in SENSORS and _is_absolute(block):
        return (_R,)
    return (_R, _C_OF_SOURCE if block.kind in SOURCES else _C)


def _is_absolute(block: Block) -> bool:
    """Whether a sensor measures without a second connection."""
    texts: Mapping[str, str] = getattr(block.parameters, "texts", {})
    return texts.get("reference", "").endswith("absolute")


def _parts(
    network: Iterable[Block],
    velocities: Mapping[str, str | None],
    masses: Mapping[str, set[str]],
    drivers: Mapping[str, str],
) -> Iterator[Part]:
    onto = {
        f"{block.sid}#{end}": f"{block.sid}#onto:{place}"
        for block in network
        if block.kind in (*SOURCES, *BETWEEN)
        for place, end in enumerate(_ends(block), 1)
    }
    for block in network:
        own = tuple(velocities[f"{block.sid}#{end}"] for end in _ends(block))
        if block.kind in MASSES:
            forces = sorted(onto[end] for end in masses[block.sid] if end in onto)
            yield block, tuple(forces), (velocity_of(block.sid),)
        elif block.kind in SENSORS:
            first = len(own)  # its signals come after its ends at the right
            yield block, own, (f"{block.sid}#rconn:{first}", f"{block.sid}#rconn:{first + 1}")
        elif block.kind in REFERENCES:
            yield block, (), ()
        else:
            force = (drivers.get(f"{block.sid}#{SIGNAL}"),) if block.kind in SOURCES else own
            yield block, force, (f"{block.sid}#onto:1", f"{block.sid}#onto:2")
