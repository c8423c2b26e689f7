"""Forces of the Contact Forces Library between spheres and planes, where its file is absent.

They follow that library, not Simscape's Spatial Contact Force: the damper acts only while two
bodies approach each other, friction is linear in the slip up to a threshold, and both forces act
at the origins of the two frames, with torques. A force on a plane that is not fixed acts where the
sphere's center is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.simulink.dynamics.joints import smooth
from drake_leg.simulink.dynamics.moment import Moment, Place, cross
from drake_leg.simulink.dynamics.relative import Relative
from drake_leg.simulink.dynamics.sensing import Quantity
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.model import Block, invalid_parameter, number
from drake_leg.simulink.multibody.mass import Array

LAWS = ("Linear", "Nonlinear")
FRICTION = ("None", "Stick-Slip Continuous")


@dataclass(frozen=True, kw_only=True)
class SphereLaw:
    """The forces of the library by penetration and slip."""

    stiffness: float  # [N/m], or by the power of the penetration
    damping: float  # [N*s/m]
    exponent: float  # of the penetration
    full_damping: float  # penetration from which on the damper acts fully [m]; 0 means any
    static: float  # coefficients of friction
    kinetic: float
    threshold: float  # of the slip [m/s]

    def spring(self, depth: float) -> float:
        """Return the force of the spring [N] at a penetration [m]."""
        return self.stiffness * math.pow(depth, self.exponent)

    def damper(self, depth: float, rate: float) -> float:
        """Return the force of the damper [N] at a penetration [m] that grows [m/s]."""
        share = float(depth > 0.0)
        if self.full_damping:
            share = smooth(min(depth / self.full_damping, 1.0))
        return share * self.damping * max(rate, 0.0)

    def friction(self, slip: float) -> float:
        """Return the coefficient of friction at a slip [m/s]."""
        if self.static == self.kinetic == 0.0:
            return 0.0
        knots = np.array([0.0, 1.0, 1.5]) * self.threshold
        return float(np.interp(slip, knots, [0.0, self.static, self.kinetic]))


@dataclass(frozen=True, eq=False, kw_only=True)
class Push:
    """What a block does at a moment, all in its base frame B."""

    frame: Mapping[str, float]  # where the follower is, as the block puts it out
    depth: float = 0.0  # [m]
    rate: float = 0.0  # at which it grows [m/s]
    spring: float = 0.0  # [N]
    damper: float = 0.0
    normal: float = 0.0
    friction: float | Array = 0.0
    force: Array | None = None  # (3,) on the follower at its origin; None where none acts
    torque: Array = field(default_factory=lambda: np.zeros(3))  # on the follower
    torque_on_base: Array | None = None  # None where its force acts at the follower's origin


class SphereForce:
    """A force between a sphere on the follower and something on the base."""

    names: ClassVar[tuple[str, ...]]  # of the signals of its bus, in their order

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        self._base, self._follower = base, follower
        self._law = _law(block)
        self._seen = Relative(base, follower, "Base")

    def act(self, moment: Moment, wrenches: Wrenches) -> None:
        """Add the wrenches on both bodies."""
        push = self.push(moment)
        if push.force is None:
            return
        R, p_WB = moment.pose(self._base)
        p_WF = moment.pose(self._follower)[1]
        force = R @ push.force
        wrenches.add(moment, self._follower.body, p_WF, force, R @ push.torque)
        on_base = None if push.torque_on_base is None else R @ push.torque_on_base
        at = p_WF if on_base is None else p_WB
        wrenches.add(moment, self._base.body, at, -force, on_base)

    def push(self, moment: Moment) -> Push:
        """Return what the block does, once a moment."""
        found = moment.memo.get(self)
        if not isinstance(found, Push):
            found = moment.memo[self] = self._push(moment)
        return found

    def _push(self, moment: Moment) -> Push:
        raise NotImplementedError

    def quantity(self, block: Block) -> Quantity:
        """Return the bus that the block puts out, all its numbers in a row."""
        of: Mapping[str, tuple[str, ...]] = {"Frame Sep": self.frame_names}
        bus = tuple(
            (f"{name}.{part}" if part else name, self._shape(name))
            for name in self.names
            for part in of.get(name, ("",))
        )
        size = sum(math.prod(shape) for _, shape in bus)
        return Quantity(port=f"{block.sid}#out:1", shape=(size,), of_state=self._numbers, bus=bus)

    frame_names: ClassVar[tuple[str, ...]]

    def _shape(self, name: str) -> tuple[int, ...]:
        return ()

    def _numbers(self, moment: Moment) -> Array:
        push = self.push(moment)
        values: Mapping[str, ArrayLike] = {
            "Normal Force": push.normal,
            "Friction Force": push.friction,
            "Penetration": push.depth,
            "Penetration Vel": push.rate,
            "Spr Force": push.spring,
            "Damp Force": push.damper,
            "Frame Sep": tuple(push.frame.values()),
        }
        return np.concatenate([np.ravel(values[name]) for name in self.names])


class SphereToPlane(SphereForce):
    """A sphere on a rectangle around the base's origin, in its plane x, y, thick to both sides."""

    names = (
        "Normal Force", "Friction Force", "Penetration", "Penetration Vel", "Spr Force",
        "Damp Force", "Frame Sep",
    )  # fmt: skip
    frame_names = ("x", "y", "z")

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        super().__init__(block, base, follower)
        self._radius, self._half_thickness, *lengths = (
            number(block.parameters.get(name))
            for name in ("sphere_rad", "plane_depth", "plane_lenx", "plane_leny")
        )
        self._reach = np.array(lengths) / 2.0

    def _shape(self, name: str) -> tuple[int, ...]:
        return (3,) if name == "Friction Force" else ()

    def _push(self, moment: Moment) -> Push:
        p = self._seen.position(moment)
        frame = dict(zip(self.frame_names, p.tolist(), strict=True))
        if not (np.abs(p[:2]) < self._reach).all():
            return Push(frame=frame, friction=np.zeros(3))
        side = float(np.sign(p[2]))
        v, w = self._seen.velocity(moment), self._seen.angular_velocity(moment)
        depth = max(self._radius + self._half_thickness - abs(float(p[2])), 0.0)
        rate = -side * float(v[2])
        spring, damper = self._law.spring(depth), self._law.damper(depth, rate)
        arm = np.array([0.0, 0.0, -side * self._radius])
        slip = v + cross(w, arm)
        slip[2] = 0.0
        pulled = _friction(self._law, spring + damper, slip)
        force = pulled.copy()
        force[2] = side * (spring + damper)
        return Push(
            frame=frame,
            depth=depth,
            rate=rate,
            spring=side * spring,
            damper=side * damper,
            normal=side * (spring + damper),
            friction=-pulled,
            force=force if depth else None,
            torque=cross(arm, pulled),
        )


