"""Mechanisms in motion, against closed forms, hand-written equations, and energy."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, four_bar, pendulum
from moving import GRAVITY, dynamics, energy, port, run, sensed, wired, with_gravity
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError

ABOUT_END = 0.4 * (1.0**2 + 0.02**2) / 12.0 + 0.4 * 0.5**2  # of the rod [kg*m^2]
WEIGHT = 0.4 * GRAVITY * 0.5  # its greatest moment [N*m]


@pytest.mark.slow
def test_a_pendulum_is_where_its_equation_says(tmp_path):
    texts = {
        "SpringStiffness": "2", "SpringStiffnessUnits": "N*m/rad",
        "DampingCoefficient": "0.1", "DampingCoefficientUnits": "N*m/(rad/s)",
        "PositionTargetSpecify": "on", "PositionTargetValue": "60",
        "VelocityTargetSpecify": "on", "VelocityTargetValue": "5",
        "VelocityTargetValueUnits": "rad/s",
        "UpperLimitSpecify": "on", "UpperLimitBound": "70", "UpperLimitSpringStiffness": "2",
        "UpperLimitDampingCoefficient": "0.02", "UpperLimitTransitionRegionWidth": "3",
        "SensePosition": "on", "SenseVelocity": "on", "SenseUpperLimitTorqueForce": "on",
    }  # fmt: skip
    built = with_gravity(pendulum(**texts))
    wired(built, "Pivot", "rconn:2", "rconn:3", "rconn:4")
    system = dynamics(built, tmp_path)

    def limit(q, v):
        depth = q - math.radians(70)
        s = min(max(depth / math.radians(3), 0.0), 1.0)
        push = max(0.0, math.degrees(2) * depth + math.degrees(0.02) * v)
        return -(s**2) * (3 - 2 * s) * push

    def rate(_, state):
        q, v = state
        return [v, (limit(q, v) - 2 * q - 0.1 * v - WEIGHT * math.sin(q)) / ABOUT_END]

    start = [math.pi / 3, 5.0]
    exact = solve_ivp(rate, (0, 0.3), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    context = run(system, 0.3)
    found = [float(sensed(system, context, built, f"Pivot rconn:{n}")) for n in (2, 3, 4)]
    np.testing.assert_allclose(found, [*exact, limit(*exact)], atol=2e-6)
    top = run(system, 0.05)
    assert float(sensed(system, top, built, "Pivot rconn:4")) < -1.0


def test_a_torque_and_what_it_gives_are_an_input_and_outputs(tmp_path):
    built = pendulum(
        TorqueActuationMode="InputTorque", SenseAcceleration="on", SenseTorqueForce="on"
    )
    wired(built, "Pivot", "lconn:2", "rconn:2", "rconn:3")
    system = dynamics(built, tmp_path)
    assert dict(system.inputs) == {port(built, "Pivot lconn:2"): slice(0, 1)}
    assert not system.motions
    context = system.CreateDefaultContext()
    system.GetInputPort("u").FixValue(context, [0.7])
    assert sensed(system, context, built, "Pivot rconn:2") == pytest.approx(0.7 / ABOUT_END)
    assert sensed(system, context, built, "Pivot rconn:3") == pytest.approx(0.7)
    assert system.EvalTimeDerivatives(context)[1] == pytest.approx(0.7 / ABOUT_END)


def test_a_motion_is_followed_and_its_torque_is_inverse_dynamics(tmp_path):
    built = with_gravity(
        pendulum(
            TorqueActuationMode="ComputedTorque",
            MotionActuationMode="InputMotion",
            SenseTorqueForce="on",
        )
    )
    wired(built, "Pivot", "lconn:2", "rconn:2")
    system = dynamics(built, tmp_path)
    assert system.motions == {port(built, "Pivot lconn:2")}
    context = system.CreateDefaultContext()
    motion = np.array([0.4, 1.5, -3.0])
    system.GetInputPort("u").FixValue(context, motion)
    system.start(context, motion)
    np.testing.assert_allclose(context.get_continuous_state_vector().CopyToVector(), motion[:2])
    assert system.EvalTimeDerivatives(context)[1] == pytest.approx(-3.0)
    torque = ABOUT_END * -3.0 + WEIGHT * math.sin(0.4)
    assert sensed(system, context, built, "Pivot rconn:2") == pytest.approx(torque)


@pytest.mark.slow
def test_a_four_bar_keeps_its_loop_closed_and_its_energy(tmp_path):
    texts = {"PositionTargetSpecify": "on", "PositionTargetValue": "60"}
    built = with_gravity(four_bar(**texts), GravityVector="[0 -9.81 0]")
    system = dynamics(built, tmp_path)
    start = energy(system, system.CreateDefaultContext())
    context = run(system, 0.2, accuracy=1e-7)
    own = system.plant.GetMyContextFromRoot(context)
    assert system.plant.CalcKineticEnergy(own) > 0.01
    assert energy(system, context) == pytest.approx(start, abs=1e-8)


@pytest.mark.slow
def test_a_parallelogram_that_starts_flat_stays_one(tmp_path):
    """Flat, its loop has two independent constraints; then three, and its crank turns evenly."""
    rate, target = 100.0, {"TargetSpecify": "on", "TargetPriority": "High"}
    moving = {f"Velocity{name}": text for name, text in target.items()}
    placed = {f"Position{name}": text for name, text in target.items()}
    built = four_bar(ground=0.3, crank=0.1, coupler=0.3, rocker=0.1)
    for joint, value in (("A", rate), ("B", -rate), ("C", rate)):
        turning = {**moving, "VelocityTargetValue": str(value)}
        built.blocks[built.sid(joint)].parameters.update(turning)
    for joint, value in (("A", "0"), ("C", "180")):
        built.blocks[built.sid(joint)].parameters.update({**placed, "PositionTargetValue": value})
    system = dynamics(built, tmp_path)
    context = run(system, 0.2)
    q = system.plant.GetPositions(system.plant.GetMyContextFromRoot(context))
    turned = math.radians(rate) * 0.2
    np.testing.assert_allclose(q[[0, 2]], [turned, math.pi + turned], rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_loop_that_cannot_be_closed_is_refused(tmp_path):
    system = dynamics(four_bar(ground=2.0), tmp_path)
    with pytest.raises(InvalidValueError, match=r"'D' stay .* open at the start"):
        system.CreateDefaultContext()


def spun(kind, **texts):
    """A plate on a joint of a kind, off its center of mass, with a sensor at its corner."""
    built = MechanismBuilder()
    built.joint(kind, "Joint", **texts)
    built.transform("Arm", offset="[0.1 0.2 -0.3]", axis="+X", angle="35")
    built.body("Brick Solid", "Plate", BrickDimensions="[0.3 0.2 0.1]")
    built.meet("World", "Joint lconn:1")
    built.meet("Joint", "Arm lconn:1")
    built.meet("Arm", "Plate")
    return built


def test_a_floating_body_senses_as_its_joint(tmp_path):
    texts = {f"P{a}SensePosition": "on" for a in "xyz"} | {
        f"P{a}SenseVelocity": "on" for a in "xyz"
    }
    texts |= {
        "SphSensePosition": "on", "SphSenseVelocity": "on",
        "PxVelocityTargetSpecify": "on", "PxVelocityTargetValue": "2",
        "SphVelocityTargetSpecify": "on", "SphVelocityTargetValue": "[1 2 3]",
        "SphVelocityTargetValueUnits": "rad/s", "PyPositionTargetSpecify": "on",
        "PyPositionTargetValue": "0.5",
    }  # fmt: skip
    built = spun("6-DOF", **texts)
    wired(built, "Joint", *(f"rconn:{n}" for n in range(2, 10)))
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    found = [sensed(system, context, built, f"Joint rconn:{n}") for n in range(2, 10)]
    np.testing.assert_allclose(found[:6], [0.0, 2.0, 0.5, 0.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(found[6], [1.0, 0.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(found[7], [1.0, 2.0, 3.0], rtol=1e-14)


def test_a_joint_without_mass_is_driven_but_not_free(tmp_path):
    texts = {"MotionActuationMode": "InputMotion", "TorqueActuationMode": "ComputedTorque"}
    for driven in (True, False):
        built = MechanismBuilder()
        built.joint("Prismatic", "Rail", **(texts if driven else {}), SenseTorqueForce="on")
        built.transform("End")
        built.meet("World", "Rail lconn:1")
        built.meet("Rail", "End lconn:1")
        if not driven:
            with pytest.raises(InvalidValueError, match="'Rail' move nothing that has mass"):
                dynamics(built, tmp_path)
            continue
        wired(built, "Rail", "lconn:2", "rconn:2")
        system = dynamics(built, tmp_path)
        context = system.CreateDefaultContext()
        system.GetInputPort("u").FixValue(context, [0.0, 0.0, 3.0])
        assert system.EvalTimeDerivatives(context)[1] == pytest.approx(3.0)
        assert sensed(system, context, built, "Rail rconn:2") == pytest.approx(0.0, abs=1e-12)


def test_what_crosses_a_joint_is_its_reaction(tmp_path):
    names = ("ConstraintForce", "ConstraintTorque", "TotalForce", "TotalTorque")
    for reverse in (False, True):
        texts = {f"Sense{name}": "on" for name in names} | {
            "TorqueActuationMode": "InputTorque", "CompositeWrenchDir": "BaseOnFollower",
            "DampingCoefficient": "0.3", "DampingCoefficientUnits": "N*m/(rad/s)",
        }  # fmt: skip
        built = with_gravity(MechanismBuilder())
        built.joint("Revolute", "Pivot", **texts)
        built.transform("Arm", offset="[0.3 -0.2 0.5]", axis="+X", angle="35")
        built.body("Ellipsoidal Solid", "Body", EllipsoidRadii="[0.1 0.2 0.3]")
        built.transform("Tilt", axis="+Y", angle="50")
        near, far = ("rconn:1", "lconn:1") if reverse else ("lconn:1", "rconn:1")
        built.meet("World", "Tilt lconn:1")
        built.meet("Tilt", f"Pivot {near}")
        built.meet(f"Pivot {far}", "Arm lconn:1")
        built.meet("Arm", "Body")
        wired(built, "Pivot", "lconn:2", *(f"rconn:{n}" for n in range(2, 6)))
        system = dynamics(built, tmp_path)
        context = system.CreateDefaultContext()
        system.GetInputPort("u").FixValue(context, [0.7])
        context.SetContinuousState([0.4, 1.3])
        fc, tc, ft, tt = (sensed(system, context, built, f"Pivot rconn:{n}") for n in range(2, 6))
        plant = system.plant
        own = plant.GetMyContextFromRoot(context)
        pivot = plant.GetJointByName("Pivot")
        reaction = plant.get_reaction_forces_output_port().Eval(own)[int(pivot.index())]
        # On the outer body at the joint, in its frame, which for the base is the base's own.
        R = np.eye(3)
        if not reverse:
            R = pivot.frame_on_child().CalcRotationMatrix(own, pivot.frame_on_parent()).matrix()
        sign = -1.0 if reverse else 1.0
        np.testing.assert_allclose(ft, sign * R @ reaction.translational(), atol=1e-9)
        np.testing.assert_allclose(fc, ft, atol=1e-12)
        np.testing.assert_allclose(tc[:2], sign * (R @ reaction.rotational())[:2], atol=1e-9)
        np.testing.assert_allclose(tt[:2], tc[:2])
        assert tc[2] == pytest.approx(0.0, abs=1e-12)
        assert tt[2] == pytest.approx(0.7 - 0.3 * 1.3)


def test_a_mechanism_that_stands_still_is_one(tmp_path):
    built = MechanismBuilder()
    built.body("Brick Solid", "Table", BrickDimensions="[1 1 1]")
    built.meet("World", "Table")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    assert system.GetOutputPort("state").Eval(context).size == 0
    assert system.GetOutputPort("efforts").Eval(context).size == 0


@pytest.mark.parametrize("state", [[math.nan, 0.0], [0.0, math.inf]])
def test_a_state_that_is_not_finite_ends_a_run_and_not_python(state, tmp_path):
    """Drake raises SystemExit there, which would take the recording with it."""
    built = pendulum(SpringStiffness="2", SpringStiffnessUnits="N*m/rad")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    context.get_mutable_continuous_state_vector().SetFromVector(state)
    with pytest.raises(ArithmeticError, match="of the mechanism is not finite"):
        system.EvalTimeDerivatives(context)


@pytest.mark.parametrize(
    ("lengths", "target", "names"),
    [
        ({}, {}, ["D"]),
        ({}, {"PositionTargetSpecify": "on", "PositionTargetValue": "20"}, []),
        ({"ground": 0.7}, {}, []),  # closed at 0
    ],
)
def test_loops_that_may_close_to_either_side_are_named(lengths, target, names, tmp_path):
    assert dynamics(four_bar(**lengths, **target), tmp_path).unguided_loops() == names
