"""Disturbed joints by their equation of motion, against the diagram that says what it is."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.primitives import Integrator

from drake_leg.diagrams import ellipse, hexabot_leg, scara
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.ellipse import EllipseConfig
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.mechanism import MOTION
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.motions import Push
from drake_leg.kinematics.scara import tool_position
from drake_leg.robot.joint_mechanics import HardStop
from drake_leg.robot.robots import LEG_B
from drake_leg.simulation.disturbed import follow_disturbed
from drake_leg.simulation.disturbed_joints import DisturbedJoints
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate
from drake_leg.singularity.inverse import Inverse
from drake_leg.systems.drift_correction import DriftCorrection

PUSH = Push(force=(0.02, -0.05, 0.1), at=0.1, lasting=0.1)
HEAVY, WEAK = 0.2, 0.0035  # mass error; torque limit [N m], less than the step takes
STRONG = Disturbance(push=PUSH, mass_error=-0.1)
ALL = replace(STRONG, torque_limit=0.01)
CORRECTED = Control(correction=5.0, q0_error=(0.01, -0.02, 0.015))
FINE = IntegratorSettings(max_step=0.001)


def leg_with(**mechanics):
    hip, *others = LEG_B.segments
    return replace(
        LEG_B, segments=(replace(hip, mechanics=replace(hip.mechanics, **mechanics)), *others)
    )


SPRUNG = leg_with(spring_stiffness=0.01, equilibrium_position=0.3, damping=1e-3, rotor_inertia=1e-5)
STOP = HardStop(stiffness=1.0, damping=0.0, transition_width=0.01)
CASES = {
    "a push": HexabotLegConfig(disturbance=Disturbance(push=PUSH)),
    "a mass error": HexabotLegConfig(disturbance=Disturbance(mass_error=HEAVY)),
    "a torque limit": HexabotLegConfig(disturbance=Disturbance(torque_limit=WEAK)),
    "all of them": HexabotLegConfig(disturbance=ALL, gravity=3.0),
    "a correction": HexabotLegConfig(disturbance=STRONG, control=CORRECTED),
    "springs and dampers": HexabotLegConfig(robot=SPRUNG, disturbance=ALL),
    "an ellipse": EllipseConfig(disturbance=ALL),
    "a SCARA": ScaraConfig(disturbance=STRONG, control=CORRECTED),
}


def diagram_of(config):
    build = {EllipseConfig: ellipse, ScaraConfig: scara}.get(type(config), hexabot_leg).build
    return build(config)


def commanded_position(config, time):
    """What a drift correction integrates, (3,): the foot, or a SCARA's x, y and yaw."""
    start = config.foot if isinstance(config, HexabotLegConfig) else at_task(config)
    return start + config.motion.displacement(np.array([time]))[0]


def at_task(config):
    x, y, _ = tool_position(config.geometry, [*config.q0, 0.0])
    return np.array([x, y, sum(config.q0)])


class Drawn:
    """The diagram, evaluated where the equation is."""

    def __init__(self, config):
        self.diagram = diagram_of(config)
        self.context = self.diagram.CreateDefaultContext()
        systems = self.diagram.GetSystems()
        (self.plant,) = (each for each in systems if isinstance(each, MultibodyPlant))
        self.integrators = [each for each in systems if isinstance(each, Integrator)]
        self.corrections = [each for each in systems if isinstance(each, DriftCorrection)]
        self.config = config
        self.motion = self.diagram.GetSubsystemByName(MOTION)

    def rates_and_torques(self, time, prescribed, q, v):
        self.context.SetTime(time)
        self.plant.SetPositionsAndVelocities(self._of(self.plant), np.concatenate([q, v]))
        for integrator, position in zip(self.integrators, prescribed, strict=False):
            self._of(integrator).SetContinuousState([position])
        for block in self.corrections:
            self._of(block).SetContinuousState(commanded_position(self.config, time))
        qdot = [
            block.EvalTimeDerivatives(self._of(block)).CopyToVector()[0]
            for block in self.integrators
        ]
        vdot = self.plant.get_generalized_acceleration_output_port().Eval(self._of(self.plant))
        asked = self.motion.GetOutputPort("torque").Eval(self._of(self.motion))
        return qdot, vdot, asked

    def _of(self, system):
        return system.GetMyMutableContextFromRoot(self.context)


