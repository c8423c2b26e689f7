"""Models in motion: blocks with states and sample times, subsystems that run at times, stops."""

import numpy as np
import pytest
from mechanism_models import pendulum
from moving import GRAVITY, falling
from rigs import Rig, shown
from scipy import signal
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from slx_models import published_leg

from drake_leg.errors import InvalidValueError
from drake_leg.runs.catalogue import RUNS
from drake_leg.simulink.dynamics.driven import DrivenMechanism
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.diagram import rates_of
from drake_leg.simulink.running.running import run_model, runnable


def sine(rig, frequency="3"):
    return rig.block("Sin", f"sine {len(rig.blocks)}", Frequency=frequency)


@pytest.mark.slow
def test_integrators_and_linear_systems_follow_their_equations(tmp_path):
    rig = Rig()
    u = sine(rig)
    rig.show(rig.block("Integrator", "integral", u, InitialCondition="2"), "integral")
    rig.show(rig.block("Integrator", "two", u, InitialCondition="[1 2]"), "two")
    rig.show(
        rig.block("Integrator", "limited", u, LimitOutput="on", UpperSaturationLimit="0.4",
                  LowerSaturationLimit="-inf"), "limited")  # fmt: skip
    rig.show(rig.block("TransferFcn", "lag", u, Numerator="[2 1]", Denominator="[1 2 3]"), "lag")
    rig.show(rig.block("cstblocks/LTI System", "lti", u, sys="tf([2 1], [1 2 3])"), "lti")
    rig.show(
        rig.block("StateSpace", "space", u, A="[0 1;-4 -1]", B="[0;1]", C="[1 0]", D="0",
                  X0="[1;0]"), "space")  # fmt: skip
    rig.show(rig.block("ZeroPole", "zp", u, Zeros="[-1]", Poles="[-2 -3]", Gain="4"), "zp")
    run = rig.run(tmp_path, 2.0)
    t = run.time
    integral = (1.0 - np.cos(3.0 * t)) / 3.0
    np.testing.assert_allclose(shown(run, "integral"), 2.0 + integral, atol=1e-8)
    np.testing.assert_allclose(shown(run, "two"), integral[:, None] + [1.0, 2.0], atol=1e-8)
    drive = np.sin(3.0 * t)
    for name, system, x0 in (
        ("lag", signal.lti([2.0, 1.0], [1.0, 2.0, 3.0]), None),
        (
            "space",
            signal.lti([[0.0, 1.0], [-4.0, -1.0]], [[0.0], [1.0]], [[1.0, 0.0]], 0.0),
            [1, 0],
        ),
        ("zp", signal.lti([-1.0], [-2.0, -3.0], 4.0), None),
    ):
        _, expected, _ = signal.lsim(system, drive, t, x0)
        np.testing.assert_allclose(shown(run, name), expected, atol=2e-5, err_msg=name)
    np.testing.assert_array_equal(shown(run, "lti"), shown(run, "lag"))
    limited = shown(run, "limited")
    assert limited.max() == pytest.approx(0.4, abs=1e-6)
    assert limited[-1] == pytest.approx(0.4 - (integral.max() - integral[-1]), abs=1e-5)


@pytest.mark.slow
def test_a_pid_controller_follows_its_equation(tmp_path):
    rig = Rig()
    rig.show(
        rig.block("slpidlib/PID Controller", "pid", sine(rig), Controller="PID", P="2", I="3",
                  D="0.5", N="20"), "pid")  # fmt: skip
    run = rig.run(tmp_path, 1.0)

    def rate(t, x):
        return [3.0 * np.sin(3.0 * t), 20.0 * (0.5 * np.sin(3.0 * t) - x[1])]

    found = solve_ivp(rate, (0.0, 1.0), [0.0, 0.0], t_eval=run.time, rtol=1e-11, atol=1e-12)
    u = np.sin(3.0 * run.time)
    expected = 2.0 * u + found.y[0] + 20.0 * (0.5 * u - found.y[1])
    np.testing.assert_allclose(shown(run, "pid"), expected, atol=1e-7)


