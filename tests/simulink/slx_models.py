"""The lab's models as somebody draws them in Simulink: the leg and the pendulum."""

from __future__ import annotations

from slx_writer import ModelBuilder

WORLD = "sm_lib/Frames and Transforms/World Frame"
RIGID_TRANSFORM = "sm_lib/Frames and Transforms/Rigid Transform"
REVOLUTE = "sm_lib/Joints/Revolute\nJoint"
SIX_DOF = "sm_lib/Joints/6-DOF Joint"
BRICK = "sm_lib/Body Elements/Brick Solid"
SPHERE = "sm_lib/Body Elements/Spherical Solid"
MECHANISM = "sm_lib/Utilities/Mechanism\nConfiguration"
SOLVER = "nesl_utility/Solver\nConfiguration"
TO_PHYSICAL = "nesl_utility/Simulink-PS\nConverter"
TO_SIMULINK = "nesl_utility/PS-Simulink\nConverter"

JACOB_INV = """function y = jacob_inv(u)
% inverse Jacobian of the leg, lengths in mm
l1 = {0}; l2 = {1}; l3 = {2};
q1 = u(1); q2 = u(2); q3 = u(3);
dx = u(4); dy = u(5); dz = u(6);
r = l1 + l2*cos(q2) + l3*cos(q2+q3);
h = l2*sin(q2) + l3*sin(q2+q3);
J = [-sin(q1)*r, -cos(q1)*h, -cos(q1)*l3*sin(q2+q3);
      cos(q1)*r, -sin(q1)*h, -sin(q1)*l3*sin(q2+q3);
      0, l2*cos(q2)+l3*cos(q2+q3), l3*cos(q2+q3)];
dq = inv(J)*[dx;dy;dz];
y = [dq' det(J)];
"""

JOINT_NAMES = ("Revolute Joint", "Revolute Joint1", "Revolute Joint2")
_DRIVEN = {
    "TorqueActuationMode": "ComputedTorque",
    "MotionActuationMode": "InputMotion",
    "SensePosition": "on",
}


def published_leg(
    *,
    lengths: tuple[float, float, float] = (50, 100, 100),
    initial: tuple[str, str, str] = ("90/180*pi", "-50/180*pi", "-90/180*pi"),
    amplitude: str = "70",
    stop_time: str = "20",
    foot_radius: str = "3",
    filtered: bool = True,
    script: str = JACOB_INV,
) -> ModelBuilder:
    """Draw the public model of leg B: lengths and radius in mm, angles in rad, sine in mm/s."""
    model = ModelBuilder(solver={"StopTime": stop_time, "SolverName": "VariableStepAuto"})
    foot, joints = _legs_bodies(model, lengths, foot_radius)
    mux, demux = _legs_task(model, amplitude, script.format(*lengths))
    for place, (joint, angle) in enumerate(zip(joints, initial, strict=True), 1):
        _legs_drive(model, place, joint, angle, mux, demux, filtered=filtered)
    _legs_sensor(model, foot)
    return model


