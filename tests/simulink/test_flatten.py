import pytest
from slx_models import RIGID_TRANSFORM, WORLD, published_leg
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import SignalWire
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.wiring import flatten


@pytest.fixture
def flat(tmp_path):
    def _flat(builder, layout="new"):
        return flatten(read_model(builder.write(tmp_path / "m.slx", layout=layout)))

    return _flat


def port(builder, system, kind, name, number):
    return builder.add_block(kind, name, {"Port": str(number)}, system=system)


def gain_in_subsystems(depth, *, atomic=False):
    """Draw clock -> gain -> scope, the gain inside so many subsystems, at their second ports."""
    builder = ModelBuilder()
    clock = builder.add_block("Clock", "Clock")
    scope = builder.add_block("Scope", "Scope")
    source, target, system = f"{clock}#out:1", f"{scope}#in:1", ""
    for place in range(depth):
        settings = {"TreatAsAtomicUnit": "on"} if atomic else {}
        inner = builder.add_block("SubSystem", f"S{place}", settings, system=system)
        builder.connect(source, f"{inner}#in:2", name="t" if place == 0 else "")
        builder.connect(f"{inner}#out:2", target)
        for number in (1, 2):
            entry = port(builder, inner, "Inport", f"In{number}", number)
            exit_ = port(builder, inner, "Outport", f"Out{number}", number)
        source, target, system = f"{entry}#out:1", f"{exit_}#in:1", inner
    gain = builder.add_block("Gain", "K", system=system)
    builder.connect(source, gain)
    builder.connect(gain, target)
    return builder, clock, gain, scope


def test_a_flat_model_stays(tmp_path):
    model = read_model(published_leg().write(tmp_path / "m.slx"))
    assert flatten(model) == model


@pytest.mark.parametrize("depth", [1, 2, 5])
@pytest.mark.parametrize("layout", ["new", "old"])
@pytest.mark.parametrize("atomic", [False, True])
def test_signals_go_through_subsystems(flat, depth, layout, atomic):
    builder, clock, gain, scope = gain_in_subsystems(depth, atomic=atomic)
    model = flat(builder, layout)
    assert {block.name for block in model.blocks} == {"Clock", "K", "Scope"}
    assert set(model.wires) == {
        SignalWire(source=f"{clock}#out:1", target=f"{gain}#in:1", name="t"),
        SignalWire(source=f"{gain}#out:1", target=f"{scope}#in:1", name=""),
    }


def test_ports_of_the_top_stay(flat):
    builder = ModelBuilder()
    entry, exit_ = builder.add_block("Inport", "In"), builder.add_block("Outport", "Out")
    builder.connect(entry, exit_)
    model = flat(builder)
    assert [block.name for block in model.blocks] == ["In", "Out"]
    assert len(model.wires) == 1


def test_ports_that_nobody_wired_leave_no_wire(flat):
    builder = ModelBuilder()
    system = builder.add_block("SubSystem", "S")
    entry = builder.add_block("Inport", "In", system=system)
    builder.connect(entry, builder.add_block("Scope", "Scope", system=system))
    builder.connect(system, builder.add_block("Scope", "Outer"))
    assert flat(builder).wires == ()


def link_in_subsystem(*, mirrored=False):
    """Draw world -> [thigh: transform -> transform] -> transform, frames at both sides."""
    builder = ModelBuilder()
    world = builder.add_library(WORLD, "World")
    thigh = builder.add_block("SubSystem", "Thigh")
    foot = builder.add_library(RIGID_TRANSFORM, "Foot")
    near, far = (
        builder.add_library(RIGID_TRANSFORM, name, system=thigh) for name in ("Near", "Far")
    )
    # Numbers count on both sides together, and the drawing's order is not theirs.
    ports = {
        name: builder.add_block("PMIOPort", name, texts, system=thigh)
        for name, texts in (
            ("middle", {"Port": "3", "Side": "Right"}),
            ("end", {"Port": "2", "Side": "Right"}),
            ("base", {"Port": "1", "Side": "Left"} if mirrored else {}),
        )
    }
    builder.physical(f"{ports['base']}#rconn:1", f"{near}#lconn:1")
    builder.physical(f"{near}#rconn:1", f"{far}#lconn:1", f"{ports['middle']}#lconn:1")
    builder.physical(f"{far}#rconn:1", f"{ports['end']}#lconn:1")
    builder.physical(f"{world}#rconn:1", f"{thigh}#lconn:1")
    builder.physical(f"{thigh}#rconn:1", f"{foot}#lconn:1")
    return builder, world, near, far, foot


@pytest.mark.parametrize("mirrored", [False, True])
def test_frames_go_through_subsystems(flat, mirrored):
    builder, world, near, far, foot = link_in_subsystem(mirrored=mirrored)
    model = flat(builder)
    assert {frozenset(node) for node in model.nodes} == {
        frozenset({f"{world}#rconn:1", f"{near}#lconn:1"}),
        frozenset({f"{near}#rconn:1", f"{far}#lconn:1"}),
        frozenset({f"{far}#rconn:1", f"{foot}#lconn:1"}),
    }
    assert {block.name for block in model.blocks} == {"World", "Foot", "Near", "Far"}


