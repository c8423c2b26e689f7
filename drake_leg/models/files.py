"""The SDF files of the reports' robots: where they are, and how they are written.

``python -m drake_leg.models.files sdf`` writes them again from ``drake_leg.robot.robots``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from drake_leg.models.sdf import package_text, sdf_text
from drake_leg.models.thigh import FILE, LEG_FILE, thigh_leg_text, thigh_text
from drake_leg.robot.robots import LEG_B, ROBOTS


def generated_files() -> dict[str, str]:
    """Write all files of the folder ``sdf`` as text: file name to content."""
    files = {f"{robot.name}.sdf": sdf_text(robot) for robot in ROBOTS}
    thighs = {FILE: thigh_text(), LEG_FILE: thigh_leg_text(LEG_B)}
    return {"package.xml": package_text(), **files, **thighs}


def sdf_folder() -> Path:
    """Find the folder of SDF files and their ``package.xml``, in a wheel or in a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "sdf"
    return installed if installed.is_dir() else package.parent / "sdf"


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for file_name, text in generated_files().items():
        (folder / file_name).write_text(text, encoding="utf-8")
