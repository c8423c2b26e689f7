"""The command line ``drake-leg``: the only place that prints.

Exit status: 0 when all went well, 1 when ``check`` found something wrong or a run's error can be
seen in its figures, 2 for bad input or a folder that cannot be written, 3 when a run stopped before
its end (what it recorded until then is saved), 130 on Ctrl-C.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

__all__ = ["main"]

INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; Ctrl-C while it loads is told like any other.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; by default the process's own.

    Returns
    -------
    int
        Exit status.
    """
    try:
        from drake_leg.cli import entry

        return entry.main(arguments)
    except KeyboardInterrupt:
        pass
    except ImportError as error:
        if not _is_interrupt(error):
            raise
    print("drake-leg: interrupted", file=sys.stderr)
    return INTERRUPTED


def _is_interrupt(error: BaseException | None) -> bool:
    """Tell whether an import failed by Ctrl-C, as that of a compiled module does."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
