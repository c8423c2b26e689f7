"""Objects that scripts share: ``containers.Map``, ``inputParser``, ``Simulink.Parameter``."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import operators, syntax
from drake_leg.simulink.matlab.data import (
    Cell,
    Function,
    LackError,
    Object,
    StopError,
    Struct,
    array_of,
    boxed,
    settled,
)
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script
Method = Callable[["Interpreter", Any, "Values", "Frame"], Any]


def method_of(node: syntax.Expression, frame: Frame) -> tuple[Object, str] | None:
    """Find the object and the method of ``a.b.method`` without evaluating anything."""
    if not isinstance(node, syntax.Field) or not isinstance(node.name, str):
        return None
    path, base = [], node.base
    while isinstance(base, syntax.Field) and isinstance(base.name, str):
        path.append(base.name)
        base = base.base
    value = frame.values.get(base.name) if isinstance(base, syntax.Name) else None
    for name in reversed(path):
        value = value.get(name) if isinstance(value, Struct) else None
    if isinstance(value, Object) and node.name in value.methods:
        return value, node.name
    return None


def call_method(self: Interpreter, name: str, arguments: Values, frame: Frame) -> Values:
    """Call a method with its object and what follows."""
    owner, *rest = arguments
    found = METHODS[name](self, owner, rest, frame)
    return [] if found is None else [found]


# --- containers.Map ---------------------------------------------------------------------------


class Map(Object):
    """A table from texts, or from numbers, to any values; its keys are in order."""

    kind = "containers.Map"
    methods = frozenset(("keys", "values", "isKey", "remove", "length", "numel"))

    def __init__(self, *, numeric: bool = False) -> None:
        self.numeric = numeric
        self.items: dict[Any, Any] = {}

    def key(self, given: Any) -> Any:
        """Take a value for a key."""
        if self.numeric != (not isinstance(given, str)):
            kind = "numbers" if self.numeric else "texts"
            raise MatlabError(f"the keys of this map are {kind}")
        if not self.numeric:
            return str(given)
        number = array_of(given)
        if number.size != 1:
            raise MatlabError("a key of a map is one number")
        return float(number.real.flat[0])

    def get(self, indices: list[Any]) -> Any:
        """Value of a key."""
        key = self.key(indices[0])
        if key not in self.items or len(indices) > 1:
            raise MatlabError(f"the map has no key {key!r:.60}")
        return self.items[key]

    def put(self, indices: list[Any], value: Any) -> None:
        """Set the value of a key."""
        self.items[self.key(indices[0])] = value

    def property(self, name: str) -> Any:
        """Count and kinds."""
        known = {
            "Count": float(len(self.items)),
            "KeyType": "double" if self.numeric else "char",
            "ValueType": "any",
        }
        return known[name] if name in known else super().property(name)

    def count(self) -> int:
        """How many keys it has."""
        return len(self.items)

    def sorted(self) -> list[Any]:
        """Keys in order."""
        return sorted(self.items)


_OPTIONS = ("KeyType", "ValueType", "UniformValues")


def _map(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``containers.Map(keys, values)``, or of key types alone."""
    plain, options = list(arguments), {}
    while len(plain) >= 2 and isinstance(plain[-2], str) and plain[-2] in _OPTIONS:
        options[str(plain[-2])], plain = plain[-1], plain[:-2]
    if len(plain) > 2:
        raise MatlabError("'containers.Map' takes keys and values")
    several = bool(plain) and (isinstance(plain[0], Cell) or _counted(plain[0]) > 1)
    keys = (_each(plain[0]) if several else [plain[0]]) if plain else []
    numeric = str(options.get("KeyType", "char")) not in ("char", "string")
    made = Map(numeric=numeric if not keys else not isinstance(keys[0], str))
    if len(plain) == 2:
        values = _each(plain[1]) if several else [plain[1]]
    else:
        values = [np.zeros((0, 0))] * len(keys)
    if len(values) != len(keys):
        raise MatlabError(f"'containers.Map' has {len(keys)} keys and {len(values)} values")
    for key, value in zip(keys, values, strict=True):
        made.put([key], value)
    return [made]


def _list(value: Any) -> list[Any]:
    return list(value.items.ravel(order="F")) if isinstance(value, Cell) else [value]


def _counted(value: Any) -> int:
    return 1 if isinstance(value, str) else int(np.size(value))


