"""Subsystems that are called, and those whose states start again, against sums by hand."""

import numpy as np
import pytest
from rigs import Rig, shown

from drake_leg.errors import InvalidValueError

STEP = 0.1  # [s]


def system_of(rig, port, gate, name="inside", **parameters):
    """A subsystem with a gate of its own; the block that is meant to be in it comes after."""
    system = rig.add_block("SubSystem", name, ports={"in": 0, "out": 1, port: 1})
    rig.add_block(gate, f"gate of {name}", parameters, system=system)
    return system


def led_out(rig, system, source):
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(source, out)


def counting(rig, name="counting", value="1"):
    """A subsystem that is called and sums up: n(k+1) = n(k) + value."""
    system = system_of(rig, "trigger", "TriggerPort", name, TriggerType="function-call")
    sum_ = rig.block("Sum", "more", "", "", Inputs="++", system=system)
    before = rig.block("UnitDelay", "before", sum_, InitialCondition="0", SampleTime="-1",
                       system=system)  # fmt: skip
    rig.connect(before, f"{sum_}#in:1")
    one = rig.block("Constant", "one", Value=value, SampleTime="inf", system=system)
    rig.connect(one, f"{sum_}#in:2")
    led_out(rig, system, sum_)
    return system


def between_samples(run, step=STEP):
    k = np.floor(run.time / step + 1e-6).astype(int)
    return np.abs(run.time / step - np.round(run.time / step)) > 1e-6, k


@pytest.mark.parametrize(
    "kind", ["FunctionCallGenerator", "simulink/Ports & Subsystems/Function-Call Generator"]
)
def test_a_subsystem_runs_when_it_is_called(kind, tmp_path):
    rig = Rig()
    system = counting(rig)
    rig.connect(rig.block(kind, "calls", sample_time=f"{STEP}"), f"{system}#trigger")
    rig.show(system, "n")
    rig.show(rig.block("Integrator", "beside", rig.block("Clock", "clock")), "x")
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    np.testing.assert_array_equal(shown(run, "n")[rows], k[rows] + 1.0)


def test_a_split_calls_several_in_turn(tmp_path):
    """The second one sums up what the first one puts out at the same call."""
    rig = Rig()
    calls = rig.block("FunctionCallGenerator", "calls", sample_time=f"{STEP}")
    split = rig.add_block("FunctionCallSplit", "split", ports={"in": 1, "out": 2})
    rig.connect(calls, split)
    first, second = (
        counting(rig, "first"),
        system_of(rig, "trigger", "TriggerPort", "second", TriggerType="function-call"),
    )
    into = rig.add_block("Inport", "in", {"Port": "1"}, system=second, ports={"out": 1})
    led_out(rig, second, rig.block("Gain", "twice", into, Gain="2", system=second))
    rig.connect(first, f"{second}#in:1")
    rig.connect(f"{split}#out:1", f"{first}#trigger")
    rig.connect(f"{split}#out:2", f"{second}#trigger")
    rig.show(second, "n")
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    np.testing.assert_array_equal(shown(run, "n")[rows], 2.0 * (k[rows] + 1.0))


def test_calls_are_made_while_they_are_enabled(tmp_path):
    rig = Rig()
    until = rig.block("Step", "until", Time="0.45", Before="1", After="0", SampleTime=f"{STEP}")
    system = counting(rig)
    calls = rig.block("FunctionCallGenerator", "calls", until, sample_time=f"{STEP}")
    rig.connect(calls, f"{system}#trigger")
    rig.show(system, "n")
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    np.testing.assert_array_equal(shown(run, "n")[rows], np.minimum(k[rows] + 1.0, 5.0))


