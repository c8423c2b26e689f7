"""A foot driven by hand: command, brake, the reports' inverse Jacobian, joints."""

from __future__ import annotations

from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, Integrator

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.movable import Floats, Movable
from drake_leg.systems.foot_brake import FootBrake
from drake_leg.systems.inverse_jacobian import InverseJacobian

COMMAND, BRAKE, INVERSE, JOINTS = "command", "brake", "inverseJacobian", "joints"


class WholeFoot(Movable):
    """A robot commanded by the velocity of its foot, (3,) [m/s], whatever of it the joints can do.

    Parameters
    ----------
    robot : Movable
        Commanded by its own parts of the velocity, in each posture by those that it has there.
    """

    def __init__(self, robot: Movable) -> None:
        self._robot = robot
        self.turning, self.length = robot.turning, robot.length
        self.determinant_scale, self.geometry = robot.determinant_scale, robot.geometry

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""
        return self._robot.foot(q)

    def jacobian(self, q: Floats) -> Array:
        """Jacobian of the parts that are commanded, (m, n)."""
        return self._robot.at(q).jacobian(q)

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """Acceleration of these parts without acceleration of the joints, (m,)."""
        return self._robot.at(q).bias(q, qdot)

    def determinant(self, q: Floats) -> float:
        """Determinant of that Jacobian."""
        return self._robot.at(q).determinant(q)

    def sigma_min(self, q: Floats) -> float:
        """Smallest singular value of that Jacobian [m]."""
        return self._robot.at(q).sigma_min(q)

    def rates(self, q: Floats, v: Floats) -> Floats:
        """Joint rates (n,) for a velocity of the foot (3,) [m/s]."""
        robot = self._robot.at(q)
        return robot.rates(q, robot.command(v).tolist())


def build(robot: Movable) -> Diagram:
    """Wire the diagram: the source ``command`` takes the foot's velocity, the state is q."""
    builder = DiagramBuilder()
    command = builder.AddNamedSystem(COMMAND, ConstantVectorSource([0.0, 0.0, 0.0]))
    brake = builder.AddNamedSystem(BRAKE, FootBrake(robot))
    inverse = builder.AddNamedSystem(INVERSE, InverseJacobian(WholeFoot(robot)))
    joints = builder.AddNamedSystem(JOINTS, Integrator(robot.joints))

    builder.Connect(command.get_output_port(), brake.GetInputPort("v"))
    builder.Connect(brake.GetOutputPort("velocity"), inverse.GetInputPort("v"))
    builder.Connect(inverse.GetOutputPort("qdot"), joints.get_input_port())
    builder.Connect(joints.get_output_port(), brake.GetInputPort("q"))
    builder.Connect(joints.get_output_port(), inverse.GetInputPort("q"))
    return builder.Build()
