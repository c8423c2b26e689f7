"""Forces of the Contact Forces Library, where its file is absent."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder
from moving import GRAVITY, dynamics, energy, run, sensed, with_gravity
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.running import run_model, runnable

LIBRARY = "Contact_Forces_Lib/3D/"
MASS = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3
INERTIA = 0.4 * MASS * 0.1**2
PLANE = {"sphere_rad": "0.1", "plane_lenx": "4", "plane_leny": "2", "plane_depth": "0.05"}
LAW = {"k_contact": "1e4", "b_contact": "50", "mu_static": "0.6", "mu_kinetic": "0.4"}


def ball(kind, z, speeds=(0.0, 0.0, 0.0), *, tilt="0", **texts):
    """A ball of 0.1 m beside the base of a force, with speeds of its center [m/s]."""
    targets = {"PzPositionTargetSpecify": "on", "PzPositionTargetValue": str(z)}
    for axis, speed in zip("xyz", speeds, strict=True):
        targets |= {
            f"P{axis}VelocityTargetSpecify": "on",
            f"P{axis}VelocityTargetValue": str(speed),
        }
    built = with_gravity(MechanismBuilder())
    built.transform("Tilt", axis="+Y", angle=tilt)
    built.joint("6-DOF", "Free", **targets)
    built.body("Spherical Solid", "Ball", SphereRadius="0.1")
    built.add_library(LIBRARY + kind, "Force", LAW | texts)
    built.meet("World", "Tilt lconn:1")
    built.meet("Tilt", "Free lconn:1", "Force")
    built.meet("Free", "Ball", "Force lconn:1")
    return built


def accelerations(built, folder):
    system = dynamics(built, folder)
    context = system.CreateDefaultContext()
    return np.split(system.EvalTimeDerivatives(context).CopyToVector()[7:], 2)


def on_plane(z, speeds=(0.0, 0.0, 0.0), **texts):
    return ball("Sphere to Plane Force", z, speeds, **(PLANE | texts))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("speed", "share"), [(5e-4, 0.3), (1.25e-3, 0.5), (0.4, 0.4)])
def test_a_sphere_is_pushed_and_rubbed_on_both_sides_of_a_plane(tmp_path, side, speed, share):
    alpha, a = accelerations(on_plane(side * 0.14, (speed, 0.0, -side * 0.1)), tmp_path)
    push = 1e4 * 0.01 + 50 * 0.1
    force = np.array([-share * push, 0.0, side * push])
    np.testing.assert_allclose(a, force / MASS - [0.0, 0.0, GRAVITY], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(
        alpha, np.cross([0.0, 0.0, -side * 0.1], force) / INERTIA, rtol=1e-9, atol=1e-9
    )


def test_nothing_acts_beside_the_rectangle_or_while_the_two_part(tmp_path):
    free = [0.0, 0.0, -GRAVITY]
    for beside in ({"plane_lenx": "0"}, {"plane_leny": "0"}):
        _, a = accelerations(on_plane(0.14, (0.2, 0.0, 0.0), **beside), tmp_path)
        np.testing.assert_allclose(a, free, atol=1e-12)
    _, a = accelerations(on_plane(0.14, (0.0, 0.0, 0.5)), tmp_path)
    assert MASS * (a[2] + GRAVITY) == pytest.approx(1e4 * 0.01)


def test_a_power_of_the_depth_pushes_and_the_damper_rises_smoothly(tmp_path):
    nonlinear = {"force_law": "Nonlinear", "pen_exponent": "1.5", "pen_full_damp_F": "0.02"}
    _, a = accelerations(
        on_plane(0.14, (0.3, 0.0, -0.1), friction_law="None", **nonlinear), tmp_path
    )
    assert MASS * (a[2] + GRAVITY) == pytest.approx(1e4 * 0.01**1.5 + 0.5 * 50 * 0.1)
    assert a[0] == 0.0


def test_spheres_push_each_other_apart_and_one_holds_another(tmp_path):
    beside = ball("Sphere to Sphere Force", 0.29, (0.4, 0.0, -0.1), sphB_rad="0.2", sphF_rad="0.1")
    inside = ball("Sphere in Sphere Force", 0.21, (0.4, 0.0, 0.1), sphB_rad="0.3", sphF_rad="0.1")
    push = 1e4 * 0.01 + 50 * 0.1
    for built, side in ((beside, 1.0), (inside, -1.0)):
        alpha, a = accelerations(built, tmp_path)
        force = np.array([-0.4 * push, 0.0, side * push])
        np.testing.assert_allclose(a, force / MASS - [0.0, 0.0, GRAVITY], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(
            alpha, np.cross([0.0, 0.0, -side * 0.1], force) / INERTIA, rtol=1e-9, atol=1e-9
        )


@pytest.mark.slow
def test_a_ball_bounces_without_loss_and_rolls_without_slip(tmp_path):
    built = on_plane(0.2, b_contact="0", friction_law="None")
    system = dynamics(built, tmp_path)
    start, later = system.CreateDefaultContext(), run(system, 0.27, accuracy=1e-9)
    assert energy(system, later) == pytest.approx(energy(system, start), rel=1e-5)
    tilt = math.radians(10)
    rest = 0.15 - MASS * GRAVITY * math.cos(tilt) / 1e4
    system = dynamics(on_plane(rest, tilt="10", v_thr="1e-3"), tmp_path)
    v = system.plant.GetVelocities(
        system.plant.GetMyContextFromRoot(run(system, 0.2, accuracy=1e-5))
    )
    speed = 5.0 / 7.0 * GRAVITY * math.sin(tilt) * 0.2
    assert math.hypot(v[3], v[5]) == pytest.approx(speed, rel=2e-3)
    assert math.hypot(v[3], v[5]) == pytest.approx(0.1 * v[1], rel=2e-3)


@pytest.mark.slow
def test_its_bus_is_seen(tmp_path):
    built = on_plane(0.14, (0.3, 0.0, -0.1))
    built.solver["StopTime"] = "1e-4"
    names = ("Normal Force", "Friction Force", "Frame Sep.z", "Penetration Vel")
    chosen = built.add_block(
        "BusSelector", "Chosen", {"OutputSignals": ",".join(names)}, ports={"in": 1, "out": 4}
    )
    scope = built.add_block("Scope", "Scope", ports={"in": 4})
    built.connect(f"{built.sid('Force')}#out:1", chosen)
    for place in range(4):
        built.connect(f"{chosen}#out:{place + 1}", f"{scope}#in:{place + 1}")
    shown = [one.values[0] for one in run_model(runnable(built.model(tmp_path))).shown]
    push = 1e4 * 0.01 + 50 * 0.1
    for seen, wanted in zip(shown, (push, [0.4 * push, 0.0, 0.0], 0.14, 0.1), strict=True):
        np.testing.assert_allclose(seen, wanted, rtol=1e-12, atol=1e-12)
    system = dynamics(built, tmp_path)
    found = sensed(system, system.CreateDefaultContext(), built, "Force out:1")
    assert found.size == 11


@pytest.mark.parametrize(
    ("texts", "sentence"),
    [
        ({"force_law": "Custom"}, "'Custom'.*Linear or Nonlinear: put Contact_Forces_Lib beside"),
        ({"friction_law": "Else"}, "friction_law 'Else'"),
        ({"v_thr": "0"}, "v_thr 0.0; it must be a positive number"),
    ],
)
def test_what_does_not_act_here_is_refused(tmp_path, texts, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        dynamics(on_plane(0.14, **texts), tmp_path)


def test_the_library_is_taken_where_it_is_found(tmp_path):
    library = ModelBuilder()
    folder = library.add_block("SubSystem", "3D")
    inner = library.add_block("SubSystem", "Sphere to Plane Force", system=folder)
    library.add_block("Gain", "Own", system=inner)
    library.write(tmp_path / "Contact_Forces_Lib.slx")
    kinds = {block.kind for block in read_model(on_plane(0.2).write(tmp_path / "m.slx")).blocks}
    assert "Gain" in kinds
    assert "Sphere to Plane Force" not in kinds
