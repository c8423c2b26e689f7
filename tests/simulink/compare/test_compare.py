"""The same robot drawn in other ways agrees; each true difference is named, and it alone."""

import math

import pytest
from slx_models import JACOB_INV, RIGID_TRANSFORM, published_leg, published_pendulum
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError

IN_METRES = JACOB_INV.replace("l1 = {0}; l2 = {1}; l3 = {2};", "l1 = .05; l2 = .1; l3 = .1;")
BACKSLASH = JACOB_INV.replace("dq = inv(J)*[dx;dy;dz];", "dq = J\\[dx;dy;dz];")
PINV = JACOB_INV.replace("inv(J)*", "pinv(J)*")
OTHER_ORDER = JACOB_INV.replace(
    "dx = u(4); dy = u(5); dz = u(6);", "dz = u(4); dx = u(5); dy = u(6);"
)


def names(items, key="name"):
    return [item[key] for item in items]


def differences(found):
    return sorted((item["name"], item["parameter"]) for item in found.different)


def rewire(model, old, new):
    """Let a line's end go to another port."""
    for line in model.lines:
        line.ports = [new if port == old else port for port in line.ports]
    return model


def cut(model, *ports):
    """Take every line out that has one of these ends."""
    model.lines = [line for line in model.lines if not set(ports) & set(line.ports)]
    return model


def test_published_leg_is_leg_b(compared):
    found = compared(published_leg())
    assert found.agrees
    assert not found.missing
    assert not found.different
    blocks = [item for item in found.matched if item["what"] == "block"]
    assert len(blocks) == len(published_leg().blocks)
    assert len({item["sid"] for item in blocks}) == len(blocks)


def test_every_wire_is_accounted_for_once(compared):
    builder = published_leg()
    found = compared(builder)
    drawn = sum(len(line.ports) - 1 for line in builder.lines if not line.physical)
    assert len([item for item in found.matched if item["what"] == "wire"]) == drawn


def test_extra_is_the_acceleration_path_and_further_scopes(compared):
    extra = names([item for item in compared(published_leg()).extra if item["what"] == "block"])
    assert "Mux of the derivatives" in extra
    assert not {"Sine Wave", "dy", "dz", "inverseJacobian", "Integrator 1", "leg_b"} & set(extra)


@pytest.mark.slow
def test_cross_sections_colours_and_filters_count_when_strict(compared):
    lax, strict = compared(published_leg()), compared(published_leg(), strict=True)
    kinds = {item["parameter"] for item in lax.tolerated}
    assert kinds == {"cross section", "SphereRadius", "GraphicDiffuseColor", "input filter"}
    assert not strict.agrees
    assert len(strict.different) == len(lax.tolerated)
    assert not strict.tolerated


def test_pendulum_agrees(compared):
    assert compared(published_pendulum(), "pendulum").agrees


def test_pendulum_with_damping_in_simscape_units(compared):
    settings = {"DampingCoefficient": "0.01", "DampingCoefficientUnits": "N*m/(deg/s)"}
    target = {"PositionTargetSpecify": "on", "PositionTargetValue": "30"}
    model = published_pendulum(settings | target, stop_time="30")
    found = compared(model, "pendulum-damped")
    assert differences(found) == [("Revolute Joint", "DampingCoefficient")]
    assert found.different[0]["simulink"] == pytest.approx(0.01 * 180 / math.pi)
    assert compared(model, "pendulum-damped", damping_unit="N*m/(deg/s)").agrees


def test_pendulum_with_spring(compared):
    spring = {
        "SpringStiffness": "5",
        "SpringStiffnessUnits": "N*m/rad",
        "EquilibriumPosition": "30",
        "DampingCoefficient": "0.01",
        "DampingCoefficientUnits": "N*m*s/rad",
    }
    model = published_pendulum(spring, stop_time="30")
    assert compared(model, "pendulum-spring").agrees
    model.set("Revolute Joint", EquilibriumPosition="45")
    assert differences(compared(model, "pendulum-spring")) == [
        ("Revolute Joint", "EquilibriumPosition")
    ]


@pytest.mark.parametrize("script", [BACKSLASH, PINV], ids=["backslash", "pinv"])
def test_other_ways_to_invert(compared, script):
    assert compared(published_leg(script=script)).agrees


def test_function_in_metres(compared):
    model = published_leg(script=IN_METRES, amplitude="0.07")
    assert compared(model).agrees


def test_inputs_in_another_order(compared):
    model = published_leg(script=OTHER_ORDER)
    mux, sine = model.sid("Mux"), model.sid("Sine Wave")
    constants = [model.sid("Constant y"), model.sid("Constant z")]
    cut(model, *(f"{mux}#in:{place}" for place in (4, 5, 6)))
    model.connect(sine, f"{mux}#in:5")
    model.connect(constants[0], f"{mux}#in:6")
    model.connect(constants[1], f"{mux}#in:4")
    assert compared(model).agrees


