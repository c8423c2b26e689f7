"""The page that lists all blocks is the one that is written now, and says what happens."""

from pathlib import Path

import pytest
from mechanism_models import MechanismBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import MULTIBODY
from drake_leg.simulink.supported import LEFT_OUT, REFUSED, in_mechanism, page

PAGE = Path(__file__).parents[2] / "docs" / "blocks.md"


def test_the_page_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == page()


@pytest.mark.parametrize("kind", MULTIBODY)
def test_what_the_page_says_of_a_block_is_so(tmp_path, kind):
    built = MechanismBuilder()
    built.joint("Revolute", "Pivot")
    built.body("Spherical Solid", "Ball")
    built.body(kind, "It")
    built.meet("Pivot", "Ball")
    # A frame on either side, so that the block is at one, whatever its ports.
    built.transform("Left")
    built.transform("Right")
    built.meet("World", "Left lconn:1", "Right lconn:1", "Pivot lconn:1")
    built.meet("Left", "It lconn:1")
    built.meet("Right", "It rconn:1")
    error, found = outcome(built, tmp_path)
    said = in_mechanism(kind)
    assert ("not built" in error) == (said == REFUSED)
    if found is None:
        assert "'It'" in error
    else:
        assert (kind in found.connections.left_out) == (said == LEFT_OUT)


def outcome(built, folder):
    try:
        return "", built.mechanism(folder)
    except InvalidValueError as error:
        return str(error), None
