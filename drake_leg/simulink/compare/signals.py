"""Signals in a form that does not depend on how they are muxed, scaled and summed.

Every scalar signal is a constant plus multiples of atoms: a sine, an integrator's integral, an
output of a function, a sensed quantity. Muxes, demuxes, gains, sums and constants dissolve in
it, so that two diagrams that mean the same in different blocks have the same signals.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

CLOSE = 1e-9  # relative, of numbers that count as equal
NOTHING = 1e-15  # what rounding leaves of a zero
PHASE_ROUNDING = 1e-12  # [half turns, rad]


@dataclass(frozen=True, kw_only=True, order=True)
class Atom:
    """A signal that no linear block makes.

    ``sine``: numbers are frequency [rad/s] and phase [rad]. ``integral``: of an integrator,
    without its initial value. ``function``: an output of a block with a law of its own.
    ``sensed``: a quantity of a joint, named by its number in the chain. ``foot``: a quantity of
    the foot against the base. ``other``: the output of a block that has no counterpart.
    """

    kind: str
    of: str = ""  # the block, the joint's number, the role
    what: str = ""  # the quantity or port
    index: int = 0
    numbers: tuple[float, ...] = ()
    name: str = field(default="", compare=False)  # of the block, for a person

    def __str__(self) -> str:
        """Name the signal for a person."""
        if self.kind == "sine":
            return "sine"
        words = {
            "integral": f"integral {self.name or self.of}",
            "function": f"output {self.index + 1} of {self.name!r}",
            "sensed": f"sensed {self.what} of joint {self.of}",
            "foot": f"{self.what} {self.index + 1} of the foot",
            "other": f"the output of {self.name!r}",
        }
        role = self.kind == "function" and not self.name
        return f"{self.what} {self.index + 1}" if role else words[self.kind]


@dataclass(frozen=True)
class Scalar:
    """A constant plus multiples of atoms."""

    constant: float = 0.0
    terms: Mapping[Atom, float] = field(default_factory=dict)
    origins: frozenset[str] = field(default=frozenset(), compare=False)  # SIDs on its way

    def scaled(self, factor: float) -> Scalar:
        """Multiply by a number."""
        return total([self], [factor])

    @property
    def shape(self) -> frozenset[Atom]:
        """The atoms without their numbers: what the signal is made of."""
        return frozenset(Atom(kind="sine") if atom.kind == "sine" else atom for atom in self.terms)

    def renamed(self, names: Mapping[Atom, Atom]) -> Scalar:
        """Replace the atoms that have other names."""
        terms = {names.get(atom, atom): factor for atom, factor in self.terms.items()}
        return Scalar(self.constant, terms, self.origins)

    def per(self, units: Mapping[Atom, float]) -> Scalar:
        """Write atoms as multiples of other units."""
        terms = {atom: factor / units.get(atom, 1.0) for atom, factor in self.terms.items()}
        return Scalar(self.constant, terms, self.origins)

    def through(self, sid: str) -> Scalar:
        """Note a block that the signal has passed; the result equals this signal."""
        return Scalar(self.constant, self.terms, self.origins | {sid})

    @property
    def sines(self) -> list[tuple[float, float, float]]:
        """Frequency [rad/s], phase [rad] and amplitude of its sines, in that order."""
        return sorted(
            (atom.numbers[0], atom.numbers[1], factor)
            for atom, factor in self.terms.items()
            if atom.kind == "sine"
        )

    def __str__(self) -> str:
        """Write the signal as a sum."""
        parts = [
            f"{'' if close(factor, 1.0) else f'{factor:.9g} x '}{atom}"
            for atom, factor in sorted(self.terms.items())
        ]
        if self.constant or not parts:
            parts.append(f"{self.constant:.9g}")
        return " + ".join(parts)


Signal = tuple[Scalar, ...]


def total(signals: Sequence[Scalar], factors: Iterable[float]) -> Scalar:
    """Sum signals, each times its factor; terms that cancel vanish."""
    constant = 0.0
    terms: dict[Atom, float] = {}
    origins: frozenset[str] = frozenset()
    for signal, factor in zip(signals, factors, strict=True):
        origins |= signal.origins if factor else frozenset()
        constant += factor * signal.constant
        for atom, value in signal.terms.items():
            terms[atom] = terms.get(atom, 0.0) + factor * value
    kept = {atom: value for atom, value in terms.items() if value != 0.0}
    return Scalar(constant, kept, origins)


def constants(values: Iterable[float]) -> Signal:
    """Make a constant signal."""
    return tuple(Scalar(float(value)) for value in values)


def atoms(atom: Iterable[Atom]) -> Signal:
    """Make a signal of bare atoms, one for each component."""
    return tuple(Scalar(0.0, {one: 1.0}) for one in atom)


def sine_term(amplitude: float, frequency: float, phase: float) -> Scalar:
    """Make a sine, written in one way: frequency [rad/s] positive, phase [rad] in 0 ... pi."""
    if frequency < 0.0:
        amplitude, frequency, phase = -amplitude, -frequency, -phase
    half_turns = math.floor(phase / math.pi + PHASE_ROUNDING)
    phase = max(phase - half_turns * math.pi, 0.0)
    if half_turns % 2:
        amplitude = -amplitude
    if amplitude == 0.0:
        return Scalar()
    atom = Atom(kind="sine", numbers=(frequency, 0.0 if phase < PHASE_ROUNDING else phase))
    return Scalar(0.0, {atom: amplitude})


def close(a: float, b: float) -> bool:
    """Tell whether two numbers of a model are the same up to rounding."""
    return bool(math.isclose(a, b, rel_tol=CLOSE, abs_tol=NOTHING) or a == b)


def mixed(matrix: np.ndarray, signal: Signal) -> Signal:
    """Multiply a signal of n components by an (m, n) matrix."""
    return tuple(total(signal, row) for row in matrix.tolist())
