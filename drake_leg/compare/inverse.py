"""Whether a MATLAB Function and the inverse Jacobian block are the same function.

With joint rates linear in the wanted velocity, ``qdot = G(q) v`` on the model's side and
``qdot = J(q)^-1 v_SI`` in Drake, they are the same exactly if ``P = J G`` does not depend on the
posture. P is then the model's unit (0.001 where it works in mm) and the order of its inputs.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import permutations

import numpy as np

from drake_leg.compare.correspondence import function_role
from drake_leg.compare.function_probe import FunctionProbe, LiveInverse, Slots, slots_of
from drake_leg.compare.signals import Atom, Scalar, Signal, close, mixed
from drake_leg.compare.simulink_signals import SimulinkSignals
from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.batches import Array
from drake_leg.systems.inverse_jacobian import InverseJacobian

SAME = 1e-7  # relative, of functions that count as equal
LENGTH_UNITS = {1.0: "m", 0.01: "cm", 0.001: "mm", 0.0254: "in"}

Finding = tuple[str, object, object]  # parameter, Simulink's value, Drake's


@dataclass(frozen=True, kw_only=True)
class Match:
    """How a MATLAB Function stands to the inverse Jacobian."""

    unit: float = 1.0  # [m] of the length unit in which it works
    velocity: Signal = ()  # the model's wanted velocity in SI, as Drake's block takes it
    ports: tuple[str, ...] = ()  # the model's inputs for these, where they are in that order
    names: dict[Atom, Atom] = field(default_factory=dict)  # its outputs -> what they are
    joints_from: dict[int, str] = field(default_factory=dict)  # joint -> "sensed", "integrated"
    findings: tuple[Finding, ...] = ()


def match_function(
    signals: SimulinkSignals,
    sid: str,
    block: InverseJacobian,
    commanded: dict[int, Scalar],
    *,
    rate_unit: float = 1.0,
) -> Match:
    """Find out whether a MATLAB Function is the inverse Jacobian.

    Parameters
    ----------
    sid : str
        Of the function's block.
    commanded : dict
        Joint -> the scalar that is commanded to it, as the model writes it.
    rate_unit : float
        Value in rad/s of the unit of the function's rates.
    """
    probe = FunctionProbe(signals, sid, slots_of(signals, sid, commanded))
    live = LiveInverse(block)
    joints = {slot.joint for slot in probe.joints}
    postures = live.postures()
    if len(postures) == 0:
        return Match(findings=(("inverse", "not tried", "none at any posture that was tried"),))
    try:
        rates = probe.rates(postures) if joints and max(joints) <= live.size else []
        wanted = (
            f"{live.size} joint positions and {live.commanded} velocities in, {live.size} rates out"
        )
        has = (
            f"{len(joints)} joint positions and {len(probe.velocity)} velocities in, "
            f"{len(rates)} rates out"
        )
        if has != wanted:
            return Match(findings=(("inputs and outputs", has, wanted),))
        if live.commanded != live.size:
            return Match(findings=(("joint rates", "not tried", "the least of many"),))
        return _compared(probe, live, postures, rates, commanded, rate_unit)
    except DrakeLegError as error:
        return Match(findings=(("code", str(error), "the inverse Jacobian"),))


def _compared(
    probe: FunctionProbe,
    live: LiveInverse,
    postures: Array,
    rates: list[Atom],
    commanded: dict[int, Scalar],
    rate_unit: float,
) -> Match:
    J = np.array([np.linalg.inv(live.inverse(q)) for q in postures])
    G = rate_unit * probe.matrices(postures, rates)
    findings: list[Finding] = []
    if not _constant(J @ G):
        for finding, slots in _other_wirings(probe.slots, live.size):
            other = rate_unit * probe.wired(slots).matrices(postures, rates)
            if _constant(J @ other):
                findings, G, probe = [finding], other, probe.wired(slots)
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
        findings += _entries(units, G, J, postures)
    if 2 * len(findings) <= J[0].size:
        velocity = mixed(mean, tuple(slot.scalar for slot in probe.velocity))
        straight = not np.any(mean - np.diag(np.diag(mean)))
        ports = tuple(slot.port for slot in probe.velocity) if straight else ()
    else:
        findings = [("joint rates", "of another law", "those of the inverse Jacobian")]
    names = {atom: function_role("qdot", index) for index, atom in enumerate(rates)}
    for atom, values in probe.others(postures, rates).items():
        sign = _determinant_sign(values, G) or _determinant_sign(values, np.linalg.inv(J))
        if sign:
            names[atom] = function_role("det J")
        if sign < 0:
            findings.append(("sign of the determinant", "negative", "positive"))
    return Match(
        unit=float(units[0]),
        velocity=velocity,
        ports=ports,
        names=names,
        joints_from={
            slot.joint: "integrated" if slot.scalar == commanded.get(slot.joint) else "sensed"
            for slot in probe.joints
        },
        findings=tuple(findings),
    )


def _constant(P: Array) -> bool:
    """Tell whether a matrix is the same at all postures."""
    if not np.isfinite(P).all() or not P.any():
        return False
    return bool(np.abs(P - P[0]).max() <= SAME * np.abs(P).max())


def _other_wirings(slots: Slots, size: int) -> list[tuple[Finding, Slots]]:
    """List what may be wrong before a right function: an angle's unit, the joints' order."""
    found: list[tuple[Finding, Slots]] = []
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


def _entries(units: Array, G: Array, J: Array, postures: Array) -> list[Finding]:
    """Name the entries of the model's Jacobian that are not Drake's, each at its worst posture."""
    if not np.isfinite(G).all() or min(np.abs(np.linalg.det(G))) == 0.0:
        return [("joint rates", "singular or not finite", "regular")]
    ours = units[:, np.newaxis] * np.linalg.inv(G)
    wrong = (np.abs(ours - J) > SAME * np.abs(J).max()).any(axis=0)
    findings: list[Finding] = []
    for row, column in np.argwhere(wrong):
        worst = int(np.argmax(np.abs(ours[:, row, column] - J[:, row, column])))
        posture = ", ".join(f"{angle:.6g}" for angle in postures[worst])
        name = f"J({row + 1},{column + 1}) at q = ({posture}) rad [SI]"
        findings.append((name, float(ours[worst, row, column]), float(J[worst, row, column])))
    return findings


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
        distance = {unit: abs(np.log(diagonal / unit)) for unit in LENGTH_UNITS}
        nearest = min(distance, key=distance.__getitem__)
        found.append(next(exact, size if _constant(P) else nearest))
    return np.array(found)


def _determinant_sign(values: Array, inverse: Array) -> int:
    """Tell whether values are a determinant in some unit: 1, or -1 with the other sign; else 0."""
    ratio = values * np.linalg.det(inverse)
    if not np.isfinite(ratio).all() or ratio[0] == 0.0:
        return 0
    return int(np.sign(ratio[0])) * bool(np.ptp(ratio) <= SAME * abs(ratio[0]))
