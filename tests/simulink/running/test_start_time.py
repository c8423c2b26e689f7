"""Models that start at other times than 0."""

import numpy as np
import pytest
from rigs import Rig, shown

from drake_leg.errors import InvalidValueError


def rig_from(start, stop="0", **solver):
    rig = Rig(solver={"StartTime": start, "StopTime": stop, **solver})
    clock = rig.block("Clock", "clock")
    rig.show(clock, "t")
    return rig, clock


@pytest.mark.parametrize("start", ["-3", "2"])
def test_signals_tell_the_models_time(tmp_path, start):
    rig, clock = rig_from(start)
    rig.show(rig.block("Integrator", "area", clock), "area")
    rig.show(rig.block("Step", "step", Time=f"{start}+0.25", After="4"), "step")
    rig.show(rig.block("Sin", "sine", Frequency="2"), "sine")
    run = rig.run(tmp_path)
    t, begins = run.time, float(start)
    assert (run.began, t[0], t[-1], run.ended) == (begins, begins, begins + 1.0, begins + 1.0)
    assert shown(run, "t") == pytest.approx(t, abs=1e-12)
    assert shown(run, "area") == pytest.approx((t**2 - begins**2) / 2.0, abs=1e-9)
    assert shown(run, "step") == pytest.approx(np.where(t >= begins + 0.25 - 1e-12, 4.0, 0.0))
    assert shown(run, "sine") == pytest.approx(np.sin(2.0 * t), abs=1e-12)


@pytest.mark.parametrize("start", ["-0.95", "0.95"])
def test_blocks_are_sampled_at_multiples_of_their_period(tmp_path, start):
    rig, clock = rig_from(start)
    rig.show(rig.block("ZeroOrderHold", "held", clock, SampleTime="0.1"), "held")
    run = rig.run(tmp_path)
    expected = np.maximum(np.floor(run.time / 0.1 + 1e-9) * 0.1, float(start))
    assert shown(run, "held") == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("start", ["1", "2", "-1"])
def test_what_is_sampled_once_a_period_is_so_at_any_start(tmp_path, start):
    """A counter goes up at every sample time, a Memory gives what was at the step before."""
    rig, clock = rig_from(start)
    count = rig.block("UnitDelay", "count", "", SampleTime="1")
    rig.connect(rig.block("Sum", "next", count, rig.constant("1"), Inputs="++"), count)
    rig.show(count, "count")
    rig.show(rig.block("Memory", "memory", clock, InitialCondition="7"), "memory")
    run = rig.run(tmp_path, duration=4.0)
    late = (run.time - float(start)) % 1.0 > 1e-6
    assert shown(run, "count")[late] == pytest.approx(np.floor(run.time - float(start))[late])
    assert shown(run, "memory")[0] == 7.0
    assert shown(run, "count")[-1] == 4.0


def test_rates_are_taken_since_the_start(tmp_path):
    rig, clock = rig_from("5")
    rig.show(rig.block("Derivative", "slope", clock), "slope")
    rig.show(rig.block("RateLimiter", "limited", clock), "limited")
    rig.show(rig.block("DiscretePulseGenerator", "pulse", Period="0.4", PulseWidth="50"), "pulse")
    run = rig.run(tmp_path)
    assert shown(run, "slope")[2:] == pytest.approx(1.0, abs=1e-6)
    assert shown(run, "limited") == pytest.approx(run.time, abs=1e-9)
    off_edges = np.abs(run.time / 0.2 - np.round(run.time / 0.2)) > 1e-3
    pulse = np.where(np.mod(run.time, 0.4) < 0.2, 1.0, 0.0)
    assert shown(run, "pulse")[off_edges] == pytest.approx(pulse[off_edges])


def test_a_stop_before_the_start_is_refused(tmp_path):
    rig, _ = rig_from("5", "2")
    with pytest.raises(InvalidValueError, match="starts at 5 s and stops at 2 s"):
        rig.run(tmp_path, duration=None)