def test_a_loop_of_an_integrator_is_solved(tmp_path):
    """xdot = -2 x from a vector, of which the file says one number."""
    rig = Rig()
    integrator = rig.block("Integrator", "x", "", InitialCondition="1")
    fed = rig.block("Sum", "sum", integrator, rig.constant("[0 1]"), Inputs="-+")
    rig.connect(rig.block("Gain", "two", fed, Gain="2"), integrator)
    rig.show(integrator, "x")
    run = rig.run(tmp_path, 1.0)
    decay = np.exp(-2.0 * run.time)[:, None]
    np.testing.assert_allclose(shown(run, "x"), [0.0, 1.0] + [1.0, 0.0] * decay, atol=1e-8)


def test_sampled_blocks_change_at_their_times(tmp_path):
    rig = Rig()
    u = rig.block("Clock", "clock")
    held = rig.block("ZeroOrderHold", "hold", u, SampleTime="0.1")
    rig.show(held, "held")
    rig.show(rig.block("UnitDelay", "delay", held, SampleTime="0.1", X0="-1"), "delayed")
    rig.show(rig.block("Delay", "delay 3", held, DelayLength="3", SampleTime="0.1"), "delayed 3")
    rig.show(rig.block("UnitDelay", "slow", u, SampleTime="[0.25 0]"), "slow")
    for method, name in (("Forward", "forward"), ("Backward", "backward"), ("Trapezoidal", "trap")):
        how = f"Integration: {method}" + (" Euler" if method != "Trapezoidal" else "")
        rig.show(
            rig.block("DiscreteIntegrator", name, held, IntegratorMethod=how, SampleTime="0.1"),
            name,
        )
    rig.show(
        rig.block("DiscreteTransferFcn", "filter", held, Numerator="[1 2]",
                  Denominator="[1 -0.5 0.2]", SampleTime="0.1"), "filter")  # fmt: skip
    run = rig.run(tmp_path, 1.0)
    between = np.abs(np.round(run.time / 0.05) - run.time / 0.05) > 0.01  # away from all hits
    t = run.time[between]
    k = np.floor(t / 0.1 + 1e-9).astype(int)

    def at(name):
        return shown(run, name)[between]

    samples = np.arange(11) * 0.1
    np.testing.assert_allclose(at("held"), samples[k], atol=1e-12)
    np.testing.assert_allclose(at("delayed"), np.concatenate([[-1.0], samples])[k], atol=1e-12)
    np.testing.assert_allclose(
        at("delayed 3"), np.concatenate([np.zeros(3), samples])[k], atol=1e-12
    )
    slow = np.floor(t / 0.25 + 1e-9).astype(int)
    np.testing.assert_allclose(at("slow"), (np.maximum(slow, 1) - 1) * 0.25, atol=1e-12)
    sums = np.cumsum(samples) * 0.1
    np.testing.assert_allclose(at("forward"), np.concatenate([[0.0], sums])[k], atol=1e-12)
    np.testing.assert_allclose(at("backward"), sums[k], atol=1e-12)
    np.testing.assert_allclose(at("trap"), (sums - 0.05 * samples)[k], atol=1e-12)
    expected = signal.lfilter([0.0, 1.0, 2.0], [1.0, -0.5, 0.2], samples)
    np.testing.assert_allclose(at("filter"), expected[k], atol=1e-12)


def gated(rig, gate, kind="EnablePort", **parameters):
    """A subsystem that puts out the time while it runs."""
    ports = {"in": 0, "out": 1, "enable" if kind == "EnablePort" else "trigger": 1}
    system = rig.add_block("SubSystem", f"gated {gate}", ports=ports)
    rig.add_block(kind, "gate", parameters, system=system)
    clock = rig.block("Clock", "clock inside", system=system)
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(clock, out)
    port = "enable" if kind == "EnablePort" else "trigger"
    rig.connect(gate, f"{system}#{port}")
    return system


def test_an_enabled_subsystem_holds_what_it_put_out(tmp_path):
    rig = Rig()
    pulse = rig.block("DiscretePulseGenerator", "pulse", Period="1", PulseWidth="40")
    rig.show(gated(rig, pulse), "y")
    run = rig.run(tmp_path, 0.9)
    runs = run.time < 0.4 - 1e-9
    np.testing.assert_allclose(shown(run, "y")[runs], run.time[runs], atol=1e-12)
    np.testing.assert_allclose(shown(run, "y")[run.time > 0.41], 0.4, atol=0.03)