@pytest.mark.slow
def test_gain_behind_the_sine_is_one_amplitude(compared):
    model = published_leg(amplitude="7")
    gain = model.add_block("Gain", "Gain", {"Gain": "10"}, ports={"in": 1, "out": 1})
    mux = model.sid("Mux")
    cut(model, f"{mux}#in:4")
    model.connect(model.sid("Sine Wave"), gain)
    model.connect(gain, f"{mux}#in:4")
    assert compared(model).agrees
    assert compared(model, gain=10.0).agrees
    model.set("Gain", Gain="5")
    (one,) = compared(model).different
    assert (one["name"], one["parameter"]) == ("Sine Wave", "Amplitude")
    assert one["simulink"] == pytest.approx(0.035)


def test_two_muxes(compared):
    model = published_leg()
    mux = model.sid("Mux")
    parts = []
    for name, places in (("Mux q", (1, 2, 3)), ("Mux v", (4, 5, 6))):
        part = model.add_block("Mux", name, {"Inputs": "3"}, ports={"in": 3, "out": 1})
        for place, old in enumerate(places, 1):
            rewire(model, f"{mux}#in:{old}", f"{part}#in:{place}")
        parts.append(part)
    for place, part in enumerate(parts, 1):
        model.connect(part, f"{mux}#in:{place}")
    model.set("Mux", Inputs="2")
    assert compared(model).agrees


def test_function_of_two_vectors_with_two_outputs(compared):
    script = JACOB_INV.replace("function y = jacob_inv(u)", "function [dq, d] = jacob_inv(q, v)")
    script = script.replace("q1 = u(1); q2 = u(2); q3 = u(3);", "q1 = q(1); q2 = q(2); q3 = q(3);")
    script = script.replace("dx = u(4); dy = u(5); dz = u(6);", "dx = v(1); dy = v(2); dz = v(3);")
    script = script.replace("y = [dq' det(J)];", "d = det(J);")
    model = published_leg(script=script)
    mux, function, demux = (model.sid(n) for n in ("Mux", "MATLAB Function", "Demux"))
    part = model.add_block("Mux", "Mux v", {"Inputs": "3"}, ports={"in": 3, "out": 1})
    for place in (1, 2, 3):
        rewire(model, f"{mux}#in:{place + 3}", f"{part}#in:{place}")
    model.set("Mux", Inputs="3").set("Demux", Outputs="3")
    model.connect(part, f"{function}#in:2")
    rewire(model, f"{demux}#out:4", f"{function}#out:2")
    assert compared(model).agrees


def test_initial_conditions_in_the_integrators(compared):
    model = published_leg()
    for place, angle in enumerate(("90/180*pi", "-50/180*pi", "-90/180*pi"), 1):
        converter = model.sid(f"Simulink-PS\nConverter{place}")
        model.remove(f"Sum{place}").remove(f"q{place} initial")
        model.connect(model.sid(f"Integrator{place}"), converter)
        model.set(f"Integrator{place}", InitialCondition=angle)
    assert compared(model).agrees
    model.set("Integrator2", InitialCondition="-pi/3")
    (one,) = compared(model).different
    assert (one["name"], one["parameter"]) == ("Integrator2", "initial position of joint 2")


def test_one_integrator_of_three(compared):
    model = published_leg()
    demux = model.sid("Demux")
    total = model.add_block(
        "Integrator",
        "Integrator",
        {"InitialCondition": "[90 -50 -90]*pi/180"},
        ports={"in": 1, "out": 1},
    )
    split = model.add_block("Demux", "Demux q", {"Outputs": "3"}, ports={"in": 1, "out": 3})
    model.set("Demux", Outputs="[3 1]")
    rewire(model, f"{demux}#out:4", f"{demux}#out:2x")
    for place in (1, 2, 3):
        for name in (f"Sum{place}", f"q{place} initial", f"Integrator{place}"):
            model.remove(name)
        model.connect(f"{split}#out:{place}", model.sid(f"Simulink-PS\nConverter{place}"))
    cut(model, f"{demux}#out:1", f"{demux}#out:2", f"{demux}#out:3")
    rewire(model, f"{demux}#out:2x", f"{demux}#out:2")
    model.connect(f"{demux}#out:1", total)
    model.connect(total, split)
    assert compared(model).agrees


def test_degrees_at_the_converters(compared):
    model = published_leg()
    for place in (1, 2, 3):
        gain = model.add_block("Gain", f"deg{place}", {"Gain": "180/pi"}, ports={"in": 1, "out": 1})
        converter = model.sid(f"Simulink-PS\nConverter{place}")
        rewire(model, f"{converter}#in:1", f"{gain}#in:1")
        model.connect(gain, converter)
        model.set(f"Simulink-PS\nConverter{place}", Unit="deg")
    assert compared(model).agrees


def test_mirrored_transform(compared):
    model = published_leg()
    sid = model.sid("Rigid Transform2")
    rewire(model, f"{sid}#lconn:1", "x")
    rewire(model, f"{sid}#rconn:1", f"{sid}#lconn:1")
    rewire(model, "x", f"{sid}#rconn:1")
    wrong = compared(model)
    assert ("Rigid Transform2", "TranslationCartesianOffset") in differences(wrong)
    model.set("Rigid Transform2", TranslationCartesianOffset="[-.05 0 0]")
    assert compared(model).agrees


