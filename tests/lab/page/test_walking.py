"""The answer to the reports' last question, from the walk itself."""

import numpy as np
import pytest

from drake_leg.lab.page.walking import answer, shares, tilt
from drake_leg.runs.named import run


@pytest.fixture(scope="module")
def walk():
    return run("hexapod", duration=2.5)


@pytest.mark.slow
def test_standing_and_swinging_legs_do_all_the_work(walk):
    recording = walk.recording
    found = shares(walk.robot, recording, 1.0)
    numbers = range(1, 19)
    power = sum(np.maximum(recording[f"tau{n}"] * recording[f"qdot{n}"], 0.0) for n in numbers)
    last = recording["time"] >= 1.5
    whole = np.trapezoid(power[last], recording["time"][last])
    assert found.standing + found.swinging == pytest.approx(whole, rel=1e-9)
    assert found.standing < 0.3 * found.swinging


def test_the_answer_has_the_numbers_of_the_run(walk):
    html = answer(walk)
    assert "without roll, pitch or heave" in html
    assert f"{tilt(walk):.3f}°" in html
    assert f"{1e3 * walk.summary['least_static_margin_m']:.1f} mm" in html
    assert tilt(walk) == max(
        walk.summary["greatest_roll_error_deg"], walk.summary["greatest_pitch_error_deg"]
    )