def test_a_triggered_subsystem_runs_at_edges(tmp_path):
    rig = Rig()
    pulse = rig.block("DiscretePulseGenerator", "pulse", Period="0.5", PulseWidth="50",
                      PhaseDelay="0.1")  # fmt: skip
    rig.show(gated(rig, pulse, "TriggerPort", TriggerType="rising"), "y")
    run = rig.run(tmp_path, 1.0)
    y, t = shown(run, "y"), run.time
    assert np.all(y[t < 0.09] == 0.0)
    np.testing.assert_allclose(y[(t > 0.15) & (t < 0.59)], 0.1, atol=0.02)
    np.testing.assert_allclose(y[t > 0.65], 0.6, atol=0.02)


def test_an_if_chooses_and_a_merge_puts_out_what_was_chosen(tmp_path):
    rig = Rig()
    u = sine(rig, "6")
    conditions = {"IfExpression": "u1 > 0.5", "ElseIfExpressions": "u1<-0.5"}
    chooser = rig.add_block("If", "if", conditions, ports={"in": 1, "out": 3})
    rig.connect(u, chooser)
    branches = []
    for number in (1, 2, 3):
        system = rig.add_block("SubSystem", f"branch {number}", ports={"out": 1, "ifaction": 1})
        rig.add_block("ActionPort", "action", system=system)
        value = rig.block("Constant", "value", Value=str(number), system=system)
        out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
        rig.connect(value, out)
        rig.connect(f"{chooser}#out:{number}", f"{system}#ifaction")
        branches.append(system)
    rig.show(rig.block("Merge", "merge", *branches, Inputs="3"), "y")
    run = rig.run(tmp_path, 1.0)
    value = np.sin(6.0 * run.time)
    clear = np.abs(np.abs(value) - 0.5) > 0.02
    expected = np.where(value > 0.5, 1.0, np.where(value < -0.5, 2.0, 3.0))
    assert np.array_equal(shown(run, "y")[clear], expected[clear])


def test_a_function_counts_its_sample_times(tmp_path):
    rig = Rig()
    script = "function y = count(u)\npersistent n\nif isempty(n), n = 0; end\nn = n + u;\ny = n;\n"
    hold = rig.block("ZeroOrderHold", "hold", rig.constant("2"), SampleTime="0.1")
    function = rig.add_function("count", script, **{"in": 1, "out": 1})
    rig.connect(hold, function)
    rig.show(function, "n")
    run = rig.run(tmp_path, 0.95)
    assert shown(run, "n")[-1] == 20.0


def test_a_stop_block_ends_the_run(tmp_path):
    rig = Rig()
    over = rig.block("simulink/Logic/Compare To Constant", "over", rig.block("Clock", "clock"),
                     relop=">", const="0.5")  # fmt: skip
    stop = rig.add_block("Stop", "enough", ports={"in": 1})
    rig.connect(over, stop)
    run = rig.run(tmp_path, 1.0)
    assert run.ended == pytest.approx(0.5, abs=0.03)
    assert "the block 'enough' stops it" in run.stopped


@pytest.mark.slow
def test_a_run_that_grows_without_bound_stops_and_keeps_what_it_has(tmp_path):
    rig = Rig()
    integrator = rig.block("Integrator", "x", "", InitialCondition="1")
    rig.connect(rig.block("Math", "square", integrator, Operator="square"), integrator)
    rig.show(integrator, "x")
    run = rig.run(tmp_path, 3.0, accuracy=1e-3)
    assert 0.9 < run.ended < 1.1
    assert run.stopped
    inside = run.time < 0.9
    np.testing.assert_allclose(shown(run, "x")[inside], 1.0 / (1.0 - run.time[inside]), rtol=1e-2)


def test_an_algebraic_loop_is_named(tmp_path):
    rig = Rig()
    a = rig.block("Gain", "a", "", Gain="0.5")
    rig.connect(rig.block("Gain", "b", a, Gain="0.5"), a)
    with pytest.raises(InvalidValueError, match=r"algebraic loop: 'a' .*'b' "):
        rig.code(tmp_path)


