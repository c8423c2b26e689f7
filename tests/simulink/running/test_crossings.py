"""Zero crossings: corners and jumps of signals, and what happens where a sign changes."""

import numpy as np
import pytest
from rigs import Rig, shown

from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.running import run_model, runnable

W, SIZE = 5.0, 3.0  # a wave of so many rad/s, and so large
ON = np.arcsin(1.0 / SIZE) / W  # [s], where it is at 1 first


def wave(rig, phase="0"):
    return rig.block("Sin", "wave", Amplitude="3", Frequency="5", Phase=phase)


def sent(signal, end):
    """Integrate a signal of the wave over time, by fine sums."""
    t = np.linspace(0.0, end, 1_000_001)
    return np.trapezoid(signal(SIZE * np.sin(W * t)), t)


BENT = {
    "saturation": ("Saturate", {"UpperLimit": "1", "LowerLimit": "-1"},
                   lambda u: np.clip(u, -1.0, 1.0)),
    "dead zone": ("DeadZone", {"LowerValue": "-1", "UpperValue": "1"},
                  lambda u: u - np.clip(u, -1.0, 1.0)),
    "abs": ("Abs", {}, np.abs),
    "sign": ("Signum", {}, np.sign),
}  # fmt: skip


@pytest.mark.parametrize("name", BENT)
def test_the_error_control_meets_corners_and_jumps(name, tmp_path):
    """At the usual accuracy of 1e-6 an integral is off by no more than some 1e-6 of a crossing."""
    kind, parameters, law = BENT[name]
    rig = Rig()
    bent = rig.block(kind, name, wave(rig), **parameters)
    rig.show(rig.block("Integrator", "integral", bent), "y")
    run = run_model(runnable(read_model(rig.write(tmp_path / "m.slx")), duration=2.0))
    assert abs(shown(run, "y")[-1] - sent(law, 2.0)) < 1e-5


def test_the_error_control_meets_switches_and_relays(tmp_path):
    """A Switch jumps by 3 at each zero of the wave, a Relay at 1 and -1: within 2 us each."""
    rig = Rig()
    u = wave(rig)
    switch = rig.block("Switch", "switch", rig.constant("2"), u, rig.constant("-1"),
                       Threshold="0", Criteria="u2 > Threshold")  # fmt: skip
    rig.show(rig.block("Integrator", "of switch", switch), "switch")
    relay = rig.block("Relay", "relay", u, OnSwitchValue="1", OffSwitchValue="-1")
    rig.show(rig.block("Integrator", "of relay", relay), "relay")
    run = run_model(runnable(read_model(rig.write(tmp_path / "m.slx")), duration=2.0))
    expected = sent(lambda u: np.where(u > 0.0, 2.0, -1.0), 2.0)
    assert abs(shown(run, "switch")[-1] - expected) < 4 * 3.0 * 2e-6
    # On from ON, off from half a period later on, and the same once more.
    assert abs(shown(run, "relay")[-1] - 2.0 * np.pi / W) < 4 * 2e-6


def test_a_state_is_set_again_where_a_signal_rises(tmp_path):
    rig = Rig()
    rig.show(rig.block("Integrator", "reset", rig.constant("1"), wave(rig, "-1"),
                       ExternalReset="rising"), "y")  # fmt: skip
    run = rig.run(tmp_path, 2.0, accuracy=1e-6)
    last = 1.0 / W + 2.0 * np.pi / W
    assert shown(run, "y")[-1] == pytest.approx(2.0 - last, abs=1e-10)


@pytest.mark.parametrize("integrates", [True, False])
def test_a_triggered_subsystem_runs_where_its_signal_falls(integrates, tmp_path):
    """It puts out the time; beside it something is integrated, or nothing."""
    rig = Rig()
    system = rig.add_block("SubSystem", "gated", ports={"out": 1, "trigger": 1})
    rig.add_block("TriggerPort", "gate", {"TriggerType": "falling"}, system=system)
    clock = rig.block("Clock", "clock inside", system=system)
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(clock, out)
    u = wave(rig)
    rig.connect(u, f"{system}#trigger")
    rig.show(system, "y")
    if integrates:
        rig.show(rig.block("Integrator", "x", u), "x")
    run = rig.run(tmp_path, 1.5, accuracy=1e-6)
    assert shown(run, "y")[-1] == pytest.approx(np.pi / W, abs=1e-10)


