"""The errors in the two reports: texts from ``errata.toml``, with effects computed here."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib.resources import files
from string import Formatter
from typing import Any

import numpy as np
import sympy as sp
from scipy.spatial.transform import Rotation

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, base_transforms, foot_pose, jacobian, row_transform
from drake_leg.kinematics.leg import (
    LegGeometry,
    MovableLeg,
    foot_jacobian,
    foot_position,
    inverse_kinematics,
)
from drake_leg.kinematics.motions import EllipticStep
from drake_leg.kinematics.pendulum import (
    PendulumModel,
    energy,
    exact_motion,
    exact_period,
    rest_angle,
)
from drake_leg.kinematics.scara import (
    ScaraGeometry,
    determinant,
    lift_position,
    task_jacobian,
    tool_position,
)
from drake_leg.lab.errata.printed import (
    J12_PRINTED,
    J12_RIGHT,
    LEG_B_TABLE_PRINTED,
    LEG_B_TABLE_RIGHT,
    MM,
    SIGMAS_PRINTED,
    SIGMAS_RIGHT,
    PrintedMatrices,
    angle_values,
    in_one_line,
    leg_b_matrices,
    rotation_defect,
    scara_matrices,
)
from drake_leg.robot.robot import Robot, Row
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.robot.toml.reader import ClassicRow, khalil_rows
from drake_leg.runs.options import EllipseOptions, LegAOptions, LegBOptions, ScaraOptions
from drake_leg.runs.pendulum_options import (
    STATE_TARGET,
    DampedPendulumOptions,
    SpringPendulumOptions,
)
from drake_leg.singularity.doctor import examine
from drake_leg.symbolic.derivation import evaluate
from drake_leg.symbolic.equations import text

Values = Mapping[str, Any]  # numbers, vectors and texts, by their names in errata.toml


@dataclass(frozen=True, kw_only=True)
class Erratum:
    """One error of a report."""

    number: int  # 1 to 25 through both reports, from 26 through both again
    source: str  # the report
    where: str  # section, equation, table or figure there
    printed: str  # what it prints: text in quotation marks, a formula without
    right: str  # what it should print
    effect: str  # a sentence on the error's effect, with computed numbers

    def _repr_html_(self) -> str:
        from drake_leg.lab.page.pieces import errata_in_notebook

        return errata_in_notebook([self.number])


@cache
def texts_by_number() -> Mapping[int, Mapping[str, Any]]:
    """Read ``errata.toml``: the fields of the errata, before the numbers are filled in."""
    content = (files(__package__) / "errata.toml").read_text(encoding="utf-8")
    return {entry["number"]: entry for entry in tomllib.loads(content)["erratum"]}


def errata() -> tuple[Erratum, ...]:
    """List the errors in the reports by number, with effects computed from the robots and runs."""
    return tuple(map(_computed, texts_by_number()))


@cache
def erratum_of(number: int) -> Erratum:
    """Return the erratum with a number, computed once; refuse a number without one."""
    if number not in texts_by_number():
        raise InvalidValueError(
            f"there is no erratum {shown(number)}; they are numbered from 1 to "
            f"{len(texts_by_number())}"
        )
    return _computed(number)


def _computed(number: int) -> Erratum:
    values = EFFECTS[number]() if number in EFFECTS else {}
    fields: dict[str, Any] = {
        name: _Filled().vformat(field, (), values)
        if name in ("printed", "right", "effect")
        else field
        for name, field in texts_by_number()[number].items()
    }
    return Erratum(**fields)


class _Filled(Formatter):
    """Formats numbers and vectors with a number of decimals, 1 by default; texts unchanged."""

    def format_field(self, value: Any, format_spec: str) -> str:  # noqa: ANN401
        if isinstance(value, str):
            return value
        write = vector if isinstance(value, Iterable) else number
        return write(value, int(format_spec or 1))


def number(value: float, decimals: int = 1) -> str:
    """Write a number with a true minus sign, and no sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def vector(values: Iterable[float], decimals: int = 1) -> str:
    """Write a vector in parentheses."""
    return f"({', '.join(number(value, decimals) for value in values)})"


def angles(q: Iterable[float]) -> str:
    """Write angles [rad] in whole degrees."""
    return f"({', '.join(number(math.degrees(angle), 0) + '°' for angle in q)})"


# --- the pendulum ----------------------------------------------------------------------------

MODEL = PendulumModel.from_robot(PENDULUM)
RELEASE = 0.0  # [rad], where the free pendulum is released: horizontal
HANGING = math.pi / 2  # [rad]