class SphereToSphere(SphereForce):
    """Two spheres beside each other, or one inside the other."""

    names = (
        "Frame Sep", "Penetration", "Penetration Vel", "Damp Force", "Spr Force", "Normal Force",
        "Friction Force",
    )  # fmt: skip
    frame_names = ("dst", "vdst")

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        super().__init__(block, base, follower)
        self._of_base, self._of_follower = (
            number(block.parameters.get(name)) for name in ("sphB_rad", "sphF_rad")
        )
        self._inside = -1.0 if block.kind == "Sphere in Sphere Force" else 1.0

    def _push(self, moment: Moment) -> Push:
        p, v = self._seen.position(moment), self._seen.velocity(moment)
        apart = math.sqrt(float(p @ p))
        d = p / apart if apart else np.zeros(3)
        speed = float(v @ d)
        frame = dict(zip(self.frame_names, (apart, speed), strict=True))
        reach = self._of_base + self._inside * self._of_follower
        depth = max(self._inside * (reach - apart), 0.0)
        rate = -self._inside * speed
        spring, damper = self._law.spring(depth), self._law.damper(depth, rate)
        out = self._inside * d  # on the follower
        arm = -self._of_follower * out
        slip = v + cross(self._seen.angular_velocity(moment), arm)
        slip = slip - (slip @ d) * d
        pulled = _friction(self._law, spring + damper, slip)
        return Push(
            frame=frame,
            depth=depth,
            rate=rate,
            spring=spring,
            damper=damper,
            normal=spring + damper,
            friction=math.sqrt(float(pulled @ pulled)),
            force=(spring + damper) * out + pulled if depth else None,
            torque=cross(arm, pulled),
            torque_on_base=cross(self._of_base * d, -pulled),
        )


SPHERE_FORCES: Mapping[str, type[SphereForce]] = {
    "Sphere to Plane Force": SphereToPlane,
    "Sphere to Sphere Force": SphereToSphere,
    "Sphere in Sphere Force": SphereToSphere,
}


def _friction(law: SphereLaw, normal: float, slip: Array) -> Array:
    """Return the force of friction against a slip [m/s]."""
    speed = math.sqrt(float(slip @ slip))
    if not speed:
        return np.zeros(3)
    pulled: Array = -law.friction(speed) * normal / speed * slip
    return pulled


def _law(block: Block) -> SphereLaw:
    get = block.parameters.get
    for name, known in (("force_law", LAWS), ("friction_law", FRICTION)):
        if get(name) not in known:
            raise invalid_parameter(
                block,
                name,
                f"without the library's file it must be {' or '.join(known)}: put "
                "Contact_Forces_Lib beside the model, or give the folder where it lies",
            )
    value = {
        name: number(get(name))
        for name in (
            "k_contact", "b_contact", "pen_exponent", "pen_full_damp_F", "mu_static",
            "mu_kinetic", "v_thr",
        )
    }  # fmt: skip
    nonlinear = get("force_law") == "Nonlinear"
    slips = get("friction_law") != "None"
    for name in ("v_thr",) * slips + ("pen_full_damp_F",) * nonlinear:
        if not value[name] > 0.0:
            raise invalid_parameter(block, name, "it must be a positive number")
    return SphereLaw(
        stiffness=value["k_contact"],
        damping=value["b_contact"],
        exponent=value["pen_exponent"] if nonlinear else 1.0,
        full_damping=value["pen_full_damp_F"] if nonlinear else 0.0,
        static=value["mu_static"] if slips else 0.0,
        kinetic=value["mu_kinetic"] if slips else 0.0,
        threshold=value["v_thr"],
    )
