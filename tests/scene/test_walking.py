"""A robot that walks, shown: its motion, what it stands on, and how pictures go with it."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.diagrams.hexapod import HexapodConfig, build, start_walking
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.robot.ground import Ground, Steps
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.walk_record import WalkRecord
from drake_leg.scene.motion import at_rest, motion_of
from drake_leg.scene.replays import replay
from drake_leg.scene.scene import scene_of
from drake_leg.scene.views import VIEWS
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import simulate

UPHILL = Ground(slope=radians(10.0), across=radians(4.0))


@pytest.fixture(scope="module")
def record():
    walk = walk_of(HEXABOT, commands=(Command(forward=0.1, start=0.8, ramp=0.3),))
    config = HexapodConfig(walk=walk, ground=UPHILL)
    run = simulate(
        build(config), 1.6, start=start_walking(config), max_step=config.time_step, guarded=False
    )
    return WalkRecord(config=config, run=run)


@pytest.fixture(scope="module")
def motion(record):
    return motion_of(HEXABOT, record.run, ground=UPHILL)


def in_world(points):
    X_WG = np.array(UPHILL.X_WG)
    return points @ X_WG[:3, :3].T + X_WG[:3, 3]


@pytest.mark.slow
def test_the_shown_robot_is_where_the_record_has_it(record, motion):
    X_WB = np.array(UPHILL.X_WG) @ record.body
    np.testing.assert_allclose(motion.poses()[:, 1], X_WB, atol=1e-12)
    np.testing.assert_allclose(np.moveaxis(motion.paths(), 0, 1), in_world(record.feet), atol=1e-9)


def test_it_stands_on_what_the_record_says(record, motion):
    footing = motion.footing
    np.testing.assert_allclose(footing.feet, in_world(record.feet), atol=1e-12)
    np.testing.assert_allclose(
        footing.forces, record.forces @ np.array(UPHILL.X_WG)[:3, :3].T, atol=1e-9
    )
    assert (footing.stands == record.loaded).all()
    supported = footing.stands.sum(axis=1) >= 3
    np.testing.assert_allclose(
        footing.margins[supported], record.static_margin[supported], atol=1e-9
    )
    assert abs(footing.forces[200:, :, 2].sum(axis=1).mean() / footing.weight - 1.0) < 0.05


def test_columns_of_a_recording_say_the_same_in_the_frame_of_the_ground(record, motion):
    quaternions = Rotation.from_matrix(record.body[:, :3, :3]).as_quat(scalar_first=True)
    columns = {"time[s]": record.time}
    columns |= dict(zip(("x[m]", "y[m]", "z[m]"), record.body[:, :3, 3].T, strict=True))
    columns |= dict(zip(("qw", "qx", "qy", "qz"), quaternions.T, strict=True))
    columns |= {f"q{i}[rad]": q for i, q in enumerate(record.q.reshape(-1, 18).T, start=1)}
    for leg, force in zip(record.config.legs.names, np.moveaxis(record.forces, 1, 0), strict=True):
        columns |= {f"{leg}_f{part}[N]": one for part, one in zip("xyz", force.T, strict=True)}
    read = motion_of(HEXABOT, Recording(columns), ground=UPHILL)
    np.testing.assert_allclose(read.poses(), motion.poses(), atol=1e-12)
    np.testing.assert_allclose(read.footing.forces, motion.footing.forces, atol=1e-9)


def test_pictures_go_with_the_body(motion):
    scene = scene_of(motion)
    first, last = scene.followed(motion.poses()[[0, -1]])
    normal = np.array(UPHILL.X_WG)[:3, 2]
    for X_WF in (first, last):
        place = X_WF[1, :3, 3]
        np.testing.assert_allclose(place[:2], 0.0, atol=1e-12)
        assert place[2] * normal[2] == pytest.approx(0.085, abs=2e-3)
    way = motion.q[-1, 4:7] - motion.q[0, 4:7]
    np.testing.assert_allclose(first[0, :2, 3] - last[0, :2, 3], way[:2], atol=1e-12)


def test_feet_that_stand_touch_the_ground(motion):
    scene = scene_of(motion)
    X_WG = np.array(UPHILL.X_WG)
    lines = [part for part in scene.parts if part.path.startswith("floor/")]
    for line in lines:
        top = (line.corners() - X_WG[:3, 3]) @ X_WG[:3, 2]
        assert top.max() == pytest.approx(0.0, abs=1e-9)
    standing = motion.footing.feet[motion.footing.stands] @ X_WG[:3, 2]
    assert np.abs(standing).max() < 2e-3


@pytest.mark.slow
def test_the_robot_is_large_in_the_picture_however_far_it_walks(motion):
    way = np.linspace(0.0, 5.0, len(motion.time))[:, np.newaxis] @ np.array([[1.0, 1.0, 0.0]])
    q = motion.q.copy()
    q[:, 4:7] += in_world(way)
    far = replace(motion, q=q)
    near, framed = (scene_of(one).framing(VIEWS["3d"]).half for one in (motion, far))
    np.testing.assert_allclose(near, framed, rtol=0.01)


@pytest.mark.slow
def test_steps_are_drawn_where_they_are(record):
    stairs = Ground(steps=Steps(height=0.02, start=0.1, run=0.1, count=2))
    scene = scene_of(motion_of(HEXABOT, record.run, ground=stairs))
    tops = [p.corners()[:, 2].max() for p in scene.parts if "stone" in p.path]
    np.testing.assert_allclose(tops, [0.02, 0.04], atol=1e-12)


@pytest.mark.slow
def test_a_page_of_ten_seconds_is_small(motion):
    longer = 10.0 / motion.duration
    footing = replace(motion.footing, time=longer * motion.time)
    walk = replace(motion, time=longer * motion.time, footing=footing)
    assert len(replay(HEXABOT, walk).html) < 4e6


def test_the_right_of_a_robot_that_walks_is_its_right_side(motion):
    for scene in (scene_of(motion), scene_of(at_rest(HEXABOT))):
        assert scene.own(VIEWS["right"]).towards == (0.0, -1.0, 0.0)
        assert scene.own(VIEWS["front"]).towards == (1.0, 0.0, 0.0)
        assert scene.own(VIEWS["top"]) is VIEWS["top"]
    assert scene_of(at_rest(LEG_B)).own(VIEWS["right"]) is VIEWS["right"]
