"""The factors of a determinant, derived with SymPy: where each is zero, the robot is singular."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import sympy as sp

from drake_leg.check.bindings import Cell
from drake_leg.check.formulas import named_symbols
from drake_leg.check.notation import spelled_as
from drake_leg.check.printed_file import METRES, Printed
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot
from drake_leg.symbolic.chain import SymbolicChain, direct_jacobian, symbolic_chain
from drake_leg.symbolic.trigonometry import tidy


def factors(
    robot: Robot,
    rows: Sequence[int],
    printed: Printed,
    names: Mapping[Cell, str],
    spelling: str,
) -> list[tuple[str, Callable[[Mapping[str, Array]], Array]]]:
    """Factor the determinant of a square part of the Jacobian.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    rows : sequence of int
        Of the Jacobian, rotation first; as many columns, the first ones.
    printed : Printed
        Whose unit of lengths is used.
    names : mapping
        Cells of the table to the names that the print has for them.
    spelling : str
        Some of the print's formulas.

    Returns
    -------
    list of (str, callable)
        Every factor that depends on a joint: where it is zero, as text, and its values at named
        variables q1, ...
    """
    chain = symbolic_chain(robot.rows)
    square = direct_jacobian(chain).extract(list(rows), list(range(len(rows))))
    determinant = tidy(square.applyfunc(tidy).det())
    found = [f for f in sp.Mul.make_args(determinant) if f.free_symbols & set(chain.q)]
    found.sort(key=sp.count_ops)
    lengths = _lengths(chain, printed, names)
    return [(spelled_as(spelling, _zeros_text(f.subs(lengths))), _value(f, chain)) for f in found]


def _zeros_text(factor: sp.Expr) -> str:
    """Say where a factor is zero."""
    text = f"{factor.args[0]} = kπ" if factor.func is sp.sin else f"{factor} = 0"
    return re.sub(r"\d+\.\d+", lambda found: f"{float(found[0]):.9g}", text)


def _value(factor: sp.Expr, chain: SymbolicChain) -> Callable[[Mapping[str, Array]], Array]:
    variables = [f"q{index + 1}" for index in range(len(chain.q))]
    function = sp.lambdify(chain.q, factor.subs(chain.values), "numpy")

    def value(values: Mapping[str, Array]) -> Array:
        zero = np.zeros_like(next(iter(values.values())))
        return np.asarray(function(*(values.get(name, zero) for name in variables)))

    return value


def _lengths(
    chain: SymbolicChain, printed: Printed, names: Mapping[Cell, str]
) -> dict[sp.Symbol, sp.Expr]:
    """Name lengths as the print does where it declares them, or write their numbers."""
    metres = METRES[printed.lengths or "m"]
    named = named_symbols(chain, names)
    return {
        symbol: sp.Symbol(named[symbol]) if symbol in named else sp.Float(f"{value / metres:.9g}")
        for symbol, value in chain.values.items()
    }
