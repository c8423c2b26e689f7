"""Trees, floating bases and poses of the base in Drake."""

from dataclasses import replace

import numpy as np
import pytest
from trees import bar, hexapod, parallelogram, turning, two_fingers

from drake_leg import LEG_B, Robot, build_plant, prove
from drake_leg.robot.robot import Row, Segment
from drake_leg.robot.tree import Loop


def crossed():
    """Two branches in turns, so that no row's antecedent is the row before, and no foot."""
    return Robot(
        name="crossed",
        title="Rows of two branches in turns",
        source="a test",
        segments=(
            turning("a1", bar("a", 0.1)),
            turning("b1", bar("b", 0.1), d=0.2, gamma=0.3, antecedent=0),
            turning("a2", bar("c", 0.2), d=0.1, alpha=0.4, antecedent=1),
            turning("b2", bar("d", 0.2), d=0.1, b=0.1, alpha=-0.4, antecedent=2),
            Segment(row=Row(joint="revolute", d=0.2, antecedent=3)),
            Segment(row=Row(joint="fixed", d=0.2, antecedent=4)),
        ),
        loops=(Loop(joint="cut", cut=5, end=6),),
    )


@pytest.mark.parametrize(
    "robot",
    [two_fingers(), pytest.param(hexapod(), marks=pytest.mark.slow), parallelogram(), crossed()],
    ids=lambda robot: robot.name,
)
def test_a_tree_is_proved_at_every_leaf(robot):
    proof = prove(robot, samples=4)
    assert proof.holds
    assert proof.complete == (not robot.loops)  # these loops have no posture that joints determine
    assert len(proof.comparisons) == len(robot.leaves) * (3 + 6) + 1
    assert {c.quantity for c in proof.comparisons} == {
        f"{quantity} of {leaf}" for quantity in ("foot", "Jacobian") for leaf in robot.leaves
    } | {"torques"}


def test_a_floating_body_has_six_more_coordinates_and_falls():
    robot = hexapod()
    plant = build_plant(robot)
    assert plant.num_velocities() == 6 + 18
    assert plant.num_positions() == 7 + 18
    context = plant.CreateDefaultContext()
    X_W0 = plant.GetFrameByName("frame_0").CalcPoseInWorld(context).GetAsMatrix4()
    assert np.abs(X_W0 - np.array(robot.base_pose)).max() < 1e-15
    accelerations = plant.EvalTimeDerivatives(context).CopyToVector()[plant.num_positions() :]
    fall = np.zeros(6 + 18)
    fall[5] = -9.80665
    assert accelerations == pytest.approx(fall, abs=1e-9)


def test_the_base_stands_where_its_pose_says():
    X_W0 = ((0, 0, 1, 0.5), (0, 1, 0, 0), (-1, 0, 0, 0.2), (0, 0, 0, 1))
    robot = replace(LEG_B, base_pose=X_W0)
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    foot = plant.GetFrameByName("frame_4").CalcPoseInWorld(context).translation()
    assert np.abs(foot - np.array(X_W0)[:3, :3] @ [0.25, 0, 0] - [0.5, 0, 0.2]).max() < 1e-15
    assert prove(robot, samples=2).holds


def test_a_loop_is_open_in_the_plant_and_its_cut_is_a_frame():
    plant = build_plant(parallelogram())
    assert plant.num_positions() == 3
    context = plant.CreateDefaultContext()
    cut, end = (
        plant.GetFrameByName(f"frame_{row}").CalcPoseInWorld(context).translation()
        for row in (4, 5)
    )
    assert cut.tolist() == pytest.approx([0.5, 0.0, 0.0])
    assert end.tolist() == pytest.approx([0.5, 0.0, 0.0])
