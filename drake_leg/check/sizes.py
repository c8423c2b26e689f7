"""Lengths too long for a robot, and inertias too great for a link: units that were mistaken."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields

from drake_leg.check.findings import Finding
from drake_leg.check.slips import LONG
from drake_leg.models.solids import bounding_radius
from drake_leg.robot import Link, Robot, Segment


def lint_sizes(robot: Robot) -> Iterator[Finding]:
    """Look for links of more than 10 m, and for inertias that no such link has.

    The table's own lengths are the table linter's.
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
    for index, link, size in _sized_links(robot):
        yield from _lint_inertia(index, link, size)


def _sized_links(robot: Robot) -> Iterator[tuple[int, Link, float]]:
    """List the links with mass properties of their own, and how long they are; 0: unknown."""
    following = [*robot.segments[1:], None]
    for index, (segment, after) in enumerate(zip(robot.segments, following, strict=True), start=1):
        if segment.link is not None and segment.link.inertial is not None:
            yield index, segment.link, _size(segment.link, after)


def _size(link: Link, after: Segment | None) -> float:
    """Return the greatest of what is known to be the link's: its end, the next joint, its solid."""
    sizes = [math.hypot(*link.end), 2.0 * math.hypot(*link.centre_of_mass)]
    if after is not None:
        sizes.append(math.hypot(after.row.d, after.row.r))
    if link.solid is not None:
        sizes.append(2.0 * bounding_radius(link.solid.shape))
    return max(sizes)


def _lint_inertia(index: int, link: Link, size: float) -> Iterator[Finding]:
    """Compare the radius of gyration with the link: half its length would be two masses."""
    body = link.inertial
    if body is None or size == 0.0:
        return
    radius = math.sqrt(body.principal_moments()[-1] / body.mass)
    if radius > size:
        yield Finding(
            place=f"row {index}",
            fault=f"the inertia of {link.name} has a radius of gyration of {1000 * radius:.3g} mm, "
            f"and the link is {1000 * size:.3g} mm long",
            remedy="moments are in kg*m^2 about the centre of mass, at most mass times the square "
            "of half the length",
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
