from functools import cache

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import ScaraOptions

run_scara = RUNS["scara"].run


@cache
def run_of(duration=20.0, **changes):
    changes = {name: list(v) if isinstance(v, tuple) else v for name, v in changes.items()}
    return run_scara(ScaraOptions(duration=duration, **changes))


def test_the_default_run_is_straight_level_and_does_not_turn():
    summary = run_of().summary
    assert summary["robot"] == "scara"
    assert summary["max_position_error_m"] <= 1e-9
    assert summary["max_off_axis_m"] <= 1e-9
    assert summary["max_velocity_error_m_s"] <= 1e-9
    assert summary["max_yaw_error_rad"] <= 1e-9
    assert summary["max_torque_error_n_m"] <= 1e-14
    assert summary["stroke_m"] == pytest.approx(0.100, abs=1e-5)
    recording = run_of().recording
    np.testing.assert_allclose(recording["z"], 0.390, atol=1e-12)
    np.testing.assert_allclose(recording["yaw"], 0.0, atol=1e-9)


def test_its_columns_have_the_units_of_a_lift():
    headers = list(run_of().recording.columns)
    expected = {"q3[rad]", "q4[m]", "qdot4[m/s]", "qddot4[m/s^2]", "tau3[N*m]", "tau4[N]",
                "yaw[rad]", "det_j[m^2]", "sigma_min[m]"}  # fmt: skip
    assert expected <= set(headers)


def test_the_determinant_is_the_closed_form_and_sigma_min_that_of_x_and_y():
    recording, summary = run_of().recording, run_of().summary
    q1, q12 = recording["q1"], recording["q1"] + recording["q2"]
    np.testing.assert_allclose(
        recording["det_j"], 0.220 * 0.240 * np.sin(recording["q2"]), atol=1e-15
    )
    J = np.array(
        [
            [-0.220 * np.sin(q1) - 0.240 * np.sin(q12), -0.240 * np.sin(q12)],
            [0.220 * np.cos(q1) + 0.240 * np.cos(q12), 0.240 * np.cos(q12)],
        ]
    ).transpose(2, 0, 1)
    smallest = np.linalg.svd(J, compute_uv=False)[:, -1]
    np.testing.assert_allclose(recording["sigma_min"], smallest, atol=1e-15)
    assert summary["sigma_min_m"] == recording["sigma_min"].min()
    assert summary["det_j_min_m2"] == recording["det_j"].min()
    assert summary["det_j_max_m2"] == recording["det_j"].max()


@pytest.mark.parametrize("height", [0.0, 0.1124])
def test_the_tools_height_sets_the_lift_alone(height):
    recording = run_of(duration=1.0, tool_height=height).recording
    np.testing.assert_allclose(recording["z"], 0.340 + height, atol=1e-12)
    np.testing.assert_allclose(recording["x"], run_of(duration=1.0).recording["x"], atol=1e-12)


@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (-1.0, 1.0, 0.0)])
def test_other_horizontal_directions_are_as_exact(direction):
    summary = run_of(duration=6.4, direction=direction).summary
    assert summary["stop_reason"] is None
    assert summary["max_position_error_m"] <= 1e-9
    assert summary["max_yaw_error_rad"] <= 1e-9


@pytest.mark.slow
def test_a_run_into_the_boundary_stops_where_the_arm_is_stretched():
    outcome = run_of(amplitude=0.2, force=True)
    x0 = 0.220 * np.cos(np.radians(30)) + 0.240 * np.cos(np.radians(120))
    y0 = 0.220 * np.sin(np.radians(30)) + 0.240 * np.sin(np.radians(120))
    stroke = np.sqrt(0.460**2 - y0**2) - x0
    instant = np.arccos(1 - stroke / 0.2)
    assert outcome.summary["stopped_at_s"] == pytest.approx(instant, abs=1e-6)
    assert "singular" in outcome.summary["stop_reason"]
    assert outcome.summary["max_position_error_m"] < 1e-6
    assert outcome.recording["q2"][-1] == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("elbow", [0.0, 180.0])
def test_a_singular_start_raises(elbow):
    with pytest.raises(SingularConfigurationError):
        run_of(q0=(30.0, elbow, 0.0))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"tool_height": 0.2}, "R is 0.2"),
        ({"direction": (0.0, 0.0, 1.0)}, "horizontal"),
        ({"l1": -0.1}, "l1 is -0.1"),
        ({"q0": (1.0, 2.0)}, "three finite angles"),
        ({"gravity": -1.0}, "gravity is -1.0"),
        ({"damping": float("inf")}, "damping is inf"),
    ],
)
def test_senseless_options_are_refused_in_a_sentence(change, said):
    with pytest.raises(InvalidValueError, match=said) as caught:
        run_of(**change)
    assert "\n" not in str(caught.value)


IMPOSSIBLE = [
    {"density": 1e300}, {"density": 1e-320}, {"l1": 1e300}, {"amplitude": 1e300},
    {"frequency": 1e-320},
]  # fmt: skip


@pytest.mark.parametrize("change", IMPOSSIBLE, ids=str)
def test_an_impossible_arm_is_refused_or_stops_in_a_sentence_or_moves_as_told(change):
    try:
        summary, sentence = run_of(duration=0.2, **change).summary, ""
    except InvalidValueError as error:
        summary, sentence = {}, str(error)
    assert "\n" not in sentence
    assert sentence or summary["stop_reason"] or summary["max_position_error_m"] < 1e-6
