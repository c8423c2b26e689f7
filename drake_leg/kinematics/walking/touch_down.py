"""Feet that feel the ground: they stop where they touch it, and search where they do not.

A plan has all footholds on the plane of the ground's frame G. A foot that is loaded in the second
half of its swing stands where it is; one that is not loaded at its planned touch-down goes on
downwards. The next swing starts where the foot stands, and its distance from the plan vanishes
during the swing by a quintic, which adds no velocity and no acceleration at either end.

Only a floor ends a swing. A foot that meets a face, as that of a step, draws back from it, rises
and tries again; its swing ends so much beside its plan.

The height of the ground under the body is the mean height of the feet that stand, smoothed. The
body follows it, and swings aim at the mean.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.gaits import arched, risen
from drake_leg.kinematics.walking.plan import PlanRow
from drake_leg.units import require_positive

# How a foot stands or goes.
ON_TIME, EARLY, LATE, MISSED, SEARCHES, SWINGS, LANDS = range(7)
TOUCHES = 0.05  # of the robot's weight: a foot that carries more has touched the ground
NEAR = 1e-3  # [m], over where it is to land: a foot that touches there lands as planned
SEARCH_SPEED = 0.2  # [m/s], downwards
SEARCH_DEPTH = 0.03  # [m]
SPEEDING = 4.0  # [m/s^2], of a search that begins
BACK = 0.002  # [m], by which a foot draws back from a face
CLIMB_SPEED = 0.3  # [m/s], at which it then rises
CLIMB = 0.010  # [m], by which it rises before it tries again
BEHIND = 0.010  # [m], below its command: a foot that is so late is not to rise
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
        return np.concatenate([np.ravel(getattr(self, one.name)) for one in fields(self)])


@dataclass(frozen=True, kw_only=True, eq=False)
class Footing:
    """Where feet are to be, in the body's planned frame B, for n feet."""

    feet: Array  # (n, 3), p_BF [m]
    swing: Array  # (n, 3), their mean velocities in G during the step, expressed in B [m/s]
    rests: NDArray[np.bool_]  # (n,), whether a foot is at rest on the ground


def footing(now: Footholds, row: PlanRow, step: float) -> Footing:
    """Where feet are to be in a time step [s]."""
    R, p = row.X_GB[:3, :3], row.X_GB[:3, 3]
    swings, flies = _swings(now, row, step), _flies(now, row)
    arrives = row.down & (now.states >= SWINGS)
    searches = row.down & (now.states == SEARCHES)
    feet = now.places.copy()
    feet[flies] = swings.begin[flies]
    feet[arrives] = _landing(now, row)[arrives]
    velocities = np.zeros_like(feet)
    goes = flies & (now.rise == 0.0)
    velocities[goes] = swings.way[goes] @ R / step
    velocities[searches] = -now.speeds[searches, np.newaxis] * R[2]
    under_body = p + np.array([0.0, 0.0, now.height])
    settles = (now.since < SETTLES) | (now.states == SEARCHES)
    rests = (row.down | ~flies) & ~settles
    return Footing(feet=(feet - under_body) @ R, swing=velocities, rests=rests)


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
    planned = _in_ground(row.feet, row)
    felt = _in_ground(felt, row) + np.array([0.0, 0.0, now.height])
    on_floor, on_face = _felt(forces, search.threshold)
    states, down, flies = now.states, row.down, _flies(now, row)
    landing, swings = _landing(now, row), _swings(now, row, step)
    touches = flies & on_floor & (row.swung[0] > 0.5) & (states != LANDS)
    early = touches & (swings.begin[:, 2] - landing[:, 2] > NEAR)
    arrives = down & (states >= SWINGS)
    searched = down & (states == SEARCHES)
    late = searched & on_floor
    on_time = arrives & (on_floor | (states == LANDS))
    meets = flies & on_face & (states == SWINGS)

    states = np.where(flies & (states != LANDS), SWINGS, states)
    states = np.where(touches, np.where(early, EARLY, LANDS), states)
    states = np.where(arrives, np.where(on_time, ON_TIME, SEARCHES), states)
    states = np.where(late, LATE, states)
    places = np.where(arrives[:, np.newaxis], landing, now.places)
    places = np.where((early | late)[:, np.newaxis], felt, places)

    goes_on = searched & ~on_floor
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
    pushed = _pushed(now, swings, forces, felt, meets, step)
    rise = np.where(meets, CLIMB, np.maximum(now.rise - step * CLIMB_SPEED, 0.0))
    return replace(
        now,
        places=places,
        left=left,
        pushed=np.where(down[:, np.newaxis], 0.0, pushed),
        rise=np.where(down, 0.0, rise),
        aims=np.where(down, ground - offset, now.aims),
        found=found,
        speeds=speeds,
        sought=sought,
        since=np.where(early | late, 0.0, np.minimum(now.since + 1.0, SETTLES)),
        states=states.astype(np.float64),
        height=now.height + step * now.climb,
        climb=now.climb + step * bend,
    )


