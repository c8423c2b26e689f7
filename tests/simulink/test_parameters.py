import math

import pytest
from slx_models import published_leg
from slx_writer import ModelBuilder, read_understood

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import BUILT_IN, LIBRARIES, OLD_NAMES, WITHOUT_PARAMETERS
from drake_leg.simulink.parameters import default_values
from drake_leg.simulink.reader import read_model
from drake_leg.units import parse_unit


@pytest.fixture
def parameters(tmp_path):
    def _parameters(kind, texts=None, **more):
        builder = ModelBuilder()
        if "/" in kind:
            builder.add_library(kind, "B", texts, **more)
        else:
            builder.add_block(kind, "B", texts, **more)
        return read_understood(builder.write(tmp_path / "m.slx")).blocks[0].parameters

    return _parameters


REVOLUTE = "sm_lib/Joints/Revolute Joint"
BRICK = "sm_lib/Body Elements/Brick Solid"


@pytest.mark.parametrize(
    ("kind", "name", "value"),
    [
        ("Sin", "Amplitude", 1.0),
        ("Sin", "Frequency", 1.0),
        ("Integrator", "InitialCondition", 0.0),
        ("Sum", "Inputs", "++"),
        ("Gain", "Gain", 1.0),
        ("Constant", "Value", 1.0),
        ("Mux", "Inputs", 4.0),
        ("TransferFcn", "Denominator", (1.0, 1.0)),
        (REVOLUTE, "TorqueActuationMode", "NoTorque"),
        (REVOLUTE, "MotionActuationMode", "ComputedMotion"),
        (REVOLUTE, "SensePosition", "off"),
        (REVOLUTE, "LowerLimitBound", -math.pi / 2),
        (BRICK, "Density", 1000.0),
        (BRICK, "BrickDimensions", (1.0, 1.0, 1.0)),
        ("sm_lib/Utilities/Mechanism Configuration", "GravityVector", (0.0, 0.0, -9.80665)),
        ("nesl_utility/Simulink-PS Converter", "InputFilterTimeConstant", 0.001),
        ("sm_lib/Joints/6-DOF Joint", "PzSenseVelocity", "off"),
        ("sm_lib/Joints/6-DOF Joint", "SphSensePosition", "off"),
        ("simulink/Sources/Ramp", "slope", 1.0),
    ],
)
def test_absent_parameters_have_their_defaults(parameters, kind, name, value):
    assert parameters(kind)[name] == value


def test_every_default_can_be_evaluated():
    for block_type in (*BUILT_IN, *WITHOUT_PARAMETERS):
        default_values(block_type, "")
    for root, blocks in LIBRARIES.items():
        for name in blocks:
            default_values("Reference", f"{root}/any folder/{name}")


@pytest.mark.parametrize(
    ("kind", "name", "text", "unit", "value", "si"),
    [
        (BRICK, "BrickDimensions", "[50 1 1]", "mm", (0.05, 0.001, 0.001), "m"),
        (BRICK, "Density", "2.7", "g/cm^3", 2700.0, "kg/m^3"),
        (BRICK, "Mass", "500", "g", 0.5, "kg"),
        (BRICK, "MomentsOfInertia", "[1 2 3]", "g*cm^2", (1e-7, 2e-7, 3e-7), "kg*m^2"),
        (REVOLUTE, "EquilibriumPosition", "30", "deg", math.pi / 6, "rad"),
        (REVOLUTE, "SpringStiffness", "1", "N*m/deg", 180 / math.pi, "N*m/rad"),
        (REVOLUTE, "SpringStiffness", "5", "N*m/rad", 5.0, "N*m/rad"),
        (REVOLUTE, "DampingCoefficient", "0.01", "N*m/(deg/s)", 1.8 / math.pi, "N*m*s/rad"),
        (REVOLUTE, "DampingCoefficient", "0.01", "N*m*s/rad", 0.01, "N*m*s/rad"),
        (REVOLUTE, "VelocityTargetValue", "60", "rpm", 2 * math.pi, "rad/s"),
        ("sm_lib/Joints/Prismatic Joint", "PositionTargetValue", "2", "in", 0.0508, "m"),
        ("sm_lib/Joints/Planar Joint", "RzPositionTargetValue", "0.5", "rev", math.pi, "rad"),
        ("sm_lib/Utilities/X/Mechanism Configuration", "GravityVector", "[0 0 -1]", "gee",
         (0.0, 0.0, -9.80665), "m/s^2"),
        ("sm_lib/Forces/Internal Force", "Reach", "[1 2]", "cm", (0.01, 0.02), "m"),
    ],
)  # fmt: skip
def test_values_in_si(parameters, kind, name, text, unit, value, si):
    found = parameters(kind, {name: text, f"{name}Units": unit})
    assert found[name] == pytest.approx(value, rel=1e-15)
    assert found[f"{name}Units"] == si


