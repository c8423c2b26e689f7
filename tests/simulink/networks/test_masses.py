"""Masses, springs and dampers on a line, against their equations."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy.integrate import solve_ivp

ELEMENTS = "fl_lib/Mechanical/Translational Elements/"
TURNING = "fl_lib/Mechanical/Rotational Elements/"


def shaken(kinds, source, sensor, **texts):
    """A mass between a spring and a damper that a force of 2 pushes, and a sensor of its place."""
    rig = Rig()
    heavy, spring, damper, ground = (
        rig.add_library(kind, kind.rpartition("/")[2], texts.get(kind.rpartition("/")[2], {}))
        for kind in kinds
    )
    pushes = rig.add_library(f"fl_lib/Mechanical/Mechanical Sources/{source}", "pushes")
    senses = rig.add_library(f"fl_lib/Mechanical/Mechanical Sensors/{sensor}", "senses")
    enters = rig.add_library("nesl_utility/Simulink-PS Converter", "enters", ports={"in": 1})
    rig.connect(rig.constant("2"), enters)
    rig.physical(f"{pushes}#rconn:1", f"{enters}#rconn:1")
    rig.physical(
        f"{heavy}#lconn:1", f"{spring}#lconn:1", f"{damper}#rconn:1", f"{pushes}#lconn:1",
        f"{senses}#lconn:1",
    )  # fmt: skip
    rig.physical(
        f"{ground}#lconn:1", f"{spring}#rconn:1", f"{damper}#lconn:1", f"{pushes}#rconn:2",
        f"{senses}#rconn:1",
    )  # fmt: skip
    for place, name in ((2, "speed"), (3, "place")):
        leaves = rig.block("nesl_utility/PS-Simulink Converter", f"leaves {name}")
        rig.physical(f"{senses}#rconn:{place}", f"{leaves}#lconn:1")
        rig.show(f"{leaves}#out:1", name)
    return rig


LINE = (
    f"{ELEMENTS}Mass",
    f"{ELEMENTS}Translational Spring",
    f"{ELEMENTS}Translational Damper",
    f"{ELEMENTS}Mechanical Translational Reference",
)
AXIS = (
    f"{TURNING}Inertia",
    f"{TURNING}Rotational Spring",
    f"{TURNING}Rotational Damper",
    f"{TURNING}Mechanical Rotational Reference",
)


@pytest.mark.parametrize(
    ("kinds", "source", "sensor", "texts"),
    [
        (
            LINE, "Ideal Force Source", "Ideal Translational Motion Sensor",
            {"Mass": {"mass": "500", "mass_unit": "g", "v_specify": "on", "v": "1"},
             "Translational Spring": {"spr_rate": "50", "x_specify": "on", "x": "0.1"},
             "Translational Damper": {"D": "3", "D_unit": "N/(m/s)"}},
        ),
        (
            AXIS, "Ideal Torque Source", "Ideal Rotational Motion Sensor",
            {"Inertia": {"inertia": "0.5", "inertia_unit": "kg*m^2", "w_specify": "on", "w": "1"},
             "Rotational Spring": {"spr_rate": "50", "init_def": "0.1"},
             "Rotational Damper": {"D": "3"}},
        ),
    ],
)  # fmt: skip
def test_a_mass_on_a_spring_follows_its_equation(tmp_path, kinds, source, sensor, texts):
    """0.5 a = 2 - 50 (x + 0.1) - 3 v from v = 1, with x from 0."""
    rig = shaken(kinds, source, sensor, **texts)
    run = rig.run(tmp_path, 0.5)

    def rate(t, state):
        x, v = state
        return [v, (2.0 - 50.0 * (x + 0.1) - 3.0 * v) / 0.5]

    found = solve_ivp(rate, (0.0, 0.5), [0.0, 1.0], t_eval=run.time, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(shown(run, "place"), found.y[0], atol=1e-7)
    np.testing.assert_allclose(shown(run, "speed"), found.y[1], atol=1e-6)


def test_a_connection_without_a_mass_follows_what_pulls_it(tmp_path):
    """1000 x + 100 x' = 2."""
    rig = shaken(LINE, "Ideal Force Source", "Ideal Translational Motion Sensor")
    rig.remove("Mass")
    run = rig.run(tmp_path, 0.5)
    np.testing.assert_allclose(shown(run, "place"), -0.002 * np.expm1(-10.0 * run.time), atol=1e-10)


def test_a_sensor_of_absolute_position_alone_has_one_connection(tmp_path):
    """As newer files have it; x'' = 3 / 1 kg."""
    rig = Rig()
    heavy = rig.add_library(f"{ELEMENTS}Mass", "Mass")
    ground = rig.add_library(LINE[-1], "ground")
    pushes = rig.add_library("fl_lib/Mechanical/Mechanical Sources/Ideal Force Source", "pushes")
    texts = {
        "reference": "foundation.enum.MeasurementReference.absolute", "position_port": "true",
        "velocity_port": "false", "acceleration_port": "false",
    }  # fmt: skip
    kind = "fl_lib/Mechanical/Mechanical Sensors/Ideal Translational Motion Sensor"
    senses = rig.add_library(kind, "senses", texts)
    constant = rig.add_library(
        "fl_lib/Physical Signals/Sources/PS Constant", "three", {"constant": "3"}
    )
    leaves = rig.block("nesl_utility/PS-Simulink Converter", "leaves")
    rig.physical(f"{constant}#rconn:1", f"{pushes}#rconn:1")
    rig.physical(f"{heavy}#lconn:1", f"{pushes}#lconn:1", f"{senses}#lconn:1")
    rig.physical(f"{ground}#lconn:1", f"{pushes}#rconn:2")
    rig.physical(f"{senses}#rconn:1", f"{leaves}#lconn:1")
    rig.show(f"{leaves}#out:1", "place")
    run = rig.run(tmp_path, 0.5)
    np.testing.assert_allclose(shown(run, "place"), 1.5 * run.time**2, atol=1e-9)