def _damping_unit() -> Values:
    critical = 2.0 * MODEL.inertia * MODEL.natural_frequency
    radians, degrees = (
        DampedPendulumOptions(damping_unit=unit).si_damping() / critical
        for unit in ("N*m*s/rad", "N*m/(deg/s)")
    )
    factor, length = degrees / radians, 1000 * MODEL.length
    return {"factor": factor, "length": length, "radians": radians, "degrees": degrees}


def _state_target() -> Values:
    target, options = math.radians(STATE_TARGET), SpringPendulumOptions()
    damped = dataclasses.replace(MODEL, damping=options.damping)
    sprung = dataclasses.replace(
        damped, spring_stiffness=options.spring_stiffness, equilibrium_position=target
    )
    rests = [rest_angle(model, target) for model in (damped, sprung)]
    hanging, held = (math.degrees(rest) for rest in rests if rest is not None)
    return {
        "target": STATE_TARGET,
        "hanging": hanging,
        "stiffness": options.spring_stiffness,
        "held": held,
    }


def _greatest_speed() -> Values:
    released = energy(MODEL, RELEASE, 0.0)
    at_zero, at_bottom = (
        math.sqrt(2.0 * float(released - energy(MODEL, angle, 0.0)) / MODEL.inertia)
        for angle in (0.0, HANGING)
    )
    return {"at_zero": at_zero, "at_bottom": at_bottom, "hanging": math.degrees(HANGING)}


def _sinusoid() -> Values:
    period = exact_period(MODEL, RELEASE) or math.inf
    small = 2.0 * math.pi / MODEL.natural_frequency
    time = np.linspace(0.0, period, 2001)
    sinusoid = HANGING + (RELEASE - HANGING) * np.cos(2.0 * math.pi * time / period)
    away = np.degrees(np.abs(exact_motion(MODEL, RELEASE, time)[0] - sinusoid).max())
    amplitude = math.degrees(HANGING - RELEASE)
    factor = period / small
    return {
        "amplitude": amplitude,
        "period": period,
        "factor": factor,
        "small": small,
        "away": away,
    }


# --- the legs --------------------------------------------------------------------------------

GEOMETRY_A, GEOMETRY_B = LegGeometry.from_robot(LEG_A), LegGeometry.from_robot(LEG_B)
FORWARDS = np.array([1.0, 0.0, 0.0])  # commanded velocity, in any unit
GAIN = 10.0  # "a constant factor of 10"


def far_end(leg: LegGeometry, options: LegBOptions) -> Array:
    """Posture (3,) [rad] at the far end of a step, where the foot has gone ``2 A / w`` forwards."""
    start = options.posture()
    stroke = 2.0 * options.amplitude / options.frequency
    foot = foot_position(leg, start) + stroke * np.array(options.unit_direction())
    return inverse_kinematics(leg, foot, like=start)