def test_a_memory_that_is_called_remembers_the_call_before(tmp_path):
    rig = Rig()
    system = system_of(rig, "trigger", "TriggerPort", TriggerType="function-call")
    clock = rig.block("DigitalClock", "clock", SampleTime="-1", system=system)
    led_out(rig, system, rig.block("Memory", "before", clock, InitialCondition="-1", system=system))
    rig.connect(rig.block("FunctionCallGenerator", "c", sample_time=f"{STEP}"), f"{system}#trigger")
    rig.show(system, "y")
    rig.show(rig.block("Memory", "beside", rig.block("Clock", "clock")), "x")
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    expected = np.where(k > 0, (k - 1) * STEP, -1.0)
    np.testing.assert_allclose(shown(run, "y")[rows], expected[rows], atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"numberOfIterations": "2"}, "calls several times at once"),
        ({"sample_time": "-1"}, "has no sample time: set one"),
    ],
)
def test_calls_that_do_not_run_are_refused(change, message, tmp_path):
    rig = Rig()
    system = counting(rig)
    given = {"sample_time": f"{STEP}"} | change
    rig.connect(rig.block("FunctionCallGenerator", "calls", **given), f"{system}#trigger")
    rig.show(system, "n")
    with pytest.raises(InvalidValueError, match=message):
        rig.code(tmp_path)


def test_a_call_by_what_does_not_call_is_refused(tmp_path):
    rig = Rig()
    system = counting(rig)
    rig.connect(rig.constant("1"), f"{system}#trigger")
    rig.show(system, "n")
    with pytest.raises(InvalidValueError, match="is called by nothing that runs here"):
        rig.code(tmp_path)


def resettable(rig, signal, how):
    """An integral of 1, and a count of samples, which start again from 2 and 5."""
    system = system_of(rig, "Reset", "ResetPort", ResetTriggerType=how)
    rig.connect(signal, f"{system}#Reset")
    one = rig.block("Constant", "one", Value="1", system=system)
    x = rig.block("Integrator", "x", one, InitialCondition="2", system=system)
    total = rig.block("DiscreteIntegrator", "n", one, InitialCondition="5", gainval="10",
                      SampleTime=f"{STEP}", system=system)  # fmt: skip
    both = rig.add_block("Mux", "both", {"Inputs": "2"}, system=system, ports={"in": 2, "out": 1})
    rig.connect(x, f"{both}#in:1")
    rig.connect(total, f"{both}#in:2")
    led_out(rig, system, both)
    rig.show(system, "y")


@pytest.mark.parametrize(
    ("how", "resets"), [("rising", [0.43]), ("falling", [0.73]), ("either", [0.43, 0.73])]
)
def test_states_start_again_at_edges(how, resets, tmp_path):
    rig = Rig()
    pulse = rig.block("DiscretePulseGenerator", "pulse", Period="10", PulseWidth="3",
                      PhaseDelay="0.43")  # fmt: skip
    resettable(rig, pulse, how)
    run = rig.run(tmp_path)
    t = run.time
    last = np.zeros_like(t)
    for reset in resets:
        last[t >= reset - 1e-9] = reset
    off = np.abs(t[:, None] - np.array([0.43, 0.73])).min(axis=1) > 1e-6
    x, n = shown(run, "y").T
    np.testing.assert_allclose(x[off], 2.0 + (t - last)[off], atol=1e-7)
    rows, k = between_samples(run)
    expected, count, waiting = [], 5.0, list(resets)
    for sample in range(11):
        if waiting and waiting[0] <= sample * STEP:
            waiting.pop(0)
            count = 5.0
        expected.append(count)
        count += 1.0
    np.testing.assert_allclose(n[rows], np.array(expected)[k[rows]], atol=1e-9)


def test_states_rest_at_their_start_while_a_level_holds_them(tmp_path):
    rig = Rig()
    until = rig.block("Step", "until", Time="0.5", Before="1", After="0", SampleTime=f"{STEP}")
    resettable(rig, until, "level hold")
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    x, n = shown(run, "y").T
    np.testing.assert_allclose(n[rows], 5.0 + np.maximum(k[rows] - 5, 0), atol=1e-9)
    free = run.time > 0.5 + 1e-6
    np.testing.assert_allclose(np.diff(x[free]), np.diff(run.time[free]), atol=1e-7)
    assert np.all(x[~free] < 2.0 + 0.01)
