"""Mechanical networks and motors against equations that are written by hand."""

import numpy as np
import pytest
from circuits import Circuit
from rigs import shown
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError

TURNING, SLIDING = "Rotational Elements", "Translational Elements"
SOURCES, SENSORS, MECHANISMS = "Mechanical Sources", "Mechanical Sensors", "Mechanisms"


def followed(run, rate, start):
    """Solve an equation over the rows of a run."""
    span = (0.0, run.time[-1])
    found = solve_ivp(rate, span, start, "LSODA", t_eval=run.time, rtol=1e-11, atol=1e-13)
    return found.y


def rested(folder=TURNING):
    """A network of one line or axis with a reference at the connection 0."""
    made = Circuit()
    kind = "Rotational" if folder == TURNING else "Translational"
    made.one(folder, f"Mechanical {kind} Reference", "rest", "0")
    return made


def test_two_masses_on_a_spring_swing_against_each_other(tmp_path):
    made = rested(SLIDING)
    for name, net, heavy in (("left", "a", "2"), ("right", "b", "3")):
        made.one(SLIDING, "Mass", name, net, mass=heavy, v_specify="on", v="1")
    made.two(SLIDING, "Translational Spring", "spring", "a", "b", spr_rate="40",
             x_specify="on", x="0.3")  # fmt: skip
    made.motion("a", "b", "apart", turns=False)
    run = made.run(tmp_path)
    w = np.sqrt(40.0 * (1.0 / 2.0 + 1.0 / 3.0))
    np.testing.assert_allclose(shown(run, "apart"), -0.3 * w * np.sin(w * run.time), atol=1e-6)


def test_inertias_at_a_gear_are_one_state(tmp_path):
    """(J1 N + J2 / N) w' = T at the slower shaft; the force sensor shows what passes."""
    made = rested()
    made.one(TURNING, "Inertia", "fast", "a", inertia="0.02")
    made.two(MECHANISMS, "Gear Box", "gear", "a", "b", ratio="-4")
    torque = made.part(SENSORS, "Ideal Torque Sensor", "passes", {"lconn:1": "b", "rconn:1": "c"})
    made.shows(f"{torque}#rconn:2", "passed")
    made.one(TURNING, "Inertia", "slow", "c", inertia="0.5")
    made.given(SOURCES, "Ideal Torque Source", "pushes", "a", "0", made.constant("0.3"))
    made.motion("c", "0", "speed")
    run = made.run(tmp_path)
    rate = -4.0 * 0.3 / (16.0 * 0.02 + 0.5)
    np.testing.assert_allclose(shown(run, "speed"), rate * run.time, atol=1e-9)
    np.testing.assert_allclose(shown(run, "passed"), 0.5 * rate, rtol=1e-12)


@pytest.mark.parametrize("ratios", [("0.1", "0.7", "0.07"), ("1000", "333.3", "333300")])
def test_gears_side_by_side_turn_though_their_ratios_are_rounded(tmp_path, ratios):
    """0.1 * 0.7 is not 0.07 to the last digit, which is no reason to rest."""
    made = rested()
    for net, inertia in (("a", "0.02"), ("b", "0.3"), ("c", "0.1")):
        made.one(TURNING, "Inertia", f"at {net}", net, inertia=inertia)
    for (fast, slow), ratio in zip(("ab", "bc", "ac"), ratios, strict=True):
        made.two(MECHANISMS, "Gear Box", f"gear {fast}{slow}", fast, slow, ratio=ratio)
    made.given(SOURCES, "Ideal Torque Source", "pushes", "a", "0", made.constant("1"))
    made.motion("c", "0", "speed")
    run = made.run(tmp_path, 0.1)
    second, both = float(ratios[1]), float(ratios[2])
    rate = both / (0.1 + 0.3 * second**2 + 0.02 * both**2)
    assert shown(run, "speed")[-1] == pytest.approx(rate * 0.1, rel=1e-9)


