"""Models of small mechanisms, in the blocks that Simscape Multibody has, for the tests."""

from __future__ import annotations

from slx_writer import ModelBuilder

from drake_leg.simulink.multibody.bodies import mechanism_of
from drake_leg.simulink.reader import read_model

BODIES, JOINTS, FRAMES = (
    "sm_lib/Body Elements/",
    "sm_lib/Joints/",
    "sm_lib/Frames and Transforms/",
)
RIGHT = "rconn:1"


class MechanismBuilder(ModelBuilder):
    """A model with a world; blocks are connected by their names and ports."""

    def __init__(self):
        super().__init__()
        self.frame("World Frame", "World")

    def frame(self, kind, name, **texts):
        return self.add_library(FRAMES + kind, name, texts)

    def body(self, kind, name, **texts):
        return self.add_library(BODIES + kind, name, texts)

    def joint(self, kind, name, **texts):
        return self.add_library(f"{JOINTS}{kind} Joint", name, texts)

    def transform(self, name, offset="[0 0 0]", axis="", angle="0"):
        texts = {"TranslationMethod": "Cartesian", "TranslationCartesianOffset": offset}
        if axis:
            texts |= {
                "RotationMethod": "StandardAxis",
                "RotationStandardAxis": axis,
                "RotationAngle": angle,
            }
        return self.frame("Rigid Transform", name, **texts)

    def meet(self, *ports):
        """Connect ports such as ``World``, whose only port is on the right, and ``Hip lconn:1``."""
        found = []
        for port in ports:
            name, _, place = port.partition(" ")
            found.append(f"{self.sid(name)}#{place or RIGHT}")
        self.physical(*found)

    def mechanism(self, folder, **more):
        return mechanism_of(self.model(folder, **more))

    def model(self, folder, **more):
        return read_model(self.write(folder / "m.slx"), **more)


def pendulum(**texts):
    """A rod of 1 m below a joint that turns about y; its brick hangs from its upper end."""
    built = MechanismBuilder()
    built.transform("Turn", axis="+X", angle="-90")
    built.joint("Revolute", "Pivot", **texts)
    built.transform("Down", offset="[0 0.5 0]")
    built.body("Brick Solid", "Rod", BrickDimensions="[0.02 1 0.02]")
    built.meet("World", "Turn lconn:1")
    built.meet("Turn", "Pivot lconn:1")
    built.meet("Pivot", "Down lconn:1")
    built.meet("Down", "Rod")
    return built


def four_bar(ground=0.4, crank=0.1, coupler=0.35, rocker=0.25, **target):
    """A four-bar linkage in x, y: all joints turn about z; the rocker's joint closes it."""
    built = MechanismBuilder()
    built.joint("Revolute", "A", **target)
    built.transform("pivot", offset=f"[{ground} 0 0]")
    built.meet("World", "A lconn:1", "pivot lconn:1")
    at = "A"
    for name, length, joint in (("crank", crank, "B"), ("coupler", coupler, "C")):
        built.transform(f"{name}_end", offset=f"[{length} 0 0]")
        built.body("Brick Solid", name, BrickDimensions=f"[{length} 0.01 0.01]")
        built.joint("Revolute", joint)
        built.meet(at, f"{name}_end lconn:1", name)
        built.meet(f"{name}_end", f"{joint} lconn:1")
        at = joint
    built.transform("rocker_end", offset=f"[{rocker} 0 0]")
    built.body("Brick Solid", "rocker", BrickDimensions=f"[{rocker} 0.01 0.01]")
    built.joint("Revolute", "D")
    built.meet(at, "rocker_end lconn:1", "rocker")
    built.meet("rocker_end", "D lconn:1")
    built.meet("D", "pivot")
    return built
