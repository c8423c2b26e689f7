"""Compares the roads to a closed loop in Drake: ``python tests/closed_loop_roads.py``.

A four-bar linkage is released from rest and swings for 20 s. Its exact motion has one degree of
freedom: the crank's, whose equation SciPy integrates to 1e-13, with the loop closed by its formula.
Every road is compared with it: how far the loop opens, the greatest error of the crank's angle, the
change of the energy, the time it takes.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import LinearBushingRollPitchYaw
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import BasicVector, LeafSystem
from scipy.integrate import solve_ivp

from drake_leg import simulate
from drake_leg.diagrams.closed_loop import ClosedLoopConfig, build
from drake_leg.kinematics.assemblies import assemblies
from drake_leg.models.plant import build_plant
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.linkages import FOUR_BAR
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.systems.closed_loop import TreeDynamics
from drake_leg.units import STANDARD_GRAVITY

CONFIG = ClosedLoopConfig(robot=FOUR_BAR)
LOOPS, START = CONFIG.loops, np.array(CONFIG.start)


def tree():
    """Dynamics of the cut tree."""
    return TreeDynamics(build_plant(FOUR_BAR), LOOPS.joints)


def reduced(dynamics, q, rate):
    """Rates of all joints, and acceleration of the crank: ``W' M W``, loop closed or not."""
    W, bias = LOOPS.rates_and_bias(q, np.array([rate]))
    qdot = W[:, 0] * rate
    dynamics.set(q, qdot)
    inertia = W.T @ dynamics.mass_matrix() @ W
    return qdot, float(-(W.T @ dynamics.forces(bias))[0] / inertia[0, 0])


def exact(duration):
    """Angle of the crank at any time, by the formula of its assembly."""
    dynamics = tree()

    def assembly(angle):
        both = [np.array(one.q) for one in assemblies(LOOPS, [angle]).found]
        return next(q for q in both if np.sin(q[1] + q[0] - q[2]) < 0.0)

    def slope(_, state):
        _, acceleration = reduced(dynamics, assembly(state[0]), state[1])
        return [state[1], acceleration]

    found = solve_ivp(
        slope, (0.0, duration), [START[0], 0.0], "DOP853", rtol=1e-12, atol=1e-13, dense_output=True
    )
    return lambda at: found.sol(at)[0]


def energies(positions, velocities):
    """Energy of the tree at every row."""
    dynamics, found = tree(), []
    for q, qdot in zip(positions, velocities, strict=True):
        dynamics.set(q, qdot)
        found.append(dynamics.energy())
    return np.array(found)


class Reduced(LeafSystem):
    """The crank's equation; the passive joints are integrated and the loop is never closed."""

    def __init__(self):
        LeafSystem.__init__(self)
        self.dynamics = tree()
        self.DeclareContinuousState(BasicVector([*START, 0.0]))

    def DoCalcTimeDerivatives(self, context, derivatives):
        state = context.get_continuous_state_vector().CopyToVector()
        qdot, acceleration = reduced(self.dynamics, state[:3], state[3])
        derivatives.SetFromVector([*qdot, acceleration])


def stepped(system, duration, scheme=None, accuracy=None, every=0.01):
    """States of a system at even times."""
    simulator = Simulator(system)
    if scheme:
        ResetIntegratorFromFlags(simulator, scheme, 0.01)
        simulator.get_mutable_integrator().set_target_accuracy(accuracy)
        simulator.get_mutable_context().DisableCaching()
    simulator.Initialize()
    times = np.arange(0.0, duration + 0.5 * every, every)
    states = []
    for at in times:
        simulator.AdvanceTo(at)
        context = simulator.get_context()
        states.append(
            context.get_continuous_state_vector().CopyToVector()
            if scheme
            else context.get_discrete_state_vector().CopyToVector()
        )
    return times, np.array(states)


