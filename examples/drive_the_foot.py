"""Keys drive the foot until the leg is nearly stretched and the guard stops it.

KEYS lists which key is held for how long; between keys the velocity changes smoothly. The loop is
that of leg_step.py. The last key drives the foot out of reach: the guard stops it before that.

    python examples/drive_the_foot.py

Things to change: KEYS, and SPEED. By hand and in 3D: drake-leg teleop leg-b
"""

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, Integrator, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial
from scipy.interpolate import CubicHermiteSpline

import drake_leg as dl

X, Y, Z = np.eye(3)
WAYS = {"D": X, "A": -X, "W": Y, "S": -Y, "R": Z, "F": -Z}
KEYS = [("D", 0.6), ("R", 0.4), ("A", 0.8), ("F", 0.3), ("W", 3.0)]  # [s]
SPEED, CHANGE = 0.10, 0.2  # [m/s], [s] from one key to the next
Q0 = np.radians([90.0, -50.0, -90.0])  # hip, knee, ankle
ENDS = np.cumsum([0.0, *(time for _, held in KEYS for time in (CHANGE, held)), CHANGE])
V = SPEED * np.array([0 * X, *(WAYS[key] for key, _ in KEYS for _ in range(2)), 0 * X])


def build() -> Diagram:
    """Wire the loop."""
    builder = DiagramBuilder()
    command = PiecewisePolynomial.CubicHermite(ENDS, V.T, 0.0 * V.T)
    keys = builder.AddNamedSystem("keys", TrajectorySource(command, 1, True))
    split = builder.AddNamedSystem("velocity, acceleration", Demultiplexer([3, 3]))
    # The block inverts the leg's Jacobian; movable gives the leg's kinematics
    inverse = builder.AddNamedSystem("inverseJacobian", dl.InverseJacobian(dl.movable(dl.LEG_B)))
    integrator = builder.AddNamedSystem("Integrator", Integrator(Q0))
    plant = builder.AddNamedSystem("leg", dl.build_plant(dl.LEG_B))
    motion = builder.AddNamedSystem("Prescribed Motion", dl.PrescribedMotion(plant))
    joints = builder.AddNamedSystem("joint sensors", Demultiplexer([3, 3]))  # q, then qdot
    frame = plant.GetFrameByName("frame_4")
    foot = builder.AddNamedSystem("6-DOF Joint", dl.FrameSensor(plant, frame))

    builder.Connect(keys.get_output_port(), split.get_input_port())
    builder.Connect(split.get_output_port(0), inverse.GetInputPort("v"))
    builder.Connect(split.get_output_port(1), inverse.GetInputPort("a"))
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


def main(duration: float = ENDS[-1]) -> plt.Figure:
    """Simulate for a duration [s], compare the foot with the command of the keys, and plot."""
    drive = dl.simulate(build(), duration=duration, max_step=0.005)
    foot = drive.scopes["foot"]
    exact = CubicHermiteSpline(ENDS, V, 0.0 * V).antiderivative()(drive.time)
    print(drive.stop_reason or "The whole motion is complete.")
    print(f"farthest from the command: {np.abs(foot - foot[0] - exact).max():.1e} m")

    figure, axes = plt.subplots(layout="constrained")
    axes.plot(drive.time, 1e3 * foot, label=["x", "y", "z"])
    for begin, (key, _) in zip(ENDS[1::2], KEYS, strict=False):
        axes.text(begin, 210.0, key, weight="bold")
    axes.set(xlabel="time [s]", ylabel="foot [mm]", title="The foot, driven by keys")
    axes.set_ylim(-160.0, 230.0)
    axes.legend(loc="center right")
    return figure


if __name__ == "__main__":
    main()
    plt.show()
