"""Khalil tables of open chains of a model."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, four_bar
from numpy.testing import assert_allclose
from pydrake.multibody.tree import JacobianWrtVariable
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import foot_pose, jacobian, row_transform
from drake_leg.simulink.mechanism import pose
from drake_leg.simulink.multibody.chain import chain_of, rows_of
from drake_leg.simulink.multibody.plant import mechanism_plant


def placed(built, at, joint, kind, turned, offset, *, backwards=False, **texts):
    """Add a transform, a joint and a brick; return the frame on the brick."""
    axis, angle = turned
    built.transform(f"{joint}_place", offset=offset, axis=axis, angle=angle)
    built.joint(kind, joint, **texts)
    built.body("Brick Solid", f"{joint}_body", BrickDimensions="[0.1 0.2 0.3]")
    base, follower = (f"{joint} lconn:1", f"{joint} rconn:1")
    if backwards:
        base, follower = follower, base
    built.meet(at, f"{joint}_place lconn:1")
    built.meet(f"{joint}_place", base)
    built.meet(follower, f"{joint}_body")
    return f"{joint}_body"


def arm():
    """Two axes in a Universal Joint, a slide that is drawn backwards, a turn with limits."""
    built = MechanismBuilder()
    at = placed(built, "World", "Shoulder", "Universal", ("+Y", "30"), "[0.1 0.2 0.3]")
    at = placed(built, at, "Slide", "Prismatic", ("+X", "70"), "[0.4 0 0.1]", backwards=True)
    at = placed(
        built, at, "Wrist", "Revolute", ("+X", "90"), "[0 0.3 -0.2]",
        LowerLimitSpecify="on", LowerLimitBound="-40", UpperLimitSpecify="on", UpperLimitBound="50",
        PositionTargetSpecify="on", PositionTargetValue="20",
    )  # fmt: skip
    built.transform("Tool", offset="[0.05 0.5 0.02]", axis="+Z", angle="25")
    built.meet(at, "Tool lconn:1")
    return built


def quarter_turns(count=60):
    """Poses whose axes are parallel or perpendicular, to rounding and a little more."""
    rng = np.random.default_rng(1)
    for _ in range(count):
        noise = rng.normal(size=3) * 10.0 ** -rng.integers(3, 18)
        angles = rng.integers(0, 4, 3) * 90.0 + noise
        R = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
        yield pose(R, rng.integers(-1, 2, 3).astype(float))


@pytest.mark.parametrize("X", [*quarter_turns(), np.eye(4), pose(np.diag([1.0, -1.0, -1.0]))])
def test_any_pose_is_one_or_two_rows(X):
    product = np.eye(4)
    for row in rows_of("revolute", X):
        product = product @ row_transform(row)
    assert_allclose(product, X, atol=2e-12)


def test_poses_of_common_tables_are_one_row():
    for angles in ((0.0, 0.0, 0.0), (90.0, 0.0, 0.0), (180.0, 0.0, 0.0)):
        R = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
        (row,) = rows_of("revolute", pose(R, (0.3, 0.0, 0.0)))
        assert (row.d, row.gamma, row.b) == (0.3, 0.0, 0.0)


def test_a_chain_moves_as_the_plant_of_its_model(tmp_path):
    mechanism = arm().mechanism(tmp_path)
    chain = chain_of(mechanism)
    assert chain.joints == ("Shoulder", "Slide", "Wrist")
    assert (chain.tip, chain.foot) == ("Wrist_body", "the follower of 'Tool'")
    plant = mechanism_plant(mechanism)
    context = plant.CreateDefaultContext()
    tool = pose(Rotation.from_euler("z", 25, degrees=True).as_matrix(), (0.05, 0.5, 0.02))
    body = plant.GetFrameByName("Wrist_body")
    for q in np.random.default_rng(2).uniform(-1.0, 1.0, (5, 4)):
        plant.SetPositions(context, q)
        X_WB = body.CalcPoseInWorld(context).GetAsMatrix4()
        assert_allclose(foot_pose(chain.robot.rows, q), X_WB @ tool, atol=1e-12)
        J = plant.CalcJacobianSpatialVelocity(
            context,
            JacobianWrtVariable.kQDot,
            body,
            tool[:3, 3],
            plant.world_frame(),
            plant.world_frame(),
        )
        assert_allclose(jacobian(chain.robot.rows, q), J, atol=1e-12)


def test_limits_and_targets_are_those_of_the_model(tmp_path):
    *others, wrist = chain_of(arm().mechanism(tmp_path)).robot.moving
    assert all(each.mechanics.bounds == (-math.inf, math.inf) for each in others)
    assert wrist.mechanics.bounds == pytest.approx((math.radians(-40), math.radians(50)))
    assert wrist.mechanics.position_target.value == pytest.approx(math.radians(20))


def test_of_several_tips_one_is_chosen(tmp_path):
    built = arm()
    placed(built, "World", "Other", "Revolute", ("+X", "0"), "[1 0 0]")
    mechanism = built.mechanism(tmp_path)
    with pytest.raises(InvalidValueError, match="2 tips: Other_body, Wrist_body"):
        chain_of(mechanism)
    chain = chain_of(mechanism, "Other_body")
    assert chain.joints == ("Other",)
    assert len(chain.robot.moving) == 1
    with pytest.raises(InvalidValueError, match="no tip 'Oter_body': did you mean Other_body"):
        chain_of(mechanism, "Oter_body")


def test_what_is_no_open_chain_of_axes_is_refused(tmp_path):
    with pytest.raises(InvalidValueError, match="closed loops, cut at"):
        chain_of(four_bar().mechanism(tmp_path))
    built = MechanismBuilder()
    placed(built, "World", "Ball", "Spherical", ("+X", "0"), "[1 0 0]")
    with pytest.raises(InvalidValueError, match="'Ball' has no axes"):
        chain_of(built.mechanism(tmp_path))
    built = MechanismBuilder()
    built.body("Brick Solid", "Stone")
    built.meet("World", "Stone")
    with pytest.raises(InvalidValueError, match="no chain of joints begins at the world"):
        chain_of(built.mechanism(tmp_path))
