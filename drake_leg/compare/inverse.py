"""A MATLAB Function beside the inverse Jacobian block: both are called, at many postures.

With joint rates linear in the wanted velocity, ``qdot = G(q) v`` on the model's side and
``qdot = J(q)^-1 v_SI`` in Drake, the two are the same function exactly if ``P = J G`` does not
depend on the posture. P is then the model's unit (0.001 where it works in mm) and the order of
its inputs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from drake_leg.compare.signals import Atom, Scalar, Signal, close, mixed
from drake_leg.compare.simulink_signals import SimulinkSignals
from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.batches import Array
from drake_leg.systems.inverse_jacobian import InverseJacobian

POSTURES = 12
SEED = 3
WORST_CONDITION = 40.0  # of the Jacobian at the postures that are tried
SAME = 1e-7  # relative, of functions that count as equal
LENGTH_UNITS = {1.0: "m", 0.01: "cm", 0.001: "mm", 0.0254: "in"}


@dataclass(frozen=True, kw_only=True)
class Slot:
    """One scalar input of the function."""

    joint: int  # whose position it takes; 0 for a part of the velocity
    factor: float  # input = constant + factor * position
    constant: float
    scalar: Scalar


@dataclass(frozen=True, kw_only=True)
class Match:
    """How a MATLAB Function stands to the inverse Jacobian."""

    same: bool
    unit: float  # [m] of the length unit in which it works
    velocity: Signal  # the model's wanted velocity in SI, as Drake's block takes it
    names: dict[Atom, Atom]  # its outputs -> what they are
    joints_from: dict[int, str]  # joint -> "sensed" or "integrated"
    findings: tuple[tuple[str, object, object], ...]  # parameter, Simulink's value, Drake's


def match_function(
    signals: SimulinkSignals,
    sid: str,
    block: InverseJacobian,
    rates: list[Atom],
    commanded: dict[int, Scalar],
) -> Match:
    """Find out whether a MATLAB Function is the inverse Jacobian.

    Parameters
    ----------
    signals : SimulinkSignals
        Of the model.
    sid : str
        Of the function's block.
    block : InverseJacobian
        The live one.
    rates : list of Atom
        The function's outputs that are integrated into joint positions, in their own order.
    commanded : dict
        Joint -> the scalar that is commanded to it, as the model writes it.

    Returns
    -------
    Match
    """
    slots = _slots(signals, sid, commanded)
    velocity = [slot for row in slots for slot in row if slot.joint == 0]
    turned = {slot.joint for row in slots for slot in row if slot.joint}
    joints_from = {
        slot.joint: "integrated" if slot.scalar == commanded.get(slot.joint) else "sensed"
        for row in slots
        for slot in row
        if slot.joint
    }
    size = block.GetInputPort("q").size()
    names = {atom: _role("qdot", index) for index, atom in enumerate(rates)}

    def unequal(*findings: tuple[str, object, object], P: Array | None = None) -> Match:
        return Match(
            same=False,
            unit=_unit(P),
            velocity=_in_si(P, velocity),
            names=names,
            joints_from=joints_from,
            findings=findings,
        )

    if len(rates) != size or turned != set(range(1, size + 1)) or not velocity:
        takes = f"joints {sorted(turned)} and {len(velocity)} velocities, gives {len(rates)} rates"
        wanted = f"joints {list(range(1, size + 1))} and {size} velocities, gives {size} rates"
        return unequal(("inputs and outputs", takes, wanted))
    postures = _postures(block, size)
    findings: list[tuple[str, object, object]] = []
    try:
        P, G, J = _products(signals, sid, block, slots, rates, postures)
        if not _constant(P):
            order, P, G, J = _reordered(signals, sid, block, slots, rates, postures, (P, G, J))
            if order:
                findings.append(("joints at its inputs", order, tuple(range(1, size + 1))))
    except DrakeLegError as error:
        return unequal(("code", str(error), "inverse Jacobian"))
    if not np.isfinite(P).all() or not P.any():
        return unequal(("joint rates", "not finite", "finite"))
    if not _constant(P):
        nominal = _nominal(P)
        return unequal(*_entries(nominal, G, J, postures), P=nominal)
    scale = float(np.abs(P).max())
    mean = P.mean(axis=0)
    mean[np.abs(mean) < SAME * scale] = 0.0
    unit = _unit(mean)
    names |= _determinants(signals, sid, block, slots, postures, rates, unit)
    return Match(
        same=not findings,
        unit=unit,
        velocity=_in_si(mean, velocity),
        names=names,
        joints_from=joints_from,
        findings=tuple(findings),
    )


def _role(what: str, index: int = 0) -> Atom:
    return Atom(kind="function", of="inverse Jacobian", what=what, index=index)


def _slots(signals: SimulinkSignals, sid: str, commanded: dict[int, Scalar]) -> list[list[Slot]]:
    """Sort the function's inputs into joint positions and parts of the velocity."""
    rows = []
    for place in range(1, len(signals.programs[sid].inputs) + 1):
        row = []
        for scalar in signals.input(sid, place) or ():
            row.append(_slot(scalar, commanded))
        rows.append(row)
    return rows


