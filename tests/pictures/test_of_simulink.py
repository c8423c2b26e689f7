"""Simulink models as pictures: every block, wire and connection of the file, and in their order."""

import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path

import pytest
from slx_models import (
    BRICK,
    MECHANISM,
    REVOLUTE,
    RIGID_TRANSFORM,
    SIX_DOF,
    SPHERE,
    TO_SIMULINK,
    WORLD,
    published_leg,
    published_pendulum,
)
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.pictures.drawing import draw
from drake_leg.pictures.mechanical import mechanism_picture
from drake_leg.pictures.of_simulink import MOST_BLOCKS, model_pictures
from drake_leg.pictures.parts import lay_out_parts
from drake_leg.robot.robots import LEG_B
from drake_leg.simulink.model import split_port
from drake_leg.simulink.reader import read_model

LEG = Path(__file__).parents[2] / "notebooks" / "leg.slx"
OFFSET = {"TranslationMethod": "StandardAxis", "TranslationStandardOffset": "0.1"}


@pytest.fixture
def pictures(tmp_path):
    def of(builder, **options):
        model = read_model(builder.write(tmp_path / "m.slx"))
        return model_pictures(model, title="m", **options)

    return of


@pytest.fixture
def picture(pictures):
    def of(builder):
        (only,) = pictures(builder)
        return only

    return of


def transform(builder, name, settings=OFFSET, **more):
    return builder.add_library(RIGID_TRANSFORM, name, settings, **more)


def pairs(picture):
    """Name what each net joins: source and target."""
    return Counter(
        (picture.blocks[net.source[0]].name, picture.blocks[block].name)
        for net in picture.nets
        for block, _ in net.targets
    )


def joined(picture):
    """Name what each physical net joins, in whatever order."""
    return Counter(
        frozenset(picture.blocks[block].name for block, _ in (net.source, *net.targets))
        for net in picture.nets
        if net.physical
    )


def follow(picture, start, glyphs):
    """Names of the blocks of some glyphs, in breadth-first order along the nets."""
    index = {block.name: place for place, block in enumerate(picture.blocks)}
    queue, seen = [index[start]], [index[start]]
    while queue:
        here = queue.pop(0)
        for net in picture.nets:
            if net.source[0] == here:
                new = [block for block, _ in net.targets if block not in seen]
                seen += new
                queue += new
    return [picture.blocks[place].name for place in seen if picture.blocks[place].glyph in glyphs]


def block_named(picture, name):
    (found,) = (block for block in picture.blocks if block.name == name)
    return found


def four_bar(*, second_world=False):
    """Draw four hinges and three bars, closed at one World Frame or held by two."""
    builder = ModelBuilder()
    world = builder.add_library(WORLD, "World")
    last = builder.add_library(WORLD, "World 2") if second_world else world
    ends = [f"{world}#rconn:1"]
    for place in range(3):
        hinge, bar = builder.add_library(REVOLUTE, f"R{place}"), transform(builder, f"bar {place}")
        builder.physical(*ends, f"{hinge}#lconn:1")
        builder.physical(f"{hinge}#rconn:1", f"{bar}#lconn:1")
        ends = [f"{bar}#rconn:1"]
    hinge = builder.add_library(REVOLUTE, "R3")
    builder.physical(*ends, f"{hinge}#lconn:1")
    builder.physical(f"{hinge}#rconn:1", f"{last}#rconn:1")
    return builder


def three_thighs():
    """Draw a link three times as a subsystem, the same names in each."""
    builder = ModelBuilder()
    end = f"{builder.add_library(WORLD, 'World')}#rconn:1"
    for place in range(3):
        thigh = builder.add_block("SubSystem", f"Thigh {place}")
        near = transform(builder, "to\nCOG", system=thigh)
        far = transform(builder, "to end", system=thigh)
        brick = builder.add_library(BRICK, "Brick", system=thigh)
        ports = [
            builder.add_block("PMIOPort", name, {"Port": number, "Side": side}, system=thigh)
            for name, number, side in (("base", "1", "Left"), ("end", "2", "Right"))
        ]
        builder.physical(f"{ports[0]}#rconn:1", f"{near}#lconn:1")
        builder.physical(f"{near}#rconn:1", f"{far}#lconn:1", f"{brick}#rconn:1")
        builder.physical(f"{far}#rconn:1", f"{ports[1]}#lconn:1")
        builder.physical(end, f"{thigh}#lconn:1")
        end = f"{thigh}#rconn:1"
    return builder