def test_a_stop_ends_the_run_where_its_signal_changes(tmp_path):
    rig = Rig()
    fallen = rig.block("Integrator", "fallen", rig.block("Clock", "clock"))
    rig.block("Stop", "stop", rig.block("RelationalOperator", "deep", fallen, rig.constant("0.5"),
                                        Operator=">="))  # fmt: skip
    rig.show(fallen, "y")
    run = rig.run(tmp_path, 3.0, accuracy=1e-6)
    assert run.by_block
    assert run.ended == pytest.approx(1.0, abs=1e-9)


def triggered(rig, signal, how):
    """Show the time at which a subsystem was triggered last."""
    system = rig.add_block("SubSystem", f"by {how}", ports={"out": 1, "trigger": 1})
    rig.add_block("TriggerPort", "gate", {"TriggerType": how}, system=system)
    clock = rig.block("Clock", "clock inside", system=system)
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(clock, out)
    rig.connect(signal, f"{system}#trigger")
    rig.show(system, f"by {how}")


# Times after which 1 falls to 0, rises to 1, or does either, of pulses of 0.2 s in 0.5 s.
EDGES = {"rising": (0.5,), "falling": (0.2,), "either": (0.2, 0.5)}


@pytest.mark.parametrize("how", EDGES)
@pytest.mark.parametrize("sampled", [True, False])
def test_pulses_reset_and_trigger_where_they_come_to_zero_and_leave_it(how, sampled, tmp_path):
    """A sampled pulse has its corners at sample times but for rounding, which are no two times."""
    rig = Rig()
    given = {"PulseType": "Sample based", "Period": "5", "PulseWidth": "2", "SampleTime": "0.1"}
    pulse = rig.block("DiscretePulseGenerator", "pulse",
                      **(given if sampled else {"Period": "0.5", "PulseWidth": "40"}))  # fmt: skip
    rig.show(rig.block("Integrator", "x", rig.constant("1"), pulse, ExternalReset=how), "x")
    triggered(rig, pulse, how)
    rig.show(rig.block("UnitDelay", "late", rig.block("Clock", "clock"), SampleTime="0.1"), "late")
    run = rig.run(tmp_path, 2.0, accuracy=1e-6)
    t = run.time
    edges = np.sort([n * 0.5 + edge for n in range(4) for edge in EDGES[how]])
    last = np.append(0.0, edges)[np.searchsorted(edges, t + 1e-9)]
    assert shown(run, "x") == pytest.approx(t - last, abs=1e-9)
    assert shown(run, f"by {how}") == pytest.approx(last, abs=1e-9)
    ticks = np.floor(t / 0.1 + 1e-6)
    assert shown(run, "late") == pytest.approx(np.maximum(ticks - 1.0, 0.0) * 0.1, abs=1e-9)
    assert "dopri5" in run.integrator  # own steps go on past corners that differ by rounding


def test_a_level_resets_while_it_is_there_and_where_it_ends(tmp_path):
    rig = Rig()
    pulse = rig.block("DiscretePulseGenerator", "pulse", Period="1", PulseWidth="30")
    for how in ("level", "level hold"):
        rig.show(rig.block("Integrator", how, rig.constant("1"), pulse, ExternalReset=how), how)
    run = rig.run(tmp_path, 0.9, accuracy=1e-6)
    after = run.time > 0.3
    assert shown(run, "level")[after] == pytest.approx(run.time[after] - 0.3, abs=1e-9)
    assert np.all(shown(run, "level hold")[~after] < 0.9 / 50 + 1e-9)


