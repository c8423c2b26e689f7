"""Forces and support, over the pictures of a robot that walks."""

import numpy as np
import pytest

from drake_leg.robot.ground import FLAT
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.scene.artists import Sketcher
from drake_leg.scene.footing import Footing
from drake_leg.scene.media import walking_still
from drake_leg.scene.motion import PlantMotion
from drake_leg.scene.scene import scene_of
from drake_leg.scene.showable import shown
from drake_leg.scene.views import VIEWS
from drake_leg.scene.walk_overlay import (
    arrows,
    draw_footing,
    margin_in_words,
    newtons_a_square,
    overlay_rows,
)

TRIPOD = [0, 2, 4]  # left front, left rear, right middle


@pytest.fixture(scope="module")
def motion():
    """A robot at rest on three feet, two of which carry as much as the third."""
    q = np.array([starting_posture(HEXABOT)] * 2)
    body = np.array([[1.0, 0.0, 0.0, 0.0, 0.3, 0.1, 0.085]] * 2)
    forces = np.zeros((2, 6, 3))
    forces[:, TRIPOD, 2] = 5.0, 5.0, 10.0
    time = np.array([0.0, 1.0])
    footing = Footing.of(HEXABOT, time, body, q, forces, FLAT)
    plant = shown(HEXABOT)
    return PlantMotion(shown=plant, time=time, q=plant.whole(body, q), footing=footing)


def test_arrows_are_as_long_as_forces_are_strong(motion):
    scene = scene_of(motion)
    square = scene.floor_square
    lengths = np.linalg.norm(arrows(scene, motion.footing)[0], axis=-1)
    unit = newtons_a_square(scene, motion.footing)
    np.testing.assert_allclose(lengths[TRIPOD], np.array([5.0, 5.0, 10.0]) * square / unit)
    assert (lengths[[1, 3, 5]] == 0.0).all()


def test_the_support_goes_around_the_loaded_feet(motion):
    footing = motion.footing
    assert sorted(footing.support(0)) == TRIPOD
    assert footing.margins[0] == pytest.approx(0.098, abs=5e-4)  # as docs/walking.md has it
    row = overlay_rows(scene_of(motion), footing)[0]
    assert sorted(row[-6:]) == [-1.0, -1.0, -1.0, 0.0, 2.0, 4.0]
    np.testing.assert_allclose(row[39:42], [0.3, 0.1, 0.0], atol=2e-3)  # under the center of mass


def test_a_margin_is_said_with_its_sign():
    assert margin_in_words(0.0784) == "support margin 78 mm"
    assert margin_in_words(-0.01) == "support margin −10 mm"
    assert margin_in_words(-np.inf) == "no foot is loaded"


def test_a_picture_has_an_arrow_at_each_loaded_foot_and_a_mark_below_the_center(motion):
    scene, view = scene_of(motion), VIEWS["3d"]
    artist = Sketcher(scene, width=480, height=360)
    blank = np.full((360, 480, 3), 255, dtype=np.uint8)
    image = draw_footing(blank, artist, view, scene, motion.footing, 0, 1).astype(int)
    footing, body = motion.footing, motion.footing.origin[0]

    def at(point):
        x, y = artist.pixels(np.array([point]) - body, view)[0].astype(int)
        return image[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3)

    ways = arrows(scene, footing)[0]
    for foot, way in zip(footing.feet[0][TRIPOD], ways[TRIPOD], strict=True):
        red, green, blue = at(foot + 0.5 * way).T
        assert ((red > 180) & (green < 130) & (blue < 60)).any()
    assert at(footing.below[0]).max(axis=1).min() < 60
    for foot in footing.feet[0][[1, 3, 5]]:
        assert not ((at(foot)[:, 0] > 180) & (at(foot)[:, 2] < 60)).any()


@pytest.mark.slow
def test_a_still_of_a_walk_is_made_at_a_time(motion):
    assert walking_still(motion, 0.4).png[1:4] == b"PNG"
    assert motion.at(0.9).time[0] == 1.0
