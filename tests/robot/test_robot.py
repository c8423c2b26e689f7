"""The data of a robot checks itself."""

import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.solids import Brick, Cylinder, Inertial, Solid, Sphere
from drake_leg.units import LEAST, MOST, require_non_negative, require_positive

NOT_FINITE = (math.nan, math.inf, -math.inf)
BALL = Sphere(radius=0.01)


def brick(**changes):
    return Brick(**{"length": 0.3, "width": 0.2, "height": 0.1, **changes})


def cylinder(**changes):
    return Cylinder(**{"radius": 0.1, "length": 0.2, **changes})


def solid(**changes):
    fields = {"shape": BALL, "density": 1000.0, "centre": (0.0,) * 3, "colour": (0.0,) * 3}
    return Solid(**{**fields, **changes})


def turning(**changes):
    return Row(**{"joint": "revolute", **changes})


@pytest.mark.parametrize("value", [*NOT_FINITE, 0.0, -0.25])
@pytest.mark.parametrize(
    ("make", "field"),
    [
        (brick, "length"),
        (brick, "width"),
        (brick, "height"),
        (cylinder, "radius"),
        (cylinder, "length"),
        (Sphere, "radius"),
        (solid, "density"),
    ],
)
def test_a_size_that_is_not_positive_is_refused_by_name_and_value(make, field, value):
    with pytest.raises(InvalidValueError, match="positive") as refusal:
        make(**{field: value})
    assert field in str(refusal.value)
    assert repr(value) in str(refusal.value)


@pytest.mark.parametrize("value", [*NOT_FINITE, -1e-9])
@pytest.mark.parametrize("field", ["damping", "spring_stiffness"])
def test_negative_joint_mechanics_are_refused_by_name_and_value(field, value):
    with pytest.raises(InvalidValueError, match="zero or positive") as refusal:
        JointMechanics(**{field: value})
    assert field.replace("_", " ") in str(refusal.value)
    assert repr(value) in str(refusal.value)


@pytest.mark.parametrize("value", NOT_FINITE)
def test_a_spring_needs_a_finite_equilibrium(value):
    with pytest.raises(InvalidValueError, match=f"equilibrium position is {value!r}"):
        JointMechanics(equilibrium_position=value)


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("field", ["d", "alpha", "r", "theta"])
def test_a_row_needs_finite_numbers(field, value):
    with pytest.raises(InvalidValueError, match=f"row's {field} is {value!r}"):
        turning(**{field: value})


def test_a_row_needs_a_known_joint():
    with pytest.raises(InvalidValueError, match=r"'helical'.*revolute, prismatic or fixed"):
        turning(joint="helical")


@pytest.mark.parametrize(("joint", "sigma"), [("revolute", 0), ("prismatic", 1), ("fixed", None)])
def test_sigma_is_the_joint_type_of_the_reports(joint, sigma):
    assert Row(joint=joint).sigma == sigma


@pytest.mark.parametrize(
    ("parts", "named"),
    [({"joint": "hip"}, "'hip'"), ({"link": Link(name="coxa")}, "'coxa'")],
    ids=["joint without link", "link without joint"],
)
def test_a_joint_and_its_link_come_together(parts, named):
    with pytest.raises(InvalidValueError, match="both or none") as refusal:
        Segment(row=turning(), **parts)
    assert named in str(refusal.value)


@pytest.mark.parametrize("joint", ["revolute", "prismatic"])
def test_only_a_fixed_row_may_be_a_mere_frame(joint):
    with pytest.raises(InvalidValueError, match=f"row 5 of 'leg_b' is {joint} and has no link"):
        replace(LEG_B, segments=(*LEG_B.segments, Segment(row=Row(joint=joint))))
    assert Segment(row=Row(joint="fixed")).link is None


@pytest.mark.parametrize("value", [*NOT_FINITE, 0.0, -2.0])
def test_require_positive_names_quantity_value_and_unit(value):
    with pytest.raises(InvalidValueError, match=f"the girth is {value!r} ell"):
        require_positive("the girth", value, "ell")


@pytest.mark.parametrize("value", [*NOT_FINITE, -2.0])
def test_require_non_negative_names_quantity_value_and_unit(value):
    with pytest.raises(InvalidValueError, match=f"the girth is {value!r} ell"):
        require_non_negative("the girth", value, "ell")


def test_the_bounds_themselves_are_allowed():
    require_positive("the girth", LEAST, "ell")
    require_positive("the girth", MOST, "ell")
    require_non_negative("the girth", 0.0, "ell")
    assert JointMechanics(damping=0.0, spring_stiffness=0.0).equilibrium_position == 0.0


@pytest.mark.parametrize("value", [5e-324, LEAST / 2, MOST * 2, 1e300])
def test_what_no_robot_has_is_refused(value):
    for require in (require_positive, require_non_negative):
        with pytest.raises(InvalidValueError, match=r"the girth is .* it must be in"):
            require("the girth", value, "ell")


def test_an_invalid_value_is_both_this_packages_error_and_a_value_error():
    assert issubclass(InvalidValueError, DrakeLegError)
    assert issubclass(InvalidValueError, ValueError)


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_a_limit_is_finite_or_left_out(side, value):
    with pytest.raises(InvalidValueError, match=f"{side} limit is {value!r}"):
        JointMechanics(**{side: value})


@pytest.mark.parametrize("value", [*NOT_FINITE, 0.0, -2.0])
@pytest.mark.parametrize("limit", ["velocity", "effort"])
def test_limits_of_speed_and_effort_are_positive(limit, value):
    with pytest.raises(InvalidValueError, match=f"{limit} limit is {value!r}"):
        JointMechanics(**{limit: value})


