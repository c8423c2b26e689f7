"""Signals in a form that does not depend on how they are muxed, scaled and summed.

Every scalar signal is a constant plus multiples of atoms: a sine, an integrator's integral, an
output of a function, a sensed quantity. Muxes, demuxes, gains, sums and constants dissolve in
it, so that two diagrams that mean the same in different blocks have the same signals. The laws
of Simulink's memoryless blocks are here, too.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.program import value as evaluated
from drake_leg.simulink.model import Block, number, vector

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
            "foot": f"{self.what} {self.index + 1} of {self.of or 'the foot'}",
            "other": f"the output of {self.name!r}",
        }
        role = self.kind == "function" and not self.name
        return f"{self.what} {self.index + 1}" if role else words[self.kind]


@dataclass(frozen=True)
class Scalar:
    """A constant plus multiples of atoms."""

    constant: float = 0.0
    terms: Mapping[Atom, float] = field(default_factory=dict)
    origins: frozenset[str] = field(default=frozenset(), compare=False)  # blocks on its way

    def scaled(self, factor: float) -> Scalar:
        """Multiply by a number."""
        return total([self], [factor])

    @cached_property
    def shape(self) -> Shape:
        """The atoms without their numbers: what the signal is made of."""
        return frozenset(Atom(kind="sine") if atom.kind == "sine" else atom for atom in self.terms)

    def renamed(self, names: Mapping[Atom, Atom]) -> Scalar:
        """Replace the atoms that have other names."""
        if names.keys().isdisjoint(self.terms):
            return self
        terms = {names.get(atom, atom): factor for atom, factor in self.terms.items()}
        return Scalar(self.constant, terms, self.origins)

    def per(self, units: Mapping[Atom, float]) -> Scalar:
        """Write atoms as multiples of other units."""
        if units.keys().isdisjoint(self.terms):
            return self
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


Shape = frozenset[Atom]
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


def integral_roles(scalar: Scalar, joint: int) -> dict[Atom, Atom]:
    """Name the integrals in a joint's commanded position after the joint."""
    role = Atom(kind="integral", of=f"of joint {joint}")
    return {atom: role for atom in scalar.terms if atom.kind == "integral"}


def function_role(what: str, index: int = 0) -> Atom:
    """Name an output of the inverse Jacobian: ``qdot`` or ``det J``, its component from 0."""
    return Atom(kind="function", of="inverse Jacobian", what=what, index=index)


# --- the laws of linear blocks ---------------------------------------------------------------

Inputs = Sequence[Signal]  # by port; zero where nothing is connected
Law = Callable[[Block, Inputs, int], Signal | None]  # None where the law cannot be followed

SINE = (("Amplitude", 1.0), ("Bias", 0.0), ("Frequency", 1.0), ("Phase", 0.0))
SOURCES = ("Sin", "SignalGenerator", "Constant", "Ground")
INTEGERS = re.compile(r"int\d|boolean|fixdt", re.IGNORECASE)  # types that round
CONVERSIONS = {"Radians to Degrees": 180.0 / math.pi, "Degrees to Radians": math.pi / 180.0}
DIALOG = ("", "Index vector (dialog)")
OPEN = constants([0.0])  # an input that is not connected
TRIALS = (0.0, 1.0, -0.31830989, 0.73, 11.3719, -47.1238898, 1234.5678)  # of an expression of u
AFFINE = 1e-12  # relative, of an expression that counts as a factor and a constant


def law_of(block: Block) -> Law | None:
    """Find the law of a block: ``law(block, inputs, place)`` is the signal at an output, from 1.

    A block with memory, with a law of its own, or that is not linear has none.
    """
    if block.type == "Fcn":
        return _fcn if _affine(block) else None
    if block.type == "SignalGenerator" and block.parameters.get("WaveForm") != "sine":
        return None
    if INTEGERS.search(str(block.parameters.get("OutDataTypeStr", ""))):
        return None
    if block.kind in CONVERSIONS:
        return _conversion
    return LAWS.get(block.type)


