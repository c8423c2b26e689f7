"""What the options say is what the diagram gets: one motion, a posture, a way of following it."""

import dataclasses
import math

import pytest

from drake_leg.diagrams import ellipse, hexabot_leg, scara
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.motions import EllipticStep, SineStep
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.runs.catalogue import RUNS, run_kind
from drake_leg.runs.options import (
    EllipseOptions,
    LegAOptions,
    LegBOptions,
    OwnOptions,
    ScaraOptions,
    StraightOptions,
)
from drake_leg.runs.step import config_of, control_of, joint_values, require_regular_start
from drake_leg.runs.step import run as run_robot

STEP = SineStep(amplitude=0.03, frequency=2.0, direction=(0.0, 1.0, 0.0))
GIVEN = {"amplitude": 0.03, "frequency": 2.0, "direction": [0.0, 3.0, 0.0]}


def makes(diagram, name, wave):
    """Whether a Sine block's output is a wave, at an instant."""
    sine = diagram.GetSubsystemByName(name)
    context = sine.CreateDefaultContext()
    context.SetTime(0.7)
    speed = wave.amplitude * math.sin(0.7 * wave.frequency + wave.phase)
    return sine.GetOutputPort("y0").Eval(context) == pytest.approx([speed], rel=1e-12)


def test_one_motion_goes_from_the_options_to_the_sine_of_the_step():
    options = LegBOptions(**GIVEN)
    assert options.motion() == STEP
    config = config_of(options.robot(), options)
    assert config.motion == STEP
    assert makes(hexabot_leg.build(config), "Sine Wave", STEP.wave)


def test_one_motion_goes_from_the_options_to_the_sines_of_the_ellipse():
    options = EllipseOptions(**GIVEN, lift=0.02)
    config = config_of(options.robot(), options)
    assert config.motion == EllipticStep(
        amplitude=0.03, frequency=2.0, direction=(0.0, 1.0, 0.0), lift=0.02
    )
    diagram = ellipse.build(config)
    assert makes(diagram, "Sine Wave along", config.motion.wave)
    assert makes(diagram, "Sine Wave up", config.motion.rise)


def test_one_motion_goes_from_the_options_to_the_sine_of_the_scara():
    options = ScaraOptions(**GIVEN)
    config = config_of(options.robot(), options)
    assert config.motion == STEP
    assert makes(scara.build(config), "Sine Wave", STEP.wave)


def test_a_robot_of_ones_own_goes_in_its_first_direction_unless_another_is_given():
    assert config_of(LEG_B, StraightOptions(q0=[90, -50, -90])).motion.direction == (1, 0, 0)
    given = StraightOptions(q0=[90, -50, -90], direction=[0.0, 0.0, -2.0])
    assert config_of(LEG_B, given).motion.direction == (0, 0, -1)


def test_the_defaults_of_the_configs_are_those_of_the_options():
    straight = config_of(LEG_B, LegBOptions())
    default = hexabot_leg.HexabotLegConfig()
    assert (straight.q0, straight.motion) == (default.q0, default.motion)
    assert config_of(LEG_B, EllipseOptions()).motion == ellipse.EllipseConfig().motion
    of_scara, default = config_of(SCARA, ScaraOptions()), scara.ScaraConfig()
    assert (of_scara.q0, of_scara.motion) == (default.q0, default.motion)


def test_the_options_know_the_leg():
    assert LegAOptions().robot().name == "leg_a"
    assert LegBOptions().robot().name == "leg_b"
    assert EllipseOptions().robot().name == "leg_b"


def test_an_own_robot_is_run_as_the_leg_is():
    kind = run_kind(dataclasses.replace(LEG_B, title="Mine"))
    assert kind.heading == "Mine: the step"
    assert kind.options is OwnOptions
    options = LegBOptions(duration=0.1)
    assert kind.robot(options) is kind.own
    own, leg = kind.run(options), RUNS["leg-b"].run(options)
    assert own.recording["q1"].tolist() == leg.recording["q1"].tolist()


def test_joint_values_are_taken_to_si_or_refused():
    assert joint_values("q0", [90.0, 0.0, -180.0], LEG_B.moving) == [math.pi / 2, 0.0, -math.pi]
    with pytest.raises(InvalidValueError, match=r"q0 is \[1\.0\]; it must be 3 finite numbers"):
        joint_values("q0", [1.0], LEG_B.moving)


@pytest.mark.parametrize(("inverse", "gain"), [("exact", 0.0), ("damped", 5.0), ("limited", 5.0)])
def test_no_correction_said_is_not_a_correction_of_zero(inverse, gain):
    joints = LEG_B.moving
    assert control_of(LegBOptions(inverse=inverse), joints).correction == gain
    assert control_of(LegBOptions(inverse=inverse, correction=0.0), joints).correction == 0.0


def test_a_default_start_that_is_singular_is_refused_where_the_inverse_is_exact():
    config = config_of(LEG_B, StraightOptions())
    with pytest.raises(SingularConfigurationError, match=r"default start .* choose one with `q0`"):
        require_regular_start(config)
    with pytest.raises(SingularConfigurationError, match=r"default start .* choose one with `q0`"):
        run_robot(LEG_B, StraightOptions())
    require_regular_start(config_of(LEG_B, StraightOptions(inverse="damped")))
