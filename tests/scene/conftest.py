"""A short step of leg B, plants that are not ours, a server, and what skips a test without VTK."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robots import LEG_B
from drake_leg.scene.artists import rendering_fault
from drake_leg.scene.motion import PlantMotion
from drake_leg.scene.server import Feed, Server, Trace
from drake_leg.scene.showable import shown

PAGE = "<p>σ</p>"


@pytest.fixture(scope="session")
def step():
    time = np.linspace(0.0, 1.0, 26)
    start, end = np.radians([90.0, -50.0, -90.0]), np.radians([60.0, -40.0, -95.0])
    return PlantMotion(shown=shown(LEG_B), time=time, q=start + np.outer(time, end - start))


@pytest.fixture(scope="session")
def rendering():
    fault = rendering_fault()
    if fault is not None:
        pytest.skip(f"nothing can be rendered here: {fault}")


class Service:
    """A server at work, with the commands that it handled."""

    def __init__(self, server):
        self.server, self.feed, self.handled = server, Feed(Trace(1.0)), []
        server.serve(PAGE, self.handle, self.feed)

    def handle(self, command):
        self.handled.append(command)
        if command.get("do") == "wrong":
            raise InvalidValueError("this is wrong")
        return {"velocity": [1.0]}


@pytest.fixture
def service():
    with Server() as server:
        yield Service(server)
