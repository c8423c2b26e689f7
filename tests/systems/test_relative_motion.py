"""Relative motion against differences of Drake's poses, and against Drake's own formulas."""

from itertools import product

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RpyFloatingJoint, SpatialInertia
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import SEQUENCES
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.systems.relative_motion import RelativeMotion

PLACES = ("base", "follower", "world")
PAIRS = pytest.mark.parametrize(
    ("make", "follower", "base"),
    [
        ("leg", "frame_4", None),
        ("leg", "frame_4", "femur_base"),
        ("leg", "femur_base", "frame_4"),
        ("leg", "tibia_cog", "tibia_end"),
        ("scara", "frame_4", "frame_1"),
        ("floating", "satellite", "ship"),
        ("floating", "ship", "satellite"),
        ("floating", None, "ship"),
    ],
)


def floating():
    """Two bodies that are free in space, their positions given by roll, pitch, yaw and x, y, z."""
    plant = MultibodyPlant(time_step=0.0)
    plant.set_name("floating")
    for name in ("ship", "satellite"):
        body = plant.AddRigidBody(name, SpatialInertia.SolidBoxWithMass(1.0, 0.3, 0.2, 0.1))
        plant.AddJoint(RpyFloatingJoint(name, plant.world_frame(), body.body_frame()))
    plant.Finalize()
    return plant


@pytest.fixture(scope="module")
def plants():
    return {"leg": build_plant(LEG_B), "scara": build_plant(SCARA), "floating": floating()}


def named(plant, name):
    return plant.world_frame() if name is None else plant.GetFrameByName(name)


class Path:
    """A smooth motion of a plant through a random posture at t = 0."""

    def __init__(self, plant, rng):
        self.plant = plant
        self.context = plant.CreateDefaultContext()
        self.terms = rng.uniform(-1.0, 1.0, (4, plant.num_positions()))

    def velocities(self, t):
        a, b, c, d = self.terms
        self.plant.SetPositions(self.context, a + t * (b + t * (c + t * d)))
        qdot = b + t * (2 * c + 3 * t * d)
        return self.plant.MapQDotToVelocity(self.context, qdot)

    def state(self, t):
        v = self.velocities(t)
        return np.concatenate([self.plant.GetPositions(self.context), v])

    def pose(self, t, frame):
        self.velocities(t)
        X_WF = frame.CalcPoseInWorld(self.context)
        return X_WF.rotation().matrix(), X_WF.translation()


def spin(dR, R):
    S = dR @ R.T
    return np.array([S[2, 1] - S[1, 2], S[0, 2] - S[2, 0], S[1, 0] - S[0, 1]]) / 2


@PAIRS
def test_every_observer_sees_the_derivative_of_what_it_sees(
    plants, make, follower, base, rng, derivative
):
    plant = plants[make]
    F, B = named(plant, follower), named(plant, base)
    frames = {"base": B, "follower": F, "world": plant.world_frame()}
    path = Path(plant, rng)
    state, vdot = path.state(0.0), derivative(path.velocities)

    for E, observer in product(PLACES, PLACES):
        R_WE, R_WO = (path.pose(0.0, frames[place])[0] for place in (E, observer))
        R_EO = R_WE.T @ R_WO

        def p_BF_O(t, frame_O=frames[observer]):
            p_WF, p_WB = (path.pose(t, frame)[1] for frame in (F, B))
            return path.pose(t, frame_O)[0].T @ (p_WF - p_WB)

        def R_BF(t):
            R_WF, R_WB = (path.pose(t, frame)[0] for frame in (F, B))
            return R_WB.T @ R_WF

        def w_BF_O(t, frame_O=frames[observer]):
            w_BF_B = spin(derivative(R_BF, t, 3e-3), R_BF(t))
            return path.pose(t, frame_O)[0].T @ path.pose(t, B)[0] @ w_BF_B

        def v_BF_O(t, p=p_BF_O):
            return derivative(p, t, 3e-3)

        motion = RelativeMotion(plant, F, B, expressed_in=E, observed_in=observer).at(state)
        np.testing.assert_allclose(motion.position(), R_EO @ p_BF_O(0.0), atol=1e-14)
        np.testing.assert_allclose(motion.velocity(), R_EO @ v_BF_O(0.0), atol=1e-8)
        np.testing.assert_allclose(motion.acceleration(vdot), R_EO @ derivative(v_BF_O), atol=1e-7)
        np.testing.assert_allclose(motion.angular_velocity(), R_EO @ w_BF_O(0.0), atol=1e-8)
        np.testing.assert_allclose(
            motion.angular_acceleration(vdot), R_EO @ derivative(w_BF_O), atol=1e-7
        )