def test_connection_labels_join_by_name(flat):
    builder = ModelBuilder()
    frames = [builder.add_library(RIGID_TRANSFORM, f"T{place}") for place in range(3)]
    for place, frame in enumerate(frames):
        label = builder.add_library(
            "nesl_utility/Connection Label", f"L{place}", {"Label": "AB"[place // 2]}
        )
        builder.physical(f"{frame}#rconn:1", f"{label}#rconn:1")
    assert [set(node) for node in flat(builder).nodes] == [{"1#rconn:1", "2#rconn:1"}]


def test_goto_and_from(flat):
    builder = ModelBuilder()
    clock = builder.add_block("Clock", "Clock")
    goto = builder.add_block("Goto", "Goto", {"GotoTag": "t"})
    builder.connect(clock, goto, name="time")
    scopes = []
    for place in range(2):
        source = builder.add_block("From", f"From{place}", {"GotoTag": "t"})
        scopes.append(builder.add_block("Scope", f"Scope{place}"))
        builder.connect(source, scopes[-1])
    model = flat(builder)
    assert set(model.wires) == {
        SignalWire(source=f"{clock}#out:1", target=f"{scope}#in:1", name="time") for scope in scopes
    }


def test_tags_reach_as_far_as_they_say(flat):
    builder = ModelBuilder()
    system = builder.add_block("SubSystem", "S")
    outer = builder.add_block("Clock", "Outer")
    inner = builder.add_block("Clock", "Inner", system=system)
    builder.connect(outer, builder.add_block("Goto", "G", {"TagVisibility": "global"}))
    builder.connect(inner, builder.add_block("Goto", "G", system=system))
    targets = {}
    for name, where in (("near", system), ("top", "")):
        scope = builder.add_block("Scope", name, system=where)
        builder.connect(builder.add_block("From", f"F {name}", system=where), scope)
        targets[f"{scope}#in:1"] = name
    found = {targets[wire.target]: wire.source for wire in flat(builder).wires}
    assert found == {"near": f"{inner}#out:1", "top": f"{outer}#out:1"}


def test_a_from_without_goto_is_named(flat):
    builder = ModelBuilder()
    builder.connect(builder.add_block("From", "F"), builder.add_block("Scope", "S"))
    with pytest.raises(
        InvalidValueError, match=r"'F' \(SID 1\) has the tag 'A', for which there is no"
    ):
        flat(builder)
    for name in "GH":
        builder.add_block("Goto", name)
    with pytest.raises(InvalidValueError, match="for which there are several Gotos"):
        flat(builder)


def test_nothing_comes_from_a_doubtful_tag_where_that_is_allowed(tmp_path):
    builder = ModelBuilder()
    builder.connect(builder.add_block("From", "F"), builder.add_block("Scope", "S"))
    model = read_model(builder.write(tmp_path / "none.slx"))
    assert flatten(model, strict=False).wires == ()
    for name in ("G1", "G2"):
        builder.add_block("Goto", name)
    model = read_model(builder.write(tmp_path / "several.slx"))
    assert flatten(model, strict=False).wires == ()


def test_a_circle_without_blocks_is_named(flat):
    builder = ModelBuilder()
    source, scope = builder.add_block("From", "F"), builder.add_block("Scope", "S")
    builder.connect(source, scope, builder.add_block("Goto", "G"))
    with pytest.raises(InvalidValueError, match="forms a loop without any block"):
        flat(builder)


def test_an_enabled_subsystem_keeps_its_enable_port(flat):
    builder = ModelBuilder()
    system = builder.add_block("SubSystem", "S")
    clock = builder.add_block("Clock", "Clock")
    builder.connect(clock, f"{system}#enable")
    with pytest.raises(InvalidValueError, match="has a wire to its enable port, but no EnablePort"):
        flat(builder)
    enable = builder.add_block("EnablePort", "Enable", system=system)
    (wire,) = flat(builder).wires
    assert (wire.source, wire.target) == (f"{clock}#out:1", f"{enable}#in:1")


@pytest.mark.parametrize("order", ["a;b", "b;a"])
def test_frames_meet_through_the_elements_of_a_bus_by_their_names(flat, order):
    builder = ModelBuilder()
    ends, buses = {}, []
    for place, names in (("near", "a;b"), ("far", order)):
        system = builder.add_block("SubSystem", place)
        bus = builder.add_block("SimscapeBus", "Bus", {"HierarchyStrings": names}, system=system)
        exit_ = builder.add_block("PMIOPort", "Out", {"Side": "Right"}, system=system)
        builder.physical(f"{bus}#rconn:1", f"{exit_}#rconn:1")
        for number, name in enumerate(names.split(";"), 1):
            ends[place, name] = builder.add_library(RIGID_TRANSFORM, name, system=system)
            builder.physical(f"{bus}#lconn:{number}", f"{ends[place, name]}#lconn:1")
        buses.append(system)
    builder.physical(*(f"{system}#rconn:1" for system in buses))
    nodes = {frozenset(node) for node in flat(builder).nodes}
    assert nodes == {
        frozenset({f"{ends['near', name]}#lconn:1", f"{ends['far', name]}#lconn:1"})
        for name in "ab"
    }