def _felt(forces: Array, threshold: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which feet are on the ground, and which press against a face that is steeper than 45 deg.

    A force within 45 deg of the normal is that of a floor: on a face, friction bears less than the
    face's own force, where its coefficient is below 1.
    """
    along, up = np.hypot(forces[:, 0], forces[:, 1]), forces[:, 2]
    return (up > threshold) & (up > along), (along > threshold) & (up <= along)


class _Swings(NamedTuple):
    """Of all feet, as if each were in the air; G is the frame of the ground."""

    begin: Array  # (n, 3), where they are to be at the beginning of a time step, in G [m]
    way: Array  # (n, 3), on which they go in it, in G [m]


def _swings(now: Footholds, row: PlanRow, step: float) -> _Swings:
    before, after = _off_plan(now, row.swung)
    way = step * row.swing @ row.X_GB[:3, :3].T + after - before
    return _Swings(_in_ground(row.feet, row) + before + now.pushed, way)


def _pushed(
    now: Footholds,
    swings: _Swings,
    forces: Array,
    felt: Array,
    meets: NDArray[np.bool_],
    step: float,
) -> Array:
    """How far faces push feet off their swings a time step later, (n, 3) [m]."""
    climbs = now.rise > 0.0
    follows = climbs & (swings.begin[:, 2] - felt[:, 2] < BEHIND)
    stays = meets | climbs
    pushed = now.pushed.copy()
    pushed[stays, :2] -= swings.way[stays, :2]
    pushed[climbs, 2] -= swings.way[climbs, 2]
    pushed[follows, 2] += step * CLIMB_SPEED + np.maximum(swings.way[follows, 2], 0.0)
    along = forces[meets, :2]
    back = BACK * along / np.linalg.norm(along, axis=1, keepdims=True)
    pushed[meets, :2] += felt[meets, :2] + back - swings.begin[meets, :2]
    return pushed


def _in_ground(feet: Array, row: PlanRow) -> Array:
    """Feet (n, 3), given in B, in G [m]."""
    return np.asarray(feet @ row.X_GB[:3, :3].T + row.X_GB[:3, 3])


def _flies(now: Footholds, row: PlanRow) -> NDArray[np.bool_]:
    """Which feet are in the air by plan, and have not touched the ground too early."""
    stands: NDArray[np.bool_] = row.down | ((now.states == EARLY) & (row.swung[0] > 0.5))
    return ~stands


def _off_plan(now: Footholds, u: Array) -> Array:
    """How far swinging feet are to be off their plan, (2, n, 3) [m], at parts u (2, n)."""
    start = now.places - now.left
    share = risen(u)
    found: Array = (1.0 - share)[..., np.newaxis] * start
    # Halfway between two heights a foot is lower than the higher one by half of their difference.
    found[..., 2] += share * now.aims + np.abs(now.aims - start[:, 2]) / 2.0 * arched(u)
    return found


def _landing(now: Footholds, row: PlanRow) -> Array:
    """Where feet land that find the ground as expected, in G, (n, 3) [m]."""
    found = _in_ground(row.feet, row)
    found[:, 2] = now.left[:, 2] + now.aims
    return found + now.pushed
