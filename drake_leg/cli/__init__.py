"""The command line ``drake-leg``: the only place that prints.

Exit status: 0 when all went well, 1 when ``check`` found something wrong, 2 for bad input or a
folder that cannot be written, 3 when a run stopped before its end (what it recorded until then is
saved), 130 on Ctrl-C.
"""

from drake_leg.cli.entry import main

__all__ = ["main"]
