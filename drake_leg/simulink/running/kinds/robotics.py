"""Blocks of the toolboxes for robots, vehicles and aircraft: rotations, and paths."""

from __future__ import annotations

from drake_leg.simulink.running.code import Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.operations import REPRESENTATIONS


@kind("Coordinate Transformation Conversion")
def transformation(w: Writer) -> None:
    """Convert a rotation, or a pose, from one representation to another."""
    s = w.settings
    a, b = s.text("InputRepresentation"), s.text("OutputRepresentation")
    orders = s.text("InputEulerSequence", "ZYX"), s.text("OutputEulerSequence", "ZYX")
    for name in (a, b):
        if name not in REPRESENTATIONS:
            raise w.fault(f"converts {name!r}, which does not run")
    inputs = ", ".join(w.numeric(place).code for place in range(w.count))
    pose = w.let(f"pose_of({a!r}, {orders[0]!r}, {inputs})", "pose")
    w.out(f"represented({pose.code}, {b!r}, {orders[1]!r})", 0)
    if len(w.node.outputs) > 1:
        w.out(f"{pose.code}[:3, 3].copy()", 1)


@kind("Direction Cosine Matrix to Rotation Angles")
def angles_of_matrix(w: Writer) -> None:
    """Take the angles [rad] of a direction cosine matrix, in the order that is set."""
    order = w.settings.text("rotationOrder", "ZYX")
    _each_angle(w, f"angles_of({w.numeric().code}, '{order}')")


@kind("Quaternions to Rotation Angles")
def angles_of_quaternion(w: Writer) -> None:
    """Take the angles [rad] of a quaternion, in the order that is set."""
    order = w.settings.text("rotationOrder", "ZYX")
    _each_angle(w, f"angles_of(cosines_of_quaternion({w.vector().code}), '{order}')")


def _each_angle(w: Writer, code: str) -> None:
    if len(w.node.outputs) == 1:
        w.out(code)
        return
    made = w.let(code, "angles")
    for place in range(3):
        w.out(f"float({made.code}[{place}])", place)


@kind("Rotation Angles to Direction Cosine Matrix")
def matrix_of_angles(w: Writer) -> None:
    """Make the direction cosine matrix of angles [rad]."""
    w.out(f"cosines_of({_angles(w)}, '{w.settings.text('rotationOrder', 'ZYX')}')")


@kind("Rotation Angles to Quaternions")
def quaternion_of_angles(w: Writer) -> None:
    """Make the quaternion of angles [rad]."""
    order = w.settings.text("rotationOrder", "ZYX")
    w.out(f"quaternion_of(cosines_of({_angles(w)}, '{order}'))")


def _angles(w: Writer) -> str:
    if w.count == 1:
        return w.vector().code
    return f"array([{', '.join(w.number(place).code for place in range(3))}])"


@kind("Quaternions to Direction Cosine Matrix")
def matrix_of_quaternion(w: Writer) -> None:
    """Make the direction cosine matrix of a quaternion."""
    w.out(f"cosines_of_quaternion({w.vector().code})")


@kind("Direction Cosine Matrix to Quaternions")
def quaternion_of_matrix(w: Writer) -> None:
    """Make the quaternion of a direction cosine matrix; its first part is not negative."""
    w.out(f"quaternion_of({w.numeric().code})")


def _pursuit_after(w: Writer) -> None:
    w.remember(f"float({w.kept['made']}[3])")


@kind("Pure Pursuit", finish=_pursuit_after)
def pure_pursuit(w: Writer) -> None:
    """Drive and turn towards a goal ahead on a path of corners."""
    port, given = 2, []
    for name, usual in (("DesiredLinearVelocity", "0.1"), ("LookaheadDistance", "1.0")):
        if w.settings.is_on(f"{name}Port"):
            given.append(w.number(port).code)
            port += 1
        else:
            given.append(literal(w.settings.number(name, usual)))
    speed, ahead = given
    most = literal(abs(w.settings.number("MaxAngularVelocity", "1.0")))
    at = w.remembered(-1.0)
    made = w.let(
        f"pursued({w.vector(0).code}, {w.numeric(1).code}, {ahead}, {speed}, {most}, {at.code})",
        "pursuit",
    )
    w.kept["made"] = made.code
    for place in range(min(len(w.node.outputs), 3)):
        w.out(f"float({made.code}[{place}])", place)