@pytest.mark.parametrize("lower", [0.5, 0.75])
def test_limits_leave_room_to_move(lower):
    with pytest.raises(InvalidValueError, match=rf"lower limit is {lower} and the upper one 0\.5"):
        JointMechanics(lower=lower, upper=0.5)


def test_a_joint_without_actuator_has_no_effort():
    with pytest.raises(InvalidValueError, match=r"2\.5 N\*m at a joint that is not actuated"):
        JointMechanics(effort=2.5, actuated=False)


def test_a_fixed_row_has_no_mechanics():
    with pytest.raises(InvalidValueError, match="a fixed row has joint mechanics"):
        Segment(row=Row(joint="fixed"), mechanics=JointMechanics(damping=0.1))


def inertial(**changes):
    fields = {"mass": 1.0, "centre": (0.1, 0.2, 0.3), "moments": (3.0, 4.0, 5.0)}
    return Inertial(**{**fields, **changes})


@pytest.mark.parametrize("value", [*NOT_FINITE, 0.0, -1.0])
def test_a_mass_said_outright_is_positive(value):
    with pytest.raises(InvalidValueError, match=f"the mass is {value!r} kg"):
        inertial(mass=value)


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("field", ["centre", "moments", "products"])
def test_an_inertia_said_outright_is_finite(field, value):
    with pytest.raises(InvalidValueError, match=rf"field {field} .*{value}.*three finite numbers"):
        inertial(**{field: (1.0, value, 1.0)})


@pytest.mark.parametrize(
    ("parts", "named"),
    [
        ({"moments": (1.0, -0.5, 1.0)}, "moments -0.5, 1, 1 .*none of them can be negative"),
        ({"moments": (1.0, 1.0, 2.5)}, "moments 1, 1, 2.5 .*other two together"),
        ({"moments": (1.0, 1.0, 1.0), "products": (1.5, 0, 0)}, "moments -0.5, .*be negative"),
        ({"moments": (1.0, 1.0, 1.0), "products": (0.75, 0, 0)}, "0.25, 1, 1.75 .*together"),
    ],
    ids=["negative", "no triangle", "indefinite", "no triangle in its own axes"],
)
def test_an_inertia_that_no_body_has_is_refused_with_its_principal_moments(parts, named):
    with pytest.raises(InvalidValueError, match=named):
        inertial(**parts)


def test_principal_moments_are_those_of_the_turned_body(rng):
    R = Rotation.random(rng=rng).as_matrix()
    matrix = R @ np.diag([3.0, 4.0, 5.0]) @ R.T
    turned = inertial(
        moments=tuple(np.diag(matrix)), products=(matrix[0, 1], matrix[0, 2], matrix[1, 2])
    )
    assert turned.principal_moments() == pytest.approx((3.0, 4.0, 5.0))
    assert inertial(moments=(5.0, 3.0, 4.0)).principal_moments() == (3.0, 4.0, 5.0)
    inertial(moments=(1.0, 2.0, 3.0))  # a plate


def test_the_centre_of_mass_is_the_inertias_before_the_solids():
    ball = solid(centre=(1.0, 2.0, 3.0))
    assert Link(name="one", solid=ball).centre_of_mass == (1.0, 2.0, 3.0)
    assert Link(name="one", solid=ball, inertial=inertial()).centre_of_mass == (0.1, 0.2, 0.3)
    assert Link(name="one").centre_of_mass == (0.0, 0.0, 0.0)


def hinged(*names, robot="r"):
    segments = (Segment(row=turning(), joint=joint, link=Link(name=link)) for joint, link in names)
    return Robot(name=robot, title="R", source="here", segments=tuple(segments))


@pytest.mark.parametrize("name", ["", "a b", "1st", "left::leg", "world", "__own__", "a.b", "-a"])
def test_a_name_that_sdf_does_not_take_is_refused(name):
    for attempt in (
        lambda: hinged(("hip", "coxa"), robot=name),
        lambda: hinged((name, "coxa")),
        lambda: hinged(("hip", name)),
    ):
        with pytest.raises(InvalidValueError, match=r"(name|link|joint)") as refusal:
            attempt()
        assert repr(name) in str(refusal.value) or "is empty" in str(refusal.value)


@pytest.mark.parametrize(
    "pairs",
    [
        [("hip", "coxa"), ("hip", "femur")],
        [("hip", "coxa"), ("knee", "coxa")],
        [("hip", "hip")],
        [("hip", "base")],
        [("base_weld", "coxa")],
        [("frame_1", "coxa")],
        [("hip", "coxa"), ("coxa_cog", "femur")],
    ],
    ids=str,
)
def test_a_name_that_is_given_twice_is_refused(pairs):
    with pytest.raises(InvalidValueError, match=r"the name '\w+' is given twice"):
        hinged(*pairs)


def test_a_robot_moves():
    with pytest.raises(InvalidValueError, match="'r' has no row that moves"):
        Robot(name="r", title="R", source="here", segments=(Segment(row=Row(joint="fixed")),))


def test_rows_and_moving_segments_keep_the_order_of_the_table():
    hinge = Segment(row=turning(), joint="a", link=Link(name="one"))
    mere = Segment(row=Row(joint="fixed", d=1.0))
    slide = Segment(row=Row(joint="prismatic"), joint="b", link=Link(name="two"))
    robot = Robot(name="r", title="R", source="here", segments=(hinge, mere, slide))
    assert robot.rows == (hinge.row, mere.row, slide.row)
    assert robot.moving == (hinge, slide)


def test_a_robots_data_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        brick().length = 1.0
