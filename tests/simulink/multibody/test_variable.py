"""Solids whose sizes and mass may change, where their inputs are constant."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.system import mechanism_dynamics
from drake_leg.simulink.running.ported import mechanism_from
from drake_leg.simulink.running.porting.mechanism import mechanism_data

BALL = 4.0 / 3.0 * math.pi * 0.1**3


def solid(kind, *inputs, source="Constant", unit="1", **texts):
    """A variable solid on a joint; what enters its ports comes through converters."""
    built = MechanismBuilder()
    built.joint("Revolute", "Pivot")
    built.body(f"Variable {kind} Solid", "Body", **texts)
    built.meet("World", "Pivot lconn:1")
    built.meet("Pivot", "Body")
    for place, text in enumerate(inputs, start=1):
        made = built.add_block(source, f"Value {place}", {"Value": text})
        converter = built.add_library(
            "nesl_utility/Simulink-PS Converter", f"C{place}", {"Unit": unit}
        )
        built.connect(made, f"{converter}#in:1")
        built.physical(f"{converter}#rconn:1", f"{built.sid('Body')}#lconn:{place}")
    return built


@pytest.mark.parametrize(
    ("texts", "inputs", "unit", "mass", "radius"),
    [
        ({"Radius": "0.1"}, (), "1", 1000.0 * BALL, 0.1),
        ({"Radius": "10", "RadiusUnits": "cm", "Density": "500"}, (), "1", 500.0 * BALL, 0.1),
        ({"Radius": "0.1", "MassType": "ProvidedByInput"}, ("2+1",), "1", 3.0, 0.1),
        ({"Radius": "0.1", "MassType": "ProvidedByInput"}, ("250",), "g", 0.25, 0.1),
        (
            {"RadiusType": "CalculateFromMass", "MassType": "ProvidedByInput", "Density": "300"},
            (str(300.0 * BALL),), "1", 300.0 * BALL, 0.1,
        ),
        (
            {"RadiusType": "ProvidedByInput", "MassType": "ProvidedByInput"},
            ("0.2", "3"), "1", 3.0, 0.2,
        ),
    ],
)  # fmt: skip
def test_a_ball_has_the_mass_of_its_constants(tmp_path, texts, inputs, unit, mass, radius):
    found = solid("Spherical", *inputs, unit=unit, **texts).mechanism(tmp_path).bodies[1].properties
    assert found.mass == pytest.approx(mass)
    np.testing.assert_allclose(found.inertia, 0.4 * mass * radius**2 * np.eye(3))


@pytest.mark.parametrize(
    ("texts", "inputs", "mass"),
    [
        ({"Length": "0.3", "Radius": "0.1"}, (), 1000.0 * math.pi * 0.01 * 0.3),
        ({"Length": "0.3", "RadiusType": "ProvidedByInput"}, ("0.1",), 3.0 * math.pi),
        (
            {"Length": "0.3", "RadiusType": "CalculateFromMass", "MassType": "ProvidedByInput"},
            (str(3.0 * math.pi),), 3.0 * math.pi,
        ),
        (
            {"Radius": "0.1", "LengthType": "CalculateFromMass", "MassType": "ProvidedByInput"},
            (str(3.0 * math.pi),), 3.0 * math.pi,
        ),
    ],
)  # fmt: skip
def test_a_cylinder_has_the_mass_of_its_constants(tmp_path, texts, inputs, mass):
    found = solid("Cylindrical", *inputs, **texts).mechanism(tmp_path).bodies[1].properties
    assert found.mass == pytest.approx(mass)
    across = mass * (3.0 * 0.01 + 0.09) / 12.0
    np.testing.assert_allclose(np.diag(found.inertia), [across, across, mass * 0.005])


@pytest.mark.parametrize(
    ("kind", "texts", "source", "sentence"),
    [
        ("Spherical", {"MassType": "ProvidedByInput"}, "Clock", "lconn:1, that is no Constant"),
        ("Spherical", {"MassType": "Else"}, "Constant", "MassType 'Else'"),
        ("Spherical", {"RadiusType": "CalculateFromMass"}, "Constant", "more than one"),
        (
            "Cylindrical", {"LengthType": "ProvidedByInput", "RadiusType": "ProvidedByInput"},
            "Constant", "whose order is not known",
        ),
        ("Spherical", {"RadiusType": "ProvidedByInput"}, "Constant", "has the radius -1; it must"),
    ],
)  # fmt: skip
def test_one_that_changes_is_refused(tmp_path, kind, texts, source, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        solid(kind, "-1", "-1", source=source, **texts).mechanism(tmp_path)


def test_a_script_has_the_constants(tmp_path):
    texts = {"RadiusType": "ProvidedByInput", "MassType": "ProvidedByInput"}
    model = solid("Spherical", "0.2", "3", **texts).model(tmp_path)
    ours, theirs = mechanism_dynamics(model), mechanism_from(mechanism_data(model, "smooth"))
    inertia = [s.plant.CalcMassMatrix(s.plant.CreateDefaultContext()) for s in (ours, theirs)]
    np.testing.assert_allclose(*inertia)
