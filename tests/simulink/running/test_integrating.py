"""How a model is integrated: fixed steps of its file, implicit steps where explicit ones fail."""

import numpy as np
import pytest
from mechanism_models import pendulum
from rigs import Rig, shown

from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.integrating import automatic_step
from drake_leg.simulink.running.running import run_model, runnable

FIXED = {"SolverType": "Fixed-step", "Solver": "ode3"}


def twice_derived(folder, power, **solver):
    """The second derivative of a power of the time, by differences, and its integral."""
    rig = Rig()
    rig.solver.update(solver)
    source = rig.block("Fcn", "Power", rig.block("Clock", "Clock"), Expr=f"u^{power}")
    second = rig.block("Derivative", "Rate 2", rig.block("Derivative", "Rate 1", source))
    rig.show(second, "second")
    rig.show(rig.block("Integrator", "Sum", second), "sum")
    return runnable(read_model(rig.write(folder / "rig.slx")), duration=1.0)


def test_blocks_that_depend_on_steps_take_those_of_the_file(tmp_path):
    """The second difference of t² is 2, whatever the step."""
    run = run_model(twice_derived(tmp_path, 2, **FIXED, FixedStep="0.01"))
    assert not run.stopped
    assert (run.steps, run.accuracy) == (100, None)
    np.testing.assert_allclose(shown(run, "second")[run.time > 0.025], 2.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(run.time, np.round(run.time / 0.01) * 0.01, rtol=0, atol=1e-12)


def test_a_jump_that_no_step_is_short_enough_for_is_passed(tmp_path):
    """A ramp's rate jumps at the start, and the rate of that is 1/h in the first step h."""
    run = run_model(twice_derived(tmp_path, 1))
    assert run.ended == 1.0
    assert not run.stopped
    assert any("the error is not controlled at" in said for said in run.remarks)
    np.testing.assert_allclose(shown(run, "second")[1:], 0.0, rtol=0, atol=1e-3)


@pytest.mark.parametrize(("at", "seen"), [("0.055", 0.06), ("0.3", 0.3), ("0.57", 0.57)])
def test_a_jump_within_a_fixed_step_comes_at_its_end(tmp_path, at, seen):
    rig = Rig()
    rig.solver.update(**FIXED, FixedStep="0.01")
    rig.show(rig.block("Derivative", "Rate", rig.block("Step", "Jump", Time=at)), "rate")
    run = run_model(runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0))
    rate = shown(run, "rate")
    np.testing.assert_allclose(run.time[rate != 0.0], [seen], rtol=0, atol=1e-12)
    np.testing.assert_allclose(rate[rate != 0.0], 100.0, rtol=1e-9)


@pytest.mark.parametrize(("at", "off"), [(0.5, 0.0), (0.505, 7.0 / 9.0 - 0.5)])
def test_fixed_steps_are_those_of_ode3(tmp_path, at, off):
    """Its stages are at 0, 1/2 and 3/4 of a step, with weights of 2/9, 3/9 and 4/9."""
    rig = Rig()
    rig.solver.update(**FIXED, FixedStep="0.01")
    rig.show(rig.block("Derivative", "Rate", rig.block("Clock", "Clock")), "rate")
    jump = rig.block("Step", "Jump", Time=f"{at}")
    rig.show(rig.block("Integrator", "Sum", jump), "sum")
    run = run_model(runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0))
    assert shown(run, "sum")[-1] == pytest.approx(1.0 - at + 0.01 * off, abs=1e-9)


@pytest.mark.parametrize(("duration", "at"), [(10.0, "2"), (1.0, "0.57")])
def test_a_memory_is_one_fixed_step_late(tmp_path, duration, at):
    """Also between rows, where nothing is integrated, and at a jump: 57 * 0.01 is after 0.57."""
    rig = Rig()
    rig.solver.update(**FIXED, FixedStep="0.01")
    before = {"InitialCondition": "-0.01"}
    rig.show(rig.block("Memory", "Memory", rig.block("Clock", "Clock"), **before), "before")
    rig.show(rig.block("Step", "Jump", Time=at), "jump")
    run = run_model(runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=duration))
    np.testing.assert_allclose(shown(run, "before"), run.time - 0.01, rtol=0, atol=1e-9)
    after = run.time > float(at) - 0.005
    np.testing.assert_array_equal(shown(run, "jump"), after.astype(float))