def _classic(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Read a table's rows as classic ones: r and θ along and about the previous z axis."""
    return khalil_rows(
        [
            ClassicRow(joint=row.joint, theta=row.theta, d=row.r, a=row.d, alpha=row.alpha)
            for row in rows
        ]
    )


def _feet(wrong: Sequence[Row], robot: Robot, q: Sequence[float]) -> Values:
    """Positions of the foot of a table read wrongly and of the right one [mm]."""
    rank = examine(jacobian(wrong, q)[3:]).rank
    wrong_foot, foot = (MM * foot_pose(rows, q)[:3, 3] for rows in (wrong, robot.rows))
    return {"wrong": wrong_foot, "true": foot, "rank": rank, "q": angles(q[:3])}


def _no_rotation(
    matrices: PrintedMatrices, values: Mapping[str, float], foot: Array, name: str
) -> Values:
    """Measure a printed transform that is not a rotation, and the foot that it gives [mm]."""
    volume, deviation = rotation_defect(matrices.value(name, values))
    return {
        "printed": in_one_line(matrices.printed[name]),
        "right": in_one_line(matrices.right[name]),
        "determinant": volume,
        "deviation": deviation,
        "away": math.dist(matrices.product(values, name)[:3, 3], foot),
    }


def _degrees_of_freedom() -> Values:
    options, lift = LegAOptions(), EllipseOptions().lift
    start = np.array(options.posture())
    time = np.linspace(0.0, 2.0 * math.pi / options.frequency, 721)
    turned = []
    for direction in ((math.cos(start[0]), math.sin(start[0]), 0.0), options.unit_direction()):
        motion = EllipticStep(
            amplitude=options.amplitude,
            frequency=options.frequency,
            direction=direction,
            lift=lift,
        )
        positions = foot_position(GEOMETRY_A, start) + motion.displacement(time)
        turned.append(np.ptp(inverse_kinematics(GEOMETRY_A, positions, like=start), axis=0))
    (hip, knee, ankle), (across, _, _) = np.degrees(turned)
    stroke = 2 * MM * options.amplitude / options.frequency
    inside = {"hip": hip, "knee": knee, "ankle": ankle}
    return {"stroke": stroke, "lift": MM * lift, **inside, "across": across}


def _first_forms() -> Values:
    q = far_end(GEOMETRY_A, LegAOptions())
    literal = np.eye(4)
    for row, angle in zip(LEG_A.rows, (q[0], q[1], q[0], q[0]), strict=True):
        literal = literal @ row_transform(dataclasses.replace(row, joint="revolute"), angle)
    right = foot_pose(LEG_A.rows, q)
    away = math.dist(literal[:3, 3], right[:3, 3])
    cosine = (np.trace(literal[:3, :3].T @ right[:3, :3]) - 1.0) / 2.0
    return {"away": MM * away, "q": angles(q), "turn": math.degrees(math.acos(cosine))}


def _missing_rates() -> Values:
    q = np.array(LegAOptions().posture())
    return {"q": angles(q), "speed": MM * math.hypot(*(foot_jacobian(GEOMETRY_A, q) @ q))}


def _wrong_column() -> Values:
    q = far_end(GEOMETRY_A, LegAOptions())
    J = foot_jacobian(GEOMETRY_A, q)
    J_printed = J.copy()
    J_printed[0, 2] = -GEOMETRY_A.l3 * math.sin(q[0]) * math.sin(q[1] + q[2])
    return {"q": angles(q), "v": J @ np.linalg.solve(J_printed, FORWARDS)}


def _hip_axis() -> Values:
    q1, q2 = LegAOptions().posture()[0], math.pi / 2
    q3 = math.acos(-(GEOMETRY_A.l1 + GEOMETRY_A.l2 * math.cos(q2)) / GEOMETRY_A.l3) - q2
    report = examine(foot_jacobian(GEOMETRY_A, (q1, q2, q3)))
    q = angles((q1, q2, q3))
    return {"q": q, "sine": math.sin(q3), "rank": report.rank, "sigma": MM * report.sigma_min}


def _stretched() -> Values:
    q = (*LegAOptions().posture()[:2], 0.0)
    J = foot_jacobian(GEOMETRY_A, q)
    first, second, third = MM * np.linalg.svd(J, compute_uv=False)
    report = examine(J)
    along = foot_pose(LEG_A.rows, q)[:3, 0]
    angle = math.degrees(math.acos(min(1.0, abs(float(report.lost_directions[0] @ along)))))
    sizes = {"first": first, "second": second, "third": third}
    return {"q": angles(q), "rank": report.rank, **sizes, "angle": angle}


def _base_on_the_ground() -> Values:
    q = LegAOptions().posture()
    return {"q": angles(q), "depth": -MM * float(foot_position(GEOMETRY_A, q)[2])}


def _length_for_angle() -> Values:
    q1, q2, q3 = LegAOptions().posture()
    foot, turned = (foot_position(GEOMETRY_A, (q1, q2, angle)) for angle in (q3, GEOMETRY_A.l3))
    return {
        "length": GEOMETRY_A.l3,
        "away": MM * math.dist(foot, turned),
        "q": angles((q1, q2, q3)),
    }


def _euler_rates() -> Values:
    q = far_end(GEOMETRY_A, LegAOptions())
    J = foot_jacobian(GEOMETRY_A, q)
    rates = np.linalg.solve(J, FORWARDS)
    return {"q": angles(q), "v": J @ [rates[0], 0.0, rates[1] + rates[2]]}


def _demuxed() -> Values:
    rates = np.linalg.solve(foot_jacobian(GEOMETRY_A, LegAOptions().posture()), FORWARDS)
    return {"size": rates.size}


def _start() -> Array:
    """Leg B's start."""
    return np.array(LegBOptions().posture())


def _leg_b_values(q: Array) -> dict[str, float]:
    """The report's symbols [rad, mm]."""
    return angle_values(q.tolist()) | {
        "L1": MM * GEOMETRY_B.l1,
        "L2": MM * GEOMETRY_B.l2,
        "L3": MM * GEOMETRY_B.l3,
    }


def _shifted_table() -> Values:
    """Read the printed table by its headings: lengths as joint types, an angle as a length."""
    literal = (
        Row(joint="revolute"),
        Row(joint="revolute", d=90.0 / MM),
        Row(joint="revolute"),
        Row(joint="fixed"),
    )
    wrong, true = (examine(jacobian(rows, _start())[3:]).rank for rows in (literal, LEG_B.rows))
    tables = {
        "printed": in_one_line(LEG_B_TABLE_PRINTED[1:]),
        "right": in_one_line(LEG_B_TABLE_RIGHT[1:]),
    }
    return {**tables, "wrong": wrong, "true": true}


def _no_rotation_of_leg_b(name: str) -> Values:
    q = _start()
    foot = MM * foot_position(GEOMETRY_B, q)
    return {**_no_rotation(leg_b_matrices(), _leg_b_values(q), foot, name), "q": angles(q)}


def _first_rows(name: str) -> Values:
    """Show the rows in which a matrix is wrong, and the abbreviations in them."""
    matrices = leg_b_matrices()
    found: dict[str, str] = {}
    for kind, sigmas in (("printed", SIGMAS_PRINTED), ("right", SIGMAS_RIGHT)):
        rows = getattr(matrices, kind)[name][:2, :]
        used = (f"{sigma} = {text(value)}" for sigma, value in sigmas.items() if rows.has(sigma))
        found |= {kind: in_one_line(rows), f"{kind}_sigmas": ", ".join(used)}
    return found


def _wrong_pose() -> Values:
    q = _start()
    printed = leg_b_matrices().value("T04", _leg_b_values(q))
    return {
        **_first_rows("T04"),
        "q": angles(q),
        "wrong": printed[:3, 3],
        "true": MM * foot_position(GEOMETRY_B, q),
        "determinant": rotation_defect(printed)[0],
    }


def _wrong_jacobian() -> Values:
    start, end = _start(), far_end(GEOMETRY_B, LegBOptions())
    printed = leg_b_matrices().printed["J"].subs(SIGMAS_PRINTED)
    listed = sp.Matrix(printed)
    listed[0, 1] = J12_PRINTED

    def sent(J_printed: sp.Matrix, q: Array) -> Array:
        """Velocity of the foot commanded forwards through the inverse of a printed Jacobian."""
        rates = np.linalg.solve(evaluate(J_printed, _leg_b_values(q)), FORWARDS)
        return MM * foot_jacobian(GEOMETRY_B, q) @ rates

    return {
        **_first_rows("J"),
        "printed_j12": text(J12_PRINTED),
        "right_j12": text(J12_RIGHT),
        "start": angles(start),
        "end": angles(end),
        "first": sent(printed, start),
        "second": sent(printed, end),
        "third": sent(listed, end),
    }


def _headings_of_leg_b() -> Values:
    """Take every d of the table along the x axis after the turn by θ."""
    before = [0.0, *(row.d for row in LEG_B.rows)]
    literal = [dataclasses.replace(row, d=d) for row, d in zip(LEG_B.rows, before, strict=False)]
    literal.append(Row(joint="fixed", d=before[-1]))
    return _feet(literal, LEG_B, LegBOptions().posture())


def _three_joints_of_leg_b() -> Values:
    return {"rank": examine(foot_jacobian(GEOMETRY_B, _start())).rank, "q": angles(_start())}


def _path() -> tuple[Array, Array, Array]:
    """The default step over a period: phases [rad], displacement [m] and velocity [m/s]."""
    motion = LegBOptions().motion()
    phase = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    time = phase / motion.frequency
    return phase, motion.displacement(time), motion.velocity(time)


def _gain() -> Values:
    (_, displacement, velocity), leg = _path(), MovableLeg(GEOMETRY_B)
    q = inverse_kinematics(
        GEOMETRY_B, foot_position(GEOMETRY_B, _start()) + displacement, like=_start()
    )
    rates = np.array([leg.rates(*pair) for pair in zip(q, velocity, strict=True)])
    went = (foot_jacobian(GEOMETRY_B, q) @ rates[:, :, np.newaxis])[:, :, 0]
    factor = np.abs(went).max() / np.abs(velocity).max()
    peak = MM * LegBOptions().amplitude
    return {"factor": factor, "low": peak / GAIN, "peak": peak, "gain": GAIN}


def _velocity_command() -> Values:
    _, displacement, velocity = _path()
    x, v = MM * displacement[:, 0], MM * velocity[:, 0]
    return {"swing": v.max(), "start": x.min(), "end": x.max(), "low": v.min()}


def _phase() -> Values:
    phase, displacement, velocity = _path()
    x, v = displacement[:, 0], velocity[:, 0]
    turning = np.exp(-1j * phase)
    lag = np.angle((v @ turning) / (x @ turning), deg=True)
    return {"lag": lag, "correlation": np.corrcoef(x, v)[0, 1]}


# --- the SCARA -------------------------------------------------------------------------------

ARM = ScaraGeometry.from_robot(SCARA)


def _scara_posture() -> tuple[float, ...]:
    """The default posture, the lift included [rad, m]."""
    options = ScaraOptions()
    return (*options.posture(), lift_position(ARM, options.tool_height))


def _scara_values() -> dict[str, float]:
    """The report's symbols at the default posture [rad, mm]."""
    return angle_values(_scara_posture()[:3]) | {"R": MM * ScaraOptions().tool_height}


def _tool() -> Array:
    """Position of the tool at the default posture [mm]."""
    return MM * tool_position(ARM, _scara_posture())


def _third_rows(name: str) -> Values:
    matrices = scara_matrices()
    return {kind: in_one_line(getattr(matrices, kind)[name][2, :]) for kind in ("printed", "right")}


def _height() -> Values:
    true = _tool()[2]
    wrong = scara_matrices().product(_scara_values(), "T01")[2, 3]
    return {**_third_rows("T03"), "low": true - wrong, "wrong": wrong, "true": true}


def _no_rotation_of_scara(name: str) -> Values:
    return _no_rotation(scara_matrices(), _scara_values(), _tool(), name)


def _three_joints_of_scara() -> Values:
    q = _scara_posture()[:3]
    return {"q": angles(q), "rank": examine(task_jacobian(ARM, q)).rank}


def _singular() -> Values:
    said, unsaid = (0.0, math.pi / 2, 0.0), (math.pi / 6, math.pi, 0.0)
    rank = [examine(task_jacobian(ARM, q)).rank for q in (said, unsaid)]
    square = [MM**2 * float(determinant(ARM, q)) for q in (said, unsaid)]
    return {
        "said": angles(said),
        "determinant": square[0],
        "rank": rank[0],
        "unsaid": angles(unsaid),
        "zero": square[1],
        "fallen": rank[1],
    }


def _axes() -> Values:
    q = _scara_posture()
    axes = [X_B[:3, 2] for X_B in base_transforms(SCARA.rows, q)[:3]]
    leaning = max(math.degrees(math.acos(min(1.0, float(z[2])))) for z in axes)
    wrist = Rotation.from_euler("XY", q[:2]).apply([MM * ARM.l2, 0.0, 0.0])
    return {"leaning": leaning, "height": wrist[2], "q": angles(q[:3])}


def _headings_of_scara() -> Values:
    q = _scara_posture()
    return {**_feet(_classic(SCARA.rows), SCARA, q), "lift": MM * q[3]}


def _half_turn() -> Values:
    turned = math.degrees(180.0) % 360.0
    return {"turned": turned, "lean": abs(turned - 180.0)}


def _lengths() -> Values:
    q = _scara_posture()[:3]
    true = MM**2 * float(determinant(ARM, q))
    return {
        "q": angles(q),
        "wrong": true * (GEOMETRY_B.l1 * GEOMETRY_B.l2) / (ARM.l1 * ARM.l2),
        "true": true,
    }


EFFECTS: Mapping[int, Callable[[], Values]] = {  # by the errata's numbers
    1: _damping_unit,
    2: _state_target,
    3: _greatest_speed,
    4: _sinusoid,
    6: _degrees_of_freedom,
    7: _first_forms,
    8: _missing_rates,
    9: _wrong_column,
    10: _hip_axis,
    11: _stretched,
    12: _height,
    13: lambda: {**_no_rotation_of_scara("T12"), **_third_rows("T12")},
    14: partial(_no_rotation_of_scara, "T34"),
    15: _three_joints_of_scara,
    16: _singular,
    17: _shifted_table,
    18: partial(_no_rotation_of_leg_b, "T12"),
    19: partial(_no_rotation_of_leg_b, "T34"),
    20: _wrong_pose,
    21: _wrong_jacobian,
    22: _gain,
    24: _velocity_command,
    25: _phase,
    27: _base_on_the_ground,
    28: _length_for_angle,
    29: lambda: _feet(_classic(LEG_A.rows), LEG_A, LegAOptions().posture()),
    30: _euler_rates,
    32: _demuxed,
    33: _axes,
    34: _headings_of_scara,
    35: _half_turn,
    36: _lengths,
    37: _headings_of_leg_b,
    38: _three_joints_of_leg_b,
}
