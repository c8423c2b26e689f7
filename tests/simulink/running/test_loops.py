"""Algebraic loops: solved where that is asked for, against their closed forms."""

import json
import runpy

import numpy as np
import pytest
from rigs import Rig, shown

from drake_leg.cli import main
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.porting import ported
from drake_leg.simulink.running.running import run_model, runnable
from drake_leg.simulink.running.solving import UnsolvedLoopError, solved


def solve(rig, folder, duration=1.0, accuracy=1e-9, **options):
    model = read_model(rig.write(folder / "rig.slx"))
    ready = runnable(model, duration=duration, solve_loops=True, **options)
    return ready, run_model(ready, accuracy=accuracy)


def fed_back(rig, reference, gain="4"):
    """Y = gain (reference - y), which is gain/(1 + gain) of the reference."""
    difference = rig.block("Sum", "sum", reference, "", Inputs="+-")
    y = rig.block("Gain", "gain", difference, Gain=gain)
    rig.connect(y, f"{difference}#in:2")
    return y


def test_a_gain_in_a_loop_is_the_gain_of_the_loop(tmp_path):
    rig = Rig()
    y = fed_back(rig, rig.block("Sin", "sine", Frequency="3"))
    rig.show(y, "y")
    rig.show(rig.block("Integrator", "x", y), "x")
    ready, run = solve(rig, tmp_path)
    np.testing.assert_allclose(shown(run, "y"), 0.8 * np.sin(3.0 * run.time), atol=1e-14)
    integral = 0.8 * (1.0 - np.cos(3.0 * run.time)) / 3.0
    np.testing.assert_allclose(shown(run, "x"), integral, atol=1e-9)
    assert [block.name for block in ready.code.loops[0].blocks] == ["sum", "gain"]
    again = run_model(ready, accuracy=1e-9)
    np.testing.assert_array_equal(shown(again, "x"), shown(run, "x"))


def test_a_loop_of_vectors_is_a_system_of_equations(tmp_path):
    """Y = A y + b; neither the shape nor the size of y is in the file."""
    rig = Rig()
    matrix = np.array([[0.5, 2.0, 0.0], [-1.0, 0.2, 3.0], [0.0, 0.7, -0.4]])
    total = rig.block("Sum", "sum", rig.constant("[1;2;3]"), "", Inputs="++")
    fed = rig.block("Gain", "A", total, Gain="[0.5 2 0;-1 0.2 3;0 0.7 -0.4]",
                    Multiplication="Matrix(K*u)")  # fmt: skip
    rig.connect(fed, f"{total}#in:2")
    rig.show(total, "y")
    _, run = solve(rig, tmp_path, 0.1)
    expected = np.linalg.solve(np.eye(3) - matrix, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(shown(run, "y")[-1], expected, rtol=1e-12)


def test_a_loop_without_a_formula_meets_its_equation(tmp_path):
    """Y = 5 t - y^3, and behind it z = t - tanh(z) + y."""
    rig = Rig()
    five = rig.block("Gain", "five", rig.block("Clock", "clock"), Gain="5")
    y = rig.block("Sum", "y", five, "", Inputs="+-")
    cube = rig.block("Fcn", "cube", y, Expr="u^3")
    rig.connect(cube, f"{y}#in:2")
    z = rig.block("Sum", "z", y, "", Inputs="+-")
    rig.connect(rig.block("Trigonometry", "tanh", z, Operator="tanh"), f"{z}#in:2")
    rig.show(y, "y")
    rig.show(z, "z")
    ready, run = solve(rig, tmp_path)
    y, z = shown(run, "y"), shown(run, "z")
    np.testing.assert_allclose(y + y**3, 5.0 * run.time, atol=1e-12)
    np.testing.assert_allclose(z + np.tanh(z), y, atol=1e-12)
    assert len(ready.code.loops) == 2


def test_a_corner_in_a_loop_is_met(tmp_path):
    """Y = limit(4 (r - y)), at and between its limits."""
    rig = Rig()
    ramp = rig.block("Gain", "ramp", rig.block("Clock", "clock"), Gain="3")
    difference = rig.block("Sum", "sum", ramp, "", Inputs="+-")
    y = rig.block("Saturate", "limit", rig.block("Gain", "gain", difference, Gain="4"),
                  UpperLimit="1", LowerLimit="-1")  # fmt: skip
    rig.connect(y, f"{difference}#in:2")
    rig.show(y, "y")
    _, run = solve(rig, tmp_path)
    np.testing.assert_allclose(shown(run, "y"), np.minimum(2.4 * run.time, 1.0), atol=1e-12)


@pytest.mark.parametrize(("guess", "sign"), [("1", 1.0), ("-2", -1.0)])
def test_a_constraint_finds_the_root_at_its_guess(guess, sign, tmp_path):
    """Z^2 - 1 - t = 0; it asks for the solution itself."""
    rig = Rig()
    z = rig.block("AlgebraicConstraint", "z", "", InitialGuess=guess)
    square = rig.block("Math", "square", z, Operator="square")
    f = rig.block("Sum", "f", square, rig.constant("1"), rig.block("Clock", "t"), Inputs="+--")
    rig.connect(f, z)
    rig.show(z, "z")
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "z"), sign * np.sqrt(1.0 + run.time), atol=1e-13)


