"""Feet and Jacobians of a million postures of leg B: closed form, chain, pinocchio in a loop.

Run it by itself: ``python tests/benchmarks/batch_kinematics.py``. Pinocchio comes with the
extra ``bench``; without it the other two are measured.
"""

import time

import numpy as np

from drake_leg.kinematics.khalil import foot_pose, jacobian, row_transform
from drake_leg.kinematics.leg import LegGeometry, foot_and_jacobian
from drake_leg.robot.robots import LEG_B

try:
    import pinocchio
except ModuleNotFoundError:
    pinocchio = None

POSTURES = 1_000_000
REPEATS = 5
LOOPED = 100_000  # postures of the loop, scaled up


def fastest(function):
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def pinocchio_model():
    """Leg B from its Khalil rows, with a frame at the foot."""
    model = pinocchio.Model()
    parent = 0
    for segment in LEG_B.segments:
        X_PC = row_transform(segment.row)
        placement = pinocchio.SE3(X_PC[:3, :3], X_PC[:3, 3])
        if segment.row.joint == "fixed":
            frame = pinocchio.Frame("foot", parent, 0, placement, pinocchio.FrameType.OP_FRAME)
            foot = model.addFrame(frame)
        else:
            joint = pinocchio.JointModelRZ()
            parent = model.addJoint(parent, joint, placement, segment.joint)
    return model, foot


def pinocchio_loop(model, foot, q):
    data = model.createData()
    axes = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
    for row in q:
        J = pinocchio.computeFrameJacobian(model, data, row, foot, axes)
        p = data.oMf[foot].translation
    return p, J[:3]


def main():
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (POSTURES, 3))
    leg = LegGeometry.from_robot(LEG_B)
    closed = fastest(lambda: foot_and_jacobian(leg, q))
    chain = fastest(lambda: (foot_pose(LEG_B.rows, q), jacobian(LEG_B.rows, q)))
    print(f"closed form       {closed:.3f} s")
    print(f"chain             {chain:.3f} s   {chain / closed:.1f} x the closed form")
    if pinocchio is None:
        return
    model, foot = pinocchio_model()
    p_loop, J_loop = pinocchio_loop(model, foot, q[:1])
    p, J = foot_and_jacobian(leg, q[0])
    assert np.abs(p - p_loop).max() < 1e-12
    assert np.abs(J - J_loop).max() < 1e-12
    loop = fastest(lambda: pinocchio_loop(model, foot, q[:LOOPED])) * POSTURES / LOOPED
    print(f"pinocchio, looped {loop:.3f} s   {loop / closed:.1f} x the closed form")


if __name__ == "__main__":
    main()
