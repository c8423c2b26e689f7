"""What lies in other files: library blocks, models, subsystems."""

import pytest
from slx_writer import ModelBuilder, mask_text, read_understood, write_parts

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.lacks import lacks_of
from drake_leg.simulink.linking import Libraries
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.wiring import flatten


def amplifier(gain="L", mask=None, name="Amplifier"):
    """Draw a subsystem of one gain."""
    builder = ModelBuilder()
    outer = builder.add_block("SubSystem", name)
    if mask:
        builder.blocks[outer].mask = mask_text(mask)
    fill(builder, outer, gain)
    return builder


def fill(builder, system, gain):
    entry = builder.add_block("Inport", "u", {"Port": "1"}, system=system)
    inside = builder.add_block("Gain", "K", {"Gain": gain}, system=system)
    leaving = builder.add_block("Outport", "y", {"Port": "1"}, system=system)
    builder.connect(entry, inside)
    builder.connect(inside, leaving)


def user(kind, texts=None, source=""):
    """Draw clock -> a block that refers to a file -> scope."""
    builder = ModelBuilder()
    clock = builder.add_block("Clock", "Clock")
    block = (
        builder.add_library(source, "User", texts)
        if source
        else builder.add_block(kind, "User", texts)
    )
    scope = builder.add_block("Scope", "Scope")
    builder.connect(clock, f"{block}#in:1")
    builder.connect(f"{block}#out:1", scope)
    return builder


def gains(model):
    return [block.parameters["Gain"] for block in model.blocks if block.type == "Gain"]


def test_a_library_block_is_read_from_the_file_beside(tmp_path):
    amplifier("3").write(tmp_path / "my_lib.slx")
    path = user("Reference", source="my_lib/Amplifier").write(tmp_path / "m.slx")
    model = read_understood(path)
    assert gains(model) == [3.0]
    flat = flatten(model)
    assert {block.name for block in flat.blocks} == {"Clock", "K", "Scope"}
    assert len(flat.wires) == 2


def test_it_is_found_in_a_given_folder_and_folders_inside(tmp_path):
    folder = tmp_path / "libraries" / "mine"
    folder.mkdir(parents=True)
    amplifier("3").write(folder / "my_lib.slx")
    path = user("Reference", source="my_lib/Amplifier").write(tmp_path / "m.slx")
    assert lacks_of(read_model(path))
    assert gains(read_model(path, paths=[tmp_path / "libraries"])) == [3.0]


def test_settings_of_the_model_go_before_those_of_the_library(tmp_path):
    amplifier("2*L", {"L": "5"}).write(tmp_path / "my_lib.slx")
    for texts, gain in (({}, 10.0), ({"L": "7"}, 14.0)):
        path = user("Reference", texts, "my_lib/Amplifier").write(tmp_path / "m.slx")
        assert gains(read_understood(path)) == [gain]


def test_two_blocks_of_one_library_are_two(tmp_path):
    amplifier("3").write(tmp_path / "my_lib.slx")
    builder = user("Reference", source="my_lib/Amplifier")
    builder.add_library("my_lib/Amplifier", "Second")
    model = read_understood(builder.write(tmp_path / "m.slx"))
    assert gains(model) == [3.0, 3.0]
    assert len({block.sid for block in model.blocks}) == len(model.blocks)


def test_a_block_may_refer_to_its_own_file(tmp_path):
    builder = amplifier("3")
    builder.add_library("$bdroot/Amplifier", "Again")
    assert gains(read_understood(builder.write(tmp_path / "my_lib.slx"))) == [3.0, 3.0]


@pytest.mark.parametrize(
    ("kind", "texts"),
    [
        ("ModelReference", {"ModelNameDialog": "part.slx"}),
        ("SubSystem", {"ReferencedSubsystem": "part"}),
    ],
)
def test_a_whole_file_is_a_subsystem(tmp_path, kind, texts):
    part = ModelBuilder()
    fill(part, "", "4")
    part.write(tmp_path / "part.slx")
    model = read_understood(user(kind, texts).write(tmp_path / "m.slx"))
    assert gains(model) == [4.0]
    assert len(flatten(model).wires) == 2


def masked_part(tmp_path):
    """Write a subsystem in a file of its own, whose mask's script sets what is inside."""
    part = ModelBuilder()
    fill(part, "", "2*L + extra")
    inner = part.add_block("SubSystem", "Stage")
    part.blocks[inner].mask = mask_text({"stroke": "0"})
    part.add_block("Gain", "Inner", {"Gain": "stroke"}, system=inner)
    parts = part.parts()
    mask = mask_text({"L": "5", "extra": "1"}, "initialize_part")
    parts["simulink/modelMask.xml"] = mask
    whole = "simulink/blockdiagram.xml"
    parts[whole] = parts[whole].replace("Model>", "Subsystem>")
    (tmp_path / "initialize_part.m").write_text(
        "here = gcb;\nmask = Simulink.Mask.get(here);\nlength = mask.getParameter('L');\n"
        "stages = find_system(here, 'LookUnderMasks', 'all', 'Name', 'Stage');\n"
        "for k = 1:numel(stages)\n  set_param(stages{k}, 'stroke', length.Value);\nend\n"
        "extra = 10;\nresize(handle=getSimulinkBlockHandle(here));\n"
    )
    return write_parts(tmp_path / "part.slx", parts)