def control_loop():
    """Draw an algebraic loop and blocks that have no glyph of their own."""
    builder = ModelBuilder()
    step = builder.add_block("Step", "Step")
    total = builder.add_block("Sum", "Sum", {"Inputs": "|+-"})
    gain = builder.add_block("Gain", "K", {"Gain": "-2.5"})
    lag = builder.add_block("TransferFcn", "a lag whose name has more words than fit under it " * 3)
    builder.connect(step, f"{total}#in:1", name="command")
    builder.connect(gain, f"{total}#in:2")
    builder.connect(total, gain, lag, name="e")
    builder.add_block("Constant", "unused", {"Value": "[1 2 3]"})
    return builder


def physical_signals():
    """Draw a hinge whose torque depends on its angle, without converters, and a sensor."""
    builder = ModelBuilder()
    world, ball = builder.add_library(WORLD, "World"), builder.add_library(SPHERE, "ball")
    modes = {"TorqueActuationMode": "InputTorque", "SensePosition": "on"}
    hinge = builder.add_library(REVOLUTE, "hinge", modes)
    gain = builder.add_library("fl_lib/Physical Signals/Functions/PS Gain", "PS Gain")
    sensor = builder.add_library("sm_lib/Frames and Transforms/Transform Sensor", "sensor")
    converter, scope = builder.add_library(TO_SIMULINK, "out"), builder.add_block("Scope", "x")
    builder.physical(f"{world}#rconn:1", f"{hinge}#lconn:1", f"{sensor}#lconn:1")
    builder.physical(f"{hinge}#rconn:1", f"{sensor}#rconn:1", f"{ball}#rconn:1")
    builder.physical(f"{hinge}#rconn:2", f"{gain}#lconn:1")
    builder.physical(f"{gain}#rconn:1", f"{hinge}#lconn:2")
    builder.physical(f"{sensor}#rconn:2", f"{converter}#lconn:1")
    builder.connect(converter, scope)
    return builder


def unconnected():
    builder = ModelBuilder()
    builder.add_library(WORLD, "World")
    builder.add_library(REVOLUTE, "hinge")
    builder.add_block("Gain", "K")
    return builder


def in_a_ring():
    builder = ModelBuilder()
    here = transform(builder, "ring")
    builder.physical(f"{here}#lconn:1", f"{here}#rconn:1")
    return builder


MODELS = (
    published_leg,
    published_pendulum,
    four_bar,
    three_thighs,
    control_loop,
    physical_signals,
    unconnected,
    in_a_ring,
)


@pytest.mark.parametrize("build", MODELS)
def test_a_model_is_drawn_cleanly_and_the_same_every_time(pictures, require_clean, build):
    drawings = [draw(*pictures(build())).svg for _ in range(2)]
    assert drawings[0] == drawings[1]
    assert ET.fromstring(drawings[0]).tag.endswith("svg")
    for picture in pictures(build()):
        require_clean(lay_out_parts(picture))


@pytest.mark.parametrize("seed", range(20))
def test_a_chance_network_is_drawn_with_all_its_connections(picture, require_clean, rng, seed):
    rng = type(rng)(type(rng.bit_generator)(seed))
    builder = ModelBuilder()
    kinds = (WORLD, SPHERE, REVOLUTE, RIGID_TRANSFORM, SIX_DOF, "fl_lib/Mechanical/Lever")
    ports = []
    for place in range(rng.integers(2, 12)):
        sid = builder.add_library(kinds[rng.integers(len(kinds))], f"B{place}")
        ports += [f"{sid}#lconn:1", f"{sid}#rconn:1"]
    rng.shuffle(ports)
    sizes = rng.integers(2, 5, len(ports))
    ends = [ports[sum(sizes[:k]) : sum(sizes[: k + 1])] for k in range(len(sizes))]
    nodes = [node for node in ends if len(node) > 1]
    for node in nodes:
        builder.physical(*node)
    drawn = picture(builder)
    assert len(drawn.blocks) == len(builder.blocks)
    names = (frozenset(builder.blocks[split_port(port)[0]].name for port in node) for node in nodes)
    assert joined(drawn) == Counter(names)
    require_clean(lay_out_parts(drawn))


