"""Functions of the library in compiled code: written out where that is simple, else called."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from drake_leg.simulink.matlab.compiling.arithmetic import (
    WRITTEN_OUT,
    added,
    by_elements,
    combined,
    folded,
)
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    floats,
    is_constant,
    moved,
    positions,
    value_of,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    REALS,
    Numbers,
    Word,
    is_small,
    kind_of_value,
    sample,
)
from drake_leg.simulink.matlab.compiling.source import (
    COMPARISON,
    PRODUCT,
    called,
    joined,
    literal,
)
from drake_leg.simulink.matlab.compiling.translation import Translation, checked
from drake_leg.simulink.matlab.data import Allowance
from drake_leg.simulink.matlab.library import KNOWN
from drake_leg.simulink.matlab.numeric import quiet

_OF_SHAPES = """size numel length isempty ndims rows height columns width isscalar isvector ismatrix
issquare isrow iscolumn isfield iscell isstruct ischar isstring isnumeric isfloat islogical isreal
isa class iscellstr"""
_OF_KINDS = """islogical isnumeric isfloat isa class"""
_MOVING = "reshape repmat fliplr flipud flip circshift horzcat vertcat cat squeeze permute"
_MOVING_FLOATS = "diag tril triu"
_OF_VALUES = """find unique zeros ones eye cell repmat linspace logspace roots union intersect
setdiff colon null orth nan NaN inf Inf true false blanks nchoosek factorial reshape num2cell"""
_DRAWING = "randn randperm"
_SAME = "real double single full conj"
_OF_PYTHON = """sin cos tan atan sinh cosh tanh asinh exp log log2 log10 log1p expm1 sqrt asin acos
acosh atanh"""
_SAFE = {"floor": "floored", "ceil": "ceiled", "fix": "fixed", "sign": "sign", "round": "rounded"}
_OF_TWO = {"atan2": "atan2", "hypot": "hypot", "mod": "mod", "rem": "rem"}
_OPERATORS = {
    "power": ".^",
    "plus": "+",
    "minus": "-",
    "times": ".*",
    "rdivide": "./",
    "and": "&",
    "or": "|",
    "eq": "==",
    "ne": "~=",
    "lt": "<",
    "le": "<=",
    "gt": ">",
    "ge": ">=",
    "mtimes": "*",
    "mrdivide": "/",
    "mldivide": "\\",
    "mpower": "^",
}


def library(t: Translation, name: str, given: list[Code], wanted: int) -> list[Code]:
    """Call a function of the library."""
    if name in _DRAWING.split():
        return _unknown(t, name, given, wanted)
    if wanted <= 1:
        found = _of_constants(name, given) or _simple(t, name, given)
        if found is not None:
            return [t.short(found)]
    return _expected(t, name, given, wanted) or _unknown(t, name, given, wanted)


def _of_constants(name: str, given: list[Code]) -> Code | None:
    if not is_constant(*given):
        return None
    values = [value_of(code) for code in given]
    return folded(lambda budget: KNOWN[name](budget, 1, *values))


def _simple(t: Translation, name: str, given: list[Code]) -> Code | None:
    """Write a function out, where that is simple."""
    if name in _OF_SHAPES.split():
        return _of_shapes(name, [t.atoms(code) for code in given])
    if name in _OPERATORS and len(given) == 2:
        return combined(t, _OPERATORS[name], *given)
    if not given or not is_small(given[0].kind):
        return None
    if name in (*_MOVING.split(), *_MOVING_FLOATS.split()):
        return _moving(name, [t.atoms(code) for code in given])
    if not all(is_small(code.kind) for code in given):
        return None
    if len(given) == 1:
        found = _of_each(t, name, given[0]) or _reduced(t, name, given[0])
        return found or _of_square(t, name, given[0])
    if len(given) == 2 and name in _OF_TWO and t.daring:
        return _pairs(t, _OF_TWO[name], *given)
    if len(given) == 2 and name in ("max", "min") and all(code.parts for code in given):
        return _pairs(t, "larger" if name == "max" else "smaller", *given)
    if len(given) == 2 and name in ("dot", "cross"):
        return _of_vectors(t, name, *given)
    return None


def _pairs(t: Translation, rule: str, left: Code, right: Code) -> Code | None:
    """Write a function of two numbers for each pair of elements."""
    return by_elements(
        t, left, right, lambda x, y: called(rule, floats(x)[0], floats(y)[0]), "float"
    )


def _of_shapes(name: str, given: list[Code]) -> Code | None:
    """Functions of sizes and kinds, which are known."""
    samples = [sample(code.kind) for code in given]
    if any(value is None for value in samples) or not is_constant(*given[1:]):
        return None
    mixed = any(isinstance(code.kind, Numbers) and code.kind.kind == "mixed" for code in given[:1])
    if mixed and name in _OF_KINDS.split():
        return None
    return folded(lambda budget: KNOWN[name](budget, 1, *samples))


def _moving(name: str, given: list[Code]) -> Code | None:
    """Functions that move elements: they move the numbers of the places."""
    joins = name in ("horzcat", "vertcat")
    small = [code for code in given if is_small(code.kind)]
    blocks = small if joins else given[1:] if name == "cat" else given[:1]
    if (joins and len(small) < len(given)) or not all(is_small(code.kind) for code in blocks):
        return None
    kinds = {code.kind.kind for code in blocks if isinstance(code.kind, Numbers)}
    if len(kinds) != 1 or "mixed" in kinds:
        return None
    if not is_constant(*(code for code in given if code not in blocks)):
        return None
    parts: list[str] = []
    values = []
    for code in given:
        if any(code is block for block in blocks):
            values.append(positions(code, len(parts) + 1))
            parts += floats(code) if name in _MOVING_FLOATS.split() else code.parts
        else:
            values.append(value_of(code))
    try:
        found = KNOWN[name](Allowance(largest=10_000), 1, *values)
    except Exception:
        return None
    if np.size(found) > 16:
        return None
    return moved(found, tuple(parts), "float" if name in _MOVING_FLOATS.split() else kinds.pop())


# --- functions of each element ----------------------------------------------------------------


def _of_each(t: Translation, name: str, code: Code) -> Code | None:
    kind = code.kind
    assert isinstance(kind, Numbers)
    rule = _rule(t, name)
    if rule is None:
        return None
    made, result = rule
    if name in ("isnan", "isinf"):
        code = t.atoms(code)
    parts = code.parts if result == "kept" else floats(code)
    result = "float" if result == "kept" else result
    if name in ("double", "single", "full") and kind.kind == "mixed":
        return None
    if name in ("double", "full", "single", "real", "conj"):
        parts, result = floats(code), "float"
    return Code(Numbers(result, kind.shape), tuple(map(made, parts)), fresh=True)


def _rule(t: Translation, name: str) -> tuple[Callable[[str], str], str] | None:
    """Return how a function of one number is written, and the kind of what it gives."""
    if name in _SAME.split():
        return (lambda part: part), "float"
    if name in _SAFE:
        return (lambda part: called(_SAFE[name], part)), "float"
    if name in _OF_PYTHON.split() and t.daring:
        return (lambda part: called(name, part)), "float"
    rules: dict[str, tuple[Callable[[str], str], str]] = {
        "abs": (lambda part: called("abs", part), "float"),
        "deg2rad": (lambda part: joined(literal(math.pi / 180.0), "*", part, PRODUCT), "float"),
        "rad2deg": (lambda part: joined(literal(180.0 / math.pi), "*", part, PRODUCT), "float"),
        "isnan": (lambda part: joined(part, "!=", part, COMPARISON), "bool"),
        "isinf": (lambda part: called("isinf", part), "bool"),
        "isfinite": (lambda part: called("isfinite", part), "bool"),
    }
    return rules.get(name)


# --- functions of vectors ---------------------------------------------------------------------


def _lines(code: Code) -> tuple[list[list[str]], tuple[int, int]] | None:
    """Lines of a matrix along its first dimension that is not 1 long, and the result's size."""
    assert isinstance(code.kind, Numbers)
    shape = code.kind.shape
    if shape is None or len(shape) != 2 or not code.parts:
        return None
    parts = floats(code)
    rows, columns = shape
    if rows == 1:
        return [list(parts)], (1, 1)
    return [list(parts[rows * j : rows * (j + 1)]) for j in range(columns)], (1, columns)