def test_a_half_drawn_as_two_transforms(compared):
    model = published_leg()
    far = model.sid("Rigid Transform1")
    turn = model.add_library(
        RIGID_TRANSFORM,
        "Turn",
        {
            "RotationMethod": "AlignedAxes",
            "FollAlignAxisA": "+Z",
            "BaseAlignAxisA": "-Y",
            "FollAlignAxisB": "+X",
            "BaseAlignAxisB": "+X",
        },
        ports={"lconn": 1, "rconn": 1},
    )
    model.set("Rigid Transform1", RotationMethod=None)
    rewire(model, f"{far}#rconn:1", f"{turn}#rconn:1")
    model.physical(f"{far}#rconn:1", f"{turn}#lconn:1")
    assert compared(model).agrees


@pytest.mark.slow
def test_joint_frames_turned_about_their_axis(compared):
    model = published_leg()
    joint = model.sid("Revolute Joint1")
    for name, angle, port in (("Before", "30", "lconn:1"), ("After", "-30", "rconn:1")):
        sid = model.add_library(
            RIGID_TRANSFORM,
            name,
            {
                "RotationMethod": "StandardAxis",
                "RotationStandardAxis": "+Z",
                "RotationAngle": angle,
                "TranslationMethod": "StandardAxis",
                "TranslationStandardAxis": "+Z" if name == "Before" else "-Z",
                "TranslationStandardOffset": "0.01",
            },
            ports={"lconn": 1, "rconn": 1},
        )
        inner, outer = ("rconn:1", "lconn:1") if name == "Before" else ("lconn:1", "rconn:1")
        rewire(model, f"{joint}#{port}", f"{sid}#{outer}")
        model.physical(f"{joint}#{port}", f"{sid}#{inner}")
    assert compared(model).agrees
    model.set("After", RotationAngle="-20")
    assert not compared(model).agrees


@pytest.mark.parametrize(
    ("block", "changes", "expected"),
    [
        (
            "Rigid Transform2",
            {"TranslationCartesianOffset": "[.06 0 0]"},
            "TranslationCartesianOffset",
        ),
        (
            "Rigid Transform1",
            {"TranslationCartesianOffset": "[.02 0 0]"},
            "TranslationCartesianOffset",
        ),
        ("Rigid Transform1", {"RotationAngle": "-90"}, "rotation"),
        (
            "Rigid Transform3",
            {"TranslationCartesianOffset": "[.05 0 .01]"},
            "TranslationCartesianOffset",
        ),
        ("Brick Solid1", {"Density": "7850"}, "Density"),
        ("Brick Solid1", {"BrickDimensions": "[90 1 1]"}, "length"),
        ("Revolute Joint1", {"DampingCoefficient": "0.1"}, "DampingCoefficient"),
        ("Revolute Joint1", {"SpringStiffness": "2"}, "SpringStiffness"),
        ("Mechanism\nConfiguration", {"GravityVector": "[0 0 -9.81]"}, "GravityVector"),
        ("Mechanism\nConfiguration", {"GravityVector": "[0 -9.80665 0]"}, "GravityVector"),
        ("Sine Wave", {"Amplitude": "50"}, "Amplitude"),
        ("Sine Wave", {"Frequency": "2"}, "Frequency"),
        ("Sine Wave", {"Phase": "pi/2"}, "Phase"),
        ("Sine Wave", {"Bias": "3"}, "constant velocity x"),
        ("Constant y", {"Value": "5"}, "constant velocity y"),
        ("q2 initial", {"Value": "-40/180*pi"}, "initial position of joint 2"),
    ],
    ids=lambda value: value if isinstance(value, str) else None,
)
def test_one_changed_number_is_one_difference(compared, block, changes, expected):
    found = compared(published_leg().set(block, **changes))
    (one,) = found.different
    assert (one["name"].replace(" ", ""), one["parameter"]) == (
        block.replace("\n", "").replace(" ", ""),
        expected,
    )
    assert not found.missing


def test_a_spring_is_compared_with_where_it_rests(compared):
    model = published_leg().set("Revolute Joint1", SpringStiffness="2", EquilibriumPosition="10")
    assert {p for _, p in differences(compared(model))} == {
        "SpringStiffness",
        "EquilibriumPosition",
    }


def test_stop_time(compared):
    assert differences(compared(published_leg(stop_time="10"))) == [("(solver)", "StopTime")]
    assert compared(published_leg(stop_time="10"), duration=10.0).agrees


def test_options_make_the_diagram_match(compared):
    model = published_leg(amplitude="50", initial=("pi/2", "-pi/4", "-pi/2"))
    assert len(compared(model).different) == 2
    assert compared(model, amplitude=0.05, q0=[90.0, -45.0, -90.0]).agrees


@pytest.mark.slow
def test_other_lengths(compared):
    model = published_leg(lengths=(60, 100, 120))
    assert not compared(model).agrees
    assert compared(model, l1=0.06, l3=0.12).agrees


@pytest.mark.slow
def test_slip_in_the_jacobian_names_the_entry(compared):
    slip = JACOB_INV.replace("cos(q1)*r, -sin(q1)*h,", "cos(q1)*r, sin(q1)*h,")
    found = compared(published_leg(script=slip))
    entries = [item["parameter"].split(" at ")[0] for item in found.different]
    assert entries == ["J(2,2)"]
    assert found.different[0]["simulink"] == pytest.approx(-found.different[0]["drake"])


