"""The palette is Okabe and Ito's, and codes and numbers say the same colors."""

import matplotlib as mpl
import pytest

from drake_leg import colours
from drake_leg.colours import rgb
from drake_leg.robot.robot import LINK_COLOURS

PRINTED = {  # Okabe and Ito's table, red, green and blue in 0...255
    "ORANGE": (230, 159, 0),
    "SKY_BLUE": (86, 180, 233),
    "GREEN": (0, 158, 115),
    "YELLOW": (240, 228, 66),
    "BLUE": (0, 114, 178),
    "VERMILLION": (213, 94, 0),
    "REDDISH_PURPLE": (204, 121, 167),
}


@pytest.mark.parametrize("name", PRINTED)
def test_palette_is_the_printed_one(name):
    code = getattr(colours, name)
    assert mpl.colors.to_rgb(code) == tuple(part / 255 for part in PRINTED[name])
    assert rgb(code) == tuple(round(part / 255, 3) for part in PRINTED[name])


def test_ends_of_the_scale():
    assert rgb("#ff0000") == (1.0, 0.0, 0.0)
    assert rgb("#000000") == (0.0, 0.0, 0.0)


def test_seven_links_have_the_seven_colours():
    assert sorted(LINK_COLOURS) == sorted(rgb(getattr(colours, name)) for name in PRINTED)