def test_a_wheel_rolls_a_mass(tmp_path):
    made = rested(SLIDING)
    made.one(TURNING, "Inertia", "disk", "a", inertia="0.1")
    made.two(MECHANISMS, "Wheel and Axle", "wheel", "a", "b", R="0.2")
    made.one(SLIDING, "Mass", "cart", "b", mass="5")
    made.given(SOURCES, "Ideal Force Source", "pushes", "b", "0", made.constant("3"))
    made.motion("b", "0", "speed", turns=False)
    run = made.run(tmp_path)
    expected = 3.0 / (5.0 + 0.1 / 0.04) * run.time
    np.testing.assert_allclose(shown(run, "speed"), expected, atol=1e-9)


def test_a_block_sticks_until_its_friction_breaks_away(tmp_path):
    """m v' = 30 t - F(v), with Stribeck's law; what sticks creeps by the smooth law alone."""
    made = rested(SLIDING)
    made.one(SLIDING, "Mass", "block", "a", mass="2")
    made.two(SLIDING, "Translational Friction", "friction", "a", "0", brkwy_frc="12",
             Col_frc="9", visc_coef="3", brkwy_vel="0.05")  # fmt: skip
    ramp = made.block("Ramp", "ramp", slope="30")
    made.given(SOURCES, "Ideal Force Source", "pushes", "a", "0", ramp)
    made.motion("a", "0", "speed", turns=False)
    run = made.run(tmp_path)

    def rate(t, state):
        s = state[0] / (np.sqrt(2.0) * 0.05)
        stribeck = np.sqrt(2.0 * np.e) * 3.0 * s * np.exp(-(s**2))
        return (30.0 * t - stribeck - 9.0 * np.tanh(state[0] / 0.005) - 3.0 * state) / 2.0

    np.testing.assert_allclose(shown(run, "speed"), followed(run, rate, [0.0])[0], atol=1e-6)
    assert shown(run, "speed")[150] < 0.01  # at 0.3 s it sticks
    assert shown(run, "speed")[-1] > 1.0


@pytest.mark.slow
@pytest.mark.parametrize("model", ["1", "2", "3"])
def test_a_block_bounces_between_stops(tmp_path, model):
    made = rested(SLIDING)
    made.one(SLIDING, "Mass", "block", "a", mass="2", v_specify="on", v="1")
    made.two(SLIDING, "Translational Hard Stop", "stops", "a", "0", upper_bnd="100",
             upper_bnd_unit="mm", lower_bnd="-0.05", stiff_up="4e3", stiff_low="5e3", D_up="20",
             D_low="10", model=model, transition="5", transition_unit="mm",
             x_specify="on", x="0.02")  # fmt: skip
    made.motion("a", "0", "speed", turns=False)
    run = made.run(tmp_path)

    def rate(_, state):
        x, v = state
        depth, stiff, damped = 0.0, 0.0, 0.0
        if x > 0.1:
            depth, stiff, damped = x - 0.1, 4e3, 20.0
        elif x < -0.05:
            depth, stiff, damped = x + 0.05, 5e3, 10.0
        if model == "2" and depth * v < 0.0:
            damped = 0.0
        force = stiff * depth + damped * v
        if model == "1":
            s = min(abs(depth) / 0.005, 1.0)
            force *= s * s * (3.0 - 2.0 * s)
        return [v, -force / 2.0]

    span = np.linspace(0.0, 1.0, run.time.size)
    found = solve_ivp(rate, (0.0, 1.0), [0.02, 1.0], t_eval=span, rtol=1e-9, max_step=1e-3)
    np.testing.assert_allclose(shown(run, "speed"), found.y[1], atol=2e-3)
    assert np.ptp(np.sign(shown(run, "speed"))) == 2.0


