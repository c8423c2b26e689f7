"""Hundreds of pendulums at random: each is carried out and drawn, and is right or says that not."""

import json
import math

import numpy as np
import pytest
from campaigns import cases

from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.outcome import NOTHING, SHOWN
from drake_leg.simulation.integrator import INTEGRATORS
from drake_leg.units import DAMPING_UNITS, SPRING_UNITS

KINDS = ("pendulum", "pendulum-damped", "pendulum-spring")
BATCHES, OF_A_BATCH = cases(4), 50
TURNS, DECAYS = 60.0, 100.0  # of the spring and of the damper: what a run may last, to be quick
ENERGY, LAID_OUT = 5, 50  # of so many one has its energy drawn; one is laid out
QUICK = ("runge_kutta5", "runge_kutta3", "radau3")  # with error control


def random_options(rng):
    """Choose a run and its options, in a person's units."""
    name = str(rng.choice(KINDS))
    size = (
        10 ** rng.uniform(-1.0, 0.3),
        10 ** rng.uniform(-2.3, -1.3),
        10 ** rng.uniform(-2.3, -1),
    )
    density = 10 ** rng.uniform(2.0, 4.0)
    inertia = density * math.prod(size) * size[0] ** 2 / 3.0
    given = {"size": list(size), "density": density, "duration": 10 ** rng.uniform(-1.0, 0.2)}
    if rng.random() < 0.2:
        given["gravity"] = float(rng.choice([0.0, 1.62, 25.0]))
    if name == "pendulum-damped" or rng.random() < 0.4:
        unit = str(rng.choice(list(DAMPING_UNITS)))
        rate = 10 ** rng.uniform(-2.0, 2.5)  # [1/s]
        given |= {"damping": rate * inertia / DAMPING_UNITS[unit], "damping_unit": unit}
        given["duration"] = min(given["duration"], DECAYS / rate)
    if name == "pendulum-spring":
        unit = str(rng.choice(list(SPRING_UNITS)))
        frequency = 10 ** rng.uniform(-1.0, 3.0)  # [rad/s]
        given["spring_stiffness"] = frequency**2 * inertia / SPRING_UNITS[unit]
        given["spring_unit"] = unit
        given["duration"] = min(given["duration"], TURNS / frequency)
    if name != "pendulum" and rng.random() < 0.5:
        given["target"] = rng.uniform(-200.0, 200.0)
    elif rng.random() < 0.9:
        given["q0"] = [float(rng.choice([rng.uniform(-400.0, 400.0), 0.0, 90.0, -90.0, -89.9]))]
    if rng.random() < 0.3:
        given["velocity_target"] = rng.uniform(-1000.0, 1000.0)
    if rng.random() < 0.06:
        given |= random_limits(rng, start_of(name, given), inertia)
        given["duration"] = min(given["duration"], 0.5)
    return name, given | random_steps(rng)


def start_of(name, given):
    """Return where a run starts [deg]."""
    target = given.get("target", 30.0) if name == "pendulum-damped" else 0.0
    return given.get("q0", [target])[0]


def random_limits(rng, start, inertia):
    """Choose limits on either side of the start, or of one side."""
    low, high = start - rng.uniform(0.0, 90.0), start + rng.uniform(0.1, 90.0)
    limits = [
        {"lower_limit": low},
        {"upper_limit": high},
        {"lower_limit": low, "upper_limit": high},
    ]
    given = dict(rng.choice(limits))
    frequency = 10 ** rng.uniform(2.0, 3.5)  # [rad/s], on the limit
    given["limit_stiffness"] = frequency**2 * inertia * math.pi / 180
    given["limit_damping"] = float(rng.choice([0.0, 0.1, 1.0])) * frequency * inertia / 57.3
    return given | ({"limit_width": 0.5} if rng.random() < 0.5 else {})


def random_steps(rng):
    if rng.random() < 0.7:
        return {}
    given = {"integrator": str(rng.choice(INTEGRATORS))}
    if rng.random() < 0.5:
        given["max_step"] = float(rng.choice([0.001, 0.005, 0.02, 0.04]))
    if given["integrator"] in QUICK and rng.random() < 0.3:
        given["accuracy"] = float(rng.choice([1e-2, 1e-4]))
    return given


def drawn(outcome, number):
    """Draw one figure of the angle, with or without its rate; that of the energy now and then."""
    odd = number % 2 == 1
    turns = {"angle": not odd, "angle_and_rate": odd, "energy": number % ENERGY == 0}
    summary = json.loads(json.dumps(outcome.summary, allow_nan=False))
    for figure_name, draw in figures_of_run(
        outcome.subject, "title", outcome.robot, outcome.recording, summary
    ):
        if not turns[figure_name]:
            continue
        figure = draw()
        if number % LAID_OUT == 0:
            figure.draw_without_rendering()


def is_right(outcome, given):
    """See that a run is as near to its exact motion as it says, or says that it is not."""
    summary, recording = outcome.summary, outcome.recording
    columns = [*recording.columns.values(), *outcome.exact.values()]
    assert all(np.isfinite(column).all() for column in columns)
    exact, energy = outcome.exact["q"], recording["energy"]
    error = float(np.abs(recording["q"] - exact).max())
    assert error == summary["max_angle_error_rad"]
    if summary["inaccuracy"] is not None:
        assert "\n" not in summary["inaccuracy"]
        return
    assert error <= max(SHOWN * min(np.ptp(exact), 2 * math.pi), NOTHING)
    scale = np.ptp(energy) + PendulumModel.from_robot(outcome.robot).gravity_torque
    default = not {"integrator", "max_step", "accuracy"} & given.keys()
    if default and summary["ill_conditioned"] is None:
        assert error <= 1e-6 * summary["error_growth"]
    grown = np.maximum.accumulate(energy[::-1])[::-1] - energy
    assert grown.max() <= (1e-6 if default else 0.05) * scale


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_pendulums_at_random_are_right_or_say_that_they_are_not(batch):
    rng = np.random.default_rng(20240 + batch)
    for number in range(OF_A_BATCH):
        name, given = random_options(rng)
        outcome = RUNS[name].run(RUNS[name].options(**given), None)
        is_right(outcome, given)
        drawn(outcome, number)
