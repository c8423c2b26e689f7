"""Derivatives through a run against differences of runs, closed forms and implicit functions."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy
from chains import PUMA, SEVEN

from drake_leg import LEG_B, gradient, run
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.differentiable import value_of
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian, foot_position
from drake_leg.robot.joint_mechanics import HardStop
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.step import config_of
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.studies.differentiated_step import DifferentiatedStep
from drake_leg.studies.extremes import Slope, one_of, peaks
from drake_leg.studies.gradient import FIELDS, Gradient
from drake_leg.studies.seeds import Seeds

STEP = {
    "duration": 1.6,
    "amplitude": 0.07,
    "q0": [90.0, -50.0, -90.0],
    "q0_error": [0.5, 0.0, -0.5],
    "direction": [1.0, 0.1, 0.2],
    "l1": 0.05,
    "l2": 0.1,
    "l3": 0.1,
    "density": 1000.0,
    "damping": 1e-3,
    "gravity": 9.80665,
}
SMALL = {
    "amplitude": 1e-5,
    "q0": 1e-2,
    "direction": 1e-4,
    "l1": 1e-5,
    "l2": 1e-5,
    "l3": 1e-5,
    "density": 1.0,
    "damping": 1e-5,
    "gravity": 1e-2,
}
RATE = "max_rate_rad_s"
# What integration leaves of a zero.
NOTHING = dict.fromkeys(("stroke_m", "end_position_m"), 1e-9)


def recorded(of, recording, summary):
    if of in summary:
        return summary[of]
    if of == "end_position_m":
        return np.array([recording[axis][-1] for axis in "xyz"])
    return max(np.abs(recording[f"tau{i}"]).max() for i in (1, 2, 3))


@cache
def results(name="", component=None, sign=0):
    """All results of a run with one option moved a little."""
    options = dict(STEP)
    if component is not None:
        options[name] = list(options[name])
        options[name][component] += sign * SMALL[name]
    elif name:
        options[name] += sign * SMALL[name]
    made = run("leg-b", **options)
    return {of: recorded(of, made.recording, made.summary) for of in FIELDS}


@cache
def gradients():
    return gradient("leg-b", of=tuple(FIELDS), by=tuple(SMALL), **STEP)


def differences(of, name):
    components = range(3) if isinstance(STEP[name], list) else [None]
    slopes = [
        (results(name, i, 1)[of] - results(name, i, -1)[of]) / (2.0 * SMALL[name])
        for i in components
    ]
    return np.array(slopes).T if components != [None] else slopes[0]


@pytest.mark.parametrize("of", sorted(FIELDS.keys() - {RATE}))
def test_a_gradient_is_that_of_differences_of_runs(of):
    slopes = gradients()[of]
    np.testing.assert_allclose(slopes.value, results()[of], rtol=1e-9)
    for name in SMALL:
        expected = differences(of, name)
        assert np.shape(slopes[name]) == np.shape(expected)
        atol = max(1e-6 * np.abs(expected).max(), NOTHING.get(of, 1e-12))
        np.testing.assert_allclose(slopes[name], expected, rtol=0.0, atol=atol, err_msg=name)


@pytest.mark.slow
def test_the_greatest_rate_has_the_gradient_of_differences():
    """The summary interpolates it by cubics, whose error small steps make negligible."""
    options = {"duration": 1.0, "max_step": 0.005}
    slopes = gradient("leg-b", of=RATE, by=("amplitude", "frequency", "l2"), **options)
    for name, value in (("amplitude", 0.07), ("frequency", 1.0), ("l2", 0.1)):
        ends = [
            run("leg-b", **{name: value + sign * 1e-5}, **options).summary[RATE] for sign in (1, -1)
        ]
        assert slopes[name] == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-6)


@pytest.mark.slow
def test_the_stroke_of_the_motion_is_twice_the_amplitude_over_the_frequency():
    A, w = 0.07, 1.3
    slopes = gradient(
        "leg-b",
        of="stroke_m",
        by=("amplitude", "frequency", "l2", "q0"),
        extremes="motion",
        amplitude=A,
        frequency=w,
        duration=3.0,
    )
    assert slopes.value == pytest.approx(2.0 * A / w, rel=1e-9)
    assert slopes["amplitude"] == pytest.approx(2.0 / w, rel=1e-9)
    assert slopes["frequency"] == pytest.approx(-2.0 * A / w**2, rel=1e-6)
    assert slopes.times[0] == pytest.approx(math.pi / w, abs=1e-6)
    assert abs(slopes["l2"]) < 1e-9
    assert np.abs(slopes["q0"]).max() < 1e-9


@pytest.mark.slow
def test_several_periods_tie_without_harm():
    slopes = gradient("leg-b", of="stroke_m", by="frequency", extremes="motion", duration=10.0)
    assert slopes["frequency"] == pytest.approx(-2.0 * 0.07, rel=1e-6)


def test_the_least_determinant_has_the_derivatives_of_its_formula():
    l1, l2, l3, q2, q3 = symbols = sympy.symbols("l1 l2 l3 q2 q3")
    det = -l2 * l3 * sympy.sin(q3) * (l1 + l2 * sympy.cos(q2) + l3 * sympy.cos(q2 + q3))
    at = dict(zip(symbols, (0.05, 0.1, 0.1, math.radians(-50.0), math.radians(-90.0)), strict=True))
    slopes = gradient("leg-b", of="det_j_min_m3", by=("l1", "l2", "l3", "q0"), duration=2.0)
    assert slopes.times == (0.0,)
    assert slopes.value == pytest.approx(float(det.subs(at)))
    for name, symbol in (("l1", l1), ("l2", l2), ("l3", l3)):
        assert slopes[name] == pytest.approx(float(det.diff(symbol).subs(at)), rel=1e-12)
    by_degrees = [math.radians(float(det.diff(q).subs(at))) for q in (q2, q3)]
    np.testing.assert_allclose(slopes["q0"], [0.0, *by_degrees], rtol=1e-12, atol=1e-18)


def test_the_joints_derivatives_are_those_of_the_implicit_function(rng):
    """``foot(q, l) = foot(q0, l) + (A / w) (1 - cos w t) d`` along the whole motion."""
    options = LegBOptions(duration=2.4)
    config = config_of(LEG_B, options)
    by = ("amplitude", "q0", "l1", "l2", "l3")
    step = DifferentiatedStep(config, Seeds(options, config, by).numbers(), IntegratorSettings())
    rows, q0 = np.linspace(0.0, 2.4, 61), np.array(config.start)

    def foot_by_lengths(q):
        def moved(i, h):
            lengths = {f"l{k + 1}": x + h * (k == i) for k, x in enumerate((0.05, 0.1, 0.1))}
            return foot_position(LegGeometry(**lengths, sign=1), q)

        return np.array([(moved(i, 1e-6) - moved(i, -1e-6)) / 2e-6 for i in range(3)]).T

    leg = LegGeometry.from_robot(LEG_B)
    for state in step.states(rows.tolist(), [0.4, 1.1, 2.4]):
        q = np.array([value_of(each) for each in state.q])
        way = np.outer([1.0, 0.0, 0.0], [1.0 - math.cos(state.time)])
        by_start = foot_jacobian(leg, q0) * math.radians(1.0)
        right = np.hstack([way, by_start, foot_by_lengths(q0) - foot_by_lengths(q)])
        expected = np.linalg.solve(foot_jacobian(leg, q), right)
        slopes = np.array([each.derivatives() for each in state.q])
        np.testing.assert_allclose(slopes, expected, rtol=0.0, atol=1e-8)


def test_torques_grow_with_the_density():
    slopes = gradient("leg-b", of="max_torque_n_m", by="density", density=2700.0, duration=1.0)
    assert slopes["density"] * 2700.0 == pytest.approx(slopes.value, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "robot",
    [PUMA, pytest.param(SEVEN, marks=pytest.mark.slow)],
    ids=["six joints", "redundant"],
)
def test_a_robot_of_ones_own_has_a_gradient(robot):
    q0 = [20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0][: len(robot.moving)]
    options = {"q0": q0, "duration": 0.4, "amplitude": 0.01}
    slopes = gradient(robot, of="end_position_m", by=("amplitude", "q0"), **options)
    assert slopes["q0"].shape == (3, len(q0))

    def end(**changed):
        recording = run(robot, **(options | changed)).recording
        return np.array([recording[axis][-1] for axis in "xyz"])

    by_amplitude = (end(amplitude=0.0101) - end(amplitude=0.0099)) / 0.0002
    np.testing.assert_allclose(slopes["amplitude"], by_amplitude, rtol=0.0, atol=1e-6)
    by_first = (end(q0=[20.01, *q0[1:]]) - end(q0=[19.99, *q0[1:]])) / 0.02
    np.testing.assert_allclose(slopes["q0"][:, 0], by_first, rtol=0.0, atol=1e-8)
    torque = gradient(robot, of="max_torque_n_m", by="gravity", **options)

    def greatest(gravity):
        recording = run(robot, gravity=gravity, **options).recording
        joints = enumerate(robot.moving, start=1)
        turning = [i for i, joint in joints if joint.row.joint == "revolute"]
        return max(np.abs(recording[f"tau{i}"]).max() for i in turning)

    by_gravity = (greatest(9.81665) - greatest(9.79665)) / 0.02
    assert torque["gravity"] == pytest.approx(by_gravity, rel=1e-6)
    assert torque["gravity"] > 0.0


def stopped_knee():
    """Leg B with a soft stop that its knee presses all along."""
    stop = HardStop(stiffness=2.0, damping=0.05, transition_width=0.1)
    bounds = {"upper": math.radians(-53.0), "upper_stop": stop}
    segments = [
        replace(each, mechanics=replace(each.mechanics, **bounds)) if each.joint == "knee" else each
        for each in LEG_B.segments
    ]
    return replace(LEG_B, segments=tuple(segments))


@pytest.mark.parametrize("extremes", ["rows", "motion"])
def test_the_force_of_joint_stops_is_differentiated(extremes):
    """The torque is greatest at the end, which is a row and an extreme of the motion."""
    options = {"q0": [90.0, -50.0, -90.0], "amplitude": 0.07, "duration": 1.0}
    slopes = gradient(
        stopped_knee(), of="max_torque_n_m", by=("amplitude", "q0"), extremes=extremes, **options
    )

    def greatest(robot, **changed):
        recording = run(robot, **(options | changed)).recording
        return max(np.abs(recording[f"tau{i}"]).max() for i in (1, 2, 3))

    def difference(name, by):
        at = np.asarray(options[name])
        more, less = (greatest(stopped_knee(), **{name: (at + h).tolist()}) for h in (by, -by))
        return (more - less) / (2.0 * np.max(by))

    assert slopes.times == (1.0,)
    assert slopes.value > 10.0 * greatest(LEG_B)
    np.testing.assert_allclose(slopes.value, greatest(stopped_knee()), rtol=1e-8)
    np.testing.assert_allclose(slopes["amplitude"], difference("amplitude", 1e-5), rtol=1e-5)
    by_degrees = [difference("q0", 1e-3 * each) for each in np.eye(3)]
    np.testing.assert_allclose(slopes["q0"], by_degrees, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("extremes", ["rows", "motion"])
@pytest.mark.parametrize("of", ["max_torque_n_m", "stroke_m"])
def test_a_run_that_is_not_reproduced_is_refused(extremes, of, monkeypatch):
    exact = FIELDS[of]
    wrong = exact._replace(rows=lambda *given: 1.001 * exact.rows(*given))
    monkeypatch.setitem(FIELDS, of, wrong)
    with pytest.raises(InvalidValueError, match=f"{of} is .* when it is repeated in AutoDiffXd"):
        gradient("leg-b", of=of, by="l2", extremes=extremes, duration=0.4)


def test_a_gradient_is_a_mapping_that_shows_itself():
    slopes = gradient("leg-b", of="end_position_m", by=("l2", "q0"), duration=0.2)
    assert isinstance(slopes, Gradient)
    assert list(slopes) == ["l2", "q0"]
    assert len(slopes) == 2
    assert "l2" in slopes
    assert slopes.units == {"l2": "m", "q0": "deg"}
    assert repr(slopes) == "<Gradient of end_position_m by l2, q0>"
    assert "m per deg" in slopes._repr_html_()
    with pytest.raises(InvalidValueError, match=r"no derivative by 'l1'.*l2"):
        slopes["l1"]


def test_damping_is_differentiated_in_its_own_unit():
    options = {"of": "max_torque_n_m", "by": "damping", "duration": 1.0}
    by_radians = gradient("leg-b", damping=0.001, **options)
    per_degree = gradient(
        "leg-b", damping=math.radians(0.001), damping_unit="N*m/(deg/s)", **options
    )
    assert per_degree["damping"] == pytest.approx(by_radians["damping"] * math.degrees(1.0))
    assert per_degree.units["damping"] == "N*m/(deg/s)"


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"of": "stroke"}, "of is 'stroke'.*did you mean stroke_m"),
        ({"by": "l4"}, "by has 'l4'; a step is differentiated by amplitude"),
        ({"of": ["stroke_m", 3]}, r"of is \['stroke_m', 3\]; it must be names of results"),
        ({"by": 3}, "by is 3; it must be names of options"),
        ({"by": ()}, r"by is \(\); it must be names"),
        ({"by": "frequency"}, "choose `extremes='motion'`"),
        ({"extremes": "all"}, "extremes is 'all'; it must be rows or motion"),
        ({"amplitud": 0.1}, "did you mean amplitude"),
        ({"of": "max_torque_n_m", "dynamics": "none"}, "`dynamics='none'` has no torques"),
        ({"push": [0, 0, 0.1]}, "a run with a push, a mass error or a torque limit"),
        ({"inverse": "damped"}, "an inverse that is not exact"),
        ({"correction": 5.0}, "`correction`"),
        ({"filter_time_constant": 0.01}, "`filter_time_constant`"),
        ({"amplitude": 0.12, "force": True}, "stops before its end"),
        ({"amplitude": 0.0, "by": "amplitude"}, "stroke_m is 0 both at 0 s and at 0.04 s"),
    ],
)
def test_what_has_no_gradient_is_refused_with_a_reason(options, says):
    with pytest.raises(InvalidValueError, match=says):
        gradient("leg-b", **({"of": "stroke_m", "by": "l2", "duration": 3.0} | options))


def test_only_straight_steps_have_a_gradient():
    with pytest.raises(InvalidValueError, match="the run 'scara' has no gradient"):
        gradient("scara", of="stroke_m", by="l1")
    with pytest.raises(SingularConfigurationError):
        gradient("leg-b", of="stroke_m", by="l2", amplitude=0.12)


def test_tied_peaks_have_one_derivative_or_none():
    first, second = Slope(1.0, np.array([2.0]), 0.1), Slope(1.0, np.array([2.0 + 1e-9]), 0.2)
    assert one_of("it", [first, second]) is first
    with pytest.raises(InvalidValueError, match=r"it is 1 both at 0.1 s and at 0.3 s"):
        one_of("it", [first, Slope(1.0, np.array([3.0]), 0.3)])
    higher = Slope(1.1, np.array([3.0]), 0.4)
    assert one_of("it", [first, higher]) is higher


def test_peaks_are_local_maxima_near_the_greatest():
    series = np.array([[0.0, 5.0], [3.0, 1.0], [1.0, 0.0], [4.96, 0.0]])
    assert peaks(series, 1e-2) == [(0, 1), (3, 0)]
    assert peaks(series, 1e-9) == [(0, 1)]