def test_code_that_does_not_run_is_told_with_its_block(tmp_path):
    rig = Rig()
    script = "function y = f()\na = 2;\ny = 2*g();\nfunction z = g()\na = 1;\nz = a;\nend\nend\n"
    rig.show(rig.add_function("Law", script), "y")
    with pytest.raises(InvalidValueError, match=r"block 'Law' \(SID .*g, line 4.*inside another"):
        rig.code(tmp_path)


def test_a_replacement_may_be_a_vector(tmp_path):
    rig = Rig()
    rig.show(rig.block("Demux", "apart", rig.block("Queue", "q"), Outputs="3"), "y")
    rig.write(tmp_path / "m.slx")
    model = read_model(tmp_path / "m.slx")
    runnable(model, replace={"q": "constant [1 2 3]"})
    with pytest.raises(
        InvalidValueError, match=r"1 number apart into 3 .* as a constant \[0 0 0\]"
    ):
        runnable(model, replace={"q": "constant 1"})


def test_all_that_does_not_run_is_one_list(tmp_path):
    rig = Rig()
    rig.show(rig.block("S-Function", "mine", FunctionName="mine"), "mine")
    rig.show(rig.block("HitCross", "other", rig.block("Gain", "k", Gain="gain")), "y")
    rig.show(rig.block("Queue", "queue"), "queue")
    rig.show(rig.block("Gain", "too", Gain="gain"), "too")
    a = rig.block("Gain", "a", "", Gain="0.5")
    rig.connect(rig.block("Gain", "b", a, Gain="0.5"), a)
    start = rig.block("Integrator", "start", a, InitialCondition="x0")
    rig.show(rig.block("Sin", "wave", Amplitude="swing", Frequency="speed"), "wave")
    rig.show(rig.block("TransferFcn", "lag", start, Denominator="[1 lag]"), "lagging")
    rig.show(rig.block("TransferFcn", "all", start, Numerator="[1 p]", Denominator="[q 1]"), "all")
    with pytest.raises(InvalidValueError) as error:
        rig.code(tmp_path)
    said = str(error.value)
    assert said.startswith("10 things are missing")
    assert said.count("give a value of gain (1 more needs it)") == 1
    assert "'mine' (SID 1) is an S-Function" in said
    assert "'queue'" in said
    assert "loop: 'a' (SID" in said
    names = ("gain", "x0", "swing", "speed", "lag", "p", "q")
    assert [name for name in names if f"give a value of {name}" not in said] == []


def test_an_unknown_stop_time_is_in_the_list_of_all_that_is_missing(tmp_path):
    rig = Rig()
    rig.solver["StopTime"] = "until"
    rig.show(rig.block("Constant", "k", Value="gain"), "k")
    with pytest.raises(InvalidValueError, match=r"2 things[\s\S]*until[\s\S]*gain"):
        rig.run(tmp_path, None)


def test_a_mechanism_and_signals_lack_things_in_one_list(tmp_path):
    model = published_leg(stop_time="1")
    model.set("Sine Wave", Amplitude="unknown_amplitude")
    model.set("Brick Solid2", BrickDimensions="[unknown_length 1 1]")
    with pytest.raises(InvalidValueError) as error:
        runnable(read_model(model.write(tmp_path / "leg.slx")))
    assert "unknown_amplitude" in str(error.value)
    assert "unknown_length" in str(error.value)


@pytest.mark.slow
def test_a_mechanism_that_only_follows_motions_is_not_integrated(tmp_path):
    """The lab's own leg, from its file, is where its kinematics say that its joints put it."""
    path = published_leg(filtered=True, stop_time="0.05").write(tmp_path / "leg.slx")
    ready = runnable(read_model(path))
    assert isinstance(ready.diagram.mechanism, DrivenMechanism)
    run = run_model(ready, accuracy=1e-6)
    assert not run.stopped
    _, feet = foot_of(run)
    time = run.time
    # The filters' second-order lags are 2 ms behind a step whose speed is 70 sin(t) mm/s.
    start = feet[0]
    assert np.abs(feet[:, 0] - start[0] - 70.0 * (1.0 - np.cos(time))).max() < 0.03
    assert np.abs(feet[:, 1:] - start[1:]).max() < 0.03


