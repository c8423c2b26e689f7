"""Lets both robots walk in many ways, and prints what the summaries say beside a bound.

``python tests/walks.py [WORD ...]`` carries out all walks, or those with all words in their names.
Of walks at random, which a seed makes the same every time, it prints the worst values. It ends with
status 1 if a bound is missed.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drake_leg.diagrams.hexapod import build_driven, start_walking
from drake_leg.kinematics.walking.weights import total_mass
from drake_leg.robot.robot import Robot
from drake_leg.robot.solids import mass_properties
from drake_leg.runs.named import run
from drake_leg.runs.walk import config_of, findings
from drake_leg.runs.walk_options import WalkOptions
from drake_leg.runs.walk_record import WalkRecord
from drake_leg.simulation.run import simulate

ROBOTS = ("hexabot", "phantomx")
DISTANCE, HEADING = "distance_error_percent", "heading_error_deg"
SPREAD = "spread_of_distances_percent"
TILT = ("greatest_roll_error_deg", "greatest_pitch_error_deg")
STEADY = dict.fromkeys(TILT, 0.04) | {"greatest_slip_m": 1.2e-4, "height_ripple_m": 3e-4}
STRAIGHT = {DISTANCE: 0.3, HEADING: 0.03, **STEADY}
SLOPE = {"duration": 8.0, "slope": 10.0}
P800 = {"servo": "xl430", "gain": 800.0, "feed_forward": "none"}
FEELS = {"lift": 0.05, "feedback": 2.0, "touch_down": True, "duration": 12.0}
SEED, PUSHES, CONDITIONS = 15, 20, 40
PUSHED = "greatest_distance_from_plan_m"

Summary = Mapping[str, Any]


class Walk(NamedTuple):
    """Options of a run, and the greatest absolute values that its summary may have."""

    options: Mapping[str, Any]
    bounds: Mapping[str, float]

    def summaries(self, robot: str) -> Iterator[Summary]:
        """Carry the run out."""
        yield run("hexapod", robot=robot, force=True, **self.options).summary


class Pushed(NamedTuple):
    """Pushes at random times, in random directions."""

    speed: float  # [m/s] that the robot would get if it were free
    bounds: Mapping[str, float]

    def summaries(self, robot: str) -> Iterator[Summary]:
        """Carry the runs out."""
        random = np.random.default_rng(SEED)
        for direction, at in random.uniform((0.0, 3.0), (360.0, 4.0), (PUSHES, 2)).tolist():
            yield run(
                "hexapod",
                robot=robot,
                duration=8.0,
                push_speed=self.speed,
                push_at=at,
                push_direction=direction,
            ).summary


class AtRandom(NamedTuple):
    """Friction, stiffness of contacts, gains of servos and load are not what the plan expects."""

    bounds: Mapping[str, float]

    def summaries(self, robot: str) -> Iterator[Summary]:
        """Carry the runs out."""
        random = np.random.default_rng(SEED)
        for friction, stiffness, gain, load in random.uniform(
            (0.4, np.log(2e4), -1.0, -0.2), (1.2, np.log(5e5), 1.0, 0.2), (CONDITIONS, 4)
        ).tolist():
            options = WalkOptions(robot=robot, friction=friction, foot_stiffness=np.exp(stiffness))
            planned = config_of(options.the_robot, options)
            servo = planned.servo
            gains = {name: 2.0**gain * getattr(servo, name) for name in ("stiffness", "damping")}
            config = replace(
                planned, robot=loaded(planned.robot, load), servo=replace(servo, **gains)
            )
            done = simulate(
                build_driven(config, planned.plan),
                10.0,
                start=start_walking(config),
                max_step=config.time_step,
                guarded=False,
            )
            yield findings(WalkRecord(config=config, run=done)) | {"duration_s": 10.0}


class AtSteps(NamedTuple):
    """The same walk at several time steps."""

    steps: tuple[float, ...]  # [s]
    bounds: Mapping[str, float]

    def summaries(self, robot: str) -> Iterator[Summary]:
        """Carry the runs out, each with how far the distances are apart until then."""
        found: list[float] = []
        for step in self.steps:
            summary = run("hexapod", robot=robot, duration=6.0, time_step=step).summary
            found.append(summary[DISTANCE])
            yield {**summary, SPREAD: max(found) - min(found)}


def loaded(robot: Robot, part: float) -> Robot:
    """Change the mass of a robot's body by a part of the mass of the whole robot."""
    link = robot.base_link
    mass = total_mass(robot)
    if link.inertial is None:
        factor = 1.0 + part * mass / mass_properties(link.solid).mass
        heavier = replace(link, solid=replace(link.solid, density=factor * link.solid.density))
    else:
        own = link.inertial
        factor = 1.0 + part * mass / own.mass
        heavier = replace(
            link,
            inertial=replace(
                own,
                mass=factor * own.mass,
                moments=tuple(factor * each for each in own.moments),
                products=tuple(factor * each for each in own.products),
            ),
        )
    return replace(robot, base_link=heavier)


