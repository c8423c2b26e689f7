"""Lets both robots walk in many ways, and prints what the summaries say beside a bound.

``python tests/walks.py [WORD ...]`` carries out all walks, or those with a word in their name. It
ends with status 1 if a bound is missed.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from typing import Any, NamedTuple

from drake_leg.runs.named import run

ROBOTS = ("hexabot", "phantomx")
DISTANCE, HEADING = "distance_error_percent", "heading_error_deg"
TILT = ("greatest_roll_error_deg", "greatest_pitch_error_deg")
STEADY = dict.fromkeys(TILT, 0.04) | {"greatest_slip_m": 1.2e-4, "height_ripple_m": 3e-4}
STRAIGHT = {DISTANCE: 0.3, HEADING: 0.03, **STEADY}
SLOPE = {"duration": 8.0, "slope": 10.0}
P800 = {"servo": "xl430", "gain": 800.0, "feed_forward": "none"}


class Walk(NamedTuple):
    """Options of a run, and the greatest absolute values that its summary may have."""

    options: Mapping[str, Any]
    bounds: Mapping[str, float]


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
    "0.3 m/s": Walk({"speed": 0.3, "period": 0.6}, {DISTANCE: 0.8}),
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
    "friction 0.05": Walk({"friction": 0.05}, {DISTANCE: 0.5}),
    "push of 0.5 m/s": Walk({"push_speed": 0.5, "push_at": 4.0}, {"off_course_m": 0.010}),
    "push of 1 m/s": Walk({"push_speed": 1.0, "push_at": 4.0}, {"off_course_m": 0.060}),
    **{
        f"time step {1e3 * step:g} ms": Walk({"time_step": step, "duration": 6.0}, {DISTANCE: 0.15})
        for step in (0.0005, 0.001, 0.002, 0.005)
    },
}


def main(words: list[str]) -> int:
    """Carry out the walks whose names have all words."""
    missed = 0
    for name, walk in WALKS.items():
        if not all(word in name for word in words):
            continue
        for robot in ROBOTS:
            began = time.process_time()
            summary = run("hexapod", robot=robot, force=True, **walk.options).summary
            speed = summary["duration_s"] / (time.process_time() - began)
            missed += report(f"{name}, {robot}", walk, summary, speed)
    print(f"{missed} bounds missed")
    return 1 if missed else 0


def report(name: str, walk: Walk, summary: Mapping[str, Any], speed: float) -> int:
    """Print a walk's values, and count the bounds that it misses."""
    late = [key for key, bound in walk.bounds.items() if not abs(summary[key]) <= bound]
    fell = " FELL" if summary["fell"] else ""
    values = ", ".join(
        f"{key} {summary[key]:.4g}{' > ' if key in late else ' / '}{bound:g}"
        for key, bound in walk.bounds.items()
    )
    margin = 1e3 * (summary["least_static_margin_m"] or 0.0)
    costs = "/".join(
        f"{summary[f'{kind}_cost_of_transport'] or 0.0:.2f}"
        for kind in ("mechanical", "electrical")
    )
    print(
        f"{name}:{fell} {values}; margin {margin:.0f} mm, cost {costs}, {speed:.1f} x", flush=True
    )
    return len(late) + bool(fell)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
