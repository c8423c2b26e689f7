"""Whether a MATLAB Function and the inverse Jacobian are the same function, and what reaches it.

With joint rates linear in the wanted velocity, ``qdot = G(q) v`` on the model's side and
``qdot = J(q)^-1 v_SI`` in Drake, they are the same exactly if ``P = J G`` does not depend on the
posture. P is then the model's unit (0.001 where it works in mm) and the order of its inputs.
Both are called at many postures.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import permutations

import numpy as np

from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.signals import Atom, Scalar, Signal, close, function_role, mixed
from drake_leg.simulink.compare.simulink_signals import SimulinkSignals
from drake_leg.simulink.matlab.program import Program
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.units import parse_unit

SAME = 1e-7  # relative, of functions that count as equal
LENGTH_UNITS = tuple(float(parse_unit(unit).factor) for unit in ("m", "cm", "mm", "in"))
POSTURES = 12
DRAWS = 400
SEED = 3
WORST_CONDITION = 40.0  # of the Jacobian at the postures that are tried
VELOCITY = 0.6  # in the function's unit, of the trials that tell rates from other outputs

Difference = tuple[str, object, object]  # parameter, Simulink's value, Drake's


@dataclass(frozen=True, kw_only=True)
class Slot:
    """One scalar input of the function."""

    port: str  # where it enters the first Mux before the function, or the function itself
    scalar: Scalar
    joint: int = 0  # whose position it takes; 0 for a part of the velocity
    factor: float = 1.0  # input = constant + factor * position
    constant: float = 0.0


Slots = list[list[Slot]]  # by input of the function


@dataclass(frozen=True, kw_only=True)
class Match:
    """How a MATLAB Function relates to the inverse Jacobian."""

    unit: float = 1.0  # [m] of the length unit in which it works
    velocity: Signal = ()  # the model's wanted velocity in SI, as Drake's block takes it
    ports: tuple[str, ...] = ()  # the model's inputs for these, where they are in that order
    names: dict[Atom, Atom] = field(default_factory=dict)  # its outputs -> what they are
    joints_from: dict[int, str] = field(default_factory=dict)  # joint -> "sensed", "integrated"
    differences: tuple[Difference, ...] = ()


def slots_of(signals: SimulinkSignals, sid: str, commanded: dict[int, Scalar]) -> Slots:
    """Sort a function's inputs into joint positions and parts of the velocity.

    ``commanded`` maps a joint to the scalar that is commanded to it, as the model writes it.
    """
    return [
        [
            _slot(scalar, signals.entry(f"{sid}#in:{place}", index), commanded)
            for index, scalar in enumerate(signals.input(sid, place) or ())
        ]
        for place in range(1, signals.codes[sid].inputs + 1)
    ]


def match_function(
    program: Program,
    sid: str,
    slots: Slots,
    block: InverseJacobian,
    commanded: dict[int, Scalar],
    *,
    rate_unit: float,
) -> Match:
    """Find out whether a MATLAB Function is the inverse Jacobian; its rates' unit is in rad/s."""
    probe = _Probe(program, sid, slots)
    invert = _inverse_of(block)
    size, parts = (int(block.GetInputPort(port).size()) for port in ("q", "v"))
    joints = {slot.joint for slot in probe.joints}
    postures = _postures(invert, size)
    if len(postures) == 0:
        nowhere = ("inverse", "not tried", "none at any posture that was tried")
        return Match(differences=(nowhere,))
    try:
        rates = probe.rates(postures) if joints and max(joints) <= size else []
        wanted = f"{size} joint positions and {parts} velocities in, {size} rates out"
        has = (
            f"{len(joints)} joint positions and {len(probe.velocity)} velocities in, "
            f"{len(rates)} rates out"
        )
        if has != wanted:
            return Match(differences=(("inputs and outputs", has, wanted),))
        if parts != size:
            return Match(differences=(("joint rates", "not tried", "the least of many"),))
        J = np.array([np.linalg.inv(invert(q)) for q in postures])
        return _compared(probe, J, postures, rates, commanded, rate_unit)
    except DrakeLegError as error:
        return Match(differences=(("code", str(error), "the inverse Jacobian"),))


