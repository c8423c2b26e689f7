"""Answers in closed form are those of the simulated runs, and of the closed forms one by one."""

import numpy as np
import pytest

from drake_leg.cli.entry import main
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian, inverse_kinematics
from drake_leg.kinematics.leg import foot_position as foot_of
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import smallest_singular_value
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.runs.options import LEG_B_POSTURE
from drake_leg.runs.peaks import greatest_between, static_torques
from drake_leg.singularity.families import LegFamilies
from drake_leg.singularity.stroke import closed_stroke
from drake_leg.studies import sweep as sweeps
from drake_leg.studies.batch import FIELDS, batch, is_closed
from drake_leg.studies.leg_places import QUANTITIES, LegSteps
from drake_leg.studies.leg_steps import answers
from drake_leg.studies.sweep import sweep

EVERY = list(FIELDS)


def planned(name="leg-b", vary=None, fields=EVERY, simulated=False, **options):
    vary = {"femur": [0.1]} if vary is None else vary
    return sweeps._plan(name, vary, None, None, None, None, fields, simulated, options)


@pytest.mark.parametrize("name", [pytest.param("leg-a", marks=pytest.mark.slow), "leg-b"])
def test_the_answers_are_those_of_the_simulated_runs(name):
    """Rows 4 ms apart miss less than 1e-6 of what is greatest between them."""
    knee = "20:70" if name == "leg-a" else "-70:-20"
    call = {
        "vary": {
            "femur": "0.06:0.14",
            "tibia": "0.06:0.14",
            "amplitude": "0.03:0.09",
            "q0[0]": "60:120",
            "q0[1]": knee,
        },
        "sample": 10,
        "seed": 5,
        "fields": EVERY,
        "direction": [1.0, 0.3, -0.2],
        "duration": 4.0,
    }
    closed = sweep(name, **call)
    simulated = sweep(name, **call, simulated=True, max_step=0.004, workers=1)
    assert closed["status"].tolist() == simulated["status"].tolist()
    assert len(closed.counts) == 2
    singular = closed["status"] == "singular"
    apart = closed["stopped_at_s"] - simulated["stopped_at_s"]
    assert np.abs(apart[singular]).max() < 1e-6
    for field in EVERY:
        assert np.isnan(closed[field][singular]).all()
        apart = np.abs(closed[field] - simulated[field])[~singular]
        assert apart.max() < 1e-6, field


def random_steps(rng, count=300):
    values = {
        "q0": np.radians(np.array(LEG_B_POSTURE)) + rng.uniform(-0.5, 0.5, (count, 3)),
        "direction": rng.normal(size=(count, 3)),
        "side": np.where(rng.random(count) < 0.5, 1.0, -1.0),
        "amplitude": rng.uniform(-0.05, 0.05, count),
        "frequency": rng.uniform(0.5, 3.0, count),
        "duration": rng.uniform(0.5, 8.0, count),
        "weight_2": rng.uniform(0.1, 1.0, count),
        "weight_3": rng.uniform(0.1, 1.0, count),
    }
    return values | {name: rng.uniform(0.04, 0.14, count) for name in ("l1", "l2", "l3")}


@pytest.mark.slow
def test_what_is_greatest_is_that_of_the_inverse_kinematics_on_fine_samples(rng):
    values = random_steps(rng)
    found = answers(LegSteps.of(**values), {name: (name,) for name in QUANTITIES})
    assert found.sure.mean() > 0.95
    assert 0.02 < found.met.mean() < 0.9
    for index in range(0, 300, 5):
        if not found.sure[index]:
            continue
        one = {name: each[index] for name, each in values.items()}
        leg = LegGeometry(
            l1=one["l1"], l2=one["l2"], l3=one["l3"], sign=1 if one["side"] > 0.0 else -1
        )
        step = SineStep(
            amplitude=one["amplitude"],
            frequency=one["frequency"],
            direction=tuple(one["direction"] / np.linalg.norm(one["direction"])),
        )
        stroke = closed_stroke(LegFamilies(leg), one["q0"], step.heading).length
        assert found.met[index] == (stroke <= step.way(one["duration"]))
        if found.met[index]:
            assert found.stop[index] == pytest.approx(stroke / step.length, abs=1e-8)
            continue
        time = np.linspace(0.0, min(one["duration"], step.period / 2.0), 4001)
        feet = foot_of(leg, one["q0"]) + step.displacement(time)
        q = inverse_kinematics(leg, feet, like=one["q0"])
        J = foot_jacobian(leg, q)
        rates = np.linalg.solve(J, step.velocity(time)[..., np.newaxis])[..., 0]
        det, tibia = determinant(leg, q), leg.l3 * np.cos(q[:, 1] + q[:, 2])
        carried = one["weight_3"] * tibia
        wanted = {
            "det_min": -det.min(),
            "det_max": det.max(),
            **{f"rate_{i + 1}": np.abs(rates[:, i]).max() for i in range(3)},
            "torque_2": np.abs(carried + one["weight_2"] * leg.l2 * np.cos(q[:, 1])).max(),
            "torque_3": np.abs(carried).max(),
        }
        for name, value in wanted.items():
            scale = abs(value) + 1e-12
            assert abs(found.greatest[name][index] - value) < 1e-5 * scale, name
            assert found.greatest[name][index] > value - 1e-7 * scale, name
        hip = np.hypot(feet[:, 0], feet[:, 1]).min()
        sigma = smallest_singular_value(J).min()
        assert min(-found.greatest["arm_sigma"][index], hip) == pytest.approx(sigma, rel=1e-5)


