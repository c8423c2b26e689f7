"""Any picture, also one that nobody would draw, is laid out cleanly."""

import pytest
from work import calls

from drake_leg.errors import InvalidValueError
from drake_leg.pictures.columns import columns_of
from drake_leg.pictures.layout import lay_out
from drake_leg.pictures.order import _Search, order_of
from drake_leg.pictures.parts import ROW, lay_out_parts
from drake_leg.pictures.routing import length
from drake_leg.pictures.svg import DrawnBlock, Net, Picture

GLYPHS = ("box", "gain", "integrator", "scope", "plant", "mux")


def chance_picture(rng):
    """Blocks with chance ports, inputs wired to chance outputs: loops and all."""
    blocks = []
    for number in range(rng.integers(2, 14)):
        inputs, outputs = rng.integers(0, 4), rng.integers(0, 4)
        glyph = GLYPHS[rng.integers(len(GLYPHS))]
        blocks.append(
            DrawnBlock(
                name=f"block {number}",
                caption=("some words",) * rng.integers(0, 4),
                glyph=glyph,
                inputs=("in",) * inputs,
                outputs=("out",) * outputs,
                loose=bool(rng.integers(2)),
            )
        )
    return Picture(title="chance", blocks=tuple(blocks), nets=_chance_nets(rng, blocks))


def _chance_nets(rng, blocks):
    sources = [(b, p) for b, block in enumerate(blocks) for p in range(len(block.outputs))]
    targets = {source: [] for source in sources}
    for b, block in enumerate(blocks):
        for port in range(len(block.inputs)):
            if sources and rng.random() < 0.8:
                targets[sources[rng.integers(len(sources))]].append((b, port))
    return tuple(
        Net(source=source, targets=tuple(ends), label="name" * int(rng.integers(2)))
        for source, ends in targets.items()
        if ends
    )


def chain(count, *more):
    """Boxes in a row, and more wires: from block to block."""
    wires = [*((i, i + 1) for i in range(count - 1)), *more]
    fed = [sum(target == b for _, target in wires) for b in range(count)]
    blocks = tuple(
        DrawnBlock(
            name=f"b{b}", inputs=("u",) * fed[b], outputs=("y",) * any(s == b for s, _ in wires)
        )
        for b in range(count)
    )
    place = [0] * count
    targets = {}
    for source, target in wires:
        targets.setdefault(source, []).append((target, place[target]))
        place[target] += 1
    nets = tuple(Net(source=(s, 0), targets=tuple(t)) for s, t in targets.items())
    return Picture(title="chain", blocks=blocks, nets=nets)


@pytest.mark.parametrize(
    "seed", [*range(10), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(10, 40))]
)
def test_a_chance_picture_is_clean(rng, require_clean, seed):
    rng = type(rng)(type(rng.bit_generator)(seed))
    require_clean(lay_out(chance_picture(rng)))


def test_a_chain_is_straight(require_clean):
    layout = lay_out(chain(6))
    require_clean(layout)
    assert all(len(route.points) == 2 for route in layout.routes)
    assert [box.x for box in layout.boxes] == sorted(box.x for box in layout.boxes)


def test_a_loop_goes_below_the_blocks(require_clean):
    layout = lay_out(chain(4, (3, 1)))
    require_clean(layout)
    back = next(r for r in layout.routes if r.source[0] == 3)
    lowest = max(y for _, y in back.points)
    assert lowest > max(box.bottom for box in layout.boxes)


def test_a_block_wired_to_itself_is_clean(require_clean):
    require_clean(lay_out(chain(3, (1, 1))))


def test_columns_follow_the_flow_but_for_loops():
    columns = columns_of(chain(5, (4, 0), (1, 4)))
    place = [s.column for s in columns.spots if s.block >= 0]
    assert place == [0, 1, 2, 3, 4]


