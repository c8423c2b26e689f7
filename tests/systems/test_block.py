"""Every block, and every diagram of a foot's motion, converts to AutoDiffXd."""

import inspect

import numpy as np
import pytest
from pydrake.autodiffutils import AutoDiffXd, InitializeAutoDiff
from pydrake.systems.analysis import Simulator, Simulator_
from pydrake.systems.framework import DiagramBuilder, LeafSystem, LeafSystem_

from drake_leg.diagrams import ellipse, hexabot_leg, kinematic_loop, pendulum, scara
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.diagrams.ellipse import EllipseConfig
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.diagrams.pendulum import PendulumConfig
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.chain import MovableChain, movable
from drake_leg.kinematics.motions import Push
from drake_leg.kinematics.movable import TRANSLATION
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.singularity.inverse import Inverse
from drake_leg.systems.block import Block, differentiable
from drake_leg.systems.drift_correction import DriftCorrection
from drake_leg.systems.energy_sensor import EnergySensor
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.partial_dynamics import PartialInverseDynamics
from drake_leg.systems.prescribed_motion import PrescribedMotion
from drake_leg.systems.speed_limit import SpeedLimit

H = 1e-6  # of the differences

PLANT = build_plant(LEG_B)
FOOT, KNEE = PLANT.GetFrameByName("frame_4"), PLANT.GetFrameByName("frame_2")
STOPPED = {"knee": JointMechanics(upper=0.4, upper_stop=HardStop.rotational())}
TWISTS = (0.0, 1.5, -1.0, 0.4, 0.9, 1.2)
ARM = tuple(Row(joint="revolute", d=0.2, r=0.1, alpha=alpha) for alpha in TWISTS)

BLOCKS = {
    "leg A": InverseJacobian(movable(LEG_A)),
    "leg B": InverseJacobian(movable(LEG_B)),
    "SCARA": InverseJacobian(MovableScara(ScaraGeometry.from_robot(SCARA))),
    "arm": InverseJacobian(MovableChain(ARM, np.eye(6))),
    "redundant arm": InverseJacobian(MovableChain(ARM[:5], TRANSLATION)),
    "foot": FrameSensor(PLANT, FOOT, acceleration=True, rotation_matrix=True),
    "foot from the knee": FrameSensor(
        PLANT, FOOT, KNEE, observed_in="world", expressed_in="follower", acceleration=True
    ),
    "energy": EnergySensor(PLANT),
    "stops": JointStops(PLANT, STOPPED),
    "limited speed": SpeedLimit(0.5),
    "speed within its limit": SpeedLimit(5.0),
    "some joints": PartialInverseDynamics(PLANT, [PLANT.GetJointByName("ankle")]),
    "all joints": PrescribedMotion(PLANT),
    "the hip": PrescribedMotion(PLANT, ["hip"]),
    "drift": DriftCorrection(5.0, start=[0.1, 0.0, 0.0]),
    "filter": InputFilter(2, 0.1),
}
OPTIONAL = ("actuation", "applied_generalized_force", "applied_spatial_force", "contact_force")

PUSH = Push(force=(0.0, 0.05, 0.1), at=0.2, lasting=0.1)
DIAGRAMS = {
    "leg": (hexabot_leg, HexabotLegConfig()),
    "leg A": (hexabot_leg, HexabotLegConfig(robot=LEG_A, q0=(1.57, 0.87, 1.57))),
    "push": (hexabot_leg, HexabotLegConfig(disturbance=Disturbance(push=PUSH))),
    "mass": (hexabot_leg, HexabotLegConfig(disturbance=Disturbance(mass_error=0.2))),
    "torque": (hexabot_leg, HexabotLegConfig(disturbance=Disturbance(torque_limit=0.002))),
    "drift": (hexabot_leg, HexabotLegConfig(control=Control(correction=5.0))),
    "filter": (hexabot_leg, HexabotLegConfig(filter_time_constant=0.02, feedback="integrated")),
    "ellipse": (ellipse, EllipseConfig()),
    "SCARA": (scara, ScaraConfig()),
    "loop": (kinematic_loop, HexabotLegConfig()),
    "loop with drift": (kinematic_loop, ScaraConfig(control=Control(correction=5.0))),
    "loop with filters": (kinematic_loop, HexabotLegConfig(filter_time_constant=0.02)),
    "pendulum": (pendulum, PendulumConfig()),
}