class _Probe:
    """A MATLAB Function with its inputs sorted into joint positions and a velocity."""

    def __init__(self, program: Program, sid: str, slots: Slots) -> None:
        self._program, self._sid = program, sid
        self.slots = slots
        flat = [slot for row in slots for slot in row]
        self.velocity = [slot for slot in flat if slot.joint == 0]
        self.joints = [slot for slot in flat if slot.joint]
        self._trial = VELOCITY * np.linspace(1.0, 1.3, len(self.velocity))

    def wired(self, slots: Slots) -> _Probe:
        """Take the same function with its inputs wired otherwise."""
        return _Probe(self._program, self._sid, slots)

    def outputs(self, q: Array, v: Array) -> dict[Atom, float]:
        """Call the function; the velocity is in the function's units."""
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
        """Find the outputs that change with the velocity, in the function's order."""
        still = np.zeros(len(self.velocity))
        changing: set[Atom] = set()
        for q in postures[:3]:
            rest, moving = self.outputs(q, still), self.outputs(q, self._trial)
            changing |= {atom for atom in rest if rest[atom] != moving[atom]}
        return sorted(changing, key=lambda atom: (int(atom.what), atom.index))

    def others(self, postures: Array, rates: list[Atom]) -> dict[Atom, Array]:
        """Evaluate the outputs that are not rates: output -> (k,), at k postures."""
        called = [self.outputs(q, self._trial) for q in postures]
        return {
            atom: np.array([values[atom] for values in called])
            for atom in called[0]
            if atom not in rates
        }

    def matrices(self, postures: Array, rates: list[Atom]) -> Array:
        """Evaluate G of ``qdot = G v`` at k postures: (k, n, m)."""

        def at(q: Array, v: Array) -> Array:
            values = self.outputs(q, v)
            return np.array([values[atom] for atom in rates])

        found = []
        for q in postures:
            rest = at(q, np.zeros(len(self.velocity)))
            found.append(np.column_stack([at(q, v) - rest for v in np.eye(len(self.velocity))]))
        return np.array(found)


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


def _inverse_of(block: InverseJacobian) -> Callable[[Array], Array]:
    """Make a function of joint positions (n,) to ``J^-1`` (n, m) of the live block."""
    context = block.CreateDefaultContext()
    units = np.eye(block.GetInputPort("v").size())

    def inverse(q: Array) -> Array:
        block.GetInputPort("q").FixValue(context, q)
        columns = []
        for unit in units:
            block.GetInputPort("v").FixValue(context, unit)
            columns.append(np.array(block.GetOutputPort("qdot").Eval(context)))
        return np.column_stack(columns)

    return inverse


def _postures(invert: Callable[[Array], Array], size: int) -> Array:
    """Draw postures (k, n) [rad] at which the Jacobian is far from singular, as far as any are."""
    random = np.random.default_rng(SEED)
    found: list[tuple[float, Array]] = []
    for q in random.uniform(-2.5, 2.5, (DRAWS, size)):
        try:
            found.append((float(np.linalg.cond(invert(q))), q))
        except DrakeLegError:
            continue
        if sum(condition < WORST_CONDITION for condition, _ in found) == POSTURES:
            break
    best = sorted(found, key=lambda one: one[0])[:POSTURES]
    return np.array([q for _, q in best])


def _compared(
    probe: _Probe,
    J: Array,
    postures: Array,
    rates: list[Atom],
    commanded: dict[int, Scalar],
    rate_unit: float,
) -> Match:
    G = rate_unit * probe.matrices(postures, rates)
    found: list[Difference] = []
    if not _constant(J @ G):
        for difference, slots in _other_wirings(probe.slots, len(rates)):
            other = rate_unit * probe.wired(slots).matrices(postures, rates)
            if _constant(J @ other):
                found, G, probe = [difference], other, probe.wired(slots)
                break
    P = J @ G
    velocity: Signal = ()
    ports: tuple[str, ...] = ()
    units = _units(P)
    if _constant(P):
        mean = P.mean(axis=0)
        mean[np.abs(mean) < SAME * np.abs(mean).max()] = 0.0
    else:
        mean = np.diag(units)
        found += _entries(units, G, J, postures)
    if 2 * len(found) <= J[0].size:
        velocity = mixed(mean, tuple(slot.scalar for slot in probe.velocity))
        straight = not np.any(mean - np.diag(np.diag(mean)))
        ports = tuple(slot.port for slot in probe.velocity) if straight else ()
    else:
        found = [("joint rates", "of another law", "those of the inverse Jacobian")]
    names = {atom: function_role("qdot", index) for index, atom in enumerate(rates)}
    for atom, values in probe.others(postures, rates).items():
        sign = _determinant_sign(values, np.linalg.det(G))
        sign = sign or _determinant_sign(values, 1.0 / np.linalg.det(J))
        if sign:
            names[atom] = function_role("det J")
        if sign < 0:
            found.append(("sign of the determinant", "negative", "positive"))
    return Match(
        unit=float(units[0]),
        velocity=velocity,
        ports=ports,
        names=names,
        joints_from={
            slot.joint: "integrated" if slot.scalar == commanded.get(slot.joint) else "sensed"
            for slot in probe.joints
        },
        differences=tuple(found),
    )