def _each(value: Any) -> list[Any]:
    """Return the elements of a cell array, or of an array of numbers."""
    if isinstance(value, np.ndarray):
        return [settled(element) for element in value.ravel(order="F")]
    return _list(value)


def _row(values: list[Any]) -> Cell:
    return Cell(boxed([values]) if values else np.empty((1, 0), dtype=object))


def _keys(self: Interpreter, owner: Map, rest: Values, frame: Frame) -> Any:
    return _row(owner.sorted())


def _map_values(self: Interpreter, owner: Map, rest: Values, frame: Frame) -> Any:
    keys = _list(rest[0]) if rest else owner.sorted()
    return _row([owner.get([key]) for key in keys])


def _is_key(self: Interpreter, owner: Map, rest: Values, frame: Frame) -> Any:
    if isinstance(rest[0], Cell):
        found = [
            isinstance(key, str) != owner.numeric and owner.key(key) in owner.items
            for key in rest[0].items.flat
        ]
        return settled(np.array(found, dtype=bool).reshape(rest[0].items.shape))
    return isinstance(rest[0], str) != owner.numeric and owner.key(rest[0]) in owner.items


def _remove(self: Interpreter, owner: Map, rest: Values, frame: Frame) -> Any:
    for key in _list(rest[0]):
        owner.get([key])
        del owner.items[owner.key(key)]
    return owner


def _size(self: Interpreter, owner: Map, rest: Values, frame: Frame) -> Any:
    return float(owner.count())


# --- inputParser ------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Input:
    """An input that a parser expects."""

    name: str
    role: str  # "required", "optional", "parameter" or "switch"
    default: Any = None
    check: Function | None = None


class InputParser(Object):
    """What the inputs of a function must be, and what they are."""

    kind = "inputParser"
    methods = frozenset((
        "addRequired", "addOptional", "addParameter", "addParamValue", "addSwitch", "parse",
    ))  # fmt: skip
    _SETTINGS = ("KeepUnmatched", "CaseSensitive", "PartialMatching", "StructExpand")

    def __init__(self) -> None:
        self.inputs: list[Input] = []
        self.settings: dict[str, Any] = {
            "FunctionName": "",
            **dict.fromkeys(("KeepUnmatched", "CaseSensitive"), False),
            **dict.fromkeys(("PartialMatching", "StructExpand"), True),
        }
        self.found: dict[str, Any] = {
            "Results": Struct(), "Unmatched": Struct(), "UsingDefaults": _row([]),
        }  # fmt: skip

    def property(self, name: str) -> Any:
        """Results, and settings."""
        if name == "Parameters":
            return _row([each.name for each in self.inputs])
        known = self.settings | self.found
        return known[name] if name in known else super().property(name)

    def set(self, name: str, value: Any) -> None:
        """Change a setting."""
        if name not in self.settings:
            super().set(name, value)
        self.settings[name] = value

    def matching(self, name: str) -> Input | None:
        """Find the option that a text names."""
        fold = (lambda text: text) if self.settings["CaseSensitive"] else str.lower
        named = [each for each in self.inputs if each.role in ("parameter", "switch")]
        exact = [each for each in named if fold(each.name) == fold(name)]
        begun = [each for each in named if name and fold(each.name).startswith(fold(name))]
        if exact:
            return exact[0]
        return begun[0] if len(begun) == 1 and self.settings["PartialMatching"] else None

    def fault(self, problem: str) -> StopError:
        """Return the error of a wrong input."""
        about = self.settings["FunctionName"]
        said = f"{about}: {problem}" if about else problem
        return StopError(
            f"it stops with the error {said!r:.80}",
            said=said,
            identifier="MATLAB:InputParser:ArgumentFailedValidation",
        )


def _adds(role: str) -> Method:
    """``addRequired(p, name, check)`` and its kin, ``add...(p, name, default, check)``."""

    def add(self: Interpreter, owner: InputParser, rest: Values, frame: Frame) -> None:
        name, *more = rest
        default = False if role == "switch" else None
        if role in ("optional", "parameter"):
            default, *more = more
        check = more[0] if more and isinstance(more[0], Function) else None
        new = Input(name=str(name), role=role, default=default, check=check)
        owner.inputs = [each for each in owner.inputs if each.name != new.name] + [new]

    return add


def _passes(self: Interpreter, one: Input, value: Any, frame: Frame) -> bool:
    """Whether a check, which may return false or stop with an error, accepts a value."""
    if one.check is None:
        return True
    try:
        found = self.apply(one.check, [value], 0, frame)
    except StopError:
        return False
    return not found or operators.truth(found[0])