@pytest.mark.parametrize("build", MODELS)
def test_every_block_is_in_one_picture_but_what_signals_reach_is_in_both(pictures, build):
    builder = build()
    both = {
        published_leg: {"Revolute Joint", "Revolute Joint1", "Revolute Joint2", "6-DOF Joint"},
        published_pendulum: {"Revolute Joint"},
        physical_signals: {"hinge", "sensor"},
    }.get(build, set())
    opened = ("SubSystem", "PMIOPort")
    kept = [b for b in builder.blocks.values() if b.type not in opened or b.script is not None]
    drawn = Counter(block.name for picture in pictures(builder) for block in picture.blocks)
    assert sum(drawn.values()) == len(kept) + len(both)
    assert {name for name, times in drawn.items() if times > 1} == both


def test_the_published_file_is_drawn_with_all_its_wires():
    model = read_model(LEG)
    signals, mechanism = model_pictures(model, title="leg")
    name = {block.sid: block.name for block in model.blocks}
    wired = Counter(
        (name[split_port(w.source)[0]], name[split_port(w.target)[0]]) for w in model.wires
    )
    assert not wired - pairs(signals)
    labels = {net.label for net in signals.nets if net.label}
    assert labels == {wire.name for wire in model.wires if wire.name}
    nodes = Counter(frozenset(name[split_port(port)[0]] for port in node) for node in model.nodes)
    assert joined(signals) + joined(mechanism) == nodes


def test_the_mechanism_goes_from_the_world_to_the_foot(pictures):
    _, mechanism = pictures(published_leg())
    assert follow(mechanism, "World Frame", ("world", "revolute", "brick", "sphere")) == [
        "World Frame",
        "Revolute Joint",
        "Brick Solid0",
        "Revolute Joint1",
        "Brick Solid1",
        "Revolute Joint2",
        "Brick Solid2",
        "Spherical Solid",
    ]
    assert block_named(mechanism, "6-DOF Joint").inputs == ("", "")
    assert not block_named(mechanism, "6-DOF Joint").outputs
    assert all(net.physical and not net.arrow for net in mechanism.nets)


def test_transforms_are_described_as_those_of_the_plant(pictures):
    _, ours = pictures(published_leg())
    theirs = mechanism_picture(build_plant(LEG_B), title="leg")
    words = [
        [block.caption for block in picture.blocks if block.glyph == "transform"]
        for picture in (ours, theirs)
    ]
    assert [caption[2:] for caption in words[0]] == words[1]


def test_blocks_carry_their_most_telling_parameters(pictures):
    signals, mechanism = pictures(published_leg())
    assert block_named(signals, "Sine Wave").caption == ("Sine Wave", "amplitude 70", "1 rad/s")
    assert block_named(signals, "q2 initial").text == ("−0.8727",)
    function = block_named(signals, "MATLAB Function")
    assert (function.text, function.inputs, function.outputs) == (("jacob_inv",), ("u",), ("y",))
    assert block_named(signals, "Simulink-PS Converter1").caption[-2:] == ("rad", "2 lags of 1 ms")
    assert block_named(mechanism, "Brick Solid1").caption[1:] == ("100 × 1 × 1 mm", "0.1 g")
    assert block_named(mechanism, "Revolute Joint").caption[-1] == "motion by input"
    assert "−9.80665" in " ".join(block_named(mechanism, "Mechanism Configuration").caption)


