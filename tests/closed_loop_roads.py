"""Compares the roads to a closed loop in Drake: ``python tests/closed_loop_roads.py``.

A four-bar linkage is released from rest and swings for 20 s. Its exact motion has one degree of
freedom: the crank's, whose equation SciPy integrates to 1e-13, with the loop closed by its formula.
Every road is compared with it: how far the loop opens, the greatest error of the crank's angle, the
change of the energy, the time it takes. A number is another duration [s]; a word after it chooses
roads by their names.
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


def roads(duration):
    """Name every road, with the time that it is given and how it is taken."""
    yield (
        "driven, loop closed in every evaluation",
        duration,
        lambda time: of_block(time, None, amplitude=(1.5,)),
    )
    for accuracy in (1e-6, 1e-8):
        yield (
            f"free, loop closed in every evaluation, {accuracy:g}",
            duration,
            lambda time, accuracy=accuracy: of_block(time, accuracy),
        )
    for accuracy in (1e-6, 1e-8):
        yield (
            f"free, W' M W, passive joints integrated, {accuracy:g}",
            duration,
            lambda time, accuracy=accuracy: of_reduced(time, accuracy),
        )
    for step in (1e-3, 1e-4):
        yield (
            f"discrete plant (SAP), ball constraint, {step:g} s",
            duration,
            lambda time, step=step: of_plant(step, time),
        )
    for stiffness in (1e5, 1e6):  # slow
        yield (
            f"continuous plant, bushing of {stiffness:g} N/m, 1e-6",
            min(duration, 1.0),
            lambda time, k=stiffness: of_plant(0.0, time, k, "runge_kutta3", 1e-6),
        )
    yield (
        "continuous plant, ball constraint",
        duration,
        lambda time: of_plant(0.0, time, None, "runge_kutta3", 1e-6),
    )


def main(duration=20.0, which=""):
    """Take the roads in whose names a word is, and print how far each one leads astray."""
    crank = exact(duration)
    print(
        f"{'road':<52}{'time [s]':>9}{'gap [m]':>10}{'angle [rad]':>13}{'energy [J]':>12}", end=""
    )
    print(f"{'CPU [s]':>9}")
    for name, lasting, road in roads(duration):
        if which not in name:
            continue
        began = time.process_time()
        try:
            times, q, qdot = road(lasting)
        except RuntimeError as error:
            print(f"{name:<52}  {' '.join(str(error).split())[:60]}")
            continue
        taken = time.process_time() - began
        print(f"{name:<52}{lasting:>9g}{LOOPS.gap(q).max():>10.1e}", end="")
        if name.startswith("driven"):
            print(f"{'':>25}", end="")
        else:
            energy = energies(q, qdot)
            print(f"{np.abs(q[:, 0] - crank(times)).max():>13.1e}", end="")
            print(f"{np.abs(energy - energy[0]).max():>12.1e}", end="")
        print(f"{taken:>9.1f}", flush=True)


if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]), *sys.argv[2:])
