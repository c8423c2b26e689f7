from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipj, ellipk

from drake_leg.errors import InvalidValueError
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.pendulum_options import (
    DampedPendulumOptions,
    FreePendulumOptions,
    SpringPendulumOptions,
)

run_pendulum = RUNS["pendulum"].run

MASS, LENGTH, WIDTH, GRAVITY = 1000 * 0.4 * 0.01 * 0.01, 0.4, 0.01, 9.80665
INERTIA = MASS * (LENGTH**2 + WIDTH**2) / 12 + MASS * LENGTH**2 / 4
TORQUE = MASS * GRAVITY * LENGTH / 2
OMEGA = np.sqrt(TORQUE / INERTIA)


@cache
def run_of(kind, **changes):
    changes = {name: list(v) if isinstance(v, tuple) else v for name, v in changes.items()}
    return run_pendulum(kind(**changes))


def free(**changes):
    return run_of(FreePendulumOptions, **changes)


def damped(**changes):
    return run_of(DampedPendulumOptions, **changes)


def sprung(**changes):
    return run_of(SpringPendulumOptions, **changes)


def exact_period(q0):
    return 4 * ellipk(np.sin((q0 - np.pi / 2) / 2) ** 2) / OMEGA


# --- free ------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_free_pendulum_keeps_its_energy():
    summary, energy = free().summary, free().recording["energy"]
    assert summary["duration_s"] == 10.0
    assert summary["energy_drift"] <= 1e-8
    assert abs(energy - energy[0]).max() / TORQUE <= 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 60.0, 260.0, 720.0])
def test_its_period_is_the_elliptic_integral(degrees):
    summary = free(q0=(degrees,), duration=4.0).summary
    expected = exact_period(np.radians(degrees))
    assert summary["exact_period_s"] == pytest.approx(expected, rel=1e-12)
    assert summary["period_s"] == pytest.approx(expected, abs=1e-8)


def test_from_the_horizontal_the_period_is_18_percent_longer_than_that_of_small_swings():
    assert free().summary["period_s"] * OMEGA / (2 * np.pi) == pytest.approx(1.18034, abs=1e-5)
    small = free(q0=(89.9,), duration=2.5).summary["period_s"]
    assert small * OMEGA / (2 * np.pi) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("degrees", [0.0, -60.0])
def test_its_angle_is_jacobis_elliptic_function(degrees):
    outcome = free(q0=(degrees,), duration=4.0)
    time, q, qdot = (outcome.recording[name] for name in ("time", "q", "qdot"))
    phi0 = np.radians(degrees) - np.pi / 2
    k = np.sin(phi0 / 2)
    sn, cn, dn, _ = ellipj(OMEGA * time, k**2)
    np.testing.assert_allclose(q, np.pi / 2 + 2 * np.arcsin(k * cn / dn), atol=1e-8)
    rate = -2 * OMEGA * k * np.sqrt(1 - k**2) * sn / dn
    np.testing.assert_allclose(qdot, rate, atol=1e-7)
    np.testing.assert_allclose(outcome.exact["q"], q, atol=1e-8)
    assert outcome.summary["max_angle_error_rad"] <= 1e-8


def test_a_run_of_less_than_a_swing_has_no_measured_period():
    summary = free(duration=0.9).summary
    assert summary["period_s"] is None
    assert summary["exact_period_s"] == pytest.approx(exact_period(0.0))


@pytest.mark.slow
def test_a_pendulum_that_hangs_or_has_no_weight_has_no_period():
    for change in ({"q0": (90.0,)}, {"gravity": 0.0}):
        summary = free(duration=4.0, **change).summary
        assert summary["period_s"] is None
        assert summary["exact_period_s"] is None


def test_without_gravity_nothing_moves_and_the_drift_is_zero():
    outcome = free(gravity=0.0, q0=(20.0,), duration=4.0)
    np.testing.assert_array_equal(outcome.recording["q"], np.radians(20.0))
    assert outcome.summary["energy_drift"] == 0.0


