"""Six-axis arms of textbooks: their tables make their published transforms."""

from pathlib import Path

import numpy as np
import pytest

from drake_leg.kinematics.khalil import foot_pose
from drake_leg.lab.grader.table_slips import lint_table
from drake_leg.lab.grader.tables import table_of_document
from drake_leg.models.proof import prove
from drake_leg.robot.robot import Row
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.toml.keys import parse_document
from drake_leg.robot.toml.reader import ClassicRow, khalil_rows, read_robot
from drake_leg.robot.toml.writer import robot_toml

ROBOTS = Path(__file__).parents[1] / "lab" / "grader" / "robots"
FILES = sorted(ROBOTS.glob("*.toml"))


def cosines_and_sines(q):
    """Return C1, S1, ..., C6, S6, C23, S23 of a posture."""
    pairs = [(np.cos(angle), np.sin(angle)) for angle in (*q, q[1] + q[2])]
    return [value for pair in pairs for value in pair]


def pose(s, n, a, p):
    """Put a transform together from its three axes and its position."""
    return np.vstack([np.transpose([s, n, a, p]), [0.0, 0.0, 0.0, 1.0]])


def khalil_and_dombres_rx90(q, D3=0.45, RL4=0.45):
    """Direct geometric model, Khalil and Dombre, example 3.1."""
    C1, S1, C2, S2, _, _, C4, S4, C5, S5, C6, S6, C23, S23 = cosines_and_sines(q)
    return pose(
        [
            C1 * (C23 * (C4 * C5 * C6 - S4 * S6) - S23 * S5 * C6) - S1 * (S4 * C5 * C6 + C4 * S6),
            S1 * (C23 * (C4 * C5 * C6 - S4 * S6) - S23 * S5 * C6) + C1 * (S4 * C5 * C6 + C4 * S6),
            S23 * (C4 * C5 * C6 - S4 * S6) + C23 * S5 * C6,
        ],
        [
            C1 * (-C23 * (C4 * C5 * S6 + S4 * C6) + S23 * S5 * S6) + S1 * (S4 * C5 * S6 - C4 * C6),
            S1 * (-C23 * (C4 * C5 * S6 + S4 * C6) + S23 * S5 * S6) - C1 * (S4 * C5 * S6 - C4 * C6),
            -S23 * (C4 * C5 * S6 + S4 * C6) - C23 * S5 * S6,
        ],
        [
            -C1 * (C23 * C4 * S5 + S23 * C5) + S1 * S4 * S5,
            -S1 * (C23 * C4 * S5 + S23 * C5) - C1 * S4 * S5,
            -S23 * C4 * S5 + C23 * C5,
        ],
        [-C1 * (S23 * RL4 - C2 * D3), -S1 * (S23 * RL4 - C2 * D3), C23 * RL4 + S2 * D3],
    )


def craigs_puma560(q, a2=0.4318, a3=0.0203, d3=0.12446, d4=0.43307):
    """Transform from frame 6 to frame 0, Craig, equation 3.14."""
    c1, s1, c2, s2, _, _, c4, s4, c5, s5, c6, s6, c23, s23 = cosines_and_sines(q)
    return pose(
        [
            c1 * (c23 * (c4 * c5 * c6 - s4 * s6) - s23 * s5 * c6) + s1 * (s4 * c5 * c6 + c4 * s6),
            s1 * (c23 * (c4 * c5 * c6 - s4 * s6) - s23 * s5 * c6) - c1 * (s4 * c5 * c6 + c4 * s6),
            -s23 * (c4 * c5 * c6 - s4 * s6) - c23 * s5 * c6,
        ],
        [
            c1 * (c23 * (-c4 * c5 * s6 - s4 * c6) + s23 * s5 * s6) + s1 * (c4 * c6 - s4 * c5 * s6),
            s1 * (c23 * (-c4 * c5 * s6 - s4 * c6) + s23 * s5 * s6) - c1 * (c4 * c6 - s4 * c5 * s6),
            -s23 * (-c4 * c5 * s6 - s4 * c6) + c23 * s5 * s6,
        ],
        [
            -c1 * (c23 * c4 * s5 + s23 * c5) - s1 * s4 * s5,
            -s1 * (c23 * c4 * s5 + s23 * c5) + c1 * s4 * s5,
            s23 * c4 * s5 - c23 * c5,
        ],
        [
            c1 * (a2 * c2 + a3 * c23 - d4 * s23) - d3 * s1,
            s1 * (a2 * c2 + a3 * c23 - d4 * s23) + d3 * c1,
            -a3 * s23 - a2 * s2 - d4 * c23,
        ],
    )


