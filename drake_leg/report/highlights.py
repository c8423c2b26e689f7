"""What the reports ask and say, answered at the top of the page in a line each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from markupsafe import Markup

from drake_leg.errata.erratum import number
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.report.errata import errata_by_number
from drake_leg.report.markup import power, prose
from drake_leg.report.runs import GAIN, RUNS
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.outcome import Outcome
from drake_leg.singularity.stroke import leg_stroke


def highlights(outcomes: Mapping[str, Outcome]) -> Iterator[tuple[str, Markup, str, str]]:
    """Return questions, answers, and the anchors and labels of the items that show them."""
    step, options = outcomes["leg-b"], LegBOptions()
    room = leg_stroke(
        LegGeometry.from_robot(step.robot), options.posture(), options.unit_direction()
    )
    yield (
        "Can the leg make a strictly forward step?",
        Markup(
            f"<b>Yes.</b> The foot goes {number(1e3 * step.summary['stroke_m'])}&nbsp;mm along x "
            f"and leaves its line by at most {power(step.summary['max_off_axis_m'])}&nbsp;m; it "
            f"could go {number(1e3 * room.length)}&nbsp;mm."
        ),
        "a02_4",
        "A 2.4",
    )
    yield (
        "Where is it singular?",
        prose(
            "Where the leg is stretched or folded, sin q3 = 0, as printed; and where the foot is "
            "on the hip's axis, which report A's text leaves out."
        ),
        "a_appendix_singular",
        "A appendix",
    )
    start, rest, held = (
        math.degrees(value)
        for value in (
            outcomes["pendulum-damped"].summary["q0_rad"],
            outcomes["pendulum-damped"].summary["rest_angle_rad"],
            outcomes["pendulum-spring"].summary["rest_angle_rad"],
        )
    )
    yield (
        "Does a state target attract the pendulum?",
        Markup(
            f"<b>No.</b> It starts at {number(start)}° and comes to rest hanging, at "
            f"{number(rest)}°. A spring holds it, at {number(held)}°."
        ),
        "a06",
        "A 6",
    )
    yield (
        "Is the velocity ten times the input?",
        Markup(f"<b>Only with a gain</b> of {number(GAIN, 0)} in the diagram: J J⁻¹ = 1."),
        "b10",
        "B 10",
    )
    yield (
        "How far are the runs from the exact answer?",
        Markup(
            f"At most {power(_worst(outcomes, 'max_position_error_m'))}&nbsp;m and "
            f"{power(_worst(outcomes, 'max_angle_error_rad'))}&nbsp;rad."
        ),
        "runs",
        "the runs",
    )
    yield (
        "What is wrong in print?",
        Markup(f"{len(errata_by_number())} errata, each with its effect in numbers."),
        "errata",
        "errata",
    )


def _worst(outcomes: Mapping[str, Outcome], measure: str) -> float:
    return max(float(outcomes[key].summary.get(measure, 0.0)) for key in RUNS)
