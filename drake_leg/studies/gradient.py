"""Derivatives of a run's results by its options, through the run."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args, overload

import numpy as np
from pydrake.autodiffutils import AutoDiffXd

from drake_leg.arguments import shown
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.differentiable import value_of
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot, html_table
from drake_leg.runs.catalogue import RunKind, run_kind
from drake_leg.runs.options import NONE, StraightOptions
from drake_leg.runs.outcome import Outcome
from drake_leg.runs.step import config_of
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.recording import Recording
from drake_leg.studies.differentiated_step import DifferentiatedStep, State
from drake_leg.studies.extremes import (
    NEARLY_TIED,
    TIED,
    Peak,
    Slope,
    joints_between,
    one_of,
    peaks,
    top_between,
)
from drake_leg.studies.seeds import Seeds

Extremes = Literal["rows", "motion"]

TORQUE = "max_torque_n_m"
ROUNDING = 1e-6  # of a result: more is not the same run


class _Field(NamedTuple):
    """A result: the greatest or least of some series, a range, or the last value."""

    unit: str
    kind: Literal["max", "min", "range", "end"]
    rows: Callable[[Recording, HexabotLegConfig], Array]  # (rows, series)
    scalars: Callable[[DifferentiatedStep, State], Any]  # (series,)
    between_rows: bool = False  # so that the summary has it, too


def _numbered(name: str) -> Callable[[Recording, HexabotLegConfig], Array]:
    """Return what reads the columns of the joints that turn, with both signs."""

    def rows(recording: Recording, config: HexabotLegConfig) -> Array:
        joints = enumerate(config.robot.moving, start=1)
        turning = [i for i, joint in joints if joint.row.joint == "revolute"]
        columns = np.column_stack([recording[f"{name}{i}"] for i in turning])
        return np.hstack([columns, -columns])

    return rows


def _column(name: str) -> Callable[[Recording, HexabotLegConfig], Array]:
    return lambda recording, config: recording[name][:, np.newaxis]


def _feet(recording: Recording, config: HexabotLegConfig) -> Array:
    return np.column_stack([recording[axis] for axis in "xyz"])


def _along(recording: Recording, config: HexabotLegConfig) -> Array:
    ways: Array = _feet(recording, config) @ np.array(config.motion.direction)
    return ways[:, np.newaxis]


def _both_signs(scalars: Any) -> Array:  # noqa: ANN401
    return np.concatenate([scalars, -np.asarray(scalars)])


FIELDS = {
    "stroke_m": _Field("m", "range", _along, lambda step, state: [step.along(state)]),
    "sigma_min_m": _Field(
        "m", "min", _column("sigma_min"), lambda step, state: [step.sigma_min(state)]
    ),
    "det_j_min_m3": _Field(
        "m^3", "min", _column("det_j"), lambda step, state: [step.determinant(state)]
    ),
    "det_j_max_m3": _Field(
        "m^3", "max", _column("det_j"), lambda step, state: [step.determinant(state)]
    ),
    TORQUE: _Field(
        "N*m",
        "max",
        _numbered("tau"),
        lambda step, state: _both_signs(step.turning(step.torques(state))),
    ),
    "max_rate_rad_s": _Field(
        "rad/s",
        "max",
        _numbered("qdot"),
        lambda step, state: _both_signs(step.turning(state.qdot)),
        between_rows=True,
    ),
    "end_position_m": _Field("m", "end", _feet, lambda step, state: step.foot(state)),
}


@dataclass(frozen=True, kw_only=True)
class Gradient(Mapping[str, Any]):
    """A result of a run, and its derivatives by options: ``gradient["l2"]``.

    The derivative by an option that is a list is an array; that of a position has three rows.
    """

    of: str  # name of the result
    value: Any  # the result itself; a float, or (3,)
    unit: str
    by: Mapping[str, Any]  # name of the option -> derivative
    units: Mapping[str, str]  # name of the option -> unit of the option
    times: tuple[float, ...]  # [s], where the result is taken

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - a float or an array
        """Return the derivative by an option.

        Raises
        ------
        InvalidValueError
            If the result was not differentiated by it.
        """
        if name not in self.by:
            raise InvalidValueError(
                f"there is no derivative by {name!r}; there is one by {', '.join(self.by)}",
                advice=did_you_mean(name, self.by),
            )
        return self.by[name]

    def __contains__(self, name: object) -> bool:
        return name in self.by

    def __iter__(self) -> Iterator[str]:
        return iter(self.by)

    def __len__(self) -> int:
        return len(self.by)

    def __repr__(self) -> str:
        return f"<Gradient of {self.of} by {', '.join(self.by)}>"

    def _repr_html_(self) -> str:
        rows = [(self.of, _shown(self.value), self.unit)]
        for name, slope in self.by.items():
            unit = self.units[name]
            rows.append((f"by {name}", _shown(slope), f"{self.unit} per {unit or '1'}"))
        return html_table(("", "value", "unit"), rows, title=f"Gradient of {self.of}")


@overload
def gradient(
    what: str | Path | Robot,
    *,
    of: str,
    by: str | Sequence[str],
    extremes: Extremes = "rows",
    **options: Any,  # noqa: ANN401 - each run has its own
) -> Gradient: ...
@overload
def gradient(
    what: str | Path | Robot,
    *,
    of: Sequence[str],
    by: str | Sequence[str],
    extremes: Extremes = "rows",
    **options: Any,  # noqa: ANN401 - each run has its own
) -> dict[str, Gradient]: ...
def gradient(
    what: str | Path | Robot,
    *,
    of: str | Sequence[str],
    by: str | Sequence[str],
    extremes: Extremes = "rows",
    **options: Any,
) -> Gradient | dict[str, Gradient]:
    """Differentiate a result of a straight step by options of the run.

    The run is carried out, and then repeated in AutoDiffXd with the run's own steps, as far as the
    result needs it. The derivative of a greatest or least value is the one at the instant where it
    is taken (the envelope theorem).

    Parameters
    ----------
    what : str, Path or Robot
        "leg-a", "leg-b"; or a robot of your own, or the path of its TOML file.
    of : str or sequence of str
        The result, or several of one run: "stroke_m", "sigma_min_m", "det_j_min_m3",
        "det_j_max_m3", "max_rate_rad_s" as in the summary of ``run``; "max_torque_n_m", the
        greatest of any joint that turns; or "end_position_m", where the foot is at the end.
    by : str or sequence of str
        Options: "amplitude", "frequency", "direction", "q0", "q0_error", "gravity"; for a leg of
        the reports also "l1", "l2", "l3", "density", "damping". Derivatives are by the option in
        its own unit: **degrees** for q0.
    extremes : {"rows", "motion"}
        Extremes of the recording's rows, as in the summary; or of the motion between its rows, too,
        which are smooth in the options. Only those can be differentiated by the frequency.
    **options
        As ``run`` takes them, for a step without disturbance, filter or correction and with an
        exact inverse.

    Returns
    -------
    Gradient
        A mapping from the names in ``by`` to derivatives, with ``value`` and ``units``. A dict of
        them by the name of the result, if ``of`` is a sequence.

    Raises
    ------
    InvalidValueError
        If there is no such result or option, if the run stops before its end, or if the result has
        no derivative: two extremes of the same value and different derivatives.
    SingularConfigurationError
        If the robot is singular where it starts, or will be.

    Examples
    --------
    >>> from drake_leg import gradient
    >>> step = {"amplitude": 0.05, "duration": 4.0}
    >>> slopes = gradient("leg-b", of="max_torque_n_m", by=("l2", "q0"), **step)
    >>> round(slopes["l2"], 4)  # of a longer femur [N*m per m]
    0.0493
    >>> slopes["q0"].shape  # by hip, knee and ankle [N*m per degree]
    (3,)
    """
    kind = run_kind(what)
    results, names = _names("of", of, "results"), _names("by", by, "options")
    fields = {name: _field(name) for name in results}
    if extremes not in get_args(Extremes):
        raise InvalidValueError(
            f"extremes is {shown(extremes)}; it must be {' or '.join(get_args(Extremes))}"
        )
    moving = [name for name, each in fields.items() if each.kind != "end" and not each.between_rows]
    if extremes == "rows" and moving and "frequency" in names:
        raise InvalidValueError(
            f"the rows of the recording do not move with the frequency, but {moving[0]} does",
            advice="choose `extremes='motion'`",
        )
    if not issubclass(kind.options, StraightOptions):
        raise InvalidValueError(
            f"the run {shown(what)} has no gradient",
            advice="choose leg-a, leg-b or a robot of your own",
        )
    chosen = _chosen(kind, options)
    if TORQUE in fields and chosen.chosen_dynamics() == NONE:
        raise InvalidValueError(
            f"a run with `dynamics={NONE!r}` has no torques, and {TORQUE} is asked for",
            advice="leave it out",
        )
    config = config_of(kind.robot(chosen), chosen)
    assert isinstance(config, HexabotLegConfig)
    _require_smooth(config)
    seeds = Seeds(chosen, config, names)
    outcome = kind.run(chosen)
    _require_end(outcome)
    run = _DifferentiatedRun(config, outcome, seeds)
    found = {}
    for name, field in fields.items():
        value, slopes, times = run.result(
            name, field, between_rows=field.between_rows or extremes == "motion"
        )
        found[name] = Gradient(
            of=name,
            value=value,
            unit=field.unit,
            by=seeds.parts(slopes),
            units=seeds.units(),
            times=times,
        )
    return found[of] if isinstance(of, str) else found


def _field(of: str) -> _Field:
    if of not in FIELDS:
        raise InvalidValueError(
            f"of is {shown(of)}; a step has {', '.join(FIELDS)}", advice=did_you_mean(of, FIELDS)
        )
    return FIELDS[of]


def _names(argument: str, given: str | Sequence[str], what: str) -> list[str]:
    names = [given] if isinstance(given, str) else given
    are_texts = isinstance(names, Collection) and all(isinstance(name, str) for name in names)
    if not are_texts or not names:
        raise InvalidValueError(f"{argument} is {shown(given)}; it must be names of {what}")
    return list(names)


def _chosen(kind: RunKind, options: Mapping[str, Any]) -> StraightOptions:
    known = [each.name for each in dataclasses.fields(kind.options)]
    for option in options:
        if option not in known:
            raise InvalidValueError(
                f"gradient has no option {option!r}",
                advice=did_you_mean(option, known, f"its options are {', '.join(known)}"),
            )
    chosen = kind.posed(kind.options(**options))
    assert isinstance(chosen, StraightOptions)
    return chosen


def _require_end(outcome: Outcome) -> None:
    """Refuse a run that stopped."""
    reason = outcome.summary["stop_reason"]
    if reason is not None:
        raise InvalidValueError(
            f"the run stops before its end and has no gradient: {reason}",
            advice="choose a shorter `duration` or a smaller `amplitude`",
        )


def _require_smooth(config: HexabotLegConfig) -> None:
    """Refuse a run that is not repeated in AutoDiffXd."""
    for without, is_there in (
        ("a push, a mass error or a torque limit", config.disturbance.acts),
        ("`filter_time_constant`", config.filter_time_constant is not None),
        ("an inverse that is not exact", not config.control.inverse.is_exact),
        ("`correction`", config.control.correction != 0.0),
        ("commands that depend on the posture", config.movable.varies),
    ):
        if is_there:
            raise InvalidValueError(f"a run with {without} has no gradient", advice="leave it out")


class _DifferentiatedRun:
    """A run and its repetition in AutoDiffXd."""

    def __init__(self, config: HexabotLegConfig, outcome: Outcome, seeds: Seeds) -> None:
        self._config, self._seeds, self._recording = config, seeds, outcome.recording
        self._time = outcome.recording["time"]
        settings = IntegratorSettings(
            scheme=outcome.summary["integrator"], max_step=outcome.summary["max_step_s"]
        )
        self._step = DifferentiatedStep(config, seeds.numbers(), settings)
        self._states: dict[float, State] = {}  # simulated already

    def result(
        self, of: str, field: _Field, *, between_rows: bool
    ) -> tuple[Any, Array, tuple[float, ...]]:
        """Value, derivatives (..., size), and when they are taken."""
        rows = field.rows(self._recording, self._config)
        if field.kind == "end":
            return self._end(of, field, rows)
        return self._extreme(of, field, rows, between_rows)

    def _end(self, of: str, field: _Field, rows: Array) -> tuple[Any, Array, tuple[float, ...]]:
        end = float(self._time[-1])
        scalars = self._at({end}, field)[end]
        value = np.array([value_of(each) for each in scalars])
        self._compare(of, value, rows[-1])
        return value, self._seeds.slopes(scalars), (end,)

    def _extreme(
        self, of: str, field: _Field, rows: Array, between_rows: bool
    ) -> tuple[Any, Array, tuple[float, ...]]:
        """Greatest or least value, or their difference: the sum of greatest values of +-rows."""
        signs = {"max": (1.0,), "min": (-1.0,), "range": (1.0, -1.0)}[field.kind]
        tops = {sign: self._tops(field, sign * rows, sign, between_rows) for sign in signs}
        at = self._at({peak.time for each in tops.values() for peak in each}, field)
        found = []
        for sign in signs:
            slopes = [self._slope(sign * at[peak.time][peak.series], peak) for peak in tops[sign]]
            found.append(one_of(of, slopes))
        back = signs[0]
        value = back * sum(each.value for each in found)
        self._compare_at_rows(of, field, rows, signs)
        slope = back * np.sum([each.slope for each in found], axis=0) + 0.0  # + 0.0: no -0
        return value, slope, tuple(each.time for each in found)

    def _compare_at_rows(self, of: str, field: _Field, rows: Array, signs: Sequence[float]) -> None:
        """Compare the extremes of the rows, wherever those of the motion are."""
        repeated = recorded = 0.0
        for sign in signs:
            row, series = np.unravel_index((sign * rows).argmax(), rows.shape)
            time = float(self._time[row])
            repeated += sign * value_of(self._at({time}, field)[time][series])
            recorded += sign * float(rows[row, series])
        self._compare(of, signs[0] * repeated, signs[0] * recorded)

    def _slope(self, scalar: Any, peak: Peak) -> Slope:  # noqa: ANN401
        return Slope(value_of(scalar), self._seeds.slopes(scalar), peak.time)

    def _at(self, times: set[float], field: _Field) -> dict[float, Any]:
        """Results with derivatives at some instants, by instant."""
        if not times <= self._states.keys():
            states = self._step.states(self._time.tolist(), sorted(times))
            self._states |= {state.time: state for state in states}
        return {time: field.scalars(self._step, self._states[time]) for time in times}

    def _tops(self, field: _Field, rows: Array, sign: float, between_rows: bool) -> list[Peak]:
        """Instants of the greatest values, near ties among them."""
        if not between_rows:
            return [Peak(float(self._time[row]), i) for row, i in peaks(rows, TIED)]
        return [self._top(field, row, i, sign) for row, i in peaks(rows, NEARLY_TIED)]

    def _top(self, field: _Field, row: int, series: int, sign: float) -> Peak:
        joints = [
            np.column_stack([self._recording[f"{name}{i}"] for i in self._joints])
            for name in ("q", "qdot", "qddot")
        ]
        q = joints_between(self._time, joints, row)

        def value(time: float) -> float:
            state = self._step.state(time, [AutoDiffXd(each) for each in q(time)])
            return sign * value_of(field.scalars(self._step, state)[series])

        return Peak(top_between(self._time, row, value), series)

    @property
    def _joints(self) -> range:
        return range(1, len(self._config.start) + 1)

    def _compare(self, of: str, value: Any, recorded: Any) -> None:  # noqa: ANN401
        """Refuse a run that the repetition does not reproduce."""
        if np.abs(value - recorded).max() > ROUNDING * np.abs(recorded).max():
            raise InvalidValueError(
                f"{of} is {recorded} in the run and {value} when it is repeated in AutoDiffXd, so "
                "it cannot be differentiated",
                advice="choose a smaller `max_step`, or another result, as stroke_m",
            )


def _shown(value: Any) -> str:  # noqa: ANN401 - a number or an array of them
    return np.array2string(np.asarray(value), precision=6)
