"""Names of what sinks show, and the axes of their figures."""

import numpy as np
import pytest
from rigs import Rig
from slx_writer import ModelBuilder

from drake_leg.pictures.plots.scope_plots import MOST_AXES, MOST_NAMED, figure_of
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.columns import columns_of, figures_of, labels_of, recording_of
from drake_leg.simulink.running.compiling import Ports, compile_signals
from drake_leg.simulink.running.network import signal_network

ROWS = 3


def columns(built, folder):
    """The columns of a model, each full of its number."""
    model = read_model(built.write(folder / "m.slx"))
    network = signal_network(model)
    labels = labels_of(compile_signals(network, Ports()).recorded, network)
    return columns_of(labels, [np.tile(np.arange(len(labels), dtype=float), (ROWS, 1))])


def headers(built, folder):
    return [each.label.header for each in columns(built, folder)]


def test_a_signal_without_a_name_has_that_of_the_block_that_drives_it(tmp_path):
    rig = Rig()
    both = rig.add_block("Demux", "Parts", {"Outputs": "2"}, ports={"in": 1, "out": 2})
    rig.connect(rig.constant("[1 2]"), both)
    scope = rig.add_block("Scope", "Scope", ports={"in": 3})
    rig.connect(f"{both}#out:1", f"{scope}#in:1")
    rig.connect(f"{both}#out:2", f"{scope}#in:2", name="speed")
    rig.connect(rig.block("Clock", "Clock"), f"{scope}#in:3")
    assert headers(rig, tmp_path) == ["Scope.Parts:1", "Scope.speed", "Scope.Clock"]


def test_entries_are_numbered_and_names_told_apart(tmp_path):
    rig = Rig()
    matrix = rig.constant("[1 2; 3 4]")
    rig.show(matrix, "time")
    for place in ("Left", "Right"):
        system = rig.add_block("SubSystem", place)
        inner = rig.add_block("Scope", "Scope", system=system, ports={"in": 1})
        rig.connect(rig.block("Clock", "Clock [s]", system=system), inner)
    assert headers(rig, tmp_path) == [
        "time(1,1)", "time(2,1)", "time(1,2)", "time(2,2)", "Left/Scope", "Right/Scope",
    ]  # fmt: skip


def test_one_name_twice_is_numbered(tmp_path):
    rig = Rig()
    rig.show(rig.block("Clock", "Clock"), "time")
    rig.block("ToWorkspace", "Again", rig.constant("1"), VariableName="x")
    rig.block("ToWorkspace", "And again", rig.constant("2"), VariableName="x")
    found = columns(rig, tmp_path)
    assert [each.label.header for each in found] == ["time_2", "x", "x_2"]
    recording = recording_of(np.zeros(ROWS), found)
    assert recording["x_2"][0] == 2.0


def sinks(count, ports, tmp_path, kind="Scope"):
    """Figures of a sink, whose ports have vectors of a size."""
    built = ModelBuilder()
    value = built.add_block("Constant", "Value", {"Value": f"1:{count}"})
    scope = built.add_block(kind, "Sink", ports={"in": ports})
    built.connect(value, *(f"{scope}#in:{n + 1}" for n in range(ports)))
    (sink,) = figures_of(columns(built, tmp_path))
    return sink, figure_of("m", np.arange(float(ROWS)), sink)


def test_a_scope_has_axes_for_each_port_and_lines_for_each_entry(tmp_path):
    _, figure = sinks(3, 2, tmp_path)
    assert [len(axes.lines) for axes in figure.axes] == [3, 3]
    names = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert names == ["Value(1)", "Value(2)", "Value(3)"]
    assert figure.axes[-1].get_xlabel() == "time t [s]"


@pytest.mark.parametrize(("count", "ports"), [(MOST_NAMED + 1, 1), (1, MOST_AXES + 1)])
def test_what_would_not_fit_is_left_out(tmp_path, count, ports):
    _, figure = sinks(count, ports, tmp_path)
    assert figure.axes[0].get_legend() is None
    assert len(figure.axes) <= MOST_AXES
    assert len(figure.axes[0].lines) == count


def test_an_xy_graph_is_drawn_over_its_first_port(tmp_path):
    built = ModelBuilder()
    graph = built.add_block("Reference", "Graph", source="simulink/Sinks/XY Graph",
                            ports={"in": 2})  # fmt: skip
    built.connect(built.add_block("Clock", "Across"), f"{graph}#in:1")
    built.connect(built.add_block("Constant", "Up"), f"{graph}#in:2")
    (sink,) = figures_of(columns(built, tmp_path))
    assert sink.is_xy
    figure = figure_of("m", np.zeros(ROWS), sink)
    ((line,),) = (axes.lines for axes in figure.axes)
    np.testing.assert_array_equal(line.get_xydata(), [[0.0, 1.0]] * ROWS)
    assert figure.axes[0].get_xlabel() == "Across"
