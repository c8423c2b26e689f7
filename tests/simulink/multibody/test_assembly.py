"""Loops closed near the state targets, compared with the closed form of a four-bar."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, four_bar, pendulum

from drake_leg.simulink.multibody.assembly import Assembly

GROUND, CRANK, COUPLER, ROCKER = 0.4, 0.1, 0.35, 0.25


def closed_form(crank):
    """Angles of coupler and rocker from the triangle that the diagonal makes [rad]."""
    x, y = CRANK * math.cos(crank), CRANK * math.sin(crank)
    diagonal, along = math.hypot(GROUND - x, y), math.atan2(-y, GROUND - x)
    at_coupler = math.acos((COUPLER**2 + diagonal**2 - ROCKER**2) / (2.0 * COUPLER * diagonal))
    return along, at_coupler


@pytest.mark.parametrize("degrees", [20, 60, 100, 170])
def test_a_four_bar_closes_where_its_triangles_do(tmp_path, degrees):
    texts = {"PositionTargetSpecify": "on", "PositionTargetValue": str(degrees)}
    built = four_bar(GROUND, CRANK, COUPLER, ROCKER, **texts)
    q, gap = Assembly(built.mechanism(tmp_path)).closed()
    assert gap < 1e-10
    crank = math.radians(degrees)
    assert q[0] == pytest.approx(crank, abs=1e-12)  # its target has high priority
    along, at_coupler = closed_form(crank)
    coupler = (q[0] + q[1] - along + math.pi) % math.tau - math.pi
    assert abs(coupler) == pytest.approx(at_coupler, abs=1e-9)


@pytest.mark.slow
def test_targets_give_way_where_they_contradict_each_other(tmp_path):
    texts = {"PositionTargetSpecify": "on", "PositionTargetValue": "40"}
    built = four_bar(**texts).set("B", **texts).set("C", **texts)
    assembly = Assembly(built.mechanism(tmp_path))
    q, gap = assembly.closed()
    assert gap < 1e-10
    assert np.abs(q - assembly.targets[:3]).max() > 1e-3


@pytest.mark.slow
def test_what_cannot_close_says_how_far_it_is_apart(tmp_path):
    _, gap = Assembly(four_bar(ground=2.0).mechanism(tmp_path)).closed()
    assert gap > 0.5


def test_a_tree_stays_at_its_targets(tmp_path):
    texts = {"PositionTargetSpecify": "on", "PositionTargetValue": "40"}
    q, gap = Assembly(pendulum(**texts).mechanism(tmp_path)).closed()
    assert (q.tolist(), gap) == ([pytest.approx(math.radians(40))], 0.0)


def random_joints(kind, *, reverse):
    """Two bodies in a loop of joints of a kind, each out of line, the first one reversed."""
    built = MechanismBuilder()
    ends = ("rconn:1", "lconn:1") if reverse else ("lconn:1", "rconn:1")
    before = "World"
    for number in (1, 2, 3):
        built.joint(kind, f"J{number}")
        built.transform(f"T{number}", offset=f"[0.3 -0.{number} 0.5]", axis="+X", angle="35")
        built.meet(before, f"J{number} {ends[0]}")
        built.meet(f"J{number} {ends[1]}", f"T{number} lconn:1")
        before = f"T{number}"
        ends = ("lconn:1", "rconn:1")
    built.lines[0].ports.append(f"{built.sid('T3')}#rconn:1")
    return built


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("kind", ["Revolute", "Prismatic", "Spherical", "Planar", "Bushing"])
def test_derivatives_of_the_gaps_are_exact(tmp_path, kind, reverse, derivative, rng):
    assembly = Assembly(random_joints(kind, reverse=reverse).mechanism(tmp_path))
    q = rng.uniform(-1.0, 1.0, len(assembly.targets))
    _, J = assembly._linearized(q)
    for column, step in enumerate(np.eye(len(q))):
        expected = derivative(lambda t, step=step: assembly.gaps(q + t * step))
        np.testing.assert_allclose(J[:, column], expected, atol=1e-9)


def test_a_loop_that_is_stretched_out_is_closed_and_nothing_else_moves(tmp_path):
    built = four_bar()
    built.joint("Revolute", "Aside")
    built.body("Spherical Solid", "Ball", SphereRadius="0.1")
    built.meet("World", "Aside lconn:1")
    built.meet("Aside", "Ball")
    mechanism = built.mechanism(tmp_path)
    places = {joint.name: place for place, joint in enumerate(mechanism.joints)}
    q, gap = Assembly(mechanism).assembled({places["A"]: 0.0})
    assert gap < 1e-10
    assert q[places["A"]] == q[places["Aside"]] == 0.0
    assert abs(q[places["B"]]) > 0.1