def vectors(block):
    ports = [block.get_input_port(i) for i in range(block.num_input_ports())]
    return [port for port in ports if port.get_name() not in OPTIONAL]


def evaluated(block, index, numbers):
    context, start = block.CreateDefaultContext(), 0
    for port in vectors(block):
        port.FixValue(context, numbers[start : start + port.size()])
        start += port.size()
    return block.get_output_port(index).Eval(context)


def differences(function, x):
    return np.array([(function(x + H * e) - function(x - H * e)) / (2 * H) for e in np.eye(len(x))])


def split(scalars, count):
    """Values, and derivatives (count, n) of which a constant has none."""
    slopes = [
        each.derivatives() if each.derivatives().size else np.zeros(count) for each in scalars
    ]
    return np.array([each.value() for each in scalars]), np.array(slopes).T


@pytest.mark.parametrize("name", BLOCKS)
def test_a_blocks_derivatives_are_those_of_differences(name, rng):
    block = BLOCKS[name]
    twin = block.ToAutoDiffXd()
    x = rng.uniform(0.45, 0.8, sum(port.size() for port in vectors(block)))
    for index in range(block.num_output_ports()):
        values, slopes = split(evaluated(twin, index, InitializeAutoDiff(x).ravel()), len(x))
        expected = differences(lambda x, i=index: evaluated(block, i, x), x)
        np.testing.assert_allclose(values, evaluated(block, index, x), rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(slopes, expected, rtol=1e-7, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("name", DIAGRAMS)
def test_a_diagrams_derivatives_are_those_of_differences(name):
    room, config = DIAGRAMS[name]
    diagram = room.build(config)
    twin = diagram.ToAutoDiffXd()
    context, context_of_twin = diagram.CreateDefaultContext(), twin.CreateDefaultContext()
    context.SetTime(0.25)
    start_on_motion(diagram, context)
    context_of_twin.SetTimeStateAndParametersFrom(context)

    def derivatives(x):
        context.SetContinuousState(x)
        return diagram.EvalTimeDerivatives(context).CopyToVector()

    x = context.get_continuous_state_vector().CopyToVector()
    context_of_twin.SetContinuousState(InitializeAutoDiff(x).ravel())
    values, slopes = split(twin.EvalTimeDerivatives(context_of_twin).CopyToVector(), len(x))
    expected = differences(derivatives, x)
    np.testing.assert_allclose(values, derivatives(x), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(slopes, expected, rtol=1e-6, atol=1e-8 * np.abs(expected).max())


@pytest.mark.slow
def test_a_simulated_step_carries_the_derivative_by_its_start():
    diagram = hexabot_leg.build(HexabotLegConfig())
    start = diagram.CreateDefaultContext()
    start_on_motion(diagram, start)
    x = start.get_continuous_state_vector().CopyToVector()

    def final(simulator, x):
        simulator.get_mutable_context().SetTimeStateAndParametersFrom(start)
        simulator.get_mutable_context().SetContinuousState(x)
        simulator.get_mutable_integrator().set_fixed_step_mode(True)
        simulator.get_mutable_integrator().set_maximum_step_size(0.02)
        simulator.AdvanceTo(0.2)
        return simulator.get_context().get_continuous_state_vector().CopyToVector()

    simulator = Simulator_[AutoDiffXd](diagram.ToAutoDiffXd())
    values, slopes = split(final(simulator, InitializeAutoDiff(x).ravel()), len(x))
    expected = differences(lambda x: final(Simulator(diagram), x), x)
    np.testing.assert_allclose(values, final(Simulator(diagram), x), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(slopes, expected, rtol=1e-6, atol=1e-8 * np.abs(expected).max())


def test_a_block_stays_an_ordinary_leaf_system():
    block = InverseJacobian(movable(LEG_B))
    assert isinstance(block, LeafSystem)
    assert list(inspect.signature(InverseJacobian).parameters) == ["robot"]
    twin = block.ToAutoDiffXd()
    assert isinstance(twin, LeafSystem_[AutoDiffXd])
    assert type(twin) is differentiable(InverseJacobian)
    assert type(twin).__name__ == "InverseJacobian_[AutoDiffXd]"


def test_a_block_of_ones_own_converts_too():
    class Named(SpeedLimit):
        def name(self):
            return "mine"

    twin = Named(1.0).ToAutoDiffXd()
    assert twin.name() == "mine"
    assert type(twin).__name__ == "Named_[AutoDiffXd]"


class OtherArguments(SpeedLimit):
    def __init__(self, top, label):
        SpeedLimit.__init__(self, top)
        self.label = label


class FewerArguments(SpeedLimit):
    def __init__(self):
        SpeedLimit.__init__(self, 1.0)


class WithoutItsArguments(Block):
    def __init__(self, size):
        Block.__init__(self)
        self.DeclareVectorInputPort("u", size)


class WithSuper(Block):
    def __init__(self, size):
        super().__init__(size)


@pytest.mark.parametrize(
    ("block", "says"),
    [
        (
            OtherArguments(1.0, "mine"),
            r"OtherArguments .*takes \(self, top, label\).*SpeedLimit.*\(self, top, lengths\).*"
            r"derive it from Block.*`Block.__init__\(self, top, label\)`",
        ),
        (FewerArguments(), r"FewerArguments .*derive it from Block.*`Block.__init__\(self\)`"),
        (WithoutItsArguments(2), r"missing 1 .*'size'.*with all of its own arguments"),
        (WithSuper(2), r"WithSuper .*use no `super\(\)`"),
    ],
    ids=["other arguments", "fewer arguments", "passes on none", "super"],
)
def test_a_block_that_cannot_be_constructed_again_says_why(block, says):
    with pytest.raises(InvalidValueError, match=says):
        block.ToAutoDiffXd()
    builder = DiagramBuilder()
    builder.AddSystem(block)
    with pytest.raises(InvalidValueError, match=says):
        builder.Build().ToAutoDiffXd()


def test_every_block_in_python_converts():
    driven_by_hand, closed_by_newton = {"FootBrake"}, {"_LoopBlock"}
    walking = {"BodyCommand", "BodyFeedback", "BodyLevel", "FeedForward", "FootSensor", "GaitBlock"}
    walking |= {"TouchDown"}
    not_converted = {c.__name__ for c in LeafSystem.__subclasses__() if _is_ours(c)}
    of_models = {"DrivenMechanism", "SignalSystem", "_Forces"}  # of anyone's Simulink model
    assert not not_converted - driven_by_hand - closed_by_newton - walking - of_models
    assert Block in LeafSystem.__subclasses__()


def _is_ours(cls):
    return cls.__module__.startswith("drake_leg.") and cls is not Block


def test_a_diagram_is_cloned_by_way_of_autodiff():
    diagram = hexabot_leg.build(HexabotLegConfig())
    block = diagram.Clone().GetSubsystemByName("inverseJacobian")
    assert isinstance(block, InverseJacobian)
    assert block.robot.geometry == movable(LEG_B).geometry


@pytest.mark.parametrize("robot", [movable(LEG_B), MovableChain(ARM, np.eye(6))])
def test_a_singular_posture_is_found_in_autodiff(robot):
    twin = InverseJacobian(robot).ToAutoDiffXd()
    context = twin.CreateDefaultContext()
    q = np.zeros(robot.joints)
    twin.GetInputPort("q").FixValue(context, InitializeAutoDiff(q).ravel())
    twin.GetInputPort("v").FixValue(context, InitializeAutoDiff(np.ones(robot.size)).ravel())
    with pytest.raises(SingularConfigurationError, match="singular"):
        twin.GetOutputPort("qdot").Eval(context)


def test_what_has_no_derivatives_says_so():
    damped = Inverse(method="damped").of(movable(LEG_B), LEG_B.moving)
    with pytest.raises(InvalidValueError, match="Damped robot has no derivatives"):
        InverseJacobian(damped).ToAutoDiffXd()
    with pytest.raises(InvalidValueError, match="no derivatives of Euler angles"):
        FrameSensor(PLANT, FOOT, euler="XYZ").ToAutoDiffXd()
