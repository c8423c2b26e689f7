"""A document has room for all that is drawn in it."""

import re

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from drake_leg.pictures.drawing import HEADING, MARGIN, draw
from drake_leg.pictures.svg import DrawnBlock, Picture


@pytest.mark.parametrize("title", ["a_ball_on_an_inclined_plane: signals", "summon_a_common_arm"])
def test_a_document_is_as_wide_as_its_bold_title(title):
    bold = FontProperties(family="DejaVu Sans", weight="bold")
    ends = TextPath((MARGIN, 0), title, size=HEADING, prop=bold).get_extents().x1
    svg = draw(Picture(title=title, blocks=(DrawnBlock(name="Gain"),), nets=())).svg
    assert float(re.search(r'width="([\d.]+)"', svg)[1]) >= ends + MARGIN / 2
