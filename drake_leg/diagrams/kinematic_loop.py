"""The leg's diagram without its mechanics: the kinematic loop, as one block and a scope.

What the blocks of the leg's diagram compute between the sine and the joints is one equation,
``qdot = J^-1(q) v(t)``. Where no torque is asked for, the joints need nothing else::

    Kinematic Loop -> joint motion
"""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.systems.framework import Diagram, DiagramBuilder, LeafSystem

from drake_leg.arguments import checked
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.mechanism import add_scope
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.kinematics.loop import KinematicEquation
from drake_leg.systems.kinematic_loop import KinematicLoop, compiled_loop

LOOP = "Kinematic Loop"
SCOPE = "joint motion"


def equation_of(config: HexabotLegConfig | ScaraConfig) -> KinematicEquation:
    """Return the equation of the joints in a leg's or a SCARA's diagram."""
    control, motion = config.control, config.motion
    leg = config if isinstance(config, HexabotLegConfig) else None
    return KinematicEquation(
        robot=config.inverted,
        motion=motion,
        q0=config.q0,
        correction=control.correction,
        top_speed=control.top_speed(motion.greatest_speed, config.movable.length),
        time_constant=leg.filter_time_constant if leg else None,
        senses=leg is None or leg.feedback == "sensed",
    )


@checked
def build(config: HexabotLegConfig | ScaraConfig) -> Diagram:
    """Wire the kinematic loop of a leg's, an ellipse's or a SCARA's configuration.

    Parameters
    ----------
    config : HexabotLegConfig, EllipseConfig or ScaraConfig
        Robot, posture and motion; what concerns masses and forces has no effect.

    Returns
    -------
    Diagram
        Its scope "joint motion" has the joint positions; with input filters also their
        derivatives, and the filters' input.

    Examples
    --------
    >>> from drake_leg import HexabotLegConfig, SineStep, build_kinematic_loop, simulate
    >>> config = HexabotLegConfig(motion=SineStep(amplitude=0.05))
    >>> joints = simulate(build_kinematic_loop(config), duration=1.0).scopes["joint motion"]
    >>> foot = [config.movable.foot(q) for q in joints]
    >>> (foot[-1] - foot[0])[0].round(6)  # 0.05 (1 - cos(1)) [m]
    np.float64(0.022985)
    """
    return _with_scope(KinematicLoop(equation_of(config), config.start))


def unguarded(equation: KinematicEquation, start: Sequence[float]) -> Diagram:
    """Wire a loop that no guard watches: of Drake's symbols, where the robot has a formula.

    No Python then runs in its steps. Its state is still to be set, to ``equation.start(start)``.
    """
    block = compiled_loop(equation, start)
    return _with_scope(KinematicLoop(equation, start) if block is None else block)


def _with_scope(block: LeafSystem) -> Diagram:
    builder = DiagramBuilder()
    builder.AddNamedSystem(LOOP, block)
    add_scope(builder, SCOPE, block.get_output_port())
    return builder.Build()
