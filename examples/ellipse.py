"""The foot of the hexabot's leg moves along an ellipse, as in walking.

Two sines command the foot, one along x and one upward. They enter the loop of leg_step.py: an
inverse Jacobian, an integrator, the leg, and feedback of its measured joint angles.

    python examples/ellipse.py

Things to change: AMPLITUDE and LIFT, the size of the ellipse; the columns of PLANE, its plane; Q0,
where the foot starts. A taller ellipse stretches the leg: the simulation then stops.
"""

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, Integrator, MatrixGain, Multiplexer, Sine

import drake_leg as dl

AMPLITUDE, FREQUENCY, LIFT = 0.070, 1.0, 0.040  # [m/s] along, [rad/s], [m] from lowest to highest
PLANE = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])  # along x, and up
Q0 = np.radians([90.0, -50.0, -90.0])  # hip, knee, ankle


def build() -> Diagram:
    """Wire the loop."""
    builder = DiagramBuilder()

    # Blocks, in the order of the signal
    along = builder.AddNamedSystem("along", Sine(AMPLITUDE, FREQUENCY, 0.0, 1))
    up = builder.AddNamedSystem("up", Sine(LIFT / 2 * FREQUENCY, FREQUENCY, np.pi / 2, 1))
    # The block inverts the leg's Jacobian; movable gives the leg's kinematics
    inverse = builder.AddNamedSystem("inverseJacobian", dl.InverseJacobian(dl.movable(dl.LEG_B)))
    integrator = builder.AddNamedSystem("Integrator", Integrator(Q0))
    plant = builder.AddNamedSystem("leg", dl.build_plant(dl.LEG_B))
    motion = builder.AddNamedSystem("Prescribed Motion", dl.PrescribedMotion(plant))
    joints = builder.AddNamedSystem("joint sensors", Demultiplexer([3, 3]))  # q, then qdot
    frame = plant.GetFrameByName("frame_4")
    foot = builder.AddNamedSystem("6-DOF Joint", dl.FrameSensor(plant, frame))

    # Wires: the sines are the foot's velocity, and their derivatives its acceleration
    for port, name in (("y0", "v"), ("y1", "a")):
        mux = builder.AddNamedSystem(f"Mux {name}", Multiplexer(2))
        plane = builder.AddNamedSystem(f"Plane {name}", MatrixGain(PLANE))
        builder.Connect(along.GetOutputPort(port), mux.get_input_port(0))
        builder.Connect(up.GetOutputPort(port), mux.get_input_port(1))
        builder.Connect(mux.get_output_port(), plane.get_input_port())
        builder.Connect(plane.get_output_port(), inverse.GetInputPort(name))
    builder.Connect(inverse.GetOutputPort("qdot"), integrator.get_input_port())
    builder.Connect(integrator.get_output_port(), motion.GetInputPort("q"))
    builder.Connect(inverse.GetOutputPort("qdot"), motion.GetInputPort("qdot"))
    builder.Connect(inverse.GetOutputPort("qddot"), motion.GetInputPort("qddot"))
    builder.Connect(motion.GetOutputPort("torque"), plant.get_actuation_input_port())
    for port in (joints.get_input_port(), foot.GetInputPort("state"), motion.GetInputPort("state")):
        builder.Connect(plant.get_state_output_port(), port)
    builder.Connect(joints.get_output_port(0), inverse.GetInputPort("q"))

    dl.add_scope(builder, "foot", foot.GetOutputPort("position"))
    return builder.Build()


def main(duration: float = 6.3) -> plt.Figure:
    """Simulate for a duration [s], compare the foot with the exact ellipse, and plot."""
    result = dl.simulate(build(), duration=duration)
    foot, phase = result.scopes["foot"], FREQUENCY * result.time
    ellipse = [AMPLITUDE / FREQUENCY * (1.0 - np.cos(phase)), LIFT / 2 * np.sin(phase)]
    exact = foot[0] + (PLANE @ ellipse).T
    print(result.stop_reason or "The ellipse is complete.")
    print(f"farthest from the exact ellipse: {np.abs(foot - exact).max():.1e} m")

    figure, axes = plt.subplots(layout="constrained")
    axes.plot(1e3 * foot[:, 0], 1e3 * foot[:, 2], ".", label="simulated, step by step")
    axes.plot(1e3 * exact[:, 0], 1e3 * exact[:, 2], "k:", label="exact")
    axes.set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal", title="The foot on an ellipse")
    axes.legend()
    return figure


if __name__ == "__main__":
    main()
    plt.show()
