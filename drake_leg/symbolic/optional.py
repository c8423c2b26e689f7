"""The one place that knows that SymPy may be missing."""

from __future__ import annotations

from importlib.util import find_spec

from drake_leg.errors import DrakeLegError


class MissingSymPyError(DrakeLegError):
    """SymPy is needed and not installed."""

    def __init__(self, purpose: str) -> None:
        self.purpose = purpose
        super().__init__(f"{purpose} needs SymPy: pip install 'drake-leg[symbolic]'")


def require_sympy(purpose: str) -> None:
    """Raise ``MissingSymPyError`` unless SymPy is installed; ``purpose`` begins its sentence."""
    if find_spec("sympy") is None:
        raise MissingSymPyError(purpose)
