"""Pictures: each is tried on its own, and if one fails, nothing else is lost."""

from __future__ import annotations

import os
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from drake_leg.cli.common import remark
from drake_leg.errors import DrakeLegError, PictureError

PLACES = "DRAKE_LEG_TRACEBACK"  # environment variable: print the traceback of unexpected errors


@contextmanager
def picture(what: str) -> Iterator[None]:
    """Make one sentence of whatever goes wrong with a picture."""
    try:
        yield
    except DrakeLegError:
        raise
    except Exception as error:
        show_place()
        raise PictureError(what, error) from error


class Pictures:
    """Pictures that are tried one after the other; ``failures`` has the errors."""

    def __init__(self) -> None:
        self.failures: list[PictureError] = []

    @contextmanager
    def trying(self, what: str) -> Iterator[None]:
        """Try to make one, and keep the error if it fails."""
        try:
            yield
        except Exception as error:
            show_place()
            self.failures.append(PictureError(what, error))

    def say_failures(self) -> None:
        """Print the errors."""
        for failure in self.failures:
            remark(failure)


def show_place() -> None:
    """Print where the error comes from, if the environment asks for it."""
    if PLACES in os.environ:
        traceback.print_exc()
