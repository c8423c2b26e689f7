import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.scene.scene import VIEWS, as_view, frame


@pytest.mark.parametrize("view", VIEWS.values(), ids=str)
def test_the_axes_of_a_view_are_a_rotation_with_z_up(view):
    R = view.axes
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert R[2, 1] >= 0.0
    assert abs(R[2, 0]) < 1e-15


def test_the_reports_views_look_along_the_axes():
    np.testing.assert_allclose(as_view("right").axes, [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    np.testing.assert_allclose(as_view("top").axes, np.eye(3), atol=2e-4)


@pytest.mark.parametrize("aspect", [0.5, 1.0, 16 / 9])
@pytest.mark.parametrize("view", VIEWS.values(), ids=str)
def test_every_point_is_inside_the_picture(view, aspect, rng):
    points = rng.normal(size=(200, 3)) * [0.1, 0.3, 0.2] + [1.0, -2.0, 0.5]
    framing = frame(view, points)
    seen = (points - framing.camera(aspect)) @ view.axes
    assert (seen[:, 2] < 0.0).all()
    slopes = np.abs(seen[:, :2] / seen[:, 2:]) / math.tan(view.field / 2.0)
    assert slopes[:, 1].max() < 1.0
    assert slopes[:, 0].max() < aspect
    assert max(slopes[:, 1].max(), slopes[:, 0].max() / aspect) > 0.7


def test_another_view_is_refused():
    with pytest.raises(InvalidValueError, match="no view 'left'; the views are 3d, right"):
        as_view("left")


@pytest.mark.parametrize(
    ("view", "title"),
    [
        ("3d", "Hexabot leg B"),
        ("right", "Hexabot leg B, from the right"),
        ("front", "Hexabot leg B, from the front"),
        ("top", "Hexabot leg B, from the top"),
    ],
)
def test_a_title_says_from_where(view, title):
    assert VIEWS[view].titled("Hexabot leg B") == title
