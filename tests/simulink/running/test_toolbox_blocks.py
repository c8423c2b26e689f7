"""Blocks of toolboxes: linear systems, sampled sources; and what is reset or not connected."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy import signal

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.network_laws import friction
from drake_leg.simulink.running.running import runnable

STEP = 0.1  # [s]


def test_a_linear_system_of_matrices_starts_where_it_is_told(tmp_path):
    """Without an input, x'' = -4 x from x = 1 is cos 2 t."""
    rig = Rig()
    rig.show(rig.block("cstblocks/LTI System", "free", rig.constant("0"), IC="[1;0]",
                       sys="ss([0 1;-4 0], [0;1], [1 0;0 1], 0)"), "x")  # fmt: skip
    run = rig.run(tmp_path, 1.0)
    t = 2.0 * run.time
    np.testing.assert_allclose(shown(run, "x"), np.transpose([np.cos(t), -2.0 * np.sin(t)]),
                               atol=1e-7)  # fmt: skip


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"sys": "tf(1,[1 1])", "IC": "1"}, "IC '1', which runs with matrices only"),
        ({"sys": "c2d(ss(-1,1,1,0), 0.1)"}, "sampled system"),
        ({"sys": "tf([1 0 0],[1 1])"}, "numerator has a higher degree"),
        ({"sys": "3"}, "linear system of this kind"),
    ],
)
def test_a_linear_system_that_does_not_run_is_refused(settings, why, tmp_path):
    rig = Rig()
    rig.show(rig.block("cstblocks/LTI System", "odd", rig.constant("0"), **settings), "y")
    with pytest.raises(InvalidValueError, match=rf"'odd' .*{why}"):
        rig.code(tmp_path)


def test_a_sampled_sine_has_its_frequency_in_hertz(tmp_path):
    rig = Rig()
    rig.show(rig.block("dspsrcs4/Sine Wave", "sine", Amplitude="[2 3]", Frequency="0.5",
                       Phase="0.1", SampleTime=f"{STEP}"), "y")  # fmt: skip
    rig.show(rig.block("dspsrcs4/Random Source", "noise", SampTime=f"{STEP}", MinVal="2",
                       MaxVal="3", rawSeed="7"), "r")  # fmt: skip
    run = rig.run(tmp_path, 1.0)
    at = STEP * np.floor(run.time / STEP + 1e-9)
    expected = np.outer(np.sin(np.pi * at + 0.1), [2.0, 3.0])
    np.testing.assert_allclose(shown(run, "y"), expected, atol=1e-12)
    drawn = shown(run, "r")
    assert len(set(drawn)) == 11
    assert 2.0 <= drawn.min() < drawn.max() <= 3.0


@pytest.mark.parametrize(
    ("how", "resets"),
    [("Rising", [3]), ("Level", [3, 4, 5, 6]), ("Level hold", [3, 4, 5])],
)
def test_a_delay_starts_again_where_it_is_reset(how, resets, tmp_path):
    """The reset is 1 from the third to the fifth sample; a sample counts itself."""
    rig = Rig()
    numbers = rig.block("simulink/Sources/Counter Free-Running", "count", NumBits="8",
                        tsamp=f"{STEP}")  # fmt: skip
    when = rig.block("simulink/Sources/Repeating Sequence Stair", "when",
                     OutValues="[0 0 0 1 1 1 0 0 0 0]", tsamp=f"{STEP}")  # fmt: skip
    rig.show(rig.block("Delay", "late", numbers, when, DelayLength="2", InitialCondition="-7",
                       ExternalReset=how), "y")  # fmt: skip
    run = rig.run(tmp_path, 0.9)
    queue, expected = [-7.0, -7.0], []
    for sample in range(10):
        if sample in resets:
            queue = [-7.0, -7.0]
        expected.append(queue[0])
        queue = [queue[1], float(sample)]
    sample = np.floor(run.time / STEP + 1e-9).astype(int)
    np.testing.assert_array_equal(shown(run, "y"), np.array(expected)[sample])


def test_a_selector_without_an_input_selects_zeros(tmp_path):
    rig = Rig()
    rig.show(rig.block("Selector", "pick", "", InputPortWidth="9", Indices="[7 8]"), "y")
    assert rig.values(tmp_path)["y"].tolist() == [0.0, 0.0]


def test_a_signal_of_a_bus_is_taken_by_its_place_where_several_are_alike(tmp_path):
    rig = Rig()
    bus = rig.add_block("BusCreator", "bus", {"Inputs": "2"}, ports={"in": 2, "out": 1})
    for place, value in enumerate(("5", "6"), 1):
        rig.connect(rig.constant(value), f"{bus}#in:{place}", name="speed")
    rig.show(rig.block("BusSelector", "pick", bus, OutputSignals="speed (signal 2)"), "y")
    assert rig.values(tmp_path)["y"] == 6.0


def test_a_series_comes_from_the_workspace(tmp_path):
    rig = Rig()
    rig.show(rig.block("FromWorkspace", "in", VariableName="timeseries([1 3 7], [0 1 2])"), "y")
    assert rig.values(tmp_path, 0.5)["y"] == 2.0


def test_a_discrete_filter_of_scipy_is_that_of_a_sampled_system(tmp_path):
    """`c2d` and a Discrete State-Space make the samples of the continuous system's step."""
    rig = Rig()
    system = "c2d(ss([0 1;-4 -1], [0;1], [1 0], 0), 0.1)"
    matrices = {name: f"getfield({system}, '{name}')" for name in "ABCD"}
    rig.show(rig.block("DiscreteStateSpace", "sampled", rig.constant("1"), SampleTime=f"{STEP}",
                       **matrices), "y")  # fmt: skip
    run = rig.run(tmp_path, 1.0)
    _, y = signal.step(([1.0], [1.0, 1.0, 4.0]), T=STEP * np.arange(11))
    sample = np.floor(run.time / STEP + 1e-9).astype(int)
    np.testing.assert_allclose(shown(run, "y"), y[sample], atol=1e-9)


