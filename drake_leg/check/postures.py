"""Random postures at which a print is compared: what its symbols are, and the robot's joints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_leg.check.expressions import evaluate, names_in
from drake_leg.check.reader import Reader
from drake_leg.check.sampling import table_length
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

COUNT = 8  # postures; two formulas that agree on all of them are the same


@dataclass(frozen=True, kw_only=True)
class Postures:
    """Values of a print's symbols and the joint positions that belong to them."""

    values: Mapping[str, Any]  # symbol to number or (N,) array; angles in rad, lengths as printed
    variables: tuple[str, ...]  # those of the symbols that vary
    q: Array  # (N, m) joint positions [rad or m]
    metres: float  # [m] of the print's unit of lengths

    def at(self, index: int) -> str:
        """Say the variables at one posture.

        Returns
        -------
        str
            Angles in rad, lengths as printed.
        """
        return ", ".join(f"{name} = {self.values[name][index]:.3g}" for name in self.variables)


def draw_postures(robot: Robot, reader: Reader, rng: np.random.Generator) -> Postures:
    """Draw the print's variables at random and follow them to the joints.

    Parameters
    ----------
    robot : Robot
        Of which m rows move.
    reader : Reader
        Of the print: its symbols, units and the joints' formulas.

    Raises
    ------
    InvalidValueError
        If a joint's formula has no value.
    """
    metres = 1.0 / reader.units["m"]
    values: dict[str, Any] = {**reader.units, **reader.symbols}
    length = table_length(robot.rows) / metres
    variables, positions = [], []
    joints: dict[str, Any] = {}  # q4 where the print writes another variable's formula for it
    for index, segment in enumerate(robot.moving):
        turning = segment.row.joint == "revolute"
        greatest = math.pi if turning else length
        formula = reader.joints.get(index)
        names = {f"q{index + 1}"} if formula is None else names_in(formula) - set(values)
        for name in sorted(names):
            values[name] = rng.uniform(-greatest, greatest, COUNT)
            variables.append(name)
        printed = values[f"q{index + 1}"] if formula is None else evaluate(formula, values)
        joints[f"q{index + 1}"] = np.broadcast_to(printed, COUNT)
        positions.append(np.broadcast_to(printed, COUNT) * (1.0 if turning else metres))
    return Postures(
        values={**joints, **values},
        variables=tuple(variables),
        q=np.stack(positions, axis=-1),
        metres=metres,
    )