def test_default_unit_is_meant_where_none_stands(parameters):
    found = parameters(REVOLUTE, {"PositionTargetValue": "90"})
    assert found["PositionTargetValue"] == math.pi / 2
    assert found["PositionTargetValueUnits"] == "rad"


def test_numbers_as_matlab_writes_them(parameters):
    assert parameters("Constant", {"Value": "-50/180*pi"})["Value"] == pytest.approx(
        -math.radians(50), rel=1e-15
    )
    assert parameters("Gain", {"Gain": "[1 2;3 4]"})["Gain"] == ((1.0, 2.0), (3.0, 4.0))


@pytest.mark.parametrize(
    ("text", "signs"), [("|+-", "+-"), ("3", "+++"), ("+ - |+", "+-+"), ("++", "++")]
)
def test_signs_of_a_sum(parameters, text, signs):
    assert parameters("Sum", {"Inputs": text})["Inputs"] == signs


def test_options_and_what_is_unknown_stay_text(parameters):
    found = parameters("Sin", {"SineType": "Sample based", "SampleTime": "Ts", "Tag": "mine"})
    assert (found["SineType"], found["SampleTime"], found["Tag"]) == ("Sample based", "Ts", "mine")


def test_units_that_nobody_here_needs_stay(parameters):
    found = parameters("fl_lib/Thermal/Mass", {"T": "Tair", "T_unit": "degC"})
    assert (found["T"], found["T_unit"]) == ("Tair", "degC")


