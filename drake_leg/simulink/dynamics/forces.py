"""Forces and torques between frames, as their blocks say."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drake_leg.simulink.dynamics.moment import Moment, Place
from drake_leg.simulink.dynamics.ports import Layout
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.model import Block, is_on, number
from drake_leg.simulink.multibody.mass import Array

GRAVITATION = 6.67384e-11  # [m^3/(kg*s^2)], CODATA 2010
COMPONENTS: tuple[tuple[str, tuple[int, ...]], ...] = (
    ("X", (0,)), ("Y", (1,)), ("Z", (2,)), ("", (0, 1, 2)),
)  # fmt: skip


class StateForce(Protocol):
    """A force that depends on positions and velocities alone."""

    def act(self, moment: Moment, wrenches: Wrenches) -> None:
        """Add the wrenches on bodies."""
        ...


class InputForce(Protocol):
    """A force that is an input."""

    def act(self, moment: Moment, u: Array, wrenches: Wrenches) -> None:
        """Add the wrenches on bodies."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class _Part:
    """Components of a force or a torque that one port takes."""

    turns: bool  # whether it is a torque
    in_world: bool
    components: tuple[int, ...]
    entries: slice  # of u


class ExternalForce:
    """Forces and torques on one frame, resolved in it or in the world."""

    def __init__(self, block: Block, place: Place, inputs: Layout) -> None:
        self._place = place
        self._parts: list[_Part] = []
        for what in ("Force", "Torque"):
            frame = block.parameters.get(f"{what}ResolutionFrame", "AttachedFrame")
            for name, components in COMPONENTS:
                if is_on(block, f"Enable{what}{name}"):
                    port = f"{block.sid}#lconn:{len(self._parts) + 1}"
                    shape = () if len(components) == 1 else (3,)
                    part = _Part(
                        turns=what == "Torque",
                        in_world=frame == "World",
                        components=components,
                        entries=inputs.add(port, shape),
                    )
                    self._parts.append(part)

    def act(self, moment: Moment, u: Array, wrenches: Wrenches) -> None:
        """Add the wrench on the body."""
        R_WF, p_WF = moment.pose(self._place)
        total = np.zeros((2, 3))
        for part in self._parts:
            given = np.zeros(3)
            given[list(part.components)] = u[part.entries]
            total[int(part.turns)] += given if part.in_world else R_WF @ given
        wrenches.add(moment, self._place.body, p_WF, total[0], total[1])


class _Pair:
    """Opposite forces on two frames, along the line between their origins."""

    def __init__(self, base: Place, follower: Place) -> None:
        self._base, self._follower = base, follower

    def line(self, moment: Moment) -> tuple[float, Array]:
        """Return the distance and the direction from the base to the follower."""
        apart = moment.pose(self._follower)[1] - moment.pose(self._base)[1]
        length = math.sqrt(float(apart @ apart))
        return length, apart / length if length else np.zeros(3)

    def growth(self, moment: Moment, direction: Array) -> float:
        """Return the rate of the distance [m/s]."""
        return float((moment.twist(self._follower)[1] - moment.twist(self._base)[1]) @ direction)

    def push(self, moment: Moment, wrenches: Wrenches, force: Array) -> None:
        """Add a force on the follower, and its opposite on the base."""
        for place, sign in ((self._follower, 1.0), (self._base, -1.0)):
            wrenches.add(moment, place.body, moment.pose(place)[1], sign * force)


class InternalForce(_Pair):
    """A force that is an input: positive pushes the frames apart."""

    def __init__(self, block: Block, base: Place, follower: Place, inputs: Layout) -> None:
        super().__init__(base, follower)
        self._entry = inputs.add(f"{block.sid}#lconn:2").start

    def act(self, moment: Moment, u: Array, wrenches: Wrenches) -> None:
        """Add the wrenches on bodies."""
        _, direction = self.line(moment)
        self.push(moment, wrenches, u[self._entry] * direction)


class SpringDamper(_Pair):
    """A linear spring and a damper between the origins of two frames."""

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        super().__init__(base, follower)
        self._rest, self._stiffness, self._damping = (
            number(block.parameters.get(name))
            for name in ("NaturalLength", "SpringStiffness", "DampingCoefficient")
        )

    def force(self, moment: Moment) -> float:
        """Return the force that pushes the frames apart [N]."""
        length, direction = self.line(moment)
        rate = self.growth(moment, direction)
        return -self._stiffness * (length - self._rest) - self._damping * rate

    def act(self, moment: Moment, wrenches: Wrenches) -> None:
        """Add the wrenches on bodies."""
        self.push(moment, wrenches, self.force(moment) * self.line(moment)[1])


class InverseSquare(_Pair):
    """A force ``k / d^2``, which pushes the frames apart where k is positive."""

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        super().__init__(base, follower)
        self._constant = number(block.parameters.get("ForceConstant"))

    def force(self, moment: Moment) -> float:
        """Return the force that pushes the frames apart [N]."""
        length, _ = self.line(moment)
        return self._constant / length**2 if length else 0.0

    def act(self, moment: Moment, wrenches: Wrenches) -> None:
        """Add the wrenches on bodies."""
        self.push(moment, wrenches, self.force(moment) * self.line(moment)[1])


class Weights:
    """The masses of bodies, for forces that act on all of them."""

    def __init__(self, moment: Moment) -> None:
        self.of = [
            (body, mass, center)
            for body, each in enumerate(moment.bodies)
            if body and (mass := each.default_mass()) > 0.0
            for center in [each.default_com()]
        ]

    def centers(self, moment: Moment) -> Sequence[tuple[int, float, Array]]:
        """Return body, mass and center of mass in the world, of each."""
        return [
            (body, mass, moment.body_pose(body)[:, :3] @ center + moment.body_pose(body)[:, 3])
            for body, mass, center in self.of
        ]


class Field:
    """The gravity of a point mass at a frame, which pulls all bodies."""

    def __init__(self, block: Block, place: Place, weights: Weights) -> None:
        self._place, self._weights = place, weights
        self._pull = GRAVITATION * number(block.parameters.get("Mass"))

    def act(self, moment: Moment, wrenches: Wrenches) -> None:
        """Add the wrenches on bodies, and their opposites where the mass is."""
        _, p_W = moment.pose(self._place)
        for body, mass, center in self._weights.centers(moment):
            apart = p_W - center
            length = math.sqrt(float(apart @ apart))
            if body != self._place.body and length:
                force = self._pull * mass / length**3 * apart
                wrenches.add(moment, body, center, force)
                wrenches.add(moment, self._place.body, p_W, -force)


class Gravity:
    """A uniform gravity that is an input, an acceleration in the world."""

    def __init__(self, block: Block, weights: Weights, inputs: Layout) -> None:
        self._weights = weights
        self._entries = inputs.add(f"{block.sid}#lconn:1", (3,))

    def act(self, moment: Moment, u: Array, wrenches: Wrenches) -> None:
        """Add the weights of all bodies."""
        for body, mass, center in self._weights.centers(moment):
            wrenches.add(moment, body, center, mass * u[self._entries])
