import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.scene.live.board import Board
from drake_leg.scene.live.server import Server
from drake_leg.scene.live.trace import Trace

PAGE = "<p>σ</p>"


class Service:
    """A server at work, with what it was told to do."""

    def __init__(self, server):
        self.server, self.board, self.taken = server, Board(Trace(1.0)), []
        server.serve(PAGE, self.take, self.board)

    def take(self, command):
        self.taken.append(command)
        if command.get("do") == "wrong":
            raise InvalidValueError("this is wrong")
        return {"velocity": [1.0]}


@pytest.fixture
def service():
    with Server() as server:
        yield Service(server)
