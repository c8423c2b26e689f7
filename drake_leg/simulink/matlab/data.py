"""Values of scripts: structures, cells and handles beside numbers and texts.

A scalar is a Python float, bool or complex; an array is a NumPy array of two or more dimensions
that never has one element; a text is a str.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.numeric import CALLS, MatlabError

STEPS = 2_000_000  # of all scripts of a model: nodes of statements that are carried out
MADE = 100_000_000  # elements of all arrays that they make
LARGEST = 2_000_000  # elements of one array


class LackError(MatlabError):
    """Something that the text needs and that is not known or not run here."""

    def __init__(self, reason: str, *, names: tuple[str, ...] = ()) -> None:
        self.names = names
        super().__init__(reason)


class SpentError(MatlabError):
    """The text took more than its budget."""


class StopError(MatlabError):
    """The text itself stops with an error; `said` is what it says, and `identifier` its name."""

    def __init__(self, reason: str, *, said: str = "", identifier: str = "") -> None:
        self.said, self.identifier = said, identifier
        super().__init__(reason)


class Struct(dict[str, Any]):
    """A structure of one element: its fields by name."""


class Text(str):
    """A text that was written in double quotes; ``+`` joins it."""

    __slots__ = ()


@dataclass(eq=False)
class Cell:
    """An array of values of any kind."""

    items: NDArray[Any]  # of objects, 2-D


@dataclass(eq=False)
class Structs:
    """An array of structures with the same fields; never of one element."""

    items: NDArray[Any]  # of Struct, 2-D
    names: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Function:
    """A function as a value: a name, or one expression with the variables that it saw."""

    name: str = ""
    inputs: tuple[str, ...] = ()
    body: syntax.Expression | None = None
    seen: Mapping[str, Any] = field(default_factory=dict)
    home: Any = None  # the functions of the file in which it was written


class LinearSystem:
    """A model of the Control System Toolbox."""

    KIND: ClassVar[str]  # MATLAB's name of its class


class Object:
    """A value that is shared rather than copied, with properties and methods."""

    kind = "handle"
    methods: frozenset[str] = frozenset()

    def property(self, name: str) -> Any:  # noqa: ANN401 - any value of a script
        """Value of a property."""
        raise LackError(f"a {self.kind} has no property '{name}' here", names=(name,))

    def set(self, name: str, value: Any) -> None:  # noqa: ANN401
        """Change a property."""
        raise LackError(f"the property '{name}' of a {self.kind} cannot be set here")

    def get(self, indices: list[Any]) -> Any:  # noqa: ANN401
        """Element at indices."""
        raise MatlabError(f"a {self.kind} is not indexed")

    def put(self, indices: list[Any], value: Any) -> None:  # noqa: ANN401
        """Set an element."""
        raise MatlabError(f"a {self.kind} is not indexed")

    def count(self) -> int:
        """How many elements it has."""
        return 1


@dataclass(kw_only=True)
class Allowance:
    """What a script may still take."""

    steps: int = STEPS
    elements: int = MADE
    largest: int = LARGEST
    nesting: int = CALLS
    taken: int = 0
    made: int = 0
    until: int = 0  # steps of the script that runs; 0 for all of them

    def share(self, part: float) -> None:
        """Let what runs next take a part of all steps at most."""
        self.until = self.taken + int(self.steps * part)

    def step(self, count: int = 1) -> None:
        """Count steps."""
        self.taken += count
        if self.taken > (min(self.until, self.steps) if self.until else self.steps):
            raise SpentError(
                f"it takes more than {self.steps:,} steps: shorten its loops or its arrays"
            )

    def work(self, operations: float) -> None:
        """Count operations on elements, a hundred as one step."""
        self.step(int(min(operations, 1e15)) // 100)

    def room(self, count: float) -> None:
        """Count an array's elements before it is made."""
        if not count <= self.largest:
            raise SpentError(f"an array has more than {self.largest:,} elements")
        self.made += int(count)
        if self.made > self.elements:
            raise SpentError(f"its arrays have more than {self.elements:,} elements in all")