def test_the_lab_with_its_filters_drifts_as_it_does_in_simscape(tmp_path):
    """The joints lag 2 ms behind, so the Jacobian is not that of where they are: y and z drift."""
    path = published_leg(filtered=True, stop_time="20").write(tmp_path / "leg.slx")
    run = run_model(runnable(read_model(path)))
    _, feet = foot_of(run)
    drift = feet[-1] - feet[0]
    assert drift[1] == pytest.approx(-1.237, abs=1e-3)
    assert drift[2] == pytest.approx(0.506, abs=1e-3)
    # Explicit steps would be 12 000, as each must be below 2.5 times the filters' 1 ms.
    assert "rodas5p" in run.integrator
    assert run.steps < 700


@pytest.mark.slow
def test_the_lab_from_its_file_is_the_run_of_leg_b_with_the_same_filters(tmp_path):
    path = published_leg(filtered=True, stop_time="2").write(tmp_path / "leg.slx")
    run = run_model(runnable(read_model(path)))
    options = RUNS["leg-b"].options(duration=2.0, filter_time_constant=0.001, accuracy=1e-12)
    leg = RUNS["leg-b"].run(options).recording
    for letter, column in zip("xyz", foot_of(run)[1].T, strict=True):
        assert column[-1] / 1e3 == pytest.approx(leg[letter][-1], abs=1e-8)


def test_a_mechanism_that_follows_motions_has_the_derivatives_of_its_diagram(tmp_path):
    ready = runnable(read_model(published_leg(filtered=True).write(tmp_path / "leg.slx")))
    diagram = ready.diagram
    context = diagram.CreateDefaultContext()
    rates = diagram.signals.rates(context, diagram.mechanism.now_at)
    rng = np.random.default_rng(1)
    for time in (0.0, 0.3, 7.0):
        x = ready.code.x + rng.normal(size=ready.code.x.size) * 0.1
        context.SetTimeAndContinuousState(time, x)
        expected = diagram.EvalTimeDerivatives(context).CopyToVector()
        assert np.abs(expected).max() > 1.0
        np.testing.assert_array_equal(rates(time, x), expected)


def test_rates_are_the_same_whether_or_not_the_mechanism_has_moved(tmp_path):
    """Two states of a filtered torque, and a pendulum's angle and speed, which is sensed."""
    built = pendulum(TorqueActuationMode="InputTorque", SensePosition="on")
    inward = built.add_library("nesl_utility/Simulink-PS Converter", "In")
    outward = built.add_library("nesl_utility/PS-Simulink Converter", "Out")
    built.connect(outward, inward)
    built.meet("In", "Pivot lconn:2")
    built.meet("Pivot rconn:2", "Out lconn:1")
    built.set("In", FilteringAndDerivatives="filter", SimscapeFilterOrder="2",
              InputFilterTimeConstant="2e-3")  # fmt: skip
    ready = runnable(built.model(tmp_path), duration=1.0)
    context = ready.diagram.CreateDefaultContext()
    rates = rates_of(ready.diagram, context)
    moves = [[0.0, 0.0, 0.3, 0.1], [0.2, 0.0, 0.3, 0.1], [0.2, 1.0, 0.3, 0.1],
             [0.2, 1.0, 0.5, 0.1], [0.0, 0.0, 0.5, -0.1], [0.7, 0.0, 0.5, -0.1]]  # fmt: skip
    for time in (0.1, 0.2):
        for x in map(np.array, moves):
            fresh = ready.diagram.CreateDefaultContext()
            fresh.SetTimeAndContinuousState(time, x)
            expected = ready.diagram.EvalTimeDerivatives(fresh).CopyToVector()
            np.testing.assert_array_equal(rates(time, x), expected)


def filtered_sine(rig):
    """A sine of 3 rad/s through (1 ms s + 1)^2, from rest, and its closed form."""
    made = rig.block(
        "TransferFcn", "filter", sine(rig), Numerator="[1]", Denominator="[1e-6 2e-3 1]"
    )
    rig.show(made, "filtered")

    def exact(t):
        tau, w = 1e-3, 3.0
        g = 1.0 / (1.0 + 1j * w * tau) ** 2  # what lasts
        fading = np.exp(-t / tau) * (g.imag + t * (g.imag / tau + w * g.real))
        return np.imag(g * np.exp(1j * w * t)) - fading

    return exact


