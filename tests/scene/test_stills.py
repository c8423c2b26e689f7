import io

import numpy as np
import pytest
from PIL import Image

from drake_leg.robots import LEG_B, PENDULUM
from drake_leg.scene import stills
from drake_leg.scene.lettering import Words, reduced, write_on
from drake_leg.scene.motion import still
from drake_leg.scene.paper import DARK, LIGHT
from drake_leg.scene.scene import scene_of
from drake_leg.scene.sketch import Sketcher
from drake_leg.scene.stills import still_png, write_stills
from drake_leg.scene.views import VIEWS
from drake_leg.scene.vtk import Renderer


def picture(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)


@pytest.mark.usefixtures("rendering")
def test_a_rendered_still_has_its_size_and_shows_something():
    image = picture(still_png(PENDULUM, [0.5], view=VIEWS["front"]))
    assert image.shape == (720, 960, 3)
    assert np.ptp(image) > 150.0


def test_where_nothing_can_be_rendered_matplotlib_draws(monkeypatch, step, tmp_path):
    monkeypatch.setattr(stills, "rendering_fault", lambda: "no light")
    paths = write_stills(tmp_path, LEG_B, step.q[0], motion=step)
    assert [path.name for path in paths] == [f"still_{name}.png" for name in VIEWS]
    images = [picture(path.read_bytes()) for path in paths]
    assert all(image.shape == (720, 960, 3) and np.ptp(image) > 150.0 for image in images)
    assert np.abs(images[0] - images[1]).max() > 100.0


@pytest.mark.usefixtures("rendering")
def test_a_still_can_be_dark():
    light, dark = (picture(still_png(PENDULUM, [0.5], paper=paper)) for paper in (LIGHT, DARK))
    assert light[0, 0].min() > 240.0
    assert dark[0, 0].max() < 60.0


@pytest.mark.usefixtures("rendering")
@pytest.mark.parametrize("view", VIEWS.values(), ids=lambda view: view.name)
def test_the_whole_floor_is_in_the_picture(view):
    motion = still(PENDULUM, [0.5])
    scene = scene_of(motion)
    (x, y, z), (u, v, _) = scene.floor
    corners = np.array([[x, y, z], [u, y, z], [x, v, z], [u, v, z]])
    for artist in (Sketcher, Renderer):
        pixels = artist(scene, width=960, height=720).pixels(corners, view)
        assert (pixels > 0.0).all()
        assert (pixels < [960.0, 720.0]).all()


def test_words_that_would_lie_on_others_are_left_out():
    paper = np.full((40, 120, 3), 255, dtype=np.uint8)
    word = Words(text="abc", x=5, y=20, size=15)
    once = write_on(paper, [word])
    assert (once < 100).any()
    assert np.array_equal(once, write_on(paper, [word, Words(text="xyz", x=8, y=22, size=15)]))
    assert not np.array_equal(once, write_on(paper, [word, Words(text="xyz", x=70, y=20, size=15)]))
    assert (paper == 255).all()


def test_a_reduced_picture_has_the_means_of_squares(rng):
    image = rng.integers(0, 255, (8, 12, 3), dtype=np.uint8)
    means = image.reshape(4, 2, 6, 2, 3).mean(axis=(1, 3))
    assert np.abs(reduced(image, 2) - means).max() <= 0.5
