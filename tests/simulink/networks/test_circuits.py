"""Electrical networks against closed forms, and networks without a solution."""

import numpy as np
import pytest
from circuits import Circuit
from rigs import shown

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.networks.assembly import KINDS as WITH_EQUATIONS
from drake_leg.simulink.networks.elimination import eliminated
from drake_leg.simulink.networks.ports import KINDS

ELEMENTS, SOURCES = "Electrical Elements", "Electrical Sources"


def fed(voltage="5"):
    """A circuit with a source of constant voltage between a and 0."""
    made = Circuit()
    made.ground()
    made.two(SOURCES, "DC Voltage Source", "source", "a", "0", v0=voltage, v0_unit="V")
    return made


def capacitor(made, name, p, n, c, **more):
    more = {"r": "0", "g": "0", **more}
    return made.two(ELEMENTS, "Capacitor", name, p, n, c=c, c_unit="F", r_unit="Ohm", **more)


def inductor(made, name, p, n, l_, **more):
    return made.two(ELEMENTS, "Inductor", name, p, n, l=l_, l_unit="H", r="0", g="0", **more)


def test_a_capacitor_is_charged_through_a_resistor(tmp_path):
    made = fed()
    made.resistor("R", "a", "b", "2")
    capacitor(made, "C", "b", "0", "0.1", vc_specify="on", vc="1", vc_unit="V")
    made.voltage("b", "0", "held")
    run = made.run(tmp_path)
    np.testing.assert_allclose(shown(run, "held"), 5.0 - 4.0 * np.exp(-run.time / 0.2), atol=1e-7)


def test_an_inductor_is_fed_through_a_resistor(tmp_path):
    made = fed()
    made.current("a", "b", "current")
    made.resistor("R", "b", "c", "2")
    inductor(made, "L", "c", "0", "0.4")
    run = made.run(tmp_path)
    np.testing.assert_allclose(shown(run, "current"), 2.5 * -np.expm1(-run.time / 0.2), atol=1e-7)


def test_a_circuit_of_three_swings(tmp_path):
    """L i' + R i + v = 5, C v' = i."""
    made, (R, L, C) = fed(), (1.0, 0.1, 0.01)
    made.resistor("R", "a", "b", str(R))
    inductor(made, "L", "b", "c", str(L))
    capacitor(made, "C", "c", "0", str(C))
    made.voltage("c", "0", "held")
    run = made.run(tmp_path, 0.4)
    damped, w0 = R / 2.0 / L, 1.0 / np.sqrt(L * C)
    w = np.sqrt(w0**2 - damped**2)
    swing = np.cos(w * run.time) + damped / w * np.sin(w * run.time)
    np.testing.assert_allclose(
        shown(run, "held"), 5.0 * (1.0 - np.exp(-damped * run.time) * swing), atol=1e-6
    )


def test_capacitors_in_parallel_are_one_state(tmp_path):
    """Index 2: they charge as one of the sum; the target of one is that of both."""
    made = fed()
    made.resistor("R", "a", "b", "2")
    capacitor(made, "C1", "b", "0", "0.06")
    capacitor(made, "C2", "b", "0", "0.04", vc_specify="on", vc="1")
    made.voltage("b", "0", "held")
    run = made.run(tmp_path)
    np.testing.assert_allclose(shown(run, "held"), 5.0 - 4.0 * np.exp(-run.time / 0.2), atol=1e-7)


def test_a_capacitor_at_a_source_draws_the_derivative_of_its_voltage(tmp_path):
    """Index 2 with an input: its derivative is that of the converter's filter."""
    made = Circuit()
    made.ground()
    sine = made.block("Sin", "sine", Frequency="3")
    source = made.given(SOURCES, "Controlled Voltage Source", "source", "a", "0", sine)
    made.current("a", "b", "current")
    capacitor(made, "C", "b", "0", "0.5")
    with pytest.raises(
        InvalidValueError, match=r"derivative of the signal .*Converter that filters it"
    ):
        made.run(tmp_path)
    converter = made.blocks[str(int(source) + 1)].parameters
    converter |= {"FilteringAndDerivatives": "filter", "InputFilterTimeConstant": "0.01"}
    run = made.run(tmp_path)
    w, lag = 3.0, 0.01
    response = 0.5 * w * np.exp(1j * w * run.time) / (1.0 + 1j * w * lag)
    start = 0.5 * w / (1.0 + (w * lag) ** 2)
    expected = response.real - start * np.exp(-run.time / lag)
    np.testing.assert_allclose(shown(run, "current"), expected, atol=1e-6)


def test_a_diode_lets_one_half_of_a_wave_through(tmp_path):
    made = Circuit()
    made.ground()
    made.two(
        SOURCES, "AC Voltage Source", "source", "a", "0",
        amp="3", frequency="2", frequency_unit="Hz", shift="30", shift_unit="deg",
    )  # fmt: skip
    made.two(ELEMENTS, "Diode", "diode", "a", "b", Vf="0.6", Ron="0.5", Goff="1e-6")
    made.resistor("R", "b", "0", "4.5")
    made.voltage("b", "0", "rectified")
    made.voltage("a", "0", "wave")
    run = made.run(tmp_path)
    wave = 3.0 * np.sin(4.0 * np.pi * run.time + np.pi / 6.0)
    np.testing.assert_allclose(shown(run, "wave"), wave, atol=1e-12)
    off = wave * 4.5 / (4.5 + 1e6)
    on = (wave - 0.6 * (1.0 - 0.5e-6)) / 5.0 * 4.5
    np.testing.assert_allclose(
        shown(run, "rectified"), np.where(wave - off > 0.6, on, off), atol=1e-9
    )