def test_rows_of_fixed_steps_show_what_is_sampled_there(tmp_path):
    """Drake's third sample time is 3 * 0.1, and the thirtieth step ends at 30 * 0.01, before it."""
    rig = Rig()
    rig.solver.update(**FIXED, FixedStep="0.01")
    clock = rig.block("Clock", "Clock")
    rig.show(rig.block("Derivative", "Rate", clock), "rate")
    delay = {"SampleTime": "0.1", "InitialCondition": "-0.1"}
    rig.show(rig.block("UnitDelay", "Delay", clock, **delay), "delayed")
    run = run_model(runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0))
    expected = np.floor(run.time * 10.0 + 1e-6) / 10.0 - 0.1
    np.testing.assert_allclose(shown(run, "delayed"), expected, rtol=0, atol=1e-12)


def test_where_no_step_is_short_enough_the_accuracy_is_that_of_the_file(tmp_path, monkeypatch):
    """From there on, and time goes on, too."""
    monkeypatch.setattr("drake_leg.simulink.running.running.SHORTEST_STEP", 4e-4)
    monkeypatch.setattr("drake_leg.simulink.running.stepping.PASSED_OVER", 0.5)
    rig = Rig()
    fast = rig.block("Sin", "Sine", Frequency="600")
    rig.show(rig.block("Integrator", "Sum", fast), "sum")
    ready = runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0)
    run = run_model(ready)
    assert run.ended == 1.0
    assert run.accuracy == 1e-3
    assert any("on the accuracy is that of the file, 0.001" in said for said in run.remarks)
    np.testing.assert_allclose(shown(run, "sum"), (1 - np.cos(600 * run.time)) / 600, atol=1e-3)
    assert run.steps > 500


def test_a_run_that_would_take_too_many_evaluations_is_as_accurate_as_the_file_asks(
    tmp_path, monkeypatch
):
    """Friction that jumps with the sign of a velocity, which slides to and fro over zero."""
    monkeypatch.setattr("drake_leg.simulink.running.stepping.PACE", 500)
    monkeypatch.setattr("drake_leg.simulink.running.stepping.MOST_EVALUATIONS", 5_000)
    rig = Rig()
    rig.solver.update(Solver="ode15s")
    velocity = rig.block("Integrator", "velocity", "", InitialCondition="0.3")
    friction = rig.block("Gain", "friction", rig.block("Signum", "sign", velocity), Gain="5")
    force = rig.block("Sin", "force", Frequency="3")
    rig.connect(rig.block("Sum", "sum", force, friction, Inputs="+-"), velocity)
    rig.show(velocity, "v")
    ready = runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0)
    run = run_model(ready)
    assert run.ended == 1.0
    assert run.accuracy == 1e-3
    assert any("on the accuracy is coarser, at last 0.001" in said for said in run.remarks)
    assert run.steps < 5_000
    v = shown(run, "v")
    slides = run.time < 0.05
    exact = 0.3 - 5 * run.time + (1 - np.cos(3 * run.time)) / 3
    np.testing.assert_allclose(v[slides], exact[slides], atol=1e-5)
    assert np.abs(v[run.time > 0.1]).max() < 0.05  # the jump times a step
    short = runnable(read_model(tmp_path / "rig.slx"), duration=0.07)
    assert run_model(short, accuracy=1e-5).accuracy == 1e-5


def test_an_accuracy_that_is_asked_for_chooses_the_steps(tmp_path):
    rig = Rig()
    rig.solver.update(**FIXED, FixedStep="0.1")
    rate = rig.block("Derivative", "Rate", rig.block("Sin", "Sine"))
    rig.show(rig.block("Integrator", "Sum", rate), "sum")
    ready = runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0)
    assert run_model(ready).steps == 10
    finer = run_model(ready, accuracy=1e-6)
    assert finer.accuracy == 1e-6
    assert finer.steps > 10


