import sys

import numpy as np
import pytest

from drake_leg.cli import main
from drake_leg.robot.robots import LEG_B
from drake_leg.scene import artists
from drake_leg.scene.artists import Renderer, Sketcher
from drake_leg.scene.motion import at_rest
from drake_leg.scene.scene import scene_of
from drake_leg.scene.views import VIEWS

POSTURE = np.radians([90.0, -50.0, -90.0])


def artist(kind, scene):
    if kind == "matplotlib":
        return Sketcher(scene, width=320, height=240)
    return Renderer(scene, width=320, height=240)


@pytest.mark.parametrize("view", VIEWS.values(), ids=lambda view: view.name)
@pytest.mark.parametrize("kind", ["vtk", "matplotlib"])
@pytest.mark.usefixtures("rendering")
def test_points_are_seen_where_they_are_said_to_be(kind, view):
    motion = at_rest(LEG_B, POSTURE)
    scene, poses = scene_of(motion), motion.poses()[0]
    picture = artist(kind, scene)
    image = picture.image(poses, view).astype(float)
    assert image.shape == (240, 320, 3)
    beyond_femur = poses[2] @ [0.05, 0.0, 0.0, 1.0]
    ((x, y),) = picture.pixels(beyond_femur[np.newaxis, :3], view)
    red, _, blue = image[round(y), round(x)]
    if view.name == "top":  # the femur lies under nothing but the tibia's end
        assert not np.allclose(image[round(y), round(x)], image[2, 2], atol=8.0)
    else:
        assert red > blue + 40.0  # orange


@pytest.mark.usefixtures("rendering")
def test_both_artists_put_points_at_the_same_place():
    motion = at_rest(LEG_B, POSTURE)
    scene = scene_of(motion)
    points = motion.poses()[0, :, :3, 3]
    for name in ("right", "front", "top"):
        rendered = artist("vtk", scene).pixels(points, VIEWS[name])
        drawn = artist("matplotlib", scene).pixels(points, VIEWS[name])
        np.testing.assert_allclose(rendered, drawn, atol=6.0)  # one of them has a perspective


@pytest.mark.parametrize("view", VIEWS.values(), ids=lambda view: view.name)
@pytest.mark.usefixtures("rendering")
def test_nothing_is_lost_where_the_renderer_leaves_out_the_edges(view, monkeypatch):
    motion = at_rest(LEG_B, POSTURE)
    part = artist("vtk", scene_of(motion)).image(motion.poses()[0], view).astype(float)
    monkeypatch.setattr(artists, "EDGE", 1.0)
    whole = artist("vtk", scene_of(motion)).image(motion.poses()[0], view).astype(float)
    assert np.array_equal(part[0], whole[0])
    assert (np.abs(part - whole).max(axis=-1) > 64.0).sum() <= 2  # edges are smoothed otherwise


@pytest.mark.slow
def test_a_renderer_that_ends_its_process_ends_in_a_sentence(monkeypatch, capsys):
    """The process is that of the trial."""
    if artists.rendering_fault() is not None or sys.platform != "linux":
        pytest.skip("this variable only takes away what Linux renders with")
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json")
    fault = artists.rendering_fault.__wrapped__()
    assert fault is not None
    for module in ("artists", "media"):
        monkeypatch.setattr(f"drake_leg.scene.{module}.rendering_fault", lambda: fault)
    assert main(["replay", "nowhere", "--out", "nothing.gif"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("drake-leg: no picture can be rendered here, OpenGL is missing")
    assert said.count("\n") == 1


def test_the_reason_is_the_last_line_that_the_trial_leaves(monkeypatch):
    monkeypatch.setattr(artists, "TRIAL", "raise ValueError('no light')")
    assert artists.rendering_fault.__wrapped__() == "ValueError: no light"
    monkeypatch.setattr(artists, "TRIAL", "raise SystemExit(7)")
    assert artists.rendering_fault.__wrapped__() == "exit status 7"


def test_a_process_that_is_told_tries_nothing(monkeypatch):
    monkeypatch.setattr(artists, "TRIAL", "raise SystemExit(7)")
    monkeypatch.setattr(artists, "_TOLD", [])
    artists.tell_rendering("no light")
    assert artists.rendering_fault() == "no light"
    monkeypatch.undo()
    artists.rendering_fault.cache_clear()


def test_a_trial_that_hangs_is_given_up(monkeypatch):
    monkeypatch.setattr(artists, "TRIAL", "import time; time.sleep(60)")
    monkeypatch.setattr(artists, "PATIENCE", 0.2)
    assert artists.rendering_fault.__wrapped__() == "TimeoutExpired"


def test_the_trial_of_the_renderer_fails_for_no_reason_of_its_own():
    """Its code is a text, whose imports nothing else looks at: a fault would pass for VTK's."""
    imports = [line for line in artists.TRIAL.splitlines() if line.startswith(("import", "from"))]
    assert imports
    exec("\n".join(imports), {})
