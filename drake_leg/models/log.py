"""Drake's log: what it says that no user can act on is kept from the terminal."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet_drake(level: int = logging.ERROR) -> Iterator[None]:
    """Let Drake log only what is at least as grave."""
    logger = logging.getLogger("drake")
    before = logger.level
    logger.setLevel(level)
    try:
        yield
    finally:
        logger.setLevel(before)
