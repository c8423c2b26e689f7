"""The replay page on a small phone."""

import pytest

from drake_leg.scene.replays import replay

pytestmark = pytest.mark.slow


@pytest.fixture
def file(step, tmp_path):
    replay(step.shown, step).write(tmp_path / "step.html")
    return (tmp_path / "step.html").as_uri()


def test_controls_take_three_rows_on_a_small_phone(open_page, file):
    visit = open_page(file, size=(320, 640))
    assert visit.overflow() == [0, 0]
    play, clock = (
        visit.page.locator(name).bounding_box() for name in ("#replay-play", "#replay-clock")
    )
    assert clock["y"] < play["y"] + play["height"]
    assert visit.page.locator("#page-panel").bounding_box()["height"] < 160
