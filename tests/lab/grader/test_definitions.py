"""A print's symbols: each has one meaning."""

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.robot.robots import LEG_B


def graded(**settings):
    matrix = {"name": "P01", "entries": ["0", "0", "0"]}
    document = {"lengths": "mm", "angles": "deg", "matrix": [matrix], **settings}
    return grade(LEG_B, printed_of_document(document, "print"))


@pytest.mark.parametrize(
    "settings",
    [
        {"symbols": {"L": 50, "l": 100}},
        {"symbols": {"L_1": 50, "L1": 100}},
        {"symbols": {"L": 50}, "where": {"l": "2*50"}},
        {"where": {"A": "cos(q1)", "a": "sin(q1)"}},
    ],
)
def test_two_symbols_of_one_name_are_refused(settings):
    with pytest.raises(InvalidValueError, match="are read as one symbol"):
        graded(**settings)


def test_one_symbol_with_two_values_is_refused():
    with pytest.raises(InvalidValueError, match="'L1' is given as 50 and as 60; define it once"):
        graded(symbols={"L1": 50}, where={"L1": "60"})


def test_one_value_may_be_said_twice():
    assert graded(symbols={"L1": 50, "L_1": 50}, where={"L1": "50"}) == []


def test_cosd_of_a_joints_angle_is_its_cosine():
    entries = (
        "cosd(q2), -sind(q2), 0, 50; 0, 0, -1, 0; cosd(q2 - 90), -sind(q2 - 90), 0, 0; 0, 0, 0, 1"
    )
    assert graded(matrix=[{"name": "T12", "entries": entries}]) == []
    assert graded(angles="rad", matrix=[{"name": "T12", "entries": entries}])
