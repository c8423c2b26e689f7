"""The front door's ``report`` and ``errata``, whose results show themselves in a notebook."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path

from drake_leg.arguments import require_callable, require_kind, shown
from drake_leg.errors import InvalidValueError, PictureError
from drake_leg.files import ResultsFolder
from drake_leg.lab.errata.catalogue import Erratum, erratum_of, texts_by_number


@dataclass(frozen=True)
class Errata:
    """Errors in the reports; a notebook shows what is printed, what is right, and the effect."""

    chosen: tuple[Erratum, ...]

    def __iter__(self) -> Iterator[Erratum]:
        return iter(self.chosen)

    def __len__(self) -> int:
        return len(self.chosen)

    def __getitem__(self, index: int) -> Erratum:
        return self.chosen[index]

    def _repr_html_(self) -> str:
        from drake_leg.lab.page.pieces import errata_in_notebook

        return errata_in_notebook(erratum.number for erratum in self.chosen)


@dataclass(frozen=True, kw_only=True)
class Report:
    """The page that was written; a notebook shows a link to it."""

    page: Path  # report.html
    failures: tuple[PictureError, ...]  # items that could not be made

    def _repr_html_(self) -> str:
        return f'<a href="{self.page}">{self.page}</a>'


def errata(*numbers: int) -> Errata:
    """List the errors in the two reports: what is printed, what is right, and the error's effect.

    The effects are computed when this is called, with the robots' dimensions.

    Parameters
    ----------
    *numbers : int
        Numbers of the errata, from 1; by default all of them.

    Returns
    -------
    Errata
        Each has ``number``, ``source``, ``where``, ``printed``, ``right`` and ``effect``.

    Raises
    ------
    InvalidValueError
        If there is no erratum with such a number, or it is not a whole number.

    Examples
    --------
    >>> from drake_leg import errata
    >>> (first,) = errata(1)
    >>> first.source
    'Report A'
    """
    given: tuple[object, ...] = numbers
    for number in given:
        if isinstance(number, bool) or not isinstance(number, Integral):
            raise InvalidValueError(
                f"the number of an erratum is {shown(number)}; it must be a whole number",
                advice=_as_numbers(number),
            )
    return Errata(tuple(map(erratum_of, numbers or texts_by_number())))


def _as_numbers(given: object) -> str:
    """Say how numbers that were given as text or in a list are given."""
    parts = given if isinstance(given, list | tuple) else [given]
    words = [str(part).strip() for part in parts]
    if words and all(word.isdecimal() for word in words):
        return f"give errata({', '.join(words)})"
    return "give it, as errata(5)"


def report(
    folder: Path | str,
    *,
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Report:
    """Reproduce every figure, table and equation of both reports on one page.

    It simulates all runs and uses all cores, at most four; it takes a minute on a slow machine.

    Parameters
    ----------
    folder : Path or str
        Folder to create, with ``report.html``, the figures and the replays.
    overwrite : bool
        Whether to replace older results in the folder.
    progress : callable, optional
        Called with the number of stages done.

    Returns
    -------
    Report
        The page, and the items that could not be made.

    Raises
    ------
    InvalidValueError
        If the folder is not a path, or progress is not a function.
    OutputError
        If the folder cannot be written.

    Examples
    --------
    Not run here, as it takes a minute:

    >>> from drake_leg import report
    >>> made = report("report")  # doctest: +SKIP
    >>> made.page  # doctest: +SKIP
    PosixPath('report/report.html')
    """
    from drake_leg.lab.page.workers import begin_loading_pages

    require_kind("folder", folder, str, Path)
    require_callable("progress", progress)
    target = ResultsFolder(Path(folder), overwrite=overwrite)
    begin_loading_pages()
    from drake_leg.lab.page.page import write_report

    with target.begun() as scratch:
        failures = write_report(scratch, progress or (lambda _done: None))
    return Report(page=target.path / "report.html", failures=tuple(failures))
