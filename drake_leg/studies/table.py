"""The table of a sweep: a row a run, in the plan's order, to and from Parquet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import (
    InvalidValueError,
    OutputError,
    UnreadableFileError,
    did_you_mean,
    require_pyarrow,
)
from drake_leg.studies.row import HEADING, Row

Column = Sequence[Any] | NDArray[Any]

DIGEST = b"drake_leg_plan"  # of the plan, in the file's metadata
BLOCK = 1 << 17  # rows that are written at once


class Table(Mapping[str, NDArray[Any]]):
    """Columns of a sweep by name: of numbers as floats, NaN where there is none; or of objects."""

    def __init__(self, columns: Mapping[str, Column]) -> None:
        self._columns = dict(columns)

    @classmethod
    def from_rows(cls, varied: Mapping[str, Column], rows: Mapping[int, Row]) -> Table:
        """Put rows by place, and what was varied, in the plan's order."""
        ordered = [rows[place] for place in range(len(rows))]
        names = dict.fromkeys([*HEADING, *(name for row in ordered for name in row)])
        found = {name: [row.get(name) for row in ordered] for name in names if name not in varied}
        return cls({"run": range(len(rows)), **varied, **found})

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a column.

        Raises
        ------
        InvalidValueError
            If there is none of this name.
        """
        if name not in self._columns:
            raise InvalidValueError(
                f"the table has no column {name!r}",
                advice=did_you_mean(name, self, f"it has {', '.join(self)}"),
            )
        column = self._columns[name]
        if isinstance(column, np.ndarray):
            return column
        if all(each is None or isinstance(each, int | float) for each in column):
            return np.array([np.nan if each is None else each for each in column], dtype=float)
        return np.array(column, dtype=object)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __iter__(self) -> Any:  # noqa: ANN401 - an iterator of names
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(self._columns["run"])

    def is_numeric(self, name: str) -> bool:
        """Whether a column has numbers, at least two different ones."""
        column = self[name]
        if column.dtype == object or column.dtype.kind not in "fiub":
            return False
        found = column[np.isfinite(column.astype(float))]
        return len(found) > 0 and bool((found != found[0]).any())

    def write(self, path: Path, digest: str) -> None:
        """Write a Parquet file; what a run does not have is null."""
        require_pyarrow()
        import pyarrow as pa
        import pyarrow.parquet as pq

        arrays = {name: _arrow(column) for name, column in self._columns.items()}
        table = pa.table(arrays).replace_schema_metadata({DIGEST: digest.encode()})
        pq.write_table(table, path, row_group_size=BLOCK)


def read_table(path: Path, digest: str | None = None) -> Table:
    """Read a table that ``Table.write`` has written, of the plan with this digest.

    Raises
    ------
    UnreadableFileError
        With the reason.
    OutputError
        If it is another plan's table.
    """
    require_pyarrow()
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(path)
    except (OSError, pa.ArrowInvalid) as error:
        raise UnreadableFileError(path, str(error).splitlines()[0]) from None
    if digest is not None and (table.schema.metadata or {}).get(DIGEST) != digest.encode():
        raise OutputError(
            f"{path} is not the table of the plan beside it",
            advice="add `overwrite=True` to carry out the sweep again",
        )
    return Table({name: _numpy(table.column(name)) for name in table.column_names})


def _arrow(column: Column) -> Any:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa

    if isinstance(column, np.ndarray):
        return pa.array(column, from_pandas=True)  # NaN becomes null
    values = list(column)
    numbers = [each for each in values if isinstance(each, int | float)]
    is_mixed = any(isinstance(each, float) for each in numbers)
    if is_mixed and len(numbers) == sum(each is not None for each in values):
        values = [None if each is None else float(each) for each in values]
    try:
        return pa.array(values)
    except (pa.ArrowInvalid, pa.ArrowTypeError):  # numbers and texts: as texts
        return pa.array([None if each is None else str(each) for each in values])


def _numpy(column: Any) -> Column:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa

    if pa.types.is_floating(column.type):
        floats: NDArray[Any] = column.to_numpy()
        return floats
    values: list[Any] = column.to_pylist()
    return values
