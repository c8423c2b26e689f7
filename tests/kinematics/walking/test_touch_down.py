"""Feet over a ground that is not where the plan believes it, followed exactly, without Drake."""

from functools import cache

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import WalkPlan, walk_of
from drake_leg.kinematics.walking.touch_down import (
    BACK,
    EARLY,
    LATE,
    MISSED,
    ON_TIME,
    SEARCHES,
    Footholds,
    Search,
    after,
    footing,
)
from drake_leg.robot.hexapods import HEXABOT

STEP, LIFT = 0.005, 0.05
START = walk_of(HEXABOT).earliest_start
WALK = walk_of(HEXABOT, lift=LIFT, commands=(Command(forward=0.1, start=START),))
SEARCH = Search(threshold=1.0)
PLAN = WalkPlan(WALK, step=STEP)


@cache
def row_of(number):
    return PLAN.at(number * STEP)


def walked(duration, surface, *, face=None, load=5.0):
    """Feet and their states (rows, n, 3) and (rows, n), and the heights of the body.

    They go where they are to be, but not below the surface, nor beyond the x of a face.
    """
    row = row_of(0)
    now = Footholds.planned(row.feet + row.X_GB[:3, 3])
    feet, states, heights = [], [], []
    before = row.feet + row.X_GB[:3, 3]
    for number in range(round(duration / STEP)):
        row = row_of(number)
        body = row.X_GB[:3, 3] + [0.0, 0.0, now.height]
        wanted = footing(now, row, STEP).feet + body
        places, forces = wanted.copy(), np.zeros_like(wanted)
        if face is not None:
            x, top = face
            ahead = (before[:, 0] <= x) & (wanted[:, 0] > x) & (wanted[:, 2] < top)
            places[ahead, 0], forces[ahead, 0] = x, -load
        under = surface(*places[:, :2].T)
        touch = wanted[:, 2] <= under + 1e-12
        places[touch, 2], forces[touch, 2] = under[touch], load
        before = places
        feet.append(places)
        states.append(now.states)
        heights.append(now.height)
        now = after(now, row, forces, places - body, search=SEARCH, step=STEP)
    return np.array(feet), np.array(states), np.array(heights)


def level(height):
    return lambda x, y: np.full(np.shape(x), height)


def higher_from(edge, height):
    return lambda x, y: np.where(x > edge, height, 0.0)


@pytest.mark.slow
def test_on_the_plane_of_the_plan_nothing_changes():
    feet, states, heights = walked(2.2, level(0.0))
    planned = WALK.feet_in_world(STEP * np.arange(len(feet))).value
    np.testing.assert_allclose(feet, planned, atol=1e-12)
    assert not np.isin(states, (EARLY, LATE, MISSED, SEARCHES)).any()
    np.testing.assert_allclose(heights, 0.0, atol=1e-12)


@pytest.mark.slow
def test_a_foot_stops_where_it_touches_the_ground_early():
    feet, states, _ = walked(2.9, higher_from(0.195, 0.02))
    stops = np.flatnonzero((states[1:, 0] == EARLY) & (states[:-1, 0] != EARLY)) + 1
    for stop in stops:
        stance = slice(stop, stop + 60)
        assert np.ptp(feet[stance, 0], axis=0).max() < 1e-12
        assert feet[stop, 0, 2] == pytest.approx(0.02, abs=1e-12)
    assert len(stops) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("depth", [0.004, 0.015, 0.028])
def test_a_foot_that_finds_no_ground_goes_down_to_it(depth):
    feet, states, _ = walked(2.2, higher_from(0.195, -depth))
    assert LATE in states[:, 0]
    found = int(np.argmax(states[:, 0] == LATE))
    assert feet[found, 0, 2] == pytest.approx(-depth, abs=1e-12)
    speeds = np.diff(feet[:, 0, 2]) / STEP
    assert speeds[states[:-1, 0] == SEARCHES].min() >= -SEARCH.speed - 1e-9


@pytest.mark.slow
def test_it_goes_down_no_farther_than_it_may():
    feet, states, _ = walked(2.2, higher_from(0.195, -1.0))
    missed = states[:, 0] == MISSED
    assert missed.any()
    np.testing.assert_allclose(feet[missed, 0, 2], -SEARCH.depth, atol=1e-12)


@pytest.mark.slow
def test_a_swing_has_no_jumps_wherever_it_begins():
    feet, states, _ = walked(3.0, higher_from(0.195, 0.02))
    speeds = np.linalg.norm(np.diff(feet[:, 0], axis=0), axis=1) / STEP
    assert speeds.max() < 0.8
    begins = np.flatnonzero((states[1:, 0] > SEARCHES) & (states[:-1, 0] == EARLY)) + 1
    assert len(begins)
    assert speeds[begins].max() < 0.02


@pytest.mark.slow
def test_the_body_follows_the_mean_height_of_its_feet():
    _, _, heights = walked(4.5, higher_from(0.0, 0.03))
    assert heights[-1] == pytest.approx(0.03, abs=2e-3)
    assert heights.min() > -1e-9
    assert heights.max() < 0.031
    assert np.abs(np.diff(heights, 2)).max() < 2.0 * STEP**2


@pytest.mark.slow
def test_a_foot_that_meets_a_face_climbs_it():
    """It draws back, rises above the edge, and lands on the floor behind it."""
    edge, top = 0.205, 0.03
    feet, states, _ = walked(3.0, higher_from(edge, top), face=(edge, top))
    x, z = feet[:, 0, 0], feet[:, 0, 2]
    beyond = int(np.argmax(x > edge + 1e-9))
    assert x[beyond - 1] <= edge
    assert z[beyond] >= top - 1e-12
    met = int(np.argmax(np.isclose(x, edge, atol=1e-12)))
    assert met > 0
    assert edge - x[met + 1] == pytest.approx(BACK, abs=1e-6)
    assert z[met + 3] > z[met]
    stands = np.isin(states[beyond:, 0], (EARLY, ON_TIME, LATE))
    np.testing.assert_allclose(z[beyond:][stands], top, atol=1e-12)


def test_a_force_across_the_ground_is_not_a_floor():
    row = row_of(round(START / STEP))
    now = Footholds.planned(row.feet + row.X_GB[:3, 3])
    for number in range(round(START / STEP), round((START + 0.8) / STEP)):
        row = row_of(number)
        forces = np.tile([-5.0, 0.0, 4.0], (6, 1))
        felt = footing(now, row, STEP).feet
        now = after(now, row, forces, felt, search=SEARCH, step=STEP)
        assert EARLY not in now.states


def test_footholds_are_read_back_from_their_numbers(rng):
    values = rng.standard_normal(16 * 6 + 2)
    np.testing.assert_array_equal(Footholds.of(values).values, values)


@pytest.mark.parametrize("name", ["threshold", "speed", "depth"])
def test_a_search_needs_positive_numbers(name):
    with pytest.raises(InvalidValueError, match="is 0"):
        Search(**{"threshold": 1.0, name: 0.0})
