"""Objects in MATLAB's binary data, such as ``Simulink.Parameter``: their properties by name.

Data that hold objects refer to them by number; the objects lie in a part of their own, a list
whose first element says which property of which object is which element.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

_REFERENCE = 0xDD000000  # that a reference to an object begins with
_HEAD = 40  # bytes: version, count of names, eight offsets
_FIRST = 2  # element of the list that holds the first value
_IN_LIST = 1  # mark of a property whose value is an element of the list


def elements_of(content: bytes) -> Iterator[bytes]:
    """Split data into its elements; each may be read as a file of one."""
    order = ">" if content[2:4] == b"MI" else "<"
    at = 8
    while at + 8 <= len(content):
        _, size = struct.unpack_from(f"{order}2I", content, at)
        yield content[at : at + 8 + size]
        at += 8 + size


def read_element(element: bytes, mark: bytes) -> Any:  # noqa: ANN401 - as SciPy reads it
    """Read one element; `mark` is the four bytes that say the order of bytes."""
    whole = b"MATLAB 5.0 MAT-file".ljust(124) + mark + element
    found = loadmat(io.BytesIO(whole), struct_as_record=True, chars_as_strings=True)
    return next((value for value in found.values() if isinstance(value, np.ndarray)), None)


class Objects:
    """The objects of a file, from the part that holds them.

    Parameters
    ----------
    content : bytes, optional
        That part; without it there are no objects.
    """

    def __init__(self, content: bytes = b"") -> None:
        self._list: NDArray[Any] = np.empty((0, 1), dtype=object)
        self._properties: list[dict[str, int]] = []  # of each set: name to element
        self._sets: dict[int, int] = {}  # number of an object to its set of properties
        if content:
            self._read(content)

    def _read(self, content: bytes) -> None:
        holder = read_element(next(elements_of(content)), content[:4])
        self._list = holder["MCOS"][0, 0]["arr"][0]
        head = self._list[0, 0].tobytes()
        offsets = struct.unpack_from("<8I", head, 8)
        names = [name.decode("utf-8", "replace") for name in head[_HEAD : offsets[0]].split(b"\0")]
        objects = np.frombuffer(head[offsets[2] : offsets[3]], "<u4")
        for number, row in enumerate(objects[: objects.size // 6 * 6].reshape(-1, 6)):
            self._sets[number] = int(row[4])
        words = np.frombuffer(head[offsets[3] : offsets[4]], "<u4").tolist()
        at = 0
        while at < len(words):
            count = words[at]
            rows = [words[at + 1 + 3 * k : at + 4 + 3 * k] for k in range(count)]
            self._properties.append(
                {names[name - 1]: value for name, mark, value in rows if mark == _IN_LIST}
            )
            at += 1 + 3 * count
            at += at % 2  # sets begin at eight bytes

    def all(self) -> Iterator[dict[str, Any]]:
        """Yield the properties of every object, by name."""
        for number in self._sets:
            yield self.of(number)

    def of(self, number: int) -> dict[str, Any]:
        """Properties of an object, by name; those at their defaults are not told."""
        chosen = self._sets.get(number, -1)
        known = self._properties[chosen] if 0 <= chosen < len(self._properties) else {}
        last = self._list.shape[0] - _FIRST
        return {name: self._list[at + _FIRST, 0] for name, at in known.items() if 0 <= at < last}

    def numbers_in(self, reference: Any) -> list[int]:  # noqa: ANN401
        """Numbers of the objects that a reference, or an array of references, names."""
        numbers = np.asarray(reference).ravel().tolist()
        if len(numbers) < 6 or int(numbers[0]) != _REFERENCE:
            return []
        return [int(each) for each in numbers[2 + int(numbers[1]) : -1]]

    def property(self, reference: Any, name: str) -> Any:  # noqa: ANN401
        """Value of a property of an object, by a reference to it; None where there is none."""
        numbers = np.asarray(reference).ravel()
        if numbers.size < 6 or int(numbers[0]) != _REFERENCE:
            return None
        chosen = self._sets.get(int(numbers[-2]))
        if chosen is None or chosen >= len(self._properties):
            return None
        place = self._properties[chosen].get(name)
        if place is None or place + _FIRST >= self._list.shape[0]:
            return None
        return self._list[place + _FIRST, 0]
