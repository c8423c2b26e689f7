"""Formulas as programs: every product has a name, so that nothing is computed or written twice.

The customized symbolic method of Khalil and Kleinfinger: zeros, ones and repeated expressions
disappear while a model is derived, and what remains is a list of short assignments.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.khalil import Array

Assignment = tuple[sp.Symbol, sp.Expr]
AXES = ("x", "y", "z")


@dataclass(frozen=True, kw_only=True)
class Input:
    """A vector that a program is given, as the joint velocities."""

    name: str
    symbols: tuple[sp.Symbol, ...]
    meaning: str


@dataclass(frozen=True, kw_only=True)
class Output:
    """A vector or matrix that a program computes; its entries are names or numbers."""

    name: str
    value: sp.Matrix
    meaning: str
    columns: tuple[str, ...] = ()  # what the columns of a matrix stand for

    @property
    def is_vector(self) -> bool:
        """Whether it is one column, which programs return as a vector."""
        return bool(self.value.cols == 1)


@dataclass(frozen=True, kw_only=True)
class Operations:
    """How many operations a program has."""

    multiplications: int
    additions: int
    functions: int  # sines, cosines, signs

    def __str__(self) -> str:
        return f"{self.multiplications} multiplications, {self.additions} additions"


@dataclass(frozen=True, kw_only=True, repr=False)
class Program:
    """Assignments in order, from inputs and letters to outputs."""

    name: str  # of a function: inverse_dynamics
    title: str
    inputs: tuple[Input, ...]
    assignments: tuple[Assignment, ...]
    outputs: tuple[Output, ...]
    values: Mapping[sp.Symbol, float] = field(default_factory=dict)  # of letters, where known
    notes: tuple[str, ...] = ()

    @cached_property
    def letters(self) -> tuple[sp.Symbol, ...]:
        """Symbols that are neither inputs nor assigned: lengths, masses and so on."""
        known = {symbol for group in self.inputs for symbol in group.symbols}
        known |= {name for name, _ in self.assignments}
        used: set[sp.Symbol] = set()
        for _, expression in self.assignments:
            used |= expression.free_symbols
        for output in self.outputs:
            used |= output.value.free_symbols
        return tuple(sorted(used - known, key=lambda symbol: natural(symbol.name)))

    @cached_property
    def operations(self) -> Operations:
        """Count the operations as they are carried out."""
        total = np.zeros(3, dtype=int)
        for _, expression in self.assignments:
            total += own_operations(expression)
        return _operations(total.tolist())

    @cached_property
    def naive_operations(self) -> Operations:
        """Count the operations of the outputs with every name written out, nothing shared."""
        counts: dict[sp.Symbol, list[int]] = {}
        for name, expression in self.assignments:
            counts[name] = _written_out(expression, counts)
        total = [0, 0, 0]
        for output in self.outputs:
            for entry in output.value:
                total = _sum(total, _written_out(entry, counts))
        return _operations(total)

    def __call__(
        self, *arguments: ArrayLike, letters: Mapping[str, float] | None = None
    ) -> dict[str, Array]:
        """Evaluate for one state or many: ``arguments`` are the inputs, each (..., n).

        ``letters`` are the values of letters by name, where they are not the table's. The outputs
        are returned by name, vectors as (..., n), matrices as (..., m, n).

        Raises
        ------
        InvalidValueError
            If an input has another size, or a letter has no value.
        """
        if len(arguments) != len(self.inputs):
            wanted = ", ".join(group.name for group in self.inputs) or "none"
            raise InvalidValueError(
                f"{self.name} is given {len(arguments)} inputs; its inputs are {wanted}"
            )
        arrays = [
            self._input(group, given) for group, given in zip(self.inputs, arguments, strict=True)
        ]
        shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        columns = [array[..., i] for array in arrays for i in range(array.shape[-1])]
        results = self._compiled(*columns, *self._numbers(letters or {}))
        found = {}
        for output, entries in zip(self.outputs, results, strict=True):
            size = (len(output.value),) if output.is_vector else output.value.shape
            filled = np.empty((*shape, len(output.value)))
            for index, entry in enumerate(entries):
                filled[..., index] = entry
            found[output.name] = filled.reshape((*shape, *size))
        return found

    def code(self, language: str) -> str:
        """Write the program as a function in a language: "numpy", "c", "matlab" or "julia".

        Raises
        ------
        InvalidValueError
            If there is no such language.
        """
        from drake_leg.symbolic.languages import code

        return code(self, language)

    def __str__(self) -> str:
        from drake_leg.symbolic.languages import text

        return text(self)

    def __repr__(self) -> str:
        outputs = ", ".join(output.name for output in self.outputs)
        return f"<Program {self.name}: {outputs}, {self.operations}>"

    def _repr_latex_(self) -> str:
        from drake_leg.symbolic.languages import latex

        lines = [line for line in latex(self).splitlines() if not line.startswith("%")]
        return "\n".join(f"$${line}$$" for line in lines)

    def _input(self, group: Input, given: ArrayLike) -> Array:
        try:
            array = np.asarray(given, dtype=np.float64)
        except (TypeError, ValueError):
            array = np.full(0, np.nan)
        if array.ndim == 0 or array.shape[-1] != len(group.symbols) or not np.isfinite(array).all():
            raise InvalidValueError(
                f"{group.name} of {self.name} must be {len(group.symbols)} finite numbers, or an "
                f"array whose last axis has that size"
            )
        return array

    def _numbers(self, given: Mapping[str, float]) -> list[float]:
        known = {symbol.name: value for symbol, value in self.values.items()}
        names = [symbol.name for symbol in self.letters]
        for name in given:
            if name not in names and name not in known:
                letters = f"its letters are {', '.join(names)}" if names else "it has none"
                raise InvalidValueError(
                    f"{self.name} has no letter {name!r}; {did_you_mean(name, names, letters)}"
                )
        known |= given
        missing = [name for name in names if name not in known]
        if missing:
            raise InvalidValueError(
                f"{', '.join(missing)} of {self.name} have no values; give them in `letters`"
            )
        return [float(known[name]) for name in names]

    @cached_property
    def _compiled(self) -> Callable[..., Iterable[Iterable[Array]]]:
        symbols = [symbol for group in self.inputs for symbol in group.symbols]
        entries = [list(output.value) for output in self.outputs]
        steps = list(self.assignments)
        function: Callable[..., Iterable[Iterable[Array]]] = sp.lambdify(
            [*symbols, *self.letters], entries, "numpy", cse=lambda formulas: (steps, formulas)
        )
        return function


def natural(name: str) -> tuple[tuple[int, int, str], ...]:
    """Rank names with numbers as people do: M2 before M10."""
    parts = re.findall(r"\d+|\D+", name)
    return tuple((0, int(p), "") if p.isdigit() else (1, 0, p) for p in parts)


# --- counting --------------------------------------------------------------------------------


def own_operations(expression: sp.Expr) -> list[int]:
    """Count the multiplications, additions and functions of one expression.

    A quotient counts as a multiplication; a sign and an arithmetic of numbers as nothing.
    """
    return _written_out(expression, {})


def _written_out(expression: sp.Expr, counts: Mapping[sp.Symbol, list[int]]) -> list[int]:
    if expression.is_Symbol:
        return counts.get(expression, [0, 0, 0])
    if not expression.free_symbols:
        return [0, 0, 0]
    own = [0, 0, 0]
    arguments = expression.args
    if expression.is_Mul:
        own[0] = len([a for a in arguments if a is not sp.S.NegativeOne]) - 1
        # One division has a reciprocal in it, which is not another operation.
        own[0] -= sum(1 for a in arguments if a.is_Pow and a.exp == -1)
    elif expression.is_Add:
        own[1] = len(arguments) - 1
    elif expression.is_Pow and expression.exp.is_Integer:
        own[0] = abs(int(expression.exp)) - 1 if expression.exp != -1 else 1
        inside = _written_out(expression.base, counts)
        times = abs(int(expression.exp))
        return [o + times * i for o, i in zip(own, inside, strict=True)]
    else:
        own[2] = 1
    for argument in arguments:
        own = _sum(own, _written_out(argument, counts))
    return own


def _sum(first: Sequence[int], second: Sequence[int]) -> list[int]:
    return [a + b for a, b in zip(first, second, strict=True)]


def _operations(total: Sequence[int]) -> Operations:
    multiplications, additions, functions = total
    return Operations(multiplications=multiplications, additions=additions, functions=functions)


# --- deriving --------------------------------------------------------------------------------


class Steps:
    """Gives names to expressions while a model is derived; an expression has one name only.

    Parameters
    ----------
    taken : iterable of str
        Names of inputs and letters, which must not be given again.
    """

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)
        self._names: dict[sp.Expr, sp.Expr] = {}
        self._assignments: list[Assignment] = []
        self._fresh = 0

    def __iter__(self) -> Iterator[Assignment]:
        return iter(self._assignments)

    def name(self, name: str, expression: sp.Expr) -> sp.Expr:
        """Name an expression, unless it is a name or a number already, or has another name."""
        expression = sp.sympify(expression)
        if is_short(expression):
            return expression
        if expression in self._names:
            return self._names[expression]
        symbol = self._assign(name, expression)
        self._names[expression] = symbol
        self._names[-expression] = -symbol
        return symbol

    def again(self, expression: sp.Expr) -> sp.Expr:
        """Name an intermediate expression: t1, t2, ..."""
        if is_short(expression):
            return expression
        if expression in self._names:
            return self._names[expression]
        self._fresh += 1
        return self.name(f"t{self._fresh}", expression)

    def vector(self, name: str, vector: sp.Matrix) -> sp.Matrix:
        """Name the three components of a vector, as in w3_x; without a name, t1 and so on."""
        if not name:
            return vector.applyfunc(self.again)
        return sp.Matrix([self.name(f"{name}_{a}", v) for a, v in zip(AXES, vector, strict=True)])

    def result(self, name: str, expression: sp.Expr) -> sp.Symbol:
        """Name a result, whatever it is."""
        return self._assign(name, expression)

    def matrix(self, name: str, matrix: sp.Matrix) -> sp.Matrix:
        """Name the entries of a result that are not numbers: A1_2, or tau3 in a column."""
        column = matrix.cols == 1

        def entry(i: int, j: int) -> sp.Expr:
            value = matrix[i, j]
            if not value.free_symbols:
                return value
            return self.result(f"{name}{i + 1}" if column else f"{name}{i + 1}_{j + 1}", value)

        return sp.Matrix(matrix.rows, matrix.cols, entry)

    def _assign(self, name: str, expression: sp.Expr) -> sp.Symbol:
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        symbol = sp.Symbol(name, real=True)
        self._assignments.append((symbol, expression))
        return symbol

    def needed(self, outputs: Iterable[Output]) -> tuple[Assignment, ...]:
        """Assignments that the outputs depend on."""
        wanted: set[sp.Symbol] = set()
        for output in outputs:
            wanted |= output.value.free_symbols
        kept = []
        for name, expression in reversed(self._assignments):
            if name in wanted:
                kept.append((name, expression))
                wanted |= expression.free_symbols
        return tuple(reversed(kept))


def is_short(expression: sp.Expr) -> bool:
    """Whether an expression is a number, a symbol or minus a symbol, which needs no name."""
    if expression.is_Symbol or not expression.free_symbols:
        return True
    return bool((-expression).is_Symbol)
