"""What disturbs a diagram, and what it is wired to."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, Saturation

from drake_leg.diagrams import hexabot_leg, scara
from drake_leg.diagrams.disturbance import (
    FIRM,
    PUSH,
    TORQUE_LIMIT,
    UNDISTURBED,
    Disturbance,
    is_disturbed,
)
from drake_leg.diagrams.mechanism import MOTION, add_mechanism
from drake_leg.diagrams.wiring import wires
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import Push
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.robot.solids import Inertial
from drake_leg.systems.prescribed_motion import STIFFNESS

LEG = hexabot_leg.HexabotLegConfig(robot=LEG_B, q0=(1.0, -0.8, -1.5))
GENTLE = Push(force=(0.0, 0.0, 0.1), at=1.0, lasting=0.1)


def leg(**changes):
    return hexabot_leg.build(replace(LEG, disturbance=Disturbance(**changes)))


def targets(diagram, source):
    return [(wire.target, wire.input) for wire in wires(diagram) if wire.source == source]


def test_the_torque_goes_through_the_limit_to_the_plant():
    diagram = leg(torque_limit=0.01)
    assert (TORQUE_LIMIT, "u0") in targets(diagram, MOTION)
    assert ("leg_b", "actuation") in targets(diagram, TORQUE_LIMIT)
    assert isinstance(diagram.GetSubsystemByName(TORQUE_LIMIT), Saturation)
    assert ("joint torques", "data") in targets(diagram, TORQUE_LIMIT)
    assert ("torques asked for", "data") in targets(diagram, MOTION)


def test_the_push_goes_to_the_plant():
    assert targets(leg(push=GENTLE), PUSH) == [("leg_b", "applied_spatial_force")]
    config = scara.ScaraConfig(robot=SCARA, disturbance=Disturbance(push=GENTLE))
    assert targets(scara.build(config), PUSH) == [("scara", "applied_spatial_force")]


@pytest.mark.parametrize(
    ("changes", "disturbed"),
    [
        ({}, False),
        ({"stiffness": 100.0}, False),
        ({"push": GENTLE}, True),
        ({"mass_error": 0.1}, True),
        ({"torque_limit": 1.0}, True),
    ],
    ids=str,
)
def test_a_diagram_is_known_to_be_disturbed(changes, disturbed):
    assert Disturbance(**changes).acts is disturbed
    assert is_disturbed(leg(**changes)) is disturbed


def test_a_saturation_that_limits_no_torque_disturbs_nothing():
    builder = DiagramBuilder()
    signal = builder.AddNamedSystem("signal", ConstantVectorSource([2.0]))
    saturation = builder.AddNamedSystem("Saturation", Saturation([-1.0], [1.0]))
    builder.Connect(signal.get_output_port(), saturation.get_input_port())
    add_mechanism(builder, LEG_B, gravity=9.80665)
    assert not is_disturbed(builder.Build())


def test_the_pull_is_firm_where_something_disturbs():
    assert UNDISTURBED.pull == STIFFNESS
    assert Disturbance(mass_error=0.1).pull == FIRM
    assert Disturbance(mass_error=0.1, stiffness=9.0).pull == 9.0


@pytest.mark.parametrize("error", [0.2, -0.3])
def test_all_masses_and_inertias_are_believed_larger_in_the_same_measure(error, rng):
    foot = LEG_B.segments[3]
    said = Inertial(mass=0.01, centre=(0.0, 0.0, 0.0), moments=(2e-6, 2e-6, 1e-6))
    link = replace(foot.link, inertial=said)
    robot = replace(LEG_B, segments=(*LEG_B.segments[:3], replace(foot, link=link)))
    believed = build_plant(Disturbance(mass_error=error).believed(robot), gravity=9.0)
    plant = build_plant(robot, gravity=9.0)
    q = rng.uniform(-3.0, 3.0, 3)
    M, gravity = [], []
    for model in (plant, believed):
        context = model.CreateDefaultContext()
        model.SetPositions(context, q)
        M.append(model.CalcMassMatrix(context))
        gravity.append(model.CalcGravityGeneralizedForces(context))
    np.testing.assert_allclose(M[1], (1.0 + error) * M[0], rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(gravity[1], (1.0 + error) * gravity[0], rtol=1e-12, atol=1e-15)
    assert Disturbance().believed(robot) is robot


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"mass_error": -1.0}, "-1.0"),
        ({"mass_error": math.nan}, "nan"),
        ({"mass_error": math.inf}, "inf"),
        ({"torque_limit": 0.0}, "torque limit"),
        ({"torque_limit": math.nan}, "torque limit"),
        ({"stiffness": -1.0}, "stiffness"),
        ({"stiffness": math.inf}, "stiffness"),
    ],
    ids=str,
)
def test_senseless_disturbances_are_refused(change, named):
    with pytest.raises(InvalidValueError, match=named):
        Disturbance(**change)


def test_a_mass_out_of_all_measure_is_refused():
    with pytest.raises(InvalidValueError):
        leg(mass_error=1e300)
