"""Operators: Python's own arithmetic on each element of small arrays, NumPy's on larger ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import operators
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    FaultError,
    constant,
    floats,
    is_constant,
    moved,
    positions,
    value_of,
    whole_value,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    REALS,
    TRUTH,
    Kind,
    Numbers,
    Shape,
    is_scalar,
    is_small,
)
from drake_leg.simulink.matlab.compiling.source import (
    AND,
    ATOM,
    BOTH,
    COMPARISON,
    EITHER,
    NOT,
    PRODUCT,
    SUM,
    Piece,
    before,
    called,
    joined,
)
from drake_leg.simulink.matlab.compiling.translation import Translation, checked
from drake_leg.simulink.matlab.data import Allowance
from drake_leg.simulink.matlab.numeric import MatlabError, quiet

MOST_PRODUCTS = 64  # of two small matrices, that are written out
WRITTEN_OUT = ((2, 2), (3, 3))  # matrices whose inverse and solutions are plain numbers
COMPARISONS = {"==": "==", "~=": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
_LOGICAL = {"&": BOTH, "|": EITHER}
_SUMS = {"+": SUM, "-": SUM, ".*": PRODUCT}


def folded(act: Callable[[Allowance], Any]) -> Code | None:
    """Compute a constant now; None where that fails, or the constant is too large."""
    try:
        with quiet():
            return constant(act(Allowance(steps=100_000, largest=10_000)))
    except Exception:
        return None


def combined(t: Translation, symbol: str, left: Code, right: Code) -> Code:
    """Two values and the operator between them."""
    if is_constant(left, right):
        a, b = value_of(left), value_of(right)
        found = folded(lambda budget: operators.combined(symbol, a, b, budget))
        if found is not None:
            return found
    a, b = left.kind, right.kind
    if isinstance(a, Numbers) and isinstance(b, Numbers):
        if is_small(a) and is_small(b):
            found = _of_small(t, symbol, left, right)
        else:
            found = _of_arrays(t, symbol, left, right)
        if found is not None:
            return t.short(found)
        shape = _shape_of_division(symbol, a.shape, b.shape)
        if shape is not None and t.daring:
            piece = called("combined", repr(symbol), t.whole(left), t.whole(right), "budget")
            return checked(t, piece, Numbers("float", shape))
    return _in_general(t, symbol, left, right)


def _shape_of_division(symbol: str, a: Shape | None, b: Shape | None) -> Shape | None:
    """Size of a quotient of matrices, or of a power of one."""
    if a is None or b is None or not (len(a) == len(b) == 2):
        return None
    if symbol == "\\" and a[0] == b[0]:
        return a[1], b[1]
    if symbol == "/" and a[1] == b[1]:
        return a[0], b[0]
    return a if symbol == "^" and a[0] == a[1] and b == (1, 1) else None


def _in_general(
    t: Translation, symbol: str, left: Code, right: Code, kind: Kind = ANYTHING
) -> Code:
    a, b = t.whole(left), t.whole(right)
    t.module.arrays = True
    piece = t.temporary(called("combined", repr(symbol), a, b, "budget"))
    return Code(kind, (piece,), fresh=True)


# --- small arrays -----------------------------------------------------------------------------


def _of_small(t: Translation, symbol: str, left: Code, right: Code) -> Code | None:
    one_left, one_right = is_scalar(left.kind), is_scalar(right.kind)
    if symbol == "*" and not (one_left or one_right):
        return _product(t, left, right)
    if symbol == "\\" and one_left:
        symbol, left, right = "./", right, left
    elif symbol == "/" and one_right:
        symbol = "./"
    elif symbol == "^" and one_left and one_right:
        symbol = ".^"
    elif symbol == ".\\":
        symbol, left, right = "./", right, left
    elif symbol == "*":
        symbol = ".*"
    if symbol == "\\":
        return _solved(t, left, right)
    if symbol == "/":
        return transposed(t, "'", of) if (of := _solved(t, *_turned(t, right, left))) else None
    if symbol == "^":
        return None
    return by_elements(t, left, right, lambda x, y: _each(t, symbol, x, y), _result(symbol))


def _turned(t: Translation, *codes: Code) -> list[Code]:
    return [transposed(t, "'", code) for code in codes]


def _solved(t: Translation, matrix: Code, wanted: Code) -> Code | None:
    """Solve two or three equations, for each column of what is wanted."""
    a, b = matrix.kind, wanted.kind
    assert isinstance(a, Numbers)
    assert isinstance(b, Numbers)
    if a.shape not in WRITTEN_OUT or not b.shape or len(b.shape) != 2 or not t.daring:
        return None
    rows, columns = a.shape[0], b.shape[1]
    if b.shape[0] != rows:
        return None
    matrix, wanted = t.atoms(matrix), t.atoms(wanted)
    parts: list[str] = []
    for column in range(columns):
        given = floats(wanted)[rows * column : rows * (column + 1)]
        piece = called(f"solve_{rows}", *floats(matrix), *given)
        parts += t.unpacked(piece, Numbers("float", (rows, 1))).parts
    return Code(Numbers("float", b.shape), tuple(parts), fresh=True)


def _result(symbol: str) -> str:
    return "bool" if symbol in COMPARISONS or symbol in _LOGICAL else "float"


def by_elements(
    t: Translation,
    left: Code,
    right: Code,
    each: Callable[[Code, Code], str | None],
    result: str,
) -> Code | None:
    """Combine two small arrays element by element; rows, columns and numbers are repeated."""
    try:
        pairs = np.broadcast_arrays(positions(left), positions(right))
    except ValueError as fault:
        raise FaultError("sizes do not match") from fault
    if not is_scalar(left.kind) or not is_scalar(right.kind):
        left, right = t.atoms(left), t.atoms(right)
    lefts, rights = _elements(left), _elements(right)
    found = []
    for i, j in zip(*(pair.ravel(order="F").astype(int) for pair in pairs), strict=True):
        piece = each(lefts[i - 1], rights[j - 1])
        if piece is None:
            return None
        found.append(piece)
    shape = np.atleast_2d(pairs[0]).shape
    return Code(Numbers(result, tuple(map(int, shape))), tuple(found), fresh=True)


def _elements(code: Code) -> list[Code]:
    assert isinstance(code.kind, Numbers)
    if is_scalar(code.kind):
        return [code]
    values = code.kind.value if isinstance(code.kind.value, tuple) else [None] * len(code.parts)
    return [
        Code(Numbers(code.kind.kind, (1, 1), value), (part,))
        for value, part in zip(values, code.parts, strict=True)
    ]


def _each(t: Translation, symbol: str, left: Code, right: Code) -> str | None:
    """Combine two numbers."""
    x, y = left.parts[0], right.parts[0]
    if symbol in COMPARISONS:
        return joined(x, COMPARISONS[symbol], y, COMPARISON)
    if symbol in _LOGICAL:
        return joined(_nonzero(left), symbol, _nonzero(right), _LOGICAL[symbol])
    kinds = [code.kind.kind for code in (left, right) if isinstance(code.kind, Numbers)]
    if "float" not in kinds:
        x = floats(left)[0]
    if symbol in _SUMS:
        return joined(x, symbol[-1], y, _SUMS[symbol])
    if symbol == "./":
        return (
            joined(x, "/", y, PRODUCT) if t.daring or _is_number(right) else called("divided", x, y)
        )
    return _power(t, floats(left)[0], right) if symbol == ".^" else None


def _nonzero(code: Code) -> str:
    assert isinstance(code.kind, Numbers)
    part = code.parts[0]
    return part if code.kind.kind == "bool" else joined(part, "!=", "0.0", COMPARISON)


def _is_number(code: Code) -> bool:
    """Whether a divisor is a constant that is not zero."""
    return is_constant(code) and bool(value_of(code))


def _power(t: Translation, base: str, exponent: Code) -> str | None:
    power = value_of(exponent) if is_constant(exponent) else None
    if power == 2.0:
        base = t.atom(base)
        return joined(base, "*", base, PRODUCT)
    if not t.daring:
        whole = isinstance(power, float) and power.is_integer()
        piece = called("known", "'power'", "budget", base, exponent.parts[0])
        return called("number", piece) if whole else None
    return called("pow", base, floats(exponent)[0])


def _product(t: Translation, left: Code, right: Code) -> Code | None:
    """Product of two small matrices."""
    a, b = positions(left), positions(right)
    if a.ndim != 2 or b.ndim != 2 or a.shape[1] != b.shape[0]:
        raise FaultError("sizes do not match")
    count = a.shape[0] * a.shape[1] * b.shape[1]
    if count > MOST_PRODUCTS or not a.shape[1]:
        return _of_arrays(t, "*", left, right)
    left, right = t.atoms(left), t.atoms(right)
    x, y = floats(left), floats(right)
    found = []
    for j in range(b.shape[1]):
        for i in range(a.shape[0]):
            terms = [
                joined(x[int(a[i, k]) - 1], "*", y[int(b[k, j]) - 1], PRODUCT)
                for k in range(a.shape[1])
            ]
            found.append(added(terms))
    return Code(Numbers("float", (a.shape[0], b.shape[1])), tuple(found), fresh=True)


def added(terms: list[Any]) -> str:
    """Write a sum."""
    total = terms[0]
    for term in terms[1:]:
        total = joined(total, "+", term, SUM)
    return str(total) if not isinstance(total, Piece) else total


# --- larger arrays ----------------------------------------------------------------------------


def _of_arrays(t: Translation, symbol: str, left: Code, right: Code) -> Code | None:
    a, b = left.kind, right.kind
    assert isinstance(a, Numbers)
    assert isinstance(b, Numbers)
    if symbol not in ("+", "-", "*", ".*", "./", "/") or "mixed" in (a.kind, b.kind):
        return _compared(t, symbol, left, right)
    if a.shape is None or b.shape is None:
        if symbol in ("/", "./") and symbol != "./" and not is_scalar(b):
            return None
        return _in_general(t, symbol, left, right, REALS)
    if symbol == "/" and not is_scalar(b):
        return None
    product = symbol == "*" and not (is_scalar(a) or is_scalar(b))
    shape = _shape_of(product, a.shape, b.shape)
    if shape is None:
        return None
    kind = Numbers("float", shape)
    if a.kind == "bool" or b.kind == "bool":
        piece = called("combined", repr(symbol), t.whole(left), t.whole(right), "budget")
    else:
        sign = "@" if product else symbol[-1]
        level = SUM if sign in "+-" else PRODUCT
        piece = joined(t.whole(left), sign, t.whole(right), level)
    t.module.arrays = True
    if is_scalar(kind):
        return Code(kind, (t.temporary(f"({piece}).item()"),))
    if is_small(kind):
        return t.unpacked(f'({piece}).ravel("F").tolist()', kind)
    return Code(kind, (t.temporary(piece),), fresh=True)


def _shape_of(product: bool, a: tuple[int, ...], b: tuple[int, ...]) -> tuple[int, ...] | None:
    if product:
        return (a[0], b[1]) if len(a) == len(b) == 2 and a[1] == b[0] else None
    try:
        return tuple(np.broadcast_shapes(a, b)) if len(a) == len(b) else None
    except ValueError:
        return None


def _compared(t: Translation, symbol: str, left: Code, right: Code) -> Code | None:
    a, b = left.kind, right.kind
    assert isinstance(a, Numbers)
    assert isinstance(b, Numbers)
    if symbol not in COMPARISONS or a.shape is None or b.shape is None:
        return None
    shape = _shape_of(False, a.shape, b.shape)
    if shape is None or math.prod(shape) == 1:
        return None
    kind = Numbers("bool", shape)
    if is_small(kind):
        return None
    piece = joined(t.whole(left), COMPARISONS[symbol], t.whole(right), COMPARISON)
    return Code(kind, (t.temporary(piece),), fresh=True)


# --- signs, transposes, truth -----------------------------------------------------------------


def signed(t: Translation, sign: str, code: Code) -> Code:
    """``+``, ``-`` and ``~`` before a value."""
    if is_constant(code):
        value = value_of(code)
        found = folded(lambda budget: operators.sign(sign, value))
        if found is not None:
            return found
    kind = code.kind
    if not isinstance(kind, Numbers) or not is_small(kind):
        real = isinstance(kind, Numbers) and kind.kind == "float" and sign != "~"
        shape = kind.shape if isinstance(kind, Numbers) else None
        piece = t.temporary(called("sign_of", repr(sign), t.whole(code)))
        return Code(Numbers("float", shape) if real else ANYTHING, (piece,))
    if sign == "~":
        return Code(
            Numbers("bool", kind.shape), tuple(_not(kind.kind, part) for part in code.parts)
        )
    parts = floats(code)
    if sign == "-":
        parts = tuple(before("-", part) for part in parts)
    return Code(Numbers("float", kind.shape), parts, fresh=True)


def _not(kind: str, part: str) -> str:
    if kind == "bool":
        return before("not ", part, NOT)
    return before("not ", called("holds", part), NOT)


def transposed(t: Translation, symbol: str, code: Code) -> Code:
    """``value'`` and ``value.'``."""
    kind = code.kind
    if isinstance(kind, Numbers) and is_small(kind) and kind.shape and len(kind.shape) == 2:
        if is_scalar(kind):
            return code
        if is_constant(code):
            value = value_of(code)
            found = folded(lambda budget: operators.transposed(symbol, value))
            if found is not None:
                return found
        return moved(positions(code).T, code.parts, kind.kind)
    piece = Piece(called("transposed", repr(symbol), t.whole(code)), ATOM)
    if isinstance(kind, Numbers) and kind.shape is not None and len(kind.shape) == 2:
        return Code(Numbers(kind.kind, kind.shape[::-1]), (piece,))
    return Code(REALS if kind == REALS else ANYTHING, (piece,))


def truth(t: Translation, code: Code) -> str:
    """Whether a value counts as true, as a condition of Python's."""
    kind = code.kind
    if is_constant(code):
        value = value_of(code)
        try:
            return str(operators.truth(value))
        except MatlabError:
            return called("truth", t.whole(code))
    if not isinstance(kind, Numbers) or not is_small(kind):
        return called("truth", t.whole(whole_value(code)))
    if is_scalar(kind):
        return code.parts[0] if kind.kind == "bool" else called("holds", code.parts[0])
    if kind.kind == "bool":
        total = code.parts[0]
        for part in code.parts[1:]:
            total = joined(total, "and", part, AND)
        return total
    return called("all_hold", *code.parts)


def from_truth(condition: str) -> Code:
    """Take a condition for a value."""
    if condition in ("True", "False"):
        return Code(Numbers("bool", (1, 1), condition == "True"), (condition,))
    return Code(TRUTH, (condition,))
