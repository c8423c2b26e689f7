"""Ported models: their scripts run alone, and give what the models give."""

import ast
import runpy

import numpy as np
import pytest
from chart_drawings import heated
from mechanism_models import pendulum
from rigs import Rig
from signal_models import charted, oscillator

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.system import mechanism_dynamics
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.folding import WIDTH, folded
from drake_leg.simulink.running.porting import INLINE, data_name, ported
from drake_leg.simulink.running.running import run_model, runnable

GREATEST = 1e-12  # difference between a model's run and its script's


def both(built, folder, duration, **options):
    """Run a model, and its script where the model's file is no more; return both runs."""
    file = built.write(folder / "m.slx")
    model = read_model(file)
    ready = runnable(model, duration=duration, **options)
    script = ported(model, ready, "alone", accuracy=1e-7)
    file.unlink()
    (folder / "alone.py").write_text(script.text, encoding="utf-8")
    if script.data:
        (folder / data_name("alone")).write_text(script.data, encoding="utf-8")
    ours = run_model(ready, accuracy=1e-7)
    return ours, runpy.run_path(str(folder / "alone.py"))["run"](), script


def require_same(ours, theirs):
    assert (ours.ended, ours.steps, ours.stopped) == (theirs.ended, theirs.steps, theirs.stopped)
    assert len(ours.shown) == len(theirs.shown)
    np.testing.assert_array_equal(ours.time, theirs.time)
    np.testing.assert_allclose(ours.states, theirs.states, rtol=0, atol=GREATEST)
    for one, other in zip(ours.shown, theirs.shown, strict=True):
        assert (one.block, one.name, one.port) == (other.block, other.name, other.port)
        np.testing.assert_allclose(one.values, other.values, rtol=0, atol=GREATEST)


def test_an_oscillator(tmp_path):
    ours, theirs, script = both(oscillator(), tmp_path, 1.0)
    require_same(ours, theirs)
    np.testing.assert_allclose(theirs.shown[0].values[:, 0], np.cos(theirs.time), atol=1e-6)
    assert script.data == ""
    for said in ("DiagramBuilder()", "# Speed", "# Place", "def derivatives(t, x, m, y, e):"):
        assert said in script.text