def test_a_value_that_is_not_known_is_drawn_as_its_text(pictures):
    builder = published_leg()
    builder.set("Sine Wave", Amplitude="A/2")
    builder.set("Brick Solid1", BrickDimensions="[L w h]")
    builder.set("Rigid Transform1", TranslationCartesianOffset="[L/2 0 0]")
    signals, mechanism = pictures(builder)
    assert any("A/2" in line for line in block_named(signals, "Sine Wave").caption)
    assert block_named(mechanism, "Brick Solid1").caption[-1] == "[L w h]"
    assert block_named(mechanism, "Rigid Transform1").caption[-1] == "[L/2 0 0]"


def test_an_unknown_block_between_signals_and_bodies_is_drawn(pictures):
    builder = ModelBuilder()
    world = builder.add_library(WORLD, "World")
    leg = builder.add_library("my_lib/Leg", "Leg")
    scope = builder.add_block("Scope", "Scope")
    builder.physical(f"{world}#rconn:1", f"{leg}#lconn:1")
    builder.connect(f"{leg}#out:1", scope)
    assert block_named(pictures(builder, part="signals")[0], "Leg").outputs


def test_springs_and_dampers_of_a_joint_are_written_in_si(pictures):
    joint = {"SpringStiffness": "0.01", "EquilibriumPosition": "-30", "DampingCoefficient": "1"}
    _, mechanism = pictures(published_pendulum(joint))
    assert block_named(mechanism, "Revolute Joint").caption[1:] == (
        "damping 57.3",
        "N·m·s/rad",
        "spring 0.573 N·m/rad",
        "at rest at −30°",
    )


def test_a_block_that_is_wired_the_other_way_says_so(picture):
    builder = ModelBuilder()
    world, bar = builder.add_library(WORLD, "World"), transform(builder, "bar")
    ball = builder.add_library(SPHERE, "ball")
    builder.physical(f"{world}#rconn:1", f"{bar}#rconn:1")
    builder.physical(f"{bar}#lconn:1", f"{ball}#rconn:1")
    drawn = picture(builder)
    assert follow(drawn, "World", ("world", "transform", "sphere")) == ["World", "bar", "ball"]
    assert block_named(drawn, "bar").caption[-1] == "drawn F to B"


def test_names_in_subsystems_are_told_apart(picture):
    drawn = picture(three_thighs())
    transforms = [block for block in drawn.blocks if block.glyph == "transform"]
    assert [block.name for block in transforms[:2]] == ["Thigh 0/to COG", "Thigh 0/to end"]
    assert {block.caption[0] for block in transforms} == {"to COG", "to end"}


def test_two_blocks_of_one_name_are_told_apart_by_their_sids(picture):
    builder = ModelBuilder()
    for _ in range(2):
        builder.add_block("Gain", "K")
    assert [block.name for block in picture(builder).blocks] == ["K (SID 1)", "K (SID 2)"]


def test_a_closed_loop_ends_in_a_block_with_both_frames_on_its_left(picture):
    closing = [b.name for b in picture(four_bar()).blocks if len(b.inputs) == 2]
    assert closing == ["bar 1"]


def test_two_world_frames_meet_in_the_middle(picture):
    drawn = picture(four_bar(second_world=True))
    assert [block.name for block in drawn.blocks if not block.inputs] == ["World", "World 2"]
    assert len([block for block in drawn.blocks if len(block.inputs) == 2]) == 1


def test_a_joint_that_carries_a_robot_is_gone_through_even_if_it_senses(pictures):
    builder = ModelBuilder()
    world = builder.add_library(WORLD, "World")
    free = builder.add_library(SIX_DOF, "free", {"PxSensePosition": "on"})
    ball, out = builder.add_library(SPHERE, "ball"), builder.add_library(TO_SIMULINK, "out")
    builder.physical(f"{world}#rconn:1", f"{free}#lconn:1")
    builder.physical(f"{free}#rconn:1", f"{ball}#rconn:1")
    builder.physical(f"{free}#rconn:2", f"{out}#lconn:1")
    _, mechanism = pictures(builder)
    assert follow(mechanism, "World", ("world", "six_dof", "sphere")) == ["World", "free", "ball"]


