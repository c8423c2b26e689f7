"""What acts at joints: springs, dampers, limits, and the forces and motions that are inputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.coordinates import Axis, Ball, Coordinate
from drake_leg.simulink.dynamics.moment import Moment
from drake_leg.simulink.dynamics.ports import Layout
from drake_leg.simulink.dynamics.turns import rotvec
from drake_leg.simulink.mechanism import rotation_of
from drake_leg.simulink.model import Block, invalid_parameter, is_on, number
from drake_leg.simulink.multibody.joints import SINGLE, Primitive
from drake_leg.simulink.multibody.mass import Array

FIRST_PORT = 2  # of what enters or leaves a joint; before are its frames
COMPONENTS = ("X", "Y", "Z")
SIDES = (("Lower", -1.0), ("Upper", 1.0))


def prefix_of(block: Block, primitive: Primitive) -> str:
    """Return what the names of a primitive's parameters begin with."""
    return "" if block.kind in SINGLE or primitive.kind == "screw" else primitive.name


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """An axis that follows an input: position, velocity, acceleration."""

    axis: int
    entries: slice  # of u


@dataclass(frozen=True, eq=False, kw_only=True)
class _Stop:
    """A limit of an axis."""

    axis: int
    side: float  # -1 of a lower limit, 1 of an upper one
    bound: float  # [rad or m]
    stiffness: float  # [N*m/rad or N/m]
    damping: float  # [N*m*s/rad or N*s/m]
    width: float  # [rad or m]