def test_a_function_in_a_file_sees_the_global_variables_of_scripts(tmp_path):
    """It counts its samples, from a number that a callback sets."""
    (tmp_path / "counted.m").write_text(
        "function y = counted(x)\nglobal K n\nif isempty(n), n = 0; end\nn = n + x;\ny = K + n;\n"
    )
    rig = Rig(callbacks={"PreLoadFcn": "global K\nK = 40;"})
    held = rig.block("ZeroOrderHold", "held", rig.constant("2"), SampleTime=f"{STEP}")
    rig.show(rig.block("MATLABFcn", "file", held, MATLABFcn="counted"), "y")
    run = rig.run(tmp_path, 0.5)
    sample = np.floor(run.time / STEP + 1e-9)
    np.testing.assert_array_equal(shown(run, "y"), 42.0 + 2.0 * sample)


PWM = "simulink/Discontinuities/PWM"


def test_pulses_last_as_long_as_the_width_that_came_at_their_start(tmp_path):
    """The mean over each period is the width then: 0.2, 0.6 and so on of a ramp."""
    rig = Rig()
    ramp = rig.block("Clock", "clock")
    given = {"Period": "0.2", "InitialDelay": "0.1", "SampleTime": "0.01",
             "RunAtFixedTimeIntervals": "on"}  # fmt: skip
    rig.show(rig.block(PWM, "pulses", ramp, **given), "pulses")
    run = rig.run(tmp_path, 1.0)
    found = shown(run, "pulses").ravel()
    for t, value in zip(run.time, found, strict=True):
        start = 0.1 + 0.2 * np.floor((t - 0.1) / 0.2 + 1e-9)
        if abs((t / 0.01) % 1.0 - 0.5) < 0.4:  # away from the samples
            place = np.floor((t - start) / 0.01 + 1e-6)
            assert value == float(t > 0.1 and place < start * 20 - 1e-6), t


def test_pulses_at_times_of_their_own_are_refused(tmp_path):
    rig = Rig()
    rig.show(rig.block(PWM, "pulses", rig.constant("0.5"), Period="1"), "y")
    with pytest.raises(InvalidValueError, match="let it run at fixed time intervals"):
        rig.values(tmp_path)


def test_what_becomes_too_large_is_no_number_and_said(tmp_path):
    assert friction(1e200, 2.0, 1.0, 0.5, 0.1) == pytest.approx(5e199)
    rig = Rig()
    rig.show(rig.block("Integrator", "x", rig.constant("1")), "x")
    model = read_model(rig.write(tmp_path / "m.slx"))
    signals = runnable(model, duration=1.0).diagram.signals
    signals.forget()

    def derivatives(t, x, m, y, e):
        return np.array([x[0] ** 3])

    found = signals._computed(derivatives, (0.0, [1e200], [], np.zeros(0), np.zeros(0)), 1)
    assert np.isnan(found).all()
    assert signals.what_is_not_finite() == "a signal becomes too large for a number"
