"""All assemblies of closed loops: in closed form, or by a search that says how complete it is."""

import math
from dataclasses import replace

import numpy as np
import pytest
from trees import parallelogram

from drake_leg.kinematics import assemblies as module
from drake_leg.kinematics.assemblies import assemblies
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.linkages import (
    BENNETT,
    FIVE_BAR,
    FOUR_BAR,
    PARALLELOGRAM_ARM,
    SLIDER_CRANK,
)
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.tree import Loop

RNG = np.random.default_rng(14)


def test_a_parallelogram_has_a_crossed_assembly():
    loops = ClosedLoops(parallelogram(), active=["crank"])
    found = {one.name: one.q for one in assemblies(loops, [0.7]).found}
    assert set(found) == {"parallelogram", "crossed"}
    assert found["parallelogram"] == pytest.approx((0.7, -0.7, 0.7), abs=1e-13)
    assert found["crossed"][2] != pytest.approx(0.7, abs=0.1)


def test_the_assemblies_of_a_flat_parallelogram_meet():
    loops = ClosedLoops(parallelogram(), active=["crank"])
    (only,) = assemblies(loops, [0.0]).found
    assert only.q == pytest.approx((0.0, 0.0, 0.0), abs=1e-7)


def test_the_arm_has_the_parallelogram_and_the_crossed_assembly():
    loops = ClosedLoops(PARALLELOGRAM_ARM)
    both = assemblies(loops, [0.3, -1.2, 0.5, 0.1, 0.2, -0.7])
    assert [one.name for one in both.found] == ["parallelogram", "crossed"]
    parallel = both.found[0].q
    assert parallel[2] == pytest.approx(math.pi / 2 - 0.7 + 1.2, abs=1e-13)


@pytest.mark.parametrize("robot", [FOUR_BAR, FIVE_BAR, PARALLELOGRAM_ARM], ids=lambda r: r.name)
def test_closed_form_and_search_agree(robot, monkeypatch):
    loops = ClosedLoops(robot)
    start = loops.position([s.mechanics.position_target.value for s in _active(loops)])
    q_a = start[loops.active_columns] + RNG.uniform(-0.1, 0.1, len(loops.active))
    exact = assemblies(loops, q_a)
    assert exact.complete
    assert exact.how == "in closed form"
    assert all(loops.closure(one.q) <= 1e-14 for one in exact.found)
    monkeypatch.setattr(module, "_triangle", lambda *given: module._search(given[0], *given[2:], 2))
    searched = assemblies(loops, q_a)
    assert searched.complete
    assert "there are no more than 2" in searched.how
    for one in exact.found:
        nearest = min(loops.distance(np.array(one.q), np.array(o.q)) for o in searched.found)
        assert nearest < 1e-12


def _active(loops):
    return [loops.robot.moving[column] for column in loops.active_columns]


def test_a_slider_crank_has_two_assemblies_and_none_out_of_reach():
    loops = ClosedLoops(SLIDER_CRANK)
    both = assemblies(loops, [1.0])
    assert [one.name for one in both.found] == ["1", "2"]
    assert both.complete
    assert both.found[0].q[2] == pytest.approx(0.2 * math.cos(1.0) - both.found[1].q[2])


@pytest.mark.slow
def test_a_search_says_how_complete_it_is():
    found = assemblies(ClosedLoops(BENNETT), [1.0])
    assert len(found.found) == 1
    assert not found.complete
    assert "the last 159 found none that is new" in found.how


def test_a_four_bar_does_not_close_beyond_its_dead_centers():
    loops = ClosedLoops(FOUR_BAR, active=["rocker"])
    assert assemblies(loops, [0.1]).found == ()
    assert assemblies(loops, [0.1]).complete


def test_cranks_that_lie_on_each_other_close_in_infinitely_many_ways():
    def moving(name, **row):
        return Segment(row=Row(joint="revolute", **row), joint=name, link=Link(name=f"{name}_bar"))

    rows = (
        moving("first"),
        moving("second", d=0.5),
        moving("third", antecedent=0),
        moving("fourth", d=0.5),
        Segment(row=Row(joint="revolute", d=0.5, antecedent=2)),
        Segment(row=Row(joint="fixed", d=0.5, antecedent=4)),
    )
    passive = JointMechanics(actuated=False)
    rows = tuple(
        replace(one, mechanics=passive) if one.joint in ("second", "fourth") else one
        for one in rows
    )
    loops = ClosedLoops(
        Robot(
            name="rhombus",
            title="Rhombus",
            source="test",
            segments=rows,
            loops=(Loop(joint="cut", cut=5, end=6),),
        )
    )
    for crank in (0.0, 0.4, 0.5, 1.0):
        together = assemblies(loops, [crank, crank])
        assert not together.complete
        assert "infinitely many" in together.how
        (one,) = together.found
        assert loops.closure(np.array(one.q)) < 1e-12
    apart = assemblies(loops, [0.4, 0.9])
    assert (len(apart.found), apart.complete) == (2, True)
