"""Serves pages, states and commands over HTTP, to this machine unless others are let in."""

from __future__ import annotations

import ipaddress
import json
import math
import os
import socket
import sys
import webbrowser
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from secrets import token_hex
from threading import Condition, Lock, Thread
from typing import Any, Self, cast

import numpy as np

from drake_leg.arguments import shown
from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.scene.furniture import TRACE_SPACING

MOST_PIECES = 500  # of a trace; its oldest pieces go when it is longer
QUIET = 1.0  # [s] without a new state, after which a page is told that the program still runs
LONGEST_NAME = 40  # of a page

LOCALHOST = "localhost"
ANYWHERE = "*"
OTHER_HOST = "choose another `host`"
FIRST_PORT, LAST_PORT = 7000, 7999
POLL = 0.03  # [s] between looks whether to end
_SMALLEST_PORT, _LARGEST_PORT = 1024, 65535

LARGEST_COMMAND = 4096  # bytes
LARGEST_READ = 1 << 20  # bytes that are read to be refused, so that the refusal is heard
PATIENCE = 10.0  # [s] with a browser that neither sends nor takes
HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
}

Address = tuple[socket.AddressFamily, str]
Command = Mapping[str, Any]  # an object of JSON: what to do, under "do", and its numbers


class Trace:
    """The paths of moving tips in a scene of a size [m], as numbered straight pieces.

    Pages ask for those that they have not yet seen.
    """

    def __init__(self, size: float) -> None:
        self._spacing = TRACE_SPACING / 2.0 * size
        self._pieces: deque[list[float]] = deque(maxlen=MOST_PIECES)
        self._last: dict[int, Array] = {}  # of each tip
        self._count = self._cleared = 0
        self._lock = Lock()

    @property
    def mark(self) -> tuple[int, int]:
        """How often it was cleared, and how many pieces have come since."""
        return self._cleared, self._count

    def add(self, points: Array) -> None:
        """Extend the paths to points of the world, one per tip, (k, 3) or (3,) [m], unless near."""
        with self._lock:
            for tip, point in enumerate(np.atleast_2d(points)):
                last = self._last.setdefault(tip, np.array(point))
                if np.linalg.norm(point - last) >= self._spacing:
                    self._pieces.append([round(float(part), 6) for part in (*last, *point)])
                    self._last[tip], self._count = np.array(point), self._count + 1

    def lift(self) -> None:
        """Leave a gap before the next point, to which the tip jumps."""
        with self._lock:
            self._last.clear()

    def clear(self) -> None:
        """Begin again."""
        with self._lock:
            self._pieces.clear()
            self._last.clear()
            self._count, self._cleared = 0, self._cleared + 1

    def since(self, cleared: int, count: int) -> dict[str, Any]:
        """Return the pieces that are new since an answer with these numbers; -1 and 0 at first.

        ``cleared``: how often the trace was cleared; ``count``: pieces since then; ``pieces``: the
        new ones, x, y, z of their ends [m].
        """
        with self._lock:
            known = count if cleared == self._cleared else 0
            new = min(self._count - known, len(self._pieces))
            pieces = list(self._pieces)[len(self._pieces) - new :]
            return {"cleared": self._cleared, "count": self._count, "pieces": pieces}


class Feed:
    """Publishes the latest state and the trace to all open pages, and the end of the session.

    A slow page misses the states in between.
    """

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.session = token_hex(4)  # tells a page whether it belongs to this feed
        self._changed = Condition()
        self._state: Mapping[str, Any] | None = None
        self._mark = trace.mark
        self._number = self._readers = 0
        self._ended = False

    def publish(self, state: Mapping[str, Any]) -> None:
        """Publish a new state, which JSON can write, or a new trace."""
        with self._changed:
            if (state, self.trace.mark) != (self._state, self._mark):
                self._state, self._mark = state, self.trace.mark
                self._number += 1
                self._changed.notify_all()

    def end(self, patience: float = QUIET) -> None:
        """Announce the end of the session; wait at most ``patience`` [s] for the pages."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._readers == 0, patience)

    def follow(self, quiet: float = QUIET) -> Iterator[Mapping[str, Any] | None]:
        """Yield what is published until the session has ended, with ``session`` and ``trace``.

        None is yielded after ``quiet`` [s] without news.
        """
        seen, cleared, count = 0, -1, 0
        with self._changed:
            self._readers += 1
        try:
            while not self._ended:
                known, seen = seen, self._newer(seen, quiet)
                state = self._state
                if state is None or seen == known:
                    if not self._ended:
                        yield None
                    continue
                trace = self.trace.since(cleared, count)
                cleared, count = trace["cleared"], trace["count"]
                yield {**state, "session": self.session, "trace": trace}
        finally:
            with self._changed:
                self._readers -= 1
                self._changed.notify_all()

    def _newer(self, seen: int, quiet: float) -> int:
        """Wait for a newer state, the end, or long enough; return the latest state's number."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._number > seen, quiet)
            return self._number


