"""What the doctor says, in Python and on the command line."""

import json

import numpy as np
import pytest

from drake_leg.cli import main
from drake_leg.doctor import examine_posture
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.leg import LegGeometry, foot_position
from drake_leg.robots import LEG_B, PENDULUM, SCARA

KEYS = {
    "rank",
    "sigma_min_m",
    "manipulability",
    "nearest_family",
    "lost_direction",
    "stroke_forward_m",
    "stroke_backward_m",
    "max_amplitude_m_s",
    "branches_deg",
}


def doctor(capsys, *words):
    assert main(["doctor", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_regular_posture(capsys):
    said = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--direction", "1,0,0")
    assert said.keys() >= KEYS
    assert said["rank"] == 3
    assert said["lost_direction"] is None
    assert said["nearest_family"] == "hip-axis"
    assert said["sigma_min_m"] == pytest.approx(0.0376743, abs=1e-7)
    assert said["max_amplitude_m_s"] == pytest.approx(said["stroke_forward_m"] / 2)
    assert said["branches_deg"] == []


def test_a_singular_posture(capsys):
    said = doctor(capsys, "leg-b", "--q", "90,-50,0")
    assert said["rank"] == 2
    assert said["nearest_family"] == "stretch"
    assert np.linalg.norm(said["lost_direction"]) == pytest.approx(1.0)
    assert said["stroke_forward_m"] is said["max_amplitude_m_s"] is None


def test_all_branches_put_the_foot_there(capsys):
    foot = [0.1, 0.05, -0.1]
    said = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--foot", "0.1,0.05,-0.1")
    assert len(said["branches_deg"]) == 4
    feet = foot_position(LegGeometry.from_robot(LEG_B), np.radians(said["branches_deg"]))
    np.testing.assert_allclose(feet, [foot] * 4, atol=1e-14)


def test_branches_out_of_reach_are_named_as_such(capsys):
    said = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--foot", "0.24,0,0")
    assert len(said["branches"]) == 4
    assert sum(branch["q_deg"] is None for branch in said["branches"]) == 2
    assert len(said["branches_deg"]) == 2


def test_the_frequency_scales_the_amplitude(capsys):
    slow = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--frequency", "0.5")
    fast = doctor(capsys, "leg-b", "--q", "90,-50,-90", "--frequency", "2")
    assert fast["max_amplitude_m_s"] == pytest.approx(4 * slow["max_amplitude_m_s"])


def test_the_scara_is_asked_of_its_horizontal_motion(capsys):
    said = doctor(capsys, "scara", "--q", "30,90,-120", "--foot", "0.2,0.2,0")
    assert said["rank"] == 2
    assert said["nearest_family"] == "stretch"
    assert len(said["branches_deg"]) == 2


def test_text_says_the_same(capsys):
    assert main(["doctor", "leg-b", "--q", "0,90,30"]) == 0
    text = capsys.readouterr().out
    assert "rank            2 of 3" in text
    assert "lost direction  (0, 1, 0)" in text
    assert "singular already" in text


def test_any_chain_has_a_rank():
    diagnosis = examine_posture(PENDULUM, [0.3])
    assert (diagnosis.rank.rank, diagnosis.nearness) == (1, ())


def test_a_chain_without_closed_form_has_no_branches():
    with pytest.raises(InvalidValueError, match="no closed form"):
        examine_posture(PENDULUM, [0.3], foot=[0.1, 0.0, 0.0])


def test_a_scaras_height_is_the_lifts_alone():
    low = examine_posture(SCARA, [0.5, 1.0, 0.0], foot=[0.2, 0.2, 0.0])
    high = examine_posture(SCARA, [0.5, 1.0, 0.0], foot=[0.2, 0.2, 0.4])
    assert low.solutions == high.solutions


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["leg-c", "--q", "1,2,3"], "leg-c"),
        (["leg-b", "--q", "1,2"], "2 numbers"),
        (["leg-b", "--q", "1,x,3"], "'x'"),
        (["leg-b", "--q", "1,nan,3"], "nan"),
        (["leg-b", "--q", "90,-50,-90", "--direction", "0,0,0"], "zero"),
        (["leg-b", "--q", "90,-50,-90", "--frequency", "-1"], "-1"),
        (["leg-b", "--q", "90,-50,-90", "--foot", "1,2"], "1,2"),
    ],
)
def test_bad_input_is_one_sentence(capsys, words, said):
    assert main(["doctor", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
