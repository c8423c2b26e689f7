import json
import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.robot.robots import LEG_B, ROBOTS
from drake_leg.scene import web_page as web_pages
from drake_leg.scene.motion import at_rest
from drake_leg.scene.scene import scene_of
from drake_leg.scene.views import MARGIN, VIEWS
from drake_leg.scene.web_page import (
    MeshcatError,
    PageError,
    open_meshcat,
    pose_rows,
    replaced,
    stage_data,
    templates,
    web_page,
)

TEMPLATE = """{% extends "page.html" %}{% block panel %}<p>words</p>{% endblock %}
{% block scripts %}<script>go();</script>{% endblock %}"""


def test_a_page_holds_its_data_its_words_and_what_is_drawn_besides():
    drawn = []
    page = web_page(
        scene_of(at_rest(LEG_B, [0.1] * 3)),
        templates().from_string(TEMPLATE),
        title="a < b",
        data={"end": "</script>"},
        heading="c < d",
        draw_more=drawn.append,
    )
    assert len(drawn) == 1
    assert "<title>a &lt; b</title>" in page
    assert "<h1>c &lt; d</h1>" in page
    assert page.index("<p>words</p>") < page.index("go();")
    data = re.search(r'id="page-data">(.*?)</script>', page, re.DOTALL)[1]
    assert json.loads(data) == {"end": "</script>"}


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_points_that_a_page_holds_frame_the_scene(robot):
    scene = scene_of(at_rest(robot, [0.1] * len(robot.moving)))
    points = np.array(stage_data(scene, VIEWS["3d"])["points"])
    assert len(points) < 300
    for view in VIEWS.values():
        seen, all_seen = points @ view.axes, scene.held @ view.axes
        assert (seen.max(axis=0) >= all_seen.max(axis=0) - 1e-6).all()
        assert (seen.min(axis=0) <= all_seen.min(axis=0) + 1e-6).all()
    assert MARGIN > 1.0


def test_poses_are_places_and_quaternions():
    X_WF = at_rest(LEG_B, [0.3, -0.5, 1.0]).poses()
    rows = pose_rows(X_WF)
    assert rows.shape == (*X_WF.shape[:2], 7)
    R = Rotation.from_quat(rows[0, :, [4, 5, 6, 3]].T).as_matrix()
    np.testing.assert_allclose(R, X_WF[0, :, :3, :3], atol=1e-14)
    np.testing.assert_array_equal(rows[..., :3], X_WF[..., :3, 3])


def test_a_page_of_meshcat_that_is_not_known_is_refused():
    with pytest.raises(PageError, match="has no </body>"):
        replaced("<html>", "</body>", "")


def test_without_a_port_for_meshcat_there_is_no_page(monkeypatch):
    def none_free(settings):
        raise RuntimeError

    monkeypatch.setattr(web_pages, "Meshcat", none_free)
    with pytest.raises(MeshcatError, match="finds no free port from 7000 to 7999"):
        open_meshcat()
