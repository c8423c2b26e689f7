"""Functions that refuse a value: ``mustBePositive`` and its kin, ``validateattributes``."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Known,
    LackError,
    StopError,
    array_of,
    extent,
    kind_of,
    numbers_of,
)
from drake_leg.simulink.matlab.inputs import scalar
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.operators import same

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script
Test = Callable[..., bool]
_INTEGERS = tuple(f"{sign}int{n}" for sign in ("", "u") for n in (8, 16, 32, 64))
_NAME = re.compile(r"[A-Za-z]\w{0,62}", re.ASCII)


def refuse(said: str, identifier: str) -> StopError:
    """Return the error with which a script ends."""
    return StopError(f"it stops with the error {said!r:.80}", said=said, identifier=identifier)


def _numeric(x: Any) -> bool:
    return kind_of(x) == "double"


def _all(test: Callable[..., Any]) -> Test:
    def holds(x: Any, *limits: Any) -> bool:
        values = numbers_of(x)
        return bool(np.all(test(values, *(scalar(limit) for limit in limits))))

    return holds


def _vector(x: Any) -> bool:
    shape = extent(x)
    return len(shape) == 2 and 1 in shape and 0 not in shape


def _count(x: Any) -> int:
    return int(np.prod(extent(x)))


def _filled(x: Any) -> bool:
    return bool(str(x)) if isinstance(x, str) else _count(x) > 0


def _textual(x: Any) -> bool:
    cells = isinstance(x, Cell) and all(isinstance(one, str) for one in x.items.flat)
    return isinstance(x, str) or cells


def _each_of(x: Any) -> list[Any]:
    if isinstance(x, Cell):
        return list(x.items.flat)
    return [x] if isinstance(x, str) else [one.item() for one in array_of(x).flat]


def _member(x: Any, allowed: Any) -> bool:
    known = _each_of(allowed)
    return all(any(same(one, other) for other in known) for one in _each_of(x))


def _in_range(x: Any, low: Any, high: Any, *flags: Any) -> bool:
    words = {str(flag) for flag in flags}
    if words - {"inclusive", "exclusive", "exclude-lower", "exclude-upper"}:
        raise MatlabError(f"'mustBeInRange' does not know {sorted(words)[0][:40]!r}")
    values, a, b = numbers_of(x), scalar(low), scalar(high)
    above = values > a if words & {"exclusive", "exclude-lower"} else values >= a
    below = values < b if words & {"exclusive", "exclude-upper"} else values <= b
    return bool(np.all(above & below))


def _is_a(x: Any, *kinds: Any) -> bool:
    """Whether a value is of a class; those of integers are plain numbers here."""
    names = {str(name) for kind in kinds for name in _each_of(kind)}
    if _numeric(x) and names & {"numeric", "float", "single", *_INTEGERS}:
        return True
    return kind_of(x) in names


_SPAN = "a number of the range"
# Each test, and what the value must be; the limits come after.
_TESTS: dict[str, tuple[Test, str]] = {
    "Positive": (_all(lambda x: x > 0), "positive"),
    "Nonpositive": (_all(lambda x: x <= 0), "nonpositive"),
    "Nonnegative": (_all(lambda x: x >= 0), "nonnegative"),
    "Negative": (_all(lambda x: x < 0), "negative"),
    "Finite": (_all(np.isfinite), "finite"),
    "NonNan": (_all(lambda x: ~np.isnan(x)), "not NaN"),
    "Nonzero": (_all(lambda x: x != 0), "nonzero"),
    "Nonsparse": (lambda x: True, "nonsparse"),
    "Nonmissing": (lambda x: not _numeric(x) or not np.isnan(array_of(x)).any(), "nonmissing"),
    "Real": (lambda x: not np.iscomplexobj(array_of(x)), "real"),
    "Integer": (_all(lambda x: np.isfinite(x) & (x == np.floor(x.real))), "integer"),
    "Numeric": (_numeric, "numeric"),
    "NumericOrLogical": (lambda x: kind_of(x) in ("double", "logical"), "numeric or logical"),
    "Float": (_numeric, "numeric"),
    "Nonempty": (_filled, "nonempty"),
    "ScalarOrEmpty": (lambda x: _count(x) <= 1, "scalar or empty"),
    "Vector": (_vector, "a vector"),
    "Row": (lambda x: len(extent(x)) == 2 and extent(x)[0] == 1, "a row vector"),
    "Column": (lambda x: len(extent(x)) == 2 and extent(x)[1] == 1, "a column vector"),
    "Matrix": (lambda x: len(extent(x)) == 2, "a matrix"),
    "GreaterThan": (_all(lambda x, c: x > c), "greater than"),
    "LessThan": (_all(lambda x, c: x < c), "less than"),
    "GreaterThanOrEqual": (_all(lambda x, c: x >= c), "greater than or equal to"),
    "LessThanOrEqual": (_all(lambda x, c: x <= c), "less than or equal to"),
    "Member": (_member, "a member of this set:"),
    "InRange": (_in_range, _SPAN),
    "A": (_is_a, "one of these classes:"),
    "UnderlyingType": (_is_a, "one of these classes:"),
    "Text": (_textual, "text"),
    "TextScalar": (lambda x: isinstance(x, str), "a single text"),
    "NonzeroLengthText": (
        lambda x: _textual(x) and all(str(one) for one in _each_of(x)),
        "text with at least one letter",
    ),
    "ValidVariableName": (
        lambda x: isinstance(x, str) and bool(_NAME.fullmatch(str(x))),
        "the name of a variable",
    ),
}


_OF_NUMBERS = frozenset((
    "Positive", "Nonpositive", "Nonnegative", "Negative", "Finite", "Nonzero", "Real", "Integer",
    "NonNan", "GreaterThan", "LessThan", "GreaterThanOrEqual", "LessThanOrEqual", "InRange",
))  # fmt: skip


def _must_be(name: str) -> Known:
    test, what = _TESTS[name]

    def check(budget: Allowance, wanted: int, value: Any, *limits: Any) -> tuple[()]:
        if name in _OF_NUMBERS and not isinstance(value, (float, bool, complex, np.ndarray)):
            raise refuse("Value must be numeric.", f"MATLAB:validators:mustBe{name}")
        passed = test(value, *limits)
        if not passed:
            told = ", ".join(_said(one) for limit in limits for one in _each_of(limit))
            raise refuse(
                f"Value must be {what}{f' {told}' if told else ''}.",
                f"MATLAB:validators:mustBe{name}",
            )
        return ()

    return check


def _said(value: Any) -> str:
    return str(value) if isinstance(value, str) else f"{value:g}"


def _must_exist(folder: bool) -> Any:
    def check(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
        if not self.host.has_file(str(arguments[0])):
            kind = "folder" if folder else "file"
            raise refuse(
                f"The {kind} {str(arguments[0])[:80]!r} is not in the given folders.",
                f"MATLAB:validators:mustBe{kind.title()}",
            )
        return []

    return check


# --- validateattributes -----------------------------------------------------------------------

_PLAIN: dict[str, Test] = {
    "positive": _TESTS["Positive"][0],
    "nonnegative": _TESTS["Nonnegative"][0],
    "finite": _TESTS["Finite"][0],
    "nonnan": _TESTS["NonNan"][0],
    "nonzero": _TESTS["Nonzero"][0],
    "real": _TESTS["Real"][0],
    "integer": _TESTS["Integer"][0],
    "nonempty": _filled,
    "nonsparse": lambda x: True,
    "scalar": lambda x: _count(x) == 1,
    "scalartext": lambda x: isinstance(x, str),
    "vector": _vector,
    "row": _TESTS["Row"][0],
    "column": _TESTS["Column"][0],
    "2d": _TESTS["Matrix"][0],
    "3d": lambda x: len(extent(x)) <= 3,
    "square": lambda x: len(extent(x)) == 2 and extent(x)[0] == extent(x)[1],
    "binary": _all(lambda x: (x == 0) | (x == 1)),
    "even": _all(lambda x: np.mod(x, 2) == 0),
    "odd": _all(lambda x: np.mod(x, 2) == 1),
    "increasing": lambda x: bool(np.all(np.diff(numbers_of(x).ravel(order="F")) > 0)),
    "decreasing": lambda x: bool(np.all(np.diff(numbers_of(x).ravel(order="F")) < 0)),
    "nondecreasing": lambda x: bool(np.all(np.diff(numbers_of(x).ravel(order="F")) >= 0)),
    "nonincreasing": lambda x: bool(np.all(np.diff(numbers_of(x).ravel(order="F")) <= 0)),
    "diag": lambda x: bool(np.all(array_of(x) == np.diag(np.diag(array_of(x))))),
}


def _of_size(x: Any, size: Any) -> bool:
    wanted = numbers_of(size).ravel()
    found = extent(x)
    return len(found) == wanted.size and bool(np.all((wanted == found) | np.isnan(wanted)))


_WITH_VALUE: dict[str, Test] = {
    ">": _TESTS["GreaterThan"][0],
    ">=": _TESTS["GreaterThanOrEqual"][0],
    "<": _TESTS["LessThan"][0],
    "<=": _TESTS["LessThanOrEqual"][0],
    "numel": lambda x, n: _count(x) == scalar(n),
    "ncols": lambda x, n: extent(x)[1] == scalar(n),
    "nrows": lambda x, n: extent(x)[0] == scalar(n),
    "ndims": lambda x, n: len(extent(x)) == scalar(n),
    "size": _of_size,
}


def _validate_attributes(
    budget: Allowance, wanted: int, value: Any, classes: Any, attributes: Any, *names: Any
) -> tuple[()]:
    """Check the class and the attributes of a value; the names only serve the message."""
    if not isinstance(classes, Cell) or not isinstance(attributes, Cell):
        raise MatlabError("'validateattributes' takes its classes and attributes in cells")
    texts = [str(one) for one in names if isinstance(one, str)]
    what = f"the value {texts[1]!r:.40}" if len(texts) > 1 else "the value"
    if classes.items.size and not _is_a(value, classes):
        listed = ", ".join(map(str, _each_of(classes)))
        raise refuse(f"Expected {what} to be of {listed}.", "MATLAB:invalidType")
    rest = iter(_each_of(attributes))
    for one in rest:
        word = str(one)
        if word in _PLAIN:
            passed, told = _PLAIN[word](value), word
        elif word in _WITH_VALUE:
            limit = next(rest, 0.0)
            passed = _WITH_VALUE[word](value, limit)
            told = f"{word} {', '.join(_said(each) for each in _each_of(limit))}"
        else:
            raise LackError(f"the attribute {word[:40]!r} of 'validateattributes' is not known")
        if not passed:
            raise refuse(f"Expected {what} to be {told}.", f"MATLAB:expected{word.title()}")
    return ()


def _validate_text(budget: Allowance, wanted: int, value: Any, allowed: Any, *names: Any) -> Any:
    """``validatestring``: the word that a text begins, whatever its case."""
    words = [str(one) for one in _each_of(allowed)]
    found = [word for word in words if word.lower().startswith(str(value).lower())]
    exact = [word for word in found if word.lower() == str(value).lower()]
    best = exact or found
    if not best or any(not word.startswith(min(best, key=len)) for word in best):
        raise refuse(
            f"Expected {str(value)[:40]!r} to be one of {', '.join(words)}.",
            "MATLAB:unrecognizedStringChoice",
        )
    return min(best, key=len)


def _count_inputs(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``narginchk``: the count of inputs of the call lies between two numbers."""
    low, high = map(scalar, arguments)
    if frame.given < low:
        raise refuse("Not enough input arguments.", "MATLAB:narginchk:notEnoughInputs")
    if frame.given > high:
        raise refuse("Too many input arguments.", "MATLAB:narginchk:tooManyInputs")
    return []


VALIDATORS: dict[str, Known] = {
    **{f"mustBe{name}": _must_be(name) for name in _TESTS},
    "validateattributes": _validate_attributes,
    "validatestring": _validate_text,
}
VALIDATORS_OF_CALLS: dict[str, Any] = {
    "mustBeFile": _must_exist(folder=False),
    "mustBeFolder": _must_exist(folder=True),
    "narginchk": _count_inputs,
}
