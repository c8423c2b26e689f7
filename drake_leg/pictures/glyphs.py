"""Draws the blocks of a picture, each with its glyph, as SVG."""

from __future__ import annotations

import math
from collections.abc import Callable

from drake_leg.pictures.svg import LINE, SMALL, Box, DrawnBlock, element, line, polyline, text_at

Glyph = Callable[[DrawnBlock, Box], str]


def draw_block(block: DrawnBlock, box: Box) -> str:
    """Draw a block without its caption and its wires."""
    return GLYPHS[block.glyph](block, box)


def _frame(box: Box, classes: str = "face", rx: float = 0.0) -> str:
    return element(
        "rect", classes=classes, x=box.x, y=box.y, width=box.width, height=box.height, rx=rx
    )


def _box(block: DrawnBlock, box: Box) -> str:
    return _frame(box, rx=2) + _inside(block, box)


def _plant(block: DrawnBlock, box: Box) -> str:
    return _frame(box, "face strong", rx=6) + _inside(block, box)


def _converter(block: DrawnBlock, box: Box) -> str:
    """Draw a diagonal with the input's kind above it and the output's below it."""
    slope = polyline([(box.x, box.bottom), (box.right, box.y)], "thin")
    texts = [
        text_at(text, box.x + share * box.width, box.y + share * box.height, 3.5, size=SMALL)
        for text, share in zip(block.text, (0.27, 0.73), strict=False)
    ]
    return _frame(box) + slope + "".join(texts)


def _inside(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    top = y - LINE * (len(block.text) - 1) / 2
    return "".join(
        text_at(text, x, top + LINE * row, baseline=4.0) for row, text in enumerate(block.text)
    )


def _sine(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    wide, high = 11.0, 10.0
    points = [
        (x - wide + 2 * wide * k / 24, y - high * math.sin(2 * math.pi * k / 24)) for k in range(25)
    ]
    axes = line(x - wide - 3, y, x + wide + 3, y, "thin")
    axes += line(x - wide, y - high - 3, x - wide, y + high + 3, "thin")
    return _frame(box) + axes + polyline(points, "stroke")


def _gain(block: DrawnBlock, box: Box) -> str:
    y = box.middle[1]
    corners = f"{box.x:.1f},{box.y:.1f} {box.right:.1f},{y:.1f} {box.x:.1f},{box.bottom:.1f}"
    inside = text_at(block.text[0], box.x + 0.36 * box.width, y, baseline=4.0) if block.text else ""
    return element("polygon", classes="face", points=corners) + inside


def _integrator(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    return (
        _frame(box)
        + text_at("1", x, y - 8, baseline=4.0, size=13.0)
        + line(x - 7, y, x + 7, y, "stroke")
        + text_at("s", x, y + 9, baseline=4.0, size=13.0)
    )


def _bar(block: DrawnBlock, box: Box) -> str:
    return _frame(box, "bar")


def _scope(block: DrawnBlock, box: Box) -> str:
    screen = Box(box.x + 5, box.y + 5, box.width - 10, box.height - 14)
    y = screen.middle[1]
    points = [
        (screen.x + 3 + (screen.width - 6) * k / 16, y - 6 * math.sin(2 * math.pi * k / 16))
        for k in range(17)
    ]
    foot = line(box.x + 8, box.bottom - 4.5, box.right - 8, box.bottom - 4.5, "thin")
    return _frame(box) + _frame(screen, "screen") + polyline(points, "trace") + foot


def _triad(x: float, y: float, size: float) -> str:
    """Three axes: x to the left below, y to the right, z up."""
    return (
        line(x, y, x, y - size, "stroke")
        + line(x, y, x + size, y, "stroke")
        + line(x, y, x - 0.6 * size, y + 0.6 * size, "stroke")
        + element("circle", classes="dot", cx=x, cy=y, r=1.8)
    )


def _world(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    ground = line(x - 13, y + 14, x + 13, y + 14, "stroke")
    return _frame(box) + _triad(x - 2, y + 3, 13.0) + ground


def _transform(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    arc = f"M{x - 11:.1f} {y - 8:.1f} q10.5 -11 21 -1 m-5.5 -0.5 l5.5 0.5 l0.5 -5.5"
    arrow = element("path", classes="thin", d=arc)
    return _frame(box) + _triad(x - 11, y + 9, 9.0) + _triad(x + 10, y + 9, 9.0) + arrow


def _revolute(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    ring = element("circle", classes="stroke", cx=x, cy=y, r=9)
    pin = element("circle", classes="dot", cx=x, cy=y, r=2.4)
    arms = line(box.x, y, x - 9, y, "stroke") + line(x + 9, y, box.right, y, "stroke")
    arc = f"M{x - 11:.1f} {y - 9:.1f} a14 14 0 0 1 20 -1 m-5.5 0 l5.5 0 l0 -5.5"
    turn = element("path", classes="thin", d=arc)
    return _frame(box) + ring + pin + arms + turn


def _prismatic(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    sleeve = element("rect", classes="stroke", x=x - 8, y=y - 7, width=16, height=14)
    rod = line(box.x, y, box.right, y, "stroke")
    tips = f"M{x - 12:.1f} {y - 13:.1f} h24 m-4 -3 l4 3 l-4 3"
    arrow = element("path", classes="thin", d=tips)
    return _frame(box) + sleeve + rod + arrow


def _six_dof(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    return _frame(box) + _triad(x - 1, y + 1, 13.0) + text_at("6", box.right - 8, box.y + 9, 4.0)


def _brick(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    left, right, top, bottom, skew = x - 15, x + 9, y - 4, y + 10, 6.0
    front = element("rect", classes="body", x=left, y=top, width=right - left, height=14)
    lid = polyline(
        [(left, top), (left + skew, top - skew), (right + skew, top - skew), (right, top)], "stroke"
    )
    side = polyline(
        [(right + skew, top - skew), (right + skew, bottom - skew), (right, bottom)], "stroke"
    )
    return _frame(box) + front + lid + side


def _cylinder(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    body = element(
        "path",
        classes="body",
        d=f"M{x - 8:.1f} {y - 9:.1f} v18 a8 3.5 0 0 0 16 0 v-18",
    )
    return _frame(box) + body + element("ellipse", classes="body", cx=x, cy=y - 9, rx=8, ry=3.5)


def _sphere(block: DrawnBlock, box: Box) -> str:
    x, y = box.middle
    ball = element("circle", classes="body", cx=x, cy=y, r=12)
    belt = element("path", classes="thin", d=f"M{x - 12:.1f} {y:.1f} a12 4 0 0 0 24 0")
    return _frame(box) + ball + belt


def _connection(block: DrawnBlock, box: Box) -> str:
    return _frame(box, rx=box.height / 2) + _inside(block, box)


GLYPHS: dict[str, Glyph] = {
    "box": _box,
    "plant": _plant,
    "converter": _converter,
    "sine": _sine,
    "constant": _box,
    "gain": _gain,
    "integrator": _integrator,
    "mux": _bar,
    "demux": _bar,
    "scope": _scope,
    "world": _world,
    "transform": _transform,
    "revolute": _revolute,
    "prismatic": _prismatic,
    "six_dof": _six_dof,
    "configuration": _box,
    "brick": _brick,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "solid": _box,
    "sum": _box,
    "connection": _connection,
}
