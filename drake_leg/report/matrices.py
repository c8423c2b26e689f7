"""The reports' transforms, Jacobians and determinants, evaluated by three independent ways.

The corrected formulas in closed form, the chain of the Khalil table, and Drake's plant on the
SDF: each is compared with the other two.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import Context

from drake_leg.errata.formulas import Formula, evaluate, evaluate_entry
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import base_transforms, jacobian
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.models.plant import build_plant
from drake_leg.report.formulas import (
    LEG_DETERMINANT,
    LEG_JACOBIAN,
    LEG_TRANSFORMS,
    SCARA_DETERMINANT,
    SCARA_JACOBIAN,
    SCARA_TRANSFORMS,
    leg_symbols,
    scara_symbols,
)
from drake_leg.robot import Robot


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One matrix: its formula, its value, and how far the other two ways are from it."""

    name: str
    formula: Formula
    value: Array
    from_chain: float  # greatest difference of an entry
    from_drake: float


def leg_comparisons(robot: Robot, q: Sequence[float]) -> list[Comparison]:
    """Compare all matrices of a leg at a posture.

    Parameters
    ----------
    robot : Robot
        Leg A or B.
    q : (3,) sequence of float
        Angles [rad].

    Returns
    -------
    list of Comparison
        Transforms between neighbours and to the base, Jacobian, determinant.
    """
    symbols = leg_symbols(LegGeometry.from_robot(robot), q)
    witness = _Witness(robot, q)
    rows = slice(3, 6)
    compared = [witness.transform(n, f, evaluate(f, symbols)) for n, f in LEG_TRANSFORMS.items()]
    compared.append(
        _compare(
            "J",
            LEG_JACOBIAN,
            evaluate(LEG_JACOBIAN, symbols),
            witness.chain_jacobian[rows],
            witness.drake_jacobian[rows],
        )
    )
    determinant = np.array([[evaluate_entry(LEG_DETERMINANT, symbols)]])
    compared.append(
        _compare(
            "det J",
            ((LEG_DETERMINANT,),),
            determinant,
            np.linalg.det(witness.chain_jacobian[rows]),
            np.linalg.det(witness.drake_jacobian[rows]),
        )
    )
    return compared


def scara_comparisons(robot: Robot, q: Sequence[float]) -> list[Comparison]:
    """Compare all matrices of the SCARA at a posture.

    Parameters
    ----------
    robot : Robot
        The SCARA.
    q : (4,) sequence of float
        Three angles [rad] and the lift [m].

    Returns
    -------
    list of Comparison
        Transforms between neighbours and to the base, Jacobian of (x, y, yaw), determinant.
    """
    symbols = scara_symbols(ScaraGeometry.from_robot(robot), q)
    witness = _Witness(robot, q)
    rows = [3, 4, 2]  # vx, vy, yaw rate
    chain, drake = witness.chain_jacobian[rows, :3], witness.drake_jacobian[rows, :3]
    compared = [witness.transform(n, f, evaluate(f, symbols)) for n, f in SCARA_TRANSFORMS.items()]
    compared.append(_compare("J", SCARA_JACOBIAN, evaluate(SCARA_JACOBIAN, symbols), chain, drake))
    determinant = np.array([[evaluate_entry(SCARA_DETERMINANT, symbols)]])
    compared.append(
        _compare(
            "det J",
            ((SCARA_DETERMINANT,),),
            determinant,
            np.linalg.det(chain),
            np.linalg.det(drake),
        )
    )
    return compared


class _Witness:
    """What the chain and Drake say at one posture."""

    def __init__(self, robot: Robot, q: Sequence[float]) -> None:
        plant = build_plant(robot)
        context = plant.CreateDefaultContext()
        plant.SetPositions(context, np.asarray(q))
        self._plant, self._context = plant, context
        self._chain = [np.eye(4), *base_transforms(robot.rows, q)]
        self.chain_jacobian = jacobian(robot.rows, q)
        self.drake_jacobian = _drake_jacobian(plant, context, len(robot.rows))

    def transform(self, name: str, formula: Formula, value: Array) -> Comparison:
        """Compare the transform ``Tij``, from frame j to frame i."""
        i, j = (int(digit) for digit in re.findall(r"\d", name))
        chain = np.linalg.solve(self._chain[i], self._chain[j])
        frame_i, frame_j = (self._plant.GetFrameByName(f"frame_{k}") for k in (i, j))
        drake = self._plant.CalcRelativeTransform(self._context, frame_i, frame_j)
        return _compare(name, formula, value, chain, drake.GetAsMatrix4())


def _drake_jacobian(plant: MultibodyPlant, context: Context, last: int) -> Array:
    base, foot = plant.GetFrameByName("frame_0"), plant.GetFrameByName(f"frame_{last}")
    spatial: Array = plant.CalcJacobianSpatialVelocity(
        context, JacobianWrtVariable.kQDot, foot, np.zeros(3), base, base
    )
    return spatial


def _compare(name: str, formula: Formula, value: Array, chain: Array, drake: Array) -> Comparison:
    return Comparison(
        name=name,
        formula=formula,
        value=value,
        from_chain=float(np.abs(value - chain).max()),
        from_drake=float(np.abs(value - drake).max()),
    )
