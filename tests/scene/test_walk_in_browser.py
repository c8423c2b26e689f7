"""The replay of a walk in a browser."""

import numpy as np
import pytest

from drake_leg.robot.ground import FLAT
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.scene.footing import Footing
from drake_leg.scene.motion import PlantMotion
from drake_leg.scene.replays import replay
from drake_leg.scene.showable import shown

pytestmark = pytest.mark.slow


@pytest.fixture
def visit(open_page, tmp_path):
    time = np.linspace(0.0, 1.0, 31)
    q = np.tile(starting_posture(HEXABOT), (31, 1))
    body = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.085], (31, 1))
    body[:, 4] = 0.6 * time
    forces = np.zeros((31, 6, 3))
    forces[:, [0, 2, 4], 2] = 7.0
    footing = Footing.of(HEXABOT, time, body, q, forces, FLAT)
    plant = shown(HEXABOT)
    motion = PlantMotion(shown=plant, time=time, q=plant.whole(body, q), footing=footing)
    replay(HEXABOT, motion).write(tmp_path / "walk.html")
    return open_page((tmp_path / "walk.html").as_uri())


def body(visit):
    """Place of the body in the picture's space, x, y, z [m]."""
    x, y, z = visit.page.evaluate(
        "(() => { const { object } = viewer.scene_tree.find(['drake', 'robot', 'frame_1']);"
        " object.updateWorldMatrix(true, false);"
        " return object.matrixWorld.elements.slice(12, 15); })()"
    )
    return [x, -z, y]


def test_the_page_follows_the_robot_and_shows_what_carries_it(visit):
    assert "support margin 98 mm" in visit.page.inner_text("#page-head")
    visit.page.keyboard.press("End")
    np.testing.assert_allclose(body(visit), [0.0, 0.0, 0.085], atol=1e-6)
    orange = lambda image: (  # noqa: E731
        (image[..., 0] > 150) & (image[..., 1] < 110) & (image[..., 2] < 60)
    ).sum()
    with_forces = orange(visit.picture())
    visit.click("Forces")
    assert orange(visit.picture()) < with_forces - 200
    visit.click("Follow")
    np.testing.assert_allclose(body(visit), [0.6, 0.0, 0.085], atol=1e-6)
    before = visit.picture()
    visit.click("Support")
    assert (np.abs(visit.picture() - before).max(axis=-1) > 30).sum() > 1000