def motor_of_parts(made):
    """R, L, a converter and a rotor, fed by a constant voltage of 12; its shaft is s."""
    made.ground()
    made.two("Electrical Sources", "DC Voltage Source", "source", "p", "0", v0="12")
    made.current("p", "q", "current")
    made.resistor("R", "q", "r", "1.5")
    made.two("Electrical Elements", "Inductor", "L", "r", "t", l="4", l_unit="mH", g="0")
    made.part("Electrical Elements", "Rotational Electromechanical Converter", "converter",
              {"lconn:1": "t", "lconn:2": "s", "rconn:1": "0", "rconn:2": "rest"},
              K="50", K_unit="mN*m/A")  # fmt: skip
    made.one(TURNING, "Inertia", "rotor", "s", inertia="2", inertia_unit="kg*cm^2")


def motor_as_one(made):
    """The same in one block."""
    made.ground()
    made.two("Electrical Sources", "DC Voltage Source", "source", "p", "0", v0="12")
    made.current("p", "q", "current")
    made.part("ee_lib/Electromechanical/Brushed Motors/", "DC Motor", "motor",
              {"lconn:1": "q", "lconn:2": "s", "rconn:1": "0", "rconn:2": "rest"},
              parameterization="ee.enum.dcparam_option.circuit_param", Ra="1.5", La="4",
              La_unit="mH", emf_or_torque="ee.enum.emf_or_torque.kv", Kv="0.05",
              J="2", J_unit="kg*cm^2", lam="0")  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("motor", [motor_of_parts, motor_as_one])
def test_a_motor_with_a_gear_and_a_load_starts(tmp_path, motor):
    """L i' = 12 - R i - K w, (J + Jl / N^2) w' = K i - (D / N^2) w."""
    made = Circuit()
    motor(made)
    made.one(TURNING, "Mechanical Rotational Reference", "held", "rest")
    made.two(MECHANISMS, "Gear Box", "gear", "s", "load", ratio="10")
    made.one(TURNING, "Inertia", "load", "load", inertia="0.05")
    made.two(TURNING, "Rotational Damper", "drag", "load", "rest", D="0.02")
    made.motion("load", "rest", "speed")
    run = made.run(tmp_path)

    def rate(_, state):
        i, w = state
        return [(12.0 - 1.5 * i - 0.05 * w) / 4e-3, (0.05 * i - 2e-4 * w) / (2e-4 + 5e-4)]

    i, w = followed(run, rate, [0.0, 0.0])
    np.testing.assert_allclose(shown(run, "current"), i, atol=2e-6)
    np.testing.assert_allclose(shown(run, "speed"), w / 10.0, atol=2e-6)


def test_a_motor_is_given_by_stall_torque_and_fastest_speed(tmp_path):
    made = Circuit()
    made.ground()
    made.two("Electrical Sources", "DC Voltage Source", "source", "p", "0", v0="6")
    made.part("ee_lib/Electromechanical/Brushed Motors/", "DC Motor", "motor",
              {"lconn:1": "p", "lconn:2": "s", "rconn:1": "0", "rconn:2": "rest"},
              parameterization="2", V_rated="6", w_max="300", T_stall="0.4", La="1e-5",
              J="1e-4")  # fmt: skip
    made.one(TURNING, "Mechanical Rotational Reference", "held", "rest")
    made.motion("s", "rest", "speed")
    run = made.run(tmp_path)
    assert shown(run, "speed")[-1] == pytest.approx(300.0, abs=1e-3)
    made.blocks[made.sid("motor")].parameters["parameterization"] = "3"
    with pytest.raises(InvalidValueError, match=r"'motor'.*parameterization '3'"):
        made.run(tmp_path)


def test_a_motor_without_load_draws_the_current_that_is_given(tmp_path):
    made = Circuit()
    made.ground()
    made.two("Electrical Sources", "DC Voltage Source", "source", "p", "0", v0="12")
    made.current("p", "q", "current")
    made.part("ee_lib/Electromechanical/Brushed Motors/", "DC Motor", "motor",
              {"lconn:1": "q", "lconn:2": "s", "rconn:1": "0", "rconn:2": "rest"},
              Ra="1.5", La="1e-3", Kv="0.05", J="1e-4",
              lam_param="ee.enum.lam_param.current", i_noload="0.3", V_i_noload="12")  # fmt: skip
    made.one(TURNING, "Mechanical Rotational Reference", "held", "rest")
    run = made.run(tmp_path, 2.0)
    assert shown(run, "current")[-1] == pytest.approx(0.3, rel=1e-6)


