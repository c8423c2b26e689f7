"""Blocks of matrices, coordinates and bits, and of few samples, against numbers by hand."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy import signal

from drake_leg.errors import InvalidValueError

STEP = 0.1  # [s]
SAMPLES = np.sin(5.0 * STEP * np.arange(10))
MATRIX = "[1 2 3; 4 5 6; 7 8 9; 10 11 12]"


def outputs(rig, kind, inputs, count, **parameters):
    """Show all outputs of a block behind constants, as y1, y2, ..."""
    ports = {"in": len(inputs), "out": count}
    add = rig.add_library if "/" in kind else rig.add_block
    sid = add(kind, "block", parameters, ports=ports)
    for place, value in enumerate(inputs, 1):
        source = rig.block("Constant", f"value {place}", Value=value, VectorParams1D="off")
        rig.connect(source, f"{sid}#in:{place}")
    for place in range(1, count + 1):
        rig.show(f"{sid}#out:{place}", f"y{place}")
    return sid


def value_of(tmp_path, kind, *inputs, **parameters):
    rig = Rig()
    outputs(rig, kind, inputs, 1, **parameters)
    return rig.values(tmp_path)["y1"]


def test_a_diagonal_is_taken(tmp_path):
    found = value_of(tmp_path, "simulink/Matrix Operations/Extract Diagonal", MATRIX)
    np.testing.assert_array_equal(found, [1, 5, 9])


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ({}, np.arange(1, 13).reshape(4, 3)),
        ({"RowSpan": "Range of rows", "RowStartMode": "Index", "RowStartIndex": "2",
          "ColSpan": "One column", "ColStartMode": "Last"}, [[6], [9], [12]]),
        ({"RowSpan": "Range of rows", "RowEndMode": "Offset from last", "RowEndIndex": "2",
          "ColSpan": "Range of columns", "ColStartMode": "Index", "ColStartIndex": "2"},
         [[2, 3], [5, 6]]),
    ],
)  # fmt: skip
def test_a_part_of_a_matrix_is_taken(parameters, expected, tmp_path):
    found = value_of(tmp_path, "simulink/Matrix Operations/Submatrix", MATRIX, **parameters)
    np.testing.assert_array_equal(found, expected)


def test_a_part_beyond_a_matrix_is_refused(tmp_path):
    span = {"RowSpan": "One row", "RowStartMode": "Index", "RowStartIndex": "5"}
    with pytest.raises(InvalidValueError, match="takes row 5 to 5 of 4"):
        value_of(tmp_path, "simulink/Matrix Operations/Submatrix", MATRIX, **span)
    with pytest.raises(InvalidValueError, match="RowStartMode 'Middle', which does not run"):
        value_of(tmp_path, "simulink/Matrix Operations/Submatrix", MATRIX, RowSpan="One row",
                 RowStartMode="Middle")  # fmt: skip


@pytest.mark.parametrize(
    ("order", "parameters", "expected"),
    [
        ("[2 4]", {"mode": "Rows"}, [[4, 5, 6], [10, 11, 12]]),
        ("[3 1 1]", {"mode": "Columns"}, [[3, 1, 1], [6, 4, 4], [9, 7, 7], [12, 10, 10]]),
        ("[0 3]", {"mode": "Rows", "indexMode": "Zero-based"}, [[1, 2, 3], [10, 11, 12]]),
    ],
)
def test_a_matrix_is_permuted(order, parameters, expected, tmp_path):
    kind = "simulink/Matrix Operations/Permute Matrix"
    np.testing.assert_array_equal(value_of(tmp_path, kind, MATRIX, order, **parameters), expected)


def test_coordinates_come_back_from_spherical_ones(tmp_path):
    rig = Rig()
    there = rig.add_library("simulink_extras/Transformations/Cartesian to Spherical", "there",
                            ports={"in": 3, "out": 3})  # fmt: skip
    back = rig.add_library("simulink_extras/Transformations/Spherical to Cartesian", "back",
                           ports={"in": 3, "out": 3})  # fmt: skip
    point = (-2.0, 3.0, -6.0)
    for place, value in enumerate(point, 1):
        rig.connect(rig.constant(f"{value}"), f"{there}#in:{place}")
        rig.connect(f"{there}#out:{place}", f"{back}#in:{place}")
        rig.show(f"{there}#out:{place}", f"s{place}")
        rig.show(f"{back}#out:{place}", f"p{place}")
    found = rig.values(tmp_path)
    assert found["s1"] == pytest.approx(7.0)
    assert found["s2"] == pytest.approx(np.arctan2(3.0, -2.0))
    assert found["s3"] == pytest.approx(np.arccos(-6.0 / 7.0))
    assert [found[f"p{k}"] for k in (1, 2, 3)] == pytest.approx(point)


@pytest.mark.parametrize(
    ("inputs", "parameters", "expected"),
    [
        (["[255 6]"], {"logicop": "AND", "BitMask": "12"}, [12, 4]),
        (["5"], {"logicop": "XOR", "BitMask": "[1 4]"}, [4, 1]),
        (["12", "10"], {"logicop": "OR", "UseBitMask": "off"}, 14),
        (["[12 10 9]"], {"logicop": "AND", "UseBitMask": "off"}, 8),
    ],
)
@pytest.mark.parametrize(
    "kind", ["BitwiseOperator", "simulink/Logic and Bit Operations/Bitwise Operator"]
)
def test_bits_are_joined(kind, inputs, parameters, expected, tmp_path):
    found = value_of(tmp_path, kind, *inputs, **parameters)
    np.testing.assert_array_equal(np.ravel(found), np.ravel(expected))


def test_bits_that_depend_on_a_type_are_refused(tmp_path):
    with pytest.raises(InvalidValueError, match="is 'NOT', which depends on how many bits"):
        value_of(tmp_path, "BitwiseOperator", "5", logicop="NOT")
    with pytest.raises(InvalidValueError, match="shifts to the right, which does not run"):
        value_of(tmp_path, "ArithShift", "5", BitShiftDirection="Right")


def test_a_shift_to_the_left_multiplies(tmp_path):
    shift = {"BitShiftDirection": "Left", "BitShiftNumber": "3"}
    assert value_of(tmp_path, "ArithShift", "5", **shift) == 40.0
    assert value_of(tmp_path, "ArithShift", "5", BitShiftNumber="-2") == 20.0


@pytest.mark.parametrize("truths", range(8))
def test_an_adder_is_a_table_of_truths(truths, tmp_path):
    """The default table adds two bits and a carry: carry first, then the sum."""
    bits = [(truths >> place) & 1 for place in (2, 1, 0)]
    found = value_of(tmp_path, "CombinatorialLogic", f"{bits}")
    if truths in (1, 2, 4):
        assert list(found) == [0, 1]
    assert found[0] * 2 + found[1] == sum(bits)


@pytest.mark.parametrize(
    ("inputs", "parameters", "expected"),
    [
        (["1", "2"], {}, 18),
        (["7", "-3"], {"DiagnosticForOutOfRangeInput": "None"}, 10),
        (["2"], {"InputsSelectThisObjectFromTable": "Column"}, [6, 20, 23]),
        (["1"], {"NumberOfTableDimensions": "1", "Table": "[7 8 9]"}, 8),
    ],
)
def test_a_table_is_read_by_places(inputs, parameters, expected, tmp_path):
    given = {"Table": "[4 5 6;16 19 18;10 20 23]"} | parameters
    if parameters.get("InputsSelectThisObjectFromTable"):
        given["Table"] = "[4 5 6;16 19 20;10 18 23]"
    np.testing.assert_array_equal(value_of(tmp_path, "LookupNDDirect", *inputs, **given), expected)


def test_a_probe_tells_about_a_signal(tmp_path):
    rig = Rig()
    held = rig.block("ZeroOrderHold", "hold", rig.constant("[1 2 3]"), SampleTime="0.25")
    probe = rig.add_block("Probe", "probe", ports={"in": 1, "out": 4})
    rig.connect(held, probe)
    for place in range(1, 5):
        rig.show(f"{probe}#out:{place}", f"y{place}")
    found = rig.values(tmp_path)
    assert found["y1"] == 3.0
    assert list(found["y2"]) == [0.25, 0.0]
    assert (found["y3"], found["y4"]) == (0.0, 3.0)


def test_a_probe_does_not_tell_the_sample_time_of_what_is_not_sampled(tmp_path):
    rig = Rig()
    rig.show(rig.block("Probe", "probe", rig.block("Clock", "clock")), "y")
    with pytest.raises(InvalidValueError, match="sample time of a signal that has none"):
        rig.values(tmp_path)


@pytest.mark.parametrize(
    ("kind", "parameters", "coefficients"),
    [
        ("Transfer Fcn Lead or Lag", {"PoleZ": "0.8", "ZeroZ": "0.3"}, ([1, -0.3], [1, -0.8])),
        ("Transfer Fcn Real Zero", {"ZeroZ": "0.6"}, ([1, -0.6], [1])),
        ("Weighted Moving Average", {"mgainval": "[0.5 0.3 0.2]"}, ([0.5, 0.3, 0.2], [1])),
        ("Weighted Moving Average", {"mgainval": "2"}, ([2], [1])),
    ],
)
def test_few_samples_are_filtered(kind, parameters, coefficients, tmp_path):
    rig = Rig()
    sine = rig.block("Sin", "sine", Frequency="5")
    held = rig.block("ZeroOrderHold", "hold", sine, SampleTime=f"{STEP}")
    rig.show(rig.block(f"simulink/Discrete/{kind}", "filter", held, **parameters), "y")
    run = rig.run(tmp_path)
    k = np.floor(run.time / STEP + 1e-6).astype(int)
    rows = np.abs(run.time / STEP - np.round(run.time / STEP)) > 1e-6
    expected = signal.lfilter(*coefficients, SAMPLES)[k[rows]]
    np.testing.assert_allclose(shown(run, "y")[rows], expected, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "value", "bounds", "expected"),
    [
        ("Lower Bound", "3.9", {"min": "3.9"}, 1.0),
        ("Lower Bound", "3.9", {"min": "3.9", "min_included": "off"}, 0.0),
        ("Upper Bound", "[1 2]", {"max": "[2 1]"}, 0.0),
        ("Range", "[1 2]", {"min": "1", "max": "2"}, 1.0),
    ],
)
def test_a_check_tells_whether_a_signal_is_within_bounds(kind, value, bounds, expected, tmp_path):
    kind = f"simulink/Model Verification/Check Static {kind}"
    assert value_of(tmp_path, kind, value, **bounds, export="on") == expected


def test_a_check_of_another_kind_puts_nothing_out(tmp_path):
    with pytest.raises(InvalidValueError, match="puts out whether its check holds"):
        value_of(tmp_path, "simulink/Model Verification/Check Static Gap", "1")


def lagging(**parameters):
    rig = Rig()
    into = rig.add_library("nesl_utility/Simulink-PS Converter", "in", ports={"in": 1})
    rig.connect(rig.constant("2"), into)
    lag = rig.add_library("fl_lib/Physical Signals/Linear Operators/PS Transfer Function", "lag",
                          parameters)  # fmt: skip
    out = rig.add_library("nesl_utility/PS-Simulink Converter", "out", ports={"out": 1})
    rig.physical(f"{into}#rconn:1", f"{lag}#lconn:1")
    rig.physical(f"{lag}#rconn:1", f"{out}#lconn:1")
    rig.show(out, "y")
    return rig


def test_a_physical_signal_lags(tmp_path):
    run = lagging(T="300", T_unit="ms", y0="-1", y0_unit="1").run(tmp_path)
    expected = 2.0 - 3.0 * np.exp(-run.time / 0.3)
    np.testing.assert_allclose(shown(run, "y"), expected, atol=1e-7)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"transfer_function_type": "foundation.enum.transfer_function_type.lead_lag"},
         "has transfer_function_type 'lead_lag'"),
        ({"reset_method": "foundation.enum.IntegratorResetSpec.Rising"}, "has reset_method"),
        ({"T": "0"}, "has the time constant 0 s; it must be positive"),
    ],
)  # fmt: skip
def test_a_physical_filter_that_does_not_run_is_refused(parameters, message, tmp_path):
    with pytest.raises(InvalidValueError, match=message):
        lagging(**parameters).code(tmp_path)
