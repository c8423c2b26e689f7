"""What a browser may ask of the server, and how all else is refused."""

from __future__ import annotations

import ipaddress
import json
from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from typing import Any, Protocol, cast

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.scene.live.board import Board
from drake_leg.scene.live.command import Command

LARGEST_COMMAND = 4096  # bytes
LARGEST_READ = 1 << 20  # bytes that are read to be refused, so that the refusal is heard
PATIENCE = 10.0  # [s] with a browser that neither sends nor takes

HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
}


@dataclass(frozen=True, kw_only=True)
class Desk:
    """What a server answers with."""

    page: bytes
    take: Callable[[Command], dict[str, Any]]
    board: Board
    names: tuple[str, ...]  # of this machine, as in a URL; "*" stands for all its addresses


class _Owner(Protocol):
    desk: Desk


class RefusedError(DrakeLegError):
    """A request that is not answered, with its status."""

    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


class Answers(BaseHTTPRequestHandler):
    """``GET /``: the page; ``GET /events``: news; ``POST /command``: one command as JSON."""

    timeout = PATIENCE
    server_version, sys_version = "drake-leg", ""

    def do_GET(self) -> None:
        """Answer with the page or with news."""
        answers = {"/": self._page, "/events": self._news, "/favicon.ico": self._no_icon}
        self._answer(answers, "/ and /events")

    def do_POST(self) -> None:
        """Take a command."""
        self._answer({"/command": self._command}, "/command")

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Refuse with one sentence; a method that is not known is the browser's fault."""
        status = HTTPStatus(code)
        if status == HTTPStatus.NOT_IMPLEMENTED:
            status, message = HTTPStatus.METHOD_NOT_ALLOWED, "only GET and POST are answered"
        self._send(status, (message or status.phrase).encode(), "text/plain; charset=utf-8")

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing in the terminal."""

    @property
    def _desk(self) -> Desk:
        return cast("_Owner", self.server).desk

    def _answer(self, answers: dict[str, Callable[[], None]], paths: str) -> None:
        try:
            require_own(self.headers.get("Host"), self.headers.get("Origin"), self._desk.names)
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
        self._send(HTTPStatus.OK, self._desk.page, "text/html; charset=utf-8")

    def _no_icon(self) -> None:
        self._send(HTTPStatus.NO_CONTENT, b"", "image/x-icon")

    def _news(self) -> None:
        self._begin(HTTPStatus.OK, "text/event-stream")
        self.wfile.write(b"retry: 500\n\n")
        for state in self._desk.board.news():
            data = "" if state is None else f"data: {json.dumps(state, separators=(',', ':'))}"
            self.wfile.write(f"{data or ':'}\n\n".encode())
        self.wfile.write(b"event: end\ndata: \n\n")

    def _command(self) -> None:
        if self.headers.get_content_type() != "application/json":
            raise RefusedError(
                HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a command's type is application/json"
            )
        command = parse_command(self.rfile.read(self._length()))
        answer = json.dumps(self._desk.take(command)).encode()
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


def require_own(host: str | None, origin: str | None, names: tuple[str, ...]) -> None:
    """Refuse what another site sends through a browser of this machine.

    Parameters
    ----------
    host, origin : str or None
        Headers of the request.
    names : tuple of str
        Of this machine, as in a URL.

    Raises
    ------
    RefusedError
        If the host is none of the names, or the origin is another host.
    """
    name = (host or "").lower().rpartition(":")[0] if _has_port(host) else (host or "").lower()
    known = name in map(str.lower, names) or ("*" in names and _is_address(name))
    if not known:
        raise RefusedError(HTTPStatus.FORBIDDEN, "the Host header does not name this server")
    if origin is not None and origin.lower() != f"http://{host}".lower():
        raise RefusedError(HTTPStatus.FORBIDDEN, "another site may not use this server")


def parse_command(text: bytes) -> Command:
    """Read a command.

    Raises
    ------
    InvalidValueError
        If it is no object of JSON.
    """
    try:
        command = json.loads(text)
    except (ValueError, RecursionError):
        raise InvalidValueError("a command is an object of JSON; this is no JSON") from None
    if not isinstance(command, dict):
        raise InvalidValueError("a command is an object of JSON, such as {}")
    return command


def _has_port(host: str | None) -> bool:
    return host is not None and host.rpartition(":")[2].isdigit() and not host.endswith("]")


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True