def _legs_bodies(
    model: ModelBuilder, lengths: tuple[float, float, float], foot_radius: str
) -> tuple[str, list[str]]:
    world = model.add_library(WORLD, "World Frame", ports={"rconn": 1})
    mechanism = model.add_library(
        MECHANISM,
        "Mechanism\nConfiguration",
        {"GravityVector": "[0 0 -9.80665]", "GravityVectorUnits": "m/s^2"},
        ports={"rconn": 1},
    )
    solver = model.add_library(SOLVER, "Solver\nConfiguration", ports={"rconn": 1})
    ends = [f"{block}#rconn:1" for block in (world, mechanism, solver)]
    joints = []
    for place, length in enumerate(lengths):
        joint = model.add_library(
            REVOLUTE, JOINT_NAMES[place], dict(_DRIVEN), ports={"lconn": 2, "rconn": 2}
        )
        half = {
            "TranslationMethod": "Cartesian",
            "TranslationCartesianOffset": f"[{length / 2000:g} 0 0]",
            "TranslationCartesianOffsetUnits": "m",
        }
        turn = {
            "RotationMethod": "StandardAxis",
            "RotationStandardAxis": "+X",
            "RotationAngle": "90",
            "RotationAngleUnits": "deg",
        }
        near = model.add_library(
            RIGID_TRANSFORM, f"Rigid Transform{2 * place}", half, ports={"lconn": 1, "rconn": 1}
        )
        brick = model.add_library(
            BRICK,
            f"Brick Solid{place}",
            {
                "BrickDimensions": f"[{length:g} 1 1]",
                "BrickDimensionsUnits": "mm",
                "Density": "1000",
                "DensityUnits": "kg/m^3",
            },
            ports={"rconn": 1},
        )
        far = model.add_library(
            RIGID_TRANSFORM,
            f"Rigid Transform{2 * place + 1}",
            half | (turn if place == 0 else {}),
            ports={"lconn": 1, "rconn": 1},
        )
        model.physical(*ends, f"{joint}#lconn:1")
        model.physical(f"{joint}#rconn:1", f"{near}#lconn:1")
        model.physical(f"{near}#rconn:1", f"{brick}#rconn:1", f"{far}#lconn:1")
        ends = [f"{far}#rconn:1"]
        joints.append(joint)
    foot = model.add_library(
        SPHERE,
        "Spherical Solid",
        {
            "SphereRadius": foot_radius,
            "SphereRadiusUnits": "mm",
            "Density": "1000",
            "DensityUnits": "kg/m^3",
        },
        ports={"rconn": 1},
    )
    model.physical(*ends, f"{foot}#rconn:1")
    return f"{foot}#rconn:1", joints


def _legs_task(model: ModelBuilder, amplitude: str, script: str) -> tuple[str, str]:
    sine = model.add_block("Sin", "Sine Wave", {"Amplitude": amplitude, "SampleTime": "0"})
    still = [model.add_block("Constant", f"Constant {axis}", {"Value": "0"}) for axis in "yz"]
    mux = model.add_block("Mux", "Mux", {"Inputs": "6"}, ports={"in": 6, "out": 1})
    function = model.add_function("MATLAB Function", script, **{"in": 1, "out": 1})
    demux = model.add_block("Demux", "Demux", {"Outputs": "4"}, ports={"in": 1, "out": 4})
    scope = model.add_block("Scope", "singularity check", ports={"in": 1})
    for place, (source, name) in enumerate(zip((sine, *still), ("dx", "dy", "dz"), strict=True), 4):
        model.connect(source, f"{mux}#in:{place}", name=name)
    model.connect(mux, function)
    model.connect(function, demux)
    model.connect(f"{demux}#out:4", scope)
    return mux, demux


def _legs_drive(
    model: ModelBuilder,
    place: int,
    joint: str,
    angle: str,
    mux: str,
    demux: str,
    *,
    filtered: bool,
) -> None:
    filtering = {"FilteringAndDerivatives": "filter", "SimscapeFilterOrder": "2"}
    integrator = model.add_block("Integrator", f"Integrator{place}", ports={"in": 1, "out": 1})
    constant = model.add_block("Constant", f"q{place} initial", {"Value": angle})
    total = model.add_block("Sum", f"Sum{place}", {"Inputs": "|++"}, ports={"in": 2, "out": 1})
    to_joint = model.add_library(
        TO_PHYSICAL,
        f"Simulink-PS\nConverter{place}",
        {"Unit": "rad"} | (filtering if filtered else {}),
        ports={"in": 1, "rconn": 1},
    )
    from_joint = model.add_library(
        TO_SIMULINK, f"PS-Simulink\nConverter{place}", {"Unit": "rad"}, ports={"lconn": 1, "out": 1}
    )
    model.connect(f"{demux}#out:{place}", integrator, name=f"dq{place}")
    model.connect(integrator, f"{total}#in:1")
    model.connect(constant, f"{total}#in:2")
    model.connect(total, to_joint, name=f"q{place}")
    model.physical(f"{to_joint}#rconn:1", f"{joint}#lconn:2")
    model.physical(f"{joint}#rconn:2", f"{from_joint}#lconn:1")
    model.connect(from_joint, f"{mux}#in:{place}")