def test_a_source_stands_beside_what_it_feeds():
    picture = chain(5)
    constant = DrawnBlock(name="constant", outputs=("y",))
    last = DrawnBlock(name="b4", inputs=("u", "u"))
    blocks = (*picture.blocks[:4], last, constant)
    nets = (*picture.nets, Net(source=(5, 0), targets=((4, 1),)))
    columns = columns_of(Picture(title="", blocks=blocks, nets=nets))
    place = [s.column for s in columns.spots if s.block >= 0]
    assert place == [0, 1, 2, 3, 4, 3]


def test_every_piece_of_a_net_is_drawn_once():
    picture = chain(6, (0, 2), (0, 4), (0, 5), (5, 1))
    layout = lay_out(picture)
    for net in range(len(picture.nets)):
        routes = [r for r in layout.routes if r.net == net]
        union = {
            (axis, at, step)
            for route in routes
            for (x1, y1), (x2, y2) in zip(route.points, route.points[1:], strict=False)
            for axis, at, low, high in [
                ("y", y1, *sorted((x1, x2))) if y1 == y2 else ("x", x1, *sorted((y1, y2)))
            ]
            for step in range(round(low * 10), round(high * 10))
        }
        drawn = sum(length(route.drawn) for route in routes)
        assert drawn == pytest.approx(len(union) / 10, abs=0.5 * len(routes))


def test_layout_is_the_same_every_time(rng):
    picture = chance_picture(rng)
    assert lay_out(picture) == lay_out(picture)


def test_two_blocks_of_one_name_are_refused():
    block = DrawnBlock(name="twin")
    with pytest.raises(InvalidValueError, match="twin"):
        Picture(title="", blocks=(block, block), nets=())


def test_an_input_takes_one_wire():
    blocks = (DrawnBlock(name="a", outputs=("", "")), DrawnBlock(name="b", inputs=("",)))
    nets = tuple(Net(source=(0, port), targets=((1, 0),)) for port in (0, 1))
    with pytest.raises(InvalidValueError, match="two wires"):
        Picture(title="", blocks=blocks, nets=nets)


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


def chance_wiring(rng, count, *, loops):
    """Blocks of two inputs, each wired to any block, or to any earlier one."""
    targets = {}
    for block in range(0 if loops else 1, count):
        for port in (0, 1):
            source = int(rng.integers(count if loops else block))
            targets.setdefault(source, []).append((block, port))
    blocks = tuple(
        DrawnBlock(name=f"b{block}", inputs=("", ""), outputs=("",)) for block in range(count)
    )
    nets = tuple(Net(source=(s, 0), targets=tuple(ends)) for s, ends in sorted(targets.items()))
    return Picture(title="chance", blocks=blocks, nets=nets)


@pytest.mark.parametrize("seed", range(4))
def test_no_block_has_a_better_place(rng, seed):
    picture = chance_picture(type(rng)(type(rng.bit_generator)(seed)))
    columns = columns_of(picture)
    order = order_of(picture, columns)
    best = _Search(picture, columns, order).total()
    for row in (*order.members, *(order.inputs[s] for s in loose_spots(picture, columns))):
        for item in list(row):
            here = row.index(item)
            for place in range(len(row)):
                row.remove(item)
                row.insert(place, item)
                assert _Search(picture, columns, order).total() >= best
            row.remove(item)
            row.insert(here, item)


def loose_spots(picture, columns):
    spots = enumerate(columns.spots)
    return [n for n, spot in spots if spot.block >= 0 and picture.blocks[spot.block].loose]


@pytest.mark.slow
@pytest.mark.parametrize("loops", [pytest.param(False, marks=pytest.mark.slow), True])
def test_a_hundred_blocks_are_laid_out(rng, loops):
    assert len(lay_out(chance_wiring(rng, 100, loops=loops)).boxes) == 100


@pytest.mark.slow
@pytest.mark.parametrize("loops", [False, True])
def test_the_work_of_a_layout_grows_less_than_the_cube(rng, loops):
    def work(count):
        picture = chance_wiring(rng, count, loops=loops)
        return calls(lambda: lay_out(picture))

    assert work(120) < 3.0**3 / 2.0 * work(40)
