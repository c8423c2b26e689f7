import json

import numpy as np
import pytest

from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.walking.margins import zero_moment_point
from drake_leg.runs.named import run
from drake_leg.runs.walk import config_of
from drake_leg.runs.walk_options import WalkOptions

PLACES = ("front", "middle", "rear")


@pytest.fixture(scope="module")
def forward():
    return run("hexapod", duration=3.0)


@pytest.mark.slow
def test_the_summary_says_how_well_it_walked(forward):
    summary = forward.summary
    assert summary["commanded_distance_m"] == pytest.approx(0.1 * (3.0 - 1.225 - 0.5), abs=1e-6)
    assert abs(summary["distance_error_percent"]) < 0.3
    assert abs(summary["heading_error_deg"]) < 0.03
    assert summary["greatest_roll_error_deg"] < 0.04
    assert summary["greatest_pitch_error_deg"] < 0.04
    assert summary["height_ripple_m"] < 3e-4
    assert summary["least_static_margin_m"] > 0.075
    assert summary["clearance_m"] == pytest.approx(0.03, abs=1e-3)
    assert not summary["fell"]
    assert not summary["body_touched_ground"]


def test_forces_of_the_ground_carry_weight_and_acceleration(forward):
    """Newton's second law for the whole robot, its accelerations by differences."""
    recording, legs = forward.recording, ("left_front", "left_middle", "left_rear")
    legs += tuple(leg.replace("left", "right") for leg in legs)
    force = sum(recording.stack(f"{leg}_fx", f"{leg}_fy", f"{leg}_fz") for leg in legs)
    rows = recording["time"] > 1.0
    h = 0.005
    place = recording.stack("com_x", "com_y", "com_z")
    speed_change = (place[2:] - 2.0 * place[1:-1] + place[:-2]) / h**2
    mass = 2.1616
    expected = mass * (speed_change + np.array([0.0, 0.0, 9.80665]))
    # A step's forces give the speed at its end.
    off = (force[1:-1] - expected)[rows[1:-1]]
    assert np.abs(off.mean(axis=0)).max() < 2e-3 * mass * 9.80665
    assert np.sqrt((off**2).mean(axis=0)).max() < 0.05 * mass * 9.80665


def test_the_zero_moment_point_is_that_of_the_forces(forward):
    """By the moment of the feet's forces about the origin."""
    recording, moment, force = forward.recording, 0.0, 0.0
    for leg in (f"{side}_{place}" for side in ("left", "right") for place in PLACES):
        f = recording.stack(f"{leg}_fx", f"{leg}_fy", f"{leg}_fz")
        moment = moment + np.cross(recording.stack(f"{leg}_x", f"{leg}_y", f"{leg}_z"), f)
        force = force + f
    settled = recording["time"] >= forward.summary["settled_at_s"]
    expected = zero_moment_point(moment[settled], force[settled])
    found = recording.stack("zmp_x", "zmp_y")[settled]
    np.testing.assert_allclose(found, expected, atol=2e-5)  # feet are up to 0.2 mm deep
    least = recording["dynamic_margin"][settled].min()
    assert least == forward.summary["least_dynamic_margin_m"]


def test_on_the_flat_the_center_of_mass_is_over_its_projection(forward):
    recording = forward.recording
    np.testing.assert_allclose(
        recording.stack("under_com_x", "under_com_y"), recording.stack("com_x", "com_y")
    )


def test_power_is_torque_times_rate_and_costs_add_up(forward):
    summary, recording = forward.summary, forward.recording
    torques = np.stack([recording[f"tau{n}"] for n in range(1, 19)])
    rates = np.stack([recording[f"qdot{n}"] for n in range(1, 19)])
    np.testing.assert_allclose(recording["power"], (torques * rates).sum(axis=0), atol=1e-12)
    mechanical = summary["mechanical_cost_of_transport"]
    assert summary["electrical_cost_of_transport"] > mechanical > 0.0


def test_what_standing_costs_is_told_apart(forward):
    """Of the whole energy, by the mean power, standing takes what the moving time does not."""
    summary, recording = forward.summary, forward.recording
    settled = recording["time"] >= summary["settled_at_s"]
    time, way = recording["time"][settled], recording.stack("x", "y")[settled]
    # The body moves from 1.225 s on; before that all feet stand.
    stands = time < 1.225
    length = np.linalg.norm(np.diff(way, axis=0), axis=1)
    weight = 2.1616 * 9.80665
    for kind in ("mechanical", "electrical"):
        whole = summary[f"{kind}_cost_of_transport"] * weight * length.sum()
        moving = summary[f"moving_{kind}_cost_of_transport"] * weight * length[~stands[1:]].sum()
        assert whole == pytest.approx(
            summary[f"mean_{kind}_power_w"] * (time[-1] - time[0]), rel=0.01
        )
        assert moving < whole
    torques = np.stack([recording[f"tau{n}"] for n in range(1, 19)])[:, settled]
    rates = np.stack([recording[f"qdot{n}"] for n in range(1, 19)])[:, settled]
    spent = np.maximum(torques * rates, 0.0).sum(axis=0)
    told = summary["moving_mechanical_cost_of_transport"]
    expected = np.trapezoid(np.where(stands, 0.0, spent), time) / (
        weight * length[~stands[1:]].sum()
    )
    assert told == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