def _legs_sensor(model: ModelBuilder, foot: str) -> None:
    world = model.add_library(WORLD, "World Frame1", ports={"rconn": 1})
    sensed = {
        f"{axis}Sense{what}": "on"
        for axis in ("Px", "Py", "Pz")
        for what in ("Position", "Velocity")
    } | {"SphSensePosition": "on"}
    joint = model.add_library(SIX_DOF, "6-DOF Joint", sensed, ports={"lconn": 1, "rconn": 8})
    model.physical(f"{world}#rconn:1", f"{joint}#lconn:1")
    model.physical(f"{joint}#rconn:1", foot)
    positions = model.add_block("Scope", "foot positions", {"NumInputPorts": "3"}, ports={"in": 3})
    velocities = model.add_block(
        "Scope", "foot velocities", {"NumInputPorts": "3"}, ports={"in": 3}
    )
    rotation = model.add_block("Scope", "Q", ports={"in": 1})
    names = ("px", "vx", "py", "vy", "pz", "vz", "Q")
    for place, name in enumerate(names):
        unit = {"p": "mm", "v": "mm/s", "Q": "1"}[name[0]]
        scope = {"p": positions, "v": velocities, "Q": rotation}[name[0]]
        converter = model.add_library(
            TO_SIMULINK, f"PS-Simulink {name}", {"Unit": unit}, ports={"lconn": 1, "out": 1}
        )
        model.physical(f"{joint}#rconn:{place + 2}", f"{converter}#lconn:1")
        model.connect(converter, f"{scope}#in:{place // 2 + 1 if name != 'Q' else 1}", name=name)


def published_pendulum(
    joint: dict[str, str] | None = None, *, stop_time: str = "10"
) -> ModelBuilder:
    """Draw the pendulum; `joint` has settings of its joint, the damped one's for example."""
    model = ModelBuilder(solver={"StopTime": stop_time})
    world = model.add_library(WORLD, "World Frame", ports={"rconn": 1})
    mechanism = model.add_library(MECHANISM, "Mechanism Configuration", ports={"rconn": 1})
    solver = model.add_library(SOLVER, "Solver Configuration", ports={"rconn": 1})
    turn = model.add_library(
        RIGID_TRANSFORM,
        "Frame 1",
        {
            "RotationMethod": "StandardAxis",
            "RotationStandardAxis": "+X",
            "RotationAngle": "-90",
            "RotationAngleUnits": "deg",
        },
        ports={"lconn": 1, "rconn": 1},
    )
    revolute = model.add_library(
        REVOLUTE,
        "Revolute Joint",
        {"SensePosition": "on", "SenseVelocity": "on"} | (joint or {}),
        ports={"lconn": 1, "rconn": 3},
    )
    centre = model.add_library(
        RIGID_TRANSFORM,
        "Frame 2",
        {
            "TranslationMethod": "StandardAxis",
            "TranslationStandardAxis": "+X",
            "TranslationStandardOffset": "20",
            "TranslationStandardOffsetUnits": "cm",
        },
        ports={"lconn": 1, "rconn": 1},
    )
    brick = model.add_library(
        BRICK,
        "Brick Solid",
        {
            "BrickDimensions": "[0.4 0.01 0.01]",
            "BrickDimensionsUnits": "m",
            "Density": "1000",
            "DensityUnits": "kg/m^3",
        },
        ports={"rconn": 1},
    )
    model.physical(
        f"{world}#rconn:1", f"{mechanism}#rconn:1", f"{solver}#rconn:1", f"{turn}#lconn:1"
    )
    model.physical(f"{turn}#rconn:1", f"{revolute}#lconn:1")
    model.physical(f"{revolute}#rconn:1", f"{centre}#lconn:1")
    model.physical(f"{centre}#rconn:1", f"{brick}#rconn:1")
    for place, (name, unit) in enumerate((("q", "rad"), ("w", "rad/s")), 2):
        converter = model.add_library(
            TO_SIMULINK, f"PS-Simulink {name}", {"Unit": unit}, ports={"lconn": 1, "out": 1}
        )
        scope = model.add_block("Scope", f"Scope {name}", ports={"in": 1})
        model.physical(f"{revolute}#rconn:{place}", f"{converter}#lconn:1")
        model.connect(converter, scope, name=name)
    return model