def test_a_constraint_has_as_many_unknowns_as_equations(tmp_path):
    """Z1 + z2 = 1 and z2 - z1 = 1, and a fixed point w = cos(w)."""
    rig = Rig()
    z = rig.block("simulink/Math Operations/Algebraic Constraint", "z", "", z0="0")
    fed = rig.block("Gain", "A", z, Gain="[1 1;-1 1]", Multiplication="Matrix(K*u)")
    rig.connect(rig.block("Sum", "f", fed, rig.constant("[1;1]"), Inputs="+-"), z)
    rig.show(z, "z")
    w = rig.block("AlgebraicConstraint", "w", "", Constraint="f(z) = z")
    rig.connect(rig.block("Trigonometry", "cos", w, Operator="cos"), w)
    rig.show(w, "w")
    run = rig.run(tmp_path, 0.01)
    np.testing.assert_allclose(shown(run, "z")[-1], [0.0, 1.0], atol=1e-12)
    assert shown(run, "w")[-1] == pytest.approx(0.7390851332151607, abs=1e-13)


def through_a_subsystem(rig, gate):
    """Y = t - 3 y where it runs, else t less what it put out last."""
    system = rig.add_block("SubSystem", "gated", ports={"in": 1, "out": 1, "enable": 1})
    rig.add_block("EnablePort", "enable", system=system)
    inside = rig.add_block("Inport", "in", {"Port": "1"}, system=system, ports={"out": 1})
    gain = rig.block("Gain", "three", inside, system=system, Gain="3")
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(gain, out)
    rig.connect(gate, f"{system}#enable")
    y = rig.block("Sum", "y", rig.block("Clock", "clock"), system, Inputs="+-")
    rig.connect(y, f"{system}#in:1")
    rig.show(y, "y")


def test_a_loop_goes_through_a_subsystem_that_is_enabled_at_times(tmp_path):
    rig = Rig()
    through_a_subsystem(rig, rig.block("DiscretePulseGenerator", "pulse", Period="1",
                                       PulseWidth="40"))  # fmt: skip
    _, run = solve(rig, tmp_path)
    t, y = run.time, shown(run, "y")
    runs = t < 0.4 - 1e-9
    np.testing.assert_allclose(y[runs], 0.25 * t[runs], atol=1e-13)
    held = (t > 0.4 + 1e-9) & (t < 1.0 - 1e-9)
    last = t[held] - y[held]
    np.testing.assert_allclose(last, last[0], atol=1e-13)
    assert 0.25 < last[0] <= 0.3 + 1e-12  # at a major step before 0.4 s


def test_a_loop_through_a_hold_is_one_at_its_sample_times(tmp_path):
    """h = hold(t - h): half of the time at each sample."""
    rig = Rig()
    y = rig.block("Sum", "y", rig.block("Clock", "clock"), "", Inputs="+-")
    held = rig.block("ZeroOrderHold", "hold", y, SampleTime="0.1")
    rig.connect(held, f"{y}#in:2")
    rig.show(held, "held")
    rig.show(y, "y")
    _, run = solve(rig, tmp_path, 0.95)
    samples = 0.05 * np.floor(10.0 * run.time + 1e-9)
    np.testing.assert_allclose(shown(run, "held"), samples, atol=1e-13)
    np.testing.assert_allclose(shown(run, "y"), run.time - samples, atol=1e-13)