WALKS = {
    "tripod forward": Walk({}, STRAIGHT),
    "tripod back": Walk({"speed": -0.1}, STRAIGHT),
    "tripod sideways": Walk({"sideways": 0.1}, STRAIGHT | {DISTANCE: 0.4}),
    "tripod diagonal": Walk({"speed": 0.07, "sideways": 0.07}, STRAIGHT | {HEADING: 0.1}),
    "tripod arc": Walk({"speed": 0.08, "turn": 14.324}, STRAIGHT | {HEADING: 0.6}),
    "ripple": Walk({"gait": "ripple", "speed": 0.05}, STRAIGHT),
    "ripple-pairs": Walk({"gait": "ripple-pairs", "speed": 0.05}, STRAIGHT),
    "wave": Walk({"gait": "wave", "speed": 0.03}, STRAIGHT),
    "1 m and stop": Walk({"distance": 1.0}, {"greatest_distance_from_plan_m": 2e-3}),
    "another direction on the way": Walk(
        {"then": "sideways=0.1 at=4; turn=15 speed=0.05 at=7"}, {DISTANCE: 0.3, HEADING: 0.1}
    ),
    "another gait on the way": Walk(
        {"then": "gait=wave speed=0.03 at=4; sideways=0.03 at=12"}, {DISTANCE: 0.3, HEADING: 0.1}
    ),
    "turn by 90 deg": Walk({"angle": 90.0, "turn": 20.0}, {HEADING: 0.7}),
    "turn by 90 deg, feedback": Walk(
        {"angle": 90.0, "turn": 20.0, "feedback": 2.0}, {HEADING: 0.02}
    ),
    "attitude": Walk(
        {"speed": 0.0, "roll": 5.0, "pitch": -5.0, "duration": 3.0}, dict.fromkeys(TILT, 0.06)
    ),
    "height 70 mm": Walk(
        {"speed": 0.0, "height": 0.07, "duration": 3.0}, {"mean_height_error_m": 2e-4}
    ),
    "height 110 mm": Walk(
        {"speed": 0.0, "height": 0.11, "duration": 3.0}, {"mean_height_error_m": 2e-4}
    ),
    "0.2 m/s": Walk({"speed": 0.2, "period": 0.8}, {DISTANCE: 0.4}),
    "0.3 m/s": Walk({"speed": 0.3, "period": 0.62, "duty": 0.5}, {DISTANCE: 0.8}),
    "xl430, gain 800, feedback": Walk(P800 | {"feedback": 4.0}, {DISTANCE: 0.6}),
    "xl430, gain 800, feedback, 10 deg up": Walk(P800 | SLOPE | {"feedback": 4.0}, {DISTANCE: 0.6}),
    "10 deg up": Walk(SLOPE, {DISTANCE: 2.0}),
    "10 deg up, feedback": Walk(SLOPE | {"feedback": 2.0}, {DISTANCE: 0.2}),
    "10 deg across, feedback": Walk(
        {"across": 10.0, "feedback": 2.0, "duration": 8.0}, {"off_course_m": 2e-3}
    ),
    "step of 20 mm, feedback": Walk(
        {"steps": 0.02, "step_count": 1.0, "lift": 0.05, "feedback": 2.0, "duration": 12.0},
        {DISTANCE: 0.5},
    ),
    "step of 30 mm, feedback, touch-down": Walk(
        FEELS | {"steps": 0.03, "step_count": 1.0}, {DISTANCE: 0.5}
    ),
    "step of 20 mm down, feedback, touch-down": Walk(
        FEELS | {"steps": -0.02, "step_count": 1.0}, {DISTANCE: 0.5}
    ),
    "blocks of 20 mm, feedback, touch-down": Walk(FEELS | {"blocks": 0.02}, {DISTANCE: 0.5}),
    "friction 0.05": Walk({"friction": 0.05}, {DISTANCE: 0.5}),
    "20 pushes of 0.5 m/s": Pushed(0.5, {PUSHED: 0.010}),
    "20 pushes of 1 m/s": Pushed(1.0, {PUSHED: 0.060}),
    "40 conditions at random": AtRandom(
        {DISTANCE: 1.0, **dict.fromkeys(TILT, 0.2), "greatest_slip_m": 6e-4}
    ),
    "time steps of 0.5 to 5 ms": AtSteps(
        (0.0005, 0.001, 0.002, 0.005), {DISTANCE: 0.05, SPREAD: 0.05}
    ),
}


def main(words: list[str]) -> int:
    """Carry out the walks whose names have all words."""
    missed = 0
    for name, walk in WALKS.items():
        for robot in ROBOTS:
            if all(word in f"{name}, {robot}" for word in words):
                missed += report(f"{name}, {robot}", walk.bounds, walk.summaries(robot))
    print(f"{missed} bounds missed")
    return 1 if missed else 0


def report(name: str, bounds: Mapping[str, float], summaries: Iterator[Summary]) -> int:
    """Print the worst values of walks, and count the bounds that they miss."""
    began = time.process_time()
    found = list(summaries)
    speed = sum(each["duration_s"] for each in found) / (time.process_time() - began)
    worst = {key: max((each[key] for each in found), key=abs) for key in bounds}
    late = [key for key, bound in bounds.items() if not abs(worst[key]) <= bound]
    falls = sum(each["fell"] for each in found)
    values = ", ".join(
        f"{key} {worst[key]:.4g}{' > ' if key in late else ' / '}{bound:g}"
        for key, bound in bounds.items()
    )
    margin = 1e3 * min(each["least_static_margin_m"] or 0.0 for each in found)
    costs = "/".join(
        f"{max(each[f'{kind}_cost_of_transport'] or 0.0 for each in found):.2f}"
        for kind in ("mechanical", "electrical")
    )
    print(
        f"{name}: {f'{falls} FELL ' if falls else ''}{values}; margin {margin:.0f} mm, "
        f"cost {costs}, {speed:.1f} x",
        flush=True,
    )
    return len(late) + falls


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
