"""Times at which a walk is looked at."""

from dataclasses import replace

import numpy as np
import pytest

from drake_leg.kinematics.walking.cycle_times import PER_SWING, times_of, times_within
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Attitude, Command, Walk

NEUTRAL = [(x, y, 0.0) for y in (0.2, -0.2) for x in (0.2, 0.0, -0.2)]


def walk_of(gait, **others):
    return Walk(gait=GAITS[gait], period=2.0, neutral=NEUTRAL, **others)


@pytest.mark.parametrize("gait", list(GAITS))
def test_a_cycle_has_both_sides_of_every_touch_down_and_lift_off_and_never_the_instant(gait):
    walk = walk_of(gait, commands=[Command(forward=0.1, start=2.0)])
    times = times_within([(6.0, 8.0)], walk)
    swings = (times[:, np.newaxis] / 2.0 - walk.gait.phases) % 1.0 >= walk.gait.duty
    for leg in range(6):
        for event in (walk.gait.phases[leg], walk.gait.phases[leg] + walk.gait.duty):
            offsets = (times / 2.0 - event + 0.5) % 1.0 - 0.5
            assert -1e-8 < offsets[offsets < 0.0].max() < -1e-10
            assert 1e-10 < offsets[offsets > 0.0].min() < 1e-8
        assert swings[:, leg].sum() >= PER_SWING
    # Where one foot lifts as another one lands, it is never seen before that one is down.
    assert walk.down(times).sum(axis=1).min() == walk.gait.fewest_down


def test_changes_are_looked_at_and_a_long_steady_walk_between_them_is_not():
    commands = [Command(forward=0.1, start=2.0, end=100.0)]
    attitude = Attitude(roll=0.1, start=50.0)
    times = times_of(walk_of("tripod", commands=commands, attitudes=[attitude]), np.inf)
    for begin, end in ((0.0, 9.0), (50.0, 53.0), (96.0, 105.0)):
        inside = times[(times > begin) & (times < end)]
        assert np.diff(inside).max() < 0.03
    assert not ((times > 10.0) & (times < 49.0)).any()
    assert len(times) < 1200
    long = walk_of("tripod", commands=[replace(commands[0], end=1e6)])
    assert len(times_of(long, np.inf)) < 1200
    assert times_of(long, 5.0).max() <= 5.0
