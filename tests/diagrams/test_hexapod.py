import numpy as np
import pytest

from drake_leg.diagrams.hexapod import HexapodConfig, build, start_walking
from drake_leg.diagrams.wiring import wires
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.simulation.run import simulate

START = walk_of(HEXABOT).earliest_start
FORWARD = walk_of(HEXABOT, commands=(Command(forward=0.1, start=START),))


def walked(duration, **settings):
    config = HexapodConfig(walk=FORWARD, **settings)
    step = config.time_step
    run = simulate(build(config), duration, start=start_walking(config), max_step=step)
    return config, run


@pytest.fixture(scope="module")
def three_seconds():
    return walked(3.0)


def test_the_robot_walks_as_planned(three_seconds):
    config, run = three_seconds
    place = run.scopes["body pose"][:, 4:]
    planned = config.walk.body(run.time).value[:, :3, 3]
    np.testing.assert_allclose(place, planned, atol=1e-3)
    assert place[-1, 0] > 0.17


def test_every_row_is_a_time_step(three_seconds):
    config, run = three_seconds
    np.testing.assert_allclose(np.diff(run.time), config.time_step, atol=1e-9)


def test_the_integrators_of_inverse_jacobians_follow_the_closed_form(three_seconds):
    config, run = three_seconds
    planned = config.legs.joints(config.walk.feet(run.time + config.time_step).value)
    np.testing.assert_allclose(
        run.scopes["desired state"][:, :18], planned.reshape(-1, 18), atol=5e-4
    )


def test_the_ground_carries_the_weight(three_seconds):
    _, run = three_seconds
    upwards = run.scopes["contact forces"][run.time > 1.0, 5]
    assert upwards.mean() == pytest.approx(2.1616 * 9.80665, rel=2e-3)


def test_two_runs_are_equal_bit_by_bit():
    (_, first), (_, second) = walked(1.0), walked(1.0)
    for name, rows in first.scopes.items():
        np.testing.assert_array_equal(rows, second.scopes[name])


def test_six_inverse_jacobians_are_wired_alike():
    found = [
        (wire.source, wire.output, wire.target, wire.input)
        for wire in wires(build(HexapodConfig()))
        if wire.target.startswith("inverseJacobian")
    ]
    for number, leg in enumerate(HexapodConfig().legs.names):
        assert ("Demux", f"y{number}", f"inverseJacobian {leg}", "v") in found
        assert (f"Integrator {leg}", "y", f"inverseJacobian {leg}", "q") in found


def test_feedback_brings_the_body_back_to_its_course():
    """Soft servos without feed-forward sink, and feedback lifts the body again."""
    soft = {"feed_forward": "none", "time_step": 0.005}
    heights = [
        walked(1.6, feedback=rate, **soft)[1].scopes["body pose"][-1, 6] for rate in (None, 4.0)
    ]
    sunk, lifted = (abs(height - 0.085) for height in heights)
    assert sunk > 5e-4
    assert lifted < 0.2 * sunk


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"time_step": 0.0}, "the time step is 0"),
        ({"feedback": -1.0}, "the rate of the body's feedback is -1"),
        ({"feed_forward": "all"}, "the feed-forward is 'all'; it must be one of full, gravity"),
        ({"walk": walk_of(HEXABOT, height=0.25)}, "left_front is out of its reach at the start"),
    ],
)
def test_what_cannot_walk_is_refused(settings, said):
    with pytest.raises(InvalidValueError, match=said):
        HexapodConfig(**settings)


def test_another_gait_walks():
    gait = GAITS["ripple"]
    start = walk_of(HEXABOT, gait, period=1.5).earliest_start
    forward = (Command(forward=0.03, start=start),)
    config = HexapodConfig(walk=walk_of(HEXABOT, gait, period=1.5, commands=forward))
    run = simulate(build(config), 2.5, start=start_walking(config), max_step=config.time_step)
    planned = config.walk.body(run.time).value[:, :3, 3]
    np.testing.assert_allclose(run.scopes["body pose"][:, 4:], planned, atol=5e-4)