@pytest.mark.parametrize("name", CASES)
def test_the_equation_is_that_of_the_diagram(name, rng):
    config = CASES[name]
    joints, drawn = DisturbedJoints(config), Drawn(config)
    n = len(joints.start) // 3
    for time in (0.05, 0.13, 0.17):
        x = joints.start + 0.05 * rng.standard_normal(3 * n)
        if isinstance(config, ScaraConfig):
            x[n - 1] = config.lift  # its command is a constant
        qdot, vdot, asked = drawn.rates_and_torques(time, *joints.parts(x))
        for joint in range(n):
            joints.put(joint, 0.0)  # from one state at random to another
            joints.put(joint, joints.next_sides(asked)[joint])
        rates = joints.rates(time, x)
        assert rates[: len(qdot)] == pytest.approx(qdot, rel=1e-12)
        np.testing.assert_allclose(rates[2 * n :], vdot, rtol=1e-10, atol=1e-10)
        driven = joints.driven(time, x)
        np.testing.assert_allclose(driven.vdot, vdot, rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(driven.asked, asked, rtol=1e-12, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a push", "a mass error", "a correction", "a SCARA"])
def test_steps_by_error_lead_where_short_steps_lead(name):
    config = CASES[name]
    run, settings = follow_disturbed(config, 0.5)
    drawn = simulate(diagram_of(config), 0.5, settings=FINE)
    assert settings.scheme == "dop853"
    assert set(run.scopes) == set(drawn.scopes)
    assert len(run.time) < len(drawn.time) / 5
    for scope, atol in (("foot positions", 1e-8), ("joint torques", 1e-5)):
        assert run.scopes[scope][-1] == pytest.approx(drawn.scopes[scope][-1], abs=atol)
        assert run.scopes[scope].shape[1] == drawn.scopes[scope].shape[1]


def test_there_is_a_row_where_a_torque_reaches_its_limit():
    run, _ = follow_disturbed(CASES["a torque limit"], 1.5)
    asked, given = run.scopes["torques asked for"], run.scopes["joint torques"]
    assert np.abs(given).max() == WEAK
    cut = (np.abs(asked) > WEAK + 1e-9).any(axis=1)
    first = int(np.argmax(cut))
    assert 0 < first < len(cut)
    assert np.abs(asked[first - 1]).max() == pytest.approx(WEAK, abs=1e-9)


def test_weak_joints_stop_at_a_singularity():
    run, _ = follow_disturbed(CASES["a torque limit"], 2.0)
    assert isinstance(run.stopped_by, SingularConfigurationError)
    assert run.stopped_at == pytest.approx(1.82723917, abs=1e-8)  # with accuracy 1e-11
    assert len(run.time) < 200
    assert abs(run.scopes["joint positions"][-1, 2]) < 1e-4  # stretched


@pytest.mark.slow
def test_a_guarded_simulation_stops_there_too():
    config = CASES["a torque limit"]
    drawn = simulate(diagram_of(config), 2.0, max_step=0.002)
    run, _ = follow_disturbed(config, 2.0)
    assert run.stopped_at == pytest.approx(drawn.stopped_at, abs=1e-7)
    assert isinstance(drawn.stopped_by, SingularConfigurationError)


@pytest.mark.parametrize(
    "changes",
    [
        {"filter_time_constant": 0.01},
        {"feedback": "integrated"},
        {"control": Control(inverse=Inverse(method="damped"), correction=5.0)},
        {"robot": leg_with(upper=3.0, upper_stop=STOP)},
        {"robot": leg_with(lower=1.55)},
    ],
    ids=str,
)
def test_what_is_not_smooth_is_left_to_the_diagram(changes):
    config = replace(CASES["a push"], **changes)
    assert follow_disturbed(config, 0.3) is None


def test_an_interrupt_keeps_what_was_recorded():
    def progress(time):
        if time > 0.1:
            raise KeyboardInterrupt

    run, _ = follow_disturbed(CASES["a push"], 1.0, progress)
    assert run.stop_reason == "interrupted"
    assert 0.1 < run.stopped_at == run.time[-1] < 0.2
    assert len(run.scopes["joint torques"]) == len(run.time)


def test_undisturbed_joints_stay_on_their_motion():
    config = HexabotLegConfig(disturbance=replace(UNDISTURBED, stiffness=2500.0))
    run, _ = follow_disturbed(config, 1.0)
    exact = config.foot + config.motion.displacement(run.time)
    assert np.abs(run.scopes["foot positions"] - exact).max() < 1e-9


def test_joints_beyond_a_singularity_are_lost():
    joints = DisturbedJoints(CASES["a push"])
    x = joints.start.copy()
    x[5] = 0.1  # the knee, bent the other way
    with pytest.raises(SingularConfigurationError):
        joints.time_left(x)