def _parse(self: Interpreter, owner: InputParser, rest: Values, frame: Frame) -> None:
    """``parse(p, inputs...)``: required ones, optional ones, then names and values."""
    results, left = Struct(), list(rest)
    for one in owner.inputs:
        if one.role == "required":
            if not left:
                raise owner.fault("Not enough input arguments.")
            results[one.name] = left.pop(0)
            _require(self, owner, one, results[one.name], frame)
    for one in owner.inputs:
        if one.role == "optional" and left:
            value = left[0]
            named = isinstance(value, str) and owner.matching(str(value)) is not None
            if named and (one.check is None or not _passes(self, one, value, frame)):
                break
            _require(self, owner, one, value, frame)
            results[one.name] = left.pop(0)
    unmatched = _named(self, owner, left, results, frame)
    usual = [each for each in owner.inputs if each.name not in results]
    results.update({each.name: each.default for each in usual})
    owner.found = {
        "Results": Struct(sorted(results.items(), key=lambda item: item[0].lower())),
        "Unmatched": unmatched,
        "UsingDefaults": _row([each.name for each in usual]),
    }


def _require(self: Interpreter, owner: InputParser, one: Input, value: Any, frame: Frame) -> None:
    if not _passes(self, one, value, frame):
        raise owner.fault(f"The value of '{one.name}' is invalid.")


def _named(
    self: Interpreter, owner: InputParser, left: Values, results: Struct, frame: Frame
) -> Struct:
    """Take names and values; return those that nothing expects."""
    unmatched = Struct()
    while left:
        name = left.pop(0)
        if isinstance(name, Struct) and owner.settings["StructExpand"]:
            left[:0] = [part for pair in name.items() for part in pair]
            continue
        if not isinstance(name, str):
            raise owner.fault("A name of a parameter is expected where a value is.")
        one = owner.matching(str(name))
        if one is not None and one.role == "switch":
            results[one.name] = True
            continue
        if not left:
            raise owner.fault(f"No value was given for '{name}'.")
        value = left.pop(0)
        if one is None:
            if not operators.truth(owner.settings["KeepUnmatched"]):
                raise owner.fault(f"'{name}' is not a recognized parameter.")
            unmatched[str(name)] = value
            continue
        _require(self, owner, one, value, frame)
        results[one.name] = value
    return unmatched


def _parser(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    if arguments:
        raise LackError("'inputParser' takes no inputs")
    return [InputParser()]


# --- Simulink.Parameter -----------------------------------------------------------------------


class Parameter(Object):
    """A value for parameters of blocks, with what is said about it."""

    kind = "Simulink.Parameter"

    def __init__(self, value: Any) -> None:
        none = np.zeros((0, 0))
        self.held: dict[str, Any] = {
            "Value": value, "DataType": "auto", "Min": none, "Max": none, "Unit": "",
            "DocUnits": "", "Description": "", "Complexity": "real", "Dimensions": none,
            "CoderInfo": Struct(StorageClass="Auto"), "StorageClass": "Auto",
        }  # fmt: skip

    def property(self, name: str) -> Any:
        """Return its value, or what is said about it."""
        return self.held[name] if name in self.held else super().property(name)

    def set(self, name: str, value: Any) -> None:
        """Change its value, or what is said about it."""
        if name not in self.held:
            super().set(name, value)
        self.held[name] = value


def _parameter(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    if len(arguments) > 1:
        raise LackError("'Simulink.Parameter' takes one value")
    return [Parameter(arguments[0] if arguments else np.zeros((0, 0)))]


class OfBlocks(ChainMap[str, Any]):
    """Variables as parameters of blocks see them: of a `Parameter`, its value."""

    def __getitem__(self, name: str) -> Any:
        """Return a value."""
        value = super().__getitem__(name)
        return value.held["Value"] if isinstance(value, Parameter) else value


METHODS: Mapping[str, Method] = {
    "keys": _keys,
    "values": _map_values,
    "isKey": _is_key,
    "remove": _remove,
    "length": _size,
    "numel": _size,
    "addRequired": _adds("required"),
    "addOptional": _adds("optional"),
    "addParameter": _adds("parameter"),
    "addParamValue": _adds("parameter"),
    "addSwitch": _adds("switch"),
    "parse": _parse,
}
HANDLES: dict[str, Any] = {
    "containers.Map": _map,
    "inputParser": _parser,
    "Simulink.Parameter": _parameter,
}
