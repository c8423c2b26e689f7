"""Buses and their names, ports of a model where nothing is given, arguments of MATLAB Functions."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, pendulum
from rigs import Rig, shown
from slx_writer import write_parts

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.running import run_model, runnable
from drake_leg.simulink.running.summary import remarks_of


def subsystem(rig, name, system="", **ports):
    return rig.add_block("SubSystem", name, ports=ports, system=system)


def element(rig, kind, system, name, place=1):
    """A port of one element of the bus at port 1 of a subsystem."""
    texts = {"PortNumber": "1", "PortName": "q", "Element": name, "PortBlockIndex": str(place)}
    return rig.add_block(kind, f"{kind} {name}", texts, system=system)


def with_lists(parts):
    """Put what tells of an element in a list, as the files do."""
    changed = {}
    for path, text in parts.items():
        start, end = '<P Name="PortNumber">', '<P Name="PortBlockIndex">'
        while start in text:
            before, _, rest = text.partition(start)
            inner, _, after = rest.partition(end)
            number, _, after = after.partition("</P>")
            text = f'{before}<List ListType="InterfaceData"><P Name="PortNumber" >{inner}'
            text += f'<P Name="PortBlockIndex" >{number}</P></List>{after}'
        changed[path] = text
    return changed


def test_ports_of_elements_take_a_bus_apart_and_join_it(tmp_path):
    rig = Rig()
    outer = subsystem(rig, "outer", **{"in": 1, "out": 1})
    inner = subsystem(rig, "inner", outer, **{"in": 1, "out": 1})
    leg = element(rig, "Inport", outer, "leg")
    angles = {name: element(rig, "Inport", inner, name) for name in ("hip", "knee")}
    for place, (name, port) in enumerate(angles.items(), 1):
        twice = rig.block("Gain", f"twice {name}", port, Gain="2", system=inner)
        rig.connect(twice, element(rig, "Outport", inner, f"twice.{name}", place))
    rig.connect(leg, f"{inner}#in:1")
    out = rig.add_block("Outport", "y", {"Port": "1"}, system=outer)
    rig.connect(f"{inner}#out:1", out)
    names = rig.block("BusCreator", "angles", "", "", Inputs="2")
    for place, (name, value) in enumerate((("hip", "0.1"), ("knee", "0.2")), 1):
        rig.connect(rig.constant(value), f"{names}#in:{place}", name=name)
    legs = rig.block("BusCreator", "legs", "", rig.constant("7"), Inputs="2")
    rig.connect(names, f"{legs}#in:1", name="leg")
    rig.connect(legs, f"{outer}#in:1")
    rig.show(f"{outer}#out:1", "y")
    path = write_parts(tmp_path / "elements.slx", with_lists(rig.parts()))
    assert 'ListType="InterfaceData"' in "".join(with_lists(rig.parts()).values())
    run = run_model(runnable(read_model(path), duration=0.1))
    assert shown(run, "y.twice.hip")[0] == pytest.approx(0.2)
    assert shown(run, "y.twice.knee")[0] == pytest.approx(0.4)


def test_a_bus_has_the_names_of_the_outputs_that_drive_it(tmp_path):
    rig = Rig()
    code = "function [P0x,...\n  P0y] = points(u)\nP0x = u;\nP0y = 2*u;\n"
    points = rig.add_function("points", code, **{"in": 1, "out": 2})
    rig.connect(rig.constant("3"), points)
    made = rig.block("BusCreator", "bus", f"{points}#out:1", f"{points}#out:2", Inputs="2")
    chosen = rig.block("BusSelector", "one", made, OutputSignals="P0y")
    rig.show(chosen, "y")
    again = rig.block("BusCreator", "again", chosen, Inputs="1")
    rig.show(rig.block("BusSelector", "same", again, OutputSignals="P0y"), "same")
    assert rig.values(tmp_path) == {"y": 6.0, "same": 6.0}


def test_buses_are_joined_to_an_array(tmp_path):
    rig = Rig()
    made = []
    for value in ("1", "2"):
        bus = rig.block("BusCreator", f"bus {value}", "", Inputs="1")
        rig.connect(rig.constant(value), f"{bus}#in:1", name="q")
        made.append(bus)
    rig.show(rig.block("Concatenate", "array", *made, NumInputs="2"), "all")
    assert rig.values(tmp_path) == {"all.(1).q": 1.0, "all.(2).q": 2.0}


def test_the_models_own_ports_are_zero_and_as_wide_as_needed(tmp_path):
    rig = Rig()
    tau = rig.add_block("Inport", "tau", {"Port": "1"}, ports={"out": 1})
    apart = rig.add_block("Demux", "apart", {"Outputs": "2"}, ports={"in": 1, "out": 2})
    rig.connect(tau, apart)
    rig.show(rig.block("Bias", "one", f"{apart}#out:2", Bias="1"), "one")
    wide = rig.add_block("Inport", "wide", {"Port": "2", "PortDimensions": "3"}, ports={"out": 1})
    rig.show(wide, "wide")
    bus = rig.add_block("Inport", "bus", {"Port": "3"}, ports={"out": 1})
    leg = rig.block("BusSelector", "leg", bus, OutputSignals="leg")
    rig.show(rig.block("BusSelector", "knee", leg, OutputSignals="knee"), "knee")
    values = rig.values(tmp_path)
    assert values["one"] == 1.0
    assert values["wide"].tolist() == [0.0, 0.0, 0.0]
    assert values["knee"] == 0.0


def test_a_physical_port_of_the_model_carries_nothing(tmp_path):
    """A subsystem's file: the torque at the joint comes from outside, where nothing is."""
    built = pendulum(TorqueActuationMode="InputTorque", SensePosition="on")
    torque = built.add_block("PMIOPort", "tau", {"Side": "Left", "Port": "1"})
    angle = built.add_block("PMIOPort", "q", {"Side": "Right", "Port": "1"})
    built.physical(f"{torque}#rconn:1", f"{built.sid('Pivot')}#lconn:2")
    built.physical(f"{angle}#rconn:1", f"{built.sid('Pivot')}#rconn:2")
    model = built.model(tmp_path)
    ready = runnable(model, duration=0.1)
    run = run_model(ready)
    assert run.complete
    assert "which are 0: tau" in " ".join(remarks_of(model, ready, run))