def test_a_transformer_shows_a_load_by_the_square_of_its_ratio(tmp_path):
    made = fed("6")
    made.current("a", "b", "drawn")
    made.part(
        ELEMENTS, "Ideal Transformer", "T",
        {"lconn:1": "b", "lconn:2": "0", "rconn:1": "c", "rconn:2": "0"}, n="3",
    )  # fmt: skip
    made.resistor("R", "c", "0", "2")
    made.voltage("c", "0", "given")
    run = made.run(tmp_path, 0.1)
    np.testing.assert_allclose(shown(run, "given"), 2.0, rtol=1e-12)
    np.testing.assert_allclose(shown(run, "drawn"), 1.0 / 3.0, rtol=1e-12)


def test_a_current_source_charges_a_capacitor(tmp_path):
    made = Circuit()
    made.ground()
    made.two(SOURCES, "DC Current Source", "source", "a", "0", i0="2", i0_unit="mA")
    capacitor(made, "C", "a", "0", "0.01")
    made.voltage("a", "0", "held")
    run = made.run(tmp_path)
    np.testing.assert_allclose(shown(run, "held"), 0.2 * run.time, atol=1e-12)


def test_a_loop_of_sources_is_named(tmp_path):
    made = fed()
    made.two(SOURCES, "DC Voltage Source", "other", "a", "0", v0="4")
    made.voltage("a", "0", "held")
    with pytest.raises(
        InvalidValueError, match=r"'(source|other)', '(source|other)' leave.*no solution"
    ):
        made.run(tmp_path)


def test_a_network_without_a_reference_is_named(tmp_path):
    made = Circuit()
    made.two(SOURCES, "DC Voltage Source", "source", "a", "b", v0="4")
    made.resistor("R", "a", "b", "2")
    made.voltage("a", "b", "held")
    with pytest.raises(InvalidValueError, match=r"has no reference"):
        made.run(tmp_path)


def test_a_block_that_is_not_computed_is_named(tmp_path):
    made = fed()
    made.two("sh_lib/Things/", "Accumulator", "vessel", "a", "0")
    made.voltage("a", "0", "held")
    with pytest.raises(InvalidValueError, match=r"'vessel'"):
        made.run(tmp_path)


def test_targets_that_no_state_heeds_are_refused(tmp_path):
    made = fed()
    made.two(ELEMENTS, "Resistor", "R", "a", "0", R="2", i_specify="on", i="3")
    made.voltage("a", "0", "held")
    with pytest.raises(InvalidValueError, match=r"'R'.* target of 'i'"):
        made.run(tmp_path)


def test_targets_that_contradict_one_another_are_refused(tmp_path):
    made = fed()
    made.resistor("R", "a", "b", "2")
    capacitor(made, "C1", "b", "0", "0.06", vc_specify="on", vc="2", vc_priority="High")
    capacitor(made, "C2", "b", "0", "0.04", vc_specify="on", vc="1", vc_priority="High")
    made.voltage("b", "0", "held")
    with pytest.raises(InvalidValueError, match=r"'C1'.* target 2, but .* it 1: choose targets"):
        made.run(tmp_path)


def test_a_value_that_is_not_finite_is_refused(tmp_path):
    made = fed()
    made.resistor("R", "a", "0", "inf")
    made.voltage("a", "0", "held")
    with pytest.raises(InvalidValueError, match=r"'R'.*R inf: it must be finite"):
        made.run(tmp_path)


def test_all_kinds_of_blocks_have_ports_and_equations():
    assert set(KINDS) == set(WITH_EQUATIONS)


def test_what_cancels_is_told_from_what_is_small():
    """Of four equations one is the sum of two others, and one has a coefficient of 1e-9."""
    M = np.array([[1.0, 1.0, 0.0], [0.3, -1.0, 1e-9], [1.3, 0.0, 1e-9], [0.0, 1.0, 0.0]])
    N = np.array([[1.0, 0.0], [0.1, 1.0], [1.1, 1.0], [0.0, 0.0]])
    found = eliminated(M, N)
    assert not found.free
    (row,) = found.left
    np.testing.assert_array_equal(found.N[row], 0.0)
    pivots = [found.pivots[column] for column in range(3)]
    x = -found.N[pivots]
    np.testing.assert_allclose(M @ x + N, 0.0, atol=1e-12)


def test_a_value_that_is_not_known_is_a_lack(tmp_path):
    made = fed()
    made.resistor("R", "a", "0", "ohms")
    made.voltage("a", "0", "held")
    with pytest.raises(InvalidValueError, match=r"give a value of ohms"):
        made.run(tmp_path)


def test_a_gyrator_shows_a_capacitor_as_an_inductor(tmp_path):
    """5 = R i + (C / G^2) i'."""
    made = fed()
    made.current("a", "b", "current")
    made.resistor("R", "b", "c", "2")
    ends = {"lconn:1": "c", "lconn:2": "0", "rconn:1": "d", "rconn:2": "0"}
    made.part(ELEMENTS, "Gyrator", "turns", ends, G="0.5")
    capacitor(made, "C", "d", "0", "0.1")
    run = made.run(tmp_path)
    np.testing.assert_allclose(shown(run, "current"), 2.5 * -np.expm1(-run.time / 0.2), atol=1e-7)