def test_a_subsystem_in_a_file_has_a_mask_of_its_own(tmp_path):
    path = masked_part(tmp_path)
    assert gains(read_understood(path)) == [20.0, 5.0]
    texts = {"ReferencedSubsystem": "part"}
    for own, found in (({}, [20.0, 5.0]), ({"L": "7"}, [24.0, 7.0])):
        outer = user("SubSystem", texts | own).write(tmp_path / "m.slx")
        assert gains(read_understood(outer)) == found


def test_what_lacks_in_the_mask_of_a_file_is_named(tmp_path):
    path = masked_part(tmp_path)
    (tmp_path / "initialize_part.m").write_text("extra = unknown_size;")
    (lack,) = lacks_of(read_model(path))
    assert "set by the mask initialization of the file 'part'" in lack.reason


def test_a_model_in_a_model_has_a_workspace_of_its_own(tmp_path):
    part = ModelBuilder(workspace={"WSDataSource": "MATLAB Code", "WSMATLABCode": "k = 6;"})
    fill(part, "", "k + outer")
    part.write(tmp_path / "part.slx")
    builder = user("ModelReference", {"ModelNameDialog": "part.slx"})
    builder.workspace = {"WSDataSource": "MATLAB Code", "WSMATLABCode": "k = 100; hidden = 1;"}
    path = builder.write(tmp_path / "m.slx")
    model = read_model(path, values={"outer": 0.5})
    assert gains(model) == [6.5]
    assert model.variables.used["k"] == "model workspace of part"
    fill(part := ModelBuilder(), "", "hidden")
    part.write(tmp_path / "part.slx")
    (lack,) = lacks_of(read_model(path))
    assert lack.names == ("hidden",)


def test_code_in_a_library_is_found_by_its_path_there(tmp_path):
    builder = ModelBuilder()
    for number, name in enumerate(("First", "Second"), start=1):
        outer = builder.add_block("SubSystem", name)
        builder.add_function("f", f"function y = f(u)\ny = {number}*u;\n", system=outer)
    builder.write(tmp_path / "my_lib.slx")
    path = user("Reference", source="my_lib/Second").write(tmp_path / "m.slx")
    (function,) = read_understood(path).functions
    assert "y = 2*u" in function.script


@pytest.mark.parametrize("name", ["9" * 300, "..", "a/b", "a\0b", "~root"])
def test_names_that_no_model_has_lead_nowhere(tmp_path, name):
    with pytest.raises(InvalidValueError, match="there is no file"):
        Libraries(tmp_path, [tmp_path]).file(name)


def test_a_circle_of_libraries_is_said(tmp_path):
    builder = ModelBuilder()
    outer = builder.add_block("SubSystem", "Leg")
    builder.add_library("my_lib/Leg", "Leg again", system=outer)
    with pytest.raises(InvalidValueError, match="Leg refers to itself"):
        read_understood(builder.write(tmp_path / "my_lib.slx"))


@pytest.mark.parametrize(
    ("content", "reason"),
    [(None, "there is no file my_lib.slx"), (b"PK cut", "cut short or damaged")],
)
def test_what_is_not_there_is_a_lack(tmp_path, content, reason):
    if content:
        (tmp_path / "my_lib.slx").write_bytes(content)
    path = user("Reference", source="my_lib/Amplifier").write(tmp_path / "m.slx")
    with pytest.raises(InvalidValueError, match=reason):
        read_understood(path)


def test_a_block_that_the_library_lacks_is_named(tmp_path):
    amplifier("3").write(tmp_path / "my_lib.slx")
    path = user("Reference", source="my_lib/Sub/Attenuator").write(tmp_path / "m.slx")
    with pytest.raises(InvalidValueError, match=r"my_lib.slx has no block 'Sub/Attenuator'"):
        read_understood(path)


def test_libraries_that_multiply_stop_at_a_number(tmp_path, monkeypatch):
    monkeypatch.setattr("drake_leg.simulink.diagram.MOST_BLOCKS", 500)
    amplifier("1", name="L0").write(tmp_path / "l0.slx")
    for level in range(1, 12):
        builder = ModelBuilder()
        outer = builder.add_block("SubSystem", f"L{level}")
        for each in range(2):
            builder.add_library(f"l{level - 1}/L{level - 1}", f"part {each}", system=outer)
        builder.write(tmp_path / f"l{level}.slx")
    with pytest.raises(InvalidValueError, match="more than 500 blocks"):
        read_model(user("Reference", source="l11/L11").write(tmp_path / "m.slx"))


@pytest.mark.parametrize(
    ("source", "remedy"),
    [
        ("simulink/Sources/Novel", "let `replace` say what it puts out instead"),
        ("ee_lib/Novel", "comment it out"),
    ],
)
def test_a_block_of_a_product_is_not_asked_for_as_a_file(tmp_path, source, remedy):
    path = user("Reference", source=source).write(tmp_path / "m.slx")
    with pytest.raises(InvalidValueError, match=f"of a product, .* computed here: {remedy}"):
        read_understood(path)
