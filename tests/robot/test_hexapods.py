import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.walking.margins import support_margin
from drake_leg.robot.hexapods import HEXABOT, HEXAPODS, HIPS, PHANTOMX, PHANTOMX_HIPS, Hip, hexapod
from drake_leg.robot.joint_mechanics import JointMechanics, starting_posture
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.solids import Inertial, mass_properties
from drake_leg.units import STANDARD_GRAVITY

POINT = Inertial(mass=1.0, centre=(0.0, 0.0, 0.0), moments=(1.0, 1.0, 1.0))


def test_the_hexabot_is_one_table_of_six_legs_of_report_b():
    assert len(HEXABOT.rows) == 24
    assert list(HEXABOT.tips) == [f"{leg}_foot" for leg in HIPS]
    for first in range(0, 24, 4):
        for own, reports in zip(HEXABOT.rows[first + 1 : first + 4], LEG_B.rows[1:], strict=True):
            assert (own.joint, own.d, own.alpha) == (reports.joint, reports.d, reports.alpha)


def test_hips_are_where_they_are_asked_for_and_legs_point_along_their_yaw():
    X_B = base_transforms(HEXABOT.rows, np.zeros(18))
    for hip, X in zip(HIPS.values(), X_B[::4], strict=True):
        assert X[:3, 3] == pytest.approx([hip.x, hip.y, 0.0], abs=1e-15)
        assert X[:3, 0] == pytest.approx([math.cos(hip.yaw), math.sin(hip.yaw), 0.0], abs=1e-15)
    raised = base_transforms(HEXABOT.rows, np.tile([0.0, 0.3, 0.0], 6))
    assert (raised[3::4, 2, 3] > 0.05).all()


def test_it_weighs_what_its_parts_weigh():
    links = [HEXABOT.base_link, *(segment.link for segment in HEXABOT.segments)]
    masses = [mass_properties(link.solid).mass for link in links]
    assert sum(masses) == pytest.approx(2.16, abs=0.01)


def test_wrong_numbers_are_refused():
    with pytest.raises(InvalidValueError, match=r"length of the femur is -0\.1 m"):
        hexapod(lengths=(0.05, -0.1, 0.1))
    with pytest.raises(InvalidValueError, match="must be three finite numbers"):
        hexapod(lengths=(0.05, 0.1))
    with pytest.raises(InvalidValueError, match=r"the hip a is \(1, 2\); it must be a Hip"):
        hexapod(hips={"a": (1, 2)})
    with pytest.raises(InvalidValueError, match="the height is nan"):
        hexapod(height=math.nan)
    with pytest.raises(InvalidValueError, match="there is no hip"):
        hexapod(hips={})
    with pytest.raises(InvalidValueError, match="yaw of the hip nose is nan"):
        hexapod(hips={"nose": Hip(0.1, 0.0, math.nan)})
    with pytest.raises(InvalidValueError, match=r"mass of the tibia is -0\.1 kg"):
        hexapod(link_masses=(0.1, 0.1, -0.1))
    with pytest.raises(InvalidValueError, match="inertial of 'head'; it must be one of body, coxa"):
        hexapod(inertials={"head": POINT})
    with pytest.raises(InvalidValueError, match=r"moments 0\.00114, 0\.00514, 0\.00819 kg"):
        Inertial(mass=0.02436, centre=(0.0, 0.0, 0.0), moments=(0.00514, 0.00819, 0.00114))
    with pytest.raises(InvalidValueError, match="the inertial of coxa is 3"):
        hexapod(inertials={"coxa": 3})
    with pytest.raises(InvalidValueError, match="mechanics of a leg are 2; there must be three"):
        hexapod(mechanics=[JointMechanics()] * 2)
    stiff = JointMechanics(lower=-1.0, upper=1.0)
    with pytest.raises(
        InvalidValueError, match=r"the ankle turns to -108\.587 deg; its limits are"
    ):
        hexapod(mechanics=(stiff, stiff, stiff))