@pytest.mark.slow
def test_wrong_length_in_the_function_alone(compared):
    model = published_leg(script=JACOB_INV.replace("{0}", "60"))
    found = compared(model)
    assert {item["name"] for item in found.different} == {"MATLAB Function"}
    assert {item["parameter"].split(" at ")[0] for item in found.different} == {"J(1,1)", "J(2,1)"}


def test_joints_swapped_at_the_mux(compared):
    model = published_leg()
    mux = model.sid("Mux")
    rewire(model, f"{mux}#in:1", "x")
    rewire(model, f"{mux}#in:2", f"{mux}#in:1")
    rewire(model, "x", f"{mux}#in:2")
    (one,) = compared(model).different
    assert (one["parameter"], one["simulink"]) == ("joints at its inputs", (2, 1, 3))


def test_rates_swapped_at_the_integrators(compared):
    model = published_leg()
    demux = model.sid("Demux")
    rewire(model, f"{demux}#out:2", "x")
    rewire(model, f"{demux}#out:3", f"{demux}#out:2")
    rewire(model, "x", f"{demux}#out:3")
    found = compared(model)
    assert sorted(names(found.different)) == ["Integrator2", "Integrator3"]
    assert {item["what"] for item in found.different} == {"wire"}


def test_gain_before_an_integrator(compared):
    model = published_leg()
    gain = model.add_block("Gain", "Slow", {"Gain": "0.5"}, ports={"in": 1, "out": 1})
    sid = model.sid("Integrator3")
    rewire(model, f"{sid}#in:1", f"{gain}#in:1")
    model.connect(gain, sid)
    (one,) = compared(model).different
    assert (one["what"], one["name"]) == ("wire", "Integrator3")


def test_block_without_counterpart(compared):
    model = published_leg()
    limit = model.add_block("Saturate", "Limit", ports={"in": 1, "out": 1})
    sid = model.sid("Integrator3")
    rewire(model, f"{sid}#in:1", f"{limit}#in:1")
    model.connect(limit, sid)
    found = compared(model)
    assert "Limit" in names([item for item in found.missing if item["what"] == "block"])
    assert not found.agrees


def test_scope_of_what_is_not_recorded(compared):
    model = published_leg()
    scope = model.add_block("Scope", "rates", ports={"in": 1})
    model.connect(f"{model.sid('Demux')}#out:1", scope)
    missing = compared(model).missing
    assert {item["what"] for item in missing} == {"block", "wire"}
    assert "rates" in names(missing)


@pytest.mark.slow
def test_positions_taken_from_the_integrators(compared):
    model = published_leg()
    mux = model.sid("Mux")
    for place in (1, 2, 3):
        cut(model, f"{mux}#in:{place}")
        model.connect(model.sid(f"Sum{place}"), f"{mux}#in:{place}")
    found = compared(model)
    assert [item["parameter"] for item in found.different] == [
        f"position of joint {place}" for place in (1, 2, 3)
    ]
    assert {(item["simulink"], item["drake"]) for item in found.different} == {
        ("integrated", "sensed")
    }
    assert compared(model, feedback="integrated").agrees


def test_joint_that_is_not_driven(compared):
    model = published_leg().set(
        "Revolute Joint2", MotionActuationMode=None, TorqueActuationMode=None
    )
    parameters = {p for n, p in differences(compared(model)) if n == "Revolute Joint2"}
    assert parameters == {"MotionActuationMode", "TorqueActuationMode"}


def test_leg_without_gravity_block(compared):
    model = published_leg().remove("Mechanism\nConfiguration")
    assert differences(compared(model)) == [("(model)", "GravityVector")]


def test_solid_that_hangs_in_the_air(compared):
    model = published_leg()
    model.add_library("sm_lib/Body Elements/Brick Solid", "Loose", ports={"rconn": 1})
    found = compared(model)
    assert names(found.missing) == ["Loose"]


def test_leg_b_is_not_leg_a(compared):
    found = compared(published_leg(), "leg-a")
    parameters = {parameter for _, parameter in differences(found)}
    assert {"rotation", "initial position of joint 2", "initial position of joint 3"} <= parameters
    assert "Amplitude" not in parameters


def test_empty_model_lacks_nothing_but_gravity(compared):
    found = compared(ModelBuilder(solver={"StopTime": "20"}))
    assert not found.missing
    assert differences(found) == [("(model)", "GravityVector")]
    assert len(found.extra) > 20


def insert(model, kind, name, port, parameters=None, **more):
    """Put a block of one input and one output before an input."""
    sid = model.add_block(kind, name, parameters, ports={"in": 1, "out": 1}, **more)
    rewire(model, port, f"{sid}#in:1")
    model.connect(sid, port)
    return sid


