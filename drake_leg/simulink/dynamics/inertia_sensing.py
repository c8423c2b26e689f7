"""What an Inertia Sensor puts out: mass, center of mass and inertia of a group of solids."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.moment import Moment, Place, Places
from drake_leg.simulink.dynamics.sensing import Quantity
from drake_leg.simulink.mechanism import BASE, Frame, PhysicalNetwork
from drake_leg.simulink.model import Block, invalid_parameter, is_on
from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.multibody.mass import Array, MassProperties, composed
from drake_leg.simulink.multibody.solids import Solid

GROUPS, FRAMES = ("BodyGroup", "Mechanism"), ("World", "Attached", "Custom")
_IN_WORLD = Place(body=0, X_BF=np.eye(4))
Parts = list[tuple[Solid, Place]]


class InertiaSensor:
    """An Inertia Sensor, and the solids that it weighs.

    Raises
    ------
    InvalidValueError
        If a setting is not known, or one of its frames is on no body.
    """

    def __init__(
        self, block: Block, network: PhysicalNetwork, mechanism: Mechanism, places: Places
    ) -> None:
        for name, known in (("SensorExtent", GROUPS), ("MeasurementFrame", FRAMES)):
            if block.parameters.get(name, known[0]) not in known:
                raise invalid_parameter(block, name, f"it must be one of {', '.join(known)}")
        self._block = block
        frame = network.frame(f"{block.sid}#{BASE}")
        measuring = block.parameters.get("MeasurementFrame", "World")
        at = frame if measuring == "Attached" else network.frame(f"{block.sid}#lconn:2")
        place = _IN_WORLD if measuring == "World" else places.at(at)
        if places.at(frame) is None or place is None:
            raise InvalidValueError(
                f"the block {block.name!r} (SID {block.sid}) has a frame that is on no body and "
                "not on the world: connect it"
            )
        self._place = place
        self._parts = self._group(frame, mechanism)

    def _group(self, frame: Frame, mechanism: Mechanism) -> Parts:
        """List the solids that it weighs, each with its place."""
        block, connections = self._block, mechanism.connections
        edges = [
            (edge.base, edge.follower)
            for edge in connections.rigid
            if not _is_weld(edge.block) or self._spans
        ]
        edges += [
            (joint.base, joint.follower)
            for joint in connections.joints
            if self._whole or (_is_weld(joint.block) and self._spans)
        ]
        reached = _reached(frame, edges)
        own = {solid for at, solid in connections.solids if at in reached}
        without_ground = self._whole and is_on(block, "ExcludeGroundedBodies")
        return [
            (solid, Place(body=number, X_BF=X_BR))
            for number, body in enumerate(mechanism.bodies)
            for solid, X_BR in body.solids
            if solid in own and (number or not without_ground)
        ]

    @property
    def _whole(self) -> bool:
        return self._block.parameters.get("SensorExtent", "BodyGroup") == "Mechanism"

    @property
    def _spans(self) -> bool:
        return self._whole or is_on(self._block, "SpanWeldJoints")

    def measured(self, moment: Moment) -> MassProperties:
        """Return the mass properties in the measurement frame, once a moment."""
        found = moment.memo.get(self)
        if not isinstance(found, MassProperties):
            X_MW = _inverse(moment, self._place)
            found = moment.memo[self] = composed(
                [(solid.properties, X_MW @ _pose(moment, place)) for solid, place in self._parts]
            )
        return found

    def quantities(self) -> Iterator[Quantity]:
        """List what it puts out, in the order of its ports."""
        number = 0
        for name, shape, law in _SENSED:
            if is_on(self._block, name):
                number += 1
                yield Quantity(
                    port=f"{self._block.sid}#rconn:{number}",
                    shape=shape,
                    of_state=partial(_sensed, law, self),
                )


def _sensed(
    law: Callable[[MassProperties], float | Array], sensor: InertiaSensor, moment: Moment
) -> float | Array:
    return law(sensor.measured(moment))


def _about_origin(properties: MassProperties) -> Array:
    c = properties.center
    found: Array = properties.inertia + properties.mass * ((c @ c) * np.eye(3) - np.outer(c, c))
    return found


_SENSED: tuple[tuple[str, tuple[int, ...], Callable[[MassProperties], float | Array]], ...] = (
    ("SenseMass", (), lambda found: found.mass),
    ("SenseCenterOfMass", (3,), lambda found: found.center),
    ("SenseInertiaMatrix", (3, 3), _about_origin),
    ("SenseCenteredInertiaMatrix", (3, 3), lambda found: found.inertia),
    ("SensePrincipalInertiaMatrix", (3, 3), lambda found: np.diag(found.principal()[0])),
    ("SenseRotationMatrix", (3, 3), lambda found: found.principal()[1]),
)


def _is_weld(block: Block | None) -> bool:
    return block is not None and block.kind == "Weld Joint"


def _reached(start: Frame, edges: Iterable[tuple[Frame, Frame]]) -> set[Frame]:
    """Return all frames that edges connect with one."""
    near: dict[Frame, list[Frame]] = {}
    for a, b in edges:
        near.setdefault(a, []).append(b)
        near.setdefault(b, []).append(a)
    reached, line = {start}, [start]
    while line:
        for there in near.get(line.pop(), ()):
            if there not in reached:
                reached.add(there)
                line.append(there)
    return reached


def _pose(moment: Moment, place: Place) -> Array:
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = moment.pose(place)
    return X


def _inverse(moment: Moment, place: Place) -> Array:
    R, p = moment.pose(place)
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R.T, -R.T @ p
    return X
