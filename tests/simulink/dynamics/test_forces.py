"""Forces between frames, against Newton's law and closed forms."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import FORCES, GRAVITY, dynamics, port, run, sensed, wired, with_gravity
from scipy.spatial.transform import Rotation

MASS = 1000.0 * 0.3 * 0.2 * 0.1  # of the plate [kg]
INERTIA = MASS / 12.0 * np.array([0.05, 0.1, 0.13])  # about its center [kg*m^2]


def plate(axis="+X", angle="35", **more):
    """A free plate, turned about an axis, with an arm out of its center."""
    built = MechanismBuilder()
    built.joint(
        "6-DOF", "Free", SphPositionTargetSpecify="on",
        SphPositionTargetRotationMethod="StandardAxis",
        SphPositionTargetRotationStandardAxis=axis, SphPositionTargetRotationAngle=angle, **more,
    )  # fmt: skip
    built.body("Brick Solid", "Plate", BrickDimensions="[0.3 0.2 0.1]")
    built.transform("Arm", offset="[0.1 0.2 -0.3]")
    built.meet("World", "Free lconn:1")
    built.meet("Free", "Plate", "Arm lconn:1")
    return built


def accelerations(system, u):
    """Return angular and linear accelerations of a free body, in the world."""
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, u)
    rates = system.EvalTimeDerivatives(context).CopyToVector()
    return np.split(rates[7:], 2)


@pytest.mark.parametrize("frame", ["AttachedFrame", "World"])
def test_an_external_force_obeys_newton_and_euler(tmp_path, frame):
    built = plate()
    switches = ("ForceX", "ForceZ", "Force", "TorqueY", "Torque")
    texts = {f"Enable{name}": "on" for name in switches} | {
        "ForceResolutionFrame": frame, "TorqueResolutionFrame": frame,
    }  # fmt: skip
    built.add_library(FORCES + "External Force and Torque", "Push", texts)
    built.meet("Arm", "Push")
    wired(built, "Push", *(f"lconn:{n}" for n in range(1, 6)))
    system = dynamics(built, tmp_path)
    assert [system.inputs[port(built, f"Push lconn:{n}")].start for n in range(1, 6)] == [
        0, 1, 2, 5, 6,
    ]  # fmt: skip
    u = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    force, torque = np.array([4.0, 4.0, 7.0]), np.array([7.0, 14.0, 9.0])
    R = Rotation.from_euler("x", 35, degrees=True).as_matrix()
    if frame == "AttachedFrame":
        force, torque = R @ force, R @ torque
    moment = torque + np.cross(R @ [0.1, 0.2, -0.3], force)
    alpha, a = accelerations(system, u)
    np.testing.assert_allclose(a, force / MASS, rtol=1e-12)
    np.testing.assert_allclose(alpha, R @ ((R.T @ moment) / INERTIA), rtol=1e-12)


def test_gravity_that_is_an_input_is_that_of_the_plant(tmp_path):
    built = with_gravity(plate(), UniformGravity="TimeVarying")
    wired(built, "Gravity", "lconn:1")
    system = dynamics(built, tmp_path)
    alpha, a = accelerations(system, [0.0, 1.0, -GRAVITY])
    np.testing.assert_allclose(a, [0.0, 1.0, -GRAVITY], rtol=1e-12)
    np.testing.assert_allclose(alpha, 0.0, atol=1e-12)


def sliders(kind, texts, *, at=(0.0, 0.4)):
    """Two equal balls on one line x, with a force between them."""
    built = MechanismBuilder()
    built.transform("Along", axis="+Y", angle="90")
    built.meet("World", "Along lconn:1")
    ends = []
    for name, x in zip("AB", at, strict=True):
        targets = {"PositionTargetSpecify": "on", "PositionTargetValue": str(x)}
        built.joint("Prismatic", f"J{name}", **targets, SensePosition="on")
        built.body("Spherical Solid", name, SphereRadius="0.05", InertiaType="PointMass", Mass="2")
        ends.append(f"J{name} lconn:1")
        built.meet(f"J{name}", name)
    built.meet("Along", *ends)
    built.add_library(FORCES + kind, "Force", texts)
    for name, place in (("A", "lconn:1"), ("B", "rconn:1")):
        node = f"J{name} rconn:1"
        built.meet(node, f"Force {place}")
    return built


def test_a_spring_between_two_bodies_has_its_frequency(tmp_path):
    texts = {"NaturalLength": "0.5", "SpringStiffness": "100", "DampingCoefficient": "0"}
    built = wired(sliders("Spring and Damper Force", texts), "Force", "rconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    assert sensed(system, context, built, "Force rconn:2") == pytest.approx(10.0)
    omega = math.sqrt(100.0 * (1 / 2 + 1 / 2))
    context = run(system, 0.3)
    apart = np.diff(system.GetOutputPort("state").Eval(context)[:2])
    assert apart == pytest.approx(0.5 - 0.1 * math.cos(omega * 0.3), abs=2e-6)


def test_an_internal_force_pushes_apart(tmp_path):
    built = wired(sliders("Internal Force", {}), "Force", "lconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, [6.0])
    rates = system.EvalTimeDerivatives(context).CopyToVector()
    np.testing.assert_allclose(rates[2:], [-3.0, 3.0])


def test_an_inverse_square_law_and_a_field_pull_and_push_as_they_say(tmp_path):
    system = dynamics(sliders("Inverse Square Law Force", {"ForceConstant": "0.8"}), tmp_path)
    rates = system.EvalTimeDerivatives(system.CreateDefaultContext()).CopyToVector()
    np.testing.assert_allclose(rates[2:], [-2.5, 2.5])
    built = plate(PxPositionTargetSpecify="on", PxPositionTargetValue="2")
    built.add_library(FORCES + "Gravitational Field", "Earth", {"Mass": "1e12"})
    built.meet("World", "Earth")
    _, a = accelerations(dynamics(built, tmp_path), [])
    np.testing.assert_allclose(a, [-6.67384e-11 * 1e12 / 4.0, 0.0, 0.0], rtol=1e-12)
