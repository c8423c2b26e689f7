from functools import cache

import numpy as np
import pytest

from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.diagrams.scara import ScaraConfig, build
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import SineStep
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.simulation.run import simulate

L1, L2 = 0.220, 0.240  # [m]
Q0 = np.radians([30.0, 90.0, -120.0])


def motion_of(changes):
    """Take the motion's numbers out of a config's."""
    names = ("amplitude", "frequency", "direction")
    numbers = {name: changes.pop(name) for name in names if name in changes}
    return {**changes, "motion": SineStep(**{"amplitude": 0.050, **numbers})}


@cache
def run_of(duration=20.0, **changes):
    return simulate(
        build(ScaraConfig(robot=SCARA, **motion_of(changes))),
        start=start_on_motion,
        duration=duration,
    )


def tool_of(q):
    """x, y by plane trigonometry."""
    return np.array(
        [
            L1 * np.cos(q[0]) + L2 * np.cos(q[0] + q[1]),
            L1 * np.sin(q[0]) + L2 * np.sin(q[0] + q[1]),
        ]
    )


@pytest.mark.slow
def test_the_tool_goes_along_x_with_height_and_yaw_constant():
    run = run_of()
    tool, q = run.scopes["foot positions"], run.scopes["joint positions"]
    x0, y0 = tool_of(Q0)
    assert run.stop_reason is None
    np.testing.assert_allclose(tool[:, 0], x0 + 0.050 * (1 - np.cos(run.time)), atol=1e-9)
    np.testing.assert_allclose(tool[:, 1], y0, atol=1e-9)
    np.testing.assert_allclose(tool[:, 2], 0.340 + 0.050, atol=1e-12)
    np.testing.assert_allclose(q[:, :3].sum(axis=1), Q0.sum(), atol=1e-9)
    np.testing.assert_allclose(q[:, 3], 0.4524 - 0.340 - 0.050, atol=1e-12)


def test_the_tool_does_not_turn_and_points_down():
    scopes = run_of().scopes
    yaw = Q0.sum()
    expected = [0.0, np.cos(yaw / 2), np.sin(yaw / 2), 0.0]  # Rz(yaw) Rx(180 deg)
    alignment = abs(scopes["Q"] @ expected)
    np.testing.assert_allclose(alignment, 1.0, atol=1e-12)
    np.testing.assert_allclose(scopes["foot angular velocities"], 0.0, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [45, 90, 200])
def test_the_tool_goes_straight_in_any_horizontal_direction(degrees):
    along = (float(np.cos(np.radians(degrees))), float(np.sin(np.radians(degrees))), 0.0)
    run = run_of(duration=6.4, amplitude=0.04, direction=along)
    moved = run.scopes["foot positions"] - run.scopes["foot positions"][0]
    np.testing.assert_allclose(moved, np.outer(0.04 * (1 - np.cos(run.time)), along), atol=1e-9)


def test_the_lift_bears_the_tools_weight_and_the_arms_none():
    scopes = run_of(duration=0.04).scopes
    still = simulate(
        build(ScaraConfig(robot=SCARA, motion=SineStep(amplitude=0.0))),
        start=start_on_motion,
        duration=1.0,
    )
    mass = 2700 * np.pi * 0.010**2 * 0.1124  # the tool
    np.testing.assert_allclose(still.scopes["joint torques"][:, :3], 0.0, atol=1e-9)
    # q4 grows downwards, so that holding the tool up pulls against it
    np.testing.assert_allclose(still.scopes["joint torques"][:, 3], -mass * 9.80665, rtol=1e-9)
    assert scopes["joint torques"].shape[1] == 4


def test_the_determinant_is_the_closed_form():
    run = run_of()
    expected = L1 * L2 * np.sin(run.scopes["joint positions"][:, 1])
    np.testing.assert_allclose(run.scopes["singularity check"][:, 0], expected, atol=1e-15)


def test_its_wires_are_the_pictures():
    connected = {
        (into.get_name(), into.get_input_port(i).get_name()): (
            out.get_name(),
            out.get_output_port(o).get_name(),
        )
        for (into, i), (out, o) in build(ScaraConfig(robot=SCARA)).connection_map().items()
    }
    assert (
        connected.items()
        >= {
            ("Direction", "u0"): ("Sine Wave", "y0"),
            ("inverseJacobian", "v"): ("Direction", "y0"),
            ("inverseJacobian", "q"): ("Angles", "y0"),
            ("Angles", "u0"): ("PS-Simulink Converters", "y0"),
            ("PS-Simulink Converters", "u0"): ("scara", "state"),
            ("Demux", "u0"): ("inverseJacobian", "qdot"),
            ("Integrator 3", "u0"): ("Demux", "y2"),
            ("Simulink-PS Converters", "u3"): ("Lift", "y0"),
            ("scara", "actuation"): ("Prescribed Motion", "torque"),
        }.items()
    )


NAN = float("nan")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"q0": (0.0, NAN, 1.0)}, "nan"),
        ({"R": -0.001}, "R is -0.001"),
        ({"R": 0.2}, "R is 0.2"),
        ({"R": NAN}, "R is nan"),
        ({"amplitude": NAN}, "amplitude is nan"),
        ({"frequency": -2.0}, "frequency is -2.0"),
        ({"direction": (2.0, 0.0, 0.0)}, "length 1"),
        ({"direction": (0.6, 0.0, 0.8)}, "horizontal"),
        ({"robot": LEG_B}, "leg_b"),
    ],
)
def test_senseless_settings_are_refused(change, said):
    with pytest.raises(InvalidValueError, match=said):
        ScaraConfig(**{"robot": SCARA, **motion_of(dict(change))})
