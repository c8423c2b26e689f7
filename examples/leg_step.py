"""The foot of the hexabot's leg makes a straight step: the loop of report A, figure 10.

A sine is the speed of the foot. The inverse Jacobian turns it into joint velocities, an integrator
turns those into joint angles, the leg follows, and the measured angles close the loop.

    python examples/leg_step.py

Things to change: AMPLITUDE, FREQUENCY, DIRECTION (a unit vector) and Q0. With AMPLITUDE = 0.12 the
leg is stretched before the step is complete; the simulation stops there and reports it.
"""

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, Integrator, MatrixGain, Sine

import drake_leg as dl

AMPLITUDE, FREQUENCY = 0.070, 1.0  # [m/s], [rad/s]
DIRECTION = np.array([1.0, 0.0, 0.0])
Q0 = np.radians([90.0, -50.0, -90.0])  # hip, knee, ankle


def build() -> Diagram:
    """Wire the loop."""
    builder = DiagramBuilder()
    # Blocks, in the order of the signal
    sine = builder.AddNamedSystem("Sine Wave", Sine(AMPLITUDE, FREQUENCY, 0.0, 1))
    v = builder.AddNamedSystem("Direction", MatrixGain(DIRECTION.reshape(3, 1)))
    a = builder.AddNamedSystem("Direction of the derivative", MatrixGain(DIRECTION.reshape(3, 1)))
    kinematics = dl.movable(dl.LEG_B)  # the leg's Jacobian and its inverse
    inverse = builder.AddNamedSystem("inverseJacobian", dl.InverseJacobian(kinematics))
    integrator = builder.AddNamedSystem("Integrator", Integrator(Q0))
    plant = builder.AddNamedSystem("leg", dl.build_plant(dl.LEG_B))
    motion = builder.AddNamedSystem("Prescribed Motion", dl.PrescribedMotion(plant))
    joints = builder.AddNamedSystem("joint sensors", Demultiplexer([3, 3]))  # q, then qdot
    sensor = dl.FrameSensor(plant, plant.GetFrameByName("frame_4"))
    foot = builder.AddNamedSystem("6-DOF Joint", sensor)

    # Wires, from the sine to the torques and back from the sensors
    builder.Connect(sine.GetOutputPort("y0"), v.get_input_port())
    builder.Connect(sine.GetOutputPort("y1"), a.get_input_port())
    builder.Connect(v.get_output_port(), inverse.GetInputPort("v"))
    builder.Connect(a.get_output_port(), inverse.GetInputPort("a"))
    builder.Connect(inverse.GetOutputPort("qdot"), integrator.get_input_port())
    builder.Connect(integrator.get_output_port(), motion.GetInputPort("q"))
    builder.Connect(inverse.GetOutputPort("qdot"), motion.GetInputPort("qdot"))
    builder.Connect(inverse.GetOutputPort("qddot"), motion.GetInputPort("qddot"))
    builder.Connect(motion.GetOutputPort("torque"), plant.get_actuation_input_port())
    for port in (joints.get_input_port(), foot.GetInputPort("state"), motion.GetInputPort("state")):
        builder.Connect(plant.get_state_output_port(), port)
    builder.Connect(joints.get_output_port(0), inverse.GetInputPort("q"))

    # Scopes
    dl.add_scope(builder, "foot", foot.GetOutputPort("position"))
    dl.add_scope(builder, "joints", joints.get_output_port(0))
    return builder.Build()


def main(duration: float = 12.0) -> plt.Figure:
    """Simulate for a duration [s], compare the foot with its exact path, and plot."""
    step = dl.simulate(build(), duration=duration)
    foot = step.scopes["foot"]
    exact = AMPLITUDE / FREQUENCY * np.outer(1.0 - np.cos(FREQUENCY * step.time), DIRECTION)
    print(step.stop_reason or "The step is complete.")
    print(f"farthest from the exact path: {np.abs(foot - foot[0] - exact).max():.1e} m")

    figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
    above.plot(step.time, 1e3 * foot, label=["x", "y", "z"])
    above.set(ylabel="foot [mm]", title="The leg makes a straight step")
    below.plot(step.time, np.degrees(step.scopes["joints"]), label=["hip", "knee", "ankle"])
    below.set(xlabel="time [s]", ylabel="joint angle [°]")
    for axes in (above, below):
        axes.legend(loc="upper right")
    return figure


if __name__ == "__main__":
    main()
    plt.show()
