"""Blocks of the toolboxes for robots: rotations, and a vehicle that follows a path."""

import math
from itertools import product

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.spatial.transform import Rotation

from drake_leg.simulink.running.operations import cosines_of
from drake_leg.simulink.running.pursuit import pursued

SHARED = "sharedtransform"


def test_rotations_of_the_aerospace_blocks_are_those_of_scipy(tmp_path):
    angles = [0.3, -0.4, 1.1]
    turned = Rotation.from_euler("ZYX", angles)
    rig = Rig()
    given = rig.constant(str(angles))
    q = rig.block(f"{SHARED}/Rotation Angles to Quaternions", "q", given)
    dcm = rig.block(f"{SHARED}/Quaternions to Direction Cosine Matrix", "dcm", q)
    again = rig.block(f"{SHARED}/Direction Cosine Matrix to Quaternions", "again", dcm)
    back = rig.block(f"{SHARED}/Quaternions to Rotation Angles", "back", again, rotationOrder="XYZ")
    for name, sid in (("q", q), ("dcm", dcm), ("back", back)):
        rig.show(sid, name)
    found = rig.values(tmp_path)
    np.testing.assert_allclose(found["q"], np.roll(turned.as_quat(), 1), atol=1e-15)
    np.testing.assert_allclose(found["dcm"], turned.as_matrix().T, atol=1e-15)
    np.testing.assert_allclose(found["back"], turned.as_euler("XYZ"), atol=1e-14)


@pytest.mark.parametrize(
    ("pose", "ahead", "direction"),
    [
        ([0.0, 0.0, 0.0], 1.0, 0.0),
        ([0.5, 0.6, 0.0], 0.8, math.atan2(-0.6, 0.8)),  # to the nearest point, then along
        ([4.0, 1.0, math.pi / 2], 2.0, math.atan2(2.0, 0.0) - math.pi / 2),  # round the corner
        ([3.0, 0.0, 0.0], 2.0, math.atan2(1.0, 1.0)),
        ([4.0, 9.0, 0.0], 2.0, -math.pi / 2),  # beyond the end, which is the goal
    ],
)
def test_the_goal_of_a_pursuit_lies_ahead_along_the_path(pose, ahead, direction):
    path = np.array([[0.0, 0.0], [np.nan, 0.0], [4.0, 0.0], [4.0, 8.0]])
    speed, rate, found, _ = pursued(np.array(pose), path, ahead, 0.5, 10.0, -1.0)
    assert speed == 0.5
    assert found == pytest.approx(direction, abs=1e-15)
    assert rate == pytest.approx(2.0 * speed * math.sin(direction) / ahead, abs=1e-15)


def test_a_pursuit_turns_no_faster_than_it_may_and_not_straight_away():
    path = np.array([[0.0, 0.0], [4.0, 0.0]])
    assert pursued(np.array([0.0, 0.0, -1.5]), path, 0.1, 1.0, 0.2, -1.0)[1] == 0.2
    assert abs(pursued(np.array([0.0, 0.0, math.pi]), path, 1.0, 1.0, 0.3, -1.0)[1]) == 0.3


def test_a_pursuit_stays_on_its_way_where_the_path_crosses_itself():
    path = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 4.0], [2.0, -4.0]])
    before = pursued(np.array([1.9, 0.0, 0.0]), path, 0.5, 1.0, 9.0, -1.0)
    at = pursued(np.array([2.0, 0.01, 0.0]), path, 0.5, 1.0, 9.0, before[3])
    late = pursued(np.array([2.01, 0.0, -1.5]), path, 0.5, 1.0, 9.0, 3.0)
    assert [each[3] for each in (before, at, late)] == [0.0, 0.0, 3.0]


def test_a_vehicle_that_pursues_a_line_comes_to_it(tmp_path):
    """To first order, its distance y from the line obeys y'' + 2 y' v/L + 2 y (v/L)^2 = 0."""
    rig = Rig()
    place = [rig.block("Integrator", name, "", InitialCondition=start)
             for name, start in (("x", "0"), ("y", "1e-4"), ("angle", "0"))]  # fmt: skip
    pose = rig.block("Mux", "pose", *place, Inputs="3")
    chase = rig.add_library("robotalgslib/Pure Pursuit", "chase", {
        "DesiredLinearVelocity": "2", "LookaheadDistance": "1", "MaxAngularVelocity": "9",
    }, ports={"in": 2, "out": 2})  # fmt: skip
    rig.connect(pose, f"{chase}#in:1")
    rig.connect(rig.constant("[0 0; 100 0]"), f"{chase}#in:2")
    for name, wave in (("x", "cos"), ("y", "sin")):
        turned = rig.block("Trigonometry", wave, place[2], Operator=wave)
        speed = rig.block("Product", f"{name} dot", f"{chase}#out:1", turned, Inputs="2")
        rig.connect(speed, f"{place['xy'.index(name)]}#in:1")
    rig.connect(f"{chase}#out:2", f"{place[2]}#in:1")
    rig.show(place[1], "y")
    run = rig.run(tmp_path, duration=2.0)
    t = 2.0 * run.time
    exact = 1e-4 * np.exp(-t) * (np.cos(t) + np.sin(t))
    np.testing.assert_allclose(shown(run, "y"), exact, atol=1e-10)


@pytest.mark.parametrize(
    "order", ["".join(o) for o in product("XYZ", repeat=3) if o[0] != o[1] != o[2]]
)
def test_direction_cosines_are_of_three_turns(order):
    angles = np.array([0.3, -1.1, 2.5])
    expected = Rotation.from_euler(order, angles).as_matrix().T
    np.testing.assert_allclose(cosines_of(angles, order), expected, atol=1e-15)
