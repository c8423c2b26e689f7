"""Motions whose derivatives nothing gives."""

import numpy as np
import pytest
from mechanism_models import pendulum
from rigs import shown

from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.running import run_model, runnable
from drake_leg.simulink.running.summary import remarks_of

FUNCTIONS = "fl_lib/Physical Signals/Functions/"
LATE = 0.002  # [s]: twice the time constant of one filter


def moved_through(block, folder):
    """What a joint does that follows a sine through a converter, which filters it, and a block."""
    built = pendulum(
        MotionActuationMode="InputMotion", TorqueActuationMode="ComputedTorque", SensePosition="on"
    )
    sine = built.add_block("Sin", "Drive", {"Frequency": "4", "Amplitude": "0.5"})
    inward = built.add_library("nesl_utility/Simulink-PS Converter", "In")
    between = built.add_library(f"{FUNCTIONS}{block}", "Between")
    outward = built.add_library("nesl_utility/PS-Simulink Converter", "Out")
    scope = built.add_block("Scope", "Scope", ports={"in": 1})
    built.connect(sine, inward)
    ends = (1, 2) if block == "PS Product" else (1,)
    built.physical(f"{inward}#rconn:1", *(f"{between}#lconn:{n}" for n in ends))
    built.physical(f"{between}#rconn:1", f"{built.sid('Pivot')}#lconn:2")
    built.meet("Pivot rconn:2", "Out lconn:1")
    built.connect(outward, scope, name="theta")
    model = read_model(built.write(folder / "m.slx"))
    ready = runnable(model, duration=0.5)
    run = run_model(ready, accuracy=1e-9)
    said = [text for text in remarks_of(model, ready, run) if "derivatives" in text]
    return run.time, shown(run, "theta"), said


def driven(time):
    return np.where(time > 0.0, 0.5 * np.sin(4.0 * time), 0.0)


@pytest.mark.slow
def test_a_product_has_the_derivatives_of_its_factors(tmp_path):
    time, theta, said = moved_through("PS Product", tmp_path)
    # What is left is of the order of the time constant squared times 8 rad/s^2.
    np.testing.assert_allclose(theta, driven(time - LATE) ** 2, atol=2e-5)
    assert said == []


@pytest.mark.slow
def test_where_nothing_gives_derivatives_a_joint_follows_by_a_filter(tmp_path):
    time, theta, said = moved_through("PS Sine", tmp_path)
    np.testing.assert_allclose(theta, np.sin(driven(time - 2.0 * LATE)), atol=3e-3)
    late = time > 0.05  # where the filters' own start has faded
    np.testing.assert_allclose(theta[late], np.sin(driven(time - 2.0 * LATE))[late], atol=5e-5)
    assert said == [
        "nothing gives derivatives of the motions from Between: joints follow them by a filter of "
        "second order with 1 ms"
    ]
