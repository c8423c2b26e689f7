"""Parameters of physical blocks in units of their own, by hand in SI."""

import numpy as np
import pytest
from rigs import Rig, shown

from drake_leg.errors import InvalidValueError


def physical(kind, parameters, *inputs):
    """Draw a physical block behind constants, and show what it puts out."""
    rig = Rig()
    block = rig.add_library(f"fl_lib/Physical Signals/Any/{kind}", "block", parameters)
    for place, value in enumerate(inputs, 1):
        into = rig.add_library("nesl_utility/Simulink-PS Converter", f"in {place}", ports={"in": 1})
        rig.connect(rig.constant(value), into)
        rig.physical(f"{into}#rconn:1", f"{block}#lconn:{place}")
    out = rig.add_library("nesl_utility/PS-Simulink Converter", "out", ports={"out": 1})
    rig.physical(f"{block}#rconn:1", f"{out}#lconn:1")
    rig.show(out, "y")
    return rig


def units(unit, **values):
    """Give parameters a unit."""
    return values | {f"{name}_unit": unit for name in values}


@pytest.mark.parametrize(
    ("kind", "parameters", "inputs", "expected"),
    [
        ("PS Saturation", units("cm", lower_limit="-20", upper_limit="30"), ["2"], 0.3),
        ("PS Saturation", units("cm", lower_limit="-20", upper_limit="30"), ["-2"], -0.2),
        ("PS Dead Zone", units("cm", lower_limit="-20", upper_limit="30"), ["2"], 1.7),
        ("PS Switch", units("mm", Threshold="500"), ["5", "0.6", "7"], 5.0),
        ("PS Switch", units("mm", Threshold="500"), ["5", "0.4", "7"], 7.0),
        ("PS Lookup Table (1D)", units("cm", x="[0 100 200]") | units("mm", f="[0 500 600]"),
         ["1.5"], 0.55),
        ("PS Lookup Table (2D)",
         units("cm", x1="[0 100]", x2="[0 200 400]") | units("mm", f="[0 20 40; 100 120 140]"),
         ["0.5", "3"], 0.08),
    ],
)  # fmt: skip
def test_limits_and_tables_have_units(kind, parameters, inputs, expected, tmp_path):
    values = physical(kind, parameters, *inputs).values(tmp_path)
    assert values["y"] == pytest.approx(expected, abs=1e-15)


def test_a_step_has_units(tmp_path):
    given = units("ms", time="500") | units("cm", initial="10", final="40")
    run = physical("PS Step", given).run(tmp_path)
    expected = np.where(run.time < 0.5, 0.1, 0.4)
    np.testing.assert_allclose(shown(run, "y"), expected, atol=1e-15)


def test_a_ramp_has_units(tmp_path):
    given = units("cm/s", slope="20") | units("ms", start_time="500")
    given |= units("mm", initial_output="100")
    run = physical("PS Ramp", given).run(tmp_path)
    expected = 0.1 + 0.2 * np.maximum(run.time - 0.5, 0.0)
    np.testing.assert_allclose(shown(run, "y"), expected, atol=1e-15)


@pytest.mark.parametrize(
    ("kind", "parameters", "said"),
    [
        ("PS Integrator", {"reset_method": "Rising"}, "has reset_method 'Rising'"),
        ("PS Integrator", {"saturation_spec": "Both"}, "has saturation_spec 'Both'"),
        ("PS Step", {}, "does not say in the file when it steps: replace it"),
    ],
)
def test_choices_that_do_not_run_are_refused(kind, parameters, said, tmp_path):
    inputs = ["1"] if kind == "PS Integrator" else []
    with pytest.raises(InvalidValueError, match=said):
        physical(kind, parameters, *inputs).code(tmp_path)
