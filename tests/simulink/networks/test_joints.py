"""Networks at the joints of a mechanism: motors on a pendulum, against Drake and by hand."""

import runpy

import numpy as np
import pytest
from circuits import Circuit
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import (
    RevoluteJoint,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder
from rigs import shown
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.porting import data_name, ported
from drake_leg.simulink.running.running import run_model, runnable
from drake_leg.simulink.running.summary import remarks_of, summary_of

TURNING, MECHANISMS = "Rotational Elements", "Mechanisms"
GRAVITY, MASS, LENGTH = 9.80665, 0.4, 1.0  # of a rod that hangs from its end
START = 1.0  # [rad]
ROD = MASS * (LENGTH**2 / 3.0 + 0.02**2 / 12.0)  # [kg*m^2] about the joint


def pendulum(**texts):
    """A rod below a joint whose velocity is sensed, and which takes a torque."""
    made = Circuit()
    add = made.add_library
    world = add("sm_lib/Frames and Transforms/World Frame", "World")
    gravity = add("sm_lib/Utilities/Mechanism Configuration", "gravity",
                  {"GravityVector": f"[0 -{GRAVITY} 0]"})  # fmt: skip
    joint = add("sm_lib/Joints/Revolute Joint", "Pivot", {
        "TorqueActuationMode": "InputTorque", "SenseVelocity": "on", "SensePosition": "on",
        "PositionTargetSpecify": "on", "PositionTargetValue": str(START),
        "PositionTargetValueUnits": "rad", "PositionTargetPriority": "High", **texts,
    })  # fmt: skip
    down = add("sm_lib/Frames and Transforms/Rigid Transform", "Down", {
        "TranslationMethod": "Cartesian", "TranslationCartesianOffset": "[0 -0.5 0]",
    })  # fmt: skip
    rod = add("sm_lib/Body Elements/Brick Solid", "Rod", {
        "BrickDimensions": "[0.02 1 0.02]", "BasedOnType": "Mass", "Mass": str(MASS),
    })  # fmt: skip
    made.physical(f"{world}#rconn:1", f"{gravity}#rconn:1", f"{joint}#lconn:1")
    made.physical(f"{joint}#rconn:1", f"{down}#lconn:1")
    made.physical(f"{down}#rconn:1", f"{rod}#rconn:1")
    leaves = made.block("nesl_utility/PS-Simulink Converter", "leaves angle")
    made.physical(f"{joint}#rconn:2", f"{leaves}#lconn:1")
    made.show(f"{leaves}#out:1", "angle")
    return made, joint


def interface(made, joint, R="s", C="rest"):
    """Connect a network to the joint by a block that is made for that."""
    sid = made.part("Multibody Interfaces", "Rotational Multibody Interface", "interface",
                    {"lconn:2": C, "rconn:2": R})  # fmt: skip
    made.physical(f"{joint}#rconn:3", f"{sid}#rconn:1")
    made.physical(f"{sid}#lconn:1", f"{joint}#lconn:2")


def shorted_motor(made, J="3e-3"):
    """A motor whose winding is shorted through a resistor, at the fast side of a gear."""
    made.ground()
    made.resistor("R", "p", "0", "2")
    made.part("Electrical Elements", "Rotational Electromechanical Converter", "converter",
              {"lconn:1": "p", "lconn:2": "fast", "rconn:1": "0", "rconn:2": "rest"},
              K="0.1")  # fmt: skip
    made.one(TURNING, "Inertia", "rotor", "fast", inertia=J)
    made.two(MECHANISMS, "Gear Box", "gear", "fast", "s", ratio="6")
    made.one(TURNING, "Mechanical Rotational Reference", "held", "rest")


def swung(times, inertia, damping):
    """Angles of the pendulum, by its equation."""

    def rate(_, state):
        q, w = state
        return [w, -(MASS * GRAVITY * LENGTH / 2.0 * np.sin(q) + damping * w) / inertia]

    span = (0.0, times[-1])
    return solve_ivp(rate, span, [START, 0.0], t_eval=times, rtol=1e-10, atol=1e-12).y[0]


def test_a_geared_rotor_swings_with_a_pendulum(tmp_path):
    made, joint = pendulum()
    shorted_motor(made)
    interface(made, joint)
    run = made.run(tmp_path, 0.3)
    expected = swung(run.time, ROD + 36.0 * 3e-3, 36.0 * 0.01 / 2.0)
    np.testing.assert_allclose(shown(run, "angle"), expected, atol=1e-7)


def test_a_sensed_torque_is_what_moves_the_joint(tmp_path):
    """It includes what the rotor takes: the rod's own inertia and gravity are left."""
    made, joint = pendulum(SenseActuatorTorque="on", SenseAcceleration="on")
    shorted_motor(made)
    interface(made, joint)
    made.shows(f"{joint}#rconn:4", "acceleration")
    made.shows(f"{joint}#rconn:5", "torque")
    run = made.run(tmp_path, 0.2)
    angle, acceleration = shown(run, "angle"), shown(run, "acceleration")
    expected = ROD * acceleration + MASS * GRAVITY * LENGTH / 2.0 * np.sin(angle)
    np.testing.assert_allclose(shown(run, "torque"), expected, atol=1e-12)


def test_a_target_of_what_a_joint_moves_is_refused(tmp_path):
    made, joint = pendulum()
    shorted_motor(made)
    made.one(TURNING, "Inertia", "more", "s", w_specify="on", w="7")
    interface(made, joint)
    with pytest.raises(InvalidValueError, match=r"'more'.* target 7 for what a signal moves"):
        made.run(tmp_path, 0.1)
    made.blocks[made.sid("more")].parameters["w_priority"] = "Low"
    assert made.run(tmp_path, 0.1).complete


@pytest.mark.parametrize("stays_rigid", [True, False])
def test_an_acceleration_that_is_not_known_is_named_by_its_joint(tmp_path, stays_rigid):
    """A torque that is shown depends on what the joint does, unless something soft is between."""
    made, joint = pendulum()
    shorted_motor(made)
    interface(made, joint, R="m")
    ends = {"lconn:1": "m", "rconn:1": "s" if stays_rigid else "n"}
    sensor = made.part("Mechanical Sensors", "Ideal Torque Sensor", "passes", ends)
    made.shows(f"{sensor}#rconn:2", "passed")
    if stays_rigid:
        with pytest.raises(
            InvalidValueError, match=r"'passes'.* acceleration of the joint 'Pivot'"
        ):
            made.run(tmp_path, 0.1)
        return
    made.two(TURNING, "Rotational Damper", "soft", "n", "s", D="1")
    assert made.run(tmp_path, 0.1).complete


def test_a_summary_tells_the_inertias_at_joints(tmp_path):
    made, joint = pendulum()
    shorted_motor(made)
    interface(made, joint)
    made.one(TURNING, "Rotational Free End", "end", "s")
    made.add_library("nesl_utility/Solver Configuration", "solver", {"DoDC": "on"})
    model = read_model(made.write(tmp_path / "m.slx"))
    ready = runnable(model, duration=0.0)
    run = run_model(ready)
    (felt,) = summary_of(model, ready, run, (), ())["understood"]["networks"]["inertias_at_joints"]
    assert felt == {"joint": "Pivot", "inertia": pytest.approx(36.0 * 3e-3, rel=1e-12)}
    assert any("not at rest as solver asks" in each for each in remarks_of(model, ready, run))


@pytest.mark.slow
def test_a_geared_rotor_is_that_of_a_joint_actuator_of_drakes(tmp_path):
    made, joint = pendulum()
    shorted_motor(made)
    interface(made, joint)
    run = made.run(tmp_path, 0.5)
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, 0.0)
    box = UnitInertia.SolidBox(0.02, LENGTH, 0.02).ShiftFromCenterOfMass([0.0, LENGTH / 2.0, 0.0])
    inertia = SpatialInertia(MASS, [0.0, -LENGTH / 2.0, 0.0], box)
    rod = plant.AddRigidBody("rod", inertia)
    pivot = plant.AddJoint(
        RevoluteJoint("pivot", plant.world_frame(), rod.body_frame(), [0, 0, 1], 36.0 * 0.01 / 2.0)
    )
    actuator = plant.AddJointActuator("motor", pivot)
    actuator.set_default_rotor_inertia(3e-3)
    actuator.set_default_gear_ratio(6.0)
    plant.mutable_gravity_field().set_gravity_vector([0.0, -GRAVITY, 0.0])
    plant.Finalize()
    simulator = Simulator(builder.Build())
    ApplySimulatorConfig(SimulatorConfig(accuracy=1e-10, max_step_size=0.01), simulator)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    pivot.set_angle(context, START)
    simulator.AdvanceTo(0.5)
    assert shown(run, "angle")[-1] == pytest.approx(pivot.get_angle(context), abs=1e-7)


