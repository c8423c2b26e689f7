from functools import cache

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces
from pydrake.systems.primitives import ConstantVectorSource, Gain, Integrator, Sine, VectorLogSink

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, build
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import SineStep
from drake_leg.models.plant import sdf_folder
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate

POSTURES = {
    LEG_A: tuple(np.radians([90.0, 50.0, 90.0])),
    LEG_B: tuple(np.radians([90.0, -50.0, -90.0])),
}
GRAVITY = 9.80665  # [m/s^2]
L1, L2, L3 = 0.050, 0.100, 0.100  # [m]
START = np.array(  # [m], by plane trigonometry: the femur dips by 50 degrees, the tibia by 140
    [
        0.0,
        L1 + L2 * np.cos(np.radians(50)) + L3 * np.cos(np.radians(140)),
        -L2 * np.sin(np.radians(50)) - L3 * np.sin(np.radians(140)),
    ]
)


def motion_of(changes):
    """Take the motion's numbers out of a config's."""
    names = ("amplitude", "frequency", "direction")
    numbers = {name: changes.pop(name) for name in names if name in changes}
    return {**changes, "motion": SineStep(**numbers)}


@cache
def step(robot=LEG_B, duration=20.0, **changes):
    config = HexabotLegConfig(robot=robot, q0=POSTURES[robot], **motion_of(changes))
    return simulate(build(config), start=start_on_motion, duration=duration)


def wires(diagram):
    """Block and port at the receiving end -> block and port at the sending end."""
    return {
        (into.get_name(), into.get_input_port(i).get_name()): (
            out.get_name(),
            out.get_output_port(o).get_name(),
        )
        for (into, i), (out, o) in diagram.connection_map().items()
    }


def diagram_of(**changes):
    return build(HexabotLegConfig(robot=LEG_B, q0=POSTURES[LEG_B], **motion_of(changes)))


@pytest.mark.slow
def test_the_foot_starts_where_the_reports_posture_puts_it():
    np.testing.assert_allclose(START, [0.0, 0.0377, -0.1409], atol=5e-5)
    for robot in (LEG_A, LEG_B):
        np.testing.assert_allclose(step(robot).scopes["foot positions"][0], START, atol=1e-15)


@pytest.mark.parametrize("robot", [LEG_B, LEG_A], ids=lambda robot: robot.name)
def test_the_foot_goes_strictly_forward_for_twenty_seconds(robot):
    run = step(robot)
    time, foot = run.time, run.scopes["foot positions"]
    assert run.stop_reason is None
    assert time[0] == 0.0
    assert time[-1] == 20.0
    np.testing.assert_allclose(foot[:, 0], 0.070 * (1 - np.cos(time)), atol=1e-9)
    np.testing.assert_allclose(foot[:, 1:], np.tile(START[1:], (len(time), 1)), atol=1e-9)
    assert np.ptp(foot[:, 0]) == pytest.approx(0.140, abs=1e-5)
    velocity = np.outer(0.070 * np.sin(time), [1, 0, 0])
    np.testing.assert_allclose(run.scopes["foot velocities"], velocity, atol=1e-9)


def test_both_legs_move_their_foot_and_turn_their_hip_alike():
    a, b = step(LEG_A), step(LEG_B)
    np.testing.assert_array_equal(a.time, b.time)
    for scope in ("foot positions", "foot velocities"):
        np.testing.assert_allclose(a.scopes[scope], b.scopes[scope], atol=1e-12)
    mirrored = b.scopes["joint positions"] * [1, -1, -1]
    np.testing.assert_allclose(a.scopes["joint positions"], mirrored, atol=1e-12)
    np.testing.assert_allclose(
        a.scopes["joint torques"], b.scopes["joint torques"] * [1, -1, -1], atol=1e-12
    )


@pytest.mark.slow
def test_the_determinant_swings_between_the_reports_values_along_the_closed_form():
    run = step()
    det_j = run.scopes["singularity check"][:, 0]
    assert det_j.min() == pytest.approx(3.767e-4, abs=5e-8)
    assert det_j.max() == pytest.approx(1.2994e-3, abs=5e-8)

    x = 0.070 * (1 - np.cos(run.time))
    reach = np.hypot(x, START[1])  # the foot's distance from the hip axis
    chord_2 = (reach - L1) ** 2 + START[2] ** 2  # from knee to foot, squared
    cosine = (chord_2 - L2**2 - L3**2) / (2 * L2 * L3)
    np.testing.assert_allclose(det_j, L2 * L3 * np.sqrt(1 - cosine**2) * reach, atol=1e-11)


