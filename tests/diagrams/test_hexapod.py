import numpy as np
import pytest

from drake_leg.diagrams.hexapod import TOUCH_DOWNS, HexapodConfig, build, start_walking
from drake_leg.diagrams.wiring import wires
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.kinematics.walking.touch_down import EARLY, MISSED
from drake_leg.robot.ground import Ground
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


@pytest.mark.slow
def test_the_robot_walks_as_planned(three_seconds):
    config, run = three_seconds
    place = run.scopes["body pose"][:, 4:]
    planned = config.walk.body(run.time).value[:, :3, 3]
    np.testing.assert_allclose(place, planned, atol=2e-4)
    np.testing.assert_allclose(place[:, :2], planned[:, :2], atol=1e-4)
    assert place[-1, 0] > 0.17


def test_every_row_is_a_time_step(three_seconds):
    config, run = three_seconds
    np.testing.assert_allclose(np.diff(run.time), config.time_step, atol=1e-9)


def test_the_integrators_of_inverse_jacobians_follow_the_closed_form(three_seconds):
    config, run = three_seconds
    times = run.time + config.time_step
    angles = run.scopes["desired state"][:, :18].reshape(-1, 6, 3)
    off = np.abs(config.legs.feet(angles) - config.walk.feet(times).value)
    down = config.walk.down(times)
    assert off[down][:, 2].max() < 3e-6
    assert off[..., 2].max() < 3e-5
    assert off.max() < 1.2e-4  # the drift of a stance along the ground


def test_the_ground_carries_the_weight(three_seconds):
    _, run = three_seconds
    upwards = run.scopes["contact forces"][run.time > 1.0, 5]
    assert upwards.mean() == pytest.approx(2.1616 * 9.80665, rel=2e-3)


@pytest.mark.slow
def test_two_runs_are_equal_bit_by_bit():
    (_, first), (_, second) = walked(1.0), walked(1.0)
    for name, rows in first.scopes.items():
        np.testing.assert_array_equal(rows, second.scopes[name])


def test_one_inverse_jacobian_moves_all_legs():
    diagram = build(HexapodConfig())
    found = {(wire.source, wire.output, wire.target, wire.input) for wire in wires(diagram)}
    assert {
        ("Gait", "v", "inverseJacobian, 6 legs", "v"),
        ("Integrator", "y", "inverseJacobian, 6 legs", "q"),
        ("inverseJacobian, 6 legs", "qdot", "Integrator", "u"),
        ("Mux", "y0", "Servo Command", "u0"),
    } <= found
    assert diagram.GetSubsystemByName("inverseJacobian, 6 legs").robot.joints == 18


def test_servos_are_told_the_angles_of_the_end_of_a_step(three_seconds):
    config, run = three_seconds
    desired = run.scopes["desired state"]
    angles, rates = desired[:, :18], desired[:, 18:]
    np.testing.assert_allclose(
        angles[1:], angles[:-1] + config.time_step * rates[1:], rtol=0.0, atol=1e-12
    )
    np.testing.assert_allclose(
        angles[0], config.start.ravel() + config.time_step * rates[0], rtol=0.0, atol=1e-12
    )


@pytest.mark.slow
def test_feedback_brings_the_body_back_to_its_course():
    """Soft servos without feed-forward sink, and feedback lifts the body again."""
    soft = {"feed_forward": "none", "time_step": 0.005}
    heights = [
        walked(1.6, feedback=rate, **soft)[1].scopes["body pose"][-1, 6] for rate in (None, 4.0)
    ]
    sunk, lifted = (abs(height - 0.085) for height in heights)
    assert sunk > 5e-4
    assert lifted < 0.2 * sunk


@pytest.mark.slow
def test_on_the_flat_feet_that_feel_the_ground_walk_as_planned(three_seconds):
    _, blind = three_seconds
    _, run = walked(2.0, touch_down=True)
    rows = len(run.time)
    place, expected = run.scopes["body pose"][:, 4:], blind.scopes["body pose"][:rows, 4:]
    np.testing.assert_allclose(place, expected, atol=1e-4)
    assert not np.isin(run.scopes[TOUCH_DOWNS], (EARLY, MISSED)).any()


@pytest.mark.slow
def test_a_body_that_is_levelled_by_gravity_is_level_on_a_slope_across():
    """The ground leans to the right by 0.05 rad, and so would a body that is not levelled."""
    ground, settings = Ground(across=0.05), {"time_step": 0.005}
    _, run = walked(1.6, ground=ground, level=4.0, **settings)
    w, x, y, z = run.scopes["body pose"][-1, :4]
    assert 2.0 * (w * x + y * z) == pytest.approx(0.0, abs=2e-3)
    _, leaning = walked(0.3, ground=ground, **settings)
    assert abs(2.0 * leaning.scopes["body pose"][-1, 1]) == pytest.approx(0.05, abs=2e-3)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"time_step": 0.0}, "the time step is 0"),
        ({"feedback": -1.0}, "the rate of the body's feedback is -1"),
        ({"level": 0.0}, "the rate of the body's levelling is 0"),
        ({"level": 2.0, "feedback": 2.0}, "`feedback` is 2 and `level` is 2; feedback of the pose"),
        ({"touch_down": True, "gravity": 0.0}, "without gravity, no foot can feel the ground"),
        ({"search_depth": 0.0}, "the depth of a foot's search is 0"),
        ({"feed_forward": "all"}, "the feed-forward is 'all'; it must be one of full, gravity"),
        ({"walk": walk_of(HEXABOT, height=0.25)}, "left_front is out of its reach at the start"),
    ],
)
def test_what_cannot_walk_is_refused(settings, said):
    with pytest.raises(InvalidValueError, match=said):
        HexapodConfig(**settings)


@pytest.mark.slow
def test_another_gait_walks():
    gait = GAITS["ripple"]
    start = walk_of(HEXABOT, gait, period=1.5).earliest_start
    forward = (Command(forward=0.03, start=start),)
    config = HexapodConfig(walk=walk_of(HEXABOT, gait, period=1.5, commands=forward))
    run = simulate(build(config), 2.5, start=start_walking(config), max_step=config.time_step)
    planned = config.walk.body(run.time).value[:, :3, 3]
    np.testing.assert_allclose(run.scopes["body pose"][:, 4:], planned, atol=5e-4)


@pytest.mark.slow
def test_feedback_compares_poses_of_the_same_instant():
    # By a time step apart, the body would stay half a millimeter behind its plan: v h.
    config, run = walked(3.0, feedback=2.0)
    place = run.scopes["body pose"][:, 4:]
    off = place - config.walk.body(run.time).value[:, :3, 3]
    assert np.abs(off[run.time > 0.5, :2]).max() < 0.2e-3
