"""What joints and Transform Sensors put out, in the order of their ports."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from drake_leg.simulink.dynamics.coordinates import Axis, Ball
from drake_leg.simulink.dynamics.joints import COMPONENTS, FIRST_PORT, Joints, prefix_of
from drake_leg.simulink.dynamics.moment import Moment
from drake_leg.simulink.dynamics.ports import Bus
from drake_leg.simulink.dynamics.turns import quaternion
from drake_leg.simulink.model import Block, is_on
from drake_leg.simulink.multibody.mass import Array

Value = float | Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """What follows from the inputs at a moment."""

    moment: Moment
    u: Array
    vdot: Array  # (nv,)
    driving: Array  # of each motion-driven axis [N*m or N], in the order of the motions
    wrenches: Mapping[int, Array]  # of forces and constraints on bodies, at their origins


@dataclass(frozen=True, eq=False, kw_only=True)
class Quantity:
    """A physical signal that a block puts out."""

    port: str
    shape: tuple[int, ...] = ()
    of_state: Callable[[Moment], Value] | None = None
    of_response: Callable[[Response], Value] | None = None
    linear: tuple[Array, float] | None = None  # row and offset: what it is of the plant's state
    bus: Bus = ()  # what its numbers are of a bus; none where it is no bus


ACTUATOR = (
    "SenseTorqueForce", "SenseActuatorTorque", "SenseActuatorForce", "SenseTorque", "SenseForce",
)  # fmt: skip


class Ports:
    """Numbers the ports of a block at which signals leave it."""

    def __init__(self, block: Block) -> None:
        self._block, self._next = block, FIRST_PORT

    def next(self) -> str:
        """Return the next port."""
        self._next += 1
        return f"{self._block.sid}#rconn:{self._next - 1}"


def sensed_of_axis(joints: Joints, axis: Axis, ports: Ports) -> Iterator[Quantity]:
    """List what a primitive of one axis puts out."""
    block, index = axis.joint.block, joints.number[id(axis)]
    if axis.primitive.kind == "screw":
        yield from _of_screw(axis, ports)
        return
    prefix = prefix_of(block, axis.primitive)
    driving = [place for place, motion in enumerate(joints.motions) if motion.axis == index]
    S = axis.S

    def effort(response: Response) -> float:
        given = joints.actuator_force(index, response.u, response.vdot)
        return given + float(sum(response.driving[place] for place in driving))

    if is_on(block, f"{prefix}SensePosition"):
        row = np.concatenate([axis.A, np.zeros_like(S)])
        yield Quantity(port=ports.next(), linear=(row, axis.b))
    if is_on(block, f"{prefix}SenseVelocity"):
        yield Quantity(port=ports.next(), linear=(np.concatenate([np.zeros_like(axis.A), S]), 0.0))
    if is_on(block, f"{prefix}SenseAcceleration"):
        yield Quantity(port=ports.next(), of_response=partial(_acceleration, S))
    if any(is_on(block, prefix + name) for name in ACTUATOR):
        yield Quantity(port=ports.next(), of_response=effort)
    for name, side in (("Lower", -1.0), ("Upper", 1.0)):
        if is_on(block, f"{prefix}Sense{name}LimitTorqueForce"):
            law = partial(joints.stop_force, axis=index, side=side)
            yield Quantity(port=ports.next(), of_state=law)


def _of_screw(axis: Axis, ports: Ports) -> Iterator[Quantity]:
    """List what a Lead Screw puts out: how it turns, then how it moves."""
    block, (A, b, S) = axis.joint.block, (axis.A, axis.b, axis.S)
    for what, scale in (("Rotation", 1.0), ("Translation", axis.primitive.lead)):
        if is_on(block, f"Sense{what}Position"):
            row = np.concatenate([scale * A, np.zeros_like(S)])
            yield Quantity(port=ports.next(), linear=(row, scale * b))
        if is_on(block, f"Sense{what}Velocity"):
            row = np.concatenate([np.zeros_like(A), scale * S])
            yield Quantity(port=ports.next(), linear=(row, 0.0))
        if is_on(block, f"Sense{what}Acceleration"):
            law = partial(_acceleration, scale * S)
            yield Quantity(port=ports.next(), of_response=law)


def _acceleration(S: Array, response: Response) -> float:
    return float(S @ response.vdot)


def sensed_of_ball(joints: Joints, ball: Ball, ports: Ports) -> Iterator[Quantity]:
    """List what a spherical primitive puts out."""
    block, index = ball.joint.block, joints.balls.index(ball)
    prefix = prefix_of(block, ball.primitive)
    in_follower = block.parameters.get(f"{prefix}SensingFrame") == "FollowerFrame"

    def resolved(R_BF: Array, vector: Array) -> Array:
        return R_BF.T @ vector if in_follower else vector

    def velocity(moment: Moment) -> Array:
        R_BF = ball.rotation(moment.q)
        return resolved(R_BF, ball.in_base(R_BF, moment.v))

    def acceleration(response: Response) -> Array:
        """Differentiate the angular velocity in the base."""
        R_BF = ball.rotation(response.moment.q)
        return resolved(R_BF, ball.in_base(R_BF, response.vdot))

    def torque(response: Response) -> Array:
        R_BF = ball.rotation(response.moment.q)
        return resolved(R_BF, joints.actuator_torque(index, response.moment, response.u))

    if is_on(block, f"{prefix}SensePosition"):
        yield Quantity(
            port=ports.next(),
            shape=(4,),
            of_state=lambda moment: quaternion(ball.rotation(moment.q)),
        )
    for name, of_state, of_response in (
        ("Velocity", velocity, None),
        ("Acceleration", None, acceleration),
        ("Torque", None, torque),
    ):
        for place, component in enumerate(COMPONENTS):
            if is_on(block, f"{prefix}Sense{name}{component}"):
                yield Quantity(
                    port=ports.next(),
                    of_state=of_state and _component(of_state, place),
                    of_response=of_response and _component(of_response, place),
                )
        whole = ACTUATOR if name == "Torque" else (f"Sense{name}",)
        if any(is_on(block, prefix + switch) for switch in whole):
            yield Quantity(
                port=ports.next(), shape=(3,), of_state=of_state, of_response=of_response
            )


def _component(of: Callable[..., Array], place: int) -> Callable[..., float]:
    return lambda at: float(of(at)[place])
