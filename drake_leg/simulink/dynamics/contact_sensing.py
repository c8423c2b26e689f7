"""What a Spatial Contact Force puts out: of a cloud of points, one value for each of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from drake_leg.simulink.dynamics.contact import Contact, Touch, contact_axes
from drake_leg.simulink.dynamics.moment import Moment, Place
from drake_leg.simulink.dynamics.sensing import Ports, Quantity
from drake_leg.simulink.model import Block, is_on
from drake_leg.simulink.multibody.mass import Array

Law = Callable[[Touch], float | Array]

MEASURES = (  # what wants the nearest points, too, where nothing touches
    "SenseContactSignal", "SensePenetrationDepth", "SenseSeparationDistance",
    "SenseContactBaseRotation", "SenseContactBaseTranslation", "SenseContactFollowerRotation",
    "SenseContactFollowerTranslation", "SenseNormalVelocity", "SenseTangentialVelocity",
)  # fmt: skip
SUMS: tuple[tuple[str, Law], ...] = (
    ("SenseNormalForceMagnitude", lambda touch: touch.push),
    ("SenseFrictionalForceMagnitude", lambda touch: touch.friction),
)


def sensed_of_contact(block: Block, contact: Contact) -> Iterator[Quantity]:
    """List what a contact puts out, in the order of its ports.

    Where two solids touch at several corners, forces are added up, and the rest is that of the
    deepest one. Velocities are 0 where nothing touches.
    """
    ports = Ports(block)
    many = contact.points if contact.points > 1 else 0
    shape = (many,) if many else ()

    def deepest(moment: Moment) -> Touch:
        return min(contact.touches(moment), key=lambda touch: touch.separation)

    def separation(moment: Moment) -> Array:
        return contact.separations(moment) if many else np.array(deepest(moment).separation)

    def spread(moment: Moment, law: Law, *size: int) -> Array:
        found = np.zeros((many, *size))
        for touch in contact.touches(moment):
            found[touch.index] = law(touch)
        return found

    def added(law: Law) -> Callable[[Moment], float | Array]:
        if many:
            return lambda moment: spread(moment, law)
        return lambda moment: sum((law(touch) for touch in contact.touches(moment)), 0.0)

    def of_deepest(law: Law, *size: int) -> Callable[[Moment], float | Array]:
        if many:
            return lambda moment: spread(moment, law, *size)
        return lambda moment: law(deepest(moment))

    if is_on(block, "SenseContactSignal"):
        yield Quantity(
            port=ports.next(), shape=shape, of_state=lambda m: (separation(m) < 0.0).astype(float)
        )
    if is_on(block, "SensePenetrationDepth"):
        yield Quantity(
            port=ports.next(), shape=shape, of_state=lambda m: np.maximum(0.0, -separation(m))
        )
    if is_on(block, "SenseSeparationDistance"):
        yield Quantity(port=ports.next(), shape=shape, of_state=separation)
    for switch, law in SUMS:
        if is_on(block, switch):
            yield Quantity(port=ports.next(), shape=shape, of_state=added(law))
    if is_on(block, "SenseNormalVelocity"):
        yield Quantity(
            port=ports.next(), shape=shape, of_state=of_deepest(lambda touch: touch.approach)
        )
    if is_on(block, "SenseTangentialVelocity"):
        yield Quantity(port=ports.next(), shape=(*shape, 2), of_state=of_deepest(_across, 2))
    for end, side in (("Base", contact.base), ("Follower", contact.follower)):
        rotation = partial(_rotation, side.place, deepest)
        translation = partial(_translation, side.place, deepest)
        if is_on(block, f"SenseContact{end}Rotation"):
            yield Quantity(port=ports.next(), shape=(3, 3), of_state=rotation)
        if is_on(block, f"SenseContact{end}Translation"):
            yield Quantity(port=ports.next(), shape=(3,), of_state=translation)


def _across(touch: Touch) -> Array:
    """Return the follower's slip along x and y of the contact's frame [m/s]."""
    slip: Array = touch.slip @ contact_axes(touch.normal)[:, :2]
    return slip


def _rotation(place: Place, touch: Callable[[Moment], Touch], moment: Moment) -> Array:
    """Return the rotation of the contact's frame in a geometry's."""
    R: Array = moment.pose(place)[0].T @ contact_axes(touch(moment).normal)
    return R


def _translation(place: Place, touch: Callable[[Moment], Touch], moment: Moment) -> Array:
    """Return the place of the contact's frame in a geometry's [m]."""
    R_WS, p_WS = moment.pose(place)
    p: Array = R_WS.T @ (touch(moment).point - p_WS)
    return p
