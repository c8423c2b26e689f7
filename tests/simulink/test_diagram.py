"""Masked subsystems, in the three forms that files have."""

import pytest
from slx_writer import ModelBuilder, mask_text, read_understood
from work import calls

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import parse_markup
from drake_leg.simulink.masks import read_mask

BRICK = "sm_lib/Body Elements/Brick Solid"
FORMS = ("new", "R2013", "texts")


def masked(builder, name, values, initialization="", *, form="new", system="", **attributes):
    """Add a masked subsystem and return its SID."""
    texts = {}
    if form == "texts":
        texts = {
            "MaskVariables": "".join(f"{key}=@{at};" for at, key in enumerate(values, 1)),
            "MaskValueString": "|".join(values.values()),
            "MaskInitialization": initialization,
        }
    sid = builder.add_block("SubSystem", name, texts, system=system)
    if form != "texts":
        builder.blocks[sid].mask = mask_text(values, initialization, form=form, **attributes)
    return sid


@pytest.fixture
def gain(tmp_path):
    """Read the gain of the last block, which is ``K`` inside all subsystems."""

    def _gain(builder, text, system, layout="new"):
        builder.add_block("Gain", "K", {"Gain": text}, system=system)
        return (
            read_understood(builder.write(tmp_path / "m.slx", layout=layout))
            .blocks[-1]
            .parameters["Gain"]
        )

    return _gain


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("layout", ["new", "old"])
def test_blocks_inside_use_the_masks_names(tmp_path, form, layout):
    builder = ModelBuilder()
    for name, length in (("Coxa", "50"), ("Femur", "2*L0")):
        values = {"L0": "50", "L": length} if name == "Coxa" else {"L": "100", "w": "[1 2]"}
        link = masked(builder, name, values, form=form)
        texts = {"BrickDimensions": "[L 1 1]", "BrickDimensionsUnits": "mm"}
        builder.add_library(BRICK, f"Brick {name}", texts, system=link)
    model = read_understood(builder.write(tmp_path / "m.slx", layout=layout))
    found = {block.name: block.parameters for block in model.blocks}
    assert found["Brick Coxa"]["BrickDimensions"] == (0.05, 0.001, 0.001)
    assert found["Brick Femur"]["BrickDimensions"] == (0.1, 0.001, 0.001)
    assert (found["Coxa"]["L"], found["Femur"]["L"], found["Femur"]["w"]) == (50, 100, (1, 2))
    assert [block.mask for block in model.blocks] == [("L0", "L"), (), ("L", "w"), ()]


def test_masks_in_masks(gain):
    builder = ModelBuilder()
    outer = masked(builder, "Outer", {"L": "100", "r": "7"})
    inner = masked(builder, "Inner", {"L": "L/4", "half": "r/2"}, system=outer)
    plain = builder.add_block("SubSystem", "Plain", system=inner)
    assert gain(builder, "[L half r]", plain) == (25.0, 3.5, 7.0)


def test_a_masks_values_do_not_see_each_other(gain):
    builder = ModelBuilder()
    system = masked(builder, "S", {"L": "100", "h": "L/2"})
    with pytest.raises(
        InvalidValueError, match=r"mask parameter h of block 'S' .SID 1. is 'L/2': "
    ):
        gain(builder, "h", system)


def test_names_end_with_their_subsystem(gain):
    builder = ModelBuilder()
    masked(builder, "S", {"L": "100"})
    with pytest.raises(
        InvalidValueError, match=r"'K' .SID 2.: parameter Gain is 'L', which cannot"
    ):
        gain(builder, "L", "")


def test_a_masked_block_uses_its_own_names(tmp_path):
    builder = ModelBuilder()
    sid = builder.add_block("Gain", "K", {"Gain": "2*k"})
    builder.blocks[sid].mask = mask_text({"k": "21"})
    (block,) = read_understood(builder.write(tmp_path / "m.slx")).blocks
    assert (block.parameters["Gain"], block.parameters["k"]) == (42.0, 21.0)


@pytest.mark.parametrize("text", ["[1;2;3]", "[1 2 3]'", "[1;2;3] % mm"])
def test_a_column_stays_a_column(gain, text):
    builder = ModelBuilder()
    system = masked(builder, "S", {"v": text})
    assert gain(builder, "v*v'", system) == ((1, 2, 3), (2, 4, 6), (3, 6, 9))


