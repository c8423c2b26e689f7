"""The feed-forward of a driven walk is that of the planned walk with the same motion."""

import numpy as np
import pytest

from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Command, Walk
from drake_leg.kinematics.walking.live import HELD, LiveWalk
from drake_leg.kinematics.walking.live_loads import live_torques
from drake_leg.kinematics.walking.loads import outwards_on, planned_torques
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.robot.ground import FLAT
from drake_leg.robot.hexapods import HEIGHT, HEXABOT
from drake_leg.robot.servos import IDEAL

STEP = 0.005
STANDS = walk_of(HEXABOT)
OUTWARDS = outwards_on(FLAT)
LOADS = live_torques(HEXABOT, IDEAL)


def live(torques=None):
    return LiveWalk(
        GAITS["tripod"],
        period=1.0,
        neutral=np.asarray(STANDS.neutral),
        height=HEIGHT,
        step=STEP,
        torques=torques,
    )


def test_at_rest_it_carries_the_weight_as_the_plan_does():
    row = live(LOADS).at(0.0)
    (planned,) = planned_torques(HEXABOT, STANDS, [0.0], IDEAL, outwards=OUTWARDS)
    np.testing.assert_allclose(row.torques, planned, atol=1e-12)


@pytest.mark.slow
def test_with_a_constant_command_it_is_that_of_the_planned_walk():
    """After five periods; accelerations of feet are differences over a time step."""
    walk, velocity = live(), (0.06, 0.01, 0.1)
    walk.command = np.array(velocity)
    found, times = [], []
    for number in range(1000):
        walk.at(number * STEP)
        if number >= 800:
            now, then = walk.now, walk._then
            found.append(LOADS(walk, now, then))
            times.append(then.number * STEP)
    names = ("forward", "sideways", "turning")
    command = Command(**dict(zip(names, velocity, strict=True)), start=10.0, ramp=1e-6)
    planned_walk = Walk(
        gait=GAITS["tripod"],
        period=1.0,
        neutral=STANDS.neutral,
        commands=(command,),
        attitudes=STANDS.attitudes,
    )
    times = np.array(times) + 16.0
    planned = planned_torques(HEXABOT, planned_walk, times, IDEAL, outwards=OUTWARDS)
    off = np.abs(np.array(found) - planned)
    assert np.abs(planned).max() > 0.8
    assert np.sqrt((off**2).mean()) < 0.01
    assert off.max() < 0.1


@pytest.mark.slow
def test_a_standing_robot_keeps_its_feet_firm_and_a_lifted_foot_is_not():
    walk = live()
    for number in range(300):
        walk.at(number * STEP)
        assert walk.firmness(walk.now, 0.05) == pytest.approx(1.0)
    walk.command = np.array([0.1, 0.0, 0.0])
    for number in range(300, 700):
        walk.at(number * STEP)
        firm = walk.firmness(walk.now, 0.05)
        assert not firm[~walk.now.down].any()
        assert firm.max() <= 1.0 + 1e-12
    assert walk.now.landed.any()


def test_it_is_held_for_a_few_steps_and_out_of_reach_it_is_zero():
    calls = []

    def counted(walk, now, then):
        calls.append(then.number)
        return LOADS(walk, now, then)

    walk = live(counted)
    rows = [walk.at(number * STEP) for number in range(2 * HELD)]
    assert calls == [1, 1 + HELD]
    assert rows[0].torques is rows[HELD - 1].torques
    far = live()
    far.at(0.0)
    far.now.feet[0] += 1.0
    found = LOADS(far, far.now, far.now)
    assert np.isfinite(found).all()
