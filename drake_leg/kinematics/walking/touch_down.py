"""Feet that feel the ground: they stop where they touch it, and search where they do not.

A plan has all footholds on the plane of the ground's frame G. A foot that is loaded in the second
half of its swing stands where it is; one that is not loaded at its planned touch-down goes on
downwards. The next swing starts where the foot stands, and its distance from the plan vanishes
during the swing by a quintic, which adds no velocity and no acceleration at either end.

The height of the ground under the body is the mean height of the feet that stand, smoothed. The
body follows it, and swings aim at the mean.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.gaits import bump, smoothstep
from drake_leg.kinematics.walking.plan import PlanRow
from drake_leg.units import require_positive

# How a foot stands or goes.
ON_TIME, EARLY, LATE, MISSED, SEARCHES, SWINGS, LANDS = range(7)
TOUCHES = 0.05  # of the robot's weight: a foot that carries more has touched the ground
NEAR = 1e-3  # [m], over where it is to land: a foot that touches there lands as planned
SEARCH_SPEED = 0.2  # [m/s], downwards
SEARCH_DEPTH = 0.03  # [m]
CLIMB_SPEED = 0.3  # [m/s], of a foot that met a face
CLEARS = 0.010  # [m], for which it rises before it goes on
BACK = 0.002  # [m], for which it draws back
SLACK = 0.010  # [m]: a climbing foot that is so far behind waits
SPEEDING = 4.0  # [m/s^2], of a search that begins
FOLLOWS = 5.0  # [rad/s], of the body's height, critically damped
SETTLES = 4  # time steps in which a foot is drawn to where it was felt


@dataclass(frozen=True, kw_only=True)
class Search:
    """How a foot feels the ground, and searches it.

    Parameters
    ----------
    threshold : float
        A foot that is loaded more has touched the ground [N].
    speed, depth : float
        Of a search downwards [m/s, m].
    """

    threshold: float  # [N]
    speed: float = SEARCH_SPEED  # [m/s]
    depth: float = SEARCH_DEPTH  # [m]

    def __post_init__(self) -> None:
        require_positive("the force by which a foot touches the ground", self.threshold, "N")
        require_positive("the speed of a foot's search", self.speed, "m/s")
        require_positive("the depth of a foot's search", self.depth, "m")


@dataclass(frozen=True, eq=False)
class Footholds:
    """Where feet stand, for n feet; G is the frame of the ground, as the plan believes it to be."""

    places: Array  # (n, 3), where each foot stands or last stood, in G [m]
    left: Array  # (n, 3), where it was planned to stand then, in G [m]
    pushed: Array  # (n, 3), how far faces pushed each foot off its swing, in G [m]
    rise: Array  # (n,), for which a foot that met a face still rises [m]
    aims: Array  # (n,), heights over the plan at which swings end [m]
    found: Array  # (n,), heights of the ground where the feet stand or last stood [m]
    speeds: Array  # (n,), of searches, downwards [m/s]
    sought: Array  # (n,), depths of searches [m]
    since: Array  # (n,), time steps since a foot was felt, at most ``SETTLES``
    states: Array  # (n,), one of ``ON_TIME``, ...
    height: float = 0.0  # of the ground under the body [m]
    climb: float = 0.0  # its rate [m/s]

    @classmethod
    def planned(cls, feet: Array) -> Footholds:
        """All feet stand as planned, (n, 3) in G [m]."""
        still = np.zeros(len(feet))
        return cls(
            places=feet,
            left=feet,
            pushed=np.zeros_like(feet),
            rise=still,
            aims=still,
            found=still,
            speeds=still,
            sought=still,
            since=still + SETTLES,
            states=still + ON_TIME,
        )

    @classmethod
    def of(cls, values: Array) -> Footholds:
        """Read the numbers of ``values``, (16 n + 2,)."""
        n = (len(values) - 2) // 16
        vectors, numbers = values[: 9 * n].reshape(3, n, 3), values[9 * n : -2].reshape(7, n)
        return cls(*vectors, *numbers, *values[-2:].tolist())

    @property
    def values(self) -> Array:
        """All numbers, (16 n + 2,)."""
        return np.concatenate([np.ravel(one) for one in astuple(self)])


@dataclass(frozen=True, kw_only=True, eq=False)
class Footing:
    """Where feet are to be, in the body's planned frame B, for n feet."""

    feet: Array  # (n, 3), p_BF [m]
    swing: Array  # (n, 3), their mean velocities in G during the step, expressed in B [m/s]
    rests: NDArray[np.bool_]  # (n,), whether a foot is at rest on the ground


