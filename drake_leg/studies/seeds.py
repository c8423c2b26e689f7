"""The options of a step by which a result can be differentiated, as numbers with derivatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from pydrake.autodiffutils import AutoDiffXd

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.khalil import Array
from drake_leg.runs.options import LegOptions, StraightOptions
from drake_leg.studies.differentiated_step import Numbers
from drake_leg.units import DAMPING_UNITS, in_si

OF_EVERY_STEP = ("amplitude", "frequency", "direction", "q0", "q0_error", "gravity")
OF_THE_LEGS = ("l1", "l2", "l3", "density", "damping")
LENGTHS = OF_THE_LEGS[:3]
UNITS = {
    "amplitude": "m/s",
    "frequency": "rad/s",
    "direction": "",
    "gravity": "m/s^2",
    "l1": "m",
    "l2": "m",
    "l3": "m",
    "density": "kg/m^3",
}


class Seeds:
    """Values of a run's options, those of ``by`` with a derivative in their own units.

    Parameters
    ----------
    options : StraightOptions
        Of the run.
    config : HexabotLegConfig
        Of its diagram.
    by : sequence of str
        Names of options.
    """

    def __init__(
        self, options: StraightOptions, config: HexabotLegConfig, by: Sequence[str]
    ) -> None:
        self._options, self._config = options, config
        known = OF_EVERY_STEP + OF_THE_LEGS * isinstance(options, LegOptions)
        for name in by:
            if name not in known:
                raise InvalidValueError(
                    f"by has {name!r}; a step is differentiated by {', '.join(known)}",
                    advice=did_you_mean(name, known),
                )
        self._turning = [joint.row.joint == "revolute" for joint in config.robot.moving]
        self._slices: dict[str, slice | int] = {}
        self.size = 0
        for name in dict.fromkeys(by):
            count = self._count(name)
            self._slices[name] = self.size if count is None else slice(self.size, self.size + count)
            self.size += count or 1

    def numbers(self) -> Numbers:
        """Return the numbers that the step depends on."""
        options, config = self._options, self._config
        direction = list(config.motion.direction)
        if options.direction is not None:
            direction = list(options.direction)
        radians = [math.radians(1.0) if turns else 1.0 for turns in self._turning]
        damping = options.si_damping() if isinstance(options, LegOptions) else 0.0
        unit = self._damping_unit()
        return Numbers(
            amplitude=self._scalar("amplitude", options.amplitude),
            frequency=self._scalar("frequency", options.frequency),
            direction=[self._scalar("direction", d, i) for i, d in enumerate(direction)],
            start=[
                self._scalar("q0", q, i, factor) + self._scalar("q0_error", 0.0, i, factor)
                for i, (q, factor) in enumerate(zip(config.start, radians, strict=True))
            ],
            gravity=self._scalar("gravity", options.gravity),
            lengths=[self._scalar(n, getattr(options, n)) for n in LENGTHS if hasattr(options, n)],
            density=self._scalar("density", getattr(options, "density", 0.0)),
            damping=self._scalar("damping", damping, 0, in_si("damping", 1.0, unit, DAMPING_UNITS)),
        )

    def units(self) -> dict[str, str]:
        """Return the units of the options of ``by``."""
        joints = "deg" if all(self._turning) else "deg or m"
        own = {"q0": joints, "q0_error": joints, "damping": self._damping_unit()}
        return {name: (UNITS | own)[name] for name in self._slices}

    def parts(self, slopes: Array) -> dict[str, Any]:
        """Split derivatives (..., size) by the name of the option."""
        parts = {name: slopes[..., where] for name, where in self._slices.items()}
        return {name: part if np.ndim(part) else float(part) for name, part in parts.items()}

    def slopes(self, scalars: ArrayLike) -> Array:
        """Return the derivatives (..., size) of a scalar or an array of them."""
        return np.array([self._slope(each) for each in np.ravel(scalars)]).reshape(
            (*np.shape(scalars), self.size)
        )

    def _slope(self, scalar: Any) -> Array:  # noqa: ANN401
        slope: Array = scalar.derivatives()
        return slope if slope.size else np.zeros(self.size)  # of a constant

    def _scalar(self, name: str, value: float, index: int = 0, factor: float = 1.0) -> Any:  # noqa: ANN401
        """Make a number in SI units; ``factor`` converts the option's unit to them."""
        where = self._slices.get(name)
        if where is None:
            return AutoDiffXd(value)
        slope = np.zeros(self.size)
        slope[index + (where.start if isinstance(where, slice) else where)] = factor
        return AutoDiffXd(value, slope)

    def _count(self, name: str) -> int | None:
        """Number of components of an option; None for a single number."""
        if name in ("q0", "q0_error"):
            return len(self._config.start)
        return 3 if name == "direction" else None

    def _damping_unit(self) -> str:
        unit = getattr(self._options, "damping_unit", None)
        return next(iter(DAMPING_UNITS)) if unit is None else str(unit)