def test_a_foreign_block_alone_is_missing(compared):
    model = published_leg()
    insert(model, "ZeroOrderHold", "Hold", f"{model.sid('Integrator2')}#in:1")
    found = compared(model)
    assert not found.different
    assert [item["name"] for item in found.missing if item["what"] == "block"] == ["Hold"]
    assert len([item for item in found.missing if item["what"] == "wire"]) == 2


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [("Fcn", {"Expr": "u*1"}), ("Gain", {"Gain": "1"}), ("SignalConversion", {})],
)
def test_blocks_that_change_nothing(compared, kind, parameters):
    model = published_leg()
    insert(model, kind, "Same", f"{model.sid('Mux')}#in:4", parameters)
    assert compared(model).agrees


def test_integrator_as_a_transfer_function(compared):
    model = published_leg()
    sid = model.sid("Integrator2")
    model.blocks[sid].block_type = "TransferFcn"
    model.set("Integrator2", Numerator="[1]", Denominator="[1 0]")
    assert compared(model).agrees


def test_open_input_of_a_mux_is_zero(compared):
    assert compared(published_leg().remove("Constant y")).agrees


def test_sine_and_zero_exchanged_at_the_mux(compared):
    model = published_leg()
    mux = model.sid("Mux")
    rewire(model, f"{mux}#in:4", "x")
    rewire(model, f"{mux}#in:5", f"{mux}#in:4")
    rewire(model, "x", f"{mux}#in:5")
    found = compared(model)
    assert not found.missing
    assert [item["parameter"][:4] for item in found.different] == ["in:4", "in:5"]


def test_external_initial_conditions(compared):
    model = published_leg()
    for place in (1, 2, 3):
        total, integrator = model.sid(f"Sum{place}"), model.sid(f"Integrator{place}")
        rewire(model, f"{total}#in:2", f"{integrator}#in:2")
        model.remove(f"Sum{place}")
        model.connect(integrator, model.sid(f"Simulink-PS\nConverter{place}"))
        model.set(f"Integrator{place}", InitialConditionSource="external")
    assert compared(model).agrees


@pytest.mark.parametrize(
    "setting",
    [{"LimitOutput": "on"}, {"WrapState": "on"}, {"ExternalReset": "rising"}],
    ids=lambda setting: next(iter(setting)),
)
def test_integrators_that_do_more(compared, setting):
    found = compared(published_leg().set("Integrator1", **setting))
    assert differences(found) == [("Integrator1", next(iter(setting)))]


def test_derivatives_wired_to_the_wrong_joint(compared):
    model = published_leg(filtered=False)
    demux = model.sid("Demux")
    for place, rate in ((1, 2), (2, 1), (3, 3)):
        name = f"Simulink-PS\nConverter{place}"
        model.set(name, FilteringAndDerivatives="provide", UdotUserProvided="1")
        model.connect(f"{demux}#out:{rate}", f"{model.sid(name)}#in:2")
    found = compared(model)
    assert [item["parameter"] for item in found.different] == [
        "in:2, derivative 1 of joint 1",
        "in:2, derivative 1 of joint 2",
    ]


def test_gain_before_a_scope(compared):
    model = published_leg()
    insert(model, "Gain", "Ten", f"{model.sid('foot velocities')}#in:1", {"Gain": "10"})
    assert differences(compared(model)) == [("foot velocities", "factor of velocity 1 of the foot")]
    model.set("Ten", Gain="1000")  # a unit
    assert compared(model).agrees


def test_unit_that_measures_something_else(compared):
    found = compared(published_leg().set("PS-Simulink vx", Unit="kg"))
    assert ("PS-Simulink vx", "Unit") in differences(found)


def test_one_sensor_in_degrees_is_one_difference(compared):
    model = published_leg().set("PS-Simulink\nConverter3", Unit="deg")
    (one,) = compared(model).different
    assert one["parameter"] == "factors of the joint positions"


def test_link_without_its_solid(compared):
    found = compared(published_leg().remove("Brick Solid1"))
    assert differences(found) == [("Revolute Joint1", "solid on its follower")]


def test_further_solid_has_no_counterpart(compared):
    model = published_leg()
    ball = model.add_library(
        "sm_lib/Body Elements/Spherical Solid", "Ball", {"SphereRadius": "0.01"}, ports={"rconn": 1}
    )
    model.physical(f"{ball}#rconn:1", f"{model.sid('Rigid Transform2')}#rconn:1")
    found = compared(model)
    assert names(found.missing) == ["Ball"]
    assert not found.different


def test_cylinder_for_a_brick(compared):
    model = published_leg()
    model.blocks[model.sid("Brick Solid1")].source = "sm_lib/Body Elements/Cylindrical Solid"
    model.set("Brick Solid1", CylinderRadius="0.005", CylinderLength="0.1")
    assert differences(compared(model)) == [("Brick Solid1", "shape")]


def test_custom_inertia(compared):
    custom = {"InertiaType": "Custom", "Mass": "0.04"}
    same = custom | {"MomentsOfInertia": "0.04/12*[.01^2+.01^2 .4^2+.01^2 .4^2+.01^2]"}
    assert compared(published_pendulum().set("Brick Solid", **same), "pendulum").agrees
    other = custom | {"MomentsOfInertia": "[1e-5 1e-5 1e-5]"}
    found = compared(published_pendulum().set("Brick Solid", **other), "pendulum")
    assert differences(found) == [("Brick Solid", "MomentsOfInertia")]