def test_a_robot_that_is_too_weak_falls_and_the_summary_says_when():
    summary = run("hexapod", duration=1.5, effort=0.05, feed_forward="none", force=True).summary
    assert summary["fell"]
    assert 0.0 < summary["fell_at_s"] < 1.5


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["hexabot", "phantomx"])
def test_feet_that_feel_the_ground_climb_a_step_of_30_mm(robot):
    ground = {"steps": 0.03, "step_count": 1.0, "lift": 0.05, "feedback": 2.0}
    summary = run("hexapod", robot=robot, duration=9.0, touch_down=True, force=True, **ground)
    summary = summary.summary
    assert abs(summary["distance_error_percent"]) < 0.5
    assert not summary["fell"]
    assert summary["touch_downs_early"] > 5
    assert summary["touch_downs_not_found"] == 0


@pytest.mark.slow
def test_a_summary_counts_touch_downs_where_feet_feel_the_ground(forward):
    counted = run("hexapod", duration=1.7, touch_down=True).summary
    kinds = ("on_time", "early", "late", "not_found")
    assert sum(counted[f"touch_downs_{kind}"] for kind in kinds) == 6
    assert all(forward.summary[f"touch_downs_{kind}"] is None for kind in kinds)


def test_a_robot_that_stands_has_no_cost_of_transport():
    summary = run("hexapod", duration=0.7, speed=0.0).summary
    assert summary["commanded_distance_m"] == 0.0
    assert summary["distance_error_percent"] is None
    assert summary["mechanical_cost_of_transport"] is None
    assert summary["least_static_margin_m"] > 0.1


def test_options_reach_the_config():
    options = WalkOptions(
        servo="xl430", feedback=2.0, friction=0.4, foot_stiffness=1e5, payload=0.5, time_step=0.002
    )
    feeling = WalkOptions(touch_down=True, search_depth=0.02, level=3.0)
    found = config_of(feeling.the_robot, feeling)
    assert (found.touch_down, found.search_depth, found.level) == (True, 0.02, 3.0)
    config = config_of(options.the_robot, options)
    assert (config.servo.name, config.feedback, config.time_step) == ("xl430", 2.0, 0.002)
    assert (config.ground.friction, config.contact.stiffness, config.payload) == (0.4, 1e5, 0.5)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"speed": 1.0}, "a speed of 0.* m/s .* is the greatest that works"),
        ({"height": 0.19}, "reach"),
        ({"height": 0.3}, "a height of the body of 0.1\\d* m is the greatest that works"),
        ({"roll": 40.0}, "a roll of 39\\.\\d* deg is the greatest that works"),
        ({"shift": [0.2, 0.0]}, "a shift by 0.0\\d*, 0, 0 m is the greatest that works"),
        ({"steps": 0.03}, "rises by up to 0.03 m .* a `lift` of more than 0.03 m"),
        ({"blocks": 0.05, "lift": 0.04}, "`touch_down=True`"),
        ({"gravity": 0.0}, "gravity, by which feet stand, is 0.0 m/s\\^2"),
        ({"time_step": 0.05}, "at most 0.02 s"),
        ({"feedback": 1000.0}, "overshoots .* at most 100 1/s"),
        (
            {"gait": "own", "phases": [0.0, 0.5, 0.2], "duty": 0.6},
            "for 3 legs, and 'hexabot' has 6",
        ),
        ({"effort": 0.05}, "at most 0.05 N\\*m"),
        ({"duty": 0.4}, "feet down"),
    ],
)
def test_a_walk_that_the_robot_cannot_make_is_refused(options, said):
    with pytest.raises(DrakeLegError, match=said):
        run("hexapod", **options)


def test_the_planned_margin_is_known_before(forward):
    assert forward.summary["planned_static_margin_m"] == pytest.approx(0.078, abs=2e-3)
    assert forward.summary["foreseen"] is None


@pytest.mark.slow
def test_a_gait_that_flies_has_no_planned_margin():
    flying = run("hexapod", gait="own", phases=[0, 0.5, 0, 0.5, 0, 0.5], duty=0.45,
                 dynamic=True, duration=1.5)  # fmt: skip
    assert flying.summary["planned_static_margin_m"] is None
    json.dumps(flying.summary, allow_nan=False)


@pytest.mark.parametrize("options", [{"payload": 0.4}, {"feed_forward": "none"}])
def test_a_load_that_is_not_planned_presses_the_body_down(options):
    summary = run("hexapod", duration=0.8, **options).summary
    assert not summary["fell"]
    assert summary["mean_height_error_m"] < -1e-4


def test_a_foot_that_is_out_of_reach_after_the_end_does_not_matter():
    assert run("hexapod", speed=0.5, duration=0.5).summary["stop_reason"] is None


@pytest.mark.slow
def test_a_forced_walk_goes_on_where_feet_are_out_of_reach_and_loses_its_way():
    summary = run("hexapod", speed=0.5, duration=4, force=True).summary
    assert summary["stop_reason"] is None
    assert summary["distance_error_percent"] < -20.0
    assert "is the greatest that works" in summary["foreseen"]