def test_a_chain_without_a_world_starts_at_its_open_end(picture):
    builder = ModelBuilder()
    solid, hinge = builder.add_library(BRICK, "solid"), builder.add_library(REVOLUTE, "hinge")
    bar = transform(builder, "bar")
    builder.physical(f"{solid}#rconn:1", f"{bar}#rconn:1")
    builder.physical(f"{bar}#lconn:1", f"{hinge}#rconn:1")
    assert [block.name for block in picture(builder).blocks] == ["hinge", "bar", "solid"]


def test_physical_signals_have_a_direction_and_stay_out_of_the_mechanism(pictures):
    signals, mechanism = pictures(physical_signals())
    assert pairs(signals) == Counter(
        [("hinge", "PS Gain"), ("PS Gain", "hinge"), ("sensor", "out"), ("out", "x")]
    )
    blue = {net.source: net.physical for net in signals.nets}
    assert sum(blue.values()) == 3
    assert {block.name for block in mechanism.blocks} == {"World", "hinge", "sensor", "ball"}
    assert len(block_named(mechanism, "sensor").inputs) == 2


def test_signs_and_kinds_are_written_in_blocks(picture):
    drawn = picture(control_loop())
    assert block_named(drawn, "Sum").inputs == ("+", "−")
    assert block_named(drawn, "K").text == ("−2.5",)
    assert block_named(drawn, "unused").text == ("[3]",)
    (lag,) = (block for block in drawn.blocks if block.text == ("Transfer Fcn",))
    assert len(lag.caption) == 3


def test_code_that_cannot_be_read_is_a_box(picture):
    builder = ModelBuilder()
    builder.add_function("F", "no function at all")
    (drawn,) = picture(builder).blocks
    assert drawn.text == ("MATLAB", "Function")


@pytest.mark.parametrize(
    ("source", "settings", "sentence"),
    [
        (BRICK, {"BrickDimensions": "[1 2]"}, r"'B' \(SID 1\): its BrickDimensions are 2 numbers"),
        (BRICK, {"BrickDimensions": "[1 2 0]"}, r"'B' \(SID 1\): the brick's height is 0.0 m"),
        (RIGID_TRANSFORM, {"RotationMethod": "Magic"}, r"'B' \(SID 1\) has RotationMethod 'Magic'"),
    ],
)
def test_what_makes_no_sense_is_refused(pictures, source, settings, sentence):
    builder = ModelBuilder()
    builder.add_library(source, "B", settings)
    with pytest.raises(InvalidValueError, match=sentence):
        pictures(builder)


def test_an_empty_model_is_refused(pictures):
    builder = ModelBuilder()
    builder.add_block("SubSystem", "nothing inside")
    with pytest.raises(InvalidValueError, match="no blocks to draw"):
        pictures(builder)


def test_parts(pictures):
    titles = {
        part: [picture.title for picture in pictures(published_leg(), part=part)]
        for part in ("all", "signals", "mechanism")
    }
    assert (
        titles["all"] == titles["signals"] + titles["mechanism"] == ["m: signals", "m: mechanism"]
    )
    with pytest.raises(InvalidValueError, match="its parts are signals and mechanism"):
        pictures(published_leg(), part="femur")
    with pytest.raises(InvalidValueError, match="no mechanism to draw"):
        pictures(control_loop(), part="mechanism")


def test_a_picture_that_nobody_can_read_is_refused(pictures):
    builder = ModelBuilder()
    for place in range(MOST_BLOCKS + 1):
        builder.add_block("Gain", f"K{place}")
    with pytest.raises(InvalidValueError, match="301 blocks; at most 300"):
        pictures(builder)


def test_gravity_that_is_no_vector_is_left_out(picture):
    builder = ModelBuilder()
    builder.add_library(MECHANISM, "Mechanism Configuration", {"UniformGravity": "None"})
    assert picture(builder).blocks[0].caption == ("Mechanism", "Configuration")
