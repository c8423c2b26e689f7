import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from drake_leg.errors import InvalidValueError, OutputError
from drake_leg.simulation.recording import (
    Recording,
    intervals,
    lettered,
    numbered,
    without_sign_jumps,
)


def recording():
    time = np.array([0.0, 0.1, 0.30000000000000004])
    return Recording({"time[s]": time, "vx[m/s]": time**2, "qw": 1.0 - time})


# --- columns ---------------------------------------------------------------------------------


def test_a_column_is_found_with_and_without_its_unit():
    values = recording()
    np.testing.assert_array_equal(values["vx"], values["vx[m/s]"])
    np.testing.assert_array_equal(values["qw"], 1.0 - values["time"])


@pytest.mark.parametrize("name", ["v", "vx[m]", "x", "", "vx[m/s"])
def test_a_column_that_is_not_there_is_refused_with_the_names_of_those_that_are(name):
    with pytest.raises(InvalidValueError, match=r"time\[s\], vx\[m/s\], qw") as caught:
        recording()[name]
    assert repr(name) in str(caught.value)


def test_columns_stand_side_by_side_in_the_order_asked_for():
    stacked = recording().stack("qw", "time")
    assert stacked.shape == (3, 2)
    np.testing.assert_array_equal(stacked[:, 1], recording()["time"])


def test_columns_of_different_length_are_refused():
    with pytest.raises(InvalidValueError, match="differ in length"):
        Recording({"a": np.zeros(3), "b": np.zeros(2)})


def test_headers_carry_their_units():
    values = np.arange(6.0).reshape(2, 3)
    assert list(lettered("v", "xyz", "m/s", values)) == ["vx[m/s]", "vy[m/s]", "vz[m/s]"]
    assert list(lettered("q", "wxyz", "", np.zeros((1, 4)))) == ["qw", "qx", "qy", "qz"]
    columns = numbered("tau", ["N*m", "N*m", "N"], values)
    assert list(columns) == ["tau1[N*m]", "tau2[N*m]", "tau3[N]"]
    np.testing.assert_array_equal(columns["tau2[N*m]"], [1.0, 4.0])


# --- CSV -------------------------------------------------------------------------------------

AWKWARD = [0.1, 1 / 3, math.pi, 5e-324, 1.7976931348623157e308, -0.0, 1e22, 2**53 + 1.0, -1e-200]


def assert_same_bits(first, second):
    assert list(first.columns) == list(second.columns)
    for header, values in first.columns.items():
        assert values.tobytes() == np.ascontiguousarray(second.columns[header]).tobytes(), header


def test_numbers_come_back_to_the_bit(tmp_path):
    written = Recording({"time[s]": np.array(AWKWARD), "q1[rad]": np.array(AWKWARD[::-1])})
    written.write_csv(tmp_path / "recording.csv")
    assert_same_bits(written, Recording.read_csv(tmp_path / "recording.csv"))


