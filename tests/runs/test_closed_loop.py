"""Runs of robots with closed loops: driven or released, their loops closed, their energy kept."""

import math

import numpy as np
import pytest

from drake_leg import run
from drake_leg.errors import InvalidValueError
from drake_leg.robot.linkages import FIVE_BAR, FOUR_BAR, SLIDER_CRANK
from drake_leg.runs.catalogue import run_kind


@pytest.mark.slow
def test_a_driven_linkage_swings_with_its_loops_closed(tmp_path):
    done = run(FOUR_BAR, swing=[60], frequency=2.0, duration=1.0, out=tmp_path / "swing")
    assert done.summary["max_closure_m"] < 1e-9
    assert done.summary["energy_error_j"] < 1e-6
    time, q = done.recording["time"], done.recording.stack("q1", "q2", "q3")
    exact = math.radians(60) * (2.0 - np.cos(2.0 * time))
    assert q[:, 0] == pytest.approx(exact, abs=1e-12)
    assert set(done.figures) == {"joint_angles", "joint_torques"}
    assert (tmp_path / "swing" / "joint_torques.png").exists()


@pytest.mark.slow
def test_a_released_linkage_keeps_its_energy():
    done = run(SLIDER_CRANK, q0=[80], duration=0.3)
    assert done.summary["dynamics"] == "released"
    assert done.summary["max_closure_m"] < 1e-6
    assert done.summary["energy_error_j"] < 1e-9
    assert done.recording["q1"][0] == pytest.approx(math.radians(80))
    assert "tau1[N*m]" not in done.recording.columns


@pytest.mark.slow
def test_a_released_linkage_steps_by_its_error():
    """In steps of 10 ms a five-bar linkage would change its energy."""
    done = run(FIVE_BAR, duration=0.2, max_step=0.01)
    assert done.summary["accuracy"] == 1e-8
    assert done.summary["energy_error_j"] < 1e-6
    assert done.summary["inaccuracy"] is None


def test_a_change_of_energy_is_said():
    done = run(SLIDER_CRANK, q0=[80], duration=1.0, integrator="explicit_euler", max_step=0.02)
    assert "the energy has changed by up to" in done.summary["inaccuracy"]
    assert "choose a smaller `max_step`" in done.summary["inaccuracy"]


def test_its_diagram_is_that_which_is_simulated():
    kind = run_kind(FOUR_BAR)
    diagram, _ = kind.diagram(kind.options(swing=[10]))
    assert {system.get_name() for system in diagram.GetSystems()} >= {"Sine Wave", "Closed Loops"}


def test_options_that_make_no_sense_are_refused():
    with pytest.raises(InvalidValueError, match="frequency means nothing without a motion"):
        run(FOUR_BAR, frequency=2.0)
    with pytest.raises(InvalidValueError, match=r"swing is .*; it must be 1 finite numbers"):
        run(FOUR_BAR, swing=[1, 2])
    with pytest.raises(InvalidValueError, match="has no option 'amplitude'"):
        run(FOUR_BAR, amplitude=0.1)
