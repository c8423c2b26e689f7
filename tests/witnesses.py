"""Closed forms that only tests need: they are witnesses of what the package computes otherwise."""

import numpy as np

from drake_leg.kinematics.khalil import (
    assemble,
    base_transforms,
    finite_vectors,
    jacobian,
    moving_rows,
    split,
)


def jacobian_rate_bias(rows, q, qdot):
    """Foot acceleration that is there without joint acceleration: ``dJv_BF/dt @ qdot``.

    An axis turns with the body before it, ``dz/dt = w x z``, and an origin moves with it. Angular,
    then translational, (..., 6), in the base frame.
    """
    moving = moving_rows(rows)
    rates = finite_vectors("qdot", qdot, len(moving))[..., np.newaxis]
    X_B = base_transforms(rows, q)
    J = jacobian(rows, q)
    p_BF = X_B[..., -1, :3, 3]
    v_BF = (J[..., 3:, :] @ rates)[..., 0]
    w = np.zeros_like(p_BF)
    v_o, o_before = np.zeros_like(p_BF), np.zeros_like(p_BF)
    bias = np.zeros((*p_BF.shape[:-1], 6))
    for column, index in enumerate(moving):
        z, o = X_B[..., index, :3, 2], X_B[..., index, :3, 3]
        rate = rates[..., column, :]
        v_o = v_o + np.cross(w, o - o_before)
        z_dot = np.cross(w, z)
        if rows[index].joint == "revolute":
            bias[..., :3] += z_dot * rate
            turning = np.cross(z_dot, p_BF - o) + np.cross(z, v_BF - v_o)
            bias[..., 3:] += turning * rate
            w = w + z * rate
        else:
            v_o = v_o + z * rate
            bias[..., 3:] += z_dot * rate
        o_before = o
    return bias


def tool_rotation(q):
    """Rotation of the SCARA's tool: ``R_BF = Rz(q1 + q2 + q3) Rx(pi)``, (..., 3, 3)."""
    (q1, q2, q3, _), cos, sin = split("q", q, 4)
    c, s = cos(q1 + q2 + q3), sin(q1 + q2 + q3)
    return assemble(((c, s, 0.0), (s, -c, 0.0), (0.0, 0.0, -1.0)))


def rest_depth(stop, load):
    """Depth at which a joint's stop carries a load at rest: ``engagement * k depth = load``.

    Beyond the transition region it is ``load / k``; within, the root of a quartic. A load away from
    the stop leaves the joint at the bound.
    """
    w, k = stop.transition_width, stop.stiffness
    if load <= 0.0:
        return 0.0
    if load >= k * w:
        return load / k
    roots = np.roots([-2.0, 3.0, 0.0, 0.0, -load / (k * w)])
    real = roots[np.abs(roots.imag) < 1e-9].real
    return float(w * real[(real >= 0.0) & (real <= 1.0)].min())


def foot_rotation(leg, q):
    """Rotation R_BF of the foot frame in the base frame, (..., 3, 3).

    ``R_BF = Rz(q1) Rx(s pi/2) Rz(q2 + q3)`` (report A, eq. 8; report B, 2.4).
    """
    (q1, q2, q3), cos, sin = split("q", q, 3)
    c1, s1, c23, s23 = cos(q1), sin(q1), cos(q2 + q3), sin(q2 + q3)
    s = leg.sign
    return assemble(
        (
            (c1 * c23, -c1 * s23, s * s1),
            (s1 * c23, -s1 * s23, -s * c1),
            (s * s23, s * c23, 0.0),
        )
    )