def test_knee_with_exchanged_ends(compared):
    model = published_leg()
    sid = model.sid("Revolute Joint1")
    rewire(model, f"{sid}#lconn:1", "x")
    rewire(model, f"{sid}#rconn:1", f"{sid}#lconn:1")
    rewire(model, "x", f"{sid}#rconn:1")
    assert differences(compared(model)) == [("Revolute Joint1", "base and follower")]


def test_sensor_with_exchanged_ends(compared):
    model = published_leg()
    sid = model.sid("6-DOF Joint")
    rewire(model, f"{sid}#lconn:1", "x")
    rewire(model, f"{sid}#rconn:1", f"{sid}#lconn:1")
    rewire(model, "x", f"{sid}#rconn:1")
    assert differences(compared(model)) == [("6-DOF Joint", "base and follower")]


def test_chain_without_a_world(compared):
    found = compared(published_leg().remove("World Frame"))
    assert ("(model)", "World Frame") in differences(found)
    assert not found.missing


def test_function_that_is_something_else(compared):
    found = compared(published_leg(script="function y = f(u)\ny = [u(1) u(2) u(3) 1];\n"))
    assert {item["name"] for item in found.different} == {"MATLAB Function"}


ANOTHER_LAW = "function y = f(u)\ny = [u(4)*u(1) u(5)+u(2) u(6) 1];\n"
FEWER_OUTPUTS = "function y = f(u)\ny = [u(4) u(5) 1 1];\n"
WAVE = {"Amplitude": "50", "Frequency": "2", "Phase": "0.5"}
WAVE_SI = {"Amplitude": (0.050, 0.070), "Frequency": (2.0, 1.0), "Phase": (0.5, 0.0)}


@pytest.mark.parametrize("script", [ANOTHER_LAW, FEWER_OUTPUTS])
@pytest.mark.parametrize("changed", [(), ("Amplitude",), ("Frequency",), ("Phase",), tuple(WAVE)])
def test_another_law_hides_nothing_upstream(compared, script, changed):
    model = published_leg(script=script)
    model.set("Sine Wave", **{name: WAVE[name] for name in changed})
    found = compared(model)
    assert "MATLAB Function" in names(found.different)
    waves = {
        item["parameter"]: (item["simulink"], item["drake"])
        for item in found.different
        if item["name"] == "Sine Wave"
    }
    assert waves == {name: pytest.approx(WAVE_SI[name]) for name in changed}


def test_a_gain_before_another_law_is_seen(compared):
    model = published_leg(script=ANOTHER_LAW)
    insert(model, "Gain", "Gain", f"{model.sid('Mux')}#in:4", {"Gain": "3"})
    wave = [item for item in compared(model).different if item["name"] == "Sine Wave"]
    assert [(item["parameter"], item["simulink"]) for item in wave] == [
        ("Amplitude", pytest.approx(0.21))
    ]


@pytest.mark.slow
def test_the_order_of_the_inputs_of_another_law_is_its_own(compared):
    model = published_leg(script=ANOTHER_LAW)
    mux = model.sid("Mux")
    for old, new in (("4", "x"), ("5", "4"), ("x", "5")):
        rewire(model, f"{mux}#in:{old}", f"{mux}#in:{new}")
    assert names(compared(model).different) == ["MATLAB Function"]


def times(model, factor):
    """Write every length so many times as large, in the same unit, as who takes m for mm does."""
    for block in model.blocks.values():
        for key in ("TranslationCartesianOffset", "BrickDimensions", "SphereRadius"):
            if key in block.parameters:
                block.parameters[key] = f"{factor}*{block.parameters[key]}"
    return model


@pytest.mark.parametrize("factor", [1000.0, 0.001, 25.4, 3.0])
def test_one_factor_of_all_lengths_is_one_difference(compared, factor):
    found = compared(times(published_leg(), factor))
    assert [(item["what"], item["simulink"]) for item in found.different] == [
        ("scale", pytest.approx(factor))
    ]
    assert not found.missing
    bodies = {item["name"]: item["counterpart"] for item in found.matched if "sid" in item}
    assert bodies["Brick Solid2"] == "body 'tibia'"
    assert bodies["Spherical Solid"] == "body 'foot'"


@pytest.mark.slow
def test_lengths_of_another_leg_in_metres(compared):
    model = times(published_leg(lengths=(25, 50, 100), amplitude="50", stop_time="10"), 1000.0)
    options = {"amplitude": 0.05, "duration": 10.0}
    (one,) = compared(model, l1=0.025, l2=0.05, **options).different
    assert one["what"] == "scale"
    found = compared(model, **options)
    assert not {"scale", "shape"} & {
        item[key] for item in found.different for key in ("what", "parameter")
    }
    bodies = {item["name"]: item["counterpart"] for item in found.matched if "sid" in item}
    assert (bodies["Brick Solid2"], bodies["Spherical Solid"]) == ("body 'tibia'", "body 'foot'")


@pytest.mark.slow
def test_one_other_length_is_no_scale(compared):
    found = compared(published_leg(lengths=(60, 100, 100)))
    assert "scale" not in {item["what"] for item in found.different}


