"""S-functions of level 1: their states, outputs and rates against closed forms and scipy."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError

PENDULUM = """
function [sys, x0, str, ts] = swing(t, x, u, flag, length, start)
switch flag
    case 0
        [sys, x0, str, ts] = mdlInitializeSizes(start);
    case 1
        sys = mdlDerivatives(t, x, u, length);
    case 3
        sys = mdlOutputs(t, x, u);
    case {2, 4, 9}
        sys = [];
    otherwise
        error(['Unhandled flag = ', num2str(flag)]);
end

function [sys, x0, str, ts] = mdlInitializeSizes(start)
sizes = simsizes;
sizes.NumContStates = 2;
sizes.NumDiscStates = 0;
sizes.NumOutputs = 2;
sizes.NumInputs = 1;
sizes.DirFeedthrough = 0;
sizes.NumSampleTimes = 1;
sys = simsizes(sizes);
x0 = start;
str = [];
ts = [0 0];

function sys = mdlDerivatives(t, x, u, length)
sys(1) = x(2);
sys(2) = -9.81 / length * sin(x(1)) + u;

function sys = mdlOutputs(t, x, u)
sys = x;
"""


def plain(body, sizes, x0="[]", ts="[0 0]", head=""):
    """Write an S-function named ``f`` whose tasks are short."""
    return (
        f"function [sys, x0, str, ts] = f(t, x, u, flag)\n{head}\nx0 = []; str = []; ts = [];\n"
        f"switch flag\ncase 0\nsys = {sizes}; x0 = {x0}; ts = {ts};\n{body}\n"
        "otherwise\nsys = [];\nend\n"
    )


def rig_of(folder, code, name="f", **parameters):
    """Draw a model with one S-function behind a sine."""
    (folder / f"{name}.m").write_text(code, encoding="utf-8")
    rig = Rig()
    u = rig.block("Sin", "u", Frequency="3")
    rig.show(rig.block("S-Function", "S", u, FunctionName=name, **parameters), "y")
    return rig


def test_continuous_states_follow_their_equations(tmp_path):
    rig = rig_of(tmp_path, PENDULUM, "swing", Parameters="0.5*2, [1; 0]")
    run = rig.run(tmp_path, 2.0)
    expected = solve_ivp(
        lambda t, x: (x[1], -9.81 * np.sin(x[0]) + np.sin(3.0 * t)),
        (0.0, 2.0), (1.0, 0.0), t_eval=run.time, rtol=1e-11, atol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(shown(run, "y"), expected.y.T, atol=1e-8)


def test_discrete_states_change_at_samples(tmp_path):
    body = "case 2\nsys = [x(1) + u; x(2) + 1];\ncase 3\nsys = x(1) + 100 * x(2);"
    rig = rig_of(tmp_path, plain(body, "[0 2 1 1 0 0 1]", "[0; 5]", "[0.25 0]"))
    run = rig.run(tmp_path, 1.0)
    samples = np.floor(run.time / 0.25 + 1e-9).astype(int)
    sums = np.concatenate([[0.0], np.cumsum(np.sin(3.0 * 0.25 * np.arange(5)))])
    expected = sums[samples] + 100.0 * (5.0 + samples)
    np.testing.assert_allclose(shown(run, "y"), expected, atol=1e-12)


def test_both_kinds_of_states_are_one_vector(tmp_path):
    body = "case 1\nsys = -x(1);\ncase 2\nsys = x(2) + 1;\ncase 3\nsys = x;"
    rig = rig_of(tmp_path, plain(body, "[1 1 2 1 0 0 1]", "[3 4]", "[-1 0]"))
    run = rig.run(tmp_path, 0.5)
    found = shown(run, "y")
    np.testing.assert_allclose(found[:, 0], 3.0 * np.exp(-run.time), rtol=1e-8)
    assert (np.diff(found[:, 1]) >= 1.0).all()  # at each major step


def test_sizes_and_the_rate_may_be_those_of_what_comes_in(tmp_path):
    (tmp_path / "f.m").write_text(
        plain("case 3\nsys = 2 * u + t;", "[0 0 -1 -1 0 1]", ts="[-1 0]"), encoding="utf-8"
    )
    rig = Rig()
    rig.show(rig.block("S-Function", "S", rig.constant("[1 2 3]"), FunctionName="f"), "y")
    np.testing.assert_array_equal(rig.values(tmp_path, 10.0)["y"], [12.0, 14.0, 16.0])


def test_what_a_function_keeps_lasts_from_sample_to_sample(tmp_path):
    head = "global sum\npersistent calls\nif isempty(calls), calls = 0; end"
    body = "case 3\ncalls = calls + 1;\nsum = sum + calls;\nsys = sum;"
    code = plain(body, "[0 0 1 1 0 1 1]", ts="[0.5 0]", head=head)
    code = code.replace("case 0\n", "case 0\nsum = 10;\n")
    run = rig_of(tmp_path, code).run(tmp_path, 1.25)
    expected = np.array([11.0, 13.0, 16.0])[np.floor(run.time / 0.5 + 1e-9).astype(int)]
    np.testing.assert_array_equal(shown(run, "y"), expected)


def test_a_function_that_only_draws_is_left_alone(tmp_path):
    rig = Rig()
    u = rig.block("Sin", "u")
    rig.add_block("S-Function", "draws", {"FunctionName": "nowhere"}, ports={"in": 1, "out": 0})
    rig.show(u, "y")
    assert rig.values(tmp_path)["y"] == 0.0


OUT = "case 3\nsys = u;"
REFUSED = {
    "no file": (None, r"block 'S' \(SID 2\) is an S-Function without a file f.m"),
    "sizes": (plain(OUT, "[0 0 1 1]"), "answers the flag 0 by 4 numbers"),
    "states": (plain(OUT, "[1 0 1 1 0 1 1]"), "1 states, but 0 initial values"),
    "rates": (plain(OUT, "[0 0 1 1 0 1 2]", ts="[0 0; 1 0]"), "f has 2 sample times"),
    "next": (plain(OUT, "[0 0 1 1 0 1 1]", ts="[-2 0]"), r"its next sample time each time \(-2\)"),
    "width": (plain(OUT, "[0 0 1 2 0 1 1]"), "takes 2 numbers, but is given 1"),
    "outputs": (plain(OUT, "[0 0 3 1 0 1 1]"), "puts out 1 numbers where f has 3 outputs"),
    "unread": (plain(OUT, "[0 0 1 1 0 0 1]"), "says that DirFeedthrough is 0: set it to 1"),
    "fault": (plain("case 3\nsys = u(7);", "[0 0 1 1 0 1 1]"), "'u' is 1×1 and has no element 7"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_run_is_told_in_a_sentence(case, tmp_path):
    code, said = REFUSED[case]
    rig = rig_of(tmp_path, code or "", "f")
    if code is None:
        (tmp_path / "f.m").unlink()
    with pytest.raises(InvalidValueError, match=said):
        rig.run(tmp_path, 0.1)


def test_a_parameter_without_a_value_is_asked_for(tmp_path):
    rig = rig_of(tmp_path, PENDULUM, "swing", Parameters="far, [0; 0]")
    with pytest.raises(InvalidValueError, match="give a value of far"):
        rig.run(tmp_path, 0.1)
