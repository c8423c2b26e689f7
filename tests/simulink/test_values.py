"""Numbers out of parameters of all kinds."""

import pytest

from drake_leg.simulink.model import Block, invalid_parameter, number, vector


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (2.0, (2.0,)),
        (3, (3.0,)),
        ((1.0, 2.0), (1.0, 2.0)),
        (((1.0, 2.0), (3.0, 4.0)), (1.0, 2.0, 3.0, 4.0)),
        ((), ()),
        ("two", ()),
        (None, ()),
    ],
)
def test_vector(value, expected):
    assert vector(value) == expected


@pytest.mark.parametrize("value", [(1.0, 2.0), (), "two", None])
def test_what_is_no_one_number_is_the_default(value):
    assert (number(value), number(value, 7.0)) == (0.0, 7.0)


@pytest.mark.parametrize("value", [5.0, (5.0,), ((5.0,),)])
def test_one_number(value):
    assert number(value, 7.0) == 5.0


def test_complaint_names_block_parameter_and_value():
    block = Block(
        sid="12:3", name="Bar", type="Gain", source="", system="", parameters={"Gain": "k"}
    )
    error = invalid_parameter(block, "Gain", "it must be one number")
    assert str(error) == "the block 'Bar' (SID 12:3) has Gain 'k'; it must be one number"
