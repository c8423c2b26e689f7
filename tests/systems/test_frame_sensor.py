import numpy as np
import pytest

from drake_leg.kinematics.rotation import rotation_matrices
from drake_leg.models.plant import build_plant
from drake_leg.robots import LEG_A, LEG_B, SCARA
from drake_leg.systems.frame_sensor import FrameSensor

PLACES = pytest.mark.parametrize(
    ("robot", "frame", "body"),
    [
        (LEG_B, "frame_4", "foot"),
        (LEG_A, "frame_4", "foot"),
        (LEG_B, "femur_cog", "femur"),
        (LEG_A, "coxa_end", "coxa"),
        (SCARA, "frame_4", "tool"),
    ],
)


def state_of(plant, rng):
    return rng.uniform(-2.0, 2.0, plant.num_multibody_states())


def sensed(sensor, state):
    context = sensor.CreateDefaultContext()
    sensor.GetInputPort("state").FixValue(context, state)
    names = ("position", "velocity", "quaternion", "angular_velocity")
    return [sensor.GetOutputPort(name).Eval(context) for name in names]


def body_motion(plant, state, body, offset):
    """Motion of a point fixed to a body, by the plant's own output ports."""
    context = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, state)
    if plant.num_actuators():
        plant.get_actuation_input_port().FixValue(context, np.zeros(plant.num_actuators()))
    index = plant.GetBodyByName(body).index()
    X_WB = plant.get_body_poses_output_port().Eval(context)[int(index)]
    V_WB = plant.get_body_spatial_velocities_output_port().Eval(context)[int(index)]
    arm = X_WB.rotation() @ offset
    velocity = V_WB.translational() + np.cross(V_WB.rotational(), arm)
    return X_WB.translation() + arm, velocity, X_WB.rotation().matrix(), V_WB.rotational()


@PLACES
def test_it_senses_what_the_plants_own_body_ports_say(robot, frame, body, rng):
    plant = build_plant(robot)
    sensor = FrameSensor(plant, plant.GetFrameByName(frame))
    link = next(s.link for s in robot.segments if s.link and s.link.name == body)
    offset = {"cog": link.solid.centre, "end": link.end}.get(frame.split("_")[1], (0.0,) * 3)
    for _ in range(5):
        state = state_of(plant, rng)
        position, velocity, quaternion, angular = sensed(sensor, state)
        p, v, R, w = body_motion(plant, state, body, np.array(offset))
        np.testing.assert_allclose(position, p, atol=1e-14)
        np.testing.assert_allclose(velocity, v, atol=1e-13)
        np.testing.assert_allclose(rotation_matrices(quaternion), R, atol=1e-14)
        np.testing.assert_allclose(angular, w, atol=1e-13)
        assert np.linalg.norm(quaternion) == pytest.approx(1.0, abs=1e-14)


def test_the_velocity_is_the_derivative_of_the_position(rng):
    plant = build_plant(LEG_B)
    sensor = FrameSensor(plant, plant.GetFrameByName("frame_4"))
    q, qdot = rng.uniform(-1.0, 1.0, (2, 3))
    h = 1e-5
    ahead, behind = (sensed(sensor, [*(q + t * qdot), *qdot]) for t in (h, -h))
    _, velocity, _, _ = sensed(sensor, [*q, *qdot])
    np.testing.assert_allclose(velocity, (ahead[0] - behind[0]) / (2 * h), atol=1e-9)


def test_one_call_leaves_nothing_behind_for_the_next(rng):
    plant = build_plant(LEG_B)
    sensor = FrameSensor(plant, plant.GetFrameByName("frame_4"))
    states = [state_of(plant, rng) for _ in range(2)]
    alone = [sensed(sensor, state) for state in states]
    contexts = [sensor.CreateDefaultContext() for _ in states]
    for context, state in zip(contexts, states, strict=True):
        sensor.GetInputPort("state").FixValue(context, state)
    # Interleaved: every port of one context, then of the other.
    for index in range(sensor.num_output_ports()):
        for context, expected in zip(contexts, alone, strict=True):
            value = sensor.get_output_port(index).Eval(context)
            np.testing.assert_array_equal(value, expected[index])


def test_every_output_feeds_through_from_the_state():
    plant = build_plant(LEG_B)
    sensor = FrameSensor(plant, plant.GetFrameByName("frame_4"))
    assert sensor.GetInputPort("state").size() == 6
    for name in ("position", "velocity", "quaternion", "angular_velocity"):
        assert sensor.HasDirectFeedthrough(0, sensor.GetOutputPort(name).get_index())
