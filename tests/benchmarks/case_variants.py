"""Runs that are not the plain step: other inverses, disturbances, filters, robots, fast sines."""

from __future__ import annotations

import re
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from .measure import Contest
from .workers import ROOT

DURATION = 6.0  # [s]
FEW = 3  # repeats
LIMIT = 0.0035  # [N m]: a little less than the step takes
ACCURATE = 1e-9  # [m]: a foot that is nearer to the converged motion is on it


class Variant(NamedTuple):
    """Options of a run, and the steps at which it has converged."""

    name: str
    options: dict
    converged: float = 0.001  # [s]
    robot: str = "leg-b"
    only_ours: dict | None = None  # what the older checkout does without being told
    effect: str = ""  # entry of the disturbance that is not zero where the option acts


@cache
def own_robot():
    """Path of the robot that the docs type in, which has no closed form."""
    text = (ROOT / "docs" / "own-robots.md").read_text(encoding="utf-8")
    (robot,) = re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)
    path = Path(tempfile.mkdtemp(prefix="drake-leg-benchmark-"), "arm.toml")
    path.write_text(robot, encoding="utf-8")
    return str(path)


def variants():
    """All of them; each differs from the plain step in one thing."""
    return [
        Variant("plain step", {}),
        Variant("forward dynamics", {}, only_ours={"dynamics": "forward"}),
        Variant("damped inverse", {"inverse": "damped"}),
        Variant("limited inverse", {"inverse": "limited"}),
        Variant("push", {"push": [0.0, 0.0, 0.1]}),
        Variant("mass error", {"mass_error": 0.2}),
        Variant("torque limit", {"torque_limit": LIMIT}, 0.0005, effect="time_at_torque_limit_s"),
        Variant("filter of 1 ms", {"filter_time_constant": 0.001}, 0.0002),
        Variant("accuracy 1e-6", {"accuracy": 1e-6}),
        Variant("20 rad/s", {"frequency": 20.0}),
        Variant("own robot", {"q0": [0.0, 80.0, -90.0]}, robot=own_robot()),
    ]


def converged(crew, variant):
    """Measure an answer's distance from the motion that the run converges to [m]."""

    @cache
    def motion():
        options = {"duration": DURATION, **variant.options, "max_step": variant.converged}
        answer = crew.ours.ask("run", robot=variant.robot, options=options)
        foot, speed = np.array(answer["foot"]).T, np.array(answer["speed"]).T
        return CubicHermiteSpline(answer["time"], foot, speed)

    def error(answer):
        if variant.effect and not answer["disturbance"][variant.effect]:
            raise RuntimeError(f"the variant {variant.name!r} is the plain step: it has no effect")
        off = np.array(answer["foot"]).T - motion()(answer["time"])
        return float(np.linalg.norm(off, axis=1).max())

    return error


def contests(short, crew):
    """Each variant against the older checkout; without one, against nothing."""
    if short:
        return []
    return [
        Contest(
            name=f"variant: {variant.name}",
            work=f"{DURATION:g} s of {'leg B' if variant.robot == 'leg-b' else 'the docs arm'}",
            simulated=DURATION,
            unit="m",
            repeats=FEW,
            enough=ACCURATE,
            **crew.contest_of(
                "run",
                error=converged(crew, variant),
                robot=variant.robot,
                options={"duration": DURATION, **variant.options, **(variant.only_ours or {})},
                old={"options": {"duration": DURATION, **variant.options}},
            ),
        )
        for variant in variants()
    ]