@pytest.mark.parametrize("accuracy", [1e-6, 1e-8])
def test_a_fast_filter_of_a_smooth_signal_takes_long_steps(accuracy, tmp_path):
    rig = Rig()
    exact = filtered_sine(rig)
    ready = runnable(read_model(rig.write(tmp_path / "m.slx")), duration=2.0)
    run = run_model(ready, accuracy=accuracy)
    assert "rodas5p" in run.integrator
    assert run.steps < 250  # explicit steps would be 900 and more
    np.testing.assert_allclose(shown(run, "filtered"), exact(run.time), rtol=0, atol=accuracy)


def test_states_of_a_transfer_function_are_alike(tmp_path):
    """Its output is of size 1, and swings at 20 000 rad/s: no state may be a large derivative."""
    rig = Rig()
    rig.show(rig.block("TransferFcn", "amplifier", rig.constant("1"),
                       Numerator="[4e8]", Denominator="[1 1e4 4e8]"), "y")  # fmt: skip
    run = rig.run(tmp_path, 0.01, accuracy=1e-8)
    w = np.sqrt(4e8 - 2.5e7)
    swing = np.exp(-5e3 * run.time) * (np.cos(w * run.time) + 5e3 / w * np.sin(w * run.time))
    np.testing.assert_allclose(shown(run, "y"), 1.0 - swing, atol=1e-7)
    code = rig.code(tmp_path)
    rates = code.functions()["derivatives"](0.0, [1.0, 1.0], [], np.zeros(0), np.zeros(0))
    assert np.abs(rates).max() < 1e5


def test_what_rosenbrock_steps_cannot_pass_is_left_to_drake(tmp_path):
    """A signal grows beside a fast filter: x' = x^2 has a pole at 1 s."""
    rig = Rig()
    filtered_sine(rig)
    growing = rig.block("Integrator", "x", "", InitialCondition="1")
    rig.connect(rig.block("Math", "square", growing, Operator="square"), growing)
    rig.show(growing, "x")
    run = rig.run(tmp_path, 2.0, accuracy=1e-6)
    assert run.integrator == "runge_kutta3"
    assert run.stopped
    assert run.ended == pytest.approx(1.0, abs=1e-3)
    assert shown(run, "x")[100] == pytest.approx(1.0 / (1.0 - run.time[100]), rel=1e-5)


def test_own_steps_end_where_blocks_are_sampled(tmp_path):
    """A stiff model; a state is set again at a sample time, too."""
    rig = Rig()
    exact = filtered_sine(rig)
    held = rig.block("ZeroOrderHold", "hold", sine(rig), SampleTime="0.1")
    rig.show(held, "held")
    rig.show(rig.block("Integrator", "integral", held), "integral")
    late = rig.block("UnitDelay", "late", rig.block("Constant", "on", Value="1"), SampleTime="0.4")
    reset = rig.block("Integrator", "reset", rig.constant("1"), late, InitialCondition="5",
                      ExternalReset="rising")  # fmt: skip
    rig.show(reset, "reset")
    run = rig.run(tmp_path, 0.6, accuracy=1e-7)
    t = run.time
    assert "rodas5p" in run.integrator
    np.testing.assert_allclose(shown(run, "filtered"), exact(t), rtol=0, atol=1e-6)
    k = np.floor(t / 0.1 + 1e-9).astype(int)
    samples = np.sin(0.3 * np.arange(7))
    np.testing.assert_allclose(shown(run, "held"), samples[k], atol=1e-12)
    whole = np.concatenate([[0.0], 0.1 * np.cumsum(samples)])
    np.testing.assert_allclose(
        shown(run, "integral"), whole[k] + samples[k] * (t - 0.1 * k), atol=1e-9
    )
    np.testing.assert_allclose(
        shown(run, "reset"), 5.0 + np.where(t < 0.4 - 1e-9, t, t - 0.4), atol=1e-9
    )


