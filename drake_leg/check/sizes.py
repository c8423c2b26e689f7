"""Lengths that are too long for a robot: millimetres in the place of metres."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from drake_leg.check.findings import Finding
from drake_leg.check.slips import LONG
from drake_leg.robot import Link, Robot


def lint_sizes(robot: Robot) -> Iterator[Finding]:
    """Look for links of more than 10 m; the table's own lengths are the table linter's.

    Parameters
    ----------
    robot : Robot
        Any robot.

    Yields
    ------
    Finding
        Warnings.
    """
    for index, segment in enumerate(robot.segments, start=1):
        if segment.link is None:
            continue
        for what, value in _lengths(segment.link):
            if abs(value) >= LONG:
                yield Finding(
                    place=f"row {index}",
                    fault=f"{what} is {value:g} m",
                    remedy=f"write {value / 1000:g} if it is {value:g} mm",
                    severity="warning",
                )


def _lengths(link: Link) -> Iterator[tuple[str, float]]:
    """List the lengths of a link with their names in a robot file."""
    if link.solid is not None:
        shape = link.solid.shape
        yield from ((f"the solid's {f.name}", getattr(shape, f.name)) for f in fields(shape))
        yield from (("the solid's centre", value) for value in link.solid.centre)
    if link.inertial is not None:
        yield from (("the centre of mass", value) for value in link.inertial.centre)
    yield from (("the link's end", value) for value in link.end)
