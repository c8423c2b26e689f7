"""Motion-driven joints beside free ones, in trees and loops, against hand-written equations."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, four_bar
from moving import GRAVITY, dynamics, sensed, wired, with_gravity
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Multiplexer, Sine
from scipy.integrate import solve_ivp

DRIVEN = {"MotionActuationMode": "InputMotion", "TorqueActuationMode": "ComputedTorque"}
AMPLITUDE, OMEGA = 0.2, 5.0


def driven_by_sine(system, amplitude=AMPLITUDE, omega=OMEGA):
    """Drive the only input of a mechanism by a sine; return a simulator, and its own context."""
    builder = DiagramBuilder()
    builder.AddSystem(system)
    sine = builder.AddSystem(Sine(amplitude, omega, 0.0, 1))
    together = builder.AddSystem(Multiplexer([1, 1, 1]))
    for number in range(3):
        builder.Connect(sine.get_output_port(number), together.get_input_port(number))
    builder.Connect(together.get_output_port(), system.GetInputPort("u"))
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    own = system.GetMyMutableContextFromRoot(context)
    system.start(context, system.GetInputPort("u").Eval(own))
    return Simulator(diagram, context), own


def cart(**texts):
    """A pendulum that hangs from a carriage on a rail along x."""
    built = with_gravity(MechanismBuilder())
    built.transform("Along", axis="+Y", angle="90")
    built.joint("Prismatic", "Rail", **texts)
    built.body("Brick Solid", "Carriage", BrickDimensions="[0.1 0.1 0.1]")
    built.transform("Turn", axis="+Y", angle="-90")
    built.transform("Pin", axis="+X", angle="-90")
    built.joint("Revolute", "Pivot", SensePosition="on")
    built.transform("Down", offset="[0 0.5 0]")
    built.body("Brick Solid", "Rod", BrickDimensions="[0.02 1 0.02]")
    built.meet("World", "Along lconn:1")
    built.meet("Along", "Rail lconn:1")
    built.meet("Rail", "Carriage", "Turn lconn:1")
    built.meet("Turn", "Pin lconn:1")
    built.meet("Pin", "Pivot lconn:1")
    built.meet("Pivot", "Down lconn:1")
    built.meet("Down", "Rod")
    return built


@pytest.mark.slow
def test_a_driven_carriage_swings_its_pendulum(tmp_path):
    built = wired(cart(**DRIVEN, SenseTorqueForce="on"), "Rail", "lconn:2", "rconn:2")
    wired(built, "Pivot", "rconn:2")
    system = dynamics(built, tmp_path)
    rod, carriage, inertia = 0.4, 1.0, 0.4 * (1.0 + 0.02**2) / 12.0 + 0.4 * 0.25

    def rate(t, state):
        theta, w = state
        a = -AMPLITUDE * OMEGA**2 * math.sin(OMEGA * t)
        # A turn about the axis moves the rod's end against x.
        moment = -rod * 0.5 * (GRAVITY * math.sin(theta) - a * math.cos(theta))
        return [w, moment / inertia]

    at = 1.2
    exact = solve_ivp(rate, (0, at), [0.0, 0.0], method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    simulator, own = driven_by_sine(system)
    simulator.get_mutable_integrator().set_target_accuracy(1e-7)

    def follow(context):
        system.follow(context)

    simulator.set_monitor(follow)
    simulator.AdvanceTo(at)
    simulator.clear_monitor()
    x, theta, v, w = system.GetOutputPort("state").Eval(own)
    assert x == pytest.approx(AMPLITUDE * math.sin(OMEGA * at), abs=1e-9)
    assert v == pytest.approx(AMPLITUDE * OMEGA * math.cos(OMEGA * at), abs=1e-8)
    np.testing.assert_allclose(np.abs([theta, w]), np.abs(exact), atol=1e-6)
    a = -AMPLITUDE * OMEGA**2 * math.sin(OMEGA * at)
    theta, w = exact
    alpha = rate(at, exact)[1]
    swing = rod * 0.5 * (alpha * math.cos(theta) - w**2 * math.sin(theta))
    force = (carriage + rod) * a - swing
    assert sensed(system, own, built, "Rail rconn:2") == pytest.approx(force, abs=1e-5)


class FourBar:
    """A four-bar linkage whose bricks are centered at the joints before them, by hand."""

    ground, crank, coupler, rocker = 0.4, 0.1, 0.35, 0.25

    def __init__(self):
        lengths = (self.crank, self.coupler, self.rocker)
        self.masses = [0.1 * length for length in lengths]
        self.inertias = [
            m * (length**2 + 1e-4) / 12.0 for m, length in zip(self.masses, lengths, strict=True)
        ]

    def closed(self, theta):
        """Return the angles of coupler and rocker, from C toward the ground's pivot."""
        bx, by = self.crank * math.cos(theta), self.crank * math.sin(theta)
        dx, dy = self.ground - bx, -by
        d = math.hypot(dx, dy)
        inner = (self.coupler**2 + d**2 - self.rocker**2) / (2 * self.coupler * d)
        phi = math.atan2(dy, dx) + math.acos(inner)
        cx, cy = bx + self.coupler * math.cos(phi), by + self.coupler * math.sin(phi)
        return phi, math.atan2(-cy, self.ground - cx)

    def rates(self, theta):
        """Return the rates of coupler and rocker per rate of the crank."""
        phi, psi = self.closed(theta)
        A = np.array(
            [
                [-self.coupler * math.sin(phi), -self.rocker * math.sin(psi)],
                [self.coupler * math.cos(phi), self.rocker * math.cos(psi)],
            ]
        )
        b = -self.crank * np.array([-math.sin(theta), math.cos(theta)])
        return np.linalg.solve(A, b)

    def inertia(self, theta):
        phi, _ = self.closed(theta)
        over, under = self.rates(theta)
        (_, m2, m3), (i1, i2, i3) = self.masses, self.inertias
        vx = -self.crank * math.sin(theta) - self.coupler * math.sin(phi) * over
        vy = self.crank * math.cos(theta) + self.coupler * math.cos(phi) * over
        moving = m2 * self.crank**2 + m3 * (vx**2 + vy**2)
        return i1 + moving + i2 * over**2 + i3 * under**2

    def height(self, theta):
        phi, _ = self.closed(theta)
        (_, m2, m3), y = self.masses, self.crank * math.sin(theta)
        return 9.81 * (m2 * y + m3 * (y + self.coupler * math.sin(phi)))

    def slopes(self, theta, step=1e-5):
        """Return the derivatives of inertia and potential energy."""
        up, down = theta + step, theta - step
        return [(f(up) - f(down)) / (2 * step) for f in (self.inertia, self.height)]

    def torque(self, theta, rate, acceleration):
        slope, pull = self.slopes(theta)
        return self.inertia(theta) * acceleration + 0.5 * slope * rate**2 + pull


