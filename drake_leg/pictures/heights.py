"""Heights of blocks and wires, by a linear program that charges bends.

After Gansner, Koutsofios, North and Vo, "A technique for drawing directed graphs", 1993, section 4:
bends are charged by their height, so that most wires become straight. Ports of bars and boxes slide
along their sides.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array

from drake_leg.pictures.columns import Columns, End
from drake_leg.pictures.order import Order
from drake_leg.pictures.svg import LINE, PORT_PAD, PORT_PITCH, Picture, size_of

GAP = 16.0  # [px], between blocks, their captions included
LANE_GAP = 13.0  # [px], to a lane
# Cost of a pixel: of a bend, by what it joins; of a block's growth; of the picture's height.
OF_BLOCKS, OF_LANE_AND_BLOCK, OF_LANES = 3.0, 4.0, 8.0
OF_SINK, OF_SOURCE, BACKWARD = 0.3, 1.3, 0.1  # times that, at ends and beginnings, and of a loop
OF_BAR_END = 0.8  # the same, to a bar
BARS = ("mux", "demux")
OF_GROWTH, OF_BAR, OF_HEIGHT = 1.5, 0.2, 0.2
Terms = dict[int, float]


@dataclass(frozen=True)
class Heights:
    """Vertical positions of all spots and of all ends of nets [px]."""

    top: tuple[float, ...]  # of every spot
    bottom: tuple[float, ...]  # without the caption
    ends: Mapping[End, float]
    total: float


def caption_height(lines: int) -> float:
    """Return the height of a block's caption [px]."""
    return LINE * lines + 3.0 if lines else 0.0


class Programme:
    """The linear program of one picture: variables, constraints and costs."""

    def __init__(self, picture: Picture, columns: Columns, order: Order) -> None:
        self.columns = columns
        self.costs: list[float] = []
        self.rows: list[tuple[Terms, float]] = []  # sum of the terms is at least the number
        self.end: dict[End, int] = {}
        self.total = self._variable(OF_HEIGHT)
        self.top: list[int] = []
        self.bottom: list[int] = []
        self.margins: list[float] = []
        for number, spot in enumerate(columns.spots):
            if spot.block < 0:
                self._add_lane(number)
            else:
                self._add_block(picture, order, number, spot.block)
        for members in order.members:
            self._stack(members)
        self._charge_bends(picture)

    def _variable(self, cost: float = 0.0) -> int:
        self.costs.append(cost)
        return len(self.costs) - 1

    def _at_least(self, high: int, low: int, distance: float) -> None:
        """Require ``high >= low + distance``."""
        self.rows.append(({high: 1.0, low: -1.0}, distance))

    def _add_lane(self, spot: int) -> None:
        y = self._variable()
        self.top.append(y)
        self.bottom.append(y)
        self.margins.append(0.0)
        self.end[End(spot, True, 0)] = self.end[End(spot, False, 0)] = y

    def _add_block(self, picture: Picture, order: Order, spot: int, index: int) -> None:
        block = picture.blocks[index]
        size = size_of(block)
        growth = OF_BAR if block.glyph in BARS else OF_GROWTH
        top, bottom = self._variable(-growth), self._variable(growth)
        self.top.append(top)
        self.bottom.append(bottom)
        self.margins.append(caption_height(len(block.caption)))
        self._at_least(bottom, top, size.height)
        if not size.elastic:
            self._at_least(top, bottom, -size.height)
        for left, ports in ((False, order.inputs[spot]), (True, order.outputs[spot])):
            ends = [self._variable() for _ in ports]
            self.end.update({End(spot, left, port): y for port, y in zip(ports, ends, strict=True)})
            if len(ends) == 1 and size.centered:
                for sign in (1.0, -1.0):
                    self.rows.append(({ends[0]: 2 * sign, top: -sign, bottom: -sign}, 0.0))
                continue
            pad = min(PORT_PAD, (size.height - PORT_PITCH * (len(ends) - 1)) / 2)
            for upper, lower in zip([top, *ends], [*ends, bottom], strict=True):
                inner = upper != top and lower != bottom
                if ends:
                    self._at_least(lower, upper, PORT_PITCH if inner else pad)

    def _stack(self, members: list[int]) -> None:
        """Keep a column's order, inside the picture."""
        spots = self.columns.spots
        if not members:
            return
        self.rows.append(({self.top[members[0]]: 1.0}, 0.0))
        for upper, lower in pairwise(members):
            blocks = (spots[upper].block >= 0) + (spots[lower].block >= 0)
            gap = GAP if blocks == 2 else LANE_GAP
            self._at_least(self.top[lower], self.bottom[upper], self.margins[upper] + gap)
        self._at_least(self.total, self.bottom[members[-1]], self.margins[members[-1]])

    def _charge_bends(self, picture: Picture) -> None:
        spots = self.columns.spots
        for track in self.columns.tracks:
            first = track.ends[0]
            for other in track.ends[1:]:
                lanes = (spots[first.spot].block < 0) + (spots[other.spot].block < 0)
                cost = (OF_BLOCKS, OF_LANE_AND_BLOCK, OF_LANES)[lanes]
                if spots[first.spot].backward or spots[other.spot].backward:
                    cost *= BACKWARD
                cost *= self._share(picture, spots[first.spot].block, spots[other.spot].block)
                bend = self._variable(cost)
                a, b = self.end[first], self.end[other]
                for sign in (1.0, -1.0):
                    if a != b:
                        self.rows.append(({bend: 1.0, a: sign, b: -sign}, 0.0))

    @staticmethod
    def _share(picture: Picture, source: int, target: int) -> float:
        """Scale a bend's cost: wires into scopes and bars bend first, those from sources last."""
        block = picture.blocks[target]
        ends = target >= 0 and not block.outputs and len(block.inputs) == 1
        begins = source >= 0 and not picture.blocks[source].inputs
        bar = target >= 0 and block.glyph in BARS
        share = (OF_SINK if ends else 1.0) * (OF_SOURCE if begins else 1.0)
        return share * (OF_BAR_END if bar else 1.0)

    def solve(self, apart: Iterable[tuple[End, End, float]]) -> Heights:
        """Place blocks, lanes and ports.

        For each (first, second, distance) in ``apart`` the first end is at least that far below
        the second [px].
        """
        rows = [*self.rows]
        for low, high, distance in apart:
            rows.append(({self.end[low]: 1.0, self.end[high]: -1.0}, distance))
        entries = [(r, c, v) for r, (terms, _) in enumerate(rows) for c, v in terms.items()]
        row, column, value = (np.array(part) for part in zip(*entries, strict=True))
        matrix = coo_array((value, (row, column)), shape=(len(rows), len(self.costs))).tocsr()
        found = linprog(
            self.costs,
            A_ub=-matrix,
            b_ub=[-least for _, least in rows],
            bounds=(0, None),
            method="highs-ds",
        )
        y = np.round(found.x, 3).tolist()
        return Heights(
            top=tuple(y[v] for v in self.top),
            bottom=tuple(y[v] for v in self.bottom),
            ends={end: y[v] for end, v in self.end.items()},
            total=y[self.total],
        )
