"""Functions of texts."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    LackError,
    Text,
    array_of,
    boxed,
    numbers_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script
_SPEC = re.compile(r"%(?:%|([-+ 0#]*)(\*|\d{1,3})?(?:\.(\d{1,3}))?l?([diufFeEgGscxXo]))")
_LONGEST = 1_000_000  # letters of one text
_ESCAPES = {"n": "\n", "t": "\t", "\\": "\\", "r": "\r", "a": "\a", "b": "\b"}


def _parts(arguments: tuple[Any, ...], whole_texts: bool = True) -> Iterator[Any]:
    for value in arguments:
        if isinstance(value, str):
            yield str(value)
        elif isinstance(value, Cell):
            yield from _parts(tuple(value.items.ravel(order="F")))
        else:
            yield from (complex(x).real for x in array_of(value).ravel(order="F"))


def formatted(template: Any, *arguments: Any) -> str:
    """What ``sprintf`` makes."""
    text = re.sub(r"\\(.)", lambda m: _ESCAPES.get(m[1], m[0]), str(template))
    values = deque(_parts(arguments))
    specs = [m for m in _SPEC.finditer(text) if m[0] != "%%"]
    made: list[str] = []
    length = 0
    while not made or (values and specs):
        made.append(_once(text, values, bool(arguments)))
        length += len(made[-1])
        if length > _LONGEST:
            raise MatlabError(f"a text of more than {_LONGEST:,} letters is not made")
    return "".join(made)


def _once(text: str, values: deque[Any], given: bool) -> str:
    made, at = [], 0
    for match in _SPEC.finditer(text):
        made.append(text[at : match.start()])
        at = match.end()
        if match[0] == "%%":
            made.append("%")
        elif values:
            made.append(_one(match, values.popleft()))
        elif given:
            return "".join(made)
    return "".join([*made, text[at:]])


def _one(match: re.Match[str], value: Any) -> str:
    flags, width, digits, kind = match[1] or "", match[2] or "", match[3], match[4]
    point = f".{digits}" if digits is not None else ""
    if kind in "sc":
        text = value if isinstance(value, str) else _letter(value)
        return str(f"%{flags.replace('0', '')}{width}{point}s" % text)
    if isinstance(value, str):
        if len(value) != 1:
            return value
        value = float(ord(value))
    if kind in "diuxXo":
        if float(value).is_integer():
            return str(f"%{flags}{width}{'d' if kind in 'diu' else kind}" % int(value))
        kind = "f" if point else "e"
    return str(f"%{flags}{width}{point}{kind}" % value)


def _letter(value: float) -> str:
    """Return a number where a text is asked for: a whole one is the code of a letter."""
    is_code = float(value).is_integer() and 0.0 <= value < 0x110000
    return chr(int(value)) if is_code else f"{value:e}"


def short(value: float) -> str:
    """Number as ``num2str`` shows it."""
    if value != value:
        return "NaN"
    if value in (np.inf, -np.inf):
        return "Inf" if value > 0 else "-Inf"
    if float(value).is_integer() and abs(value) < 1e15:
        return str(int(value))
    digits = max(5, int(np.floor(np.log10(abs(value)))) + 5)
    return f"{value:.{min(digits, 16)}g}"


def num2str(value: Any, form: Any = None) -> str:
    """Text of numbers."""
    if isinstance(value, str):
        return str(value)
    if isinstance(form, str):
        return formatted(form, value)
    array = array_of(value)
    if form is not None:
        return "  ".join(f"{x:.{int(form)}g}" for x in array.ravel())
    return "  ".join(short(float(x)) for x in array.ravel())


def _each_text(function: Callable[..., Any]) -> Callable[..., Any]:
    """Work on a text, or on every one of a cell."""

    def applied(value: Any, *rest: Any) -> Any:
        if isinstance(value, Cell):
            made = np.empty(value.items.shape, dtype=object)
            for k in range(made.size):
                made.flat[k] = function(str(value.items.flat[k]), *rest)
            return Cell(made)
        return type(value)(function(str(value), *rest)) if isinstance(value, str) else value

    return applied


def _compared(test: Callable[..., bool]) -> Callable[..., Any]:
    def compare(left: Any, right: Any, *count: Any) -> Any:
        if isinstance(right, Cell) and not isinstance(left, Cell):
            left, right = right, left
        if isinstance(left, Cell):
            others = right.items.ravel() if isinstance(right, Cell) else [right] * left.items.size
            found = [one(a, b, *count) for a, b in zip(left.items.ravel(), others, strict=True)]
            return settled(np.array(found, dtype=bool).reshape(left.items.shape))
        return one(left, right, *count)

    def one(a: Any, b: Any, *count: Any) -> bool:
        return isinstance(a, str) and isinstance(b, str) and test(str(a), str(b), *count)

    return compare


def _str2num(text: Any) -> Any:
    rows = [row.split() for row in re.split(r"[;\n]", re.sub(r"[\[\],]", " ", str(text)))]
    try:
        numbers = [[float(word) for word in row] for row in rows if row]
        return settled(np.array(numbers, ndmin=2)) if numbers else np.zeros((0, 0))
    except ValueError:
        raise LackError(f"'str2num' reads numbers alone, not {str(text)[:60]!r}") from None


def _str2double(text: Any) -> Any:
    if isinstance(text, Cell):
        return settled(np.array([[_str2double(x) for x in row] for row in text.items]))
    try:
        return float(str(text).strip()) if isinstance(text, str) else float("nan")
    except ValueError:
        return float("nan")


def _replaced(text: str, old: Any, new: Any) -> str:
    old, new = str(old), str(new)
    if text.count(old) * len(new) > _LONGEST:
        raise MatlabError(f"a text of more than {_LONGEST:,} letters is not made")
    return text.replace(old, new) if old else text


def _strcat(*parts: Any) -> Any:
    if any(isinstance(part, Cell) for part in parts):
        size = max(part.items.size for part in parts if isinstance(part, Cell))
        shape = next(p.items.shape for p in parts if isinstance(p, Cell) and p.items.size == size)
        lists = [
            [str(x) for x in p.items.flat] * (size if p.items.size == 1 else 1)
            if isinstance(p, Cell)
            else [str(p)] * size
            for p in parts
        ]
        made = np.empty(size, dtype=object)
        for k in range(size):
            made[k] = "".join(words[k] for words in lists)
        return Cell(made.reshape(shape))
    return "".join(str(p) if isinstance(p, Text) else str(p).rstrip(" \t\n") for p in parts)


def _row(words: list[str]) -> Cell:
    return Cell(boxed([list(words)]))


def _split(text: Any, by: Any = " ") -> Cell:
    words = str(text).split(str(by)) if str(by) else [str(text)]
    return _row(list(words))


def _join(cell: Any, by: Any = " ") -> str:
    return str(by).join(str(x) for x in cell.items.ravel(order="F"))


def _found(text: Any, pattern: Any) -> Any:
    a, b = str(text), str(pattern)
    where = [float(k + 1) for k in range(len(a)) if b and a.startswith(b, k)]
    return settled(np.array([where])) if where else np.zeros((0, 0))


def _found_either(one: Any, other: Any) -> Any:
    """``findstr``: the shorter text in the longer one."""
    short, long = sorted((str(one), str(other)), key=len)
    return _found(long, short)


def _contains(text: Any, pattern: Any) -> Any:
    if isinstance(text, Cell):
        return settled(np.array([[str(pattern) in str(x) for x in row] for row in text.items]))
    return str(pattern) in str(text)


def _mat2str(value: Any, digits: Any = 15.0) -> str:
    array = array_of(value)
    rows = [" ".join(f"{x:.{int(digits)}g}" for x in row) for row in array]
    return rows[0] if array.size == 1 else f"[{';'.join(rows)}]"


def _fullfile(*parts: Any) -> str:
    return "/".join(str(part).rstrip("/\\") for part in parts if str(part))


def _file_parts(path: Any) -> Any:
    folder, _, last = str(path).replace("\\", "/").rpartition("/")
    stem, dot, ending = last.rpartition(".")
    return folder, stem if dot else last, dot + ending if dot else ""


def _char(value: Any) -> Any:
    if isinstance(value, str):
        return str(value)
    if isinstance(value, Cell):
        return str(value.items.flat[0]) if value.items.size == 1 else value
    return "".join(
        chr(int(code)) for code in numbers_of(value).real.ravel() if 0 <= code < 0x110000
    )


def _print(budget: Allowance, wanted: int, *arguments: Any) -> str:
    made = formatted(*arguments)
    budget.room(len(made))
    return made


def _signs(function: Callable[[str], bool]) -> Callable[[Any], Any]:
    """Make a function that tells something of each sign of a text; of numbers, it is false."""

    def told(value: Any) -> Any:
        if isinstance(value, str):
            return settled(np.array([[function(sign) for sign in value]], dtype=bool))
        return settled(np.zeros(np.shape(array_of(value)), dtype=bool))

    return told


def _first_word(text: Any, ends: Any = " \t\n\v\f\r\0") -> Any:
    """``[word, rest] = strtok(text, ends)``."""
    plain = str(text).lstrip(str(ends))
    length = next((k for k, sign in enumerate(plain) if sign in str(ends)), len(plain))
    return plain[:length], plain[length:]


_OF_TEXTS: dict[str, Callable[..., Any]] = {
    "num2str": num2str,
    "int2str": lambda value: num2str(settled(np.round(array_of(value)))),
    "mat2str": _mat2str,
    "str2num": _str2num,
    "str2double": _str2double,
    "strcat": _strcat,
    "strsplit": _split,
    "split": _split,
    "strjoin": _join,
    "strfind": _found,
    "findstr": _found_either,
    "contains": _contains,
    "strrep": _each_text(_replaced),
    "strtrim": _each_text(lambda text: text.strip()),
    "deblank": _each_text(lambda text: text.rstrip()),
    "isspace": _signs(str.isspace),
    "isletter": _signs(str.isalpha),
    "strtok": _first_word,
    "upper": _each_text(lambda text: text.upper()),
    "lower": _each_text(lambda text: text.lower()),
    "strcmp": _compared(lambda a, b: a == b),
    "strcmpi": _compared(lambda a, b: a.lower() == b.lower()),
    "strncmp": _compared(lambda a, b, n: len(a) >= n and a[: int(n)] == b[: int(n)]),
    "strncmpi": _compared(
        lambda a, b, n: len(a) >= n and a[: int(n)].lower() == b[: int(n)].lower()
    ),
    "startsWith": _compared(lambda a, b: a.startswith(b)),
    "endsWith": _compared(lambda a, b: a.endswith(b)),
    "char": _char,
    "string": lambda value: Text(num2str(value)),
    "cellstr": lambda value: value if isinstance(value, Cell) else _row([str(value)]),
    "fullfile": _fullfile,
    "fileparts": _file_parts,
    "filesep": lambda: "/",
    "pathsep": lambda: ":",
    "blanks": lambda count: " " * min(int(count), 10_000),
}
TEXTS: dict[str, Callable[..., Any]] = {
    "sprintf": _print,
    **{name: of_values(function) for name, function in _OF_TEXTS.items()},
}