@pytest.mark.slow
def test_size_density_and_gravity_act():
    size = (0.5, 0.03, 0.01)
    inertia = (0.5**2 + 0.03**2) / 12 + 0.5**2 / 4  # per mass
    omega = np.sqrt(1.62 * 0.25 / inertia)
    expected = 4 * ellipk(0.5) / omega
    slow = free(size=size, gravity=1.62, density=700.0, duration=6.0)
    assert slow.summary["period_s"] == pytest.approx(expected, abs=1e-8)
    dense = free(size=size, gravity=1.62, density=1400.0, duration=6.0)
    np.testing.assert_allclose(dense.recording["q"], slow.recording["q"], atol=1e-10)
    assert dense.recording["qdot"].max() == pytest.approx(slow.recording["qdot"].max())


def test_its_columns_have_units():
    headers = ["time[s]", "q[rad]", "qdot[rad/s]", "qddot[rad/s^2]", "energy[J]"]
    for outcome in (run(duration=0.1) for run in (free, damped, sprung)):
        assert list(outcome.recording.columns) == headers


# --- damped ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_damped_pendulum_starts_at_its_target_and_rests_hanging():
    outcome = damped()
    q, summary = outcome.recording["q"], outcome.summary
    assert summary["duration_s"] == 30.0
    assert q[0] == summary["q0_rad"] == pytest.approx(np.radians(30.0))
    assert summary["exact_rest_angle_rad"] == pytest.approx(np.pi / 2, abs=1e-15)
    assert summary["rest_angle_rad"] == pytest.approx(np.pi / 2, abs=1e-6)
    assert abs(q[-1] - np.radians(30.0)) > 1.0  # a state target does not attract
    assert summary["period_s"] is None
    assert summary["energy_drift"] is None


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [-45.0, 200.0])
def test_it_rests_hanging_whatever_its_target(degrees):
    summary = damped(target=degrees, damping=0.02, duration=6.0).summary
    down = summary["rest_angle_rad"] - np.pi / 2
    assert down == pytest.approx(2 * np.pi * round(down / (2 * np.pi)), abs=1e-6)


@pytest.mark.slow
def test_simscapes_unit_damps_57_times_as_hard():
    in_si = damped(damping=0.001 * 180 / np.pi, duration=2.0)
    in_simscapes = damped(damping=0.001, damping_unit="N*m/(deg/s)", duration=2.0)
    np.testing.assert_allclose(in_si.recording["q"], in_simscapes.recording["q"], atol=1e-12)


@pytest.mark.slow
def test_small_swings_die_out_with_the_linear_decrement():
    """q - pi/2 = phi0 exp(-c t / 2 I) (cos + ...): peaks fall by exp(-c T / 2 I)."""
    damping = 0.002
    outcome = damped(target=89.9, damping=damping, duration=8.0)
    time, phi = outcome.recording["time"], outcome.recording["q"] - np.pi / 2
    decay = damping / (2 * INERTIA)
    omega = np.sqrt(OMEGA**2 - decay**2)
    phi0 = np.radians(-0.1)
    exact = (
        phi0 * np.exp(-decay * time) * (np.cos(omega * time) + decay / omega * np.sin(omega * time))
    )
    np.testing.assert_allclose(phi, exact, atol=2e-8)


def test_a_run_that_has_not_come_to_rest_says_no_rest_angle():
    summary = damped(duration=2.0, damping=0.001).summary
    assert summary["rest_angle_rad"] is None
    assert summary["exact_rest_angle_rad"] is None


@pytest.mark.parametrize("duration", [1e-6, 1e-5])
def test_a_run_that_has_hardly_begun_has_not_come_to_rest(duration):
    assert damped(duration=duration).summary["rest_angle_rad"] is None


# --- with a spring ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "target"),
    [
        (5.0, 30.0),
        (0.5, 30.0),
        (1.0, -20.0),
        pytest.param(50.0, 120.0, marks=pytest.mark.slow),
    ],
)
def test_the_spring_holds_it_where_the_torques_balance(stiffness, target):
    summary = sprung(spring_stiffness=stiffness, target=target, damping=0.05, duration=4.0).summary

    def torque(q):
        return TORQUE * np.cos(q) - stiffness * (q - np.radians(target))

    rest = brentq(torque, *sorted((np.radians(target), np.pi / 2)), xtol=1e-15)
    assert summary["exact_rest_angle_rad"] == pytest.approx(rest, abs=1e-12)
    assert summary["rest_angle_rad"] == pytest.approx(rest, abs=1e-6)


