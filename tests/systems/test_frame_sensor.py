import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import euler_rotation, rate_matrix, rotation_matrices
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.systems.frame_sensor import MEASUREMENT_FRAMES, FrameSensor
from drake_leg.systems.relative_motion import RelativeMotion

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


ALWAYS = ["position", "velocity", "quaternion", "angular_velocity"]
ANGLES = ["angles", "angle_rates", "gimbal_distance"]


@pytest.mark.parametrize(
    ("requested", "inputs", "outputs"),
    [
        ({}, ["state"], []),
        ({"rotation_matrix": True}, ["state"], ["rotation_matrix"]),
        ({"euler": "XYZ"}, ["state"], ANGLES),
        (
            {"acceleration": True},
            ["state", "acceleration"],
            ["acceleration", "angular_acceleration"],
        ),
        (
            {"acceleration": True, "euler": "ZXZ"},
            ["state", "acceleration"],
            [*ANGLES, "acceleration", "angular_acceleration", "angle_accelerations"],
        ),
    ],
    ids=str,
)
def test_only_the_requested_ports_are_there_and_the_docstring_lists_them(
    requested, inputs, outputs
):
    plant = build_plant(LEG_B)
    sensor = FrameSensor(plant, plant.GetFrameByName("frame_4"), **requested)
    names = [sensor.get_output_port(i).get_name() for i in range(sensor.num_output_ports())]
    assert names == ALWAYS + outputs
    assert [sensor.get_input_port(i).get_name() for i in range(sensor.num_input_ports())] == inputs
    for name in names:
        (row,) = (
            line
            for line in FrameSensor.__doc__.splitlines()
            if line.strip().startswith(f"``{name}``") and " out " in line
        )
        assert int(row.split(" out ")[1].split()[0]) == sensor.GetOutputPort(name).size()


@pytest.fixture
def falling():
    """A leg that falls, its foot sensed in every way against its moving knee."""
    builder = DiagramBuilder()
    plant = builder.AddNamedSystem("leg", build_plant(LEG_B))
    foot, knee = plant.GetFrameByName("frame_4"), plant.GetFrameByName("coxa_end")
    sensor = builder.AddNamedSystem(
        "sensor",
        FrameSensor(
            plant,
            foot,
            knee,
            **MEASUREMENT_FRAMES["Non-Rotating Follower"],
            acceleration=True,
            euler="YXZ",
            rotation_matrix=True,
        ),
    )
    builder.Connect(plant.get_state_output_port(), sensor.GetInputPort("state"))
    builder.Connect(
        plant.get_generalized_acceleration_output_port(), sensor.GetInputPort("acceleration")
    )
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    leg = plant.GetMyMutableContextFromRoot(context)
    plant.get_actuation_input_port().FixValue(leg, np.zeros(3))
    plant.SetPositionsAndVelocities(leg, [0.3, -0.7, -1.1, 1.0, -2.0, 0.5])
    return plant, leg, sensor, sensor.GetMyContextFromRoot(context)


def test_in_a_diagram_every_port_says_what_the_motion_is(falling):
    plant, leg, sensor, context = falling
    assert plant is not None
    sensed = {
        port.get_name(): port.Eval(context)
        for port in map(sensor.get_output_port, range(sensor.num_output_ports()))
    }
    knee, foot = plant.GetFrameByName("coxa_end"), plant.GetFrameByName("frame_4")
    X_BF = plant.CalcRelativeTransform(leg, knee, foot)
    V = foot.CalcRelativeSpatialVelocity(leg, knee, plant.world_frame(), foot)
    A = foot.CalcRelativeSpatialAcceleration(leg, knee, plant.world_frame(), foot)
    R_BF = X_BF.rotation().matrix()
    expected = {
        "position": X_BF.inverse().translation() * -1.0,
        "velocity": V.translational(),
        "angular_velocity": V.rotational(),
        "rotation_matrix": R_BF.ravel(),
        "acceleration": A.translational(),
        "angular_acceleration": A.rotational(),
    }
    for name, value in expected.items():
        np.testing.assert_allclose(sensed[name], value, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(euler_rotation("YXZ", sensed["angles"]), R_BF, atol=1e-14)
    w_BF_B = rate_matrix("YXZ", sensed["angles"]) @ sensed["angle_rates"]
    np.testing.assert_allclose(R_BF.T @ w_BF_B, V.rotational(), atol=1e-13)
    motion = RelativeMotion(plant, foot, knee).at(plant.GetPositionsAndVelocities(leg))
    vdot = plant.get_generalized_acceleration_output_port().Eval(leg)
    np.testing.assert_allclose(
        sensed["angle_accelerations"], motion.angle_accelerations("YXZ", vdot), rtol=1e-12
    )
    assert sensed["gimbal_distance"] == pytest.approx(np.pi / 2 - abs(sensed["angles"][1]))


def test_gimbal_lock_is_told_and_stops_nothing():
    plant = build_plant(LEG_B)
    sensor = FrameSensor(plant, plant.GetFrameByName("frame_4"), euler="ZXZ")
    context = sensor.CreateDefaultContext()
    sensor.GetInputPort("state").FixValue(context, np.zeros(6))  # R = Rz(q1) Rx(90 deg) Rz(q2+q3)
    assert sensor.GetOutputPort("gimbal_distance").Eval(context) == pytest.approx(np.pi / 2)

    coxa = FrameSensor(plant, plant.GetFrameByName("frame_1"), euler="ZXZ")  # only turns about z
    context = coxa.CreateDefaultContext()
    coxa.GetInputPort("state").FixValue(context, [0.7, 0.0, 0.0, 3.0, 0.0, 0.0])
    assert coxa.GetOutputPort("gimbal_distance").Eval(context) == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(coxa.GetOutputPort("angles").Eval(context), [0.0, 0.0, 0.7])
    rates = coxa.GetOutputPort("angle_rates").Eval(context)
    np.testing.assert_allclose(rates, [1.5, 0.0, 1.5], atol=1e-15)


def test_bad_input_is_refused_in_one_sentence():
    plant = build_plant(LEG_B)
    frame = plant.GetFrameByName("frame_4")
    with pytest.raises(InvalidValueError, match="rotation sequence is 'RPY'; it must be one of"):
        FrameSensor(plant, frame, euler="RPY")
    with pytest.raises(InvalidValueError, match="'frame_4' is not of the plant"):
        FrameSensor(build_plant(LEG_B), frame)
    with pytest.raises(InvalidValueError, match=r"plant\.GetFrameByName\('frame_4'\)"):
        FrameSensor(plant, "frame_4")
    for setting in ("acceleration", "rotation_matrix"):
        with pytest.raises(InvalidValueError, match=f"{setting} is 'yes'; it must be a bool"):
            FrameSensor(plant, frame, **{setting: "yes"})