@pytest.mark.parametrize(("how", "gain"), [("rising", "1"), ("falling", "-1"), ("either", "1")])
def test_a_signal_that_goes_on_past_zero_triggers_once(how, gain, tmp_path):
    """A step ends where it is 0 exactly; the next one leads past it."""
    rig = Rig()
    late = rig.block("Bias", "late", rig.block("Clock", "clock"), Bias="-0.25")
    triggered(rig, rig.block("Gain", "turned", late, Gain=gain), how)
    assert shown(rig.run(tmp_path), f"by {how}")[-1] == 0.25


def test_a_signal_that_rests_at_zero_triggers_where_it_comes_and_where_it_goes(tmp_path):
    rig = Rig()
    stairs = rig.block("simulink/Sources/Repeating Sequence Stair", "stairs",
                       OutValues="[-1 0 0 1]", tsamp="0.1")  # fmt: skip
    triggered(rig, stairs, "rising")
    run = rig.run(tmp_path, 0.39)
    found = shown(run, "by rising")
    assert found[(run.time > 0.1) & (run.time < 0.299)] == pytest.approx(0.1, abs=1e-9)
    assert found[run.time > 0.301] == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize("stairs", ["[-1 0 1 1]", "[-1 0 1 0 1 1]"])
def test_a_sampled_signal_that_goes_on_past_zero_triggers_once(stairs, tmp_path):
    """It is at zero for several major steps, but only for one sample."""
    rig = Rig()
    name = "simulink/Sources/Repeating Sequence Stair"
    triggered(rig, rig.block(name, "stairs", OutValues=stairs, tsamp="0.1"), "rising")
    rig.show(rig.block("Integrator", "x", rig.block("Clock", "clock")), "x")
    run = rig.run(tmp_path, 0.39)
    assert shown(run, "by rising")[run.time > 0.11] == pytest.approx(0.1, abs=1e-9)


@pytest.mark.parametrize("integrates", [True, False])
def test_a_stop_that_is_on_ends_the_run_at_its_start(integrates, tmp_path):
    rig = Rig()
    one = rig.constant("1")
    rig.block("Stop", "stop", one)
    rig.show(rig.block("Integrator", "x", one) if integrates else one, "y")
    run = rig.run(tmp_path)
    assert run.by_block
    assert (run.ended, run.time.tolist()) == (0.0, [0.0])


def test_rows_reach_to_where_a_stop_ends_the_run(tmp_path):
    """One step goes past many rows and is cut at the Stop: the rows before it lie on the curve."""
    rig = Rig()
    x = rig.block("Integrator", "x", wave(rig, "pi/2"))
    deep = rig.block("RelationalOperator", "deep", x, rig.constant("0.45"), Operator=">=")
    rig.block("Stop", "stop", deep)
    rig.show(x, "x")
    run = rig.run(tmp_path, 3.0, accuracy=1e-6)
    assert run.ended == pytest.approx(np.arcsin(0.45 * W / SIZE) / W, abs=1e-6)
    assert 0.0 <= run.ended - run.time[-1] < 3.0 / 500
    assert shown(run, "x") == pytest.approx(SIZE / W * np.sin(W * run.time), abs=1e-6)


def test_what_changes_its_sign_at_every_step_does_not_stop_the_time(tmp_path):
    """x' = t - 2 sign(x) slides along 0, where a Hit Crossing looks at it."""
    rig = Rig()
    x = rig.block("Integrator", "x", "", InitialCondition="0.01")
    pull = rig.block("Gain", "pull", rig.block("Signum", "sign", x), Gain="-2")
    rig.connect(rig.block("Sum", "sum", rig.block("Clock", "t"), pull, Inputs="++"), x)
    rig.show(rig.block("HitCross", "hit", x), "hit")
    rig.show(x, "x")
    model = read_model(rig.write(tmp_path / "m.slx"))
    run = run_model(runnable(model, duration=0.1), accuracy=1e-3)
    assert not run.stopped
    assert np.abs(shown(run, "x")[run.time > 0.02]).max() < 1e-2