def _constant(P: Array) -> bool:
    """Tell whether a matrix is the same at all postures."""
    if not np.isfinite(P).all() or not P.any():
        return False
    return bool(np.abs(P - P[0]).max() <= SAME * np.abs(P).max())


def _other_wirings(slots: Slots, size: int) -> list[tuple[Difference, Slots]]:
    """List what may be wrong before a right function: an angle's unit, the joints' order."""
    found: list[tuple[Difference, Slots]] = []
    scaled = {s.joint: s.factor for row in slots for s in row if s.joint and s.factor != 1.0}
    if scaled:
        plain = [
            [replace(s, factor=1.0, constant=0.0) if s.joint else s for s in row] for row in slots
        ]
        factors = tuple(scaled.get(joint, 1.0) for joint in range(1, size + 1))
        found.append((("factors of the joint positions", factors, (1.0,) * size), plain))
    right = tuple(range(1, size + 1))
    for order in list(permutations(right))[1:]:
        swapped = [
            [replace(s, joint=order[s.joint - 1]) if s.joint else s for s in row] for row in slots
        ]
        wired = tuple(order.index(joint) + 1 for joint in right)
        found.append((("joints at its inputs", wired, right), swapped))
    return found


def _entries(units: Array, G: Array, J: Array, postures: Array) -> list[Difference]:
    """Name the entries of the model's Jacobian that are not Drake's, each at its worst posture."""
    if not np.isfinite(G).all() or min(np.abs(np.linalg.det(G))) == 0.0:
        return [("joint rates", "singular or not finite", "regular")]
    ours = units[:, np.newaxis] * np.linalg.inv(G)
    wrong = (np.abs(ours - J) > SAME * np.abs(J).max()).any(axis=0)
    found: list[Difference] = []
    for row, column in np.argwhere(wrong):
        worst = int(np.argmax(np.abs(ours[:, row, column] - J[:, row, column])))
        posture = ", ".join(f"{angle:.6g}" for angle in postures[worst])
        name = f"J({row + 1},{column + 1}) at q = ({posture}) rad [SI]"
        found.append((name, float(ours[worst, row, column]), float(J[worst, row, column])))
    return found


def _units(P: Array) -> Array:
    """Find the unit of each part of the velocity; the likeliest one where P varies."""
    count = P.shape[1]
    if not np.isfinite(P).all() or P.shape[2] != count:
        return np.ones(count)
    found = []
    for row in range(count):
        size = float(np.median(np.abs(P[:, row, :]).max(axis=1)))
        exact = (unit for unit in LENGTH_UNITS if size and close(round(size / unit, 7), 1.0))
        diagonal = max(float(np.median(np.abs(P[:, row, row]))), 1e-300)
        nearest = min(LENGTH_UNITS, key=lambda unit: abs(np.log(diagonal / unit)))
        found.append(next(exact, size if _constant(P) else nearest))
    return np.array(found)


def _determinant_sign(values: Array, inverses: Array) -> int:
    """Tell whether values are a determinant in some unit: 1, or -1 with the other sign; else 0."""
    ratio = values * inverses
    if not np.isfinite(ratio).all() or ratio[0] == 0.0:
        return 0
    return int(np.sign(ratio[0])) * bool(np.ptp(ratio) <= SAME * abs(ratio[0]))
