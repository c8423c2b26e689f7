"""The mechanism of a Simulink model as a picture, from the world outwards."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

from drake_leg.drawings.chain import Chain, Output
from drake_leg.drawings.picture import Picture
from drake_leg.drawings.simulink_bodies import body_block
from drake_leg.drawings.simulink_network import Network, ports_by_block
from drake_leg.simulink.model import Block, Model, split_port

_SENSORS = ("6-DOF Joint", "Bushing Joint", "Transform Sensor")
_LEAVES = ("Solid", "Inertia", "Configuration", "Graphic")  # how names of what ends a chain end


def model_mechanism_picture(
    model: Model, network: Network, names: Mapping[str, str], *, title: str
) -> Picture:
    """Draw the mechanical blocks of a model, breadth-first from its World Frames.

    What is attached to no World Frame follows, from an open end if there is one. A block that
    closes a loop has two connections on its left side, and so has a joint that only senses, which
    comes last. A model without a mechanism has a picture without blocks.
    """
    return _Walk(model, network, names).picture(title)


class _Walk:
    """Goes from frame to frame and attaches what is connected there."""

    def __init__(self, model: Model, network: Network, names: Mapping[str, str]) -> None:
        self.network, self.names = network, names
        self.blocks = {b.sid: b for b in model.blocks if b.sid in network.mechanical}
        self.node = {port: index for index, node in enumerate(network.frames) for port in node}
        self.ports = ports_by_block(self.node)
        self.frame: dict[int, Output] = {}  # of the nodes that are reached
        self.met: deque[str] = deque()
        self.met_sensors: deque[str] = deque()
        self.placed: set[str] = set()
        self.chain = Chain()

    def picture(self, title: str) -> Picture:
        worlds = [sid for sid, block in self.blocks.items() if block.kind == "World Frame"]
        for world in worlds:
            self._place(world)
        self._spread()
        for sid in sorted(self.blocks, key=self._unlikely_start):
            if sid not in self.placed:
                self._place(sid)
                self._spread()
        return self.chain.picture(title)

    def _unlikely_start(self, sid: str) -> int:
        """Rank what a chain without a world may start from: references, open ends, the rest."""
        kind = self.blocks[sid].kind
        if "Reference" in kind or kind in ("Connection Port", "PMIOPort"):
            return 0
        return 1 if len(self.ports.get(sid, ())) == 1 and not kind.endswith(_LEAVES) else 2

    def _spread(self) -> None:
        while self.met or self.met_sensors:
            sid = (self.met or self.met_sensors).popleft()
            if sid not in self.placed:
                self._place(sid)

    def _place(self, sid: str) -> None:
        """Attach a block to the frames that are reached; its other ones are reached from now on."""
        self.placed.add(sid)
        index, opened = len(self.chain.blocks), 0
        attached = []
        for port in self.ports.get(sid, ()):
            node = self.node[port]
            if node in self.frame:
                attached.append(port)
                continue
            self.frame[node] = (index, opened)
            opened += 1
            self._meet(node)
        drawn = body_block(
            self.blocks[sid],
            name=self.names[sid],
            turned=[split_port(port)[1:] for port in attached] == [("rconn", 1)] and opened > 0,
            senses=sid in self.network.sensed,
        )
        self.chain.add(drawn, *(self.frame[self.node[port]] for port in attached))

    def _meet(self, node: int) -> None:
        for port in self.network.frames[node]:
            sid, _, _ = split_port(port)
            (self.met_sensors if self._only_senses(self.blocks[sid]) else self.met).append(sid)

    def _only_senses(self, block: Block) -> bool:
        return block.kind in _SENSORS and block.sid in self.network.sensed
