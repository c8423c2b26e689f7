"""Geometry that every picture must keep, and the pictures of the reports' runs."""

from functools import cache
from itertools import pairwise

import pytest

from drake_leg.pictures.svg import Box
from drake_leg.runs.catalogue import RUNS

LEAST_DISTANCE = 5.0  # [px], between parallel lines of different nets


@pytest.fixture(scope="session")
def run_diagram():
    """The live diagram of a run, as it is by default."""

    @cache
    def build(name, **options):
        kind = RUNS[name]
        return kind.diagram(kind.options(**options))[0]

    return build


@pytest.fixture(scope="session")
def require_clean():
    """Refuse a layout in which anything hides anything else, or a wire ends in the wrong place."""

    def check(layout):
        _require_ends(layout)
        _require_free_blocks(layout)
        _require_free_texts(layout)
        _require_nets_apart(layout)

    return check


def segments(points):
    return list(pairwise(points))


def _bar(start, end, margin=0.0):
    (x1, y1), (x2, y2) = start, end
    return Box(
        min(x1, x2) - margin,
        min(y1, y2) - margin,
        abs(x2 - x1) + 2 * margin,
        abs(y2 - y1) + 2 * margin,
    )


def _overlap(a, b, margin=0.0):
    """Whether two rectangles have more than an edge in common, or are nearer than a margin."""
    return (
        a.x < b.right + margin
        and b.x < a.right + margin
        and a.y < b.bottom + margin
        and b.y < a.bottom + margin
    )


def _require_ends(layout):
    for route in layout.routes:
        assert route.points[0] == layout.outputs[route.source]
        assert route.points[-1] == layout.inputs[route.target]
        assert route.drawn[-1] == route.points[-1]
        for (x1, y1), (x2, y2) in segments(route.points):
            assert x1 == x2 or y1 == y2
    for (block, _), (x, y) in layout.inputs.items():
        box = layout.boxes[block]
        assert x == pytest.approx(box.x, abs=1e-9)
        assert box.y <= y <= box.bottom
    for (block, _), (x, y) in layout.outputs.items():
        box = layout.boxes[block]
        assert x == pytest.approx(box.right, abs=1e-9)
        assert box.y <= y <= box.bottom


def _require_free_blocks(layout):
    for index, box in enumerate(layout.boxes):
        assert box.x >= 0.0
        assert box.y >= 0.0
        assert box.right <= layout.width + 1e-6
        assert box.bottom <= layout.height + 1e-6
        for other in layout.boxes[index + 1 :]:
            assert not _overlap(box, other, margin=6.0)
        for route in layout.routes:
            for start, end in segments(route.points):
                assert not _overlap(_bar(start, end), box, margin=-1e-6)


def _require_free_texts(layout):
    texts = [*layout.labels, *(line for lines in layout.captions for line in lines)]
    wires = [_bar(*piece) for route in layout.routes for piece in segments(route.points)]
    for index, label in enumerate(texts):
        for other in texts[index + 1 :]:
            assert not _overlap(label.box, other.box), (label, other)
        for box in [*layout.boxes, *wires]:
            assert not _overlap(label.box, box), (label, box)


def _require_nets_apart(layout):
    """Lines of different nets may cross, and do nothing else."""
    pieces = [(r.net, piece) for r in layout.routes for piece in segments(r.points)]
    for index, (net, piece) in enumerate(pieces):
        for other_net, other in pieces[index + 1 :]:
            if net != other_net and _direction(piece) == _direction(other):
                assert not _overlap(_bar(*piece), _bar(*other), margin=LEAST_DISTANCE)


def _direction(piece):
    (_, y1), (_, y2) = piece
    return y1 == y2