def moved_by(signal):
    """A pendulum whose joint follows a signal that the block of this kind makes of -1."""
    built = pendulum(MotionActuationMode="InputMotion", TorqueActuationMode="ComputedTorque")
    minus = built.add_block("Constant", "minus", {"Value": "-1"}, ports={"out": 1})
    root = built.add_block(signal, "root", ports={"in": 1, "out": 1})
    enters = built.add_library(
        "nesl_utility/Simulink-PS Converter", "enters", {"Unit": "rad"}, ports={"in": 1}
    )
    built.connect(minus, root)
    built.connect(root, enters)
    built.physical(f"{enters}#rconn:1", f"{built.sid('Pivot')}#lconn:2")
    return built


def test_a_motion_that_is_no_number_is_refused(tmp_path):
    with pytest.raises(InvalidValueError, match=r"'Pivot' \(\d+#lconn:2\) is not finite"):
        runnable(moved_by("Sqrt").model(tmp_path), duration=0.1)
    assert runnable(moved_by("Abs").model(tmp_path), duration=0.1)


def test_what_becomes_complex_in_a_matlab_function_is_no_number(tmp_path):
    rig = Rig()
    code = "function [y, z] = f(u)\ny = acos(u);\nz = [u; sqrt(-u)];\n"
    block = rig.add_function("f", code, **{"in": 1, "out": 2})
    rig.connect(rig.constant("2"), block)
    rig.show(rig.block("Gain", "half", f"{block}#out:1", Gain="0.5"), "y")
    rig.show(f"{block}#out:2", "z")
    values = rig.values(tmp_path)
    assert math.isnan(values["y"])
    np.testing.assert_array_equal(values["z"], [2.0, math.nan])


def test_a_bus_of_which_no_field_is_read_is_a_vector_to_a_matlab_function(tmp_path):
    rig = Rig()
    bus = rig.block("BusCreator", "bus", rig.constant("3"), rig.constant("4"), Inputs="2")
    length = rig.add_function("length", "function y = f(u)\ny = norm(u) + u(2);\n")
    rig.connect(bus, length)
    rig.show(length, "y")
    first = rig.add_function("first", "function y = f(u)\ny = u.signal1;\n")
    rig.connect(bus, first)
    rig.show(first, "first")
    assert rig.values(tmp_path) == {"y": 9.0, "first": 3.0}