@pytest.mark.slow
def test_sensors_and_sources_make_the_same_interface(tmp_path):
    """As before there were blocks for it: the velocity moves a source, a torque sensor answers."""
    made, joint = pendulum()
    shorted_motor(made)
    source = made.part("Mechanical Sources", "Ideal Angular Velocity Source", "follows",
                       {"lconn:1": "m", "rconn:2": "rest"})  # fmt: skip
    sensor = made.part("Mechanical Sensors", "Ideal Torque Sensor", "answers",
                       {"lconn:1": "m", "rconn:1": "s"})  # fmt: skip
    gain = made.add_library("fl_lib/Physical Signals/Functions/PS Gain", "minus", {"gain": "-1"})
    made.physical(f"{joint}#rconn:3", f"{source}#rconn:1")
    made.physical(f"{sensor}#rconn:2", f"{gain}#lconn:1")
    made.physical(f"{gain}#rconn:1", f"{joint}#lconn:2")
    run = made.run(tmp_path, 0.5)
    expected = swung(run.time, ROD + 36.0 * 3e-3, 36.0 * 0.01 / 2.0)
    np.testing.assert_allclose(shown(run, "angle"), expected, atol=1e-7)


@pytest.mark.slow
def test_a_torsion_spring_with_friction_holds_a_pendulum_back(tmp_path):
    """No inertia: a spring and a damper between the interface's ends."""
    made, joint = pendulum()
    made.two(TURNING, "Rotational Spring", "spring", "s", "rest", spr_rate="2")
    made.two(TURNING, "Rotational Damper", "damper", "s", "rest", D="0.1")
    made.one(TURNING, "Mechanical Rotational Reference", "held", "rest")
    interface(made, joint)
    run = made.run(tmp_path, 0.5)

    def rate(_, state):
        q, w = state
        pull = MASS * GRAVITY * LENGTH / 2.0 * np.sin(q) + 2.0 * (q - START) + 0.1 * w
        return [w, -pull / ROD]

    found = solve_ivp(rate, (0.0, 0.5), [START, 0.0], t_eval=run.time, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(shown(run, "angle"), found.y[0], atol=1e-7)


@pytest.mark.slow
def test_a_script_has_the_reflected_inertia(tmp_path):
    made, joint = pendulum()
    shorted_motor(made)
    interface(made, joint)
    model = read_model(made.write(tmp_path / "m.slx"))
    ready = runnable(model, duration=0.2)
    script = ported(model, ready, "alone", accuracy=1e-7)
    (tmp_path / "alone.py").write_text(script.text, encoding="utf-8")
    if script.data:
        (tmp_path / data_name("alone")).write_text(script.data, encoding="utf-8")
    theirs = runpy.run_path(str(tmp_path / "alone.py"))["run"]()
    ours = run_model(ready, accuracy=1e-7)
    np.testing.assert_allclose(theirs.states, ours.states, atol=1e-12)


def test_an_inertia_at_another_joint_is_refused(tmp_path):
    """The network follows one joint, and acts on another one."""
    made, joint = pendulum()
    world, rod = made.sid("World"), made.sid("Rod")
    other = made.add_library("sm_lib/Joints/Revolute Joint", "Other",
                             {"TorqueActuationMode": "InputTorque"})  # fmt: skip
    more = made.add_library("sm_lib/Body Elements/Brick Solid", "More")
    made.physical(f"{rod}#rconn:1", f"{other}#lconn:1")
    made.physical(f"{other}#rconn:1", f"{more}#rconn:1")
    assert world
    shorted_motor(made)
    sid = made.part("Multibody Interfaces", "Rotational Multibody Interface", "interface",
                    {"lconn:2": "rest", "rconn:2": "s"})  # fmt: skip
    made.physical(f"{joint}#rconn:3", f"{sid}#rconn:1")
    made.physical(f"{sid}#lconn:1", f"{other}#lconn:2")
    with pytest.raises(InvalidValueError, match=r"follow the velocity of the same axis"):
        made.run(tmp_path, 0.1)