def fu_gonzalez_and_lees_puma560(q, a2=0.4318, a3=-0.02032, d2=0.14909, d4=0.43307, d6=0.05625):
    """Arm matrix, Fu, Gonzalez and Lee, equation 2.2-40."""
    C1, S1, C2, S2, _, _, C4, S4, C5, S5, C6, S6, C23, S23 = cosines_and_sines(q)
    return pose(
        [
            C1 * (C23 * (C4 * C5 * C6 - S4 * S6) - S23 * S5 * C6) - S1 * (S4 * C5 * C6 + C4 * S6),
            S1 * (C23 * (C4 * C5 * C6 - S4 * S6) - S23 * S5 * C6) + C1 * (S4 * C5 * C6 + C4 * S6),
            -S23 * (C4 * C5 * C6 - S4 * S6) - C23 * S5 * C6,
        ],
        [
            C1 * (-C23 * (C4 * C5 * S6 + S4 * C6) + S23 * S5 * S6) - S1 * (-S4 * C5 * S6 + C4 * C6),
            S1 * (-C23 * (C4 * C5 * S6 + S4 * C6) + S23 * S5 * S6) + C1 * (-S4 * C5 * S6 + C4 * C6),
            S23 * (C4 * C5 * S6 + S4 * C6) + C23 * S5 * S6,
        ],
        [
            C1 * (C23 * C4 * S5 + S23 * C5) - S1 * S4 * S5,
            S1 * (C23 * C4 * S5 + S23 * C5) + C1 * S4 * S5,
            -S23 * C4 * S5 + C23 * C5,
        ],
        [
            C1 * (d6 * (C23 * C4 * S5 + S23 * C5) + S23 * d4 + a3 * C23 + a2 * C2)
            - S1 * (d6 * S4 * S5 + d2),
            S1 * (d6 * (C23 * C4 * S5 + S23 * C5) + S23 * d4 + a3 * C23 + a2 * C2)
            + C1 * (d6 * S4 * S5 + d2),
            d6 * (C23 * C5 - S23 * C4 * S5) + C23 * d4 - a3 * S23 - a2 * S2,
        ],
    )


@pytest.mark.parametrize(
    ("name", "published"),
    [
        ("rx90", khalil_and_dombres_rx90),
        ("puma560_modified", craigs_puma560),
        ("puma560_classic_craig", craigs_puma560),
        ("puma560_classic", fu_gonzalez_and_lees_puma560),
    ],
)
def test_a_table_makes_the_published_transform(name, published, rng):
    robot = load_robot(ROBOTS / f"{name}.toml")
    for q in rng.uniform(-np.pi, np.pi, (20, 6)):
        np.testing.assert_allclose(foot_pose(robot.rows, q), published(q), rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=pytest.mark.slow if "classic" in path.stem else ())
        for path in FILES
    ],
)
def test_an_arm_is_proved_against_sympy_and_drake(path):
    proof = prove(load_robot(path), samples=8)
    assert proof.holds, proof.worst


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_linter_finds_nothing_in_a_textbooks_table(path):
    document = parse_document(path.read_text(encoding="utf-8"), path.name)
    assert not lint_table(table_of_document(document))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_an_arm_is_written_in_khalils_convention_and_read_back(path):
    robot = load_robot(path)
    text = robot_toml(robot)
    assert 'convention = "khalil"' in text
    assert read_robot(text, path.name) == robot


def test_classic_rows_become_khalil_rows_and_a_fixed_tool_row():
    rows = [
        ClassicRow(joint="revolute", theta=0.1, d=0.2, a=0.3, alpha=0.4),
        ClassicRow(joint="prismatic", theta=0.5, d=0.6, a=0.7, alpha=0.8),
    ]
    assert khalil_rows(rows) == (
        Row(joint="revolute", r=0.2, theta=0.1),
        Row(joint="prismatic", d=0.3, alpha=0.4, r=0.6, theta=0.5),
        Row(joint="fixed", d=0.7, alpha=0.8),
    )


def test_any_classic_table_is_the_product_of_its_own_transforms(rng):
    """Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha), row after row."""
    for _ in range(20):
        numbers = rng.uniform(-2.0, 2.0, (4, 4))
        kinds = ["revolute", "prismatic", "fixed", "revolute"]
        rows = [
            ClassicRow(joint=kind, theta=theta, d=d, a=a, alpha=alpha)
            for kind, (theta, d, a, alpha) in zip(kinds, numbers.tolist(), strict=True)
        ]
        q = rng.uniform(-2.0, 2.0, 3)
        turned = [q[0], 0.0, 0.0, q[2]]
        slid = [0.0, q[1], 0.0, 0.0]
        expected = np.eye(4)
        for (theta, d, a, alpha), more_theta, more_d in zip(numbers, turned, slid, strict=True):
            expected = expected @ classic_transform(theta + more_theta, d + more_d, a, alpha)
        np.testing.assert_allclose(foot_pose(khalil_rows(rows), q), expected, rtol=0, atol=1e-13)


def classic_transform(theta, d, a, alpha):
    """Craig's "other" convention, as most textbooks print it."""
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array(
        [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    )
