"""How one frame moves with respect to another one: Transform Sensors, and joints that only sense.

A measurement frame M that rotates sees the rotation of what it measures in its derivatives; one
that does not rotate is only the directions in which they are resolved.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial, wraps

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.joints import COMPONENTS, prefix_of
from drake_leg.simulink.dynamics.moment import Moment, Place, cross
from drake_leg.simulink.dynamics.sensing import ACTUATOR, Ports, Quantity, Response
from drake_leg.simulink.dynamics.turns import quaternion, rotvec
from drake_leg.simulink.model import Block, is_on
from drake_leg.simulink.multibody.bodies import Joint
from drake_leg.simulink.multibody.mass import Array

UNTURNED = np.eye(3)
MEASURED_IN = ("World", "Base", "Follower", "NonRotatingBase", "NonRotatingFollower")


def kept(law: Callable[[Relative, Moment], Array]) -> Callable[[Relative, Moment], Array]:
    """Compute a quantity once a moment."""

    @wraps(law)
    def keeping(self: Relative, moment: Moment) -> Array:
        key = self, law
        found = moment.memo.get(key)
        if not isinstance(found, np.ndarray):
            found = moment.memo[key] = law(self, moment)
        return found

    return keeping


class Relative:
    """The motion of a follower frame F from a base frame B, measured in a frame M."""

    def __init__(self, base: Place, follower: Place, frame: str) -> None:
        self._base, self._follower = base, follower
        self._of_base = frame.endswith("Base")
        self._rotates = frame in ("Base", "Follower")
        self._is_world = frame == "World"

    @kept
    def rotation(self, moment: Moment) -> Array:
        """Return R_BF."""
        R: Array = moment.pose(self._base)[0].T @ moment.pose(self._follower)[0]
        return R

    @kept
    def turning(self, moment: Moment) -> Array:
        """Return w_BF in F."""
        w = moment.twist(self._follower)[0] - moment.twist(self._base)[0]
        w_BF_F: Array = moment.pose(self._follower)[0].T @ w
        return w_BF_F

    @kept
    def position(self, moment: Moment) -> Array:
        """Return p_BF in M [m]."""
        p: Array = self._R_MW(moment) @ self._apart(moment)
        return p

    @kept
    def velocity(self, moment: Moment) -> Array:
        """Return the derivative of the position that M sees [m/s]."""
        v = moment.twist(self._follower)[1] - moment.twist(self._base)[1]
        if self._rotates:
            v = v - cross(self._w_WM(moment), self._apart(moment))
        found: Array = self._R_MW(moment) @ v
        return found

    def acceleration(self, response: Response) -> Array:
        """Return the second derivative of the position that M sees [m/s^2]."""
        moment = response.moment
        a = self._accelerated(response, self._follower)[1]
        a = a - self._accelerated(response, self._base)[1]
        if self._rotates:
            p, w = self._apart(moment), self._w_WM(moment)
            v = moment.twist(self._follower)[1] - moment.twist(self._base)[1]
            alpha = self._accelerated(response, self._measuring)[0]
            a = a - cross(alpha, p) - 2.0 * cross(w, v) + cross(w, cross(w, p))
        found: Array = self._R_MW(moment) @ a
        return found

    @kept
    def angular_velocity(self, moment: Moment) -> Array:
        """Return w_BF in M [rad/s]."""
        w: Array = moment.twist(self._follower)[0] - moment.twist(self._base)[0]
        found: Array = self._R_MW(moment) @ w
        return found

    def angular_acceleration(self, response: Response) -> Array:
        """Return the derivative of the angular velocity that M sees [rad/s^2]."""
        moment = response.moment
        alpha = self._accelerated(response, self._follower)[0]
        alpha = alpha - self._accelerated(response, self._base)[0]
        if self._rotates:
            w = moment.twist(self._follower)[0] - moment.twist(self._base)[0]
            alpha = alpha - cross(self._w_WM(moment), w)
        found: Array = self._R_MW(moment) @ alpha
        return found

    @property
    def _measuring(self) -> Place:
        return self._base if self._of_base else self._follower

    def _R_MW(self, moment: Moment) -> Array:
        return UNTURNED if self._is_world else moment.pose(self._measuring)[0].T

    def _w_WM(self, moment: Moment) -> Array:
        return moment.twist(self._measuring)[0]

    @kept
    def _apart(self, moment: Moment) -> Array:
        apart: Array = moment.pose(self._follower)[1] - moment.pose(self._base)[1]
        return apart

    def _accelerated(self, response: Response, place: Place) -> tuple[Array, Array]:
        return response.moment.acceleration(place, response.vdot)


def sensed_of_joint(joint: Joint, base: Place, follower: Place, ports: Ports) -> list[Quantity]:
    """List what a 6-DOF Joint puts out that constrains and drives nothing."""
    block, seen = joint.block, Relative(base, follower, "Base")
    found: list[Quantity] = []
    for primitive in joint.primitives:
        prefix = prefix_of(block, primitive)
        if primitive.kind == "slide":
            found += _of_slide(block, prefix, primitive.axis, seen, ports)
        else:
            found += _of_ball(block, prefix, seen, ports)
    return found


def _of_slide(
    block: Block, prefix: str, axis: int, seen: Relative, ports: Ports
) -> Iterator[Quantity]:
    if is_on(block, f"{prefix}SensePosition"):
        yield Quantity(port=ports.next(), of_state=_component(seen.position, axis))
    if is_on(block, f"{prefix}SenseVelocity"):
        yield Quantity(port=ports.next(), of_state=_component(seen.velocity, axis))
    if is_on(block, f"{prefix}SenseAcceleration"):
        yield Quantity(port=ports.next(), of_response=_component(seen.acceleration, axis))
    if any(is_on(block, prefix + name) for name in ACTUATOR):
        yield Quantity(port=ports.next(), of_state=lambda _: 0.0)
    for side in ("Lower", "Upper"):
        if is_on(block, f"{prefix}Sense{side}LimitTorqueForce"):
            yield Quantity(port=ports.next(), of_state=lambda _: 0.0)


def _of_ball(block: Block, prefix: str, seen: Relative, ports: Ports) -> Iterator[Quantity]:
    in_follower = block.parameters.get(f"{prefix}SensingFrame") == "FollowerFrame"

    def resolved(moment: Moment, vector: Array) -> Array:
        return seen.rotation(moment).T @ vector if in_follower else vector

    def velocity(moment: Moment) -> Array:
        return resolved(moment, seen.angular_velocity(moment))

    def acceleration(response: Response) -> Array:
        return resolved(response.moment, seen.angular_acceleration(response))

    if is_on(block, f"{prefix}SensePosition"):
        yield Quantity(
            port=ports.next(), shape=(4,), of_state=lambda m: quaternion(seen.rotation(m))
        )
    for place, component in enumerate(COMPONENTS):
        if is_on(block, f"{prefix}SenseVelocity{component}"):
            yield Quantity(port=ports.next(), of_state=_component(velocity, place))
    if is_on(block, f"{prefix}SenseVelocity"):
        yield Quantity(port=ports.next(), shape=(3,), of_state=velocity)
    for place, component in enumerate(COMPONENTS):
        if is_on(block, f"{prefix}SenseAcceleration{component}"):
            yield Quantity(port=ports.next(), of_response=_component(acceleration, place))
    if is_on(block, f"{prefix}SenseAcceleration"):
        yield Quantity(port=ports.next(), shape=(3,), of_response=acceleration)


# --- Transform Sensor ------------------------------------------------------------------------


def sensed_of_transform(block: Block, base: Place, follower: Place, ports: Ports) -> list[Quantity]:
    """List what a Transform Sensor puts out.

    Raises
    ------
    InvalidValueError
        If it measures in a frame, or puts out a quantity, that is not known.
    """
    frame = str(block.parameters.get("MeasurementFrame", "World"))
    if frame not in MEASURED_IN:
        raise InvalidValueError(
            f"the block {block.name!r} (SID {block.sid}) has MeasurementFrame {frame!r}; it must "
            f"be one of {', '.join(MEASURED_IN)}"
        )
    for name in UNKNOWN:
        if is_on(block, name):
            raise InvalidValueError(
                f"the block {block.name!r} (SID {block.sid}) has {name} on, which is not "
                "supported: switch it off, and compute it from what it senses otherwise"
            )
    seen = Relative(base, follower, frame)
    return [
        *_rotation(block, seen, ports),
        *_turning(block, seen, ports),
        *_translation(block, seen, ports),
    ]


UNKNOWN = (
    "SenseAngle1", "SenseAngle2", "SenseAngle3", "SenseOmega1", "SenseOmega2", "SenseOmega3",
    "SenseAlpha1", "SenseAlpha2", "SenseAlpha3", "SenseRotationSequenceDDot", "SenseQDDot",
    "SenseRDDot", "SenseRadDDot", "SenseAzimDDot", "SenseDistDDot", "SenseIncDDot",
)  # fmt: skip


def _rotation(block: Block, seen: Relative, ports: Ports) -> Iterator[Quantity]:
    def angle(moment: Moment) -> float:
        return float(np.linalg.norm(rotvec(seen.rotation(moment))))

    def axis(moment: Moment) -> Array:
        turn = rotvec(seen.rotation(moment))
        length = float(np.linalg.norm(turn))
        return turn / length if length else np.array([0.0, 0.0, 1.0])

    def angles(moment: Moment) -> Array:
        found: Array = Rotation.from_matrix(seen.rotation(moment)).as_euler(_sequence(block))
        return found

    if is_on(block, "SenseAngle"):
        yield Quantity(port=ports.next(), of_state=angle)
    if is_on(block, "SenseAxis"):
        yield Quantity(port=ports.next(), shape=(3,), of_state=axis)
    if is_on(block, "SenseQ"):
        yield Quantity(
            port=ports.next(), shape=(4,), of_state=lambda m: quaternion(seen.rotation(m))
        )
    if is_on(block, "SenseR"):
        yield Quantity(port=ports.next(), shape=(3, 3), of_state=seen.rotation)
    if is_on(block, "SenseRotationSequence"):
        yield Quantity(port=ports.next(), shape=(3,), of_state=angles)


def _sequence(block: Block) -> str:
    return str(block.parameters.get("RotationSequence", "XYX"))


def _turning(block: Block, seen: Relative, ports: Ports) -> Iterator[Quantity]:
    def angle_rates(moment: Moment) -> Array:
        return _rates_of_angles(_sequence(block), seen.rotation(moment), seen.turning(moment))

    def quaternion_rate(moment: Moment) -> Array:
        w, x, y, z = quaternion(seen.rotation(moment)).tolist()
        rates = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]])
        found: Array = 0.5 * rates @ seen.turning(moment)
        return found

    def matrix_rate(moment: Moment) -> Array:
        x, y, z = seen.turning(moment).tolist()
        found: Array = seen.rotation(moment) @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return found

    yield from _vector(block, "SenseOmega", ports, of_state=seen.angular_velocity)
    if is_on(block, "SenseQDot"):
        yield Quantity(port=ports.next(), shape=(4,), of_state=quaternion_rate)
    if is_on(block, "SenseRDot"):
        yield Quantity(port=ports.next(), shape=(3, 3), of_state=matrix_rate)
    if is_on(block, "SenseRotationSequenceDot"):
        yield Quantity(port=ports.next(), shape=(3,), of_state=angle_rates)
    yield from _vector(block, "SenseAlpha", ports, of_response=seen.angular_acceleration)


def _rates_of_angles(sequence: str, R_BF: Array, w_BF_F: Array) -> Array:
    """Return the rates of body-fixed angles [rad/s]; the smallest ones in a gimbal lock."""
    angles = Rotation.from_matrix(R_BF).as_euler(sequence)
    axes = np.eye(3)[["XYZ".index(letter) for letter in sequence]]
    last = Rotation.from_euler(sequence[2], angles[2])
    later = Rotation.from_euler(sequence[1:], angles[1:])
    turned = [later.inv().apply(axes[0]), last.inv().apply(axes[1]), axes[2]]
    found: Array = np.linalg.lstsq(np.column_stack(turned), w_BF_F, rcond=1e-12)[0]
    return found


def _vector(
    block: Block,
    name: str,
    ports: Ports,
    of_state: Callable[[Moment], Array] | None = None,
    of_response: Callable[[Response], Array] | None = None,
) -> Iterator[Quantity]:
    for place, component in enumerate(COMPONENTS):
        if is_on(block, name + component):
            yield Quantity(
                port=ports.next(),
                of_state=of_state and _component(of_state, place),
                of_response=of_response and _component(of_response, place),
            )
    if is_on(block, name):
        yield Quantity(port=ports.next(), shape=(3,), of_state=of_state, of_response=of_response)


def _translation(block: Block, seen: Relative, ports: Ports) -> Iterator[Quantity]:
    for end, old in (("", ""), ("Dot", "V"), ("DDot", "A")):
        state = {"": seen.position, "Dot": seen.velocity}.get(end)
        response = seen.acceleration if end == "DDot" else None
        for place, component in enumerate(COMPONENTS):
            if is_on(block, f"Sense{component}{end}") or is_on(block, f"Sense{old}{component}"):
                yield Quantity(
                    port=ports.next(),
                    of_state=state and _component(state, place),
                    of_response=response and _component(response, place),
                )
        if is_on(block, f"SenseXYZ{end}") or is_on(block, f"Sense{old}XYZ"):
            yield Quantity(port=ports.next(), shape=(3,), of_state=state, of_response=response)
        if end == "DDot":
            return
        for names, law in _CURVED:
            if any(is_on(block, f"Sense{name}{end}") for name in names):
                yield Quantity(port=ports.next(), of_state=partial(_curved, seen, law, end))


def _curved(
    seen: Relative, law: Callable[[Array, Array], tuple[float, float]], end: str, moment: Moment
) -> float:
    p = seen.position(moment)
    v = seen.velocity(moment) if end else np.zeros(3)
    return law(p, v)[bool(end)]


def _radius(p: Array, v: Array) -> tuple[float, float]:
    x, y, _ = p.tolist()
    radius = math.hypot(x, y)
    return radius, (x * v[0] + y * v[1]) / radius if radius else math.hypot(v[0], v[1])


def _azimuth(p: Array, v: Array) -> tuple[float, float]:
    x, y, _ = p.tolist()
    square = x * x + y * y
    return math.atan2(y, x), float(x * v[1] - y * v[0]) / square if square else 0.0


def _distance(p: Array, v: Array) -> tuple[float, float]:
    distance = float(np.linalg.norm(p))
    return distance, float(p @ v) / distance if distance else float(np.linalg.norm(v))


def _inclination(p: Array, v: Array) -> tuple[float, float]:
    radius, rate = _radius(p, v)
    square = radius * radius + float(p[2]) ** 2
    slope = float(radius * v[2] - p[2] * rate) / square if square else 0.0
    return math.atan2(float(p[2]), radius), slope


_CURVED = (
    (("Rad", "Radius"), _radius),
    (("Azim", "Azimuth"), _azimuth),
    (("Dist",), _distance),
    (("Inc", "Inclination"), _inclination),
)


def _component(of: Callable[..., Array], place: int) -> Callable[..., float]:
    return lambda at: float(of(at)[place])