def test_thighs_in_subsystems(compared):
    model = published_leg()
    for place in range(3):
        system = model.add_block("SubSystem", f"Thigh {place}", ports={"lconn": 1, "rconn": 1})
        inner = [
            model.sid(name)
            for name in (
                f"Rigid Transform{2 * place}",
                f"Brick Solid{place}",
                f"Rigid Transform{2 * place + 1}",
            )
        ]
        ends = [f"{inner[0]}#lconn:1", f"{inner[2]}#rconn:1"]
        for side, (end, label) in enumerate(zip(ends, ("Left", "Right"), strict=True)):
            outer = f"{system}#{'lr'[side]}conn:1"
            rewire(model, end, outer)
            port = model.add_block(
                "PMIOPort",
                f"Conn{side + 1}",
                {"Side": label, "Port": str(side + 1)},
                system=system,
                ports={"rconn": 1},
            )
            model.blocks[port].system = system
            for sid in inner:
                model.blocks[sid].system = system
            model.physical(f"{port}#rconn:1", end)
        for line in model.lines:
            if line.physical and all(p.split("#")[0] in inner for p in line.ports):
                line.system = system
    found = compared(model)
    assert found.agrees, (found.missing, found.different)


@pytest.mark.slow
def test_selector_takes_what_it_says(compared):
    model = published_leg()
    function, demux = model.sid("MATLAB Function"), model.sid("Demux")
    sid = model.add_block("Selector", "Rates", ports={"in": 1, "out": 1})
    model.set("Rates", Indices="[1 2 3]", InputPortWidth="4").set("Demux", Outputs="3")
    cut(model, f"{demux}#in:1", f"{demux}#out:4")
    model.connect(f"{function}#out:1", f"{sid}#in:1")
    model.connect(sid, demux)
    model.remove("singularity check")
    assert compared(model).agrees
    model.set("Rates", Indices="[1 3 2]")
    assert names(compared(model).different) == ["Integrator2", "Integrator3"]
    model.set("Rates", Indices="[0 1 2]", IndexMode="Zero-based")
    assert compared(model).agrees


def test_leg_drawn_in_degrees(compared):
    script = JACOB_INV.replace("y = [dq' det(J)];", "y = [dq'*180/pi det(J)];")
    model = published_leg(script=script, initial=("90", "-50", "-90"))
    for place in (1, 2, 3):
        model.set(f"Simulink-PS\nConverter{place}", Unit="deg")
    assert compared(model).agrees
    model.set("Sine Wave", Amplitude="50")
    (one,) = compared(model).different
    assert one["simulink"] == pytest.approx(0.05)


@pytest.mark.parametrize("unit", ["mrad", "foo", "m", "N"])
def test_motion_in_a_unit_of_something_else(compared, unit):
    model = published_leg().set("Simulink-PS\nConverter3", Unit=unit)
    assert ("Simulink-PS Converter3", "Unit") in differences(compared(model))


@pytest.mark.slow
@pytest.mark.parametrize(("priority", "agrees"), [("High", False), ("Low", True)])
def test_state_target_beside_a_motion(compared, priority, agrees):
    target = {"PositionTargetSpecify": "on", "PositionTargetValue": "80"}
    model = published_leg().set("Revolute Joint", PositionTargetPriority=priority, **target)
    assert compared(model).agrees is agrees
    model.set("Revolute Joint", PositionTargetValue="90")
    assert compared(model).agrees


@pytest.mark.parametrize("solver", [{"StartTime": "5"}, {"StopTime": "[20 30]"}])
def test_other_times(compared, solver):
    model = published_leg()
    model.solver.update(solver)
    assert [p for _, p in differences(compared(model))] == list(solver)


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("DataTypeConversion", {"OutDataTypeStr": "int32"}),
        ("Gain", {"Gain": "[1 2; 3 4; 5 6]", "Multiplication": "Matrix(K*u)"}),
        ("Fcn", {"Expr": "floor(u)"}),
        ("Fcn", {"Expr": "u + 5*sin(2*pi*u)"}),
        ("Saturate", {}),
    ],
)
def test_block_that_is_no_wire_is_missing(compared, kind, parameters):
    model = published_leg()
    insert(model, kind, "Odd", f"{model.sid('Integrator1')}#in:1", parameters)
    assert "Odd" in names(compared(model).missing)


def test_matrix_gain_from_the_right(compared):
    model = published_leg()
    settings = {"Gain": "5*eye(6)", "Multiplication": "Matrix(u*K)"}
    insert(model, "Gain", "Five", f"{model.sid('MATLAB Function')}#in:1", settings)
    assert not compared(model).agrees


def test_second_sine_is_seen(compared):
    model = published_leg()
    other = model.add_block("Sin", "Noise", {"Amplitude": "500", "Frequency": "7"})
    both = model.add_block("Sum", "Both", {"Inputs": "++"}, ports={"in": 2, "out": 1})
    rewire(model, f"{model.sid('Mux')}#in:4", f"{both}#in:1")
    model.connect(other, f"{both}#in:2")
    model.connect(both, f"{model.sid('Mux')}#in:4")
    assert [item["what"] for item in compared(model).different] == ["wire"]


