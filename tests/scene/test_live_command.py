import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.scene.live import action_of, numbers_of, tab_of


def test_a_command_says_what_to_do():
    assert action_of({"do": "halt"}, ("halt", "quit")) == "halt"
    for wanted in ("jump", None, 3, ["halt"], {}):
        with pytest.raises(InvalidValueError, match='"do" must be one of halt, quit'):
            action_of({"do": wanted}, ("halt", "quit"))


def test_numbers_are_taken_exactly():
    assert numbers_of({"v": [1, -2.345678901234, 0]}, "v", 3) == [1.0, -2.345678901234, 0.0]


@pytest.mark.parametrize(
    "values",
    [None, 3.0, "1,2", [1.0], [1.0, 2.0, 3.0], [1.0, math.nan], [1.0, math.inf], [1.0, True],
     [1.0, "2"], [1.0, None], [1.0, 10**400], {"0": 1.0, "1": 2.0}],
)  # fmt: skip
def test_what_are_no_numbers_is_refused(values):
    with pytest.raises(InvalidValueError, match='"v" must be a list of 2 finite numbers'):
        numbers_of({"v": values}, "v", 2)


@pytest.mark.parametrize("tab", [None, "", 3, "x" * 41, ["a"]])
def test_a_page_has_a_short_name(tab):
    assert tab_of({"tab": "abc"}) == "abc"
    with pytest.raises(InvalidValueError, match='"tab" must be a name'):
        tab_of({"tab": tab})
