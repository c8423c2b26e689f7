"""Parameters of blocks that a person gives other values than the file does."""

import pytest
from slx_models import BRICK, RIGID_TRANSFORM, WORLD
from slx_writer import ModelBuilder, mask_text, read_understood

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model


@pytest.fixture
def path(tmp_path):
    """Two gains of one name, one of them in a masked subsystem; and a brick of 2 000 g."""
    builder = ModelBuilder()
    leg = builder.add_block("SubSystem", "Leg")
    builder.add_block("Gain", "K", {"Gain": "2"}, system=leg)
    arm = builder.add_block("SubSystem", "Arm")
    builder.blocks[arm].mask = mask_text({"L": "0.3"})
    builder.add_block("Gain", "K", {"Gain": "L"}, system=arm)
    world = builder.add_library(WORLD, "World")
    link = builder.add_library(
        BRICK, "Link 1", {"Mass": "2000", "MassUnits": "g", "InertiaType": "CalculateFromGeometry"}
    )
    shift = builder.add_library(
        RIGID_TRANSFORM, "Shift", {"TranslationMethod": "Cartesian", "BasedOn": "x"}
    )
    builder.physical(f"{world}#rconn:1", f"{shift}#lconn:1")
    builder.physical(f"{shift}#rconn:1", f"{link}#rconn:1")
    return builder.write(tmp_path / "m.slx")


def block(model, path):
    return next(each for each in model.blocks if each.path == path)


def test_a_value_takes_the_place_of_the_files_in_the_files_unit(path):
    model = read_model(path, parameters={"Link 1:Mass": "500"})
    assert block(model, "Link 1").parameters["Mass"] == pytest.approx(0.5, rel=1e-15)


def test_a_unit_and_a_choice_are_parameters_too(path):
    given = {"Link 1:MassUnits": "kg", "Link 1:Mass": "3", "Link 1:InertiaType": "PointMass"}
    found = block(read_model(path, parameters=given), "Link 1").parameters
    assert (found["Mass"], found["InertiaType"]) == (3.0, "PointMass")


def test_what_the_file_leaves_to_its_default_can_be_set(path):
    found = block(read_model(path, parameters={"Link 1:Density": "7800"}), "Link 1").parameters
    assert found["Density"] == 7800.0


def test_a_masks_value_reaches_the_blocks_inside(path):
    model = read_model(path, parameters={"Arm:L": "2*0.35"})
    assert block(model, "Arm/K").parameters["Gain"] == pytest.approx(0.7, rel=1e-15)


def test_a_variable_of_the_value_is_found_where_others_are(path):
    model = read_model(path, parameters={"Arm/K:Gain": "3*L"})
    assert block(model, "Arm/K").parameters["Gain"] == pytest.approx(0.9, rel=1e-15)


def test_an_old_name_sets_todays_parameter(path):
    model = read_model(path, parameters={"Link 1:BrickDimensionUnits": "mm"})
    assert block(model, "Link 1").parameters["BrickDimensions"] == pytest.approx([1e-3] * 3)


def test_the_file_itself_says_the_rest(path):
    untouched = read_understood(path)
    model = read_model(path, parameters={"Arm:L": "1"})
    assert block(model, "Link 1").parameters["Mass"] == 2.0
    assert block(untouched, "Arm/K").parameters["Gain"] == 0.3


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Link 1:mas", "block 'Link 1' .* has no parameter 'mas'.*did you mean Mass"),
        ("Link 1:Colour of it", "has no parameter 'Colour of it'.*it has "),
        ("Link 2:Mass", "there is no block 'Link 2' with a parameter to set.*did you mean Link 1"),
        ("K:Gain", "2 blocks are called 'K': 'Leg/K', 'Arm/K': write the path of the one"),
        (":Gain", "there is no block ''"),
    ],
)
def test_what_is_not_there_is_told(path, name, said):
    with pytest.raises(InvalidValueError, match=said):
        read_model(path, parameters={name: "1"})


def test_a_text_without_a_value_is_told_with_its_parameter(path):
    model = read_model(path, parameters={"Leg/K:Gain": "2*nobody"})
    with pytest.raises(InvalidValueError, match=r"'K' .*parameter Gain is '2\*nobody'"):
        block(model, "Leg/K").parameters["Gain"]
