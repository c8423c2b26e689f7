"""What a file's solver asks for, of signals alone."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.running import run_model, runnable


def chemistry(solver):
    """Robertson's three reactions, whose rates differ by nine orders of magnitude."""
    rig = Rig(solver={"Solver": solver, "RelTol": "1e-8", "StopTime": "1e5"})
    texts = ("-0.04*u(1) + 1e4*u(2)*u(3)", "0.04*u(1) - 1e4*u(2)*u(3) - 3e7*u(2)^2", "3e7*u(2)^2")
    mux = rig.add_block("Mux", "all", {"Inputs": "3"}, ports={"in": 3, "out": 1})
    for place, text in enumerate(texts, 1):
        rate = rig.block("Fcn", f"rate {place}", mux, Expr=text)
        state = rig.block("Integrator", f"x{place}", rate, InitialCondition=str(float(place == 1)))
        rig.connect(state, f"{mux}#in:{place}")
    rig.show(mux, "x")
    return rig


@pytest.mark.parametrize("solver", ["ode15s", "ode23tb"])
def test_what_is_said_to_be_stiff_is_integrated_so(tmp_path, solver):
    run = chemistry(solver).run(tmp_path, duration=1e5, accuracy=None)
    assert (run.integrator, run.complete) == ("rodas5p", True)
    assert run.steps < 1000
    exact = solve_ivp(
        lambda _, x: [
            -0.04 * x[0] + 1e4 * x[1] * x[2],
            0.04 * x[0] - 1e4 * x[1] * x[2] - 3e7 * x[1] ** 2,
            3e7 * x[1] ** 2,
        ],
        (0.0, 1e5), [1.0, 0.0, 0.0], method="Radau", t_eval=run.time, rtol=1e-10, atol=1e-14,
    )  # fmt: skip
    np.testing.assert_allclose(shown(run, "x"), exact.y.T, atol=1e-6)


@pytest.mark.parametrize(("absolute", "error"), [("auto", None), ("1e-9", 1e-4)])
def test_small_states_are_as_accurate_as_the_file_asks(tmp_path, absolute, error):
    rig = Rig(solver={"Solver": "ode45", "AbsTol": absolute})
    gain = rig.add_block("Gain", "spring", {"Gain": "-4000"}, ports={"in": 1, "out": 1})
    speed = rig.block("Integrator", "speed", gain)
    place = rig.block("Integrator", "place", speed, InitialCondition="1e-4")
    rig.connect(place, f"{gain}#in:1")
    rig.show(place, "place")
    run = rig.run(tmp_path, accuracy=None)
    apart = np.abs(shown(run, "place") - 1e-4 * np.cos(np.sqrt(4000.0) * run.time)).max() / 1e-4
    assert run.accuracy == pytest.approx(1e-6 if error is None else 1e-9)
    assert error is None or apart < error


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"duration": -1.0}, r"the duration is -1\.0 s; it must be zero or positive"),
        ({"duration": float("inf")}, "the duration is inf s; it must be zero or positive"),
        ({"contact": "soft"}, "contact is 'soft'; it must be 'smooth' or 'pulling' or 'drake'"),
        ({"accuracy": 0.0}, r"the accuracy is 0\.0; it must be in 1e-14 \.\.\. 0\.1"),
        ({"accuracy": float("nan")}, "the accuracy is nan; it must be in 1e-14"),
        ({"budget": 0.0}, r"the budget is 0\.0 s; it must be a positive number"),
    ],
)
def test_what_no_run_can_have_is_refused(given, problem, tmp_path):
    rig = Rig()
    rig.show(rig.block("Clock", "clock"), "t")
    model = read_model(rig.write(tmp_path / "m.slx"))
    is_of_run = given.keys() <= {"accuracy", "budget"}
    with pytest.raises(InvalidValueError, match=problem):
        run_model(runnable(model, **({} if is_of_run else given)), **(given if is_of_run else {}))
