"""Packages that may be missing or broken, tried before any work is done for what needs them."""

from __future__ import annotations

from importlib import import_module

from drake_leg.errors import DrakeLegError


class BrokenPackageError(DrakeLegError):
    """A package is wanted that is not installed, or that fails when it is imported.

    Attributes
    ----------
    reason : str
        Why it cannot be imported.
    """

    def __init__(self, purpose: str, package: str, reason: str, remedy: str) -> None:
        self.reason = reason
        super().__init__(
            f"{purpose} needs {package}, which cannot be imported ({reason}): {remedy}"
        )


def require_import(module: str, *, purpose: str, package: str, remedy: str) -> None:
    """Refuse to go on without a package.

    Parameters
    ----------
    module : str
        What is imported of it: ``PIL.Image``.
    purpose : str
        What wants it, the subject of the error's sentence.
    package : str
        Its name for a person: ``Pillow``.
    remedy : str
        What a person can do.

    Raises
    ------
    BrokenPackageError
        With the reason, if it cannot be imported for whatever reason.
    """
    try:
        import_module(module)
    except Exception as error:  # a broken package may raise anything
        lines = str(error).splitlines() or [type(error).__name__]
        raise BrokenPackageError(purpose, package, lines[0], remedy) from error


def require_matplotlib() -> None:
    """Refuse to go on without matplotlib, and Pillow, which all figures are made with.

    Raises
    ------
    BrokenPackageError
        If one of them cannot be imported.
    """
    require_pillow()
    require_import(
        "matplotlib",
        purpose="a figure",
        package="matplotlib",
        remedy="take MPLBACKEND out of the environment if it is set, or "
        "pip install --force-reinstall matplotlib",
    )


def require_pillow() -> None:
    """Refuse to go on without Pillow, which all pictures and figures are written with.

    Raises
    ------
    BrokenPackageError
        If it cannot be imported.
    """
    require_import(
        "PIL.Image",
        purpose="a picture",
        package="Pillow",
        remedy="pip install --force-reinstall pillow",
    )