def action_of(command: Command, actions: Collection[str]) -> str:
    """Read what a command asks for, one of ``actions``."""
    wanted = command.get("do")
    if not isinstance(wanted, str) or wanted not in actions:
        raise InvalidValueError(f'"do" must be one of {", ".join(actions)}')
    return wanted


def numbers_of(command: Command, name: str, count: int) -> list[float]:
    """Read the ``count`` finite numbers that a command has under a name."""
    values = command.get(name)
    if (
        not isinstance(values, list)
        or len(values) != count
        or not all(isinstance(value, int | float) and _finite(value) for value in values)
    ):
        raise InvalidValueError(f'"{name}" must be a list of {count} finite numbers')
    return [float(value) for value in values]


def tab_of(command: Command) -> str:
    """Read the name of the page that a command comes from; the page chose it."""
    tab = command.get("tab")
    if not isinstance(tab, str) or not 0 < len(tab) <= LONGEST_NAME:
        raise InvalidValueError(f'"tab" must be a name of at most {LONGEST_NAME} letters')
    return tab


def _finite(value: float) -> bool:
    try:
        return not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        return False


class ServerError(DrakeLegError):
    """Pages cannot be served at a host and a port, or at any port (None)."""

    def __init__(self, host: str, port: int | None, reason: str, advice: str) -> None:
        self.host, self.port = host, port
        where = "" if port is None else f", port {port}"
        super().__init__(f"cannot listen at {host}{where}: {reason}", advice=advice)


class Server:
    """Listens once created; answers once it serves.

    The host ``*`` lets all in that can reach this machine. By default the port is the first that is
    free from ``FIRST_PORT`` on.
    """

    def __init__(self, host: str = LOCALHOST, port: int | None = None) -> None:
        if port is not None and (
            not isinstance(port, int) or not _SMALLEST_PORT <= port <= _LARGEST_PORT
        ):
            whole = "" if isinstance(port, int) else "a whole number "
            raise InvalidValueError(
                f"the port is {shown(port)}; it must be {whole}in {_SMALLEST_PORT} ... "
                f"{_LARGEST_PORT}"
            )
        addresses = _addresses(host)
        self._listeners = _listen(host, addresses, port)
        self._feed: Feed | None = None
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

    def serve(self, page: str, handle: Callable[[Command], dict[str, Any]], feed: Feed) -> None:
        """Begin to answer with a page and the states of a feed.

        ``handle`` is called with each command, in other threads; it returns the answer to the page,
        or raises a ``DrakeLegError``, whose sentence is the answer.
        """
        self._feed = feed
        site = Site(page=page.encode(), handle=handle, feed=feed, names=self.names)
        for listener in self._listeners:
            listener.site = site
            Thread(target=listener.serve_forever, args=(POLL,), daemon=True).start()

    def close(self) -> None:
        """Announce the end of the session to the pages, and stop listening."""
        if self._feed is not None:
            self._feed.end()
        for listener in self._listeners:
            if self._feed is not None:
                listener.shutdown()
            listener.server_close()


@dataclass(frozen=True, kw_only=True)
class Site:
    """What a server answers with."""

    page: bytes
    handle: Callable[[Command], dict[str, Any]]
    feed: Feed
    names: tuple[str, ...]  # of this machine, as in a URL; "*" stands for all its addresses


class RefusedError(DrakeLegError):
    """A request that is not answered, with its status."""

    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


