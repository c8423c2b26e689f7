"""The SDF files of the reports' robots: where they lie, and how they are written.

``python -m drake_leg.models.files sdf`` writes them anew from ``drake_leg.robots``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import package_text, sdf_text
from drake_leg.models.thigh_sdf import FILE, LEG_FILE, thigh_leg_text, thigh_text
from drake_leg.robots import LEG_B, ROBOTS


def generated_files() -> dict[str, str]:
    """Write all files of the folder ``sdf`` as text.

    Returns
    -------
    dict
        File name to text.
    """
    files = {f"{robot.name}.sdf": sdf_text(robot) for robot in ROBOTS}
    thighs = {FILE: thigh_text(), LEG_FILE: thigh_leg_text(LEG_B)}
    return {"package.xml": package_text(), **files, **thighs}


def sdf_folder() -> Path:
    """Find the folder of SDF files, in a wheel or in a checkout.

    Returns
    -------
    Path
        With ``package.xml``, for ``PackageMap.AddPackageXml``.
    """
    package = Path(__file__).resolve().parents[1]
    installed = package / "sdf"
    return installed if installed.is_dir() else package.parent / "sdf"


def sdf_file(name: str) -> Path:
    """Find the SDF file of a robot.

    Parameters
    ----------
    name : str
        ``pendulum``, ``leg_a``, ``leg_b`` or ``scara``.

    Raises
    ------
    InvalidValueError
        If there is no such robot.
    """
    names = [robot.name for robot in ROBOTS]
    if name not in names:
        raise InvalidValueError(f"there is no robot {name!r}; the robots are {', '.join(names)}")
    return sdf_folder() / f"{name}.sdf"


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for file_name, text in generated_files().items():
        (folder / file_name).write_text(text, encoding="utf-8")
