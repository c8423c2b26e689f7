"""Steps by stiffness: as fine as the error asks, as many as there is time for."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import pendulum
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.pendulum import MOST, Steps, implicit_step, steps_of
from drake_leg.runs.pendulum_options import DampedPendulumOptions, SpringPendulumOptions

run_pendulum = RUNS["pendulum"].run


def model_of(**mechanics):
    return PendulumModel.from_robot(pendulum(mechanics=JointMechanics(actuated=False, **mechanics)))


@pytest.mark.parametrize("growth", [0.0, 0.5, 20.0])
def test_the_count_is_that_of_the_steps_taken(growth):
    steps = Steps(first=1e-4, longest=2e-3 if growth else 1e-4, growth=growth)
    time, taken = 0.0, 0
    while time < 5.0:
        time, taken = time + steps.at(time), taken + 1
    assert steps.count(5.0) == pytest.approx(taken, rel=0.02)


def test_a_free_pendulum_takes_2_ms():
    assert steps_of(model_of(), 10.0, 0.0) == Steps(first=0.002, longest=0.002, growth=0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "damping", "duration"),
    [(5.0, 0.0, 2.0), (100.0, 0.01, 1.0), (1e3, 0.01, 0.3), (1e4, 0.01, 0.1), (1e3, 1.0, 1.0)],
)
def test_a_stiff_spring_is_right_to_a_twentieth_of_a_microradian(stiffness, damping, duration):
    options = SpringPendulumOptions(spring_stiffness=stiffness, damping=damping, duration=duration)
    summary = run_pendulum(options).summary
    assert summary["max_angle_error_rad"] < 5e-8
    assert summary["stop_reason"] is None


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.1, 1.0, 10.0])
def test_a_strong_damper_is_right_with_few_steps(damping):
    outcome = run_pendulum(DampedPendulumOptions(damping=damping, duration=1.0))
    assert outcome.summary["max_angle_error_rad"] < 1e-9
    assert outcome.summary["rows"] < 5000
    steps = np.diff(outcome.recording["time"])
    assert steps[1] <= steps.max() <= 0.002 * 1.001


@pytest.mark.slow
def test_a_damper_too_strong_for_explicit_steps_names_the_integrator_that_works():
    with pytest.raises(InvalidValueError, match="integrator='radau3'") as refused:
        run_pendulum(DampedPendulumOptions(damping=1e3))
    assert "\n" not in str(refused.value)
    options = DampedPendulumOptions(damping=1e3, duration=0.5, integrator="radau3")
    assert run_pendulum(options).summary["max_angle_error_rad"] < 1e-7


def test_a_spring_too_stiff_names_no_integrator_for_none_works():
    with pytest.raises(InvalidValueError, match="choose a softer one") as refused:
        run_pendulum(SpringPendulumOptions(spring_stiffness=1e8))
    assert "integrator" not in str(refused.value)


@pytest.mark.parametrize("stiffness", [5.0, 1e3, 1e5, 1e6])
@pytest.mark.parametrize("damping", [0.0, 1e-4, 0.01])
def test_there_are_never_too_many_steps(stiffness, damping):
    model = model_of(spring_stiffness=stiffness, damping=damping)
    try:
        steps = steps_of(model, 30.0, 0.5)
    except InvalidValueError:
        assert stiffness >= 1e5
        return
    assert steps.count(30.0) <= 1.001 * MOST
    assert 0.0 < steps.first <= steps.longest <= 0.002


def test_an_implicit_step_is_bound_by_time_only():
    assert implicit_step(model_of(damping=1e6), 10.0) == pytest.approx(10.0 / 20_000)
    assert implicit_step(model_of(), 10.0) == 0.002
