"""Contact whose forces are inputs: they act where the two touch, and nowhere else."""

import math

import numpy as np
import pytest
from moving import GRAVITY, dynamics, falling, sensed, wired

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.contact import contact_axes

MASS = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3
INERTIA = 0.4 * MASS * 0.1**2
VELOCITY = np.array([0.3, 0.4, -0.1])
SENSED = ("Contact rconn:2", "Contact rconn:3")


def given(height, *inputs, **texts):
    """A ball that slides over a floor and is pushed by inputs."""
    moving = {}
    for axis, speed in zip("xyz", VELOCITY, strict=True):
        moving |= {
            f"P{axis}VelocityTargetSpecify": "on",
            f"P{axis}VelocityTargetValue": str(speed),
        }
    built = falling(height, **moving)
    built.set(
        "Contact", SenseNormalForceMagnitude="off", SenseSeparationDistance="off",
        SenseNormalVelocity="on", SenseTangentialVelocity="on", **texts,
    )  # fmt: skip
    return wired(built, "Contact", *inputs)


def accelerations(system, u):
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, u)
    return np.split(system.EvalTimeDerivatives(context).CopyToVector()[7:], 2), context


BOTH = {"NormalForceType": "ProvidedByInput", "FrictionType": "ProvidedByInput"}


def test_both_forces_push_at_the_contact(tmp_path):
    built = given(0.09, "lconn:2", "lconn:3", **BOTH)
    system = dynamics(built, tmp_path)
    R = contact_axes(np.array([0.0, 0.0, 1.0]))
    slip = R[:, :2].T @ [0.3, 0.4, 0.0]
    (alpha, a), context = accelerations(system, [5.0, *(-2.0 * slip)])
    np.testing.assert_allclose(sensed(system, context, built, SENSED[0]), -0.1, atol=1e-12)
    np.testing.assert_allclose(sensed(system, context, built, SENSED[1]), slip, atol=1e-12)
    force = np.array([-0.6, -0.8, 5.0])
    np.testing.assert_allclose(a, force / MASS - [0.0, 0.0, GRAVITY], rtol=1e-9)
    np.testing.assert_allclose(
        alpha, np.cross([0.0, 0.0, -0.095], force) / INERTIA, rtol=1e-9, atol=1e-9
    )


def test_a_law_of_the_block_stays_beside_an_input(tmp_path):
    u = 3.0
    friction = {"CoefficientOfStaticFriction": "0.5", "CoefficientOfDynamicFriction": "0.2"}
    built = given(0.09, "lconn:2", NormalForceType="ProvidedByInput", **friction)
    (_, a), _ = accelerations(dynamics(built, tmp_path), [u])
    np.testing.assert_allclose(MASS * a[:2], -0.2 * u * VELOCITY[:2] / 0.5, rtol=1e-9)
    assert MASS * (a[2] + GRAVITY) == pytest.approx(u)
    built = given(0.09, "lconn:2", FrictionType="ProvidedByInput")
    (_, a), _ = accelerations(dynamics(built, tmp_path), [1.0, 0.0])
    along = contact_axes(np.array([0.0, 0.0, 1.0]))[:, 0]
    np.testing.assert_allclose(MASS * a[:2], along[:2], rtol=1e-9, atol=1e-12)
    assert MASS * (a[2] + GRAVITY) == pytest.approx(1e4 * 0.01 + 30 * 0.1)


def test_nothing_acts_where_nothing_touches(tmp_path):
    system = dynamics(given(0.2, "lconn:2", "lconn:3", **BOTH), tmp_path)
    (_, a), _ = accelerations(system, [5.0, 1.0, 1.0])
    np.testing.assert_allclose(a, [0.0, 0.0, -GRAVITY], atol=1e-12)


def test_what_is_not_built_is_named(tmp_path):
    built = given(0.09, "lconn:2", **BOTH).set("Contact", SenseNormalForceMagnitude="on")
    with pytest.raises(InvalidValueError, match="and senses them: use the inputs themselves"):
        dynamics(built, tmp_path)
