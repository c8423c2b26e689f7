"""The proof: four witnesses agree, and one that does not is named."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.feet import greatest_reach, random_configurations, ranges
from drake_leg.kinematics.khalil import table_length
from drake_leg.models.proof import TOLERANCE, DrakeWitness, difference_jacobian, prove
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import LEG_B, ROBOTS, SCARA
from drake_leg.symbolic import derivation
from drake_leg.symbolic.table import row_transform, table_of_rows


def bare(*rows, **mechanics):
    """Make a robot of a table alone; the mechanics are the first joint's."""
    segments = [
        Segment(
            row=row, joint=f"joint_{i}", link=Link(name=f"link_{i}"),
            mechanics=JointMechanics(**(mechanics if i == 0 else {})),
        )
        for i, row in enumerate(rows)
    ]  # fmt: skip
    return Robot(name="bare", title="Bare", source="test", segments=tuple(segments))


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_reports_robots_are_proved(robot):
    proof = prove(robot)
    assert proof.holds
    assert proof.worst.difference < 1e-14
    quantities = [(c.quantity, c.first, c.second) for c in proof.comparisons]
    assert len(set(quantities)) == 10
    assert ("torques", "SymPy", "Drake") in quantities
    assert ("Jacobian", "chain", "differences") in quantities


@pytest.mark.slow
def test_the_same_seed_gives_the_same_proof():
    assert prove(LEG_B, samples=3, seed=5) == prove(LEG_B, samples=3, seed=5)
    assert prove(LEG_B, samples=3, seed=5) != prove(LEG_B, samples=3, seed=6)


def test_right_angles_everywhere_lose_no_digit_on_the_way_through_sdf():
    right = math.pi / 2
    rows = [
        Row(joint="revolute", d=0.3, alpha=alpha, r=0.2, theta=theta)
        for alpha in (right, -right)
        for theta in (right, -right)
    ]
    assert prove(bare(*rows)).worst.difference < 1e-14


@pytest.mark.parametrize("size", [1e-4, 1e3])
def test_lengths_are_compared_relative_to_the_robots_size(size):
    rows = [Row(joint="revolute", d=size, alpha=0.3, r=size) for _ in range(3)]
    proof = prove(bare(*rows))
    assert proof.size == pytest.approx(6 * size)
    assert proof.holds


@pytest.mark.parametrize(("entry", "value"), [((0, 3), 1e-9), ((1, 1), 1e-9)])
def test_a_witness_that_differs_is_named_with_its_entry(entry, value, monkeypatch):
    honest = DrakeWitness.foot

    def lies_once(self, q, row):
        pose = honest(self, q)
        pose[entry] += value if q[0] > 0.0 else 0.0
        return pose

    monkeypatch.setattr(DrakeWitness, "foot", lies_once)
    proof = prove(LEG_B)
    worst = proof.worst
    assert not proof.holds
    assert "Drake" in (worst.first, worst.second)
    assert (worst.quantity, worst.entry) == ("foot", (entry[0] + 1, entry[1] + 1))
    assert worst.q[0] > 0.0
    assert abs(worst.values[1] - worst.values[0]) == pytest.approx(value, rel=1e-5)
    assert [c.agrees for c in proof.comparisons].count(False) == 2


def test_a_witness_without_a_number_proves_nothing(monkeypatch):
    monkeypatch.setattr(DrakeWitness, "foot", lambda self, q, row: np.full((4, 4), np.nan))
    proof = prove(LEG_B)
    assert not proof.holds
    assert math.isnan(proof.worst.difference)


def test_differences_over_a_quarter_turn_are_the_derivative(rng):
    for robot in (*ROBOTS, bare(Row(joint="prismatic", alpha=0.4), Row(joint="revolute", d=0.7))):
        q = rng.uniform(-3.0, 3.0, (7, len(robot.moving)))
        exact = khalil.jacobian(robot.rows, q)
        np.testing.assert_allclose(difference_jacobian(robot.rows, q), exact, atol=1e-14)


@pytest.mark.parametrize(
    "arguments", [{"samples": 0}, {"samples": 10**9}, {"seed": -1}, {"budget": 0.0}]
)
def test_senseless_numbers_are_refused(arguments):
    with pytest.raises(InvalidValueError, match=r"samples|seed|budget"):
        prove(LEG_B, **arguments)


def test_the_proof_as_json_has_the_greatest_differences():
    proof = prove(SCARA, samples=2)
    content = json.loads(json.dumps(proof.as_json()))
    assert content["holds"] is True
    assert content["tolerance"] == TOLERANCE
    assert len(content["comparisons"][0]["q_rad_or_m"]) == 4


def test_a_proof_shows_itself_in_a_notebook(monkeypatch):
    html = prove(LEG_B, samples=2)._repr_html_()
    assert "leg_b: proved: none is above 1e-12 (2 random configurations" in html
    assert html.count("<td>yes</td>") == 10
    monkeypatch.setattr(DrakeWitness, "foot", lambda self, q, row: np.full((4, 4), np.nan))
    html = prove(LEG_B, samples=2)._repr_html_()
    assert "NOT proved" in html
    assert html.count("<td>NO</td>") == 2
    html = prove(LEG_B, samples=2, budget=1e-9)._repr_html_()
    assert html.count("<td>not compared</td>") == 9


