"""What a Weld Joint carries, and what an Inertia Sensor weighs."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import FORCES, GRAVITY, dynamics, sensed, wired, with_gravity

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.plant import mechanism_plant, prove_mechanism

TOTAL = {"SenseTotalForce": "on", "SenseTotalTorque": "on"}
BOX = {"BrickDimensions": "[0.1 0.2 0.3]"}
MASS = 6.0


def chain(**texts):
    """Two boxes on a pivot about y, the lower one welded 0.5 m below it, 0.2 m beside."""
    built = with_gravity(MechanismBuilder())
    built.transform("Turn", axis="+X", angle="-90")
    built.joint("Revolute", "Pivot", TorqueActuationMode="InputTorque")
    built.transform("Back", axis="+X", angle="90")
    built.body("Brick Solid", "Upper", **BOX)
    built.transform("Down", offset="[0.2 0 -0.5]")
    built.joint("Weld", "Weld", **(TOTAL | texts))
    built.transform("On", offset="[0.1 0 0]")
    built.body("Brick Solid", "Lower", **BOX)
    built.meet("World", "Turn lconn:1")
    built.meet("Turn", "Pivot lconn:1")
    built.meet("Pivot", "Back lconn:1")
    built.meet("Back", "Upper", "Down lconn:1")
    built.meet("Down", "Weld lconn:1")
    built.meet("Weld", "On lconn:1")
    built.meet("On", "Lower")
    return built


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_weld_carries_the_weight_beyond_it(tmp_path, sign):
    built = chain(CompositeWrenchDir="BaseOnFollower" if sign > 0 else "FollowerOnBase")
    wired(built, "Weld", "rconn:2", "rconn:3")
    wired(built, "Pivot", "lconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    torque = -MASS * GRAVITY * 0.3  # about y of the pivot, which holds the lower box
    system.GetInputPort("u").FixValue(context, [torque])
    np.testing.assert_allclose(system.EvalTimeDerivatives(context).CopyToVector(), 0, atol=1e-12)
    force, moment = (sensed(system, context, built, f"Weld rconn:{n}") for n in (2, 3))
    np.testing.assert_allclose(force, [0.0, 0.0, sign * MASS * GRAVITY], atol=1e-9)
    np.testing.assert_allclose(moment, [0.0, -sign * 0.1 * MASS * GRAVITY, 0.0], atol=1e-9)


def test_a_weld_pulls_a_box_that_swings_around(tmp_path):
    built = chain(CompositeWrenchDir="BaseOnFollower", SenseConstraintForce="on")
    wired(built, "Weld", "rconn:2", "rconn:3", "rconn:4")
    wired(built, "Pivot", "lconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    rate = 3.0
    system.GetInputPort("u").FixValue(context, [0.0])
    context.SetContinuousState([0.0, rate])
    alpha = float(system.EvalTimeDerivatives(context)[1])
    held, force = (sensed(system, context, built, f"Weld rconn:{n}") for n in (2, 3))
    arm = np.array([0.3, 0.0, -0.5])
    a = np.cross([0.0, alpha, 0.0], arm) - rate**2 * arm
    a[2] += GRAVITY
    np.testing.assert_allclose(force, MASS * a, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(held, force)


def test_a_force_beyond_it_counts_and_one_before_it_does_not(tmp_path):
    for place, felt in (("On", -5.0), ("Back", 0.0)):
        built = chain(CompositeWrenchDir="BaseOnFollower")
        built.add_library(FORCES + "External Force and Torque", "Push", {"EnableForceZ": "on"})
        built.meet(f"{place}", "Push")
        wired(built, "Weld", "rconn:2", "rconn:3")
        wired(built, "Pivot", "lconn:2")
        wired(built, "Push", "lconn:1")
        system = dynamics(built, tmp_path)
        context = system.CreateDefaultContext()
        u = np.zeros(2)
        u[system.inputs[f"{built.sid('Push')}#lconn:1"]] = 5.0
        x = 0.3 if place == "On" else 0.0
        u[system.inputs[f"{built.sid('Pivot')}#lconn:2"]] = -MASS * GRAVITY * 0.3 + 5.0 * x
        system.GetInputPort("u").FixValue(context, u)
        force = sensed(system, context, built, "Weld rconn:2")
        np.testing.assert_allclose(force, [0.0, 0.0, MASS * GRAVITY + felt], atol=1e-9)


def test_a_weld_that_senses_is_a_fixed_joint_of_the_same_mechanism(tmp_path):
    built = chain()
    assert len(built.mechanism(tmp_path).bodies) == 2
    mechanism = wired(built, "Weld", "rconn:2").mechanism(tmp_path)
    assert [body.name for body in mechanism.bodies] == ["world", "Upper", "Lower"]
    assert prove_mechanism(mechanism, mechanism_plant(mechanism)).holds


def test_of_two_welds_beside_each_other_neither_is_computed(tmp_path):
    built = chain()
    built.joint("Weld", "Again", **TOTAL)
    built.meet("Down", "Again lconn:1")
    built.meet("Weld", "Again")
    wired(built, "Weld", "rconn:2")
    wired(built, "Again", "rconn:2")
    wired(built, "Pivot", "lconn:2")
    system = dynamics(built, tmp_path)
    assert not system.efforts


@pytest.mark.parametrize("joint", ["Weld", "Pivot"])
def test_a_joint_that_comes_apart_is_refused(tmp_path, joint):
    built = chain().set(joint, JointMode="Disengaged")
    with pytest.raises(InvalidValueError, match="JointMode 'Disengaged'; it must be Normal"):
        built.mechanism(tmp_path)
    built.set(joint, JointMode="ProvidedByInput")
    assert built.mechanism(tmp_path).joints
    with pytest.raises(InvalidValueError, match=f"'{joint}'.*takes its mode from an input"):
        dynamics(built, tmp_path)


def weighed(built, folder, *numbers):
    wired(built, "Pivot", "lconn:2")
    wired(built, "Scale", *(f"rconn:{number}" for number in numbers))
    system = dynamics(built, folder)
    context = system.CreateDefaultContext()
    context.SetContinuousState([math.radians(90), 0.0])
    return [sensed(system, context, built, f"Scale rconn:{number}") for number in numbers]


ALL = ("Mass", "CenterOfMass", "InertiaMatrix", "CenteredInertiaMatrix", "PrincipalInertiaMatrix")


def scale(at, **texts):
    built = chain()
    senses = {f"Sense{name}": "on" for name in (*ALL, "RotationMatrix")}
    built.body("Inertia Sensor", "Scale", **(senses | texts))
    built.meet(at, "Scale lconn:1")
    return built


@pytest.mark.parametrize(
    ("at", "texts", "mass", "center"),
    [
        ("On", {}, 6.0, [-0.5, 0.0, -0.3]),  # turned about y by 90 degrees
        ("On", {"SpanWeldJoints": "on"}, 12.0, [-0.25, 0.0, -0.15]),
        ("On", {"SensorExtent": "Mechanism"}, 12.0, [-0.25, 0.0, -0.15]),
        ("On", {"MeasurementFrame": "Attached"}, 6.0, [0.0, 0.0, 0.0]),
        ("Back", {"MeasurementFrame": "Attached"}, 6.0, [0.0, 0.0, 0.0]),
        ("Turn", {}, 0.0, [0.0, 0.0, 0.0]),
    ],
)
def test_an_inertia_sensor_weighs_its_group(tmp_path, at, texts, mass, center):
    found = weighed(scale(at, **texts), tmp_path, 1, 2)
    assert found[0] == pytest.approx(mass)
    np.testing.assert_allclose(found[1], center, atol=1e-12)


def test_its_inertia_is_about_the_origin_the_center_and_the_principal_axes(tmp_path):
    _, center, about, centered, principal, R = weighed(scale("On"), tmp_path, *range(1, 7))
    own = MASS / 12.0 * np.diag([0.04 + 0.01, 0.09 + 0.01, 0.09 + 0.04])  # x is along -z now
    np.testing.assert_allclose(centered, own, atol=1e-12)
    moved = MASS * (center @ center * np.eye(3) - np.outer(center, center))
    np.testing.assert_allclose(about, own + moved, atol=1e-12)
    np.testing.assert_allclose(np.diag(principal), np.sort(np.diag(own)), atol=1e-12)
    np.testing.assert_allclose(R @ principal @ R.T, centered, atol=1e-12)


def test_a_sensor_whose_settings_are_not_known_is_refused(tmp_path):
    with pytest.raises(InvalidValueError, match="SensorExtent 'Else'; it must be one of BodyGroup"):
        weighed(scale("On", SensorExtent="Else"), tmp_path, 1)
    with pytest.raises(InvalidValueError, match="frame that is on no body"):
        weighed(scale("On", MeasurementFrame="Custom"), tmp_path, 1)
