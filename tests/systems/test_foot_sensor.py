import numpy as np

from drake_leg.kinematics.walking.legs import Legs
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.systems.foot_sensor import FootSensor

LEGS = Legs.of(HEXABOT)


def turn(angle, axis):
    """Homogeneous rotation about x, y or z."""
    c, s = np.cos(angle), np.sin(angle)
    first, second = [(1, 2), (2, 0), (0, 1)][axis]
    X = np.eye(4)
    X[first, first] = X[second, second] = c
    X[first, second], X[second, first] = -s, s
    return X


def test_forces_are_those_whose_torques_the_joints_feel(rng):
    """By virtual work: tau = J^T f for every leg, with J by differences of the feet."""
    q = starting_posture(HEXABOT) + rng.uniform(-0.2, 0.2, 18)
    pitch, slope = 0.1, 0.2
    X_WG, X_WB = turn(-slope, 1), turn(pitch, 1)
    force = rng.uniform(-5.0, 5.0, (6, 3))  # in G
    in_body = force @ X_WG[:3, :3].T @ X_WB[:3, :3]
    h, torques = 1e-6, np.zeros(18)
    for joint in range(18):
        there = np.zeros(18)
        there[joint] = h
        up, down = (LEGS.feet((q + s * there).reshape(6, 3)) for s in (1.0, -1.0))
        torques[joint] = ((up - down) / (2.0 * h) * in_body).sum()
    sensor = FootSensor(LEGS, X_WG)
    context = sensor.CreateDefaultContext()
    sensor.GetInputPort("q").FixValue(context, q)
    sensor.GetInputPort("contact").FixValue(context, [0.0] * 6 + torques.tolist())
    quaternion = [np.cos(pitch / 2), 0.0, np.sin(pitch / 2), 0.0]
    sensor.GetInputPort("body").FixValue(context, [*quaternion, 0.3, 0.2, 0.1])
    found = sensor.GetOutputPort("force").Eval(context).reshape(6, 3)
    np.testing.assert_allclose(found, force, atol=1e-6)
    feet = sensor.GetOutputPort("feet").Eval(context).reshape(6, 3)
    np.testing.assert_allclose(feet, LEGS.feet(q.reshape(6, 3)), atol=1e-15)
