"""Report B's matrices, right and as printed, in the report's symbols and millimeters.

The right ones are derived from the robots' tables; the printed ones differ by the misprints listed
here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import sympy as sp

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.robot.robots import SCARA
from drake_leg.symbolic.catalogue import derived
from drake_leg.symbolic.derivation import evaluate
from drake_leg.symbolic.equations import text

MM = 1000.0  # [mm/m]
NEIGHBOURS = ("T01", "T12", "T23", "T34")
TH1, TH2, TH3, R = sp.symbols("θ1 θ2 θ3 R", real=True)
SIGMA1, SIGMA2 = sp.symbols("σ1 σ2", real=True)

Misprints = Mapping[tuple[int, int], sp.Expr | int]  # by row and column, from 0

SCARA_MISPRINTS: Mapping[str, Misprints] = {
    "T01": {(2, 3): 0},
    "T12": {(2, 1): 1, (2, 2): 0},
    "T34": {
        (0, 2): 1,
        (1, 1): 1,
        (1, 3): 1,
        (2, 3): sp.Add(sp.Float(452.4), -340, -R, evaluate=False),
    },
    "T03": {(2, 3): 0},
}
LEG_B_MISPRINTS: Mapping[str, Misprints] = {
    "T12": {(0, 1): 0, (0, 2): sp.sin(TH2), (2, 1): 0, (2, 2): -sp.cos(TH2)},
    "T34": {(0, 2): 1, (1, 3): 1},
    "T04": {
        (0, 0): sp.cos(TH2 - TH3) * sp.cos(TH1),
        (0, 1): sp.sin(TH2 - TH3) * sp.cos(TH1),
        (1, 0): sp.cos(TH2 - TH3) * sp.sin(TH1),
        (1, 1): sp.sin(TH2 - TH3) * sp.sin(TH1),
    },
    "J": {
        (0, 2): 100 * sp.sin(TH2 - TH3) * sp.cos(TH1),
        (1, 2): 100 * sp.sin(TH2 - TH3) * sp.sin(TH1),
    },
}

# The abbreviations in T04 and J.
SIGMAS_RIGHT = {
    SIGMA1: 2 * sp.cos(TH2 + TH3) + 2 * sp.cos(TH2) + 1,
    SIGMA2: 2 * sp.sin(TH2 + TH3) + 2 * sp.sin(TH2),
}
SIGMAS_PRINTED = {
    sigma: expression.subs(TH2 + TH3, TH2 - TH3) for sigma, expression in SIGMAS_RIGHT.items()
}

# j12 in the list of entries before J; the list's other entries are those of the matrix.
J12_PRINTED = -50 * sp.cos(TH1) * (SIGMAS_PRINTED[SIGMA2] + 1)
J12_RIGHT = -50 * sp.cos(TH1) * SIGMAS_RIGHT[SIGMA2]

# Table 2.2: number, σ, d, α, r, θ. The number's column is right, the others' headings are not.
LEG_B_TABLE_PRINTED = (
    ("1", "0", "0", "0", "0", "θ1"),
    ("2", "L1", "90°", "0", "0", "θ2"),
    ("3", "L2", "0", "0", "0", "θ3"),
    ("4", "L3", "0", "0", "0", "0"),
)
LEG_B_TABLE_RIGHT = (
    ("1", "0", "0", "0", "0", "θ1"),
    ("2", "0", "L1", "90°", "0", "θ2"),
    ("3", "0", "L2", "0", "0", "θ3"),
    ("4", "~", "L3", "0", "0", "0"),
)


@dataclass(frozen=True, kw_only=True)
class PrintedMatrices:
    """A robot's matrices in report B, by name."""

    right: Mapping[str, sp.Matrix]
    printed: Mapping[str, sp.Matrix]  # those that are printed wrongly
    sigmas: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)  # as they are printed

    def value(self, name: str, values: Mapping[str, float]) -> Array:
        """Evaluate a matrix as it is printed; ``values`` has the symbols by name [rad, mm]."""
        return evaluate(self.printed[name].subs(self.sigmas), values)

    def product(self, values: Mapping[str, float], wrong: str = "") -> Array:
        """Multiply the transforms of neighboring frames, one as it is printed: T04 [-, mm]."""
        T04 = np.eye(4)
        for name in NEIGHBOURS:
            T04 = T04 @ (self.value(name, values) if name == wrong else self._right(name, values))
        return T04

    def _right(self, name: str, values: Mapping[str, float]) -> Array:
        return evaluate(self.right[name], values)