def test_a_step_over_the_hip_axis_stops_there():
    """The foot is straight before the hip axis, and goes towards it."""
    call = {
        "vary": {"amplitude": [0.015, 0.05]},
        "q0": [0.0, -50.0, -90.0],
        "direction": [-1.0, 0.0, 0.0],
        "fields": ["stroke_m"],
    }
    closed = sweep("leg-b", **call)
    simulated = sweep("leg-b", **call, simulated=True)
    assert closed["status"].tolist() == simulated["status"].tolist() == ["done", "singular"]
    assert closed["stopped_at_s"][1] == pytest.approx(simulated["stopped_at_s"][1], abs=1e-6)
    assert "hip-axis" in closed["message"][1]


def test_what_a_run_refuses_is_refused_here_too():
    vary = {"femur": [0.1, -0.1], "q0[2]": [-90.0, 0.0]}
    closed = sweep("leg-b", vary=vary, fields=["sigma_min_m"], duration=1.0)
    assert closed["status"].tolist() == ["done", "singular", "refused", "refused"]
    assert "the length l2 is -0.1 m" in closed["message"][2]


def test_more_steps_than_a_run_may_take_are_refused_here_too():
    """The longest step is 0.04 s, and less for a fast motion."""
    vary = {"duration": [1.0, 1e5], "amplitude": [0.01]}
    closed = sweep("leg-b", vary=vary, fields=["stroke_m"])
    simulated = sweep("leg-b", vary=vary, fields=["stroke_m"], simulated=True)
    assert closed["status"].tolist() == simulated["status"].tolist() == ["done", "refused"]
    assert "more than the 2000000 steps" in closed["message"][1]
    fast = planned(vary={"duration": [20.0, 2000.0]}, frequency=500.0)
    assert batch(fast, lambda done, count: None).left == [1]


def test_nothing_is_simulated_where_a_closed_form_is_enough(monkeypatch):
    monkeypatch.setattr(sweeps, "carried_out_here", lambda *_: pytest.fail("simulated"))
    monkeypatch.setattr(sweeps, "Dispatcher", lambda *_: pytest.fail("simulated"))
    monkeypatch.setattr(sweeps, "_gathered", lambda plan, places, *_: dict.fromkeys(places))
    result = sweep("leg-b", vary={"femur": "0.08:0.12:100"}, fields=EVERY)
    assert result.counts == {"done": 100}


def test_where_something_else_is_asked_for_runs_are_simulated():
    assert is_closed(planned())
    assert is_closed(planned("leg-a", density=500.0, gravity=1.6, q0=[90, 50, 80]))
    assert is_closed(planned(dynamics="none"))
    for other in (
        planned(fields=None),
        planned(fields=[*EVERY, "max_torque_error_n_m"]),
        planned("ellipse"),
        planned("scara", {"l1": [0.3]}),
        planned(vary={"inverse": ["exact"]}),
        planned(mass_error=0.1),
        planned(dynamics="forward"),
        planned(dynamics="none", density=500.0),
        planned(max_step=0.01),
        planned(force=True),
        planned(simulated=True),
    ):
        assert not is_closed(other)


@pytest.mark.parametrize("chunk", [2**16, 20])
def test_blocks_make_no_difference(monkeypatch, chunk):
    plan = planned(vary={"femur": "0.06:0.14:37"})
    whole = batch(plan, lambda *_: None)
    monkeypatch.setattr("drake_leg.studies.leg_steps.POINTS", 5 * 32)
    monkeypatch.setattr("drake_leg.studies.batch.CHUNK", chunk)
    counts = []
    parts = batch(plan, lambda done, total: counts.append((done, total)))
    assert len(counts) > 7
    assert counts[-1] == (37, 37)
    for name, column in whole.columns.items():
        np.testing.assert_array_equal(column, parts.columns[name])


def test_the_help_names_the_fields(capsys):
    with pytest.raises(SystemExit):
        main(["sweep", "--help"])
    shown = capsys.readouterr().out.replace("\n", " ")
    for field in FIELDS:
        assert field in shown


# --- the same entries of a run's summary ---------------------------------------------------------


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, SCARA], ids=lambda robot: robot.name)
def test_static_torques_are_drakes(robot, posed, rng):
    q = rng.uniform(-0.1, 0.1, (5, len(robot.moving)))
    torques = static_torques(robot, q, 9.80665)
    for row, posture in enumerate(q):
        plant, context = posed(robot, posture)
        exact = -plant.CalcGravityGeneralizedForces(context)
        np.testing.assert_allclose(torques[row], exact, atol=1e-12)


def test_what_is_greatest_between_rows_is_found():
    time = np.linspace(0.0, 3.0, 40)
    values = np.stack([np.sin(time), 0.2 * np.cos(3.0 * time)], axis=1)
    slopes = np.stack([np.cos(time), -0.6 * np.sin(3.0 * time)], axis=1)
    assert values.max() < 1.0 - 1e-5
    assert greatest_between(time, values, slopes) == pytest.approx(1.0, abs=1e-7)
    assert greatest_between(time[:1], values[:1], slopes[:1]) == pytest.approx(0.2)
