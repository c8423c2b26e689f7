"""Blocks without states: what they put out, against NumPy and arithmetic by hand."""

import math

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import SEQUENCES
from drake_leg.simulink.running.operations import angles_of, inverse

V = "[1 -2 3]"
M = "[1 2;3 4]"
NAN = math.nan

CASES = [
    # kind, parameters, inputs, expected
    ("Gain", {"Gain": "3"}, ["2"], 6.0),
    ("Gain", {"Gain": "[1 2 3]"}, ["2"], [2.0, 4.0, 6.0]),
    ("Gain", {"Gain": "[1 2 3]"}, [V], [1.0, -4.0, 9.0]),
    ("Gain", {"Gain": M, "Multiplication": "Matrix(K*u)"}, ["[5 6]"], [17.0, 39.0]),
    ("Gain", {"Gain": "[1 2]", "Multiplication": "Matrix(K*u)"}, ["[5 6]"], 17.0),
    ("Gain", {"Gain": M, "Multiplication": "Matrix(u*K)"}, [M], [[7.0, 10.0], [15.0, 22.0]]),
    ("Bias", {"Bias": "0.5"}, [V], [1.5, -1.5, 3.5]),
    ("Sum", {"Inputs": "|+-"}, ["5", "2"], 3.0),
    ("Sum", {"Inputs": "-+-"}, ["5", V, "1"], [-5.0, -8.0, -3.0]),
    ("Sum", {"Inputs": "+"}, [V], 2.0),
    ("Product", {"Inputs": "*/"}, ["6", "4"], 1.5),
    ("Product", {"Inputs": "*/"}, ["1", "0"], math.inf),
    ("Product", {"Inputs": "*/"}, ["0", "0"], NAN),
    ("Product", {"Inputs": "3"}, ["2", V, "5"], [10.0, -20.0, 30.0]),
    ("Product", {"Inputs": "1"}, [V], -6.0),
    ("Product", {"Inputs": "2", "Multiplication": "Matrix(*)"}, [M, "[1 1]"], [3.0, 7.0]),
    ("Product", {"Inputs": "/", "Multiplication": "Matrix(*)"}, [M], [[-2.0, 1.0], [1.5, -0.5]]),
    ("Math", {"Operator": "exp"}, ["1"], math.e),
    ("Math", {"Operator": "log"}, ["0"], -math.inf),
    ("Math", {"Operator": "10^u"}, ["2"], 100.0),
    ("Math", {"Operator": "square"}, [V], [1.0, 4.0, 9.0]),
    ("Math", {"Operator": "pow"}, ["2", "-1"], 0.5),
    ("Math", {"Operator": "pow"}, ["-8", "1/3"], NAN),
    ("Math", {"Operator": "reciprocal"}, ["0"], math.inf),
    ("Math", {"Operator": "mod"}, ["-1", "3"], 2.0),
    ("Math", {"Operator": "rem"}, ["-1", "3"], -1.0),
    ("Math", {"Operator": "mod"}, ["[-1 5]", "3"], [2.0, 2.0]),
    ("Math", {"Operator": "hypot"}, ["3", "4"], 5.0),
    ("Math", {"Operator": "transpose"}, [V], [[1.0, -2.0, 3.0]]),
    ("Sqrt", {}, ["9"], 3.0),
    ("Sqrt", {}, ["-9"], NAN),
    ("Sqrt", {"Operator": "signedSqrt"}, ["-9"], -3.0),
    ("Trigonometry", {"Operator": "sin"}, ["pi/6"], 0.5),
    ("Trigonometry", {"Operator": "acos"}, ["2"], NAN),
    ("Trigonometry", {"Operator": "atan2"}, ["1", "-1"], 0.75 * math.pi),
    ("Trigonometry", {"Operator": "cos"}, [V], np.cos([1.0, -2.0, 3.0])),
    ("Abs", {}, [V], [1.0, 2.0, 3.0]),
    ("Signum", {}, [V], [1.0, -1.0, 1.0]),
    ("Signum", {}, ["0"], 0.0),
    ("UnaryMinus", {}, [V], [-1.0, 2.0, -3.0]),
    ("Rounding", {"Operator": "round"}, ["-2.5"], -3.0),
    ("Rounding", {"Operator": "round"}, ["[0.5 1.5 -0.5]"], [1.0, 2.0, -1.0]),
    ("Rounding", {"Operator": "fix"}, ["-2.5"], -2.0),
    ("Rounding", {"Operator": "floor"}, ["-2.5"], -3.0),
    ("MinMax", {"Function": "max", "Inputs": "1"}, [V], 3.0),
    ("MinMax", {"Function": "min", "Inputs": "2"}, [V, "0"], [0.0, -2.0, 0.0]),
    ("DotProduct", {}, [V, "[2 2 2]"], 4.0),
    ("simulink/Math/Cross Product", {}, ["[1 0 0]", "[0 1 0]"], [0.0, 0.0, 1.0]),
    ("Polyval", {"Coefs": "[1 0 -1]"}, ["3"], 8.0),
    ("Fcn", {"Expr": "u(1)*exp(-u(2))"}, ["[3 0]"], 3.0),
    ("MATLABFcn", {"MATLABFcn": "norm"}, ["[3 4]"], 5.0),
    ("RelationalOperator", {"Operator": ">="}, [V, "1"], [1.0, 0.0, 1.0]),
    ("RelationalOperator", {"Operator": "~="}, ["1", "1"], 0.0),
    ("simulink/Logic/Compare To Constant", {"relop": "<", "const": "2"}, [V], [1.0, 1.0, 0.0]),
    ("simulink/Logic/Compare To Zero", {"relop": "=="}, ["0"], 1.0),
    ("simulink/Logic/Interval Test", {"lowlimit": "-1", "uplimit": "1"}, [V], [1.0, 0.0, 0.0]),
    ("Logic", {"Operator": "AND"}, ["1", "0"], 0.0),
    ("Logic", {"Operator": "NOR"}, ["0", "0"], 1.0),
    ("Logic", {"Operator": "NOT"}, [V], [0.0, 0.0, 0.0]),
    ("Logic", {"Operator": "XOR"}, ["1", "0"], 1.0),
    ("Logic", {"Operator": "OR"}, ["[0 0 1]"], 1.0),
    ("Switch", {"Criteria": "u2 >= Threshold", "Threshold": "1"}, ["5", "1", "7"], 5.0),
    ("Switch", {"Criteria": "u2 > Threshold", "Threshold": "1"}, ["5", "1", "7"], 7.0),
    ("Switch", {"Criteria": "u2 ~= 0"}, ["5", "[1 0]", "7"], [5.0, 7.0]),
    ("Switch", {"Threshold": "0"}, ["5", "1", "[7 8]"], [5.0, 5.0]),
    ("MultiPortSwitch", {"Inputs": "2"}, ["2", "10", "[20 30]"], [20.0, 30.0]),
    ("ManualSwitch", {"sw": "0", "CurrentSetting": "1"}, ["5", "7"], 7.0),
    ("Saturate", {"UpperLimit": "2", "LowerLimit": "-1"}, [V], [1.0, -1.0, 2.0]),
    ("DeadZone", {"LowerValue": "-1", "UpperValue": "2"}, [V], [0.0, -1.0, 1.0]),
    ("Quantizer", {"QuantizationInterval": "0.5"}, ["1.3"], 1.5),
    ("Mux", {"Inputs": "3"}, ["1", V, "5"], [1.0, 1.0, -2.0, 3.0, 5.0]),
    ("Selector", {"Indices": "[3 1]", "InputPortWidth": "3"}, [V], [3.0, 1.0]),
    (
        "Selector",
        {
            "NumberOfDimensions": "2",
            "Indices": "[1 2],[2]",
            "IndexOptions": "Index vector (dialog),Index vector (dialog)",
        },
        [M],
        [[2.0], [4.0]],
    ),
    ("Concatenate", {"NumInputs": "2"}, [V, "4"], [1.0, -2.0, 3.0, 4.0]),
    (
        "Concatenate",
        {"NumInputs": "2", "Mode": "Multidimensional array", "ConcatenateDimension": "2"},
        [M, "[5 6]"],
        [[1.0, 2.0, 5.0], [3.0, 4.0, 6.0]],
    ),
    ("Reshape", {"OutputDimensionality": "1-D array"}, [M], [1.0, 3.0, 2.0, 4.0]),
    ("Assignment", {"Indices": "[2]"}, [V, "9"], [1.0, 9.0, 3.0]),
    ("Width", {}, [V], 3.0),
    ("DataTypeConversion", {"OutDataTypeStr": "int8"}, ["300.7"], 127.0),
    ("DataTypeConversion", {"OutDataTypeStr": "int32"}, ["-2.5"], -3.0),
    ("DataTypeConversion", {"OutDataTypeStr": "double"}, [V], [1.0, -2.0, 3.0]),
    (
        "Lookup_n-D",
        {"BreakpointsForDimension1": "[0 1 3]", "Table": "[0 10 20]"},
        ["2"],
        15.0,
    ),
    ("Lookup_n-D", {"BreakpointsForDimension1": "[0 1]", "Table": "[0 10]"}, ["2"], 20.0),
    (
        "Lookup_n-D",
        {"BreakpointsForDimension1": "[0 1]", "Table": "[0 10]", "ExtrapMethod": "Clip"},
        ["2"],
        10.0,
    ),
    (
        "Lookup_n-D",
        {
            "NumberOfTableDimensions": "2",
            "BreakpointsForDimension1": "[0 1]",
            "BreakpointsForDimension2": "[0 2]",
            "Table": "[0 2;1 3]",
        },
        ["0.5", "1"],
        1.5,
    ),
    (
        "Lookup_n-D",
        {
            "InputPortMap": "u0,u1",
            "BreakpointsForDimension1": "[0 1]",
            "BreakpointsForDimension2": "[0 2]",
            "Table": "[0 2;1 3]",
            "InterpMethod": "Nearest",
        },
        ["0.6", "0.9"],
        1.0,
    ),
    (
        "robotcorelib/Coordinate Transformation Conversion",
        {"InputRepresentation": "Euler Angles", "OutputRepresentation": "Quaternion"},
        ["[pi/2 0 0]"],
        [math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)],
    ),
    (
        "robotcorelib/Coordinate Transformation Conversion",
        {"InputRepresentation": "Axis-Angle", "OutputRepresentation": "Rotation Matrix"},
        ["[0 0 2 pi/2]"],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    ),
    ("Lookup", {"InputValues": "[0 1]", "Table": "[5 6]"}, ["0.5"], 5.5),
    (
        "simulink/Lookup/Lookup Table Dynamic",
        {"LookUpMeth": "Interpolation-Use End Values"},
        ["4", "[0 1 3]", "[0 10 20]"],
        20.0,
    ),
    ("simulink/Lookup/Lookup Table Dynamic", {}, ["4", "[0 1 3]", "[0 10 20]"], 25.0),
    ("hdlsllib/HDL Operations/Multiply-Add", {}, [V, "2", "10"], [12.0, 6.0, 16.0]),
    (
        "hdlsllib/HDL Operations/Multiply-Add",
        {"Function": "(a.*b)-c"},
        ["3", "4", "5"],
        7.0,
    ),
    ("simulink/Limits/Dead Zone Dynamic", {}, ["2", V, "-1"], [0.0, -1.0, 1.0]),
    ("simulink_extras/Cartesian to Polar", {}, ["3", "4"], 5.0),
    ("simulink_extras/Polar to Cartesian", {}, ["2", "pi/3"], 1.0),
]


