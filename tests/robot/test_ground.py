import json
import math
from dataclasses import asdict

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.ground import EDGE, FLAT, Blocks, Ground, Steps, ground_from


def test_the_x_axis_rises_by_the_slope_and_the_left_side_by_the_slope_across():
    assert np.array_equal(FLAT.X_WG, np.eye(4))
    up = np.array(Ground(slope=0.2).X_WG)
    assert up[:3, 0] == pytest.approx([math.cos(0.2), 0.0, math.sin(0.2)])
    aside = np.array(Ground(across=0.3).X_WG)
    assert aside[:3, 1] == pytest.approx([0.0, math.cos(0.3), math.sin(0.3)])
    R = np.array(Ground(slope=0.2, across=-0.3).X_WG)[:3, :3]
    assert R[2, 0] == pytest.approx(math.sin(0.2))
    assert pytest.approx(np.eye(3)) == R @ R.T
    assert np.linalg.det(R) == pytest.approx(1.0)
    # First the slope, about y; then across, about the new x.
    assert pytest.approx(up[:3, :3] @ np.array(Ground(across=-0.3).X_WG)[:3, :3]) == R


def test_stairs_have_a_tread_after_every_step():
    stairs = Ground(steps=Steps(height=0.02, run=0.25, start=0.5, count=3))
    x = [-1.0, 0.499, 0.5, 0.749, 0.75, 1.0, 40.0]
    assert stairs.height(x, 0.0) == pytest.approx([0.0, 0.0, 0.02, 0.02, 0.04, 0.06, 0.06])
    down = Ground(steps=Steps(height=-0.02, run=0.25, start=0.5, count=2))
    assert down.height([0.4, 0.5, 0.6, 0.9], 3.0) == pytest.approx([0.0, 0.0, -0.02, -0.04])


def test_blocks_are_random_within_their_height_and_the_same_for_the_same_seed():
    blocks = Blocks(height=0.03, seed=7)
    heights = blocks.heights
    assert heights.shape == (25, 16)
    assert heights.min() >= 0.0
    assert 0.025 < heights.max() <= 0.03
    assert np.array_equal(heights, Blocks(height=0.03, seed=7).heights)
    assert not np.array_equal(heights, Blocks(height=0.03, seed=8).heights)
    ground = Ground(blocks=blocks)
    x, y = 0.30 + 0.05 * 3.5, (5.5 - 8) * 0.05
    assert ground.height(x, y) == heights[3, 5]
    assert ground.height([0.29, 1.56, 0.4, 1e300], [0.0, 0.0, 0.41, 0.0]).tolist() == [0.0] * 4


def test_the_height_is_the_top_of_the_highest_slab(rng):
    ground = Ground(steps=Steps(height=0.01, count=4), blocks=Blocks(height=0.05, rows=9))
    x, y = rng.uniform(-0.2, 1.5, 3000), rng.uniform(-0.6, 0.6, 3000)
    low, high = np.moveaxis(np.array(ground.slabs()), 1, 0)
    above = [
        ((low[:, :2] <= point) & (point <= high[:, :2])).all(axis=1)
        for point in zip(x, y, strict=True)
    ]
    tops = [high[inside, 2].max() for inside in above]
    np.testing.assert_allclose(ground.height(x, y), tops, atol=1e-15)
    assert len(low) == 5 + 9 * 16
    assert (low[:2, 0] == [-EDGE, 0.3]).all()
    assert (high[:5, :2] == EDGE).all()


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Ground(friction=-0.1), r"friction of the ground is -0\.1; it must be zero or"),
        (lambda: Ground(friction=math.nan), "friction of the ground is nan"),
        (lambda: Ground(slope=10.0), r"slope of the ground is 10 rad; it must be at most 1\.0472"),
        (lambda: Ground(across=-2.0), r"slope across of the ground is -2 rad"),
        (lambda: Ground(steps=0.02), r"the steps of the ground is 0\.02; it must be a Steps"),
        (lambda: Steps(height=0.0), r"height of a step is 0\.0 m; it must be positive \(up\)"),
        (lambda: Steps(height=0.01, run=0.0), r"run of a step is 0\.0 m"),
        (lambda: Steps(height=0.01, count=2.0), r"number of steps is 2\.0; it must be a whole"),
        (lambda: Steps(height=0.01, count=400), r"stairs is from x = 0\.3 to 80\.1 m; the ground"),
        (lambda: Blocks(height=-0.01), r"greatest height of a block is -0\.01 m"),
        (lambda: Blocks(height=0.01, cell=0.0), r"edge of a block is 0\.0 m"),
        (lambda: Blocks(height=0.01, rows=40, columns=40), "40 by 40 blocks; it must have at most"),
        (lambda: Blocks(height=0.01, seed=-1), "seed of the blocks is -1; it must be a whole"),
        (lambda: Blocks(height=0.01, start=49.0), r"blocks is from x = 49 to 50\.25 m"),
        (lambda: Blocks(height=0.01, cell=7.0, rows=1), r"blocks is from y = -56 to 56 m"),
    ],
)
def test_wrong_numbers_are_refused(make, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        make()


@pytest.mark.parametrize(
    "ground",
    [FLAT, Ground(slope=0.1, across=0.02, steps=Steps(height=0.01), blocks=Blocks(height=0.02))],
)
def test_a_ground_is_read_back_from_json(ground):
    assert ground_from(json.loads(json.dumps(asdict(ground)))) == ground


@pytest.mark.parametrize("data", [{"slop": 1.0}, {**asdict(FLAT), "steps": {"heigth": 1.0}}])
def test_what_is_not_a_ground_is_refused(data):
    with pytest.raises(InvalidValueError, match="is not a ground"):
        ground_from(data)
