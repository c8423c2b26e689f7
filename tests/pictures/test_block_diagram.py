"""The block diagrams of the runs: all wires, none more, and nothing on top of anything."""

import re
import xml.etree.ElementTree as ET

import pytest
from pydrake.geometry import SceneGraph
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import (
    Adder,
    ConstantVectorSource,
    Gain,
    Integrator,
    VectorLogSink,
    ZeroOrderHold,
)

from drake_leg.pictures.block_diagram import block_diagram, diagram_picture
from drake_leg.pictures.drawing import draw
from drake_leg.pictures.layout import lay_out
from drake_leg.runs.catalogue import RUNS

SVG = "{http://www.w3.org/2000/svg}"


def block_pairs(picture):
    return sorted(
        (picture.blocks[net.source[0]].name, picture.blocks[block].name)
        for net in picture.nets
        for block, _ in net.targets
    )


def connected_pairs(diagram):
    return sorted(
        (source.get_name(), target.get_name())
        for (target, _), (source, _) in diagram.connection_map().items()
        if not isinstance(source, SceneGraph) and not isinstance(target, SceneGraph)
    )


def of_class(root, word):
    return [e for e in root.iter() if word in e.get("class", "").split()]


@pytest.mark.parametrize("name", RUNS)
def test_every_wire_of_a_run_is_drawn_once_and_cleanly(run_diagram, require_clean, name):
    diagram = run_diagram(name)
    layout = lay_out(diagram_picture(diagram, title=name))
    assert block_pairs(layout.picture) == connected_pairs(diagram)
    assert len(layout.routes) == len(connected_pairs(diagram))
    assert len({route.target for route in layout.routes}) == len(layout.routes)
    require_clean(layout)


def test_a_notebook_scrolls_a_wide_drawing_whose_texts_would_be_too_small(run_diagram):
    drawing = block_diagram(run_diagram("leg-b"))
    frame = ET.fromstring(drawing._repr_html_())
    (least,) = re.findall(r"min-width:(\d+)px", frame[0].get("style"))
    assert frame.get("style") == "overflow-x:auto"
    assert int(least) == pytest.approx(0.7 * float(frame[0][0].get("width")), abs=1.0)


@pytest.mark.slow
def test_a_disturbed_run_is_drawn_with_its_push_its_limits_and_its_correction(
    run_diagram, require_clean
):
    diagram = run_diagram(
        "leg-b", push=(0.0, 0.0, 0.1), torque_limit=0.01, correction=5.0, inverse="damped"
    )
    layout = lay_out(diagram_picture(diagram, title="leg-b"))
    assert block_pairs(layout.picture) == connected_pairs(diagram)
    names = {block.name for block in layout.picture.blocks}
    assert {"Push", "Torque Limit", "Drift Correction", "Speed Limit"} <= names
    require_clean(layout)


@pytest.mark.parametrize("name", RUNS)
def test_the_picture_fits_a_page(run_diagram, name):
    layout = lay_out(diagram_picture(run_diagram(name), title=name))
    assert layout.width < 1500.0
    assert layout.height < 800.0


def test_the_gain_of_the_factor_ten_is_drawn_with_its_value(run_diagram, require_clean):
    picture = diagram_picture(run_diagram("leg-b", gain=10.0), title="gain")
    (gain,) = (block for block in picture.blocks if block.name == "Gain")
    assert (gain.glyph, gain.text) == ("gain", ("10",))
    require_clean(lay_out(picture))


def test_signals_are_called_as_in_the_reports(run_diagram):
    picture = diagram_picture(run_diagram("leg-b"), title="leg")
    called = {picture.blocks[n.source[0]].name: n.label for n in picture.nets if n.label}
    assert called["Mux"] == "v"
    assert called["Integrator 2"] == "q₂"
    assert called["Simulink-PS Converters"] == "q"