def test_a_network_keeps_its_energy(tmp_path):
    """A spring, an inductor and a mass at one converter: nothing is lost."""
    made = Circuit()
    made.ground()
    made.one(SLIDING, "Mass", "mass", "a", mass="0.4", v_specify="on", v="1")
    made.two(SLIDING, "Translational Spring", "spring", "a", "0m", spr_rate="30")
    made.one(SLIDING, "Mechanical Translational Reference", "wall", "0m")
    made.part("Electrical Elements", "Translational Electromechanical Converter", "converter",
              {"lconn:1": "p", "lconn:2": "a", "rconn:1": "0", "rconn:2": "0m"}, K="2")  # fmt: skip
    made.current("p", "q", "current")
    made.two("Electrical Elements", "Inductor", "coil", "q", "0", l="0.5", g="0")
    made.motion("a", "0m", "speed", "place", turns=False)
    run = made.run(tmp_path)
    v, x, i = (shown(run, name) for name in ("speed", "place", "current"))
    energy = 0.2 * v**2 + 15.0 * x**2 + 0.25 * i**2
    np.testing.assert_allclose(energy, 0.2, atol=1e-7)


def test_an_acceleration_is_sensed(tmp_path):
    made = rested(SLIDING)
    made.one(SLIDING, "Mass", "mass", "a", mass="2")
    made.given(SOURCES, "Ideal Force Source", "pushes", "a", "0", made.constant("3"))
    ends = {"lconn:1": "a"}
    sensor = made.part(SENSORS, "Ideal Translational Motion Sensor", "senses", ends,
                       reference="foundation.enum.MeasurementReference.absolute",
                       acceleration_port="true", velocity_port="true",
                       position_port="false")  # fmt: skip
    made.shows(f"{sensor}#rconn:1", "acceleration")
    made.shows(f"{sensor}#rconn:2", "speed")
    run = made.run(tmp_path)
    np.testing.assert_allclose(shown(run, "acceleration"), 1.5, rtol=1e-12)
    np.testing.assert_allclose(shown(run, "speed"), 1.5 * run.time, atol=1e-9)


def test_a_sensor_with_an_open_end_is_named(tmp_path):
    """What it measures against is not determined; it is not rest."""
    made = rested()
    made.one(TURNING, "Inertia", "mass", "a", inertia="2")
    sensor = made.part(SENSORS, "Ideal Rotational Motion Sensor", "senses", {"lconn:1": "a"})
    made.shows(f"{sensor}#rconn:2", "speed")
    with pytest.raises(InvalidValueError, match=r"'senses' .* has no reference: connect one"):
        made.run(tmp_path)


@pytest.mark.parametrize("is_damped", [True, False])
def test_friction_needs_a_mass_or_a_damper_beside_it(tmp_path, is_damped):
    """Else its law is to be solved for the velocity; with a damper, its loop is solved."""
    made = rested()
    made.two(TURNING, "Rotational Friction", "rubs", "a", "0", brkwy_trq="1", Col_trq="1",
             visc_coef="0.5")  # fmt: skip
    made.given(SOURCES, "Ideal Torque Source", "pushes", "a", "0", made.constant("4"))
    made.motion("a", "0", "speed")
    if is_damped:
        made.two(TURNING, "Rotational Damper", "damps", "a", "0", D="0.5")
        np.testing.assert_allclose(shown(made.run(tmp_path), "speed"), 3.0, rtol=1e-9)
        return
    with pytest.raises(InvalidValueError, match=r"'rubs', 'pushes'.* put a mass or a damper"):
        made.run(tmp_path)


