"""Which sweeps of a leg's step need no simulation, and their answers in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.processes import cores
from drake_leg.robot.robots import hexabot_leg
from drake_leg.runs.options import INVERSE, NONE, WEIGHTY, LegAOptions, LegBOptions
from drake_leg.runs.peaks import link_mass
from drake_leg.runs.step import STEPS_PER_PERIOD
from drake_leg.simulation.integrator import ROW_INTERVAL
from drake_leg.simulation.run import STEP_BUDGET
from drake_leg.studies.leg_places import LegSteps
from drake_leg.studies.leg_steps import Answers, answers
from drake_leg.studies.plan import Plan
from drake_leg.studies.row import DONE, SINGULAR
from drake_leg.units import LEAST, MOST

CHUNK = 2**16  # runs at once, which bound the memory
TURNS = 4.0 * math.pi  # [rad], of a joint at the start: more is not what was meant

# Options of a run that the answers follow from; where another one is given, runs are simulated.
LENGTHS = ("l1", "l2", "l3")
NUMBERS = ("amplitude", "frequency", "duration", "density", "gravity")
OPTIONS = {*LENGTHS, *NUMBERS, "q0", "direction"}

# Quantities along a step that each entry of the summary is the greatest of.
FIELDS: dict[str, tuple[str, ...]] = {
    "stroke_m": (),
    "sigma_min_m": ("arm_sigma",),  # and the distance from the hip axis
    "det_j_min_m3": ("det_min",),
    "det_j_max_m3": ("det_max",),
    "max_rate_rad_s": ("rate_1", "rate_2", "rate_3"),
    "max_static_torque_n_m": ("torque_2", "torque_3"),
}
NEGATED = {"sigma_min_m", "det_j_min_m3"}  # the least of something, as the greatest of its negative

MESSAGES = np.array(
    [
        None,
        "the leg would become singular (stretch family)",
        "the leg would become singular (hip-axis family)",
    ],
    dtype=object,
)


class Batch(NamedTuple):
    """Columns of all runs, and the places of those that are left to a simulation."""

    columns: dict[str, NDArray[Any]]
    left: list[int]


def is_closed(plan: Plan) -> bool:
    """Whether nothing is asked for but what has a closed form."""
    given = {*plan.fixed, *(one.option for one in plan.vary)}
    if plan.fixed.get("dynamics") == INVERSE or (
        plan.fixed.get("dynamics") == NONE and not given & set(WEIGHTY)
    ):
        given -= {"dynamics"}  # what moves is the same with and without torques
    return (
        not plan.simulated
        and plan.fields is not None
        and set(plan.fields) <= set(FIELDS)
        and plan.kind.own is None
        and plan.kind.options in (LegAOptions, LegBOptions)
        and given <= OPTIONS
    )


def batch(plan: Plan, report: Callable[[int, int], None]) -> Batch:
    """Answer a plan for which ``is_closed`` holds, in blocks, on all cores."""
    count, values = len(plan), _values(plan)
    columns: list[dict[str, NDArray[Any]]] = []
    known: list[NDArray[np.bool_]] = []
    with ThreadPoolExecutor(cores()) as threads, np.errstate(all="ignore"):
        for first in range(0, count, CHUNK):
            chunk = {name: each[first : first + CHUNK] for name, each in values.items()}

            def tell(done: int, first: int = first) -> None:
                report(first + done, count)

            found, surely = _answered(plan, chunk, threads, tell)
            columns.append(found)
            known.append(surely)
    together = {name: np.concatenate([each[name] for each in columns]) for name in columns[0]}
    return Batch(together, np.flatnonzero(~np.concatenate(known)).tolist())


def _answered(
    plan: Plan,
    values: Mapping[str, Array],
    threads: ThreadPoolExecutor,
    report: Callable[[int], None],
) -> tuple[dict[str, NDArray[Any]], NDArray[np.bool_]]:
    """Columns of some runs, and which of them need no simulation."""
    fields, steps = plan.fields or (), _steps(plan, values)
    wanted = {field: FIELDS[field] for field in fields if FIELDS[field]}
    found = answers(steps, wanted, threads.map, report)
    columns = {
        "status": np.where(found.met, SINGULAR, DONE).astype("<U8"),
        "message": MESSAGES[np.where(found.met, np.where(found.at_hip, 2, 1), 0)],
        "stopped_at_s": np.where(found.met, steps.time(found.stop), np.nan),
        **{field: _field(field, steps, found) for field in fields},
    }
    return columns, found.sure & _valid(values)


def _field(field: str, steps: LegSteps, found: Answers) -> Array:
    if field == "stroke_m":
        stroke: Array = steps.length * steps.end
        return np.where(found.met, np.nan, stroke)
    greatest = found.greatest[field]
    if field == "sigma_min_m":
        greatest = np.maximum(greatest, -steps.least_hip_distance)
    return -greatest if field in NEGATED else greatest


def _values(plan: Plan) -> dict[str, Array]:
    """Numbers of all runs: (runs,), or (runs, 3) of q0 and the direction."""
    base: Any = plan.kind.options(**plan.fixed)
    count = len(plan)
    values = {name: np.broadcast_to(getattr(base, name), (count,)) for name in (*LENGTHS, *NUMBERS)}
    lists = {name: np.tile(getattr(base, name), (count, 1)) for name in ("q0", "direction")}
    for one in plan.vary:
        column = np.array(plan.columns[one.name], dtype=float)
        if one.option not in lists:
            values[one.option] = column
        elif one.index is None:
            lists[one.option] = column
        else:
            lists[one.option][:, one.index] = column
    return values | lists


def _valid(block: Mapping[str, Array]) -> NDArray[np.bool_]:
    """Which legs have values that a run surely takes; the others are left to it."""
    valid = np.ones(len(block["l1"]), dtype=bool)
    for name in (*LENGTHS, *NUMBERS):
        valid &= (np.abs(block[name]) >= LEAST) & (np.abs(block[name]) <= MOST)
        if name != "amplitude":
            valid &= block[name] > 0.0
    period = 2.0 * math.pi / block["frequency"]
    step = np.minimum(ROW_INTERVAL, period / STEPS_PER_PERIOD)
    valid &= block["duration"] / step <= STEP_BUDGET
    valid &= (np.abs(np.radians(block["q0"])) <= TURNS).all(axis=1)
    size = np.linalg.norm(block["direction"], axis=1)
    valid &= (size > LEAST) & (size <= MOST)
    return valid


def _steps(plan: Plan, block: Mapping[str, Array]) -> LegSteps:
    base: Any = plan.kind.options()
    robot = hexabot_leg(base.robot().name[-1].upper(), l1=1.0, l2=1.0, l3=1.0, density=1.0)
    side = LegGeometry.from_robot(robot).sign
    _, femur, tibia, foot = (link_mass(segment.link) for segment in robot.segments)
    weight = block["density"] * block["gravity"]
    numbers = {name: block[name] for name in (*LENGTHS, "amplitude", "frequency", "duration")}
    return LegSteps.of(
        np.radians(block["q0"]),
        np.full(len(weight), float(side)),
        block["direction"],
        weight_2=weight * (0.5 * femur * block["l2"] + tibia * block["l3"] + foot),
        weight_3=weight * (0.5 * tibia * block["l3"] + foot),
        **numbers,
    )
