"""Bodies with moments of inertia and no mass, as the rotors of gears, against closed forms."""

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, pendulum
from moving import dynamics, sensed, wired, with_gravity

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody import mass
from drake_leg.simulink.multibody.plant import mechanism_plant, prove_mechanism

AXIAL = 3e-4  # about the axis of the joint, z [kg*m^2]
ROTOR = {"InertiaType": "Custom", "Mass": "0", "MomentsOfInertia": f"[2e-4 4e-4 {AXIAL}]"}
SENSED = {"TorqueActuationMode": "InputTorque", "SenseAcceleration": "on"}


def rotor(kind="Revolute", **texts):
    built = MechanismBuilder()
    built.joint(kind, "Axle", **texts)
    built.transform("Aside", offset="[0.3 0 0]")
    built.body("Brick Solid", "Rotor", **ROTOR)
    built.meet("World", "Axle lconn:1")
    built.meet("Axle", "Aside lconn:1")
    built.meet("Aside", "Rotor")
    return built


def test_a_torque_turns_it_by_its_moment_of_inertia(tmp_path):
    built = with_gravity(
        rotor(**SENSED, SenseTotalTorque="on", CompositeWrenchDir="BaseOnFollower")
    )
    wired(built, "Axle", "lconn:2", "rconn:2", "rconn:3")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, [0.06])
    assert sensed(system, context, built, "Axle rconn:2") == pytest.approx(0.06 / AXIAL, rel=1e-9)
    np.testing.assert_allclose(
        sensed(system, context, built, "Axle rconn:3"), [0.0, 0.0, 0.06], atol=1e-12
    )


def test_its_plant_agrees_with_its_blocks_and_weighs_nothing(tmp_path):
    mechanism = rotor().mechanism(tmp_path)
    plant = mechanism_plant(mechanism)
    assert prove_mechanism(mechanism, plant).holds
    M = plant.CalcMassMatrix(plant.CreateDefaultContext())
    np.testing.assert_allclose(M, [[AXIAL]], rtol=1e-12)


def test_it_adds_to_what_carries_it(tmp_path):
    built = pendulum(**SENSED)
    built.body("Brick Solid", "Rotor", **ROTOR)
    built.meet("Down", "Rotor")
    wired(built, "Pivot", "lconn:2", "rconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, [0.7])
    whole = 0.4 * (1.0**2 + 0.02**2) / 12.0 + 0.4 * 0.5**2 + AXIAL
    assert sensed(system, context, built, "Pivot rconn:2") == pytest.approx(0.7 / whole)


def test_it_does_not_resist_being_shifted(tmp_path):
    with pytest.raises(InvalidValueError, match="'Axle' move nothing that has mass"):
        dynamics(rotor("Prismatic"), tmp_path)


def test_a_mechanism_whose_plant_is_wrong_does_not_run(tmp_path, monkeypatch):
    monkeypatch.setattr(mass, "CARRIER", 1e-3)
    with pytest.raises(InvalidValueError, match=r"differs from its blocks, by .* run"):
        dynamics(rotor(), tmp_path)