def test_what_blocks_put_out(tmp_path):
    rig = Rig()
    for number, (kind, parameters, inputs, _) in enumerate(CASES):
        sources = [rig.constant(value) for value in inputs]
        rig.show(rig.block(kind, f"block {number}", *sources, **parameters), f"y{number}")
    values = rig.values(tmp_path)
    for number, (kind, parameters, inputs, expected) in enumerate(CASES):
        about = f"{kind} {parameters} of {inputs}"
        found = values[f"y{number}"]
        np.testing.assert_allclose(found, expected, rtol=1e-14, atol=3e-16, err_msg=about)
        assert np.shape(found) == np.shape(expected), about


SOURCES = [
    ("Sin", {"Amplitude": "2", "Frequency": "3", "Phase": "0.1", "Bias": "1"},
     lambda t: 2.0 * math.sin(3.0 * t + 0.1) + 1.0),
    ("Step", {"Time": "0.5", "Before": "1", "After": "4"}, lambda t: 4.0 if t >= 0.5 else 1.0),
    ("Clock", {}, lambda t: t),
    ("simulink/Sources/Ramp", {"slope": "2", "start": "0.3", "InitialOutput": "1"},
     lambda t: 1.0 + 2.0 * max(t - 0.3, 0.0)),
    ("DiscretePulseGenerator", {"Amplitude": "3", "Period": "0.4", "PulseWidth": "25"},
     lambda t: 3.0 if math.fmod(t, 0.4) < 0.1 else 0.0),
    ("SignalGenerator", {"WaveForm": "square", "Amplitude": "2", "Frequency": "1",
                         "Units": "Hertz"},
     lambda t: 2.0 if math.fmod(t, 1.0) < 0.5 else -2.0),
    ("simulink/Sources/Repeating Sequence", {"rep_seq_t": "[0 0.2 1]", "rep_seq_y": "[0 1 0]"},
     lambda t: float(np.interp(math.fmod(t, 1.0), [0.0, 0.2, 1.0], [0.0, 1.0, 0.0]))),
    ("simulink/Sources/Chirp Signal", {"f1": "1", "f2": "3", "T": "2"},
     lambda t: math.sin(2.0 * math.pi * (1.0 + 0.5 * t) * t)),
    ("FromWorkspace", {"VariableName": "[0 1;1 3;2 7]"},
     lambda t: float(np.interp(t, [0.0, 1.0, 2.0], [1.0, 3.0, 7.0]))),
]  # fmt: skip


