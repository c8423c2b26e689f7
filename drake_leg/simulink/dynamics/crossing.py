"""The force and torque that cross a joint, and those of them that are of its constraints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from drake_leg.simulink.dynamics.coordinates import Axis, Ball, Coordinate
from drake_leg.simulink.dynamics.joints import COMPONENTS
from drake_leg.simulink.dynamics.moment import Moment, Place, cross
from drake_leg.simulink.dynamics.sensing import Ports, Quantity, Response
from drake_leg.simulink.model import is_on
from drake_leg.simulink.multibody.bodies import Joint, Mechanism
from drake_leg.simulink.multibody.mass import Array


class Crossing:
    """The wrenches that cross the joints of a tree."""

    def __init__(self, tree: Mechanism, gravity: Array) -> None:
        self._gravity = gravity
        self._masses = [body.properties for body in tree.bodies]
        self._beyond: dict[str, list[int]] = {}
        self._child: dict[str, int] = {}
        for joint in reversed(tree.joints):
            child = joint.base if joint.reversed else joint.follower
            beyond = [child]
            for other in tree.joints:
                parent = other.follower if other.reversed else other.base
                if parent == child:
                    beyond += self._beyond[other.name]
            self._beyond[joint.name], self._child[joint.name] = beyond, child

    def on_child(self, joint: Joint, response: Response) -> tuple[int, Array]:
        """Return the outer body of a joint, and the wrench on it at its origin, in the world."""
        moment, child = response.moment, self._child[joint.name]
        p_WC = moment.body_pose(child)[:, 3]
        total = np.zeros(6)
        for body in self._beyond[joint.name]:
            X_WB = moment.body_pose(body)
            wrench = self._inertial(body, response) - response.wrenches.get(body, np.zeros(6))
            total[:3] += wrench[:3] + cross(X_WB[:, 3] - p_WC, wrench[3:])
            total[3:] += wrench[3:]
        return child, total

    def _inertial(self, body: int, response: Response) -> Array:
        """Return the wrench at a body's origin that it takes to move it against gravity."""
        mass = self._masses[body]
        if mass.is_nothing:
            return np.zeros(6)
        moment = response.moment
        R_WB = moment.body_pose(body)[:, :3]
        c, inertia = R_WB @ mass.center, R_WB @ mass.inertia @ R_WB.T
        w = moment.body_twist(body)[:3]
        here = Place(body=body, X_BF=np.eye(4))
        alpha, a = moment.acceleration(here, response.vdot)
        force = mass.mass * (a + cross(alpha, c) + cross(w, cross(w, c)) - self._gravity)
        torque = inertia @ alpha + cross(w, inertia @ w) + cross(c, force)
        return np.concatenate([torque, force])


def sensed_of_crossing(
    joint: Joint, coordinates: list[Coordinate], crossing: Crossing, ports: Ports
) -> Iterator[Quantity]:
    """List the forces and torques that cross a joint, as far as it puts them out.

    Those of the constraints are what remains without the directions in which it moves.
    """
    block = joint.block
    for what in ("Constraint", "Total"):
        for place, kind in ((1, "Force"), (0, "Torque")):
            law = partial(_sensed, joint, coordinates, crossing, what == "Constraint", place)
            if is_on(block, f"Sense{what}{kind}"):
                yield Quantity(port=ports.next(), shape=(3,), of_response=law)
            for number, component in enumerate(COMPONENTS):
                if is_on(block, f"Sense{what}{kind}{component}"):
                    yield Quantity(port=ports.next(), of_response=_component(law, number))


def _component(law: Callable[[Response], Array], number: int) -> Callable[[Response], float]:
    return lambda response: float(law(response)[number])


def _sensed(
    joint: Joint,
    coordinates: list[Coordinate],
    crossing: Crossing,
    constrained: bool,
    place: int,
    response: Response,
) -> Array:
    """Return a torque (place 0) or a force (1), resolved in the base or the follower."""
    moment, get = response.moment, joint.block.parameters.get
    base = Place(body=joint.base, X_BF=joint.X_PB)
    follower = Place(body=joint.follower, X_BF=joint.X_CF)
    (R_WB, p_WB), (R_WF, p_WF) = moment.pose(base), moment.pose(follower)
    child, wrench = crossing.on_child(joint, response)
    on_follower = get("CompositeWrenchDir", "FollowerOnBase") == "BaseOnFollower"
    if on_follower == joint.reversed:
        wrench = -wrench
    in_follower = get("CompositeWrenchFrame", "BaseFrame") == "FollowerFrame"
    at = p_WF if in_follower else p_WB
    torque = wrench[:3] + cross(moment.body_pose(child)[:, 3] - at, wrench[3:])
    vector = wrench[3:] if place else torque
    if constrained:
        free = _free(coordinates, moment, R_WB, slides=bool(place))
        vector = vector - free @ np.linalg.pinv(free) @ vector
    R: Array = R_WF if in_follower else R_WB
    found: Array = R.T @ vector
    return found


def _free(coordinates: list[Coordinate], moment: Moment, R: Array, *, slides: bool) -> Array:
    """Return the directions (3, n) in which a joint slides, or about which it turns."""
    found = [np.zeros((3, 0))]
    for coordinate in coordinates:
        primitive = coordinate.primitive
        if isinstance(coordinate, Ball):
            if not slides:
                found.append(np.eye(3))
            R = R @ coordinate.rotation(moment.q)
            continue
        assert isinstance(coordinate, Axis)
        if primitive.kind == "screw" or (primitive.kind == "slide") is slides:
            found.append(R[:, [primitive.axis]])
        position = np.array([float(coordinate.A @ moment.q) + coordinate.b])
        R = R @ primitive.pose(position)[:3, :3]
    return np.hstack(found)
