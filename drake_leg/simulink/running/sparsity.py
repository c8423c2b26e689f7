"""Which derivatives of a model's states depend on which states, read off its code."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Pattern = NDArray[np.bool_]
NOTHING: frozenset[int] = frozenset()
Marks = Mapping[str, Sequence[frozenset[int]]]  # what the entries of an argument depend on


def source_of(function: Callable[..., Any], name: str, source: str) -> str | None:
    """Return the source of one function: out of that of all, or of the file where it stands."""
    if not source:
        try:
            source = textwrap.dedent(inspect.getsource(function))
        except OSError:
            return None
    found = (node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef))
    return next((ast.unparse(node) for node in found if node.name == name), None)


def dependence(source: str, marks: Marks) -> list[frozenset[int]] | None:
    """Tell what each entry of the vector that a function returns depends on.

    Parameters
    ----------
    source : str
        Of the function, whose last but one statement makes an array of single numbers.
    marks : mapping
        What each entry of an argument depends on; other arguments depend on nothing.

    Returns
    -------
    list of frozenset, optional
        None where the entries are not single numbers.
    """
    (function,) = ast.parse(source).body
    assert isinstance(function, ast.FunctionDef)
    known: dict[str, frozenset[int]] = {}
    result = function.body[-2]
    for statement in function.body[:-2]:
        names = _made(statement)
        if names is None:  # any of its names may be changed, or left as it was
            names = {each.id for each in ast.walk(statement) if isinstance(each, ast.Name)}
            if isinstance(statement, ast.FunctionDef):
                names.add(statement.name)
            found = _read(statement, known, marks)
        else:
            assert isinstance(statement, ast.Assign)
            found = _read(statement.value, known, marks)
        known |= dict.fromkeys(names, found)
    made = result.value if isinstance(result, ast.Assign) else None
    if not (isinstance(made, ast.Call) and made.args and isinstance(made.args[0], ast.List)):
        return None
    entries = made.args[0].elts
    if any(isinstance(entry, ast.Starred) for entry in entries):
        return None
    return [_read(entry, known, marks) for entry in entries]


def _made(statement: ast.stmt) -> set[str] | None:
    """Return the names that a statement sets, if that is all it does."""
    if not isinstance(statement, ast.Assign):
        return None
    names = [each for target in statement.targets for each in ast.walk(target)]
    if not all(isinstance(each, ast.Name | ast.Tuple | ast.Store) for each in names):
        return None
    return {each.id for each in names if isinstance(each, ast.Name)}


def _read(node: ast.AST, known: Mapping[str, frozenset[int]], marks: Marks) -> frozenset[int]:
    """Collect what the names in a piece of code depend on; of entries, that of the entries."""
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
        entries = marks.get(node.value.id, ())
        first, last = _span(node.slice)
        if entries and first is not None:
            return NOTHING.union(*entries[first:last])
    if isinstance(node, ast.Name):
        return NOTHING.union(*marks[node.id]) if node.id in marks else known.get(node.id, NOTHING)
    return NOTHING.union(*(_read(each, known, marks) for each in ast.iter_child_nodes(node)))


def _span(place: ast.expr) -> tuple[int | None, int | None]:
    """Return the first entry and the one after the last; None where code computes them."""
    if isinstance(place, ast.Constant) and isinstance(place.value, int):
        return place.value, place.value + 1
    if isinstance(place, ast.Slice) and place.step is None:
        ends = (place.lower, place.upper)
        found = [end.value for end in ends if isinstance(end, ast.Constant)]
        first, last = found if len(found) == 2 else (None, None)
        if isinstance(first, int) and isinstance(last, int):
            return first, last
    return None, None


def groups_of(pattern: Pattern) -> list[list[int]]:
    """Put columns that share no row together."""
    groups: list[list[int]] = []
    rows: list[Pattern] = []
    for column in range(pattern.shape[1]):
        own = pattern[:, column]
        for group, taken in zip(groups, rows, strict=True):
            if not (taken & own).any():
                group.append(column)
                taken |= own
                break
        else:
            groups.append([column])
            rows.append(own.copy())
    return groups
