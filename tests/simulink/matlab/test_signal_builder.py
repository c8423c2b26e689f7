"""The signals of a Signal Builder or Editor, from the objects in which files keep them."""

import struct

import numpy as np
import pytest
from packed_data import MARK, double, element, matrix, octets, opaque, structure, words
from rigs import Rig, shown
from slx_writer import write_parts

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.signal_builder import built_signals, text_of_signals
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.running import run_model, runnable


def row(*values):
    return matrix(6, (1, len(values)), element(9, struct.pack(f"<{len(values)}d", *values)))


def references(*numbers):
    return words(0xDD000000, 2, 1, len(numbers), *numbers, 1)


def objects(*properties):
    """Lay out objects, each with properties of its own by name."""
    names = list(dict.fromkeys(name for each in properties for name in each))
    text = "\0".join(names).encode() + b"\0"
    sets, table, cells = [0, 0], [0] * 6, []
    for number, each in enumerate(properties, 1):
        sets.append(len(each))
        for name, value in each.items():
            sets += [names.index(name) + 1, 1, len(cells)]
            cells.append(value)
        sets += [0] * (len(sets) % 2)
        table += [1, 0, 0, 0, number, number]
    regions = [text.ljust(len(text) + -len(text) % 8, b"\0"), bytes(32), b""]
    regions += [struct.pack(f"<{len(each)}I", *each) for each in (table, sets)]
    ends, at = [], 40
    for region in regions:
        at += len(region)
        ends.append(at)
    head = struct.pack("<10I", 3, len(names), *ends, *[at] * 3) + b"".join(regions)
    whole = (octets(head), matrix(6, (0, 0), element(9, b"")), *cells)
    wrapped = opaque(b"FileWrapper__", matrix(1, (len(whole), 1), *whole))
    return octets(MARK + bytes(4) + structure(MCOS=wrapped))


def suite(active):
    """Two groups: one signal, and two; a step is two values at one time."""
    held = opaque(b"SigSuite", words(0xDD000000, 2, 1, 1, 1, 1))
    made = objects(
        {"Groups": references(2, 3), "ActiveGroup": double(active)},
        {"Signals": references(4)},
        {"Signals": references(5, 6)},
        {"XData": row(0.0, 10.0), "YData": row(7.0, 7.0)},
        {"XData": row(0.0, 0.4, 0.4, 10.0), "YData": row(0.0, 0.0, 2.0, 2.0)},
        {"XData": row(0.0, 1.0), "YData": row(1.0, 3.0)},
    )
    return MARK + bytes(4) + structure(sbobj=held) + made


def test_the_active_group_is_read():
    (only,) = built_signals(suite(1))
    assert only.tolist() == [[0.0, 7.0], [10.0, 7.0]]
    step, ramp = built_signals(suite(2))
    assert step[:, 1].tolist() == [0.0, 0.0, 2.0, 2.0]
    assert text_of_signals([ramp]) == "{[0.0 1.0;1.0 3.0]}"
    with pytest.raises(LackError, match="cannot be read"):
        built_signals(suite(2)[:300])


def test_a_signal_builder_puts_out_its_signals(tmp_path):
    rig = Rig()
    builder = rig.add_block("SubSystem", "Signal Builder", ports={"out": 1})
    texts = {"VariableName": "tuvar", "SigBuilderData": "here"}
    table = rig.add_block("FromWorkspace", "FromWs", texts, system=builder, ports={"out": 1})
    out = rig.add_block("Outport", "y", {"Port": "1"}, system=builder)
    rig.connect(table, out)
    rig.show(f"{builder}#out:1", "y")
    parts = rig.parts()
    parts = {
        name: text.replace('"SigBuilderData">here', '"SigBuilderData" Ref="bdmxdata:DataTag0">')
        for name, text in parts.items()
    }
    parts["simulink/bdmxdata/DataTag0.mxarray"] = suite(2)
    path = write_parts(tmp_path / "builder.slx", parts)
    run = run_model(runnable(read_model(path), duration=1.0))
    np.testing.assert_allclose(shown(run, "y")[:, 0], np.where(run.time < 0.4, 0.0, 2.0))
    np.testing.assert_allclose(shown(run, "y")[:, 1], 1.0 + 2.0 * run.time)


