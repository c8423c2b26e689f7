"""What the commands share that open Meshcat in a browser."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from drake_leg.cli.common import numbers
from drake_leg.errors import InvalidValueError

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat


def add_meshcat(parser: argparse.ArgumentParser) -> None:
    """Add the options.

    Parameters
    ----------
    parser : ArgumentParser
        Of the command.
    """
    parser.add_argument(
        "--host",
        default="localhost",
        help="name or address to serve at; '*' lets other machines in (default localhost)",
    )
    parser.add_argument(
        "--port", metavar="N", help="port to serve at (default the first free one from 7000 on)"
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")
    parser.add_argument(
        "--once", action="store_true", help="end at once, without a browser: a trial"
    )


LEAVING = (
    "Escape in the browser, or Ctrl-C here, ends it: the posture is printed as --q takes it, and "
    "the exit status is 0."
)


def start_meshcat(chosen: argparse.Namespace, shows: str) -> Meshcat:
    """Start Meshcat, say where, and open a browser.

    Parameters
    ----------
    chosen : Namespace
        With the options of ``add_meshcat``.
    shows : str
        What is to be seen.

    Returns
    -------
    Meshcat

    Raises
    ------
    InvalidValueError
        If the port is no whole number.
    MeshcatError
        If Meshcat cannot listen there.
    """
    from drake_leg.scene.meshcat import open_meshcat
    from drake_leg.scene.viewer import open_browser

    meshcat = open_meshcat(host=chosen.host, port=_port(chosen.port))
    url = meshcat.web_url()
    print(f"{shows}: {url}", flush=True)
    print("Open Controls has the sliders and buttons; Escape there or Ctrl-C here ends", flush=True)
    if not (chosen.once or chosen.no_browser or open_browser(url)):
        print(f"drake-leg: no browser was found; open {url} in one", file=sys.stderr, flush=True)
    return meshcat


def _port(text: str | None) -> int | None:
    if text is None:
        return None
    value = numbers("--port", text, 1)[0]
    if value != int(value):
        raise InvalidValueError(f"--port is {text}; it must be a whole number")
    return int(value)