@cache
def scara_matrices() -> PrintedMatrices:
    """Return the matrices of sections 1.3 and 1.4; θ12 is θ1 + θ2."""
    robot, arm = derived("scara"), ScaraGeometry.from_robot(SCARA)
    numbers = {symbol: _mm(value) for symbol, value in robot.table.values.items()}
    *turns, lift = robot.table.q
    names = dict(zip(turns, (TH1, TH2, TH3), strict=True))
    names |= {lift: _mm(arm.height - arm.lowest) - R} | numbers
    found = dict(zip(NEIGHBOURS, robot.neighbours, strict=True)) | {"T03": robot.to_base[2]}
    right = {name: _sums_named(matrix.subs(names)) for name, matrix in found.items()}
    return PrintedMatrices(right=right, printed=_misprinted(right, SCARA_MISPRINTS))


@cache
def leg_b_matrices() -> PrintedMatrices:
    """Return the matrices of sections 2.3 to 2.5; T04 and J have numbers for L1, L2 and L3."""
    robot = derived("leg-b")
    names = dict(zip(robot.table.q, (TH1, TH2, TH3), strict=True))
    letters = {symbol: sp.Symbol(f"L{symbol.name[1:]}") for symbol in robot.table.values}
    numbers = {symbol: _mm(value) for symbol, value in robot.table.values.items()}
    right = {
        name: matrix.subs(names | letters)
        for name, matrix in zip(NEIGHBOURS, robot.neighbours, strict=True)
    }
    for name, matrix in (("T04", robot.to_base[-1]), ("J", robot.jacobian)):
        right[name] = matrix.subs(names | numbers).applyfunc(_abbreviated)
    printed = _misprinted(right, LEG_B_MISPRINTS)
    return PrintedMatrices(right=right, printed=printed, sigmas=SIGMAS_PRINTED)


def _mm(length: float) -> sp.Number:
    """Write a length [m] in mm."""
    millimeters = round(MM * length, 6)
    return sp.Integer(millimeters) if millimeters.is_integer() else sp.Float(millimeters)


def _misprinted(
    right: Mapping[str, sp.Matrix], misprints: Mapping[str, Misprints]
) -> dict[str, sp.Matrix]:
    printed = {}
    for name, entries in misprints.items():
        printed[name] = sp.Matrix(right[name])
        for place, entry in entries.items():
            printed[name][place] = entry
    return printed


def _sums_named(matrix: sp.Matrix) -> sp.Matrix:
    """Write θ123 for θ1 + θ2 + θ3."""

    def name(angle: sp.Expr) -> sp.Symbol:
        return sp.Symbol("θ" + "".join(sorted(term.name[1:] for term in sp.Add.make_args(angle))))

    for function in (sp.cos, sp.sin):
        matrix = matrix.replace(function, lambda angle, f=function: f(name(angle)))
    return matrix


def _abbreviated(entry: sp.Expr) -> sp.Expr:
    """Replace factors of a product by σ1 and σ2."""
    if not entry.is_Mul:
        return entry
    entry = sp.factor(entry)
    for sigma, expression in SIGMAS_RIGHT.items():
        number, rest = sp.factor(expression).as_coeff_Mul()
        entry = entry.subs(rest, sigma / number)
    return entry


def in_one_line(rows: sp.Matrix | Sequence[Sequence[str]]) -> str:
    """Write a matrix, or the rows of a table, in one line, with semicolons between the rows."""
    if isinstance(rows, sp.MatrixBase):
        rows = texts(rows)
    return f"[{'; '.join(', '.join(row) for row in rows)}]"


def texts(matrix: sp.Matrix) -> tuple[tuple[str, ...], ...]:
    """Write the entries of a matrix, row by row."""
    return tuple(tuple(map(text, row)) for row in matrix.tolist())


def angle_values(q: Sequence[float]) -> dict[str, float]:
    """Name joint angles [rad], and their sums, as report B does: θ1, θ12, θ123."""
    values = {f"θ{joint}": angle for joint, angle in enumerate(q, start=1)}
    return values | {"θ12": math.fsum(q[:2]), "θ123": math.fsum(q[:3])}


def rotation_defect(X: Array) -> tuple[float, float]:
    """Measure how far the upper left part R of a (4, 4) transform is from a rotation.

    Returns its determinant, 1 for a rotation, and the greatest entry of ``R' R - 1``, 0 for one.
    """
    R = X[:3, :3]
    return float(np.linalg.det(R)), float(np.abs(R.T @ R - np.eye(3)).max())