class Joints:
    """The coordinates of a mechanism's joints, what acts at them and what drives them.

    Positions and rates of those of one axis are ``A q + b`` and ``S v``; all of them at once.
    """

    def __init__(self, coordinates: Sequence[Coordinate], inputs: Layout, nq: int, nv: int) -> None:
        self.axes = [each for each in coordinates if isinstance(each, Axis)]
        self.balls = [each for each in coordinates if isinstance(each, Ball)]
        self.problems: list[str] = []
        self.motions: list[Motion] = []
        self.motion_ports: set[str] = set()
        self.A = np.array([axis.A for axis in self.axes]).reshape(len(self.axes), nq)
        self.b = np.array([axis.b for axis in self.axes])
        self.S = np.array([axis.S for axis in self.axes]).reshape(len(self.axes), nv)
        self.number = {id(axis): index for index, axis in enumerate(self.axes)}
        self.forced: list[tuple[int, int]] = []  # axis, entry of u, of its force
        self.felt = np.zeros(len(self.axes))  # inertias of networks at them [kg*m^2 or kg]
        self._torques: list[tuple[int, slice, tuple[int, ...], bool]] = []
        self._add_inputs(coordinates, inputs)
        self._stops = [
            stop for index, axis in enumerate(self.axes) for stop in self._stops_of(axis, index)
        ]
        self._stop_axes = np.array([stop.axis for stop in self._stops], dtype=int)
        self._sides = np.array([stop.side for stop in self._stops])
        self._bounds = np.array([stop.bound for stop in self._stops])
        self._rests = [self._attempt(np.eye(3), _rest, ball) for ball in self.balls]
        self._find_springs()
        self._forced = np.array([axis for axis, _ in self.forced], dtype=int)
        self._forcing = np.array([entry for _, entry in self.forced], dtype=int)

    def positions(self, moment: Moment) -> Array:
        """Return the positions of all axes [rad or m]."""
        x: Array = self.A @ moment.q + self.b
        return x

    def rates(self, moment: Moment) -> Array:
        """Return the rates of all axes [rad/s or m/s]."""
        rates: Array = self.S @ moment.v
        return rates

    def followed(self, state: Array, u: Array) -> Array:
        """Return a state of the plant whose driven axes are at their motions."""
        found, nq = state.copy(), self.A.shape[1]
        for motion in self.motions:
            x, rate, _ = u[motion.entries]
            A, S = self.A[motion.axis], self.S[motion.axis]
            found[:nq] += A * (x - self.b[motion.axis] - A @ found[:nq])
            found[nq:] += S * (rate - S @ found[nq:])
        return found

    def stop_force(self, moment: Moment, axis: int, side: float) -> float:
        """Return the force of one limit along its axis [N*m or N]."""
        x, rate = self.positions(moment), self.rates(moment)
        return sum(
            _pushed(stop, x[axis], rate[axis])
            for stop in self._stops
            if (stop.axis, stop.side) == (axis, side)
        )

    def internal(self, moment: Moment) -> Array:
        """Return the generalized forces of what is inside joints and not in the plant, (nv,)."""
        total = np.zeros(len(moment.v))
        if len(self._stops):
            x = self.positions(moment)
            beyond = self._sides * (x[self._stop_axes] - self._bounds) > 0.0
            if beyond.any():
                rates = self.rates(moment)
                for index in np.flatnonzero(beyond):
                    stop = self._stops[index]
                    total += self.S[stop.axis] * _pushed(stop, x[stop.axis], rates[stop.axis])
        if len(self._sprung):
            sprung = self._sprung
            S = self.S[sprung]
            x = self.A[sprung] @ moment.q + self.b[sprung]
            total -= (self._stiffness * (x - self._rest) + self._damping * (S @ moment.v)) @ S
        for ball, R_BE in zip(self.balls, self._rests, strict=True):
            primitive = ball.primitive
            if primitive.stiffness or primitive.damping:
                R_BF = ball.rotation(moment.q)
                w = ball.in_base(R_BF, moment.v)
                turn = R_BE @ rotvec(R_BE.T @ R_BF)
                torque = -primitive.stiffness * turn - primitive.damping * w
                total[ball.v : ball.v + 3] += ball.force(R_BF, torque)
        return total

    def actuation(self, moment: Moment, u: Array) -> Array:
        """Return the generalized forces of the forces and torques that are inputs, (nv,)."""
        total: Array = u[self._forcing] @ self.S[self._forced]
        for index, entries, components, in_follower in self._torques:
            ball = self.balls[index]
            torque = np.zeros(3)
            torque[list(components)] = u[entries]
            R_BF = ball.rotation(moment.q)
            total[ball.v : ball.v + 3] += ball.force(R_BF, R_BF @ torque if in_follower else torque)
        return total

    def actuator_torque(self, ball: int, moment: Moment, u: Array) -> Array:
        """Return the torque of the inputs of a ball, in the base."""
        total = np.zeros(3)
        for index, entries, components, in_follower in self._torques:
            if index == ball:
                torque = np.zeros(3)
                torque[list(components)] = u[entries]
                R_BF = self.balls[ball].rotation(moment.q)
                total += R_BF @ torque if in_follower else torque
        return total

    def actuator_force(self, axis: int, u: Array, vdot: Array) -> float:
        """Return the force of the input of an axis, and of a network's inertia [N*m or N]."""
        given = sum(u[entry] for index, entry in self.forced if index == axis)
        return float(given - self.felt[axis] * (self.S[axis] @ vdot))

    def _attempt(self, otherwise: Array, work: Callable[[Ball], Array], ball: Ball) -> Array:
        try:
            return work(ball)
        except InvalidValueError as error:
            self.problems.append(str(error))
            return otherwise

    def _add_inputs(self, coordinates: Sequence[Coordinate], inputs: Layout) -> None:
        """Number the ports of each joint's inputs, primitive by primitive."""
        used: dict[str, int] = {}
        for coordinate in coordinates:
            block, primitive = coordinate.joint.block, coordinate.primitive
            get, prefix = block.parameters.get, prefix_of(block, primitive)
            place = used.get(block.sid, FIRST_PORT)
            forced = get(f"{prefix}TorqueActuationMode") == "InputTorque"
            moved = get(f"{prefix}MotionActuationMode") == "InputMotion"
            if isinstance(coordinate, Axis):
                index = self.number[id(coordinate)]
                if forced:
                    entries = inputs.add(f"{block.sid}#lconn:{place}")
                    self.forced.append((index, entries.start))
                    place += 1
                if moved:
                    port = f"{block.sid}#lconn:{place}"
                    self.motions.append(Motion(axis=index, entries=inputs.add(port, (3,))))
                    self.motion_ports.add(port)
                    place += 1
            else:
                if moved:
                    self.problems.append(
                        f"the block {block.name!r} (SID {block.sid}) has the motion of a spherical "
                        "primitive as an input, which is not supported: drive it by a torque"
                    )
                if forced:
                    place = self._add_torques(coordinate, inputs, prefix, place)
            used[block.sid] = place

    def _add_torques(self, ball: Ball, inputs: Layout, prefix: str, place: int) -> int:
        block, index = ball.joint.block, self.balls.index(ball)
        in_follower = block.parameters.get(f"{prefix}ActuationFrame") == "FollowerFrame"
        single = [
            (number,)
            for number, component in enumerate(COMPONENTS)
            if is_on(block, f"{prefix}ActuateTorque{component}")
        ]
        whole = is_on(block, f"{prefix}ActuateTorque") or not single
        for components in [*single, *([(0, 1, 2)] if whole else [])]:
            shape = () if len(components) == 1 else (3,)
            entries = inputs.add(f"{block.sid}#lconn:{place}", shape)
            self._torques.append((index, entries, components, in_follower))
            place += 1
        return place

    def _stops_of(self, axis: Axis, index: int) -> list[_Stop]:
        block, primitive = axis.joint.block, axis.primitive
        prefix, found = prefix_of(block, primitive), []
        for (name, side), bound in zip(SIDES, (primitive.lower, primitive.upper), strict=True):
            if bound is None or not np.isfinite(bound):
                continue
            stiffness, damping, width = (
                number(block.parameters.get(f"{prefix}{name}Limit{what}"))
                for what in ("Stiffness", "Damping", "TransitionRegionWidth")
            )
            if not width > 0.0:
                parameter = f"{prefix}{name}LimitTransitionRegionWidth"
                self.problems.append(
                    str(invalid_parameter(block, parameter, "it must be a positive number"))
                )
                continue
            found.append(
                _Stop(
                    axis=index,
                    side=side,
                    bound=bound,
                    stiffness=stiffness,
                    damping=damping,
                    width=width,
                )
            )
        return found

    def _find_springs(self) -> None:
        """Find the axes of floating bases with springs or dampers, which are not in the plant."""
        floating = {ball.joint.name for ball in self.balls if ball.R_WB is not None}
        self._sprung = [
            index
            for index, axis in enumerate(self.axes)
            if axis.joint.name in floating and (axis.primitive.stiffness or axis.primitive.damping)
        ]
        sprung = [self.axes[index].primitive for index in self._sprung]
        self._stiffness = np.array([primitive.stiffness for primitive in sprung])
        self._damping = np.array([primitive.damping for primitive in sprung])
        self._rest = np.array([primitive.rest for primitive in sprung])


def _pushed(stop: _Stop, x: float, rate: float) -> float:
    """Return the force of a limit along its axis; it never pulls."""
    depth = stop.side * (x - stop.bound)
    if depth <= 0.0:
        return 0.0
    push = max(0.0, stop.stiffness * depth + stop.damping * stop.side * rate)
    return -stop.side * smooth(depth / stop.width) * push


def smooth(s: float) -> float:
    """Rise from 0 at 0 to 1 at 1, with slope 0 at both: ``3 s^2 - 2 s^3``."""
    return 0.0 if s <= 0.0 else 1.0 if s >= 1.0 else s * s * (3.0 - 2.0 * s)


def _rest(ball: Ball) -> Array:
    """Return R_BF at which the spring of a ball is at rest."""
    block = ball.joint.block
    prefix = prefix_of(block, ball.primitive)
    for name, _ in SIDES:
        if is_on(block, f"{prefix}{name}LimitSpecify"):
            raise InvalidValueError(
                f"the block {block.name!r} (SID {block.sid}) has a limit of a spherical primitive, "
                "which is not supported: switch it off, or replace the joint by a Gimbal Joint"
            )
    if not ball.primitive.stiffness:
        return np.eye(3)
    return rotation_of(block, f"{prefix}EqPos")