@pytest.mark.parametrize("time", [0.0, 0.05, 0.37, 0.61, 0.93, 1.75])
def test_what_sources_put_out(tmp_path, time):
    rig = Rig()
    for number, (kind, parameters, _) in enumerate(SOURCES):
        rig.show(rig.block(kind, f"source {number}", **parameters), f"y{number}")
    values = rig.values(tmp_path, time)
    for number, (kind, _, law) in enumerate(SOURCES):
        assert values[f"y{number}"] == pytest.approx(law(time), abs=1e-13), kind


def test_matrices_over_time_come_from_the_workspace(tmp_path):
    rig = Rig()
    texts = {
        "a": "struct('time', [0 1], 'signals', struct('values', cat(3, [1 2;3 4], [5 6;7 8])))",
        "b": "struct('time', [0;1], 'signals', struct('values', cat(3, [1;2], [3;4])))",
        "c": "struct('time', [0;1], 'signals', struct('values', [1 2;3 4]))",
    }
    for name, text in texts.items():
        rig.show(rig.block("FromWorkspace", f"from {name}", VariableName=text), name)
    values = rig.values(tmp_path, 0.5)
    assert values["a"].tolist() == [[3.0, 4.0], [5.0, 6.0]]
    assert values["b"].tolist() == [2.0, 3.0]
    assert values["c"].tolist() == [2.0, 3.0]


