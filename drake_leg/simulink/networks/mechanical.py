"""The equations of mechanical blocks, as Simscape's documentation gives them.

A force or a torque that flows from R to C pulls R and C towards each other where it is positive.
"""

from __future__ import annotations

from drake_leg.simulink.networks.assembly import Bench, element


@element("Mechanical Translational Reference", "Mechanical Rotational Reference")
def reference(b: Bench) -> None:
    """Rest."""
    b.zero(b.at("V"))
    b.into("V")


@element("Translational Free End", "Rotational Free End")
def free_end(_: Bench) -> None:
    """Let nothing flow."""


@element("Mass", "Inertia")
def mass(b: Bench) -> None:
    """Have a velocity, which the forces change."""
    turns = b.block.kind == "Inertia"
    heavy = b.positive("inertia" if turns else "mass", 0.01 if turns else 1.0)
    velocity, rate = b.state("w" if turns else "v")
    b.zero(velocity - b.at("M"))
    b.flow("M", heavy * rate)
    if b.has("N"):
        b.zero(b.between("M", "N"))
        b.through("N", "M")


@element("Translational Spring", "Rotational Spring")
def spring(b: Bench) -> None:
    """Pull with a force that grows with the deformation."""
    name = "phi" if b.block.kind.startswith("Rotational") else "x"
    old = b.number("init_def", 0.0)  # of releases without targets
    strain, rate = b.state(name, start=old)
    b.zero(rate - b.between("R", "C"))
    force = b.number("spr_rate", 10.0 if name == "phi" else 1000.0) * strain
    b.flow("R", force)
    b.flow("C", -force)


@element("Translational Damper", "Rotational Damper")
def damper(b: Bench) -> None:
    """Pull with a force that grows with the relative velocity."""
    rate = b.number("D", 0.001 if b.block.kind.startswith("Rotational") else 100.0)
    force = b.through("R", "C")
    b.zero(force - rate * b.between("R", "C"))


@element("Translational Friction", "Rotational Friction")
def friction(b: Bench) -> None:
    """Resist with Stribeck, Coulomb and viscous friction, smooth around rest."""
    turns = b.block.kind.startswith("Rotational")
    end = "trq" if turns else "frc"
    breakaway, coulomb = b.number(f"brkwy_{end}", 25.0), b.number(f"Col_{end}", 20.0)
    viscous = b.number("visc_coef", 0.001 if turns else 100.0)
    velocity = b.positive("brkwy_vel", 0.1)
    if breakaway < coulomb:
        raise b.fault(
            f"has the breakaway friction {breakaway:g}, below the Coulomb friction {coulomb:g}: it "
            "must not be less"
        )
    force = b.law(
        f"friction({{0}}, {breakaway!r}, {coulomb!r}, {viscous!r}, {velocity!r})",
        b.between("R", "C"),
    )
    b.flow("R", force)
    b.flow("C", -force)


@element("Translational Hard Stop", "Rotational Hard Stop")
def hard_stop(b: Bench) -> None:
    """Push back beyond two bounds, with stiffness and damping."""
    turns = b.block.kind.startswith("Rotational")
    law = b.chosen("model", "3", {"1": "smooth", "2": "undamped", "3": "damped"})
    low, high = b.bound("lower_bnd", -0.1), b.bound("upper_bnd", 0.1)
    if not low < high:
        raise b.fault(f"has the bounds {low:g} and {high:g}: the lower one must be less")
    stiff, damped = 1e6, 0.01 if turns else 150.0
    numbers = [b.number(f"stiff_{side}", stiff) for side in ("low", "up")]
    numbers += [b.number(f"D_{side}", damped) for side in ("low", "up")]
    width = b.positive("transition", 0.1 if turns else 1e-4) if law == "smooth" else 0.0
    place, rate = b.state("phi" if turns else "x")
    velocity = b.between("R", "C")
    b.zero(rate - velocity)
    listed = ", ".join(repr(each) for each in (low, high, *numbers, width))
    rebounds = law == "undamped"
    force = b.law(f"hard_stop({{0}}, {{1}}, {listed}, {rebounds})", place, velocity)
    b.flow("R", force)
    b.flow("C", -force)


@element("Ideal Force Source", "Ideal Torque Source")
def force_source(b: Bench) -> None:
    """Push R from C with the force that is given."""
    b.flow("R", -b.input("S"))
    b.flow("C", b.input("S"))


@element("Ideal Translational Velocity Source", "Ideal Angular Velocity Source")
def velocity_source(b: Bench) -> None:
    """Move R relative to C with the velocity that is given."""
    b.through("R", "C")
    b.zero(b.between("R", "C") - b.input("S"))


@element("Ideal Force Sensor", "Ideal Torque Sensor")
def force_sensor(b: Bench) -> None:
    """Put out the force that flows from R to C, which move as one."""
    b.output("F", b.through("R", "C"))
    b.zero(b.between("R", "C"))


@element("Ideal Translational Motion Sensor", "Ideal Rotational Motion Sensor")
def motion_sensor(b: Bench) -> None:
    """Put out velocity, position and acceleration of R relative to C, or to rest."""
    velocity = b.between("R", "C") if b.takes("C") else b.at("R")
    b.output("V", velocity)
    if b.gives("P"):
        b.require("wrap_angle", "off", "false")
        position, rate = b.state(start=b.number("offset", 0.0))
        b.zero(rate - velocity)
        b.output("P", position)
    if b.gives("B"):
        moving, rate = b.follower()
        b.zero(moving - velocity)
        b.output("B", rate)


@element("Gear Box")
def gear_box(b: Bench) -> None:
    """Let S turn as many times as fast as O as the ratio says, without losses."""
    _geared(b, "S", "O", b.number("ratio", 5.0))


@element("Simple Gear")
def simple_gear(b: Bench) -> None:
    """Let the base turn as many times as fast as the follower as the ratio says."""
    b.require("friction_model", "off", "1")
    b.require("enable_faults", "off", "0")
    b.require("enable_backlash", "false", "off", "0")
    sign = b.chosen("rotation_direction", "opposite", {"same": 1.0, "opposite": -1.0})
    _geared(b, "S", "O", sign * b.number("ratio", 2.0))


@element("Wheel and Axle")
def wheel(b: Bench) -> None:
    """Let P move by the radius as A turns."""
    sign = b.chosen("or", "1", {"1": 1.0, "2": -1.0, "-1": -1.0})
    _geared(b, "P", "A", sign * b.positive("R", 0.1))


def _geared(b: Bench, fast: str, slow: str, ratio: float) -> None:
    if not ratio:
        raise b.fault("has the ratio 0: it must be another number")
    b.zero(b.at(fast) - ratio * b.at(slow))
    effort = b.into(fast)
    b.flow(slow, -ratio * effort)


@element("Rotational Multibody Interface", "Translational Multibody Interface")
def interface(b: Bench) -> None:
    """Let R move relative to C as a joint does, and let the network act on the joint."""
    b.zero(b.between("R", "C") - b.input("w"))
    b.output("t", b.through("R", "C"))
