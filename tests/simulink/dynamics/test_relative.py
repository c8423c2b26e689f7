"""Transform Sensors, against differences along a motion and against each other."""

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import dynamics, sensed, wired

from drake_leg.errors import InvalidValueError

FRAMES = ("World", "Base", "Follower", "NonRotatingBase", "NonRotatingFollower")
SWITCHES = (
    "SenseAngle", "SenseAxis", "SenseQ", "SenseR", "SenseRotationSequence", "SenseOmega",
    "SenseQDot", "SenseRDot", "SenseRotationSequenceDot", "SenseAlpha", "SenseX", "SenseXYZ",
    "SenseRad", "SenseAzim", "SenseDist", "SenseInc", "SenseXYZDot", "SenseRadDot",
    "SenseAzimDot", "SenseDistDot", "SenseIncDot", "SenseXYZDDot",
)  # fmt: skip


def two_arms(frame):
    """Two universal joints on the world; a sensor between the ends of their arms."""
    built = MechanismBuilder()
    for name, offset in (("A", "[0.3 0.1 0.5]"), ("B", "[-0.2 0.4 0.6]")):
        built.joint("Universal", f"J{name}")
        built.transform(f"T{name}", offset=offset, axis="+Y", angle="25")
        built.body("Ellipsoidal Solid", name, EllipsoidRadii="[0.1 0.2 0.3]")
        built.meet(f"J{name}", f"T{name} lconn:1", name)
    built.meet("World", "JA lconn:1", "JB lconn:1")
    texts = dict.fromkeys(SWITCHES, "on")
    texts |= {"MeasurementFrame": frame, "RotationSequence": "ZYX"}
    built.frame("Transform Sensor", "Sensor", **texts)
    built.meet("TA", "Sensor lconn:1")
    built.meet("TB", "Sensor")
    return wired(built, "Sensor", *(f"rconn:{n + 2}" for n in range(len(SWITCHES))))


def measured(system, built, state):
    context = system.CreateDefaultContext()
    context.SetContinuousState(state)
    values = {
        name: sensed(system, context, built, f"Sensor rconn:{n + 2}")
        for n, name in enumerate(SWITCHES)
    }
    return values, system.EvalTimeDerivatives(context).CopyToVector()


@pytest.mark.parametrize("frame", FRAMES)
def test_what_is_sensed_is_the_derivative_of_what_is_sensed(tmp_path, frame):
    built = two_arms(frame)
    system = dynamics(built, tmp_path)
    state = np.random.default_rng(1).uniform(-1.0, 1.0, 8)
    here, rate = measured(system, built, state)
    step = 1e-6
    before, after = (measured(system, built, state + s * step * rate)[0] for s in (-1, 1))
    slope = {name: (after[name] - before[name]) / (2 * step) for name in SWITCHES}
    turning = ("SenseQ", "SenseR", "SenseRotationSequence")
    for name in turning:
        np.testing.assert_allclose(here[f"{name}Dot"], slope[name], atol=1e-8)
    if frame.startswith("NonRotating"):
        twin, _ = measured(
            dynamics(two_arms(frame.removeprefix("NonRotating")), tmp_path), built, state
        )
        for name in ("SenseXYZ", "SenseOmega", "SenseDistDot"):
            np.testing.assert_allclose(here[name], twin[name])
        assert np.abs(here["SenseXYZDot"] - twin["SenseXYZDot"]).max() > 0.01
        return
    for name in ("SenseXYZ", "SenseRad", "SenseAzim", "SenseDist", "SenseInc"):
        np.testing.assert_allclose(here[f"{name}Dot"], slope[name], atol=1e-8)
    np.testing.assert_allclose(here["SenseXYZDDot"], slope["SenseXYZDot"], atol=1e-7)
    np.testing.assert_allclose(here["SenseAlpha"], slope["SenseOmega"], atol=1e-7)
    x, y, z = here["SenseXYZ"]
    assert here["SenseX"] == x
    assert here["SenseRad"] == pytest.approx(np.hypot(x, y))
    assert here["SenseInc"] == pytest.approx(np.arctan2(z, np.hypot(x, y)))


def test_rotations_agree_in_all_their_forms(tmp_path):
    built = two_arms("World")
    system = dynamics(built, tmp_path)
    here, _ = measured(system, built, np.random.default_rng(2).uniform(-1.0, 1.0, 8))
    R, (w, *xyz) = here["SenseR"], here["SenseQ"]
    assert np.trace(R) == pytest.approx(1 + 2 * np.cos(here["SenseAngle"]))
    np.testing.assert_allclose(R @ here["SenseAxis"], here["SenseAxis"], atol=1e-14)
    assert w == pytest.approx(np.cos(here["SenseAngle"] / 2))
    np.testing.assert_allclose(xyz, np.sin(here["SenseAngle"] / 2) * here["SenseAxis"], atol=1e-14)


def test_a_six_dof_joint_between_bodies_only_senses(tmp_path):
    built = MechanismBuilder()
    built.joint("Revolute", "Pivot", PositionTargetSpecify="on", PositionTargetValue="90")
    built.transform("End", offset="[1 0 0]")
    built.body("Spherical Solid", "Ball", SphereRadius="0.1")
    built.joint("6-DOF", "Sensor", PxSensePosition="on", PySensePosition="on",
                PySenseVelocity="on", SphSensePosition="on")  # fmt: skip
    built.meet("World", "Pivot lconn:1", "Sensor lconn:1")
    built.meet("Pivot", "End lconn:1", "Ball")
    built.meet("End", "Sensor")
    wired(built, "Sensor", "rconn:2", "rconn:3", "rconn:4", "rconn:5")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    context.SetContinuousState([np.pi / 3, 2.0])
    found = [sensed(system, context, built, f"Sensor rconn:{n}") for n in range(2, 6)]
    np.testing.assert_allclose(found[:3], [0.5, np.sqrt(0.75), 2.0 * 0.5])
    np.testing.assert_allclose(
        found[3], [np.cos(np.pi / 6), 0.0, 0.0, np.sin(np.pi / 6)], atol=1e-15
    )


def test_a_frame_that_is_not_known_is_refused(tmp_path):
    with pytest.raises(InvalidValueError, match="it must be one of World, Base"):
        dynamics(two_arms("Moon"), tmp_path)
