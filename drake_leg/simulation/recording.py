"""Recordings of runs: named arrays with units, written to CSV and read back."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.arguments import require_kind, shown
from drake_leg.errors import InvalidValueError, OutputError, UnreadableFileError, did_you_mean
from drake_leg.files import LARGEST_RECORDING, opened
from drake_leg.kinematics.khalil import Array, real_numbers
from drake_leg.robot.robot import html_table

MOST_NAMES = 6  # of columns that an error's sentence lists


@dataclass(frozen=True)
class Recording:
    """Columns of equal length, in order; a header such as ``vx[m/s]`` holds name and unit.

    Parameters
    ----------
    columns : mapping of str to (rows,) array_like
        Header to values; lists become arrays.

    Raises
    ------
    InvalidValueError
        If the columns differ in length, or are not named rows of numbers.

    Examples
    --------
    >>> import numpy as np
    >>> from drake_leg import Recording
    >>> time = np.linspace(0.0, 1.0, 5)
    >>> swing = Recording({"time[s]": time, "q[rad]": 0.1 * np.cos(time)})
    >>> swing["q"].max(), swing.unit("q")
    (np.float64(0.1), 'rad')
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     swing.write_csv(Path(folder) / "swing.csv")
    ...     Recording.read_csv(Path(folder) / "swing.csv")["q"].max()
    np.float64(0.1)
    """

    columns: Mapping[str, Array]

    def __post_init__(self) -> None:
        if isinstance(self.columns, str | Path):
            raise InvalidValueError(
                f"the columns of a recording are {shown(self.columns)}; they must be a "
                "mapping from headers to values",
                advice="read a file with Recording.read_csv(path)",
            )
        require_kind("the columns of a recording", self.columns, Mapping)
        if not self.columns:
            raise InvalidValueError(
                "a recording has no columns", advice="give one at least, as {'time[s]': [0.0, 0.1]}"
            )
        columns = {}
        for header, values in self.columns.items():
            require_kind("the header of a column", header, str)
            column = f"the column {_name(header)}"
            is_numeric = isinstance(values, np.ndarray) and values.dtype.kind in "biuf"
            array = values if is_numeric else real_numbers(column, values)
            if array.ndim != 1:
                raise InvalidValueError(
                    f"{column} has shape {array.shape}; it must be a row of numbers"
                )
            columns[header] = array
        object.__setattr__(self, "columns", columns)
        lengths = {name: len(values) for name, values in self.columns.items()}
        if len(set(lengths.values())) > 1:
            raise InvalidValueError(f"the columns differ in length: {lengths}")

    def __getitem__(self, name: str) -> Array:
        """Return the column (rows,) of a name, ``vx`` or ``vx[m/s]``, in the unit of its header.

        Raises
        ------
        InvalidValueError
            If there is no such column.
        """
        return self.columns[self._header(name)]

    def has(self, name: str) -> bool:
        """Tell whether there are columns of a name, with or without a number, such as ``tau``."""
        return any(_name(header).rstrip("0123456789") == name for header in self.columns)

    def unit(self, name: str) -> str:
        """Return the unit of a column, as its header says it; empty where it says none.

        Raises
        ------
        InvalidValueError
            If there is no such column.
        """
        return self._header(name).partition("[")[2].removesuffix("]")

    def _header(self, name: str) -> str:
        for header in self.columns:
            if name in (header, _name(header)):
                return header
        first = ", ".join(list(self.columns)[:MOST_NAMES])
        others = len(self.columns) - MOST_NAMES
        raise InvalidValueError(
            f"there is no column {name!r}; the recording has {first}"
            + (f" and {others} more" if others > 0 else ""),
            advice=did_you_mean(name, map(_name, self.columns)),
        )

    def stack(self, *names: str) -> Array:
        """Return several columns side by side, (rows, len(names)).

        Raises
        ------
        InvalidValueError
            If a column is missing.
        """
        return np.stack([self[name] for name in names], axis=-1)

    @property
    def _rows(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __repr__(self) -> str:
        return f"<Recording: {self._rows} rows, {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        rows = []
        for header, values in self.columns.items():
            name, _, unit = header.partition("[")
            ends = (values[0], values[-1], values.min(), values.max()) if len(values) else ()
            rows.append((name, unit.removesuffix("]"), *(f"{value:.6g}" for value in ends)))
        headings = ("column", "unit", "first", "last", "least", "greatest")
        return html_table(headings, rows, title=f"Recording, {self._rows} rows")

    def write_csv(self, path: Path | str) -> None:
        """Write the columns with 17 significant digits, so that they are read back exactly.

        Raises
        ------
        OutputError
            If it cannot be written.
        """
        require_kind("the path of a recording", path, str, Path)
        try:
            with Path(path).open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(self.columns)
                rows = zip(*(values.tolist() for values in self.columns.values()), strict=True)
                writer.writerows([repr(value) for value in row] for row in rows)
        except OSError as error:
            raise OutputError(f"{path} cannot be written: {error.strerror}") from error

    @classmethod
    def read_csv(cls, path: Path | str) -> Self:
        """Read back, bit by bit, what ``write_csv`` wrote, such as the recording of a run.

        Parameters
        ----------
        path : Path or str
            A CSV file whose first line names the columns, as ``time[s],q[rad]``.

        Returns
        -------
        Recording
            Its columns in the order of the file.

        Raises
        ------
        OutputError
            If the file cannot be read, has no header, was cut short, or holds something that is
            not a number.
        """
        require_kind("the path of a recording", path, str, Path)
        path = Path(path)
        rows = _rows(path)
        if not rows:
            raise OutputError(f"{path} is empty; a recording starts with a line of column names")
        header, body = rows[0], rows[1:]
        for name in header:
            if header.count(name) > 1:
                raise OutputError(
                    f"{path} has {header.count(name)} columns {name!r}; names must differ"
                )
        rows_of_numbers = [
            _numbers(f"{path}, line {number}", header, row)
            for number, row in enumerate(body, start=2)
        ]
        values = np.array(rows_of_numbers, dtype=np.float64).reshape(-1, len(header))
        return cls(dict(zip(header, values.T, strict=True)))


def _name(header: str) -> str:
    """Name of a column without its unit."""
    return header.partition("[")[0].strip()


def _rows(path: Path) -> list[list[str]]:
    """Read all cells; a last line without an end is one that was cut off."""
    lines: list[str] = []

    def noted(file: io.TextIOWrapper) -> Iterator[str]:
        for line in file:
            lines[:] = [line]
            yield line

    try:
        with (
            opened(path, most=LARGEST_RECORDING) as file,
            io.TextIOWrapper(file, encoding="utf-8", newline="") as text,
        ):
            rows = list(csv.reader(noted(text)))
    except (UnicodeDecodeError, csv.Error) as error:
        raise UnreadableFileError(path, str(error)) from None
    if lines and not lines[0].endswith(("\n", "\r")):
        raise OutputError(
            f"{path}, line {len(rows)}, has no end: the file was cut short; carry out the run "
            "again, or end the line if it is whole"
        )
    return rows


def _numbers(where: str, header: Sequence[str], row: Sequence[str]) -> list[float]:
    """Read a row, or say which of its values is not a number."""
    if len(row) != len(header):
        raise OutputError(f"{where}, has {len(row)} values for {len(header)} columns")
    numbers = []
    for name, text in zip(header, row, strict=True):
        try:
            numbers.append(float(text))
        except ValueError:
            raise OutputError(
                f"{where}, has {text!r} in the column {name}, which is not a number: correct "
                "the file, or carry out the run again"
            ) from None
    return numbers


def numbered(name: str, units: Sequence[str], values: Array) -> dict[str, Array]:
    """Make columns such as ``q1[rad]``, ``q2[rad]`` ... of an array (rows, n)."""
    return {f"{name}{i + 1}[{unit}]": values[:, i] for i, unit in enumerate(units)}


def lettered(prefix: str, letters: str, unit: str, values: Array) -> dict[str, Array]:
    """Make columns such as ``vx[m/s]``, ``vy[m/s]`` ... of an array (rows, len(letters)).

    With an empty unit there are no brackets.
    """
    suffix = f"[{unit}]" if unit else ""
    return {f"{prefix}{letter}{suffix}": values[:, i] for i, letter in enumerate(letters)}


def without_sign_jumps(quaternions: ArrayLike) -> Array:
    """Choose of q and -q, the same rotation, the one nearest to the row before.

    Quaternions (rows, 4) are w, x, y, z; the first row keeps its sign.
    """
    rows = np.asarray(quaternions, dtype=np.float64)
    flips = np.where((rows[1:] * rows[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)
    signs: Array = np.concatenate([[1.0], np.cumprod(flips)])
    return rows * signs[:, np.newaxis]


def intervals(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last row, exclusive, of each time in which a flag (rows,) is set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