def _reduced(t: Translation, name: str, code: Code) -> Code | None:
    if name == "trace" and isinstance(code.kind, Numbers) and code.kind.shape:
        rows = code.kind.shape[0]
        if code.kind.shape != (rows, rows) or not rows:
            return None
        return Code(Numbers("float", (1, 1)), (added(list(floats(code)[:: rows + 1])),))
    if name not in ("sum", "prod", "mean", "max", "min", "norm"):
        return None
    code = t.atoms(code) if name == "norm" else code
    lines = _lines(code)
    if lines is None or (name == "norm" and (lines[1] != (1, 1) or not t.daring)):
        return None
    parts = tuple(_of_line(name, line) for line in lines[0])
    return Code(Numbers("float", lines[1]), parts, fresh=True)


def _of_line(name: str, line: list[str]) -> str:
    if name in ("max", "min"):
        total = line[0]
        for part in line[1:]:
            total = called("larger" if name == "max" else "smaller", total, part)
        return total
    if name == "norm":
        if len(line) == 1:
            return called("abs", line[0])
        return called("sqrt", added([joined(one, "*", one, PRODUCT) for one in line]))
    if name == "prod":
        total = line[0]
        for part in line[1:]:
            total = joined(total, "*", part, PRODUCT)
        return total
    total = added(line)
    return joined(total, "/", literal(float(len(line))), PRODUCT) if name == "mean" else total


