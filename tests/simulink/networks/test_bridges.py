"""Bridges and pulse-width modulators, averaged, against the current of a resistor and inductor."""

import numpy as np
import pytest
from circuits import Circuit
from rigs import shown

from drake_leg.errors import InvalidValueError

SOURCES = "Electrical Sources"
CIRCUITS, CONVERTERS = (
    "ee_lib/Integrated Circuits/",
    "ee_lib/Semiconductors & Converters/Converters/",
)
AVERAGED = {"pwm_or_av": "ee.enum.pwm_or_av.averaged"}


def source(made, net, volts):
    made.two(SOURCES, "DC Voltage Source", f"at {net}", net, "0", v0=str(volts), v0_unit="V")


def modulated(asked, **more):
    """A modulator between the connections w and 0, that an asked voltage drives."""
    made = Circuit()
    made.ground()
    source(made, "a", asked)
    ends = {"lconn:1": "a", "lconn:2": "0", "rconn:1": "w", "rconn:2": "0"}
    texts = {**AVERAGED, "Vmin": "-10", "Vmax": "10", "Vm": "5", **more}
    made.part(CIRCUITS, "Controlled PWM Voltage", "PWM", ends, **texts)
    made.voltage("w", "0", "mean")
    return made


def driven(asked, reverse=0.0, brake="0", **more):
    """An inductor of 0.4 H and a resistor of 1.9 Ohm at a bridge of 0.1 Ohm."""
    made = modulated(asked)
    source(made, "r", reverse)
    ends = {"lconn:1": "w", "lconn:2": "0", "lconn:3": "r", "rconn:1": "p", "rconn:2": "n"}
    ends |= {"lconn:4": brake} if brake else {}
    texts = {**AVERAGED, "discontinuous": "0", "Vmax": "5", "Vm": "24", "Ron": "0.1", **more}
    made.part(CONVERTERS, "H-Bridge", "bridge", ends, **texts)
    made.current("p", "q", "current")
    made.resistor("R", "q", "s", "1.9")
    made.two("Electrical Elements", "Inductor", "L", "s", "n", l="0.4", l_unit="H", r="0", g="0")
    made.one("Electrical Elements", "Electrical Reference", "other ground", "n")
    return made


@pytest.mark.parametrize(
    ("asked", "share"), [(-10.0, 0.0), (0.0, 0.5), (5.0, 0.75), (12.0, 1.0), (-11.0, 0.0)]
)
def test_pulses_are_as_wide_as_is_asked(tmp_path, asked, share):
    made = modulated(asked)
    np.testing.assert_allclose(shown(made.run(tmp_path), "mean"), 5.0 * share, rtol=1e-12)


@pytest.mark.parametrize(("reverse", "sign"), [(0.0, 1.0), (3.0, -1.0)])
def test_a_bridge_drives_a_load_by_the_width_of_its_pulses(tmp_path, reverse, sign):
    run = driven(5.0, reverse).run(tmp_path)
    final = sign * 0.75 * 24.0 / (0.1 + 1.9)
    exact = final * -np.expm1(-run.time * 2.0 / 0.4)
    np.testing.assert_allclose(shown(run, "current"), exact, atol=1e-6)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: driven(1.0, brake="r"), "'bridge'.* brakes by a voltage at BRK.* connect BRK to"),
        (lambda: driven(1.0, brake=""), "'bridge'.* brakes by a voltage at BRK"),
        (lambda: driven(1.0, pwm_or_av="1"), "'bridge'.* pwm_or_av '1'.* choose 'averaged'"),
        (lambda: driven(1.0, discontinuous="1"), "'bridge'.* discontinuous '1'.* 'continuous'"),
        (lambda: modulated(1.0, Vmax="-10"), "'PWM'.* Vmax -10 V, not more .* -10 V: raise Vmax"),
        (lambda: modulated(1.0, ComponentPath="ee.ic.controlled_pwm_ps"), "'PWM'.* ComponentPath"),
    ],
)
def test_what_is_not_computed_is_refused(tmp_path, made, message):
    with pytest.raises(InvalidValueError, match=message):
        made().run(tmp_path)