@pytest.mark.parametrize(
    ("values", "attributes", "text", "reason"),
    [
        (
            {"L": "L0"},
            {},
            "L/2",
            "mask parameter L of block 'S' .SID 1. is 'L0': 'L0' is not a known function",
        ),
        ({"L": ""}, {}, "L", "is '': the text is empty"),
        ({"L": "9^9^9^9^9"}, {}, "L", "is '9.9.9.9.9': it is infinite"),
        ({"L": "2"}, {"Type": "popup"}, "L", "is '2': it has no choices"),
        ({"L": "2"}, {"Evaluate": "off"}, "L", "'2' is a text, not a number"),
        ({"pi": "rods"}, {}, "pi", "mask parameter pi of block 'S' .SID 1. is 'rods'"),
    ],
)
@pytest.mark.parametrize("form", ["new", "R2013"])
def test_what_a_mask_cannot_tell_is_said(gain, form, values, attributes, text, reason):
    builder = ModelBuilder()
    system = masked(builder, "S", values, form=form, **attributes)
    with pytest.raises(
        InvalidValueError, match=f"parameter Gain is .*cannot be evaluated.*{reason}"
    ):
        gain(builder, text, system)


def test_an_unknown_value_that_nobody_uses_is_no_matter(tmp_path):
    builder = ModelBuilder()
    masked(builder, "Outer", {"L": "2"})
    inner = masked(builder, "S", {"L": "L0", "file": "'leg.stl'"})
    builder.add_block("Gain", "K", {"Gain": "3"}, system=inner)
    model = read_understood(builder.write(tmp_path / "m.slx"))
    assert (model.blocks[1].parameters["L"], model.blocks[1].parameters["file"]) == (
        "L0",
        "'leg.stl'",
    )


@pytest.mark.parametrize("form", FORMS)
def test_the_initialization_of_a_mask_is_run(gain, form):
    builder = ModelBuilder()
    outer = masked(builder, "Outer", {"L": "100"}, form=form)
    system = masked(builder, "S", {"w": "L/50"}, "L = w/2; set_param(gcb, 'x', 'y')\nk = 3*L;")
    builder.blocks[system].system = outer
    assert gain(builder, "[L w k]", system) == (1.0, 2.0, 3.0)


def test_what_an_initialization_leaves_out_is_said(gain):
    builder = ModelBuilder()
    system = masked(builder, "S", {"w": "1"}, "L = get_param(gcb, 'UserData');")
    with pytest.raises(
        InvalidValueError,
        match=r"'L' is set by the mask initialization of block 'S' .SID 1., where it is left out "
        r".line 1 of .*: the parameter 'UserData' of the block is not known",
    ):
        gain(builder, "L", system)


def test_an_initialization_sees_its_own_mask_alone(gain):
    builder = ModelBuilder()
    outer = masked(builder, "Outer", {"far": "100"})
    system = masked(builder, "S", {"w": "1"}, "L = far;", system=outer)
    with pytest.raises(InvalidValueError, match="'far' is not a known function"):
        gain(builder, "L", system)


def test_texts_of_old_masks():
    block = parse_markup(b"<Block/>", "part")
    mask = read_mask(
        block,
        {
            "MaskType": "Link",
            "MaskVariables": "L=@1;name=&2;kind=@3;missing=@4;odd",
            "MaskValueString": "100|leg|brick",
            "MaskStyleString": "edit,edit,popup(brick|sphere),edit",
        },
    )
    assert mask.type == "Link"
    assert mask.values == {"L": "100", "name": "leg", "kind": "brick", "missing": ""}
    assert mask.literal == {"name"}
    assert mask.choices == {"kind": ("brick", "sphere")}


@pytest.mark.slow
def test_the_work_is_proportional_to_the_number_of_masked_blocks(tmp_path):
    def work(gains):
        builder = ModelBuilder()
        system = ""
        for place in range(20):
            mask = {f"a{place}": f"{place}", "L": "100"}
            system = masked(builder, f"S{place}", mask, system=system)
        for place in range(gains):
            builder.add_block(
                "Gain", f"K{place}", {"Gain": f"{place}*L + a{place % 20}"}, system=system
            )
        path = builder.write(tmp_path / f"{gains}.slx")
        assert read_understood(path).blocks[-1].parameters["Gain"] == (gains - 1) * 100 + 19
        return calls(lambda: read_understood(path))

    few, more, most = work(100), work(300), work(500)
    assert most - more == pytest.approx(more - few, rel=0.2)
