"""The physical network of a model, and the walk over its frames."""

from slx_models import BRICK, REVOLUTE, RIGID_TRANSFORM, SIX_DOF, TO_SIMULINK, WORLD
from slx_writer import ModelBuilder

from drake_leg.simulink.mechanism import Walk, network_of
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.wiring import flatten

TWO = {"lconn": 1, "rconn": 1}


def network(builder, tmp_path):
    return network_of(flatten(read_model(builder.write(tmp_path / "m.slx"))))


def arm():
    """Draw two joints in a row with a transform between them; the first one is sensed."""
    model = ModelBuilder()
    world = model.add_library(WORLD, "World", ports={"rconn": 1})
    first = model.add_library(REVOLUTE, "First", {"SensePosition": "on"}, ports=TWO)
    link = model.add_library(RIGID_TRANSFORM, "Link", ports=TWO)
    second = model.add_library(REVOLUTE, "Second", ports=TWO)
    solid = model.add_library(BRICK, "Solid", ports={"rconn": 1})
    converter = model.add_library(TO_SIMULINK, "Converter", ports={"lconn": 1, "out": 1})
    model.physical(f"{world}#rconn:1", f"{first}#lconn:1")
    model.physical(f"{first}#rconn:1", f"{link}#lconn:1")
    model.physical(f"{link}#rconn:1", f"{second}#lconn:1")
    model.physical(f"{second}#rconn:1", f"{solid}#rconn:1")
    model.physical(f"{first}#rconn:2", f"{converter}#lconn:1")
    return model


def steps(found, rank=lambda block, body: (0,)):
    walk = Walk(found, rank)
    world = next(block for block in found.blocks.values() if block.kind == "World Frame")
    return [walk.take(world), *walk]


def test_signals_and_frames_are_told_apart(tmp_path):
    found = network(arm(), tmp_path)
    assert len(found.signals) == 1
    assert len(set(found.frames.values())) == 4
    names = {sid: block.name for sid, block in found.blocks.items()}
    assert {names[sid] for sid in found.sensed} == {"First"}
    assert "Converter" not in {names[sid] for sid in found.mechanical}


def test_a_walk_numbers_the_bodies_from_the_world(tmp_path):
    found = steps(network(arm(), tmp_path))
    assert [(step.block.name, step.body, step.beyond) for step in found] == [
        ("World", 0, 0),
        ("First", 0, 1),
        ("Link", 1, 1),
        ("Second", 1, 2),
        ("Solid", 2, 2),
    ]
    assert [step.near[0].partition("#")[2] for step in found[1:4]] == ["lconn:1"] * 3


def test_a_joint_that_closes_a_loop_leads_nowhere(tmp_path):
    model = arm()
    closing = model.add_library(SIX_DOF, "Closing", ports=TWO)
    model.physical(f"{model.sid('World')}#rconn:1", f"{closing}#lconn:1")
    model.physical(f"{model.sid('Solid')}#rconn:1", f"{closing}#rconn:1")
    last = steps(network(model, tmp_path), lambda block, body: (block.kind == "6-DOF Joint",))[-1]
    assert last.block.name == "Closing"
    assert [port.partition("#")[2] for port in last.near] == ["lconn:1", "rconn:1"]
    assert last.far == ()
    assert last.body == last.beyond == 0


def test_blocks_without_a_rank_are_not_entered(tmp_path):
    found = steps(
        network(arm(), tmp_path), lambda block, body: None if block.name == "Second" else (0,)
    )
    assert [step.block.name for step in found] == ["World", "First", "Link"]


def test_a_joint_that_hangs_free_has_two_bodies(tmp_path):
    model = ModelBuilder()
    model.add_library(REVOLUTE, "Free", ports=TWO)
    found = network(model, tmp_path)
    walk = Walk(found, lambda block, body: (0,))
    (block,) = found.blocks.values()
    step = walk.take(block)
    assert step.near == ()
    assert (step.body, step.beyond) == (1, 2)
    assert [walk.reached[frame] for frame in found.ends(block)] == [1, 2]