def test_sampled_sine(compared):
    found = compared(published_leg().set("Sine Wave", SampleTime="0.5"))
    assert differences(found) == [("Sine Wave", "SampleTime")]


def test_sensor_that_pulls(compared):
    found = compared(published_leg().set("6-DOF Joint", PxSpringStiffness="3"))
    assert differences(found) == [("6-DOF Joint", "PxSpringStiffness")]


@pytest.mark.slow
def test_function_without_an_inverse(compared):
    transposed = published_leg(script=JACOB_INV.replace("inv(J)*", "J'*"))
    found = compared(transposed)
    assert differences(found) == [("MATLAB Function", "joint rates")]
    assert not found.missing


def test_determinant_with_the_other_sign(compared):
    found = compared(published_leg(script=JACOB_INV.replace("det(J)]", "-det(J)]")))
    assert differences(found) == [("MATLAB Function", "sign of the determinant")]


def test_manual_switch_and_product(compared):
    model = published_leg(amplitude="7")
    mux = model.sid("Mux")
    ten = model.add_block("Constant", "Ten", {"Value": "10"})
    product = model.add_block("Product", "Product", {"Inputs": "2"}, ports={"in": 2, "out": 1})
    switch = model.add_block("ManualSwitch", "Switch", ports={"in": 2, "out": 1})
    rewire(model, f"{mux}#in:4", f"{product}#in:1")
    model.connect(ten, f"{product}#in:2")
    model.connect(product, f"{switch}#in:1")
    model.connect(ten, f"{switch}#in:2")
    model.connect(switch, f"{mux}#in:4")
    found = compared(model)
    assert found.agrees, found.different + found.missing


def test_all_joints_exchanged(compared):
    model = published_leg()
    for name in ("Revolute Joint", "Revolute Joint1", "Revolute Joint2"):
        sid = model.sid(name)
        rewire(model, f"{sid}#lconn:1", "x")
        rewire(model, f"{sid}#rconn:1", f"{sid}#lconn:1")
        rewire(model, "x", f"{sid}#rconn:1")
    assert {parameter for _, parameter in differences(compared(model))} == {"base and follower"}


@pytest.mark.slow
def test_a_long_row_of_gains(compared):
    model = published_leg()
    for index in range(400):
        insert(model, "Gain", f"Gain{index}", f"{model.sid('Mux')}#in:4", {"Gain": "1"})
    assert compared(model).agrees


@pytest.mark.parametrize(
    ("block", "changes"),
    [
        ("Brick Solid1", {"BrickDimensions": "[1 2]"}),
        ("Revolute Joint1", {"SpringStiffness": "[1 2]"}),
    ],
)
def test_numbers_that_make_no_sense_are_a_sentence(compared, block, changes):
    with pytest.raises(InvalidValueError, match=block):
        compared(published_leg().set(block, **changes))


@pytest.mark.slow
def test_counts_that_no_model_has(compared):
    assert not compared(published_leg().set("Demux", Outputs="1e9")).agrees
    compared(published_leg().set("Mux", Inputs="1e9"))


def test_derivatives_of_a_leg_drawn_in_degrees(compared):
    script = JACOB_INV.replace("y = [dq' det(J)];", "y = [dq'*180/pi det(J)];")
    model = published_leg(script=script, initial=("90", "-50", "-90"), filtered=False)
    demux = model.sid("Demux")
    for place in (1, 2, 3):
        name = f"Simulink-PS\nConverter{place}"
        model.set(name, Unit="deg", FilteringAndDerivatives="provide", UdotUserProvided="1")
        model.connect(f"{demux}#out:{place}", f"{model.sid(name)}#in:2")
    assert compared(model).agrees


UNREADABLE = [
    (JACOB_INV.replace("J =", "persistent k\nJ =", 1), "'persistent' is not supported"),
    (
        JACOB_INV.replace("inv(J)", "reciprocal(J)"),
        "'reciprocal' is not a known function or constant",
    ),
    (JACOB_INV.replace("u(6)", "u(9)"), "'u' is 6×1 and has no element 9"),
    ("", "it has no code in the file; save the model again in Simulink"),
]


@pytest.mark.parametrize(("script", "why"), UNREADABLE)
def test_unreadable_function_is_one_finding_and_the_rest_is_compared(compared, script, why):
    found = compared(published_leg(script=script))
    (one,) = found.different
    assert (one["what"], one["name"]) == ("block", "MATLAB Function")
    assert one["why"].startswith("could not be read: ")
    assert why in one["why"]
    assert not found.missing
    assert not found.agrees
    changed = compared(published_leg(script=script, amplitude="50"))
    assert names(changed.different) == ["MATLAB Function", "Sine Wave"]


def test_unreadable_function_beside_a_run_without_one(compared):
    model = published_pendulum()
    function = model.add_function("Odd", "function y = f(u)\ny = reciprocal(u);\n")
    model.connect(model.sid("PS-Simulink q"), function)
    found = compared(model, "pendulum")
    assert [item["why"].partition(":")[0] for item in found.different] == ["could not be read"]
    assert "Odd" in names(found.missing)