def test_a_transfer_function_may_begin_with_zeros(tmp_path):
    rig = Rig()
    u = rig.constant("3")
    rig.show(rig.block("TransferFcn", "gain", u, Numerator="[0 2]", Denominator="[0 4]"), "gain")
    assert rig.values(tmp_path)["gain"] == 1.5


def test_a_bus_is_taken_apart_by_names(tmp_path):
    rig = Rig()
    a, b = rig.constant("1"), rig.constant("[2 3]")
    creator = rig.add_block("BusCreator", "bus", {"Inputs": "2"}, ports={"in": 2, "out": 1})
    rig.connect(a, f"{creator}#in:1", name="a")
    rig.connect(b, f"{creator}#in:2", name="b")
    rig.show(rig.block("BusSelector", "select", creator, OutputSignals="b"), "b")
    rig.show(creator, "all")
    values = rig.values(tmp_path)
    assert values["b"].tolist() == [2.0, 3.0]
    assert values["all.a"] == 1.0


def test_a_demux_shares_out_what_comes(tmp_path):
    rig = Rig()
    demux = rig.add_block("Demux", "demux", {"Outputs": "2"}, ports={"in": 1, "out": 2})
    rig.connect(rig.constant("[1 2 3]"), demux)
    rig.show(f"{demux}#out:1", "first")
    rig.show(f"{demux}#out:2", "rest")
    values = rig.values(tmp_path)
    assert values["first"].tolist() == [1.0, 2.0]
    assert values["rest"] == 3.0


