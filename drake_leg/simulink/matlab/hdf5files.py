"""Variables of .mat files of version 7.3, which are HDF5 files, read by h5py.

MATLAB's arrays lie there with their dimensions reversed. An attribute says of which class each is,
and cells and arrays of structures hold references.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import Cell, LackError, Struct, Structs, settled

MOST_BYTES = 100_000_000  # of all that is read
MOST_PARTS = 200_000  # variables, fields and elements of cells
DEEPEST = 40
REMEDY = "pip install 'drake-leg[hdf5]', or save it with '-v7'"
NUMBERS = ("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
           "uint64")  # fmt: skip


def read_hdf5(path: Path) -> dict[str, Any]:
    """Read the variables of a .mat file of version 7.3; those of unknown classes are left out.

    Raises
    ------
    LackError
        If h5py is not installed, or the file is damaged or holds more than the limits.
    """
    h5py = _h5py(path.name)
    try:
        with h5py.File(path, "r") as file:
            return _Reader(h5py, file).variables()
    except LackError as error:
        raise LackError(f"{path.name} {error}") from None
    except Exception as error:
        raise LackError(f"{path.name} is no .mat file: {str(error)[:80]}") from None


def names_of_hdf5(path: Path) -> set[str]:
    """Names of the variables of such a file; none where it cannot be read."""
    try:
        with _h5py(path.name).File(path, "r") as file:
            return {name for name in file if not name.startswith("#")}
    except Exception:
        return set()


def _h5py(name: str) -> Any:  # noqa: ANN401 - it has no types
    try:
        import h5py
    except Exception:  # a broken package may raise anything
        raise LackError(
            f"{name} is a .mat file of version 7.3, which h5py reads: {REMEDY}"
        ) from None
    return h5py


class _Reader:
    """Reads one file, and counts what it holds."""

    def __init__(self, h5py: Any, file: Any) -> None:  # noqa: ANN401
        self._h5py, self._file = h5py, file
        self._bytes = self._parts = 0

    def variables(self) -> dict[str, Any]:
        """Return all variables by their names."""
        found = {name: self._member(self._file, name, 0) for name in self._names(self._file)}
        return {name: value for name, value in found.items() if value is not None}

    def _names(self, group: Any) -> list[str]:  # noqa: ANN401
        return [name for name in group if not name.startswith("#")]

    def _member(self, group: Any, name: str, depth: int) -> Any:  # noqa: ANN401
        """Read what a group has under a name; links that lead out of the file are not followed."""
        if not isinstance(group.get(name, getlink=True), self._h5py.HardLink):
            return None
        return self._value(group[name], depth + 1)

    def _value(self, node: Any, depth: int) -> Any:  # noqa: ANN401
        self._parts += 1
        if depth > DEEPEST or self._parts > MOST_PARTS:
            raise LackError(f"holds more than {MOST_PARTS:,} values, or deeper than {DEEPEST}")
        kind = _text(node.attrs.get("MATLAB_class", b""))
        if isinstance(node, self._h5py.Group):
            if "MATLAB_sparse" in node.attrs:
                return self._sparse(node)
            return self._structure(node, depth) if kind in ("struct", "") else None
        if node.attrs.get("MATLAB_empty"):
            return _empty(kind, self._read(node).ravel())
        if kind == "cell":
            return Cell(self._referred(self._read(node).T, depth))
        if kind == "char":
            rows = self._read(node).T
            return "".join(map(chr, rows.reshape(-1, rows.shape[-1])[0].tolist()))
        if kind == "logical":
            return settled(np.atleast_2d(self._read(node).T != 0))
        return settled(np.atleast_2d(_numbers(self._read(node).T))) if kind in NUMBERS else None

    def _read(self, dataset: Any) -> np.ndarray[Any, Any]:  # noqa: ANN401
        """Read the numbers of a dataset, all of which are in this file."""
        if dataset.external or dataset.is_virtual:
            raise LackError("has data in other files, which are not read")
        self._bytes += dataset.size * dataset.dtype.itemsize
        if self._bytes > MOST_BYTES:
            raise LackError(f"unpacks to more than {MOST_BYTES:,} bytes")
        found: np.ndarray[Any, Any] = np.asarray(dataset[()])
        return found

    def _referred(self, references: np.ndarray[Any, Any], depth: int) -> np.ndarray[Any, Any]:
        """Read what references refer to."""
        items = np.empty(np.atleast_2d(references).shape, dtype=object)
        for place, reference in enumerate(references.flat):
            items.flat[place] = self._value(self._file[reference], depth + 1)
        return items

    def _structure(self, group: Any, depth: int) -> Struct | Structs:  # noqa: ANN401
        """Read one structure; where its fields are references, an array of them."""
        names = self._names(group)
        nodes = [group.get(name) for name in names]
        if names and all(self._refers(node) for node in nodes):
            columns = [self._referred(self._read(node).T, depth) for node in nodes]
            items = np.empty(columns[0].shape, dtype=object)
            for place in range(items.size):
                items.flat[place] = Struct(
                    {name: each.flat[place] for name, each in zip(names, columns, strict=True)}
                )
            return Structs(items, tuple(names))
        return Struct({name: self._member(group, name, depth) for name in names})

    def _refers(self, node: Any) -> bool:  # noqa: ANN401
        """Tell whether a field is that of an array of structures."""
        return (
            isinstance(node, self._h5py.Dataset)
            and "MATLAB_class" not in node.attrs
            and self._h5py.check_ref_dtype(node.dtype) is self._h5py.Reference
        )

    def _sparse(self, group: Any) -> Any:  # noqa: ANN401
        """Read a sparse matrix as a full one."""
        rows, columns = int(group.attrs["MATLAB_sparse"]), self._read(group["jc"]).size - 1
        self._bytes += 8 * rows * columns
        if self._bytes > MOST_BYTES:
            raise LackError(f"unpacks to more than {MOST_BYTES:,} bytes")
        if "data" not in group:
            return settled(np.zeros((rows, columns)))
        data, where = _numbers(self._read(group["data"])), self._read(group["ir"]).astype(int)
        ends = self._read(group["jc"]).astype(int)
        full = np.zeros((rows, columns), dtype=data.dtype)
        full[where, np.repeat(np.arange(columns), np.diff(ends))] = data
        return settled(full)


def _numbers(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return numbers, complex ones from their two parts."""
    if values.dtype.names == ("real", "imag"):
        return np.asarray(values["real"] + 1j * values["imag"])
    return values


def _empty(kind: str, shape: np.ndarray[Any, Any]) -> Any:  # noqa: ANN401
    """Return an empty value of a class and a size."""
    size = tuple(int(each) for each in shape)
    if len(size) < 2 or all(size) or max(size) > MOST_PARTS:
        raise LackError("has an empty value of a size that is none")
    if kind == "char":
        return ""
    if kind == "cell":
        return Cell(np.empty(size, dtype=object))
    if kind == "struct":
        return Structs(np.empty(size, dtype=object))
    return np.zeros(size, dtype=bool if kind == "logical" else float)


def _text(value: Any) -> str:  # noqa: ANN401 - bytes or text
    return value.decode("ascii", "replace") if isinstance(value, bytes) else str(value)
