"""Contact by Drake's law: against its equation, Drake's own plants, and the blocks' law."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import FORCES, GRAVITY, LAW, dynamics, falling, run, sensed, wired
from pydrake.geometry import (
    AddContactMaterial,
    Ellipsoid,
    HalfSpace,
    ProximityProperties,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.framework import DiagramBuilder
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError
from drake_leg.models.log import quiet_drake

FRICTION = {"CoefficientOfStaticFriction": "0.4", "CoefficientOfDynamicFriction": "0.3"}
BRICK = {"BrickDimensions": "[0.2 0.3 0.1]"}
WEIGHT = 1000.0 * 0.2 * 0.3 * 0.1 * GRAVITY  # of that brick


@pytest.mark.slow
def test_a_ball_bounces_as_hunt_and_crossley_say(tmp_path):
    built = falling(0.15)
    system = dynamics(built, tmp_path, contact="drake")
    mass = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3

    def rate(_, state):
        z, v = state
        depth = max(0.1 - z, 0.0)
        return [v, 1e4 * depth * max(0.0, 1.0 - 30.0 / (1e4 * 1e-3) * v) / mass - GRAVITY]

    exact = solve_ivp(rate, (0, 0.25), [0.15, 0.0], method="LSODA", rtol=1e-11, atol=1e-12)
    context = run(system, 0.25)
    state = system.GetOutputPort("state").Eval(context)
    np.testing.assert_allclose(state[[6, 12]], exact.y[:, -1], atol=2e-6)
    assert sensed(system, context, built, "Contact rconn:2") == pytest.approx(state[6] - 0.1)


@pytest.mark.parametrize(
    ("solid", "texts", "shape", "mass"),
    [
        (
            "Spherical Solid", {"SphereRadius": "0.1"}, Sphere(0.1),
            SpatialInertia.SolidSphereWithDensity(1000.0, 0.1),
        ),
        (
            "Ellipsoidal Solid", {"EllipsoidRadii": "[0.1 0.2 0.15]"},
            Ellipsoid(0.1, 0.2, 0.15),
            SpatialInertia.SolidEllipsoidWithDensity(1000.0, 0.1, 0.2, 0.15),
        ),
    ],
)  # fmt: skip
def test_a_body_is_pushed_as_in_a_plant_of_drakes(tmp_path, solid, texts, shape, mass):
    built = falling(0.09, solid=solid, texts=texts).set("Contact", **FRICTION)
    system = dynamics(built, tmp_path, contact="drake")
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    material = ProximityProperties()
    AddContactMaterial(3.0, 2e4, CoulombFriction(0.4, 0.3), material)
    body = plant.AddRigidBody("Body", mass)
    with quiet_drake():
        for where, what in ((plant.world_body(), HalfSpace()), (body, shape)):
            plant.RegisterCollisionGeometry(where, RigidTransform(), what, "it", material)
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
        plant.Finalize()
        plant.set_stiction_tolerance(1e-3)
        diagram = builder.Build()
    context = system.CreateDefaultContext()
    own = system.plant.GetMyMutableContextFromRoot(context)
    root = diagram.CreateDefaultContext()
    theirs = plant.GetMyMutableContextFromRoot(root)
    rng = np.random.default_rng(3)
    for _ in range(3):
        v = rng.uniform(-1.0, 1.0, 6)
        system.plant.SetVelocities(own, v)
        plant.SetPositions(theirs, system.plant.GetPositions(own))
        plant.SetVelocities(theirs, v)
        ours = system.EvalTimeDerivatives(context).CopyToVector()[7:]
        np.testing.assert_allclose(
            ours, diagram.EvalTimeDerivatives(root).CopyToVector()[7:], atol=1e-9
        )


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["smooth", "drake"])
def test_a_sliding_brick_stops_after_the_way_that_friction_takes(tmp_path, contact):
    pushed = {"PxVelocityTargetSpecify": "on", "PxVelocityTargetValue": "0.5"}
    built = falling(0.05 - WEIGHT / 4 / 1e4, solid="Brick Solid", texts=BRICK, **pushed)
    built.set("Contact", CoefficientOfStaticFriction="0.3", CoefficientOfDynamicFriction="0.3")
    system = dynamics(built, tmp_path, contact=contact)
    context = run(system, 0.3, accuracy=1e-4)
    state = system.GetOutputPort("state").Eval(context)
    assert state[4] == pytest.approx(0.5**2 / 2 / 0.3 / GRAVITY, rel=5e-3)
    assert abs(state[10]) < 1e-3
    assert 0.05 - state[6] == pytest.approx(WEIGHT / 4 / 1e4, rel=0.01)  # as deep by both laws


def test_a_brick_rests_on_its_corners(tmp_path):
    built = falling(0.05 - WEIGHT / 4 / 1e4, solid="Brick Solid", texts=BRICK)
    system = dynamics(built, tmp_path, contact="drake")
    context = system.CreateDefaultContext()
    assert sensed(system, context, built, "Contact rconn:3") == pytest.approx(WEIGHT, rel=1e-9)
    np.testing.assert_allclose(system.EvalTimeDerivatives(context).CopyToVector(), 0.0, atol=1e-9)


def test_two_bricks_push_each_other_alike(tmp_path):
    built = MechanismBuilder()
    for name, height in (("Low", "0"), ("High", "0.09")):
        targets = {"PzPositionTargetSpecify": "on", "PzPositionTargetValue": height}
        built.joint("6-DOF", f"{name}_free", **targets)
        built.body("Brick Solid", name, ExportEntireGeometry="on", BrickDimensions="[0.1 0.1 0.1]")
        built.meet(f"{name}_free", name)
    built.add_library(FORCES + "Spatial Contact Force", "Contact", LAW)
    built.meet("World", "Low_free lconn:1", "High_free lconn:1")
    built.meet("Low lconn:1", "Contact lconn:1")
    built.meet("High lconn:1", "Contact")
    wired(built, "Contact", "rconn:3")
    system = dynamics(built, tmp_path, contact="drake")
    context = system.CreateDefaultContext()
    assert sensed(system, context, built, "Contact rconn:3") == pytest.approx(1e4 * 0.01, rel=1e-6)
    rates = system.EvalTimeDerivatives(context).CopyToVector()
    np.testing.assert_allclose(rates[-12:-6], -rates[-6:], atol=1e-9)
    assert rates[-1] > 50.0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"CoefficientOfStaticFriction": "0.2", "CoefficientOfDynamicFriction": "0.3"},
            "0.3 in mo",
        ),
        ({"NormalStiffness": "0"}, "stiffness is 0"),
    ],
)
def test_what_drakes_law_does_not_have_is_refused(tmp_path, change, said):
    with pytest.raises(InvalidValueError, match=f"'Contact' .*{said}"):
        dynamics(falling(0.15).set("Contact", **FRICTION | change), tmp_path, contact="drake")


def test_a_surface_that_drake_does_not_have_is_refused(tmp_path):
    built = falling(0.15, floor="Grid Surface")
    built.set("Floor", XGridVector="[-1 1]", YGridVector="[-1 1]", ZHeights="[0 0; 0 0]")
    with pytest.raises(InvalidValueError, match=r"'Contact' .* choose 'smooth' contact"):
        dynamics(built, tmp_path, contact="drake")