@pytest.mark.parametrize(
    ("folder", "kind", "texts", "said"),
    [
        (TURNING, "Inertia", {"inertia": "0"}, "inertia 0: it must be positive"),
        (MECHANISMS, "Gear Box", {"ratio": "0"}, "ratio 0"),
        (TURNING, "Rotational Friction", {"brkwy_trq": "1", "Col_trq": "2"}, "must not be less"),
        (TURNING, "Rotational Hard Stop", {"upper_bnd": "-1"}, "lower one must be less"),
        (TURNING, "Rotational Hard Stop", {"model": "4"}, "model '4'"),
    ],
)  # fmt: skip
def test_parameters_without_sense_are_refused(tmp_path, folder, kind, texts, said):
    made = rested()
    made.two(folder, kind, "it", "a", "0", **texts)
    made.motion("a", "0", "speed")
    with pytest.raises(InvalidValueError, match=rf"'it' .*{said}"):
        made.run(tmp_path)


def driven(made, torque, **texts):
    """A drive with a rotor, asked for a torque, between the connections p and 0."""
    sid = made.part("ee_lib/Electromechanical/", "Motor & Drive (System Level)", "drive",
                    {"lconn:1": "p", "lconn:3": "s", "rconn:1": "0", "rconn:3": "rest"},
                    torque_speed_param="ee.enum.electromech.envelope.torque_power",
                    **{"torque_max": "0.5", "power_max": "20", "Tc": "0.05", "eff": "80",
                       "w_eff": "100", "T_eff": "0.2", "Piron": "1", "Pbase": "0.5", "Res": "0.1",
                       "J": "2e-3", "lam": "1e-3", **texts})  # fmt: skip
    asks = made.add_library(
        "fl_lib/Physical Signals/Sources/PS Constant", "asks", {"constant": torque}
    )
    made.physical(f"{asks}#rconn:1", f"{sid}#lconn:2")
    made.one(TURNING, "Mechanical Rotational Reference", "held", "rest")
    made.shows(f"{sid}#rconn:2", "speed")


@pytest.mark.slow
def test_a_drive_follows_a_torque_and_draws_its_power(tmp_path):
    """Tc T' = limited(2) - T, J w' = T - lam w; (24 - R i) i = T w + losses."""
    made = Circuit()
    made.ground()
    made.two("ee_lib/Sources/", "Battery", "battery", "a", "0", Vnom="24", R1="0.4", prm_AH="1")
    made.current("a", "p", "current")
    driven(made, "2")
    run = made.run(tmp_path, 0.3)

    def rate(_, state):
        torque, w = state
        return [(min(0.5, 20.0 / max(abs(w), 1e-9)) - torque) / 0.05, (torque - 1e-3 * w) / 2e-3]

    torque, w = followed(run, rate, [0.0, 0.0])
    np.testing.assert_allclose(shown(run, "speed"), w, atol=1e-4)
    copper = (100.0 * 0.2 * 0.25 - 1.5) / 0.2**2
    power = torque * w + copper * torque**2 + 1.0 * (w / 100.0) ** 2 + 0.5
    i = shown(run, "current")
    np.testing.assert_allclose((24.0 - 0.5 * i) * i, power, atol=1e-3)


def test_a_battery_has_its_measured_voltage_at_a_part_of_its_charge(tmp_path):
    made = Circuit()
    made.ground()
    made.two("ee_lib/Sources/", "Battery", "battery", "a", "0", Vnom="12", R1="0.5", prm_AH="2",
             AH="2", AH_unit="A*hr", V1="11", AH1="1.2", AH1_unit="hr*A", charge_specify="on",
             charge="1.2", charge_unit="A*hr")  # fmt: skip
    made.resistor("R", "a", "0", "10.5")
    made.voltage("a", "0", "held")
    run = made.run(tmp_path, 60.0)
    assert shown(run, "held")[0] == pytest.approx(11.0 * 10.5 / 11.0, rel=1e-12)
    assert 10.3 < shown(run, "held")[-1] < 10.5
    made.blocks[made.sid("battery")].parameters["V1"] = "6"
    with pytest.raises(InvalidValueError, match=r"'battery'.*no curve from 12 V"):
        made.run(tmp_path, 1.0)
