"""Files of CAD programs, written by Open CASCADE, for the tests."""

import pytest

FEATURE = "cylindrical surface 6"
PART = {
    "ExtGeomFileName": "C:\\cad\\Leg.STEP", "InertiaType": "Custom", "Mass": "2",
    "MomentsOfInertia": "[1 1 1]", "DoExposeReferenceFrame": "off",
}  # fmt: skip


def frame(origin=FEATURE, primary=None):
    """Write a frame of a solid on a feature, and perhaps along one."""
    along = (
        f"<Source>GeometricFeature</Source><FeatureName>{primary}</FeatureName>"
        if primary
        else "<Source>ReferenceFrame</Source><SourceDirection>+Z</SourceDirection>"
    )
    return (
        "<Frames><Frame><Name>F1</Name><Origin><Source>GeometricFeature</Source>"
        f"<FeatureName>{origin}</FeatureName></Origin><PrimaryAxis>{along}"
        "<DefinedDirection>+Z</DefinedDirection></PrimaryAxis><SecondaryAxis>"
        "<Source>ReferenceFrame</Source><SourceDirection>+X</SourceDirection>"
        "<DefinedDirection>+X</DefinedDirection></SecondaryAxis></Frame></Frames>"
    )


def open_cascade():
    """Return the package, or skip the test."""
    return pytest.importorskip("OCP", reason="2026-11-30: the extra cad, 380 MB, is not installed")


def write(path, shape, unit="MM"):
    """Write a shape whose numbers are of a unit."""
    from OCP.Interface import Interface_Static
    from OCP.Message import Message
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    Message.DefaultMessenger_s().ChangePrinters().Clear()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("xstep.cascade.unit", unit)
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    return path
