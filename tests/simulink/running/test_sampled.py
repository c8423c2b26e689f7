"""Blocks that count, delay and filter sample by sample, and controllers, against recursions."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy import signal

from drake_leg.errors import InvalidValueError

STEP = 0.1  # [s]
SAMPLES = np.sin(5.0 * STEP * np.arange(30))


def held_sine(rig):
    sine = rig.block("Sin", "sine", Frequency="5")
    return rig.block("ZeroOrderHold", "hold", sine, SampleTime=f"{STEP}")


def between_samples(run):
    """Rows that are not at a sample time, and the number of the sample before each."""
    k = np.floor(run.time / STEP + 1e-6).astype(int)
    return np.abs(run.time / STEP - np.round(run.time / STEP)) > 1e-6, k


def test_counters_begin_again_beyond_their_limit(tmp_path):
    rig = Rig()
    rig.show(rig.block("simulink/Sources/Counter Limited", "to 2", uplimit="2", tsamp="0.1"), "n")
    rig.show(rig.block("simulink/Sources/Counter Free-Running", "bits", NumBits="2", tsamp="0.1"),
             "bits")  # fmt: skip
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    assert np.array_equal(shown(run, "n")[rows], (k % 3)[rows])
    assert np.array_equal(shown(run, "bits")[rows], (k % 4)[rows])


@pytest.mark.parametrize(("current", "order"), [("off", "Oldest"), ("on", "Newest")])
def test_a_tapped_delay_is_a_window(current, order, tmp_path):
    rig = Rig()
    rig.show(rig.block("simulink/Discrete/Tapped Delay", "taps", held_sine(rig), NumDelays="2",
                       vinit="7", includeCurrent=current, DelayOrder=order,
                       samptime=f"{STEP}"), "y")  # fmt: skip
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    past = np.concatenate([[7.0, 7.0], SAMPLES])
    window = [past[k], past[k + 1]] + ([past[k + 2]] if current == "on" else [])
    expected = np.column_stack(window[::-1] if order == "Newest" else window)
    np.testing.assert_allclose(shown(run, "y")[rows], expected[rows], atol=1e-12)


def test_one_discrete_pole(tmp_path):
    rig = Rig()
    rig.show(rig.block("simulink/Discrete/Transfer Fcn First Order", "pole", held_sine(rig),
                       PoleZ="0.8"), "y")  # fmt: skip
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    expected = signal.lfilter([0.2], [1.0, -0.8], SAMPLES)[k]
    np.testing.assert_allclose(shown(run, "y")[rows], expected[rows], atol=1e-12)


def test_a_slope_is_limited_by_signals(tmp_path):
    rig = Rig()
    rig.show(rig.block("simulink/Limits/Rate Limiter Dynamic", "limited", rig.constant("2"),
                       held_sine(rig), rig.constant("-3")), "y")  # fmt: skip
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    expected, before = [], 0.0
    for sample in SAMPLES:
        before += min(max(sample - before, -0.3), 0.2)
        expected.append(before)
    np.testing.assert_allclose(shown(run, "y")[rows], np.array(expected)[k][rows], atol=1e-12)


def test_a_delay_may_come_in(tmp_path):
    rig = Rig()
    clock = rig.block("Clock", "clock")
    late = rig.block("Gain", "half", clock, Gain="0.5")
    rig.show(rig.block("VariableTransportDelay", "delay", clock, late, InitialOutput="0",
                       MaximumDelay="2"), "y")  # fmt: skip
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "y"), 0.5 * run.time, atol=1e-9)


def test_a_controller_with_weights(tmp_path):
    rig = Rig()
    r, y = rig.constant("2"), rig.block("Clock", "clock")
    rig.show(rig.block("simulink/Continuous/PID Controller (2DOF)", "pid", r, y, Controller="PID",
                       P="3", I="0.5", D="0.2", N="10", b="0.4", c="0"), "u")  # fmt: skip
    run = rig.run(tmp_path)
    t = run.time
    filtered = -0.2 * (1.0 - np.exp(-10.0 * t))  # 10 s / (s + 10) of -t, times D
    expected = 3.0 * (0.8 - t) + 0.5 * (2.0 * t - t**2 / 2.0) + filtered
    np.testing.assert_allclose(shown(run, "u"), expected, atol=1e-7)


def test_white_noise_has_its_power(tmp_path):
    rig = Rig()
    rig.show(rig.block("simulink/Sources/Band-Limited White Noise", "noise",
                       Cov="[0.1]", Ts="0.002", seed="[7]"), "y")  # fmt: skip
    values = np.unique(shown(rig.run(tmp_path), "y"))
    assert len(values) > 450
    assert np.std(values) == pytest.approx((0.1 / 0.002) ** 0.5, rel=0.1)


def test_a_pulse_by_time_has_no_sample_time(tmp_path):
    rig = Rig()
    given = {"Period": "0.5", "PulseWidth": "40", "SampleTime": "0.3"}
    rig.show(rig.block("DiscretePulseGenerator", "pulse", **given), "y")
    run = rig.run(tmp_path)
    off_edges = np.abs(np.mod(run.time + 0.05, 0.1) - 0.05) > 1e-6
    expected = np.where(np.mod(run.time, 0.5) < 0.2, 1.0, 0.0)
    assert shown(run, "y")[off_edges] == pytest.approx(expected[off_edges])


@pytest.mark.parametrize(
    ("kind", "given"),
    [
        ("DiscretePulseGenerator", {"PulseType": "Sample based", "SampleTime": "-1"}),
        ("Sin", {"SineType": "Sample based", "SampleTime": "0"}),
        ("simulink/Sources/Repeating Sequence Stair", {"tsamp": "-1"}),
    ],
)
def test_a_source_by_samples_needs_a_sample_time(kind, given, tmp_path):
    rig = Rig()
    rig.show(rig.block(kind, "source", **given), "y")
    with pytest.raises(InvalidValueError, match=r"'source' \(SID 1\) has no sample time: set one"):
        rig.run(tmp_path)


@pytest.mark.parametrize(
    ("method", "error"), [("Forward Euler", -1.0), ("Backward Euler", 1.0), ("Trapezoidal", 0.0)]
)
def test_a_sum_without_a_sample_time_is_over_the_time_that_passes(method, error, tmp_path):
    """The steps are those between the rows: the sum of t h is off t^2/2 by t h/2 at most."""
    rig = Rig()
    clock = rig.block("Clock", "clock")
    how = {"IntegratorMethod": f"Integration: {method}", "SampleTime": "-1", "gainval": "3"}
    rig.show(rig.block("DiscreteIntegrator", "sum", clock, **how), "y")
    run = rig.run(tmp_path)
    expected = 3.0 * (run.time**2 + error * run.time / 500) / 2.0
    assert shown(run, "y")[-1] == pytest.approx(expected[-1], abs=1e-9)


@pytest.mark.parametrize("method", ["Forward Euler", "Backward Euler", "Trapezoidal"])
def test_a_sum_begins_where_a_signal_says(method, tmp_path):
    """The signal is read at the start and never again."""
    rig = Rig()
    start = rig.block("Sum", "start", rig.block("Clock", "clock"), rig.constant("[5 7]"))
    total = rig.block("DiscreteIntegrator", "sum", rig.constant("[2 -1]"), start,
                      IntegratorMethod=f"Integration: {method}", SampleTime="0.1",
                      InitialConditionSource="external")  # fmt: skip
    rig.show(total, "y")
    run = rig.run(tmp_path)
    steps = np.floor(run.time / 0.1 + 1e-9)
    ahead = {"Forward Euler": 0.0, "Backward Euler": 1.0, "Trapezoidal": 0.5}[method]
    expected = np.array([5.0, 7.0]) + 0.1 * (steps[:, np.newaxis] + ahead) * np.array([2.0, -1.0])
    np.testing.assert_allclose(shown(run, "y").reshape(len(steps), 2), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("method", "steps"), [("Forward Euler", 0), ("Backward Euler", 1), ("Trapezoidal", 1)]
)
def test_a_sum_over_the_time_that_passes_is_reset_too(method, steps, tmp_path):
    rig = Rig()
    up = rig.block("Step", "up", Time="0.5")
    how = {"IntegratorMethod": f"Integration: {method}", "SampleTime": "-1"}
    rig.show(rig.block("DiscreteIntegrator", "sum", rig.constant("1"), up, **how,
                       InitialCondition="3", ExternalReset="rising"), "y")  # fmt: skip
    run = rig.run(tmp_path, duration=1.0)
    at = np.flatnonzero(run.time >= 0.5 - 1e-9)[0]
    step = run.time[at] - run.time[at - 1]
    assert shown(run, "y")[at] == pytest.approx(3.0 + steps * step, abs=1e-12)


@pytest.mark.parametrize(
    ("how", "resets"),
    [("rising", [5]), ("falling", [8]), ("either", [5, 8]), ("sampled level", [5, 6, 7])],
)
def test_a_sum_is_reset_by_a_signal(how, resets, tmp_path):
    rig = Rig()
    pulse = rig.block("Sum", "pulse",
                      rig.block("Step", "up", Time="0.5", SampleTime="0.1"),
                      rig.block("Step", "down", Time="0.8", SampleTime="0.1"),
                      Inputs="+-")  # fmt: skip
    rig.show(rig.block("DiscreteIntegrator", "sum", rig.constant("1"), pulse, SampleTime="0.1",
                       InitialCondition="3", ExternalReset=how), "y")  # fmt: skip
    run = rig.run(tmp_path, duration=1.0)
    value, expected = 3.0, []
    for step in range(10):
        value = 3.0 if step in resets else value
        expected.append(value)
        value += 0.1
    at = np.searchsorted(run.time, np.arange(10) * 0.1 + 0.05)
    np.testing.assert_allclose(shown(run, "y")[at], expected, atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_a_converter_filters_between_the_samples_of_what_comes_in(order, tmp_path):
    """From rest at the first sample, lags of tau one behind the other."""
    tau = 0.03  # [s]
    rig = Rig()
    texts = {
        "FilteringAndDerivatives": "filter", "SimscapeFilterOrder": f"{order}",
        "InputFilterTimeConstant": f"{tau}",
    }  # fmt: skip
    kind = "nesl_utility/Simulink-PS Converter"
    enters = rig.add_library(kind, "enters", texts, ports={"in": 1})
    rig.connect(held_sine(rig), enters)
    leaves = rig.block("nesl_utility/PS-Simulink Converter", "leaves")
    rig.physical(f"{enters}#rconn:1", f"{leaves}#lconn:1")
    rig.show(f"{leaves}#out:1", "y")
    run = rig.run(tmp_path, 0.5)
    fine = np.linspace(0.0, 0.5, 100 * 50 + 1)
    held = SAMPLES[np.floor(fine / STEP + 1e-9).astype(int)]
    lag = signal.TransferFunction([1.0], np.poly([-1.0 / tau] * order) * tau**order)
    _, expected, _ = signal.lsim(lag, held, fine, interp=False)
    np.testing.assert_allclose(shown(run, "y"), expected[::10], atol=1e-5)


@pytest.mark.parametrize("top", [[2.0, 1.0], [1.0]])
@pytest.mark.parametrize("loop", [False, True])
def test_a_filter_takes_each_entry_of_a_vector(top, loop, tmp_path):
    """Against SciPy's filter of each; with a loop, u is the sine less what comes out."""
    rig = Rig()
    held = rig.block("Gain", "both", held_sine(rig), Gain="[1; -3]")
    texts = {"Numerator": f"{top}", "Denominator": "[1 -0.5 0.2]", "SampleTime": f"{STEP}"}
    filtered = rig.block("DiscreteTransferFcn", "filter", "" if loop else held, **texts)
    top = np.pad(top, (3 - len(top), 0))
    bottom = np.array([1.0, -0.5, 0.2])
    if loop:
        rig.connect(rig.block("Sum", "error", held, filtered, Inputs="+-"), filtered)
        bottom = bottom + top
    rig.show(filtered, "y")
    run = rig.run(tmp_path)
    rows, k = between_samples(run)
    expected = signal.lfilter(top, bottom, np.outer([1.0, -3.0], SAMPLES)).T[k]
    np.testing.assert_allclose(shown(run, "y")[rows], expected[rows], atol=1e-12)
