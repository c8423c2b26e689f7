"""The robot and a print's symbols at random samples: lengths as they are, or drawn freely."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drake_leg.check.bindings import Binding, Cell, cell_values
from drake_leg.check.chains import Chain, chain_of
from drake_leg.check.expressions import evaluate
from drake_leg.check.postures import COUNT, Postures
from drake_leg.check.reader import Reader
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

_LEAST, _MOST = 0.6, 1.6  # times its own value: how long a length is drawn


@dataclass(frozen=True, kw_only=True)
class Samples:
    """What a print's formulas and the robot are evaluated with."""

    values: Mapping[str, Any]  # symbol to number or (N,) array; angles in rad, lengths as printed
    chain: Chain  # in the print's unit of lengths


class Sampler:
    """Draws samples; the same ones whenever it is asked for the same lengths.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    reader : Reader
        Of the print: its symbols and the joints' formulas.
    """

    def __init__(
        self, robot: Robot, reader: Reader, postures: Postures, rng: np.random.Generator
    ) -> None:
        self._robot, self._reader, self._postures = robot, reader, postures
        self.lengths = cell_values(robot, postures.metres)
        self._factors = {cell: rng.uniform(_LEAST, _MOST, COUNT) for cell in self.lengths}
        chain = chain_of(robot.rows, postures.q, postures.metres)
        self.as_it_is = Samples(values=postures.values, chain=chain)
        self._drawn: dict[tuple[frozenset[str], frozenset[Any]], Samples] = {}

    def varied(self, binding: Binding, names: Collection[str]) -> Samples:
        """Vary the lengths that some symbols stand for.

        Parameters
        ----------
        binding : Binding
            What symbols stand for.
        names : collection of str
            Those to vary; other lengths stay as they are.

        Returns
        -------
        Samples
            A symbol that stands for several cells varies them together.
        """
        bound = frozenset(name for name in names if name in binding)
        if not bound:
            return self.as_it_is
        key = bound, frozenset(binding.items())
        if key not in self._drawn:
            self._drawn[key] = self._draw(binding, bound)
        return self._drawn[key]

    def _draw(self, binding: Binding, names: Collection[str]) -> Samples:
        factors: dict[Cell, Array] = {}
        for name in sorted(names):
            first = min(binding[name])
            factors |= dict.fromkeys(binding[name] - set(factors), self._factors[first])
        values = dict(self.as_it_is.values)
        for name, cells in binding.items():
            if cells & set(factors):
                values[name] = values[name] * factors[min(cells & set(factors))]
        chain = self._chain(values, factors)
        joints = {f"q{i + 1}": chain.q[:, i] for i in self._reader.joints}
        own = set(joints) - set(self._postures.variables)
        return Samples(values=values | {name: joints[name] for name in own}, chain=chain)

    def _chain(self, values: Mapping[str, Any], factors: Mapping[Cell, Array]) -> Chain:
        """Put lengths into the table, and the joints where the symbols then say."""
        chain = self.as_it_is.chain
        columns = {name: getattr(chain, name).copy() for name in ("d", "alpha", "r", "theta")}
        for (row, column), factor in factors.items():
            columns[column][:, row] *= factor
        q = chain.q.copy()
        for index, formula in self._reader.joints.items():
            q[:, index] = evaluate(formula, values)
        return replace(chain, q=q, **columns)
