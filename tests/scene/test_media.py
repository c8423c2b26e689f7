import base64
import html.parser
import io
import json
import re
import sys

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from drake_leg.errors import BrokenPackageError, InvalidValueError, OutputError
from drake_leg.robot.robots import LEG_B, PENDULUM, ROBOTS
from drake_leg.scene import media
from drake_leg.scene.artists import Renderer, Sketcher
from drake_leg.scene.lettering import DARK, LIGHT
from drake_leg.scene.media import Still, require_video, still, write_video
from drake_leg.scene.motion import PlantMotion, at_rest
from drake_leg.scene.replays import Replay, replay
from drake_leg.scene.scene import scene_of
from drake_leg.scene.showable import shown
from drake_leg.scene.views import VIEWS


def picture(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)


@pytest.mark.slow
@pytest.mark.usefixtures("rendering")
def test_a_rendered_still_has_its_size_and_shows_something():
    image = picture(still(PENDULUM, [0.5], view="front").png)
    assert image.shape == (720, 960, 3)
    assert np.ptp(image) > 150.0


@pytest.mark.slow
def test_where_nothing_can_be_rendered_matplotlib_draws(monkeypatch, step):
    monkeypatch.setattr(media, "rendering_fault", lambda: "no light")
    stills = [still(step.shown, step.q[0], view=view, motion=step) for view in VIEWS]
    pictures = [picture(one.png) for one in stills]
    assert all(image.shape == (720, 960, 3) and np.ptp(image) > 150.0 for image in pictures)
    assert np.abs(pictures[0] - pictures[1]).max() > 100.0


@pytest.mark.slow
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


@pytest.mark.slow
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


def test_a_path_is_a_text_or_a_path(step):
    with pytest.raises(InvalidValueError, match="target is 3; it must be a str or Path"):
        write_video(3, step.shown, step)
    for picture in (Still(b""), Replay("a", "a page")):
        with pytest.raises(InvalidValueError, match="path is 3; it must be a str or Path"):
            picture.write(3)


def test_another_ending_is_refused(step, tmp_path):
    with pytest.raises(OutputError, match=r"does not end in \.mp4 or \.gif"):
        write_video(tmp_path / "step.avi", step.shown, step)


class Addresses(html.parser.HTMLParser):
    """Collects what a page's tags would load."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found += [value for name, value in attrs if name in ("src", "href", "data", "action")]


def data_of(page):
    return json.loads(re.search(r'id="page-data">(.*?)</script>', page, re.DOTALL)[1])


@pytest.fixture(scope="module")
def page(step):
    return replay(step.shown, step).html


def test_the_page_is_one_file_of_less_than_4_megabytes(page):
    assert len(page.encode()) < 4e6
    addresses = Addresses()
    addresses.feed(page)
    assert addresses.found == []


def test_the_page_holds_the_poses_of_the_recorded_joint_positions(page, step):
    data = data_of(page)
    rows = np.frombuffer(base64.b64decode(data["poses"]), "<f4").reshape(-1, len(data["paths"]), 7)
    X_WF = step.sampled(data["rate"]).poses()[:, 1:]
    assert data["paths"][-1].endswith("frame_4")
    np.testing.assert_allclose(rows[..., :3], X_WF[..., :3, 3], atol=1e-7)
    R = Rotation.from_quat(rows[..., [4, 5, 6, 3]].reshape(-1, 4).astype(float)).as_matrix()
    np.testing.assert_allclose(R, X_WF[..., :3, :3].reshape(-1, 3, 3), atol=3e-7)
    assert data["duration"] == pytest.approx(1.0)


@pytest.mark.parametrize("end", [0.01, 1.0, 2.65139769, 7.77])
def test_a_replay_ends_where_its_motion_ends(end):
    motion = PlantMotion(
        shown=shown(LEG_B), time=np.array([0.0, end]), q=np.array([[1.0] * 3, [0.5] * 3])
    )
    data = data_of(replay(motion.shown, motion).html)
    rows = np.frombuffer(base64.b64decode(data["poses"]), "<f4").reshape(-1, len(data["paths"]), 7)
    np.testing.assert_allclose(rows[-1, -1, :3], motion.paths()[0][-1], atol=1e-7)
    assert data["duration"] == pytest.approx(end, rel=1e-9)
    assert data["rate"] >= 30.0
    assert (len(rows) - 1) / data["rate"] == pytest.approx(end, rel=1e-9)


def test_the_page_names_the_robot_and_its_views(page):
    assert "<title>Hexabot leg B: replay</title>" in page
    assert "$" not in re.search(r"<header.*?</header>", page, re.DOTALL)[0]
    assert [view["label"] for view in data_of(page)["views"]] == ["3D", "Right", "Front", "Top"]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_every_robot_at_rest_has_a_page(robot):
    assert data_of(replay(robot, at_rest(robot, [0.1] * len(robot.moving))).html)["duration"] == 0.0


def test_a_replay_of_an_hour_is_refused():
    motion = PlantMotion(shown=shown(LEG_B), time=np.array([0.0, 3600.0]), q=np.zeros((2, 3)))
    with pytest.raises(InvalidValueError, match="at most 600 s"):
        replay(motion.shown, motion)


def test_a_page_is_named_after_its_run(step):
    page = replay(step.shown, step, title="Leg <B>: the step", note="stopped at 1 s: & so on").html
    assert "<title>Leg &lt;B&gt;: the step: replay</title>" in page
    assert "<h1>Leg &lt;B&gt;: the step</h1>" in page
    assert "<summary>stopped at 1 s: &amp; so on</summary>" in page


def test_a_page_that_is_there_stays(step, tmp_path):
    (tmp_path / "a.html").write_text("mine")
    with pytest.raises(OutputError, match=r"a\.html exists"):
        replay(step.shown, step).write(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text() == "mine"
