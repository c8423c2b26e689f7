"""Parameters that a block has and does not use, because another one chooses a different method."""

from __future__ import annotations

from collections.abc import Mapping

from drake_leg.errors import UnknownValueError
from drake_leg.simulink.model import Block

Uses = Mapping[str, tuple[str, ...]]  # of each choice: the parameters that it uses

_CYLINDRICAL = (
    "TranslationCylindricalRadius",
    "TranslationCylindricalTheta",
    "TranslationCylindricalZOffset",
)
_BY_CHOICE: dict[str, Uses] = {
    "TranslationMethod": {
        "None": (),
        "Cartesian": ("TranslationCartesianOffset",),
        "StandardAxis": ("TranslationStandardOffset",),
        "Cylindrical": _CYLINDRICAL,
        "CylindricalOffset": _CYLINDRICAL,
    },
    "RotationMethod": {
        "None": (),
        "AlignedAxes": (),
        "StandardAxis": ("RotationAngle",),
        "ArbitraryAxis": ("RotationAngle", "RotationArbitraryAxis"),
        "RotationSequence": ("RotationSequenceAngles",),
        "RotationMatrix": ("RotationMatrix",),
        "Quaternion": ("RotationQuaternion",),
    },
    "InertiaType": {
        "CalculateFromGeometry": ("Density", "Mass"),
        "PointMass": ("Mass",),
        "Custom": ("Mass", "CenterOfMass", "MomentsOfInertia", "ProductsOfInertia"),
    },
    "BasedOnType": {"Density": ("Density",), "Mass": ("Mass",), "DensityFromFile": ()},
}
_OF_MECHANICS = "sm_lib/"


def unused_parameters(block: Block) -> frozenset[str]:
    """Names of the parameters that a block of Simscape Multibody does not use."""
    if not block.source.startswith(_OF_MECHANICS):
        return frozenset()
    unused: set[str] = set()
    for choice, uses in _BY_CHOICE.items():
        if choice == "BasedOnType" and _chosen(block, "InertiaType") != "CalculateFromGeometry":
            continue  # it is shown with geometry only
        used = uses.get(_chosen(block, choice))
        if used is not None:
            unused |= {name for names in uses.values() for name in names} - set(used)
    return frozenset(unused)


def _chosen(block: Block, choice: str) -> str:
    try:
        return str(block.parameters.get(choice, ""))
    except UnknownValueError:
        return ""