@pytest.mark.parametrize(
    ("periods", "step"), [((), 0.02), ((0.05,), 0.05), ((0.006, 0.004), 0.002)]
)
def test_an_automatic_step_meets_all_sample_times(tmp_path, periods, step):
    """It is a fiftieth of the duration where there are none."""
    rig = Rig()
    rig.solver.update(**FIXED, FixedStep="auto")
    rate = rig.block("Derivative", "Rate", rig.block("Clock", "Clock"))
    rig.show(rig.block("Integrator", "Sum", rate), "sum")
    for period in periods:
        delay = {"SampleTime": f"{period}", "InitialCondition": "0"}
        rig.show(rig.block("UnitDelay", f"Delay {period}", rate, **delay), f"delayed {period}")
    ready = runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=1.0)
    assert ready.solver["fixed step"] == pytest.approx(step, rel=1e-12)
    assert run_model(ready).longest_step == pytest.approx(step, rel=1e-8)
    assert automatic_step(1.0, None) == 0.02


@pytest.mark.slow
def test_time_goes_on_where_the_integrator_changes(tmp_path):
    """A pendulum in a damper creeps, and is driven by a sine of the time."""
    built = pendulum(
        TorqueActuationMode="InputTorque", DampingCoefficient="1e5",
        DampingCoefficientUnits="N*m/(rad/s)",
    )  # fmt: skip
    inward = built.add_library("nesl_utility/Simulink-PS Converter", "In", {"Unit": "N*m"})
    sine = built.add_block("Sin", "Sine", {"Amplitude": "1e5", "Frequency": "3"})
    built.connect(sine, f"{inward}#in:1")
    built.physical(f"{inward}#rconn:1", f"{built.sid('Pivot')}#lconn:2")
    run = run_model(runnable(built.model(tmp_path), duration=2.0))
    assert "rodas5p" in run.integrator
    assert run.ended == 2.0
    np.testing.assert_allclose(run.time, np.linspace(0.0, 2.0, len(run.time)), atol=1e-9)
    creep = (1.0 - np.cos(3.0 * run.time)) / 3.0
    np.testing.assert_allclose(run.states[:, 0], creep, rtol=0, atol=2e-3)


@pytest.mark.slow
def test_where_explicit_steps_fail_implicit_ones_go_on(tmp_path):
    """A controller whose gains no explicit step can follow turns a pendulum to its angle."""
    built = pendulum(TorqueActuationMode="InputTorque", SensePosition="on", SenseVelocity="on")
    inward = built.add_library("nesl_utility/Simulink-PS Converter", "In", {"Unit": "N*m"})
    joint = built.sid("Pivot")
    goal = built.add_block("Constant", "Goal", {"Value": "0.5"})
    ports = {"in": 1, "out": 1}
    gain = built.add_block("Gain", "Gain", {"Gain": "1e9"}, ports=ports)
    rate = built.add_block("Gain", "Rate", {"Gain": "1e6"}, ports=ports)
    force = built.add_block("Sum", "Force", {"Inputs": "+-"}, ports={"in": 2, "out": 1})
    off = built.add_block("Sum", "Off", {"Inputs": "+-"}, ports={"in": 2, "out": 1})
    angle = built.add_library("nesl_utility/PS-Simulink Converter", "Angle", {"Unit": "rad"})
    speed = built.add_library("nesl_utility/PS-Simulink Converter", "Speed", {"Unit": "rad/s"})
    for one, other in [(f"{joint}#rconn:2", f"{angle}#lconn:1"),
                       (f"{joint}#rconn:3", f"{speed}#lconn:1"),
                       (f"{inward}#rconn:1", f"{joint}#lconn:2")]:  # fmt: skip
        built.physical(one, other)
    for one, other in [(goal, f"{off}#in:1"), (f"{angle}#out:1", f"{off}#in:2"),
                       (off, f"{gain}#in:1"), (gain, f"{force}#in:1"),
                       (f"{speed}#out:1", f"{rate}#in:1"), (rate, f"{force}#in:2"),
                       (force, f"{inward}#in:1")]:  # fmt: skip
        built.connect(one, other)
    run = run_model(runnable(built.model(tmp_path), duration=0.5))
    assert not run.stopped
    assert "rodas5p" in run.integrator
    assert run.states[-1, 0] == pytest.approx(0.5, abs=1e-6)
    assert 0 < run.steps < 2000
