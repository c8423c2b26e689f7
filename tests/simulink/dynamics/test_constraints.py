"""Constraints between frames: against joints that hold the same, closed forms, and energy."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import CURVES, GRAVITY, dynamics, energy, run, with_gravity
from pydrake.systems.framework import Context
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.curves import Curve
from drake_leg.simulink.dynamics.wrenches import Wrenches

CONSTRAINTS = "sm_lib/Constraints/"


def target(axis, value, priority="High"):
    return {
        f"{axis}PositionTargetSpecify": "on",
        f"{axis}PositionTargetValue": str(value),
        f"{axis}PositionTargetPriority": priority,
    }


def held(joint, kind, texts, *, place=None, body="Brick Solid", **targets):
    """A body at a joint from the world, which a constraint holds, too."""
    built = with_gravity(MechanismBuilder())
    built.transform("Place", **(place or {}))
    built.joint(joint, "Free", **targets)
    built.transform("Off", offset="[0.1 0.2 0.3]")
    built.body(body, "Body", BrickDimensions="[0.1 0.2 0.3]")
    built.add_library(CONSTRAINTS + kind, "Held", texts)
    built.meet("World", "Place lconn:1", "Free lconn:1")
    built.meet("Place", "Held lconn:1")
    built.meet("Free", "Off lconn:1", "Held")
    built.meet("Off", "Body")
    return built


def between(kind, texts):
    """Two free bodies, which a constraint holds together."""
    built = with_gravity(MechanismBuilder())
    built.transform("Tilt", axis="+X", angle="35")
    for name, place, at in (("One", -0.4, "World"), ("Other", 0.5, "Tilt")):
        built.joint("6-DOF", f"{name}_free", **target("Px", place), **target("Py", 0.3, "Low"))
        built.body("Brick Solid", name, BrickDimensions="[0.1 0.2 0.3]")
        built.transform(f"{name}_end", offset="[0.1 0.2 0.3]")
        built.meet(f"{name}_free", name, f"{name}_end lconn:1")
        built.meet(at, f"{name}_free lconn:1", *(["Tilt lconn:1"] if at == "World" else []))
    built.add_library(CONSTRAINTS + kind, "Held", texts)
    built.meet("One_end", "Held lconn:1")
    built.meet("Other_end", "Held")
    return built


def on_curve(points, ends, joint="6-DOF", **targets):
    """A ball whose center is on a curve of the world."""
    built = with_gravity(MechanismBuilder())
    built.joint(joint, "Free", **targets)
    built.body("Spherical Solid", "Body", SphereRadius="0.01")
    texts = {"DataPoints": np.array2string(np.asarray(points), threshold=10**6, precision=17,
             floatmode="unique").replace("\n", ";"), "EndConditionType": ends}  # fmt: skip
    built.add_library(CURVES + "Spline", "Way", texts)
    built.add_library(CONSTRAINTS + "Point on Curve Constraint", "Held")
    built.meet("World", "Free lconn:1", "Way lconn:1")
    built.meet("Free", "Body", "Held")
    built.meet("Way", "Held lconn:1")
    return built


def moving(system, seed=0):
    """Return a context in motion that the constraints allow, and what holds them."""
    context = system.CreateDefaultContext()
    acting = system._acting
    plant = system.plant
    own = plant.GetMyMutableContextFromRoot(context)
    acting.moment.move_to(plant.GetPositionsAndVelocities(own))
    J = np.vstack([each.jacobian(acting.moment) for each in acting.constraints])
    v = np.random.default_rng(seed).uniform(-1.0, 1.0, plant.num_velocities())
    plant.SetVelocities(own, v - np.linalg.pinv(J) @ J @ v)
    return context


KEPT = [
    ("Distance Constraint", {"Distance": "1", "DistanceUnits": "m"}, 1),
    ("Angle Constraint", {"Type": "General", "Angle": "50", "AngleUnits": "deg"}, 1),
    ("Angle Constraint", {"Type": "Perpendicular"}, 1),
    ("Angle Constraint", {"Type": "Parallel"}, 2),
    ("Angle Constraint", {"Type": "Anti-Parallel"}, 2),
]
AT = {**target("Px", 0.7), **target("Py", 0.3, "Low")}
HELIX = [(math.cos(t), math.sin(t), 0.3 * t) for t in np.linspace(0.0, 4.0, 12)]


def rigs():
    for kind, texts, rows in KEPT:
        name = f"{kind} {texts.get('Type', '')}"
        yield pytest.param(between(kind, texts), rows, id=name)
    yield pytest.param(on_curve(HELIX, "Natural", **AT), 2, id="Point on Curve Constraint")


@pytest.mark.parametrize(("built", "rows"), [*rigs()])
def test_accelerations_keep_constraints_and_power(tmp_path, built, rows):
    system = dynamics(built, tmp_path)
    (constraint,) = system._acting.constraints
    assert len(constraint) == rows
    context: Context = moving(system)
    plant, moment = system.plant, system._acting.moment
    own = plant.GetMyMutableContextFromRoot(context)
    q, v = plant.GetPositions(own), plant.GetVelocities(own)
    vdot = system.EvalTimeDerivatives(context).CopyToVector()[len(q) :]

    def along(step):
        """Take a step of the motion, of order two; return the gap and the energy there."""
        middle = plant.CreateDefaultContext()
        plant.SetPositions(middle, q)
        half = q + step / 2.0 * plant.MapVelocityToQDot(middle, v + step / 4.0 * vdot)
        plant.SetPositions(middle, half)
        after = q + step * plant.MapVelocityToQDot(middle, v + step / 2.0 * vdot)
        for first in range(0, len(after), 7):  # of a quaternion
            after[first : first + 4] /= np.linalg.norm(after[first : first + 4])
        plant.SetPositions(middle, after)
        plant.SetVelocities(middle, v + step * vdot)
        moment.move_to(plant.GetPositionsAndVelocities(middle))
        rate = constraint.jacobian(moment) @ moment.v
        total = plant.CalcKineticEnergy(middle) + plant.CalcPotentialEnergy(middle)
        return constraint.gap(moment), rate, total

    (before, slow, low), (after, fast, high) = along(-1e-4), along(1e-4)
    np.testing.assert_allclose(along(0.0)[0], 0.0, atol=1e-11)
    np.testing.assert_allclose((after - before) / 2e-4, 0.0, atol=1e-6)
    np.testing.assert_allclose((fast - slow) / 2e-4, 0.0, atol=1e-5)
    assert (high - low) / 2e-4 == pytest.approx(0.0, abs=1e-5 * max(abs(high), 1.0))


@pytest.mark.parametrize(("built", "rows"), [*rigs()])
def test_wrenches_of_constraints_do_the_work_of_their_rows(tmp_path, built, rows):
    system = dynamics(built, tmp_path)
    moving(system)
    (constraint,), moment = system._acting.constraints, system._acting.moment
    multipliers, wrenches = np.random.default_rng(5).normal(size=rows), Wrenches()
    constraint.act(moment, multipliers, wrenches)
    expected = multipliers @ constraint.jacobian(moment)
    np.testing.assert_allclose(moment.generalized(wrenches.by_body), expected, atol=1e-12)


def test_a_ball_at_a_distance_is_a_pendulum(tmp_path):
    built = with_gravity(MechanismBuilder())
    angle, rate = 1.0, 2.0
    speed = {"PxVelocityTargetSpecify": "on", "PxVelocityTargetValue": str(rate * math.cos(angle))}
    built.joint(
        "6-DOF", "Free", **target("Px", math.sin(angle)), **target("Pz", -math.cos(angle)), **speed
    )
    built.body("Spherical Solid", "Body", SphereRadius="0.1")
    built.add_library(CONSTRAINTS + "Distance Constraint", "Rod", {"Distance": "1"})
    built.meet("World", "Free lconn:1", "Rod lconn:1")
    built.meet("Free", "Body", "Rod")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    state = system.GetOutputPort("state").Eval(context)
    np.testing.assert_allclose(state[10:13], rate * np.array([math.cos(1), 0, math.sin(1)]))
    along, across = (
        np.array([math.cos(1), 0, math.sin(1)]),
        np.array([-math.sin(1), 0, math.cos(1)]),
    )
    expected = -GRAVITY * math.sin(angle) * along + rate**2 * across
    np.testing.assert_allclose(
        system.EvalTimeDerivatives(context).CopyToVector()[10:13], expected, atol=1e-12
    )


@pytest.mark.slow
def test_a_ball_at_a_distance_swings_as_a_pendulum_and_keeps_its_energy(tmp_path):
    built = with_gravity(MechanismBuilder())
    built.joint("6-DOF", "Free", **target("Px", 1.0))
    built.body("Spherical Solid", "Body", SphereRadius="0.1")
    built.add_library(CONSTRAINTS + "Distance Constraint", "Rod", {"Distance": "1"})
    built.meet("World", "Free lconn:1", "Rod lconn:1")
    built.meet("Free", "Body", "Rod")
    system = dynamics(built, tmp_path)
    before = energy(system, system.CreateDefaultContext())
    context = run(system, 0.8, accuracy=1e-7)
    mass = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3
    assert energy(system, context) == pytest.approx(before, abs=1e-6 * mass * GRAVITY)
    exact = solve_ivp(
        lambda _, y: [y[1], -GRAVITY * math.sin(y[0])], (0, 0.8), [math.pi / 2, 0.0],
        rtol=1e-11, atol=1e-12,
    )  # fmt: skip
    angle = exact.y[0, -1]
    place = system.GetOutputPort("state").Eval(context)[4:7]
    np.testing.assert_allclose(place, [math.sin(angle), 0.0, -math.cos(angle)], atol=1e-6)


def test_a_ball_joint_with_parallel_axes_is_a_revolute_joint(tmp_path):
    turned = {"axis": "+X", "angle": "90"}
    found = []
    for joint, kind in (("Spherical", "Parallel"), ("Revolute", "")):
        built = with_gravity(MechanismBuilder())
        built.transform("Place", **turned)
        built.joint(joint, "Free")
        built.transform("Off", offset="[0.1 0.2 0.3]")
        built.body("Brick Solid", "Body", BrickDimensions="[0.1 0.2 0.3]")
        built.meet("World", "Place lconn:1")
        built.meet("Free", "Off lconn:1")
        built.meet("Off", "Body")
        if kind:
            built.add_library(CONSTRAINTS + "Angle Constraint", "Held", {"Type": kind})
            built.meet("Place", "Free lconn:1", "Held lconn:1")
            built.meet("Off", "Held")
        else:
            built.meet("Place", "Free lconn:1")
        system = dynamics(built, tmp_path)
        context = system.CreateDefaultContext()
        plant = system.plant
        vdot = system.EvalTimeDerivatives(context).CopyToVector()[-plant.num_velocities() :]
        own = plant.GetMyContextFromRoot(context)
        body = plant.GetBodyByName("Body")
        spatial = plant.CalcSpatialAccelerationsFromVdot(own, vdot)[body.index()]
        found.append(spatial.get_coeffs())
    np.testing.assert_allclose(found[0], found[1], atol=1e-10)
    assert np.abs(found[1]).max() > 1.0


def test_a_bead_on_a_straight_wire_slides_down_as_on_a_slope(tmp_path):
    points = [(0.1 * n, 0.0, -0.05 * n) for n in range(-3, 4)]
    system = dynamics(on_curve(points, "Natural", **target("Px", 0.03)), tmp_path)
    context = system.CreateDefaultContext()
    state = system.GetOutputPort("state").Eval(context)
    np.testing.assert_allclose(state[4:7], [0.03, 0.0, -0.015], atol=1e-12)
    down = np.array([2.0, 0.0, -1.0]) / math.sqrt(5.0)
    acceleration = system.EvalTimeDerivatives(context).CopyToVector()[10:13]
    np.testing.assert_allclose(acceleration, GRAVITY / math.sqrt(5.0) * down, atol=1e-10)


def test_a_bead_on_a_round_wire_is_a_pendulum(tmp_path):
    around = np.linspace(0.0, math.tau, 73)[:-1]
    points = np.column_stack([np.cos(around), np.zeros(72), np.sin(around)])
    targets = {**target("Px", 0.6), "PzVelocityTargetSpecify": "on", "PzVelocityTargetValue": "1"}
    targets |= target("Pz", -0.7, "Low")
    system = dynamics(on_curve(points, "Closed", **targets), tmp_path)
    context = system.CreateDefaultContext()
    state = system.GetOutputPort("state").Eval(context)
    x, z = state[4], state[6]
    assert math.hypot(x, z) == pytest.approx(1.0, abs=1e-5)
    along = np.array([-z, 0.0, x])
    rate = float(state[10:13] @ along)
    expected = -GRAVITY * x * along - rate**2 * np.array([x, 0.0, z])
    acceleration = system.EvalTimeDerivatives(context).CopyToVector()[10:13]
    np.testing.assert_allclose(acceleration, expected, atol=0.01)
    assert rate > 1.0


def test_targets_of_high_priority_stay_where_constraints_allow(tmp_path):
    low = {**target("Px", 0.2, "Low"), **target("Pz", 0.5)}
    built = held("6-DOF", "Distance Constraint", {"Distance": "1"}, **low)
    context = dynamics(built, tmp_path).CreateDefaultContext()
    state = context.get_continuous_state_vector().CopyToVector()
    assert state[6] == pytest.approx(0.5)
    assert np.linalg.norm(state[4:7]) == pytest.approx(1.0, abs=1e-12)


def test_constraints_that_cannot_be_met_are_named(tmp_path):
    built = held("Revolute", "Distance Constraint", {"Distance": "1"})
    with pytest.raises(InvalidValueError, match=r"the constraints 'Held' are 1 rad or m off"):
        dynamics(built, tmp_path).CreateDefaultContext()


@pytest.mark.parametrize(
    ("kind", "texts", "said"),
    [
        ("Distance Constraint", {}, "Distance 0.0; it must be a positive number"),
        ("Distance Constraint", {"Distance": "0"}, "a joint keeps two points together"),
        ("Angle Constraint", {}, "Type 'not given'; it must be General"),
        ("Angle Constraint", {"Type": "General", "Angle": "180"}, "between 0 and 180 degrees"),
    ],
)
def test_settings_that_make_no_sense_are_refused(tmp_path, kind, texts, said):
    with pytest.raises(InvalidValueError, match=f"'Held' .*{said}"):
        dynamics(held("6-DOF", kind, texts), tmp_path)


@pytest.mark.parametrize(
    ("points", "ends", "said"),
    [
        ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], "Bent", "EndConditionType"),
        ([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], "Natural", "too few points, or two equal ones"),
        ([(0.0,), (1.0,)], "Natural", "n x 2 or n x 3"),
    ],
)
def test_curves_that_make_no_sense_are_refused(tmp_path, points, ends, said):
    with pytest.raises(InvalidValueError, match=f"'Way' .*{said}"):
        dynamics(on_curve(points, ends), tmp_path)


@pytest.mark.parametrize("closed", [False, True])
def test_the_nearest_point_of_a_curve_is_found(closed):
    curve = Curve(np.array(HELIX), closed=closed)
    rng = np.random.default_rng(1)
    for s in rng.uniform(0.05, 0.9 * curve.length, 10):
        away = np.cross(curve.at(s)[1], rng.normal(size=3))
        point = curve.at(s)[0] + 0.05 * away / np.linalg.norm(away)
        found = curve.nearest(point)
        assert (curve.at(found)[0] - point) @ curve.at(found)[1] == pytest.approx(0.0, abs=1e-10)
        assert found == pytest.approx(s, abs=0.05)
    start, end = curve.at(0.0)[1:], curve.at(curve.length)[1:]
    if closed:
        np.testing.assert_allclose(start, end, atol=1e-9)
    else:
        np.testing.assert_allclose([start[1], end[1]], 0.0, atol=1e-12)