def footing(now: Footholds, row: PlanRow, step: float) -> Footing:
    """Where feet are to be in a time step [s]."""
    R, p = row.X_GB[:3, :3], row.X_GB[:3, 3]
    planned = row.feet @ R.T + p
    begin, end = row.swung[:, :, np.newaxis]
    flies = _flies(now, row)
    before, after = _off_plan(now, begin), _off_plan(now, end)
    arrives = row.down & (now.states >= SWINGS)
    feet = now.places.copy()
    feet[flies] = (planned + before + now.pushed)[flies]
    feet[arrives] = (_landing(now, planned) + now.pushed)[arrives]
    swing = np.zeros_like(feet)
    swing[flies] = row.swing[flies] + ((after - before) / step)[flies] @ R
    climbs = flies & (now.rise > 0.0)
    swing[climbs] = 0.0
    searches = now.states == SEARCHES
    swing[searches & row.down] = -now.speeds[searches & row.down, np.newaxis] * R[2]
    under_body = p + np.array([0.0, 0.0, now.height])
    settles = (now.since < SETTLES) | searches
    rests = (row.down | ~flies) & ~settles
    return Footing(feet=(feet - under_body) @ R, swing=swing, rests=rests)


def after(
    now: Footholds,
    row: PlanRow,
    forces: Array,
    felt: Array,
    *,
    search: Search,
    step: float,
    offset: float = 0.0,
) -> Footholds:
    """Where feet stand a time step [s] later.

    Parameters
    ----------
    forces : (n, 3) ndarray
        Of the ground on the feet, in G [N].
    felt : (n, 3) ndarray
        Feet p_BF as sensed, in the body's planned frame [m].
    offset : float
        What is to be added to a height to have it in the true G [m]: the body may be higher than
        commanded.
    """
    R, p = row.X_GB[:3, :3], row.X_GB[:3, 3]
    planned = row.feet @ R.T + p
    felt = felt @ R.T + p + np.array([0.0, 0.0, now.height])
    feels, meets = _felt(forces, search.threshold)
    states, down = now.states, row.down
    flies = _flies(now, row)
    over = (planned + _off_plan(now, row.swung[0][:, np.newaxis]) - _landing(now, planned))[:, 2]
    touches = flies & feels & (row.swung[0] > 0.5) & (states != LANDS)
    pushed, rise = _pushed(now, row, forces, felt, flies & meets & (states == SWINGS), search, step)
    early = touches & (over > NEAR)
    arrives = down & (states >= SWINGS)
    searched = down & (states == SEARCHES)
    late = searched & feels
    on_time = arrives & (feels | (states == LANDS))

    states = np.where(flies & (states != LANDS), SWINGS, states)
    states = np.where(touches, np.where(early, EARLY, LANDS), states)
    states = np.where(arrives, np.where(on_time, ON_TIME, SEARCHES), states)
    states = np.where(late, LATE, states)
    places = np.where(arrives[:, np.newaxis], _landing(now, planned) + now.pushed, now.places)
    places = np.where((early | late)[:, np.newaxis], felt, places)

    goes_on = searched & ~feels
    way = np.where(goes_on, np.minimum(step * now.speeds, search.depth - now.sought), 0.0)
    places[:, 2] -= way
    sought = np.where(arrives, 0.0, now.sought + way)
    states = np.where(goes_on & (sought >= search.depth), MISSED, states)
    speeds = np.where(states == SEARCHES, np.minimum(now.speeds + step * SPEEDING, search.speed), 0)

    left = np.where(down[:, np.newaxis], planned, now.left)
    heights = places[:, 2] - left[:, 2] + offset
    found = np.where(early | late | on_time, heights, now.found)
    stands = np.isin(states, (ON_TIME, EARLY, LATE))
    ground = float(found[stands].mean()) if stands.any() else now.height
    bend = FOLLOWS**2 * (ground - now.height) - 2.0 * FOLLOWS * now.climb
    return replace(
        now,
        places=places,
        left=left,
        pushed=pushed,
        rise=rise,
        aims=np.where(down, ground - offset, now.aims),
        found=found,
        speeds=speeds,
        sought=sought,
        since=np.where(early | late, 0.0, np.minimum(now.since + 1.0, SETTLES)),
        states=states.astype(np.float64),
        height=now.height + step * now.climb,
        climb=now.climb + step * bend,
    )


