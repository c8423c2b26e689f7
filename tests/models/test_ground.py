"""The ground in Drake is the ground as data: where it is, and how it holds a foot."""

import math

import numpy as np
import pytest
from pydrake.geometry import AddContactMaterial, Box, ProximityProperties, Role, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_leg.models.ground import SEEN, add_ground
from drake_leg.robot.ground import FLAT, Blocks, Ground, Steps

GROUNDS = {
    "flat": FLAT,
    "stairs on a slope": Ground(slope=0.2, across=0.1, steps=Steps(height=-0.02, count=3)),
    "blocks": Ground(across=-0.3, blocks=Blocks(height=0.04, rows=8, columns=9, start=0.0)),
}


def material(friction):
    properties = ProximityProperties()
    AddContactMaterial(None, 1e8, CoulombFriction(friction, friction), properties)
    return properties


def on(ground, *, mass=None):
    """A plant of the ground, and perhaps of a point foot, and its diagram."""
    builder = DiagramBuilder()
    plant, scene = AddMultibodyPlantSceneGraph(builder, time_step=0.005)
    add_ground(plant, ground, material(ground.friction))
    if mass:
        inertia = SpatialInertia(mass, np.zeros(3), UnitInertia.SolidSphere(0.01))
        foot = plant.AddRigidBody("foot", inertia)
        plant.RegisterCollisionGeometry(
            foot, RigidTransform(), Sphere(0.0), "point", material(ground.friction)
        )
    plant.set_sap_near_rigid_threshold(0.01)
    plant.Finalize()
    return builder.Build(), plant, scene


@pytest.mark.parametrize("ground", GROUNDS.values(), ids=GROUNDS)
def test_the_surface_is_at_the_height_that_the_data_say(ground, rng):
    diagram, _, scene = on(ground)
    context = scene.GetMyContextFromRoot(diagram.CreateDefaultContext())
    query = scene.get_query_output_port().Eval(context)
    x, y = rng.uniform(-0.5, 1.0, 40), rng.uniform(-0.4, 0.4, 40)
    surface = np.stack([x, y, ground.height(x, y), np.ones(40)], axis=-1) @ np.array(ground.X_WG).T
    normal = np.array(ground.X_WG)[:3, 2]
    for point in surface[:, :3]:
        above, below = (
            min(d.distance for d in query.ComputeSignedDistanceToPoint(point + side * normal))
            for side in (1e-7, -1e-7)
        )
        assert below < 0.0 < above


@pytest.mark.parametrize(("slope", "slides"), [(0.61, False), (0.73, True)])
def test_a_foot_slides_down_a_slope_that_is_steeper_than_its_friction(slope, slides):
    """With a friction of 0.8 it holds up to an angle of atan(0.8) = 0.675."""
    ground = Ground(slope=slope, friction=0.8)
    diagram, plant, _ = on(ground, mass=0.4)
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    down, speeds = -np.array(ground.X_WG)[:3, 0], []
    for time in (0.1, 0.3):
        simulator.AdvanceTo(time)
        speeds.append(plant.GetVelocities(context)[-3:] @ down)
    pull = 9.81 * (math.sin(slope) - 0.8 * math.cos(slope))
    assert speeds[0] < 1e-3 or slides
    assert (speeds[1] - speeds[0]) / 0.2 == pytest.approx(pull if slides else 0.0, abs=1e-4)


FIELD = Blocks(height=0.03, rows=8, columns=9, start=-0.2)


@pytest.mark.parametrize(
    ("ground", "begin", "push"),
    [
        (Ground(friction=0.1, steps=Steps(height=0.03, start=0.1)), 0.01, (3.0, 0.0)),
        (Ground(friction=0.1, steps=Steps(height=-0.03, start=-0.1)), 0.01, (-3.0, 0.0)),
        (Ground(friction=0.1, blocks=FIELD), 0.01, (3.0, 0.0)),
        (Ground(friction=0.1, blocks=FIELD), -0.15, (0.0, 3.0)),
    ],
    ids=("stairs up", "stairs down", "blocks along x", "blocks along y"),
)
def test_a_foot_that_is_pressed_against_a_face_stays_on_the_ground(ground, begin, push):
    diagram, plant, _ = on(ground, mass=3.0)
    plant.mutable_gravity_field().set_gravity_vector(np.array([*push, -9.81]))
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    foot, begins = plant.GetBodyByName("foot"), (begin, 0.02)
    plant.SetFreeBodyPose(context, foot, RigidTransform([*begins, ground.height(*begins)]))
    simulator.AdvanceTo(0.6)
    x, y, z = foot.EvalPoseInWorld(context).translation()
    ahead = np.sign(push)
    low, high = (ground.height(x + s * ahead[0], y + s * ahead[1]) for s in (-1e-3, 1e-3))
    assert high > low  # it is at a face
    assert z == pytest.approx(low, abs=1e-3)


def test_it_is_drawn_near_its_origin_and_carries_far():
    for ground in GROUNDS.values():
        _, _, scene = on(ground)
        inspector = scene.model_inspector()

        def widest(role, inspector=inspector):
            shapes = (inspector.GetShape(one) for one in inspector.GetAllGeometryIds(role))
            return max(max(box.size()) for box in shapes if isinstance(box, Box))

        assert widest(Role.kProximity) > 90.0
        assert widest(Role.kIllustration) <= 2 * SEEN
