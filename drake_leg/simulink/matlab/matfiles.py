"""Variables of .mat files, read by SciPy and h5py; nothing in them is carried out."""

from __future__ import annotations

import struct
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatlabOpaque

from drake_leg.simulink.matlab.data import Cell, LackError, Struct, Structs, settled
from drake_leg.simulink.matlab.hdf5files import names_of_hdf5, read_hdf5
from drake_leg.simulink.matlab.objects import Objects, elements_of, read_element

MAT_BYTES = 100_000_000  # of a file, and of what is packed in it
_HEAD = 128
_HDF5 = (b"MATLAB 7.3", b"\x89HDF\r\n\x1a\n")  # how files of version 7.3 begin
_PACKED = 15  # kind of an element that is compressed


def read_mat(path: Path) -> dict[str, Any]:
    """Read the variables of a .mat file of versions 4 to 7.3.

    Raises
    ------
    LackError
        If it is none, is damaged or larger than the limits; or if it is of version 7.3 and h5py is
        not installed.
    """
    if require_readable(path).startswith(_HDF5):
        return read_hdf5(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = loadmat(path, struct_as_record=True, chars_as_strings=True)
    except Exception as error:
        raise LackError(f"{path.name} is no .mat file: {str(error)[:80]}") from None
    objects = Objects()
    made = {
        name: _value(value, objects) for name, value in found.items() if not name.startswith("__")
    }
    return {name: value for name, value in made.items() if value is not None}


def require_readable(path: Path) -> bytes:
    """Read a .mat file as it is, if it is not too large, packed or unpacked.

    Raises
    ------
    LackError
        If it is, or cannot be read.
    """
    try:
        if path.stat().st_size > MAT_BYTES:
            raise LackError(f"{path.name} is larger than {MAT_BYTES:,} bytes")
        content = path.read_bytes()
    except OSError as error:
        raise LackError(f"{path.name} cannot be read: {error.strerror}") from None
    if content.startswith(b"MATLAB 5"):
        _require_small(content, path.name)
    return content


def names_of_mat(path: Path) -> set[str]:
    """Names of the variables of a .mat file; none where it cannot be read."""
    try:
        if path.stat().st_size > MAT_BYTES:
            return set()
        with path.open("rb") as file:
            if file.read(_HEAD).startswith(_HDF5):
                return names_of_hdf5(path)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return {name for name, _, _ in whosmat(path)}
    except Exception:
        return set()


def read_struct(content: bytes, name: str) -> dict[str, Any]:
    """Read the fields of the structure that a model keeps its workspace in.

    Raises
    ------
    LackError
        If it is damaged, or larger than the limits.
    """
    if len(content) > MAT_BYTES:
        raise LackError(f"{name} is larger than {MAT_BYTES:,} bytes")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            first, *others = elements_of(content)
            objects = Objects(read_element(others[0], content[:4]).tobytes() if others else b"")
            fields = _value(read_element(first, content[:4]), objects)
    except Exception as error:
        raise LackError(f"{name} is damaged: {str(error)[:80]}") from None
    known = fields if isinstance(fields, Struct) else Struct()
    return {key: value for key, value in known.items() if value is not None}


def _require_small(content: bytes, name: str) -> None:
    """Refuse a file that unpacks to more than the limit."""
    order = ">" if content[126:128] == b"MI" else "<"
    at, total = _HEAD, 0
    while at + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}2I", content, at)
        if kind == _PACKED:
            total += _unpacked_size(content[at + 8 : at + 8 + size], MAT_BYTES - total)
        if total >= MAT_BYTES:
            raise LackError(f"{name} unpacks to more than {MAT_BYTES:,} bytes")
        at += 8 + size


def _unpacked_size(packed: bytes, most: int) -> int:
    unpacker, total = zlib.decompressobj(), 0
    while packed and total < most:
        try:
            total += len(unpacker.decompress(packed, 1 << 20))
        except zlib.error:
            break
        packed = unpacker.unconsumed_tail
    return total


def _value(value: Any, objects: Objects) -> Any:  # noqa: ANN401 - any value of a script
    if isinstance(value, MatlabOpaque):
        held = objects.property(value["arr"][0], "Value")
        return None if held is None else _value(held, objects)
    if not isinstance(value, np.ndarray):
        return None
    if value.dtype.names:
        items = np.empty(value.shape, dtype=object)
        for k in range(value.size):
            one = value.flat[k]
            names = value.dtype.names
            items.flat[k] = Struct({name: _value(one[name], objects) for name in names})
        return items.flat[0] if items.size == 1 else Structs(items, value.dtype.names)
    if value.dtype == object:
        items = np.empty(value.shape, dtype=object)
        for k in range(value.size):
            items.flat[k] = _value(value.flat[k], objects)
        return Cell(items)
    if value.dtype.kind in "US":
        return str(value.flat[0]) if value.size else ""
    if value.dtype.kind in "biufc":
        return settled(np.atleast_2d(value))
    return None
