"""Lists the errata: their texts from ``errata.toml``, with computed numbers filled in."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from string import Formatter
from typing import Any

import numpy as np

from drake_leg.kinematics.khalil import Array, foot_pose
from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.robot.robot import Row
from drake_leg.robot.toml_reader import ClassicRow, khalil_rows
from drake_leg.runs.options import LegBOptions

Values = Mapping[str, Any]  # numbers, vectors and texts, by their names in errata.toml
Effects = Mapping[int, Callable[[], Values]]  # by the errata's numbers


@dataclass(frozen=True, kw_only=True)
class Erratum:
    """One error of a report."""

    number: int  # 1 to 25 through both reports, from 26 through both again
    source: str  # the report
    where: str  # section, equation, table or figure there
    printed: str  # what it prints: text in quotation marks, a formula without
    right: str  # what it should print
    effect: str  # a sentence on the error's effect, with computed numbers


class _Filled(Formatter):
    """Formats numbers and vectors with a number of decimals, 1 by default; texts unchanged."""

    def format_field(self, value: Any, format_spec: str) -> str:  # noqa: ANN401
        if isinstance(value, str):
            return value
        write = vector if isinstance(value, Iterable) else number
        return write(value, int(format_spec or 1))


def filled(sentence: str, values: Values) -> str:
    """Fill values into a sentence of ``errata.toml``."""
    return _Filled().vformat(sentence, (), values)


def number(value: float, decimals: int = 1) -> str:
    """Write a number with a true minus sign, and no sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def vector(values: Iterable[float], decimals: int = 1) -> str:
    """Write a vector in parentheses."""
    return f"({', '.join(number(value, decimals) for value in values)})"


def angles(q: Iterable[float]) -> str:
    """Write angles [rad] in whole degrees."""
    return f"({', '.join(number(math.degrees(angle), 0) + '°' for angle in q)})"


MM = 1000.0  # [mm/m]
FORWARDS = np.array([1.0, 0.0, 0.0])  # commanded velocity, in any unit


def far_end(leg: LegGeometry, options: LegBOptions) -> Array:
    """Posture (3,) [rad] at the far end of a step, where the foot has gone ``2 A / w`` forwards."""
    start = options.posture()
    stroke = 2.0 * options.amplitude / options.frequency
    foot = foot_position(leg, start) + stroke * np.array(options.unit_direction())
    return inverse_kinematics(leg, foot, like=start)


def classic(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Read a table's rows as classic ones: r and θ along and about the previous z axis."""
    return khalil_rows(
        [
            ClassicRow(joint=row.joint, theta=row.theta, d=row.r, a=row.d, alpha=row.alpha)
            for row in rows
        ]
    )


def feet(wrong: Sequence[Row], true: Sequence[Row], q: Sequence[float]) -> Values:
    """Positions of the foot of two tables [mm]."""
    return {
        "wrong": MM * foot_pose(wrong, q)[:3, 3],
        "true": MM * foot_pose(true, q)[:3, 3],
    }


def errata() -> tuple[Erratum, ...]:
    """List the errors in the reports by number, with effects computed from the robots and runs."""
    effects = _effects()
    text = (files(__package__) / "errata.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["erratum"]:
        values = effects[entry["number"]]() if entry["number"] in effects else {}
        for part in ("printed", "right", "effect"):
            entry[part] = filled(entry[part], values)
        found.append(Erratum(**entry))
    return tuple(found)


def _effects() -> Effects:
    from drake_leg.lab.errata import leg_a_errors, leg_b_errors, pendulum_errors, scara_errors

    return {
        **pendulum_errors.EFFECTS,
        **leg_a_errors.EFFECTS,
        **scara_errors.EFFECTS,
        **leg_b_errors.EFFECTS,
    }