def test_scopes_can_be_left_out(run_diagram):
    picture = diagram_picture(run_diagram("leg-b"), title="leg", scopes=False)
    assert all(block.glyph != "scope" for block in picture.blocks)
    assert ("Mux", "inverseJacobian") in block_pairs(picture)


def test_without_accelerations_what_only_they_need_is_left_out(run_diagram, require_clean):
    diagram = run_diagram("leg-b", gain=10.0)
    picture = diagram_picture(diagram, title="leg", accelerations=False)
    gone = {s.get_name() for s in diagram.GetSystems()} - {block.name for block in picture.blocks}
    assert gone == {"Gain of the derivative", "Mux of the derivatives"}
    require_clean(lay_out(picture))


def test_the_loop_through_the_leg_runs_below_the_blocks_that_it_passes(run_diagram):
    layout = lay_out(diagram_picture(run_diagram("leg-b"), title="leg"))
    names = [block.name for block in layout.picture.blocks]
    to = names.index("inverseJacobian")
    back = next(
        r
        for r in layout.routes
        if r.target[0] == to and layout.boxes[r.source[0]].x > layout.boxes[to].x
    )
    lowest = max(y for _, y in back.points)
    passed = [box for box in layout.boxes if back.points[-1][0] < box.x < back.points[0][0] - 60]
    assert lowest > max(box.bottom for box in passed)


def test_the_drawing_is_one_svg_document_with_a_title(run_diagram):
    drawing = block_diagram(run_diagram("leg-b"), title="A < B & C")
    root = ET.fromstring(drawing.svg)
    assert root.find(f"{SVG}title").text == "A < B & C"
    assert "Mux to" in root.find(f"{SVG}desc").text
    assert drawing._repr_svg_() == str(drawing) == drawing.svg
    assert len(repr(drawing)) < 100
    assert len(of_class(root, "wire")) == len(run_diagram("leg-b").connection_map())
    assert len(of_class(root, "block")) == len(run_diagram("leg-b").GetSystems())


@pytest.mark.slow
def test_the_same_diagram_gives_the_same_bytes(run_diagram):
    first, second = (block_diagram(run_diagram("scara"), title="scara").svg for _ in range(2))
    assert first == second


def test_backgrounds(run_diagram):
    picture = diagram_picture(run_diagram("pendulum"), title="pendulum")
    auto, white, none = (draw(picture, background=b).svg for b in ("auto", "white", "none"))
    assert "prefers-color-scheme: dark" in auto
    assert "prefers-color-scheme" not in white + none
    assert 'class="paper"' in white
    assert 'class="paper"' not in none


def test_any_diagram_of_drakes_blocks_is_drawn(require_clean):
    builder = DiagramBuilder()
    one = builder.AddNamedSystem("one", ConstantVectorSource([1.0]))
    two = builder.AddNamedSystem("two", ConstantVectorSource([0.125]))
    total = builder.AddNamedSystem("sum", Adder(2, 1))
    integrator = builder.AddNamedSystem("integrator", Integrator([0.5]))
    gain = builder.AddNamedSystem("gain", Gain([2.0, 3.0]))
    hold = builder.AddNamedSystem("hold", ZeroOrderHold(0.1, 1))
    scope = builder.AddNamedSystem("scope", VectorLogSink(1))
    builder.Connect(one.get_output_port(), total.get_input_port(0))
    builder.Connect(two.get_output_port(), total.get_input_port(1))
    builder.Connect(total.get_output_port(), integrator.get_input_port())
    builder.Connect(integrator.get_output_port(), hold.get_input_port())
    builder.Connect(hold.get_output_port(), scope.get_input_port())
    builder.ExportInput(gain.get_input_port())
    picture = diagram_picture(builder.Build(), title="mixed")
    inside = {block.name: block.text for block in picture.blocks}
    assert inside["one"] == ("1",)
    assert inside["two"] == ("0.125",)
    assert inside["gain"] == ("[2]",)
    assert inside["hold"] == ("Zero Order Hold",)
    require_clean(lay_out(picture))
