"""The pendulum's Simulink diagram: report A, figures 2 and 3.

The mechanical blocks::

    World Frame -> Revolute Joint (damping, spring) -> Rigid Transform -> Brick Solid
                        |
                        +-> q, w -> Scopes
"""

from __future__ import annotations

from dataclasses import dataclass

from pydrake.systems.framework import Context, Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, Demultiplexer

from drake_leg.arguments import checked, require_fields
from drake_leg.diagrams.additions import config_html
from drake_leg.diagrams.mechanism import add_scope, add_stops
from drake_leg.diagrams.wiring import built, plant_of
from drake_leg.kinematics.chain import require_radians
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import initial_state
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import PENDULUM
from drake_leg.systems.energy_sensor import EnergySensor
from drake_leg.units import STANDARD_GRAVITY, require_angle, require_non_negative


@dataclass(frozen=True, kw_only=True)
class PendulumConfig:
    """A pendulum released from rest; damping and spring are the robot's joint mechanics.

    Parameters
    ----------
    robot : Robot
        A pendulum, with damping and spring in its joint mechanics.
    q0 : float, optional
        Where the simulation starts [rad]; by default the robot's state target.
    gravity : float
        Along -z [m/s^2].

    Raises
    ------
    InvalidValueError
        If the robot is not a pendulum, or an angle or gravity makes no sense.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import PENDULUM, PendulumConfig
    >>> PendulumConfig(robot=PENDULUM, q0=radians(30)).gravity
    9.80665
    """

    robot: Robot = PENDULUM
    q0: float | None = None  # [rad], where the simulation starts; None: the robot's state target
    gravity: float = STANDARD_GRAVITY  # [m/s^2]

    def __post_init__(self) -> None:
        require_fields(self)
        require_non_negative("gravity", self.gravity, "m/s^2")
        PendulumModel.from_robot(self.robot)
        if self.q0 is not None:
            require_radians([self.q0], self.robot.moving)
        require_angle("the state target", self.start)

    def _repr_html_(self) -> str:
        return config_html(self, [self.start], self.robot.moving)

    @property
    def start(self) -> float:
        """Where the simulation starts [rad]."""
        return initial_state(self.robot).q[0] if self.q0 is None else self.q0


@checked
def build(config: PendulumConfig) -> Diagram:
    """Wire the pendulum's diagram.

    Parameters
    ----------
    config : PendulumConfig
        Robot and state target.

    Returns
    -------
    Diagram
        To be started with ``start_at_target``.

    Examples
    --------
    >>> from drake_leg import PENDULUM, PendulumConfig, build_pendulum, simulate
    >>> diagram = build_pendulum(PendulumConfig(robot=PENDULUM, q0=0.0))
    >>> swing = simulate(diagram, duration=1.0)
    >>> swing.scopes["q"].max().round(2)  # nearly a half turn [rad]
    np.float64(3.14)
    """
    builder = DiagramBuilder()

    # Blocks.
    plant = build_plant(config.robot, gravity=config.gravity)
    builder.AddNamedSystem(config.robot.name, plant)
    plant.SetDefaultPositions([config.start])
    joint = builder.AddNamedSystem("PS-Simulink Converters", Demultiplexer([1, 1]))
    sensor = builder.AddNamedSystem("Energy", EnergySensor(plant))
    stops = add_stops(builder, config.robot, plant)

    # Wires.
    builder.Connect(plant.get_state_output_port(), joint.get_input_port())
    builder.Connect(plant.get_state_output_port(), sensor.GetInputPort("state"))
    energy = sensor.GetOutputPort("energy")
    if stops is not None:
        force = stops.GetOutputPort("generalized_force")
        builder.Connect(force, plant.get_applied_generalized_force_input_port())
        energy = _sum(builder, energy, stops.GetOutputPort("energy"))

    # Scopes.
    add_scope(builder, "q", joint.get_output_port(0))
    add_scope(builder, "w", joint.get_output_port(1))
    add_scope(builder, "acceleration", plant.get_generalized_acceleration_output_port())
    add_scope(builder, "energy", energy)
    return built(builder)


def _sum(builder: DiagramBuilder, energy: OutputPort, of_stops: OutputPort) -> OutputPort:
    total = builder.AddNamedSystem("Energy with that of the stops", Adder(2, 1))
    builder.Connect(energy, total.get_input_port(0))
    builder.Connect(of_stops, total.get_input_port(1))
    return total.get_output_port()


def start_at_target(diagram: Diagram, context: Context) -> None:
    """Put the joint of a pendulum's diagram at its state target, at rest."""
    plant = plant_of(diagram)
    plant.SetDefaultState(
        plant.GetMyContextFromRoot(context),
        plant.GetMyMutableContextFromRoot(context).get_mutable_state(),
    )
