"""The top of a model, its subsystems closed."""

import pytest
from mechanism_models import BODIES, FRAMES
from slx_writer import ModelBuilder

from drake_leg.pictures import of_simulink
from drake_leg.pictures.model_page import model_page
from drake_leg.pictures.outline import outline_picture
from drake_leg.simulink.reader import read_model


@pytest.fixture
def nested(tmp_path):
    """A constant, a scope, a frame and a solid at the top; a gain in a subsystem."""
    built = ModelBuilder()
    inside = built.add_block("SubSystem", "Inside", ports={"in": 1, "out": 1})
    gain = built.add_block("Gain", "Hidden", {"Gain": "2"}, system=inside)
    built.connect(built.add_block("Inport", "In", system=inside), gain)
    built.connect(gain, built.add_block("Outport", "Out", system=inside))
    built.connect(built.add_block("Constant", "One", {"Value": "1"}), inside)
    built.connect(inside, built.add_block("Scope", "Scope", ports={"in": 1}), name="twice")
    world = built.add_library(f"{FRAMES}World Frame", "World")
    solid = built.add_library(f"{BODIES}Brick Solid", "Brick")
    built.physical(f"{world}#rconn:1", f"{solid}#rconn:1")
    return read_model(built.write(tmp_path / "nested.slx"))


def test_the_top_of_a_model_has_its_subsystems_as_boxes(nested):
    picture = outline_picture(nested, title="top")
    names = [block.name for block in picture.blocks]
    assert sorted(names) == ["Brick", "Inside", "One", "Scope", "World"]
    wires = {
        (names[net.source[0]], *(names[block] for block, _ in net.targets)): net
        for net in picture.nets
    }
    assert wires.keys() == {("One", "Inside"), ("Inside", "Scope"), ("World", "Brick")}
    assert wires["Inside", "Scope"].label == "twice"
    assert wires["World", "Brick"].physical
    assert not wires["World", "Brick"].arrow
    assert {block.name for block in picture.blocks if block.physical} == {"World", "Brick"}


def test_a_page_of_a_large_model_shows_its_top(nested, monkeypatch):
    assert "its top" not in model_page(nested, command="c", missing=("a",))
    monkeypatch.setattr(of_simulink, "MOST_BLOCKS", 2)
    page = model_page(nested, command="c", missing=("a",))
    assert "nested: its top" in page
    assert "at most 2 can be drawn" in page
