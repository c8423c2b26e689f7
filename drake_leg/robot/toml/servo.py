"""A servo in a TOML file: read, and written so that it is read back as exactly the same servo."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path, PurePath

from drake_leg.arguments import require_kind
from drake_leg.files import read_text
from drake_leg.robot.servos import Servo, dynamixel_stiffness
from drake_leg.robot.toml.keys import Keys, parse_document
from drake_leg.robot.toml.writer import as_line
from drake_leg.units import parse_unit

SPEED_UNITS = {"rad/s": parse_unit("rad/s"), "rpm": parse_unit("rpm")}
GAIN = "position_p_gain"
KEYS = (*(field.name for field in fields(Servo)), "speed_unit", GAIN)

_HEAD = "# A servo of drake-leg, seen at its output. Keys that are not known may be left out."
_COMMENTS = {
    "name": "",
    "source": "",
    "stall_torque": "[N*m] of the motor at full voltage, at rest",
    "no_load_speed": "[{unit}] of the motor at full voltage, without torque",
    "speed_unit": '"rpm" or "rad/s"',
    "stiffness": f"[N*m/rad] of the controller; a DYNAMIXEL's {GAIN} may be given instead",
    "damping": "[N*m*s/rad] of the controller",
    "rotor_inertia": "[kg*m^2] of rotor and gears, at the output",
    "friction": "[N*m] of the gears, dry",
    "torque_constant": "[N*m/A] stall torque over stall current",
    "resistance": "[Ohm] voltage over stall current",
    "voltage": "[V] of the supply",
}
_CONSTANTS = (
    "write torque_constant, the stall torque over the stall current, and resistance, the voltage "
    "over the stall current"
)
_INSTEAD = {
    **dict.fromkeys(("torque", "effort", "stall"), "write stall_torque"),
    **dict.fromkeys(
        ("speed", "velocity", "rpm", "max_speed"),
        'write no_load_speed, and speed_unit = "rpm" where it is in rpm',
    ),
    **dict.fromkeys(
        ("kp", "gain", "p_gain", "P"),
        f"write stiffness [N*m/rad], or {GAIN} as in a DYNAMIXEL's control table",
    ),
    **dict.fromkeys(("kd", "d_gain", "D"), "write damping [N*m*s/rad]"),
    **dict.fromkeys(("armature", "inertia"), "write rotor_inertia"),
    **dict.fromkeys(("frictionloss", "coulomb", "dry_friction"), "write friction"),
    **dict.fromkeys(("kt", "R", "stall_current", "current"), _CONSTANTS),
    **dict.fromkeys(
        ("viscous", "back_emf_damping"),
        "the motor's own damping is stall_torque over no_load_speed; what a joint has beside it is "
        "the robot's, as damping under [row.mechanics]",
    ),
    **dict.fromkeys(("row", "angles", "base"), "this is the file of a robot, and not of a servo"),
}


def load_servo(path: Path | str) -> Servo:
    """Read a servo from a TOML file.

    Parameters
    ----------
    path : Path or str
        ``servo_toml`` writes one to start from.

    Raises
    ------
    InvalidValueError
        With file, key and value, if something is missing or invalid.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from drake_leg.robot.servos import XL430
    >>> from drake_leg.robot.toml.servo import load_servo, servo_toml
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "mine.toml"
    ...     _ = path.write_text(servo_toml(XL430).replace("friction = 0.04", "friction = 0.1"))
    ...     load_servo(path).friction  # [N*m]
    0.1
    """
    require_kind("the path of a servo's file", path, str, PurePath)
    return read_servo(read_text(Path(path)), str(path))


def read_servo(text: str, where: str) -> Servo:
    """Read a servo from TOML; errors begin with the file's name."""
    keys = Keys(parse_document(text, where), where, KEYS, _INSTEAD)
    unit = keys.choice("speed_unit", tuple(SPEED_UNITS), "rad/s")
    stall_torque = keys.positive("stall_torque", "N*m")
    return keys.make(
        Servo,
        name=keys.text("name", Path(where).stem),
        source=keys.text("source", Path(where).name),
        stall_torque=stall_torque,
        no_load_speed=SPEED_UNITS[unit].in_si(keys.positive("no_load_speed", unit)),
        stiffness=_stiffness(keys, stall_torque),
        damping=keys.non_negative("damping", "N*m*s/rad", 0.0),
        rotor_inertia=keys.non_negative("rotor_inertia", "kg*m^2", 0.0),
        friction=keys.non_negative("friction", "N*m", 0.0),
        torque_constant=keys.optional("torque_constant", "N*m/A", positive=True),
        resistance=keys.optional("resistance", "Ohm", positive=True),
        voltage=keys.optional("voltage", "V", positive=True),
    )


def _stiffness(keys: Keys, stall_torque: float) -> float:
    """Read the stiffness, or the gain that it follows from."""
    if not keys.has(GAIN):
        return keys.positive("stiffness", "N*m/rad")
    if keys.has("stiffness"):
        raise keys.error(f"stiffness and {GAIN} say the same; keep one")
    gain = keys.positive(GAIN, "1")
    return keys.make(dynamixel_stiffness, gain=gain, stall_torque=stall_torque)


def servo_toml(servo: Servo) -> str:
    """Write a servo as TOML; ``read_servo(servo_toml(servo), name) == servo``, to the last bit."""
    require_kind("the servo", servo, Servo)
    values = {field.name: getattr(servo, field.name) for field in fields(Servo)}
    rpm = _in_rpm(servo.no_load_speed)
    unit = "rad/s" if rpm is None else "rpm"
    values["no_load_speed"] = servo.no_load_speed if rpm is None else rpm
    lines = [_HEAD]
    for key, comment in _COMMENTS.items():
        value = unit if key == "speed_unit" else values[key]
        if value is not None:
            lines.append(as_line(key, value, comment.format(unit=unit)))
    return "\n".join(lines) + "\n"


def _in_rpm(speed: float) -> float | None:
    """Find the shortest number of rpm that is exactly this speed [rad/s] when converted back."""
    unit = SPEED_UNITS["rpm"]
    rpm = speed / unit.in_si(1.0)
    candidates = (round(rpm, digits) for digits in range(6))
    return next((one for one in candidates if unit.in_si(one) == speed), None)