def test_it_stands_on_its_feet_at_the_start():
    X_B = base_transforms(HEXABOT.rows, starting_posture(HEXABOT))
    feet = X_B[3::4, :3, 3]
    assert feet[:, 2] == pytest.approx([-0.085] * 6, abs=1e-15)
    for hip, foot in zip(HIPS.values(), feet, strict=True):
        assert math.hypot(foot[0] - hip.x, foot[1] - hip.y) == pytest.approx(0.130, abs=1e-15)
    assert HEXABOT.base_pose[2][3] == 0.085
    with pytest.raises(InvalidValueError, match=r"0\.3 m below its hip .* between 0 and 0\.2 m"):
        hexapod(height=0.3)


@pytest.mark.parametrize("robot", HEXAPODS, ids=lambda robot: robot.name)
def test_the_ball_of_a_foot_ends_at_the_frame_that_stands(robot):
    feet = [segment.link for segment in robot.segments if segment.row.joint == "fixed"]
    assert len(feet) == 6
    for foot in feet:
        assert foot.solid.centre == (-foot.solid.shape.radius, 0.0, 0.0)


# --- the PhantomX, by its published frames ----------------------------------------------------


def about(axis, angle):
    """Rotation matrix (3, 3) about y or z by an angle [deg]."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return np.array(
        {"y": [[c, 0, s], [0, 1, 0], [-s, 0, c]], "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis]
    )


# Of each link: mass [kg], center [m], and xx, xy, xz, yy, yz, zz of its inertia [kg*m^2].
PUBLISHED = {
    "body": (1.522054, (0.001522, 0.000302, 0.015345),
             (4.466e-3, 7.6888e-6, -1.245e-4, 8.489e-3, 5.0996e-6, 9.202e-3)),
    "coxa": (0.02471, (0.019066, -0.000002, 0.006577),
             (2.154e-5, -1.22e-9, -1.92741e-6, 2.657e-5, -1e-11, 2.925e-5)),
    "femur": (0.085834, (0.020226, -0.00029, -0.00063),
              (2.887e-5, 2.419e-7, 4.8494e-6, 7.502e-5, 3e-10, 8.672e-5)),
    "tibia": (0.171825, (0.036797, 0.000054, -0.011991),
              (1.762e-4, -1.4522e-6, 1.789e-4, 5.158e-4, 6.181e-7, 3.768e-4)),
}  # fmt: skip


def published_leg(angles, hip):
    """Pose (R, p) of coxa, femur and tibia on the body, and place of the foot.

    The angles are the published ones, of coxa, femur and tibia [deg].
    """
    coxa, femur, tibia = angles
    R1 = about("z", math.degrees(hip.yaw) + coxa)
    p1 = np.array([hip.x, hip.y, 0.0])
    R2, p2 = R1 @ about("y", femur), p1 + R1 @ [0.052907539, 0.0, 0.0]
    R3, p3 = R2 @ about("y", tibia), p2 + R2 @ [0.060, 0.0, -0.015]
    return ((R1, p1), (R2, p2), (R3, p3)), p3 + R3 @ [0.095, 0.0, -0.090]


def moved(mass, centre, inertia, R, p):
    """Mass, first moment and inertia about the body's origin, of a body at a pose."""
    xx, xy, xz, yy, yz, zz = inertia
    at = p + R @ centre
    turned = R @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ R.T
    return mass, mass * at, turned + mass * (at @ at * np.eye(3) - np.outer(at, at))


def own_link(link):
    """Mass, center and inertia of a link of the table, as those that are published."""
    if link.inertial:
        body = link.inertial
        (xx, yy, zz), (xy, xz, yz) = body.moments, body.products
        return body.mass, body.centre, (xx, xy, xz, yy, yz, zz)
    body = mass_properties(link.solid)
    xx, yy, zz = body.moments
    return body.mass, link.solid.centre, (xx, 0.0, 0.0, yy, 0.0, zz)


def total(parts):
    return [sum(part[index] for part in parts) for index in range(3)]


ZEROS = (0.0, math.degrees(math.atan2(15, 60)), math.degrees(math.atan2(90, 95)))