class Answers(BaseHTTPRequestHandler):
    """``GET /``: the page; ``GET /events``: states; ``POST /command``: one command as JSON."""

    timeout = PATIENCE
    server_version, sys_version = "drake-leg", ""

    def do_GET(self) -> None:
        """Answer with the page or with states."""
        answers = {"/": self._page, "/events": self._events, "/favicon.ico": self._no_icon}
        self._answer(answers, "/ and /events")

    def do_POST(self) -> None:
        """Take a command."""
        self._answer({"/command": self._command}, "/command")

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Refuse with one sentence; an unknown method is a client error."""
        status = HTTPStatus(code)
        if status == HTTPStatus.NOT_IMPLEMENTED:
            status, message = HTTPStatus.METHOD_NOT_ALLOWED, "only GET and POST are answered"
        self._send(status, (message or status.phrase).encode(), "text/plain; charset=utf-8")

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing."""

    @property
    def _site(self) -> Site:
        return cast("_Listener", self.server).site

    def _answer(self, answers: dict[str, Callable[[], None]], paths: str) -> None:
        try:
            require_own(self.headers.get("Host"), self.headers.get("Origin"), self._site.names)
            path = self.path.partition("?")[0]
            if path not in answers:
                raise RefusedError(
                    HTTPStatus.NOT_FOUND, f"{self.command} is answered at {paths} only"
                )
            answers[path]()
        except RefusedError as refused:
            self.send_error(refused.status, str(refused))
        except DrakeLegError as error:
            self.send_error(HTTPStatus.BAD_REQUEST, str(error))

    def _page(self) -> None:
        self._send(HTTPStatus.OK, self._site.page, "text/html; charset=utf-8")

    def _no_icon(self) -> None:
        self._send(HTTPStatus.NO_CONTENT, b"", "image/x-icon")

    def _events(self) -> None:
        self._begin(HTTPStatus.OK, "text/event-stream")
        self.wfile.write(b"retry: 500\n\n")
        for state in self._site.feed.follow():
            data = "" if state is None else f"data: {json.dumps(state, separators=(',', ':'))}"
            self.wfile.write(f"{data or ':'}\n\n".encode())
        self.wfile.write(b"event: end\ndata: \n\n")

    def _command(self) -> None:
        if self.headers.get_content_type() != "application/json":
            raise RefusedError(
                HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a command's type is application/json"
            )
        command = parse_command(self.rfile.read(self._length()))
        answer = json.dumps(self._site.handle(command)).encode()
        self._send(HTTPStatus.OK, answer, "application/json")

    def _length(self) -> int:
        told = self.headers.get("Content-Length")
        if told is None:
            raise RefusedError(HTTPStatus.LENGTH_REQUIRED, "a command has a Content-Length")
        if not (told.isascii() and told.isdigit()):
            raise RefusedError(HTTPStatus.BAD_REQUEST, "Content-Length must be a whole number")
        length = int(told[:20])
        if length > LARGEST_COMMAND:
            self.rfile.read(length if length < LARGEST_READ else 0)
            raise RefusedError(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
                f"a command has at most {LARGEST_COMMAND} bytes",
            )
        return length

    def _send(self, status: HTTPStatus, body: bytes, kind: str) -> None:
        self._begin(status, kind, len(body))
        if self.command != "HEAD":
            self.wfile.write(body)

    def _begin(self, status: HTTPStatus, kind: str, length: int | None = None) -> None:
        self.send_response(status)
        for name, value in HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        self.end_headers()


class _Listener(ThreadingHTTPServer):
    """Listens at one address."""

    daemon_threads = True
    request_queue_size = 1024  # pages that may wait to be answered at one moment
    site: Site

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
        """Ignore a browser that breaks the connection."""


def open_browser(url: str) -> bool:
    """Open a page in the user's browser; return whether that worked."""
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return False
    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False


def require_own(host: str | None, origin: str | None, names: tuple[str, ...]) -> None:
    """Refuse requests that another site sends through a browser of this machine.

    Then the Host header is not one of this machine's names, or Origin is another host.
    """
    name = (host or "").lower().rpartition(":")[0] if _has_port(host) else (host or "").lower()
    known = name in map(str.lower, names) or ("*" in names and _is_address(name))
    if not known:
        raise RefusedError(HTTPStatus.FORBIDDEN, "the Host header does not name this server")
    if origin is not None and origin.lower() != f"http://{host}".lower():
        raise RefusedError(HTTPStatus.FORBIDDEN, "another site may not use this server")


def parse_command(text: bytes) -> Command:
    """Read a command; raise ``InvalidValueError`` if it is not a JSON object."""
    try:
        command = json.loads(text)
    except (ValueError, RecursionError):
        raise InvalidValueError("a command is an object of JSON; this is not JSON") from None
    if not isinstance(command, dict):
        raise InvalidValueError("a command is an object of JSON, such as {}")
    return command


def _listen(host: str, addresses: list[Address], port: int | None) -> list[_Listener]:
    """Listen at all addresses, at one port."""
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
    raise ServerError(
        host,
        port,
        "the port is taken, or the host is not this machine's"
        if port is not None
        else f"none of the ports {FIRST_PORT} to {LAST_PORT} is free, or the host is another's",
        "choose another `port` or `host`",
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
    except (OSError, TypeError, ValueError):
        raise ServerError(
            repr(host), None, "no machine of this name is known", OTHER_HOST
        ) from None
    own = [place for place in dict.fromkeys(places) if _bindable(*place)]
    if not own:
        raise ServerError(host, None, "it is not an address of this machine", OTHER_HOST)
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
    if host == ANYWHERE or any(ipaddress.ip_address(name).is_unspecified for _, name in addresses):
        own = socket.gethostname()
        return (LOCALHOST, own, f"{own}.local", ANYWHERE)
    numbers = [f"[{name}]" if ":" in name else name for _, name in addresses]
    loops = any(ipaddress.ip_address(name).is_loopback for _, name in addresses)
    first = numbers[0] if ":" in host else host
    return tuple(dict.fromkeys([first, *numbers, *[LOCALHOST] * loops]))


def _has_port(host: str | None) -> bool:
    return host is not None and host.rpartition(":")[2].isdigit() and not host.endswith("]")


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True
