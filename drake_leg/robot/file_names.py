"""Which files hold robots, by their names."""

from __future__ import annotations

from pathlib import Path

TOML, PAR = ".toml", ".par"
ENDINGS = f"{TOML} or {PAR}"


def is_par(path: Path | str) -> bool:
    """Whether a file is one of SYMORO."""
    return Path(path).suffix.lower() == PAR


def is_robot_file(path: Path | str) -> bool:
    """Whether a file holds a robot."""
    return Path(path).suffix.lower() in (TOML, PAR)
