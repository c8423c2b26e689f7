"""The ground under a walking robot, as data: a slope, steps, a field of random blocks, friction.

The ground has a frame of its own, G: its plane z = 0 is where the robot stands at the start, x is
the way of the walk. A slope turns G in the world.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import NoneType
from typing import TYPE_CHECKING, Any, NamedTuple

from drake_leg.arguments import require_kind, shown
from drake_leg.errors import InvalidValueError
from drake_leg.units import require_finite, require_positive

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from drake_leg.robot.tree import Pose

EDGE = 50.0  # [m], from the origin to the ground's edges
DEPTH = 1.0  # [m], of the ground below its lowest step
# [N/m]. Where it is less, feet sink in and a robot falls short of its way (0.2 % at half of it);
# where it is more, feet that touch down at steps of 5 ms bounce and slip.
FOOT_STIFFNESS = 1e5
STEEPEST = math.radians(60.0)
UNDER = 0.005  # [m], how far a block reaches under a higher neighbor
MOST_PARTS = 1000  # steps or blocks; Drake takes seconds to add more to a plant


class Slab(NamedTuple):
    """A part of the ground: a box, its faces along the axes of G."""

    low: tuple[float, float, float]  # [m], least x, y and z
    high: tuple[float, float, float]  # [m], greatest x, y and z


@dataclass(frozen=True, kw_only=True)
class Steps:
    """Stairs across the way, up or down; the last tread goes on to the edge of the ground."""

    height: float  # [m], of one step; negative: down
    run: float = 0.20  # [m], from one step to the next
    start: float = 0.30  # [m], x of the first
    count: int = 1

    def __post_init__(self) -> None:
        require_finite("the height of a step", self.height)
        if self.height == 0.0:
            raise InvalidValueError(
                "the height of a step is 0.0 m; it must be positive (up) or negative (down)"
            )
        require_positive("the height of a step, without its sign,", abs(self.height), "m")
        require_positive("the run of a step", self.run, "m")
        require_finite("the x of the first step", self.start)
        _require_count("the number of steps", self.count)
        last = self.start + (self.count - 1) * self.run
        _require_on_ground("the stairs", self.start, last)


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """A field of square blocks of random heights, side by side, centered across the way."""

    height: float  # [m], greatest; heights are uniformly distributed from 0 on
    cell: float = 0.05  # [m], edge of a block
    start: float = 0.30  # [m], x where the field begins
    rows: int = 25  # along x
    columns: int = 16  # along y
    seed: int = 0

    def __post_init__(self) -> None:
        require_positive("the greatest height of a block", self.height, "m")
        require_positive("the edge of a block", self.cell, "m")
        require_finite("the x where the blocks begin", self.start)
        _require_count("the number of rows of blocks", self.rows)
        _require_count("the number of columns of blocks", self.columns)
        if self.rows * self.columns > MOST_PARTS:
            raise InvalidValueError(
                f"the field has {self.rows} by {self.columns} blocks; it must have at most "
                f"{MOST_PARTS} in all: make the field smaller, or its blocks larger"
            )
        if type(self.seed) is not int or self.seed < 0:
            raise InvalidValueError(
                f"the seed of the blocks is {shown(self.seed)}; it must be a whole number that is "
                "not negative"
            )
        _require_on_ground("the field of blocks", self.start, self.start + self.rows * self.cell)
        side = self.columns * self.cell / 2
        _require_on_ground("the field of blocks", -side, side, along="y")

    @cached_property
    def heights(self) -> NDArray[Any]:
        """Height of each block, (rows, columns) [m]: the same for the same seed and field."""
        import numpy as np

        random = np.random.default_rng(self.seed)
        return random.uniform(0.0, self.height, (self.rows, self.columns))


@dataclass(frozen=True, kw_only=True)
class Ground:
    """The ground under a walking robot.

    Parameters
    ----------
    slope : float
        Angle by which the ground rises along its x axis [rad].
    across : float
        Angle by which it is then turned about its x axis, so that its left side rises [rad].
    friction : float
        Coulomb's coefficient, between a foot and the ground.
    steps : Steps, optional
        Stairs across the way.
    blocks : Blocks, optional
        A field of random blocks; where they meet stairs, what is higher counts.

    Raises
    ------
    InvalidValueError
        If a number makes no sense.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg.robot.ground import Ground, Steps
    >>> ground = Ground(slope=radians(10), steps=Steps(height=0.02, start=0.3, run=0.2, count=3))
    >>> ground.height([0.0, 0.4, 5.0], 0.0).tolist()  # [m], in the ground's frame
    [0.0, 0.02, 0.06]
    """

    slope: float = 0.0
    across: float = 0.0
    friction: float = 0.8
    steps: Steps | None = None
    blocks: Blocks | None = None

    def __post_init__(self) -> None:
        for name, angle in (("slope", self.slope), ("slope across", self.across)):
            require_finite(f"the {name} of the ground", angle)
            if abs(angle) > STEEPEST:
                raise InvalidValueError(
                    f"the {name} of the ground is {angle:.6g} rad; it must be at most "
                    f"{STEEPEST:.6g} rad (60 deg), up or down"
                )
        require_finite("the friction of the ground", self.friction)
        if self.friction < 0.0:
            raise InvalidValueError(
                f"the friction of the ground is {self.friction:.6g}; it must be zero or positive"
            )
        require_kind("the steps of the ground", self.steps, Steps, NoneType)
        require_kind("the blocks of the ground", self.blocks, Blocks, NoneType)

    @property
    def X_WG(self) -> Pose:
        """Pose of the ground's frame in the world, (4, 4) [-]; both have the same origin.

        The x axis rises by exactly ``slope``; gravity is along the world's -z.
        """
        (s, c), (u, v) = ((math.sin(a), math.cos(a)) for a in (self.slope, self.across))
        return (
            (c, -s * u, -s * v, 0.0),
            (0.0, v, -u, 0.0),
            (s, c * u, c * v, 0.0),
            (0.0, 0.0, 0.0, 1.0),
        )

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[Any]:
        """Height of the ground in its own frame, (...) [m], at points x, y (...) [m]."""
        import numpy as np

        at_x, at_y = np.broadcast_arrays(*(np.asarray(one, dtype=np.float64) for one in (x, y)))
        found = np.zeros(at_x.shape)
        if self.steps is not None:
            steps = self.steps
            share = (at_x - steps.start) / steps.run
            passed = np.floor(share) + 1.0 if steps.height > 0.0 else np.ceil(share)
            found += steps.height * np.clip(passed, 0.0, steps.count)
        if self.blocks is not None:
            blocks = self.blocks
            row = np.floor((at_x - blocks.start) / blocks.cell)
            column = np.floor(at_y / blocks.cell + blocks.columns / 2)
            inside = (row >= 0) & (row < blocks.rows) & (column >= 0) & (column < blocks.columns)
            cells = (np.where(inside, one, 0).astype(int) for one in (row, column))
            found = np.where(inside, np.maximum(found, blocks.heights[*cells]), found)
        return found

    def slabs(self) -> tuple[Slab, ...]:
        """The boxes that it consists of: the plane, the treads of the stairs, the blocks.

        What is lower reaches under what is higher beside it. Else there would be a crack between
        two boxes, into which a foot sinks that is pressed against the higher one.
        """
        steps = self.steps
        if steps is None:
            treads = [(-EDGE, EDGE, 0.0)]
        else:
            up = steps.height > 0.0
            places = [steps.start + number * steps.run for number in range(steps.count)]
            edges = [(begin, EDGE) for begin in [-EDGE, *places]]
            if not up:
                edges = [(-EDGE, end) for end in [*places, EDGE]]
            treads = [(*edge, number * steps.height) for number, edge in enumerate(edges)]
        bottom = min(top for _, _, top in treads) - DEPTH
        found = [Slab((begin, -EDGE, bottom), (end, EDGE, top)) for begin, end, top in treads]
        return (*found, *self._block_slabs(bottom))

    def _block_slabs(self, bottom: float) -> list[Slab]:
        blocks = self.blocks
        if blocks is None:
            return []
        cell, under = blocks.cell, min(UNDER, blocks.cell)
        found = []
        for row, heights in enumerate(blocks.heights.tolist()):
            x = blocks.start + row * cell
            for column, top in enumerate(heights):
                y = (column - blocks.columns / 2) * cell
                (rear, front), (right, left) = _reach(blocks.heights, row, column)
                low = (x - under * rear, y - under * right, bottom)
                found.append(Slab(low, (x + cell + under * front, y + cell + under * left, top)))
        return found


def _reach(
    heights: NDArray[Any], row: int, column: int
) -> tuple[tuple[bool, bool], tuple[bool, bool]]:
    """Whether a block reaches under its neighbors: rear and front, right and left.

    It does under higher ones, but not to the side where it would rise out of a lower one's corner.
    """

    def is_higher(x: int, y: int) -> bool:
        inside = 0 <= x < heights.shape[0] and 0 <= y < heights.shape[1]
        return inside and bool(heights[x, y] > heights[row, column])

    along = {side: is_higher(row + side, column) for side in (-1, 1)}
    across = {
        side: is_higher(row, column + side)
        and all(is_higher(row + way, column + side) for way in (-1, 1) if along[way])
        for side in (-1, 1)
    }
    return (along[-1], along[1]), (across[-1], across[1])


def _require_count(what: str, value: int) -> None:
    if type(value) is not int or not 1 <= value <= MOST_PARTS:
        raise InvalidValueError(
            f"{what} is {shown(value)}; it must be a whole number from 1 to {MOST_PARTS}"
        )


def _require_on_ground(what: str, begin: float, end: float, *, along: str = "x") -> None:
    if not -EDGE < begin <= end < EDGE:
        raise InvalidValueError(
            f"{what} is from {along} = {begin:.6g} to {end:.6g} m; the ground ends at -{EDGE:g} "
            f"and {EDGE:g} m"
        )


def ground_from(data: Mapping[str, Any]) -> Ground:
    """Read a ground back from what ``dataclasses.asdict`` made of it.

    Raises
    ------
    InvalidValueError
        If it is not one.
    """
    try:
        parts = {
            name: data[name] and kind(**data[name])
            for name, kind in (("steps", Steps), ("blocks", Blocks))
        }
        return Ground(**{**data, **parts})
    except (TypeError, KeyError) as error:
        raise InvalidValueError(f"{shown(data)} is not a ground: {error}") from None


FLAT = Ground()