def test_with_a_spring_the_pendulum_still_starts_horizontally():
    assert sprung(duration=0.1).recording["q"][0] == 0.0
    assert sprung(duration=0.1, q0=(45.0,)).recording["q"][0] == np.radians(45.0)


@pytest.mark.slow
def test_an_undamped_spring_keeps_its_energy_and_never_rests():
    summary = sprung(damping=0.0, duration=4.0).summary
    assert summary["energy_drift"] <= 1e-6
    assert summary["rest_angle_rad"] is None


@pytest.mark.slow
def test_the_motion_is_that_of_an_independent_integration():
    for outcome in (damped(duration=5.0), sprung(duration=5.0)):
        assert outcome.summary["max_angle_error_rad"] <= 1e-8


# --- refused ---------------------------------------------------------------------------------

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"size": (0.3, 0.02)}, "length, width and height"),
        ({"size": (0.3, -0.02, 0.01)}, "-0.02"),
        ({"size": (0.3, NAN, 0.01)}, "nan"),
        ({"density": 0.0}, "density is 0.0"),
        ({"q0": (1.0, 2.0)}, "one finite angle"),
        ({"q0": (NAN,)}, "nan"),
        ({"gravity": -9.81}, "gravity is -9.81"),
        ({"gravity": NAN}, "gravity is nan"),
        ({"gravity": -INF}, "gravity is -inf"),
        ({"damping": -1.0}, "damping is -1.0"),
        ({"duration": 0.0}, "duration is 0.0"),
        ({"duration": 1e6}, "more than the 2000000 steps"),
        ({"integrator": "magic"}, "'magic'"),
    ],
)
def test_senseless_options_are_refused_in_a_sentence(change, said):
    with pytest.raises(InvalidValueError, match=said) as caught:
        free(**change)
    assert "\n" not in str(caught.value)


def test_a_negative_spring_is_refused():
    with pytest.raises(InvalidValueError, match=r"stiffness is -5\.0"):
        sprung(spring_stiffness=-5.0)


IMPOSSIBLE = [
    {"size": (1e-300, 1e-300, 1e-300)}, {"size": (1e300, 0.02, 0.01)}, {"size": (0.3, 0.02, 1e30)},
    {"density": 1e300}, {"density": 1e-300}, {"density": 1e-320}, {"damping": 1e-320},
    {"target": 1e300}, {"target": -1e300}, {"target": 1e-320}, {"spring_stiffness": 1e-320},
    {"q0": (1e300,)},
]  # fmt: skip


@pytest.mark.parametrize("change", IMPOSSIBLE, ids=str)
def test_an_impossible_pendulum_is_refused_or_stops_in_a_sentence_or_swings_as_told(change):
    try:
        summary, sentence = sprung(duration=0.1, **change).summary, ""
    except InvalidValueError as error:
        summary, sentence = {}, str(error)
    assert "\n" not in sentence
    assert sentence or summary["stop_reason"] or summary["max_angle_error_rad"] < 1e-6


LIGHT = DampedPendulumOptions(duration=1.0, density=1.0, damping=1.0)


def test_a_light_damped_link_is_told_what_works():
    with pytest.raises(InvalidValueError, match="integrator='radau3'"):
        run_pendulum(replace(LIGHT, damping=1000.0))


@pytest.mark.slow
@pytest.mark.parametrize("density", [pytest.param(1.0, marks=pytest.mark.slow), 100.0])
def test_an_implicit_integrator_gives_the_right_motion_of_a_light_damped_link(density):
    options = replace(LIGHT, density=density, damping=0.05, integrator="radau3")
    summary = run_pendulum(options).summary
    assert summary["stop_reason"] is None
    assert summary["max_angle_error_rad"] < 2e-6
