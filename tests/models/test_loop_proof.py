"""Closed loops are proved in closed postures: the cut joint's motion is what the frames do."""

from dataclasses import replace

import pytest
from trees import parallelogram

from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.kinematics.loop_cuts import CutMotion, Cuts
from drake_leg.models.proof import prove
from drake_leg.models.witnesses import DrakeWitness
from drake_leg.robot.linkages import FOUR_BAR, LINKAGES, SLIDER_CRANK_CUT_AT_SLIDE


@pytest.mark.slow
@pytest.mark.parametrize("robot", LINKAGES, ids=lambda robot: robot.name)
def test_linkages_are_proved(robot):
    proof = prove(robot, samples=6)
    assert proof.holds
    assert proof.complete
    assert proof.worst.difference < 1e-13
    cut = robot.loops[0].joint
    compared = {(c.quantity, c.first, c.second) for c in proof.comparisons}
    assert (f"closure at {cut}", "loops", "Drake") in compared
    assert (f"rates at {cut}", "loops", "SymPy") in compared
    assert (f"Jacobian of frame_{robot.loops[0].end}", "chain", "Drake") in compared


def test_a_wrong_cut_joint_is_named(monkeypatch):
    honest = Cuts.motion

    def lying(self, q, qdot, qddot):
        position, velocity, acceleration = honest(self, q, qdot, qddot)
        return CutMotion(position + 1e-9, velocity, acceleration)

    monkeypatch.setattr(Cuts, "motion", lying)
    proof = prove(SLIDER_CRANK_CUT_AT_SLIDE, samples=3)
    assert not proof.holds
    assert (proof.worst.quantity, proof.worst.first) == ("closure at slide", "loops")


@pytest.mark.slow
def test_wrong_rates_of_passive_joints_are_named(monkeypatch):
    honest = ClosedLoops.W

    def lying(self, q):
        W = honest(self, q)
        W[-1] *= 1.0 + 1e-9
        return W

    monkeypatch.setattr(ClosedLoops, "W", lying)
    proof = prove(FOUR_BAR, samples=3)
    assert not proof.holds
    assert (proof.worst.quantity, proof.worst.first) == ("rates at pin", "loops")


def test_another_model_in_drake_is_named(monkeypatch):
    segments = list(FOUR_BAR.segments)
    segments[4] = replace(segments[4], row=replace(segments[4].row, d=0.25 + 1e-9))
    other = DrakeWitness(replace(FOUR_BAR, segments=tuple(segments)))
    honest = DrakeWitness.pose
    monkeypatch.setattr(DrakeWitness, "pose", lambda _, *given: honest(other, *given))
    proof = prove(FOUR_BAR, samples=3)
    assert not proof.holds
    wrong = {c.quantity for c in proof.comparisons if not c.agrees}
    assert "closure at pin" in wrong


def test_loops_that_cannot_be_closed_are_missing():
    proof = prove(parallelogram(), samples=2)  # all of its joints are actuated
    assert proof.holds
    (missing,) = proof.missing
    assert "has 1 degree of freedom with its loops closed" in missing.why
