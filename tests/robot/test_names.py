"""Names that SDF takes, and those that it does not."""

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import require_name, require_unique
from drake_leg.robot.robots import LEG_B


@pytest.mark.parametrize("name", ["coxa", "arm_2", "left-arm", "épaule", "_x", "__x", "a1"])
def test_a_plain_name_is_taken(name):
    require_name("the link", name)


@pytest.mark.parametrize(
    "name",
    ["", "world", "__model__", "__x__", "a::b", "a b", "1a", "a/b", "a\n", "<a>", "a.b", "-a"],
)
def test_a_name_that_sdf_or_a_shell_stumbles_over_is_refused(name):
    with pytest.raises(InvalidValueError, match="the link is"):
        require_name("the link", name)


def test_a_name_given_twice_is_told_with_both_owners():
    with pytest.raises(InvalidValueError, match="'a' is given twice, to a link and to a joint"):
        require_unique([("a", "a link"), ("b", "a frame"), ("a", "a joint")])


@pytest.mark.parametrize("text", ["two\nlines", "a tab\t", "\0", "\ud800"])
def test_a_title_stands_on_one_line(text):
    with pytest.raises(InvalidValueError, match=r"title is .* one line"):
        type(LEG_B)(name="x", title=text, source="x", segments=LEG_B.segments)


def test_a_robot_checks_its_own_names():
    hip, knee, *rest = LEG_B.segments
    with pytest.raises(InvalidValueError, match="'coxa' is given twice"):
        type(LEG_B)(name="x", title="x", source="x", segments=(hip, knee, hip, *rest))
