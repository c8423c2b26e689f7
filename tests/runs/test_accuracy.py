"""A run whose error can be seen says so, whatever moves; a start that nobody can follow, too."""

import json
import math

import pytest

from drake_leg.cli import main
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.outcome import finer, inaccuracy, shows
from drake_leg.simulation.integrator import IntegratorSettings

EULER = {"integrator": "explicit_euler"}


def summary_of(name, **options):
    return RUNS[name].run(RUNS[name].options(**options), None).summary


def test_an_error_shows_that_is_wider_than_a_curve():
    assert not shows(0.009, 1.0)
    assert shows(0.011, 1.0)
    assert not shows(1e-7, 0.0)
    assert shows(1e-5, 0.0)
    assert shows(math.nan, 1.0)
    assert inaccuracy(0.001, 1.0, "angle", "rad", "do") is None
    said = inaccuracy(3.7, 3.14, "angle", "rad", "choose a smaller `max_step`")
    assert said.startswith("the angle is up to 3.7 rad from the exact motion")
    assert said.endswith("choose a smaller `max_step`")


def test_the_remedy_fits_the_integrator():
    assert finer(IntegratorSettings()) == "choose a smaller `max_step`"
    assert finer(IntegratorSettings(accuracy=1e-3)) == "choose a finer `accuracy`"
    assert "runge_kutta5" in finer(IntegratorSettings(scheme="explicit_euler"))


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("pendulum", EULER),
        ("pendulum", {"max_step": 0.04, "integrator": "runge_kutta3", "duration": 60.0}),
        ("pendulum-damped", EULER | {"max_step": 0.02, "duration": 5.0}),
        ("pendulum-spring", EULER | {"duration": 1.0}),
        ("leg-b", EULER | {"duration": 7.0}),
        ("leg-a", EULER | {"duration": 7.0}),
        ("ellipse", EULER | {"duration": 7.0}),
        ("scara", EULER | {"duration": 7.0}),
    ],
)
def test_an_error_that_can_be_seen_is_said(name, options):
    said = summary_of(name, **options)["inaccuracy"]
    assert "from the exact motion" in said
    assert said.endswith("choose a smaller `max_step` or `integrator='runge_kutta5'`")


@pytest.mark.parametrize("name", RUNS)
def test_nothing_is_said_of_the_defaults(name):
    summary = summary_of(name, duration=2.0)
    assert summary["inaccuracy"] is None
    assert summary.get("ill_conditioned") is None


@pytest.mark.parametrize(
    "options",
    [
        {"q0_error": [2.0, -1.0, 3.0]},
        {"push": [0.0, 0.0, 0.3], "push_at": 0.1},
        {"filter_time_constant": 0.05, "max_step": 0.01},
        {"amplitude": 0.1, "inverse": "damped"},
    ],
    ids=str,
)
def test_what_was_asked_for_is_no_inaccuracy(options):
    summary = summary_of("leg-b", duration=3.0, **options)
    assert summary["max_position_error_m"] > 1e-3
    assert summary["inaccuracy"] is None


# --- ill-conditioned starts ------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("pendulum", {"q0": [-90.0]}),
        pytest.param("pendulum", {"q0": [-89.9999]}, marks=pytest.mark.slow),
        # On the separatrix.
        pytest.param(
            "pendulum", {"q0": [0.0], "velocity_target": 491.3373}, marks=pytest.mark.slow
        ),
        ("pendulum-damped", {"q0": [-90.0], "duration": 10.0}),
        pytest.param(
            "pendulum-spring",
            {"q0": [-90.0], "spring_stiffness": 0.0, "duration": 10.0},
            marks=pytest.mark.slow,
        ),
    ],
    ids=str,
)
def test_a_start_that_ends_near_upright_is_called_ill_conditioned(name, options):
    summary = summary_of(name, **options)
    assert summary["error_growth"] > 1e6
    rate = summary["instability_1_s"]
    assert f"exp({rate:.3g} t)" in summary["ill_conditioned"]
    assert "near upright" in summary["ill_conditioned"]


@pytest.mark.slow
def test_upright_the_free_pendulum_says_that_nobody_can_tell():
    summary = summary_of("pendulum", q0=[-90.0])
    assert summary["instability_1_s"] == pytest.approx(6.064, abs=1e-3)
    assert summary["inaccuracy"].endswith("start farther from upright")
    assert summary_of("pendulum", q0=[-90.0], duration=1.0)["inaccuracy"] is None


@pytest.mark.slow
def test_it_ends_with_status_1_one_sentence_and_all_files(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())
    out = tmp_path / "out"
    assert main(["run", "pendulum", "--q0", "-90", "--out", str(out)]) == 1
    printed = capsys.readouterr()
    assert "angle up to 6.3e+00 rad from the exact motion" in printed.out
    remark, sentence = printed.err.splitlines()
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert remark == f"drake-leg: {summary['ill_conditioned']}"
    assert sentence == f"drake-leg: {summary['inaccuracy']}"
    assert (out / "recording.csv").exists()
