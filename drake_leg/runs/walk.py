"""The run of a robot that walks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from pydrake.systems.framework import Diagram
from scipy.spatial.transform import Rotation

from drake_leg.diagrams.hexapod import HexapodConfig, build, start_walking
from drake_leg.errors import ImpossibleWalkError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.foresight import WalkForesight, foresee_walk
from drake_leg.kinematics.walking.power import (
    cost_of_transport,
    electrical_power,
    mechanical_power,
    work,
)
from drake_leg.kinematics.walking.sequence import WalkSequence
from drake_leg.kinematics.walking.touch_down import EARLY, LATE, MISSED, ON_TIME, SEARCH_DEPTH
from drake_leg.kinematics.walking.weights import total_mass
from drake_leg.robot.robot import Robot
from drake_leg.runs.outcome import Outcome
from drake_leg.runs.walk_options import WalkOptions
from drake_leg.runs.walk_record import WalkRecord
from drake_leg.simulation.integrator import ROW_INTERVAL
from drake_leg.simulation.recording import Recording, lettered, numbered
from drake_leg.simulation.run import Progress, Start, simulate

KINDS = ("hip", "knee", "ankle")
AT_REST = 1e-6  # [m]: a body that was to go less far has no cost of transport


def run(robot: Robot, options: WalkOptions, progress: Progress | None = None) -> Outcome:
    """Let a robot walk.

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    ImpossibleWalkError
        If the robot cannot make the walk, unless it is forced.
    """
    foreseen = _foreseen(robot, options)
    if not options.force:
        _require_lift(options)
        for part in foreseen:
            part.require_walkable()
    config = config_of(robot, options)
    done = simulate(
        build(config),
        options.the_duration,
        start=start_walking(config),
        max_step=min(config.time_step, ROW_INTERVAL),
        progress=progress,
        guarded=False,
    )
    record = WalkRecord(config=config, run=done)
    common = {
        "robot": robot.name,
        "duration_s": options.the_duration,
        "stopped_at_s": done.stopped_at,
        "stop_reason": done.stop_reason,
        "time_step_s": config.time_step,
        "settled_at_s": record.settled_at,
        "rows": len(done.time),
        "real_time_factor": done.real_time_factor,
    }
    return Outcome(
        robot=robot,
        recording=Recording(_columns(record)),
        exact={name: record.planned.value[:, row, 3] for row, name in enumerate(("x", "y", "z"))},
        summary={
            **common,
            **findings(record),
            **_of_changes(options),
            **_of_foresight(foreseen),
        },
        subject="walk",
    )


def diagram(robot: Robot, options: WalkOptions) -> tuple[Diagram, Start]:
    """Build the diagram of a run; return it with its start."""
    config = config_of(robot, options)
    return build(config), start_walking(config)


def config_of(robot: Robot, options: WalkOptions) -> HexapodConfig:
    """Return the config of a run's diagram; an option that makes no sense is refused."""
    from drake_leg.models.walker import Contact

    return HexapodConfig(
        robot=robot,
        walk=options.the_walk(),
        servo=options.the_servo,
        feed_forward=options.feed_forward,
        feedback=options.feedback,
        level=options.level,
        touch_down=options.touch_down,
        search_depth=SEARCH_DEPTH if options.search_depth is None else options.search_depth,
        ground=options.the_ground,
        contact=Contact(stiffness=options.foot_stiffness, foot_radius=options.foot_radius),
        payload=options.payload,
        push=options.the_push,
        time_step=options.time_step,
        gravity=options.gravity,
    )


def _require_lift(options: WalkOptions) -> None:
    """Refuse a ground that rises at once by more than blind swings are high.

    Raises
    ------
    ImpossibleWalkError
        With the least lift.
    """
    rise = max(options.steps or 0.0, options.blocks or 0.0)
    lift = min(pace.lift for pace in options.the_paces)
    if rise >= lift and not options.touch_down:
        raise ImpossibleWalkError(
            f"the ground rises by up to {rise:g} m at once, and a swing of {lift:g} m is no higher",
            advice=f"choose a `lift` of more than {rise:g} m, or `touch_down=True`, with which "
            "feet climb; `force=True` goes on",
            where="",
            time=0.0,
            value=rise,
            limit=lift,
        )


def _foreseen(robot: Robot, options: WalkOptions) -> tuple[WalkForesight, ...]:
    """Foresee each part of the walk."""
    walk, duration = options.the_walk(), options.the_duration
    parts = walk.parts if isinstance(walk, WalkSequence) else (walk,)
    ends = [*(part.begins for part in parts[1:]), duration]
    return tuple(
        foresee_walk(
            robot,
            part,
            options.the_servo,
            ground=options.the_ground,
            gravity=options.gravity,
            dynamic=options.dynamic,
            duration=min(end, duration),
            foot_height=options.foot_radius,
        )
        for part, end in zip(parts, ends, strict=True)
        if part.begins < duration
    )