def test_configurations_stay_within_the_limits(rng):
    robot = bare(Row(joint="prismatic", r=0.5), Row(joint="revolute", d=0.25), lower=0.1, upper=0.2)
    q = random_configurations(robot, 200, rng)
    assert q.min(axis=0) == pytest.approx([0.1, -math.pi], abs=0.1)
    assert ((q[:, 0] > 0.1) & (q[:, 0] < 0.2)).all()
    assert greatest_reach(robot) == pytest.approx(0.75 + 0.2)


@pytest.mark.parametrize(
    ("mechanics", "expected"),
    [
        ({}, (-math.pi, math.pi)),
        ({"lower": 1.0}, (1.0, 1.0 + 2 * math.pi)),
        ({"upper": 1.0}, (1.0 - 2 * math.pi, 1.0)),
        ({"lower": -1.0, "upper": 1.0}, (-1.0, 1.0)),
    ],
)
def test_a_joint_without_a_limit_goes_round_once(mechanics, expected):
    (found,) = ranges(bare(Row(joint="revolute"), **mechanics))
    assert found == pytest.approx(expected)


def test_a_chain_without_lengths_counts_as_a_metre_long():
    assert table_length([Row(joint="revolute")]) == 1.0


def test_what_the_budget_does_not_reach_is_missing_and_said(monkeypatch, for_ever):
    monkeypatch.setattr("drake_leg.symbolic.derivation.jacobian_function", for_ever)
    stages = []
    proof = prove(LEG_B, samples=2, budget=3.0, progress=stages.append)
    assert proof.holds
    assert not proof.complete
    missing = [(one.quantity, one.witness) for one in proof.missing]
    assert missing == [("Jacobian", "SymPy"), ("torques", "Drake"), ("torques", "SymPy")]
    assert {one.why for one in proof.missing} == {"not done within 3 s: give it more with `budget`"}
    assert len(proof.comparisons) == 6
    assert stages[-3] == "Jacobian by SymPy"
    assert proof.as_json()["complete"] is False


ODD = (
    Row(joint="prismatic", d=0.1, alpha=0.3, r=-0.2, theta=1.1),
    Row(joint="fixed", d=-0.4, alpha=-2.0, r=0.05, theta=math.pi / 3),
    Row(joint="revolute", d=0.2, alpha=math.pi / 4, theta=-0.7),
    Row(joint="revolute", d=0.3, r=0.1),
    Row(joint="fixed", d=0.1, alpha=math.pi / 2, r=0.2),
)


@pytest.mark.parametrize("broken", ["chain", "SymPy"])
@pytest.mark.parametrize("index", range(len(ODD)))
@pytest.mark.parametrize("field", ["d", "alpha", "r", "theta"])
def test_one_slip_in_one_row_of_one_witness_is_found_and_named(broken, index, field, monkeypatch):
    row = ODD[index]
    slip = replace(row, **{field: getattr(row, field) + 1e-9})
    rows = (*ODD[:index], slip, *ODD[index + 1 :])
    if broken == "SymPy":
        monkeypatch.setattr(derivation, "table_of_rows", lambda _, real=table_of_rows: real(rows))
    else:
        monkeypatch.setattr(khalil, "foot_pose", lambda _, q, real=khalil.foot_pose: real(rows, q))
    proof = prove(bare(*ODD), samples=4)
    assert not proof.holds
    wrong = [c for c in proof.comparisons if not c.agrees and c.quantity == "foot"]
    assert [broken in (c.first, c.second) for c in wrong] == [True, True]


@pytest.mark.parametrize("method", ["foot_function", "jacobian_function"])
def test_a_wrong_formula_of_a_row_is_found(method, monkeypatch):
    def turned_backwards(row):
        return row_transform(replace(row, theta=-row.theta))

    honest = getattr(derivation, method)

    def dishonest(rows):
        with monkeypatch.context() as patch:
            patch.setattr(derivation, "row_transform", turned_backwards)
            return honest(rows)

    monkeypatch.setattr(derivation, method, dishonest)
    proof = prove(LEG_B, samples=4)
    wrong = {c.quantity for c in proof.comparisons if not c.agrees}
    assert wrong == {"foot" if method == "foot_function" else "Jacobian"}
    assert all("SymPy" in (c.first, c.second) for c in proof.comparisons if not c.agrees)


@pytest.mark.slow
def test_long_chains_are_proved(rng):
    rows = [
        Row(joint="revolute", d=d, alpha=alpha, r=r, theta=theta)
        for d, r, alpha, theta in rng.uniform(-0.3, 0.3, (20, 4))
    ]
    proof = prove(bare(*rows))
    assert proof.holds
    assert proof.complete


def test_a_budget_that_is_over_at_once_proves_nothing():
    proof = prove(LEG_B, samples=2, budget=1e-9)
    assert (proof.comparisons, proof.worst) == ((), None)
    assert len(proof.missing) == 9
