"""The plan of a sweep: every run's options, in an order that never changes."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from typing import Any

import numpy as np

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.khalil import Array
from drake_leg.runs.catalogue import RunKind
from drake_leg.runs.option import converted
from drake_leg.runs.options import RunOptions
from drake_leg.studies.lettered import LetteredFile
from drake_leg.studies.variation import MOST_RUNS, Variation

SAMPLERS = ("sobol", "random")


@dataclass(frozen=True, kw_only=True)
class Plan:
    """The runs of a sweep: fixed options, and columns of varied ones."""

    name: str  # of the run or the robot's file
    kind: RunKind
    fixed: Mapping[str, Any]
    vary: tuple[Variation, ...]
    sample: int | None = None  # how many samples; None: the whole grid
    sampler: str = "sobol"
    seed: int = 0
    fields: tuple[str, ...] | None = None  # of the summary that are kept; None: all
    simulated: bool = False  # even where a closed form has the answer
    file: LetteredFile | None = None  # whose letters vary

    def __len__(self) -> int:
        return self._count

    @cached_property
    def _count(self) -> int:
        if self.sample is not None:
            return self.sample
        return math.prod(one.size for one in self.vary)

    @cached_property
    def columns(self) -> dict[str, Sequence[Any]]:
        """Varied values by name, each of a length of all runs; a grid's last one varies fastest."""
        if self.sample is not None:
            parts = samples(self.sampler, len(self.vary), self.sample, self.seed)
            return {one.name: one.at(parts[:, i]) for i, one in enumerate(self.vary)}
        grids = {one.name: one.grid for one in self.vary}
        places = np.unravel_index(np.arange(len(self)), [len(grid) for grid in grids.values()])
        return {
            name: [grid[place] for place in of]
            for (name, grid), of in zip(grids.items(), places, strict=True)
        }

    def values(self, run: int) -> dict[str, Any]:
        """Varied values of a run, as in the table."""
        return {name: column[run] for name, column in self.columns.items()}

    def options(self, run: int) -> dict[str, Any]:
        """All options of a run, as ``kind.options`` takes them."""
        options = dict(self.fixed)
        for one in self.vary:
            value = self.columns[one.name][run]
            if one.is_letter:
                continue
            if one.index is None:
                options[one.option] = value
                continue
            whole = options.get(one.option)
            if whole is None:
                whole = self._default(one.option)
            if whole is None or one.index >= len(whole):
                raise InvalidValueError(
                    f"{one.option} has no component {one.index}: give `{one.option}` as a whole"
                )
            options[one.option] = [*whole[: one.index], value, *whole[one.index + 1 :]]
        return options

    def letters(self, run: int) -> dict[str, float]:
        """Numbers of a run for the letters that vary."""
        return {one.name: self.columns[one.name][run] for one in self.vary if one.is_letter}

    def _default(self, option: str) -> list[float] | None:
        default: list[float] | None = getattr(self.kind.options(), option)
        return default

    def described(self) -> dict[str, Any]:
        """What determines all rows, for the plan's file."""
        described: dict[str, Any] = {
            "version": version("drake-leg"),
            "run": self.name,
            "options": dict(self.fixed),
            "vary": [one.described() for one in self.vary],
            "fields": self.fields,
            "simulated": self.simulated,
            "runs": len(self),
        }
        if self.sample is not None:
            described |= {"sample": self.sample, "sampler": self.sampler, "seed": self.seed}
        if self.kind.own is not None:
            from drake_leg.robot.toml.writer import robot_toml

            described["robot"] = robot_toml(self.kind.own)
        if self.file is not None:
            described["file"] = self.file.text
            described["numbers"] = dict(self.file.numbers)
        return described

    @cached_property
    def digest(self) -> str:
        """Identify the plan and the version that carries it out: equal for the same rows only."""
        text = json.dumps(self.described(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def samples(sampler: str, dimensions: int, count: int, seed: int) -> Array:
    """Points (count, dimensions) in the unit cube, the same for the same seed."""
    if sampler == "random":
        points: Array = np.random.default_rng(seed).random((count, dimensions))
        return points
    from scipy.stats import qmc

    sobol = qmc.Sobol(dimensions, scramble=True, seed=np.random.default_rng(seed))
    sobol_points: Array = sobol.random_base2(max(count - 1, 1).bit_length())
    return sobol_points[:count]


def checked_plan(plan: Plan) -> Plan:
    """Convert the options of all runs; refuse them, a count or a first run that make no sense.

    Raises
    ------
    InvalidValueError
        With the value.
    """
    known = {field.name: field for field in dataclasses.fields(plan.kind.options)}
    for option in plan.fixed:
        if option not in known:
            advice = did_you_mean(option, known, f"its options are {', '.join(known)}")
            raise InvalidValueError(f"the run {plan.name!r} has no option {option!r}: {advice}")
    if plan.sampler not in SAMPLERS:
        raise InvalidValueError(
            f"the sampler is {shown(plan.sampler)}; it must be {' or '.join(SAMPLERS)}"
        )
    if not 1 <= len(plan) <= MOST_RUNS:
        raise InvalidValueError(f"these are {len(plan)} runs; there may be up to {MOST_RUNS}")
    fixed = {option: converted(known[option], value) for option, value in plan.fixed.items()}
    plan = dataclasses.replace(plan, fixed=fixed)
    options_of(plan, 0)
    return plan


def options_of(plan: Plan, run: int) -> RunOptions:
    """Options of a run, checked."""
    return plan.kind.options(**plan.options(run))