def _slot(scalar: Scalar, commanded: dict[int, Scalar]) -> Slot:
    for joint, command in commanded.items():
        if scalar == command:
            return Slot(joint=joint, factor=1.0, constant=0.0, scalar=scalar)
    if len(scalar.terms) == 1:
        ((atom, factor),) = scalar.terms.items()
        if atom.kind == "sensed" and atom.what == "position":
            return Slot(joint=int(atom.of), factor=factor, constant=scalar.constant, scalar=scalar)
    return Slot(joint=0, factor=1.0, constant=0.0, scalar=scalar)


def _postures(block: InverseJacobian, size: int) -> Array:
    """Draw postures at which the live Jacobian is far from singular."""
    random = np.random.default_rng(SEED)
    found: list[Array] = []
    while len(found) < POSTURES:
        q = random.uniform(-2.5, 2.5, size)
        try:
            inverse = _live_inverse(block, q)
        except DrakeLegError:
            continue
        if np.linalg.cond(inverse) < WORST_CONDITION:
            found.append(q)
    return np.array(found)


def _live_inverse(block: InverseJacobian, q: Array) -> Array:
    context = block.CreateDefaultContext()
    block.GetInputPort("q").FixValue(context, q)
    columns = []
    for unit in np.eye(block.GetInputPort("v").size()):
        block.GetInputPort("v").FixValue(context, unit)
        columns.append(np.array(block.GetOutputPort("qdot").Eval(context)))
    return np.column_stack(columns)


def _call(
    signals: SimulinkSignals, sid: str, slots: list[list[Slot]], q: Array, v: Array
) -> list[Array]:
    """Call the function with joint positions and a velocity; all outputs."""
    parts = iter(v.tolist())
    arguments = [
        [
            slot.constant + slot.factor * q[slot.joint - 1] if slot.joint else next(parts)
            for slot in row
        ]
        for row in slots
    ]
    return list(signals.programs[sid].call(*arguments))


def _products(
    signals: SimulinkSignals,
    sid: str,
    block: InverseJacobian,
    slots: list[list[Slot]],
    rates: list[Atom],
    postures: Array,
) -> tuple[Array, Array, Array]:
    """Stack ``P = J G``, G and J over the postures."""
    parts = sum(slot.joint == 0 for row in slots for slot in row)
    products, ours, theirs = [], [], []
    for q in postures:

        def at(v: Array, q: Array = q) -> Array:
            results = _call(signals, sid, slots, q, v)
            return np.array([results[int(atom.what) - 1][atom.index] for atom in rates])

        rest = at(np.zeros(parts))
        G = np.column_stack([at(unit) - rest for unit in np.eye(parts)])
        J = np.linalg.inv(_live_inverse(block, q))
        products.append(J @ G)
        ours.append(G)
        theirs.append(J)
    return np.array(products), np.array(ours), np.array(theirs)


