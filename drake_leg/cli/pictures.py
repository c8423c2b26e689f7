"""Pictures: each is tried on its own, and one that fails costs nothing but itself."""

from __future__ import annotations

import os
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from drake_leg.cli.common import remark
from drake_leg.errors import DrakeLegError, PictureError

PLACES = "DRAKE_LEG_TRACEBACK"  # environment variable: show where an unforeseen error came from


@contextmanager
def picture(what: str) -> Iterator[None]:
    """Make one sentence of whatever keeps a picture from being made.

    Raises
    ------
    PictureError
        In place of an unexpected error.
    """
    try:
        yield
    except DrakeLegError:
        raise
    except Exception as error:
        show_place()
        raise PictureError(what, error) from error


class Pictures:
    """Pictures tried one after the other.

    Attributes
    ----------
    failures : list of PictureError
        What kept some of them from being made.
    """

    def __init__(self) -> None:
        self.failures: list[PictureError] = []

    @contextmanager
    def trying(self, what: str) -> Iterator[None]:
        """Try one, and remember what keeps it from being made."""
        try:
            yield
        except Exception as error:
            show_place()
            self.failures.append(PictureError(what, error))

    def say_failures(self) -> None:
        """Say in a sentence each what kept pictures from being made."""
        for failure in self.failures:
            remark(failure)


def show_place() -> None:
    """Show where the error being handled came from, to who asks for it."""
    if PLACES in os.environ:
        traceback.print_exc()