def _of_foresight(foreseen: tuple[WalkForesight, ...]) -> dict[str, Any]:
    """What was known before: what fails, and the least planned margin."""
    margins = [part.demand("static margin") for part in foreseen]
    known = [margin.value for margin in margins if margin is not None]
    return {
        "foreseen": next((part.refusal for part in foreseen if part.refusal), None),
        "planned_static_margin_m": _finite(min(known)) if len(known) == len(margins) else None,
    }


def _of_changes(options: WalkOptions) -> dict[str, Any]:
    """How the robot walks after each change that was asked for."""
    return {
        "changes": [
            {
                "at_s": pace.at,
                "gait": pace.gait.name,
                "period_s": pace.period,
                "forward_m_s": pace.forward,
                "sideways_m_s": pace.sideways,
                "turning_deg_s": pace.turn,
            }
            for pace in options.the_paces[1:]
        ]
        or None
    }


def _columns(record: WalkRecord) -> dict[str, Array]:
    """Columns of the recording; places and forces are in the frame of the ground."""
    rows, legs = len(record.time), record.config.legs.names
    joints = 3 * len(legs)
    X_GB, planned = record.body, record.planned.value
    columns = {"time[s]": record.time}
    columns |= lettered("", "xyz", "m", X_GB[:, :3, 3])
    columns |= lettered("q", "wxyz", "", _quaternions(X_GB))
    for name, values, unit in (
        ("q", record.q, "rad"),
        ("qdot", record.rates, "rad/s"),
        ("tau", record.torques, "N*m"),
    ):
        columns |= numbered(name, [unit] * joints, values.reshape(rows, joints))
    for number, leg in enumerate(legs):
        columns |= lettered(f"{leg}_", "xyz", "m", record.feet[:, number])
        columns |= lettered(f"{leg}_f", "xyz", "N", record.forces[:, number])
        columns[f"{leg}_down"] = record.planned_down[:, number].astype(np.float64)
        columns[f"{leg}_loaded"] = record.loaded[:, number].astype(np.float64)
    columns |= lettered("com_", "xyz", "m", record.centre_of_mass)
    columns |= lettered("under_com_", "xy", "m", record.under_centre_of_mass)
    columns |= lettered("zmp_", "xy", "m", record.zero_moment_point)
    columns["static_margin[m]"] = record.static_margin
    columns["dynamic_margin[m]"] = record.dynamic_margin
    columns |= lettered("planned_", "xyz", "m", planned[:, :3, 3])
    columns |= lettered("planned_q", "wxyz", "", _quaternions(planned))
    columns["power[W]"] = record.power
    return columns


def _quaternions(X: Array) -> Array:
    """(rows, 4), w first and not negative."""
    return np.asarray(Rotation.from_matrix(X[:, :3, :3]).as_quat(canonical=True, scalar_first=True))


def findings(record: WalkRecord) -> dict[str, Any]:
    """What a summary says of a recorded walk."""
    servo, walk = record.config.servo, record.config.walk
    return {
        "gait": walk.gait.name,
        "period_s": walk.period,
        "servo": servo.name,
        "slope_deg": math.degrees(record.config.ground.slope),
        "across_deg": math.degrees(record.config.ground.across),
        "ground": asdict(record.config.ground),
        **_course(record),
        **_steadiness(record),
        **_support(record),
        **_touch_downs(record),
        **_effort(record),
        "fell": record.fell_at is not None,
        "fell_at_s": record.fell_at,
        "inaccuracy": None,
    }


def _course(record: WalkRecord) -> dict[str, Any]:
    """How far the body went, and how far off its planned course and heading it ends."""
    planned = record.planned
    velocity = planned.rate[:, :3, 3]
    speed = np.linalg.norm(velocity, axis=1)
    length = float(np.trapezoid(speed, record.time))
    moves = np.flatnonzero(speed > AT_REST)
    off = record.body[-1, :3, 3] - planned.value[-1, :3, 3]
    start = record.body[0, :3, 3] - planned.value[0, :3, 3]
    ahead = across = 0.0
    if len(moves):
        forward = velocity[moves[-1]] / speed[moves[-1]]
        left = np.array([-forward[1], forward[0], 0.0])
        ahead, across = float(forward @ (off - start)), float(left @ (off - start))
    heading = np.degrees(record.tilts[:, 2])
    turned = math.degrees(_turned(planned.value) - _turned(planned.value[:1]))
    lasted = float(record.time[-1])
    return {
        "commanded_distance_m": length,
        "distance_m": length + ahead,
        "distance_error_percent": 100.0 * ahead / length if length > AT_REST else None,
        "off_course_m": across,
        "greatest_distance_from_plan_m": float(np.linalg.norm(record.offsets[:, :2], axis=1).max()),
        "mean_speed_m_s": (length + ahead) / lasted if lasted else 0.0,
        "commanded_turn_deg": turned,
        "turn_deg": turned + float(heading[-1]),
        "heading_error_deg": float(heading[-1]),
        "greatest_heading_error_deg": float(np.abs(heading).max()),
    }


