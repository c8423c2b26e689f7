"""Files of CAD programs, written by Open CASCADE, for the tests."""

import pytest


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
