"""Many runs: a thousand steps on one core and on two."""

from __future__ import annotations

import time

import numpy as np
from scipy.integrate import solve_ivp

from drake_leg import sweep

from .measure import Contest, scaled, timed
from .motion import DURATION, Q0, rates
from .peers_loop import TOLERANCE

RUNS = 1000
SOLVED = 20  # runs of SciPy, scaled up
FEW = 3  # repeats of what takes long


def swept(workers):
    """Steps of leg B with a thousand amplitudes, simulated without torques."""

    def work(_):
        return sweep(
            "leg-b",
            vary={"amplitude": f"0.02:0.07:{RUNS}"},
            dynamics="none",
            workers=workers,
        )

    cores = "one core" if workers == 1 else f"{workers} cores"
    return timed(f"drake-leg, {cores}", work, error=greatest_foot_error, clock=time.perf_counter)


def greatest_foot_error(result):
    """Greatest error of all feet [m]; every run must have come to its end."""
    if result.counts != {"done": RUNS}:
        raise RuntimeError(f"the runs ended as {result.counts}")
    return float(np.max(result["max_position_error_m"]))


def on_two_cores():
    """The sweep as it is by default on this many cores."""
    return swept(2)


def on_one_core():
    """The same sweep in one process."""
    return swept(1)


def scipy_runs():
    """SciPy alone: the same number of loops in math, one after the other."""
    from .motion import foot_error

    def work(_):
        return [
            solve_ivp(rates, (0.0, DURATION), Q0, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE)
            for _ in range(SOLVED)
        ]

    solving = timed(
        "scipy DOP853, math, one core",
        work,
        error=lambda found: max(foot_error(one.t, one.y.T) for one in found),
        clock=time.perf_counter,
    )
    return scaled(solving, RUNS / SOLVED)


def contests(short, crew):
    """Many runs on two cores, beside one core and SciPy."""
    if short:
        return []
    return [
        Contest(
            name="many runs",
            work=f"{RUNS} kinematic runs of 20 s, with their summaries",
            ours=on_two_cores,
            peers=[on_one_core, scipy_runs],
            simulated=RUNS * DURATION,
            unit="m",
            allowed=1e-9,
            repeats=FEW,
        ),
    ]