def column(*values):
    return matrix(6, (len(values), 1), element(9, struct.pack(f"<{len(values)}d", *values)))


def scenario_file(path, *, name=b"Scenario"):
    """A data set of two series, the times of the second one even."""
    held = matrix(17, (), element(1, b"MCOS"), element(1, b"Simulink.SimulationData.Dataset"),
                  words(0xDD000000, 2, 1, 1, 5, 1), name=name)  # fmt: skip
    made = objects(
        {"Data_": column(0.0, 4.0, 2.0), "TimeInfo": references(2)},
        {"Time_": column(0.0, 0.4, 0.8), "Length": double(3.0)},
        {"Data_": column(1.0, 3.0), "TimeInfo": references(4)},
        {"Start_": double(0.0), "Increment_": double(0.5), "Length": double(2.0)},
        {"Name": octets(b"set")},
    )
    head = b"MATLAB 5.0 MAT-file".ljust(116) + struct.pack("<Q", 128 + len(held)) + b"\x00\x01IM"
    path.write_bytes(head + held + made)


def test_a_series_in_a_file_is_put_out(tmp_path):
    held = matrix(17, (), element(1, b"MCOS"), element(1, b"timeseries"),
                  words(0xDD000000, 2, 1, 1, 1, 1), name=b"held")  # fmt: skip
    made = objects(
        {"Data_": column(0.0, 4.0, 2.0), "TimeInfo": references(2)},
        {"Time_": column(0.0, 0.4, 1.0), "Length": double(3.0)},
    )
    head = b"MATLAB 5.0 MAT-file".ljust(116) + struct.pack("<Q", 128 + len(held)) + b"\x00\x01IM"
    (tmp_path / "s.mat").write_bytes(head + held + made)
    rig = Rig()
    rig.show(rig.block("FromFile", "file", FileName="s"), "y")
    run = rig.run(tmp_path, 1.0)
    np.testing.assert_allclose(shown(run, "y"), np.interp(run.time, [0, 0.4, 1], [0, 4, 2]))


def edited(folder, **settings):
    rig = Rig()
    editor = rig.add_library("SignalEditorBlockLib/Signal Editor", "edit", {
        "FileName": "s.mat", "ActiveScenario": "Scenario", "ApplySigPropsToAllSignals": "on",
        **settings,
    }, ports={"out": 2})  # fmt: skip
    for place, name in enumerate("ab", 1):
        rig.show(f"{editor}#out:{place}", name)
    return rig.run(folder, 1.0)


def test_a_signal_editor_puts_out_its_scenario(tmp_path):
    scenario_file(tmp_path / "s.mat")
    run = edited(tmp_path)
    t = run.time
    np.testing.assert_allclose(shown(run, "a"), np.select([t < 0.4, t < 0.8, t <= 0.8], [0, 4, 2]))
    np.testing.assert_allclose(shown(run, "b"), np.select([t < 0.5, t <= 0.5], [1.0, 3.0]))
    run = edited(tmp_path, Interpolate="on", OutputAfterFinalValue="Holding final value")
    np.testing.assert_allclose(shown(run, "a"), np.interp(t, [0.0, 0.4, 0.8], [0.0, 4.0, 2.0]))
    run = edited(tmp_path, Interpolate="on", OutputAfterFinalValue="Extrapolation")
    np.testing.assert_allclose(shown(run, "b"), 1.0 + 4.0 * t)


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"FileName": "none.mat"}, "not in the given folders"),
        ({"ActiveScenario": "Other"}, "holds the scenario 'Scenario', not 'Other'"),
        ({"ApplySigPropsToAllSignals": "off"}, "settings for each signal"),
        ({"FileName": "bad.mat"}, "cannot be read"),
    ],
)
def test_a_signal_editor_that_cannot_be_read_is_refused(tmp_path, settings, why):
    scenario_file(tmp_path / "s.mat")
    (tmp_path / "bad.mat").write_bytes(b"MATLAB 5.0 MAT-file")
    with pytest.raises(InvalidValueError, match=why):
        edited(tmp_path, **settings)