def added(parts: Sequence[Signal], factors: Sequence[float]) -> Signal:
    """Sum signals, each times its factor; a scalar is added to every component."""
    size = max(map(len, parts))
    wide = [part * size if len(part) == 1 else part for part in parts]
    summed = []
    for index in range(size):
        there = [
            (part[index], f) for part, f in zip(wide, factors, strict=True) if index < len(part)
        ]
        summed.append(total([part for part, _ in there], [f for _, f in there]))
    return tuple(summed)


def _sine(block: Block, inputs: Inputs, place: int) -> Signal | None:
    columns = [vector(block.parameters.get(name, default)) for name, default in SINE]
    if len({len(column) for column in columns} - {1}) > 1 or not all(columns):
        return None
    rows = np.broadcast_arrays(*(np.array(column) for column in columns))
    return tuple(
        total([sine_term(amplitude, frequency, phase), Scalar(bias)], [1.0, 1.0])
        for amplitude, bias, frequency, phase in zip(*(r.tolist() for r in rows), strict=True)
    )


def _gain(block: Block, inputs: Inputs, place: int) -> Signal | None:
    signal, gain = inputs[0], block.parameters.get("Gain", 1.0)
    how = str(block.parameters.get("Multiplication", ""))
    if isinstance(gain, str):
        return None
    if how.startswith("Matrix") and isinstance(gain, tuple):
        matrix = np.atleast_2d(np.array(gain, dtype=float))
        matrix = matrix if how.startswith("Matrix(K*u)") else matrix.T
        return mixed(matrix, signal) if matrix.shape[1] == len(signal) else None
    factors = vector(gain)
    if len(factors) == 1:
        return tuple(scalar.scaled(factors[0]) for scalar in signal)
    if len(signal) == 1:
        return tuple(signal[0].scaled(factor) for factor in factors)
    if len(signal) != len(factors):
        return None
    return tuple(s.scaled(factor) for s, factor in zip(signal, factors, strict=True))


def _sum(block: Block, inputs: Inputs, place: int) -> Signal | None:
    signs = [sign for sign in str(block.parameters.get("Inputs", "++")) if sign in "+-"]
    factors = [1.0 if sign == "+" else -1.0 for sign in signs]
    if len(factors) == 1:
        signal = inputs[0]
        return (total(signal, factors * len(signal)),)
    if not factors:
        return None
    wired = [*inputs, *[OPEN] * len(factors)]
    return added(wired[: len(factors)], factors)


def _bias(block: Block, inputs: Inputs, place: int) -> Signal:
    bias = constants(vector(block.parameters.get("Bias", 0.0)))
    return added([inputs[0], bias], [1.0, 1.0])


def _generator(block: Block, inputs: Inputs, place: int) -> Signal:
    hertz = str(block.parameters.get("Units", "")).lower().startswith("h")
    frequency = number(block.parameters.get("Frequency"), 1.0) * (2.0 * math.pi if hertz else 1.0)
    return (sine_term(number(block.parameters.get("Amplitude"), 1.0), frequency, 0.0),)


def _product(block: Block, inputs: Inputs, place: int) -> Signal | None:
    """Follow a product in which one factor at most is not a constant."""
    signs = str(block.parameters.get("Inputs", "2"))
    if signs.strip("*") and not signs.isdigit():
        return None
    size = max(len(signal) for signal in inputs)
    wide = [signal * (size if len(signal) == 1 else 1) for signal in inputs]
    product = []
    for index in range(size):
        parts = [signal[index] for signal in wide if index < len(signal)]
        moving = [part for part in parts if part.terms]
        if len(moving) > 1:
            return None
        still = [part for part in parts if not part.terms]
        scaled = (moving[0] if moving else Scalar(1.0)).scaled(
            math.prod(part.constant for part in still)
        )
        origins = [Scalar(0.0, {}, part.origins) for part in still]
        product.append(total([scaled, *origins], [1.0] * (1 + len(origins))))
    return tuple(product)


def _switch(block: Block, inputs: Inputs, place: int) -> Signal:
    """Follow a Manual Switch in its present position."""
    lower = str(block.parameters.get("CurrentSetting", "1")) == "0"
    wired = [*inputs, OPEN][:2]
    return wired[lower]


