"""Options of blocks: each is heeded or refused, never passed over."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy import signal

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.kinds.options import USUAL

STEP = 0.05  # [s]
LIBRARIES = {
    "PID Controller (2DOF)": "simulink/Continuous/PID Controller (2DOF)",
    "Discrete PID Controller (2DOF)": "simulink/Discrete/Discrete PID Controller (2DOF)",
    "PID Controller": "simulink/Continuous/PID Controller",
    "Discrete PID Controller": "simulink/Discrete/Discrete PID Controller",
    "Moving Average": "dspstat3/Moving Average",
    "Random Source": "dspsrcs4/Random Source",
    "Signal Editor": "SignalEditorBlockLib/Signal Editor",
    "Sine Wave": "dspsrcs4/Sine Wave",
}


@pytest.mark.parametrize(
    ("kind", "option"), [(kind, option) for kind, usual in USUAL.items() for option in usual]
)
def test_what_does_not_run_is_refused_by_its_name(kind, option, tmp_path):
    rig = Rig()
    u = rig.constant("1")
    rig.show(rig.block(LIBRARIES.get(kind, kind), "odd", u, u, u, **{option: "strange"}), "y")
    with pytest.raises(InvalidValueError, match=rf"'odd'.* {option} 'strange', which does not run"):
        rig.run(tmp_path)


def present(method):
    """1/z and what comes in, as a discrete integral of a method takes them: STEP / (z - 1)."""
    return {
        "Forward Euler": ([0.0, STEP], [1.0, -1.0]),
        "Backward Euler": ([STEP, 0.0], [1.0, -1.0]),
        "Trapezoidal": ([STEP / 2.0, STEP / 2.0], [1.0, -1.0]),
    }[method]


@pytest.mark.parametrize("method", ["Forward Euler", "Backward Euler", "Trapezoidal"])
def test_a_discrete_controller_integrates_by_its_methods(method, tmp_path):
    rig = Rig()
    held = rig.block("ZeroOrderHold", "hold", rig.block("Sin", "sine", Frequency="5"),
                     SampleTime=f"{STEP}")  # fmt: skip
    common = {"TimeDomain": "Discrete-time", "SampleTime": "-1", "P": "0"}
    integral = rig.block("simulink/Discrete/PID Controller", "I", held,
                         Controller="I", I="3", IntegratorMethod=method, **common)  # fmt: skip
    derivative = rig.block("simulink/Discrete/PID Controller", "D", held, Controller="PD",
                           D="0.2", N="8", FilterMethod=method, **common)  # fmt: skip
    rig.show(integral, "integral")
    rig.show(derivative, "derivative")
    run = rig.run(tmp_path)
    k = np.round(run.time / STEP - 1e-6 - 0.5).astype(int).clip(0)
    samples = np.sin(5.0 * STEP * np.arange(30))
    top, bottom = (np.array(each) for each in present(method))
    expected = 3.0 * signal.lfilter(top, bottom, samples)
    inside = np.abs(run.time / STEP - np.round(run.time / STEP)) > 1e-6
    np.testing.assert_allclose(shown(run, "integral")[inside], expected[k][inside], atol=1e-12)
    # D N / (1 + N a(z)), where a(z) is the integral.
    expected = signal.lfilter(0.2 * 8.0 * bottom, bottom + 8.0 * top, samples)
    np.testing.assert_allclose(shown(run, "derivative")[inside], expected[k][inside], atol=1e-12)


def test_a_continuous_controller_is_so_behind_a_hold(tmp_path):
    rig = Rig()
    held = rig.block("ZeroOrderHold", "hold", rig.constant("2"), SampleTime="0.1")
    rig.show(rig.block("simulink/Continuous/PID Controller", "I", held,
                       Controller="I", I="3", TimeDomain="Continuous-time"), "y")  # fmt: skip
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "y"), 6.0 * run.time, atol=1e-9)


def test_a_transfer_function_starts_at_its_initial_output(tmp_path):
    rig = Rig()
    kind = "simulink_extras/Additional Linear/Transfer Fcn (with initial outputs)"
    u = rig.constant("1")
    rig.show(rig.block(kind, "first", u, N="[1]", D="[0.5 1]", U0="0", Y0="-0.02"), "first")
    rig.show(rig.block(kind, "second", u, N="[4]", D="[1 2 4]", U0="0", Y0="0.3"), "second")
    run = rig.run(tmp_path)
    decay = np.exp(-run.time / 0.5)
    np.testing.assert_allclose(shown(run, "first"), 1.0 - 1.02 * decay, atol=1e-8)
    w = np.sqrt(3.0)
    swing = np.exp(-run.time) * (np.cos(w * run.time) + np.sin(w * run.time) / w)
    np.testing.assert_allclose(shown(run, "second"), 1.0 - 0.7 * swing, atol=1e-8)


def enabled(rig, gate, *, states, output, initial="[]"):
    """A subsystem that integrates 1, and counts the samples, while it runs."""
    system = rig.add_block("SubSystem", "gated", ports={"out": 2, "enable": 1})
    rig.add_block("EnablePort", "gate", {"StatesWhenEnabling": states}, system=system)
    one = rig.block("Constant", "one", Value="1", system=system)
    integral = rig.block("Integrator", "integral", one, system=system, InitialCondition="0.5")
    count = rig.block("DiscreteIntegrator", "count", one, system=system, SampleTime="0.1")
    for number, source in ((1, integral), (2, count)):
        options = {"Port": str(number), "OutputWhenDisabled": output, "InitialOutput": initial}
        port = rig.add_block("Outport", f"out {number}", options, system=system, ports={"in": 1})
        rig.connect(source, port)
    rig.connect(gate, f"{system}#enable")
    rig.show(f"{system}#out:1", "integral")
    rig.show(f"{system}#out:2", "count")


def pulse_of(rig):
    """On in [0, 0.4) and from 1 on."""
    return rig.block("DiscretePulseGenerator", "pulse", Period="1", PulseWidth="40")


@pytest.mark.parametrize(("states", "again"), [("reset", 0.5), ("held", 0.9)])
def test_states_start_again_or_go_on_where_a_subsystem_is_enabled(states, again, tmp_path):
    rig = Rig()
    enabled(rig, pulse_of(rig), states=states, output="held")
    run = rig.run(tmp_path, 1.3)
    late = run.time > 1.001
    expected = again + run.time[late] - 1.0
    np.testing.assert_allclose(shown(run, "integral")[late], expected, atol=1e-7)
    counted = shown(run, "count")[late] - (0.0 if states == "reset" else 0.4)
    k = np.floor(10.0 * (run.time[late] - 1.0) + 1e-9)
    np.testing.assert_allclose(counted, 0.1 * k, atol=1e-9)


@pytest.mark.parametrize(("initial", "off"), [("[]", 0.0), ("-7", -7.0)])
def test_an_output_is_reset_where_a_subsystem_is_off(initial, off, tmp_path):
    rig = Rig()
    enabled(rig, pulse_of(rig), states="held", output="reset", initial=initial)
    run = rig.run(tmp_path, 0.9)
    assert np.all(shown(run, "integral")[run.time > 0.4] == off)
    early = run.time < 0.4 - 1e-9
    np.testing.assert_allclose(shown(run, "integral")[early], 0.5 + run.time[early], atol=1e-9)


def test_a_branch_starts_again_each_time_that_it_is_chosen(tmp_path):
    rig = Rig()
    chooser = rig.add_block("If", "if", {"IfExpression": "u1 > 0"}, ports={"in": 1, "out": 1})
    rig.connect(pulse_of(rig), chooser)
    system = rig.add_block("SubSystem", "branch", ports={"out": 1, "ifaction": 1})
    rig.add_block("ActionPort", "action", {"InitializeStates": "reset"}, system=system)
    one = rig.block("Constant", "one", Value="1", system=system)
    integral = rig.block("Integrator", "integral", one, system=system)
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(integral, out)
    rig.connect(f"{chooser}#out:1", f"{system}#ifaction")
    rig.show(system, "y")
    run = rig.run(tmp_path, 1.3)
    late = run.time > 1.001
    np.testing.assert_allclose(shown(run, "y")[late], run.time[late] - 1.0, atol=1e-7)


def test_a_function_runs_at_its_own_sample_time(tmp_path):
    rig = Rig()
    function = rig.add_function("twice", "function y = twice(u)\ny = 2*u;\n", **{"in": 1, "out": 1})
    rig.set("twice", SystemSampleTime="0.1")
    rig.connect(rig.block("Clock", "clock"), function)
    rig.show(function, "y")
    run = rig.run(tmp_path, 0.95)
    k = np.floor(10.0 * run.time + 1e-9)
    np.testing.assert_allclose(shown(run, "y"), 0.2 * k, atol=1e-9)


def test_blocks_run_at_the_sample_time_of_their_subsystem(tmp_path):
    rig = Rig()
    system = rig.add_block(
        "SubSystem", "slow", {"SystemSampleTime": "0.1", "TreatAsAtomicUnit": "on"},
        ports={"in": 1, "out": 1},
    )  # fmt: skip
    inside = rig.add_block("Inport", "in", {"Port": "1"}, system=system, ports={"out": 1})
    gain = rig.block("Gain", "gain", inside, system=system, Gain="3")
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(gain, out)
    rig.connect(rig.block("Clock", "clock"), system)
    rig.show(system, "y")
    run = rig.run(tmp_path, 0.95)
    k = np.floor(10.0 * run.time + 1e-9)
    np.testing.assert_allclose(shown(run, "y"), 0.3 * k, atol=1e-9)


def test_a_table_may_come_in_with_its_points(tmp_path):
    rig = Rig()
    points, values = rig.constant("[0 1 3]"), rig.constant("[5 7 1]")
    source = {"BreakpointsForDimension1Source": "Input port", "TableSource": "Input port"}
    u = rig.constant("2")
    rig.show(rig.block("Lookup_n-D", "both", u, points, values,
                       NumberOfTableDimensions="1", **source), "both")  # fmt: skip
    rig.show(rig.block("Lookup_n-D", "one", u, values, NumberOfTableDimensions="1",
                       BreakpointsForDimension1="[0 1 4]", TableSource="Input port"),
             "one")  # fmt: skip
    found = rig.values(tmp_path)
    assert found["both"] == 4.0
    assert found["one"] == 5.0


@pytest.mark.parametrize(("direction", "hits"), [("rising", 2), ("falling", 2), ("either", 4)])
def test_crossings_are_told_once_each(direction, hits, tmp_path):
    rig = Rig()
    wave = rig.block("Sin", "sine", Frequency="4*pi", Phase="0.3")
    crossing = rig.block("HitCross", "hit", wave, HitCrossingOffset="0.2",
                         HitCrossingDirection=direction)  # fmt: skip
    total = rig.block("DiscreteIntegrator", "sum", crossing, SampleTime="0.001", gainval="1000")
    rig.show(crossing, "y")
    rig.show(total, "sum")
    run = rig.run(tmp_path)
    assert set(np.unique(shown(run, "y"))) <= {0.0, 1.0}
    assert shown(run, "sum")[-1] == pytest.approx(hits)


def test_an_initial_value_is_put_out_at_the_start_alone(tmp_path):
    rig = Rig()
    rig.show(rig.block("InitialCondition", "start", rig.block("Clock", "clock"), Value="9"), "y")
    assert rig.values(tmp_path) == {"y": 9.0}
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "y")[1:], run.time[1:], atol=1e-12)


@pytest.mark.parametrize(
    ("domain", "UseFilter"),
    [("Continuous-time", "on"), ("Discrete-time", "on"), ("Discrete-time", "off")],
)
def test_a_controller_takes_its_gains_from_ports(domain, UseFilter, tmp_path):
    rig = Rig()
    held = rig.block("ZeroOrderHold", "hold", rig.block("Sin", "sine", Frequency="5"),
                     SampleTime=f"{STEP}")  # fmt: skip
    gains = {"P": "2", "I": "3", "D": "0.2"} | ({"N": "8"} if UseFilter == "on" else {})
    common = {"TimeDomain": domain, "SampleTime": "-1", "UseFilter": UseFilter,
              "FilterMethod": "Trapezoidal", "Controller": "PID"}  # fmt: skip
    ports = [rig.constant(text) for text in gains.values()]
    rig.show(rig.block("simulink/Discrete/PID Controller", "inside", held, **gains, **common), "a")
    rig.show(rig.block("simulink/Discrete/PID Controller", "outside", held, *ports,
                       ControllerParametersSource="external", **common), "b")  # fmt: skip
    run = rig.run(tmp_path)
    assert np.ptp(shown(run, "a")) > 1.0
    np.testing.assert_allclose(shown(run, "b"), shown(run, "a"), rtol=0, atol=1e-12)


def test_discrete_filters_start_at_states_that_are_the_same(tmp_path):
    rig = Rig()
    u = rig.block("ZeroOrderHold", "hold", rig.constant("6"), SampleTime="0.1")
    texts = {"Numerator": "[0.25 0 0 0 -0.25]", "Denominator": "[1 0 0 0 0]", "InitialStates": "4"}
    for kind in ("DiscreteTransferFcn", "DiscreteFilter"):
        rig.show(rig.block(kind, kind, u, SampleTime="0.1", **texts), kind)
    rig.show(rig.block("DiscreteFir", "fir", u, Coefficients="[0.5 0.5]", InitialStates="4"), "fir")
    run = rig.run(tmp_path)
    early = np.where(run.time < 0.4 - 1e-9, 0.5, 0.0)
    np.testing.assert_allclose(shown(run, "DiscreteTransferFcn"), early, atol=1e-12)
    np.testing.assert_allclose(shown(run, "DiscreteFilter"), early, atol=1e-12)
    np.testing.assert_allclose(shown(run, "fir"), np.where(run.time < 0.1 - 1e-9, 5.0, 6.0))


@pytest.mark.parametrize(
    "texts",
    [
        {"InitialStates": "[1 2]", "Denominator": "[1 0.5 0.2]"},
        {"InitialStates": "1", "Denominator": "[2 0.5]"},
        {"InitialStates": "1", "FilterStructure": "Direct form I"},
    ],
)
def test_other_initial_states_of_filters_are_refused(texts, tmp_path):
    rig = Rig()
    rig.show(rig.block("DiscreteFilter", "odd", rig.constant("1"), **texts), "y")
    with pytest.raises(InvalidValueError, match=r"'odd'.* has InitialStates"):
        rig.run(tmp_path)


def test_a_flip_flop_is_set_reset_and_holds(tmp_path):
    rig = Rig()
    s = rig.block("DiscretePulseGenerator", "s", Period="0.4", PulseWidth="50")
    r = rig.block("DiscretePulseGenerator", "r", Period="0.6", PulseWidth="50", PhaseDelay="0.3")
    flip = rig.add_library("simulink_extras/Flip Flops/S-R Flip-Flop", "flip",
                           {"initial_condition": "1"}, ports={"in": 2, "out": 2})  # fmt: skip
    rig.connect(s, f"{flip}#in:1")
    rig.connect(r, f"{flip}#in:2")
    rig.show(f"{flip}#out:1", "q")
    rig.show(f"{flip}#out:2", "not q")
    rig.show(s, "s")
    rig.show(r, "r")
    run = rig.run(tmp_path, 2.0)
    q, state = [], 1.0
    for set_, reset in zip(shown(run, "s"), shown(run, "r"), strict=True):
        state = float((set_ or state) and not reset)
        q.append(state)
    np.testing.assert_array_equal(shown(run, "q"), q)
    expected = (shown(run, "s") == 0.0) & (np.array(q) == 0.0)
    np.testing.assert_array_equal(shown(run, "not q"), expected)


def test_what_is_open_is_as_wide_as_a_matrix_needs(tmp_path):
    rig = Rig()
    inport = rig.add_block("Inport", "in", {"Port": "1"}, ports={"out": 1})
    rig.add_block("Inport", "idle", {"Port": "2"}, ports={"out": 1})
    times = {"Gain": "[1 2 3; 4 5 6]", "Multiplication": "Matrix(K*u)"}
    added = rig.block("Sum", "sum", rig.block("Gain", "K", inport, **times), rig.constant("[7 8]"))
    rig.show(added, "y")
    times["Multiplication"] = "Matrix(u*K)"
    rig.show(rig.block("Gain", "u*K", inport, **times), "row")
    values = rig.values(tmp_path)
    assert values["y"].tolist() == [7.0, 8.0]
    assert np.ravel(values["row"]).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("number", "expected"), [("5", 10.0), ("1", 30.0), ("2", 20.0), ("7", 30.0)]
)
def test_a_multiport_switch_goes_by_the_indices_of_its_ports(number, expected, tmp_path):
    rig = Rig()
    inputs = [rig.constant(value) for value in (number, "10", "20", "30")]
    rig.show(rig.block("MultiPortSwitch", "choice", *inputs, Inputs="3",
                       DataPortOrder="Specify indices", DataPortIndices="{5,[2 3],1}"),
             "y")  # fmt: skip
    assert rig.values(tmp_path) == {"y": expected}


@pytest.mark.parametrize("mode", ["inherited", "continuous"])
def test_a_slope_is_limited_from_sample_to_sample_where_what_comes_in_is_sampled(mode, tmp_path):
    """By samples it begins below the input, and rises at once; else it begins with the input."""
    rig = Rig()
    steps = rig.block("simulink/Sources/Repeating Sequence Stair", "steps",
                      OutValues="[1 1 1 5 5 5 5 5 5 5]", tsamp="0.1")  # fmt: skip
    rig.show(rig.block("RateLimiter", "limited", steps, RisingSlewLimit="4",
                       SampleTimeMode=mode, InitialCondition="0.3"), "y")  # fmt: skip
    run = rig.run(tmp_path, 0.8)
    t, y = run.time, shown(run, "y")
    if mode == "continuous":
        expected = np.clip(1.0 + 4.0 * (t - 0.3), 1.0, 5.0)
    else:
        last = np.floor(t / 0.1 + 1e-6)
        expected = np.where(last < 3, np.minimum(1.0, 0.7 + 0.4 * last), 1.0 + 0.4 * (last - 2))
    assert y == pytest.approx(expected, abs=0.01 if mode == "continuous" else 1e-9)