@PAIRS
def test_drake_says_the_same_of_its_own_forward_dynamics(plants, make, follower, base, rng):
    plant = plants[make]
    F, B, W = named(plant, follower), named(plant, base), plant.world_frame()
    context = plant.CreateDefaultContext()
    state = rng.uniform(-1.0, 1.0, plant.num_multibody_states())
    plant.SetPositionsAndVelocities(context, state)
    if plant.num_actuators():
        torque = rng.uniform(-0.01, 0.01, plant.num_actuators())
        plant.get_actuation_input_port().FixValue(context, torque)
    vdot = plant.get_generalized_acceleration_output_port().Eval(context)

    for E, axes in (("base", B), ("follower", F), ("world", W)):
        motion = RelativeMotion(plant, F, B, expressed_in=E).at(state)
        A_BF = F.CalcSpatialAcceleration(context, B, axes)
        V_BF = F.CalcSpatialVelocity(context, B, axes)
        scale = 1.0 + np.linalg.norm(A_BF.get_coeffs())
        close(motion.velocity(), V_BF.translational())
        close(motion.angular_velocity(), V_BF.rotational())
        close(motion.acceleration(vdot), A_BF.translational(), scale)
        close(motion.angular_acceleration(vdot), A_BF.rotational(), scale)

        watched = RelativeMotion(plant, F, B, expressed_in=E, observed_in="world").at(state)
        V = F.CalcRelativeSpatialVelocity(context, B, W, axes)
        A = F.CalcRelativeSpatialAcceleration(context, B, W, axes)
        close(watched.velocity(), V.translational())
        close(watched.acceleration(vdot), A.translational(), scale)
        close(watched.angular_velocity(), V.rotational())
        close(watched.angular_acceleration(vdot), A.rotational(), scale)

    X_BF = plant.CalcRelativeTransform(context, B, F)
    np.testing.assert_allclose(motion.rotation(), X_BF.rotation().matrix(), atol=1e-15)
    close(RelativeMotion(plant, F, B).at(state).position(), X_BF.translation())
    w, *xyz = motion.quaternion()
    assert w >= 0.0
    np.testing.assert_allclose(
        Rotation.from_quat([*xyz, w]).as_matrix(), X_BF.rotation().matrix(), atol=1e-14
    )


def close(found, expected, scale=1.0):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * scale)


def test_a_frame_at_rest_on_a_turning_base_rests_there_but_not_in_the_world():
    plant = build_plant(LEG_B)
    coxa, end = plant.GetFrameByName("coxa_base"), plant.GetFrameByName("coxa_end")
    state = [0.4, 0.0, 0.0, 3.0, 0.0, 0.0]  # the hip turns at 3 rad/s
    vdot = np.array([2.0, 0.0, 0.0])
    base = RelativeMotion(plant, end, coxa).at(state)
    np.testing.assert_array_equal(base.velocity(), 0.0)
    np.testing.assert_array_equal(base.acceleration(vdot), 0.0)
    inertial = RelativeMotion(plant, end, coxa, observed_in="world").at(state)
    np.testing.assert_allclose(inertial.velocity(), [0.0, 0.15, 0.0], atol=1e-15)
    np.testing.assert_allclose(inertial.acceleration(vdot), [-0.45, 0.1, 0.0], atol=1e-15)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_and_their_derivatives_follow_the_rotation(plants, sequence, rng, derivative):
    plant = plants["floating"]
    path = Path(plant, rng)
    motion = RelativeMotion(
        plant,
        plant.GetFrameByName("satellite"),
        plant.GetFrameByName("ship"),
        expressed_in="follower",
        observed_in="world",
    )
    state, vdot = path.state(0.0), derivative(path.velocities)
    angles = motion.at(state).angles(sequence)
    expected = Rotation.from_matrix(motion.rotation()).as_euler(sequence)
    np.testing.assert_allclose(angles, expected, atol=1e-12)
    step = 2e-4
    rates = derivative(lambda t: motion.at(path.state(t)).angles(sequence), 0.0, step)
    np.testing.assert_allclose(motion.at(state).angle_rates(sequence), rates, rtol=1e-6, atol=1e-8)
    rates_over_time = derivative(
        lambda t: motion.at(path.state(t)).angle_rates(sequence), 0.0, step
    )
    accelerations = motion.at(state).angle_accelerations(sequence, vdot)
    np.testing.assert_allclose(accelerations, rates_over_time, rtol=1e-6, atol=1e-7)


def test_drakes_roll_pitch_yaw_joint_has_angle_rates_which_are_not_body_rates(plants, rng):
    plant = plants["floating"]
    joint = plant.GetJointByName("ship")
    context = plant.CreateDefaultContext()
    motion = RelativeMotion(plant, plant.GetFrameByName("ship"))
    for _ in range(10):
        state = rng.uniform(-1.2, 1.2, plant.num_multibody_states())
        plant.SetPositionsAndVelocities(context, state)
        qdot = plant.MapVelocityToQDot(context, plant.GetVelocities(context))
        rpy_rates = qdot[joint.position_start() :][:3]
        motion.at(state)
        np.testing.assert_allclose(
            motion.angles("ZYX")[::-1], joint.get_angles(context), atol=1e-14
        )
        np.testing.assert_allclose(motion.angle_rates("ZYX")[::-1], rpy_rates, atol=1e-12)
        np.testing.assert_allclose(
            motion.angular_velocity(), joint.get_angular_velocity(context), atol=1e-14
        )
        assert np.abs(motion.angular_velocity() - rpy_rates).max() > 1e-2


def test_a_frame_of_another_plant_is_refused(plants):
    leg, other = plants["leg"], build_plant(LEG_B)
    with pytest.raises(InvalidValueError, match="'frame_4' is not of the plant 'leg_b'"):
        RelativeMotion(leg, other.GetFrameByName("frame_4"))
    with pytest.raises(InvalidValueError, match="'ship' is not of the plant 'leg_b'"):
        RelativeMotion(
            leg, leg.GetFrameByName("frame_4"), plants["floating"].GetFrameByName("ship")
        )


def test_a_plant_under_construction_is_refused():
    plant = MultibodyPlant(time_step=0.0)
    with pytest.raises(InvalidValueError, match="not finalized; call its Finalize"):
        RelativeMotion(plant, plant.world_frame())


@pytest.mark.parametrize("setting", ["expressed_in", "observed_in"])
def test_an_unknown_place_is_refused_with_the_known_ones(plants, setting):
    leg = plants["leg"]
    with pytest.raises(InvalidValueError, match=f"{setting} is 'Base'.*base, follower, world"):
        RelativeMotion(leg, leg.GetFrameByName("frame_4"), **{setting: "Base"})
