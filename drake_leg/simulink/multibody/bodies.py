"""The mechanism of a Simulink model as a tree of bodies, cut where it closes loops.

Frames that are rigidly connected are on one body. Joints connect bodies; those that close a loop
are cut: the actuated ones last, and a 6-DOF joint, which constrains nothing, first.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.mechanism import Frame, inverse
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.multibody.connections import (
    WORLD,
    Connections,
    Jointed,
    connections_of,
    refuse,
)
from drake_leg.simulink.multibody.joints import Primitive
from drake_leg.simulink.multibody.mass import Array, MassProperties, composed
from drake_leg.simulink.multibody.naming import Names
from drake_leg.simulink.multibody.solids import Solid

CLOSED = 1e-6  # [m, -], of a rigid loop
FREE = "6-DOF Joint"
SHOWN = 5  # solids in an error


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """A rigid body B, or what is fixed on the world W."""

    name: str
    solids: tuple[tuple[Solid, Array], ...]  # with their poses X_BR, (4, 4) [m]
    frames: Mapping[Frame, Array]  # poses X_BF, (4, 4) [m], of the model's frames on it
    share: float = 1.0  # of the solids' mass that it has

    @cached_property
    def properties(self) -> MassProperties:
        """Mass, center of mass and inertia in B."""
        whole = composed([(solid.properties, X_BR) for solid, X_BR in self.solids])
        return MassProperties(
            mass=self.share * whole.mass, center=whole.center, inertia=self.share * whole.inertia
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Joint:
    """A joint of the tree, or one that closes a loop."""

    name: str
    connects: Jointed
    base: int  # body
    follower: int  # body
    X_PB: Array  # (4, 4), of its base B on the body P that carries it [m]
    X_CF: Array  # (4, 4), of its follower F on the body C that carries it [m]
    reversed: bool  # whether its follower is nearer to the world than its base

    @property
    def block(self) -> Block:
        """Return its block."""
        return self.connects.block

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """Return its degrees of freedom, from base to follower."""
        return self.connects.primitives

    @property
    def positions(self) -> int:
        """Return how many positions it has."""
        return sum(primitive.positions for primitive in self.primitives)

    def pose(self, q: Array) -> Array:
        """Compute X_BF(q), (4, 4), of its follower in its base."""
        X_BF, first = np.eye(4), 0
        for primitive in self.primitives:
            last = first + primitive.positions
            X_BF = X_BF @ primitive.pose(q[first:last])
            first = last
        return X_BF

    @property
    def start(self) -> Array:
        """Return its positions at its state targets."""
        return np.concatenate([np.zeros(0), *(each.start for each in self.primitives)])


@dataclass(frozen=True, eq=False, kw_only=True)
class Mechanism:
    """The bodies of a model, the joints that connect them in a tree, and those that are cut."""

    name: str
    bodies: tuple[Body, ...]  # the world first
    joints: tuple[Joint, ...]  # of the tree; a parent's comes before its children's
    floating: tuple[int, ...]  # bodies that begin a tree without the world
    loops: tuple[Joint, ...]  # joints that close loops
    sensors: tuple[Joint, ...]  # 6-DOF joints that close loops, and constrain nothing
    connections: Connections


def mechanism_of(model: Model) -> Mechanism:
    """Find the bodies and joints of a model.

    Raises
    ------
    InvalidValueError
        That lists all that is missing or makes no mechanism.
    """
    mechanism = read_mechanism(model)
    if not (mechanism.connections.solids or mechanism.connections.joints):
        raise InvalidValueError(
            f"the model {model.name!r} holds no mechanism: it has no solid and no joint"
        )
    moving = mechanism.bodies[1:]  # what is fixed to the world may weigh anything
    refuse([_impossible(body) for body in moving if not body.properties.is_possible])
    return mechanism


def read_mechanism(model: Model, sensors: Container[str] = (), *, apart: bool = True) -> Mechanism:
    """Find the bodies and joints of a model, possible or not; it may have none.

    ``sensors`` are SIDs of joints that only measure, which are kept out of the tree. A weld that
    senses what it carries is a joint, unless welds are not kept ``apart``.

    Raises
    ------
    InvalidValueError
        That lists all that is missing: values, kinds of blocks.
    """
    return _Tree(connections_of(model, apart=apart), Names(model), sensors).mechanism(model.name)


def _impossible(body: Body) -> str:
    moments, _ = body.properties.principal()
    solids = ", ".join(repr(solid.block.name) for solid, _ in body.solids[:SHOWN])
    return (
        f"nothing can have the principal moments of inertia of {body.name!r}, "
        f"{', '.join(f'{moment:.4g}' for moment in moments)} kg*m^2, of which none may be "
        f"negative or more than the sum of the others: correct the inertia of {solids}"
    )


@dataclass(kw_only=True)
class _Piece:
    """What is rigidly connected, with poses in the frame at which it was entered."""

    frames: dict[Frame, Array]
    solids: list[tuple[Solid, Array]]


def neighbours(
    edges: Iterable[tuple[Frame, Frame, Array]],
) -> dict[Frame, list[tuple[Frame, Array]]]:
    """List, for each frame A, the frames B that an edge (A, B, X_AB) connects with it, and X_AB."""
    near: dict[Frame, list[tuple[Frame, Array]]] = {}
    for base, follower, X_BF in edges:
        near.setdefault(base, []).append((follower, X_BF))
        near.setdefault(follower, []).append((base, inverse(X_BF)))
    return near


def _pieces(connections: Connections) -> list[_Piece]:
    """Gather what is rigidly connected; the world is the first piece."""
    near = neighbours((edge.base, edge.follower, edge.X_BF) for edge in connections.rigid)
    near.setdefault(WORLD, [])
    for joint in connections.joints:
        near.setdefault(joint.base, [])
        near.setdefault(joint.follower, [])
    solids: dict[Frame, list[Solid]] = {}
    for frame, solid in connections.solids:
        near.setdefault(frame, [])
        solids.setdefault(frame, []).append(solid)
    seen: set[Frame] = set()
    return [_piece(frame, near, solids, seen) for frame in (WORLD, *near) if frame not in seen]


def _piece(
    root: Frame,
    near: Mapping[Frame, Sequence[tuple[Frame, Array]]],
    solids: Mapping[Frame, Sequence[Solid]],
    seen: set[Frame],
) -> _Piece:
    piece = _Piece(frames={root: np.eye(4)}, solids=[])
    left = [root]
    while left:
        here = left.pop()
        X_RH = piece.frames[here]
        piece.solids += [(solid, X_RH) for solid in solids.get(here, ())]
        for there, X_HT in near[here]:
            X_RT = X_RH @ X_HT
            if there not in piece.frames:
                piece.frames[there] = X_RT
                left.append(there)
            elif not np.allclose(piece.frames[there], X_RT, rtol=0.0, atol=CLOSED):
                names = sorted({solid.block.name for solid, _ in piece.solids})
                refuse(
                    [
                        f"transforms that meet near {', '.join(map(repr, names[:4])) or 'a frame'} "
                        "form a rigid loop that does not close: correct one of them"
                    ]
                )
    seen.update(piece.frames)
    return piece


def _rank(joint: Jointed) -> int:
    """Order in which joints become part of the tree: welds first, free ones last."""
    if not joint.primitives:
        return -1
    if joint.block.kind == FREE:
        return 4
    if joint.block.kind == "Bushing Joint":
        return 3
    if any(each.driven for each in joint.primitives):
        return 0
    moved = any(each.target or each.stiffness or each.damping for each in joint.primitives)
    return 1 if moved else 2


class _Tree:
    """A spanning tree of pieces and joints, ordered from the world on."""

    def __init__(self, connections: Connections, names: Names, sensors: Container[str]) -> None:
        self._connections, self._names, self._sensors = connections, names, sensors
        self._pieces = _pieces(connections)
        at = {frame: place for place, piece in enumerate(self._pieces) for frame in piece.frames}
        self._ends = [(at[joint.base], at[joint.follower]) for joint in connections.joints]
        self._kept = self._spanning()
        self._order, self._inbound = self._walk()
        self._number = {piece: place for place, piece in enumerate(self._order)}

    def mechanism(self, name: str) -> Mechanism:
        """Number the bodies, and place everything in their frames."""
        origins = [self._origin(piece) for piece in range(len(self._pieces))]
        joints = [self._joint(index, origins) for index in range(len(self._ends))]
        cut = [joint for index, joint in enumerate(joints) if index not in self._kept]
        return Mechanism(
            name=name,
            bodies=tuple(self._body(piece, origins[piece]) for piece in self._order),
            joints=tuple(
                joints[self._inbound[piece]] for piece in self._order if piece in self._inbound
            ),
            floating=tuple(
                place
                for place, piece in enumerate(self._order)
                if place and piece not in self._inbound
            ),
            loops=tuple(joint for joint in cut if joint.block.kind != FREE),
            sensors=tuple(joint for joint in cut if joint.block.kind == FREE),
            connections=self._connections,
        )

    def _spanning(self) -> set[int]:
        """Choose the joints of a tree, by their rank."""
        parent = list(range(len(self._pieces)))

        def root(piece: int) -> int:
            while parent[piece] != piece:
                parent[piece] = parent[parent[piece]]
                piece = parent[piece]
            return piece

        kept = set()
        joints = self._connections.joints
        of_tree = (i for i, joint in enumerate(joints) if joint.block.sid not in self._sensors)
        for index in sorted(of_tree, key=lambda index: _rank(joints[index])):
            a, b = map(root, self._ends[index])
            if a != b:
                parent[a] = b
                kept.add(index)
        return kept

    def _walk(self) -> tuple[list[int], dict[int, int]]:
        """Order the pieces from the world on, and find the joint that leads to each.

        A tree without the world begins with a piece that is no joint's follower.
        """
        at: dict[int, list[int]] = {}
        for index in sorted(self._kept):
            for end in self._ends[index]:
                at.setdefault(end, []).append(index)
        order: list[int] = []
        inbound: dict[int, int] = {}
        seen: set[int] = set()
        led_to = {self._ends[index][1] for index in self._kept}
        for root in sorted(range(len(self._pieces)), key=lambda piece: piece in led_to - {0}):
            if root in seen or (root and not (self._pieces[root].solids or root in at)):
                continue
            seen.add(root)
            line = [root]
            for here in line:
                order.append(here)
                for index in at.get(here, ()):
                    for there in self._ends[index]:
                        if there not in seen:
                            seen.add(there)
                            inbound[there] = index
                            line.append(there)
        return order, inbound

    def _origin(self, piece: int) -> Array:
        """Place the origin of a body: at the joint that leads to it."""
        index = self._inbound.get(piece)
        if index is None:
            return np.eye(4)
        joint = self._connections.joints[index]
        frames = self._pieces[piece].frames
        return frames[joint.follower if self._ends[index][1] == piece else joint.base]

    def _joint(self, index: int, origins: Sequence[Array]) -> Joint:
        joint = self._connections.joints[index]
        base, follower = self._ends[index]
        number = self._number.__getitem__
        return Joint(
            name=self._names.of(joint.block),
            connects=joint,
            base=number(base),
            follower=number(follower),
            X_PB=inverse(origins[base]) @ self._pieces[base].frames[joint.base],
            X_CF=inverse(origins[follower]) @ self._pieces[follower].frames[joint.follower],
            reversed=self._inbound.get(base) == index,
        )

    def _body(self, piece: int, origin: Array) -> Body:
        X_BP, found = inverse(origin), self._pieces[piece]
        solids = tuple((solid, X_BP @ X_PR) for solid, X_PR in found.solids)
        name = WORLD if piece == 0 else self._names.of_body([solid for solid, _ in solids])
        frames = {frame: X_BP @ X_PF for frame, X_PF in found.frames.items()}
        return Body(name=name, solids=solids, frames=frames)