def settled(array: Any) -> Any:  # noqa: ANN401 - any value of a script
    """Make an array of NumPy's a value: one element is a scalar; zero imaginary parts go."""
    if not isinstance(array, (np.ndarray, np.generic)):
        return array
    if np.iscomplexobj(array) and not np.any(np.imag(array)):
        array = np.real(array)
    if array.dtype != np.bool_ and array.dtype not in (np.float64, np.complex128):
        array = array.astype(np.float64)
    if array.size == 1:
        return array.item()
    while array.ndim > 2 and array.shape[-1] == 1:
        array = array[..., 0]
    return np.atleast_2d(array)


def array_of(value: Any) -> NDArray[Any]:  # noqa: ANN401
    """Take a value for an array of numbers, of two dimensions at least."""
    if isinstance(value, np.ndarray):
        return value
    if isinstance(value, str):
        return np.array([[float(ord(sign)) for sign in value]]).reshape(1, len(value))
    if isinstance(value, (float, bool, complex, int)):
        return np.array([[value]])
    raise MatlabError(f"a {kind_of(value)} is used where a number is needed")


def numbers_of(value: Any) -> NDArray[Any]:  # noqa: ANN401
    """Take a value for numbers: true is 1, and a text is the codes of its letters."""
    array = array_of(value)
    return array.astype(np.float64) if array.dtype == np.bool_ else array


def kind_of(value: Any) -> str:  # noqa: ANN401
    """MATLAB's name of a value's class."""
    if isinstance(value, np.ndarray):
        return "logical" if value.dtype == np.bool_ else "double"
    if isinstance(value, Text):
        return "string"
    if isinstance(value, Object):
        return value.kind
    if isinstance(value, LinearSystem):
        return value.KIND
    kinds = {
        bool: "logical",
        str: "char",
        Cell: "cell",
        Struct: "struct",
        Structs: "struct",
        Function: "function_handle",
    }
    return kinds.get(type(value), "double")


def extent(value: Any) -> tuple[int, ...]:  # noqa: ANN401
    """Size of a value."""
    if isinstance(value, np.ndarray):
        return tuple(value.shape)
    if isinstance(value, (Cell, Structs)):
        return tuple(value.items.shape)
    if isinstance(value, Text):
        return (1, 1)
    if isinstance(value, Object):
        return (value.count(), 1)
    if isinstance(value, str):
        return (1 if value else 0, len(value))
    return (1, 1)


def items_of(value: Any) -> NDArray[Any]:  # noqa: ANN401
    """Elements of any value as an array of two or more dimensions."""
    if isinstance(value, (Cell, Structs)):
        return value.items
    if isinstance(value, (Struct, Function, Text, Object)):
        return boxed([[value]])
    return array_of(value)


def boxed(rows: list[list[Any]]) -> NDArray[Any]:
    """Put values into an array of objects."""
    array = np.empty((len(rows), len(rows[0]) if rows else 0), dtype=object)
    for i, row in enumerate(rows):
        for j, value in enumerate(row):
            array[i, j] = value
    return array


def like(value: Any, items: NDArray[Any]) -> Any:  # noqa: ANN401
    """Make elements a value of the same kind as another."""
    if isinstance(value, Cell):
        return Cell(np.atleast_2d(items))
    if isinstance(value, (Struct, Structs)):
        if items.size == 1:
            return items.flat[0]
        names = tuple(value) if isinstance(value, Struct) else value.names
        return Structs(np.atleast_2d(items), names)
    if isinstance(value, (Function, Text, Object)):
        return items.flat[0] if items.size == 1 else Cell(items)
    if isinstance(value, str):
        return "".join(chr(int(code)) for code in items.ravel(order="F"))
    return settled(items)


Known = Callable[..., Any]  # of the budget, the count of values wanted, and the arguments


def of_values(function: Callable[..., Any]) -> Known:
    """Make a function that needs no budget one of the library."""
    return lambda budget, wanted, *arguments: function(*arguments)
