"""Claimed sets of singular postures: right ones, wrong ones, and what is left out."""

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.lab.grader.printed_text import parse_text
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA

LEG = {"lengths": "mm", "angles": "deg", "symbols": {"L1": 50, "L2": 100, "L3": 100}}
ARM = {"lengths": "mm", "joints": {"lift": "452.4-340-R"}}


def graded(singular, robot=LEG_B, settings=LEG):
    return grade(robot, printed_of_document({**settings, "singular": singular}, "print.toml"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "singular",
    [
        "θ3 = kπ or L1 + L2 c2 + L3 c23 = 0",
        ["sin(q3) = 0", "L1 + L2*cos(q2) + L3*cos(q2+q3) = 0"],
        "q3 = 0 or π or 50 + 100 c2 + 100 c23 = 0",
        r"\det J = 0 \iff \theta_3 = k\pi ; L_2 c_2 = -L_1 - L_3 c_{23}",
        "|J| = 0 if q3 = 0, ±π or L1 + L2c2 + L3c23 = 0",
        "θ3 = 0 [π] or L1 + L2c2 + L3c23 = 0",
        "θ3 = n·180° or 1 + 2c2 + 2c23 = 0, n ∈ Z",
        "s3² = 0 or (1 + 2c2 + 2c23)² = 0",
        "q3 = 0 mod π ou 1 + 2c2 + 2c23 = 0",
        "θ3 = 0 + kπ, k ∈ Z ; L1 + L2 c2 + L3 c23 = 0",
        r"\theta_3 = k\pi, k\in\mathbb{Z} \text{ or } L_1 + L_2 c_2 + L_3 c_{23} = 0",
        "θ3 = kπ (k ∈ Z) or L1 + L2 c2 + L3 c23 = 0",
        "θ3 = kπ, k integer, or L1 + L2 c2 + L3 c23 = 0",
        "θ3 = kπ for all k ∈ Z; L1 + L2 c2 + L3 c23 = 0",
        "kπ = θ3, k = 0, ±1, ±2, or L1 + L2 c2 + L3 c23 = 0",
    ],
)
@pytest.mark.parametrize("robot", [pytest.param(LEG_A, marks=pytest.mark.slow), LEG_B])
def test_both_families_of_the_leg_are_right(robot, singular):
    assert graded(singular, robot) == []


@pytest.mark.parametrize("singular", ["θ2 = kπ", "sin θ2 = 0", "q2 = 0 or q2 = 180°", "s2 = 0"])
def test_the_scaras_family_is_right(singular):
    assert graded(singular, SCARA, ARM) == []


def test_a_definition_may_stand_for_a_factor():
    settings = {**LEG, "where": {"rho": "L1 + L2 c2 + L3 c23"}}
    assert graded(r"s3 = 0 or \rho = 0", settings=settings) == []


@pytest.mark.slow
def test_report_as_claim_leaves_a_family_out():
    """Erratum 10."""
    (finding,) = graded(r"\theta_3 = k\pi, k \in \mathbb{Z}", LEG_A)
    assert "singular postures are left out, such as θ1 = " in finding.fault
    assert finding.remedy == "add L1 + L2*cos(θ2) + L3*cos(θ2 + θ3) = 0"


def test_report_bs_claim_of_every_joint_is_wrong_for_all_but_one():
    """Erratum 16."""
    (finding,) = graded("|J| = 0 when qi = 0 or π, i = 1, 2, 3", SCARA, ARM)
    said, _, posture = finding.fault.partition(" are not singular: at ")
    assert said == "q1 = 0, q3 = 0, q1 = π and q3 = π"
    assert posture.endswith("° the determinant is not zero")
    assert finding.remedy == "leave them out; the determinant is zero where q2 = kπ"


@pytest.mark.slow
def test_half_a_family_is_not_all_of_it():
    numbers = graded("q3 = kπ", settings={"lengths": "mm"})
    assert {f.remedy for f in numbers} == {"add 100*cos(q2) + 100*cos(q2 + q3) + 50 = 0"}
    assert {f.remedy for f in graded("q3 = 0 or 1 + 2c2 + 2c23 = 0")} == {"add q3 = kπ"}
    remedies = {f.remedy for f in graded("q2 = 90° and q3 = 30°")}
    assert remedies == {"add q3 = kπ", "add L1 + L2*cos(q2) + L3*cos(q2 + q3) = 0"}


@pytest.mark.slow
def test_a_set_without_postures_is_named():
    assert graded("cos(q2) = 3")[0].fault == "no posture was found at which cos(q2) = 3"


@pytest.mark.parametrize(
    "singular",
    [
        "the leg is stretched",
        "θ3 ≠ 0",
        "q2 = 0, q3 = 0",
        "θ3 = kπ, k ∈ Z, L1 + L2 c2 + L3 c23 = 0",
        "qi = 0",
        "θ3 = kπ + nπ",
        r"\rho = 0",
        "sin(q3) = 0 = q2",
        "q3 = (0",
        "q3 = " + " or ".join(map(str, range(60))),
        "x" * 5000,
    ],
)
def test_what_is_no_set_is_not_understood(singular):
    (finding,) = graded(singular)
    assert not finding.understood
    assert finding.remedy


def test_a_robot_without_a_square_jacobian_has_no_singular_postures():
    settings = {"lengths": "m", "angles": "rad"}
    assert "no square Jacobian" in graded("q1 = 0", PENDULUM, settings)[0].fault


def test_without_factors_a_posture_is_named(monkeypatch):
    monkeypatch.setattr(
        "drake_leg.lab.grader.claims.RightForms.determinant_factors", lambda *arguments: []
    )
    (finding,) = graded("θ3 = kπ")
    assert finding.remedy == "add the other zeros of the determinant"


def test_sets_and_determinants_are_read_from_text():
    text = "|J| = 0 when qi = 0 or π, i = 1, 2, 3\nL1 = 50\n|J| = 5 s2\nT01,1,0\n"
    text += r"$\det J = 0 \iff \theta_3 = k\pi$"
    document = parse_text(text, "x.txt")
    assert document["singular"] == [text.splitlines()[0], text.splitlines()[-1]]
    assert document["matrix"][0] == {"name": "|J|", "entries": "5 s2"}
    assert parse_text("singular,qi = 0, i = 1, 2", "x.csv") == {"singular": ["qi = 0, i = 1, 2"]}


def test_sets_are_read_from_csv_and_must_be_text():
    assert parse_text("singular,θ3 = kπ\nsingular,s2 = 0\n", "x.csv") == {
        "singular": ["θ3 = kπ", "s2 = 0"]
    }
    with pytest.raises(InvalidValueError, match="singular is 3; it must be text"):
        graded(3)


@pytest.mark.slow
@pytest.mark.parametrize(
    "equation",
    [
        "L1 + L3*c2 + L2*c23 = 0",
        "L1 + 2*L1*c2 + L2*c23 = 0",
        "0.5*L2 + L2*c2 + L3*c23 = 0",
    ],
)
def test_an_equation_that_holds_for_equal_lengths_only_is_wrong(equation):
    (finding,) = graded(f"q3 = kπ or {equation}")
    assert finding.fault == f"{equation} is singular for L1 = 50, L2 = 100, L3 = 100 only"
    assert finding.remedy.endswith("q3 = kπ or L1 + L2*c2 + L3*c23 = 0")


@pytest.mark.parametrize(
    "equation", ["a + L*c2 + L*c23 = 0", "a + 100*c2 + L*c23 = 0", "1 + L/a*c2 + L/a*c23 = 0"]
)
def test_one_symbol_may_stand_for_two_equal_lengths(equation):
    settings = {**LEG, "symbols": {"a": 50, "L": 100}}
    assert graded(f"q3 = kπ or {equation}", settings=settings) == []


@pytest.mark.slow
def test_a_factor_has_the_names_of_its_lengths():
    settings = {**LEG, "symbols": {"L_coxa": 50, "L_femur": 100, "L_tibia": 100}}
    (finding,) = graded("θ3 = kπ", settings=settings)
    assert finding.remedy == "add L_coxa + L_femur*cos(θ2) + L_tibia*cos(θ2 + θ3) = 0"


@pytest.mark.parametrize("angle", ["q3 = k*180", "q3 = 0 or 180", "180k = q3", "sind(q3) = 0"])
def test_bare_numbers_are_degrees_where_angles_are(angle):
    assert graded(f"{angle}; L1 + L2 cosd(q2) + L3 cosd(q2 + q3) = 0") == []


@pytest.mark.slow
def test_bare_numbers_are_radians_where_no_unit_is_said():
    settings = {"lengths": "mm", "symbols": LEG["symbols"]}
    assert graded("q3 = 3.14159k or L1 + L2 c2 + L3 c23 = 0", settings=settings) == []
    fault, *_ = graded("q3 = 180k or L1 + L2 c2 + L3 c23 = 0", settings=settings)
    assert "write 180° for 180" in fault.remedy


@pytest.mark.slow
def test_postures_are_in_degrees():
    (finding, _) = graded("q3 = 90 or L1 + L2 c2 + L3 c23 = 0")
    assert "q3 = 90° the determinant is not zero" in finding.fault
