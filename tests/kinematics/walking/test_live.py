"""A walk that is driven while it goes."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Command, Walk
from drake_leg.kinematics.walking.live import GREATEST, RISE, LiveWalk

STEP = 0.005
NEUTRAL = np.array(
    [
        [x, side * y, 0.0]
        for side in (1.0, -1.0)
        for x, y in ((0.19, 0.15), (0.0, 0.21), (-0.19, 0.15))
    ]
)


def live(gait="tripod", period=1.0):
    return LiveWalk(GAITS[gait], period=period, neutral=NEUTRAL, height=0.085, step=STEP)


def walked(walk, orders, duration):
    """Moments and rows; orders are (time, function)."""
    moments, rows = [], []
    orders = list(orders)
    for number in range(round(duration / STEP)):
        while orders and number * STEP >= orders[0][0] - 1e-9:
            orders.pop(0)[1](walk)
        rows.append(walk.at(number * STEP))
        moments.append(walk.now)
    return moments, rows


def drive(*velocity):
    return lambda walk: setattr(walk, "command", np.array(velocity))


@pytest.mark.slow
@pytest.mark.parametrize(
    "gait",
    [gait if gait == "tripod" else pytest.param(gait, marks=pytest.mark.slow) for gait in GAITS],
)
def test_with_a_constant_command_it_walks_as_the_planned_walk_does(gait):
    period = 3.0 if gait == "wave" else 1.0
    velocity = (0.04, 0.01, 0.1)
    moments, _ = walked(live(gait, period), [(0.0, drive(*velocity))], 5.0 * period)
    after = moments[round(4.0 * period / STEP) :]
    start = after[0]
    names = ("forward", "sideways", "turning")
    command = Command(**dict(zip(names, velocity, strict=True)), start=10 * period, ramp=1e-6)
    walk = Walk(gait=GAITS[gait], period=period, neutral=NEUTRAL, commands=(command,))
    # The planned walk, an entire number of periods later.
    time = 20 * period + STEP * np.array([one.number for one in after]) - 4.0 * period
    X = walk.level(time[0]).value
    to_live = start.X_GB @ np.linalg.inv(X)
    to_live[2, 3] = 0.0
    planned = walk.feet_in_world(time)
    feet = planned.value @ to_live[:3, :3].T + to_live[:3, 3]
    np.testing.assert_allclose([one.feet for one in after], feet, atol=1e-9)
    speeds = planned.rate @ to_live[:3, :3].T
    np.testing.assert_allclose([one.speeds for one in after], speeds, atol=1e-8)
    other = np.array([one.down for one in after]) != walk.down(time)
    assert np.abs(speeds[other]).max(initial=0.0) < 1e-4  # only where a swing begins or ends


ORDERS = [
    (0.2, drive(0.1, 0.0, 0.0)),
    (1.13, drive(0.0, 0.06, 0.4)),
    (2.0, drive(-0.1, 0.0, -0.3)),
    (2.71, lambda walk: setattr(walk, "height", 0.1)),
    (3.4, lambda walk: walk.change_gait(GAITS["ripple"], 1.5)),
    (5.5, drive(0.0, 0.0, 0.0)),
]


@pytest.fixture(scope="module")
def moments():
    return walked(live(), ORDERS, 9.0)[0]


@pytest.mark.slow
def test_feet_that_stand_do_not_move(moments):
    feet = np.array([one.feet for one in moments])
    both = np.array([one.down for one in moments])
    both = both[1:] & both[:-1]
    assert np.abs(np.diff(feet, axis=0))[both].max() == 0.0


@pytest.mark.slow
def test_swings_begin_and_end_at_rest_and_their_velocities_have_no_jumps(moments):
    feet, speeds = (np.array([getattr(one, n) for one in moments]) for n in ("feet", "speeds"))
    assert np.abs(np.diff(speeds, axis=0)).max() < 25.0 * STEP  # [m/s], of a bounded acceleration
    np.testing.assert_allclose(
        np.diff(feet, axis=0), STEP * (speeds[1:] + speeds[:-1]) / 2.0, atol=1e-4
    )
    assert feet[..., 2].min() == 0.0


@pytest.mark.slow
def test_the_body_moves_smoothly_and_not_faster_than_it_may(moments):
    velocity = np.array([one.velocity for one in moments])
    assert (np.abs(np.diff(velocity, axis=0)) <= GREATEST * STEP * (1 + 1e-9)).all()
    heights = np.array([one.height for one in moments])
    assert np.abs(np.diff(heights)).max() <= RISE * STEP * (1 + 1e-9)
    assert heights[-1] == pytest.approx(0.1, abs=1e-4)


@pytest.mark.slow
def test_a_gait_changes_where_all_feet_stand(moments):
    walk = live()
    changed = None
    for number in range(1400):
        if number == 300:
            walk.change_gait(GAITS["wave"], 3.0)
        walk.command = np.array([0.08, 0.0, 0.0])
        walk.at(number * STEP)
        if changed is None and walk.gait.name == "wave":
            changed = walk.now
    assert changed.down.all()
    assert not walk.is_changing
    assert sum(one < 3 for one in [walk.now.down.sum()]) == 0


@pytest.mark.slow
def test_at_rest_all_feet_come_back_to_their_neutral_places(moments):
    last = moments[-1]
    np.testing.assert_allclose(last.velocity, 0.0, atol=1e-4)
    X = last.X_GB
    home = NEUTRAL @ X[:3, :3].T + [*X[:2, 3], 0.0]
    assert np.abs(last.feet - home).max() < 2e-3
    assert last.down.all()


def test_rows_come_one_after_the_other():
    walk = live()
    first = walk.at(0.0)
    assert walk.at(0.0) is first
    walk.at(STEP)
    with pytest.raises(InvalidValueError, match="step by step"):
        walk.at(5 * STEP)
    walk.reset()
    np.testing.assert_array_equal(walk.at(0.0).feet, first.feet)