@pytest.mark.parametrize("robot", [LEG_B, LEG_A], ids=lambda robot: robot.name)
def test_torques_are_inverse_dynamics_on_a_plant_parsed_from_the_sdf_file(robot):
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModels(str(sdf_folder() / f"{robot.name}.sdf"))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    plant.Finalize()
    context = plant.CreateDefaultContext()
    forces = MultibodyForces(plant)

    scopes = step(robot).scopes
    joints = (scopes[f"joint {kind}"] for kind in ("positions", "velocities", "accelerations"))
    for q, qdot, qddot, torque in zip(*joints, scopes["joint torques"], strict=True):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, qdot)
        plant.CalcForceElementsContribution(context, forces)
        expected = plant.CalcInverseDynamics(context, qddot, forces)
        np.testing.assert_allclose(torque, expected, rtol=0.0, atol=1e-15)


def test_rates_and_accelerations_are_derivatives_of_the_angles():
    settings = IntegratorSettings(max_step=0.01)
    run = simulate(diagram_of(), start=start_on_motion, duration=1.005, settings=settings)
    for of, is_its_rate in (("positions", "velocities"), ("velocities", "accelerations")):
        values = run.scopes[f"joint {of}"][:101]
        rates = run.scopes[f"joint {is_its_rate}"][:101]
        near, far = values[3:-1] - values[1:-3], values[4:] - values[:-4]
        np.testing.assert_allclose(rates[2:-2], (8 * near - far) / (12 * 0.01), atol=1e-6)


DIRECTIONS = [(0, 0, 1), (0, 0, -1), (0, 1, 0), (1, 1, 1), (-3, 2, -1), (2, -1, 5)]


@pytest.mark.parametrize("direction", DIRECTIONS, ids=str)
def test_the_foot_goes_straight_in_any_direction(direction):
    unit = tuple(float(x) for x in np.array(direction) / np.linalg.norm(direction))
    run = step(duration=2 * np.pi, amplitude=0.015, direction=unit)
    assert run.stop_reason is None
    moved = run.scopes["foot positions"] - START
    advance = 0.015 * (1 - np.cos(run.time))
    np.testing.assert_allclose(moved, np.outer(advance, unit), atol=1e-9)


def test_a_negative_amplitude_steps_backwards():
    forwards, backwards = step(duration=3.0), step(duration=3.0, amplitude=-0.070)
    mirrored = forwards.scopes["foot positions"] * [-1, 1, 1]
    np.testing.assert_allclose(backwards.scopes["foot positions"], mirrored, atol=1e-12)


@pytest.mark.slow
def test_a_gain_of_ten_moves_the_foot_like_no_gain_at_ten_times_the_sine():
    plain, gained = step(), step(gain=10.0)
    np.testing.assert_array_equal(plain.time, gained.time)
    for scope in ("foot positions", "foot velocities", "joint positions"):
        np.testing.assert_allclose(plain.scopes[scope], gained.scopes[scope], atol=1e-12)
    sine = gained.scopes["input"][:, 0]
    np.testing.assert_allclose(sine, 0.007 * np.sin(gained.time), atol=1e-15)
    np.testing.assert_allclose(gained.scopes["foot velocities"][:, 0], 10 * sine, atol=1e-9)


def test_gravity_changes_the_torques_and_not_the_motion():
    on_earth, in_space = step(duration=3.0), step(duration=3.0, gravity=0.0)
    for scope in ("foot positions", "joint positions"):
        np.testing.assert_allclose(on_earth.scopes[scope], in_space.scopes[scope], atol=1e-10)
    heavy, light = (abs(run.scopes["joint torques"]).max(axis=0) for run in (on_earth, in_space))
    assert np.all(heavy[1:] > 10 * light[1:])  # the hip's axis is vertical


def test_the_power_of_the_joints_is_the_rate_of_the_energy():
    """Integral of tau qdot over time by Simpson's rule; energy by the plant's mass matrix."""
    settings = IntegratorSettings(max_step=0.01)
    run = simulate(diagram_of(), start=start_on_motion, duration=1.6, settings=settings)
    last = len(run.time) // 2 * 2 - 2
    rows = slice(0, last + 1)  # an even number of equal steps
    np.testing.assert_allclose(np.diff(run.time[rows]), 0.01, atol=1e-12)
    tau, qdot = run.scopes["joint torques"][rows], run.scopes["joint velocities"][rows]
    power = (tau * qdot).sum(axis=1)
    h = run.time[1]
    work = h / 3 * (power[0] + 4 * power[1:-1:2].sum() + 2 * power[2:-2:2].sum() + power[-1])

    plant = diagram_of().GetSubsystemByName("leg_b")
    context = plant.CreateDefaultContext()

    def energy(row):
        plant.SetPositions(context, run.scopes["joint positions"][row])
        plant.SetVelocities(context, run.scopes["joint velocities"][row])
        return plant.CalcKineticEnergy(context) + plant.CalcPotentialEnergy(context)

    assert work == pytest.approx(energy(last) - energy(0), abs=1e-10)
    assert abs(work) > 1e-6


