"""Parts that no wire joins stand apart, in rows."""

import pytest

from drake_leg.pictures.layout import ROW, lay_out, lay_out_parts
from drake_leg.pictures.svg import DrawnBlock, Net, Picture


def chains(count, length):
    """Rows of boxes, wired within each."""
    blocks = tuple(
        DrawnBlock(name=f"{row} {place}", caption=("box",), inputs=("",), outputs=("",))
        for place in range(length)
        for row in range(count)
    )
    nets = tuple(
        Net(source=(index, 0), targets=((index + count, 0),), label="s")
        for index in range(count * (length - 1))
    )
    return Picture(title="chains", blocks=blocks, nets=nets)


def test_one_part_is_laid_out_as_ever():
    picture = chains(1, 4)
    assert lay_out_parts(picture) == lay_out(picture)


@pytest.mark.parametrize("count", [2, 7, 30])
def test_parts_stand_apart(require_clean, count):
    picture = chains(count, 3)
    layout = lay_out_parts(picture)
    require_clean(layout)
    assert layout.picture is picture
    assert layout.width <= ROW
    routes = sorted(layout.routes, key=lambda route: route.net)
    nets = [(net.source, net.targets[0]) for net in picture.nets]
    assert [(route.source, route.target) for route in routes] == nets
    rows = {box.y for box in layout.boxes}
    assert (len(rows) > 1) == (count > 3)


def test_blocks_without_wires_stand_in_rows(require_clean):
    blocks = tuple(DrawnBlock(name=f"b{index}", caption=("alone",)) for index in range(20))
    layout = lay_out_parts(Picture(title="", blocks=blocks, nets=()))
    require_clean(layout)
    assert layout.boxes[1].x > layout.boxes[0].x
    assert layout.boxes[1].y == layout.boxes[0].y
