"""The camera of pages in 3D: where it may go, and that the views are as before wherever it was."""

import json
import math

import numpy as np
import pytest

from drake_leg.scene.replays import replay
from drake_leg.scene.views import MARGIN

pytestmark = pytest.mark.slow

VIEWS = ("Right", "Top", "3D", "Front")
TIMEOUT = 30_000
QUICK = 20  # notches of the wheel in one event


@pytest.fixture(scope="module")
def file(step, tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "step.html"
    replay(step.shown, step).write(path)
    return path.as_uri()


@pytest.fixture
def visit(keep_page, file):
    visit = keep_page(file, size=(500, 400))
    yield visit
    visit.put_back()


def wait_for(visit, condition):
    visit.page.wait_for_function(condition, timeout=TIMEOUT)


def heights(visit):
    """Heights of the camera, of what it turns around and of the floor [m]."""
    return visit.page.evaluate(
        "[viewer.camera.position.y, viewer.controls.target.y,"
        " JSON.parse(document.getElementById('page-data').textContent).floor]"
    )


def drag(visit, down, button="left"):
    """Drag the picture downwards from its middle, in steps, beyond the window if need be."""
    box = visit.page.locator("#meshcat-pane canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    visit.page.mouse.move(x, y)
    visit.page.mouse.down(button=button)
    visit.page.mouse.move(x, y + down, steps=8)
    visit.page.mouse.up(button=button)


def turn_the_wheel(visit, notches):
    box = visit.page.locator("#meshcat-pane canvas").bounding_box()
    visit.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    for turned in range(0, abs(notches), QUICK):
        visit.page.mouse.wheel(0, math.copysign(100 * min(QUICK, abs(notches) - turned), notches))


def test_the_camera_turns_down_to_the_horizon_and_no_further(visit):
    before = heights(visit)[0]
    drag(visit, -280)
    wait_for(visit, f"viewer.camera.position.y < {before - 0.01}")
    camera, target, floor = heights(visit)
    assert camera == pytest.approx(target, abs=1e-6)
    assert target > floor
    drag(visit, 280)
    wait_for(visit, "viewer.camera.position.y > viewer.controls.target.y + 0.1")


def test_the_camera_is_not_shifted_under_the_floor(visit):
    before = heights(visit)[1]
    for _ in range(6):
        drag(visit, -280, button="right")
    wait_for(visit, f"viewer.controls.target.y < {before - 0.01}")
    drag(visit, -280)
    wait_for(visit, "viewer.camera.position.y - viewer.controls.target.y < 1e-6")
    camera, target, floor = heights(visit)
    assert camera >= floor - 1e-6
    assert target == pytest.approx(floor, abs=1e-6)


def test_the_wheel_zooms_at_once_and_the_robot_is_never_lost(visit):
    away = "viewer.camera.position.distanceTo(viewer.controls.target)"
    first = visit.page.evaluate(away)
    turn_the_wheel(visit, 3)
    wait_for(visit, f"{away} > {1.1 * first}")
    assert visit.page.locator("#page-hint").count() == 0
    turn_the_wheel(visit, 60)
    wait_for(visit, f"{away} > {2 * first}")
    depths = visit.page.evaluate(
        "['frame_1', 'frame_4'].map(name => viewer.scene_tree.find(['drake', 'robot', name]).object"
        ".getWorldPosition(new MeshCat.THREE.Vector3())"
        ".project((viewer.camera.updateMatrixWorld(), viewer.camera)).z)"
    )
    assert max(depths) < 1.0
    turn_the_wheel(visit, -120)
    wait_for(visit, f"{away} < {0.5 * first}")
    assert visit.page.evaluate(away) > visit.page.evaluate("2 * viewer.camera.near")


def test_shifting_never_loses_the_robot(visit):
    off = "viewer.controls.target.distanceTo(viewer.controls.cursor)"
    first = visit.page.evaluate("viewer.camera.position.distanceTo(viewer.controls.target)")
    for _ in range(6):
        drag(visit, -280, button="right")
    wait_for(visit, f"{off} > {0.1 * first}")
    assert visit.page.evaluate(off) <= 0.5 * first + 1e-6


def test_views_are_the_same_wherever_the_camera_was(visit):
    data = json.loads(visit.page.inner_text("#page-data"))
    views = {view["label"]: view for view in data["views"]}
    targets = dict(zip(views, data["targets"], strict=True))
    for name, notches in zip(VIEWS, (12, -12, 12, -12), strict=True):
        drag(visit, -280)
        drag(visit, -280, button="right")
        turn_the_wheel(visit, notches)
        wait_for(visit, "!document.querySelector('#page-views [aria-pressed=true]')")
        visit.click(name)
        camera, target = (
            np.array(visit.page.evaluate(f"viewer.{where}.toArray()"))[[0, 2, 1]] * [1, -1, 1]
            for where in ("camera.position", "controls.target")
        )
        np.testing.assert_allclose(target, targets[name], atol=1e-9)
        away = np.linalg.norm(camera - target)
        np.testing.assert_allclose((camera - target) / away, views[name]["axes"][2], atol=1e-9)
        seen = np.abs([visit.seen(point) for point in data["points"]])
        assert seen.max() == pytest.approx(1.0 / MARGIN, abs=1e-3)