def test_a_loop_of_a_bus_is_solved(tmp_path):
    """A bus of a = t + b / 2 and b = 4 - a, both taken out of it."""
    rig = Rig()
    bus = rig.block("BusCreator", "bus", "", "", Inputs="'a','b'")
    taken = {}
    for name in ("a", "b"):
        taken[name] = rig.block("BusSelector", f"take {name}", bus, OutputSignals=name)
    half = rig.block("Gain", "half", taken["b"], Gain="0.5")
    rig.connect(rig.block("Sum", "sum", rig.block("Clock", "t"), half, Inputs="++"),
                f"{bus}#in:1")  # fmt: skip
    four = rig.block("Sum", "rest", rig.constant("4"), taken["a"], Inputs="+-")
    rig.connect(four, f"{bus}#in:2")
    rig.show(taken["a"], "a")
    _, run = solve(rig, tmp_path)
    np.testing.assert_allclose(shown(run, "a"), (run.time + 2.0) / 1.5, atol=1e-12)


def test_a_loop_drives_what_lets_its_blocks_run(tmp_path):
    """An enable signal out of the loop of the subsystem that it lets run."""
    rig = Rig()
    system = rig.add_block("SubSystem", "gated", ports={"in": 1, "out": 1, "enable": 1})
    rig.add_block("EnablePort", "enable", system=system)
    inside = rig.add_block("Inport", "in", {"Port": "1"}, system=system, ports={"out": 1})
    out = rig.add_block("Outport", "out", {"Port": "1"}, system=system, ports={"in": 1})
    rig.connect(rig.block("Gain", "three", inside, system=system, Gain="3"), out)
    y = rig.block("Sum", "y", rig.constant("2"), system, Inputs="+-")
    rig.connect(y, f"{system}#in:1", f"{system}#enable")
    rig.show(y, "y")
    _, run = solve(rig, tmp_path, 0.1)
    np.testing.assert_allclose(shown(run, "y"), 0.5, atol=1e-13)


def test_a_switch_that_feeds_itself_keeps_what_it_put_out(tmp_path):
    """It follows the time while a pulse is on, and holds it after that."""
    rig = Rig()
    pulse = rig.block("DiscretePulseGenerator", "pulse", Period="1", PulseWidth="40")
    latch = rig.block("Switch", "latch", rig.block("Clock", "t"), pulse, "", Threshold="0.5")
    rig.connect(latch, f"{latch}#in:3")
    rig.show(latch, "y")
    _, run = solve(rig, tmp_path, 0.9)
    t, y = run.time, shown(run, "y")
    on = t < 0.4 - 1e-9
    np.testing.assert_allclose(y[on], t[on], atol=1e-12)
    off = t > 0.4 + 1e-9
    assert np.ptp(y[off]) < 1e-12
    assert 0.4 - 0.9 / 50.0 <= y[-1] <= 0.4


def lost(rig):
    """Z^2 = 1/4 - t, which has no solution from 0.25 s on; it is integrated."""
    z = rig.block("AlgebraicConstraint", "root", "", InitialGuess="1")
    square = rig.block("Math", "square", z, Operator="square")
    f = rig.block("Sum", "sum of squares", square, rig.block("Clock", "t"), rig.constant("0.25"),
                  Inputs="++-")  # fmt: skip
    rig.connect(f, z)
    rig.show(rig.block("Integrator", "x", z), "x")


def test_a_loop_without_a_solution_ends_the_run_by_its_name(tmp_path):
    rig = Rig()
    lost(rig)
    run = rig.run(tmp_path, accuracy=1e-6)
    assert run.ended == pytest.approx(0.25, abs=2e-3)
    assert "Newton's method finds no solution of the algebraic loop of 'root'" in run.stopped
    assert "'sum of squares'" in run.stopped
    assert f"at {run.ended:.6g} s" in run.stopped
    t = run.time
    np.testing.assert_allclose(
        shown(run, "x"), (0.125 - np.maximum(0.25 - t, 0.0) ** 1.5) / 1.5, atol=1e-5
    )


def test_a_loop_without_a_solution_at_a_sample_time_ends_the_run(tmp_path):
    rig = Rig()
    z = rig.block("AlgebraicConstraint", "root", "", InitialGuess="1")
    square = rig.block("Math", "square", z, Operator="square")
    held = rig.block("ZeroOrderHold", "hold", rig.block("Clock", "t"), SampleTime="0.1")
    rig.connect(rig.block("Sum", "f", square, held, rig.constant("0.25"), Inputs="++-"), z)
    rig.show(z, "z")
    run = rig.run(tmp_path)
    assert run.ended == pytest.approx(0.3)
    assert "no solution of the algebraic loop of 'root'" in run.stopped


def test_a_constraint_outside_of_a_loop_is_refused(tmp_path):
    rig = Rig()
    rig.show(rig.block("AlgebraicConstraint", "z", rig.constant("1")), "z")
    with pytest.raises(InvalidValueError, match=r"'z' .* does not depend on at once"):
        rig.code(tmp_path)


