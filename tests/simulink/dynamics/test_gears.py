"""Gears and screws, against their ratios and what turns with what."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import GRAVITY, dynamics, energy, run, sensed, wired, with_gravity

from drake_leg.errors import InvalidValueError

GEARS = "sm_lib/Gears and Couplings/Gears/"
TURN = {"TorqueActuationMode": "InputTorque", "SenseAcceleration": "on"}


def two_shafts(kind, texts, *, offset, axis="", angle="0", second="Revolute"):
    """Two cylinders of 1 kg and 4 kg on shafts; the first one takes a torque."""
    built = MechanismBuilder()
    built.transform("Place", offset=offset, axis=axis, angle=angle)
    for name, joint, mass, before in (
        ("First", "Revolute", "1", "World"),
        ("Second", second, "4", "Place"),
    ):
        more = TURN if name == "First" else {"SenseAcceleration": "on"}
        built.joint(joint, name, **more)
        built.body(
            "Cylindrical Solid", f"{name}Body", CylinderRadius="0.1", CylinderLength="0.02",
            BasedOnType="Mass", Mass=mass,
        )  # fmt: skip
        built.meet(name, f"{name}Body")
        if before != "World":
            built.meet(before, f"{name} lconn:1")
    built.meet("World", "Place lconn:1", "First lconn:1")
    built.add_library(GEARS + kind, "Gear", texts)
    for name, place in (("First", "lconn:1"), ("Second", "rconn:1")):
        built.meet(f"{name}Body", f"Gear {place}")
    wired(built, "First", "lconn:2", "rconn:2")
    return wired(built, "Second", "rconn:2")


def ratio(built, folder, torque=0.3):
    """Return how the second accelerates for the first, and check the power of both."""
    system = dynamics(built, folder)
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, [torque])
    first, second = (
        float(sensed(system, context, built, f"{name} rconn:2")) for name in ("First", "Second")
    )
    inertias = (0.5 * 1.0 * 0.01, 4.0 if built.is_rack else 0.5 * 4.0 * 0.01)
    slope = second / first
    assert first == pytest.approx(torque / (inertias[0] + inertias[1] * slope**2), rel=1e-9)
    return slope


@pytest.mark.parametrize(
    ("kind", "texts", "place", "expected"),
    [
        (
            "Common Gear Constraint",
            {"BaseGearRadius": "0.1", "FollGearRadius": "0.2"},
            {"offset": "[0.3 0 0]"},
            -0.5,
        ),
        (
            "Common Gear Constraint",
            {"GearType": "Internal", "BaseGearRadius": "0.1", "FollGearRadius": "0.4"},
            {"offset": "[0.3 0 0]"},
            0.25,
        ),
        (
            "Common Gear Constraint",
            {"GearType": "Internal", "SpecificationType": "CenterDistanceAndRatio",
             "CenterDistance": "0.3", "CenterDistanceUnits": "m", "GearRatio": "0.25"},
            {"offset": "[0.3 0 0]"},
            4.0,
        ),
        (
            "Common Gear Constraint",
            {"SpecificationType": "CenterDistanceAndRatio", "CenterDistance": "30",
             "CenterDistanceUnits": "cm", "GearRatio": "2"},
            {"offset": "[0 0.3 0]"},
            -0.5,
        ),
        (
            "Bevel Gear Constraint",
            {"BaseGearRadius": "0.1", "FollGearRadius": "0.2"},
            {"offset": "[0.1 0 0.2]", "axis": "+Y", "angle": "90"},
            0.5,
        ),
        (
            "Worm and Gear Constraint",
            {"WormRadius": "0.05", "GearRadius": "0.2", "WormLeadAngle": "10"},
            {"offset": "[0.25 0 0]", "axis": "+X", "angle": "90"},
            0.05 * math.tan(math.radians(10)) / 0.2,
        ),
        (
            "Rack and Pinion Constraint",
            {"PinionRadius": "0.1"},
            {"offset": "[0.1 0 0]", "axis": "+X", "angle": "-90", "second": "Prismatic"},
            0.1,
        ),
    ],
)  # fmt: skip
def test_gears_have_their_ratio_and_pass_on_power(tmp_path, kind, texts, place, expected):
    built = two_shafts(kind, texts, **place)
    built.is_rack = "second" in place
    assert ratio(built, tmp_path) == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_planets_keep_their_energy_and_their_ratio(tmp_path):
    built = with_gravity(MechanismBuilder(), GravityVector="[0 -9.81 0]")
    built.joint("Revolute", "Arm", PositionTargetSpecify="on", PositionTargetValue="20")
    built.transform("End", offset="[0.3 0 0]")
    built.joint("Revolute", "Planet", SenseVelocity="on")
    built.body("Cylindrical Solid", "Body", CylinderRadius="0.1", CylinderLength="0.02")
    built.add_library(
        GEARS + "Common Gear Constraint", "Gear", {"BaseGearRadius": "0.2", "FollGearRadius": "0.1"}
    )
    built.meet("World", "Arm lconn:1", "Gear lconn:1")
    built.meet("Arm", "End lconn:1")
    built.meet("End", "Planet lconn:1")
    built.meet("Planet", "Body", "Gear")
    wired(built, "Planet", "rconn:2")
    system = dynamics(built, tmp_path)
    start = energy(system, system.CreateDefaultContext())
    context = run(system, 0.3, accuracy=1e-8)
    arm, planet = system.GetOutputPort("state").Eval(context)[2:]
    assert abs(arm) > 1.0
    assert planet == pytest.approx(2.0 * arm, abs=1e-6)  # rolls on a sun that stands still
    assert energy(system, context) == pytest.approx(start, abs=1e-6)


def test_a_screw_falls_as_it_turns(tmp_path):
    built = with_gravity(MechanismBuilder())
    built.joint(
        "Lead Screw", "Screw", Lead="20", LeadUnits="mm/rev", Direction="LeftHand",
        PositionTargetSpecify="on", PositionTargetTranslationValue="0.05",
        SenseRotationPosition="on", SenseTranslationPosition="on",
        SenseTranslationAcceleration="on",
    )  # fmt: skip
    built.body("Cylindrical Solid", "Nut", CylinderRadius="0.1", BasedOnType="Mass", Mass="2")
    built.meet("World", "Screw lconn:1")
    built.meet("Screw", "Nut")
    wired(built, "Screw", "rconn:2", "rconn:3", "rconn:4")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    turn, z, a = (float(sensed(system, context, built, f"Screw rconn:{n}")) for n in (2, 3, 4))
    lead = 0.02 / math.tau
    assert (turn, z) == pytest.approx((-0.05 / lead, 0.05))
    inertia = 0.5 * 2.0 * 0.01
    assert a == pytest.approx(-2.0 * GRAVITY / (2.0 + inertia / lead**2))
    p = system.plant.GetBodyByName("Nut").EvalPoseInWorld(
        system.plant.GetMyContextFromRoot(context)
    )
    np.testing.assert_allclose(p.translation(), [0.0, 0.0, 0.05], atol=1e-15)


def test_a_gear_without_a_radius_is_refused(tmp_path):
    texts = {"BaseGearRadius": "0", "FollGearRadius": "0.2"}
    with pytest.raises(InvalidValueError, match=r"'Gear' .* BaseGearRadius 0"):
        dynamics(two_shafts("Common Gear Constraint", texts, offset="[0.3 0 0]"), tmp_path)
