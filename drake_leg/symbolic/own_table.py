"""A robot's own table derived, piece by piece: each piece may take long, or for ever."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import sympy as sp

from drake_leg.robot import Row
from drake_leg.symbolic.chain import (
    SymbolicChain,
    base_transforms,
    direct_jacobian,
    indirect_jacobian,
    row_transform,
    symbolic_chain,
)
from drake_leg.symbolic.equations import Equation, zeros_of
from drake_leg.symbolic.singularities import singular_families
from drake_leg.symbolic.trigonometry import normal_form, tidy

PARTS = ("w_x", "w_y", "w_z", "v_x", "v_y", "v_z")  # rows of the Jacobian


@dataclass(frozen=True, kw_only=True)
class Piece:
    """Something that is derived."""

    title: str
    derive: Callable[[], list[Equation]]
    otherwise: str = ""  # what it says that there is no equation


class OwnTable:
    """What follows from a robot's table.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which m rows move.
    """

    def __init__(self, rows: Sequence[Row]) -> None:
        self.chain: SymbolicChain = symbolic_chain(rows)

    @property
    def legend(self) -> str:
        """The numbers of the letters, as in ``l1 = 0.25 m``."""
        return ", ".join(
            f"{symbol} = {value:.9g} {'m' if symbol.is_positive else 'rad'}"
            for symbol, value in self.chain.values.items()
        )

    def pieces(self) -> Iterator[Piece]:
        """List what is derived, the simplest first.

        Yields
        ------
        Piece
            Later ones use what earlier ones found.
        """
        for frame, row in enumerate(self.chain.rows, start=1):
            title = f"frame {frame} in frame {frame - 1}"
            left = sp.MatrixSymbol(f"T_{frame - 1}{frame}", 4, 4)
            yield _piece(title, left, partial(row_transform, row))
        for frame in range(2, len(self.chain.rows) + 1):
            title, left = f"frame {frame} in the base", sp.MatrixSymbol(f"T_0{frame}", 4, 4)
            yield _piece(title, left, partial(self._to_base, frame))
        columns = len(self.chain.q)
        title = f"Jacobian, its rows {', '.join(PARTS)}"
        yield _piece(title, sp.MatrixSymbol("J", 6, columns), lambda: self._jacobian)
        difference = sp.Symbol("direct") - sp.Symbol("indirect")
        yield _piece("Jacobian by both methods", difference, self._difference)
        yield Piece(
            title="determinant",
            derive=self._determinants,
            otherwise="none, as no rows of the Jacobian are as many as its columns",
        )
        yield Piece(
            title="singular postures",
            derive=self._families,
            otherwise="none is told by a determinant",
        )

    def _to_base(self, frame: int) -> sp.Matrix:
        return base_transforms(self.chain)[frame - 1].applyfunc(tidy)

    @cached_property
    def _direct(self) -> sp.Matrix:
        return direct_jacobian(self.chain)

    @cached_property
    def _jacobian(self) -> sp.Matrix:
        return self._direct.applyfunc(tidy)

    def _difference(self) -> sp.Basic:
        difference = (self._direct - indirect_jacobian(self.chain)).applyfunc(normal_form)
        return sp.Integer(0) if difference.is_zero_matrix else difference

    @cached_property
    def _square(self) -> tuple[int, ...]:
        """Rows of the Jacobian that make it square: what moves at all, or only translates."""
        moved = [row for row in range(6) if not self._jacobian[row, :].is_zero_matrix]
        for rows in ([row for row in moved if row >= 3], moved):
            if len(rows) == len(self.chain.q):
                return tuple(rows)
        return ()

    @cached_property
    def _determinant(self) -> sp.Expr:
        return tidy(
            self._jacobian.extract(list(self._square), list(range(len(self._square)))).det()
        )

    def _determinants(self) -> list[Equation]:
        size = len(self._square)
        if not size:
            return []
        return [
            Equation(
                title=f"determinant of the rows {', '.join(PARTS[row] for row in self._square)}",
                left=sp.Determinant(sp.MatrixSymbol("J", size, size)),
                right=self._determinant,
            )
        ]

    def _families(self) -> list[Equation]:
        if not self._square:
            return []
        families = singular_families(self._determinant, self.chain.q)
        return [equation for family in families for equation in zeros_of(family)]


def _piece(title: str, left: sp.Basic, right: Callable[[], sp.Basic]) -> Piece:
    return Piece(title=title, derive=lambda: [Equation(title=title, left=left, right=right())])