def _selector(block: Block, inputs: Inputs, place: int) -> Signal | None:
    if str(block.parameters.get("IndexOptions", "")).strip() not in DIALOG:
        return None
    signal = inputs[0]
    try:
        indices = vector(evaluated(str(block.parameters.get("Indices", "[1 3]"))))
    except InvalidValueError:
        return None
    first = 0 if str(block.parameters.get("IndexMode", "")).startswith("Zero") else 1
    chosen = [int(index) - first for index in indices]
    if any(not 0 <= index < len(signal) for index in chosen):
        return None
    return tuple(signal[index] for index in chosen)


def _demux(block: Block, inputs: Inputs, place: int) -> Signal | None:
    signal = inputs[0]
    widths = _widths(block, len(signal))
    if place > len(widths):
        return None
    start = sum(widths[: place - 1])
    return signal[start : start + widths[place - 1]]


def least_size(demux: Block) -> int:
    """Return how many components a Demux needs at least."""
    outputs = vector(demux.parameters.get("Outputs", 1.0))
    if len(outputs) > 1:
        return sum(int(width) if width > 0 else 1 for width in outputs)
    return max(int(outputs[0]), 1) if outputs else 1


def _widths(block: Block, size: int) -> list[int]:
    """Share a Demux's input out; there are no outputs where it cannot be."""
    outputs = vector(block.parameters.get("Outputs", 1.0))
    if len(outputs) > 1:
        fixed = sum(int(width) for width in outputs if width > 0)
        free = sum(width <= 0 for width in outputs)
        return [int(w) if w > 0 else (size - fixed) // max(free, 1) for w in outputs]
    count = least_size(block)
    if count > size:
        return []
    each, rest = divmod(size, count)
    return [each + (index < rest) for index in range(count)]


def _conversion(block: Block, inputs: Inputs, place: int) -> Signal:
    factor = CONVERSIONS[block.kind]
    return tuple(scalar.scaled(factor) for scalar in inputs[0])


def _affine(block: Block) -> tuple[float, float] | None:
    """Read an Fcn's expression of its scalar input as a factor and a constant."""
    text = str(block.parameters.get("Expr", "")).replace("u(1)", "u").replace("u[1]", "u")
    try:
        found = [evaluated(text, {"u": at}) for at in TRIALS]
    except InvalidValueError:
        return None
    if not all(isinstance(one, float) and math.isfinite(one) for one in found):
        return None
    zero, one, *others = (float(str(result)) for result in found)
    slope = one - zero
    bent = max(
        abs(result - zero - at * slope) / max(abs(at), 1.0)
        for at, result in zip(TRIALS[2:], others, strict=True)
    )
    return (slope, zero) if bent <= AFFINE * (abs(slope) + abs(zero)) else None


def _fcn(block: Block, inputs: Inputs, place: int) -> Signal | None:
    affine, signal = _affine(block), inputs[0]
    if affine is None or len(signal) != 1:
        return None
    return (total([signal[0], Scalar(1.0)], affine),)


LAWS: dict[str, Law] = {
    "Sin": _sine,
    "Constant": lambda block, *_: constants(vector(block.parameters.get("Value", 1.0))),
    "Ground": lambda *_: OPEN,
    "Gain": _gain,
    "Sum": _sum,
    "Bias": _bias,
    "UnaryMinus": lambda _, inputs, __: tuple(scalar.scaled(-1.0) for scalar in inputs[0]),
    "Demux": _demux,
    "Selector": _selector,
    "Product": _product,
    "ManualSwitch": _switch,
    "SignalGenerator": _generator,
    **dict.fromkeys(("Mux", "Concatenate", "BusCreator"), lambda _, inputs, __: sum(inputs, ())),
    **dict.fromkeys(
        (
            "SignalConversion",
            "DataTypeConversion",
            "RateTransition",
            "Reshape",
            "SignalSpecification",
            "Squeeze",
            "BusToVector",
        ),
        lambda _, inputs, __: inputs[0],
    ),
}