def test_its_blocks_have_simulinks_names_and_kinds():
    diagram = diagram_of()
    kinds = {system.get_name(): type(system) for system in diagram.GetSystems()}
    assert kinds["Sine Wave"] is Sine
    assert kinds["dy"] is kinds["dz"] is ConstantVectorSource
    assert {"Mux", "inverseJacobian", "Demux", "6-DOF Joint", "leg_b"} <= set(kinds)
    assert [kinds[f"Integrator {i}"] for i in (1, 2, 3)] == [Integrator] * 3
    assert Gain not in kinds.values()
    scopes = {name for name, kind in kinds.items() if kind is VectorLogSink}
    assert scopes >= {"foot positions", "foot velocities", "Q", "singularity check", "input"}


def test_its_wires_are_the_pictures():
    assert (
        wires(diagram_of()).items()
        >= {
            ("Mux", "u0"): ("Sine Wave", "y0"),
            ("Mux", "u1"): ("dy", "y0"),
            ("Mux", "u2"): ("dz", "y0"),
            ("inverseJacobian", "v"): ("Mux", "y0"),
            ("Demux", "u0"): ("inverseJacobian", "qdot"),
            ("Integrator 1", "u0"): ("Demux", "y0"),
            ("Integrator 2", "u0"): ("Demux", "y1"),
            ("Integrator 3", "u0"): ("Demux", "y2"),
            ("Simulink-PS Converters", "u0"): ("Integrator 1", "y0"),
            ("Simulink-PS Converters", "u1"): ("Integrator 2", "y0"),
            ("Simulink-PS Converters", "u2"): ("Integrator 3", "y0"),
            ("Prescribed Motion", "q"): ("Simulink-PS Converters", "y0"),
            ("Prescribed Motion", "qdot"): ("inverseJacobian", "qdot"),
            ("Prescribed Motion", "qddot"): ("inverseJacobian", "qddot"),
            ("leg_b", "actuation"): ("Prescribed Motion", "torque"),
            ("6-DOF Joint", "state"): ("leg_b", "state"),
            ("singularity check", "data"): ("inverseJacobian", "det_j"),
        }.items()
    )


def test_the_jacobian_takes_its_angles_from_the_plants_sensors():
    connected = wires(diagram_of())
    assert connected["inverseJacobian", "q"] == ("PS-Simulink Converters", "y0")
    assert connected["PS-Simulink Converters", "u0"] == ("leg_b", "state")


def test_its_acceleration_comes_from_the_sines_derivative():
    connected = wires(diagram_of())
    assert connected["inverseJacobian", "a"] == ("Mux of the derivatives", "y0")
    assert connected["Mux of the derivatives", "u0"] == ("Sine Wave", "y1")


def test_a_gain_stands_between_the_sine_and_the_mux():
    connected = wires(diagram_of(gain=10.0))
    assert connected["Gain", "u0"] == ("Sine Wave", "y0")
    assert connected["Mux", "u0"] == ("Gain", "y0")
    assert connected["input", "data"] == ("Sine Wave", "y0")


def test_every_input_port_of_every_block_is_connected():
    for diagram in (diagram_of(), diagram_of(gain=2.0, direction=(0.0, 1.0, 0.0))):
        connected = diagram.connection_map()
        for system in diagram.GetSystems():
            if system.get_name() == "leg_b":
                continue
            for index in range(system.num_input_ports()):
                assert (system, system.get_input_port(index).get_index()) in connected


def test_the_integrators_start_at_the_initial_angles():
    run = step(duration=0.04)
    np.testing.assert_allclose(run.scopes["joint positions"][0], POSTURES[LEG_B], atol=1e-15)
    np.testing.assert_allclose(run.scopes["joint velocities"][0], 0.0, atol=1e-15)


NAN = float("nan")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"q0": (0.0, 1.0)}, "q0 has 2 numbers; leg_b has 3 joint positions"),
        ({"q0": (0.0, NAN, 1.0)}, "nan"),
        ({"amplitude": NAN}, "amplitude is nan"),
        ({"amplitude": float("inf")}, "amplitude is inf"),
        ({"frequency": 0.0}, "frequency is 0.0"),
        ({"frequency": -1.0}, "frequency is -1.0"),
        ({"gain": 0.0}, "gain is 0.0"),
        ({"gain": NAN}, "gain is nan"),
        ({"direction": (1.0, 1.0, 0.0)}, "must have length 1"),
        ({"direction": (NAN, 0.0, 0.0)}, "must be three finite numbers"),
        ({"robot": SCARA}, "scara"),
    ],
)
def test_senseless_settings_are_refused(change, said):
    with pytest.raises(InvalidValueError, match=said):
        HexabotLegConfig(**{"robot": LEG_B, "q0": POSTURES[LEG_B], **motion_of(dict(change))})


@pytest.mark.parametrize("gravity", [-1.0, NAN, float("inf")])
def test_senseless_gravity_is_refused(gravity):
    with pytest.raises(InvalidValueError, match=f"gravity is {gravity}"):
        diagram_of(gravity=gravity)
