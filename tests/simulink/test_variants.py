"""Variant subsystems, whose choices have ports of like names."""

import pytest
from slx_models import WORLD
from slx_writer import ModelBuilder, mask_text, read_understood

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.lacks import lacks_of
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.wiring import flatten


def variant_model(texts, conditions=("Soft", "Stiff")):
    """Draw clock -> one of two gains, 1 and 2, -> scope; and a world frame at a solid in each."""
    builder = ModelBuilder()
    clock, scope = builder.add_block("Clock", "Clock"), builder.add_block("Scope", "Scope")
    world = builder.add_library(WORLD, "World")
    outer = builder.add_block("SubSystem", "Law", {"Variant": "on", **texts})
    builder.connect(clock, f"{outer}#in:1")
    builder.connect(f"{outer}#out:1", scope)
    builder.physical(f"{world}#rconn:1", f"{outer}#lconn:1")
    ports_in(builder, outer)
    for number, condition in enumerate(conditions, start=1):
        choice = builder.add_block(
            "SubSystem", f"Choice {number}", {"VariantControl": condition}, system=outer
        )
        entry, leaving, frame = ports_in(builder, choice)
        gain = builder.add_block("Gain", f"K{number}", {"Gain": str(number)}, system=choice)
        solid = builder.add_library("sm_lib/Body Elements/Inertia", f"I{number}", system=choice)
        builder.connect(entry, gain)
        builder.connect(gain, leaving)
        builder.physical(f"{frame}#rconn:1", f"{solid}#rconn:1")
    return builder


def ports_in(builder, system):
    return (
        builder.add_block("Inport", "u", {"Port": "1"}, system=system),
        builder.add_block("Outport", "y", {"Port": "1"}, system=system),
        builder.add_block("PMIOPort", "B", {"Port": "1", "Side": "Left"}, system=system),
    )


@pytest.fixture
def path(tmp_path):
    return tmp_path / "m.slx"


def wired(model):
    """Names of the leaf blocks that wires and frames join."""
    flat = flatten(model)
    names = {block.sid: block.name for block in flat.blocks}
    ends = [(wire.source, wire.target) for wire in flat.wires] + list(flat.nodes)
    return {" ".join(sorted(names[port.split("#")[0]] for port in end)) for end in ends}


CHOSEN = [
    {"Clock K1", "K1 Scope", "I1 World"},
    {"Clock K2", "K2 Scope", "I2 World"},
]


@pytest.mark.parametrize(
    ("texts", "conditions", "wanted", "number"),
    [
        ({"VariantControlMode": "label", "LabelModeActiveChoice": "Stiff"}, None, {}, 2),
        ({"OverrideUsingVariant": "Soft"}, None, {}, 1),
        ({"LabelModeActiveChoice": "Soft"}, None, {"Law": "Stiff"}, 2),
        ({"LabelModeActiveChoice": "Soft"}, None, {"Law": "Choice 2"}, 2),
        ({"VariantControlMode": "expression"}, ("1 == 2", "1 == 1"), {}, 2),
        ({"VariantControlMode": "expression"}, ("(default)", "1 == 2"), {}, 1),
        ({"VariantControlMode": "expression"}, ("% 1 == 1", "1 == 1"), {}, 2),
    ],
)
def test_one_choice_takes_the_place(path, texts, conditions, wanted, number):
    builder = variant_model(texts, conditions or ("Soft", "Stiff"))
    model = read_model(builder.write(path), variants=wanted)
    assert wired(model) == CHOSEN[number - 1]
    assert not lacks_of(model)


@pytest.mark.parametrize("name", ["OverrideUsingVariant", "LabelModeActiveChoice"])
def test_a_mask_chooses_by_either_name_of_the_setting(path, name):
    builder = variant_model({"LabelModeActiveChoice": "Soft"}, ("Soft", "Stiff"))
    outer = builder.add_block("SubSystem", "Around")
    builder.blocks[builder.sid("Law")].system = outer
    code = f"set_param([gcb '/Law'], '{name}', 'Stiff')"
    builder.blocks[outer].mask = mask_text({"unused": "1"}, code)
    names = {block.name for block in read_model(builder.write(path)).blocks}
    assert "K2" in names
    assert "K1" not in names


@pytest.mark.parametrize(
    ("texts", "conditions", "reason"),
    [
        ({"VariantControlMode": "expression"}, ("kind == 1", "kind == 2"), "'kind' is not a known"),
        ({"VariantControlMode": "expression"}, ("1 == 2", "1 == 3"), "no condition of its choices"),
        ({"LabelModeActiveChoice": "Hard"}, ("Soft", "Stiff"), "none of its choices is 'Hard'"),
    ],
)
def test_a_choice_that_is_not_known_is_a_lack(path, texts, conditions, reason):
    builder = variant_model(texts, conditions)
    with pytest.raises(InvalidValueError, match=rf"'Law' \(SID 4\) is a variant.*{reason}"):
        read_understood(builder.write(path))
    assert not any(block.name.startswith("K") for block in read_model(path).blocks)


@pytest.mark.parametrize(
    ("wanted", "sentence"),
    [
        ({"law": "Stiff"}, "no variant subsystem 'law': did you mean Law"),
        ({"Law": "Hard"}, "has no choice 'Hard': choose one of 'Choice 1', 'Choice 2'"),
    ],
)
def test_a_wanted_choice_must_exist(path, wanted, sentence):
    builder = variant_model({"LabelModeActiveChoice": "Soft"})
    with pytest.raises(InvalidValueError, match=sentence):
        read_model(builder.write(path), variants=wanted)
