"""Many runs: a thousand steps on one core and on two, and a million designs in closed form."""

from __future__ import annotations

import time

import numpy as np
from scipy.integrate import solve_ivp

from drake_leg import run, sweep

from .measure import Contest, scaled, timed
from .motion import DURATION, Q0, rates
from .peers_loop import TOLERANCE

RUNS = 1000
FEWER_RUNS = 200  # on one core
SOLVED = 20  # runs of SciPy, scaled up
FEW = 3  # repeats of what takes long
DESIGNS = 2**20
VARIED = {"femur": "0.07:0.12", "amplitude": "0.02:0.06"}
FIELDS = ("stroke_m", "sigma_min_m")
CHECKED = 4  # designs that are also simulated
FINE = {"duration": 4.0, "max_step": 0.005}  # rows near the turning point, past which all repeats


def swept(workers, runs=RUNS, clock=time.perf_counter):
    """Steps of leg B with as many amplitudes, simulated without torques."""

    def work(_):
        return sweep(
            "leg-b",
            vary={"amplitude": f"0.02:0.07:{runs}"},
            dynamics="none",
            workers=workers,
        )

    cores = "one core" if workers == 1 else f"{workers} cores"
    return timed(f"drake-leg, {cores}", work, error=greatest_foot_error, clock=clock)


def greatest_foot_error(result):
    """Greatest error of all feet [m]; every run must have come to its end."""
    if result.counts.keys() != {"done"}:
        raise RuntimeError(f"the runs ended as {result.counts}")
    return float(np.max(result["max_position_error_m"]))


def on_two_cores():
    """The sweep as it is by default on this many cores."""
    return swept(2)


def on_one_core():
    """The same sweep in one process."""
    return swept(1)


def fewer():
    """Fewer of them in this process, by its CPU time."""
    return swept(1, FEWER_RUNS, time.process_time)


def scipy_runs():
    """SciPy alone: the same number of loops in math, one after the other."""
    return solved(RUNS, time.perf_counter)


def fewer_scipy_runs():
    """Fewer of them, by CPU time."""
    return solved(FEWER_RUNS, time.process_time)


def solved(runs, clock):
    """So many runs of SciPy, of which a part is carried out."""
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
        clock=clock,
    )
    return scaled(solving, runs / SOLVED)


def designs():
    """Stroke and smallest singular value of a million legs, without simulation."""
    return timed(
        "drake-leg, closed form",
        lambda _: sweep("leg-b", vary=VARIED, sample=DESIGNS, fields=FIELDS, workers=1),
        error=design_error,
    )


def design_error(result):
    """Compare some designs with their simulation: greatest difference [m]."""
    greatest = 0.0
    for row in np.linspace(0, DESIGNS - 1, CHECKED).astype(int):
        femur, amplitude = float(result["femur"][row]), float(result["amplitude"][row])
        summary = run("leg-b", l2=femur, amplitude=amplitude, **FINE).summary
        off = [abs(float(result[field][row]) - summary[field]) for field in FIELDS]
        greatest = max(greatest, *off)
    return greatest


def contests(short, crew):
    """Many runs on one core beside SciPy, and on two; many designs, beside nothing."""
    few = Contest(
        name="many runs, one core",
        work=f"{FEWER_RUNS} kinematic runs of 20 s, with their summaries",
        ours=fewer,
        peers=[fewer_scipy_runs],
        simulated=FEWER_RUNS * DURATION,
        unit="m",
        allowed=1e-9,
    )
    if short:
        return [few]
    return [
        few,
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
        Contest(
            name="many designs",
            work=f"stroke and smallest singular value of {DESIGNS} legs",
            ours=designs,
            peers=[],
            unit="m",
            allowed=1e-6,
            repeats=1,
        ),
    ]