def test_arguments_of_a_matlab_function_may_be_parameters(tmp_path):
    """Only those that the chart names: u has a value in the workspace, too."""
    code = "function y = ...\n  f(u, ... % the input\n  body)\ny = u * body.length;\n"
    rig = Rig()
    block = rig.add_function("f", code)
    rig.connect(rig.constant("3"), block)
    rig.show(block, "y")
    parts = rig.parts()
    (chart,) = [path for path in parts if "stateflow/chart" in path]
    data = '<data name="body"><P Name="scope">PARAMETER_DATA</P></data></chart>'
    parts[chart] = parts[chart].replace("</chart>", data)
    path = write_parts(tmp_path / "parameters.slx", parts)
    (tmp_path / "values.m").write_text("u = 100; body.length = 2;")
    model = read_model(path, init=[tmp_path / "values.m"])
    run = run_model(runnable(model, duration=0.1))
    assert shown(run, "y")[0] == 6.0


def test_what_a_from_of_a_library_takes_from_its_user_is_zero(tmp_path):
    rig = Rig()
    rig.show(rig.block("Bias", "one", rig.block("From", "from", GotoTag="A"), Bias="1"), "y")
    parts = rig.parts()
    with pytest.raises(InvalidValueError, match="there is no Goto"):
        runnable(read_model(write_parts(tmp_path / "model.slx", parts)), duration=0.1)
    whole = "simulink/blockdiagram.xml"
    parts[whole] = parts[whole].replace("Model>", "Library>")
    model = read_model(write_parts(tmp_path / "library.slx", parts))
    assert shown(run_model(runnable(model, duration=0.1)), "y")[0] == 1.0


def test_a_vector_is_taken_apart_as_the_mechanism_takes_its_parts(tmp_path):
    """Of four numbers in two outputs, one pushes along x, and three are a vector."""
    built = MechanismBuilder()
    built.body("Brick Solid", "Brick", BrickDimensions="[0.1 0.1 0.1]")  # of 1 kg
    built.joint("6-DOF", "Free")
    texts = {"EnableForceX": "on", "EnableForce": "on"}
    built.add_library("sm_lib/Forces and Torques/External Force and Torque", "Push", texts)
    built.meet("World", "Free lconn:1")
    built.meet("Free", "Brick", "Push")
    four = built.add_block("Constant", "Four", {"Value": "[2 1 0 3]"})
    apart = built.add_block("Demux", "Apart", {"Outputs": "2"}, ports={"in": 1, "out": 2})
    built.connect(four, apart)
    for number in (1, 2):
        name = f"Convert{number}"
        sid = built.add_library("nesl_utility/Simulink-PS Converter", name, {"Unit": "N"})
        built.connect(f"{apart}#out:{number}", f"{sid}#in:1")
        built.meet(name, f"Push lconn:{number}")
    run = run_model(runnable(built.model(tmp_path), duration=1.0))
    np.testing.assert_allclose(run.states[-1, 4:7], [1.5, 0.0, 1.5], atol=1e-6)


def test_a_signal_of_a_bus_does_not_depend_on_the_others(tmp_path):
    """A torque that follows an angle, which is in one bus with an acceleration."""
    built = pendulum(
        TorqueActuationMode="InputTorque", SensePosition="on", SenseAcceleration="on",
        PositionTargetSpecify="on", PositionTargetValue="20",
    )  # fmt: skip
    bus = built.add_block("BusCreator", "all", {"Inputs": "'q','a'"}, ports={"in": 2, "out": 1})
    for place in (2, 3):
        leaves = built.add_library("nesl_utility/PS-Simulink Converter", f"leaves{place}")
        built.meet(f"Pivot rconn:{place}", f"leaves{place} lconn:1")
        built.connect(f"{leaves}#out:1", f"{bus}#in:{place - 1}")
    angle = built.add_block("BusSelector", "angle", {"OutputSignals": "q"})
    built.connect(bus, angle)
    gain = built.add_block("Gain", "pulls", {"Gain": "-3"})
    built.connect(angle, gain)
    enters = built.add_library("nesl_utility/Simulink-PS Converter", "enters", ports={"in": 1})
    built.connect(gain, enters)
    built.meet("enters rconn:1", "Pivot lconn:2")
    run = run_model(runnable(read_model(built.write(tmp_path / "m.slx")), duration=0.1))
    assert run.complete
    assert abs(run.states[-1, 0]) < abs(run.states[0, 0])


def test_a_filtered_converter_that_leads_nowhere_runs(tmp_path):
    rig = Rig()
    clock = rig.block("Clock", "clock")
    rig.show(clock, "y")
    ends = rig.add_library("nesl_utility/Simulink-PS Converter", "ends",
                           {"FilteringAndDerivatives": "filter", "SimscapeFilterOrder": "2"},
                           ports={"in": 1, "rconn": 1})  # fmt: skip
    rig.connect(clock, ends)
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "y"), run.time, atol=1e-12)
