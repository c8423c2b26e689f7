"""Joints as chains of primitives; their poses, compared with Drake's joints."""

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    PlanarJoint,
    PrismaticJoint,
    RevoluteJoint,
    SpatialInertia,
    UniversalJoint,
)
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.multibody.bodies import Joint
from drake_leg.simulink.multibody.connections import Jointed
from drake_leg.simulink.multibody.joints import primitives_of

PRIMITIVES = {
    "Revolute": ["Rz"], "Prismatic": ["Pz"], "Spherical": ["Sph"], "Weld": [],
    "Cylindrical": ["Rz", "Pz"], "Universal": ["Rx", "Ry"], "Planar": ["Px", "Py", "Rz"],
    "Rectangular": ["Px", "Py"], "Cartesian": ["Px", "Py", "Pz"], "Gimbal": ["Rx", "Ry", "Rz"],
    "Pin Slot": ["Px", "Rz"], "6-DOF": ["Px", "Py", "Pz", "Sph"], "Telescoping": ["Sph", "Pz"],
    "Bushing": ["Px", "Py", "Pz", "Rx", "Ry", "Rz"], "Bearing": ["Pz", "Rx", "Ry", "Rz"],
}  # fmt: skip


def read(folder, kind, **texts):
    built = MechanismBuilder()
    built.joint(kind, "J", **texts)
    (block,) = [block for block in built.model(folder).blocks if block.name == "J"]
    return block


def joint_of(block):
    connects = Jointed(block=block, primitives=primitives_of(block), base="a", follower="b")
    X = np.eye(4)
    return Joint(name="J", connects=connects, base=0, follower=1, X_PB=X, X_CF=X, reversed=False)


@pytest.mark.parametrize("kind", PRIMITIVES)
def test_every_joint_is_a_chain(tmp_path, kind):
    found = primitives_of(read(tmp_path, kind))
    assert [primitive.name for primitive in found] == PRIMITIVES[kind]


@pytest.mark.parametrize(
    ("kind", "drake", "q"),
    [
        ("Revolute", lambda *f: RevoluteJoint("J", *f, [0, 0, 1]), [0.7]),
        ("Prismatic", lambda *f: PrismaticJoint("J", *f, [0, 0, 1]), [0.7]),
        ("Planar", lambda *f: PlanarJoint("J", *f), [0.3, -0.2, 0.7]),
        ("Universal", lambda *f: UniversalJoint("J", *f), [0.3, -0.9]),
    ],
)
def test_poses_are_those_of_drakes_joints(tmp_path, kind, drake, q):
    plant = MultibodyPlant(0.0)
    body = plant.AddRigidBody("B", SpatialInertia.SolidSphereWithMass(1.0, 0.1))
    plant.AddJoint(drake(plant.world_frame(), body.body_frame()))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    X: RigidTransform = body.EvalPoseInWorld(context)
    found = joint_of(read(tmp_path, kind)).pose(np.array(q))
    np.testing.assert_allclose(found, X.GetAsMatrix4(), atol=1e-15)


def test_springs_dampers_limits_and_targets_are_in_si(tmp_path):
    (primitive,) = primitives_of(
        read(
            tmp_path,
            "Revolute",
            SpringStiffness="2",
            SpringStiffnessUnits="N*m/rad",
            DampingCoefficient="3",
            DampingCoefficientUnits="N*m/(rad/s)",
            EquilibriumPosition="90",
            LowerLimitSpecify="on",
            LowerLimitBound="-45",
            PositionTargetSpecify="on",
            PositionTargetValue="30",
            PositionTargetPriority="Low",
            TorqueActuationMode="InputTorque",
        )
    )
    assert (primitive.stiffness, primitive.damping) == (2.0, 3.0)
    assert primitive.rest == pytest.approx(np.pi / 2)
    assert primitive.lower == pytest.approx(-np.pi / 4)
    assert primitive.upper is None
    assert primitive.target == pytest.approx((np.pi / 6,))
    assert (primitive.firm, primitive.driven) == (False, True)


def test_the_target_of_a_ball_is_a_rotation(tmp_path):
    *_, ball = primitives_of(
        read(
            tmp_path,
            "6-DOF",
            SphPositionTargetSpecify="on",
            SphPositionTargetRotationMethod="RotationSequence",
            SphPositionTargetRotationSequence="ZYX",
            SphPositionTargetRotationSequenceAngles="[10 20 30]",
        )
    )
    expected = Rotation.from_euler("ZYX", [10, 20, 30], degrees=True)
    np.testing.assert_allclose(ball.start, expected.as_rotvec(), atol=1e-15)
    np.testing.assert_allclose(ball.pose(ball.start)[:3, :3], expected.as_matrix(), atol=1e-15)


def test_what_cannot_be_built_is_named(tmp_path):
    with pytest.raises(InvalidValueError, match=r"'J'.*is a Constant Velocity Joint"):
        primitives_of(read(tmp_path, "Constant Velocity"))
    with pytest.raises(UnknownValueError, match="stiff"):
        primitives_of(read(tmp_path, "Revolute", SpringStiffness="stiff"))
    with pytest.raises(InvalidValueError, match=r"DampingCoefficient .* one number"):
        primitives_of(read(tmp_path, "Revolute", DampingCoefficient="[1 2]"))
