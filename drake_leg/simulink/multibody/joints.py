"""Joints of Simscape as chains of primitives: what turns and slides, with springs and targets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.arguments import with_article
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import PRIMITIVES
from drake_leg.simulink.mechanism import pose, rotation_of
from drake_leg.simulink.model import Block, invalid_parameter, is_on, number, vector
from drake_leg.simulink.multibody.mass import Array

Kind = Literal["turn", "slide", "ball", "screw"]

SINGLE = {"Revolute Joint": "Rz", "Prismatic Joint": "Pz", "Spherical Joint": "Sph"}
_KINDS: dict[str, Kind] = {"R": "turn", "P": "slide", "S": "ball"}
_TARGET, _RATE = "PositionTarget", "VelocityTarget"


@dataclass(frozen=True, kw_only=True)
class Primitive:
    """One degree of freedom along or about an axis, or a ball of three."""

    name: str  # "Px", "Rz", "Sph"
    kind: Kind
    axis: int  # 0, 1, 2; of a ball -1
    lead: float = 0.0  # of a screw [m/rad]; its position is an angle
    stiffness: float = 0.0  # [N*m/rad or N/m]
    rest: float = 0.0  # [rad or m], where the spring is at rest
    damping: float = 0.0  # [N*m*s/rad or N*s/m]
    lower: float | None = None  # [rad or m]
    upper: float | None = None  # [rad or m]
    target: tuple[float, ...] | None = (
        None  # position [rad or m]; of a ball a quaternion w, x, y, z
    )
    firm: bool = True  # whether the target has high priority
    rate: tuple[float, ...] | None = None  # target of the velocity [rad/s or m/s]
    rate_firm: bool = True  # whether that target has high priority
    driven: bool = False  # whether a force, a torque or a motion is an input

    @property
    def positions(self) -> int:
        """Return how many positions it has: a ball's are a rotation vector [rad]."""
        return 3 if self.kind == "ball" else 1

    def pose(self, q: Array) -> Array:
        """Compute X_BF(q), (4, 4), of its follower in its base."""
        if self.kind == "ball":
            return pose(Rotation.from_rotvec(q).as_matrix())
        moved = np.zeros(3)
        moved[self.axis] = float(q[0])
        if self.kind == "slide":
            return pose(None, moved)
        return pose(_turned(moved), self.lead * moved)

    @property
    def start(self) -> Array:
        """Return the position at its target, or zero."""
        if self.target is None:
            return np.zeros(self.positions)
        if self.kind == "ball":
            vector: Array = Rotation.from_quat(np.roll(self.target, -1)).as_rotvec()
            return vector
        return np.array(self.target)


def _turned(rotation: Array) -> Array:
    turned: Array = Rotation.from_rotvec(rotation).as_matrix()
    return turned


def primitives_of(block: Block) -> tuple[Primitive, ...]:
    """Read a joint as its primitives, from base to follower; a weld has none.

    Raises
    ------
    InvalidValueError
        If the joint is of a kind without them, or a value is not known.
    """
    if block.parameters.get("JointMode") == "Disengaged":
        raise invalid_parameter(block, "JointMode", "it must be Normal")
    if block.kind == "Weld Joint":
        return ()
    if block.kind == "Lead Screw Joint":
        return (_screw(block),)
    names = SINGLE.get(block.kind) or PRIMITIVES.get(block.kind)
    if names is None:
        raise InvalidValueError(
            f"the block {block.name!r} (SID {block.sid}) is {with_article(block.kind)}, which is "
            "not built: replace it by joints and constraints that are"
        )
    return tuple(_primitive(block, name) for name in names.split())


def _primitive(block: Block, name: str) -> Primitive:
    prefix = "" if block.kind in SINGLE else name
    kind = _KINDS[name[0]]
    if kind == "ball":
        return _ball(block, name, prefix)
    get = _getter(block, prefix)
    bounds = [
        get(f"{side}LimitBound") if is_on(block, f"{prefix}{side}LimitSpecify") else None
        for side in ("Lower", "Upper")
    ]
    targeted = is_on(block, f"{prefix}{_TARGET}Specify")
    return Primitive(
        name=name,
        kind=kind,
        axis="xyz".index(name[1]),
        stiffness=get("SpringStiffness"),
        rest=get("EquilibriumPosition"),
        damping=get("DampingCoefficient"),
        lower=bounds[0],
        upper=bounds[1],
        target=(get(f"{_TARGET}Value"),) if targeted else None,
        firm=_is_firm(block, prefix + _TARGET),
        rate=(get(f"{_RATE}Value"),) if is_on(block, f"{prefix}{_RATE}Specify") else None,
        rate_firm=_is_firm(block, prefix + _RATE),
        driven=_is_driven(block, prefix),
    )


def _ball(block: Block, name: str, prefix: str) -> Primitive:
    get = _getter(block, prefix)
    target = None
    if is_on(block, f"{prefix}{_TARGET}Specify"):
        R = rotation_of(block, f"{prefix}{_TARGET}")
        target = tuple(np.roll(Rotation.from_matrix(R).as_quat(), 1).tolist())
    return Primitive(
        name=name,
        kind="ball",
        axis=-1,
        stiffness=get("SpringStiffness"),
        damping=get("DampingCoefficient"),
        target=target,
        firm=_is_firm(block, prefix + _TARGET),
        rate=_turning(block, prefix) if is_on(block, f"{prefix}{_RATE}Specify") else None,
        rate_firm=_is_firm(block, prefix + _RATE),
        driven=_is_driven(block, prefix),
    )


def _screw(block: Block) -> Primitive:
    """Read a Lead Screw, whose follower moves along z as it turns about it."""
    get = _getter(block, "")
    lead = get("Lead") * (-1.0 if block.parameters.get("Direction") == "LeftHand" else 1.0)
    if not lead:
        raise invalid_parameter(block, "Lead", "it must not be zero")

    def target(name: str) -> tuple[float] | None:
        if not is_on(block, f"{name}Specify"):
            return None
        if is_on(block, f"{name}RotationBased"):
            return (get(f"{name}RotationValue"),)
        return (get(f"{name}TranslationValue") / lead,)

    return Primitive(
        name="Lsz",
        kind="screw",
        axis=2,
        lead=lead,
        target=target(_TARGET),
        firm=_is_firm(block, _TARGET),
        rate=target(_RATE),
        rate_firm=_is_firm(block, _RATE),
    )


def _getter(block: Block, prefix: str) -> Callable[[str], float]:
    def get(name: str) -> float:
        value = block.parameters.get(prefix + name, 0.0)
        if not isinstance(value, int | float):
            raise invalid_parameter(block, prefix + name, "it must be one number")
        return number(value)

    return get


def _turning(block: Block, prefix: str) -> tuple[float, ...]:
    """Read the target of an angular velocity, in the base."""
    name = f"{prefix}{_RATE}Value"
    found = vector(block.parameters.get(name))
    if len(found) != 3:
        raise invalid_parameter(block, name, "it must be 3 numbers")
    turned = is_on(block, f"{prefix}{_TARGET}Specify")
    if turned and is_on(block, f"{prefix}{_RATE}InFollowerFrame"):
        found = tuple((rotation_of(block, f"{prefix}{_TARGET}") @ np.array(found)).tolist())
    return found


def _is_firm(block: Block, target: str) -> bool:
    return block.parameters.get(f"{target}Priority", "High") == "High"


def _is_driven(block: Block, prefix: str) -> bool:
    return (
        block.parameters.get(f"{prefix}TorqueActuationMode") == "InputTorque"
        or block.parameters.get(f"{prefix}MotionActuationMode") == "InputMotion"
    )
