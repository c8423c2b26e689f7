import numpy as np
import pytest

from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, LEG_B, pendulum
from drake_leg.systems.energy_sensor import EnergySensor

LENGTH, WIDTH, HEIGHT, DENSITY = 0.4, 0.03, 0.02, 800.0  # [m], [kg/m^3]
MASS = DENSITY * LENGTH * WIDTH * HEIGHT
INERTIA = MASS * (LENGTH**2 + WIDTH**2) / 12 + MASS * LENGTH**2 / 4  # about the pivot


def energy_of(plant, state):
    sensor = EnergySensor(plant)
    context = sensor.CreateDefaultContext()
    sensor.GetInputPort("state").FixValue(context, state)
    (value,) = sensor.GetOutputPort("energy").Eval(context)
    return value


@pytest.mark.parametrize("gravity", [9.80665, 1.62, 0.0])
@pytest.mark.parametrize("stiffness", [0.0, 5.0])
def test_the_pendulums_energy_is_the_closed_form(gravity, stiffness, rng):
    mechanics = JointMechanics(
        damping=0.3, spring_stiffness=stiffness, equilibrium_position=0.7, actuated=False
    )
    robot = pendulum(size=(LENGTH, WIDTH, HEIGHT), density=DENSITY, mechanics=mechanics)
    plant = build_plant(robot, gravity=gravity)
    for q, qdot in rng.uniform(-4.0, 4.0, (10, 2)):
        kinetic = INERTIA * qdot**2 / 2
        height = -LENGTH / 2 * np.sin(q)  # positive angles turn the link downwards
        spring = stiffness * (q - 0.7) ** 2 / 2
        expected = kinetic + MASS * gravity * height + spring
        assert energy_of(plant, [q, qdot]) == pytest.approx(expected, rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=lambda robot: robot.name)
def test_the_legs_energy_is_summed_over_its_links(robot, rng):
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    for state in rng.uniform(-3.0, 3.0, (5, 6)):
        plant.SetPositionsAndVelocities(context, state)
        M = plant.CalcMassMatrix(context)
        expected = state[3:] @ M @ state[3:] / 2
        for name, mass in (
            ("coxa", 1000 * 0.050 * 0.008 * 0.005),
            ("femur", 1000 * 0.100 * 0.008 * 0.005),
            ("tibia", 1000 * 0.100 * 0.008 * 0.005),
            ("foot", 1000 * 4 / 3 * np.pi * 0.006**3),
        ):
            frame = plant.GetFrameByName(f"{name}_cog")
            expected += mass * 9.80665 * frame.CalcPoseInWorld(context).translation()[2]
        assert energy_of(plant, state) == pytest.approx(expected, rel=1e-12)


def test_its_ports_have_the_names_and_sizes_of_its_table():
    sensor = EnergySensor(build_plant(LEG_B))
    assert sensor.GetInputPort("state").size() == 6
    assert sensor.GetOutputPort("energy").size() == 1
    assert sensor.HasAnyDirectFeedthrough()
