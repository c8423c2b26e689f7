"""One subsystem of a model, as a model of its own."""

import pytest
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.pictures import of_simulink
from drake_leg.pictures.of_simulink import model_pictures
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.subsystems import largest_subsystems, subsystem


def controller(built, above, name, tag):
    """Add a subsystem: what comes in and what comes from a tag, added, goes out."""
    held = built.add_block("SubSystem", name, ports={"in": 1, "out": 1}, system=above)
    taken = built.add_block("From", "Taken", {"GotoTag": tag}, system=held)
    total = built.add_block("Sum", "Total", {"Inputs": "++"}, system=held)
    built.connect(built.add_block("Inport", "In", system=held), f"{total}#in:1")
    built.connect(taken, f"{total}#in:2")
    built.connect(total, built.add_block("Outport", "Out", system=held), name="u")
    return held


@pytest.fixture
def nested(tmp_path):
    """Two controllers in a leg; one reads a tag of its own leg, one a tag of the top."""
    built = ModelBuilder()
    leg = built.add_block("SubSystem", "Leg", ports={"in": 1, "out": 1})
    for name, tag in (("Hip", "near"), ("Knee", "far")):
        controller(built, leg, name, tag)
    for system, tag in ((leg, "near"), ("", "far")):
        goto = built.add_block(
            "Goto", f"To {tag}", {"GotoTag": tag, "TagVisibility": "global"}, system=system
        )
        built.connect(built.add_block("Constant", f"C {tag}", system=system), goto)
    return read_model(built.write(tmp_path / "nested.slx"))


def drawn(model, system):
    (picture,) = model_pictures(model, title="m", system=system)
    names = [block.name for block in picture.blocks]
    return {(names[net.source[0]], names[end]) for net in picture.nets for end, _ in net.targets}


def test_a_subsystem_is_drawn_with_its_ports_and_what_comes_from_elsewhere(nested):
    assert drawn(nested, "Leg/Knee") == {
        ("In", "Total"), ("[far]", "Total"), ("Total", "Out"),
    }  # fmt: skip
    assert ("C near", "Hip/Total") in drawn(nested, "Leg")
    assert ("[far]", "Knee/Total") in drawn(nested, "Leg")


def test_blocks_inside_keep_their_values_and_wires_their_names(nested):
    inside = subsystem(nested, "Hip")
    assert [wire.name for wire in inside.wires] == ["", "", "u"]
    assert {block.name for block in inside.blocks if not block.system} == {
        "In", "Out", "Total", "[near]",
    }  # fmt: skip


def test_the_largest_subsystems_that_can_be_drawn_come_first(nested):
    assert largest_subsystems(nested, 10) == [("Leg", 3)]
    assert largest_subsystems(nested, 2) == [("Leg/Hip", 1), ("Leg/Knee", 1)]


def test_a_model_that_is_too_large_names_its_subsystems(nested, monkeypatch):
    monkeypatch.setattr(of_simulink, "MOST_BLOCKS", 3)
    with pytest.raises(InvalidValueError, match=r"draw a subsystem with `system`: 'Leg' of 3 bl"):
        model_pictures(nested, title="m")


def test_a_name_that_no_subsystem_has_is_refused(nested):
    with pytest.raises(InvalidValueError, match=r"no subsystem 'Kne' to draw: .*Knee"):
        subsystem(nested, "Kne")