def test_a_stop_ends_own_steps(tmp_path):
    rig = Rig()
    filtered_sine(rig)
    late = rig.block("RelationalOperator", "late", rig.block("Clock", "clock"),
                     rig.constant("0.3"), Operator=">=")  # fmt: skip
    rig.block("Stop", "stop", late)
    run = rig.run(tmp_path, 0.6, accuracy=1e-5)
    assert "rodas5p" in run.integrator
    assert run.by_block
    assert run.ended == pytest.approx(0.3, abs=1e-9)


def foot_of(run):
    feet = [each for each in run.shown if each.block == "foot positions"]
    return [each.name for each in feet], np.column_stack([each.values[:, 0] for each in feet])


@pytest.mark.slow
def test_a_stiff_mechanism_is_integrated_implicitly(tmp_path):
    """A pendulum in a damper creeps: explicit steps would be some microseconds long."""
    texts = {
        "DampingCoefficient": "1e5", "DampingCoefficientUnits": "N*m/(rad/s)",
        "PositionTargetSpecify": "on", "PositionTargetValue": "60",
    }  # fmt: skip
    built = pendulum(**texts)
    built.add_library("sm_lib/Utilities/Mechanism Configuration", "Gravity")
    built.physical(f"{built.sid('Gravity')}#rconn:1", f"{built.sid('World')}#rconn:1")
    ready = runnable(built.model(tmp_path), duration=100.0)
    run = run_model(ready)
    assert not run.stopped
    assert "rodas5p" in run.integrator
    assert run.steps < 2000


@pytest.mark.slow
def test_contact_is_integrated_implicitly(tmp_path):
    """A ball that was dropped lies still, as deep in the floor as its weight presses it."""
    run = run_model(runnable(falling(0.12).model(tmp_path), duration=2.0))
    assert not run.stopped
    assert "rodas5p" in run.integrator
    weight = 1000.0 * 4.0 / 3.0 * np.pi * 0.1**3 * GRAVITY
    assert run.states[-1, 6] == pytest.approx(0.1 - weight / 1e4, abs=1e-6)
    assert run.steps < 500


def test_a_bouncing_ball_is_where_fine_steps_put_it(tmp_path):
    """Against SciPy's explicit steps at a finer accuracy, and energy: the floor only takes."""
    ready = runnable(falling(0.12).model(tmp_path), duration=0.25)
    run = run_model(ready)
    assert "rodas5p" in run.integrator
    diagram = ready.diagram
    context = diagram.CreateDefaultContext()
    diagram.mechanism.start(context, ready.start)
    start = context.get_continuous_state_vector().CopyToVector()
    fine = solve_ivp(
        rates_of(diagram, context), (0.0, 0.25), start, "DOP853", rtol=1e-7, atol=1e-7,
        t_eval=run.time[::50],
    )  # fmt: skip
    height, rise = run.states[:, 6], run.states[:, 12]
    np.testing.assert_allclose(height[::50], fine.y[6], rtol=0, atol=1e-5)
    energy = GRAVITY * height + rise**2 / 2.0
    free = height > 0.1 + 1e-3
    assert np.diff(energy[free]).max() < 1e-6
    assert height.min() < 0.1


def test_the_rate_of_a_filtered_force_is_a_state_in_the_unit_of_the_force(tmp_path):
    """A damper by signals: an absolute accuracy means the same to the force and to its rate."""
    rig = Rig()
    speed = rig.block("Integrator", "speed", "", InitialCondition="1")
    texts = {
        "FilteringAndDerivatives": "filter", "SimscapeFilterOrder": "2",
        "InputFilterTimeConstant": "1e-3",
    }  # fmt: skip
    kind = "nesl_utility/Simulink-PS Converter"
    enters = rig.add_library(kind, "enters", texts, ports={"in": 1})
    rig.connect(rig.block("Gain", "k", speed, Gain="-1e5"), enters)
    leaves = rig.block("nesl_utility/PS-Simulink Converter", "leaves")
    rig.physical(f"{enters}#rconn:1", f"{leaves}#lconn:1")
    rig.connect(f"{leaves}#out:1", speed)
    code = rig.code(tmp_path)
    none = np.zeros(0)
    found = code.functions()["derivatives"](0.0, [1.0, 2.0, 3.0], list(code.memory), none, none)
    y, rate = 2.0, 3.0 / 1e-3
    np.testing.assert_allclose(found, [y, rate, 1e-3 * ((-1e5 - y) / 1e-6 - 2.0 * rate / 1e-3)])


