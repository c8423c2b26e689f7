"""A body that includes one leg six times is the walker that is built by hand."""

import dataclasses
import logging

import numpy as np
import pytest
from pydrake.geometry import AddContactMaterial, ProximityProperties
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiscreteContactApproximation,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_leg.diagrams.hexapod import walk_of
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.models.ground import add_ground
from drake_leg.models.plant import WALKERS, sdf_folder
from drake_leg.models.walker import NEAR_RIGID, POINT_FEET, Contact, add_walker
from drake_leg.models.walker_sdf import body_text, leg_text
from drake_leg.robot.ground import FLAT
from drake_leg.robot.hexapods import HEXABOT, PHANTOMX
from drake_leg.robot.servos import IDEAL
from drake_leg.units import STANDARD_GRAVITY

JOINTS = ("hip", "knee", "ankle")
STEP = 0.005  # [s]


class Simulated:
    """A plant of a walker, its state in the table's order whatever its own."""

    def __init__(self, builder, plant, instances, joints):
        self.plant, self.diagram = plant, builder.Build()
        self.simulator = Simulator(self.diagram)
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.instances = instances
        self.at_q = [*range(7), *(joint.position_start() for joint in joints)]
        self.at_v = [*range(6), *(joint.velocity_start() for joint in joints)]
        for instance in instances:
            n = plant.num_actuated_dofs(instance)
            plant.get_actuation_input_port(instance).FixValue(self.context, np.zeros(n))

    def set(self, q, v):
        for setter, at, values in (
            (self.plant.SetPositions, self.at_q, q),
            (self.plant.SetVelocities, self.at_v, v),
        ):
            ordered = np.empty(len(at))
            ordered[at] = values
            setter(self.context, ordered)

    def want(self, q, v):
        """Desired angles and rates (n, 3) of all legs."""
        parts = zip(*(np.split(one.ravel(), len(self.instances)) for one in (q, v)), strict=True)
        for instance, part in zip(self.instances, parts, strict=True):
            port = self.plant.get_desired_state_input_port(instance)
            port.FixValue(self.context, np.concatenate(part))

    @property
    def state(self):
        q = self.plant.GetPositions(self.context)[self.at_q]
        return np.concatenate([q, self.plant.GetVelocities(self.context)[self.at_v]])

    def dynamics(self):
        at = np.ix_(self.at_v, self.at_v)
        return {
            "mass matrix": self.plant.CalcMassMatrix(self.context)[at],
            "gravity": self.plant.CalcGravityGeneralizedForces(self.context)[self.at_v],
            "bias": self.plant.CalcBiasTerm(self.context)[self.at_v],
        }


def by_hand(robot):
    builder = DiagramBuilder()
    walker = add_walker(builder, robot, time_step=STEP)
    joints = [walker.plant.GetJointByName(segment.joint) for segment in robot.moving]
    return Simulated(builder, walker.plant, [walker.instance], joints)


def from_file(name):
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, STEP)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    plant.set_sap_near_rigid_threshold(NEAR_RIGID)
    parser = Parser(plant)
    parser.SetStrictParsing()
    parser.package_map().AddPackageXml(str(sdf_folder() / "package.xml"))
    parser.AddModels(str(sdf_folder() / f"{name}.sdf"))
    rigid = ProximityProperties()
    friction = CoulombFriction(FLAT.friction, FLAT.friction)
    AddContactMaterial(None, 1e6 * POINT_FEET.stiffness, friction, rigid)
    add_ground(plant, FLAT, rigid)
    for index in plant.GetJointActuatorIndices():  # as the other is made for its time step
        actuator = plant.get_mutable_joint_actuator(index)
        excess = actuator.joint().default_damping() * STEP / 2.0
        actuator.set_default_rotor_inertia(actuator.default_rotor_inertia() - excess)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -STANDARD_GRAVITY])
    plant.Finalize()
    robot = WALKERS[name]
    legs = [plant.GetModelInstanceByName(f"{robot.name}::{leg}") for leg in Legs.of(robot).names]
    joints = [plant.GetJointByName(joint, leg) for leg in legs for joint in JOINTS]
    return Simulated(builder, plant, legs, joints)


@pytest.fixture(params=WALKERS)
def name(request):
    return request.param


def test_it_is_parsed_without_a_warning(name, caplog):
    with caplog.at_level(logging.DEBUG):
        from_file(name)
    assert caplog.records == []


def test_it_moves_as_the_walker_that_is_built_by_hand(name, rng):
    composed, whole = from_file(name), by_hand(WALKERS[name])
    for _ in range(3):
        q, v = rng.uniform(-1.0, 1.0, 25), rng.uniform(-1.0, 1.0, 24)
        q[:4] /= np.linalg.norm(q[:4])
        composed.set(q, v)
        whole.set(q, v)
        for what, value in composed.dynamics().items():
            expected = whole.dynamics()[what]
            np.testing.assert_allclose(value, expected, rtol=0.0, atol=1e-12, err_msg=what)


@pytest.mark.slow
def test_it_walks_as_the_walker_that_is_built_by_hand(name):
    robot = WALKERS[name]
    legs, walk = Legs.of(robot), walk_of(robot, commands=[Command(forward=0.1, start=0.8)])
    times = 0.8 + STEP * np.arange(101)
    wanted = legs.motion(walk.feet(times))
    sides = (from_file(name), by_hand(robot))
    for side in sides:
        height = -walk.neutral[0, 2]
        q = np.concatenate([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, height], wanted.value[0].ravel()])
        side.set(q, np.zeros(24))
    for number in range(1, len(times)):
        for side in sides:
            side.want(wanted.value[number], wanted.rate[number])
            side.simulator.AdvanceTo(STEP * number)
    composed, whole = (side.state for side in sides)
    assert whole[4] > 0.004  # [m], on its way
    np.testing.assert_allclose(composed, whole, rtol=0.0, atol=1e-9)


def test_legs_that_are_not_alike_are_refused():
    odd = list(PHANTOMX.segments)
    odd[5] = dataclasses.replace(odd[5], mechanics=HEXABOT.segments[1].mechanics)
    with pytest.raises(InvalidValueError, match="'phantomx' are not alike: left_middle is not"):
        body_text(dataclasses.replace(PHANTOMX, segments=tuple(odd)), leg_file="leg.sdf")
    with pytest.raises(InvalidValueError, match="not alike"):
        leg_text(dataclasses.replace(PHANTOMX, segments=tuple(odd)))


def test_servo_contact_and_friction_are_in_the_leg():
    rubbing = dataclasses.replace(IDEAL, friction=0.1)
    with pytest.raises(InvalidValueError, match=r"friction of 0\.1 N\*m, which SDF does not bring"):
        leg_text(HEXABOT, servo=rubbing)
    servo = dataclasses.replace(IDEAL, stiffness=7.0, stall_torque=1.25)
    text = leg_text(HEXABOT, servo=servo, contact=Contact(foot_radius=0.006), friction=0.3)
    assert text.count('<drake:controller_gains p="7.0"') == 3
    assert text.count("<effort>1.25</effort>") == 3
    assert "<drake:mu_static>0.3</drake:mu_static>" in text
    assert text.count("<radius>0.006</radius>") == 2  # drawn, and touching
