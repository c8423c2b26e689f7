"""What commands share that open a page in a browser."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from drake_leg.cli.common import numbers
from drake_leg.errors import InvalidValueError

if TYPE_CHECKING:
    from drake_leg.scene.server import Server


HOST = "localhost"


def add_server(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "--host",
        help=f"name or address to serve at; '*' lets other machines in (default {HOST})",
    )
    parser.add_argument(
        "--port", metavar="N", help="port to serve at (default the first free one from 7000 on)"
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")
    parser.add_argument(
        "--once", action="store_true", help="end at once, without a browser, to try it"
    )


def server_options(chosen: argparse.Namespace) -> dict[str, bool]:
    """Tell which of the options were given."""
    return {
        "--host": chosen.host is not None,
        "--port": chosen.port is not None,
        "--no-browser": chosen.no_browser,
        "--once": chosen.once,
    }


LEAVING = (
    "Escape in the page, or Ctrl-C here, ends it. Then the posture is printed, as for --q, and "
    "the exit status is 0."
)


def start_server(chosen: argparse.Namespace, shows: str) -> Server:
    """Listen, print where, and open a browser; the server does not serve yet."""
    from drake_leg.scene.server import Server, open_browser

    server = Server(HOST if chosen.host is None else chosen.host, _port(chosen.port))
    print(f"{shows}: {server.url}", flush=True)
    print("Press Escape in the page or Ctrl-C here to end", flush=True)
    if not (chosen.once or chosen.no_browser or open_browser(server.url)):
        print(
            f"drake-leg: no browser was found; open {server.url} in one",
            file=sys.stderr,
            flush=True,
        )
    return server


def _port(text: str | None) -> int | None:
    if text is None:
        return None
    value = numbers("--port", text, 1)[0]
    if value != int(value):
        raise InvalidValueError(f"--port is {text}; it must be a whole number")
    return int(value)
