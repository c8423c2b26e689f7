import io
import sys

import numpy as np
import pytest
from PIL import Image

from drake_leg.errors import BrokenPackageError, InvalidValueError, OutputError
from drake_leg.robot.robots import PENDULUM
from drake_leg.scene import images
from drake_leg.scene.artists import Renderer, Sketcher
from drake_leg.scene.images import require_video, still, write_stills, write_video
from drake_leg.scene.lettering import DARK, LIGHT
from drake_leg.scene.scene import VIEWS, at_rest, scene_of


def picture(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)


@pytest.mark.usefixtures("rendering")
def test_a_rendered_still_has_its_size_and_shows_something():
    image = picture(still(PENDULUM, [0.5], view="front").png)
    assert image.shape == (720, 960, 3)
    assert np.ptp(image) > 150.0


def test_where_nothing_can_be_rendered_matplotlib_draws(monkeypatch, step, tmp_path):
    monkeypatch.setattr(images, "rendering_fault", lambda: "no light")
    paths = write_stills(tmp_path, step)
    assert [path.name for path in paths] == [f"still_{name}.png" for name in VIEWS]
    pictures = [picture(path.read_bytes()) for path in paths]
    assert all(image.shape == (720, 960, 3) and np.ptp(image) > 150.0 for image in pictures)
    assert np.abs(pictures[0] - pictures[1]).max() > 100.0


@pytest.mark.usefixtures("rendering")
def test_a_still_can_be_dark():
    light, dark = (picture(still(PENDULUM, [0.5], paper=paper).png) for paper in (LIGHT, DARK))
    assert light[0, 0].min() > 240.0
    assert dark[0, 0].max() < 60.0


@pytest.mark.usefixtures("rendering")
@pytest.mark.parametrize("view", VIEWS.values(), ids=lambda view: view.name)
def test_the_whole_floor_is_in_the_picture(view):
    motion = at_rest(PENDULUM, [0.5])
    scene = scene_of(motion)
    (x, y, z), (u, v, _) = scene.floor
    corners = np.array([[x, y, z], [u, y, z], [x, v, z], [u, v, z]])
    for artist in (Sketcher, Renderer):
        pixels = artist(scene, width=960, height=720).pixels(corners, view)
        assert (pixels > 0.0).all()
        assert (pixels < [960.0, 720.0]).all()


@pytest.mark.usefixtures("rendering")
def test_a_gif_has_its_frames_and_its_pace(step, tmp_path):
    seen = []
    assert (
        write_video(
            tmp_path / "step.gif", step.shown, step, view=VIEWS["right"], progress=seen.append
        )
        == 21
    )
    with Image.open(tmp_path / "step.gif") as gif:
        assert (gif.n_frames, gif.info["duration"], gif.size) == (21, 50, (400, 300))
        first = np.asarray(gif.convert("RGB")).astype(float)
        gif.seek(20)
        last = np.asarray(gif.convert("RGB")).astype(float)
    assert np.abs(last - first).max() > 50.0
    np.testing.assert_allclose(seen, np.arange(21) / 20.0)
    assert [path.name for path in tmp_path.iterdir()] == ["step.gif"]


@pytest.mark.slow
@pytest.mark.usefixtures("rendering")
def test_an_mp4_has_thirty_frames_a_second(step, tmp_path):
    av = pytest.importorskip("av", reason="PyAV, of the extra video, is not installed")
    assert write_video(tmp_path / "step.mp4", step.shown, step) == 31
    with av.open(str(tmp_path / "step.mp4")) as file:
        stream = file.streams.video[0]
        images = [frame.to_ndarray(format="rgb24").astype(float) for frame in file.decode(stream)]
        assert (stream.average_rate, stream.width, stream.height) == (30, 800, 600)
    assert len(images) == 31
    assert np.abs(images[-1] - images[0]).max() > 50.0


def test_an_mp4_without_pyav_is_refused_in_a_sentence(step, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(BrokenPackageError, match=r"pip install 'drake-leg\[video\]'"):
        write_video(tmp_path / "step.mp4", step.shown, step)
    assert not list(tmp_path.iterdir())


def test_a_broken_pyav_or_pillow_is_found_before_any_work(tmp_path, monkeypatch):
    package = tmp_path / "av"
    package.mkdir()
    (package / "__init__.py").write_text("raise OSError('libavcodec.so.61: no such file\\nmore')")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "av", raising=False)
    with pytest.raises(BrokenPackageError, match=r"PyAV.* \(libavcodec.so.61: no such file\): pip"):
        require_video(tmp_path / "step.mp4")
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    with pytest.raises(BrokenPackageError, match="needs Pillow, which cannot be imported"):
        require_video(tmp_path / "step.gif")


def test_a_video_of_an_hour_is_refused(tmp_path):
    motion = ([0.0, 3600.0], np.zeros((2, 1)))
    with pytest.raises(InvalidValueError, match="3600 s long; a video is at most 600 s"):
        write_video(tmp_path / "long.gif", PENDULUM, motion)


def test_another_ending_is_refused(step, tmp_path):
    with pytest.raises(OutputError, match=r"does not end in \.mp4 or \.gif"):
        write_video(tmp_path / "step.avi", step.shown, step)
