"""Where the positions and rates of a model's joints are in the state of its plant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.simulink.multibody.bodies import Joint, Mechanism
from drake_leg.simulink.multibody.joints import Primitive
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.sdf import floats, joint_names, link_names


@dataclass(frozen=True, eq=False, kw_only=True)
class Axis:
    """A primitive of a joint that turns or slides: position ``A q + b``, rate ``S v``.

    A force along it is the generalized force ``S^T f``.
    """

    joint: Joint
    primitive: Primitive
    A: Array  # (nq,)
    b: float  # [m]
    S: Array  # (nv,)


@dataclass(frozen=True, eq=False, kw_only=True)
class Ball:
    """A primitive of a joint that turns about all axes, from its base B to its follower F.

    Drake's rates of it are the angular velocity of one frame in another one. A turn of a floating
    body is that in the world W; that of a chain is that of its outer frame in its inner one.
    """

    joint: Joint
    primitive: Primitive
    q: int  # first of three angles, roll, pitch, yaw, or of a quaternion
    v: int  # first of three
    R_WB: Array | None  # of a floating body

    def rotation(self, q: Array) -> Array:
        """Return R_BF."""
        if self.R_WB is not None:
            R: Array = self.R_WB.T @ _of_quaternion(q[self.q : self.q + 4])
            return R
        R = _of_angles(q[self.q : self.q + 3])
        return R.T if self.joint.reversed else R

    def in_base(self, R_BF: Array, rates: Array) -> Array:
        """Return the angular velocity w_BF_B of Drake's rates, or an acceleration of theirs."""
        own = rates[self.v : self.v + 3]
        w: Array
        if self.R_WB is not None:
            w = self.R_WB.T @ own
        else:
            w = -(R_BF @ own) if self.joint.reversed else own
        return w

    def force(self, R_BF: Array, torque: Array) -> Array:
        """Return the generalized forces (3,) of a torque on the follower, in the base."""
        f: Array
        if self.R_WB is not None:
            f = self.R_WB @ torque
        else:
            f = -(R_BF.T @ torque) if self.joint.reversed else torque
        return f


def _of_quaternion(quaternion: Array) -> Array:
    w, x, y, z = (quaternion / np.linalg.norm(quaternion)).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _of_angles(angles: Array) -> Array:
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles).tolist(), np.sin(angles).tolist()
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


Coordinate = Axis | Ball


def coordinates_of(mechanism: Mechanism, plant: MultibodyPlant) -> tuple[Coordinate, ...]:
    """List the coordinates of a mechanism without loops, joint by joint, from base to follower."""
    found: list[Coordinate] = []
    for joint in mechanism.joints:
        if floats(mechanism, joint):
            found += _floating(mechanism, joint, plant)
            continue
        names = joint_names(joint)
        if joint.reversed:
            names.reverse()
        for name, primitive in zip(names, joint.primitives, strict=True):
            simple = plant.GetJointByName(name)
            q, v = simple.position_start(), simple.velocity_start()
            if primitive.kind == "ball":
                found.append(Ball(joint=joint, primitive=primitive, q=q, v=v, R_WB=None))
            else:
                found.append(_axis(joint, primitive, plant, q, v))
    return tuple(found)


def _axis(joint: Joint, primitive: Primitive, plant: MultibodyPlant, q: int, v: int) -> Axis:
    A, S = np.zeros(plant.num_positions()), np.zeros(plant.num_velocities())
    A[q] = S[v] = 1.0
    return Axis(joint=joint, primitive=primitive, A=A, b=0.0, S=S)


def _floating(mechanism: Mechanism, joint: Joint, plant: MultibodyPlant) -> list[Coordinate]:
    """List the coordinates of a floating base, whose joint begins on the world.

    The origin of its body is that of the joint's follower.
    """
    body = plant.GetBodyByName(link_names(mechanism)[joint.follower])
    q, v = body.floating_positions_start(), body.floating_velocities_start_in_v()
    R_WB, p_WB = joint.X_PB[:3, :3], joint.X_PB[:3, 3]
    found: list[Coordinate] = []
    for primitive in joint.primitives:
        if primitive.kind == "ball":
            found.append(Ball(joint=joint, primitive=primitive, q=q, v=v, R_WB=R_WB))
            continue
        along = R_WB[:, primitive.axis]
        A, S = np.zeros(plant.num_positions()), np.zeros(plant.num_velocities())
        A[q + 4 : q + 7], S[v + 3 : v + 6] = along, along
        b = -float(along @ p_WB)
        found.append(Axis(joint=joint, primitive=primitive, A=A, b=b, S=S))
    return found
