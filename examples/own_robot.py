"""An arm of your own: its Khalil table is written, proved, and its foot makes a straight step.

The table's chain, SymPy, Drake and finite differences must agree on the foot and the Jacobian. Then
the loop of leg_step.py moves the foot.

    python examples/own_robot.py

Things to change: everything in ROWS; one row more is one joint more, in Q0 and joint sensors too.
"""

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, Integrator, MatrixGain, Sine

import drake_leg as dl
from drake_leg.robot.robot import Link, Row, Segment
from drake_leg.robot.solids import Brick, Solid


def bar(joint: str, length: float, row: Row) -> Segment:
    """Make a segment: an aluminum bar along the x axis of its row's frame, length in m."""
    shape, middle = Brick(length=length, width=0.02, height=0.01), (length / 2, 0.0, 0.0)
    solid = Solid(shape=shape, density=2700.0, centre=middle, colour=(0.0, 0.45, 0.7))
    return Segment(row=row, joint=joint, link=Link(name=f"{joint}_link", solid=solid))


ROWS = (  # d and r in m, alpha and theta in rad
    bar("turn", 0.05, Row(joint="revolute", r=0.10)),
    bar("shoulder", 0.25, Row(joint="revolute", d=0.05, alpha=np.pi / 2)),
    bar("elbow", 0.20, Row(joint="revolute", d=0.25)),
    Segment(row=Row(joint="fixed", d=0.20)),  # the foot, a frame only
)
ARM = dl.Robot(name="arm", title="Desk arm", source="own_robot.py", segments=ROWS)
Q0 = np.radians([0.0, 60.0, -90.0])
VELOCITY = np.array([0.0, 0.050, 0.0])  # of the foot, times sin(t) [m/s]


def build() -> Diagram:
    """Wire the loop."""
    builder = DiagramBuilder()
    sine = builder.AddNamedSystem("Sine Wave", Sine(1.0, 1.0, 0.0, 1))
    # The block inverts the robot's Jacobian; movable gives the robot's kinematics
    inverse = builder.AddNamedSystem("inverseJacobian", dl.InverseJacobian(dl.movable(ARM)))
    integrator = builder.AddNamedSystem("Integrator", Integrator(Q0))
    plant = builder.AddNamedSystem("plant", dl.build_plant(ARM))
    motion = builder.AddNamedSystem("Prescribed Motion", dl.PrescribedMotion(plant))
    joints = builder.AddNamedSystem("joint sensors", Demultiplexer([3, 3]))  # q, then qdot
    frame = plant.GetFrameByName(f"frame_{len(ROWS)}")
    foot = builder.AddNamedSystem("6-DOF Joint", dl.FrameSensor(plant, frame))
    for derivative, port in (("y0", "v"), ("y1", "a")):
        gain = builder.AddNamedSystem(f"Direction {port}", MatrixGain(VELOCITY.reshape(3, 1)))
        builder.Connect(sine.GetOutputPort(derivative), gain.get_input_port())
        builder.Connect(gain.get_output_port(), inverse.GetInputPort(port))
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
    """Prove the table, simulate for a duration [s], compare with the exact path, and draw."""
    proof = dl.prove(ARM)
    print(f"proved: {proof.holds}; differences up to {proof.worst.difference:.0e}")
    step = dl.simulate(build(), duration=duration)
    way = step.scopes["foot"] - step.scopes["foot"][0]
    exact = np.outer(1.0 - np.cos(step.time), VELOCITY)
    print(f"farthest from the exact path: {np.abs(way - exact).max():.1e} m")
    return dl.frames_drawing(ARM)


if __name__ == "__main__":
    main()
    plt.show()
