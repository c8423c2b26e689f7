"""A page, its news and its commands over HTTP, to this machine unless told otherwise."""

from __future__ import annotations

import socket
from collections.abc import Callable
from http.server import ThreadingHTTPServer
from ipaddress import ip_address
from threading import Thread
from typing import Any, Self

from drake_leg.errors import DrakeLegError
from drake_leg.scene.live.board import Board
from drake_leg.scene.live.command import Command
from drake_leg.scene.live.requests import Answers, Desk

LOCALHOST = "localhost"
ANYWHERE = "*"
FIRST_PORT, LAST_PORT = 7000, 7999
POLL = 0.03  # [s] between looks whether to end
_SMALLEST_PORT, _LARGEST_PORT = 1024, 65535

Address = tuple[socket.AddressFamily, str]


class ServerError(DrakeLegError):
    """Pages cannot be served where it was told."""


class Server:
    """Listens from the beginning; answers when it serves.

    Parameters
    ----------
    host : str
        Name or address to listen at; ``*`` lets all in that can reach this machine.
    port : int, optional
        To listen at; by default the first that is free from ``FIRST_PORT`` on.

    Raises
    ------
    ServerError
        If the port is taken or no port, or the host is not one of this machine's.
    """

    def __init__(self, host: str = LOCALHOST, port: int | None = None) -> None:
        if port is not None and not _SMALLEST_PORT <= port <= _LARGEST_PORT:
            raise ServerError(
                f"--port is {port}; it must be in {_SMALLEST_PORT} ... {_LARGEST_PORT}"
            )
        addresses = _addresses(host)
        self._listeners = _listen(host, addresses, port)
        self._board: Board | None = None
        self.port = self._listeners[0].server_address[1]
        self.names = _names(host, addresses)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def url(self) -> str:
        """Where the page is, for a browser on this machine."""
        return f"http://{self.names[0]}:{self.port}"

    def serve(self, page: str, take: Callable[[Command], dict[str, Any]], board: Board) -> None:
        """Begin to answer.

        Parameters
        ----------
        take : callable
            Called with each command, from threads of its own; returns what a page is answered,
            or raises a ``DrakeLegError``, whose sentence the page is answered.
        board : Board
            What the pages are told.
        """
        self._board = board
        desk = Desk(page=page.encode(), take=take, board=board, names=self.names)
        for listener in self._listeners:
            listener.desk = desk
            Thread(target=listener.serve_forever, args=(POLL,), daemon=True).start()

    def close(self) -> None:
        """Tell the pages that the session has ended, and listen no longer."""
        if self._board is not None:
            self._board.end()
        for listener in self._listeners:
            if self._board is not None:
                listener.shutdown()
            listener.server_close()


class _Listener(ThreadingHTTPServer):
    """Listens at one address."""

    daemon_threads = True
    request_queue_size = 1024  # pages that may wait to be answered at one moment
    desk: Desk

    def __init__(self, address: Address, port: int) -> None:
        self.address_family = address[0]
        super().__init__((address[1], port), Answers)

    def server_bind(self) -> None:
        """Bind, without asking the network for this machine's name."""
        if self.address_family == socket.AF_INET6:
            self.socket.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(self.server_address)
        self.server_address = self.socket.getsockname()

    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing: a browser that breaks off is no news for the terminal."""


def _listen(host: str, addresses: list[Address], port: int | None) -> list[_Listener]:
    """Listen at all addresses, with one port."""
    ports = range(FIRST_PORT, LAST_PORT + 1) if port is None else (port,)
    for candidate in ports:
        listeners: list[_Listener] = []
        try:
            for address in addresses:
                listeners.append(_Listener(address, candidate))
        except OSError:
            for listener in listeners:
                listener.server_close()
        else:
            return listeners
    where = f"port {port}" if port is not None else f"ports {FIRST_PORT} to {LAST_PORT}"
    raise ServerError(
        f"cannot listen at {host}, {where}: the port is taken, or the host is not this "
        "machine's; choose another --port or --host"
    )


def _addresses(host: str) -> list[Address]:
    """Find the addresses of a host that are this machine's."""
    try:
        places = (
            [(socket.AF_INET, "0.0.0.0"), (socket.AF_INET6, "::")]
            if host == ANYWHERE
            else [
                (family, str(address[0]))
                for family, _, _, _, address in socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)
            ]
        )
    except (OSError, ValueError):
        raise ServerError(
            f"cannot listen at {host!r}: no machine of this name is known; choose another --host"
        ) from None
    own = [place for place in dict.fromkeys(places) if _bindable(*place)]
    if not own:
        raise ServerError(
            f"cannot listen at {host}: it is not an address of this machine; choose another --host"
        )
    return own


def _bindable(family: socket.AddressFamily, address: str) -> bool:
    try:
        with socket.socket(family, socket.SOCK_STREAM) as trial:
            trial.bind((address, 0))
    except OSError:
        return False
    return True


def _names(host: str, addresses: list[Address]) -> tuple[str, ...]:
    """Names by which browsers may know this machine, as in a URL."""
    if host == ANYWHERE or any(ip_address(name).is_unspecified for _, name in addresses):
        own = socket.gethostname()
        return (LOCALHOST, own, f"{own}.local", ANYWHERE)
    numbers = [f"[{name}]" if ":" in name else name for _, name in addresses]
    loops = any(ip_address(name).is_loopback for _, name in addresses)
    first = numbers[0] if ":" in host else host
    return tuple(dict.fromkeys([first, *numbers, *[LOCALHOST] * loops]))
