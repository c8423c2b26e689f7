"""What the options say is what the diagram gets: one motion, a posture, a way of following it."""

import math

import pytest

from drake_leg.diagrams import ellipse, hexabot_leg, scara
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.motions import EllipticStep, SineStep
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.catalogue import RUNS, OwnRobot
from drake_leg.runs.configs import (
    control_of,
    ellipse_config,
    joint_values,
    leg_of,
    require_regular_start,
    scara_config,
    straight_config,
)
from drake_leg.runs.leg import run_robot
from drake_leg.runs.options import (
    EllipseOptions,
    LegAOptions,
    LegBOptions,
    ScaraOptions,
    StraightOptions,
)

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
    config = straight_config(leg_of(options), options)
    assert config.motion == STEP
    assert makes(hexabot_leg.build(config), "Sine Wave", STEP.wave)


def test_one_motion_goes_from_the_options_to_the_sines_of_the_ellipse():
    config = ellipse_config(EllipseOptions(**GIVEN, lift=0.02))
    assert config.motion == EllipticStep(
        amplitude=0.03, frequency=2.0, direction=(0.0, 1.0, 0.0), lift=0.02
    )
    diagram = ellipse.build(config)
    assert makes(diagram, "Sine Wave along", config.motion.wave)
    assert makes(diagram, "Sine Wave up", config.motion.rise)


def test_one_motion_goes_from_the_options_to_the_sine_of_the_scara():
    config = scara_config(ScaraOptions(**GIVEN))
    assert config.motion == STEP
    assert makes(scara.build(config), "Sine Wave", STEP.wave)


def test_a_robot_of_ones_own_goes_in_its_first_direction_unless_another_is_given():
    assert straight_config(LEG_B, StraightOptions(q0=[90, -50, -90])).motion.direction == (1, 0, 0)
    given = StraightOptions(q0=[90, -50, -90], direction=[0.0, 0.0, -2.0])
    assert straight_config(LEG_B, given).motion.direction == (0, 0, -1)


def test_the_defaults_of_the_configs_are_those_of_the_options():
    straight = straight_config(LEG_B, LegBOptions())
    default = hexabot_leg.HexabotLegConfig()
    assert (straight.q0, straight.motion) == (default.q0, default.motion)
    assert ellipse_config(EllipseOptions()).motion == ellipse.EllipseConfig().motion
    of_scara, default = scara_config(ScaraOptions()), scara.ScaraConfig()
    assert (of_scara.q0, of_scara.motion) == (default.q0, default.motion)


def test_the_options_know_the_leg():
    assert leg_of(LegAOptions()).name == "leg_a"
    assert leg_of(LegBOptions()).name == "leg_b"
    assert leg_of(EllipseOptions()).name == "leg_b"


def test_an_own_robot_is_run_as_the_leg_is():
    kind = OwnRobot(title="Mine", own=LEG_B)
    assert kind.heading == "Mine: the step"
    assert kind.options is StraightOptions
    options = LegBOptions(duration=0.1)
    assert kind.robot(options) is LEG_B
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
    config = straight_config(LEG_B, StraightOptions())
    with pytest.raises(SingularConfigurationError, match=r"default start .* choose one with `q0`"):
        require_regular_start(config)
    with pytest.raises(SingularConfigurationError, match=r"default start .* choose one with `q0`"):
        run_robot(LEG_B, StraightOptions())
    require_regular_start(straight_config(LEG_B, StraightOptions(inverse="damped")))
