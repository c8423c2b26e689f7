"""What SDF says of a robot of one's own: limits, explicit masses, any title."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.solids import Inertial, Solid, Sphere

BALL = Solid(shape=Sphere(radius=0.05), density=1e3, centre=(0.1, 0.0, 0.0), colour=(1.0, 0.0, 0.0))


def one_link(*, kind="revolute", title="Arm", link=None, **mechanics):
    link = link or Link(name="link", solid=BALL)
    segment = Segment(
        row=Row(joint=kind), joint="joint", link=link, mechanics=JointMechanics(**mechanics)
    )
    return Robot(name="arm", title=title, source="test", segments=(segment,))


def limits_of(robot):
    plant = MultibodyPlant(1e-3)  # position limits act on discrete plants only
    parser = Parser(plant)
    parser.SetStrictParsing()
    parser.AddModelsFromString(sdf_text(robot), "sdf")
    plant.Finalize()
    return plant, plant.GetJointByName("joint")


def test_drake_reads_every_limit():
    robot = one_link(lower=-1.0, upper=2.0, velocity=3.0, effort=4.0)
    plant, joint = limits_of(robot)
    assert joint.position_lower_limits() == [-1.0]
    assert joint.position_upper_limits() == [2.0]
    assert joint.velocity_upper_limits() == [3.0]
    assert plant.GetEffortUpperLimits() == [4.0]


def test_a_limit_on_one_side_leaves_the_other_open():
    _, joint = limits_of(one_link(kind="prismatic", upper=0.5))
    assert joint.position_lower_limits() == [-math.inf]
    assert joint.position_upper_limits() == [0.5]


def test_a_joint_that_is_not_actuated_may_have_limits():
    plant, joint = limits_of(one_link(lower=-1.0, actuated=False))
    assert plant.num_actuators() == 0
    assert joint.position_lower_limits() == [-1.0]


def test_without_limits_the_sdf_has_none():
    assert "<limit>" not in sdf_text(one_link())


@pytest.mark.parametrize(
    ("mechanics", "said"),
    [
        ({"lower": 1.0, "upper": 1.0}, "lower limit is 1"),
        ({"lower": 2.0, "upper": 1.0}, "lower limit is 2 and the upper one 1"),
        ({"lower": math.nan}, "lower limit is nan"),
        ({"upper": math.inf}, "upper limit is inf"),
        ({"velocity": 0.0}, "velocity limit"),
        ({"effort": -1.0}, "effort limit"),
        ({"effort": 1.0, "actuated": False}, "not actuated"),
    ],
)
def test_limits_that_make_no_sense_are_refused(mechanics, said):
    with pytest.raises(InvalidValueError, match=said):
        JointMechanics(**mechanics)


def test_a_fixed_row_takes_no_mechanics():
    with pytest.raises(InvalidValueError, match="fixed row"):
        Segment(
            row=Row(joint="fixed"), joint="weld", link=Link(name="link"),
            mechanics=JointMechanics(damping=1.0),
        )  # fmt: skip


def test_drake_reads_an_explicit_inertia():
    body = Inertial(
        mass=2.0, centre=(0.1, 0.2, 0.3), moments=(0.2, 0.3, 0.4), products=(0.01, 0.02, 0.03)
    )
    plant, _ = limits_of(one_link(link=Link(name="link", solid=BALL, inertial=body)))
    found = plant.GetBodyByName("link").default_spatial_inertia()
    about_centre = found.Shift(body.centre).CalcRotationalInertia().CopyToFullMatrix3()
    np.testing.assert_allclose(found.get_com(), body.centre, atol=1e-15)
    np.testing.assert_allclose(
        about_centre,
        [[0.2, 0.01, 0.02], [0.01, 0.3, 0.03], [0.02, 0.03, 0.4]],
        atol=1e-15,
    )
    cog = plant.GetFrameByName("link_cog").CalcPoseInBodyFrame(plant.CreateDefaultContext())
    np.testing.assert_allclose(cog.translation(), body.centre, atol=1e-15)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ({"mass": 0.0}, "mass"),
        ({"mass": -1.0}, "mass"),
        ({"mass": math.nan}, "mass"),
        ({"moments": (1.0, 1.0, 2.1)}, "at most the other two together"),
        ({"moments": (-0.1, 1.0, 1.0)}, "none of them can be negative"),
        ({"moments": (1.0, 1.0, math.inf)}, "must be three finite numbers"),
        ({"products": (1.5, 0.0, 0.0)}, "none of them can be negative"),
        ({"centre": (math.nan, 0.0, 0.0)}, "must be three finite numbers"),
    ],
)
def test_an_inertia_that_no_body_has_is_refused(body, said):
    right = {"mass": 1.0, "centre": (0.0, 0.0, 0.0), "moments": (1.0, 1.0, 1.0)}
    with pytest.raises(InvalidValueError, match=said):
        Inertial(**{**right, **body})


PARTS = st.floats(1e-3, 1e3)


@pytest.mark.slow
@given(x=PARTS, y=PARTS, z=st.just(0.0) | PARTS, turn=st.floats(-3.0, 3.0))
def test_drake_takes_every_inertia_that_is_taken_here_even_a_plates(x, y, z, turn):
    """Moments y+z, x+z, x+y are any body's; with z = 0 a plate's, on the triangle's edge."""
    c, s = math.cos(turn), math.sin(turn)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    matrix = R @ np.diag([y + z, x + z, x + y]) @ R.T
    try:
        body = Inertial(
            mass=1.0,
            centre=(0.0, 0.0, 0.0),
            moments=tuple(np.diag(matrix).tolist()),
            products=(float(matrix[0, 1]), 0.0, 0.0),
        )
    except InvalidValueError:
        assert z < 1e-6 * max(x, y)  # a plate, or nearly one, with products of inertia
        return
    build_plant(one_link(link=Link(name="link", inertial=body)))


@pytest.mark.parametrize("title", ["a -- b", "--", "a---", "<&>", "θ — “x”", "]]>", "-"])
def test_any_title_makes_xml(title):
    text = sdf_text(one_link(title=title), origin="my--arm.toml")
    assert ET.fromstring(text).find("model").get("name") == "arm"
    build_plant(one_link(title=title))


def test_the_document_says_what_it_is_generated_from():
    assert "Generated from arm.toml." in sdf_text(one_link(), origin="arm.toml")


def test_what_is_smaller_than_any_part_is_written_as_nothing():
    faint = Solid(
        shape=Sphere(radius=0.05), density=1e3, centre=(1e-310, 0.0, 0.0), colour=(1e-200, 0.0, 1.0)
    )
    build_plant(one_link(link=Link(name="link", solid=faint, end=(0.0, 5e-324, 0.0))))
