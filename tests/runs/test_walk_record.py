import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder

from drake_leg.diagrams.hexapod import HexapodConfig, build, start_walking
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.models.walker import Contact, add_walker
from drake_leg.robot.ground import Ground, Steps
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.runs.walk_record import WalkRecord
from drake_leg.simulation.run import simulate

FORWARD = walk_of(HEXABOT, commands=(Command(forward=0.1, start=walk_of(HEXABOT).earliest_start),))


def recorded(duration, **settings):
    config = HexapodConfig(walk=FORWARD, **settings)
    step = config.time_step
    run = simulate(build(config), duration, start=start_walking(config), max_step=step)
    return WalkRecord(config=config, run=run)


@pytest.fixture(scope="module")
def record():
    return recorded(2.5)


@pytest.mark.slow
def test_feet_are_those_of_the_plants_kinematics(record):
    plant = add_walker(DiagramBuilder(), HEXABOT).plant
    context = plant.CreateDefaultContext()
    scopes, row = record.run.scopes, 300
    q = np.concatenate([scopes["body pose"][row], scopes["joint positions"][row]])
    plant.SetPositions(context, q)
    for number, tip in enumerate(HEXABOT.tips):
        foot = plant.GetBodyByName(tip).EvalPoseInWorld(context).translation()
        np.testing.assert_allclose(record.feet[row, number], foot, atol=1e-12)
    centre = plant.CalcCenterOfMassPositionInWorld(context)
    np.testing.assert_allclose(record.centre_of_mass[row], centre, atol=1e-12)


def test_forces_of_the_feet_are_all_forces_of_the_ground(record):
    # They act half a penetration below the feet.
    assert np.abs(record.force_on_body[record.settled]).max() < 5e-3 * record.weight


def test_power_is_balanced(record):
    """Motors' work is energy, the dampers' heat, and what the contacts take away."""
    scopes, config = record.run.scopes, record.config
    walker = add_walker(DiagramBuilder(), HEXABOT, servo=config.servo)
    plant, context = walker.plant, walker.plant.CreateDefaultContext()
    q = np.hstack([scopes["body pose"], scopes["joint positions"]])
    v = np.hstack([scopes["body velocity"], scopes["joint velocities"]])
    energy = []
    for row in range(len(q)):
        plant.SetPositionsAndVelocities(context, np.concatenate([q[row], v[row]]))
        kinetic = 0.5 * v[row] @ plant.CalcMassMatrix(context) @ v[row]
        energy.append(kinetic + plant.CalcPotentialEnergy(context))
    # Forces of a row act on the step that ends there.
    speed = (v[1:] + v[:-1]) / 2.0
    joints = np.diff(record.time)[:, np.newaxis] * speed[:, 6:]
    damping = config.servo.back_emf_damping * v[1:, 6:]
    motors = ((record.drive.reshape(len(q), -1)[1:] - damping) * joints).sum(axis=1)
    contacts = (scopes["contact forces"][1:] * speed).sum(axis=1) * config.time_step
    gone = np.cumsum(motors + contacts) - (np.array(energy[1:]) - energy[0])
    worked = np.cumsum(np.abs(motors))
    later = record.time[1:] > 1.0
    assert np.abs(gone[later]).max() < 0.01 * worked[-1]


def test_slips_and_swings_are_counted_by_stances(record):
    assert len(record.slips) > 12
    assert record.slips.max() < 1.2e-4
    np.testing.assert_allclose(record.swing_heights, 0.03, atol=1e-3)


@pytest.mark.slow
def test_the_rolling_of_a_ball_is_no_slip():
    rolling = recorded(2.55, contact=Contact(foot_radius=0.006))
    stance = rolling.planned_down[:, 0] & (rolling.forces[:, 0, 2] > 1.0) & (rolling.time > 1.9)
    assert np.ptp(rolling.feet[stance, 0, 0]) > 1.5e-3
    assert rolling.slips.max() < 3e-4


@pytest.mark.slow
def test_on_a_slope_everything_is_in_the_grounds_frame():
    sloped = recorded(1.5, ground=Ground(slope=0.1))
    np.testing.assert_allclose(sloped.offsets[-1], 0.0, atol=2e-3)
    np.testing.assert_allclose(sloped.tilts[-1], 0.0, atol=1e-3)
    # The center of mass is supported along gravity, which leans backwards in that frame.
    assert sloped.static_margin[-1] < recorded(1.5).static_margin[-1] - 0.004
    force = sloped.forces[sloped.settled].sum(axis=1).mean(axis=0)
    expected = sloped.weight * np.array([np.sin(0.1), 0.0, np.cos(0.1)])
    np.testing.assert_allclose(force, expected, atol=0.03 * sloped.weight)


def test_a_robot_on_lower_ground_has_not_fallen():
    """Its body is lower than half of its planned height, but not over the ground below it."""
    lower = recorded(0.4, ground=Ground(steps=Steps(height=-0.05, start=-1.0)))
    assert lower.body[-1, 2, 3] == pytest.approx(lower.planned.value[-1, 2, 3] - 0.05, abs=2e-3)
    assert lower.fell_at is None