def _of_vectors(t: Translation, name: str, left: Code, right: Code) -> Code | None:
    a, b = t.atoms(left), t.atoms(right)
    shapes = [code.kind.shape for code in (a, b) if isinstance(code.kind, Numbers)]
    if any(shape is None or len(shape) != 2 or 1 not in shape for shape in shapes):
        return None
    x, y = floats(a), floats(b)
    if len(x) != len(y) or not x:
        return None
    if name == "dot":
        terms = [joined(p, "*", q, PRODUCT) for p, q in zip(x, y, strict=True)]
        return Code(Numbers("float", (1, 1)), (added(terms),))
    if len(x) != 3:
        return None
    parts = []
    for i, j in ((1, 2), (2, 0), (0, 1)):
        first = joined(x[i], "*", y[j], PRODUCT)
        parts.append(joined(first, "-", joined(x[j], "*", y[i], PRODUCT), PRODUCT - 1))
    shape = shapes[0] if shapes[0] == shapes[1] else (3, 1)
    return Code(Numbers("float", shape), tuple(parts), fresh=True)


def _of_square(t: Translation, name: str, code: Code) -> Code | None:
    """Determinant and inverse of a matrix of two or three rows."""
    assert isinstance(code.kind, Numbers)
    if name not in ("det", "inv") or code.kind.shape not in WRITTEN_OUT:
        return None
    rows, _ = code.kind.shape
    piece = called(f"{name}_{rows}", *floats(code))
    if name == "det":
        return Code(Numbers("float", (1, 1)), (piece,))
    return t.unpacked(piece, Numbers("float", (rows, rows)))


# --- calls ------------------------------------------------------------------------------------


def _expected(t: Translation, name: str, given: list[Code], wanted: int) -> list[Code] | None:
    """Call a function whose results are of the kinds that it gives for a sample."""
    samples = [sample(code.kind) for code in given]
    numbers = all(isinstance(code.kind, Numbers | Word) for code in given)
    if not numbers or any(value is None for value in samples) or not t.daring:
        return None
    if name in _OF_VALUES.split() and not is_constant(*given):
        return None
    try:
        with quiet():
            found = KNOWN[name](Allowance(largest=10_000), wanted, *samples)
    except Exception:
        return None
    values = list(found) if isinstance(found, tuple) else [found]
    found_kinds = [kind_of_value(value) for value in values[: max(1, wanted)]]
    kinds = [kind for kind in found_kinds if isinstance(kind, Numbers)]
    if len(kinds) < max(1, wanted):
        return None
    t.module.arrays = True
    if wanted <= 1 and len(values) == 1:
        return [checked(t, _call(t, name, given), kinds[0])]
    listed = t.temporary(_several(t, name, given, wanted))
    return [checked(t, f"{listed}[{k}]", kind) for k, kind in enumerate(kinds)]


def _call(t: Translation, name: str, given: list[Code]) -> str:
    return called("known", repr(name), "budget", *map(t.whole, given))


def _several(t: Translation, name: str, given: list[Code], wanted: int) -> str:
    arguments = "[" + ", ".join(map(t.whole, given)) + "]"
    return called("library", repr(name), arguments, str(wanted))


def _unknown(t: Translation, name: str, given: list[Code], wanted: int) -> list[Code]:
    """Call a function of whose results nothing is known."""
    t.module.arrays = True
    listed = t.temporary(_several(t, name, given, wanted))
    real = name in ("zeros", "ones", "eye", "linspace", "colon", "repmat") and all(
        isinstance(code.kind, Numbers) and code.kind.kind == "float" for code in given
    )
    kind = REALS if real else ANYTHING
    return [Code(kind, (f"{listed}[{k}]",), fresh=real) for k in range(max(1, wanted))]
