"""From the equations of a network to its states: their derivatives, and what is put out.

All equations are solved once for what they determine: potentials, currents, forces and the rates of
states. What they say of states alone, as of two inertias that turn as one, is differentiated, and
takes a state away. Inputs may so come in with their derivatives.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from drake_leg.arguments import some_of
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block
from drake_leg.simulink.networks.assembly import Assembly, Law, State
from drake_leg.simulink.networks.elimination import Eliminated, eliminated
from drake_leg.simulink.networks.linear import ONE, Linear, Quantity, total

ORDERS = 3  # of the derivatives that may be taken
SAME = 1e-9  # of the targets of states that depend on one another
NAMED = 6  # blocks in an error


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduced:
    """A network by its states."""

    states: tuple[tuple[State, Linear], ...]  # with their derivatives
    laws: tuple[tuple[Law, tuple[Linear, ...]], ...]  # with their arguments
    outputs: Mapping[str, Linear]  # by port


def reduced(assembly: Assembly, blocks: Mapping[str, Block]) -> Reduced:
    """Find the states of a network.

    Raises
    ------
    InvalidValueError
        If its equations have no solution, or several: with the blocks that they are of.
    """
    return _Reduction(assembly, blocks).reduced()


@dataclass(eq=False)
class _Reduction:
    assembly: Assembly
    blocks: Mapping[str, Block]
    dependent: dict[Quantity, Linear] = field(default_factory=dict)  # states that follow

    def __post_init__(self) -> None:
        self._equations = list(self.assembly.equations)
        self._states = {state.quantity: state for state in self.assembly.states}
        quantities = self._quantities()
        self._rates = {q.of: q for q in quantities if q.of is not None}
        self._inputs = {
            (q.owner, order): Quantity(role="input", owner=q.owner, order=order) if order else q
            for q in quantities
            for order in range(ORDERS + 1)
            if q.role == "input"
        }

    def _quantities(self) -> list[Quantity]:
        sums = [equation for equation, _ in self._equations]
        sums += [argument for law in self.assembly.laws for argument in law.arguments]
        sums += self.assembly.outputs.values()
        found = dict.fromkeys(quantity for each in sums for quantity in each)
        for state in self.assembly.states:
            found[state.quantity] = None
        return list(found)

    def reduced(self) -> Reduced:
        for _ in range(ORDERS):
            solved = self._solved()
            constraints = self._constraints(solved)
            if not constraints:
                return self._result(solved)
            for constraint, involved in constraints:
                self._depend(constraint, involved)
        raise InvalidValueError(
            f"the network of {self._named(self.blocks)} fixes its states more than "
            f"{ORDERS} times: leave one of its rigid connections out"
        )

    # --- equations ---

    def _solved(self) -> Eliminated:
        quantities = self._quantities()
        self._unknown = [q for q in quantities if q.role in ("through", "rate", "across")]
        self._unknown.sort(key=lambda q: q.role == "across")  # the last ones are left free
        self._known = [q for q in quantities if q.role in ("state", "law")]
        self._known = [q for q in self._known if q not in self.dependent]
        self._known += [*self._inputs.values(), ONE]
        columns = {q: place for place, q in enumerate((*self._unknown, *self._known))}
        A = np.zeros((len(self._equations), len(columns)))
        for row, (equation, _) in enumerate(self._equations):
            for quantity, factor in self._substituted(equation).items():
                A[row, columns[quantity]] += factor
        count = len(self._unknown)
        return eliminated(A[:, :count], A[:, count:])

    def _substituted(self, value: Linear) -> Linear:
        """Replace the states that follow from others."""
        return total((factor, self.dependent.get(q, Linear(q))) for q, factor in value.items())

    def _constraints(self, solved: Eliminated) -> list[tuple[Linear, list[str]]]:
        """Find what the equations say of states alone."""
        found = []
        for row in solved.left:
            says = Linear(dict(zip(self._known, solved.N[row], strict=True)))
            involved = [
                sid
                for k in np.flatnonzero(solved.combination[row])
                for sid in self._equations[k][1]
            ]
            if not says:
                continue
            if not any(quantity.role == "state" for quantity in says):
                raise self._unsolved(says, involved)
            found.append((says, involved))
        return found

    def _unsolved(self, says: Linear, involved: Iterable[str]) -> InvalidValueError:
        if any(quantity.role == "law" for quantity in says):
            return InvalidValueError(
                f"the blocks {self._named(involved)} meet where a law that is not linear must be "
                "solved for its argument: put a mass or a damper, in a circuit a capacitor or a "
                "resistor, there"
            )
        return InvalidValueError(
            f"the blocks {self._named(involved)} leave their network no solution, as they fix one "
            "quantity more than once: leave one out, or put a mass or an element with losses "
            "between them"
        )

    def _depend(self, constraint: Linear, involved: Iterable[str]) -> None:
        """Take a state away that follows from others, and let its rate follow, too."""
        constraint = self._substituted(constraint)
        states = [q for q in constraint if q.role == "state"]
        if not states:
            return
        if any(q.role == "law" for q in constraint):
            raise InvalidValueError(
                f"the blocks {self._named(involved)} fix a state by a law that is not linear: put "
                "an element with losses between them"
            )
        least = min(states, key=lambda q: (self._states[q].priority, -abs(constraint[q])))
        factor = constraint[least]
        instead = (-1.0 / factor) * (constraint - factor * Linear(least))
        self.dependent[least] = instead
        self.dependent = {q: self._substituted(value) for q, value in self.dependent.items()}
        rate = Linear()
        for quantity, share in constraint.items():
            if quantity.role == "state":
                rate += share * Linear(self._rates[quantity])
            elif quantity.role == "input":
                rate += share * Linear(self._inputs[quantity.owner, quantity.order + 1])
        self._equations.append((rate, tuple(involved)))
        self._require_target(least, instead)

    def _require_target(self, state: Quantity, instead: Linear) -> None:
        """Refuse a target that contradicts those of the states it follows from."""
        start = self._states[state].start
        if self._states[state].priority < 2:
            return
        if any(q.role == "input" for q in instead):
            if start:
                raise InvalidValueError(
                    f"block {self.blocks[state.owner].name!r} (SID {state.owner}) has the target "
                    f"{start:g} for what a signal moves: clear it, as the signal says where it "
                    "starts"
                )
            return
        follows = sum(
            factor * (self._states[q].start if q.role == "state" else 1.0)
            for q, factor in instead.items()
        )
        if abs(follows - start) > SAME * (1.0 + abs(start)):
            raise InvalidValueError(
                f"block {self.blocks[state.owner].name!r} (SID {state.owner}) has the target "
                f"{start:g}, but what it is connected with makes it {follows:g}: choose targets "
                "that agree"
            )

    # --- results ---

    def _result(self, solved: Eliminated) -> Reduced:
        values: dict[Quantity, Linear] = {}
        open_ones = {self._unknown[column] for column in solved.free}
        for quantity in open_ones & self.assembly.potentials.keys():
            raise self._undetermined(quantity)
        for column, row in solved.pivots.items():
            terms = dict(zip(self._known, -solved.N[row], strict=True))
            terms |= {self._unknown[k]: -solved.M[row, k] for k in solved.free if solved.M[row, k]}
            values[self._unknown[column]] = Linear(terms)

        def explicit(value: Linear) -> Linear:
            found = Linear()
            for quantity, factor in self._substituted(value).items():
                found += factor * values.get(quantity, Linear(quantity))
            for quantity in found:
                if quantity in open_ones:
                    raise self._undetermined(quantity)
            return found

        states = [state for q, state in self._states.items() if q not in self.dependent]
        return Reduced(
            states=tuple(
                (state, explicit(Linear(self._rates[state.quantity]))) for state in states
            ),
            laws=tuple(
                (law, tuple(explicit(argument) for argument in law.arguments))
                for law in self.assembly.laws
            ),
            outputs={port: explicit(value) for port, value in self.assembly.outputs.items()},
        )

    def _undetermined(self, quantity: Quantity) -> InvalidValueError:
        block = self.blocks[quantity.owner.partition("#")[0]]
        if quantity.role == "across":
            return InvalidValueError(
                f"the network of block {block.name!r} (SID {block.sid}) has no reference: connect "
                "one to it"
            )
        return InvalidValueError(
            f"what flows through block {block.name!r} (SID {block.sid}) is not determined by its "
            "network: put an element with losses beside it"
        )

    def _named(self, sids: Iterable[str]) -> str:
        names = [repr(self.blocks[sid].name) for sid in dict.fromkeys(sids)]
        return some_of(names, NAMED)
