import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.robot.linkages import FOUR_BAR
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.robot.toml.reader import read_robot
from drake_leg.scene.showable import shown
from drake_leg.scene.viewer import joint_sliders, view, view_served

Q = np.radians([90.0, -50.0, -90.0])
LIMITED = """
name = "limited"
angles = "deg"
row = [{ sigma = 0, d = 0.1, alpha = 0, r = 0, theta = 0, limits = { lower = -30, upper = 60 } }]
"""


class Person:
    """Stands for a server and its page: carries out one command at a time, then quits."""

    def __init__(self, *commands):
        self.commands, self.answers, self.states = list(commands), [], []

    def serve(self, page, handle, feed):
        self.page, self.handle, self.feed = page, handle, feed
        self.told = feed.follow(quiet=0.01)

    def wait(self, seconds):
        assert 0.0 < seconds < 0.1
        self.states.append(next(self.told) if not self.states or self.commands else None)
        command = self.commands.pop(0) if self.commands else {"do": "quit"}
        self.answers.append(self.handle(command))

    def view(self, robot=LEG_B, q=Q):
        return view_served(robot, q, self, wait=self.wait)

    def trace(self):
        return np.array(self.feed.trace.since(-1, 0)["pieces"])


@pytest.fixture(autouse=True)
def _no_page(monkeypatch):
    monkeypatch.setattr("drake_leg.scene.viewer._page", lambda *_: "")


def joints(*values, **more):
    return {"do": "joints", "values": list(values), **more}


def test_sliders_have_the_joints_units_and_limits():
    turn = joint_sliders(shown(LEG_B), Q)[1]
    assert (turn.joint, turn.symbol, turn.low, turn.high) == ("knee", "deg", -180.0, 180.0)
    assert turn.value == pytest.approx(-50.0)
    assert turn.unit == pytest.approx(math.pi / 180.0)
    lift = joint_sliders(shown(SCARA), [0.0, 0.0, 0.0, 0.06])[3]
    assert (lift.joint, lift.symbol, lift.unit) == ("lift", "mm", 1e-3)
    assert lift.value == pytest.approx(60.0)
    (limited,) = joint_sliders(shown(read_robot(LIMITED, "limited")), [0.0])
    assert (limited.low, limited.high) == pytest.approx((-30.0, 60.0))


def test_a_posture_outside_the_limits_is_on_the_slider():
    (slider,) = joint_sliders(shown(read_robot(LIMITED, "limited")), [2.0])
    assert slider.high == slider.value == pytest.approx(math.degrees(2.0))


def test_the_sliders_move_the_robot_and_quit_ends():
    person = Person(joints(45.0, -50.0, -90.0))
    np.testing.assert_allclose(person.view(), np.radians([45.0, -50.0, -90.0]), atol=1e-12)


def test_typed_values_are_taken_exactly_and_clipped_to_the_limits():
    person = Person(joints(12.3456789012))
    assert person.view(read_robot(LIMITED, "limited"), [0.0]) == pytest.approx(
        math.radians(12.3456789012), abs=1e-15
    )
    person = Person(joints(1e9))
    assert person.view(read_robot(LIMITED, "limited"), [0.0]) == pytest.approx(math.radians(60.0))
    assert person.answers[0] == {"values": [pytest.approx(60.0)]}


def test_the_pages_are_told_posture_values_and_tip():
    person = Person(joints(45.0, -50.0, -90.0), joints(45.0, -50.0, -90.0))
    person.view()
    q = np.radians([45.0, -50.0, -90.0])
    state = person.states[1]
    np.testing.assert_allclose(state["tip"], 1e3 * foot_pose(LEG_B.rows, q)[:3, 3], atol=0.006)
    np.testing.assert_allclose(state["poses"][-1][:3], foot_pose(LEG_B.rows, q)[:3, 3], atol=1e-6)
    assert state["values"] == [45.0, -50.0, -90.0]


def test_a_slider_that_goes_far_at_once_draws_the_arc_and_no_chord():
    person = Person(joints(0.0, -50.0, -90.0))
    person.view()
    pieces = person.trace().reshape(-1, 3)
    assert len(pieces) > 20
    radius = np.hypot(*foot_pose(LEG_B.rows, Q)[:2, 3])
    np.testing.assert_allclose(np.hypot(pieces[:, 0], pieces[:, 1]), radius, rtol=1e-3)


@pytest.mark.parametrize("jump", [joints(0.0, -50.0, -90.0, put=True), {"do": "start"}])
def test_a_robot_that_is_put_somewhere_leaves_no_trace(jump):
    person = Person(jump)
    person.view()
    assert len(person.trace()) == 0


def test_buttons_take_the_robot_back_and_the_trace_away():
    person = Person(joints(90.0, -50.0, -20.0), {"do": "clear"}, {"do": "start"})
    np.testing.assert_allclose(person.view(), Q, atol=1e-12)
    assert len(person.trace()) == 0


@pytest.mark.parametrize(
    "command", [{}, {"do": "drive"}, joints(1.0), joints(1.0, 2.0, math.nan), joints(1, 2, "3")]
)
def test_a_wrong_command_is_refused_and_changes_nothing(command):
    person = Person()
    person.view()
    with pytest.raises(InvalidValueError):
        person.handle(command)
    assert person.handle({"do": "clear"}) == {"values": [pytest.approx(v) for v in (90, -50, -90)]}


def test_a_posture_of_another_size_is_refused():
    with pytest.raises(InvalidValueError, match="must be 3 long"):
        Person().view(q=[0.0])


@pytest.fixture
def views(monkeypatch):
    """Where a view was served, without a page."""
    served = []

    def view_served(_what, _q, server, *, view):
        served.append((server.url, view))
        return Q

    monkeypatch.setattr("drake_leg.scene.viewer.view_served", view_served)
    return served


def test_the_address_is_opened_or_announced(views, monkeypatch):
    opened, announced = [], []
    monkeypatch.setattr("drake_leg.scene.viewer.open_browser", lambda url: not opened.append(url))
    view(LEG_B, Q, view="top")
    view(LEG_B, Q, announce=announced.append)
    assert views == [(opened[0], "top"), (announced[0], "3d")]


def test_without_a_browser_the_address_must_be_announced(views, monkeypatch):
    monkeypatch.setattr("drake_leg.scene.viewer.open_browser", lambda _: False)
    with pytest.raises(InvalidValueError, match="no browser can be opened here: pass `announce="):
        view(LEG_B, Q)
    assert not views


def test_the_sliders_of_a_robot_with_loops_are_those_of_its_active_joints():
    loops = ClosedLoops(FOUR_BAR)
    person = Person(joints(100.0), joints(-170.0))
    q = person.view(FOUR_BAR, [1.0, 0.0, 0.0])
    assert q[0] == pytest.approx(math.radians(-170.0))
    assert loops.closure(q) <= 1e-12
    assert len(person.states[0]["values"]) == 1


def test_a_slider_stops_where_the_loops_do_not_close():
    driven = replace(FOUR_BAR, segments=tuple(map(_driven_by_the_rocker, FOUR_BAR.segments)))
    start = ClosedLoops(FOUR_BAR).position([1.0])
    q = Person(joints(5.0)).view(driven, start)
    assert q == pytest.approx(start)


def _driven_by_the_rocker(segment):
    mechanics = replace(segment.mechanics, actuated=segment.joint == "rocker")
    return segment if segment.row.joint == "fixed" else replace(segment, mechanics=mechanics)
