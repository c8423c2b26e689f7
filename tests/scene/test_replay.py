import base64
import html.parser
import json
import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError, OutputError
from drake_leg.robot.robots import LEG_B, ROBOTS
from drake_leg.scene.replay import replay
from drake_leg.scene.scene import PlantMotion, at_rest
from drake_leg.scene.shown_plant import shown


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
