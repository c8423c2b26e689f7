"""What a walk is made of, for scripts and notebooks: robots, gaits, commands, servos, the diagram.

A robot walks by its name with ``drake_leg.run("hexapod", speed=0.1)``. The same in parts::

    from drake_leg import HEXABOT, simulate
    from drake_leg.walking import Command, HexapodConfig, build_hexapod, start_walking, walk_of

    walk = walk_of(HEXABOT, commands=(Command(forward=0.1, start=1.0),))
    config = HexapodConfig(robot=HEXABOT, walk=walk)
    result = simulate(build_hexapod(config), 5.0, start=start_walking(config), max_step=0.005)
    print(result.scopes["body pose"][-1])  # quaternion, place [m]
"""

from drake_leg.diagrams.hexapod import HexapodConfig, start_walking
from drake_leg.diagrams.hexapod import build as build_hexapod
from drake_leg.kinematics.walking.foresight import foresee_walk
from drake_leg.kinematics.walking.gait import GAITS, Gait
from drake_leg.kinematics.walking.gaits import Attitude, Command, Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.loads import outwards_on, planned_forces, planned_torques
from drake_leg.kinematics.walking.margins import support_margin
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.kinematics.walking.power import cost_of_transport, electrical_power, work
from drake_leg.kinematics.walking.sequence import WalkSequence, following
from drake_leg.kinematics.walking.weights import total_mass
from drake_leg.models.walker import Contact
from drake_leg.robot.ground import FLAT, Blocks, Ground, Steps
from drake_leg.robot.hexapods import BODY, HEXABOT, HIPS, PHANTOMX, Hip, hexapod
from drake_leg.robot.servos import IDEAL, SERVOS, XL430, Servo
from drake_leg.robot.toml.servo import load_servo, servo_toml

__all__ = [
    "BODY",
    "FLAT",
    "GAITS",
    "HEXABOT",
    "HIPS",
    "IDEAL",
    "PHANTOMX",
    "SERVOS",
    "XL430",
    "Attitude",
    "Blocks",
    "Command",
    "Contact",
    "Gait",
    "Ground",
    "HexapodConfig",
    "Hip",
    "Legs",
    "Servo",
    "Steps",
    "Walk",
    "WalkSequence",
    "build_hexapod",
    "cost_of_transport",
    "electrical_power",
    "following",
    "foresee_walk",
    "hexapod",
    "load_servo",
    "outwards_on",
    "planned_forces",
    "planned_torques",
    "servo_toml",
    "start_walking",
    "support_margin",
    "total_mass",
    "walk_of",
    "work",
]
