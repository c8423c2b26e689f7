"""Loops through a mechanism: a torque that depends on the acceleration that it causes."""

import math
import runpy

import numpy as np
import pytest
from mechanism_models import pendulum

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.closing import closed
from drake_leg.simulink.running.porting import data_name, ported
from drake_leg.simulink.running.running import run_model, runnable
from drake_leg.simulink.running.solving import UnsolvedLoopError

INERTIA = 0.4 * (1.0**2 + 0.02**2) / 12.0 + 0.4 * 0.5**2  # of the rod about its pivot [kg*m^2]
PULL = 3.0  # [N*m/rad]


def resisted(inertia):
    """A rod that is pulled back to its angle 0, and resists its acceleration as a flywheel does."""
    built = pendulum(
        TorqueActuationMode="InputTorque", SensePosition="on", SenseAcceleration="on",
        PositionTargetSpecify="on", PositionTargetValue="20",
    )  # fmt: skip
    given = []
    for place, gain in ((2, -PULL), (3, -inertia)):
        leaves = built.add_library("nesl_utility/PS-Simulink Converter", f"leaves{place}")
        built.meet(f"Pivot rconn:{place}", f"leaves{place} lconn:1")
        given.append(built.add_block("Gain", f"gain{place}", {"Gain": repr(gain)}))
        built.connect(f"{leaves}#out:1", given[-1])
    both = built.add_block("Sum", "both", {"Inputs": "++"}, ports={"in": 2, "out": 1})
    for place, gain in enumerate(given, start=1):
        built.connect(gain, f"{both}#in:{place}")
    enters = built.add_library("nesl_utility/Simulink-PS Converter", "enters", ports={"in": 1})
    built.connect(both, enters)
    built.meet("enters rconn:1", "Pivot lconn:2")
    show = built.add_block("Scope", "shown", ports={"in": 1})
    built.connect(both, show)
    return built


@pytest.mark.slow
@pytest.mark.parametrize("inertia", [0.5, 40.0, -0.1])
def test_a_torque_against_its_acceleration_is_a_flywheel(inertia, tmp_path):
    model = read_model(resisted(inertia).write(tmp_path / "m.slx"))
    run = run_model(runnable(model, duration=0.2, solve_loops=True), accuracy=1e-8)
    angle = math.radians(20.0) * np.cos(math.sqrt(PULL / (INERTIA + inertia)) * run.time)
    np.testing.assert_allclose(run.states[:, 0], angle, atol=1e-7)
    acceleration = -PULL * angle / (INERTIA + inertia)
    torque = -PULL * angle - inertia * acceleration
    np.testing.assert_allclose(run.shown[0].values[:, 0], torque, atol=1e-6)


@pytest.mark.parametrize("inertia", [0.5, 40.0, -0.1, -1.0])
def test_the_acceleration_at_the_start_is_that_of_both_inertias(inertia, tmp_path):
    """Where the torque gives more than all inertia back, the rod goes the other way."""
    model = read_model(resisted(inertia).write(tmp_path / "m.slx"))
    diagram = runnable(model, duration=1.0, solve_loops=True).diagram
    rates = diagram.EvalTimeDerivatives(diagram.CreateDefaultContext()).CopyToVector()
    expected = -PULL * math.radians(20.0) / (INERTIA + inertia)
    assert rates[-1] == pytest.approx(expected, rel=1e-12)


def test_a_torque_that_cancels_all_inertia_has_no_solution(tmp_path):
    model = read_model(resisted(-INERTIA).write(tmp_path / "m.slx"))
    run = run_model(runnable(model, duration=1.0, solve_loops=True))
    assert "no solution of the loop of what drives the mechanism" in run.stopped


def test_a_loop_is_refused_where_the_file_says_so(tmp_path):
    built = resisted(0.5)
    built.solver["AlgebraicLoopMsg"] = "error"
    model = read_model(built.write(tmp_path / "m.slx"))
    with pytest.raises(InvalidValueError, match=r"depends at once on forces .*`solve_loops`"):
        runnable(model, duration=1.0)


@pytest.mark.slow
def test_a_port_closes_the_loop_as_well(tmp_path):
    model = read_model(resisted(0.5).write(tmp_path / "m.slx"))
    ready = runnable(model, duration=0.1, solve_loops=True)
    script = ported(model, ready, "alone", accuracy=1e-7)
    (tmp_path / "alone.py").write_text(script.text, encoding="utf-8")
    (tmp_path / data_name("alone")).write_text(script.data, encoding="utf-8")
    theirs = runpy.run_path(str(tmp_path / "alone.py"))["run"]()
    np.testing.assert_allclose(theirs.states, run_model(ready, accuracy=1e-7).states, atol=1e-12)


def test_a_loop_that_is_not_linear_is_solved_or_told():
    found = closed(lambda z: np.cos(z), 1)
    assert found[0] == pytest.approx(0.7390851332151607, abs=1e-9)
    with pytest.raises(UnsolvedLoopError):
        closed(lambda z: z + 1.0, 1)
    with pytest.raises(UnsolvedLoopError):
        closed(lambda z: z * z + 1.0, 1)