def in_this_table(angles):
    """Published angles of coxa, femur and tibia [deg] as those of hip, knee and ankle [rad]."""
    coxa, femur, tibia = angles
    return np.radians([coxa, -femur - ZEROS[1], -tibia - ZEROS[2] + ZEROS[1]])


def test_the_phantomx_is_the_published_robot_in_other_axes(rng):
    hips = list(PHANTOMX_HIPS.values())
    for _ in range(5):
        angles = rng.uniform([-55, -98, -45], [55, 90, 125], (6, 3))
        X_B = base_transforms(PHANTOMX.rows, np.concatenate([in_this_table(a) for a in angles]))
        theirs = [moved(*PUBLISHED["body"], np.eye(3), np.zeros(3))]
        for leg, (one, hip) in enumerate(zip(angles, hips, strict=True)):
            poses, foot = published_leg(one, hip)
            assert X_B[4 * leg + 3][:3, 3] == pytest.approx(foot, abs=1e-15)
            theirs += [
                moved(*PUBLISHED[part], *pose)
                for part, pose in zip(("coxa", "femur", "tibia"), poses, strict=True)
            ]
        ours = [moved(*own_link(PHANTOMX.base_link), np.eye(3), np.zeros(3))] + [
            moved(*own_link(segment.link), X[:3, :3], X[:3, 3])
            for segment, X in zip(PHANTOMX.segments, X_B, strict=True)
        ]
        for own, published in zip(total(ours), total(theirs), strict=True):
            np.testing.assert_allclose(own, published, rtol=0.0, atol=1e-14)


def test_the_phantomx_weighs_and_turns_as_published():
    assert sum(own_link(link)[0] for link in links_of(PHANTOMX)) == pytest.approx(3.216268)
    low, high = zip(*(segment.mechanics.bounds for segment in PHANTOMX.moving[:3]), strict=True)
    assert low == pytest.approx(in_this_table((-55, 90, 125)))
    assert high == pytest.approx(in_this_table((55, -98, -45)))


def links_of(robot):
    return [robot.base_link, *(segment.link for segment in robot.segments)]


def test_the_phantomx_stands_at_its_published_home():
    X_B = base_transforms(PHANTOMX.rows, starting_posture(PHANTOMX))
    for hip, X in zip(PHANTOMX_HIPS.values(), X_B[3::4], strict=True):
        _, asleep = published_leg((0, -90, 90), hip)
        assert X[:3, 3] == pytest.approx([*asleep[:2], -0.083], abs=1e-15)


@pytest.mark.parametrize("three", [(0, 2, 4), (1, 3, 5)])
def test_on_three_feet_the_phantomx_needs_most_torque_in_the_knee_that_is_alone(three):
    """Statics by hand: the weight on three feet by their moments, the torque by lever arms."""
    X_B = base_transforms(PHANTOMX.rows, starting_posture(PHANTOMX))
    feet = X_B[3::4][list(three)][:, :3, 3]
    parts = [
        moved(*own_link(segment.link), X[:3, :3], X[:3, 3])
        for segment, X in zip(PHANTOMX.segments, X_B, strict=True)
    ]
    mass, first, _ = total([moved(*own_link(PHANTOMX.base_link), np.eye(3), np.zeros(3)), *parts])
    centre = first / mass
    g = STANDARD_GRAVITY
    weights = np.linalg.solve(
        [np.ones(3), feet[:, 0], feet[:, 1]], mass * g * np.array([1.0, *centre[:2]])
    )
    torques = []
    for leg, weight in zip(three, weights, strict=True):
        knee, out = X_B[4 * leg + 1][:3, 3], X_B[4 * leg][:3, 0]
        lifted = sum(g * (p - m * knee) @ out for m, p, _ in parts[4 * leg + 1 : 4 * leg + 4])
        torques.append(weight * (X_B[4 * leg + 3][:3, 3] - knee) @ out - lifted)
    assert max(torques) == pytest.approx(1.26, abs=0.002)
    assert support_margin(feet[:, :2], centre[:2]) == pytest.approx(0.1246, abs=2e-4)