def commanded(folder, monkeypatch, *arguments):
    """Carry a script out as a command; return the last time of its recording."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr("sys.argv", ["alone.py", *arguments])
    runpy.run_path("alone.py", run_name="__main__")
    return float(
        (folder / "alone_run" / "recording.csv").read_text().splitlines()[-1].split(",")[0]
    )


def test_a_script_is_a_command(tmp_path, monkeypatch, capsys):
    both(oscillator(), tmp_path, 1.0)
    assert commanded(tmp_path, monkeypatch, "--duration", "0.5") == 0.5
    assert "to 0.5 s" in capsys.readouterr().out
    for wrong in ("-1", "nan", "inf", "long"):
        with pytest.raises(SystemExit):
            commanded(tmp_path, monkeypatch, "--duration", wrong)
        assert f"invalid positive value: '{wrong}'" in capsys.readouterr().err


def test_an_automatic_step_is_a_part_of_the_duration(tmp_path):
    rig = Rig()
    rig.show(rig.block("Integrator", "Place", rig.constant("1")), "place")
    rig.solver.update(SolverType="Fixed-step", Solver="ode4", FixedStep="auto")
    ours, theirs, script = both(rig, tmp_path, 1.0)
    require_same(ours, theirs)
    assert "fixed_step=duration / 50" in script.text


def test_sample_times_code_tables_and_stops(tmp_path):
    rig = Rig()
    clock = rig.block("Clock", "Clock")
    u = rig.block("Sin", "Sine", Frequency="3")
    delayed = rig.block("UnitDelay", "Delay", u, SampleTime="0.05", InitialCondition="0.3")
    rig.show(rig.block("DiscreteIntegrator", "Sum", delayed, SampleTime="0.1"), "sum")
    rig.show(rig.block("Memory", "Before", u), "before")
    rig.show(rig.block("Fcn", "Formula", u, Expr="2*u^2 - 1"), "formula")
    points, values = "linspace(-1, 1, 500)", "linspace(-1, 1, 500).^3"
    table = {"BreakpointsForDimension1": points, "Table": values}
    rig.show(rig.block("Lookup_n-D", "Table", u, NumberOfTableDimensions="1", **table), "cube")
    square = rig.block(
        "Product",
        "Square",
        rig.constant("reshape(1:144, 12, 12)/7"),
        u,
        Multiplication="Element-wise(.*)",
    )
    rig.show(square, "magic")
    code = rig.add_function("Counter", "function y = f(u)\n% it's \"kept\"\npersistent n\n"
                            "if isempty(n)\n n = 0;\nend\nn = n + u;\ny = [n; 2*n];\n")  # fmt: skip
    rig.connect(delayed, code)
    rig.show(code, "counted")
    late = rig.block("RelationalOperator", "Late", clock, rig.constant("0.4"), Operator=">=")
    rig.connect(late, rig.add_block("Stop", "Enough"))
    ours, theirs, script = both(rig, tmp_path, 1.0)
    assert "'Enough' stops it" in theirs.stopped
    assert theirs.by_block
    require_same(ours, theirs)
    assert '"arrays"' in script.data  # 500 numbers are more than a script should hold
    assert INLINE < 500
    assert "persistent n" in script.text
    assert " = array([\n    [0.14285714285714285, " in script.text  # a matrix by its rows


@pytest.mark.parametrize("sampled", [True, False])
def test_a_chart(tmp_path, sampled):
    ours, theirs, script = both(heated(sampled=sampled), tmp_path, 3.0)
    require_same(ours, theirs)
    assert "at_chart = 2; % Heat" in script.text


def test_a_replaced_block(tmp_path):
    (tmp_path / "t.csv").write_text("0,0\n1,2\n", encoding="utf-8")
    replaced = {"Chart": str(tmp_path / "t.csv")}
    require_same(*both(charted(), tmp_path, 1.0, replace=replaced)[:2])


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["torque", "motion"])
def test_a_mechanism_that_is_driven_and_sensed(tmp_path, mode):
    modes = {
        "torque": {"TorqueActuationMode": "InputTorque"},
        "motion": {"TorqueActuationMode": "ComputedTorque", "MotionActuationMode": "InputMotion"},
    }[mode]
    built = pendulum(
        **modes, SensePosition="on", DampingCoefficient="0.3", PositionTargetSpecify="on",
        PositionTargetValue="20", PositionTargetPriority="Low",
    )  # fmt: skip
    drive = built.add_block("Sin", "Drive", {"Frequency": "4", "Amplitude": "0.5"})
    inward = built.add_library("nesl_utility/Simulink-PS Converter", "In")
    outward = built.add_library("nesl_utility/PS-Simulink Converter", "Out")
    scope = built.add_block("Scope", "Scope", ports={"in": 1})
    built.connect(drive, inward)
    built.meet("In", "Pivot lconn:2")
    built.meet("Pivot rconn:2", "Out lconn:1")
    built.connect(outward, scope, name="theta")
    if mode == "motion":
        built.set("In", FilteringAndDerivatives="filter", SimscapeFilterOrder="2",
                  InputFilterTimeConstant="2e-4")  # fmt: skip
    ours, theirs, script = both(built, tmp_path, 0.3)
    require_same(ours, theirs)
    assert {"torque": "runge_kutta3", "motion": "rodas5p"}[mode] in theirs.integrator
    assert np.ptp(theirs.shown[0].values) > 1e-3
    assert 'mechanism.GetOutputPort("sensed")' in script.text
    assert '"DampingCoefficient"' in script.data
    assert "LowerLimitSpringStiffness" not in script.data  # which nothing reads


def test_functions_in_files_come_with_the_script(tmp_path):
    """One calls another, in a folder of its own, and counts its calls."""
    (tmp_path / "private").mkdir()
    for name, code in {
        "twice.m": "function y = twice(u)\npersistent n\nif isempty(n)\n n = 0;\nend\n"
        "n = n + 1;\ny = 2*u + 0*n + more(u);\n",
        "private/more.m": 'function y = more(u)\ny = u^2; % "more"\n',
    }.items():
        (tmp_path / name).write_text(code, encoding="utf-8")
    rig = Rig()
    code = rig.add_function("Doubler", "function y = f(u)\ny = twice(u);\n")
    clock = rig.block("Clock", "Clock")
    rig.connect(clock, code)
    rig.show(code, "doubled")
    rig.show(rig.block("MATLABFcn", "Formula", clock, MATLABFcn="1 + twice(u)"), "more")
    file = rig.write(tmp_path / "m.slx")
    ready = runnable(read_model(file), duration=1.0)
    script = ported(read_model(file), ready, "alone")
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "alone.py").write_text(script.text, encoding="utf-8")
    (alone / data_name("alone")).write_text(script.data, encoding="utf-8")
    for path in (tmp_path / "twice.m", tmp_path / "private" / "more.m", file):
        path.unlink()
    theirs = runpy.run_path(str(alone / "alone.py"))["run"]()
    doubled, more = (each.values[:, 0] for each in theirs.shown)
    np.testing.assert_allclose(doubled, 2.0 * theirs.time + theirs.time**2, rtol=0, atol=1e-12)
    np.testing.assert_allclose(more, 1.0 + doubled, rtol=0, atol=1e-12)
    assert '\n      "y = u^2; % \\"more\\""' in script.data  # a line for each of theirs


def test_an_s_function_comes_with_the_script(tmp_path):
    code = tmp_path / "lag.m"
    code.write_text(
        "function [sys, x0, str, ts] = lag(t, x, u, flag, par)\nx0 = []; str = []; ts = [];\n"
        "switch flag\ncase 0\nsys = [1 0 1 1 0 0 1]; x0 = par.start; ts = [0 0];\n"
        "case 1\nsys = (u - x) / par.time;\ncase 3\nsys = x;\notherwise\nsys = [];\nend\n"
    )
    rig = Rig()
    step = rig.constant("1")
    values = {"FunctionName": "lag", "Parameters": "struct('start', 3, 'time', 0.5)"}
    rig.show(rig.block("S-Function", "Lag", step, **values), "y")
    file = rig.write(tmp_path / "m.slx")
    script = ported(read_model(file), runnable(read_model(file), duration=1.0), "alone")
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "alone.py").write_text(script.text, encoding="utf-8")
    (alone / data_name("alone")).write_text(script.data, encoding="utf-8")
    code.unlink()
    theirs = runpy.run_path(str(alone / "alone.py"))["run"]()
    expected = 1.0 + 2.0 * np.exp(-2.0 * theirs.time)
    np.testing.assert_allclose(theirs.shown[0].values[:, 0], expected, atol=1e-6)


def test_two_functions_of_one_name_are_refused(tmp_path):
    """Each caller has one in its own private folder."""
    for folder, factor in (("a", 2), ("b", 3)):
        (tmp_path / folder / "private").mkdir(parents=True)
        inner = f"function y = part(u)\ny = {factor}*u;\n"
        (tmp_path / folder / "private" / "part.m").write_text(inner, encoding="utf-8")
        outer = f"function y = by{folder}(u)\ny = part(u);\n"
        (tmp_path / folder / f"by{folder}.m").write_text(outer, encoding="utf-8")
    rig = Rig()
    code = rig.add_function("Both", "function y = f(u)\ny = bya(u) + byb(u);\n")
    rig.connect(rig.block("Clock", "Clock"), code)
    rig.show(code, "sum")
    model = read_model(rig.write(tmp_path / "m.slx"), paths=[tmp_path])
    ready = runnable(model, duration=1.0)
    with pytest.raises(InvalidValueError, match=r"two functions 'part'.*rename one"):
        ported(model, ready, "alone")


@pytest.mark.parametrize(
    "line",
    [
        f"a = f([{', '.join(map(str, range(60)))}], x['an, odd] name'], \"it's, so\")",
        "short = 1",
        f"b = {{{', '.join(f'{n!r}: ({n}, {n})' for n in range(40))}}}",
    ],
)
def test_a_folded_line_means_the_same(line):
    lines = folded(line, 4)
    assert all(len(one) <= WIDTH for one in lines)
    assert all(one.startswith("    ") for one in lines)
    whole = "\n".join(["if True:", *lines])
    assert ast.dump(ast.parse(whole).body[0].body[0]) == ast.dump(ast.parse(line).body[0])


def test_a_script_that_would_lack_what_acts_is_refused(tmp_path, monkeypatch):
    left_out = {"Spatial Contact Force": ("Foot",)}

    def lacking(model, **more):
        system = mechanism_dynamics(model, **more)
        system._acting.left_out = left_out
        return system

    monkeypatch.setattr("drake_leg.simulink.running.ported.mechanism_dynamics", lacking)
    with pytest.raises(InvalidValueError, match="without Spatial Contact Force"):
        both(pendulum(), tmp_path, 0.1)


def test_motions_through_way_points(tmp_path):
    rig = Rig()
    clock = rig.block("Clock", "clock")
    for kind, settings in (
        ("Trapezoidal Velocity Profile Trajectory", {"Waypoints": "[0 1 0; 2 3 5]"}),
        ("Trapezoidal Velocity Profile Trajectory", {"WaypointSource": "External"}),
        ("Polynomial Trajectory", {}),
    ):
        external = "WaypointSource" in settings
        name = f"{kind} {external}"
        ports = {"in": 1 + external, "out": 3}
        path = rig.add_library(f"robotcorelib/{kind}", name, settings, ports=ports)
        rig.connect(clock, f"{path}#in:1")
        if external:
            rig.connect(rig.constant("[0 2; 1 0]"), f"{path}#in:2")
        rig.show(f"{path}#out:1", name)
    require_same(*both(rig, tmp_path, 3.0)[:2])


def test_calls_and_resets(tmp_path):
    rig = Rig()
    called = rig.add_block("SubSystem", "called", ports={"out": 1, "trigger": 1})
    rig.add_block("TriggerPort", "call", {"TriggerType": "function-call"}, system=called)
    total = rig.block("DiscreteIntegrator", "total", "", gainval="1", SampleTime="-1",
                      system=called)  # fmt: skip
    one = rig.block("Constant", "one", Value="1", system=called)
    rig.connect(one, f"{total}#in:1")
    rig.connect(total, rig.add_block("Outport", "out", system=called, ports={"in": 1}))
    rig.connect(rig.block("FunctionCallGenerator", "calls", sample_time="0.1"), f"{called}#trigger")
    again = rig.add_block("SubSystem", "again", ports={"out": 1, "Reset": 1})
    rig.add_block("ResetPort", "reset", {"ResetTriggerType": "rising"}, system=again)
    time = rig.block("Integrator", "time", "", system=again)
    rig.connect(rig.block("Constant", "one", Value="1", system=again), f"{time}#in:1")
    rig.connect(time, rig.add_block("Outport", "out", system=again, ports={"in": 1}))
    rig.connect(rig.block("Step", "step", Time="0.35"), f"{again}#Reset")
    rig.show(called, "sum")
    rig.show(again, "since")
    ours, theirs, _ = both(rig, tmp_path, 1.0)
    require_same(ours, theirs)
    assert theirs.shown[1].values[-1] == pytest.approx(0.65, abs=1e-6)


def test_subsystems_that_iterate(tmp_path):
    rig = Rig()
    u = rig.block("ZeroOrderHold", "u", rig.block("Clock", "clock"), SampleTime="0.1")
    loop = rig.add_block("SubSystem", "loop", ports={"in": 1, "out": 1})
    rig.add_block("ForIterator", "three", {"IterationLimit": "3"}, system=loop)
    into = rig.add_block("Inport", "in", {"Port": "1"}, system=loop, ports={"out": 1})
    rig.connect(u, f"{loop}#in:1")
    before = rig.block("UnitDelay", "before", into, SampleTime="-1", system=loop)
    rig.connect(before, rig.add_block("Outport", "out", system=loop, ports={"in": 1}))
    rig.show(loop, "y")
    each = rig.add_block("SubSystem", "each", ports={"in": 1, "out": 1})
    rig.add_block("ForEach", "for each", system=each)
    part = rig.add_block("Inport", "in", {"Port": "1", "Partition": "on"}, system=each,
                         ports={"out": 1})  # fmt: skip
    rig.connect(rig.constant("[1 -2]"), f"{each}#in:1")
    lag = rig.block("Integrator", "lag", part, system=each)
    rig.connect(lag, rig.add_block("Outport", "out", system=each, ports={"in": 1}))
    rig.show(each, "x")
    ours, theirs, _ = both(rig, tmp_path, 1.0)
    require_same(ours, theirs)
    np.testing.assert_allclose(theirs.shown[1].values[-1], [1.0, -2.0], atol=1e-6)


def test_tables(tmp_path):
    rig = Rig()
    clock = rig.block("Clock", "clock")
    line = {"NumberOfTableDimensions": "1", "BreakpointsForDimension1": "[0 0.4 1]",
            "Table": "[1 3 -2]", "InterpMethod": "Akima spline"}  # fmt: skip
    solid = {"NumberOfTableDimensions": "3", "Table": "cat(3, [1 2;3 4], [5 6;0 1])"}
    solid |= {f"BreakpointsForDimension{axis}": "[0 1]" for axis in (1, 2, 3)}
    rig.show(rig.block("Lookup_n-D", "curve", clock, **line), "curve")
    rig.show(rig.block("Lookup_n-D", "solid", clock, clock, clock, **solid), "solid")
    ours, theirs, _ = both(rig, tmp_path, 1.0)
    require_same(ours, theirs)
    assert theirs.shown[1].values[-1] == 1.0