def _constant(P: Array) -> bool:
    """Tell whether a matrix is the same at all postures."""
    if not np.isfinite(P).all():
        return False
    return bool(np.abs(P - P[0]).max() <= SAME * max(float(np.abs(P).max()), 1e-300))


def _reordered(
    signals: SimulinkSignals,
    sid: str,
    block: InverseJacobian,
    slots: list[list[Slot]],
    rates: list[Atom],
    postures: Array,
    found: tuple[Array, Array, Array],
) -> tuple[tuple[int, ...], Array, Array, Array]:
    """Try whether the function is right once the joints at its inputs change places."""
    for order in list(permutations(range(1, postures.shape[1] + 1)))[1:]:
        swapped = [
            [replace(slot, joint=order[slot.joint - 1]) if slot.joint else slot for slot in row]
            for row in slots
        ]
        products = _products(signals, sid, block, swapped, rates, postures)
        if _constant(products[0]):
            wired = tuple(order.index(joint) + 1 for joint in range(1, len(order) + 1))
            return (wired, *products)
    return ((), *found)


def _nominal(P: Array) -> Array | None:
    """Return the length unit that a wrong function most likely works in, as a matrix."""
    if P.shape[1] != P.shape[2]:
        return None
    diagonal = float(np.median(np.abs(np.diagonal(P, axis1=1, axis2=2))))
    unit = min(LENGTH_UNITS, key=lambda u: abs(np.log(max(diagonal, 1e-300) / u)))
    return unit * np.eye(P.shape[1])


def _entries(
    nominal: Array | None, G: Array, J: Array, postures: Array
) -> list[tuple[str, object, object]]:
    """Name the entries of the model's Jacobian that are not Drake's, each at its worst posture."""
    if nominal is None:
        return [("joint rates", "not those of the Jacobian", "inverse Jacobian")]
    try:
        ours = nominal @ np.linalg.inv(G)
    except np.linalg.LinAlgError:
        return [("Jacobian", "singular", "regular")]
    scale = np.abs(J).max()
    findings: list[tuple[str, object, object]] = []
    for row, column in np.argwhere((np.abs(ours - J) > SAME * scale).any(axis=0)):
        worst = int(np.argmax(np.abs(ours[:, row, column] - J[:, row, column])))
        posture = ", ".join(f"{angle:.6g}" for angle in postures[worst])
        findings.append(
            (
                f"J({row + 1},{column + 1}) at q = ({posture}) rad [m/rad]",
                float(ours[worst, row, column]),
                float(J[worst, row, column]),
            )
        )
    return findings


def _unit(P: Array | None) -> float:
    if P is None:
        return 1.0
    scale = float(np.abs(P).max())
    return next((unit for unit in LENGTH_UNITS if close(round(scale / unit, 9), 1.0)), scale)


def _in_si(P: Array | None, velocity: list[Slot]) -> Signal:
    scalars = tuple(slot.scalar for slot in velocity)
    if P is None:
        return scalars

    return mixed(P, scalars)


def _determinants(
    signals: SimulinkSignals,
    sid: str,
    block: InverseJacobian,
    slots: list[list[Slot]],
    postures: Array,
    rates: list[Atom],
    unit: float,
) -> dict[Atom, Atom]:
    """Find the outputs that are the Jacobian's determinant, in whatever unit."""
    parts = sum(slot.joint == 0 for row in slots for slot in row)
    context = block.CreateDefaultContext()
    live, called = [], []
    for q in postures:
        block.GetInputPort("q").FixValue(context, q)
        live.append(float(block.GetOutputPort("det_j").Eval(context)[0]))
        called.append(_call(signals, sid, slots, q, np.linspace(0.5, 0.7, parts)))
    found = {}
    for place, values in enumerate(called[0], start=1):
        for index in range(len(values)):
            atom = Atom(kind="function", of=sid, what=str(place), index=index)
            ratio = np.array([row[place - 1][index] for row in called]) / np.array(live)
            positive = bool(np.isfinite(ratio).all() and ratio[0] > 0.0)
            if atom not in rates and positive and np.ptp(ratio) <= SAME * ratio[0]:
                found[atom] = _role("det J")
    return found