def test_a_ported_loop_is_the_same(tmp_path):
    rig = Rig()
    y = fed_back(rig, rig.block("Sin", "sine", Frequency="3"))
    rig.show(rig.block("Integrator", "x", y), "x")
    ready, ours = solve(rig, tmp_path, accuracy=1e-7)
    model = read_model(tmp_path / "rig.slx")
    script = ported(model, ready, "alone", accuracy=1e-7)
    (tmp_path / "alone.py").write_text(script.text, encoding="utf-8")
    theirs = runpy.run_path(str(tmp_path / "alone.py"))["run"]()
    assert ours.steps == theirs.steps
    np.testing.assert_array_equal(shown(ours, "x"), shown(theirs, "x"))
    assert "def loop(loop_z):" in script.text


def test_the_command_solves_what_it_refuses_without_its_option(tmp_path, capsys):
    rig = Rig()
    rig.show(fed_back(rig, rig.constant("2")), "y")
    model = str(rig.write(tmp_path / "loop.slx"))
    command = ["run", model, "--out", str(tmp_path / "out"), "--duration", "0.1", "--figures=none"]
    assert main(command) == 2
    said = capsys.readouterr().err
    assert "an algebraic loop: 'sum' (SID 2), 'gain' (SID 3): break it" in said
    assert "or --solve-loops" in said
    assert main([*command, "--solve-loops"]) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    (loop,) = summary["understood"]["algebraic_loops"]
    assert loop == {"blocks": ["sum", "gain"], "unknown_signals": 1}
    assert any("algebraic loops of 'sum' (SID 2)" in remark for remark in summary["remarks"])
    text = (tmp_path / "out" / "recording.csv").read_text(encoding="utf-8")
    assert text.splitlines()[-1].endswith(",1.6")


@pytest.mark.parametrize("setting", ["none", "warning", "error"])
def test_a_file_says_whether_its_loops_are_solved(setting, tmp_path):
    rig = Rig(solver={"StopTime": "0.1", "AlgebraicLoopMsg": setting})
    rig.show(fed_back(rig, rig.constant("2")), "y")
    model = read_model(rig.write(tmp_path / "loop.slx"))
    if setting == "error":
        with pytest.raises(InvalidValueError, match="an algebraic loop: 'sum'"):
            runnable(model)
    else:
        assert shown(run_model(runnable(model)), "y")[-1] == pytest.approx(1.6, abs=1e-12)
        with pytest.raises(InvalidValueError, match="an algebraic loop: 'sum'"):
            runnable(model, solve_loops=False)


def test_a_way_to_solve_loops_is_refused_where_there_is_none(tmp_path, capsys):
    rig = Rig()
    rig.show(rig.constant("2"), "y")
    model = str(rig.write(tmp_path / "none.slx"))
    assert main(["run", model, "--out", str(tmp_path / "out"), "--solve-loops"]) == 2
    assert "this model has none" in capsys.readouterr().err


# --- the method ------------------------------------------------------------------------------


def zero_of(residual, start):
    return solved(residual, (np.array(start, dtype=float), None), "the loop")


def test_newton_finds_zeros_and_keeps_its_jacobian():
    calls = []

    def residual(z):
        calls.append(z)
        return np.array([z[0] ** 2 + z[1] - 3.0, z[0] - z[1] - 1.0])

    root = zero_of(residual, [1.0, 1.0])
    expected = (np.sqrt(17.0) - 1.0) / 2.0
    np.testing.assert_allclose(root[0], [expected, expected - 1.0], rtol=1e-14)
    calls.clear()
    solved(lambda z: residual(z) - 1e-7, root, "the loop")
    assert len(calls) <= 3


@pytest.mark.parametrize(
    "residual",
    [lambda z: z**2 + 1.0, lambda z: z * 0.0 + 1.0, lambda z: z * np.nan,
     lambda z: np.sign(z) + 0.5],
    ids=["complex", "singular", "not finite", "jump"],
)  # fmt: skip
def test_what_has_no_zero_is_refused(residual):
    with pytest.raises(UnsolvedLoopError, match="no solution of the loop"):
        zero_of(residual, [0.7])


def test_steps_are_shortened_where_a_residual_is_curved():
    assert abs(zero_of(np.arctan, [20.0])[0][0]) < 1e-13


def test_rounding_of_large_numbers_ends_the_search():
    z, _ = zero_of(lambda z: (z + 1e6) - (1e6 + 0.3), [0.0])
    assert z[0] == pytest.approx(0.3, abs=1e-9)
