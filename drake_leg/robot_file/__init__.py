"""A robot of one's own: from a TOML file and back.

``keys`` reads a table key by key and puts every fault into one sentence, ``units`` knows the
file's angles, ``classic`` turns standard Denavit-Hartenberg rows into Khalil's, ``read`` and
``write`` are the two ways.
"""

from drake_leg.robot_file.read import load_robot, read_robot
from drake_leg.robot_file.write import robot_toml

__all__ = ["load_robot", "read_robot", "robot_toml"]
