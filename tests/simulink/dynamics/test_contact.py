"""Contact: against hand-written equations, closed forms, Newton's third law, and Drake's shapes."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import FORCES, GRAVITY, LAW, dynamics, falling, run, sensed, wired, with_gravity
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import Cylinder as DrakeCylinder
from pydrake.geometry import (
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    ProximityProperties,
    SceneGraph,
    Sphere,
)
from pydrake.math import RigidTransform
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics import shapes
from drake_leg.simulink.dynamics.contact import ContactLaw
from drake_leg.simulink.dynamics.shapes import Ball, Barrel, Box, Ground, Hull, Plane, Rim


@pytest.mark.slow
def test_a_ball_bounces_as_its_equation_says(tmp_path):
    built = falling(0.15)
    system = dynamics(built, tmp_path)
    mass = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3

    def rate(_, state):
        z, v = state
        depth = max(0.1 - z, 0.0)
        s = min(depth / 1e-3, 1.0)
        force = s * s * (3 - 2 * s) * max(0.0, 1e4 * depth - 30 * v)
        return [v, force / mass - GRAVITY]

    exact = solve_ivp(rate, (0, 0.25), [0.15, 0.0], method="LSODA", rtol=1e-11, atol=1e-12)
    assert exact.y[0].min() < 0.1 - 1e-3
    context = run(system, 0.25)
    state = system.GetOutputPort("state").Eval(context)
    np.testing.assert_allclose(state[[6, 12]], exact.y[:, -1], atol=2e-6)
    assert sensed(system, context, built, "Contact rconn:2") == pytest.approx(state[6] - 0.1)


@pytest.mark.slow
def test_a_sliding_ball_ends_rolling_with_five_sevenths_of_its_speed(tmp_path):
    depth = 41.0792 / 1e4
    more = {"PxVelocityTargetSpecify": "on", "PxVelocityTargetValue": "0.7"}
    system = dynamics(falling(0.1 - depth, **more), tmp_path)
    context = run(system, 0.12, accuracy=1e-5)
    state = system.GetOutputPort("state").Eval(context)
    radius = 0.1 - depth / 2  # about where the floor pushes
    inertia = 0.4 * 0.1**2
    rolling = 0.7 * radius**2 / (radius**2 + inertia)
    assert state[10] == pytest.approx(rolling, rel=5e-3)
    assert state[8] * radius == pytest.approx(state[10], rel=5e-3)


def test_a_brick_rests_on_its_corners(tmp_path):
    texts = {"BrickDimensions": "[0.2 0.3 0.1]"}
    weight = 1000.0 * 0.2 * 0.3 * 0.1 * GRAVITY
    built = falling(0.05 - weight / 4 / 1e4, solid="Brick Solid", texts=texts)
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    assert sensed(system, context, built, "Contact rconn:3") == pytest.approx(weight, rel=1e-9)
    np.testing.assert_allclose(system.EvalTimeDerivatives(context).CopyToVector(), 0.0, atol=1e-9)


def test_two_balls_push_each_other_alike(tmp_path):
    built = MechanismBuilder()
    for name, x in (("A", 0.0), ("B", 0.15)):
        texts = {"PxPositionTargetSpecify": "on", "PxPositionTargetValue": str(x)}
        built.joint("6-DOF", f"J{name}", **texts, PyVelocityTargetSpecify="on",
                    PyVelocityTargetValue=str(x))  # fmt: skip
        built.body("Spherical Solid", name, SphereRadius="0.1", ExportEntireGeometry="on")
        built.meet(f"J{name}", name)
    built.add_library(FORCES + "Spatial Contact Force", "Contact", LAW)
    built.meet("World", "JA lconn:1", "JB lconn:1")
    built.meet("A lconn:1", "Contact lconn:1")
    built.meet("B lconn:1", "Contact")
    wired(built, "Contact", "rconn:3")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    rates = system.EvalTimeDerivatives(context).CopyToVector()[14:].reshape(2, 6)
    mass = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3
    assert rates[1, 3] * mass == pytest.approx(1e4 * 0.05)
    np.testing.assert_allclose(rates[0, 3:], -rates[1, 3:])
    assert rates[1, 4] < 0.0  # rubs off what the two slide past each other
    assert sensed(system, context, built, "Contact rconn:3") == pytest.approx(1e4 * 0.05)


def drakes_distances(shape, points):
    """Return what Drake says of the same shape."""
    scene = SceneGraph()
    source = scene.RegisterSource("test")
    frame = scene.RegisterFrame(source, GeometryFrame("frame"))
    instance = GeometryInstance(RigidTransform(), shape, "shape")
    instance.set_proximity_properties(ProximityProperties())
    scene.RegisterGeometry(source, frame, instance)
    context = scene.CreateDefaultContext()
    poses = FramePoseVector()
    poses.set_value(frame, RigidTransform())
    scene.get_source_pose_port(source).FixValue(context, poses)
    query = scene.get_query_output_port().Eval(context)
    found = [query.ComputeSignedDistanceToPoint(point)[0] for point in points]
    return np.array([f.distance for f in found]), np.array([f.grad_W for f in found])


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (Box(half=np.array([0.1, 0.2, 0.3])), DrakeBox(0.2, 0.4, 0.6)),
        (Barrel(rim=0.2, half=0.15), DrakeCylinder(0.2, 0.3)),
        (Ball(radii=np.full(3, 0.2)), Sphere(0.2)),
        (Hull(Box(half=np.array([0.1, 0.2, 0.3])).corners.points), DrakeBox(0.2, 0.4, 0.6)),
    ],
)
def test_distances_are_drakes(ours, theirs):
    points = np.random.default_rng(0).uniform(-0.4, 0.4, (60, 3))
    distances, normals = ours.signed(points)
    expected, gradients = drakes_distances(theirs, points)
    np.testing.assert_allclose(distances, expected, atol=1e-12)
    np.testing.assert_allclose(normals, gradients, atol=1e-9)


@pytest.mark.parametrize("surface", [Box(half=np.array([0.1, 0.2, 0.3])), Plane()])
def test_one_point_is_as_far_as_among_many(surface):
    points = np.random.default_rng(1).uniform(-0.4, 0.4, (200, 3))
    distances, normals = surface.signed(points)
    found = [surface.nearest(point.tolist()) for point in points]
    np.testing.assert_allclose([distance for distance, _ in found], distances, atol=1e-15)
    np.testing.assert_allclose([normal for _, normal in found], normals, atol=1e-15)


def test_forces_follow_velocities_where_positions_stay(tmp_path):
    """What is kept of the positions is not kept of the velocities."""
    built = falling(0.05)
    used = dynamics(built, tmp_path)
    context = used.CreateDefaultContext()
    start = context.get_continuous_state_vector().CopyToVector()
    rng = np.random.default_rng(2)
    for change in (0, 1, 7, 1, 0):  # from which entry on the state changes
        start[change:] += rng.normal(size=start.size - change) * 1e-3
        fresh = dynamics(built, tmp_path)
        rates = []
        for system, its in ((used, context), (fresh, fresh.CreateDefaultContext())):
            its.get_mutable_continuous_state_vector().SetFromVector(start)
            rates.append(system.EvalTimeDerivatives(its).CopyToVector())
        np.testing.assert_array_equal(*rates)
    assert rates[0][12] > 10.0 * GRAVITY  # the floor pushes


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_points_that_may_be_nearest_to_a_hull_are_found_by_its_planes(radius, monkeypatch):
    rng = np.random.default_rng(1)
    hull = Hull(rng.normal(size=(12, 3)))
    points = rng.normal(size=(200, 3), loc=(4.0, 0.0, 0.0))
    distances, normals = hull.signed(points)
    places = hull.candidates(points, radius)
    assert {int(distances.argmin()), *np.flatnonzero(distances < radius).tolist()} <= {*places}
    assert len(places) < len(points) / 2
    assert len(hull.candidates(points * math.nan, radius)) == len(points)
    monkeypatch.setattr(shapes, "PAIRS", 7)
    np.testing.assert_array_equal(hull.candidates(points, radius), places)
    for found, expected in zip(hull.signed(points), (distances, normals), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_an_ellipsoid_and_a_hilly_ground_are_exact_to_first_order():
    ball = Ball(radii=np.array([0.1, 0.2, 0.4]))
    at = ball.toward(np.array([[1.0, 2.0, -1.0]]))
    distance, normal = ball.signed(at)
    assert distance == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(normal[0], np.array([1.0, 2.0, -1.0]) / math.sqrt(6.0))
    beyond, _ = ball.signed(at + 1e-6 * normal)
    assert beyond == pytest.approx(1e-6, rel=1e-4)
    ground = Ground(np.array([0.0, 1.0]), np.array([0.0, 2.0]), np.array([[0.0, 2.0], [0.0, 2.0]]))
    distance, normal = ground.signed(np.array([[0.5, 1.0, 1.5], [2.0, 0.0, 0.0]]))
    assert distance[0] == pytest.approx(0.5 / math.sqrt(2.0))
    np.testing.assert_allclose(normal[0], np.array([0.0, -1.0, 1.0]) / math.sqrt(2.0))
    assert distance[1] > 1e6


@pytest.mark.parametrize("gap", [0.02, -0.01])
@pytest.mark.parametrize(
    ("solid", "texts"),
    [
        ("Cylindrical Solid", {"CylinderRadius": "0.2", "CylinderLength": "0.3"}),
        ("Ellipsoidal Solid", {"EllipsoidRadii": "[0.2 0.1 0.15]"}),
    ],
)
def test_a_wheel_beside_the_middle_of_a_wide_brick_touches_its_face(solid, texts, gap, tmp_path):
    """Not on the way to the brick's center."""
    built = MechanismBuilder()
    place = {"Px": 0.05 + 0.2 + gap, "Py": 0.7, "Pz": -0.5}
    targets = {f"{axis}PositionTargetSpecify": "on" for axis in place}
    targets |= {f"{axis}PositionTargetValue": str(value) for axis, value in place.items()}
    built.joint("6-DOF", "Free", **targets)
    built.body(solid, "Wheel", ExportEntireGeometry="on", **texts)
    built.body("Brick Solid", "Wall", BrickDimensions="[0.1 2 2]", ExportEntireGeometry="on")
    built.add_library(FORCES + "Spatial Contact Force", "Contact", LAW)
    built.meet("World", "Free lconn:1", "Wall")
    built.meet("Free", "Wheel")
    built.meet("Wall lconn:1", "Contact lconn:1")
    built.meet("Wheel lconn:1", "Contact")
    wired(built, "Contact", "rconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    assert sensed(system, context, built, "Contact rconn:2") == pytest.approx(gap, abs=1e-12)


def test_corners_of_a_cylinder_are_its_deepest_points():
    barrel = Barrel(rim=0.2, half=0.3)
    lying = barrel.toward(np.array([[0.0, -1.0, 0.0]] * 2))
    assert lying[:, 1].min() == pytest.approx(-0.2)
    assert (lying[:, 1] < -0.1).sum() == 2
    rim = Rim(rim=0.2).toward(np.array([[0.0, -1.0, 0.3]]))
    assert rim[:, 1].min() == pytest.approx(-0.2)
    assert not rim[:, 2].any()
    standing = barrel.toward(np.array([[0.0, 0.0, -1.0]] * 2))
    assert (standing[:, 2] == -0.3).sum() == 4


def test_the_law_rises_smoothly_and_pulls_only_where_asked():
    law = ContactLaw(stiffness=1e4, damping=1e3, width=1e-3, static=0.5, dynamic=0.3, critical=1e-2)
    assert law.normal(2e-3, 0.0) == pytest.approx(20.0)
    assert law.normal(5e-4, 0.0) == pytest.approx(0.5 * 5.0)
    assert law.normal(2e-3, -1.0) == 0.0
    pulls = ContactLaw(stiffness=1e4, damping=1e3, width=1e-3, pulls=True)
    assert pulls.normal(2e-3, -1.0) == pytest.approx(20.0 - 1e3)
    speeds = np.linspace(0.0, 3e-2, 3001)
    friction = np.array([law.friction(speed) for speed in speeds])
    assert friction[0] == 0.0
    assert friction.max() == pytest.approx(0.5)
    assert speeds[friction.argmax()] == pytest.approx(1e-2)
    assert friction[-1] == pytest.approx(0.3)
    assert np.abs(np.diff(friction, 2)).max() < 1e-4  # without a corner


def test_what_cannot_touch_is_refused_by_name(tmp_path):
    built = falling(0.15)
    built.set("Contact", FrictionType="Viscous", NormalTransitionRegionWidth="0")
    with pytest.raises(InvalidValueError, match=r"'Contact' .* FrictionType"):
        dynamics(built, tmp_path)


def test_a_contact_without_a_geometry_is_left_out(tmp_path):
    built = with_gravity(MechanismBuilder())
    built.joint("6-DOF", "Free")
    built.body("Spherical Solid", "Body", SphereRadius="0.1", ExportEntireGeometry="on")
    built.add_library(FORCES + "Spatial Contact Force", "Contact", LAW)
    built.meet("World", "Free lconn:1")
    built.meet("Free", "Body")
    built.meet("Body lconn:1", "Contact")
    assert dynamics(built, tmp_path).left_out == {"Spatial Contact Force": ("Contact",)}
