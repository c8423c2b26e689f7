"""What the rooms' tests share: seeded chance, numerical derivatives, Drake as a witness."""

from functools import cache

import numpy as np
import pytest
from hypothesis import settings

from drake_leg.models.plant import build_plant

settings.register_profile("drake_leg", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("drake_leg")


@pytest.fixture
def rng():
    return np.random.default_rng(20231030)


@pytest.fixture(scope="session")
def derivative():
    """Central difference of fourth order of a function of one number."""

    def five_points(function, at=0.0, step=1e-3):
        near = function(at + step) - function(at - step)
        far = function(at + 2 * step) - function(at - 2 * step)
        return (8 * near - far) / (12 * step)

    return five_points


@pytest.fixture(scope="session")
def posed():
    """Drake's plant of a robot, parsed from its SDF, and a context with joint positions."""

    @cache
    def parsed(robot):
        plant = build_plant(robot)
        return plant, plant.CreateDefaultContext()

    def pose(robot, q, qdot=None):
        plant, context = parsed(robot)
        plant.SetPositions(context, q)
        plant.SetVelocities(context, np.zeros(plant.num_velocities()) if qdot is None else qdot)
        return plant, context

    return pose


@pytest.fixture(scope="session")
def drake_frames(posed):
    """Drake's poses of frame_1 ... frame_n in the world, (n, 4, 4)."""

    def poses(robot, q):
        plant, context = posed(robot, q)
        names = [f"frame_{index}" for index in range(1, len(robot.rows) + 1)]
        frames = [plant.GetFrameByName(name) for name in names]
        return np.array([frame.CalcPoseInWorld(context).GetAsMatrix4() for frame in frames])

    return poses
