"""Contact whose normal force or friction is an input of its block."""

from __future__ import annotations

from itertools import count

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.contact import Contact, ContactLaw, contact_axes
from drake_leg.simulink.dynamics.contact_sensing import SUMS
from drake_leg.simulink.dynamics.moment import Moment
from drake_leg.simulink.dynamics.ports import Layout
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.model import Block, is_on
from drake_leg.simulink.multibody.mass import Array

BY_INPUT = "ProvidedByInput"


def is_given(block: Block) -> bool:
    """Whether a force of a contact is an input."""
    return BY_INPUT in (
        block.parameters.get("NormalForceType"),
        block.parameters.get("FrictionType"),
    )


class GivenContact:
    """The forces of a contact that are inputs, at its deepest point, while the two touch.

    The normal force pushes the two apart as it is given. Friction is given by its x and y in the
    contact's frame, and acts on the follower; else it follows its law.

    Raises
    ------
    InvalidValueError
        If a cloud of points touches, or the block measures the forces.
    """

    def __init__(self, block: Block, contact: Contact, law: ContactLaw, inputs: Layout) -> None:
        self._contact, self._law = contact, law
        about = f"the block {block.name!r} (SID {block.sid}) takes its forces from inputs"
        if contact.points > 1:
            raise InvalidValueError(f"{about}, one for each point of a cloud, which is not built")
        if any(is_on(block, switch) for switch, _ in SUMS):
            raise InvalidValueError(f"{about}, and senses them: use the inputs themselves")
        ports = (f"{block.sid}#lconn:{number}" for number in count(2))
        by_input = [
            block.parameters.get(name) == BY_INPUT for name in ("NormalForceType", "FrictionType")
        ]
        self._push = inputs.add(next(ports)) if by_input[0] else None
        self._across = inputs.add(next(ports), (2,)) if by_input[1] else None

    def act(self, moment: Moment, u: Array, wrenches: Wrenches) -> None:
        """Add the forces on both bodies."""
        touching = [touch for touch in self._contact.touches(moment) if touch.separation < 0.0]
        if not touching:
            return
        touch = min(touching, key=lambda each: each.separation)
        push = float(u[self._push.start]) if self._push else 0.0
        force: Array = push * touch.normal
        if self._across:
            force = force + contact_axes(touch.normal)[:, :2] @ u[self._across]
        elif touch.speed > 0.0:
            friction = self._law.friction(touch.speed) * abs(push)
            force = force - friction / touch.speed * touch.slip
        if np.any(force):
            self._contact.push(moment, wrenches, touch, force)
