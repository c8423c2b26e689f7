"""The names of axes on pages in 3D: where they stand, and those of axes seen from their ends."""

from itertools import combinations

import numpy as np
import pytest

from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.scene.motion import at_rest
from drake_leg.scene.replays import replay

pytestmark = pytest.mark.slow

POSTURES = {
    "leg B": (LEG_B, np.radians([90.0, -50.0, -90.0])),
    "leg A": (LEG_A, np.radians([90.0, 50.0, 90.0])),
    "SCARA": (SCARA, [0.5, 1.5, -2.1, 0.06]),
}
NAMES = """[...document.querySelectorAll('.axis-name:not([hidden])')].map(name => {
  const mark = name.querySelector('i');
  const sign = mark.hidden ? '' : {towards: '⊙', away: '⊗'}[mark.className];
  return [sign + name.textContent, name.getBoundingClientRect().toJSON()];
})"""
TIMEOUT = 30_000


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("names")
    for name, posture in POSTURES.items():
        motion = at_rest(*posture)
        replay(motion.shown, motion).write(folder / f"{name}.html")
    return folder


@pytest.fixture
def show(keep_page, files):
    shown = []

    def opened(name, size=(1000, 800)):
        visit = keep_page((files / f"{name}.html").as_uri())
        visit.resize(*size)
        shown.append(visit)
        return visit

    yield opened
    for visit in shown:
        visit.put_back()


def look(visit, view):
    visit.click(view)
    visit.page.wait_for_function("!viewer.needs_render", timeout=TIMEOUT)


def names(visit):
    return dict(visit.page.evaluate(NAMES))


@pytest.mark.parametrize(
    ("posture", "view", "expected"),
    [
        ("leg B", "Right", {"⊙x0", "⊙z2", "⊙z3", "⊙z4"}),
        ("leg A", "Right", {"⊙x0", "⊗z2", "⊗z3", "⊗z4"}),
        ("leg B", "Top", {"⊙z0", "⊙z1"}),
        ("SCARA", "Top", {"⊙z0", "⊙z1", "⊙z2", "⊙z3", "⊗z4"}),
    ],
)
def test_an_axis_seen_from_its_end_is_named_beside_its_origin(show, posture, view, expected):
    visit = show(posture)
    look(visit, view)
    seen = names(visit)
    assert expected <= set(seen)
    assert {name[1:] for name in expected}.isdisjoint(seen)
    canvas = visit.page.locator("#meshcat-pane canvas").bounding_box()
    for name in expected:
        frame, box = int(name[-1]), seen[name]
        right, up = visit.seen([0.0, 0.0, 0.0] if frame == 0 else visit.frame(frame))
        x = canvas["x"] + canvas["width"] * (1 + right) / 2
        y = canvas["y"] + canvas["height"] * (1 - up) / 2
        middle = [(box["left"] + box["right"]) / 2, (box["top"] + box["bottom"]) / 2]
        assert 10 < np.hypot(middle[0] - x, middle[1] - y) < 40


@pytest.mark.parametrize("size", [(1000, 800), (390, 700)], ids=["desk", "phone"])
@pytest.mark.parametrize("posture", POSTURES)
def test_no_name_lies_on_another_and_none_is_cut(show, posture, size):
    visit = show(posture, size=size)
    canvas = visit.page.locator("#meshcat-pane canvas").bounding_box()
    for view in ("3D", "Right", "Front", "Top"):
        look(visit, view)
        seen = names(visit)
        assert len(seen) > 6
        for one, other in combinations(seen.values(), 2):
            across = min(one["right"], other["right"]) - max(one["left"], other["left"])
            down = min(one["bottom"], other["bottom"]) - max(one["top"], other["top"])
            assert min(across, down) < 1.0
        visit.page.evaluate(
            "(viewer.camera.zoom = 1.8, viewer.camera.updateProjectionMatrix(), viewer.set_dirty())"
        )
        visit.page.wait_for_function("!viewer.needs_render", timeout=TIMEOUT)
        seen = names(visit)
        assert all(box["left"] > -2.0 and box["right"] < size[0] + 2.0 for box in seen.values())
        low, high = canvas["y"], canvas["y"] + canvas["height"]
        assert all(box["top"] > low - 2.0 and box["bottom"] < high + 2.0 for box in seen.values())


def test_a_name_that_would_lie_on_another_or_on_an_axis_moves_aside(show):
    visit = show("leg B")
    look(visit, "Right")
    seen = names(visit)
    assert {"z0", "z1", "x1", "y0"} <= set(seen)  # z1 ends in the middle of z0
    middle = lambda box: (box["left"] + box["right"]) / 2  # noqa: E731
    assert abs(middle(seen["z1"]) - middle(seen["z0"])) > 5


def test_marks_go_with_the_frames(show):
    visit = show("leg B")
    look(visit, "Right")
    assert any(name.startswith("⊙") for name in names(visit))
    visit.click("Frames")
    visit.page.wait_for_function(
        "document.querySelectorAll('.axis-name:not([hidden])').length === 0", timeout=TIMEOUT
    )