@pytest.mark.parametrize(("at", "beyond"), [(-1.0, "Linear"), (1.7, "Clip"), (9.0, "Clip")])
def test_a_prelookup_and_an_interpolation_are_a_table(at, beyond, tmp_path):
    rig = Rig()
    u, v = rig.constant(str(at)), rig.constant("0.4")
    one = rig.add_block("PreLookup", "one", {"BreakpointsData": "[0 1 3]", "ExtrapMethod": beyond},
                        ports={"in": 1, "out": 2})  # fmt: skip
    two = rig.add_block("PreLookup", "two", {"BreakpointsData": "[0 2]"}, ports={"in": 1, "out": 2})
    rig.connect(u, one)
    rig.connect(v, two)
    ends = [f"{one}#out:1", f"{one}#out:2", f"{two}#out:1", f"{two}#out:2"]
    rig.show(rig.block("Interpolation_n-D", "line", *ends[:2], Table="[5 7 1]",
                       NumberOfTableDimensions="1"), "line")  # fmt: skip
    rig.show(rig.block("Interpolation_n-D", "plane", *ends, Table="[5 6;7 8;1 4]",
                       NumberOfTableDimensions="2"), "plane")  # fmt: skip
    rig.show(rig.block("Lookup_n-D", "same line", u, Table="[5 7 1]", ExtrapMethod=beyond,
                       BreakpointsForDimension1="[0 1 3]"), "same line")  # fmt: skip
    rig.show(rig.block("Lookup_n-D", "same plane", u, v, Table="[5 6;7 8;1 4]",
                       NumberOfTableDimensions="2", BreakpointsForDimension1="[0 1 3]",
                       BreakpointsForDimension2="[0 2]", ExtrapMethod=beyond),
             "same plane")  # fmt: skip
    found = rig.values(tmp_path)
    assert found["line"] == pytest.approx(found["same line"])
    assert found["plane"] == pytest.approx(found["same plane"])


def test_a_multiport_switch_chooses_whole_numbers_or_the_last(tmp_path):
    rig = Rig()
    a, b, c = (rig.constant(text) for text in ("[1 2]", "[3 4]", "7"))
    for control in ("1", "2.9", "0", "5", "3"):
        rig.show(
            rig.block("MultiPortSwitch", f"switch {control}", rig.constant(control), a, b, c,
                      Inputs="3"),
            f"of {control}",
        )  # fmt: skip
    each = rig.constant("[3 1]")
    rig.show(rig.block("MultiPortSwitch", "each", each, a, b, c, Inputs="3"), "each")
    rig.show(rig.block("MultiPortSwitch", "entry", rig.constant("2"), a, Inputs="1"), "entry")
    values = rig.values(tmp_path)
    assert [values[f"of {control}"].tolist() for control in ("1", "2.9", "0", "5", "3")] == [
        [1.0, 2.0], [3.0, 4.0], [7.0, 7.0], [7.0, 7.0], [7.0, 7.0],
    ]  # fmt: skip
    assert values["each"].tolist() == [7.0, 2.0]
    assert values["entry"] == 2.0


@pytest.mark.parametrize("order", SEQUENCES)
def test_angles_of_a_direction_cosine_matrix_are_those_of_its_rotation(order):
    turned = Rotation.random(20, random_state=5)
    for one in turned:
        found = angles_of(one.as_matrix().T, order)
        np.testing.assert_allclose(found, one.as_euler(order), atol=1e-13)
    locked = Rotation.from_euler(order, [0.3, 0.0 if order[0] == order[2] else np.pi / 2, 0.4])
    found = angles_of(locked.as_matrix().T, order)
    assert found[0] == 0.0
    again = Rotation.from_euler(order, found).as_matrix()
    np.testing.assert_allclose(again, locked.as_matrix(), atol=1e-12)