def plant_with(step, stiffness=None):
    """The tree's plant with its loop closed by a ball constraint or by a bushing."""
    plant = MultibodyPlant(time_step=step)
    Parser(plant).AddModelsFromString(sdf_text(FOUR_BAR), "sdf")
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -STANDARD_GRAVITY])
    cut, end = plant.GetFrameByName("frame_4"), plant.GetFrameByName("frame_5")
    if stiffness is None:
        plant.AddBallConstraint(
            cut.body(),
            cut.GetFixedPoseInBodyFrame().translation(),
            end.body(),
            end.GetFixedPoseInBodyFrame().translation(),
        )
    else:
        nothing, stiff = np.zeros(3), np.full(3, stiffness)
        plant.AddForceElement(
            LinearBushingRollPitchYaw(cut, end, nothing, nothing, stiff, 1e-4 * stiff)
        )
    plant.Finalize()
    names = [plant.GetJointByName(joint) for joint in LOOPS.joints]
    order = [joint.position_start() for joint in names]
    default = np.empty(3)
    default[order] = START
    plant.SetDefaultPositions(default)
    return plant, order


def of_plant(step, duration, stiffness=None, scheme=None, accuracy=None):
    plant, order = plant_with(step, stiffness)
    times, states = stepped(plant, duration, scheme, accuracy)
    return times, states[:, :3][:, order], states[:, 3:][:, order]


def of_reduced(duration, accuracy):
    times, states = stepped(Reduced(), duration, "runge_kutta5", accuracy)
    velocities = [LOOPS.W(q[:3])[:, 0] * q[3] for q in states]
    return times, states[:, :3], np.array(velocities)


def of_block(duration, accuracy, **settings):
    done = simulate(
        build(ClosedLoopConfig(robot=FOUR_BAR, **settings)),
        duration=duration,
        settings=IntegratorSettings(accuracy=accuracy),
    )
    assert done.stop_reason is None, done.stop_reason
    return done.time, done.scopes["joint positions"], done.scopes["joint velocities"]


def main(duration=20.0):
    crank = exact(duration)
    print(f"four-bar released from rest, {duration:g} s")
    print(f"{'road':<58}{'gap [m]':>10}{'angle [rad]':>13}{'energy [J]':>12}{'CPU [s]':>9}")

    def report(name, road, *given, moved=True, **settings):
        began = time.process_time()
        try:
            times, q, qdot = road(*given, **settings)
        except RuntimeError as error:
            print(f"{name:<58}{' '.join(str(error).split())[:60]}")
            return
        taken = time.process_time() - began
        gap = LOOPS.gap(q).max()
        if not moved:
            print(f"{name:<58}{gap:>10.1e}{'':>13}{'':>12}{taken:>9.1f}", flush=True)
            return
        angle = np.abs(q[:, 0] - crank(times)).max()
        energy = energies(q, qdot)
        print(
            f"{name:<58}{gap:>10.1e}{angle:>13.1e}{np.abs(energy - energy[0]).max():>12.1e}"
            f"{taken:>9.1f}",
            flush=True,
        )

    report(
        "crank driven, loop closed in every evaluation",
        of_block,
        duration,
        None,
        amplitude=(1.5,),
        moved=False,
    )
    for accuracy in (1e-6, 1e-8):
        report(
            f"free, loop closed in every evaluation, accuracy {accuracy:g}",
            of_block,
            duration,
            accuracy,
        )
    for accuracy in (1e-6, 1e-8):
        report(
            f"free, W' M W, passive joints integrated, {accuracy:g}", of_reduced, duration, accuracy
        )
    for step in (1e-3, 1e-4):
        report(f"discrete plant (SAP), ball constraint, {step:g} s", of_plant, step, duration)
    for stiffness in (1e5, 1e6):
        report(
            f"continuous plant, bushing of {stiffness:g} N/m, 1e-6",
            of_plant,
            0.0,
            duration,
            stiffness,
            "runge_kutta3",
            1e-6,
        )
    report("continuous plant, ball constraint", of_plant, 0.0, duration, None, "runge_kutta3", 1e-6)


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
