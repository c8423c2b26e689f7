"""The loads of a planned walk: forces of the ground on the feet, and torques of the servos.

What the links' motion and weight ask for as a whole is spread over the standing feet, which may
press outwards, too, as far as the ground's friction holds them: that spares the knees. Then every
joint carries what is beyond it in the tree, less the forces of the ground there.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, finite_vectors, real_numbers
from drake_leg.kinematics.walking.gaits import Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.kinematics.walking.power import gear_friction
from drake_leg.kinematics.walking.sequence import WalkSequence
from drake_leg.kinematics.walking.weights import wrenches_of_links
from drake_leg.robot.ground import Ground
from drake_leg.robot.robot import Robot, require_robot
from drake_leg.robot.servos import Servo
from drake_leg.units import STANDARD_GRAVITY, require_non_negative

FADING = (
    0.05  # [s], in which a foot takes its load after a touch-down, and yields it before lift-off
)
FEEBLE = 1e-9  # of a foot's weight, that of one that has just touched down: all may do so at once
OUTWARDS = (
    0.125  # of the friction that a slope leaves; with a quarter, feet of a wave slip as they land
)
MOST_FRICTION = 1.0  # that counts: much more would load the ankles more than it spares the knees
FLAT = (
    1e-12  # of the feet's extent cubed: below it they are on a line, and carry no moment about it
)


class Loads(NamedTuple):
    """What a planned walk loads feet and servos with."""

    forces: Array  # (..., n, 3) [N], of the ground on the feet, in G
    torques: Array  # (..., 3 n) [N*m], at the actuators, in the order of the joints


def outwards_on(ground: Ground) -> float:
    """How much of its load a foot may press outwards from its hip on a ground [-]."""
    up = ground.X_WG[2][2]
    slope = math.sqrt(max(0.0, 1.0 - up * up)) / up
    return OUTWARDS * max(0.0, min(ground.friction, MOST_FRICTION) - slope)


def planned_torques(
    robot: Robot,
    walk: Walk | WalkSequence,
    times: ArrayLike,
    servo: Servo,
    *,
    gravity: float | ArrayLike = STANDARD_GRAVITY,
    inertia: bool = True,
    outwards: float = 0.0,
) -> Array:
    """Torques that make a robot follow a walk, (rows, 3 n) [N*m]: a feed-forward for its servos.

    Parameters
    ----------
    times : (rows,) array_like
        [s].
    gravity : float or (3,) array_like
        Its strength, along -z of the ground frame G, or on a slope its vector in G [m/s^2].
    inertia : bool
        Whether body, links and rotors are accelerated; otherwise weights, and what depends on
        speed, count alone.
    outwards : float
        How much of its vertical load each standing foot presses outwards from its hip, as
        ``outwards_on(ground)``.

    Raises
    ------
    InvalidValueError
        If a foot is out of reach; it says which, and when.
    """
    plan = _plan(robot, walk, times, gravity, outwards)
    torques = planned_loads(plan, servo, inertia=inertia).torques
    _require_reach(plan)
    return torques


def planned_forces(
    robot: Robot,
    walk: Walk | WalkSequence,
    times: ArrayLike,
    *,
    gravity: float | ArrayLike = STANDARD_GRAVITY,
    inertia: bool = True,
    outwards: float = 0.0,
) -> Array:
    """Forces of the ground on the feet, (rows, n, 3) [N], in G; as ``planned_torques``."""
    plan = _plan(robot, walk, times, gravity, outwards)
    forces, *_ = _loads_of_links(plan, inertia=inertia)
    _require_reach(plan)
    return forces


def planned_loads(plan: PlannedWalk, servo: Servo, *, inertia: bool = True) -> Loads:
    """Loads of feet and servos; NaN where a foot is out of reach.

    The torques overcome the friction of gears that turn; at rest it may hold a joint either way.
    """
    require_kind("the servo", servo, Servo)
    forces, moment, force = _loads_of_links(plan, inertia=inertia)
    robot = plan.robot
    rows = [index for index, row in enumerate(robot.rows, start=1) if row.joint != "fixed"]
    beyond = _beyond(robot)[rows]
    axis, place = (plan.links.value[..., :3, column][..., rows, :] for column in (2, 3))
    M, F = beyond @ moment, beyond @ force
    torques = (axis * (M - np.cross(place, F))).sum(axis=-1)
    q, qdot, qddot = (part.reshape(torques.shape) for part in plan.joints)
    mechanics = [segment.mechanics for segment in robot.moving]
    damping, stiffness, rest = np.array(
        [(one.damping, one.spring_stiffness, one.equilibrium_position) for one in mechanics]
    ).T
    torques += (damping + servo.back_emf_damping) * qdot + stiffness * (q - rest)
    torques -= gear_friction(servo, qdot)
    if inertia:
        torques += servo.rotor_inertia * qddot
    return Loads(forces, torques)


def spread(feet: ArrayLike, weights: ArrayLike, moment: ArrayLike, force: ArrayLike) -> Array:
    """Forces at feet, (..., n, 3) [N], that make up a wrench, the least by weighted squares.

    ``sum f = force`` and ``sum p x f = moment`` with the least ``sum |f|^2 / w``, as if a rigid
    plate stood on springs of stiffness w: a foot may pull, too. Feet are p (..., n, 3) [m], weights
    w (..., n); the moment (..., 3) [N*m] is about the origin. Feet on a line carry no moment about
    that line; without any weight, all forces are 0.
    """
    p, w, M, F = (np.asarray(one, dtype=np.float64) for one in (feet, weights, moment, force))
    total = w.sum(axis=-1, keepdims=True)
    share = (w / np.where(total > 0.0, total, 1.0))[..., np.newaxis]
    centre = (share * p).sum(axis=-2)
    arm = p - centre[..., np.newaxis, :]
    # The plate turns by theta, which presses every foot by w theta x arm.
    tensor = -np.einsum("...ni,...nj->...ij", share * arm, arm)
    square = -np.trace(tensor, axis1=-2, axis2=-1)
    tensor += square[..., np.newaxis, np.newaxis] * np.eye(3)
    theta = _solved(tensor, M - np.cross(centre, F), square)
    found: Array = share * (F[..., np.newaxis, :] + np.cross(theta[..., np.newaxis, :], arm))
    return found


def _solved(tensor: Array, moment: Array, square: Array) -> Array:
    """Solve ``tensor theta = moment``, (..., 3); where it is singular, as well as it can be."""
    with np.errstate(invalid="ignore"):  # what is NaN stays NaN
        regular = np.linalg.det(tensor) > FLAT * square**3
        safe = np.where(regular[..., np.newaxis, np.newaxis], tensor, np.eye(3))
        theta = np.asarray(np.linalg.solve(safe, moment[..., np.newaxis])[..., 0], dtype=np.float64)
    flat = ~regular & np.isfinite(square)
    inverses = np.linalg.pinv(tensor[flat], rcond=1e-6, hermitian=True)
    theta[flat] = (inverses @ moment[flat][..., np.newaxis])[..., 0]
    return theta


def _loads_of_links(plan: PlannedWalk, *, inertia: bool) -> tuple[Array, Array, Array]:
    """Forces on the feet, and what base and rows are to be given beside them.

    The latter are moments about G's origin and forces, (..., m + 1, 3) [N*m, N], in G.
    """
    moment, force = wrenches_of_links(
        plan.robot, plan.links, np.array(plan.gravity), inertia=inertia
    )
    tips = list(plan.robot.tips.values())
    feet = plan.links.value[..., :3, 3][..., tips, :]
    weights = np.maximum(plan.walk.firmness(plan.times, FADING), FEEBLE * plan.down)
    M, F = moment.sum(axis=-2), force.sum(axis=-2)
    forces = spread(feet, weights, M, F)
    if plan.outwards:
        inwards = _held_inwards(plan, feet, forces)
        rest = M - np.cross(feet, inwards).sum(axis=-2), F - inwards.sum(axis=-2)
        forces = inwards + spread(feet, weights, *rest)
    moment[..., tips, :] -= np.cross(feet, forces)
    force[..., tips, :] -= forces
    return forces, moment, force


def _held_inwards(plan: PlannedWalk, feet: Array, forces: Array) -> Array:
    """Forces along the ground, (..., n, 3) [N], on feet that press outwards from their hips."""
    X_GB = plan.body.value[..., np.newaxis, :, :]
    hips = np.einsum("...ij,...j->...i", X_GB[..., :3, :3], plan.legs.hips) + X_GB[..., :3, 3]
    out = (feet - hips) * (1.0, 1.0, 0.0)
    far = np.linalg.norm(out, axis=-1, keepdims=True)
    out /= np.where(far > 0.0, far, 1.0)
    pressed = np.maximum(forces[..., 2:], 0.0)
    return np.asarray(-plan.outwards * pressed * out)


@lru_cache(maxsize=8)
def _beyond(robot: Robot) -> NDArray[np.float64]:
    """Which rows (columns) each row carries, itself included; row and column 0 are the base's."""
    count = len(robot.rows) + 1
    found = np.zeros((count, count))
    for row in range(count):
        found[[0, *robot.path(row)], row] = 1.0
    return found


@lru_cache(maxsize=8)
def _legs(robot: Robot) -> Legs:
    return Legs.of(robot)


def _plan(
    robot: Robot,
    walk: Walk | WalkSequence,
    times: ArrayLike,
    gravity: float | ArrayLike,
    outwards: float,
) -> PlannedWalk:
    require_robot(robot)
    require_kind("the walk", walk, Walk, WalkSequence)
    require_non_negative("what feet press outwards", outwards, "of their load")
    vector = real_numbers("gravity", gravity)
    if vector.ndim == 0:
        vector = np.array([0.0, 0.0, -float(vector)])
    x, y, z = finite_vectors("gravity", vector, 3).tolist()
    return PlannedWalk(
        robot=robot,
        legs=_legs(robot),
        walk=walk,
        times=real_numbers("the times", times),
        gravity=(x, y, z),
        outwards=outwards,
    )


def _require_reach(plan: PlannedWalk) -> None:
    out = np.argwhere(~np.isfinite(plan.joints.value).all(axis=-1))
    if len(out):
        *row, leg = out[0]
        raise InvalidValueError(
            f"at {plan.times[tuple(row)]:.4g} s the foot {plan.legs.names[leg]} is out of reach; "
            "plan a walk with shorter steps, or less lift"
        )