def test_a_matrix_of_three_is_inverted_as_any_other():
    a = np.random.default_rng(3).normal(size=(3, 3))
    np.testing.assert_allclose(inverse(a), np.linalg.inv(a), rtol=1e-12)
    assert np.all(inverse(np.zeros((3, 3))) == math.inf)


@pytest.mark.parametrize(("between", "before"), [("on", 2.5), ("off", 3.0)])
@pytest.mark.parametrize(
    ("end", "after"),
    [("Setting to zero", 0.0), ("Holding final value", 2.0), ("Extrapolation", None)],
)
def test_what_comes_after_a_table_over_time(between, before, end, after, tmp_path):
    rig = Rig()
    rig.show(rig.block("FromWorkspace", "from", VariableName="[0 1; 0.25 3; 0.5 2]",
                       Interpolate=between, OutputAfterFinalValue=end), "y")  # fmt: skip
    if after is None:
        after = 1.0 if between == "on" else 2.0
    found = [rig.values(tmp_path, time)["y"] for time in (0.375, 0.5, 0.75)]
    assert found == pytest.approx([before, 2.0, after])


def test_a_table_over_time_that_repeats_is_refused(tmp_path):
    rig = Rig()
    rig.show(rig.block("FromWorkspace", "from", VariableName="[0 1; 1 2]",
                       OutputAfterFinalValue="Cyclic repetition"), "y")  # fmt: skip
    with pytest.raises(
        InvalidValueError,
        match="repeats its data, which takes a structure without times, and no interpolation",
    ):
        rig.values(tmp_path)


@pytest.mark.parametrize(
    ("end", "after"), [("Cyclic repetition", [2, 5]), ("Holding final value", [7, 7])]
)
def test_a_structure_without_times_has_its_block_s_samples(end, after, tmp_path):
    rig = Rig()
    rig.show(rig.block("FromWorkspace", "from", SampleTime="0.1", Interpolate="off",
                       VariableName="struct('time', [], 'signals', struct('values', [2;5;7]))",
                       OutputAfterFinalValue=end), "y")  # fmt: skip
    run = rig.run(tmp_path, 0.5)
    found = shown(run, "y")[np.searchsorted(run.time, np.arange(5) / 10 + 0.05)]
    assert found.ravel().tolist() == [2, 5, 7, *after]


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ("[0 1; 2 3; 1 4]", "reads times that fall from 2 to 1: sort them"),
        ("struct('signals', struct('values', [1;2]))", "which needs a sample time"),
        ("struct('time', [0;1], 'signals', {struct('values', 1)})", "reads 2 times and 1 rows"),
    ],
)
def test_tables_over_time_that_are_none_are_refused(given, reason, tmp_path):
    rig = Rig()
    rig.show(rig.block("FromWorkspace", "from", VariableName=given), "y")
    with pytest.raises(InvalidValueError, match=reason):
        rig.values(tmp_path)


@pytest.mark.parametrize("kind", ["RandomNumber", "UniformRandomNumber"])
def test_random_numbers_without_a_sample_time_stay_for_a_step(kind, tmp_path):
    """What integrates them sees one number in each step."""
    rig = Rig()
    noise = rig.block(kind, "noise", SampleTime="0")
    rig.show(noise, "noise")
    rig.show(rig.block("Integrator", "x", noise), "x")
    run = rig.run(tmp_path, 0.05, accuracy=1e-6)
    x, drawn = (shown(run, name).ravel() for name in ("x", "noise"))
    np.testing.assert_allclose(np.diff(x), np.diff(run.time) * drawn[:-1], atol=1e-15)
    assert np.unique(drawn).size > 100


def test_an_integral_without_gain_stays_where_it_starts(tmp_path):
    rig = Rig()
    given = {"Controller": "PI", "P": "2", "I": "0", "InitialConditionForIntegrator": "5"}
    for kind in ("PID Controller", "Discrete PID Controller"):
        block = rig.block(f"simulink/Controllers/{kind}", kind, rig.constant("3"), **given,
                          SampleTime="0.1")  # fmt: skip
        rig.show(block, kind)
    assert rig.values(tmp_path) == {"PID Controller": 11.0, "Discrete PID Controller": 11.0}
