"""The tool of a SCARA arm moves on a straight line in space, and does not rotate.

Four joints control four velocities of the tool: along x, y and z, and its yaw rate. A gain with
these four numbers multiplies a sine; the rest is the loop of leg_step.py.

    python examples/scara.py

Things to change: VELOCITY, whose last number rotates the tool; Q0, whose last number is the
lift. An arm whose elbow becomes straight is singular: the simulation stops before.
"""

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, Integrator, MatrixGain, Sine

import drake_leg as dl

VELOCITY = np.array([0.050, 0.020, 0.010, 0.0])  # amplitudes: x, y, z [m/s] and yaw rate [rad/s]
FREQUENCY = 1.0  # [rad/s]
Q0 = np.array([*np.radians([30.0, 90.0, -120.0]), 0.080])  # shoulder, elbow, wrist; lift [m]


def build() -> Diagram:
    """Wire the loop."""
    builder = DiagramBuilder()

    # Blocks, in the order of the signal
    sine = builder.AddNamedSystem("Sine Wave", Sine(1.0, FREQUENCY, 0.0, 1))
    v = builder.AddNamedSystem("Velocity", MatrixGain(VELOCITY.reshape(4, 1)))
    a = builder.AddNamedSystem("Acceleration", MatrixGain(VELOCITY.reshape(4, 1)))
    # The block inverts the arm's Jacobian; movable gives the arm's kinematics
    inverse = builder.AddNamedSystem("inverseJacobian", dl.InverseJacobian(dl.movable(dl.SCARA)))
    integrator = builder.AddNamedSystem("Integrator", Integrator(Q0))
    plant = builder.AddNamedSystem("scara", dl.build_plant(dl.SCARA))
    motion = builder.AddNamedSystem("Prescribed Motion", dl.PrescribedMotion(plant))
    joints = builder.AddNamedSystem("joint sensors", Demultiplexer([4, 4]))  # q, then qdot
    frame = plant.GetFrameByName("frame_4")
    tool = builder.AddNamedSystem("6-DOF Joint", dl.FrameSensor(plant, frame, euler="ZYX"))

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
    for port in (joints.get_input_port(), tool.GetInputPort("state"), motion.GetInputPort("state")):
        builder.Connect(plant.get_state_output_port(), port)
    builder.Connect(joints.get_output_port(0), inverse.GetInputPort("q"))

    dl.add_scope(builder, "tool", tool.GetOutputPort("position"))
    dl.add_scope(builder, "turn", tool.GetOutputPort("angles"))
    return builder.Build()


def main(duration: float = 6.3) -> plt.Figure:
    """Simulate for a duration [s], compare the tool with its exact line, and plot."""
    move = dl.simulate(build(), duration=duration)
    tool, turn = move.scopes["tool"], move.scopes["turn"]
    exact = np.outer(1.0 - np.cos(FREQUENCY * move.time), VELOCITY[:3] / FREQUENCY)
    print(move.stop_reason or "The move is complete.")
    print(f"farthest from the exact line: {np.abs(tool - tool[0] - exact).max():.1e} m")

    figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
    above.plot(move.time, 1e3 * (tool - tool[0]), label=["x", "y", "z"])
    above.set(ylabel="displacement of the tool [mm]", title="The tool moves on a straight line")
    above.legend(loc="upper right")
    below.plot(move.time, np.degrees(turn[:, 0] - turn[0, 0]))
    below.set(xlabel="time [s]", ylabel="rotation of the tool [°]", ylim=(-1.0, 1.0))
    return figure


if __name__ == "__main__":
    main()
    plt.show()
