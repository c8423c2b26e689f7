"""A root is where SciPy's ``brentq`` finds it, or where it is known to be."""

import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from drake_leg.kinematics.roots import MOST, sign_change

SHAPES = {
    "sine": math.sin,
    "cubic": lambda x: x**3,
    "flat": lambda x: x**9,
    "steep": lambda x: math.copysign(math.sqrt(abs(x)), x),
    "curved": math.expm1,
    "saturated": lambda x: math.tanh(50.0 * x),
    "step": lambda x: 1.0 if x > 0.0 else -1.0,
}


@pytest.mark.parametrize("shape", SHAPES)
@given(root=st.floats(-1.0, 1.0), width=st.floats(1.1, 1.5), sign=st.sampled_from([1.0, -1.0]))
def test_a_root_is_found_to_rounding(shape, root, width, sign):
    calls = []

    def function(x):
        calls.append(x)
        return sign * SHAPES[shape](x - root)

    found = sign_change(function, -width, width + 0.1)
    assert len(calls) <= MOST + 2
    assert found == pytest.approx(root, rel=1e-15, abs=1e-30)


@pytest.mark.parametrize("level", [-0.9, -0.1, 1e-6, 0.3, 0.99])
def test_it_agrees_with_brentq(level):
    def function(x):
        return math.sin(x) - level

    theirs = brentq(function, -1.5, 1.55, xtol=1e-300, rtol=1e-15)
    assert sign_change(function, -1.5, 1.55) == pytest.approx(theirs, rel=1e-15)


def test_a_root_at_an_end_is_that_end():
    assert sign_change(lambda x: x, 0.0, 2.0) == 0.0
    assert sign_change(lambda x: x - 2.0, 0.0, 2.0) == 2.0


@pytest.mark.slow
def test_a_posture_is_examined_and_a_leg_is_built_without_scipy():
    """SciPy takes longer to load than the doctor takes to answer."""
    code = (
        "import sys; from drake_leg import LEG_B, build_hexabot_leg, examine_posture; "
        "from drake_leg import HexabotLegConfig; q = (1.57, -0.87, -1.57); "
        "examine_posture(LEG_B, q, direction=(1, 0, 0), frequency=1.0, foot=(0.1, 0.1, -0.1)); "
        "build_hexabot_leg(HexabotLegConfig(robot=LEG_B, q0=q)); "
        "sys.exit('scipy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
