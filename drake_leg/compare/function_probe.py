"""A MATLAB Function called at many postures, beside the live inverse Jacobian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_leg.compare.signals import Atom, Scalar
from drake_leg.compare.simulink_signals import SimulinkSignals
from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.batches import Array
from drake_leg.systems.inverse_jacobian import InverseJacobian

POSTURES = 12
DRAWS = 400
SEED = 3
WORST_CONDITION = 40.0  # of the Jacobian at the postures that are tried
VELOCITY = 0.6  # in the function's unit, of the trials that tell rates from other outputs


@dataclass(frozen=True, kw_only=True)
class Slot:
    """One scalar input of the function."""

    port: str  # where it enters the last Mux before the function, or the function itself
    scalar: Scalar
    joint: int = 0  # whose position it takes; 0 for a part of the velocity
    factor: float = 1.0  # input = constant + factor * position
    constant: float = 0.0


Slots = list[list[Slot]]  # by input of the function


@dataclass(frozen=True)
class LiveInverse:
    """The live inverse Jacobian, evaluated at postures of one's choice."""

    block: InverseJacobian

    @property
    def size(self) -> int:
        """Number of joints."""
        return int(self.block.GetInputPort("q").size())

    @property
    def commanded(self) -> int:
        """Number of commanded velocities."""
        return int(self.block.GetInputPort("v").size())

    def inverse(self, q: Array) -> Array:
        """Evaluate ``J^-1``.

        Parameters
        ----------
        q : (n,)
            Joint positions [rad].

        Returns
        -------
        (n, n) ndarray
            [rad/m].

        Raises
        ------
        SingularConfigurationError
            If there is none.
        """
        context = self.block.CreateDefaultContext()
        self.block.GetInputPort("q").FixValue(context, q)
        columns = []
        for unit in np.eye(self.block.GetInputPort("v").size()):
            self.block.GetInputPort("v").FixValue(context, unit)
            columns.append(np.array(self.block.GetOutputPort("qdot").Eval(context)))
        return np.column_stack(columns)

    def postures(self) -> Array:
        """Draw postures at which the Jacobian is far from singular, as far as there are any.

        Returns
        -------
        (at most POSTURES, n) ndarray
            [rad].
        """
        random = np.random.default_rng(SEED)
        found: list[tuple[float, Array]] = []
        for q in random.uniform(-2.5, 2.5, (DRAWS, self.size)):
            try:
                found.append((float(np.linalg.cond(self.inverse(q))), q))
            except DrakeLegError:
                continue
            if sum(condition < WORST_CONDITION for condition, _ in found) == POSTURES:
                break
        best = sorted(found, key=lambda one: one[0])[:POSTURES]
        return np.array([q for _, q in best])


class FunctionProbe:
    """A MATLAB Function with its inputs sorted into joint positions and a velocity.

    Parameters
    ----------
    sid : str
        Of the function's block.
    """

    def __init__(self, signals: SimulinkSignals, sid: str, slots: Slots) -> None:
        self._signals, self._sid = signals, sid
        self._program = signals.programs[sid]
        self.slots = slots
        flat = [slot for row in slots for slot in row]
        self.velocity = [slot for slot in flat if slot.joint == 0]
        self.joints = [slot for slot in flat if slot.joint]

    def wired(self, slots: Slots) -> FunctionProbe:
        """Take the same function with its inputs wired otherwise."""
        return FunctionProbe(self._signals, self._sid, slots)

    def outputs(self, q: Array, v: Array) -> dict[Atom, float]:
        """Call the function.

        Parameters
        ----------
        q : (n,)
            Joint positions [rad or m].
        v : (m,)
            The other inputs, in the function's units.
        """
        parts = iter(v.tolist())
        arguments = [
            [
                slot.constant + slot.factor * q[slot.joint - 1] if slot.joint else next(parts)
                for slot in row
            ]
            for row in self.slots
        ]
        return {
            Atom(kind="function", of=self._sid, what=str(place), index=index): float(number)
            for place, result in enumerate(self._program.call(*arguments), start=1)
            for index, number in enumerate(result)
        }

    def rates(self, postures: Array) -> list[Atom]:
        """Find the outputs that change with the velocity.

        Parameters
        ----------
        postures : (k, n)
            Where it is tried [rad].

        Returns
        -------
        list of Atom
            In the function's order.
        """
        count = len(self.velocity)
        changing: set[Atom] = set()
        for q in postures[:3]:
            rest, moving = self.outputs(q, np.zeros(count)), self.outputs(q, self._trial())
            changing |= {atom for atom in rest if rest[atom] != moving[atom]}
        return sorted(changing, key=lambda atom: (int(atom.what), atom.index))

    def others(self, postures: Array, rates: list[Atom]) -> dict[Atom, Array]:
        """Evaluate the outputs that are no rates.

        Parameters
        ----------
        postures : (k, n)
            Where [rad].

        Returns
        -------
        dict
            Output -> (k,) ndarray.
        """
        called = [self.outputs(q, self._trial()) for q in postures]
        return {
            atom: np.array([values[atom] for values in called])
            for atom in called[0]
            if atom not in rates
        }

    def matrices(self, postures: Array, rates: list[Atom]) -> Array:
        """Evaluate G of ``qdot = G v``.

        Parameters
        ----------
        postures : (k, n)
            Where [rad].
        rates : list of Atom
            The outputs that make ``qdot``.

        Returns
        -------
        (k, n, m) ndarray
        """
        count = len(self.velocity)
        found = []
        for q in postures:
            rest = self._at(q, np.zeros(count), rates)
            found.append(np.column_stack([self._at(q, v, rates) - rest for v in np.eye(count)]))
        return np.array(found)

    def _trial(self) -> Array:
        return VELOCITY * np.linspace(1.0, 1.3, len(self.velocity))

    def _at(self, q: Array, v: Array, rates: list[Atom]) -> Array:
        values = self.outputs(q, v)
        return np.array([values[atom] for atom in rates])


def slots_of(signals: SimulinkSignals, sid: str, commanded: dict[int, Scalar]) -> Slots:
    """Sort a function's inputs into joint positions and parts of the velocity.

    Parameters
    ----------
    sid : str
        Of the function's block.
    commanded : dict
        Joint -> the scalar that is commanded to it, as the model writes it.

    Returns
    -------
    list of list of Slot
        By input of the function.
    """
    return [
        [
            _slot(scalar, signals.entry(f"{sid}#in:{place}", index), commanded)
            for index, scalar in enumerate(signals.input(sid, place) or ())
        ]
        for place in range(1, len(signals.programs[sid].inputs) + 1)
    ]


def _slot(scalar: Scalar, port: str, commanded: dict[int, Scalar]) -> Slot:
    for joint, command in commanded.items():
        if scalar == command:
            return Slot(port=port, scalar=scalar, joint=joint)
    if len(scalar.terms) == 1:
        ((atom, factor),) = scalar.terms.items()
        if atom.kind == "sensed" and atom.what == "position":
            return Slot(
                port=port,
                scalar=scalar,
                joint=int(atom.of),
                factor=factor,
                constant=scalar.constant,
            )
    return Slot(port=port, scalar=scalar)