@pytest.mark.parametrize(
    ("kind", "texts", "sentence"),
    [
        ("Sin", {"Amplitude": "A0"}, r"block 'B' \(SID 1\): parameter Amplitude is 'A0', which"),
        ("Gain", {"Gain": "system('ls')"}, "parameter Gain is .*which cannot be evaluated"),
        ("Constant", {"Value": ""}, "parameter Value is '', which cannot be evaluated"),
        ("Constant", {"Value": "1/"}, "parameter Value is '1/', which cannot be evaluated"),
        ("Constant", {"Value": "x" * 5000}, r"parameter Value is 'xxx.*\.\.\.', which"),
        (BRICK, {"DensityUnits": "mm"}, "parameter Density has the unit 'mm', which measures some"),
        (
            BRICK,
            {"DensityUnits": "stone"},
            "parameter Density has the unit 'stone', which is not supported",
        ),
        ("sm_lib/F/Internal Force", {"X": "a", "XUnits": "m"}, "parameter X is 'a', which cannot"),
    ],
)
def test_what_cannot_be_evaluated_is_said(parameters, kind, texts, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        parameters(kind, texts)


TRANSFORM = "sm_lib/Frames and Transforms/Rigid Transform"
SENSOR = "sm_lib/Frames and Transforms/Transform Sensor"
OVERFLOW = "9^9^9^9^9"


@pytest.mark.parametrize(
    ("kind", "name", "text"),
    [
        ("Sin", "Amplitude", OVERFLOW),
        ("Sin", "Amplitude", "inf"),
        ("Gain", "Gain", "-1e999"),
        ("Saturate", "UpperLimit", OVERFLOW),
        ("Integrator", "LowerSaturationLimit", f"-{OVERFLOW}"),
        ("Integrator", "InitialCondition", "Inf"),
        (REVOLUTE, "SpringStiffness", "1e308"),
        (REVOLUTE, "UpperLimitBound", "1e999"),
        ("sm_lib/F/Internal Force", "Reach", OVERFLOW),
    ],
)
def test_infinite_numbers_are_refused(parameters, kind, name, text):
    units = {"ReachUnits": "m"} if name == "Reach" else {}
    sentence = (
        f"block 'B' .SID 1.: parameter {name} is '.*', which is infinite: put a finite number"
    )
    with pytest.raises(InvalidValueError, match=sentence):
        parameters(kind, {name: text} | units)


@pytest.mark.parametrize(
    ("kind", "name", "text"),
    [
        ("Saturate", "UpperLimit", "inf"),
        ("Saturate", "LowerLimit", "-Inf"),
        ("Step", "Time", "inf"),
        ("RateLimiter", "RisingSlewLimit", "inf"),
        (REVOLUTE, "UpperLimitBound", "inf"),
        ("sm_lib/F/Internal Force", "Reach", "inf"),
    ],
)
def test_limits_and_times_may_be_infinite(parameters, kind, name, text):
    units = {"ReachUnits": "m"} if name == "Reach" else {}
    assert math.isinf(parameters(kind, {name: text} | units)[name])


def test_some_of_several_limits_may_be_infinite(parameters):
    found = parameters("Saturate", {"UpperLimit": "[1 inf]", "LowerLimit": "-[Inf; 2]"})
    assert found["UpperLimit"] == (1.0, math.inf)
    assert found["LowerLimit"] == (-math.inf, -2.0)
    for kind, name in (("Gain", "Gain"), ("Sin", "Amplitude")):
        with pytest.raises(InvalidValueError, match=f"parameter {name} is .*, which is infinite"):
            parameters(kind, {name: "[1 inf]"})
    with pytest.raises(InvalidValueError, match="one of its elements is not finite"):
        parameters("Saturate", {"UpperLimit": "[1 nan]"})


@pytest.mark.parametrize(
    ("name", "text"), [("StopTime", OVERFLOW), ("RelTol", "inf"), ("StartTime", "inf")]
)
def test_infinite_solver_settings_are_refused(tmp_path, name, text):
    path = ModelBuilder(solver={name: text}).write(tmp_path / "m.slx")
    with pytest.raises(
        InvalidValueError, match=f"solver setting {name} is '.*', which is infinite"
    ):
        read_understood(path)


@pytest.mark.parametrize("name", ["Quaternion", "RotationQuaternion"])
def test_both_names_of_the_quaternion(parameters, name):
    found = parameters(TRANSFORM, {"RotationMethod": "Quaternion", name: "[0 1 0 0]"})
    assert found["RotationQuaternion"] == (0.0, 1.0, 0.0, 0.0)
    assert "Quaternion" not in found


@pytest.mark.parametrize(
    ("method", "name", "value"),
    [
        ("Quaternion", "RotationQuaternion", (1.0, 0.0, 0.0, 0.0)),
        ("RotationMatrix", "RotationMatrix", ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))),
        ("ArbitraryAxis", "RotationArbitraryAxis", (0.0, 0.0, 1.0)),
        ("RotationSequence", "RotationSequenceAngles", (0.0, 0.0, 0.0)),
        ("RotationSequence", "RotationSequence", "XYZ"),
    ],
)
def test_a_rotation_without_its_value_has_the_default(parameters, method, name, value):
    assert parameters(TRANSFORM, {"RotationMethod": method})[name] == value


@pytest.mark.parametrize("prefix", ["", "Rz"])
@pytest.mark.parametrize("side", ["Lower", "Upper"])
def test_both_names_of_a_stop(parameters, prefix, side):
    kind = "sm_lib/Joints/Planar Joint" if prefix else REVOLUTE
    spring, damper = f"{prefix}{side}LimitStiffness", f"{prefix}{side}LimitDamping"
    other_spring, other_damper = (
        f"{prefix}{side}LimitSpringStiffness",
        f"{prefix}{side}LimitDampingCoefficient",
    )
    texts = {
        other_spring: "5",
        f"{other_spring}Units": "N*m/rad",
        other_damper: "2",
        f"{other_damper}Units": "N*m/(deg/s)",
    }
    found = parameters(kind, texts)
    assert found[spring] == 5.0
    assert found[damper] == pytest.approx(360 / math.pi, rel=1e-15)
    assert found[f"{spring}Units"] == "N*m/rad"
    assert not texts.keys() & found.keys()
    with pytest.raises(InvalidValueError, match=f"parameter {other_spring} is 'k', which cannot"):
        parameters(kind, {other_spring: "k"})


