"""Blocks named after a robot, and blocks that have that name already."""

from dataclasses import replace

import pytest

from drake_leg.diagrams import ellipse, hexabot_leg, pendulum, scara
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robots import LEG_B, PENDULUM, SCARA

POSTURE = (1.0, -0.8, -1.5)


@pytest.mark.parametrize("name", ["Demux", "input", "Q", "dy", "inverseJacobian"])
def test_a_robot_called_like_a_block_is_refused_and_does_not_end_the_process(name):
    config = hexabot_leg.HexabotLegConfig(robot=replace(LEG_B, name=name), q0=POSTURE)
    with pytest.raises(InvalidValueError, match=f"'{name}' is the name of the robot and"):
        hexabot_leg.build(config)


def test_every_diagram_is_built_so():
    for build, config in (
        (ellipse.build, ellipse.EllipseConfig(robot=replace(LEG_B, name="Mux"), q0=POSTURE)),
        (scara.build, scara.ScaraConfig(robot=replace(SCARA, name="Lift"))),
        (pendulum.build, pendulum.PendulumConfig(robot=replace(PENDULUM, name="energy"))),
    ):
        with pytest.raises(InvalidValueError, match="give the robot another name"):
            build(config)


def test_a_name_of_its_own_is_kept():
    config = hexabot_leg.HexabotLegConfig(robot=replace(LEG_B, name="hexabot"), q0=POSTURE)
    assert hexabot_leg.build(config).HasSubsystemNamed("hexabot")
