"""The reports' matrices, evaluated in three independent ways.

The formulas that SymPy derives, the chain of the Khalil table in numbers, and Drake's plant on the
SDF: the first is compared with the other two.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import Context

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import (
    base_transforms,
    jacobian,
    jacobian_by_differentiation,
    row_transform,
)
from drake_leg.models.plant import build_plant
from drake_leg.lab.page.contents import PosedRobot
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.catalogue import derived
from drake_leg.symbolic.chain import evaluate
from drake_leg.symbolic.equations import general_transform, matrices

POSTURES = 1000  # at which the two Jacobians are compared
TRANSFORM, CONTRIBUTION = re.compile(r"T(\d)(\d)"), re.compile(r"V(\d)")


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One matrix: its formula, its value, and how far the other two ways are from it."""

    formula: sp.Matrix
    value: Array | None  # None where it belongs to no posture
    from_chain: float  # greatest difference of an entry
    from_drake: float


@dataclass(frozen=True, kw_only=True)
class BothMethods:
    """The Jacobian of a task by the direct and by the indirect method."""

    direct: Array  # at the subject's posture
    indirect: Array
    difference: float  # greatest of an entry, at ``POSTURES`` random postures


def comparisons(subject: PosedRobot) -> Mapping[str, Comparison]:
    """Compare all matrices of a leg or the SCARA at its posture, by their names.

    The names are T, T01 ..., V1 ..., P, J, J⁻¹, det J, det J expanded.
    """
    robot, q, chain = subject.robot, subject.q, derived(subject.name).chain
    values = {symbol.name: value for symbol, value in chain.values.items()}
    values |= {symbol.name: value for symbol, value in zip(chain.q, q, strict=True)}
    witness = _Witness(robot, q)
    found = {"T": _row_comparison(robot, witness)}
    for name, formula in matrices(derived(subject.name)).items():
        if name == "T":
            continue
        by_chain, by_drake = (
            side(name, subject.task) for side in (witness.by_chain, witness.by_drake)
        )
        value = evaluate(formula, values)
        found[name] = Comparison(
            formula=formula,
            value=value,
            from_chain=float(np.abs(value - by_chain).max()),
            from_drake=float(np.abs(value - by_drake).max()),
        )
    return found


def methods(subject: PosedRobot) -> BothMethods:
    """Compare the direct with the indirect method, for a leg or the SCARA."""
    rows = subject.robot.rows
    size = len(subject.task)
    random = np.random.default_rng(0).uniform(-np.pi, np.pi, (POSTURES, len(subject.q)))
    difference = jacobian(rows, random) - jacobian_by_differentiation(rows, random)
    direct, indirect = (
        method(rows, subject.q)[list(subject.task), :size]
        for method in (jacobian, jacobian_by_differentiation)
    )
    return BothMethods(direct=direct, indirect=indirect, difference=float(np.abs(difference).max()))


def _row_comparison(robot: Robot, witness: _Witness) -> Comparison:
    """Compare the general transform, with the numbers of every row of the table."""
    formula = general_transform()
    from_chain = from_drake = 0.0
    position = 0
    for number, row in enumerate(robot.rows, start=1):
        q = 0.0
        if row.joint != "fixed":
            q, position = witness.q[position], position + 1
        r = row.r + q * (row.joint == "prismatic")
        theta = row.theta + q * (row.joint == "revolute")
        value = evaluate(formula, {"d": row.d, "alpha": row.alpha, "r": r, "theta": theta})
        drake = witness.by_drake(f"T{number - 1}{number}", ())
        from_chain = max(from_chain, float(np.abs(value - row_transform(row, q)).max()))
        from_drake = max(from_drake, float(np.abs(value - drake).max()))
    return Comparison(formula=formula, value=None, from_chain=from_chain, from_drake=from_drake)


class _Witness:
    """What the chain and Drake say at one posture."""

    def __init__(self, robot: Robot, q: Sequence[float]) -> None:
        plant = build_plant(robot)
        context = plant.CreateDefaultContext()
        plant.SetPositions(context, np.asarray(q))
        self.q = q
        self._plant, self._context = plant, context
        self._chain = [np.eye(4), *base_transforms(robot.rows, q)]
        self._last = len(robot.rows)
        self._jacobians = (
            jacobian(robot.rows, q),
            _drake_jacobian(plant, context, self._last),
        )

    def by_chain(self, name: str, task: Sequence[int]) -> Array:
        """Evaluate a matrix from the chain of the table."""
        found = TRANSFORM.fullmatch(name)
        if found:
            i, j = map(int, found.groups())
            return np.asarray(np.linalg.solve(self._chain[i], self._chain[j]), dtype=float)
        if name == "P":
            return np.asarray(self._chain[-1][:3, 3:])
        return _of_jacobian(name, self._jacobians[0][list(task), : len(task)])

    def by_drake(self, name: str, task: Sequence[int]) -> Array:
        """Evaluate a matrix from Drake's plant."""
        found = TRANSFORM.fullmatch("T0" + str(self._last) if name == "P" else name)
        if found:
            frame_i, frame_j = (self._plant.GetFrameByName(f"frame_{k}") for k in found.groups())
            X_ij = self._plant.CalcRelativeTransform(self._context, frame_i, frame_j).GetAsMatrix4()
            return np.asarray(X_ij[:3, 3:] if name == "P" else X_ij)
        return _of_jacobian(name, self._jacobians[1][list(task), : len(task)])


def _of_jacobian(name: str, J: Array) -> Array:
    """Evaluate what follows from a Jacobian."""
    column = CONTRIBUTION.fullmatch(name)
    if column:
        joint = int(column[1])
        return J[:, joint - 1 : joint]
    if name == "J⁻¹":
        return np.asarray(np.linalg.inv(J), dtype=float)
    return J if name == "J" else np.array([[np.linalg.det(J)]])


def _drake_jacobian(plant: MultibodyPlant, context: Context, last: int) -> Array:
    base, foot = plant.GetFrameByName("frame_0"), plant.GetFrameByName(f"frame_{last}")
    spatial: Array = plant.CalcJacobianSpatialVelocity(
        context, JacobianWrtVariable.kQDot, foot, np.zeros(3), base, base
    )
    return spatial
