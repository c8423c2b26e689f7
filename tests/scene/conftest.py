"""A short step of leg B, and what skips a test where nothing can be rendered."""

import numpy as np
import pytest

from drake_leg.robots import LEG_B
from drake_leg.scene.motion import Motion
from drake_leg.scene.rendering import rendering_fault


@pytest.fixture(scope="session")
def step():
    time = np.linspace(0.0, 1.0, 26)
    start, end = np.radians([90.0, -50.0, -90.0]), np.radians([60.0, -40.0, -95.0])
    return Motion(robot=LEG_B, time=time, q=start + np.outer(time, end - start))


@pytest.fixture(scope="session")
def rendering():
    fault = rendering_fault()
    if fault is not None:
        pytest.skip(f"nothing can be rendered here: {fault}")