def four_bar_in_motion(**texts):
    targets = {"PositionTargetSpecify": "on", "PositionTargetValue": "60"}
    # The coupler opens upward, as by hand.
    built = with_gravity(four_bar(**targets, **texts), GravityVector="[0 -9.81 0]")
    for joint, angle in (("B", "-20"), ("C", "-90")):
        built.set(
            joint, **targets | {"PositionTargetValue": angle, "PositionTargetPriority": "Low"}
        )
    return built


@pytest.mark.slow
def test_a_four_bar_moves_as_its_one_equation_says(tmp_path):
    hand = FourBar()
    built = four_bar_in_motion(SensePosition="on", SenseVelocity="on")
    built.set("D", SensePosition="on")
    wired(wired(built, "A", "rconn:2", "rconn:3"), "D", "rconn:2")
    system = dynamics(built, tmp_path)

    def rate(_, state):
        theta, w = state
        return [w, -hand.torque(theta, w, 0.0) / hand.inertia(theta)]

    start, at = [math.pi / 3, 0.0], 0.25
    exact = solve_ivp(rate, (0, at), start, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    simulator = Simulator(system, system.CreateDefaultContext())
    simulator.get_mutable_integrator().set_target_accuracy(1e-6)
    simulator.AdvanceTo(at)
    context = simulator.get_context()
    theta, w = (float(sensed(system, context, built, f"A rconn:{n}")) for n in (2, 3))
    assert abs(w) > 1.0
    np.testing.assert_allclose([theta, w], exact, atol=2e-5)
    _, psi = hand.closed(theta)  # the rocker points back to D, the ground's frame is not turned
    found = float(sensed(system, context, built, "D rconn:2"))
    assert math.remainder(found + psi, math.tau) == pytest.approx(0.0, abs=1e-6)


def test_a_driven_four_bar_takes_the_torque_of_its_equation(tmp_path):
    hand = FourBar()
    built = four_bar_in_motion(**DRIVEN, SenseTorqueForce="on")
    wired(built, "A", "lconn:2", "rconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    motion = np.array([1.3, 2.0, -4.0])
    system.GetInputPort("u").FixValue(context, motion)
    system.start(context, motion)
    found = sensed(system, context, built, "A rconn:2")
    assert found == pytest.approx(hand.torque(*motion), rel=1e-6)


def test_a_spring_at_the_joint_that_closes_a_loop_acts(tmp_path):
    hand = FourBar()
    built = four_bar_in_motion()
    built.set("D", SpringStiffness="0.5", SpringStiffnessUnits="N*m/rad",
              DampingCoefficient="0.1", DampingCoefficientUnits="N*m/(rad/s)")  # fmt: skip
    built.set("A", VelocityTargetSpecify="on", VelocityTargetValue="2",
              VelocityTargetValueUnits="rad/s", SenseAcceleration="on")  # fmt: skip
    built.set("D", SensePosition="on")
    wired(wired(built, "A", "rconn:2"), "D", "rconn:2")
    system = dynamics(built, tmp_path)
    context = system.CreateDefaultContext()
    theta, w = math.pi / 3, 2.0
    under = -hand.rates(theta)[1]  # of D's angle
    angle = float(sensed(system, context, built, "D rconn:2"))
    torque = -under * (0.5 * angle + 0.1 * under * w)
    expected = (torque - hand.torque(theta, w, 0.0)) / hand.inertia(theta)
    found = sensed(system, context, built, "A rconn:2")
    assert found == pytest.approx(expected, rel=1e-6)
