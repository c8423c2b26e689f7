"""Whether a printed formula is what a matrix is, with numbers and with lengths of any size."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterator

import numpy as np

from drake_leg.check.bindings import Binding, same
from drake_leg.check.chains import Chain
from drake_leg.check.decimals import agrees_within_digits
from drake_leg.check.expressions import evaluate, names_in
from drake_leg.check.formula_trees import number_of, parts, replace_node
from drake_leg.check.postures import COUNT
from drake_leg.check.samples import Sampler, Samples
from drake_leg.kinematics.batches import Array

MOST_READINGS = 64  # of an entry's numbers as lengths


class Meaning:
    """What a matrix is, or could be, at all samples; evaluated once for each of them."""

    def __init__(self, of_chain: Callable[[Chain], Array]) -> None:
        self._of_chain = of_chain
        self._found: list[tuple[Samples, Array]] = []

    def at(self, samples: Samples) -> Array:
        """Evaluate the matrix, (N, r, c)."""
        for known, found in self._found:
            if known is samples:
                return found
        with np.errstate(all="ignore"):
            self._found.append((samples, self._of_chain(samples.chain)))
        return self._found[-1][1]


class Comparison:
    """Compares formulas with meanings, under one reading of the symbols.

    Parameters
    ----------
    binding : Binding
        Which cells of the table its symbols stand for.
    """

    def __init__(self, sampler: Sampler, binding: Binding) -> None:
        self.sampler, self.binding = sampler, binding

    def values(self, tree: ast.expr, samples: Samples | None = None) -> Array:
        """Evaluate a formula, (N,); by default with the lengths as they are."""
        values = (samples or self.sampler.as_it_is).values
        return np.broadcast_to(evaluate(tree, values), COUNT)

    def agrees_in_number(
        self, tree: ast.expr, meaning: Meaning, place: tuple[int, int], margin: float
    ) -> bool:
        """Whether a formula is right for the lengths as they are."""
        return self._agrees(tree, meaning, place, margin, self.sampler.as_it_is)

    def agrees(
        self, tree: ast.expr, meaning: Meaning, place: tuple[int, int], margin: float
    ) -> bool:
        """Whether a formula is right whatever the lengths that it has symbols for.

        Parameters
        ----------
        tree : ast.expr
            Formula of joint variables, lengths and numbers.
        meaning : Meaning
            What it is compared with.
        place : (int, int)
            Row and column there, from 0.
        margin : float
            How far from it counts as equal; a value that is not finite never does.

        Returns
        -------
        bool
            Numbers that stand for lengths are right as numbers.
        """
        return self.agrees_in_number(tree, meaning, place, margin) and (
            self.agrees_in_symbols(tree, meaning, place, margin)
            or any(
                self.agrees_in_symbols(other, meaning, place, margin)
                for other in itertools.islice(self._with_symbols(tree), MOST_READINGS)
            )
        )

    def agrees_in_symbols(
        self, tree: ast.expr, meaning: Meaning, place: tuple[int, int], margin: float
    ) -> bool:
        """Whether a formula stays right while the lengths vary that it has symbols for."""
        samples = self.sampler.varied(self.binding, names_in(tree))
        return self._agrees(tree, meaning, place, margin, samples)

    def _agrees(
        self,
        tree: ast.expr,
        meaning: Meaning,
        place: tuple[int, int],
        margin: float,
        samples: Samples,
    ) -> bool:
        right = meaning.at(samples)[:, place[0], place[1]]
        with np.errstate(all="ignore"):
            return self._is_near(tree, right, margin, samples)

    def _is_near(self, tree: ast.expr, right: Array, margin: float, samples: Samples) -> bool:
        near = np.abs(self.values(tree, samples) - right) <= margin
        return bool(np.all(near)) or agrees_within_digits(
            tree, right, margin, lambda formula: self.values(formula, samples)
        )

    def _with_symbols(self, tree: ast.expr) -> Iterator[ast.expr]:
        """Read the numbers of a formula that has symbols, too, as lengths in all ways."""
        bound = {name for name in names_in(tree) if name in self.binding}
        choices = []
        for node in parts(tree) if bound else ():
            value = number_of(node)
            equal = [n for n in self.binding if value and same(self._length(n), value)]
            if isinstance(node, ast.Constant) and equal:
                choices.append([(node, None), *((node, name) for name in equal)])
        for chosen in itertools.islice(itertools.product(*choices), 1, None):
            other = tree
            for number, name in chosen:
                if name is not None:
                    other = replace_node(other, number, ast.Name(id=name))
            yield other

    def _length(self, name: str) -> float:
        return float(self.sampler.as_it_is.values[name])
