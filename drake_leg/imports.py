"""Packages that may be missing or broken, tried before any work is done that needs them."""

from __future__ import annotations

from importlib import import_module

from drake_leg.errors import DrakeLegError


class BrokenPackageError(DrakeLegError):
    """A package that is needed is not installed, or fails when it is imported.

    Attributes
    ----------
    reason : str
        Why it cannot be imported.
    """

    def __init__(self, purpose: str, package: str, reason: str, remedy: str) -> None:
        self.reason = reason
        super().__init__(
            f"{purpose} needs {package}, which cannot be imported ({reason})", advice=remedy
        )


def require_import(module: str, *, purpose: str, package: str, remedy: str) -> None:
    """Refuse to go on without a package, of which this module is needed for a purpose.

    Raises
    ------
    BrokenPackageError
        With the reason, whatever it is.
    """
    try:
        import_module(module)
    except Exception as error:  # a broken package may raise anything
        lines = str(error).splitlines() or [type(error).__name__]
        raise BrokenPackageError(purpose, package, lines[0], remedy) from error


def require_matplotlib() -> None:
    """Refuse to go on without matplotlib and Pillow, which figures need."""
    require_pillow()
    require_import(
        "matplotlib",
        purpose="a figure",
        package="matplotlib",
        remedy="take MPLBACKEND out of the environment if it is set, or "
        "pip install --force-reinstall matplotlib",
    )


def require_pillow() -> None:
    """Refuse to go on without Pillow, which all pictures need."""
    require_import(
        "PIL.Image",
        purpose="a picture",
        package="Pillow",
        remedy="pip install --force-reinstall pillow",
    )