def _pushed(
    now: Footholds,
    row: PlanRow,
    forces: Array,
    felt: Array,
    meets: NDArray[np.bool_],
    search: Search,
    step: float,
) -> tuple[Array, Array]:
    """How far faces push feet off their swings, (n, 3) [m], and for what they then rise, (n,) [m].

    A foot that meets a face draws back from it and rises, and then goes on with its swing.
    """
    R, p = row.X_GB[:3, :3], row.X_GB[:3, 3]
    begin, end = row.swung[:, :, np.newaxis]
    before, after = _off_plan(now, begin), _off_plan(now, end)
    way = step * row.swing @ R.T + after - before
    commanded = row.feet @ R.T + p + before + now.pushed
    climbs = now.rise > 0.0
    follows = climbs & (commanded[:, 2] - felt[:, 2] < SLACK)
    pushed = now.pushed - np.where(climbs[:, np.newaxis], way, 0.0)
    up = np.where(follows, step * CLIMB_SPEED, 0.0)
    pushed[:, 2] += up + np.where(follows, np.maximum(way[:, 2], 0.0), 0.0)
    if meets.any():
        back = forces[meets, :2] / np.linalg.norm(forces[meets, :2], axis=1, keepdims=True)
        pushed[meets, :2] += felt[meets, :2] + BACK * back - commanded[meets, :2]
        pushed[meets, :2] -= np.where(climbs[:, np.newaxis], 0.0, way)[meets, :2]
    rise = np.where(meets, CLEARS, np.maximum(now.rise - step * CLIMB_SPEED, 0.0))
    return np.where(row.down[:, np.newaxis], 0.0, pushed), np.where(row.down, 0.0, rise)


def _felt(forces: Array, threshold: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which feet are on the ground, and which press against a face that is steeper than 45 deg.

    A force within 45 deg of the normal is that of a floor: on a face, friction bears less than the
    face's own force, where its coefficient is below 1.
    """
    along, up = np.hypot(forces[:, 0], forces[:, 1]), forces[:, 2]
    return (up > threshold) & (up > along), (along > threshold) & (up <= along)


def _flies(now: Footholds, row: PlanRow) -> NDArray[np.bool_]:
    """Which feet are in the air by plan, and have not touched the ground too early."""
    return ~row.down & ~((now.states == EARLY) & (row.swung[0] > 0.5))


def _off_plan(now: Footholds, u: Array) -> Array:
    """How far swinging feet are to be off their plan, (n, 3) [m], at parts u (n, 1) of a swing."""
    start = now.places - now.left
    share = smoothstep(u).value
    found = (1.0 - share) * start
    found[:, 2] += share[:, 0] * now.aims
    # Halfway between two heights a foot is lower than the higher one by half of their difference.
    found[:, 2] += np.abs(now.aims - start[:, 2]) / 2.0 * bump(u).value[:, 0]
    return found


def _landing(now: Footholds, planned: Array) -> Array:
    """Where feet land that find the ground as expected, beside their plan, (n, 3) [m]."""
    found = planned.copy()
    found[:, 2] = now.left[:, 2] + now.aims
    return found