def test_a_duration_stands_for_a_stop_time_that_is_not_known(tmp_path):
    rig = Rig(solver={"StopTime": "2*T_cg"})
    rig.show(rig.block("Clock", "t"), "t")
    assert rig.run(tmp_path, 0.1).ended == pytest.approx(0.1)


def test_a_physical_block_of_an_unknown_library_is_no_signal_to_replace(tmp_path):
    rig = Rig()
    port = rig.add_library("my_lib/Interface", "interface", ports={"RConn": 1})
    stop = rig.add_library("fl_lib/Stop", "stop", ports={"LConn": 1})
    rig.physical(f"{port}#rconn:1", f"{stop}#lconn:1")
    model = read_model(rig.write(tmp_path / "rig.slx"))
    with pytest.raises(InvalidValueError, match="'interface' is an Interface, which is physical"):
        runnable(model, replace={"interface": "constant 0"})


def test_a_run_that_is_not_finite_names_the_block_that_was_first(tmp_path):
    rig = Rig()
    late = rig.block("Sum", "late", rig.constant("0.5"), rig.block("Clock", "clock"), Inputs="+-")
    limit = rig.block("MinMax", "limit", late, rig.constant("inf"), Function="min")
    logarithm = rig.block("Math", "logarithm", limit, Operator="log")
    rig.show(rig.block("Integrator", "integral", rig.block("Gain", "after", logarithm)), "x")
    run = rig.run(tmp_path, 1.0, accuracy=1e-3)
    assert run.stopped.startswith("what the block 'logarithm' puts out is not finite, at 0.")
    assert 0.3 < run.ended < 0.51
    assert run.time[-1] == pytest.approx(run.ended, abs=0.05)
    assert np.isfinite(shown(run, "x")).all()


def test_a_run_forgets_what_was_not_finite_in_the_one_before(tmp_path):
    rig = Rig()
    root = rig.block("Fcn", "root", rig.block("Clock", "clock"), Expr="sqrt(1-u)")
    rig.show(rig.block("Integrator", "integral", root), "x")
    ready = runnable(read_model(rig.write(tmp_path / "rig.slx")), duration=2.0)
    first, second = run_model(ready), run_model(ready)
    assert first.stopped
    assert (second.stopped, second.steps) == (first.stopped, first.steps)


def test_an_observer_has_as_many_states_as_its_matrices_fit(tmp_path):
    """x' = A x + L (y - C x) of one start: what fails for one number is tried for a vector."""
    A, L, C = "[0 1; -2 -3]", "[4; 5]", "[1 0.5]"
    rig = Rig()
    times = {"Multiplication": "Matrix(K*u)"}
    x = rig.block("Integrator", "x", InitialCondition="0.25")
    rig.blocks[x].ports["in"] = 1
    seen = rig.block("Gain", "C", x, Gain=C, **times)
    error = rig.block("Sum", "error", rig.constant("1"), seen, Inputs="+-")
    fed = rig.block("Gain", "L", error, Gain=L, **times)
    own = rig.block("Gain", "A", x, Gain=A, **times)
    rig.connect(rig.block("Sum", "rate", own, fed, Inputs="++"), f"{x}#in:1")
    rig.show(x, "x")
    run = rig.run(tmp_path)
    M = np.array([[0.0, 1.0], [-2.0, -3.0]]) - np.outer([4.0, 5.0], [1.0, 0.5])
    rest = -np.linalg.solve(M, [4.0, 5.0])
    exact = [rest + expm(M * t) @ (np.full(2, 0.25) - rest) for t in run.time]
    np.testing.assert_allclose(shown(run, "x"), exact, atol=1e-8)


def test_an_observer_changes_nothing(tmp_path):
    rig = Rig()
    rig.show(rig.block("Integrator", "sum", rig.block("Clock", "t")), "y")
    rig.block("ObserverReference", "Observer")
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "y"), run.time**2 / 2.0, atol=1e-9)
