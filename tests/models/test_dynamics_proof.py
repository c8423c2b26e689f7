"""Torques of random motions: SymPy's Newton-Euler equations against Drake's inverse dynamics."""

from dataclasses import replace

import pytest
from trees import hexapod, two_fingers

from drake_leg import LEG_B, SCARA, prove
from drake_leg.models.plant import build_plant
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.solids import Inertial

ON_A_WALL = ((0, 0, 1, 0.1), (1, 0, 0, 0.2), (0, 1, 0, 0.3), (0, 0, 0, 1))
ROBOTS = (LEG_B, SCARA, two_fingers(), hexapod(), replace(LEG_B, base_pose=ON_A_WALL))


def of_torques(robot):
    (found,) = [c for c in prove(robot, samples=4).comparisons if c.quantity == "torques"]
    return found


@pytest.mark.parametrize(
    "robot",
    [
        pytest.param(robot, marks=pytest.mark.slow) if robot.name == "hexapod" else robot
        for robot in ROBOTS
    ],
    ids=Robot.__repr__,
)
def test_torques_agree(robot):
    assert of_torques(robot).difference < 1e-14


def test_products_of_inertia_dampers_and_springs_make_no_difference():
    body = Inertial(
        mass=2.0, centre=(0.1, -0.2, 0.3), moments=(0.3, 0.4, 0.5), products=(0.05, -0.06, 0.07)
    )
    joint = JointMechanics(damping=0.4, spring_stiffness=3.0, equilibrium_position=0.2)
    row = Row(joint="revolute", d=0.2, alpha=0.7, r=-0.1)
    first = Segment(row=row, joint="a", link=Link(name="first", inertial=body), mechanics=joint)
    second = replace(first, joint="b", link=Link(name="second", inertial=body))
    robot = Robot(name="odd", title="Odd", source="test", segments=(first, second))
    assert of_torques(robot).difference < 1e-14


def test_rotors_and_dry_friction_are_in_the_proof(monkeypatch):
    segments = tuple(
        replace(one, mechanics=JointMechanics(rotor_inertia=0.2 + k, dry_friction=0.3, damping=0.1))
        if one.joint and one.row.joint != "fixed"
        else one
        for k, one in enumerate(LEG_B.segments)
    )
    robot = replace(LEG_B, segments=segments)
    assert of_torques(robot).difference < 1e-14
    plant = build_plant(robot)
    assert plant.CalcMassMatrix(plant.CreateDefaultContext())[2, 2] > 2.2
    monkeypatch.setattr(
        "drake_leg.models.plant.sdf_text",
        lambda robot: sdf_text(robot).replace("rotor_inertia>1.2<", "rotor_inertia>1.3<"),
    )
    assert not of_torques(robot).agrees


def test_a_robot_without_mass_has_no_torques():
    bare = tuple(
        replace(one, link=one.link and replace(one.link, solid=None)) for one in LEG_B.segments
    )
    proof = prove(replace(LEG_B, segments=bare), samples=2)
    assert "torques" not in {c.quantity for c in proof.comparisons}


def test_a_mass_that_is_lost_on_the_way_to_drake_is_found(monkeypatch):
    monkeypatch.setattr(
        "drake_leg.models.plant.sdf_text",
        lambda robot: sdf_text(robot).replace("<mass>0.004</mass>", "<mass>0.0041</mass>"),
    )
    assert "<mass>0.004</mass>" in sdf_text(LEG_B)
    assert not of_torques(LEG_B).agrees
