"""Charts in models: what drives them, when they make their steps, and what they say."""

import numpy as np
import pytest
from chart_drawings import Drawing, charted, heated, thermostat
from rigs import Rig, shown

from drake_leg.errors import InvalidValueError


def test_a_sampled_chart_makes_a_step_at_each_sample(tmp_path):
    run = heated(sampled=True).run(tmp_path, 3.0)
    x, heat, count = 1.55, 0.0, 0
    expected = []
    for step in range(25):
        if step and heat == 0.0 and x < 1.0:
            heat, count = 1.0, count + 1
        elif step and heat == 1.0 and x > 2.0:
            heat = 0.0
        expected.append((x, count))
        x += (3.0 * heat - 1.0) * 0.12
    at = 20 * np.arange(25)
    np.testing.assert_allclose(run.time[at], 0.12 * np.arange(25), atol=1e-12)
    np.testing.assert_allclose(shown(run, "x")[at], [x for x, _ in expected], atol=1e-9)
    np.testing.assert_array_equal(shown(run, "count")[at], [count for _, count in expected])
    assert expected[-1][1] >= 2


def test_a_continuous_chart_makes_a_step_at_each_major_step(tmp_path):
    run = heated(sampled=False).run(tmp_path, 3.0)
    x, heat = shown(run, "x"), shown(run, "heat")
    assert set(heat) == {0.0, 1.0}
    assert 0.9 < x.min() < 1.0 < 2.0 < x.max() < 2.1
    assert np.all(np.diff(x)[heat[:-1] == 1.0] > -0.02)


def test_a_chart_counts_the_seconds_of_the_model(tmp_path):
    made = Drawing()
    made.data("OUTPUT", "y")
    made.state("Wait", "\nentry: y = 0;")
    made.state("Go", "\nentry: y = 1;")
    made.way("", "Wait")
    made.way("Wait", "Go", "after(0.4, sec)")
    rig = Rig()
    rig.show(charted(rig, made, SystemSampleTime="0.1"), "y")
    run = rig.run(tmp_path, 1.0)
    np.testing.assert_array_equal(shown(run, "y")[run.time < 0.4 - 1e-9], 0.0)
    np.testing.assert_array_equal(shown(run, "y")[run.time > 0.4 + 1e-9], 1.0)


def test_a_parameter_of_a_chart_is_one_of_the_model(tmp_path):
    made = Drawing()
    made.data("PARAMETER", "most")
    made.data("INPUT", "u")
    made.data("OUTPUT", "y")
    made.state("A", "\ny = min(u, most);")
    made.way("", "A")
    rig = Rig(callbacks={"InitFcn": "most = 2.5;"})
    rig.show(charted(rig, made, rig.constant("7")), "y")
    np.testing.assert_array_equal(shown(rig.run(tmp_path, 0.1), "y"), 2.5)


def test_a_chart_that_does_not_run_says_why(tmp_path):
    made = thermostat()
    made.way("Heat", "Cool", "tripped", order=2)
    rig = Rig()
    rig.show(charted(rig, made, rig.constant("0"), rig.constant("0")), "y")
    with pytest.raises(
        InvalidValueError, match=r"'Mode'.* waits for the event 'tripped'.* can say"
    ):
        rig.run(tmp_path)
