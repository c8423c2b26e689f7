"""A pendulum is released, and follows the exact solution.

The diagram has three blocks: the plant, a demultiplexer for its state, and an energy sensor. Two
plots show the angle, with the exact motion as a dotted line, and the energy, which is conserved.

    python examples/pendulum.py

Things to change: ``Q0``; the pendulum itself, as in ``pendulum(size=(0.8, 0.01, 0.01))``; or
``pendulum(mechanics=JointMechanics(damping=0.01))``, for which the exact motion here does not hold.
"""

from math import radians

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer

import drake_leg as dl
from drake_leg.kinematics.pendulum import PendulumModel, exact_motion
from drake_leg.robot.robots import pendulum

ROBOT = pendulum()
Q0 = radians(-30.0)  # 0 is horizontal, 90 degrees hangs down


def build() -> Diagram:
    """Wire the plant to its sensors."""
    builder = DiagramBuilder()

    # Blocks
    plant = builder.AddNamedSystem("pendulum", dl.build_plant(ROBOT))
    plant.SetDefaultPositions([Q0])
    state = builder.AddNamedSystem("angle and velocity", Demultiplexer([1, 1]))
    energy = builder.AddNamedSystem("energy sensor", dl.EnergySensor(plant))

    # Wires
    builder.Connect(plant.get_state_output_port(), state.get_input_port())
    builder.Connect(plant.get_state_output_port(), energy.GetInputPort("state"))

    # Scopes
    dl.add_scope(builder, "q", state.get_output_port(0))
    dl.add_scope(builder, "energy", energy.GetOutputPort("energy"))
    return builder.Build()


def main(duration: float = 10.0) -> plt.Figure:
    """Simulate for a duration [s], compare with the exact motion, and plot."""
    swing = dl.simulate(build(), duration=duration, max_step=0.002)

    q = swing.scopes["q"][:, 0]
    q_exact, _ = exact_motion(PendulumModel.from_robot(ROBOT), Q0, swing.time)
    print(f"farthest from the exact angle: {np.abs(q - q_exact).max():.1e} rad")

    figure, (angle, energy) = plt.subplots(2, 1, sharex=True, layout="constrained")
    angle.plot(swing.time, np.degrees(q), label="simulated")
    angle.plot(swing.time, np.degrees(q_exact), "k:", label="exact")
    angle.set_ylabel("angle q [°]")
    angle.legend(loc="upper right")
    energy.plot(swing.time, 1e3 * swing.scopes["energy"][:, 0])
    energy.set(xlabel="time [s]", ylabel="energy [mJ]", ylim=(0.0, 50.0))
    figure.suptitle("A pendulum, released at rest")
    return figure


if __name__ == "__main__":
    main()
    plt.show()