def _turned(X: Array) -> float:
    """Yaw of the last of poses (rows, 4, 4) [rad], whole turns since the first included."""
    return float(np.unwrap(np.arctan2(X[:, 1, 0], X[:, 0, 0]))[-1])


def _steadiness(record: WalkRecord) -> dict[str, Any]:
    tilts, heights = record.tilts[record.settled], record.offsets[record.settled, 2]
    roll, pitch, _ = np.degrees(np.abs(tilts)).max(axis=0).tolist()
    return {
        "greatest_roll_error_deg": roll,
        "greatest_pitch_error_deg": pitch,
        "height_ripple_m": float(np.ptp(heights)),
        "mean_height_error_m": float(heights.mean()),
    }


def _support(record: WalkRecord) -> dict[str, Any]:
    settled, legs = record.settled, record.config.legs.names
    slips, swings = record.slips, record.swing_heights
    vertical = record.forces[settled, :, 2]
    carried = np.abs(record.force_on_body[settled]).max() > 0.1 * record.weight
    return {
        "greatest_slip_m": float(slips.max()) if len(slips) else None,
        "mean_slip_m": float(slips.mean()) if len(slips) else None,
        "least_static_margin_m": _finite(record.static_margin[settled].min()),
        "least_dynamic_margin_m": _finite(_least(record.dynamic_margin[settled])),
        "clearance_m": float(swings.min()) if len(swings) else None,
        "greatest_contact_force_n": dict(zip(legs, vertical.max(axis=0).tolist(), strict=True)),
        "mean_contact_force_n": dict(zip(legs, vertical.mean(axis=0).tolist(), strict=True)),
        "body_touched_ground": bool(carried),
    }


def _touch_downs(record: WalkRecord) -> dict[str, Any]:
    """How many feet found the ground as planned, early, late, or not at all; None if not felt."""
    counts = record.touch_downs
    return {
        "touch_downs_on_time": None if counts is None else counts[ON_TIME],
        "touch_downs_early": None if counts is None else counts[EARLY],
        "touch_downs_late": None if counts is None else counts[LATE],
        "touch_downs_not_found": None if counts is None else counts[MISSED],
    }


def _effort(record: WalkRecord) -> dict[str, Any]:
    """Torques, speeds, power, and what a walk costs."""
    settled, servo, config = record.settled, record.config.servo, record.config
    torques, rates = record.torques[settled], record.rates[settled]
    time, drive = record.time[settled], record.drive[settled]
    mechanical = mechanical_power(servo, drive, rates).sum(axis=(1, 2))
    found: dict[str, Any] = {
        "peak_torque_n_m": _by_kind(np.abs(torques).max(axis=(0, 1))),
        "rms_torque_n_m": _by_kind(np.sqrt((torques**2).mean(axis=(0, 1)))),
        "peak_joint_rate_rad_s": _by_kind(np.abs(rates).max(axis=(0, 1))),
        "stall_torque_n_m": servo.stall_torque,
        "no_load_speed_rad_s": servo.no_load_speed,
        "rows_at_torque_limit": int(
            (np.abs(drive) >= servo.stall_torque * (1 - 1e-9)).any((1, 2)).sum()
        ),
        "mean_mechanical_power_w": float(mechanical.mean()),
        "mean_electrical_power_w": None,
        "mechanical_cost_of_transport": None,
        "electrical_cost_of_transport": None,
        "moving_mechanical_cost_of_transport": None,
        "moving_electrical_cost_of_transport": None,
    }
    powers = {"mechanical": mechanical}
    if servo.is_electrical:
        powers["electrical"] = electrical_power(servo, drive, rates).sum(axis=(1, 2))
        found["mean_electrical_power_w"] = float(powers["electrical"].mean())
    speed = np.linalg.norm(record.planned.rate[settled, :3, 3], axis=1)
    if config.gravity > 0.0 and float(np.trapezoid(speed, time)) > AT_REST:
        mass = total_mass(config.robot) + config.payload
        ways = np.linalg.norm(np.diff(record.body[settled, :2, 3], axis=0), axis=1)
        moves = speed > AT_REST
        moved = float(ways[moves[1:] & moves[:-1]].sum())
        for kind, power in powers.items() if moved else ():
            spent, moving = work(time, power), work(time, np.where(moves, power, 0.0))
            for name, energy, way in (("", spent, float(ways.sum())), ("moving_", moving, moved)):
                found[f"{name}{kind}_cost_of_transport"] = cost_of_transport(
                    energy, mass, way, config.gravity
                )
    return found


def _by_kind(values: Array) -> Mapping[str, float]:
    return dict(zip(KINDS, values.tolist(), strict=True))


def _least(values: Array) -> float:
    """Least value; NaN if there is none."""
    return float(np.nanmin(values)) if np.isfinite(values).any() else float("nan")


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