@pytest.mark.slow
@given(arrays(np.float64, (4, 3), elements=st.floats(allow_nan=False)))
def test_any_numbers_come_back_to_the_bit(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("csv") / "recording.csv"
    written = Recording(numbered("q", ["rad", "rad", "m"], values))
    written.write_csv(path)
    assert_same_bits(written, Recording.read_csv(path))


def test_the_first_line_is_the_header_and_every_row_a_line(tmp_path):
    recording().write_csv(tmp_path / "a.csv")
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "time[s],vx[m/s],qw"
    assert len(lines) == 4
    assert lines[3].split(",")[0] == "0.30000000000000004"


def test_a_recording_without_rows_comes_back(tmp_path):
    written = Recording({"time[s]": np.zeros(0), "q[rad]": np.zeros(0)})
    written.write_csv(tmp_path / "a.csv")
    assert_same_bits(written, Recording.read_csv(tmp_path / "a.csv"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("time[s],q[rad]\n0.0,1.0\n0.1\n", "line 3, has 1 values for 2 columns"),
        ("time[s],q[rad]\n0.0,1.0,2.0\n", "line 2, has 3 values for 2 columns"),
        (
            "time[s],q[rad]\n0.0,one\n",
            r"line 2, has 'one' in the column q\[rad\], which is not a number: correct",
        ),
        ("time[s],q[rad]\n0.0,1.0\n0.1,\n", "line 3, has '' in the column q.*not a number"),
    ],
)
def test_a_file_that_is_no_recording_is_refused_in_a_sentence(tmp_path, text, said):
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(OutputError, match=said) as caught:
        Recording.read_csv(path)
    assert "bad.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_of_bytes_that_are_no_text_is_refused(tmp_path):
    (tmp_path / "bad.csv").write_bytes(b"\xff\xfe\x00\x00")
    with pytest.raises(OutputError, match=r"bad.csv cannot be read"):
        Recording.read_csv(tmp_path / "bad.csv")


def test_a_header_that_names_two_columns_alike_is_refused(tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("time[s],q[rad],q[rad]\n0.0,1.0,2.0\n", encoding="utf-8")
    with pytest.raises(OutputError, match=r"q\[rad\]"):
        Recording.read_csv(path)


def test_a_file_with_an_endless_field_is_refused(tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("time[s]\n" + "1" * 200_000 + "\n", encoding="utf-8")
    with pytest.raises(OutputError, match=r"bad.csv"):
        Recording.read_csv(path)


@pytest.mark.parametrize("name", ["missing.csv", "", "a/b.csv"])
def test_a_file_that_is_not_there_is_refused(tmp_path, name):
    with pytest.raises(OutputError, match="cannot be read"):
        Recording.read_csv(tmp_path / name)


def test_a_file_that_cannot_be_written_is_refused(tmp_path):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    for path in (tmp_path / "file" / "a.csv", tmp_path):
        with pytest.raises(OutputError, match="cannot be written"):
            recording().write_csv(path)


# --- quaternions -----------------------------------------------------------------------------


def turning_about_x(angles):
    halves = np.asarray(angles) / 2
    return np.stack([np.cos(halves), np.sin(halves), 0 * halves, 0 * halves], axis=-1)


def test_a_quaternion_turns_on_without_jumps_whatever_signs_it_came_with(rng):
    smooth = turning_about_x(np.linspace(0.0, 20.0, 200))
    signs = np.concatenate([[1.0], rng.choice([-1.0, 1.0], 199)])
    np.testing.assert_array_equal(without_sign_jumps(smooth * signs[:, np.newaxis]), smooth)


def test_the_first_row_keeps_its_sign_and_every_row_its_rotation(rng):
    rows = rng.normal(size=(50, 4))
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    smooth = without_sign_jumps(rows)
    np.testing.assert_array_equal(smooth[0], rows[0])
    np.testing.assert_allclose(abs((smooth * rows).sum(axis=1)), 1.0)
    assert np.all((smooth[1:] * smooth[:-1]).sum(axis=1) >= 0.0)


@pytest.mark.parametrize("count", [0, 1])
def test_one_row_or_none_stays_as_it_is(count):
    rows = turning_about_x(np.ones(count))
    np.testing.assert_array_equal(without_sign_jumps(rows), rows)


def test_a_missing_column_is_said_with_a_few_that_there_are():
    recording = Recording({f"c{index}[m]": np.zeros(1) for index in range(32)})
    with pytest.raises(InvalidValueError, match=r"'q'; the recording has c0\[m\], .* and 26 more$"):
        recording["q"]


def test_lists_become_arrays(tmp_path):
    swing = Recording({"time[s]": [0.0, 1.0], "q[rad]": [0.5, 0.25]})
    np.testing.assert_array_equal(swing["q"], np.array([0.5, 0.25]))
    assert "<td>0.25</td>" in swing._repr_html_()
    swing.write_csv(tmp_path / "swing.csv")
    np.testing.assert_array_equal(Recording.read_csv(tmp_path / "swing.csv")["q"], swing["q"])


def test_intervals_are_the_runs_of_true_flags():
    flags = np.array([True, True, False, True, False, False, True])
    assert intervals(flags) == [(0, 2), (3, 4), (6, 7)]
    assert intervals(np.zeros(3, dtype=bool)) == []