@pytest.mark.parametrize(
    ("kind", "quantity"),
    [
        (REVOLUTE, "Torque"),
        ("sm_lib/Joints/Prismatic Joint", "Force"),
        ("sm_lib/Joints/Spherical Joint", "Torque"),
    ],
)
def test_sensed_torques_and_forces(parameters, kind, quantity):
    found = parameters(kind, {f"SenseTotal{quantity}": "on"})
    assert found[f"Sense{quantity}"] == found[f"SenseActuator{quantity}"] == "off"
    assert found[f"SenseTotal{quantity}"] == "on"


def test_what_a_transform_sensor_senses(parameters):
    angles = ("Angle", "Axis", "Q", "R", "Omega", "OmegaX", "OmegaY", "OmegaZ")
    places = ("X", "Y", "Z", "XYZ", "Dist", "Radius", "Azimuth", "Inclination")
    rates = ("VX", "VY", "VZ", "VXYZ", "AX", "AY", "AZ", "AXYZ")
    names = [f"Sense{what}" for what in (*angles, *places, *rates)]
    found = parameters(SENSOR)
    assert found["MeasurementFrame"] == "World"
    assert {name for name in found if name.startswith("Sense")} == set(names)
    assert {found[name] for name in names} == {"off"}
    found = parameters(SENSOR, {"SenseVx": "on", "SenseAZ": "on", "MeasurementFrame": "Base"})
    assert (found["SenseVX"], found["SenseVx"], found["SenseAZ"]) == ("on", "on", "on")
    assert found["MeasurementFrame"] == "Base"


def test_a_workspace_variable_in_the_solver_is_said(tmp_path):
    path = published_leg(stop_time="Tend").write(tmp_path / "m.slx")
    with pytest.raises(InvalidValueError, match="solver setting StopTime is 'Tend', which cannot"):
        read_understood(path)


def test_units_of_the_table_are_known():
    for blocks in (BUILT_IN, *LIBRARIES.values()):
        for parameter in (parameter for row in blocks.values() for parameter in row):
            if parameter.unit:
                assert "^-" not in parse_unit(parameter.unit).si


@pytest.mark.parametrize(
    ("texts", "name", "value"),
    [
        (
            {"TranslationLengthUnit": "mm", "TranslationCartesianOffset": "[1 2 3]"},
            "TranslationCartesianOffset",
            (0.001, 0.002, 0.003),
        ),
        (
            {"TranslationLengthUnit": "in", "TranslationStandardOffset": "10"},
            "TranslationStandardOffset",
            0.254,
        ),
        (
            {"TranslationROffset": "5", "TranslationROffsetUnits": "cm"},
            "TranslationCylindricalRadius",
            0.05,
        ),
        (
            {
                "TranslationLengthUnit": "mm",
                "TranslationCartesianOffset": "[1 2 3]",
                "TranslationCartesianOffsetUnits": "m",
            },
            "TranslationCartesianOffset",
            (1.0, 2.0, 3.0),
        ),
    ],
)
def test_units_and_parameters_of_older_files_have_other_names(tmp_path, texts, name, value):
    built = ModelBuilder()
    built.add_library("sm_lib/Frames and Transforms/Rigid Transform", "T", texts)
    (block,) = read_model(built.write(tmp_path / "m.slx")).blocks
    assert block.parameters[name] == pytest.approx(value)
    assert not any(old in block.parameters for old in OLD_NAMES)


def test_a_bricks_edges_and_gravity_in_older_files_have_their_units(tmp_path):
    built = ModelBuilder()
    built.add_library(
        "sm_lib/Body Elements/Solid",
        "S",
        {"GeometryShape": "Brick", "BrickDimensions": "[1 2 3]", "BrickDimensionUnits": "cm"},
    )
    built.add_library(
        "sm_lib/Utilities/Mechanism Configuration",
        "M",
        {"GravityVector": "[0 0 -981]", "GravityUnits": "cm/s^2"},
    )
    solid, configuration = read_model(built.write(tmp_path / "m.slx")).blocks
    assert solid.parameters["BrickDimensions"] == pytest.approx((0.01, 0.02, 0.03))
    assert configuration.parameters["GravityVector"] == pytest.approx((0.0, 0.0, -9.81))
