"""Singular assemblies of closed loops: those of known linkages, and what the doctor says."""

import math

import numpy as np
import pytest
from trees import parallelogram

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.robot.linkages import (
    BENNETT,
    COUPLER,
    CRANK,
    FOUR_BAR,
    GROUND,
    PARALLELOGRAM_ARM,
    ROCKER,
    SLIDER_CRANK,
)
from drake_leg.singularity.loop_doctor import examine_loops
from drake_leg.singularity.singular_assemblies import singular_assemblies


def toggles():
    """Crank angles at which crank and coupler of the four-bar are in line."""
    angles = []
    for reach, turn in ((COUPLER + CRANK, 0.0), (COUPLER - CRANK, math.pi)):
        cosine = (GROUND**2 + reach**2 - ROCKER**2) / (2 * GROUND * reach)
        angles.append(math.acos(cosine) - turn)
    return angles


@pytest.mark.slow
def test_the_rocker_of_a_four_bar_has_two_dead_centers():
    found = examine_loops(FOUR_BAR)
    assert [(one.kind, one.joint) for one in found.singular] == [("dead center", "rocker")] * 2
    assert sorted(one.q[0] for one in found.singular) == pytest.approx(sorted(toggles()), abs=1e-9)


@pytest.mark.slow
def test_there_a_driven_rocker_does_not_determine_the_crank():
    loops = ClosedLoops(FOUR_BAR, active=["rocker"])
    found, said = singular_assemblies(loops, ClosedLoops(FOUR_BAR).position([1.0]))
    assert [one.kind for one in found] == ["actuation"] * 2
    assert sorted(one.q[0] for one in found) == pytest.approx(sorted(toggles()), abs=1e-9)
    assert max(loops.sigma_min(one.q) for one in found) < 1e-9
    assert said == "rocker all around"


@pytest.mark.slow
def test_a_slider_has_its_dead_centers_in_line_with_the_crank():
    found = examine_loops(SLIDER_CRANK).singular
    assert {one.joint for one in found} == {"slide"}
    ends = sorted(one.q[2] for one in found)
    assert ends == pytest.approx([COUPLER - CRANK, COUPLER + CRANK], abs=1e-12)


def test_the_assemblies_of_a_parallelogram_meet_where_it_is_flat():
    loops = ClosedLoops(parallelogram(), active=["crank"])
    found, _ = singular_assemblies(loops, [0.5, -0.5, 0.5])
    assert [one.kind for one in found] == ["branching"] * 2
    for one in found:
        assert math.sin(one.q[0]) == pytest.approx(0.0, abs=1e-6)
        assert math.sin(one.q[1]) == pytest.approx(0.0, abs=1e-6)


def test_joints_outside_the_loops_are_not_searched():
    found = examine_loops(PARALLELOGRAM_ARM)
    assert {one.along for one in found.singular} == {"joint2", "joint7"}
    assert found.here == "parallelogram"
    assert "joint1" not in found.searched
    rates = dict(found.entries)["rates"]
    assert rates == "joint3' = -1 joint2' +1 joint7'"


@pytest.mark.slow
def test_a_bennett_linkage_has_no_singular_assembly():
    found = examine_loops(BENNETT)
    assert found.singular == ()
    assert "no assembly; searched along first all around" in dict(found.entries)["singular"]
    assert "perhaps not all" in dict(found.entries)["assemblies"]


@pytest.mark.slow
def test_a_posture_is_closed_first():
    given = [1.0, -0.5, 1.6]
    found = examine_loops(FOUR_BAR, given)
    assert found.q[0] == 1.0
    assert found.gap < 1e-13
    assert "after the passive joints were moved by up to 0.0" in dict(found.entries)["closure"]
    alone = examine_loops(FOUR_BAR, [1.0])
    assert alone.q == pytest.approx(found.q, abs=1e-12)
    assert alone.as_json()["freedom"] == 1
    assert np.shape(alone.as_json()["passive_rates"]) == (2, 1)
    with pytest.raises(InvalidValueError, match="q has 2 numbers; four_bar has 3 joint positions"):
        examine_loops(FOUR_BAR, [1.0, 2.0])


def test_a_posture_that_is_itself_a_branching_is_in_the_list():
    loops = ClosedLoops(PARALLELOGRAM_ARM)
    flat = np.zeros(len(loops.joints))
    flat[loops.joints.index("joint3")] = math.pi / 2  # th3 = pi/2 + th7 - th2
    assert loops.closure(flat) < 1e-12
    found, _ = singular_assemblies(loops, flat)
    assert [np.abs(np.array(one.q) - flat).max() < 1e-6 for one in found[:2]] == [True, True]
    assert {one.along for one in found[:2]} == {"joint2", "joint7"}
